//! Derivatives of motions and equilibria over each kind of parameter.

use super::{Check, Expectation, GroupError};
use rodlab_lab::experiment::from_text;
use rodlab_lab::scenario::{Loaded, ScenarioError};
use rodlab_lab::sensitivity::{Field, derivatives, differences, field_derivatives};
use std::path::Path;

const FORWARD: Expectation = Expectation::new(
    "J dq/dp = −(∂R/∂s ds/dp + ∂R/∂p)",
    "extrapolated central differences of whole runs",
);
const ADJOINT: Expectation = Expectation::new(
    "J λ = q̄, dI/dp = −Σ (∂R/∂p)ᵀ λ",
    "the forward mode, over a value that is the same along the rod",
);

const WIRE: &str = include_str!("scenes/swinging_wire.toml");
const BRAKING: &str = include_str!("scenes/braking_rod.toml");

/// Keys of the wire: its modulus, shear, density, dashpots, radius, shape without stress, the way and the turn of the clamp, weight, drag,
/// force.
const KEYS: [(&str, &str); 12] = [
    ("Young's modulus", "material.youngs_modulus"),
    ("Poisson's ratio", "material.poissons_ratio"),
    ("density", "material.density"),
    ("viscosity", "material.viscosity"),
    ("the radius", "rods.wire.radius"),
    ("natural curvature", "rods.wire.natural_shape.curvature.0"),
    ("natural twist", "rods.wire.natural_shape.twist"),
    ("the way of a clamp", "clamps.0.move.1.1.1"),
    ("the turn of a clamp", "clamps.0.turn.1.1"),
    ("weight", "loads.0.acceleration.2"),
    ("drag", "loads.1.translation"),
    ("a force", "loads.2.force.1"),
];

/// Each kind of parameter of a wire, friction, and fields along the wire.
pub fn checks(_full: bool) -> Result<Vec<Check>, GroupError> {
    let mut checks = Vec::new();
    for (kind, key) in KEYS {
        let name = format!("swinging wire, tip over {kind}: worst derivative");
        checks.push(FORWARD.of(name, "").zero(error_of(WIRE, key)?, 1e-6));
    }
    let name = "rod that slides and brakes, place over friction: worst derivative";
    let error = error_of(BRAKING, "contact.friction")?;
    checks.push(FORWARD.of(name, "").zero(error, 1e-6));
    for (kind, key, fields) in [
        (
            "natural curvature",
            "rods.wire.natural_shape.curvature.0",
            &[Field::NaturalCurvature][..],
        ),
        (
            "stiffness",
            "material.youngs_modulus",
            &[
                Field::BendingStiffness,
                Field::TwistingStiffness,
                Field::StretchingStiffness,
            ],
        ),
    ] {
        let name =
            format!("swinging wire, tip over the {kind} of all nodes: worst sum of derivatives");
        checks.push(
            ADJOINT
                .of(name, "")
                .zero(difference_of_modes(key, fields)?, 1e-6),
        );
    }
    Ok(checks)
}

fn loaded(text: &str, more: &[String]) -> Result<Loaded, ScenarioError> {
    from_text("scene", text, Path::new(""), more)
}

/// Largest error of the derivatives over a key at the end, over the largest of them.
fn error_of(text: &str, key: &str) -> Result<f64, GroupError> {
    let source = |more: &[String]| loaded(text, more);
    let keys = [key.to_owned()];
    let found = derivatives(&source, &[], &keys)?;
    let expected = differences(&source, &[], &keys)?;
    let found = found.rows.last().ok_or("no output")?;
    Ok(worst(numbers(&found.derivatives[0]), numbers(&expected[0])))
}

/// The same of the sum of derivatives over fields, with the derivative over the key for which they stand. A modulus stands for relative
/// changes of all stiffnesses, and dashpots are not among them.
fn difference_of_modes(key: &str, fields: &[Field]) -> Result<f64, GroupError> {
    let elastic = "material.viscosity=0".to_owned();
    let source = |more: &[String]| {
        let all = [std::slice::from_ref(&elastic), more].concat();
        loaded(WIRE, &all)
    };
    let forward = derivatives(&source, &[], &[key.to_owned()])?;
    let adjoint = field_derivatives(&source, &[], fields, 1)?;
    let forward = forward.rows.last().ok_or("no output")?;
    let expected = numbers(&forward.derivatives[0]);
    // A relative change is one of the value over itself; of two curvatures, the key is the first.
    let (components, unit) = match fields {
        [Field::NaturalCurvature] => (1, 1.0),
        _ => (adjoint.components.len(), 1e7),
    };
    let sum = |column: usize| -> f64 {
        let components = 0..components;
        components
            .map(|component| adjoint.sum(component, column) / unit)
            .sum()
    };
    Ok(worst((0..expected.len()).map(sum).collect(), expected))
}

fn numbers(values: &[Option<f64>]) -> Vec<f64> {
    let values = values.iter();
    values.map(|value| value.unwrap_or(f64::NAN)).collect()
}

fn worst(found: Vec<f64>, expected: Vec<f64>) -> f64 {
    let largest = expected.iter().fold(0.0_f64, |sum, one| sum.max(one.abs()));
    let pairs = found.iter().zip(&expected);
    // Written so that a number that is none is not lost.
    let worst = pairs.fold(0.0, |worst: f64, (found, expected)| {
        let error = (found - expected).abs();
        if error <= worst { worst } else { error }
    });
    worst / largest
}
