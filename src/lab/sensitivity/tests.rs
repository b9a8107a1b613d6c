//! Tests derivatives of probes against differences of whole runs, and rejected requests.

use super::*;
use crate::experiment::from_text;
use crate::scenario::{Loaded, ScenarioError};
use std::path::Path;

const BEAM: &str = r#"
    experiment = "scene"
    material = { youngs_modulus = "10 MPa", poissons_ratio = 0.45, density = 1000.0 }
    [parameters]
    length = "30 cm"
    [[rods]]
    name = "beam"
    radius = "3 mm"
    edges = 12
    inertia = "lumped"
    shape = { kind = "straight", start = [0, 0, 0], end = ["length", 0, 0] }
    natural_shape = { kind = "curved", curvature = [0, 0], twist = 0 }
    [[clamps]]
    rod = "beam"
    at = "start"
    [[loads]]
    kind = "gravity"
    acceleration = [0, 0, -9.81]
    [[probes]]
    name = "tip"
    kind = "displacement"
    rod = "beam"
    at = "end"
    [[probes]]
    name = "wall"
    kind = "reaction"
    rod = "beam"
    at = "start"
    [time]
    step = "2 ms"
    end = "0.1 s"
    [output]
    interval = "20 ms"
"#;

fn beam(overrides: &[&str], more: &[String]) -> Result<Loaded, ScenarioError> {
    let typed = overrides.iter().map(|text| (*text).to_owned());
    let all: Vec<String> = typed.chain(more.iter().cloned()).collect();
    from_text("beam", BEAM, Path::new(""), &all)
}

fn owned(texts: &[&str]) -> Vec<String> {
    texts.iter().map(|text| (*text).to_owned()).collect()
}

/// Compares all derivatives of the tip at the end with differences.
#[track_caller]
fn check(overrides: &[&str], keys: &[&str], tolerance: f64) {
    let source = |more: &[String]| beam(overrides, more);
    let (of, keys) = (owned(&["tip"]), owned(keys));
    let found = derivatives(&source, &of, &keys).unwrap();
    assert_eq!(found.columns, ["tip_x_m", "tip_y_m", "tip_z_m"]);
    let expected = differences(&source, &of, &keys).unwrap();
    let row = found.rows.last().unwrap();
    for (index, key) in keys.iter().enumerate() {
        let (own, other) = (&row.derivatives[index], &expected[index]);
        let largest = other
            .iter()
            .flatten()
            .fold(0.0, |sum: f64, one| sum.max(one.abs()));
        assert!(largest > 0.0, "{key}");
        for (own, other) in own.iter().zip(other) {
            let error = (own.unwrap() - other.unwrap()).abs() / largest;
            assert!(error < tolerance, "{key}: {own:?} {other:?}");
        }
    }
}

const KEYS: [&str; 6] = [
    "material.youngs_modulus",
    "rods.beam.radius",
    "parameters.length",
    "loads.0.acceleration.1",
    "material.density",
    "rods.beam.natural_shape.curvature.0",
];

#[test]
fn derivatives_of_a_motion_are_those_of_whole_runs() {
    check(&[], &KEYS, 1e-6);
}

#[test]
fn derivatives_of_an_equilibrium_are_those_of_whole_runs() {
    let overrides = ["time={mode=\"static\"}", "output={}"];
    check(&overrides, &KEYS, 1e-6);
}

#[test]
fn the_table_has_a_row_for_each_output_and_a_column_for_each_key() {
    let source = |more: &[String]| beam(&[], more);
    let (of, keys) = (owned(&["tip_z_m", "wall"]), owned(&KEYS[..2]));
    let found = derivatives(&source, &of, &keys).unwrap();
    let csv = found.to_csv();
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines.len(), 7);
    assert!(
        lines[0].starts_with(
            "time_s,tip_z_m,d_tip_z_m_d_material.youngs_modulus,d_tip_z_m_d_rods.beam.radius,wall_force_x_n,"
        ),
        "{}",
        lines[0]
    );
    // There is no reaction before the first step.
    assert!(lines[1].ends_with(",,,"), "{}", lines[1]);
    assert_eq!(found.keys[1].unit.as_deref(), Some("m"));
    // The weight that the wall carries grows with the square of the radius.
    let still = ["time={mode=\"static\"}", "output={}"];
    let source = |more: &[String]| beam(&still, more);
    let found = derivatives(&source, &owned(&["wall_force_z_n"]), &keys).unwrap();
    let elasticity = |key: usize| found.elasticity(&found.rows[0], key, 0).unwrap();
    assert!(elasticity(0).abs() < 1e-6, "{}", elasticity(0));
    assert!((elasticity(1) - 2.0).abs() < 1e-6, "{}", elasticity(1));
}

#[track_caller]
fn refused(overrides: &[&str], of: &str, key: &str) -> String {
    let source = |more: &[String]| beam(overrides, more);
    let found = derivatives(&source, &owned(&[of]), &owned(&[key]));
    found.expect_err("it has no derivative").to_string()
}

#[test]
fn what_has_no_derivative_is_named() {
    let density = "material.density";
    let message = refused(&[], "tap", density);
    assert!(
        message.contains("`tap`") && message.contains("tip"),
        "{message}"
    );
    let message = refused(&[], "tip", "time.step");
    assert!(
        message.contains("`time.step`: it changes the steps"),
        "{message}"
    );
    let message = refused(&[], "tip", "rods.beam.name");
    assert!(message.contains("expected text"), "{message}");
    let message = refused(&[], "tip", "rods.beam.radiu");
    assert!(message.contains("unknown key"), "{message}");
    let message = refused(&[], "tip", "rods.beam.edges");
    assert!(message.contains("whole number"), "{message}");
    let message = refused(&["probes=[]"], "tip", density);
    assert!(message.contains("[[probes]]"), "{message}");
    let flow = ["fluid={model=\"rss\",viscosity=0.1}"];
    let source = |more: &[String]| beam(&flow, more);
    let refused = field_derivatives(&source, &owned(&["tip"]), &[Field::Force], 1, &|| true);
    let message = refused.unwrap_err().to_string();
    assert!(message.contains("fluid.model"), "{message}");
}

#[test]
fn fields_that_change_everywhere_alike_are_keys() {
    // A round section, at rest and in motion: curvature about one director, and all stiffnesses together.
    let still = ["time={mode=\"static\"}", "output={}"];
    for overrides in [&still[..], &[]] {
        let source = |more: &[String]| beam(overrides, more);
        let (of, keys) = (
            owned(&["tip"]),
            owned(&[
                "rods.beam.natural_shape.curvature.0",
                "material.youngs_modulus",
            ]),
        );
        let expected = derivatives(&source, &of, &keys).unwrap();
        let expected = &expected.rows.last().unwrap().derivatives;
        let fields = [
            Field::NaturalCurvature,
            Field::BendingStiffness,
            Field::TwistingStiffness,
            Field::StretchingStiffness,
        ];
        let found = field_derivatives(&source, &of, &fields, 1, &|| true).unwrap();
        assert_eq!(found.columns, ["tip_x_m", "tip_y_m", "tip_z_m"]);
        assert_eq!(found.rows.len(), 13);
        for column in 0..3 {
            let curvature = found.sum(0, column);
            let stiffness: f64 = (2..6).map(|of| found.sum(of, column)).sum();
            for (own, key) in [(curvature, 0), (stiffness / 1e7, 1)] {
                let other = expected[key][column].unwrap();
                let error = (own - other).abs();
                assert!(error <= 2e-7 * other.abs() + 1e-15, "{own:e} {other:e}");
            }
        }
    }
}

#[test]
fn fields_of_parts_of_a_motion_have_rows_of_their_own() {
    let source = |more: &[String]| beam(&[], more);
    let fields = [Field::Force, Field::InitialVelocity];
    let found = field_derivatives(&source, &owned(&["tip_z_m"]), &fields, 4, &|| true).unwrap();
    let ends = found.ends.iter().zip([0.025, 0.05, 0.075, 0.1]);
    assert!(
        ends.into_iter()
            .all(|(end, expected)| (end - expected).abs() < 1e-15)
    );
    let csv = found.to_csv();
    let lines: Vec<&str> = csv.lines().collect();
    assert!(
        lines[0].starts_with("until_s,rod,node,arc_length_m,d_tip_z_m_d_force_x,d_tip_z_m_d_"),
        "{}",
        lines[0]
    );
    assert_eq!(lines.len(), 1 + 4 * 13);
    assert!(lines[1].starts_with("0.025,beam,0,0.0,"), "{}", lines[1]);
    // The sum over parts for the last node does not depend on the number of parts.
    let whole = field_derivatives(&source, &owned(&["tip_z_m"]), &fields, 1, &|| true).unwrap();
    assert!((found.sum(2, 0) / whole.sum(2, 0) - 1.0).abs() < 1e-12);
    // An earlier push has more time to move the tip.
    let of_tip = |part: usize| found.rows[13 * part + 12].derivatives[2][0];
    assert!(of_tip(0) > of_tip(3) && of_tip(3) > 0.0);
}

#[test]
fn fields_without_derivatives_are_named() {
    let refused = |overrides: &[&str], of: &str, field: Field, parts: usize| {
        let source = |more: &[String]| beam(overrides, more);
        let found = field_derivatives(&source, &owned(&[of]), &[field], parts, &|| true);
        found.expect_err("it has no derivative").to_string()
    };
    let message = refused(&[], "wall", Field::Force, 1);
    assert!(message.contains("`wall_force_x_n`"), "{message}");
    let still = ["time={mode=\"static\"}", "output={}"];
    for (field, parts) in [(Field::InitialVelocity, 1), (Field::Force, 2)] {
        let message = refused(&still, "tip", field, parts);
        assert!(message.contains("time.mode"), "{message}");
    }
}
