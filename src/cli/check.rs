//! `rodlab check`.

use super::candidates::keys;
use super::prelude::*;
use super::preset_file::scenario_or_cell;
use super::run::prepare;
use rodlab_lab::experiment::{DerivedNumbers, case_set, derived_numbers, try_scene};
use rodlab_lab::run::{Forecast, forecast};
use rodlab_lab::scenario::Copied;
use rodlab_lab::sweep::check_every_value;
use rodlab_workcell::cell::{Cell, CellReport};

/// Arguments of `rodlab check`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rodlab check scenarios/*.toml
  rodlab check beam.toml --set rods.beam.radius=\"7 mm\" --json
  rodlab check scenarios/cells/*.toml            robot cells: files with [[arms]] or [[axes]]")]
pub struct CheckArguments {
    /// The scenario files
    #[arg(required = true, value_parser = scenario_or_cell(), add = presets(PresetKind::Scenario))]
    pub scenarios: Vec<PathBuf>,
    /// Set a key of each scenario; repeatable
    #[arg(long = "set", value_name = "KEY=VALUE", add = keys("="))]
    pub overrides: Vec<String>,
    /// Print the numbers as JSON, an object per file
    #[arg(long)]
    pub json: bool,
}

/// Checks all scenarios, even if the first has errors.
pub fn check(arguments: &CheckArguments, common: &Common) -> Result<(), Failure> {
    let mut last: Option<Failure> = None;
    for path in &arguments.scenarios {
        let checked = match is_cell(path) {
            true => check_cell(path, arguments.json),
            false => check_scenario(path, arguments),
        };
        if let Err(failure) = checked
            && let Some(earlier) = last.replace(failure)
        {
            earlier.report(common.colours_stderr());
        }
    }
    last.map_or(Ok(()), Err)
}

/// Tables that only cell files have. A file that extends a cell has none of its arms itself.
const OF_CELLS: [&str; 7] = [
    "[[arms]]",
    "[[axes]]",
    "[table]",
    "[camera]",
    "[chuck]",
    "[safety]",
    "[streaming]",
];

/// Whether a file describes a robot cell.
fn is_cell(path: &Path) -> bool {
    // Files that cannot be read are reported by the reader of scenarios.
    let bytes = rodlab_lab::scenario::read_text_file(path).unwrap_or_default();
    let text = String::from_utf8_lossy(&bytes);
    let mut lines = text.lines().map(str::trim_start);
    lines.any(|line| OF_CELLS.iter().any(|table| line.starts_with(table)))
}

fn check_cell(path: &Path, json: bool) -> Result<(), Failure> {
    let report = CellReport::new(&Cell::read(path)?);
    print(&match json {
        true => format!("{}\n", report.to_json()),
        false => format!("{}: valid\n{report}", path.display()),
    })
}

fn check_scenario(path: &Path, arguments: &CheckArguments) -> Result<(), Failure> {
    let checked = check_one(path, &arguments.overrides)?;
    if arguments.json {
        return print(&format!("{}\n", checked.to_json()));
    }
    print(&format!(
        "{}: {}\n{}{}{}  {:<26}{}\n",
        path.display(),
        checked.in_words(),
        checked.copies_in_lines(),
        checked.numbers,
        checked.notes_in_lines(),
        "processor time",
        checked.forecast
    ))
}

/// Derived numbers of a scenario; for a sweep, those of its first case.
struct Checked {
    cases: u128,
    numbers: DerivedNumbers,
    forecast: Forecast,
    /// Simplifications of the scene, one sentence each.
    notes: Vec<String>,
    /// Arrays that contain copies.
    copied: Vec<Copied>,
}

impl Checked {
    fn to_json(&self) -> serde_json::Value {
        let mut json = self.numbers.to_json();
        if !self.notes.is_empty() {
            json["notes"] = self.notes.clone().into();
        }
        if !self.copied.is_empty() {
            json["copies"] = serde_json::to_value(&self.copied).expect("numbers are JSON values");
        }
        json["cost"] = serde_json::to_value(&self.forecast).expect("numbers are JSON values");
        json
    }

    fn copies_in_lines(&self) -> String {
        let line = |copied: &Copied| {
            let plural = if copied.written == 1 { "" } else { "s" };
            format!(
                "  {:<26}{} after expansion, from {} table{plural}\n",
                copied.key, copied.expanded, copied.written
            )
        };
        self.copied.iter().map(line).collect()
    }

    fn notes_in_lines(&self) -> String {
        let notes = self.notes.iter();
        notes
            .map(|note| format!("  {:<26}{note}\n", "note"))
            .collect()
    }

    fn in_words(&self) -> String {
        match self.cases {
            1 => "valid".to_owned(),
            cases => format!("valid, {cases} cases; the first:"),
        }
    }
}

fn check_one(path: &Path, overrides: &[String]) -> Result<Checked, Failure> {
    let case_set = case_set(path, overrides, &[])?;
    let prepared = if case_set.is_sweep() {
        check_every_value(&case_set)?
    } else {
        prepare(&case_set)?
    };
    let notes = try_scene(&prepared)?;
    let first = match case_set.search() {
        Some(search) => case_set.searched_scenario(0, search.from)?,
        None => case_set.scenario_of(0)?,
    };
    Ok(Checked {
        copied: first.copied(),
        cases: case_set.count(),
        numbers: derived_numbers(&prepared),
        forecast: forecast(&prepared),
        notes,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_extends_a_cell_is_a_cell() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("lab.toml");
        for (text, expected) in [
            (
                "extends = \"gantry.toml\"\n[safety]\nhand_speed = 0.2\n",
                true,
            ),
            ("[[arms]]\nname = \"a\"\n", true),
            (
                "experiment = \"scene\"\n[contact]\nmodel = \"imc\"\n",
                false,
            ),
        ] {
            std::fs::write(&path, text).unwrap();
            assert_eq!(is_cell(&path), expected, "{text}");
        }
    }
}
