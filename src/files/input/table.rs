//! Columns of numbers in CSV files of programs and users.
//!
//! Fields are separated by commas, semicolons, tabs or blanks, as in the first line. A header
//! names the columns, with their units in any of the usual forms (`x`, `x_m`, `X [mm]`, `x (cm)`).
//! If the first line has numbers only, there is no header. If fields are not separated by commas,
//! a comma is a decimal comma. Empty lines and lines that begin with `#` are skipped.

/// Units of columns, with their values in SI units.
const UNITS: [(&str, f64); 10] = [
    ("m", 1.0),
    ("mm", 1e-3),
    ("cm", 1e-2),
    ("um", 1e-6),
    ("µm", 1e-6),
    ("μm", 1e-6),
    ("in", 0.0254),
    ("inch", 0.0254),
    ("s", 1.0),
    ("ms", 1e-3),
];

/// A CSV file.
#[derive(Clone, Debug)]
pub struct Table<'a> {
    text: &'a str,
    separator: char,
    has_decimal_commas: bool,
    /// Names of the columns as written; empty without a header.
    header: Option<Vec<String>>,
    /// Number of lines before the first row.
    skipped: usize,
    /// Fields of the first line.
    columns: usize,
}

/// A column of numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Column {
    /// Index of the column in a row, from 0.
    pub index: usize,
    /// The value of its unit in SI units.
    pub unit: f64,
}

impl<'a> Table<'a> {
    /// Reads the first line of a file.
    ///
    /// # Errors
    /// It is empty.
    pub fn new(text: &'a str) -> Result<Self, String> {
        let text = text.trim_start_matches('\u{feff}');
        let (index, first) = lines(text).next().ok_or("it is empty")?;
        let separator = separator_of(first);
        let mut table = Self {
            text,
            separator,
            has_decimal_commas: false,
            header: None,
            skipped: 0,
            columns: 0,
        };
        let fields = table.fields(first);
        table.columns = fields.len();
        table.has_decimal_commas = separator != ',';
        let is_number = |field: &String| table.number(field).is_some() || field.is_empty();
        if !fields.iter().all(is_number) {
            table.header = Some(fields);
            table.skipped = index + 1;
        }
        Ok(table)
    }

    /// The column with a name, given with or without its unit; without a header, the column at
    /// index `place`.
    pub fn column(&self, name: &str, place: usize) -> Option<Column> {
        let Some(header) = &self.header else {
            let there = place < self.columns;
            return there.then_some(Column {
                index: place,
                unit: 1.0,
            });
        };
        let mut found = header.iter().enumerate().filter_map(|(index, heading)| {
            let (bare, unit) = split_unit(heading);
            (bare == name).then_some(Column { index, unit })
        });
        found.next()
    }

    /// The header as written.
    pub fn header(&self) -> Option<&[String]> {
        self.header.as_deref()
    }

    /// The rows, each with the number of its line.
    pub fn rows(&self) -> impl Iterator<Item = (usize, Vec<String>)> + '_ {
        lines(self.text)
            .filter(|(index, _)| *index >= self.skipped)
            .map(|(index, line)| (index + 1, self.fields(line)))
    }

    /// Checks that a row has as many fields as the first line.
    ///
    /// # Errors
    /// A message, to be placed after the line number.
    pub fn check_length(&self, fields: &[String]) -> Result<(), String> {
        match fields.len() == self.columns {
            true => Ok(()),
            false => Err(format!(
                "expected {} columns, found {}",
                self.columns,
                fields.len()
            )),
        }
    }

    /// The finite number of a field, in SI units.
    pub fn value(&self, fields: &[String], column: Column) -> Option<f64> {
        let number = self.number(fields.get(column.index)?)?;
        Some(if column.unit == 1.0 {
            number
        } else {
            number * column.unit
        })
    }

    fn number(&self, field: &str) -> Option<f64> {
        let commas = field.matches(',').count();
        if self.has_decimal_commas && commas == 1 && !field.contains('.') {
            return finite(&field.replace(',', "."));
        }
        finite(field)
    }

    fn fields(&self, line: &str) -> Vec<String> {
        if self.separator == ' ' {
            return line.split_whitespace().map(unquoted).collect();
        }
        let mut in_quotes = false;
        let fields = line.split(|letter| {
            in_quotes ^= letter == '"';
            letter == self.separator && !in_quotes
        });
        let mut fields: Vec<String> = fields.map(unquoted).collect();
        // Spreadsheets end lines with a separator.
        if self.separator == ';' && fields.len() > 1 && fields.last().is_some_and(String::is_empty)
        {
            fields.pop();
        }
        fields
    }
}

/// Non-empty lines that are not comments, with their index. They end with a line feed, or with a
/// carriage return in files without line feeds.
fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let end = if text.contains('\n') { '\n' } else { '\r' };
    let lines = text.split(end).map(str::trim).enumerate();
    lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'))
}

/// A finite number.
fn finite(field: &str) -> Option<f64> {
    field
        .trim()
        .parse()
        .ok()
        .filter(|number: &f64| number.is_finite())
}

fn unquoted(field: &str) -> String {
    field.trim().trim_matches('"').trim().to_owned()
}

/// The separator of the fields of a line.
fn separator_of(line: &str) -> char {
    for separator in [';', '\t', ','] {
        if line.contains(separator) {
            return separator;
        }
    }
    let is_number = |field: &str| finite(field).is_some();
    let fields = || line.split_whitespace();
    let are_names = fields().all(|field| {
        field
            .chars()
            .all(|letter| letter.is_alphanumeric() || letter == '_')
    });
    match fields().count() > 1 && (fields().all(is_number) || are_names) {
        true => ' ',
        false => ',',
    }
}

/// The name of a heading in lower case without its unit, and the unit; an unknown unit is part of
/// the name.
fn split_unit(heading: &str) -> (String, f64) {
    let heading = heading.to_lowercase();
    let split = heading.rsplit_once(['[', '(', '/', '_', ' ']);
    if let Some((name, unit)) = split {
        let unit = unit.trim_end_matches([']', ')']).trim();
        if let Some((_, value)) = UNITS.iter().find(|(known, _)| *known == unit) {
            let name = name.trim_end_matches(['[', '(', '/', '_', ' ']);
            return (name.to_owned(), *value);
        }
    }
    (heading, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn points(text: &str) -> Option<Vec<[f64; 2]>> {
        let table = Table::new(text).ok()?;
        let [x, y] = [table.column("x", 0)?, table.column("y", 1)?];
        let rows = table
            .rows()
            .map(|(_, row)| Some([table.value(&row, x)?, table.value(&row, y)?]));
        rows.collect()
    }

    #[test]
    fn files_of_many_programs_are_read() {
        let expected = [[1.5, 2.0], [3.0, -0.25]];
        for text in [
            "x,y\n1.5,2\n3,-0.25\n",
            "x_m,y_m\n1.5,2\n3,-0.25",
            "x_mm,y_mm\n1500,2000\n3000,-250\n",
            "X [mm];Y [mm]\n1500;2000\n3000;-250\n",
            "x (cm)\ty (cm)\n150\t200\n300\t-25\n",
            "\u{feff}# made by hand\r\n\r\n\"X (mm)\",\"Y (mm)\"\r\n1500,2000\r\n3000,-250\r\n",
            "x;y\n1,5;2\n3;-0,25\n",
            "x;y;\n1,5;2;\n3;-0,25;\n",
            "1.5,2\n3,-0.25\n",
            "1.5 2\n3 -0.25\n",
            "1,5\t2\n3\t-2,5e-1\n",
            "x y\n1.5 2\n3 -0.25\n",
            "name,y/mm,x/mm\na,2000,1500\nb,-250,3000\n",
            "x,y\r1.5,2\r3,-0.25\r",
        ] {
            let found = points(text).unwrap_or_else(|| panic!("{text}"));
            let near = found.iter().zip(&expected).all(|(found, expected)| {
                found
                    .iter()
                    .zip(expected)
                    .all(|(found, expected)| (found - expected).abs() < 1e-15)
            });
            assert!(near && found.len() == 2, "{text}: {found:?}");
        }
    }

    #[test]
    fn ambiguous_numbers_are_rejected_with_their_line() {
        assert_eq!(points("x;y\n1,5,0;2\n"), None);
        assert_eq!(points("x;y\n1.000,5;2\n"), None);
        assert_eq!(points("a,b\n1,2\n"), None);
        assert!(Table::new("# nothing\n\n").is_err());
        let table = Table::new("# c\r\nx,y\r\n\r\n1,2\r\n3\r\n").unwrap();
        let rows: Vec<_> = table.rows().collect();
        assert_eq!(rows[0].0, 4);
        assert!(table.check_length(&rows[0].1).is_ok() && table.check_length(&rows[1].1).is_err());
    }

    proptest! {
        #[test]
        fn any_text_is_read_or_refused(text in "\\PC{0,60}", lines in "[-xy_m0-9.,;\t \r\n\"\\[\\]]{0,80}") {
            let _ = points(&text);
            let _ = points(&lines);
        }
    }
}
