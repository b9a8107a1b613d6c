//! Open overhand knots: a loop, a braid of 2n + 1 crossings below it, and two straight tails on one line.

use super::loop_elastica::LoopElastica;
use super::polyline::{equally_spaced, length};
use super::traction::relaxed_loop;
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::kirchhoff::numerics::smooth_step;
use std::f64::consts::PI;

/// An open overhand knot of unknotting number n: the long (2, 2n+1) torus knot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overhand {
    /// Unknotting number n: 1 is the trefoil, 2 the cinquefoil.
    pub unknotting_number: usize,
    /// Length of the rod, m.
    pub length: f64,
    /// Radius of the rod, m.
    pub radius: f64,
    /// Distance of the ends, m.
    pub end_to_end: f64,
}

/// Distance of the strands' centrelines from the axis of the braid, in radii: the surfaces are 0.4
/// h apart. Nearer strands would overlap where the polyline cuts the corners of a coarse helix;
/// farther ones take longer to settle.
const STRAND_OFFSET: f64 = 1.2;
/// Least length of the tails beyond the braid, in radii, over which the strands return to the
/// axis.
const SHORTEST_TAIL: f64 = 8.0;
/// Points of the smooth curve per part: tails, braid, loop.
const POINTS: usize = 4000;
/// Maximum number of iterations for the shortening that gives the rod its length; each gains more
/// than a digit.
const REPETITIONS: usize = 20;

/// The nodes of the knot, m, equally spaced along a curve around the x axis from x = −D/2 to x =
/// D/2, where D is the distance of the ends. The loop lies in the half plane y > 0.
///
/// Braid and loop have the proportions of least energy without friction
/// ([`relaxed_loop`](super::relaxed_loop)). The strands are slightly apart.
///
/// # Errors
/// A message if braid and loop do not fit between the ends.
pub fn overhand_nodes(knot: &Overhand, nodes: usize) -> Result<Vec<Vector3>, String> {
    let mut shortening = knot.length - knot.end_to_end;
    let mut curve = Vec::new();
    for _ in 0..REPETITIONS {
        curve = smooth_curve(knot, shortening)?;
        shortening += knot.length - length(&curve);
    }
    Ok(equally_spaced(&curve, nodes))
}

fn smooth_curve(knot: &Overhand, shortening: f64) -> Result<Vec<Vector3>, String> {
    let shape = relaxed_loop(knot.unknotting_number, knot.radius, shortening);
    let half_braid = 0.5 * shape.braid;
    let half_line = 0.5 * knot.end_to_end;
    let tail = half_line - half_braid;
    let least = SHORTEST_TAIL * knot.radius;
    if !(tail > least) {
        return Err(format!(
            "the knot is {:.4} m wide, its ends only {:.4} m apart",
            2.0 * (half_braid + least),
            knot.end_to_end
        ));
    }
    let half_turns = 2 * knot.unknotting_number + 1;
    let offset = STRAND_OFFSET * knot.radius;
    // Beyond the braid the strands return to the axis as slowly as the tails allow, so that they do
    // not touch the loop.
    let faded = |along: f64| offset * (1.0 - smooth_step(along / tail));
    let strand = |x: f64, phase: f64| {
        let part = (x + half_braid) / (2.0 * half_braid);
        let angle = phase + half_turns as f64 * PI * smooth_step(part);
        let distance = faded(x.abs() - half_braid);
        Vector3::new(x, distance * libm::cos(angle), distance * libm::sin(angle))
    };
    let line = |from: f64, to: f64, phase: f64| {
        (0..=POINTS).map(move |k| {
            let x = from + (to - from) * k as f64 / POINTS as f64;
            strand(x, phase)
        })
    };
    let mut curve: Vec<Vector3> = line(-half_line, -half_braid, PI).collect();
    curve.extend(line(-half_braid, half_braid, PI).skip(1));
    curve.extend(
        loop_points(&shape.elastica, shape.radius, half_braid, offset)
            .into_iter()
            .skip(1),
    );
    curve.extend(line(-half_braid, half_braid, 0.0).skip(1));
    curve.extend(line(half_braid, half_line, 0.0).skip(1));
    Ok(curve)
}

/// The loop from the right end of the braid to its left end. The loop is raised above the braid at
/// both ends and follows the elastica at the top.
fn loop_points(elastica: &LoopElastica, radius: f64, half_braid: f64, offset: f64) -> Vec<Vector3> {
    let points = elastica.points(POINTS);
    let length = points[POINTS][2] * radius;
    points
        .iter()
        .enumerate()
        .map(|(k, &[x, y, s])| {
            let angle = std::f64::consts::TAU * k as f64 / POINTS as f64;
            let along = (s * radius).min(length - s * radius);
            let distance = offset * (1.0 - smooth_step(2.0 * along / length));
            let inward = Vector3::new(-libm::sin(angle), libm::cos(angle), 0.0) * distance;
            Vector3::new(half_braid + x * radius, y * radius, 0.0) + inward
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::determinant;
    use super::*;

    fn knot(unknotting_number: usize) -> Overhand {
        Overhand {
            unknotting_number,
            length: 1.0,
            radius: 1.6e-3,
            end_to_end: 0.4,
        }
    }

    #[test]
    fn knots_have_their_determinant_at_any_fineness() {
        for n in 1..=6 {
            for nodes in [151, 301, 601] {
                let nodes = overhand_nodes(&knot(n), nodes).unwrap();
                assert_eq!(determinant(&nodes), Some(2 * n as u64 + 1));
            }
        }
    }

    #[test]
    fn nodes_are_equally_spaced_along_a_rod_of_the_length_asked_for() {
        for n in [1, 4] {
            let nodes = overhand_nodes(&knot(n), 301).unwrap();
            assert!((nodes[0] - Vector3::new(-0.2, 0.0, 0.0)).norm() < 1e-15);
            assert!((nodes[300] - Vector3::new(0.2, 0.0, 0.0)).norm() < 1e-15);
            assert!((length(&nodes) - 1.0).abs() < 2e-3, "{}", length(&nodes));
            assert!(
                nodes
                    .windows(2)
                    .all(|pair| ((pair[1] - pair[0]).norm() * 300.0 - 1.0).abs() < 0.02)
            );
        }
    }

    #[test]
    fn strands_stand_apart() {
        for n in 1..=6 {
            // Six turns need a longer braid.
            let knot = Overhand {
                length: if n == 6 { 1.5 } else { 1.0 },
                end_to_end: if n == 6 { 0.55 } else { 0.4 },
                ..knot(n)
            };
            let curve = overhand_nodes(&knot, 2001).unwrap();
            // Within ten radii along the rod a strand does not return to itself.
            for (i, a) in curve.iter().enumerate() {
                for b in curve.iter().skip(i + 32) {
                    assert!((a - b).norm() > 2.02 * knot.radius, "n = {n}");
                }
            }
        }
    }

    #[test]
    fn a_knot_wider_than_its_ends_are_apart_is_refused() {
        let narrow = Overhand {
            end_to_end: 0.05,
            ..knot(3)
        };
        assert!(overhand_nodes(&narrow, 301).is_err());
    }
}
