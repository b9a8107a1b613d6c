//! The equilibria of a designed rod: its distance from the target curve, and stability.

use super::curve::length;
use crate::run::PreparedRun;
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::{IntegrationParameters, Simulation, SimulationError};
use rodlab_engine::mechanics::scene::{Scene, Start};

/// Residual of equilibria, over the forces of the rod.
pub const FORCE_TOLERANCE: f64 = 1e-11;
/// Displacement of the perturbed start, over the length of the rod, and the direction of the
/// displacement.
const PERTURBATION: f64 = 0.01;
const DIRECTION: [f64; 3] = [0.6, 0.48, 0.64];
/// Distance, over the length of the rod, below which two equilibria count as the same.
const SAME: f64 = 1e-6;

/// The equilibria of the scenario with the designed rod.
pub struct Check {
    /// Largest and mean distance of a node from the curve, m.
    pub distance: f64,
    pub mean_distance: f64,
    /// Largest distance from the curve of the equilibrium reached from a displaced start; none if
    /// there is no such equilibrium.
    pub from_displaced_start: Option<f64>,
    /// Number of directions in which the energy falls; none with friction and rigid contact.
    pub unstable_directions: Option<usize>,
    /// The rod in equilibrium.
    pub nodes: Vec<Vector3>,
    /// Tangent and first director: of the clamp at the start of the rod, if it holds a frame
    /// there, and of the first edge.
    pub wall: Option<[Vector3; 2]>,
    pub first_edge: [Vector3; 2],
}

impl Check {
    /// Finds the equilibria of a run and compares a rod with its wanted nodes. `begins_there`:
    /// whether the run starts on these nodes.
    ///
    /// # Errors
    /// No equilibrium was found.
    pub fn new(
        run: &PreparedRun,
        rod: usize,
        wanted: &[Vector3],
        begins_there: bool,
    ) -> Result<Self, SimulationError> {
        let before = run.scene.rods[..rod].iter();
        let first: usize = before.map(|rod| rod.centreline.len()).sum();
        let own = first..first + wanted.len();
        let parameters = IntegrationParameters {
            force_tolerance: FORCE_TOLERANCE.min(run.integration.force_tolerance),
            ..run.integration
        };
        let distances = |simulation: &Simulation| -> Vec<f64> {
            let pairs = simulation.positions()[own.clone()].iter().zip(wanted);
            pairs.map(|(one, other)| (one - other).norm()).collect()
        };
        let distance =
            |simulation: &Simulation| distances(simulation).into_iter().fold(0.0, f64::max);
        let mut simulation = Simulation::new(&run.scene, &parameters)?;
        let start = simulation.as_start();
        simulation.find_equilibrium()?;
        // The search leaves an unstable equilibrium on the curve.
        let mut beside = run.scene.clone();
        if !begins_there {
            beside.start = Some(simulation.as_start());
        }
        let mut nearby = Simulation::new(&beside, &parameters)?;
        let displaced = displaced(&run.scene, rod, own.start, &nearby.as_start());
        let unstable_directions = nearby.find_nearby_equilibrium().ok();
        let from_displaced_start = Simulation::new(&displaced, &parameters)
            .and_then(|mut simulation| {
                simulation.find_equilibrium()?;
                Ok(distance(&simulation))
            })
            .ok();
        Ok(Self {
            distance: distance(&simulation),
            mean_distance: distances(&simulation).iter().sum::<f64>() / wanted.len() as f64,
            from_displaced_start,
            unstable_directions,
            nodes: simulation.positions()[own.clone()].to_vec(),
            wall: start.walls[first],
            first_edge: [(wanted[1] - wanted[0]).normalize(), start.directors[first]],
        })
    }

    /// Limitations of the design of a rod with this length, m.
    pub fn remarks(&self, length: f64) -> Vec<String> {
        let mut remarks = Vec::new();
        if self.unstable_directions.is_some_and(|count| count > 0) {
            remarks.push(
                "the shape is an unstable equilibrium: the rod leaves it after the slightest \
                 disturbance"
                    .to_owned(),
            );
        }
        match self.from_displaced_start {
            Some(distance) if distance > self.distance + SAME * length => remarks.push(format!(
                "there are several equilibria: from a start {PERTURBATION} lengths away the rod comes to rest {distance:.3e} m from the wanted shape"
            )),
            None => remarks.push("from a displaced start no equilibrium was found".to_owned()),
            Some(_) => {}
        }
        remarks
    }
}

/// The scene with the free nodes of a rod displaced.
fn displaced(scene: &Scene, rod: usize, first: usize, start: &Start) -> Scene {
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
        // The displacement and its slope vanish at a clamp.
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
