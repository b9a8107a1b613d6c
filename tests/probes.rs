//! Probes on the command line: sweeps, searches and figures use their columns.

use assert_cmd::Command;
use std::fs;
use std::path::Path;

/// EI = E π r⁴/4 = 2.0106e-3 N m², weight 0.49310 N/m.
pub const BEAM: &str = r#"
experiment = "scene"
material = { youngs_modulus = 1e7, poissons_ratio = 0.5, density = 1000.0 }
time = { mode = "static" }
[[rods]]
name = "beam"
radius = 0.004
edges = 20
shape = { kind = "straight", start = [0, 0, 0], end = [0.3, 0, 0] }
[[clamps]]
rod = "beam"
at = "start"
[[loads]]
kind = "gravity"
acceleration = [0, 0, -9.81]
[[probes]]
name = "root"
kind = "reaction"
at = "start"
summary = "last"
[[probes]]
name = "tip"
kind = "position"
at = "end"
summary = "last"
"#;

fn rodlab(directory: &Path, arguments: &[&str]) -> String {
    let mut command = Command::cargo_bin("rodlab").unwrap();
    let done = command.current_dir(directory).args(arguments).assert();
    String::from_utf8(done.success().get_output().stdout.clone()).unwrap()
}

fn column(path: &Path, name: &str) -> Vec<f64> {
    let mut reader = csv::Reader::from_path(path).unwrap();
    let index = reader
        .headers()
        .unwrap()
        .iter()
        .position(|column| column == name);
    let index = index.unwrap_or_else(|| panic!("no column {name}"));
    let number = |record: csv::StringRecord| record[index].parse().unwrap();
    reader
        .records()
        .map(|record| number(record.unwrap()))
        .collect()
}

#[test]
fn sweeps_and_figures_have_the_columns_of_probes() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path();
    fs::write(path.join("beam.toml"), BEAM).unwrap();
    let vary = "material.density=500,1000,2000";
    rodlab(
        path,
        &[
            "run",
            "beam.toml",
            "--vary",
            vary,
            "--out",
            "sweep",
            "--quiet",
        ],
    );
    let summary = path.join("sweep/summary.csv");
    let densities = column(&summary, "material.density");
    let forces = column(&summary, "root_force_z_last_n");
    for (density, force) in densities.iter().zip(&forces) {
        let weight = density * 9.81 * 0.3 * std::f64::consts::PI * 0.004 * 0.004;
        assert!((force / weight - 1.0).abs() < 1e-6);
    }
    let tips = column(&summary, "tip_z_last_m");
    assert!(tips[0] > tips[1] && tips[1] > tips[2]);
    let figure = [
        "plot",
        "sweep",
        "--x",
        "material.density",
        "--y",
        "root_force_z_last_n",
    ];
    let printed = rodlab(path, &figure);
    let svg = printed.lines().next().unwrap();
    let drawn = fs::read_to_string(path.join(svg)).unwrap();
    assert!(drawn.contains("Root force z last in N"), "{drawn}");
}

#[test]
fn a_sweep_has_the_derivatives_that_sensitivity_prints() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path();
    let sweep = r#"
[sweep]
material.density = [500, 1000]
[sweep.derivatives]
of = ["tip_z_m"]
to = ["rods.beam.radius", "material.density"]
"#;
    fs::write(path.join("beam.toml"), BEAM).unwrap();
    fs::write(path.join("sweep.toml"), format!("{BEAM}{sweep}")).unwrap();
    let run = ["run", "sweep.toml", "--out", "sweep", "--quiet"];
    rodlab(path, &run);
    let summary = path.join("sweep/summary.csv");
    let keys = ["rods.beam.radius", "material.density"];
    for (case, density) in ["500", "1000"].into_iter().enumerate() {
        let set = format!("material.density={density}");
        let to = keys.join(",");
        let sensitivity = [
            "sensitivity",
            "beam.toml",
            "--of",
            "tip_z_m",
            "--to",
            &to,
            "--set",
            &set,
            "--json",
        ];
        let printed: serde_json::Value = serde_json::from_str(&rodlab(path, &sensitivity)).unwrap();
        for (index, key) in keys.into_iter().enumerate() {
            let expected = printed["columns"][0]["derivatives"][index]["derivative"].as_f64();
            let found = column(&summary, &format!("d_tip_z_m_d_{key}"));
            let error = found[case] / expected.unwrap() - 1.0;
            assert!(error.abs() < 1e-12, "{key}: {error:e}");
        }
    }
    let before = fs::read(&summary).unwrap();
    rodlab(path, &run);
    assert_eq!(before, fs::read(&summary).unwrap());
    fs::remove_dir_all(path.join("sweep/cases")).unwrap();
    rodlab(path, &run);
    assert_eq!(before, fs::read(&summary).unwrap());
}

#[test]
fn a_search_aims_at_a_column_of_a_probe() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path();
    let search = r#"
[sweep.search]
method = "bisect"
parameter = "material.density"
from = 100.0
to = 4000.0
objective = "tip_z_last_m"
target = -0.05
tolerance = 0.5
"#;
    fs::write(path.join("beam.toml"), format!("{BEAM}{search}")).unwrap();
    rodlab(path, &["run", "beam.toml", "--out", "search", "--quiet"]);
    let found = column(&path.join("search/search.csv"), "material.density");
    let beam = BEAM.replace("density = 1000.0", &format!("density = {:?}", found[0]));
    fs::write(path.join("found.toml"), beam).unwrap();
    rodlab(path, &["run", "found.toml", "--out", "found", "--quiet"]);
    let tip = column(&path.join("found/summary.csv"), "tip_z_last_m");
    assert!((tip[0] + 0.05).abs() < 1e-4, "{tip:?}");
}

#[test]
fn probes_are_explained_and_are_in_the_schema() {
    let directory = tempfile::tempdir().unwrap();
    let explained = rodlab(directory.path(), &["explain", "probes"]);
    for word in [
        "reaction",
        "linking_number",
        "contact_force",
        "summary",
        "from_plane",
    ] {
        assert!(explained.contains(word), "{word}\n{explained}");
    }
    let schema = rodlab(directory.path(), &["schema"]);
    assert!(schema.contains("twisting_moment") && schema.contains("stop_when"));
    let page = include_str!("../src/guide/probes.md");
    let kinds = explained
        .split("kinds: ")
        .nth(1)
        .unwrap()
        .split("\n  keys of")
        .next()
        .unwrap();
    for kind in kinds.split(',').map(str::trim) {
        assert!(page.contains(&format!("| `{kind}` |")), "{kind}");
    }
}

/// The examples of the guide page run.
#[test]
fn the_examples_of_the_guide_run() {
    let directory = tempfile::tempdir().unwrap();
    let page = include_str!("../src/guide/probes.md");
    let mut examples = page.split("```toml ").skip(1);
    let mut example = || {
        let (_, text) = examples.next().unwrap().split_once('\n').unwrap();
        text.split("```").next().unwrap()
    };
    let scene = example();
    let stop = example();
    let moving = scene.replace("mode = \"static\"", "step = 2e-3\nend = 1.0") + stop;
    for (name, text) in [("beam", scene), ("moving", &moving)] {
        fs::write(directory.path().join(format!("{name}.toml")), text).unwrap();
        let file = format!("{name}.toml");
        let printed = rodlab(directory.path(), &["run", &file, "--quiet"]);
        assert!(printed.contains("tip_z_last_m"), "{printed}");
        assert_eq!(printed.contains("ended early"), name == "moving");
    }
}

#[test]
fn sensitivities_are_printed_checked_and_written() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path();
    fs::write(path.join("beam.toml"), BEAM).unwrap();
    let to = "material.youngs_modulus,material.density";
    let common = ["sensitivity", "beam.toml", "--of", "tip_z_m", "--to", to];
    let text = rodlab(path, &[&common[..], &["--check", "--out", "out"]].concat());
    for word in [
        "in equilibrium",
        "tip_z_m = ",
        "material.density",
        "kg/m",
        "by differences",
    ] {
        assert!(text.contains(word), "{word}: {text}");
    }
    // The shape depends only on the ratio of density and modulus.
    let table = path.join("out/sensitivity.csv");
    let by_modulus = column(&table, "d_tip_z_m_d_material.youngs_modulus");
    let by_density = column(&table, "d_tip_z_m_d_material.density");
    let sum = 1e7 * by_modulus[0] + 1000.0 * by_density[0];
    assert!(sum.abs() < 1e-7 * (1000.0 * by_density[0]).abs(), "{sum}");
    let json = rodlab(path, &[&common[..], &["--json"]].concat());
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let first = &json["columns"][0]["derivatives"][0];
    assert_eq!(first["derivative"], by_modulus[0]);
    let along = [
        "--field",
        "natural_curvature,bending_stiffness",
        "--out",
        "out",
    ];
    let text = rodlab(path, &[&common[..4], &along].concat());
    for word in [
        "bending_stiffness_1 (relative)",
        "node ",
        "fields.csv",
        "fields.svg",
    ] {
        assert!(text.contains(word), "{word}: {text}");
    }
    let along = path.join("out/fields.csv");
    let stiffness = |axis: u8| -> f64 {
        let own = column(&along, &format!("d_tip_z_m_d_bending_stiffness_{axis}"));
        own.iter().sum()
    };
    // The weight is carried by bending alone.
    let share = (stiffness(1) + stiffness(2)) / (1e7 * by_modulus[0]);
    assert!((share - 1.0).abs() < 1e-3, "{share}");
    let mut wrong = Command::cargo_bin("rodlab").unwrap();
    let wrong = wrong.current_dir(path);
    let wrong = wrong.args(["sensitivity", "beam.toml", "--of", "top", "--to", to]);
    let fault = String::from_utf8(wrong.assert().code(2).get_output().stderr.clone()).unwrap();
    assert!(fault.contains("`top`") && fault.contains("tip"), "{fault}");
}

#[test]
fn motions_may_begin_in_the_equilibrium() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path();
    fs::write(path.join("still.toml"), BEAM).unwrap();
    let time = r#"{ step = "2 ms", end = "0.1 s", begin = "equilibrium" }"#;
    let moving = BEAM.replace(r#"{ mode = "static" }"#, time);
    fs::write(path.join("rests.toml"), &moving).unwrap();
    for name in ["still", "rests"] {
        let file = format!("{name}.toml");
        rodlab(path, &["run", &file, "--out", name, "--quiet"]);
    }
    let height = |name: &str| column(&path.join(name).join("series.csv"), "tip_z_m");
    let (still, rests) = (height("still")[0], height("rests"));
    assert!(still < -0.1 && rests.len() > 10);
    for height in &rests {
        assert!((height - still).abs() < 1e-7, "{height} {still}");
    }
    // Derivatives include the initial equilibrium; so does a resumed run.
    let to = "material.youngs_modulus,material.density";
    let derivatives = |name: &str| {
        let file = format!("{name}.toml");
        rodlab(
            path,
            &[
                "sensitivity",
                &file,
                "--of",
                "tip_z_m",
                "--to",
                to,
                "--out",
                name,
            ],
        );
        let table = path.join(name).join("sensitivity.csv");
        let own = column(&table, "d_tip_z_m_d_material.density");
        own[own.len() - 1]
    };
    let (of_still, of_rests) = (derivatives("still"), derivatives("rests"));
    assert!(
        (of_rests / of_still - 1.0).abs() < 1e-5,
        "{of_rests} {of_still}"
    );
    let thrown = moving.replace("edges = 20", "edges = 20\nvelocity = [0, 1, 0]");
    fs::write(path.join("thrown.toml"), thrown).unwrap();
    let mut wrong = Command::cargo_bin("rodlab").unwrap();
    let wrong = wrong.current_dir(path).args(["check", "thrown.toml"]);
    let fault = String::from_utf8(wrong.assert().code(2).get_output().stderr.clone()).unwrap();
    assert!(
        fault.contains("thrown.toml:4:") && fault.contains("`time.begin`"),
        "{fault}"
    );
}
