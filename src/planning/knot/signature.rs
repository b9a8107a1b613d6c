//! The signature of a knot: zero if the knot is its own mirror image, −2 for the right-handed
//! trefoil, 2 for the left-handed one.
//!
//! Signatures of connected sums add up. The signature therefore distinguishes the reef knot, the
//! sum of a trefoil and its mirror image, from the granny knot, the sum of two equal trefoils.
//! Their Alexander polynomials and determinants are the same.
//!
//! The method is that of Gordon and Litherland (On the signature of a link, Invent. Math. 47,
//! 1978). The faces of a projection are coloured like a chessboard. The faces of one colour form a
//! surface whose boundary is the knot; each face i of the other colour is a loop around it. A
//! crossing has the index η = 1 if the strand above, turned counter-clockwise, sweeps over faces
//! of the surface, else −1. The Goeritz matrix G has the entries G_ij = −Σ η over crossings
//! between the faces i and j; its rows add up to zero, and one face is left out. With the sum over
//! crossings at which η is the sign of the crossing, where the surface is not oriented like the
//! knot,
//!
//! ```text
//! σ = sign G − Σ η
//! ```

use super::projection::{Crossing, some_crossings};
use nalgebra::DMatrix;
use rodlab_engine::mechanics::Vector3;

/// Strands that meet at a crossing.
const STRANDS: usize = 4;

/// Signature of a closed polygon, whose last node is joined to the first; a right-handed trefoil has −2. `None` if two segments
/// cross in space, or if no direction of projection was found in which all crossings are clear.
pub fn signature_of_closed(nodes: &[Vector3]) -> Option<i64> {
    Some(signature(&some_crossings(nodes)?))
}

fn signature(crossings: &[Crossing]) -> i64 {
    if crossings.is_empty() {
        return 0;
    }
    let faces = Faces::of(crossings);
    let is_surface = faces.colours();
    let whites: Vec<usize> = (0..faces.count).filter(|&face| !is_surface[face]).collect();
    let row = |face: usize| whites.iter().position(|&white| white == face);
    let mut goeritz = DMatrix::<f64>::zeros(whites.len(), whites.len());
    let mut correction = 0;
    for (index, crossing) in crossings.iter().enumerate() {
        // The strand below enters at corner 0. Turned counter-clockwise, the strand above sweeps
        // over corners 1 and 3.
        let corners: [usize; STRANDS] = std::array::from_fn(|corner| faces.at(index, corner));
        let (eta, white) = if is_surface[corners[1]] {
            (1, [corners[0], corners[2]])
        } else {
            (-1, [corners[1], corners[3]])
        };
        if (eta > 0) == crossing.is_positive {
            correction += eta;
        }
        if let [Some(one), Some(other)] = white.map(row)
            && one != other
        {
            let eta = eta as f64;
            goeritz[(one, other)] -= eta;
            goeritz[(other, one)] -= eta;
            goeritz[(one, one)] += eta;
            goeritz[(other, other)] += eta;
        }
    }
    let size = whites.len().saturating_sub(1);
    if size == 0 {
        return -correction;
    }
    let reduced = goeritz.view((0, 0), (size, size)).into_owned();
    // The determinant of the matrix is that of the knot, an odd number, so no eigenvalue is zero.
    let signs = reduced.symmetric_eigenvalues();
    let sign: i64 = signs
        .iter()
        .map(|value| if *value > 0.0 { 1 } else { -1 })
        .sum();
    sign - correction
}

/// The faces of a projection, given by the corners between adjacent strands of its crossings.
/// Strands of a crossing are numbered counter-clockwise, starting with the one on which the lower
/// strand enters. Corner k follows strand k.
struct Faces {
    of_corner: Vec<usize>,
    count: usize,
}

impl Faces {
    fn of(crossings: &[Crossing]) -> Self {
        // Passages in the order of the curve: position, crossing, whether above.
        let mut passages: Vec<(f64, usize, bool)> = Vec::with_capacity(2 * crossings.len());
        for (index, crossing) in crossings.iter().enumerate() {
            passages.push((crossing.under, index, false));
            passages.push((crossing.over, index, true));
        }
        passages.sort_by(|one, other| one.0.total_cmp(&other.0));
        let strand = |&(_, index, is_above): &(f64, usize, bool), is_going_out: bool| {
            let right_to_left = [3, 1][usize::from(!crossings[index].is_positive)];
            let coming_in = if is_above { right_to_left } else { 0 };
            let strand = (coming_in + if is_going_out { 2 } else { 0 }) % STRANDS;
            (index, strand)
        };
        let mut same: Vec<usize> = (0..STRANDS * crossings.len()).collect();
        let corner = |(crossing, strand): (usize, usize)| STRANDS * crossing + strand % STRANDS;
        let next = passages.iter().cycle().skip(1);
        for (from, to) in passages.iter().zip(next) {
            let ((here, leaving), (there, arriving)) = (strand(from, true), strand(to, false));
            // The corners on the left and on the right of the curve between the two passages.
            let left = [(here, leaving), (there, arriving + STRANDS - 1)];
            let right = [(here, leaving + STRANDS - 1), (there, arriving)];
            for pair in [left, right] {
                let [one, other] = pair.map(|place| representative(&same, corner(place)));
                same[one] = other;
            }
        }
        let representatives: Vec<usize> = (0..same.len())
            .map(|corner| representative(&same, corner))
            .collect();
        let mut known = representatives.clone();
        known.sort_unstable();
        known.dedup();
        let number = |corner: &usize| known.partition_point(|other| other < corner);
        Self {
            of_corner: representatives.iter().map(number).collect(),
            count: known.len(),
        }
    }

    fn at(&self, crossing: usize, corner: usize) -> usize {
        self.of_corner[STRANDS * crossing + corner]
    }

    /// Whether each face has the colour of the first one; adjacent corners of a crossing have
    /// different colours.
    fn colours(&self) -> Vec<bool> {
        let mut colours = vec![None; self.count];
        colours[self.of_corner[0]] = Some(true);
        let mut has_changed = true;
        while has_changed {
            has_changed = false;
            for corners in self.of_corner.chunks(STRANDS) {
                let known = (0..STRANDS).find_map(|k| Some((k, colours[corners[k]]?)));
                let Some((place, colour)) = known else {
                    continue;
                };
                for (corner, &face) in corners.iter().enumerate() {
                    if colours[face].is_none() {
                        colours[face] = Some(colour == (corner % 2 == place % 2));
                        has_changed = true;
                    }
                }
            }
        }
        colours
            .into_iter()
            .map(|colour| colour == Some(true))
            .collect()
    }
}

fn representative(same: &[usize], mut corner: usize) -> usize {
    while same[corner] != corner {
        corner = same[corner];
    }
    corner
}

#[cfg(test)]
mod tests {
    use super::super::closure::joined_far_away;
    use super::super::projection::crossings;
    use super::super::{KnotSize, TwoThrows, determinant_of_closed};
    use super::*;
    use std::f64::consts::TAU;

    fn mirrored(nodes: &[Vector3]) -> Vec<Vector3> {
        let image = |node: &Vector3| Vector3::new(node.x, node.y, -node.z);
        nodes.iter().map(image).collect()
    }

    /// The torus knot (2, q), right-handed.
    fn torus(q: i32) -> Vec<Vector3> {
        let count = 100 * q;
        let at = |k: i32| {
            let angle = TAU * f64::from(k) / f64::from(count);
            let (around, along) = (f64::from(q) * angle, 2.0 * angle);
            let radius = 2.0 + around.cos();
            Vector3::new(radius * along.cos(), radius * along.sin(), around.sin())
        };
        (0..count).map(at).collect()
    }

    #[test]
    fn torus_knots_have_one_less_than_their_crossings() {
        for q in [1, 3, 5, 7] {
            let knot = torus(q);
            let found = signature_of_closed(&knot).unwrap();
            assert_eq!(found.abs(), i64::from(q) - 1);
            assert_eq!(signature_of_closed(&mirrored(&knot)), Some(-found));
            let positive =
                crossings(&knot, &Vector3::new(0.123, 0.218, 0.968).normalize()).unwrap();
            let is_right = positive
                .iter()
                .filter(|crossing| crossing.is_positive)
                .count()
                * 2
                > positive.len();
            assert!(q == 1 || (found < 0) == is_right);
        }
    }

    #[test]
    fn the_figure_eight_is_its_own_mirror_image() {
        let at = |k: i32| {
            let angle = TAU * f64::from(k) / 400.0;
            let radius = 2.0 + (2.0 * angle).cos();
            let [x, y] = [(3.0 * angle).cos(), (3.0 * angle).sin()];
            Vector3::new(radius * x, radius * y, (4.0 * angle).sin())
        };
        let knot: Vec<Vector3> = (0..400).map(at).collect();
        assert_eq!(determinant_of_closed(&knot), Some(5));
        assert_eq!(signature_of_closed(&knot), Some(0));
    }

    #[test]
    fn loops_of_an_unknot_count_for_nothing_in_any_view() {
        // A ring with two kinks, seen from several directions with different crossings.
        let at = |k: i32| {
            let angle = TAU * f64::from(k) / 300.0;
            let radius = 1.0 + 0.9 * (5.0 * angle).cos();
            Vector3::new(
                radius * angle.cos(),
                radius * (2.0 * angle).sin(),
                (0.7 + angle).sin(),
            )
        };
        let ring: Vec<Vector3> = (0..300).map(at).collect();
        let views = [
            [0.3, 0.2, 0.9],
            [0.9, -0.2, 0.1],
            [-0.4, 0.8, 0.2],
            [0.1, 0.1, -0.9],
        ];
        assert_eq!(determinant_of_closed(&ring), Some(1));
        let mut most = 0;
        for view in views {
            let seen = crossings(&ring, &Vector3::from(view).normalize()).unwrap();
            most = most.max(seen.len());
            assert_eq!(signature(&seen), 0);
        }
        assert!(most >= 2, "{most}");
    }

    fn tied(throws: TwoThrows) -> Vec<Vector3> {
        let size = KnotSize {
            length: 1.0,
            radius: 1.6e-3,
            end_to_end: 0.6,
        };
        let [first, second] = throws.nodes(&size, 301).unwrap();
        joined_far_away([&first, &second], &Vector3::x()).unwrap()
    }

    #[test]
    fn a_reef_knot_is_not_a_granny_knot() {
        let (reef, granny) = (tied(TwoThrows::REEF), tied(TwoThrows::GRANNY));
        for knot in [&reef, &granny] {
            assert_eq!(determinant_of_closed(knot), Some(9));
        }
        assert_eq!(signature_of_closed(&reef), Some(0));
        assert_eq!(signature_of_closed(&granny).map(i64::abs), Some(4));
        // The sum of the torus knots (2, 5) and (2, 3) with opposite handedness.
        let surgeon = signature_of_closed(&tied(TwoThrows::SURGEON));
        assert_eq!(surgeon.map(i64::abs), Some(2));
    }
}
