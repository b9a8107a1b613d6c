//! Files of measurements.
//!
//! A CSV file has one of three headers. Empty cells were not measured.
//!
//! | header | content |
//! |---|---|
//! | `time_s,marker,x_m,y_m,z_m` and `rod`, `node` or `arc_length_m` | positions of markers; the place of each may also be in a second file |
//! | `x_m,y_m,z_m` | points along a centreline from its first end, matched by their part of its length |
//! | `time_s` and names of columns | columns of probes, `critical_parameter`, `sliding_onset_s`, `frequency_1_hz`, ... |
//!
//! `time_s` may be absent for equilibria, and any of the coordinates for pictures. A column
//! `sd_m`, or the name of a column with the suffix `_sd`, gives the standard deviation of the
//! noise of each row.

use super::error::IdentifyError;
use rodlab_files::input::{self, Column, Table};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Largest file, bytes.
const LARGEST_FILE: u64 = 64 << 20;
/// Maximum number of measured numbers in a file.
const MOST_NUMBERS: usize = 1_000_000;
/// Name of the group of all coordinates of a file.
pub const POSITION: &str = "position";
/// Suffix of a column of standard deviations.
const DEVIATION: &str = "_sd";
/// Names of coordinates.
pub const AXES: [&str; 3] = ["x", "y", "z"];

/// A place on a rod.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// Name of the rod; `None` for the only rod.
    pub rod: Option<String>,
    /// Where on the rod.
    pub at: At,
}

/// A place along a rod.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum At {
    /// A node, from 0.
    Node(usize),
    /// Arc length from the first node, m.
    ArcLength(f64),
    /// Fraction of the length of the rod, 0 to 1.
    Part(f64),
}

/// Quantity that a number measures.
#[derive(Clone, Debug, PartialEq)]
pub enum Measured {
    /// A coordinate of a point of a rod, m.
    Coordinate {
        /// The point.
        place: Place,
        /// 0 to 2 for x, y, z.
        axis: usize,
    },
    /// Component of the position of a point of a rod along a direction, m.
    Along {
        /// The point.
        place: Place,
        /// The direction, a unit vector.
        direction: [f64; 3],
    },
    /// A column of a probe, or one of the derived columns.
    Column(String),
}

/// A measured number.
#[derive(Clone, Debug, PartialEq)]
pub struct Datum {
    /// Line of the datum in the file, from 1.
    pub line: usize,
    /// Time, s; `None` in an equilibrium.
    pub time: Option<f64>,
    /// The quantity.
    pub measured: Measured,
    /// The number, in SI units.
    pub value: f64,
    /// Standard deviation of its noise, if the file states it.
    pub deviation: Option<f64>,
    /// Name of its series: numbers of one series follow each other in time or along the rod.
    pub series: String,
}

/// The measurements of a file.
#[derive(Clone, Debug)]
pub struct DataFile {
    /// The file.
    pub path: PathBuf,
    /// The numbers, in the order of the rows.
    pub data: Vec<Datum>,
}

impl Datum {
    /// Name of the group of numbers with the same noise: `position`, or the column.
    pub fn group(&self) -> &str {
        match &self.measured {
            Measured::Coordinate { .. } | Measured::Along { .. } => POSITION,
            Measured::Column(name) => name,
        }
    }
}

impl DataFile {
    /// Reads a file; `markers` gives the places of markers that the file does not state.
    ///
    /// # Errors
    /// The first fault, with its line and what is allowed.
    pub fn read(path: &Path, markers: &BTreeMap<String, Place>) -> Result<Self, IdentifyError> {
        let text = text_of(path)?;
        Self::from_text(path, &text, markers)
    }

    /// Reads the measurements from the text of a file.
    ///
    /// # Errors
    /// The errors of [`DataFile::read`].
    pub fn from_text(
        path: &Path,
        text: &str,
        markers: &BTreeMap<String, Place>,
    ) -> Result<Self, IdentifyError> {
        let reader = Reader::new(path, text)?;
        let axes = AXES.map(|axis| reader.table.column(axis, usize::MAX));
        let data = if axes.iter().any(Option::is_some) {
            reader.points(axes, markers)?
        } else {
            reader.columns()?
        };
        if data.is_empty() {
            return Err(
                reader.fault("there are no measurements; give at least one row with a number")
            );
        }
        if data.len() > MOST_NUMBERS {
            let message = format!(
                "there are {} numbers; allowed: at most {MOST_NUMBERS}",
                data.len()
            );
            return Err(reader.fault(&message));
        }
        Ok(Self {
            path: path.to_owned(),
            data,
        })
    }
}

/// Reads a file of places of markers: `marker` with `node` or `arc_length_m`, and `rod` if there
/// are several rods.
///
/// # Errors
/// The first fault, with its line.
pub fn read_markers(path: &Path) -> Result<BTreeMap<String, Place>, IdentifyError> {
    let text = text_of(path)?;
    let reader = Reader::new(path, &text)?;
    let marker = reader.needed("marker")?;
    let mut places = BTreeMap::new();
    for row in reader.rows() {
        let (line, fields) = row?;
        let place = reader.place(line, &fields)?.ok_or_else(|| {
            reader.fault_at(line, "the place is missing; give `node` or `arc_length_m`")
        })?;
        places.insert(fields[marker.index].clone(), place);
    }
    Ok(places)
}

fn text_of(path: &Path) -> Result<String, IdentifyError> {
    let unreadable =
        |reason| IdentifyError::Input(format!("{} cannot be read: {reason}", path.display()));
    let bytes = input::read(path, LARGEST_FILE).map_err(unreadable)?;
    String::from_utf8(bytes)
        .map_err(|_| IdentifyError::Input(format!("{}: it is not text in UTF-8", path.display())))
}

struct Reader<'a> {
    path: &'a Path,
    table: Table<'a>,
    header: Vec<String>,
}

impl<'a> Reader<'a> {
    fn new(path: &'a Path, text: &'a str) -> Result<Self, IdentifyError> {
        let fault = |message: &str| IdentifyError::Input(format!("{}: {message}", path.display()));
        let table = Table::new(text).map_err(|message| fault(&message))?;
        let header = table.header().map(<[String]>::to_vec);
        let header = header.ok_or_else(|| {
            fault("there is no header; the first line names the columns, such as time_s,marker,x_m,y_m,z_m")
        })?;
        Ok(Self {
            path,
            table,
            header,
        })
    }

    fn fault(&self, message: &str) -> IdentifyError {
        IdentifyError::Input(format!("{}: {message}", self.path.display()))
    }

    fn fault_at(&self, line: usize, message: impl Into<String>) -> IdentifyError {
        IdentifyError::Row {
            file: self.path.to_owned(),
            line,
            message: message.into(),
        }
    }

    /// Rows of the right length, with their line numbers.
    fn rows(&self) -> impl Iterator<Item = Result<(usize, Vec<String>), IdentifyError>> + '_ {
        self.table.rows().map(|(line, fields)| {
            let checked = self.table.check_length(&fields);
            checked.map_err(|message| self.fault_at(line, message))?;
            Ok((line, fields))
        })
    }

    fn column(&self, name: &str) -> Option<Column> {
        self.table.column(name, usize::MAX)
    }

    fn needed(&self, name: &str) -> Result<Column, IdentifyError> {
        self.column(name).ok_or_else(|| {
            let known = self.header.join(", ");
            self.fault(&format!("there is no column `{name}`; there are {known}"))
        })
    }

    /// Returns the number of a cell; `None` if it is empty.
    fn number(
        &self,
        line: usize,
        fields: &[String],
        column: Column,
    ) -> Result<Option<f64>, IdentifyError> {
        let text = fields.get(column.index).map_or("", String::as_str);
        if text.is_empty() {
            return Ok(None);
        }
        let number = self.table.value(fields, column);
        number.map(Some).ok_or_else(|| {
            let name = &self.header[column.index];
            self.fault_at(
                line,
                format!("`{name}` is {text:?}; allowed: a finite number, or nothing where it was not measured"),
            )
        })
    }

    /// Returns the standard deviation of a cell, which must be above 0.
    fn deviation(
        &self,
        line: usize,
        fields: &[String],
        column: Option<Column>,
    ) -> Result<Option<f64>, IdentifyError> {
        let Some(column) = column else {
            return Ok(None);
        };
        match self.number(line, fields, column)? {
            Some(number) if number <= 0.0 => Err(self.fault_at(
                line,
                format!(
                    "`{}` is {number}; allowed: above 0",
                    self.header[column.index]
                ),
            )),
            number => Ok(number),
        }
    }

    /// Returns the time of a row; `None` without a time column.
    fn time(&self, line: usize, fields: &[String]) -> Result<Option<f64>, IdentifyError> {
        let Some(column) = self.column("time") else {
            return Ok(None);
        };
        match self.number(line, fields, column)? {
            None => Err(self.fault_at(line, "the time is missing")),
            time => Ok(time),
        }
    }

    /// Returns the place that a row states.
    fn place(&self, line: usize, fields: &[String]) -> Result<Option<Place>, IdentifyError> {
        let rod = self
            .column("rod")
            .map(|column| fields[column.index].clone());
        let rod = rod.filter(|name| !name.is_empty());
        let node = match self.column("node") {
            Some(column) => self.number(line, fields, column)?,
            None => None,
        };
        let arc_length = match self.column("arc_length") {
            Some(column) => self.number(line, fields, column)?,
            None => None,
        };
        let at = match (node, arc_length) {
            (None, None) => return Ok(None),
            (Some(_), Some(_)) => {
                return Err(self.fault_at(line, "give either `node` or `arc_length_m`, not both"));
            }
            (Some(node), None) if node < 0.0 || node.fract() != 0.0 => {
                return Err(self.fault_at(
                    line,
                    format!("`node` is {node}; allowed: whole numbers from 0"),
                ));
            }
            (Some(node), None) => At::Node(node as usize),
            (None, Some(length)) => At::ArcLength(length),
        };
        Ok(Some(Place { rod, at }))
    }

    /// Reads positions of markers, or points along a centreline.
    fn points(
        &self,
        axes: [Option<Column>; 3],
        markers: &BTreeMap<String, Place>,
    ) -> Result<Vec<Datum>, IdentifyError> {
        let marker = self.column("marker");
        let has_places = self.column("node").is_some() || self.column("arc_length").is_some();
        let deviation = self.column("sd");
        let mut curves = Curves::default();
        let mut data = Vec::new();
        for row in self.rows() {
            let (line, fields) = row?;
            let time = self.time(line, &fields)?;
            let values =
                axes.map(|axis| axis.map_or(Ok(None), |column| self.number(line, &fields, column)));
            let mut coordinates = [None; 3];
            for (coordinate, value) in coordinates.iter_mut().zip(values) {
                *coordinate = value?;
            }
            let deviation = self.deviation(line, &fields, deviation)?;
            let stated = self.place(line, &fields)?;
            let name = marker.map(|column| fields[column.index].clone());
            let place = match (&stated, &name) {
                (Some(place), _) => place.clone(),
                (None, Some(name)) => markers.get(name).cloned().ok_or_else(|| {
                    let known: Vec<&str> = markers.keys().map(String::as_str).collect();
                    let known = match known.is_empty() {
                        true => "none; add a column `node` or `arc_length_m`, or pass --markers"
                            .to_owned(),
                        false => known.join(", "),
                    };
                    self.fault_at(
                        line,
                        format!(
                            "the place of marker `{name}` on a rod is not known; known: {known}"
                        ),
                    )
                })?,
                (None, None) if has_places => {
                    return Err(
                        self.fault_at(line, "the place is missing; give `node` or `arc_length_m`")
                    );
                }
                (None, None) => {
                    let rod = self
                        .column("rod")
                        .map(|column| fields[column.index].clone());
                    curves.add(time, rod.as_deref(), coordinates, data.len());
                    Place {
                        rod,
                        at: At::Part(0.0),
                    }
                }
            };
            for (axis, value) in coordinates.iter().enumerate() {
                let Some(value) = *value else { continue };
                let series = match (&name, &place.at) {
                    (Some(name), _) => format!("{name} {}", AXES[axis]),
                    (None, At::Node(node)) if time.is_some() => {
                        format!("node {node} {}", AXES[axis])
                    }
                    (None, _) => AXES[axis].to_owned(),
                };
                data.push(Datum {
                    line,
                    time,
                    measured: Measured::Coordinate {
                        place: place.clone(),
                        axis,
                    },
                    value,
                    deviation,
                    series,
                });
            }
        }
        curves.place(&mut data);
        Ok(data)
    }

    /// Reads columns of probes and derived columns.
    fn columns(&self) -> Result<Vec<Datum>, IdentifyError> {
        let whole = |index| Column { index, unit: 1.0 };
        let named = |name: &str| {
            self.header
                .iter()
                .position(|other| other == name)
                .map(whole)
        };
        let measured: Vec<(&String, Column)> = (self.header.iter().enumerate())
            .filter(|(_, name)| {
                let name = name.to_lowercase();
                !name.starts_with("time") && !name.ends_with(DEVIATION)
            })
            .map(|(index, name)| (name, whole(index)))
            .collect();
        let mut data = Vec::new();
        for row in self.rows() {
            let (line, fields) = row?;
            let time = self.time(line, &fields)?;
            for (name, column) in &measured {
                let Some(value) = self.number(line, &fields, *column)? else {
                    continue;
                };
                let deviation = named(&format!("{name}{DEVIATION}"));
                data.push(Datum {
                    line,
                    time,
                    measured: Measured::Column((*name).clone()),
                    value,
                    deviation: self.deviation(line, &fields, deviation)?,
                    series: (*name).clone(),
                });
            }
        }
        Ok(data)
    }
}

/// Points along centrelines, which are matched by their fraction of the length of the polyline.
#[derive(Default)]
struct Curves(Vec<Points>);

/// The points of one centreline at one time.
struct Points {
    time: Option<f64>,
    rod: Option<String>,
    /// Each point with the index of its first datum.
    points: Vec<([f64; 3], usize)>,
}

impl Curves {
    fn add(
        &mut self,
        time: Option<f64>,
        rod: Option<&str>,
        coordinates: [Option<f64>; 3],
        first: usize,
    ) {
        if coordinates.iter().all(Option::is_none) {
            return;
        }
        let point = coordinates.map(Option::unwrap_or_default);
        let same = |curve: &&mut Points| curve.time == time && curve.rod.as_deref() == rod;
        match self.0.iter_mut().find(same) {
            Some(curve) => curve.points.push((point, first)),
            None => self.0.push(Points {
                time,
                rod: rod.map(str::to_owned),
                points: vec![(point, first)],
            }),
        }
    }

    /// Writes the places of all points into their data.
    fn place(&self, data: &mut [Datum]) {
        for curve in &self.0 {
            let mut lengths = vec![0.0];
            for pair in curve.points.windows(2) {
                let steps = (0..3).map(|axis| (pair[1].0[axis] - pair[0].0[axis]).powi(2));
                let last = lengths[lengths.len() - 1];
                lengths.push(last + steps.sum::<f64>().sqrt());
            }
            let whole = lengths[lengths.len() - 1];
            for ((_, first), length) in curve.points.iter().zip(lengths) {
                let part = if whole > 0.0 { length / whole } else { 0.0 };
                let line = data[*first].line;
                for datum in data[*first..]
                    .iter_mut()
                    .take_while(|datum| datum.line == line)
                {
                    if let Measured::Coordinate { place, .. } = &mut datum.measured {
                        place.at = At::Part(part);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn read(text: &str) -> Result<Vec<Datum>, String> {
        let markers = BTreeMap::from([(
            "tip".to_owned(),
            Place {
                rod: None,
                at: At::Node(20),
            },
        )]);
        let file = DataFile::from_text(Path::new("swing.csv"), text, &markers);
        file.map(|file| file.data)
            .map_err(|error| error.to_string())
    }

    #[test]
    fn markers_centrelines_and_columns_are_read() {
        let data = read("time_s,marker,x_m,y_m,z_m\n0.1,tip,1,2,\n").unwrap();
        assert_eq!(data.len(), 2);
        assert_eq!(
            (data[1].time, data[1].value, data[1].series.as_str()),
            (Some(0.1), 2.0, "tip y")
        );
        let data = read("rod,arc_length_m,z_mm,sd_mm\nwire,0.5,-3,1\n").unwrap();
        let place = Place {
            rod: Some("wire".into()),
            at: At::ArcLength(0.5),
        };
        assert_eq!(data[0].measured, Measured::Coordinate { place, axis: 2 });
        assert_eq!((data[0].value, data[0].deviation), (-0.003, Some(0.001)));
        let data = read("point,x_m,y_m\n0,0,0\n1,0,1\n2,3,1\n").unwrap();
        let parts: Vec<At> = data
            .iter()
            .filter_map(|datum| match &datum.measured {
                Measured::Coordinate { place, axis: 0 } => Some(place.at),
                _ => None,
            })
            .collect();
        assert_eq!(parts, [At::Part(0.0), At::Part(0.25), At::Part(1.0)]);
        let data = read("time_s,pull_force_x_n,pull_force_x_n_sd\n0.5,2.5,0.1\n").unwrap();
        assert_eq!(data[0].measured, Measured::Column("pull_force_x_n".into()));
        assert_eq!(data[0].deviation, Some(0.1));
    }

    #[test]
    fn faults_name_the_line_and_what_is_allowed() {
        for (text, expected) in [
            ("1,2,3\n", "there is no header"),
            (
                "time_s,marker,x_m\n0,tip\n",
                "line 2: expected 3 columns, found 2",
            ),
            (
                "time_s,marker,x_m\n0,tip,NaN\n",
                "line 2: `x_m` is \"NaN\"; allowed: a finite number",
            ),
            (
                "time_s,marker,x_m\n0,top,1\n",
                "line 2: the place of marker `top` on a rod is not known; known: tip",
            ),
            ("time_s,marker,x_m\n,tip,1\n", "line 2: the time is missing"),
            (
                "node,x_m\n1.5,1\n",
                "line 2: `node` is 1.5; allowed: whole numbers",
            ),
            (
                "node,x_m,sd_m\n1,1,0\n",
                "line 2: `sd_m` is 0; allowed: above 0",
            ),
            ("time_s,marker,x_m\n", "no measurements"),
        ] {
            let error = read(text).unwrap_err();
            assert!(
                error.contains(expected) && error.contains("swing.csv"),
                "{error}"
            );
        }
    }

    proptest! {
        #[test]
        fn any_text_is_read_or_refused(text in "(time_s|marker|x_m|node|sd_m|force_n|,|\n|tip|[-0-9.]{1,4}){0,30}") {
            let _ = read(&text);
        }
    }
}
