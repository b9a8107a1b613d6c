//! The cell of a task: from a file, or a preset that is simulated in this process.

use super::live_page::LiveArguments;
use super::prelude::*;
use super::preset_file::preset_file;
use rodlab_workcell::cell::Cell;
use rodlab_workcell::task::{Report, Unfinished};
use rodlab_workcell::virtual_cell::{Settings, with_cell};
use std::io::{IsTerminal, Write as _};

/// Choice of the cell, and whether its arms move without confirmation.
#[derive(Clone, Debug, Args)]
pub struct CellChoice {
    /// Cell file of real arms or a served cell [default: simulated]
    ///
    /// By default a preset cell is simulated in this process, at full speed.
    #[arg(long, value_name = "FILE", value_parser = file_or_preset(PresetKind::Cell), add = presets(PresetKind::Cell))]
    pub cell: Option<PathBuf>,
    /// Slow all motions down to this fraction of their speed
    #[arg(long, hide_short_help = true, value_name = "FRACTION", default_value_t = 1.0, value_parser = within(0.01, 1.0))]
    pub speed_scale: f64,
    #[command(flatten)]
    pub live: LiveArguments,
    /// Move the arms of --cell without asking first
    #[arg(long)]
    pub yes: bool,
    /// Print the record as JSON, also on a terminal
    #[arg(long)]
    pub json: bool,
}

/// The cell of a task.
pub struct TaskCell {
    /// Cell as defined by its file.
    pub cell: Cell,
    /// File of the cell.
    pub file: PathBuf,
    /// Whether the cell is simulated in this process.
    pub is_virtual: bool,
}

impl CellChoice {
    /// Prints the report of a task: a short table on a terminal; its record as JSON elsewhere and
    /// with --json.
    pub fn print(
        &self,
        report: &Report,
        record: &impl Serialize,
        directory: &Path,
    ) -> Result<(), Failure> {
        if self.json || !std::io::stdout().is_terminal() {
            return print_json(record);
        }
        print(&report.table())?;
        print_paths(&["report.html", "cell.html"].map(|name| directory.join(name)))
    }

    /// Reads the cell, or the preset if no cell is given. The preset is simulated, except in a
    /// `dry_run`.
    pub fn read(&self, preset: &str, dry_run: bool) -> Result<TaskCell, Failure> {
        let file = self.cell.clone();
        let file = file.map_or_else(|| preset_file(PresetKind::Cell, preset), Ok)?;
        let is_virtual = self.cell.is_none() && !dry_run;
        let cell = Cell::read(&file)?;
        let can_ask = self.yes || std::io::stdin().is_terminal();
        if !(dry_run || is_virtual || can_ask) {
            return Err(Failure::Input(
                "--yes is required: the arms of --cell will move, and standard input is not a terminal for confirmation".into(),
            ));
        }
        if is_virtual {
            tracing::warn!("no --cell: the virtual cell `{preset}` is simulated at full speed");
        }
        Ok(TaskCell {
            cell,
            file,
            is_virtual,
        })
    }
}

impl TaskCell {
    /// Rejects arms whose last task did not finish, unless --checked states that they were
    /// inspected, and arms without the parts that the task needs. `camera` is the purpose of the
    /// camera. The arms of a simulated cell are always ready.
    pub fn refuse_unready(
        &self,
        arms: &[usize],
        is_checked: bool,
        camera: Option<&str>,
    ) -> Result<(), Failure> {
        if self.is_virtual {
            return Ok(());
        }
        for arm in arms {
            let left = Unfinished::of(&self.cell, *arm, Path::new("")).left();
            if let Some(left) = left.filter(|_| !is_checked) {
                return Err(Failure::Input(format!(
                    "the last task with arm {} did not finish ({left}): inspect the arm and its gripper, then pass --checked",
                    self.cell.arms[*arm].name
                )));
            }
            let missing = camera.and_then(|camera| missing_part(&self.cell, *arm, camera));
            if let Some(what) = missing {
                return Err(Failure::Input(format!("{}: {what}", self.file.display())));
            }
        }
        Ok(())
    }

    /// Shows the report of the plan and asks on the terminal whether real arms may move, unless
    /// --yes is given.
    ///
    /// # Errors
    /// The user answers no.
    pub fn confirm(
        &self,
        arms: &[usize],
        report: &Report,
        directory: &Path,
        choice: &CellChoice,
    ) -> Result<(), Failure> {
        if self.is_virtual || choice.yes {
            return Ok(());
        }
        let names = arms.iter().map(|arm| self.cell.arms[*arm].name.as_str());
        let names = names.collect::<Vec<_>>().join(" and ");
        let page = directory.join("cell.html");
        let question = format!(
            "{}: {names} will move as {} shows",
            self.cell.title,
            page.display()
        );
        let table = report.table();
        let answer = asked(&format!("{table}\n{question}. Move? [y/N] "));
        match answer.map_err(Failure::system)?.trim() {
            "y" | "yes" => Ok(()),
            _ => Err(Failure::interrupted(format!(
                "nothing moved; the plan is in {}",
                directory.display()
            ))),
        }
    }

    /// Carries out work in the cell. `settings` define its contents if it is simulated.
    pub fn work<T>(
        &self,
        settings: Settings,
        work: impl FnOnce(&Cell) -> Result<T, Failure>,
    ) -> Result<T, Failure> {
        if !self.is_virtual {
            return work(&self.cell);
        }
        let (done, _) = with_cell(&self.cell, settings, work)?;
        done
    }
}

/// The answer of the user to a question on the terminal, in lower case; empty at the end of the
/// input.
pub fn asked(question: &str) -> std::io::Result<String> {
    let mut stderr = std::io::stderr();
    stderr.write_all(question.as_bytes())?;
    stderr.flush()?;
    let mut answer = String::new();
    std::io::stdin().read_line(&mut answer)?;
    Ok(answer.to_ascii_lowercase())
}

/// Message about a part that a task with an arm needs and that the cell file lacks. `camera` is
/// the purpose of the camera.
fn missing_part(cell: &Cell, arm: usize, camera: &str) -> Option<String> {
    let known = &cell.arms[arm];
    let name = &known.name;
    let seen = cell.camera.as_ref();
    if seen.is_none_or(|seen| seen.source.is_none()) {
        return Some(format!("a [camera] with a `source` is needed: {camera}"));
    }
    if known.driver.is_none() {
        return Some(format!("arm {name} needs a `driver`"));
    }
    if cell.gripper(arm).is_none() {
        let needed =
            "needs a `gripper`, and a driver of kind \"rosbridge\", \"ros1\" or \"ros2\" for it";
        return Some(format!("arm {name} {needed}"));
    }
    None
}
