//! A tree of axis-aligned boxes that finds the parts near a point in logarithmic time.
//!
//! The boxes of each node are split at the median of their centres along the axis of largest
//! spread. The nodes are stored in the order in which a search visits them, and each holds the
//! index of the node that follows its subtree, so a search needs no stack.

use crate::mechanics::Vector3;

/// An axis-aligned box. An empty box contains no point and meets no box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct AlignedBox {
    lower: [f64; 3],
    upper: [f64; 3],
}

impl AlignedBox {
    /// The box around no point.
    pub(crate) const EMPTY: Self = Self {
        lower: [f64::INFINITY; 3],
        upper: [f64::NEG_INFINITY; 3],
    };

    /// The box around points, enlarged by `distance` in every direction.
    pub(crate) fn around(points: impl Iterator<Item = Vector3>, distance: f64) -> Self {
        points.fold(Self::EMPTY, |around, point| {
            around.with(&Self {
                lower: std::array::from_fn(|axis| point[axis] - distance),
                upper: std::array::from_fn(|axis| point[axis] + distance),
            })
        })
    }

    /// Whether a point is in the box or on its border.
    pub(crate) fn contains(&self, point: &Vector3) -> bool {
        (0..3).all(|axis| (self.lower[axis]..=self.upper[axis]).contains(&point[axis]))
    }

    /// Whether two boxes have a point in common.
    pub(crate) fn meets(&self, other: &Self) -> bool {
        (0..3).all(|axis| {
            self.lower[axis] <= other.upper[axis] && other.lower[axis] <= self.upper[axis]
        })
    }

    /// The box around both.
    fn with(&self, other: &Self) -> Self {
        Self {
            lower: std::array::from_fn(|axis| self.lower[axis].min(other.lower[axis])),
            upper: std::array::from_fn(|axis| self.upper[axis].max(other.upper[axis])),
        }
    }

    /// Squared distance of a point, m²; 0 inside.
    fn square_distance(&self, point: &Vector3) -> f64 {
        let beyond = |axis: usize| {
            let (below, above) = (
                self.lower[axis] - point[axis],
                point[axis] - self.upper[axis],
            );
            below.max(above).max(0.0)
        };
        (0..3).map(|axis| beyond(axis).powi(2)).sum()
    }

    fn twice_centre(&self, axis: usize) -> f64 {
        self.lower[axis] + self.upper[axis]
    }
}

/// The tree.
#[derive(Clone, Debug)]
pub(super) struct BoxTree {
    nodes: Vec<Node>,
}

#[derive(Clone, Debug)]
struct Node {
    around: AlignedBox,
    /// Index of the node that follows the subtree of this node.
    next: u32,
    /// Index of the box of a leaf; [`NO_PART`] for other nodes.
    part: u32,
}

const NO_PART: u32 = u32::MAX;

impl BoxTree {
    /// A tree of boxes, numbered in the order given.
    pub(crate) fn new(boxes: impl Iterator<Item = AlignedBox>) -> Self {
        let mut parts: Vec<(u32, AlignedBox)> = (0..).zip(boxes).collect();
        let mut tree = Self {
            nodes: Vec::with_capacity(2 * parts.len()),
        };
        if !parts.is_empty() {
            tree.add(&mut parts);
        }
        tree
    }

    fn add(&mut self, parts: &mut [(u32, AlignedBox)]) {
        let index = self.nodes.len();
        let boxes = parts.iter().map(|(_, part)| part);
        let around = boxes.fold(AlignedBox::EMPTY, |around, part| around.with(part));
        let part = if parts.len() == 1 {
            parts[0].0
        } else {
            NO_PART
        };
        self.nodes.push(Node {
            around,
            next: 0,
            part,
        });
        if parts.len() > 1 {
            let axis = axis_of_largest_spread(parts);
            let centre = |(_, part): &(u32, AlignedBox)| part.twice_centre(axis);
            parts.select_nth_unstable_by(parts.len() / 2, |one, other| {
                centre(one).total_cmp(&centre(other))
            });
            let (before, after) = parts.split_at_mut(parts.len() / 2);
            self.add(before);
            self.add(after);
        }
        self.nodes[index].next = self.nodes.len() as u32;
    }

    /// The box around all.
    pub(crate) fn whole(&self) -> AlignedBox {
        self.nodes
            .first()
            .map_or(AlignedBox::EMPTY, |root| root.around)
    }

    /// Numbers of the boxes that meet a box, in no particular order.
    pub(crate) fn meeting(&self, sought: AlignedBox) -> impl Iterator<Item = usize> + use<'_> {
        let mut next = 0;
        std::iter::from_fn(move || {
            while let Some(node) = self.nodes.get(next) {
                if !node.around.meets(&sought) {
                    next = node.next as usize;
                    continue;
                }
                next += 1;
                if node.part != NO_PART {
                    return Some(node.part as usize);
                }
            }
            None
        })
    }

    /// The part nearest to a point, by its `distance` (m), which is at least that of its box, and
    /// this distance; `None` if no part is nearer than `within`.
    pub(crate) fn nearest(
        &self,
        point: &Vector3,
        within: f64,
        distance: impl Fn(usize) -> f64,
    ) -> Option<(usize, f64)> {
        let (mut nearest, mut least) = (None, within);
        let mut next = 0;
        while let Some(node) = self.nodes.get(next) {
            if node.around.square_distance(point) >= least * least {
                next = node.next as usize;
                continue;
            }
            next += 1;
            if node.part != NO_PART {
                let part = node.part as usize;
                let found = distance(part);
                if found < least {
                    (nearest, least) = (Some((part, found)), found);
                }
            }
        }
        nearest
    }
}

fn axis_of_largest_spread(parts: &[(u32, AlignedBox)]) -> usize {
    let spread = |axis: &usize| {
        let centres = parts.iter().map(|(_, part)| part.twice_centre(*axis));
        let [least, largest] = centres.fold([f64::INFINITY, f64::NEG_INFINITY], |range, centre| {
            [range[0].min(centre), range[1].max(centre)]
        });
        largest - least
    };
    let axes = 0..3;
    axes.max_by(|one, other| spread(one).total_cmp(&spread(other)))
        .expect("there are three axes")
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn boxes(count: std::ops::Range<usize>) -> impl Strategy<Value = Vec<AlignedBox>> {
        let number = -4i8..=4;
        let corner = prop::array::uniform3(number.clone()).prop_map(|at| at.map(f64::from));
        let one = (corner, 0u8..3).prop_map(|(centre, size)| {
            AlignedBox::around(std::iter::once(Vector3::from(centre)), f64::from(size))
        });
        prop::collection::vec(one, count)
    }

    proptest! {
        #[test]
        fn a_search_finds_each_box_that_meets_another_once(boxes in boxes(0..40), sought in boxes(1..2)) {
            let tree = BoxTree::new(boxes.iter().copied());
            let mut found: Vec<usize> = tree.meeting(sought[0]).collect();
            found.sort_unstable();
            let meets = |index: &usize| boxes[*index].meets(&sought[0]);
            prop_assert_eq!(found, (0..boxes.len()).filter(meets).collect::<Vec<_>>());
        }
    }

    proptest! {
        #[test]
        fn the_nearest_box_is_the_one_of_least_distance(boxes in boxes(0..40), sought in boxes(1..2), within in 0.0..9.0f64) {
            let tree = BoxTree::new(boxes.iter().copied());
            let point = Vector3::from(sought[0].lower);
            let distance = |index: usize| boxes[index].square_distance(&point).sqrt();
            let found = tree.nearest(&point, within, distance);
            let all = (0..boxes.len()).map(distance).filter(|found| *found < within);
            let least = all.reduce(f64::min);
            prop_assert_eq!(found.map(|(_, distance)| distance), least);
            prop_assert!(found.is_none_or(|(part, own)| own == distance(part)));
        }
    }

    #[test]
    fn boxes_that_touch_meet_and_a_box_around_nothing_meets_none() {
        let around = |x: f64| AlignedBox::around(std::iter::once(Vector3::x() * x), 1.0);
        let tree = BoxTree::new([around(0.0)].into_iter());
        assert_eq!(tree.meeting(around(2.0)).count(), 1);
        assert_eq!(tree.meeting(around(2.0 + 1e-15 + f64::EPSILON)).count(), 0);
        assert_eq!(tree.meeting(AlignedBox::EMPTY).count(), 0);
        assert!(tree.whole().contains(&Vector3::x()));
        let empty = BoxTree::new(std::iter::empty());
        assert!(!empty.whole().contains(&Vector3::zeros()));
        assert_eq!(empty.meeting(around(0.0)).count(), 0);
    }

    #[test]
    fn a_search_among_many_boxes_visits_few() {
        // A row of 10,000 boxes: a search walks two paths down the tree, whose depth is 14.
        let row = (0..10_000)
            .map(|x| AlignedBox::around(std::iter::once(Vector3::x() * f64::from(x)), 0.2));
        let tree = BoxTree::new(row);
        let sought = AlignedBox::around(std::iter::once(Vector3::x() * 4321.0), 0.1);
        let met = tree.nodes.iter().filter(|node| node.around.meets(&sought));
        assert!(met.count() <= 15);
        assert_eq!(tree.meeting(sought).collect::<Vec<_>>(), [4321]);
    }
}
