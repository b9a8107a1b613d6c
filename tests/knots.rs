//! Knots from outside: curves in files, their measured invariants, and rejected input.

use serde_json::Value;
use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::process::Command;
use tempfile::TempDir;

const SCENARIO: &str = r#"
experiment = "knot-tightening"

[material]
youngs_modulus = "1.8 MPa"
poissons_ratio = 0.5
density = 100.0

[rod]
radius = "1.6 mm"
nodes = 201

[knot]
curve = "trefoil.csv"
pull_speed = "5 mm/s"
settling_time = 0.1

[contact]
distance_tolerance = "0.1 mm"

[time]
step = 2.5e-3
end = 0.2

[output]
interval = 0.1
"#;

/// A trefoil; closed if the gap is zero.
fn trefoil(gap: f64) -> String {
    let mut text = "x,y,z\n".to_owned();
    for k in 0..=200 {
        // The curve starts and ends at the outermost point of a loop.
        let part = gap + (1.0 - 2.0 * gap) * f64::from(k) / 200.0;
        let angle = std::f64::consts::PI + std::f64::consts::TAU * part;
        let x = 0.04 * (angle.sin() + 2.0 * (2.0 * angle).sin());
        let y = 0.04 * (angle.cos() - 2.0 * (2.0 * angle).cos());
        let z = -0.016 * (3.0 * angle).sin();
        writeln!(text, "{x:.6},{y:.6},{z:.6}").unwrap();
    }
    text
}

fn directory(curve: &str) -> TempDir {
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("trefoil.csv"), curve).unwrap();
    fs::write(directory.path().join("trefoil.toml"), SCENARIO).unwrap();
    directory
}

/// Runs the program; returns exit code, standard output and standard error without line breaks.
fn rodlab(directory: &Path, arguments: &[&str]) -> (i32, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rodlab"));
    let output = command
        .current_dir(directory)
        .args(arguments)
        .output()
        .unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    let words = |text: String| text.split_whitespace().collect::<Vec<_>>().join(" ");
    (
        output.status.code().unwrap(),
        text(output.stdout),
        words(text(output.stderr)),
    )
}

#[test]
fn curves_are_measured_closed_or_open() {
    for (gap, closed) in [(0.0, true), (0.02, false)] {
        let directory = directory(&trefoil(gap));
        let (code, stdout, stderr) = rodlab(directory.path(), &["measure", "knot", "trefoil.csv"]);
        assert_eq!((code, stderr.as_str()), (0, ""));
        let found: Value = serde_json::from_str(&stdout).unwrap();
        assert_eq!(found["knot_determinant"], 3);
        assert_eq!(found["crossings"], 3);
        assert_eq!(found["closed"], closed);
    }
    let scenarios = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let (_, stdout, _) = rodlab(&scenarios, &["measure", "knot", "three_twist.csv"]);
    let found: Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!(found["knot_determinant"], 7);
}

#[test]
fn curves_without_a_knot_to_measure_are_refused() {
    for (curve, reason) in [
        ("x,y,z\n0,0,0\n1,0,zero\n", "trefoil.csv, line 3"),
        ("x,y,z\n0,0,0\n1,0,0\n0,0,0\n", "needs at least 3 points"),
        (
            "x,y,z\n0,0,0\n2,0,0\n2,1,0\n1,1,0\n1,-1,0\n",
            "intersects itself",
        ),
    ] {
        let directory = directory(curve);
        let (code, stdout, stderr) = rodlab(directory.path(), &["measure", "knot", "trefoil.csv"]);
        assert_eq!((code, stdout.as_str()), (2, ""), "{curve}");
        assert!(stderr.contains(reason), "{stderr}");
    }
}

#[test]
fn a_rod_along_a_curve_is_run_and_its_scenario_runs_again() {
    let directory = directory(&trefoil(0.02));
    let (code, _, stderr) = rodlab(directory.path(), &["run", "trefoil.toml", "--out", "first"]);
    assert_eq!((code, stderr.as_str()), (0, ""));
    let series = fs::read_to_string(directory.path().join("first/series.csv")).unwrap();
    assert_eq!(series.lines().count(), 4);
    fs::remove_file(directory.path().join("trefoil.csv")).unwrap();
    let again = ["run", "first/scenario.toml", "--out", "second"];
    assert_eq!(rodlab(directory.path(), &again).0, 0);
    let second = fs::read_to_string(directory.path().join("second/series.csv")).unwrap();
    assert_eq!(second, series);
}

#[test]
fn a_sweep_stores_the_curve_itself() {
    let directory = directory(&trefoil(0.02));
    let sweep = [
        "run",
        "trefoil.toml",
        "--vary",
        "contact.friction=0,0.1",
        "--out",
        "first",
    ];
    let (code, _, stderr) = rodlab(directory.path(), &sweep);
    assert_eq!(code, 0, "{stderr}");
    fs::remove_file(directory.path().join("trefoil.csv")).unwrap();
    let again = ["check", "first/scenario.toml"];
    let (code, _, stderr) = rodlab(directory.path(), &again);
    assert_eq!((code, stderr.as_str()), (0, ""));
}

#[test]
fn bad_curves_exit_with_2_and_leave_nothing_behind() {
    let open = trefoil(0.02);
    let flat: String = open
        .lines()
        .map(|line| match line.rsplit_once(',') {
            Some((across, height)) if height != "z" => format!("{across},0\n"),
            _ => format!("{line}\n"),
        })
        .collect();
    for (curve, set, reason) in [
        (
            &open,
            "knot.kind=\"figure-eight\"",
            "its determinant is 3, that of the knot asked for is 5",
        ),
        (&open, "knot.kind=\"granny\"", "a curve is one rod"),
        (&open, "rod.radius=\"20 mm\"", "interpenetrate"),
        (&open, "time.end=100.0", "beyond the length of the rod"),
        (&open, "knot.curve=\"no.csv\"", "no.csv cannot be read"),
        (&flat, "knot.length=1.0", "the curve intersects itself"),
        (&trefoil(0.0), "knot.length=1.0", "the curve is closed"),
        (
            &"x,y,z\n0,0,0\n1,0\n".to_owned(),
            "knot.length=1.0",
            "trefoil.csv, line 3",
        ),
    ] {
        let directory = directory(curve);
        for command in ["run", "check"] {
            let (code, stdout, stderr) =
                rodlab(directory.path(), &[command, "trefoil.toml", "--set", set]);
            assert_eq!((code, stdout.as_str()), (2, ""), "{set}: {stderr}");
            assert!(stderr.contains(reason), "{reason} in {stderr}");
        }
        let files = fs::read_dir(directory.path()).unwrap().count();
        assert_eq!(files, 2, "{set}");
    }
}
