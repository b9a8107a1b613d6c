//! Stability of a helical rod with clamped ends, by the discrete rod (thesis 6.2).
//!
//! A point (κ, τ, ω) stands for a naturally straight rod of unit length and bending stiffness, held at
//! both ends in the shape of a helix of curvature κ and torsion τ with the twisting moment ω. Along a
//! direction, the rod is brought to its equilibrium next to the helix at growing distances ‖(κ, τ, ω)‖;
//! where the Hessian there gets its first negative pivot, the helix ceases to be stable. Nothing of
//! [`critical_distance`](crate::mechanics::kirchhoff::critical_distance), the theory, is used.

use crate::mechanics::Vector3;
use crate::mechanics::dynamics::{IntegrationParameters, Simulation, SimulationError};
use crate::mechanics::kirchhoff::{CriticalDistance, Helix};
use crate::mechanics::scene::{Clamp, Motion, NaturalShape, RodDescription, Scene, Stiffness};

/// Fewest edges that make a helix.
pub const FEWEST_EDGES: usize = 8;
/// Radius, m. EA = 4 EI/h² then makes the rod as good as inextensible: forces of 100 EI/L² stretch it by
/// 2.5e-5.
const RADIUS: f64 = 1e-3;
/// Twisting over bending stiffness at Poisson's ratio 1/2. Stability does not depend on it.
const STIFFNESS_RATIO: f64 = 1.0 / 1.5;
/// First step along a direction. Stability is not regained farther out, so that a step too long does no harm
/// but where Newton's method fails.
const STEP: f64 = 0.5;
/// Largest distance per edge: the rod turns by half a radian from edge to edge there.
const LARGEST_TURN: f64 = 0.5;
/// The search ends when the bracket is this narrow, as a fraction of the distance.
const PRECISION: f64 = 1e-9;

/// Distance at which the helical rod of `edges` edges along the direction of `helix` loses stability;
/// `None` where it is stable up to a distance of `edges`/2, beyond which the mesh is too coarse.
///
/// # Errors
/// [`SimulationError::NoConvergence`] where no equilibrium is found next to the helix.
pub fn discrete_critical_distance(
    helix: &Helix,
    edges: usize,
) -> Result<Option<f64>, SimulationError> {
    let direction = helix.scaled(1.0 / helix.distance());
    let unstable = |distance: f64| -> Result<bool, SimulationError> {
        let scene = clamped_helix(&direction.scaled(distance), edges);
        let mut simulation = Simulation::new(&scene, &IntegrationParameters::default())?;
        Ok(simulation.find_nearby_equilibrium()? > 0)
    };
    let farthest = LARGEST_TURN * edges as f64;
    let (mut stable, mut lost) = (0.0, STEP);
    while !unstable(lost)? {
        stable = lost;
        lost += STEP;
        if lost > farthest {
            return Ok(None);
        }
    }
    while lost - stable > PRECISION * lost {
        let middle = 0.5 * (stable + lost);
        if unstable(middle)? {
            lost = middle;
        } else {
            stable = middle;
        }
    }
    Ok(Some(0.5 * (stable + lost)))
}

/// The same with an estimate of its error: the error of the mesh falls with the square of the edge length, so
/// that it is 4/3 of the difference from a mesh twice as fine.
///
/// # Errors
/// See [`discrete_critical_distance`].
pub fn estimated_critical_distance(
    helix: &Helix,
    edges: usize,
) -> Result<Option<CriticalDistance>, SimulationError> {
    let Some(distance) = discrete_critical_distance(helix, edges)? else {
        return Ok(None);
    };
    let finer = discrete_critical_distance(helix, 2 * edges)?;
    Ok(finer.map(|finer| CriticalDistance {
        distance,
        error_estimate: 4.0 / 3.0 * (finer - distance).abs(),
    }))
}

/// A rod with its nodes on the helix, clamped at both ends.
///
/// Edges are stretched as the tension n·t = (ω − τ) τ demands, and evenly twisted by ω/GJ.
fn clamped_helix(helix: &Helix, edges: usize) -> Scene {
    let bending = 1.0;
    let stiffness = Stiffness {
        stretching: 4.0 * bending / (RADIUS * RADIUS),
        bending: [bending; 2],
        twisting: STIFFNESS_RATIO * bending,
    };
    let centreline: Vec<Vector3> = (0..=edges)
        .map(|k| helix.position(k as f64 / edges as f64))
        .collect();
    let tension = (helix.twisting_moment - helix.torsion) * helix.torsion;
    let stretch = 1.0 + tension / stiffness.stretching;
    let natural_length = (centreline[1] - centreline[0]).norm() / stretch;
    let natural = (0..=edges)
        .map(|k| k as f64 * natural_length * Vector3::x())
        .collect();
    let clamp = |node| Clamp {
        rod: 0,
        node,
        holds_position: true,
        holds_frame: true,
        motion: Motion::default(),
    };
    Scene {
        rods: vec![RodDescription {
            name: "helix".into(),
            centreline,
            closed: false,
            end_tangents: [0.0, 1.0].map(|end| Some(helix.tangent(end))),
            first_director: None,
            // From the middle of the first edge to that of the last.
            twist: helix.twisting_moment / stiffness.twisting * (edges - 1) as f64 / edges as f64,
            natural_shape: NaturalShape::Centreline(natural),
            stiffness,
            radius: RADIUS,
            mass_per_length: 1.0,
            rotational_inertia_per_length: 0.5 * RADIUS * RADIUS,
            velocity: Vector3::zeros(),
            angular_velocity: Vector3::zeros(),
            held: false,
        }],
        clamps: vec![clamp(0), clamp(edges)],
        ..Scene::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::kirchhoff::critical_distance;

    fn helix(curvature: f64, torsion: f64, twisting_moment: f64) -> Helix {
        Helix {
            curvature,
            torsion,
            twisting_moment,
        }
    }

    #[test]
    fn the_distance_converges_to_the_theory_with_the_square_of_the_edge_length() {
        for direction in [
            helix(1.0, 1.0, 1.0),
            helix(1.0, 1.0, -1.0),
            helix(0.594, 0.698, 0.4),
            helix(0.0, 1.0, 0.0),
            helix(0.0, 0.0, 1.0),
        ] {
            let expected = critical_distance(&direction).unwrap().distance;
            let error = |edges| {
                let found = discrete_critical_distance(&direction, edges).unwrap();
                found.unwrap() / expected - 1.0
            };
            let [coarse, fine] = [40, 80].map(error);
            assert!(fine.abs() < 2e-3, "{direction:?}: {fine:e}");
            let order = (coarse / fine).log2();
            assert!((order - 2.0).abs() < 0.1, "{direction:?}: order {order}");
        }
    }

    /// A rod bent to a full circle turns freely about its tangent at the clamps, on any mesh.
    #[test]
    fn the_planar_ring_is_exact() {
        let found = discrete_critical_distance(&helix(1.0, 0.0, 0.0), 20).unwrap();
        assert!((found.unwrap() - std::f64::consts::TAU).abs() < 1e-7);
    }

    #[test]
    fn the_error_estimate_is_that_of_the_mesh() {
        let direction = helix(1.0, 1.0, -1.0);
        let expected = critical_distance(&direction).unwrap().distance;
        let found = estimated_critical_distance(&direction, 40)
            .unwrap()
            .unwrap();
        let error = (found.distance - expected).abs();
        assert!((found.error_estimate / error - 1.0).abs() < 0.05);
    }

    #[test]
    fn a_pulled_straight_rod_stays_stable() {
        let found = discrete_critical_distance(&helix(0.0, 1.0, 2.0), 40).unwrap();
        assert_eq!(found, None);
    }
}
