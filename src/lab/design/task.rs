//! Computes natural strains from a scenario and a curve, and checks them.

use super::check::Check;
use super::curve::{length, wanted_nodes};
use super::error::DesignError;
use super::request::Request;
use super::unloaded::unloaded;
use crate::experiment;
use crate::run::PreparedRun;
use crate::scenario::{Inertia, Loaded, NaturalShape, Scenario, Shape, Strains};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::scene::NaturalStrains;
use rodlab_engine::mechanics::statics::natural_strains;
use serde::Serialize;

/// Product of natural curvature and radius above which the theory of slender rods is inaccurate.
const SLENDER: f64 = 0.1;

/// A natural shape and its check.
#[derive(Clone, Debug, Serialize)]
pub struct Designed {
    /// Name of the rod.
    pub rod: String,
    /// Number of edges of the rod.
    pub edges: usize,
    /// Length of the target curve, m.
    pub curve_length_m: f64,
    /// Natural length of the designed rod, m.
    pub natural_length_m: f64,
    /// Natural length of the rod in the scenario, m.
    pub length_before_m: f64,
    /// Largest distance of a node in equilibrium from the target curve, m.
    pub distance_m: f64,
    /// Largest distance over the length.
    pub distance_over_length: f64,
    /// Largest distance from the curve of the equilibrium reached from a displaced start, m; none
    /// if there is no such equilibrium.
    pub distance_from_displaced_start_m: Option<f64>,
    /// Number of directions in which the energy of the equilibrium falls: 0 if it is stable; none
    /// with friction and rigid contact.
    pub unstable_directions: Option<usize>,
    /// Largest natural curvature, 1/m.
    pub natural_curvature_per_m: f64,
    /// Largest natural curvature times the radius.
    pub curvature_times_radius: f64,
    /// Largest natural twist, rad/m.
    pub natural_twist_rad_per_m: f64,
    /// Largest stretching strain in the wanted shape.
    pub stretching_strain: f64,
    /// Largest unbalanced force in the wanted shape, N.
    pub residual_n: f64,
    /// What limits the design.
    pub remarks: Vec<String>,
    /// The scenario with the natural shape.
    #[serde(skip)]
    pub scenario_toml: String,
    /// Natural strains at the nodes.
    #[serde(skip)]
    pub natural: NaturalStrains,
    /// Nodes of the target curve, in equilibrium, and without stress, m.
    #[serde(skip)]
    pub nodes: [Vec<Vector3>; 3],
}

/// Finds the natural shape of the rod that `key` names and checks it with the equilibrium of the
/// scenario.
///
/// # Errors
/// [`DesignError`]: a curve that does not fit the rod, a key that cannot be used, or a curve that
/// no natural shape holds.
pub fn natural_shape(request: &Request<'_>, key: &str) -> Result<Designed, DesignError> {
    let loaded = request.scenario.scenario_with(&[])?;
    let mut scenario = loaded.scenario.clone();
    let index = rod_of(key, &scenario)?;
    let before = prepared(&loaded, &scenario)?;
    let built = before.scene.rods.len() - scenario.rods.len();
    let rod = built + index;
    let edges = scenario.rods[index].edges;
    if scenario.rods[index].closed {
        let message = format!("--vary {key}: the rod is closed; allowed: an open rod");
        return Err(DesignError::Input(message));
    }
    let length_before = length(&before.scene.rods[rod].centreline);
    let nodes = wanted_nodes(request.shape, edges, length_before, false)?;
    let curve_length = length(&nodes);
    let target = &mut scenario.rods[index];
    target.shape = Shape::Points {
        points: nodes.iter().map(|node| (*node).into()).collect(),
    };
    target.natural_shape = NaturalShape::AsPlaced;
    for section in &mut target.sections {
        (section.natural_curvature, section.natural_twist) = (None, None);
    }
    target.inertia = Inertia::Lumped;
    target.pretension = 0.0;
    let name = target.name.clone();
    for clamp in scenario.clamps.iter_mut().filter(|one| one.rod == name) {
        (clamp.offset, clamp.rotation) = ([0.0; 3], [0.0; 3]);
    }
    let placed = prepared(&loaded, &scenario)?;
    let found = natural_strains(&placed.scene, rod)?;
    scenario.rods[index].natural_shape = NaturalShape::Strains(strains(&found.natural));
    let run = prepared(&loaded, &scenario)?;
    let check = Check::new(&run, rod, &nodes, true)?;
    let stability = check.remarks(curve_length);
    let wall = check.wall.unwrap_or(check.first_edge);
    let without_loads = unloaded(&found.natural, nodes[0], wall, check.wall.is_some());
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
        nodes: [nodes, check.nodes, without_loads],
        natural: found.natural,
    };
    designed.remarks = remarks(&designed, stability);
    Ok(designed)
}

fn remarks(designed: &Designed, stability: Vec<String>) -> Vec<String> {
    let mut remarks = stability;
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

/// The rod whose natural shape a key sets.
pub fn named_rod(key: &str) -> Option<&str> {
    let parts: Vec<&str> = key.split('.').collect();
    match parts.as_slice() {
        ["rods", name, "natural_curvature" | "natural_shape"] => Some(name),
        _ => None,
    }
}

/// Index of the rod that a key names, among the rods of the scenario.
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
    let name = named_rod(key).unwrap_or_default();
    let named = scenario.rods.iter().position(|rod| rod.name == name);
    let numbered = name
        .parse()
        .ok()
        .filter(|index| *index < scenario.rods.len());
    named.or(numbered).ok_or_else(|| fault("no such rod"))
}

fn prepared(loaded: &Loaded, scenario: &Scenario) -> Result<PreparedRun, DesignError> {
    Ok(experiment::prepare(scenario).map_err(|issues| loaded.locate(issues))?)
}

/// Natural strains as columns of the keys of a scenario.
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
