//! Rods, grippers, weight and table of a deployment.

use super::gripper_path::GripperPath;
use super::keys::{Deployment, Rod};
use super::knot_proof::knot_of_patterns;
use super::laid_rod::{POINTS, PatternMark};
use super::monitor::{Watched, WatchedRod};
use super::outcome::DerivedDeployment;
use super::paths::DeploymentPaths;
use super::pegs;
use crate::experiment::on_table;
use crate::experiment::prepare::round_rod;
use crate::scenario::{BuilderRod, Scenario};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::scene::{Clamp, NaturalShape, RodDescription, Scene};
use std::ops::Range;

/// Adds all of them.
pub fn add(scene: &mut Scene, deployment: &Deployment, paths: &DeploymentPaths, friction: f64) {
    let is_single = paths.rods.len() == 1;
    for (number, (rod, path)) in deployment.rods().zip(&paths.rods).enumerate() {
        let name = match number {
            0 if is_single => "rod",
            0 => "first_rod",
            _ => "second_rod",
        };
        scene.clamps.push(Clamp {
            rod: scene.rods.len(),
            node: rod.edges,
            holds_position: true,
            holds_frame: true,
            motion: path.motion(),
        });
        scene.rods.push(described(name, rod, path));
    }
    let standing = deployment.pegs.iter().enumerate();
    let standing = standing.map(|(number, peg)| pegs::post(&format!("peg_{}", number + 1), peg));
    scene.rods.extend(standing);
    on_table::add_table(scene, friction);
}

fn described(name: &str, rod: &Rod, path: &GripperPath) -> RodDescription {
    let material = on_table::material(&rod.deployed(), rod.density);
    let section = BuilderRod {
        radius: rod.radius,
        nodes: rod.edges + 1,
    };
    let straight = (0..=rod.edges)
        .map(|node| Vector3::x() * (rod.length * node as f64 / rod.edges as f64))
        .collect();
    RodDescription {
        end_tangents: [None, Some(path.first_direction())],
        natural_shape: NaturalShape::Centreline(straight),
        ..round_rod(name, path.start.clone(), &material, &section)
    }
}

/// The nodes of each rod, numbered over the whole scene, which begins with these rods.
pub fn nodes(deployment: &Deployment) -> Vec<Range<usize>> {
    let mut begin = 0;
    let nodes = deployment.rods().map(|rod| {
        let nodes = begin..begin + rod.edges + 1;
        begin = nodes.end;
        nodes
    });
    nodes.collect()
}

/// The clamps of the scene that represent the grippers that lay rods.
pub fn gripper_clamps(deployment: &Deployment, scene: &Scene) -> Vec<usize> {
    let clamp_of = |(number, rod): (usize, &Rod)| {
        let holds = |clamp: &Clamp| clamp.rod == number && clamp.node == rod.edges;
        let clamp = scene.clamps.iter().position(holds);
        clamp.expect("the gripper of a rod that is laid")
    };
    deployment.rods().enumerate().map(clamp_of).collect()
}

/// Height below which a node lies on the table, m.
pub fn lying_height(scenario: &Scenario, rod: &Rod) -> f64 {
    let tolerance = scenario.contact.distance_tolerance().unwrap_or(0.0);
    rod.radius + 2.0 * tolerance
}

/// Parameters of the monitor.
pub fn watched(scenario: &Scenario, deployment: &Deployment, paths: &DeploymentPaths) -> Watched {
    let layings = deployment.layings();
    let rods = layings.iter().zip(&paths.rods).zip(nodes(deployment));
    let rods = rods.map(|((laying, path), nodes)| WatchedRod {
        marks: marks(laying, path),
        length: laying.rod.length,
        nodes,
        lying_height: lying_height(scenario, &laying.rod),
        laid: path.laid.clone(),
        derived: derived(laying, path),
    });
    Watched {
        rods: rods.collect(),
        friction: scenario.contact.friction(),
        outline: if deployment.pegs.is_empty() {
            Vec::new()
        } else {
            pegs::outline(&paths.rods[0].curve)
        },
        pegs: deployment.pegs.clone(),
        knot: paths.tying.as_ref().map(|tying| {
            let curves = layings.iter().map(|laying| laying.whole_pattern().ok());
            knot_of_patterns(&curves.collect::<Option<Vec<_>>>()?, &tying.passages)
        }),
    }
}

/// The compared points of a pattern.
fn marks(deployment: &Deployment, path: &GripperPath) -> Vec<PatternMark> {
    let from = deployment.lead_in;
    let mark = |index: usize| {
        let s = from + (path.length - from) * index as f64 / (POINTS - 1) as f64;
        PatternMark {
            s,
            position: path.curve.at(s).position.into(),
        }
    };
    (0..POINTS).map(mark).collect()
}

/// Friction demand of a pattern.
fn derived(deployment: &Deployment, path: &GripperPath) -> DerivedDeployment {
    let asked = &path.feasibility;
    DerivedDeployment {
        pattern_length: path.length,
        lead_in: deployment.lead_in,
        least_radius: Some(asked.least_radius_m).filter(|radius| radius.is_finite()),
        largest_friction_demand: asked.largest_demand,
        share_above_friction: asked.share_above_friction.unwrap_or(0.0),
        largest_gripper_speed: path.largest_speed(),
    }
}
