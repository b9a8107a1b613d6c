//! Continuous collision detection for two moving edges, by conservative advancement.
//!
//! The nodes move along straight lines, x_m + t v_m. For any unit vector n the distance of the
//! edges is at least the width of the slab that separates them along n, since every point of an
//! edge is between its ends:
//!
//! Δ(t) ≥ min over i, j of n·(x_i + t v_i) − n·(x_j + t v_j), i in {0, 1}, j in {2, 3},
//!
//! At t = 0 the two sides are equal for the direction n of the closest points. So the edges may
//! move until this slab has become too thin; then the closest points are computed again, and so
//! on. (Mirtich 1996. Li et al. 2021, "Codimensional incremental potential contact", advance by
//! the largest speed of the nodes over all directions instead, which is slower.) Edges that slide
//! along each other need one slab; a bound by speed would advance by a fraction of the gap at a
//! time. The bound does not depend on the features that are nearest (point–point, point–edge,
//! edge–edge). An error of the closest points makes the slab thinner than necessary, never too
//! thick.

use super::closest_points::ClosestPoints;
use crate::mechanics::Vector3;

/// Part of a gap that a step must leave.
///
/// A barrier grows like the inverse of the gap, so a step may increase its force tenfold. With a
/// smaller part, an overlong step could end in a state from which Newton's method needs many steps
/// to return. A larger part would need more steps when a force rises by orders of magnitude.
pub(super) const KEPT_GAP: f64 = 0.1;
/// The search ends after an advance that leaves at most this fraction of the kept gap as slack.
const USED_UP: f64 = 0.1;
/// Maximum number of advances. After these the search returns the path so far, which is safe.
///
/// Usually a few are enough. A pair of edges of length L that turn together by an angle θ needs θL
/// divided by the gap, since the slabs do not turn: hundreds in the largest steps of a turning
/// bundle.
const ADVANCES: usize = 1000;

/// The largest fraction t of the path `displacements`, at most `longest`, along which the
/// centrelines of the edges (`nodes[0]`, `nodes[1]`) and (`nodes[2]`, `nodes[3]`) stay farther
/// apart than `threshold` (m) plus a tenth of their present gap beyond it. Zero for edges that are
/// already nearer than `threshold`.
pub(super) fn safe_fraction(
    nodes: &[Vector3; 4],
    displacements: &[Vector3; 4],
    threshold: f64,
    longest: f64,
) -> f64 {
    safe_fraction_from(
        separation_of_edges(nodes),
        [nodes, displacements],
        &ENDS,
        separation_of_edges,
        [threshold, longest],
    )
}

/// The largest fraction of the path `displacements`, at most `longest`, along which the
/// centrelines of the edges are certain to be farther apart than the first of `bounds` (m). The
/// whole path if they never come within the second of `bounds` of that distance.
pub(super) fn fraction_beyond(
    nodes: &[Vector3; 4],
    displacements: &[Vector3; 4],
    bounds: [f64; 2],
    longest: f64,
) -> f64 {
    advance(
        separation_of_edges(nodes),
        [nodes, displacements],
        &ENDS,
        separation_of_edges,
        bounds,
        longest,
    )
}

/// Ends of the first edge with those of the second.
const ENDS: [(usize, usize); 4] = [(0, 2), (0, 3), (1, 2), (1, 3)];

fn separation_of_edges(nodes: &[Vector3; 4]) -> Vector3 {
    ClosestPoints::of(nodes).separation
}

/// [`safe_fraction`] for two bodies that are the convex hulls of some of the four corners; `pairs`
/// lists each corner of the first with each of the second. `separation` is the vector between
/// their nearest points, which is `apart` at the start.
pub(super) fn safe_fraction_from(
    apart: Vector3,
    paths: [&[Vector3; 4]; 2],
    pairs: &[(usize, usize)],
    separation: impl Fn(&[Vector3; 4]) -> Vector3,
    [threshold, longest]: [f64; 2],
) -> f64 {
    let gap = apart.norm() - threshold;
    if !(gap > 0.0) {
        return 0.0;
    }
    let kept = threshold + KEPT_GAP * gap;
    let tolerance = USED_UP * KEPT_GAP * gap;
    advance(apart, paths, pairs, separation, [kept, tolerance], longest)
}

/// [`fraction_beyond`] for two such bodies.
fn advance(
    mut apart: Vector3,
    [corners, displacements]: [&[Vector3; 4]; 2],
    pairs: &[(usize, usize)],
    separation: impl Fn(&[Vector3; 4]) -> Vector3,
    [kept, tolerance]: [f64; 2],
    longest: f64,
) -> f64 {
    let (mut fraction, mut moved) = (0.0, *corners);
    for _ in 0..ADVANCES {
        let normal = apart / apart.norm();
        // Heights are measured from a corner, so that rounding errors do not depend on the distance
        // from the origin.
        let height = |m: usize| (moved[m] - moved[0]).dot(&normal);
        let speed = |m: usize| displacements[m].dot(&normal);
        let mut advance = longest - fraction;
        for &(i, j) in pairs {
            let slack = (height(i) - height(j) - kept).max(0.0);
            let approach = speed(j) - speed(i);
            if slack < approach * advance {
                advance = slack / approach;
            }
        }
        if advance >= longest - fraction {
            return longest;
        }
        fraction += advance;
        moved = std::array::from_fn(|m| corners[m] + displacements[m] * fraction);
        apart = separation(&moved);
        if apart.norm() - kept <= tolerance {
            break;
        }
    }
    fraction
}

#[cfg(test)]
mod tests {
    use super::super::test_support::Random;
    use super::*;

    use super::super::closest_points::edge_distance;

    const THRESHOLD: f64 = 1.0;

    /// Least distance on the path up to `fraction`, from dense samples.
    fn least_distance(nodes: &[Vector3; 4], displacements: &[Vector3; 4], fraction: f64) -> f64 {
        const SAMPLES: u32 = 400;
        (0..=SAMPLES)
            .map(|sample| {
                let t = fraction * f64::from(sample) / f64::from(SAMPLES);
                edge_distance(&std::array::from_fn(|m| nodes[m] + displacements[m] * t))
            })
            .fold(f64::INFINITY, f64::min)
    }

    /// Free fraction of the path for a distance of `kept`, found by advances bounded by the speed
    /// of the nodes.
    fn safe_fraction_by_speed(
        nodes: &[Vector3; 4],
        displacements: &[Vector3; 4],
        kept: f64,
    ) -> f64 {
        let [a, b, c, d] = displacements.map(|displacement| displacement.norm());
        let speed = a.max(b) + c.max(d);
        let mut fraction = 0.0;
        for _ in 0..20_000 {
            let moved = std::array::from_fn(|m| nodes[m] + displacements[m] * fraction);
            fraction += (edge_distance(&moved) - kept) / speed;
            if fraction >= 1.0 {
                return 1.0;
            }
        }
        fraction
    }

    struct Flight {
        nodes: [Vector3; 4],
        displacements: [Vector3; 4],
    }

    /// Random pairs, some nearly parallel, with gaps and motions of many orders of magnitude.
    fn flights(count: usize) -> Vec<Flight> {
        let mut random = Random::new(23);
        let mut flights = Vec::new();
        while flights.len() < count {
            let first = [random.vector() * 3.0, random.vector() * 3.0];
            let parallel = flights.len() % 3 == 0;
            let second = if parallel {
                let tilt = 10f64.powf(-5.0 + 4.0 * random.symmetric());
                first.map(|node| node + random.vector() * tilt)
            } else {
                [random.vector() * 3.0, random.vector() * 3.0]
            };
            let mut nodes = [first[0], first[1], second[0], second[1]];
            // Moves along the closest points, or across parallel edges, to the wanted gap.
            let closest = ClosestPoints::of(&nodes);
            let edge = nodes[1] - nodes[0];
            let away = if parallel {
                edge.cross(&random.vector()).normalize()
            } else {
                closest.separation / closest.distance()
            };
            let gap = 10f64.powf(-2.5 + 2.5 * random.symmetric());
            for _ in 0..50 {
                let short = THRESHOLD + gap - edge_distance(&nodes);
                nodes[0] += away * short;
                nodes[1] += away * short;
            }
            if (edge_distance(&nodes) - THRESHOLD - gap).abs() > 0.5 * gap {
                continue;
            }
            let size = 10f64.powf(-1.0 + 2.0 * random.symmetric());
            let displacements = [(); 4].map(|()| random.vector() * size);
            flights.push(Flight {
                nodes,
                displacements,
            });
        }
        flights
    }

    #[test]
    fn no_collision_is_missed() {
        let (mut stopped, mut free) = (0, 0);
        for Flight {
            nodes,
            displacements,
        } in flights(3000)
        {
            let gap = edge_distance(&nodes) - THRESHOLD;
            let fraction = safe_fraction(&nodes, &displacements, THRESHOLD, 1.0);
            assert!((0.0..=1.0).contains(&fraction));
            let least = least_distance(&nodes, &displacements, fraction);
            assert!(
                least > THRESHOLD + 0.099 * gap,
                "gap {gap:e}, least {least:e}"
            );
            if fraction < 1.0 {
                stopped += 1;
            } else {
                free += 1;
            }
        }
        assert!(stopped > 500 && free > 500, "{stopped} {free}");
    }

    #[test]
    fn the_path_is_nearly_as_long_as_it_may_be() {
        let mut shortened = 0;
        for Flight {
            nodes,
            displacements,
        } in flights(1000)
        {
            let gap = edge_distance(&nodes) - THRESHOLD;
            let fraction = safe_fraction(&nodes, &displacements, THRESHOLD, 1.0);
            // A tenth of the kept gap may remain unused.
            let used_up = THRESHOLD + (1.0 + USED_UP) * KEPT_GAP * gap;
            let longest = safe_fraction_by_speed(&nodes, &displacements, used_up);
            assert!(
                fraction > 0.1 * longest,
                "{fraction:e} of {longest:e}, gap {gap:e}"
            );
            shortened += usize::from(fraction < 0.999 * longest);
        }
        // The advances run out where edges turn by radians within a millionth of a radius of each other.
        assert!(shortened < 10, "{shortened} of 1000");
    }

    #[test]
    fn sliding_edges_move_on_without_a_bound() {
        // Crossed at a right angle, a millionth of the radius apart, sliding by many radii.
        let height = Vector3::z() * (THRESHOLD * (1.0 + 1e-6));
        let nodes = [
            Vector3::x() * -2.0,
            Vector3::x() * 2.0,
            height - Vector3::y() * 2.0,
            height + Vector3::y() * 2.0,
        ];
        let slide = [Vector3::new(30.0, 10.0, 0.0), Vector3::new(20.0, -5.0, 0.0)];
        let displacements = [slide[0], slide[0], slide[1], slide[1]];
        assert_eq!(safe_fraction(&nodes, &displacements, THRESHOLD, 1.0), 1.0);
    }

    #[test]
    fn edges_that_touch_already_may_not_move() {
        let nodes = [
            Vector3::zeros(),
            Vector3::x(),
            Vector3::z() * THRESHOLD,
            Vector3::new(0.0, 1.0, THRESHOLD),
        ];
        let displacements = [Vector3::z(); 4];
        assert_eq!(safe_fraction(&nodes, &displacements, THRESHOLD, 1.0), 0.0);
    }
}
