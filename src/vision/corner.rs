//! Corners of a skeleton, at which two strands that end on a third one look like one strand.
//!
//! Two strands of one hue that cross under a strand of another hue, or close to it, leave two
//! wedges in their layer. The skeleton of each wedge is a line with a corner that is sharper than
//! the bend of a strand. The line is cut at this corner, so that each half can continue on the
//! other side of the upper strand.

use super::path_energy::unit;
use super::skeleton::{Branch, Node, Skeleton};

/// Length on both sides of a corner that determines its angle, in widths.
const STRETCH: f64 = 1.5;
/// Cosine of the least angle by which a corner turns: 60°, which corresponds to a curve with a
/// radius of one and a half widths.
const COSINE: f64 = 0.5;

/// Cuts the branches of a skeleton at their corners.
pub(super) fn cut_corners(skeleton: &mut Skeleton) {
    let mut branches = Vec::with_capacity(skeleton.branches.len());
    for branch in std::mem::take(&mut skeleton.branches) {
        cut(branch, &mut skeleton.nodes, &mut branches);
    }
    skeleton.branches = branches;
}

fn cut(branch: Branch, nodes: &mut Vec<Node>, branches: &mut Vec<Branch>) {
    let corner = branch
        .nodes
        .and_then(|ends| Some((ends, sharpest(&branch)?)));
    let Some(([begin, end], corner)) = corner else {
        branches.push(branch);
        return;
    };
    let node = nodes.len();
    nodes.push(Node {
        position: branch.pixels[corner],
        half_width: branch.half_widths[corner],
    });
    let part = |pixels: std::ops::Range<usize>, nodes| Branch {
        pixels: branch.pixels[pixels.clone()].to_vec(),
        half_widths: branch.half_widths[pixels].to_vec(),
        nodes: Some(nodes),
    };
    cut(part(0..corner, [begin, node]), nodes, branches);
    let rest = corner + 1..branch.pixels.len();
    cut(part(rest, [node, end]), nodes, branches);
}

/// The pixel at which a branch bends most, if it is a corner.
fn sharpest(branch: &Branch) -> Option<usize> {
    let reach = (STRETCH * 2.0 * branch.half_width()).ceil().max(4.0) as usize;
    let pixels = &branch.pixels;
    let cosine = |index: usize| {
        let [before, here, behind] = [index - reach, index, index + reach].map(|k| pixels[k]);
        unit(here - before).dot(&unit(behind - here))
    };
    let inside = reach..pixels.len().saturating_sub(reach);
    let cosines = inside.map(|index| (index, cosine(index)));
    let (corner, least) = cosines.min_by(|a, b| a.1.total_cmp(&b.1))?;
    (least < COSINE).then_some(corner)
}

#[cfg(test)]
mod tests {
    use super::super::Point;
    use super::*;

    fn branch(place: impl Fn(f64) -> Point) -> Skeleton {
        let pixels: Vec<Point> = (0..80).map(|k| place(f64::from(k) - 40.0)).collect();
        let node = |position| Node {
            position,
            half_width: 3.0,
        };
        Skeleton {
            nodes: vec![node(place(-41.0)), node(place(40.0))],
            branches: vec![Branch {
                half_widths: vec![3.0; pixels.len()],
                pixels,
                nodes: Some([0, 1]),
            }],
        }
    }

    #[test]
    fn a_wedge_is_cut_at_its_tip_and_an_arc_is_not() {
        let mut wedge = branch(|s| Point::new(50.0 - s.abs() * 0.6, 50.0 + s * 0.8));
        cut_corners(&mut wedge);
        assert_eq!((wedge.nodes.len(), wedge.branches.len()), (3, 2));
        assert!((wedge.nodes[2].position - Point::new(50.0, 50.0)).norm() < 1.5);
        assert_eq!(wedge.branches[0].nodes, Some([0, 2]));
        assert_eq!(wedge.branches[1].nodes, Some([2, 1]));

        // Two widths of radius.
        let mut arc = branch(|s| Point::new(12.0 * (s / 12.0).cos(), 12.0 * (s / 12.0).sin()));
        cut_corners(&mut arc);
        assert_eq!(arc.branches.len(), 1);
    }
}
