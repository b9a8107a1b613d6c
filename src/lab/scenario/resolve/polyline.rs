//! Resolves polylines: corners from a CSV file or from the scenario itself.

use super::columns::read_columns;
use crate::scenario::resolved::Shape;
use crate::scenario::section::Section;
use crate::scenario::typed::{self, Vector};
use crate::scenario::units::Length;
use std::path::Path;

/// Resolves a polyline.
pub fn points(section: &Section<'_>, typed: &typed::Points) -> Shape {
    Shape::Points {
        points: corners(section, "file", &typed.file, &typed.points),
    }
}

/// Corners from the file that `key` names, or from the key `points`; empty after a fault.
pub fn corners(
    section: &Section<'_>,
    key: &str,
    file: &Option<String>,
    points: &Option<Vec<Vector<Length>>>,
) -> Vec<[f64; 3]> {
    match (file, points) {
        (Some(file), None) => read(&section.path_of(key, file)).unwrap_or_else(|message| {
            section.fault(key, message);
            Vec::new()
        }),
        (None, Some(points)) => {
            let below = section.below("points");
            let points: Vec<[f64; 3]> = points
                .iter()
                .enumerate()
                .map(|(index, point)| below.components(&index.to_string(), point))
                .collect();
            if let Some(index) = first_repeated(&points) {
                below.fault(
                    &index.to_string(),
                    "the point repeats the one before it; consecutive points must differ",
                );
            }
            if points.len() < 2 {
                section.fault("points", "a polyline needs at least 2 points");
            }
            points
        }
        (None, None) => {
            section.missing(
                key,
                "a CSV file with columns x, y, z, or the `points` themselves",
            );
            Vec::new()
        }
        (Some(_), Some(_)) => {
            section.fault("points", format!("give `{key}` or `points`, not both"));
            Vec::new()
        }
    }
}

/// Index of the first point that equals the previous point.
fn first_repeated(points: &[[f64; 3]]) -> Option<usize> {
    points
        .windows(2)
        .position(|pair| pair[0] == pair[1])
        .map(|index| index + 1)
}

/// Reads a CSV file of corners. A header line names the columns x, y and z (with or without the
/// suffix `_m`); other columns are ignored. Each further row is a corner, in m. Lines that begin
/// with `#` are comments.
pub fn read(path: &Path) -> Result<Vec<[f64; 3]>, String> {
    let place = path.display();
    let rows = read_columns(path, ["x", "y", "z"])?;
    if let Some(pair) = rows.windows(2).find(|pair| pair[0].1 == pair[1].1) {
        return Err(format!(
            "{place}, line {}: the point repeats the one before it; consecutive points must differ",
            pair[1].0
        ));
    }
    if rows.len() < 2 {
        return Err(format!(
            "{place} has {} points; a polyline needs at least 2",
            rows.len()
        ));
    }
    Ok(rows.into_iter().map(|(_, point)| point).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    fn read_text(text: &str) -> Result<Vec<[f64; 3]>, String> {
        let mut file = tempfile::NamedTempFile::new().unwrap();
        file.write_all(text.as_bytes()).unwrap();
        let name = file.path().display().to_string();
        read(file.path()).map_err(|message| message.replace(&name, "shape.csv"))
    }

    #[test]
    fn columns_are_found_by_name() {
        let points = read_text("# a comment\nz_m, s, x_m, y_m\n3,0,1,2\n6,1,4,5e0\n");
        assert_eq!(points, Ok(vec![[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]));
    }

    #[test]
    fn faults_name_file_and_line() {
        let fault = |text| read_text(text).unwrap_err();
        insta::assert_snapshot!(fault("x,y,z\n0,0,0\n1,0\n"), @"shape.csv, line 3: expected 3 columns, found 2");
        insta::assert_snapshot!(fault("x,y,z\n0,0,zero\n"), @r#"shape.csv, line 2: "zero" is not a finite number"#);
        insta::assert_snapshot!(fault("x,y,z\n0,0,nan\n"), @r#"shape.csv, line 2: "nan" is not a finite number"#);
        insta::assert_snapshot!(fault("x,y,z\n0,0,1\n0,0,2\n0,0,2\n"), @"shape.csv, line 4: the point repeats the one before it; consecutive points must differ");
        insta::assert_snapshot!(fault("x,y\n0,0\n"), @"shape.csv, line 1: no column `z`; the header must name x, y and z");
        insta::assert_snapshot!(fault("x,y,z\n0,0,1\n"), @"shape.csv has 1 points; a polyline needs at least 2");
        insta::assert_snapshot!(fault(""), @"shape.csv: it is empty");
    }
}
