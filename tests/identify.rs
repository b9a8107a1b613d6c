//! `rodlab identify` on the command line: a stiffness from a force and a shape, and bad data.

use super::probes::BEAM;
use assert_cmd::Command;
use std::fs;
use std::path::Path;

fn rodlab(directory: &Path, arguments: &[&str]) -> (i32, String, String) {
    let mut command = Command::cargo_bin("rodlab").unwrap();
    let output = command.current_dir(directory).args(arguments).output();
    let output = output.unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (
        output.status.code().unwrap(),
        text(output.stdout),
        text(output.stderr),
    )
}

/// A folder with the scenario, and the positions of the nodes 5, 10, 15 and 20 in equilibrium as
/// data.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let nodes = format!("{BEAM}[output]\nnodes = true\n");
    fs::write(path.join("beam.toml"), nodes).unwrap();
    let (code, _, error) = rodlab(path, &["run", "beam.toml"]);
    assert_eq!(code, 0, "{error}");
    let table = fs::read_to_string(path.join("results/beam/nodes.csv")).unwrap();
    let mut data = "node,x_m,z_m\n".to_owned();
    for line in table.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        if ["5", "10", "15", "20"].contains(&cells[2]) {
            data += &format!("{},{},{}\n", cells[2], cells[3], cells[5]);
        }
    }
    fs::write(path.join("shape.csv"), data).unwrap();
    fs::write(path.join("weight.csv"), "root_force_z_n\n0.147931\n").unwrap();
    folder
}

#[test]
fn a_stiffness_and_a_density_are_found_from_a_shape_and_a_force() {
    let folder = folder();
    let path = folder.path();
    let keys = "material.youngs_modulus,material.density";
    let start = [
        "--set",
        "material.youngs_modulus=2e7",
        "--set",
        "material.density=1500",
    ];
    let shape = [
        "identify",
        "beam.toml",
        "--data",
        "shape.csv",
        "--fit",
        keys,
        "--noise",
        "position=1e-4",
    ];
    let (code, text, error) = rodlab(path, &[&shape[..], &start].concat());
    assert_eq!(code, 0, "{error}");
    assert!(
        text.contains("one by one") && text.contains("weigh the rod"),
        "{text}"
    );
    let both = [
        "identify",
        "beam.toml",
        "--data",
        "shape.csv,weight.csv",
        "--fit",
        keys,
    ];
    let noise = [
        "--noise",
        "position=1e-4",
        "--noise",
        "root_force_z_n=1e-3",
        "--out",
        "both",
        "--json",
    ];
    let (code, text, error) = rodlab(path, &[&both[..], &noise, &start].concat());
    assert_eq!(code, 0, "{error}");
    let answer: serde_json::Value = serde_json::from_str(&text).unwrap();
    for (index, truth) in [1e7, 1000.0].into_iter().enumerate() {
        let value = answer["parameters"][index]["value"].as_f64().unwrap();
        assert!((value / truth - 1.0).abs() < 1e-3, "{text}");
    }
    for name in [
        "identified.json",
        "parameters.csv",
        "residuals.csv",
        "residuals.svg",
        "fitted.toml",
        "rod.toml",
    ] {
        assert!(path.join("both").join(name).is_file(), "{name}");
    }
    assert_eq!(
        rodlab(path, &["run", "both/fitted.toml", "--out", "again"]).0,
        0
    );
}

#[test]
fn bad_data_end_with_code_2_and_name_file_and_line() {
    let folder = folder();
    let path = folder.path();
    fs::write(path.join("bad.csv"), "node,x_m\n5,0.1\n21,nan\n").unwrap();
    fs::write(path.join("far.csv"), "node,x_m\n5,0.1\n21,0.2\n").unwrap();
    fs::create_dir(path.join("full")).unwrap();
    fs::write(path.join("full/mine.txt"), "").unwrap();
    let fit = ["--fit", "material.density"];
    for (arguments, expected) in [
        (
            &["--data", "bad.csv"] as &[&str],
            "bad.csv, line 3: `x_m` is \"nan\"; allowed: a finite number",
        ),
        (
            &["--data", "far.csv"],
            "far.csv, line 3: there is no node 21; `beam` has nodes 0 to 20",
        ),
        (&["--data", "none.csv"], "none.csv cannot be read"),
        (
            &["--data", "shape.csv", "--with", "beam.toml"],
            "expected SCENARIO:FILE",
        ),
        (
            &["--data", "shape.csv", "--prior", "a=1+-1"],
            "this key is not fitted",
        ),
        (&["--data", "shape.csv", "--out", "full"], "is not empty"),
    ] {
        let (code, _, error) = rodlab(
            path,
            &[&["identify", "beam.toml"], arguments, &fit].concat(),
        );
        assert_eq!(code, 2, "{error}");
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn help_is_short() {
    let (_, text, _) = rodlab(Path::new("."), &["identify", "-h"]);
    assert!(text.lines().count() <= 40, "{text}");
}
