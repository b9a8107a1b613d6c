//! Knots of two rods that are tied in two throws: reef, granny and surgeon's knot.

use super::KnotSize;
use super::polyline::equally_spaced;
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::kirchhoff::numerics::smooth_step;
use std::f64::consts::PI;

/// Distance of the centrelines from the axis of a throw, in radii: the surfaces are 0.4 radii
/// apart.
const STRAND_OFFSET: f64 = 1.2;
/// Length of a throw per half turn, in radii.
const PITCH: f64 = 10.0;
/// Least distance of the axis of a throw from that of the knot, in radii.
const SMALLEST: f64 = 10.0;
/// Distance of the ends from the axis of the knot, in radii.
const END_OFFSET: f64 = 2.5;
/// Clearance between a loop and the tails that pass around it, in radii.
const CLEARANCE: f64 = 4.0;
/// Smallest length of the tails between throws and axis, over the distance of the throws from the
/// axis.
const SLOPE: f64 = 1.5;
/// Points of the smooth curve per part: tail, throw, loop.
const POINTS: usize = 1000;

/// Two throws, given by their half turns, positive for right-handed screws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TwoThrows([i32; 2]);

impl TwoThrows {
    /// Reef or square knot: the throws have opposite handedness.
    pub const REEF: Self = Self([3, -3]);
    /// Granny knot: both throws have the same handedness.
    pub const GRANNY: Self = Self([3, 3]);
    /// Surgeon's knot: a reef knot with another full turn in its first throw.
    pub const SURGEON: Self = Self([5, -3]);

    /// Determinant of the knot that results when the starts of the rods are joined, and their ends
    /// are joined.
    ///
    /// This knot is the sum of the torus knots (2, h) of the throws with h half turns, and
    /// determinants multiply.
    pub fn determinant(self) -> u64 {
        let Self(half_turns) = self;
        half_turns
            .iter()
            .map(|turns| u64::from(turns.unsigned_abs()))
            .product()
    }

    /// The nodes of both rods, m, equally spaced. The first rod comes from the left and returns
    /// there, the second from the right. Both starts lie below the ends. All four are pulled along
    /// x, two to each side.
    ///
    /// The rods turn around each other in the first throw, below the x axis, and in the second
    /// one, above it. Between the throws each makes a loop inside the tails of the other. A
    /// rotation by π about the y axis exchanges the rods.
    ///
    /// # Errors
    /// A message if loops and tails do not fit between the ends.
    pub fn nodes(self, knot: &KnotSize, nodes: usize) -> Result<[Vec<Vector3>; 2], String> {
        let half_line = 0.5 * knot.end_to_end;
        let half_throw = self.half_throw(knot.radius);
        let room = half_line - half_throw - CLEARANCE * knot.radius;
        let extents = [SMALLEST * knot.radius, room / (1.0 + SLOPE)];
        let curve = knot.fitted(extents, |extent| self.smooth_curve(knot, extent))?;
        let first = equally_spaced(&curve, nodes);
        let turned = |node: &Vector3| Vector3::new(-node.x, node.y, -node.z);
        let second = first.iter().map(turned).collect();
        Ok([first, second])
    }

    fn half_throw(self, radius: f64) -> f64 {
        let Self([first, second]) = self;
        0.5 * PITCH * radius * f64::from(first.abs().max(second.abs()))
    }

    /// The first rod. The axes of the throws are at the heights −`extent` and `extent`.
    fn smooth_curve(self, knot: &KnotSize, extent: f64) -> Vec<Vector3> {
        let Self([first, second]) = self;
        let half_line = 0.5 * knot.end_to_end;
        let half_throw = self.half_throw(knot.radius);
        let offset = STRAND_OFFSET * knot.radius;
        let parts = || (0..=POINTS).map(|k| k as f64 / POINTS as f64);
        // The tail runs straight beside the loop of the other rod, then to the axis.
        let bend = half_throw + extent + CLEARANCE * knot.radius;
        let tail = |part: f64| {
            let x = half_throw + part * (half_line - half_throw);
            let way = smooth_step((x - bend) / (half_line - bend));
            let y = (1.0 - way) * (extent + offset) + way * END_OFFSET * knot.radius;
            Vector3::new(-x, y, 0.0)
        };
        // From the outer strand on one side to the inner one on the other, around an axis at
        // `height`.
        let throw = |part: f64, half_turns: i32, height: f64| {
            let angle = PI * (1.0 + f64::from(half_turns) * smooth_step(part));
            let x = half_throw * (2.0 * part - 1.0);
            Vector3::new(
                x,
                height + offset * libm::cos(angle),
                offset * libm::sin(angle),
            )
        };
        let below = |point: Vector3| Vector3::new(point.x, -point.y, -point.z);
        let mut curve: Vec<Vector3> = parts().map(|part| below(tail(1.0 - part))).collect();
        curve.extend(parts().skip(1).map(|part| throw(part, first, -extent)));
        curve.extend(parts().skip(1).map(|part| {
            let (sine, cosine) = libm::sincos(PI * part);
            let radius = extent - offset;
            Vector3::new(half_throw + radius * sine, -radius * cosine, 0.0)
        }));
        // The second throw from its end to its start, which has the shape of the first seen from
        // above.
        curve.extend(
            parts()
                .skip(1)
                .map(|part| below(throw(1.0 - part, second, -extent))),
        );
        curve.extend(parts().skip(1).map(tail));
        curve
    }
}

#[cfg(test)]
mod tests {
    use super::super::{determinant, determinant_of_pair, least_distance};
    use super::*;

    const KNOTS: [TwoThrows; 3] = [TwoThrows::REEF, TwoThrows::GRANNY, TwoThrows::SURGEON];

    fn knot(end_to_end: f64) -> KnotSize {
        KnotSize {
            length: 1.0,
            radius: 1.6e-3,
            end_to_end,
        }
    }

    fn rods(throws: TwoThrows, end_to_end: f64, nodes: usize) -> [Vec<Vector3>; 2] {
        throws.nodes(&knot(end_to_end), nodes).unwrap()
    }

    #[test]
    fn knots_have_their_determinant_at_any_fineness() {
        for (throws, determinant) in KNOTS.into_iter().zip([9, 9, 15]) {
            assert_eq!(throws.determinant(), determinant);
            for nodes in [201, 301, 601] {
                let [first, second] = rods(throws, 0.6, nodes);
                let found = determinant_of_pair([&first, &second], &Vector3::x());
                assert_eq!(found, Some(determinant), "{throws:?}");
            }
        }
    }

    #[test]
    fn throws_without_a_full_turn_are_not_a_knot() {
        let [first, second] = rods(TwoThrows([1, -1]), 0.6, 301);
        assert_eq!(
            determinant_of_pair([&first, &second], &Vector3::x()),
            Some(1)
        );
        let [first, second] = rods(TwoThrows([3, -1]), 0.6, 301);
        assert_eq!(
            determinant_of_pair([&first, &second], &Vector3::x()),
            Some(3)
        );
    }

    #[test]
    fn neither_rod_is_knotted_by_itself() {
        let [first, second] = rods(TwoThrows::SURGEON, 0.6, 301);
        assert_eq!(determinant(&first), Some(1));
        assert_eq!(determinant(&second), Some(1));
    }

    #[test]
    fn strands_stand_apart_and_starts_lie_below_ends() {
        for throws in KNOTS {
            for end_to_end in [0.6, 0.8] {
                let [first, second] = rods(throws, end_to_end, 2001);
                let least = least_distance(&[&first, &second], 16e-3);
                assert!(least > 2.02 * 1.6e-3, "{throws:?} {least}");
                for (rod, x) in [(first, -0.5), (second, 0.5)] {
                    let ends = [(rod[0], -4e-3), (rod[2000], 4e-3)];
                    for (end, y) in ends {
                        let expected = Vector3::new(x * end_to_end, y, 0.0);
                        assert!((end - expected).norm() < 1e-15);
                    }
                }
            }
        }
    }

    #[test]
    fn a_knot_that_does_not_fit_is_refused_with_what_would() {
        let refusal = |end_to_end| TwoThrows::REEF.nodes(&knot(end_to_end), 301).unwrap_err();
        assert!(refusal(0.05).contains("too near"), "{}", refusal(0.05));
        assert!(refusal(0.95).contains("of rod, not"), "{}", refusal(0.95));
    }
}
