//! What the tests of the virtual cell share.

use crate::cell::Cell;
use std::path::{Path, PathBuf};

/// The gantry that comes with the program.
pub fn gantry() -> Cell {
    cell("gantry")
}

/// A cell that comes with the program.
pub fn cell(name: &str) -> Cell {
    let file = format!("scenarios/cells/{name}.toml");
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join(file);
    Cell::read(&path).unwrap_or_else(|error| panic!("{error}"))
}

/// A file of a short and coarse rod, in a folder that it keeps.
pub fn short_rod() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rod.toml");
    let text = "[deployment.rod]\ngravito_bending_length = \"3 cm\"\nradius = \"2 mm\"\nlength = \"30 cm\"\nedges = 30\n";
    std::fs::write(&path, text).unwrap();
    (folder, path)
}
