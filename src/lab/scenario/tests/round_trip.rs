//! Resolved scenarios: units, defaults, and a canonical form that reads back to itself.

use super::{BEAM, read};
use crate::experiment::{Actuation, ActuationKind};
use crate::scenario::{Contact, Hold, Inertia, NaturalShape, Scenario, Shape, Time};
use proptest::prelude::*;

#[test]
fn a_good_file_is_resolved_to_si_units() {
    let scenario = read(BEAM).unwrap();
    let rod = &scenario.rods[0];
    assert_eq!(rod.radius, 5e-3);
    assert_eq!(rod.material.youngs_modulus, 1e8);
    assert_eq!(rod.natural_shape, NaturalShape::AsPlaced);
    let second_moment = std::f64::consts::PI * 5e-3f64.powi(4) / 4.0;
    assert!((rod.stiffness.bending_1 / (1e8 * second_moment) - 1.0).abs() < 1e-15);
    assert_eq!(scenario.time, Time::Static);
    assert_eq!(scenario.clamps[0].hold, Hold::Both);
}

#[test]
fn resolved_scenarios_read_back_to_themselves() {
    let scenario = read(BEAM).unwrap();
    insta::assert_snapshot!(scenario.to_toml(), @r###"
title = "Heavy cantilever"
experiment = "scene"

[[rods]]
name = "beam"
radius = 0.005
edges = 50
closed = false
held = false
natural_shape = "as-placed"
twist = 0.0
inertia = "consistent"
velocity = [0.0, 0.0, 0.0]
angular_velocity = [0.0, 0.0, 0.0]

[rods.shape]
kind = "straight"
start = [0.0, 0.0, 0.0]
end = [1.0, 0.0, 0.0]

[rods.material]
youngs_modulus = 100000000.0
poissons_ratio = 0.5
density = 1000.0

[rods.cross_section]
kind = "circle"

[rods.stiffness]
stretching = 7853.981633974483
bending_1 = 0.04908738521234052
bending_2 = 0.04908738521234052
twisting = 0.032724923474893676

[[clamps]]
rod = "beam"
at = "start"
hold = "both"
angular_velocity = 0.0

[[loads]]
kind = "gravity"
acceleration = [0.0, 0.0, -9.81]

[contact]
model = "none"

[fluid]
model = "none"

[time]
mode = "static"

[solver]
force_tolerance = 0.000001
displacement_tolerance = 0.0001
maximum_iterations = 40

[output]
nodes = true
forces = false
contacts = false
vtk = false
"###);
    assert_eq!(read(&scenario.to_toml()).unwrap(), scenario);
}

/// Every kind of shape, section, clamp and load, with units.
const EVERYTHING: &str = r#"experiment = "scene"

[material]
youngs_modulus = "1.3 MPa"
poissons_ratio = 0.49
density = "1.18 g/cm^3"

[[rods]]
radius = "1.6 mm"
edges = 30
shape = { kind = "helix", start = [0.1, 0.2, 0.3], axis = [1, 2, 3], radius = "3 cm", pitch = "7 cm", turns = 2.3, handedness = "left", phase = "33 deg" }
natural_shape = "straight"
velocity = ["1 mm/s", 0, 0]

[[rods]]
name = "strip"
edges = 10
cross_section = { kind = "rectangle", width = "10 mm", thickness = "1 mm" }
shape = { kind = "arc", start = [1, 0, 0], tangent = [0, 1, 1], normal = [1, 0.3, 0], radius = 0.3, angle = "170 deg" }
natural_curvature = ["3 1/m", 0]
natural_twist = "20 deg/m"
director = [1, 1, 1]
twist = "1 turn"
material = { youngs_modulus = "200 GPa" }
stiffness = { stretching = "7 kN", twisting = "3 N mm^2" }

[[rods]]
name = "ring"
radius = "2 mm"
edges = 20
shape = { kind = "ring", centre = [0, 0, 1], normal = [0.1, 0.2, 0.3], radius = "10 cm" }
natural_shape = { kind = "ring", centre = [0, 0, 0], radius = "11 cm" }

[[rods]]
name = "post"
radius = "2 cm"
held = true
shape = { kind = "points", points = [[0, 0, -1], [0, 0, 0], [0, 0.1, "120 cm"]] }

[[rods]]
name = "chain"
radius = "2 mm"
edges = 12
shape = { kind = "catenary", start = [0, 0, 1], end = [1, 0.5, 2], length = "250 cm", down = [0, 0.1, -1] }

[[rods]]
name = "loose"
radius = "1 mm"
edges = 20
shape = { kind = "slack", start = [0, 3, 1], end = [1, 3.5, 2], length = "250 cm", towards = [0, 1, -1] }

[[rods]]
name = "coil"
radius = "1 mm"
edges = 200
shape = { kind = "coil", centre = [0, 0, 5], normal = [0, 1, 1], inner_radius = "3 cm", spacing = "4 mm", length = "2 m", phase = "10 deg" }

[[rods]]
name = "string"
radius = "1 mm"
edges = 20
shape = { kind = "straight", start = [0, 4, 0], end = [1, 4, 0] }
pretension = "20 mN"

[[clamps]]
rod = "rod_1"
at = "start"
move = [[0, [0, 0, 0]], ["2 s", [0, 0, "10 cm"]]]
turn = [[0, 0], ["1 min", "90 deg"]]
axis = [1, 1, 0]
pivot = [0, 0, 1]

[[clamps]]
rod = "strip"
at = 3
hold = "position"
angular_velocity = "15 rpm"

[[clamps]]
rod = "strip"
at = "end"
poses = [[0, [0, 0, 0], [1, 0, 0, 0]], ["2 s", [0, "1 cm", 0], [0.7, 0.7, 0.1, 0.1]]]

[[loads]]
kind = "gravity"
acceleration = [0, 0, -9.81]
schedule = [[0, 0], [1, 1]]

[[loads]]
kind = "force"
rod = "strip"
at = "end"
force = [0, "3 mN", 0]

[[loads]]
kind = "moment"
rod = "strip"
at = 2
moment = [0, "3 mN m", 0]

[[loads]]
kind = "distributed"
force_per_length = [0, 1, 0]

[[loads]]
kind = "drag"
rod = "ring"
translation = 0.1

[[actuation]]
rod = "strip"
kind = "curvature"
direction = 2
values = [[0, 0], ["1 min", "2 1/cm"]]
from = "1 cm"

[[actuation]]
rod = "strip"
kind = "twist"
amplitude = "90 deg/m"
wavelength = "3 cm"
frequency = "-2 Hz"
phase = "0.25 turn"
schedule = [[0, 0], [1, 1]]
to = 0.2

[[actuation]]
rod = "ring"
kind = "length"
amplitude = 0.1

[[planes]]
point = [0, 0, -3]
normal = [0, 1, 7]
friction = 0.3

[[planes]]
point = [0, 0, -4]
wall = false

[contact]
friction = 0.2
friction_at = "surface"

[fluid]
model = "rss"
viscosity = "0.1 Pa s"

[time]
scheme = "implicit-midpoint"
step = "auto"
end = "2 min"

[output]
vtk = true
"#;

#[test]
fn every_kind_reads_back_to_itself() {
    let scenario = read(EVERYTHING).unwrap_or_else(|error| panic!("{error}"));
    let again = read(&scenario.to_toml()).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(
        again,
        Scenario {
            title: scenario.title.clone(),
            ..scenario.clone()
        }
    );
    assert_eq!(again.to_toml(), scenario.to_toml());
}

#[test]
fn smooth_contact_reads_back_to_itself() {
    for model in ["imc", "ipc"] {
        let table = format!("[contact]\nmodel = \"{model}\"\ngeometry = \"smooth\"");
        let scenario = read(&format!("{BEAM}\n{table}")).unwrap_or_else(|error| panic!("{error}"));
        let text = scenario.to_toml();
        assert!(text.contains("geometry = \"smooth\""), "{text}");
        assert_eq!(read(&text).unwrap(), scenario);
    }
}

#[test]
fn inertia_is_consistent_by_default_where_that_gains() {
    let inertia = |text: &str| read(text).unwrap().rods[0].inertia;
    let with = |key: &str| BEAM.replace("edges = 50", &format!("edges = 50\n{key}"));
    let beside = |table: &str| format!("{BEAM}\n{table}");
    for text in [
        BEAM.to_owned(),
        with("inertia = \"auto\""),
        with("natural_shape = \"straight\""),
        with("natural_curvature = [0, 0]"),
        beside("[contact]\nmodel = \"none\""),
    ] {
        assert_eq!(inertia(&text), Inertia::Consistent, "{text}");
    }
    for text in [
        with("inertia = \"lumped\""),
        with("natural_curvature = [0, 0.1]"),
        with("natural_twist = 1.0"),
        beside("[contact]\nmodel = \"imc\""),
        beside("[fluid]\nmodel = \"resistive\"\nviscosity = 1.0"),
    ] {
        assert_eq!(inertia(&text), Inertia::Lumped, "{text}");
    }
    let both = with("inertia = \"consistent\"\nnatural_curvature = [0, 0.1]");
    assert_eq!(inertia(&both), Inertia::Consistent);
}

#[test]
fn defaults_follow_from_what_is_given() {
    let scenario = read(EVERYTHING).unwrap();
    let Contact::Imc {
        distance_tolerance, ..
    } = scenario.contact
    else {
        panic!("{:?}", scenario.contact);
    };
    // The strip has the smallest radius: half its thickness.
    assert_eq!(scenario.rods[1].radius, 0.5e-3);
    assert_eq!(distance_tolerance, 0.01 * 0.5e-3);
    assert_eq!(scenario.rods[1].material.density, 1180.0);
    assert_eq!(scenario.rods[1].stiffness.stretching, 7000.0);
    assert_eq!(
        scenario.rods[2].natural_shape,
        NaturalShape::Curve(Shape::Ring {
            centre: [0.0; 3],
            normal: [0.0, 0.0, 1.0],
            radius: 0.11
        })
    );
    assert!(scenario.rods[2].closed);
    assert_eq!(scenario.rods[3].edges, 2);
    assert_eq!(scenario.output.interval, Some(1.2));
    assert_eq!(
        scenario.parts.all::<Actuation>()[0].kind,
        ActuationKind::Curvature { direction: 2 }
    );
    let [high, low] = scenario.parts.all::<Actuation>()[2].course.extremes();
    assert_eq!([high, low], [0.1, -0.1]);
}

proptest! {
    #[test]
    fn resolved_numbers_read_back_exactly(
        radius in 1e-6..1e-1f64,
        pitch in 1e-3..1.0f64,
        turns in 0.1..20.0f64,
        phase in -400.0..400.0f64,
        axis in prop::array::uniform3(-1.0..1.0f64),
        end in 1e-3..1e3f64,
    ) {
        prop_assume!(axis.iter().any(|c| c.abs() > 1e-3));
        let text = EVERYTHING
            .replace("radius = \"1.6 mm\"", &format!("radius = {radius:?}"))
            .replace("pitch = \"7 cm\"", &format!("pitch = {pitch:?}"))
            .replace("turns = 2.3", &format!("turns = {turns:?}"))
            .replace("33 deg", &format!("{phase:?} deg"))
            .replace("axis = [1, 2, 3]", &format!("axis = {axis:?}"))
            .replace("2 min", &format!("{end:?} min"));
        let scenario = read(&text).unwrap();
        prop_assert_eq!(read(&scenario.to_toml()).unwrap(), scenario);
    }
}
