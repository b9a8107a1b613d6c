//! Exact derivatives with respect to each kind of parameter, against closed forms and extrapolated
//! central differences of whole runs.

use super::{Check, Expectation, GroupError};
use rodlab_lab::experiment;
use rodlab_lab::scenario::{Loaded, ScenarioError};
use rodlab_lab::sensitivity::{Field, Source, derivatives, differences, field_derivatives};
use std::path::Path;

const STRAIGHT: &str = include_str!("scenes/straight_rod.toml");
const MOVED: &str = include_str!("scenes/sensitive_rod.toml");
const ARMS: &str = include_str!("scenes/sensitive_arms.toml");
const SLIDING: &str = include_str!("scenes/sliding_rod.toml");

/// A small force at the tip; its deflection is a ten thousandth of the length.
const TIP_FORCE: &str = "loads=[{kind=\"force\",rod=\"rod\",at=\"end\",force=[0,0,\"2.4 mN\"]}]";
/// A small weight, with a similar deflection.
const WEIGHT: &str = "loads=[{kind=\"gravity\",acceleration=[0,0,-0.02]}]";
/// A second clamp, which resists a natural twist.
const TWISTED: &str = "clamps=[{rod=\"rod\",at=\"start\"},{rod=\"rod\",at=\"end\"}]";
const NATURAL_TWIST: &str = "rods.rod.natural_shape.twist=0.1";

const DEFLECTION: Expectation = Expectation::new("w = F L³/3EI, I = πr⁴/4", "Euler–Bernoulli");
const SAG: Expectation = Expectation::new("w = ρ g A L⁴/8EI", "Euler–Bernoulli");
const ARC: Expectation = Expectation::new("dw/dκ = L²/2 at κ = 0", "geometry of an arc");
const TORQUE: Expectation = Expectation::new("M = GJ τ, GJ = E πr⁴/4(1+ν)", "Saint-Venant");
const ADJOINT: Expectation = Expectation::new(
    "J λ = q̄, dI/dp = −Σ (∂R/∂p)ᵀ λ",
    "the derivative over a value that is the same along the rod",
);
const DIFFERENCES: Expectation = Expectation::new("dx/dp", "extrapolated central differences");

/// An equilibrium with a closed form: overrides, column, key, and elasticity (p/y) dy/dp.
type Elasticity = (
    &'static str,
    Expectation,
    &'static [&'static str],
    &'static str,
    &'static str,
    f64,
);

/// Equilibria with closed forms.
const ELASTICITIES: [Elasticity; 9] = [
    (
        "deflection over Young's modulus",
        DEFLECTION,
        &[TIP_FORCE],
        "tip_z_m",
        "material.youngs_modulus",
        -1.0,
    ),
    (
        "deflection over the radius",
        DEFLECTION,
        &[TIP_FORCE],
        "tip_z_m",
        "rods.rod.radius",
        -4.0,
    ),
    (
        "deflection over the length",
        DEFLECTION,
        &[TIP_FORCE],
        "tip_z_m",
        "parameters.length",
        3.0,
    ),
    (
        "deflection over the load",
        DEFLECTION,
        &[TIP_FORCE],
        "tip_z_m",
        "loads.0.force.2",
        1.0,
    ),
    (
        "sag over the density",
        SAG,
        &[WEIGHT],
        "tip_z_m",
        "material.density",
        1.0,
    ),
    (
        "sag over the radius",
        SAG,
        &[WEIGHT],
        "tip_z_m",
        "rods.rod.radius",
        -2.0,
    ),
    (
        "torque over the natural twist",
        TORQUE,
        &[TWISTED, NATURAL_TWIST],
        "wall_moment_x_n_m",
        "rods.rod.natural_shape.twist",
        1.0,
    ),
    (
        "torque over the radius",
        TORQUE,
        &[TWISTED, NATURAL_TWIST],
        "wall_moment_x_n_m",
        "rods.rod.radius",
        4.0,
    ),
    (
        "torque over Poisson's ratio",
        TORQUE,
        &[TWISTED, NATURAL_TWIST],
        "wall_moment_x_n_m",
        "material.poissons_ratio",
        -0.2,
    ),
];

/// Parameters of the moved rod, with their keys.
const OF_MOTION: [(&str, &str); 11] = [
    ("Young's modulus", "material.youngs_modulus"),
    ("twisting stiffness", "rods.rod.stiffness.twisting"),
    ("density", "material.density"),
    ("radius", "rods.rod.radius"),
    ("damping", "material.viscosity"),
    ("drag", "loads.1.translation"),
    ("natural curvature", "rods.rod.natural_shape.curvature.0"),
    ("natural twist", "rods.rod.natural_shape.twist"),
    ("speed of the clamp", "clamps.0.move.1.1.2"),
    ("turn of the clamp", "clamps.0.turn.1.1"),
    ("load", "loads.2.force.1"),
];
/// Parameters of the arms, with their keys.
const OF_ARMS: [(&str, &str); 5] = [
    ("stiffness of a hinge", "joints.elbow.stiffness"),
    ("rest angle of a hinge", "joints.elbow.rest_angle"),
    ("mass of a body", "bodies.hand.mass"),
    ("inertia of a body", "bodies.hand.inertia.0"),
    ("offset of a body", "bodies.hand.offset.1"),
];
/// Key of rigid contact for the sliding rod.
const RIGID: &str = "contact={model=\"complementarity\",friction=0.3}";
/// Parameters of the sliding rod, with their keys.
const OF_SLIDING: [(&str, &str); 1] = [("friction", "contact.friction")];

/// Material that relaxes, a fluid, and another scheme for the moved rod.
const RELAXING: [&str; 2] = [
    "material.relaxing_modulus=\"5 MPa\"",
    "material.relaxation_time=\"30 ms\"",
];
const IN_FLUID: [&str; 1] = ["fluid={model=\"resistive\",viscosity=0.05}"];
const BY_MIDPOINT: [&str; 2] = ["material.viscosity=0", "time.scheme=\"implicit-midpoint\""];
/// A curved forearm.
const CURVED: [&str; 2] = [
    "rods.lower.natural_shape={kind=\"curved\",curvature=[1,2],twist=3}",
    "rods.lower.inertia=\"lumped\"",
];

/// A scene with overrides, a field along a rod, with its name and the key of its first component,
/// and the largest error.
struct OfField {
    scene: &'static str,
    text: &'static str,
    overrides: &'static [&'static str],
    field: Field,
    name: &'static str,
    rod: &'static str,
    key: &'static str,
    bound: f64,
}

impl OfField {
    const fn curvature(
        scene: &'static str,
        text: &'static str,
        overrides: &'static [&'static str],
    ) -> Self {
        Self {
            scene,
            text,
            overrides,
            field: Field::NaturalCurvature,
            name: "natural curvature",
            rod: "rod",
            key: "rods.rod.natural_shape.curvature.0",
            bound: 1e-6,
        }
    }

    const fn velocity(scene: &'static str, overrides: &'static [&'static str]) -> Self {
        Self {
            field: Field::InitialVelocity,
            name: "initial velocity",
            key: "rods.rod.velocity.0",
            bound: 1e-5,
            ..Self::curvature(scene, SLIDING, overrides)
        }
    }
}

const OF_FIELDS: [OfField; 8] = [
    OfField::curvature("motion", MOVED, &[]),
    OfField {
        field: Field::NaturalTwist,
        name: "natural twist",
        key: "rods.rod.natural_shape.twist",
        ..OfField::curvature("motion", MOVED, &[])
    },
    OfField::curvature("relaxing motion", MOVED, &RELAXING),
    OfField::curvature("motion in a fluid", MOVED, &IN_FLUID),
    OfField::curvature("motion by the midpoint rule", MOVED, &BY_MIDPOINT),
    OfField {
        rod: "lower",
        key: "rods.lower.natural_shape.curvature.0",
        ..OfField::curvature("arms", ARMS, &CURVED)
    },
    OfField::velocity("sliding", &[]),
    OfField::velocity("sliding by complementarity", &[RIGID]),
];

/// Checks equilibria, a damped motion, sliding, and fields along a rod.
pub fn checks(_full: bool) -> Result<Vec<Check>, GroupError> {
    let mut checks = Vec::new();
    for (name, expectation, overrides, column, key, expected) in ELASTICITIES {
        let found = derivatives(
            &source(STRAIGHT, overrides),
            &[column.to_owned()],
            &[key.to_owned()],
        )?;
        let row = found.rows.last().ok_or("no equilibrium")?;
        let elasticity = found.elasticity(row, 0, 0).unwrap_or(f64::NAN);
        checks.push(
            expectation
                .of(format!("{name}, elasticity"), "")
                .relative(expected, elasticity, 1e-6),
        );
    }
    let key = "rods.rod.natural_shape.curvature.0".to_owned();
    let found = derivatives(&source(STRAIGHT, &[]), &["tip".to_owned()], &[key])?;
    let row = found.rows.last().ok_or("no equilibrium")?;
    let size = largest(&row.derivatives[0]);
    checks.push(
        ARC.of("tip over the natural curvature", "m²")
            .relative(0.5, size, 1e-6),
    );
    for (name, text, keys, bound) in [
        ("motion", MOVED, &OF_MOTION[..], 1e-6),
        ("arms", ARMS, &OF_ARMS, 1e-6),
        ("sliding", SLIDING, &OF_SLIDING, 1e-5),
    ] {
        checks.extend(against_differences(name, &source(text, &[]), keys, bound)?);
    }
    let rigid = source(SLIDING, &[RIGID]);
    let name = "sliding by complementarity";
    checks.extend(against_differences(name, &rigid, &OF_SLIDING, 1e-5)?);
    for one in &OF_FIELDS {
        let name = format!(
            "{}, tip over the {} of all nodes: worst sum",
            one.scene, one.name
        );
        checks.push(ADJOINT.of(name, "").zero(error_of_field(one)?, one.bound));
    }
    Ok(checks)
}

/// Derivatives of the displacement of the tip at the end of a run, against differences; errors are
/// fractions of the largest component.
fn against_differences(
    scene: &str,
    source: Source<'_>,
    keys: &[(&str, &str)],
    bound: f64,
) -> Result<Vec<Check>, GroupError> {
    let of = ["tip".to_owned()];
    let dotted: Vec<String> = keys.iter().map(|(_, key)| (*key).to_owned()).collect();
    let found = derivatives(source, &of, &dotted)?;
    let row = found.rows.last().ok_or("no outputs")?;
    let expected = differences(source, &of, &dotted)?;
    let of_key = |(index, (name, _)): (usize, &(&str, &str))| {
        let (own, other) = (&row.derivatives[index], &expected[index]);
        let errors = own
            .iter()
            .zip(other)
            .map(|(own, other)| Some((*own)? - (*other)?));
        let errors: Vec<Option<f64>> = errors.collect();
        let error = largest(&errors) / largest(other);
        DIFFERENCES
            .of(format!("{scene}, tip over {name}: worst component"), "")
            .zero(error, bound)
    };
    Ok(keys.iter().enumerate().map(of_key).collect())
}

/// Error of the derivatives with respect to the first component of a field, summed over all nodes
/// of its rod.
fn error_of_field(one: &OfField) -> Result<f64, GroupError> {
    let source = source(one.text, one.overrides);
    let of = ["tip".to_owned()];
    let adjoint = field_derivatives(&source, &of, &[one.field], 1, &|| true)?;
    let forward = derivatives(&source, &of, &[one.key.to_owned()])?;
    let rows = adjoint.rows.iter().filter(|row| row.rod == one.rod);
    let sum = |column: usize| {
        rows.clone()
            .map(|row| row.derivatives[0][column])
            .sum::<f64>()
    };
    let expected = &forward.rows.last().ok_or("no outputs")?.derivatives[0];
    let errors = expected.iter().enumerate();
    let errors = errors.map(|(column, expected)| Some(sum(column) - (*expected)?));
    let errors: Vec<Option<f64>> = errors.collect();
    Ok(largest(&errors) / largest(expected))
}

/// The largest magnitude; NaN if a number is missing.
fn largest(numbers: &[Option<f64>]) -> f64 {
    let sizes = numbers.iter().map(|one| one.map_or(f64::NAN, f64::abs));
    sizes.fold(0.0, |most, size| {
        if size > most || size.is_nan() {
            size
        } else {
            most
        }
    })
}

/// A scene with two lists of overrides.
fn source(
    text: &'static str,
    overrides: &[&str],
) -> impl Fn(&[String]) -> Result<Loaded, ScenarioError> {
    let own: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
    move |more| {
        experiment::from_text(
            "scene",
            text,
            Path::new(""),
            &[own.as_slice(), more].concat(),
        )
    }
}
