//! The error e of a manipulated rod, and its kind of buckling.

use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::kirchhoff::Helix;

/// Error e of the shape against a helix (thesis Eq. 6.1): mean distance of the nodes from their
/// places on it, over the radius of the helix. The rod has length 1. `enlargement` is the factor
/// by which the helix is enlarged so that the rod's edges fit on it.
pub fn helix_error(nodes: &[Vector3], helix: &Helix, enlargement: f64) -> f64 {
    let edges = (nodes.len() - 1) as f64;
    let distances = nodes
        .iter()
        .enumerate()
        .map(|(k, node)| (node - enlargement * helix.position(k as f64 / edges)).norm());
    let mean = distances.sum::<f64>() / nodes.len() as f64;
    // A straight helix has no radius. The straight rod at the start has the error 0.
    let inverse_radius = match helix.curvature {
        0.0 => 0.0,
        curvature => (curvature.powi(2) + helix.torsion.powi(2)) / curvature,
    };
    mean * inverse_radius
}

/// Error above which the rod has left the helix: a tenth of its radius. The mesh alone causes an
/// error of 1e-3 with 60 edges. Beyond the loss of stability e grows to more than 1, so that
/// another threshold gives nearly the same distance.
const DEVIATION: f64 = 0.1;
/// Ratio of the kinetic energy to that of the whole rod moving with the speed of its end, above
/// which the rod moves by itself. Such a rod is three times as fast as its end; a rod that follows
/// its end has a ratio below 0.5.
const OWN_MOTION: f64 = 10.0;

/// Observation of a manipulated rod at an output time.
#[derive(Clone, Copy, Debug)]
pub struct Observation {
    /// Distance ‖(κ, τ, ω)‖ of the prescribed helix.
    pub distance: f64,
    /// Error e of its shape.
    pub error: f64,
    /// Kinetic energy, divided by that of the whole rod moving with the speed of its end.
    pub kinetic_energy: f64,
}

/// Distance at which a manipulated rod leaves the helix, and its kind of buckling.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Buckling {
    /// Distance ‖(κ, τ, ω)‖ at which the error exceeds a tenth.
    pub deviates: Option<f64>,
    /// Distance, after the deviation, at which the rod is first seen to move much faster than its
    /// end.
    pub snaps: Option<f64>,
}

impl Buckling {
    /// The buckling of a rod, given observations at increasing distances.
    pub fn of(observations: &[Observation]) -> Self {
        let deviation = observations
            .iter()
            .position(|observation| observation.error > DEVIATION);
        let Some(index) = deviation else {
            return Self::default();
        };
        let here = observations[index];
        let before = index.checked_sub(1).map_or(
            Observation {
                distance: 0.0,
                error: 0.0,
                kinetic_energy: 0.0,
            },
            |before| observations[before],
        );
        let part = (DEVIATION - before.error) / (here.error - before.error);
        let snap = observations[index..]
            .iter()
            .find(|observation| observation.kinetic_energy > OWN_MOTION);
        Self {
            deviates: Some(before.distance + part * (here.distance - before.distance)),
            snaps: snap.map(|observation| observation.distance),
        }
    }

    /// Kind of the buckling as a word.
    pub fn kind(&self) -> &'static str {
        match (self.deviates, self.snaps) {
            (None, _) => "none",
            (Some(_), None) => "continuous",
            (Some(_), Some(_)) => "snapping",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shifted_helix_has_the_shift_over_its_radius_as_its_error() {
        let helix = Helix::from([3.0, 4.0, 1.0]);
        let shift = Vector3::new(0.0, 0.006, 0.0);
        let nodes: Vec<Vector3> = (0..=40)
            .map(|k| helix.position(f64::from(k) / 40.0) + shift)
            .collect();
        let error = helix_error(&nodes, &helix, 1.0);
        assert!((error - 0.006 / helix.radius()).abs() < 1e-14, "{error}");
    }

    #[test]
    fn the_kind_of_buckling_follows_from_the_speed_of_the_rod() {
        let observed = |error: f64, kinetic_energy: f64, distance: f64| Observation {
            distance,
            error,
            kinetic_energy,
        };
        let start = [observed(0.0, 50.0, 1.0), observed(0.05, 0.3, 2.0)];
        let then = |rest: &[Observation]| Buckling::of(&[&start, rest].concat());
        assert_eq!(then(&[observed(0.09, 0.3, 3.0)]).kind(), "none");
        let grown = then(&[observed(0.15, 0.4, 3.0), observed(0.3, 0.5, 4.0)]);
        assert_eq!(grown.kind(), "continuous");
        assert!((grown.deviates.unwrap() - 2.5).abs() < 1e-12);
        let snapped = then(&[observed(0.15, 0.4, 3.0), observed(2.0, 300.0, 4.0)]);
        assert_eq!((snapped.kind(), snapped.snaps), ("snapping", Some(4.0)));
    }
}
