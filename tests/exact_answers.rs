//! `rodlab solve` and `rodlab measure` from outside: JSON on standard output, and rejected input.

use serde_json::Value;
use std::process::Command;

fn rodlab(arguments: &[&str]) -> (i32, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_rodlab"))
        .args(arguments)
        .output()
        .unwrap();
    (
        output.status.code().unwrap(),
        String::from_utf8(output.stdout).unwrap(),
        String::from_utf8(output.stderr).unwrap(),
    )
}

fn answer(arguments: &[&str]) -> Value {
    let (code, stdout, stderr) = rodlab(arguments);
    assert_eq!(code, 0, "{stderr}");
    serde_json::from_str(&stdout).unwrap()
}

#[test]
fn a_helix_direction_has_its_critical_distance() {
    let found = answer(&["solve", "helix", "--direction=2,2,-2"]);
    assert!((found["critical"].as_f64().unwrap() - 6.790424).abs() < 1e-6);
    assert!((found["tau"].as_f64().unwrap() - 3f64.sqrt().recip()).abs() < 1e-15);
    assert_eq!(found["method"], "theory");
    assert!(found["error_estimate"].as_f64().unwrap() < 1e-9);
}

#[test]
fn the_discrete_rod_agrees_within_its_error_estimate() {
    let arguments = ["solve", "helix", "--direction=1,1,-1", "--method", "der"];
    let found = answer(&arguments);
    let error = (found["critical"].as_f64().unwrap() - 6.790424).abs();
    let estimate = found["error_estimate"].as_f64().unwrap();
    assert!((error / estimate - 1.0).abs() < 0.05, "{error} {estimate}");
    assert_eq!(found["method"], "der");
    let (code, stdout, stderr) = rodlab(&[&arguments[..], &["--edges", "7"]].concat());
    assert_eq!((code, stdout.as_str()), (2, ""));
    assert!(stderr.contains("from 8"), "{stderr}");
}

#[test]
fn a_direction_that_stays_stable_is_unbounded() {
    let found = answer(&["solve", "helix", "--direction=0,1,2"]);
    assert!(found["critical"].is_null() && found["error_estimate"].is_null());
}

#[test]
fn meaningless_directions_are_rejected() {
    for (direction, complaint) in [
        ("0,0,0", "not zero"),
        ("-1,0,0", "must not be negative"),
        ("1,2", "three numbers"),
        ("1,nan,0", "finite"),
    ] {
        let (code, stdout, stderr) =
            rodlab(&["solve", "helix", &format!("--direction={direction}")]);
        assert_eq!((code, stdout.as_str()), (2, ""));
        assert!(stderr.contains(complaint), "{stderr}");
    }
}

#[test]
fn measure_inverts_solve() {
    let solved = answer(&["solve", "loop-height", "--gravito-bending-length", "3 cm"]);
    let height = solved["height_m"].as_f64().unwrap();
    assert!((height / 0.03 - 1.142240).abs() < 1e-6);
    let measured = answer(&[
        "measure",
        "loop-height",
        "--height",
        &height.to_string(),
        "--uncertainty",
        "1 mm",
    ]);
    let length = measured["gravito_bending_length_m"].as_f64().unwrap();
    let uncertainty = measured["uncertainty_m"].as_f64().unwrap();
    assert!((length - 0.03).abs() < 1e-12);
    assert!((uncertainty * 1.142240 - 1e-3).abs() < 1e-9);

    let strip = ["--length", "20 cm"];
    let solved = answer(
        &[
            &["solve", "hanging-plate", "--gravito-bending-length", "0.1"],
            &strip[..],
        ]
        .concat(),
    );
    let drop = solved["drop_m"].as_f64().unwrap();
    let measure = |drop: f64| {
        let drop = drop.to_string();
        let arguments = [
            "measure",
            "hanging-plate",
            "--uncertainty",
            "1 mm",
            "--drop",
        ];
        let found = answer(&[&arguments[..], &[&drop], &strip].concat());
        (
            found["gravito_bending_length_m"].as_f64().unwrap(),
            found["uncertainty_m"].as_f64().unwrap(),
        )
    };
    let (length, uncertainty) = measure(drop);
    assert!((length - 0.1).abs() < 1e-9);
    // The uncertainty is half of the difference between results for a drop one millimetre smaller
    // and larger.
    let spread = 0.5 * (measure(drop - 1e-3).0 - measure(drop + 1e-3).0);
    assert!((uncertainty / spread - 1.0).abs() < 1e-3);
}

#[test]
fn meaningless_shapes_are_rejected() {
    for arguments in [
        &["measure", "hanging-plate", "--length", "1", "--drop", "1.2"][..],
        &["measure", "loop-height", "--height", "-1"],
        &["measure", "loop-height", "--height", "3 kg"],
        &["solve", "loop-height"],
    ] {
        let (code, stdout, _) = rodlab(arguments);
        assert_eq!((code, stdout.as_str()), (2, ""), "{arguments:?}");
    }
}

#[test]
fn a_grasp_is_solved_by_both_methods_and_with_all_solutions() {
    let asked = ["solve", "grasp", "--suspended-length", "8", "--curvature"];
    let of = |more: &[&str]| answer(&[&asked[..], more].concat());
    let exact = of(&["-1.5"]);
    for (axis, expected) in [1.29871653775, -4.72571818121, 5.14302216855]
        .iter()
        .enumerate()
    {
        let found = exact["position"][axis].as_f64().unwrap();
        assert!((found - expected).abs() < 1e-6, "{exact}");
    }
    assert_eq!(
        (&exact["stable"], &exact["branch"]),
        (&true.into(), &1.into())
    );
    let discrete = of(&["-1.5", "--method", "der", "--edges", "100"]);
    for axis in 0..3 {
        let difference = |key: &str| {
            let value = |found: &Value| found[key][axis].as_f64().unwrap();
            (value(&discrete) - value(&exact)).abs()
        };
        assert!(difference("position") < 4e-3);
        assert!(difference("rotation_vector") < 8e-4);
    }
    let all = of(&["0", "--all"]);
    let solutions = all["solutions"].as_array().unwrap();
    assert!(solutions.len() > 9, "{all}");
    assert_eq!(solutions[0]["stable"], true);
    assert!(solutions.iter().any(|solution| solution["stable"] == false));
}

#[test]
fn grasps_out_of_range_are_refused() {
    for (arguments, complaint) in [
        (
            ["--suspended-length=0", "--curvature=0"],
            "between 0.1 and 100",
        ),
        (
            ["--suspended-length=nan", "--curvature=0"],
            "between 0.1 and 100",
        ),
        (
            ["--suspended-length=5", "--curvature=13"],
            "between −12 and 12",
        ),
    ] {
        let (code, stdout, stderr) = rodlab(&[&["solve", "grasp"], &arguments[..]].concat());
        assert_eq!((code, stdout.as_str()), (2, ""), "{arguments:?}");
        assert!(stderr.contains(complaint), "{stderr}");
    }
    let soft = ["--suspended-length=5", "--curvature=0", "--stretch=-1"];
    let (code, _, stderr) = rodlab(&[&["solve", "grasp"], &soft[..]].concat());
    assert_eq!(code, 2);
    assert!(stderr.contains("100 or more"), "{stderr}");
}
