//! A rod folded over onto itself: the open loop that remains under its weight.

use super::elastica::{Elastica, Forces};
use super::numerics::bisect;
use std::f64::consts::PI;

const ITERATIONS: usize = 20;

/// The loop of a heavy rod that rests on a table and is folded over onto itself (thesis Fig. 5.8).
///
/// Lengths in the gravito-bending length L_gb, for which EI/(ρgA) = 2 L_gb³.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeavyLoop {
    /// Height of the loop: 1.142240 L_gb, which is 0.906597 (EI/ρgA)^(1/3). The thesis gives
    /// 0.9066 L_gb but means the second length.
    pub height: f64,
    /// Length of the rod between its contacts.
    pub length: f64,
    /// Vertical force on the cross-section where the rod leaves the table, in EI/L_gb².
    pub vertical_force: f64,
}

impl HeavyLoop {
    /// Solves θ'' = −(V + s/2) cos θ, θ(0) = θ'(0) = 0, θ(ℓ) = π, θ'(ℓ) = 0 for the force V and the
    /// length ℓ, by shooting and Newton's method.
    ///
    /// The rod leaves the table flat and without moment, turns over by more than π, and comes down
    /// flat and without moment upon itself; no horizontal force acts. The rod comes down to the
    /// height at which it left, ∫ sin θ ds = 0; to see this, multiply the equation by θ' and
    /// integrate. The height of the loop is that of the point where θ is first π.
    pub fn new() -> Self {
        // Enough digits to converge to the loop that winds once; Newton's method finds the rest.
        let (mut force, mut length) = (-2.36, 5.9);
        for _ in 0..ITERATIONS {
            let end = elastica(force).place(length);
            let (by_force, by_length) = (end.by_vertical, elastica(force).slope(&end));
            let determinant =
                by_force.angle * by_length.curvature - by_length.angle * by_force.curvature;
            let (beyond, slope) = (end.state.angle - PI, end.state.curvature);
            force -= (beyond * by_length.curvature - slope * by_length.angle) / determinant;
            length -= (slope * by_force.angle - beyond * by_force.curvature) / determinant;
        }
        let at = |s: f64| elastica(force).place(s).state;
        let top = bisect(0.0, 0.5 * length, |s| at(s).angle - PI);
        Self {
            height: at(top).z,
            length,
            vertical_force: force,
        }
    }

    /// Nodes that divide the loop into `edges` equal parts, shape `[edges + 1][x, z]`, in L_gb,
    /// from the point where the rod leaves the table, along x, to the point where it comes down.
    pub fn places(&self, edges: usize) -> Vec<[f64; 2]> {
        let places = elastica(self.vertical_force).places(self.length, edges);
        places
            .iter()
            .map(|place| [place.state.x, place.state.z])
            .collect()
    }
}

impl Default for HeavyLoop {
    fn default() -> Self {
        Self::new()
    }
}

/// The rod, from the point where it leaves the table.
fn elastica(vertical: f64) -> Elastica {
    Elastica::heavy(Forces {
        horizontal: 0.0,
        vertical,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_loop_stands_as_high_as_the_reference_says() {
        let heavy = HeavyLoop::new();
        assert!((heavy.height - 1.142_240).abs() < 5e-7, "{heavy:?}");
        assert!((heavy.height / 2f64.cbrt() - 0.906_597).abs() < 5e-7);
    }

    #[test]
    fn the_places_lie_on_the_loop() {
        let heavy = HeavyLoop::new();
        for edges in [7, 400] {
            let places = heavy.places(edges);
            assert_eq!(places.len(), edges + 1);
            let top = places.iter().fold(0.0, |top: f64, [_, z]| top.max(*z));
            let edge = heavy.length / edges as f64;
            assert!(top <= heavy.height + 1e-12 && top > heavy.height - edge * edge);
            let [_, last] = places[edges];
            assert!(last.abs() < 1e-9);
        }
    }

    #[test]
    fn the_loop_comes_down_flat_and_without_moment_to_where_it_left() {
        let heavy = HeavyLoop::new();
        let at = |s: f64| elastica(heavy.vertical_force).place(s).state;
        let end = at(heavy.length);
        assert!((end.angle - PI).abs() < 1e-9);
        assert!(end.curvature.abs() < 1e-9 && end.z.abs() < 1e-9);
        for part in 1..100 {
            let here = at(heavy.length * 0.01 * f64::from(part));
            assert!(here.z > 0.0 && here.angle < 1.5 * PI);
        }
    }
}
