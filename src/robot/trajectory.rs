//! Joint trajectories as tables: `time_s` and a column per joint, `arm.joint_rad` or `arm.joint_m`; an external axis is
//! `axis_rad`.

use super::chain::JointKind;
use rodlab_files::finite::{self, NotFinite};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Largest table, bytes; endless pipes are not read further.
const LARGEST: u64 = 256 << 20;

/// A joint trajectory of arms and axes on one clock.
#[derive(Clone, Debug, PartialEq)]
pub struct JointTrajectory {
    /// Part, joint and unit of each column.
    pub columns: Vec<Column>,
    /// Increasing times, s.
    pub times: Vec<f64>,
    /// Positions, rad or m: a row per time.
    pub points: Vec<Vec<f64>>,
}

/// A column of a trajectory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// Name of the arm or of the axis.
    pub part: String,
    /// Name of the joint; `None` for an axis.
    pub joint: Option<String>,
    /// Kind of the joint, which determines the unit, rad or m.
    pub kind: JointKind,
}

/// Reason why a table is rejected.
#[derive(Debug, thiserror::Error)]
#[error("{}{}: {message}", path.display(), line.map(|line| format!(":{line}")).unwrap_or_default())]
pub struct TableError {
    /// The file.
    pub path: PathBuf,
    /// The line, counted from one.
    pub line: Option<u64>,
    /// The error.
    pub message: String,
}

/// The numbers of a table, with its header and the line of each row.
pub struct Table {
    /// Names of the columns.
    pub header: Vec<String>,
    /// Finite numbers.
    pub rows: Vec<Vec<f64>>,
    /// Line of each row.
    pub lines: Vec<u64>,
}

/// Reads a table of numbers.
///
/// # Errors
/// The table cannot be read, a cell is not a finite number, or a row is too short or too long.
pub fn read_table(path: &Path) -> Result<Table, TableError> {
    let fault = |line: Option<u64>, message: String| TableError {
        path: path.to_owned(),
        line,
        message,
    };
    let of_csv = |error: csv::Error| {
        let line = error.position().map(csv::Position::line);
        fault(line, error.to_string())
    };
    let file = File::open(path).map_err(|error| fault(None, error.to_string()))?;
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .from_reader(file.take(LARGEST + 1));
    let header: Vec<String> = reader
        .headers()
        .map_err(of_csv)?
        .iter()
        .map(str::to_owned)
        .collect();
    let (mut rows, mut lines) = (Vec::new(), Vec::new());
    for record in reader.records() {
        let record = record.map_err(of_csv)?;
        let line = record.position().map(csv::Position::line);
        let row: Result<Vec<f64>, TableError> = record
            .iter()
            .zip(&header)
            .map(|(cell, name)| {
                finite::number(cell).ok_or_else(|| {
                    let message = format!("`{name}`: {cell:?} is not a finite number");
                    fault(line, message)
                })
            })
            .collect();
        rows.push(row?);
        lines.push(line.unwrap_or(0));
    }
    if reader.position().byte() > LARGEST {
        let message = format!(
            "it is larger than {} MiB, the largest size allowed",
            LARGEST >> 20
        );
        return Err(fault(None, message));
    }
    Ok(Table {
        header,
        rows,
        lines,
    })
}

impl Column {
    /// Name of the column in a table.
    pub fn header(&self) -> String {
        let unit = self.kind.unit();
        match &self.joint {
            Some(joint) => format!("{}.{joint}_{unit}", self.part),
            None => format!("{}_{unit}", self.part),
        }
    }

    fn parse(header: &str) -> Option<Self> {
        let (name, kind) = match (header.strip_suffix("_rad"), header.strip_suffix("_m")) {
            (Some(name), _) => (name, JointKind::Revolute),
            (None, Some(name)) => (name, JointKind::Prismatic),
            (None, None) => return None,
        };
        let (part, joint) = match name.split_once('.') {
            Some((part, joint)) => (part, Some(joint.to_owned())),
            None => (name, None),
        };
        Some(Self {
            part: part.to_owned(),
            joint,
            kind,
        })
    }
}

impl JointTrajectory {
    /// Reads a trajectory.
    ///
    /// # Errors
    /// The table is faulty, its first column is not `time_s`, another column is not a joint, it
    /// has fewer than two rows, or its times do not increase.
    pub fn read(path: &Path) -> Result<Self, TableError> {
        let table = read_table(path)?;
        let fault = |line: u64, message: String| TableError {
            path: path.to_owned(),
            line: Some(line),
            message,
        };
        if table.header.first().map(String::as_str) != Some("time_s") {
            return Err(fault(1, "the first column must be `time_s`".into()));
        }
        let columns = table.header[1..].iter().map(|header| {
            Column::parse(header).ok_or_else(|| {
                fault(
                    1,
                    format!(
                        "column `{header}`: expected `arm.joint_rad`, `arm.joint_m` or `axis_rad`"
                    ),
                )
            })
        });
        let columns = columns.collect::<Result<Vec<Column>, TableError>>()?;
        if let Some(k) = (1..columns.len()).find(|k| columns[..*k].contains(&columns[*k])) {
            return Err(fault(
                1,
                format!("column `{}` occurs twice", columns[k].header()),
            ));
        }
        if columns.is_empty() || table.rows.len() < 2 {
            return Err(fault(
                1,
                "expected at least one joint column and two rows".into(),
            ));
        }
        for (pair, line) in table.rows.windows(2).zip(&table.lines[1..]) {
            if pair[1][0] <= pair[0][0] {
                let message = format!(
                    "`time_s`: {} follows {}; time must grow",
                    pair[1][0], pair[0][0]
                );
                return Err(fault(*line, message));
            }
        }
        Ok(Self {
            columns,
            times: table.rows.iter().map(|row| row[0]).collect(),
            points: table
                .rows
                .into_iter()
                .map(|mut row| row.split_off(1))
                .collect(),
        })
    }

    /// The trajectory as CSV.
    ///
    /// # Errors
    /// A time or a position is not finite.
    pub fn to_csv(&self) -> Result<String, NotFinite> {
        finite::check(&self.times, |row| format!("`time_s` of point {}", row + 1))?;
        for (row, point) in self.points.iter().enumerate() {
            let name = |column: usize| {
                self.columns
                    .get(column)
                    .map_or_else(String::new, Column::header)
            };
            finite::check(point, |column| {
                format!("`{}` of point {}", name(column), row + 1)
            })?;
        }
        let header: Vec<String> = self.columns.iter().map(Column::header).collect();
        let mut text = format!("time_s,{}\n", header.join(","));
        for (time, point) in self.times.iter().zip(&self.points) {
            // Enough digits for first and second differences over a millisecond.
            let cells: Vec<String> = point.iter().map(|q| format!("{q:.12}")).collect();
            text.push_str(&format!("{time:.6},{}\n", cells.join(",")));
        }
        Ok(text)
    }

    /// Indices of the columns of an arm or axis.
    pub fn columns_of(&self, part: &str) -> Vec<usize> {
        let columns = self.columns.iter().enumerate();
        columns
            .filter(|(_, column)| column.part == part)
            .map(|(index, _)| index)
            .collect()
    }

    /// The trajectory at `speed` times its speed, starting at time zero.
    #[must_use]
    pub fn scaled(&self, speed: f64) -> Self {
        let start = self.times[0];
        Self {
            times: self
                .times
                .iter()
                .map(|time| (time - start) / speed)
                .collect(),
            ..self.clone()
        }
    }

    /// Duration from the first to the last time, s.
    pub fn duration(&self) -> f64 {
        self.times[self.times.len() - 1] - self.times[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<JointTrajectory, String> {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("joints.csv");
        std::fs::write(&path, text).unwrap();
        JointTrajectory::read(&path).map_err(|error| error.to_string())
    }

    const GOOD: &str =
        "time_s,right.j0_rad,right.slide_m,twister_rad\n0,0.1,0.2,0\n0.01,0.11,0.2,1e-3\n";

    #[test]
    fn a_trajectory_reads_back_as_it_was_written() {
        let trajectory = read(GOOD).unwrap();
        assert_eq!(trajectory.columns[0].joint.as_deref(), Some("j0"));
        assert_eq!(trajectory.columns[1].kind, JointKind::Prismatic);
        assert_eq!(
            (
                trajectory.columns[2].part.as_str(),
                &trajectory.columns[2].joint
            ),
            ("twister", &None)
        );
        assert_eq!(trajectory.columns_of("right"), [0, 1]);
        assert_eq!(read(&trajectory.to_csv().unwrap()).unwrap(), trajectory);
        assert_eq!(trajectory.scaled(0.5).duration(), 0.02);
    }

    #[test]
    fn a_trajectory_with_a_number_that_is_not_finite_is_not_written() {
        let mut trajectory = read(GOOD).unwrap();
        trajectory.points[1][0] = f64::NAN;
        let error = trajectory.to_csv().unwrap_err().to_string();
        assert_eq!(error, "`right.j0_rad` of point 2 is not a finite number");
        trajectory.points[1][0] = 0.11;
        trajectory.times[1] = f64::INFINITY;
        assert!(trajectory.to_csv().is_err());
    }

    #[test]
    fn faults_name_the_line() {
        for (good, bad, expected) in [
            ("0.11", "NaN", "joints.csv:3: `right.j0_rad`: \"NaN\""),
            ("0.01,", "-0.01,", "joints.csv:3: `time_s`: -0.01 follows 0"),
            ("1e-3\n", "\n", "joints.csv:3: `twister_rad`: \"\""),
            (",1e-3", "", "joints.csv:3"),
            ("time_s", "t", "joints.csv:1: the first column"),
            ("twister_rad", "twister", "column `twister`"),
            ("twister_rad", "right.j0_rad", "twice"),
            ("0.01,0.11,0.2,1e-3\n", "", "two rows"),
        ] {
            let error = read(&GOOD.replacen(good, bad, 1)).unwrap_err();
            assert!(error.contains(expected), "{error}");
        }
    }
}
