//! A rodlab CSV file, read column by column.

use super::ResultsError;
use super::stream::read_whole_lines;
use crate::finite;
use std::path::Path;

/// A CSV file as text cells under named columns.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Table {
    columns: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// Reads a file; ignores a partial last row after a crash.
    ///
    /// # Errors
    /// [`ResultsError::Io`] if it cannot be read, [`ResultsError::Damaged`] if rows differ in
    /// length.
    pub fn read(path: &Path) -> Result<Self, ResultsError> {
        let bytes = read_whole_lines(path)?;
        let damaged = |error: csv::Error| ResultsError::Damaged {
            path: path.to_owned(),
            reason: error.to_string(),
        };
        let mut reader = csv::Reader::from_reader(bytes.as_slice());
        let cells = |record: &csv::StringRecord| record.iter().map(Into::into).collect();
        let columns = cells(reader.headers().map_err(damaged)?);
        let rows = reader
            .records()
            .map(|record| record.map(|record| cells(&record)))
            .collect::<Result<_, _>>()
            .map_err(damaged)?;
        Ok(Self { columns, rows })
    }

    /// Names of the columns.
    pub fn columns(&self) -> &[String] {
        &self.columns
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether the table has no rows.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The cells of a row.
    pub fn row(&self, row: usize) -> &[String] {
        &self.rows[row]
    }

    /// The cells of a column; `None` if there is no such column.
    pub fn column(&self, name: &str) -> Option<impl Iterator<Item = &str>> {
        let index = self.columns.iter().position(|column| column == name)?;
        Some(self.rows.iter().map(move |row| row[index].as_str()))
    }

    /// The numbers of a column; `None` if there is no such column. A cell that is not a number is
    /// `None`.
    pub fn numbers(&self, name: &str) -> Option<Vec<Option<f64>>> {
        Some(self.column(name)?.map(finite::number).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn columns_are_found_by_name_and_torn_rows_left_out() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("summary.csv");
        fs::write(&path, "case,force_n\na,1.5\nb,\nc,2").unwrap();
        let table = Table::read(&path).unwrap();
        assert_eq!(table.len(), 2);
        assert_eq!(table.numbers("force_n"), Some(vec![Some(1.5), None]));
        assert_eq!(
            table.column("case").unwrap().collect::<Vec<_>>(),
            ["a", "b"]
        );
        assert!(table.column("other").is_none());
        fs::write(&path, "a,b\n1\n").unwrap();
        let error = Table::read(&path).unwrap_err();
        assert!(matches!(error, ResultsError::Damaged { .. }), "{error}");
    }
}
