//! `rodlab explain`: keys of scenario files; files of results directories and their columns.

use super::candidates::explained;
use super::prelude::*;
use rodlab_files::results::FileDescription;
use rodlab_lab::experiment::{self, Described, describe, described_files, files_with_column};
use rodlab_lab::scenario::did_you_mean;

/// Arguments of `rodlab explain`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rodlab explain time.step                  a key of scenario files
  rodlab explain rods.shape                 a table of keys
  rodlab explain series                     a file of results directories with its columns
  rodlab explain series.traction_start_n    one of its columns
  rodlab explain manifest.json")]
pub struct ExplainArguments {
    /// Dotted key, file of results directories or FILE.COLUMN; without it, all of them are listed
    #[arg(add = explained())]
    pub key: Option<String>,
}

/// Explains a key, a file or a column.
pub fn explain(arguments: &ExplainArguments) -> Result<(), Failure> {
    print(&explanation(arguments.key.as_deref().unwrap_or("")).map_err(Failure::Input)?)
}

fn explanation(key: &str) -> Result<String, String> {
    match describe(key) {
        Some(Described::File(files)) => Ok(file_in_words(&files)),
        Some(Described::Column(file, column)) => {
            Ok(column_in_words(file, column.name, column.meaning))
        }
        Some(Described::NoColumn(files, name)) => column_of_a_key(&files, name),
        None if key.is_empty() => Ok(experiment::explain(key)? + &files()),
        None => experiment::explain(key).or_else(|error| column_anywhere(key).ok_or(error)),
    }
}

/// Explains a varied key that is a column in a table of a sweep.
fn column_of_a_key(files: &[&FileDescription], name: &str) -> Result<String, String> {
    let file = files[0].names[0];
    let of_sweeps = ["summary.csv", "search.csv"].contains(&file);
    if of_sweeps
        && name.contains('.')
        && let Ok(words) = experiment::explain(name)
    {
        return Ok(words);
    }
    let columns = files.iter().flat_map(|file| file.columns());
    let columns: Vec<&str> = columns.map(|column| column.name).collect();
    let advice =
        did_you_mean(name, columns.iter().copied()).unwrap_or_else(|| match columns.is_empty() {
            true => "it is not a table".to_owned(),
            false => format!("it has: {}", columns.join(", ")),
        });
    Err(format!("`{file}` has no `{name}`; {advice}"))
}

/// Explains a column that was given without its file.
fn column_anywhere(name: &str) -> Option<String> {
    let words: String = files_with_column(name)
        .into_iter()
        .map(|(file, column)| column_in_words(file, column.name, column.meaning))
        .collect();
    (!words.is_empty()).then_some(words)
}

fn column_in_words(file: &FileDescription, name: &str, meaning: &str) -> String {
    format!("{}: {name}\n  {meaning}\n", file.names[0])
}

fn file_in_words(files: &[&FileDescription]) -> String {
    let mut text = format!("{}\n  {}\n", files[0].names.join(", "), files[0].meaning);
    let columns = files.iter().flat_map(|file| file.columns());
    let width = columns.map(|column| column.name.len()).max();
    let width = width.unwrap_or_default();
    for group in files.iter().flat_map(|file| file.groups) {
        // Writing to a string cannot fail.
        let _ = match group.when {
            "" => writeln!(text),
            when => writeln!(text, "\n  {when}:"),
        };
        for column in group.columns {
            let _ = writeln!(text, "  {:<width$}  {}", column.name, column.meaning);
        }
    }
    text
}

fn files() -> String {
    let mut names: Vec<&str> = Vec::new();
    for file in described_files() {
        if !names.contains(&file.names[0]) {
            names.push(file.names[0]);
        }
    }
    format!("results: {}\n", names.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rodlab_lab::experiment::json_schema;

    #[test]
    fn columns_and_files_are_explained() {
        insta::assert_snapshot!(explanation("series.traction_start_n").unwrap(), @r"
        series.csv: traction_start_n
          Force with which the first end is pulled outwards, N.
        ");
        insta::assert_snapshot!(explanation("rods.pvd").unwrap(), @r"
        rods.pvd
          The collection that ParaView opens ([output] vtk = true): the frames of vtk/ with their times.
        ");
        let timings = explanation("timings").unwrap();
        assert!(timings.starts_with("timings.csv\n") && timings.contains("\n  cpu_time_s "));
        let anywhere = explanation("time_s").unwrap();
        assert!(anywhere.contains("series.csv") && anywhere.contains("nodes.csv"));
    }

    #[test]
    fn varied_keys_are_columns_too_and_misspelt_ones_get_advice() {
        let key = explanation("contact.friction").unwrap();
        assert_eq!(explanation("summary.contact.friction"), Ok(key));
        let error = |key| explanation(key).unwrap_err();
        insta::assert_snapshot!(error("series.contact"), @"`series.csv` has no `contact`; did you mean `contacts`?");
        insta::assert_snapshot!(error("scenario.toml.x"), @"`scenario.toml` has no `x`; it is not a table");
        insta::assert_snapshot!(error("kontakt"), @"there is no key `kontakt` at the top of a scenario; did you mean `contact`?");
    }

    #[test]
    fn no_key_of_scenarios_is_hidden_by_a_file() {
        let schema = json_schema();
        for key in schema["properties"].as_object().unwrap().keys() {
            assert_eq!(describe(key), None, "{key}");
        }
    }
}
