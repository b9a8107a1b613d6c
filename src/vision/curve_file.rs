//! Curves in CSV files: patterns, centrelines of images and nodes of simulated rods.

use super::input::read_text;
use super::{Point, VisionError};
use rodlab_files::input::{Column, Table};
use std::path::Path;

/// Maximum number of points of a curve.
const MOST_POINTS: usize = 1_000_000;

/// Reads a plane curve in metres from a CSV file, see [`Table`]. The columns are `x` and `y`, with
/// their unit in any of the usual forms, or the first two columns of a file without a header.
/// Without a unit, values are in metres.
///
/// If the file has several strands (a column `strand`, from 1), `strand` is read, or else the
/// first one in the file. Of several rods (a column `rod`) the first is read, and of several times
/// (`time_s`) the last. If most times have a single point, the table is a path in time: all of its
/// points are read.
///
/// # Errors
/// The file cannot be read, has no such columns, or a value is not a finite number.
pub fn read_curve(path: &Path, strand: Option<usize>) -> Result<Vec<Point>, VisionError> {
    let text = read_text(path)?;
    parse_curve(&text, strand).map_err(|reason| VisionError::Malformed {
        path: path.into(),
        reason,
    })
}

fn parse_curve(text: &str, strand: Option<usize>) -> Result<Vec<Point>, String> {
    let table = Table::new(text)?;
    let names = table.header().unwrap_or_default();
    let (Some(x), Some(y)) = (table.column("x", 0), table.column("y", 1)) else {
        let has_pixels = names.iter().any(|name| name == "u_px");
        return Err(format!(
            "its header \"{}\" has no columns x_m and y_m{}",
            names.join(","),
            if has_pixels {
                "; `rodlab trace --cell` writes them"
            } else {
                ""
            }
        ));
    };
    // A file without a header has none of these columns.
    let named = |name: &str| table.column(name, usize::MAX);
    let group = named("strand").or_else(|| named("rod"));
    let time = named("time");
    let mut wanted = strand.map(|strand| strand.to_string());
    if strand.is_some() && group.is_none() {
        return Err("it has no column strand".into());
    }
    let mut latest = f64::NEG_INFINITY;
    let mut points = Vec::new();
    // Points at all times, the number of these times, and that of the rows.
    let mut path: Result<Vec<Point>, String> = Ok(Vec::new());
    let (mut times, mut rows) = (0_usize, 0_usize);
    for (line, values) in table.rows() {
        let number = |column: Column| {
            table.value(&values, column).ok_or_else(|| {
                let text = values.get(column.index).map_or("", String::as_str);
                let name = names
                    .get(column.index)
                    .map_or("a coordinate", String::as_str);
                format!("line {line}: {name} is \"{text}\", expected a number")
            })
        };
        if let Some(group) = group {
            let found = values.get(group.index).map_or("", String::as_str);
            if wanted.get_or_insert_with(|| found.to_string()) != found {
                continue;
            }
        }
        let at = time.map_or(Ok(0.0), number)?;
        if at > latest {
            latest = at;
            times += 1;
            points.clear();
        }
        let place = || -> Result<Point, String> { Ok(Point::new(number(x)?, number(y)?)) };
        rows += 1;
        if rows <= MOST_POINTS && time.is_some() {
            path = path.and_then(|mut path| {
                path.push(place()?);
                Ok(path)
            });
        }
        if at == latest {
            points.push(place()?);
        }
        if points.len() > MOST_POINTS {
            return Err(format!("it has more than {MOST_POINTS} points"));
        }
    }
    // A curve at one time has two points or more.
    if time.is_some() && 2 * times > rows {
        if rows > MOST_POINTS {
            return Err(format!("it has more than {MOST_POINTS} points"));
        }
        points = path?;
    }
    if points.len() < 2 {
        return Err(match strand {
            Some(strand) => format!("strand {strand} has fewer than two points"),
            None => "it has fewer than two points".into(),
        });
    }
    Ok(points)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strands_rods_and_times_are_distinguished() {
        let strands = "strand,point,u_px,v_px,width_px,x_m,y_m\n1,0,0,0,2,0,0\n1,1,0,0,2,1,0\n2,0,0,0,2,5,5\n2,1,0,0,2,6,5\n";
        assert_eq!(
            parse_curve(strands, None).expect("a curve")[1],
            Point::new(1.0, 0.0)
        );
        assert_eq!(
            parse_curve(strands, Some(2)).expect("a curve")[0],
            Point::new(5.0, 5.0)
        );
        assert!(parse_curve(strands, Some(3)).is_err());
        let nodes = "time_s,rod,node,x_m,y_m,z_m,theta_rad\n0,beam,0,9,9,9,\n0,beam,1,8,9,9,\n\
                     2,beam,0,1,2,3,\n2,beam,1,2,2,3,\n2,other,0,4,4,4,\n";
        let found = parse_curve(nodes, None).expect("a curve");
        assert_eq!(found, [Point::new(1.0, 2.0), Point::new(2.0, 2.0)]);
    }

    #[test]
    fn a_path_in_time_is_read_as_a_whole() {
        // The last time twice: the pen waits.
        let path = "time_s,x_mm,y_mm\n0,0,0\n1,50,0\n2,100,0\n3,200,5\n3,200,5\n";
        let found = parse_curve(path, None).expect("a curve");
        assert_eq!(found.len(), 5);
        assert!((found[3] - Point::new(0.2, 0.005)).norm() < 1e-12);
        let error = parse_curve("time_s,x_m,y_m\n0,0,0\n1,a,0\n2,1,0\n", None).expect_err("text");
        assert!(error.contains("line 3"), "{error}");
    }

    #[test]
    fn faults_name_the_line() {
        let error = parse_curve("x_m,y_m\n0,0\n1,zero\n", None).expect_err("no number");
        assert!(error.contains("line 3") && error.contains("y_m"), "{error}");
        let error = parse_curve("strand,point,u_px,v_px,width_px\n", None).expect_err("no metres");
        assert!(error.contains("--cell"), "{error}");
        assert!(parse_curve("", None).is_err());
        assert!(parse_curve("x,y\n1,2\n", None).is_err());
        assert!(parse_curve("x,y\n1,2\n3\n", None).is_err());
    }
}
