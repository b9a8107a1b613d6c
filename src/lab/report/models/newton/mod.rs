//! A scenario as a Python program for Newton 1.8.
//!
//! A rod becomes a chain of capsules with a rod joint at each inner node, `newton.Rod`, whose
//! stiffnesses are EA, EI and GJ over the length ℓ between the middles of its edges. Its curvature
//! 2 tan(φ/2)/ℓ with the angle φ between edges is that of `rodlab`. A clamp is a body that the program
//! moves, at half an edge from the middle of the first edge.
//!
//! Newton simulates rods with one solver, `SolverVBD`. It relaxes one body after the other in single
//! precision, and its results depend on the step h. Long steps leave bending unresolved as long as
//! the joints resist stretching more than the inertia of an edge, EA/ℓ > ρA ℓ/h². In short steps,
//! rounding of positions, 6e-8 L, is an acceleration 6e-8 L/h². The step is therefore a fixed part
//! of the time √(L/a) with the characteristic acceleration a, and EA is limited to ρA ℓ²/h².

mod clamps;

use super::left_out::{Phrases, left_out};
use super::refusals::{Abilities, clamps_of, represented};
use super::scene_model::SceneModel;
use super::surroundings::{capsules, friction, gravity, half_spaces};
use crate::run::{Mode, PreparedRun};
use clamps::HeldNode;
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::scene::{NaturalShape, RodDescription, Scene};
use rodlab_files::origin::VERSION;
use std::f64::consts::TAU;
use std::fmt::Write;

/// Time step relative to √(L/a).
const STEP: f64 = 1.6e-3;
/// Acceleration of an elastic rod, relative to EI/(ρA L³).
const ELASTIC: f64 = 10.0;
/// Rate at which a scene that is to come to rest is slowed down, relative to √(a/L).
const DRAG: f64 = 2.0;
/// Time after which it is at rest, relative to √(L/a).
const REST: f64 = 12.0;
/// Least moment of inertia of a body, kg m². Newton replaces tensors with one below 1e-10.
const INERTIA: f64 = 1.1e-10;
/// Iterations of the solver in a step, for rods of as many edges as given and for longer ones.
const ITERATIONS: (usize, usize, usize) = (10, 50, 20);

const ABILITIES: Abilities = Abilities {
    simulator: "Newton",
    not_closed: None,
    bent: true,
};

/// The part of the program that is the same for all scenarios.
const PROGRAM: &str = include_str!("program.py");

/// The model of a scenario for Newton.
///
/// # Errors
/// The keys of a scene of which a model would mean something else, a sentence each.
pub fn newton(prepared: &PreparedRun) -> Result<SceneModel, Vec<String>> {
    let scene = &prepared.scene;
    let moving = represented(prepared, ABILITIES, |index| index)?;
    let times = Times::of(prepared, &moving);
    let rods: Vec<Rod> = (moving.iter().enumerate())
        .map(|(number, index)| Rod::of(scene, *index, number, times))
        .collect();
    Ok(SceneModel {
        text: written(prepared, &rods, times),
        left_out: left_out(prepared, phrases(scene, &rods, times)),
    })
}

/// Times of a simulation.
#[derive(Clone, Copy, Debug)]
struct Times {
    /// Time step, s.
    step: f64,
    /// Number of steps between outputs, a multiple of 2.
    output_every: usize,
    /// Number of all steps.
    steps: usize,
    /// Rate at which bodies are slowed down, 1/s.
    drag: f64,
}

impl Times {
    fn of(prepared: &PreparedRun, rods: &[usize]) -> Self {
        let scene = &prepared.scene;
        let units = rods.iter().map(|rod| unit(scene, &scene.rods[*rod]));
        let [shortest, longest] = units.fold([f64::INFINITY, 0.0_f64], |[least, most], unit| {
            [least.min(unit), most.max(unit)]
        });
        let longest_step = STEP * shortest;
        let (end, interval, drag) = match prepared.mode {
            Mode::Dynamic { end, .. } => (end, prepared.output.interval, 0.0),
            _ => (REST * longest, REST * longest, DRAG / longest),
        };
        // The program takes two steps before the first output, and two steps at a time.
        let between = interval.min(end).max(4.0 * longest_step);
        let output_every = 2 * ((between / (2.0 * longest_step)).ceil() as usize).max(2);
        Self {
            step: between / output_every as f64,
            output_every,
            steps: output_every * ((end / between).round() as usize).max(1),
            drag,
        }
    }
}

/// The time √(L/a) of a rod, s. The acceleration a is that of its weight or that of elastic forces,
/// 10 EI/(ρA L³), if that is larger.
fn unit(scene: &Scene, rod: &RodDescription) -> f64 {
    let length: f64 = edges(rod).iter().sum();
    let elastic = ELASTIC * rod.stiffness.bending[0] / (rod.mass_per_length * length.powi(3));
    (length / gravity(scene).norm().max(elastic)).sqrt()
}

/// The larger one of the weight of a rod and of the load 4π² EI/L² that buckles it between clamps, N.
fn largest_force(scene: &Scene, rod: &RodDescription) -> f64 {
    let length: f64 = edges(rod).iter().sum();
    let weight = rod.mass_per_length * length * gravity(scene).norm();
    let buckling = TAU * TAU * rod.stiffness.bending[0] / (length * length);
    weight.max(buckling)
}

/// Lengths of the edges of a rod, m.
fn edges(rod: &RodDescription) -> Vec<f64> {
    let nodes = &rod.centreline;
    let last = nodes.len() - usize::from(!rod.closed);
    let edge = |k: usize| (nodes[(k + 1) % nodes.len()] - nodes[k]).norm();
    (0..last).map(edge).collect()
}

/// A rod in the program.
struct Rod<'a> {
    described: &'a RodDescription,
    /// Stiffness against stretching, N.
    stretching: f64,
    /// Stiffness of contacts, N/m.
    contact: f64,
    held: Vec<HeldNode>,
    /// Nodes and masses, kg.
    masses: Vec<(usize, f64)>,
    /// Index among the rods of the program.
    number: usize,
}

impl<'a> Rod<'a> {
    fn of(scene: &'a Scene, index: usize, number: usize, times: Times) -> Self {
        let described = &scene.rods[index];
        let shortest = edges(described).into_iter().fold(f64::INFINITY, f64::min);
        let contact = described.mass_per_length * shortest / times.step.powi(2);
        let carried = scene.bodies.iter();
        let carried = carried.filter(|body| body.at.rod == index && body.inertia.is_none());
        let end = times.step * times.steps as f64;
        let clamps = clamps_of(scene, index).into_iter();
        Self {
            described,
            stretching: described.stiffness.stretching.min(contact * shortest),
            contact,
            held: clamps
                .filter(|clamp| clamp.holds_position)
                .map(|clamp| HeldNode::of(described, clamp, end, times.drag > 0.0))
                .collect(),
            masses: carried.map(|body| (body.at.node, body.mass)).collect(),
            number,
        }
    }
}

/// What differs from the scenario in Newton.
fn phrases(scene: &Scene, rods: &[Rod], times: Times) -> Phrases {
    let mut always = Vec::new();
    for rod in rods {
        let own = rod.described.stiffness.stretching;
        if rod.stretching < own {
            let strain = 100.0 * largest_force(scene, rod.described) / rod.stretching;
            always.push(format!(
                "stretching of {}: EA is {:.4} N instead of {own:.4} N, so that the solver \
                 converges; its weight or the load that buckles it strains it by {strain:.1} %",
                rod.described.name, rod.stretching
            ));
        }
    }
    for rod in rods {
        let described = rod.described;
        let shortest = edges(described).into_iter().fold(f64::INFINITY, f64::min);
        let across = described.mass_per_length * shortest.powi(3) / 12.0;
        let along = described.rotational_inertia_per_length * shortest;
        if across.min(along) < INERTIA {
            always.push(format!(
                "moments of inertia of edges of {} below {INERTIA:e} kg m², the least in Newton",
                described.name
            ));
        }
    }
    let usual = friction(scene);
    let has_other = half_spaces(scene).any(|plane| plane.friction != usual)
        || capsules(scene).iter().any(|one| one.friction != usual);
    let more = (usual == 0.0 && has_other)
        .then(|| "friction with planes and obstacles: the rods have none of their own".to_owned());
    Phrases {
        always,
        contact: "contact: Newton's contact with the same friction replaces the contact model",
        forces: "loads: forces; set `body_f` of the states in `simulate`",
        rest: format!(
            "the search for equilibria: bodies are slowed down at a rate of {:.3} 1/s until they \
             are at rest",
            times.drag
        ),
        more: more.into_iter().collect(),
    }
}

/// The program.
fn written(prepared: &PreparedRun, rods: &[Rod], times: Times) -> String {
    let scene = &prepared.scene;
    let name: String = prepared.name.chars().filter(|c| !c.is_control()).collect();
    let usual = friction(scene);
    let contact = rods.iter().map(|rod| rod.contact).fold(0.0, f64::max);
    let most = rods.iter().map(|rod| rod.described.centreline.len()).max();
    let (few, up_to, many) = ITERATIONS;
    let is_short = most.is_none_or(|nodes| nodes <= up_to + 1);
    let collide = if scene.contact.is_some() {
        "True"
    } else {
        "False"
    };
    let mut text = format!(
        "# rodlab {VERSION}: {name}, for Newton 1.8\n\
         \"\"\"The rods of a scenario. Run as a program, it simulates them and prints their nodes.\"\"\"\n\n\
         import math\n\nimport newton\nimport numpy as np\nimport warp as wp\n\n\
         STEP = {:?}  # s; bending is wrong in longer ones, and rounding in shorter ones\n\
         OUTPUT_EVERY = {}  # steps; a multiple of 2, at least 4\n\
         STEPS = {}\n\
         ITERATIONS = {}  # of the solver in a step\n\
         GRAVITY = {}  # m/s²\n\
         DRAG = {:?}  # 1/s; brings rods to rest that are to be in equilibrium\n\
         COLLIDE = {collide}\n\
         FRICTION = {usual:?}  # between rods\n\
         CONTACT = {contact:?}  # N/m; stiffness of contacts\n\
         INERTIA = {INERTIA:?}  # kg m²; the least, as Newton adds 1e-6 to ones below 1e-10\n\
         # EA in N, EI and GJ in N m², mass in kg/m, spin (moment of inertia about the centreline)\n\
         # in kg m, damping (viscosity over modulus) in s, lengths in m. Rods are without stress as\n\
         # placed, or if they are straight.\n\
         RODS = [\n",
        times.step,
        times.output_every,
        times.steps,
        if is_short { few } else { many },
        tuple(gravity(scene)),
        times.drag,
    );
    for rod in rods {
        write_rod(&mut text, rod);
    }
    text += "]\n# The place and the tangent at time zero. A path has a time, s, a place and a rotation (quaternion\n\
             # x, y, z, w) in each row, and is linear between them.\nCLAMPS = [\n";
    for rod in rods {
        rod.held
            .iter()
            .for_each(|held| held.write(&mut text, rod.number));
    }
    text += "]\nMASSES = [\n";
    for rod in rods {
        for (node, mass) in &rod.masses {
            _ = writeln!(
                text,
                "    {{\"rod\": {}, \"node\": {node}, \"mass\": {mass:?}, \"tangent\": None}},  # kg",
                rod.number
            );
        }
    }
    // Newton takes the geometric mean of the coefficients of two surfaces.
    let own = |friction: f64| {
        if usual > 0.0 {
            friction * friction / usual
        } else {
            friction
        }
    };
    text += "]\nPLANES = [\n";
    for plane in half_spaces(scene) {
        _ = writeln!(
            text,
            "    {{\"point\": {}, \"normal\": {}, \"friction\": {:?}}},",
            tuple(plane.point),
            tuple(plane.normal),
            own(plane.friction)
        );
    }
    text += "]\nCAPSULES = [\n";
    for capsule in capsules(scene) {
        let [from, to] = capsule.ends.map(tuple);
        _ = writeln!(
            text,
            "    {{\"ends\": [{from}, {to}], \"radius\": {:?}, \"friction\": {:?}}},",
            capsule.radius,
            own(capsule.friction)
        );
    }
    text += "]\n";
    text + PROGRAM
}

fn write_rod(text: &mut String, rod: &Rod) {
    let described = rod.described;
    let truth = |is_true: bool| if is_true { "True" } else { "False" };
    let straight = !matches!(described.natural_shape, NaturalShape::AsPlaced);
    _ = writeln!(
        text,
        "    {{\n        \"name\": {},\n        \"radius\": {:?},\n        \"EA\": {:?},\n        \
         \"EI\": {:?},\n        \"GJ\": {:?},\n        \"mass\": {:?},\n        \"spin\": {:?},\n        \
         \"damping\": {:?},\n        \"closed\": {},\n        \"straight\": {},\n        \"points\": [",
        quoted(&described.name),
        described.radius,
        rod.stretching,
        described.stiffness.bending[0],
        described.stiffness.twisting,
        described.mass_per_length,
        described.rotational_inertia_per_length,
        described.retardation_time,
        truth(described.closed),
        truth(straight)
    );
    for node in &described.centreline {
        _ = writeln!(text, "            {},", tuple(*node));
    }
    *text += "        ],\n    },\n";
}

/// A vector in Python.
fn tuple(vector: Vector3) -> String {
    let [x, y, z] = [vector.x + 0.0, vector.y + 0.0, vector.z + 0.0];
    format!("({x:?}, {y:?}, {z:?})")
}

/// A text in Python, whose escapes are those of JSON.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::{from_text, prepare};

    const CANTILEVER: &str = r#"
        experiment = "scene"
        material = { youngs_modulus = "100 MPa", poissons_ratio = 0.5, density = 1000.0 }
        time = { end = "1 s" }
        output = { interval = "0.1 s" }
        rods = [{ name = "beam", radius = "5 mm", edges = 4, shape = { kind = "straight", start = [0, 0, 0], end = [1, 0, 0] } }]
        clamps = [{ rod = "beam", at = "start", turn = [[0, 0], [0.5, 1]] }]
        loads = [{ kind = "gravity", acceleration = [0, 0, -9.81] }]
    "#;

    fn model(overrides: &[&str]) -> Result<SceneModel, Vec<String>> {
        let overrides: Vec<String> = overrides.iter().map(|key| (*key).to_owned()).collect();
        let loaded = from_text("cantilever", CANTILEVER, ".".as_ref(), &overrides).unwrap();
        newton(&prepare(&loaded.scenario).unwrap())
    }

    /// The number after a name in a program.
    fn number(text: &str, name: &str) -> f64 {
        let rest = text.split_once(name).unwrap().1;
        let end = rest.find([',', '\n', ' ', '}']).unwrap();
        rest[..end].parse().unwrap()
    }

    #[test]
    fn the_program_has_the_stiffnesses_and_the_path_of_the_clamp() {
        let text = model(&[]).unwrap().text;
        let area = std::f64::consts::PI * 25e-6;
        let bending = 100e6 * area * 25e-6 / 4.0;
        for (name, expected) in [
            ("\"EI\": ", bending),
            ("\"GJ\": ", bending / 1.5),
            ("\"mass\": ", 1000.0 * area),
            ("\"EA\": ", 100e6 * area),
        ] {
            assert!(
                (number(&text, name) / expected - 1.0).abs() < 1e-12,
                "{name}"
            );
        }
        let steps = number(&text, "\nSTEPS = ");
        let every = number(&text, "OUTPUT_EVERY = ");
        assert!((number(&text, "\nSTEP = ") * every - 0.1).abs() < 1e-12);
        assert!(steps == 10.0 * every && every % 2.0 == 0.0);
        // Half of a radian about the tangent at a quarter of the time.
        let row = text.lines().find(|line| line.contains("(0.3,")).unwrap();
        let row = row.trim().trim_matches(['(', ')', ',']);
        let row: Vec<f64> = row.split(", ").map(|word| word.parse().unwrap()).collect();
        assert_eq!(row.len(), 8);
        assert!((row[4] - libm::sin(0.3)).abs() < 1e-9, "{row:?}");
        assert!((row[7] - libm::cos(0.3)).abs() < 1e-9, "{row:?}");
    }

    #[test]
    fn stretching_is_as_soft_as_the_solver_needs_and_the_change_is_listed() {
        let model = model(&["rods.beam.edges=40"]).unwrap();
        let stretching = number(&model.text, "\"EA\": ");
        let step = number(&model.text, "\nSTEP = ");
        let inertia = number(&model.text, "\"mass\": ") * (0.025 / step).powi(2);
        assert!((stretching / inertia - 1.0).abs() < 1e-9);
        assert!(stretching < 0.1 * 7854.0);
        assert!(
            model.left_out[0].contains("stretching of beam"),
            "{:?}",
            model.left_out
        );
    }

    #[test]
    fn rods_that_are_straight_without_stress_may_be_placed_bent_but_not_twisted() {
        let bent = "rods.beam.shape={ kind = \"points\", points = [[0,0,0],[0.1,0,0],[0.2,0.1,0],[0.2,0.2,0],[0.2,0.3,0]] }";
        let straight = "rods.beam.natural_shape=\"straight\"";
        let text = model(&[bent, straight]).unwrap().text;
        assert!(text.contains("\"straight\": True"));
        let refused = |overrides: &[&str], key: &str| {
            let faults = model(overrides).unwrap_err();
            let found = faults.iter().any(|fault| fault.starts_with(key));
            assert!(found, "{faults:?}");
        };
        refused(
            &[bent, straight, "rods.beam.twist=1"],
            "rods.beam.natural_shape",
        );
        refused(
            &["rods.beam.cross_section={ kind = \"rectangle\", width = 0.02, thickness = 0.01 }"],
            "rods.beam.cross_section",
        );
        refused(&["clamps.0.at=2"], "rods.beam.name: a clamp");
    }

    #[test]
    fn friction_with_a_plane_is_the_geometric_mean_of_two_coefficients() {
        let text = model(&[
            "contact={ friction = 0.4 }",
            "planes=[{ point = [0, 0, -1], normal = [0, 0, 1], friction = 0.2 }]",
        ])
        .unwrap()
        .text;
        assert!(text.contains("COLLIDE = True"));
        let plane = text.split_once("PLANES").unwrap().1;
        let mean = (number(&text, "\nFRICTION = ") * number(plane, "\"friction\": ").abs()).sqrt();
        assert!((mean - 0.2).abs() < 1e-12);
    }
}
