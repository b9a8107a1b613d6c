//! Shared helpers of tests: cells that come with the program, and rods for them.

use crate::cell::Cell;
use crate::virtual_cell::{RodSupply, Settings};
use std::path::{Path, PathBuf};

/// A file of the repository.
pub fn file(name: &str) -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join(name)
}

/// A cell that comes with the program.
pub fn cell(name: &str) -> Cell {
    let path = file(&format!("scenarios/cells/{name}.toml"));
    Cell::read(&path).unwrap_or_else(|error| panic!("{error}"))
}

/// The gantry that comes with the program.
pub fn gantry() -> Cell {
    cell("gantry")
}

/// Short and coarse rods.
pub fn short_rods() -> RodSupply {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rod.toml");
    let text = "[deployment.rod]\ngravito_bending_length = \"3 cm\"\nradius = \"2 mm\"\nlength = \"30 cm\"\nedges = 30\n";
    std::fs::write(&path, text).unwrap();
    RodSupply::new(&path, 0.4).unwrap()
}

/// Settings of a virtual cell without objects, on a free port.
pub fn settings() -> Settings {
    Settings::empty(1.0)
}
