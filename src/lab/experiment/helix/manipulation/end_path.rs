//! The path of the manipulated end.

use crate::experiment::helix::stability::DiscreteRod;
use rodlab_engine::mechanics::kirchhoff::Helix;
use rodlab_engine::mechanics::scene::{Motion, piecewise_linear};
use rodlab_engine::mechanics::{UnitQuaternion, Vector3};
use rodlab_engine::random::uniform_numbers;

/// Distance ‖(κ, τ, ω)‖ between corners of the path. The end rotates by a fraction of a radian
/// from one corner to the next.
const SPACING: f64 = 0.02;
/// Number of corners between two random displacements of the jitter.
const JITTER_CORNERS: usize = 10;

/// Motion of the end of a rod of length 1.
#[derive(Clone, Copy, Debug)]
pub struct Manipulation {
    /// The rod; its chain of edges should lie on the helices.
    pub rod: DiscreteRod,
    /// The direction of (κ, τ, ω), a vector of any length.
    pub direction: Helix,
    /// Distance ‖(κ, τ, ω)‖ at the end of the path.
    pub farthest: f64,
    /// Speed of the end, in lengths of the rod per unit of time.
    pub speed: f64,
    /// Amplitude d of the jitter: the displacement from the path is at most this, in lengths of the rod.
    pub jitter: f64,
    /// Seed of the jitter.
    pub seed: u64,
}

/// A path of the manipulated end of a rod of length 1 that starts straight along x.
#[derive(Clone, Debug)]
pub struct EndPath {
    /// Times and distances ‖(κ, τ, ω)‖.
    pub distances: Vec<(f64, f64)>,
    /// Displacements from the end of the straight rod, at the same times.
    pub displacements: Vec<(f64, Vector3)>,
    /// Orientations relative to the initial one, at the same times.
    pub orientations: Vec<(f64, UnitQuaternion)>,
}

impl EndPath {
    /// The path of a manipulation. The end follows it at constant speed, apart from the jitter.
    pub fn new(manipulation: &Manipulation) -> Self {
        let unit = manipulation
            .direction
            .scaled(1.0 / manipulation.direction.distance());
        let corners = (manipulation.farthest / SPACING).ceil().max(1.0) as usize;
        let jitter = jitter(corners, manipulation.jitter, manipulation.seed);
        let mut path = Self {
            distances: Vec::new(),
            displacements: Vec::new(),
            orientations: Vec::new(),
        };
        let (mut time, mut before) = (0.0, Vector3::zeros());
        for corner in 0..=corners {
            let distance = manipulation.farthest * corner as f64 / corners as f64;
            let end = manipulation.rod.end_on_helix(&unit.scaled(distance));
            let displacement = end.translation[0].1;
            time += (displacement - before).norm() / manipulation.speed;
            before = displacement;
            path.distances.push((time, distance));
            path.displacements
                .push((time, displacement + jitter[corner]));
            path.orientations.push((time, end.orientation[0].1));
        }
        path
    }

    /// Time at the end of the path.
    pub fn duration(&self) -> f64 {
        self.distances.last().map_or(0.0, |(time, _)| *time)
    }

    /// Distance ‖(κ, τ, ω)‖ at a time.
    pub fn distance(&self, time: f64) -> f64 {
        piecewise_linear(&self.distances, time).unwrap_or(0.0)
    }

    /// The motion of a clamp that follows the path.
    pub fn motion(&self) -> Motion {
        Motion {
            translation: self.displacements.clone(),
            orientation: self.orientations.clone(),
            ..Motion::default()
        }
    }
}

/// Displacements at the corners: random ones at every [`JITTER_CORNERS`]th corner except the
/// first, linear between them.
fn jitter(corners: usize, amplitude: f64, seed: u64) -> Vec<Vector3> {
    let mut number = uniform_numbers(seed);
    let mut component = || (2.0 * number() - 1.0) * amplitude / 3.0_f64.sqrt();
    let mut stations = vec![(0.0, Vector3::zeros())];
    for station in 1..=corners / JITTER_CORNERS + 1 {
        let displacement = Vector3::from_fn(|_, _| component());
        stations.push(((station * JITTER_CORNERS) as f64, displacement));
    }
    (0..=corners)
        .map(|corner| piecewise_linear(&stations, corner as f64).unwrap_or_default())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn manipulation(jitter: f64) -> Manipulation {
        Manipulation {
            rod: DiscreteRod {
                edges: 20,
                stiffness_ratio: 0.75,
                bending_stiffness: 1.0,
            },
            direction: Helix::from([1.0, 1.0, 1.0]),
            farthest: 4.0,
            speed: 0.1,
            jitter,
            seed: 1,
        }
    }

    #[test]
    fn the_end_moves_at_its_speed_from_the_straight_rod_to_the_end_of_the_helix() {
        let path = EndPath::new(&manipulation(0.0));
        assert_eq!(path.displacements[0], (0.0, Vector3::zeros()));
        for pair in path.displacements.windows(2) {
            let speed = (pair[1].1 - pair[0].1).norm() / (pair[1].0 - pair[0].0);
            assert!((speed / 0.1 - 1.0).abs() < 1e-9, "{speed}");
        }
        assert_eq!(path.distance(path.duration()), 4.0);
        let last = Helix::from([1.0, 1.0, 1.0]).scaled(4.0 / 3.0_f64.sqrt());
        let place = Vector3::x() + path.displacements.last().unwrap().1;
        // The chords of 20 edges fit on a helix that is larger by the factor 1 + turn²/24, with
        // their turning angle.
        assert!((place - last.position(1.0)).norm() < 2e-3);
        let tangent = path.orientations.last().unwrap().1 * Vector3::x();
        assert!((tangent - last.tangent(1.0)).norm() < 1e-12);
    }

    #[test]
    fn jitter_leaves_path_times_and_orientations_as_they_are() {
        let [still, jittering] = [0.0, 0.02].map(|jitter| EndPath::new(&manipulation(jitter)));
        assert_eq!(still.distances, jittering.distances);
        assert_eq!(still.orientations, jittering.orientations);
        let pairs = still.displacements.iter().zip(&jittering.displacements);
        let off: Vec<f64> = pairs.map(|(a, b)| (a.1 - b.1).norm()).collect();
        let largest = off.iter().copied().fold(0.0, f64::max);
        assert!(
            off[0] == 0.0 && largest > 0.01 && largest <= 0.02,
            "{largest}"
        );
    }
}
