//! `rodlab plan deployment` from outside: files, numbers, and rejected input.

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Command;

fn plan(arguments: &[&str]) -> (i32, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_rodlab"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(["plan", "deployment"])
        .args(arguments)
        .output()
        .unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    let code = output.status.code().unwrap();
    (code, text(output.stdout), text(output.stderr))
}

const GREEN: &str = "scenarios/rods/green_vps.toml";

/// Header and rows of a table of numbers.
fn rows(path: &Path) -> (String, Vec<Vec<f64>>) {
    let text = fs::read_to_string(path).unwrap();
    let (header, rest) = text.split_once('\n').unwrap();
    let rows = rest.lines().map(|line| {
        let cells = line.split(',').map(|cell| cell.parse().unwrap());
        cells.collect()
    });
    (header.to_owned(), rows.collect())
}

#[test]
fn every_letter_is_planned_for_every_rod() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("plan");
    for letter in ["U", "C", "L", "A", "S"] {
        for rod in ["pink_vps", "green_vps", "rope"] {
            let (pattern, rod) = (
                format!("scenarios/patterns/{letter}.svg"),
                format!("scenarios/rods/{rod}.toml"),
            );
            let (code, stdout, stderr) = plan(&[
                "--pattern",
                &pattern,
                "--rod",
                &rod,
                "--out",
                out.to_str().unwrap(),
            ]);
            assert_eq!(code, 0, "{letter}: {stderr}");
            let report: Value = serde_json::from_str(&stdout).unwrap();
            assert_eq!(report["unstable_poses"], 0);
            assert!(report["deviation_m"].as_f64().unwrap() <= 0.25e-3);
            let (header, poses) = rows(&out.join("trajectory.csv"));
            assert_eq!(header, "time_s,x_m,y_m,z_m,qw,qx,qy,qz");
            assert_eq!(poses.len() as u64, report["poses"].as_u64().unwrap());
            for pair in poses.windows(2) {
                assert!(pair[1][0] > pair[0][0]);
                let turned: f64 = (4..8).map(|k| pair[0][k] * pair[1][k]).sum();
                assert!(turned > 0.99, "{letter}: {pair:?}");
                assert!(pair[1][3] < pair[0][3], "the gripper comes down");
            }
            let (header, pattern) = rows(&out.join("pattern.csv"));
            assert_eq!(header, "s_m,x_m,y_m,curvature_per_m,friction_demand");
            assert_eq!(pattern.len(), poses.len());
        }
    }
    let figure = fs::read_to_string(out.join("deployment.svg")).unwrap();
    assert!(figure.starts_with("<svg") && figure.ends_with("</svg>\n"));
    let json = fs::read_to_string(out.join("trajectory.json")).unwrap();
    let json: Value = serde_json::from_str(&json).unwrap();
    assert!(json["poses"].as_array().unwrap().len() > 100);
}

#[test]
fn the_landing_is_a_scenario_that_runs() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let (code, _, stderr) = plan(&[
        "--pattern",
        "line:0.1",
        "--rod",
        "scenarios/rods/cable.toml",
        "--speed",
        "0.2",
        "--out",
        out,
    ]);
    assert_eq!(code, 0, "{stderr}");
    let results = folder.path().join("results");
    let run = Command::new(env!("CARGO_BIN_EXE_rodlab"))
        .arg("run")
        .arg(folder.path().join("landing.toml"))
        .arg("--out")
        .arg(&results)
        .output()
        .unwrap();
    assert!(
        run.status.success(),
        "{}",
        String::from_utf8_lossy(&run.stderr)
    );
    // The output states the distance of the rod from the pattern.
    let said = String::from_utf8(run.stdout).unwrap() + &String::from_utf8(run.stderr).unwrap();
    assert!(said.contains("off the pattern"), "{said}");
    // The laid part of the rod is on the table along the pattern.
    let text = fs::read_to_string(results.join("nodes.csv")).unwrap();
    let nodes: Vec<Vec<&str>> = text
        .lines()
        .skip(1)
        .map(|line| line.split(',').collect())
        .collect();
    let last = nodes.last().unwrap()[0];
    let number = |row: &[&str], column: usize| row[column].parse::<f64>().unwrap();
    let lying = nodes
        .iter()
        .filter(|row| row[0] == last && number(row, 2) * 0.87 / 80.0 < 0.09);
    let mut count = 0;
    for row in lying {
        let s = number(row, 2) * 0.87 / 80.0;
        // At this speed, the stiff cable slides a little.
        assert!((number(row, 3) - s).abs() < 2e-3, "{row:?}");
        assert!(
            number(row, 4).abs() < 1e-6 && number(row, 5) < 2.5e-3,
            "{row:?}"
        );
        count += 1;
    }
    assert!(count > 5);
}

#[test]
fn the_letter_a_crosses_its_second_leg() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let (_, stdout, stderr) = plan(&[
        "--pattern",
        "scenarios/patterns/A.svg",
        "--rod",
        GREEN,
        "--out",
        out,
    ]);
    let report: Value = serde_json::from_str(&stdout).expect(&stderr);
    assert!(!report["crossings"].as_array().unwrap().is_empty());
}

#[test]
fn points_and_formulas_are_patterns_too() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let csv = folder.path().join("arc.csv");
    let mut text = String::from("x_m,y_m\n");
    for index in 0..100 {
        let angle = f64::from(index) / 40.0;
        text += &format!("{},{}\n", angle.sin(), 1.0 - angle.cos());
    }
    fs::write(&csv, text).unwrap();
    let csv = csv.to_str().unwrap();
    let of = |arguments: &[&str]| -> Value {
        let (code, stdout, stderr) = plan(&[arguments, &["--rod", GREEN, "--out", out]].concat());
        assert_eq!(code, 0, "{stderr}");
        serde_json::from_str(&stdout).unwrap()
    };
    let drawn = of(&["--pattern", csv, "--size", "0.2", "--lead-in", "none"]);
    // The height of the arc is 1 − cos(2.475).
    let scale = 0.2 / (1.0 - 2.475f64.cos());
    assert!((drawn["length_m"].as_f64().unwrap() / (2.475 * scale) - 1.0).abs() < 5e-3);
    let circle = of(&["--pattern", "circle:-0.1", "--friction", "steel"]);
    assert_eq!(circle["friction"], 0.4);
    let lead_in = circle["lead_in_m"].as_f64().unwrap();
    assert!(lead_in > 0.05, "{circle}");
    let length = circle["length_m"].as_f64().unwrap();
    assert!((length - lead_in - 0.2 * std::f64::consts::PI).abs() < 1e-9);
    assert_eq!(circle["crossings"], Value::Array(Vec::new()));
    let demand = |name: &str| circle[name].as_f64().unwrap();
    let lying = demand("largest_lying_friction_demand");
    assert!((lying - 0.1).abs() < 2e-3, "{lying}");
    let least = demand("least_lying_friction_demand");
    // Where the lead-in begins, it has a second derivative and no curvature, so no tension helps.
    assert!(least > 0.9 * lying && least <= lying, "{least}");
    // κ̄ = 0.32 with x_M = 2.57 and n_z = 0.72; the demand is greater near the end, where little
    // of the rod is left.
    assert!(demand("largest_friction_demand") > 0.17, "{circle}");
    of(&["--pattern", "line:0.5", "--scheme", "intuitive"]);
    of(&["--pattern", "sine:3cm,25 cm,2"]);
}

#[test]
fn impossible_plans_are_rejected_and_leave_no_files() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let text = file("text.svg", "<svg><text> </text></svg>");
    let strokes = file("two.svg", "<svg><path d=\"M0 0h9 M0 9h9\"/></svg>");
    let corner = file(
        "corner.svg",
        "<svg width=\"100mm\" viewBox=\"0 0 9 9\"><path d=\"M0 0h9v9\"/></svg>",
    );
    let nan = file("nan.csv", "x_m,y_m\n0,0\nnan,1\n");
    let rod = file(
        "rod.toml",
        "[deployment.rod]\nradius = \"1 mm\"\nlength = 0\ngravito_bending_length = 0.03\n",
    );
    let out = folder.path().join("out");
    let out = out.to_str().unwrap();
    for (arguments, complaint) in [
        (
            vec!["--pattern", &text, "--rod", GREEN],
            "its text has no visible letters",
        ),
        (
            vec!["--pattern", &strokes, "--stroke", "3", "--rod", GREEN],
            "no stroke 3",
        ),
        (
            vec![
                "--pattern",
                &corner,
                "--deviation",
                "0.05 mm",
                "--rod",
                GREEN,
            ],
            "radius of",
        ),
        (vec!["--pattern", &nan, "--rod", GREEN], "line 3"),
        (vec!["--pattern", "line:2", "--rod", GREEN], "2.0000 m long"),
        (
            vec!["--pattern", "circle:0", "--rod", GREEN],
            "other than 0",
        ),
        (
            vec!["--pattern", "line:0.1", "--size", "1", "--rod", GREEN],
            "--size",
        ),
        (vec!["--pattern", "B", "--rod", GREEN], ".svg or .csv file"),
        (
            vec!["--pattern", "missing.svg", "--rod", GREEN],
            "missing.svg",
        ),
        (vec!["--pattern", "line:0.1", "--rod", &rod], "length"),
        (
            vec!["--pattern", "line:0.1", "--rod", GREEN, "--friction", "ice"],
            "fabric",
        ),
    ] {
        let (code, stdout, stderr) = plan(&[&arguments[..], &["--out", out]].concat());
        assert_eq!((code, stdout.as_str()), (2, ""), "{arguments:?}: {stderr}");
        assert!(stderr.contains(complaint), "{arguments:?}: {stderr}");
    }
    assert!(!Path::new(out).exists());
}
