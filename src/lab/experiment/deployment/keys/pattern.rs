//! Resolves a pattern: a drawing with its size and direction, or a formula.

use super::resolved::Pattern;
use super::typed::{self, PatternKind};
use crate::scenario::keys::{Section, read_columns};
use crate::scenario::read_text_file;
use rodlab_files::input::xml_text;
use rodlab_planning::plan::pattern::{Drawing, Point, StrokeChoice, SvgDrawing};
use std::path::Path;

/// Most waves of a sine.
const MOST_WAVES: f64 = 1000.0;

/// Resolves a pattern; `None` after a fault that prevents further checks.
pub fn resolve(section: &Section<'_>, typed: &typed::Pattern) -> Option<Pattern> {
    let kind = typed.kind(section);
    refuse_keys_of_others(section, typed, kind);
    let pattern = match kind {
        PatternKind::Drawn => return drawn(section, typed),
        PatternKind::Line => Pattern::Line {
            length: typed.length(section),
        },
        PatternKind::Circle => {
            let radius = typed.radius(section);
            if radius == 0.0 {
                section.fault("radius", "a circle has a radius other than 0");
            }
            Pattern::Circle { radius }
        }
        PatternKind::Sine => {
            let waves = typed.waves(section);
            if waves > MOST_WAVES {
                section.out_of_range("waves", waves, format_args!("at most {MOST_WAVES}"));
            }
            Pattern::Sine {
                amplitude: typed.amplitude(section),
                wavelength: typed.wavelength(section),
                waves,
            }
        }
    };
    let is_known = match pattern {
        Pattern::Line { length } => length.is_finite(),
        Pattern::Circle { radius } => radius.is_finite() && radius != 0.0,
        Pattern::Sine {
            amplitude,
            wavelength,
            waves,
        } => [amplitude, wavelength, waves].iter().all(|x| x.is_finite()) && waves <= MOST_WAVES,
        Pattern::Drawn { .. } => true,
    };
    is_known.then_some(pattern)
}

/// Reports keys that do not apply to this kind of pattern.
fn refuse_keys_of_others(section: &Section<'_>, typed: &typed::Pattern, kind: PatternKind) {
    let drawn = [
        ("file", typed.file.is_some()),
        ("points", typed.points.is_some()),
        ("size", typed.size.is_some()),
        ("stroke", typed.stroke.is_some()),
        ("reverse", typed.reverse.is_some()),
        ("deviation", typed.deviation.is_some()),
    ];
    let line = [("length", typed.length.is_some())];
    let circle = [("radius", typed.radius.is_some())];
    let sine = [
        ("amplitude", typed.amplitude.is_some()),
        ("wavelength", typed.wavelength.is_some()),
        ("waves", typed.waves.is_some()),
    ];
    for (of, name, keys) in [
        (PatternKind::Drawn, "drawn", &drawn[..]),
        (PatternKind::Line, "line", &line),
        (PatternKind::Circle, "circle", &circle),
        (PatternKind::Sine, "sine", &sine),
    ] {
        if of != kind {
            section.refuse(
                keys,
                &format!("this key is for patterns of kind \"{name}\""),
            );
        }
    }
}

fn drawn(section: &Section<'_>, typed: &typed::Pattern) -> Option<Pattern> {
    let deviation = typed.deviation(section);
    let drawing = Drawing {
        size: typed.size(section),
        reverse: typed.reverse(section),
    };
    let stroke = match typed.stroke {
        Some(_) => Some(section.count("stroke", typed.stroke, 1..=usize::MAX)?),
        None => None,
    };
    let (key, points) = match (&typed.file, &typed.points) {
        (Some(file), None) => {
            let path = section.path_of("file", file);
            ("file", read(&path, stroke))
        }
        (None, Some(points)) => {
            let below = section.below("points");
            let points = points.iter().enumerate().map(|(index, point)| {
                let [x, y] = below.components(&index.to_string(), point);
                Point::new(x, y)
            });
            ("points", Ok(points.collect()))
        }
        (Some(_), Some(_)) => {
            section.fault("points", "give `file` or `points`, not both");
            return None;
        }
        (None, None) => {
            section.missing("file", "an SVG or CSV file, or the `points` themselves");
            return None;
        }
    };
    let points = points.and_then(|points: Vec<Point>| {
        let placed = drawing.of(points);
        placed.map_err(|error| error.to_string())
    });
    match points {
        Ok(points)
            if points
                .iter()
                .all(|point| point.x.is_finite() && point.y.is_finite()) =>
        {
            Some(Pattern::Drawn {
                points: points.iter().map(|point| [point.x, point.y]).collect(),
                deviation,
            })
        }
        Ok(_) => None,
        Err(message) => {
            section.fault(key, message);
            None
        }
    }
}

/// Reads an SVG drawing, and logs the ignored parts.
///
/// # Errors
/// A message with the name of the file: it cannot be read, or is not an SVG drawing.
pub fn svg_drawing(path: &Path) -> Result<SvgDrawing, String> {
    let place = path.display();
    let text = xml_text(&read_text_file(path)?);
    let drawing = SvgDrawing::read(&text).map_err(|error| format!("{place}: {error}"))?;
    for note in &drawing.notes {
        tracing::warn!("{place}: {note}");
    }
    Ok(drawing)
}

/// The points of an SVG or CSV file.
fn read(path: &Path, stroke: Option<usize>) -> Result<Vec<Point>, String> {
    let place = path.display();
    let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
    if extension == "svg" {
        let choice = stroke.map_or(StrokeChoice::Only, StrokeChoice::Number);
        let mut drawing = svg_drawing(path)?;
        let number = drawing.choose(&choice);
        let number = number.map_err(|error| format!("{place}: {error}"))?;
        let stroke = drawing.strokes.swap_remove(number - 1);
        if stroke.is_outline {
            tracing::warn!(
                "{place}: line {}: <{}> is a filled area without a line of its own: the rod follows its edge; \
                 rodlab plan deployment --centreline writes its middle line as drawing.csv",
                stroke.line,
                stroke.element
            );
        }
        return Ok(stroke.points);
    }
    if extension != "csv" {
        return Err(format!("{place}: an .svg or a .csv file is needed"));
    }
    if stroke.is_some() {
        return Err(format!("{place} has no strokes; leave `stroke` out"));
    }
    let rows = read_columns(path, ["x", "y"])?;
    Ok(rows
        .into_iter()
        .map(|(_, [x, y])| Point::new(x, y))
        .collect())
}
