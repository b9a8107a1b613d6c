//! Resolves starts from the end of another run. The file is read and identified by its hash.

use super::Section;
use crate::scenario::input_file::{self, LARGEST_TABLE};
use crate::scenario::resolved::Start;
use crate::scenario::typed;
use std::path::{Path, PathBuf};

/// File name of the state in a results directory.
pub const END_STATE: &str = "end_state.csv";
/// File name of the manifest in a results directory.
const MANIFEST: &str = "manifest.json";
/// File name of the copy beside a resolved scenario.
pub const COPY: &str = "start_state.csv";

/// The file that `from` names: a file itself, or the state in a results directory.
pub fn file_of(from: &Path) -> PathBuf {
    if from.is_dir() {
        from.join(END_STATE)
    } else {
        from.to_owned()
    }
}

/// Resolves the table; `None` if it is missing or faulty.
pub fn start(top: &Section<'_>, typed: Option<&typed::Start>) -> Option<Start> {
    let typed = typed?;
    let section = top.below("start");
    let help = "a results directory, such as \"results/hang\"";
    let from = section.needed("from", typed.from.as_ref(), help)?;
    let place = section.path_of("from", from);
    let file = file_of(&place);
    if place.is_dir() && !file.exists() {
        let message = format!(
            "{} holds no end state ({END_STATE}): the run there is not finished, is not a single dynamic or static run, or was made by an earlier version",
            place.display()
        );
        section.fault("from", message);
        return None;
    }
    let contents = match input_file::read(&file, LARGEST_TABLE) {
        Ok(contents) => contents,
        Err(message) => {
            section.fault("from", message);
            return None;
        }
    };
    let hash = blake3::hash(&contents).to_hex().to_string();
    if let Some(expected) = typed.hash.as_ref().filter(|expected| **expected != hash) {
        let message = format!(
            "{} is not the expected state: its hash is {hash}, not {expected}",
            file.display()
        );
        section.fault("hash", message);
        return None;
    }
    if let Err(message) = check_mark(&file, &hash) {
        section.fault("from", message);
        return None;
    }
    Some(Start {
        from: COPY,
        velocities: typed.velocities.unwrap_or(true),
        hash,
        contents: contents.into(),
    })
}

/// Compares a state with the hash in the manifest beside it. If the manifest has no hash, as in
/// earlier versions, the file is accepted with a warning.
fn check_mark(file: &Path, hash: &str) -> Result<(), String> {
    let (Some(directory), Some(name)) = (file.parent(), file.file_name()) else {
        return Ok(());
    };
    let manifest = directory.join(MANIFEST);
    if !manifest.is_file() {
        return Ok(());
    }
    let manifest: serde_json::Value =
        serde_json::from_slice(&input_file::read(&manifest, LARGEST_TABLE)?)
            .map_err(|error| format!("{} is damaged: {error}", manifest.display()))?;
    let mark = &manifest["files"][&*name.to_string_lossy()]["blake3"];
    match mark.as_str() {
        Some(mark) if mark == hash => Ok(()),
        Some(_) => Err(format!(
            "{} is not the state that the run wrote; restore the file, or run again",
            file.display()
        )),
        None => {
            tracing::warn!(
                "{} has no hash in manifest.json, as in results of earlier versions: changes to it cannot be detected",
                file.display()
            );
            Ok(())
        }
    }
}
