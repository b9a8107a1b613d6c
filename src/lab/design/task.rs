//! From a scenario and a curve to the natural strains, and their check.

use super::curve::Spline;
use super::error::DesignError;
use super::unloaded::unloaded;
use crate::experiment;
use crate::run::PreparedRun;
use crate::scenario::{
    CaseSet, Inertia, Loaded, NaturalShape, Scenario, Shape, Strains, read_polyline,
};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::{IntegrationParameters, Simulation};
use rodlab_engine::mechanics::scene::{self, NaturalStrains, Scene};
use rodlab_engine::mechanics::statics::natural_strains;
use serde::Serialize;
use std::path::Path;

/// Difference of the lengths of curve and rod that is allowed, over the length of the rod.
const LENGTHS: f64 = 0.01;
/// Residual of the check, over the forces of the rod.
const FORCE_TOLERANCE: f64 = 1e-11;
/// Displacement of the perturbed start, over the length of the rod, and its direction.
const PERTURBATION: f64 = 0.01;
const DIRECTION: [f64; 3] = [0.6, 0.48, 0.64];
/// Distance over the length below which both starts lead to the same equilibrium.
const SAME: f64 = 1e-6;
/// Natural curvature times radius from which the theory of slender rods is inaccurate.
const SLENDER: f64 = 0.1;

/// What is wanted.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a> {
    /// The scenario, of one case.
    pub scenario: &'a CaseSet,
    /// CSV file of the wanted curve, from the first node of the rod to its last.
    pub shape: &'a Path,
    /// The key to find: `rods.NAME.natural_curvature`.
    pub vary: &'a str,
}

/// A natural shape and its check.
#[derive(Clone, Debug, Serialize)]
pub struct Designed {
    /// Name of the rod.
    pub rod: String,
    /// Its edges.
    pub edges: usize,
    /// Length of the wanted curve, m.
    pub curve_length_m: f64,
    /// Natural length of the designed rod, m.
    pub natural_length_m: f64,
    /// Natural length of the rod in the scenario, m.
    pub length_before_m: f64,
    /// Largest distance of a node in equilibrium from the wanted curve, m.
    pub distance_m: f64,
    /// The same over the length.
    pub distance_over_length: f64,
    /// The same of the equilibrium that a displaced start leads to, m; none where it leads to none.
    pub distance_from_displaced_start_m: Option<f64>,
    /// Directions in which the energy of the equilibrium falls: 0 where it is stable; none with friction and rigid contact.
    pub unstable_directions: Option<usize>,
    /// Largest natural curvature, 1/m.
    pub natural_curvature_per_m: f64,
    /// The same times the radius.
    pub curvature_times_radius: f64,
    /// Largest natural twist, rad/m.
    pub natural_twist_rad_per_m: f64,
    /// Largest strain of stretching in the wanted shape.
    pub stretching_strain: f64,
    /// Largest force that is not in balance in the wanted shape, N.
    pub residual_n: f64,
    /// What limits the design.
    pub remarks: Vec<String>,
    /// The scenario with the natural shape.
    #[serde(skip)]
    pub scenario_toml: String,
    /// Natural strains at the nodes.
    #[serde(skip)]
    pub natural: NaturalStrains,
    /// Nodes of the wanted curve, in equilibrium, and without stress, m.
    #[serde(skip)]
    pub nodes: [Vec<Vector3>; 3],
}

/// Finds the natural shape and checks it by the equilibrium of the scenario.
///
/// # Errors
/// [`DesignError`]: a curve that does not fit the rod, a key that does not suit, and a curve that no natural shape holds.
pub fn design(request: &Request<'_>) -> Result<Designed, DesignError> {
    let loaded = request.scenario.scenario_with(&[])?;
    let mut scenario = loaded.scenario.clone();
    let index = rod_of(request.vary, &scenario)?;
    let before = prepared(&loaded, &scenario)?;
    let built = before.scene.rods.len() - scenario.rods.len();
    let rod = built + index;
    let edges = scenario.rods[index].edges;
    if scenario.rods[index].closed {
        let message = format!("{}: the rod is closed; allowed: an open rod", request.vary);
        return Err(DesignError::Input(message));
    }
    let length_before = length(&before.scene.rods[rod].centreline);
    let curve = read_polyline(request.shape).map_err(DesignError::Input)?;
    let spline = Spline::new(&curve.into_iter().map(Vector3::from).collect::<Vec<_>>());
    let nodes = spline.nodes(edges);
    let curve_length = length(&nodes);
    let longer = curve_length / length_before - 1.0;
    if longer.abs() > LENGTHS {
        return Err(DesignError::Input(format!(
            "{}: the curve is {curve_length:.6} m long and the rod {length_before:.6} m ({:+.2} %); allowed: a difference of {:.0} % at most. Change the length of the rod or scale the curve",
            request.shape.display(),
            100.0 * longer,
            100.0 * LENGTHS
        )));
    }
    let target = &mut scenario.rods[index];
    target.shape = Shape::Points {
        points: nodes.iter().map(|node| (*node).into()).collect(),
    };
    target.natural_shape = NaturalShape::AsPlaced;
    target.inertia = Inertia::Lumped;
    target.pretension = 0.0;
    let placed = prepared(&loaded, &scenario)?;
    let found = natural_strains(&placed.scene, rod)?;
    scenario.rods[index].natural_shape = NaturalShape::Strains(strains(&found.natural));
    let run = prepared(&loaded, &scenario)?;
    let check = Check::new(&run, rod, &nodes)?;
    let radius = scenario.rods[index].radius;
    let curvatures = found.natural.curvature.iter();
    let curvature = curvatures
        .map(|one| libm::hypot(one[0], one[1]))
        .fold(0.0, f64::max);
    let twists = found.natural.twist.iter();
    let natural_length: f64 = found.natural.lengths.iter().sum();
    let mut designed = Designed {
        rod: scenario.rods[index].name.clone(),
        edges,
        curve_length_m: curve_length,
        natural_length_m: natural_length,
        length_before_m: length_before,
        distance_m: check.distance,
        distance_over_length: check.distance / curve_length,
        distance_from_displaced_start_m: check.from_displaced_start,
        unstable_directions: check.unstable_directions,
        natural_curvature_per_m: curvature,
        curvature_times_radius: curvature * radius,
        natural_twist_rad_per_m: twists.map(|one| one.abs()).fold(0.0, f64::max),
        stretching_strain: found.largest_strain,
        residual_n: found.residual,
        remarks: Vec::new(),
        scenario_toml: run.scenario_toml.clone(),
        nodes: [nodes, check.nodes, check.unloaded],
        natural: found.natural,
    };
    designed.remarks = remarks(&designed);
    Ok(designed)
}

fn remarks(designed: &Designed) -> Vec<String> {
    let mut remarks = Vec::new();
    if designed.unstable_directions.is_some_and(|count| count > 0) {
        remarks.push(
            "the wanted shape is an unstable equilibrium: the rod leaves it at the least disturbance"
                .to_owned(),
        );
    }
    match designed.distance_from_displaced_start_m {
        Some(distance) if distance > SAME * designed.curve_length_m => remarks.push(format!(
            "there are several equilibria: from a start {PERTURBATION} lengths away the rod comes to rest {distance:.3e} m from the wanted shape"
        )),
        None => remarks.push("from a displaced start no equilibrium was found".to_owned()),
        Some(_) => {}
    }
    if designed.curvature_times_radius > SLENDER {
        remarks.push(format!(
            "the natural curvature times the radius is {:.3}; the theory of slender rods assumes less than {SLENDER}",
            designed.curvature_times_radius
        ));
    }
    let change = designed.natural_length_m / designed.length_before_m - 1.0;
    if change.abs() > 1e-6 {
        remarks.push(format!(
            "the natural length is {:.6} m instead of {:.6} m ({:+.4} %)",
            designed.natural_length_m,
            designed.length_before_m,
            100.0 * change
        ));
    }
    remarks
}

/// The number of the rod that a key names, among those of the scenario.
fn rod_of(key: &str, scenario: &Scenario) -> Result<usize, DesignError> {
    let fault = |what: &str| {
        let names: Vec<String> = (scenario.rods.iter())
            .map(|rod| format!("rods.{}.natural_curvature", rod.name))
            .collect();
        DesignError::Input(format!(
            "--vary {key}: {what}; allowed: {}",
            names.join(", ")
        ))
    };
    if scenario.rods.is_empty() {
        return Err(DesignError::Input(format!(
            "--vary {key}: the scenario has no [[rods]]"
        )));
    }
    let parts: Vec<&str> = key.split('.').collect();
    let ["rods", name, "natural_curvature" | "natural_shape"] = parts.as_slice() else {
        return Err(fault("not the natural curvature of a rod"));
    };
    let named = scenario.rods.iter().position(|rod| rod.name == *name);
    let numbered = name
        .parse()
        .ok()
        .filter(|index| *index < scenario.rods.len());
    named.or(numbered).ok_or_else(|| fault("no such rod"))
}

fn prepared(loaded: &Loaded, scenario: &Scenario) -> Result<PreparedRun, DesignError> {
    Ok(experiment::prepare(scenario).map_err(|issues| loaded.locate(issues))?)
}

fn length(nodes: &[Vector3]) -> f64 {
    nodes
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).norm())
        .sum()
}

/// Row by row as the keys of a scenario.
fn strains(natural: &NaturalStrains) -> Strains {
    let mut arc_length = vec![0.0];
    for length in &natural.lengths {
        arc_length.push(arc_length[arc_length.len() - 1] + length);
    }
    Strains {
        arc_length,
        curvature_1: natural.curvature.iter().map(|one| one[0]).collect(),
        curvature_2: natural.curvature.iter().map(|one| one[1]).collect(),
        twist: natural.twist.clone(),
    }
}

/// The equilibria of the scenario with the designed rod.
struct Check {
    distance: f64,
    from_displaced_start: Option<f64>,
    unstable_directions: Option<usize>,
    nodes: Vec<Vector3>,
    unloaded: Vec<Vector3>,
}

impl Check {
    fn new(run: &PreparedRun, rod: usize, wanted: &[Vector3]) -> Result<Self, DesignError> {
        let before = run.scene.rods[..rod].iter();
        let first: usize = before.map(|rod| rod.centreline.len()).sum();
        let own = first..first + wanted.len();
        let parameters = IntegrationParameters {
            force_tolerance: FORCE_TOLERANCE.min(run.integration.force_tolerance),
            ..run.integration
        };
        let distance = |simulation: &Simulation| {
            let pairs = simulation.positions()[own.clone()].iter().zip(wanted);
            pairs
                .map(|(one, other)| (one - other).norm())
                .fold(0.0, f64::max)
        };
        let mut simulation = Simulation::new(&run.scene, &parameters)?;
        let start = simulation.as_start();
        simulation.find_equilibrium()?;
        let (largest, nodes) = (
            distance(&simulation),
            simulation.positions()[own.clone()].to_vec(),
        );
        let unstable_directions = Simulation::new(&run.scene, &parameters)?
            .find_nearby_equilibrium()
            .ok();
        let displaced = displaced(&run.scene, rod, own.start, &start);
        let from_displaced_start = Simulation::new(&displaced, &parameters)
            .and_then(|mut simulation| {
                simulation.find_equilibrium()?;
                Ok(distance(&simulation))
            })
            .ok();
        let natural = match &run.scene.rods[rod].natural_shape {
            scene::NaturalShape::Strains(natural) => natural.clone(),
            _ => NaturalStrains::default(),
        };
        let wall = start.walls[first];
        let edge = [(wanted[1] - wanted[0]).normalize(), start.directors[first]];
        Ok(Self {
            distance: largest,
            from_displaced_start,
            unstable_directions,
            nodes,
            unloaded: unloaded(&natural, wanted[0], wall.unwrap_or(edge), wall.is_some()),
        })
    }
}

/// The scene with the free nodes of a rod displaced.
fn displaced(scene: &Scene, rod: usize, first: usize, start: &scene::Start) -> Scene {
    let mut start = start.clone();
    let last = scene.rods[rod].centreline.len() - 1;
    let length = length(&scene.rods[rod].centreline);
    let is_held = |node: usize| {
        let clamps = scene.clamps.iter();
        clamps
            .filter(|clamp| clamp.rod == rod)
            .any(|clamp| clamp.node == node)
    };
    for node in 0..=last {
        let part = node as f64 / last as f64;
        // A clamp leaves neither a displacement nor a turn.
        let near_start = if is_held(0) { part * part } else { 1.0 };
        let near_end = if is_held(last) {
            (1.0 - part) * (1.0 - part)
        } else {
            1.0
        };
        let size = PERTURBATION * length * near_start * near_end;
        start.positions[first + node] += Vector3::from(DIRECTION) * size;
    }
    Scene {
        start: Some(start),
        ..scene.clone()
    }
}
