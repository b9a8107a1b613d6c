//! Resolves the radius over the arc length of a rod: rows from a CSV file or from the scenario
//! itself, as sections between them.

use super::columns::read_columns;
use super::cross_section::check_wall;
use crate::scenario::quantity::Quantity;
use crate::scenario::resolved::{CrossSection, Rod, RodSection};
use crate::scenario::section::{NON_NEGATIVE, POSITIVE, Section};
use crate::scenario::typed;
use crate::scenario::units::Length;
use std::path::Path;

const COLUMNS: [&str; 2] = ["arc_length", "radius"];

/// Resolves a profile.
pub fn sections(section: &Section<'_>, typed: &typed::Profile, rod: &Rod) -> Vec<RodSection> {
    if matches!(rod.cross_section, CrossSection::Rectangle { .. }) {
        section.fault(
            "radius",
            "a rectangle has no radius over the arc length; use `sections` with `end_width`",
        );
        return Vec::new();
    }
    let rows = rows(section, typed);
    let least = rows.iter().map(|row| row[1]).fold(f64::INFINITY, f64::min);
    check_wall(section, &rod.cross_section, least);
    let between = |pair: &[[f64; 2]]| RodSection {
        from: pair[0][0],
        to: Some(pair[1][0]),
        radius: pair[0][1],
        end_radius: pair[1][1],
        cross_section: rod.cross_section,
        end_width: None,
        end_thickness: None,
        youngs_modulus: rod.material.youngs_modulus,
        poissons_ratio: rod.material.poissons_ratio,
        density: rod.material.density,
        natural_curvature: None,
        natural_twist: None,
        friction: None,
    };
    rows.windows(2).map(between).collect()
}

/// The rows, each an arc length and a radius in m; none after a fault.
fn rows(section: &Section<'_>, typed: &typed::Profile) -> Vec<[f64; 2]> {
    let lists = [&typed.arc_length, &typed.radius];
    if let Some(file) = &typed.file {
        let given = COLUMNS.iter().zip(lists);
        let given: Vec<(&str, bool)> = given.map(|(key, list)| (*key, list.is_some())).collect();
        section.refuse(&given, "give `file` or lists, not both");
        return read(&section.path_of("file", file)).unwrap_or_else(|message| {
            section.fault("file", message);
            Vec::new()
        });
    }
    for (key, list) in COLUMNS.into_iter().zip(lists) {
        if list.is_none() {
            section.missing(key, "a list of lengths, or a CSV `file` with all columns");
        }
    }
    let numbers = |key: &str, list: &Option<Vec<Quantity<Length>>>, range| -> Vec<f64> {
        let typed = list.as_deref().unwrap_or(&[]);
        let elements = section.elements(key, typed).enumerate();
        let below = section.below(key);
        elements
            .map(|(index, (_, one))| below.number(&index.to_string(), one, range))
            .collect()
    };
    let places = numbers("arc_length", &typed.arc_length, NON_NEGATIVE);
    let radii = numbers("radius", &typed.radius, POSITIVE);
    if radii.len() != places.len() {
        let message = format!(
            "{} numbers, but `arc_length` has {}",
            radii.len(),
            places.len()
        );
        section.fault("radius", message);
    } else if let Err((row, message)) = check(&places) {
        section.fault("arc_length", format!("number {}: {message}", row + 1));
    }
    let rows = places.into_iter().zip(radii);
    rows.map(|(place, radius)| [place, radius]).collect()
}

/// Checks that arc lengths increase. A fault names its row, counted from 0.
fn check(places: &[f64]) -> Result<(), (usize, String)> {
    if places.len() < 2 {
        return Err((0, "at least 2 rows are needed".to_owned()));
    }
    match places.windows(2).position(|pair| pair[1] <= pair[0]) {
        Some(row) => {
            let message = format!("{} m does not exceed the previous one", places[row + 1]);
            Err((row + 1, message))
        }
        None => Ok(()),
    }
}

fn read(path: &Path) -> Result<Vec<[f64; 2]>, String> {
    let rows = read_columns(path, COLUMNS)?;
    let at = |row: usize, message: &str| match rows.get(row) {
        Some((line, _)) => format!("{}, line {line}: {message}", path.display()),
        None => format!("{}: {message}", path.display()),
    };
    let places: Vec<f64> = rows.iter().map(|(_, row)| row[0]).collect();
    check(&places).map_err(|(row, message)| at(row, &format!("arc_length: {message}")))?;
    let wrong = rows
        .iter()
        .position(|(_, row)| row[0] < 0.0 || row[1] <= 0.0);
    match wrong {
        Some(row) => Err(at(
            row,
            "an arc length must be at least 0, and a radius greater than 0",
        )),
        None => Ok(rows.iter().map(|(_, row)| *row).collect()),
    }
}
