//! Samples: rows of inputs and of expected outputs.

use rand_pcg::Pcg64;
use rand_pcg::rand_core::{Rng, SeedableRng};
use rodlab_files::finite;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Rows of inputs and of the corresponding outputs, each stored one after the other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Samples {
    /// Inputs, `rows` × `input_width`.
    pub inputs: Vec<f64>,
    /// Outputs, `rows` × `output_width`.
    pub outputs: Vec<f64>,
    /// Numbers in a row of inputs.
    pub input_width: usize,
    /// Numbers in a row of outputs.
    pub output_width: usize,
}

/// Reason why samples could not be read.
#[derive(Debug, Error)]
pub enum SamplesError {
    /// The file could not be read.
    #[error("{path} cannot be read: {error}")]
    File {
        /// The file.
        path: PathBuf,
        /// The error.
        error: csv::Error,
    },
    /// A column is missing.
    #[error("{path}: there is no column `{column}`; there are {present}")]
    Column {
        /// The file.
        path: PathBuf,
        /// The column.
        column: String,
        /// The columns of the file.
        present: String,
    },
    /// A cell is not a finite number.
    #[error("{path}, line {line}: `{column}` is {cell:?}, not a finite number")]
    Cell {
        /// The file.
        path: PathBuf,
        /// The line.
        line: u64,
        /// The column.
        column: String,
        /// Text of the cell.
        cell: String,
    },
}

impl Samples {
    /// Number of samples.
    pub fn rows(&self) -> usize {
        self.inputs.len() / self.input_width.max(1)
    }

    /// The inputs of a sample.
    pub fn input(&self, row: usize) -> &[f64] {
        &self.inputs[row * self.input_width..][..self.input_width]
    }

    /// The outputs of a sample.
    pub fn output(&self, row: usize) -> &[f64] {
        &self.outputs[row * self.output_width..][..self.output_width]
    }

    /// Reads columns of a CSV file; rows whose outputs are all empty are skipped.
    ///
    /// # Errors
    /// See [`SamplesError`].
    pub fn read<Name: AsRef<str>>(
        path: &Path,
        inputs: &[Name],
        outputs: &[Name],
    ) -> Result<Self, SamplesError> {
        let failed = |error| SamplesError::File {
            path: path.to_owned(),
            error,
        };
        let mut reader = csv::Reader::from_path(path).map_err(failed)?;
        let header = reader.headers().map_err(failed)?.clone();
        let find = |name: &Name| {
            let name = name.as_ref();
            let found = header.iter().position(|column| column == name);
            found.ok_or_else(|| SamplesError::Column {
                path: path.to_owned(),
                column: name.to_owned(),
                present: header.iter().collect::<Vec<_>>().join(", "),
            })
        };
        let inputs_at: Vec<usize> = inputs.iter().map(find).collect::<Result<_, _>>()?;
        let outputs_at: Vec<usize> = outputs.iter().map(find).collect::<Result<_, _>>()?;
        let mut samples = Self {
            input_width: inputs.len(),
            output_width: outputs.len(),
            ..Self::default()
        };
        let mut record = csv::StringRecord::new();
        while reader.read_record(&mut record).map_err(failed)? {
            if outputs_at.iter().all(|column| record[*column].is_empty()) {
                continue;
            }
            let number = |column: &usize| {
                let cell = &record[*column];
                finite::number(cell).ok_or_else(|| SamplesError::Cell {
                    path: path.to_owned(),
                    line: record.position().map_or(0, csv::Position::line),
                    column: header[*column].to_owned(),
                    cell: cell.to_owned(),
                })
            };
            for column in &inputs_at {
                samples.inputs.push(number(column)?);
            }
            for column in &outputs_at {
                samples.outputs.push(number(column)?);
            }
        }
        Ok(samples)
    }

    /// Reads the same columns of several files and concatenates them.
    ///
    /// # Errors
    /// See [`SamplesError`].
    pub fn read_all<Name: AsRef<str>>(
        paths: &[PathBuf],
        inputs: &[Name],
        outputs: &[Name],
    ) -> Result<Self, SamplesError> {
        let mut all = Self {
            input_width: inputs.len(),
            output_width: outputs.len(),
            ..Self::default()
        };
        for path in paths {
            let samples = Self::read(path, inputs, outputs)?;
            all.inputs.extend(samples.inputs);
            all.outputs.extend(samples.outputs);
        }
        Ok(all)
    }

    /// The samples of some rows.
    pub fn chosen(&self, rows: &[usize]) -> Self {
        Self {
            inputs: rows
                .iter()
                .flat_map(|row| self.input(*row))
                .copied()
                .collect(),
            outputs: rows
                .iter()
                .flat_map(|row| self.output(*row))
                .copied()
                .collect(),
            ..*self
        }
    }

    /// Random split into training samples and a held-out fraction.
    pub fn split(&self, held_back: f64, seed: u64) -> [Self; 2] {
        let mut rows: Vec<usize> = (0..self.rows()).collect();
        shuffle(&mut rows, &mut Pcg64::seed_from_u64(seed));
        let (held, kept) = rows.split_at((held_back * rows.len() as f64).round() as usize);
        [self.chosen(kept), self.chosen(held)]
    }
}

/// Shuffles items (Fisher and Yates).
pub fn shuffle<Item>(items: &mut [Item], random: &mut Pcg64) {
    for last in (1..items.len()).rev() {
        let other = (random.next_u64() % (last as u64 + 1)) as usize;
        items.swap(last, other);
    }
}
