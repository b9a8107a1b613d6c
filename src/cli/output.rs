//! Writing to standard output.

use super::failure::Failure;
use super::terminal::printable;
use rodlab_files::figure::{is_page, is_picture};
use rodlab_files::results::replace_own;
use serde::Serialize;
use std::borrow::Cow;
use std::io::{ErrorKind, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Standard output of a command that another program has called.
static COLLECTED: Mutex<Option<String>> = Mutex::new(None);

/// Collects what `work` prints. Only one call runs at a time.
pub fn collect<T>(work: impl FnOnce() -> T) -> (T, String) {
    static TURN: Mutex<()> = Mutex::new(());
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let collected = || COLLECTED.lock().unwrap_or_else(PoisonError::into_inner);
    *collected() = Some(String::new());
    let result = work();
    let text = collected().take();
    (result, text.unwrap_or_default())
}

/// Writes text to standard output. For a terminal, control characters are replaced, see
/// [`printable`]. A reader that closes the pipe, such as `head`, causes no error.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut collected = COLLECTED.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(collected) = collected.as_mut() {
        *collected += text;
        return Ok(());
    }
    drop(collected);
    let mut stdout = std::io::stdout().lock();
    let text = match stdout.is_terminal() {
        true => Cow::Owned(printable(text)),
        false => Cow::Borrowed(text),
    };
    match stdout
        .write_all(text.as_bytes())
        .and_then(|()| stdout.flush())
    {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Failure::System(format!(
            "standard output cannot be written: {error}"
        ))),
        _ => Ok(()),
    }
}

/// Writes the paths of files to standard output, one per line.
pub fn print_paths(paths: &[PathBuf]) -> Result<(), Failure> {
    let lines = paths.iter().map(|path| format!("{}\n", path.display()));
    print(&lines.collect::<String>())
}

/// Writes a value to standard output as JSON, with one line per key.
pub fn print_json(value: &impl Serialize) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(value).map_err(|error| {
        Failure::System(format!("the answer cannot be written as JSON: {error}"))
    })?;
    print(&(text + "\n"))
}

/// Writes a file to a path that the user chose. Only a file of the same kind is replaced.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    Ok(replace_own(path, bytes, |head| are_alike(head, bytes))?)
}

/// Creates a directory unless it exists.
pub fn make_directory(path: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(path)
        .map_err(|error| Failure::System(format!("{} cannot be made: {error}", path.display())))
}

/// Writes files into a directory, which is created if it does not exist, see [`write_file`].
pub fn write_files(directory: &Path, files: Vec<(&str, Vec<u8>)>) -> Result<(), Failure> {
    std::fs::create_dir_all(directory).map_err(|error| {
        Failure::System(format!("{}: cannot be made: {error}", directory.display()))
    })?;
    for (name, bytes) in files {
        write_file(&directory.join(name), &bytes)?;
    }
    Ok(())
}

/// Whether two files seem to be of the same kind: both are pictures, both are pages, or both are
/// texts whose first lines without comments, such as the header of a table, are equal.
fn are_alike(one: &[u8], other: &[u8]) -> bool {
    let kinds: [fn(&[u8]) -> bool; 2] = [is_picture, is_page];
    kinds.iter().any(|is_kind| is_kind(one) && is_kind(other))
        || first_line(one).is_some_and(|line| first_line(other) == Some(line))
}

fn first_line(text: &[u8]) -> Option<&[u8]> {
    text.split(|byte| *byte == b'\n')
        .map(<[u8]>::trim_ascii)
        .find(|line| !line.is_empty() && !line.starts_with(b"#"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_another_kind_are_not_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path().join("answer");
        let files = [
            "s_m,x_m,y_m\n0,0,0\n",
            "# reprojection 0.04 px\n[camera]\nwidth = 640\n",
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"8\"></svg>",
            "{\n  \"poses\": []\n}\n",
        ];
        for (k, old) in files.iter().enumerate() {
            for (l, new) in files.iter().enumerate() {
                std::fs::write(&place, old).unwrap();
                let new = new.replace('0', "1").replace("width=\"8\"", "width=\"9\"");
                assert_eq!(write_file(&place, new.as_bytes()).is_ok(), k == l);
                let kept = if k == l { new.as_str() } else { old };
                assert_eq!(std::fs::read_to_string(&place).unwrap(), kept);
            }
        }
        std::fs::write(&place, "").unwrap();
        write_file(&place, files[0].as_bytes()).unwrap();
        assert!(write_file(folder.path(), files[0].as_bytes()).is_err());
    }
}
