//! Searches by bisection and golden section.

use super::{directory, outcome, succeed};
use std::fs;
use std::path::Path;

/// Ropes that hang from a clamp. The stiffer they are, the less bending energy they have.
const HANGING: &str = r#"
experiment = "scene"
material = { youngs_modulus = "1 MPa", poissons_ratio = 0.5, density = 1000.0 }
time = { mode = "static" }

[[rods]]
name = "rope"
radius = "5 mm"
edges = 8
shape = { kind = "straight", start = [0, 0, 0], end = [0.2, 0, 0] }

[[clamps]]
rod = "rope"
at = "start"

[[loads]]
kind = "gravity"
acceleration = [0, 0, -9.81]
"#;

fn column(table: &Path, name: &str) -> Vec<f64> {
    let mut reader = csv::Reader::from_path(table).unwrap();
    let place = reader
        .headers()
        .unwrap()
        .iter()
        .position(|header| header == name)
        .unwrap();
    reader
        .records()
        .map(|row| row.unwrap()[place].parse().unwrap())
        .collect()
}

#[test]
fn a_bisection_ends_within_its_tolerance_and_repeats_nothing() {
    let search = "[sweep]\nrods.rope.edges = [6, 8]\n[sweep.search]\nmethod = \"bisect\"\n\
                  parameter = \"material.youngs_modulus\"\nobjective = \"bending_energy_j\"\ntarget = 3e-3\n\
                  from = \"1 MPa\"\nto = \"10 MPa\"\ntolerance = \"0.1 MPa\"\n";
    let directory = directory(&format!("{HANGING}{search}"));
    let stdout = succeed(&directory, &["run", "swings.toml"]);
    let results = directory.path().join("results/swings");
    let table = results.join("search.csv");
    assert_eq!(column(&table, "rods.rope.edges"), [6.0, 8.0]);
    let [low, found, high] =
        ["from", "material.youngs_modulus", "to"].map(|name| column(&table, name));
    fs::write(directory.path().join("single.toml"), HANGING).unwrap();
    for (place, edges) in [6, 8].into_iter().enumerate() {
        assert!(low[place] < found[place] && found[place] < high[place]);
        assert!(high[place] - low[place] <= 0.1e6);
        // The energy passes its target between the ends of the last interval.
        let energy = |modulus: f64| {
            let modulus = format!("material.youngs_modulus={modulus}");
            let edges = format!("rods.rope.edges={edges}");
            let single = [
                "run",
                "single.toml",
                "--force",
                "--set",
                &modulus,
                "--set",
                &edges,
            ];
            succeed(&directory, &single);
            column(
                &directory.path().join("results/single/series.csv"),
                "bending_energy_j",
            )[0]
        };
        assert!(energy(low[place]) > 3e-3 && energy(high[place]) < 3e-3);
    }
    let summary = fs::read(results.join("summary.csv")).unwrap();
    assert_eq!(succeed(&directory, &["run", "swings.toml"]), stdout);
    assert_eq!(fs::read(results.join("summary.csv")).unwrap(), summary);
}

#[test]
fn a_golden_section_finds_the_least_outcome_inside_the_interval() {
    // The rope lies along x: without a load along z it does not bend.
    let search = "[sweep.search]\nmethod = \"golden\"\nparameter = \"loads.0.acceleration.2\"\n\
                  objective = \"bending_energy_j\"\nfrom = -4.0\nto = 6.0\ntolerance = 0.01\n";
    let directory = directory(&format!("{HANGING}{search}"));
    succeed(&directory, &["run", "swings.toml"]);
    let table = directory.path().join("results/swings/search.csv");
    let found = column(&table, "loads.0.acceleration.2")[0];
    assert!(found.abs() < 0.01, "{found}");
}

#[test]
fn searches_without_an_end_report_the_reason() {
    let search = |objective: &str, target: &str| {
        format!(
            "{HANGING}[sweep.search]\nmethod = \"bisect\"\nparameter = \"material.density\"\n\
             objective = \"{objective}\"\ntarget = {target}\nfrom = 900.0\nto = 1000.0\ntolerance = 1.0\n"
        )
    };
    let directory = directory(&search("bending_energy_j", "1e6"));
    let (code, stdout, _) = outcome(&directory, &["run", "swings.toml"]);
    assert_eq!(code, 3);
    assert!(
        stdout.contains("does not pass 1000000 between the ends"),
        "{stdout}"
    );
    fs::write(
        directory.path().join("swings.toml"),
        search("bending", "0.0"),
    )
    .unwrap();
    let (code, _, stderr) = outcome(&directory, &["run", "swings.toml", "--force"]);
    assert_eq!(code, 2);
    assert!(
        stderr.contains("no column `bending`") && stderr.contains("bending_energy_j"),
        "{stderr}"
    );
}
