//! The fisherman's knot: two rods, each tied around the other.

use super::KnotSize;
use super::polyline::equally_spaced;
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::kirchhoff::numerics::smooth_step;
use std::f64::consts::PI;

/// Distance of the two core strands from the axis, in radii: their surfaces are 0.4 radii apart.
const CORE_OFFSET: f64 = 1.2;
/// Distance of the winding strand from the axis, in radii: its surface is 0.4 radii from the core.
const WINDING_OFFSET: f64 = 3.6;
/// Number of half turns of the winding strand. With one and a half turns around the core, each rod
/// ties a trefoil.
const HALF_TURNS: f64 = 3.0;
/// Length of the winding per half turn, in radii.
const PITCH: f64 = 16.0;
/// Least radius of the loops, in radii.
const SMALLEST: f64 = 8.0;
/// Distance between the loops of the two knots, and of the ends from the axis, in radii.
const CLEARANCE: f64 = 4.0;
const END_OFFSET: f64 = 2.5;
/// Least length of a tail beyond the loops, in radii.
const SHORTEST_TAIL: f64 = 16.0;
/// Points of the smooth curve per part: tail, core, arc, winding.
const POINTS: usize = 1000;

/// Determinant of the knot that results when the starts of the rods are joined, and their ends are
/// joined.
///
/// With Fox's colourings a and b of the two strands between the knots, the windings give the ends
/// of the second rod the colours a + 5d and a − 5d, and those of the first rod a − 6d and a + 6d,
/// with d = b − a. Joined ends have the same colour, which requires 11 d = 0.
pub const FISHERMAN_DETERMINANT: u64 = 11;

/// The nodes of both rods of a fisherman's knot, m, equally spaced: the first rod comes from the left and ends on the
/// right, the second from the right and ends on the left. All four ends are pulled along x, two to each side, starts
/// above and ends below.
///
/// On the right the first rod runs beside the second, makes a loop and winds around both. A
/// rotation by π about the y axis exchanges the rods.
///
/// # Errors
/// A message if loops and tails do not fit between the ends.
pub fn fisherman_nodes(knot: &KnotSize, nodes: usize) -> Result<[Vec<Vector3>; 2], String> {
    let tail = (CLEARANCE + SHORTEST_TAIL) * knot.radius;
    let room = 0.5 * knot.end_to_end - winding_length(knot) - tail;
    let radii = [SMALLEST * knot.radius, 0.5 * room];
    let curve = knot.fitted(radii, |radius| smooth_curve(knot, radius))?;
    let first = equally_spaced(&curve, nodes);
    let turned = |node: &Vector3| Vector3::new(-node.x, node.y, -node.z);
    let second = first.iter().map(turned).collect();
    Ok([first, second])
}

fn winding_length(knot: &KnotSize) -> f64 {
    HALF_TURNS * PITCH * knot.radius
}

/// The first rod. The loop of the knot has two semicircles, one of the radius `arc` and a slightly
/// smaller one.
fn smooth_curve(knot: &KnotSize, arc: f64) -> Vec<Vector3> {
    let [core, winding] = [CORE_OFFSET, WINDING_OFFSET].map(|offset| offset * knot.radius);
    let half_line = 0.5 * knot.end_to_end;
    let end_offset = END_OFFSET * knot.radius;
    let length = winding_length(knot);
    // From `left` to `right` the rod winds; the loop reaches beyond by its arcs.
    let left = arc + 0.5 * CLEARANCE * knot.radius;
    let right = left + length;
    let outside = right + arc;
    let parts = || (0..=POINTS).map(|k| k as f64 / POINTS as f64);
    let mut curve: Vec<Vector3> = parts()
        .map(|part| {
            let x = -half_line + part * (half_line - outside);
            let way = smooth_step(part);
            Vector3::new(x, (1.0 - way) * end_offset, way * core)
        })
        .collect();
    let core_end = Vector3::new(right, 0.0, core);
    curve.extend(
        parts()
            .skip(1)
            .map(|part| Vector3::new(-outside, 0.0, core).lerp(&core_end, part)),
    );
    // Up, and back above the core.
    curve.extend(parts().skip(1).map(|part| {
        let (sine, cosine) = libm::sincos(PI * part);
        Vector3::new(right + arc * sine, arc * (1.0 - cosine), core)
    }));
    curve.extend(parts().skip(1).map(|part| {
        let x = right - part * length;
        Vector3::new(x, 2.0 * arc, core * (1.0 - smooth_step(part)))
    }));
    // Down to the winding, which begins above the core.
    let smaller = arc - 0.5 * winding;
    curve.extend(parts().skip(1).map(|part| {
        let (sine, cosine) = libm::sincos(PI * part);
        Vector3::new(
            left - smaller * sine,
            2.0 * arc - smaller * (1.0 - cosine),
            0.0,
        )
    }));
    curve.extend(parts().skip(1).map(|part| {
        let angle = HALF_TURNS * PI * smooth_step(part);
        Vector3::new(
            left + part * length,
            winding * libm::cos(angle),
            winding * libm::sin(angle),
        )
    }));
    curve.extend(parts().skip(1).map(|part| {
        let way = smooth_step(part);
        let y = -(1.0 - way) * winding - way * end_offset;
        Vector3::new(right + part * (half_line - right), y, 0.0)
    }));
    curve
}

#[cfg(test)]
mod tests {
    use super::super::{determinant, determinant_of_pair, least_distance};
    use super::*;

    fn rods(end_to_end: f64, nodes: usize) -> Result<[Vec<Vector3>; 2], String> {
        let size = KnotSize {
            length: 1.0,
            radius: 1.6e-3,
            end_to_end,
        };
        fisherman_nodes(&size, nodes)
    }

    #[test]
    fn each_rod_ties_a_trefoil_and_joined_they_have_their_determinant() {
        for nodes in [201, 301, 601] {
            let [first, second] = rods(0.6, nodes).unwrap();
            assert_eq!(determinant(&first), Some(3));
            assert_eq!(determinant(&second), Some(3));
            let found = determinant_of_pair([&first, &second], &Vector3::x());
            assert_eq!(found, Some(FISHERMAN_DETERMINANT));
        }
    }

    #[test]
    fn strands_stand_apart_and_starts_lie_above_ends() {
        for end_to_end in [0.6, 0.75] {
            let [first, second] = rods(end_to_end, 2001).unwrap();
            let least = least_distance(&[&first, &second], 24e-3);
            assert!(least > 2.02 * 1.6e-3, "{least}");
            let ends = [first[0], first[2000], second[0], second[2000]];
            for (end, [x, y]) in
                ends.iter()
                    .zip([[-0.5, 4e-3], [0.5, -4e-3], [0.5, 4e-3], [-0.5, -4e-3]])
            {
                assert!((end - Vector3::new(x * end_to_end, y, 0.0)).norm() < 1e-15);
            }
        }
    }

    #[test]
    fn a_knot_that_does_not_fit_is_refused_with_what_would() {
        let refusal = |end_to_end| rods(end_to_end, 301).unwrap_err();
        assert!(refusal(0.05).contains("too near"), "{}", refusal(0.05));
        assert!(refusal(0.95).contains("of rod, not"), "{}", refusal(0.95));
    }
}
