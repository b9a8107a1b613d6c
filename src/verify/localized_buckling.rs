//! The localised helical buckle of a long twisted rod: the case of Bergou et al. 2008, sec. 8.

use super::rods::{clamp, unit_rod};
use super::theory::localized_buckling::LocalizedBuckle;
use super::{Check, Expectation, GroupError};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::{IntegrationParameters, Simulation};
use rodlab_engine::mechanics::scene::{RodDescription, Scene, Stiffness};
use std::f64::consts::TAU;

const ENVELOPE: Expectation = Expectation::new(
    "(cos φ − cos φ₀)/(1 − cos φ₀) = tanh²(s/s*)",
    "van der Heijden & Thompson 2000",
);
const DEFLECTION: Expectation =
    Expectation::new("cos φ₀ = M²/2BT − 1", "van der Heijden & Thompson 2000");

/// The rod of Bergou et al.
const BENDING: f64 = 1.345;
const TWISTING: f64 = 0.789;
const LENGTH: f64 = 9.29;
const TURNS: f64 = 27.0;
const SHORTENING: f64 = 0.3;
const EDGES: usize = 800;

/// Checks the depth of the buckle and its envelope.
pub fn checks(_full: bool) -> Result<Vec<Check>, GroupError> {
    let theory = LocalizedBuckle::new(BENDING, TWISTING, LENGTH, TURNS * TAU, SHORTENING);
    let mut simulation = Simulation::new(&scene(&theory), &IntegrationParameters::default())?;
    simulation.find_equilibrium()?;
    let nodes = simulation.positions();
    let cosines: Vec<f64> = nodes
        .windows(2)
        .map(|edge| (edge[1] - edge[0]).normalize().x)
        .collect();
    // The middle of the rod is a node; its tangent is the mean of those of the adjacent edges.
    let middle = 0.5 * (cosines[EDGES / 2 - 1] + cosines[EDGES / 2]);
    let worst = cosines
        .iter()
        .enumerate()
        .map(|(k, cosine)| {
            let s = LENGTH * ((k as f64 + 0.5) / EDGES as f64 - 0.5);
            let envelope = (cosine - middle) / (1.0 - middle);
            (envelope - theory.envelope(s)).abs()
        })
        .fold(0.0, f64::max);
    Ok(vec![
        DEFLECTION
            .of("localised buckle: cos φ in its middle", "")
            .relative(theory.cosine_in_the_middle(), middle, 1e-2),
        ENVELOPE
            .of("localised buckle: largest deviation of the envelope", "")
            .zero(worst, 1e-2),
    ])
}

/// The rod, initially on the continuum solution, with its ends clamped there.
fn scene(theory: &LocalizedBuckle) -> Scene {
    let centreline = theory
        .centreline(EDGES + 1)
        .into_iter()
        .map(Vector3::from)
        .collect();
    let rod = RodDescription {
        end_tangents: [Some(Vector3::x()); 2],
        twist: theory.moment / TWISTING * LENGTH * (EDGES as f64 - 1.0) / EDGES as f64,
        stiffness: Stiffness {
            stretching: 1e8,
            bending: [BENDING; 2],
            twisting: TWISTING,
        },
        ..unit_rod(centreline)
    };
    Scene {
        rods: vec![rod],
        clamps: vec![clamp(0), clamp(EDGES)],
        ..Scene::default()
    }
}
