//! A rod folded over onto itself: the loop that its weight leaves open.

use super::numerics::{bisect, runge_kutta};
use std::f64::consts::PI;

/// Steps of the integration; the error of the height is below 1e-10.
const STEPS: usize = 2000;
const ITERATIONS: usize = 20;

/// The loop of a heavy rod that lies on a table and is folded over onto itself (thesis Fig. 5.8).
///
/// Lengths in the gravito-bending length L_gb, for which EI/(ρgA) = 2 L_gb³.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeavyLoop {
    /// Height of the loop: 1.142240 L_gb, which is 0.906597 (EI/ρgA)^(1/3). The thesis gives 0.9066 L_gb
    /// and means the second length.
    pub height: f64,
    /// Length of rod that does not lie on anything.
    pub length: f64,
    /// Vertical force on the cross-section where the rod leaves the table, in EI/L_gb².
    pub vertical_force: f64,
}

impl HeavyLoop {
    /// Solves θ'' = −(V + s/2) cos θ, θ(0) = θ'(0) = 0, θ(ℓ) = π, θ'(ℓ) = 0 for the force V and the
    /// length ℓ, by shooting and Newton's method.
    ///
    /// The rod leaves the table flat and without moment, turns over by more than π, and comes down flat and
    /// without moment upon itself; no horizontal force acts. that it comes down to the height at which it left,
    /// ∫ sin θ ds = 0, follows: multiply the equation by θ' and integrate. Its height is that of the point
    /// where θ first is π.
    pub fn new() -> Self {
        // Digits enough to be drawn to the loop that winds once; Newton's method gives the rest.
        let (mut force, mut length) = (-2.36, 5.9);
        for _ in 0..ITERATIONS {
            let [_, angle, slope, angle_by_force, slope_by_force] = shoot(force, length);
            let slope_by_length = -(force + 0.5 * length) * libm::cos(angle);
            let determinant = angle_by_force * slope_by_length - slope * slope_by_force;
            let beyond = angle - PI;
            force -= (beyond * slope_by_length - slope * slope) / determinant;
            length -= (slope * angle_by_force - beyond * slope_by_force) / determinant;
        }
        let top = bisect(0.0, 0.5 * length, |s| shoot(force, s)[1] - PI);
        Self {
            height: shoot(force, top)[0],
            length,
            vertical_force: force,
        }
    }

    /// Nodes that divide the loop into `edges` equal parts, shape `[edges + 1][x, z]`, in L_gb: from where the rod leaves
    /// the table, along x, to where it comes down.
    pub fn places(&self, edges: usize) -> Vec<[f64; 2]> {
        // The abscissa beside height and angle; a multiple of the edges, so that every node is a step.
        let steps = edges * STEPS.div_ceil(edges);
        let slope = |s: f64, &[_, _, angle, slope]: &[f64; 4]| {
            let (sine, cosine) = libm::sincos(angle);
            let load = self.vertical_force + 0.5 * s;
            [cosine, sine, slope, -load * cosine]
        };
        let path = runge_kutta(0.0, self.length, [0.0; 4], steps, slope);
        let nodes = path.iter().step_by(steps / edges);
        nodes.map(|[x, z, ..]| [*x, *z]).collect()
    }
}

impl Default for HeavyLoop {
    fn default() -> Self {
        Self::new()
    }
}

/// At arc length `end`: height, angle and its slope, and the derivatives of the last two by the force.
fn shoot(force: f64, end: f64) -> [f64; 5] {
    let slope = |s: f64, &[_, angle, slope, by_force, slope_by_force]: &[f64; 5]| {
        let load = force + 0.5 * s;
        let (sine, cosine) = libm::sincos(angle);
        [
            sine,
            slope,
            -load * cosine,
            slope_by_force,
            -cosine + load * sine * by_force,
        ]
    };
    runge_kutta(0.0, end, [0.0; 5], STEPS, slope)[STEPS]
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
        let [height, angle, slope, ..] = shoot(heavy.vertical_force, heavy.length);
        assert!((angle - PI).abs() < 1e-9 && slope.abs() < 1e-9 && height.abs() < 1e-9);
        for part in 1..100 {
            let [height, angle, ..] =
                shoot(heavy.vertical_force, heavy.length * 0.01 * f64::from(part));
            assert!(height > 0.0 && angle < 1.5 * PI);
        }
    }
}
