//! The open figure-eight knot, from its Chebyshev curve.

use super::KnotSize;
use super::polyline::equally_spaced;
use rodlab_engine::mechanics::Vector3;

/// Height of the curve, in radii. At the crossings its strands are at least 1.018 heights apart,
/// so their surfaces are 0.6 radii apart.
const HEIGHT: f64 = 2.55;
/// Least extent of the loops, in radii: in smaller loops the strands of adjacent crossings touch.
const SMALLEST: f64 = 12.0;
/// Least length of the tails beyond the loops, over the extent of the loops. Over this length they
/// return to the axis.
const SHORTEST_TAIL: f64 = 1.0;
/// Determinant of the figure-eight knot, whose Alexander polynomial is t² − 3t + 1.
pub const FIGURE_EIGHT_DETERMINANT: u64 = 5;
/// Points of the smooth curve per part: each tail, the loops.
const POINTS: usize = 2000;

/// The nodes of a figure-eight knot, m, equally spaced along a curve around the x axis, from x =
/// −D/2 to x = D/2, where D is the distance of the ends.
///
/// Between its tails the curve is (a T₅(t), a T₃(t), c T₇(t)) with Chebyshev polynomials, −1 ≤ t ≤
/// 1 (the harmonic knot H(3, 5, 7) of Koseleff and Pecker). The knot has four crossings,
/// alternately above and below. The curve is symmetric about a point, since the knot is its own
/// mirror image.
///
/// # Errors
/// A message if loops and tails do not fit between the ends.
pub fn figure_eight_nodes(knot: &KnotSize, nodes: usize) -> Result<Vec<Vector3>, String> {
    let half_line = 0.5 * knot.end_to_end;
    let height = HEIGHT * knot.radius;
    let extents = [SMALLEST * knot.radius, half_line / (1.0 + SHORTEST_TAIL)];
    let curve = knot.fitted(extents, |extent| smooth_curve(extent, height, half_line))?;
    Ok(equally_spaced(&curve, nodes))
}

fn smooth_curve(extent: f64, height: f64, half_line: f64) -> Vec<Vector3> {
    let corner = Vector3::new(extent, extent, height);
    // T_n'(1) = n².
    let slope = Vector3::new(25.0 * extent, 9.0 * extent, 49.0 * height).normalize();
    let tail = half_line - extent;
    // A cubic from the corner to the axis, which it meets tangentially.
    let right = (1..=POINTS).map(|k| {
        let t = k as f64 / POINTS as f64;
        let s = 1.0 - t;
        (corner * (s + 3.0 * t) + slope * (t * tail)) * (s * s)
            + (Vector3::x() * (half_line * (t + 3.0 * s)) - Vector3::x() * (s * tail)) * (t * t)
    });
    let right: Vec<Vector3> = right.collect();
    let loops = (0..=POINTS).map(|k| {
        let angle = std::f64::consts::PI * (1.0 - k as f64 / POINTS as f64);
        Vector3::new(
            extent * libm::cos(5.0 * angle),
            extent * libm::cos(3.0 * angle),
            height * libm::cos(7.0 * angle),
        )
    });
    let mut curve: Vec<Vector3> = right.iter().rev().map(|point| -point).collect();
    curve.extend(loops);
    curve.extend(right);
    curve
}

#[cfg(test)]
mod tests {
    use super::super::{determinant, least_distance};
    use super::*;

    fn knot(end_to_end: f64) -> KnotSize {
        KnotSize {
            length: 1.0,
            radius: 1.6e-3,
            end_to_end,
        }
    }

    #[test]
    fn it_is_a_figure_eight_at_any_fineness() {
        for end_to_end in [0.3, 0.6] {
            for nodes in [151, 301, 601] {
                let nodes = figure_eight_nodes(&knot(end_to_end), nodes).unwrap();
                assert_eq!(determinant(&nodes), Some(FIGURE_EIGHT_DETERMINANT));
            }
        }
    }

    #[test]
    fn its_strands_stand_apart() {
        for end_to_end in [0.3, 0.6] {
            let curve = figure_eight_nodes(&knot(end_to_end), 2001).unwrap();
            let least = least_distance(&[&curve], 16e-3);
            assert!(least > 2.02 * 1.6e-3, "{end_to_end} {least}");
        }
    }

    #[test]
    fn it_is_symmetric_about_the_middle() {
        let nodes = figure_eight_nodes(&knot(0.5), 301).unwrap();
        for (node, opposite) in nodes.iter().zip(nodes.iter().rev()) {
            assert!((node + opposite).norm() < 1e-12);
        }
    }

    #[test]
    fn a_knot_that_does_not_fit_is_refused_with_what_would() {
        let refusal = |end_to_end| figure_eight_nodes(&knot(end_to_end), 301).unwrap_err();
        assert!(refusal(0.05).contains("too near"), "{}", refusal(0.05));
        assert!(refusal(0.9).contains("of rod, not"), "{}", refusal(0.9));
        assert!(refusal(0.1).contains("of rod, not"), "{}", refusal(0.1));
    }
}
