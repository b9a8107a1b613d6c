//! A scenario as a model of MuJoCo 4 (MJCF).
//!
//! A rod becomes a one-dimensional flex, which MuJoCo simulates as a discrete elastic rod: a body
//! with three slides for each free node, and a hinge for the twist of each free edge. Flexes are
//! round, so that Young's modulus and the shear modulus follow from the stiffnesses and the radius
//! h of the contact surface,
//!
//! ```text
//! E = 4 EI/(π h⁴),      G = 2 GJ/(π h⁴)
//! ```
//!
//! A clamp that holds the frame of an end gets a short edge before it. The stiffness of a node is
//! divided by half the lengths of its edges, so that this edge leaves half an edge at the clamp, as
//! in `rodlab`. Rods are without stress as placed, and edges keep their lengths.

mod flex;

use super::left_out::{Phrases, left_out};
use super::refusals::{Abilities, represented};
use super::scene_model::SceneModel;
use super::surroundings::{Capsule, capsules, friction, gravity, half_spaces};
use crate::run::{Mode, PreparedRun};
use flex::Flex;
use rodlab_engine::mechanics::scene::{RodDescription, Scene};
use rodlab_files::figure::escape;
use rodlab_files::origin::VERSION;
use std::fmt::Write;

/// Time step relative to the time √(ρA L⁴/EI) of a rod and to the length of its edges; the error of
/// the lengths of edges grows with it.
const STEP: f64 = 0.03;
/// Damping time of rods that are to come to rest, relative to √(ρA L⁴/EI). The slowest vibration of a
/// cantilever, whose frequency is 3.52 over that time, has then the damping ratio 0.88.
const RESTING: f64 = 0.5;

const ABILITIES: Abilities = Abilities {
    simulator: "MuJoCo",
    not_closed: Some("closed rods have no twist in MuJoCo; cut the rod open and clamp its ends"),
    bent: false,
};

/// The model of a scenario for MuJoCo.
///
/// # Errors
/// The keys of a scene of which a model would mean something else, a sentence each.
pub fn mjcf(prepared: &PreparedRun) -> Result<SceneModel, Vec<String>> {
    let scene = &prepared.scene;
    let flexes = represented(prepared, ABILITIES, |index| {
        Flex::of(scene, index, damping(prepared, &scene.rods[index]))
    })?;
    let step = scene.rods.iter().map(step_of).fold(f64::INFINITY, f64::min);
    Ok(SceneModel {
        text: written(prepared, &flexes, step),
        left_out: left_out(prepared, phrases(&flexes)),
    })
}

/// What differs from the scenario in MuJoCo.
fn phrases(flexes: &[Flex]) -> Phrases {
    let longest = flexes.iter().map(|flex| flex.damping).fold(0.0, f64::max);
    let moving = flexes.iter().flat_map(Flex::moving);
    let moving: Vec<&str> = moving.map(|(name, _)| name).collect();
    let paths = format!(
        "paths of clamps: set `mocap_pos` and `mocap_quat` of {}",
        moving.join(", ")
    );
    Phrases {
        always: vec!["stretching: edges keep their lengths".into()],
        contact: "contact: MuJoCo's soft contact with the same friction replaces the contact \
                  model; rods do not touch themselves",
        forces: "loads: forces; set `xfrc_applied` of the bodies of nodes",
        rest: format!(
            "the search for equilibria: a damping time of {longest:.3} s brings the rods to rest"
        ),
        more: (!moving.is_empty()).then_some(paths).into_iter().collect(),
    }
}

/// The time √(ρA L⁴/EI) of a rod, s.
fn unit(rod: &RodDescription) -> f64 {
    let length: f64 = rod
        .centreline
        .windows(2)
        .map(|ends| (ends[1] - ends[0]).norm())
        .sum();
    length * length * (rod.mass_per_length / rod.stiffness.bending[0]).sqrt()
}

fn step_of(rod: &RodDescription) -> f64 {
    if rod.held {
        return f64::INFINITY;
    }
    STEP / rod.centreline.len() as f64 * unit(rod)
}

/// Damping time of a rod, s: that of the scenario; for a scene that is to come to rest, at least
/// what brings it there.
fn damping(prepared: &PreparedRun, rod: &RodDescription) -> f64 {
    match prepared.mode {
        Mode::Dynamic { .. } => rod.retardation_time,
        _ => rod.retardation_time.max(RESTING * unit(rod)),
    }
}

/// Numbers with a space between them.
fn list<'a>(numbers: impl IntoIterator<Item = &'a f64>) -> String {
    let words: Vec<String> = numbers.into_iter().map(|x| (x + 0.0).to_string()).collect();
    words.join(" ")
}

fn written(prepared: &PreparedRun, flexes: &[Flex], step: f64) -> String {
    let scene = &prepared.scene;
    let mut text = format!(
        "<!-- rodlab {VERSION}: {}, for MuJoCo 4 or later -->\n<mujoco model=\"{}\">\n",
        escape(&prepared.name).replace("--", "-"),
        escape(&prepared.name)
    );
    let contact = match scene.contact {
        Some(_) => "enable",
        None => "disable",
    };
    _ = writeln!(
        text,
        "  <option timestep=\"{step}\" integrator=\"discrete\" tolerance=\"1e-12\" gravity=\"{}\">\n    \
         <flag contact=\"{contact}\"/>\n  </option>\n  <worldbody>",
        list(gravity(scene).iter())
    );
    text += &surroundings(scene);
    flexes.iter().for_each(|flex| flex.write_bodies(&mut text));
    text += "  </worldbody>\n  <deformable>\n";
    let friction = friction(scene);
    (flexes.iter()).for_each(|flex| flex.write(&mut text, friction));
    text += "  </deformable>\n  <equality>\n";
    (flexes.iter()).for_each(|flex| flex.write_constraints(&mut text, 2.0 * step));
    text += "  </equality>\n</mujoco>\n";
    text
}

/// The geoms of a scene.
fn surroundings(scene: &Scene) -> String {
    let mut text = String::new();
    for plane in half_spaces(scene) {
        _ = writeln!(
            text,
            "    <geom type=\"plane\" size=\"0 0 0.01\" pos=\"{}\" zaxis=\"{}\" friction=\"{} 0.005 0.0001\"/>",
            list(plane.point.iter()),
            list(plane.normal.iter()),
            plane.friction
        );
    }
    for Capsule {
        ends,
        radius,
        friction,
    } in capsules(scene)
    {
        let [from, to] = ends;
        let friction = format!("friction=\"{friction} 0.005 0.0001\"");
        _ = if from == to {
            let centre = list(from.iter());
            writeln!(
                text,
                "    <geom type=\"sphere\" size=\"{radius}\" pos=\"{centre}\" {friction}/>"
            )
        } else {
            let ends = list(from.iter().chain(to.iter()));
            writeln!(
                text,
                "    <geom type=\"capsule\" size=\"{radius}\" fromto=\"{ends}\" {friction}/>"
            )
        };
    }
    text
}

#[cfg(test)]
mod tests {
    use super::flex::SHORT;
    use super::*;
    use crate::experiment::{from_text, prepare};

    const CANTILEVER: &str = r#"
        experiment = "scene"
        material = { youngs_modulus = "100 MPa", poissons_ratio = 0.5, density = 1000.0 }
        time = { mode = "static" }
        rods = [{ name = "beam", radius = "5 mm", edges = 4, shape = { kind = "straight", start = [0, 0, 0], end = [1, 0, 0] } }]
        clamps = [{ rod = "beam", at = "start" }]
        loads = [{ kind = "gravity", acceleration = [0, 0, -9.81] }]
    "#;

    fn model(text: &str, overrides: &[&str]) -> Result<SceneModel, Vec<String>> {
        let overrides: Vec<String> = overrides.iter().map(|key| (*key).to_owned()).collect();
        let loaded = from_text("cantilever", text, ".".as_ref(), &overrides).unwrap();
        mjcf(&prepare(&loaded.scenario).unwrap())
    }

    #[test]
    fn a_cantilever_has_a_short_clamped_edge_and_the_moduli_of_its_material() {
        let model = model(CANTILEVER, &[]).unwrap();
        let has = |part: &str| assert!(model.text.contains(part), "{part}\n{}", model.text);
        has("body=\"world world beam_1 beam_2 beam_3 beam_4\"");
        has("element=\"0 1 1 2 2 3 3 4 4 5\"");
        has(&format!("vertex=\"{} 0 0 0 0 0 ", -SHORT * 0.25));
        has("gravity=\"0 0 -9.81\"");
        has("<body name=\"beam_twist_1\">");
        has("<body name=\"beam_twist\">");
        assert!(!model.text.contains("beam_twist_0") && !model.text.contains("beam_twist_4"));
        let number = |attribute: &str| -> f64 {
            let rest = model.text.split_once(&format!("{attribute}=\"")).unwrap().1;
            rest.split('"').next().unwrap().parse().unwrap()
        };
        assert!((number("young") / 100e6 - 1.0).abs() < 1e-12);
        assert!((number("shear") / (100e6 / 3.0) - 1.0).abs() < 1e-12);
        let masses = model.text.split("mass=\"").skip(1);
        let masses = masses.map(|rest| rest.split('"').next().unwrap().parse::<f64>().unwrap());
        let masses: Vec<f64> = masses.take(4).collect();
        let edge = 1000.0 * std::f64::consts::PI * 25e-6 * 0.25;
        for (mass, part) in masses.iter().zip([1.0, 1.0, 1.0, 0.5]) {
            assert!((mass / (part * edge) - 1.0).abs() < 1e-12, "{mass}");
        }
    }

    #[test]
    fn scenes_that_would_mean_something_else_are_refused_by_key() {
        let refused = |overrides: &[&str], key: &str| {
            let faults = model(CANTILEVER, overrides).unwrap_err();
            assert!(
                faults.iter().any(|fault| fault.starts_with(key)),
                "{faults:?}"
            );
        };
        refused(
            &[
                "rods.beam.shape={ kind = \"points\", points = [[0,0,0],[0.1,0,0],[0.2,0.1,0],[0.2,0.2,0],[0.2,0.3,0]] }",
                "rods.beam.natural_shape=\"straight\"",
            ],
            "rods.beam.natural_shape",
        );
        refused(
            &["rods.beam.cross_section={ kind = \"rectangle\", width = 0.02, thickness = 0.01 }"],
            "rods.beam.cross_section",
        );
        refused(&["clamps.0.at=2"], "rods.beam.name: a clamp");
    }

    #[test]
    fn the_rest_is_listed() {
        let model = model(
            CANTILEVER,
            &["loads=[{ kind = \"force\", rod = \"beam\", at = \"end\", force = [0, 0, 1] }]"],
        )
        .unwrap();
        for word in ["stretching", "force", "rest"] {
            assert!(
                model.left_out.iter().any(|line| line.contains(word)),
                "{word} {:?}",
                model.left_out
            );
        }
    }
}
