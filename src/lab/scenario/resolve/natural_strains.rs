//! Resolves natural curvature and twist over the arc length: rows from a CSV file or from the
//! scenario itself.

use super::columns::read_columns;
use crate::scenario::resolved::Strains;
use crate::scenario::section::{LARGEST, Section};
use crate::scenario::typed;
use std::path::Path;

const COLUMNS: [&str; 4] = ["arc_length", "curvature_1", "curvature_2", "twist"];

/// Resolves natural strains.
pub fn strains(section: &Section<'_>, typed: &typed::Strains) -> Strains {
    let lists = [
        &typed.arc_length,
        &typed.curvature_1,
        &typed.curvature_2,
        &typed.twist,
    ];
    if let Some(file) = &typed.file {
        let given = COLUMNS.iter().zip(lists);
        let given: Vec<(&str, bool)> = given.map(|(key, list)| (*key, list.is_some())).collect();
        section.refuse(&given, "give `file` or lists, not both");
        return read(&section.path_of("file", file)).unwrap_or_else(|message| {
            section.fault("file", message);
            Strains::default()
        });
    }
    for (key, list) in COLUMNS.into_iter().zip(lists) {
        if list.is_none() {
            section.missing(key, "a list of numbers, or a CSV `file` with all columns");
        }
        let wrong = (list.iter().flatten()).find(|one| one.is_nan() || one.abs() > LARGEST);
        if let Some(wrong) = wrong {
            section.out_of_range(key, wrong, format_args!("at most {LARGEST:e} in magnitude"));
        }
    }
    let [arc_length, curvature_1, curvature_2, twist] =
        lists.map(|list| list.clone().unwrap_or_default());
    let rows = arc_length.len();
    let others = [&curvature_1, &curvature_2, &twist];
    for (key, list) in COLUMNS[1..].iter().zip(others) {
        if list.len() != rows {
            let found = list.len();
            section.fault(key, format!("{found} numbers, but `arc_length` has {rows}"));
        }
    }
    if let Err((row, message)) = check(&arc_length) {
        section.fault("arc_length", format!("number {}: {message}", row + 1));
    }
    Strains {
        arc_length,
        curvature_1,
        curvature_2,
        twist,
    }
}

/// Checks that arc lengths begin at 0 and increase. A fault names its row, counted from 0.
fn check(lengths: &[f64]) -> Result<(), (usize, String)> {
    match lengths {
        [] | [_] => Err((0, "at least 2 rows are needed".to_owned())),
        [first, ..] if *first != 0.0 => Err((0, format!("{first} m; the first must be 0"))),
        _ => match lengths.windows(2).position(|pair| pair[1] <= pair[0]) {
            Some(row) => Err((
                row + 1,
                format!("{} m does not exceed the previous one", lengths[row + 1]),
            )),
            None => Ok(()),
        },
    }
}

fn read(path: &Path) -> Result<Strains, String> {
    let rows = read_columns(path, COLUMNS)?;
    let lengths: Vec<f64> = rows.iter().map(|(_, row)| row[0]).collect();
    check(&lengths).map_err(|(row, message)| match rows.get(row) {
        Some((line, _)) => format!("{}, line {line}: arc_length: {message}", path.display()),
        None => format!("{}: {message}", path.display()),
    })?;
    let column = |index: usize| rows.iter().map(|(_, row)| row[index]).collect();
    Ok(Strains {
        arc_length: lengths,
        curvature_1: column(1),
        curvature_2: column(2),
        twist: column(3),
    })
}
