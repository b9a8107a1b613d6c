//! Posts on the table, and whether a rod passes them as its pattern does.
//!
//! A rod is placed if two conditions hold at every peg. Seen from above, the peg is on the same
//! side of the rod as of the pattern; and the rod lies beside the peg, below its top. The side is a
//! topological property: rod and pattern, joined by straight lines at their ends, form a closed
//! curve that must not go around the peg.

use super::keys::Peg;
use crate::experiment::prepare::round_rod;
use crate::scenario::{BuilderRod, Material};
use nalgebra::Vector2;
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::scene::RodDescription;
use rodlab_planning::plan::pattern::Pattern;
use std::f64::consts::TAU;

/// Number of nodes of a post, which is one edge.
pub const NODES: usize = 2;
/// Young's modulus of steel: the softer of two bodies limits the stiffness of contact.
const STEEL: Material = Material {
    youngs_modulus: 2e11,
    poissons_ratio: 0.3,
    density: 7850.0,
    viscosity: 0.0,
    relaxing_modulus: 0.0,
    relaxation_time: 0.0,
    yield_stress: 0.0,
    tangent_modulus: 0.0,
};
/// Points of a pattern seen from above.
const OUTLINE: usize = 2000;
/// Points of a drawn circle.
const CIRCLE: usize = 24;

/// The rigid obstacle that represents a peg: its cylinder and its round top.
pub fn post(name: &str, peg: &Peg) -> RodDescription {
    let [x, y] = peg.position;
    let axis = [0.0, peg.height - peg.radius].map(|z| Vector3::new(x, y, z));
    let section = BuilderRod {
        radius: peg.radius,
        nodes: NODES,
    };
    RodDescription {
        held: true,
        ..round_rod(name, axis.into(), &STEEL, &section)
    }
}

/// A pattern from above, m.
pub fn outline(curve: &Pattern) -> Vec<[f64; 2]> {
    let step = curve.length() / OUTLINE as f64;
    let points = curve.sampled(step).into_iter();
    points.map(|point| point.position.into()).collect()
}

/// Circles of pegs from above for a plot, with gaps between them, m.
pub fn outlines(pegs: &[Peg]) -> Vec<(f64, Option<f64>)> {
    let circle = |peg: &Peg| {
        let ([x, y], radius) = (peg.position, peg.radius);
        let points = (0..=CIRCLE).map(move |index| {
            let (sine, cosine) = libm::sincos(TAU * index as f64 / CIRCLE as f64);
            (x + radius * cosine, Some(y + radius * sine))
        });
        points.chain([(x, None)])
    };
    pegs.iter().flat_map(circle).collect()
}

/// The first `part` (a fraction, at most 1) of a rod of equal edges; the last point lies between
/// two nodes.
pub fn first_part(nodes: &[Vector3], part: f64) -> Vec<Vector3> {
    let along = (part * (nodes.len() - 1) as f64).clamp(0.0, (nodes.len() - 1) as f64);
    let whole = along.floor() as usize;
    let mut first = nodes[..=whole].to_vec();
    if let Some(next) = nodes.get(whole + 1) {
        first.push(nodes[whole].lerp(next, along - whole as f64));
    }
    first
}

/// Whether a rod passes a peg on the same side as its pattern and lies below the top of the peg
/// there.
pub fn passes(rod: &[Vector3], pattern: &[[f64; 2]], peg: &Peg) -> bool {
    let axis = Vector2::from(peg.position);
    let from_above = rod.iter().map(|node| node.xy());
    is_on_its_side(from_above, pattern, &axis) && height_beside(rod, &axis) < peg.height
}

/// Whether a rod, seen from above, passes a peg on the same side as its pattern without lying on
/// the peg. The centreline of the rod must be farther from the axis of the peg than the radius of
/// the peg.
pub fn passes_beside(rod: &[Vector2<f64>], pattern: &[[f64; 2]], peg: &Peg) -> bool {
    let axis = Vector2::from(peg.position);
    let is_beside = rod.windows(2).all(|edge| {
        let along = edge[1] - edge[0];
        (edge[0] + part_nearest(&edge[0], &along, &axis) * along - axis).norm() > peg.radius
    });
    is_beside && is_on_its_side(rod.iter().copied(), pattern, &axis)
}

/// Whether the closed curve of a rod and its pattern, seen from above, does not go around an axis.
fn is_on_its_side(
    rod: impl Iterator<Item = Vector2<f64>>,
    pattern: &[[f64; 2]],
    axis: &Vector2<f64>,
) -> bool {
    let back = pattern.iter().rev().map(|&point| Vector2::from(point));
    let between: Vec<Vector2<f64>> = rod.chain(back).collect();
    winding_number(&between, axis) == 0
}

/// Parameter along an edge, from 0 to 1, of the point nearest to a place.
fn part_nearest(from: &Vector2<f64>, along: &Vector2<f64>, place: &Vector2<f64>) -> f64 {
    let length = along.norm_squared();
    if length > 0.0 {
        ((place - from).dot(along) / length).clamp(0.0, 1.0)
    } else {
        0.0
    }
}

/// Winding number of a closed polygon around a point, counter-clockwise.
fn winding_number(polygon: &[Vector2<f64>], point: &Vector2<f64>) -> i64 {
    let next = polygon.iter().cycle().skip(1);
    let crossed = polygon.iter().zip(next).map(|(from, to)| {
        // Crossings of the ray from the point along +x.
        let is_left = (to - from).perp(&(point - from)) > 0.0;
        match (from.y <= point.y, to.y <= point.y) {
            (true, false) if is_left => 1,
            (false, true) if !is_left => -1,
            _ => 0,
        }
    });
    crossed.sum()
}

/// Height of a rod where it is nearest to a vertical axis, m.
fn height_beside(rod: &[Vector3], axis: &Vector2<f64>) -> f64 {
    let nearest = rod.windows(2).map(|edge| {
        let (from, along) = (edge[0].xy(), (edge[1] - edge[0]).xy());
        let place = edge[0].lerp(&edge[1], part_nearest(&from, &along, axis));
        ((place.xy() - axis).norm(), place.z)
    });
    let nearest = nearest.min_by(|one, other| one.0.total_cmp(&other.0));
    nearest.map_or(f64::INFINITY, |(_, height)| height)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn peg(x: f64, y: f64) -> Peg {
        Peg {
            position: [x, y],
            radius: 0.004,
            height: 0.006,
        }
    }

    /// A rod on the table along y = `offset` + a bump of height `bump` around x = 0.1.
    fn rod(offset: f64, bump: f64) -> Vec<Vector3> {
        let at = |index: i32| {
            let x = 0.2 * f64::from(index) / 100.0;
            let y = offset + bump * (-((x - 0.1) / 0.02).powi(2)).exp();
            Vector3::new(x, y, 0.002)
        };
        (0..=100).map(at).collect()
    }

    fn line() -> Vec<[f64; 2]> {
        (0..=10)
            .map(|index| [0.02 * f64::from(index), 0.0])
            .collect()
    }

    #[test]
    fn a_peg_between_rod_and_pattern_is_passed_on_the_wrong_side() {
        let lying = rod(0.0, 0.02);
        // The bump and the pattern go around a peg between them. They do not go around a peg
        // beyond the bump, below the pattern, or away from the bump.
        assert!(!passes(&lying, &line(), &peg(0.1, 0.01)));
        assert!(passes(&lying, &line(), &peg(0.1, 0.03)));
        assert!(passes(&lying, &line(), &peg(0.1, -0.01)));
        assert!(passes(&lying, &line(), &peg(0.05, 0.01)));
        // A rod that deviates by less than the distance of the peg passes it as the pattern does.
        assert!(passes(&rod(0.003, 0.0), &line(), &peg(0.1, 0.01)));
        assert!(!passes(&rod(0.013, 0.0), &line(), &peg(0.1, 0.01)));
    }

    #[test]
    fn both_senses_of_a_pattern_and_a_closed_one_agree() {
        let ring = |radius: f64| {
            let at = move |index: i32| {
                let (sine, cosine) = (TAU * f64::from(index) / 60.0).sin_cos();
                Vector3::new(radius * cosine, radius * sine, 0.002)
            };
            (0..=60).map(at)
        };
        let pattern: Vec<[f64; 2]> = ring(0.1).map(|point| [point.x, point.y]).collect();
        for (radius, passed) in [(0.1, true), (0.102, true), (0.12, false)] {
            for reversed in [false, true] {
                let mut rod: Vec<Vector3> = ring(radius).collect();
                let mut pattern = pattern.clone();
                if reversed {
                    rod.reverse();
                    pattern.reverse();
                }
                assert_eq!(passes(&rod, &pattern, &peg(0.0, 0.11)), passed, "{radius}");
                assert!(passes(&rod, &pattern, &peg(0.0, 0.0)));
            }
        }
    }

    #[test]
    fn a_rod_on_the_top_of_a_peg_is_not_placed() {
        let mut lying = rod(0.008, 0.0);
        assert!(passes(&lying, &line(), &peg(0.1, 0.014)));
        for node in &mut lying[45..=55] {
            node.z = 0.0061;
        }
        assert!(!passes(&lying, &line(), &peg(0.1, 0.014)));
    }

    #[test]
    fn a_rod_that_is_seen_on_a_peg_is_not_placed() {
        let seen = |offset: f64| -> Vec<Vector2<f64>> {
            rod(offset, 0.0).iter().map(|node| node.xy()).collect()
        };
        let stands = peg(0.1, 0.014);
        assert!(passes_beside(&seen(0.008), &line(), &stands));
        // Here the centreline is within the radius of the peg, or on the other side of the peg.
        assert!(!passes_beside(&seen(0.011), &line(), &stands));
        assert!(!passes_beside(&seen(0.0201), &line(), &stands));
    }

    #[test]
    fn a_post_ends_with_its_round_top() {
        let post = post("peg", &peg(0.1, 0.2));
        assert!(post.held);
        assert_eq!(post.centreline.len(), NODES);
        assert!((post.centreline[1].z + post.radius - 0.006).abs() < 1e-15);
    }

    #[test]
    fn the_first_part_ends_between_two_nodes() {
        let nodes: Vec<Vector3> = (0..=4)
            .map(|x| Vector3::new(f64::from(x), 0.0, 0.0))
            .collect();
        let first = first_part(&nodes, 0.6);
        assert_eq!(first.len(), 4);
        assert!((first[3].x - 2.4).abs() < 1e-15);
        assert_eq!(first_part(&nodes, 1.0).len(), 5);
    }
}
