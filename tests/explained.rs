//! `rodlab explain` describes every file and every column that the program writes.

use assert_cmd::Command;
use rodlab::experiment::{Described, describe};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// Short runs that together write everything that a results directory may contain.
const COMMANDS: [&str; 13] = [
    "run scenarios/heavy_cantilever.toml --set output.forces=true --set output.vtk=true",
    "run scenarios/flagella_quick.toml --set time.end=0.01 --set output.forces=true --set output.vtk=true",
    "run scenarios/trefoil.toml --set time.end=0.02 --set knot.settling_time=0 --set output.interval=0.01",
    "run scenarios/reef.toml --set time.end=0.02 --set knot.settling_time=0 --set output.interval=0.01",
    "run scenarios/inversion_n3.toml --set time.end=0.02 --set knot.settling_time=0 --set output.interval=0.01",
    "run scenarios/euler_column.toml",
    "run scenarios/helix_boundary.toml --set helix_stability.directions.count=60 --set helix_stability.section_directions=9",
    "run scenarios/cantilever_sweep.toml",
    "run scenarios/cantilever_search.toml",
    "run scenarios/flagella_m2.toml --timeout 1s --set time.end=100",
    "plot results/heavy_cantilever --y bending_energy_j",
    "plot results/flagella_quick --y bending_energy_j",
    "gather results/cantilever_sweep",
];

/// Files and columns below a results directory that `rodlab explain` does not describe.
fn unexplained(directory: &Path, found: &mut BTreeSet<String>, seen: &mut usize) {
    for entry in fs::read_dir(directory).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        *seen += 1;
        if !matches!(describe(&name), Some(Described::File(_))) {
            found.insert(name.clone());
        }
        match name.as_str() {
            // Each case has a folder with the same files.
            "cases" => fs::read_dir(&path).unwrap().for_each(|case| {
                unexplained(&case.unwrap().path(), found, seen);
            }),
            "manifest.json" => {
                let text = fs::read_to_string(&path).unwrap();
                let manifest: serde_json::Value = serde_json::from_str(&text).unwrap();
                let keys = manifest.as_object().unwrap().keys().cloned();
                columns(&name, keys, found);
            }
            "summary.csv" | "search.csv" => {
                // Varied keys are columns, too; they contain a dot, or are top-level keys.
                let header = header(&path);
                columns(&name, header.filter(|column| !column.contains('.')), found);
            }
            name if name.ends_with(".csv") => columns(name, header(&path), found),
            _ => {}
        }
    }
}

fn header(path: &Path) -> impl Iterator<Item = String> {
    let text = fs::read_to_string(path).unwrap();
    let header = text.lines().next().unwrap_or_default().to_owned();
    header
        .split(',')
        .filter(|column| !column.is_empty())
        .map(str::to_owned)
        .collect::<Vec<_>>()
        .into_iter()
}

fn columns(file: &str, names: impl Iterator<Item = String>, found: &mut BTreeSet<String>) {
    for name in names {
        let key = format!("{file}.{name}");
        if !matches!(describe(&key), Some(Described::Column(..))) {
            found.insert(key);
        }
    }
}

#[test]
fn every_file_and_column_is_explained() {
    let folder = tempfile::tempdir().unwrap();
    let scenarios = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    fs::create_dir(folder.path().join("scenarios")).unwrap();
    for entry in fs::read_dir(scenarios).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_owned();
        if path.is_dir() {
            continue;
        }
        fs::copy(&path, folder.path().join("scenarios").join(name)).unwrap();
    }
    let rodlab = |arguments: &str| {
        let output = Command::new(env!("CARGO_BIN_EXE_rodlab"))
            .current_dir(folder.path())
            .args(arguments.split(' '))
            .output()
            .unwrap();
        let code = output.status.code();
        // Exit code 5: stopped by --timeout, so that there are checkpoints.
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(matches!(code, Some(0 | 5)), "{arguments}: {errors}");
    };
    COMMANDS.iter().for_each(|arguments| rodlab(arguments));
    let (mut found, mut seen) = (BTreeSet::new(), 0);
    for entry in fs::read_dir(folder.path().join("results")).unwrap() {
        let directory = entry.unwrap().path();
        let results = directory.display().to_string();
        rodlab(&format!("plot {results}"));
        if directory.join("nodes.csv").exists() {
            rodlab(&format!("view {results}"));
        }
        unexplained(&directory, &mut found, &mut seen);
    }
    assert!(found.is_empty(), "without an explanation: {found:#?}");
    assert!(seen > 100, "{seen}");
}
