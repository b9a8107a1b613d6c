//! The lengths of chains of joined filaments, for resistive force theory.
//!
//! The coefficients of resistive force theory depend on the length of a filament. If the ends of
//! two filaments are joined, without other joints there, the two count as one filament of their
//! total length. A rod made of pieces therefore has the drag of a rod made in one piece. Where
//! three or more nodes meet, or an end meets the middle of another filament, each filament keeps
//! its own length.

use super::{Connections, Filament};
use crate::mechanics::Vector3;

/// Distance over the radius below which the ends of two filaments are still joined.
const JOINED: f64 = 0.1;

/// Filaments that continue each other.
#[derive(Clone, Debug, Default)]
pub(super) struct Continuation {
    /// Indices of two filaments, and the nodes at which they meet.
    meetings: Vec<([usize; 2], [usize; 2])>,
    /// Scratch: the first filament of the chain of each filament.
    first: Vec<usize>,
    lengths: Vec<f64>,
}

impl Continuation {
    /// Finds the filaments that continue each other among connected ones.
    pub(crate) fn new(filaments: &[Filament], connections: &Connections) -> Self {
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for pair in &connections.joined {
            let (mut ours, others): (Vec<_>, Vec<_>) = (groups.into_iter())
                .partition(|group: &Vec<usize>| pair.iter().any(|node| group.contains(node)));
            ours.push(pair.to_vec());
            let mut group = ours.concat();
            group.sort_unstable();
            group.dedup();
            groups = others;
            groups.push(group);
        }
        let filament_of = |node: usize| {
            let of = filaments
                .iter()
                .position(|filament| filament.range().contains(&node))?;
            let range = filaments[of].range();
            let is_end = !filaments[of].closed && (node == range.start || node + 1 == range.end);
            is_end.then_some(of)
        };
        let meeting = |group: &Vec<usize>| {
            let &[a, b] = group.as_slice() else {
                return None;
            };
            Some(([filament_of(a)?, filament_of(b)?], [a, b]))
        };
        Self {
            meetings: groups.iter().filter_map(meeting).collect(),
            ..Self::default()
        }
    }

    /// Contour length of each filament with all those that continue it, m.
    pub(crate) fn lengths(&mut self, filaments: &[Filament], positions: &[Vector3]) -> &[f64] {
        self.first.clear();
        self.first.extend(0..filaments.len());
        for ([a, b], nodes) in &self.meetings {
            let distance = (positions[nodes[0]] - positions[nodes[1]]).norm();
            let radius = filaments[*a].radius.min(filaments[*b].radius);
            if distance < JOINED * radius {
                let [a, b] = [*a, *b].map(|filament| self.first[filament]);
                for first in &mut self.first {
                    if *first == a.max(b) {
                        *first = a.min(b);
                    }
                }
            }
        }
        self.lengths.clear();
        self.lengths.resize(filaments.len(), 0.0);
        for (filament, &first) in filaments.iter().zip(&self.first) {
            let node = |k: usize| positions[filament.first_node + k % filament.nodes];
            let edges = (0..filament.edges()).map(|k| (node(k + 1) - node(k)).norm());
            self.lengths[first] += edges.sum::<f64>();
        }
        for (filament, &first) in self.first.iter().enumerate() {
            self.lengths[filament] = self.lengths[first];
        }
        &self.lengths
    }
}

impl Continuation {
    /// The first filament of the chain of each filament, at the last [`Self::lengths`].
    pub(crate) fn chains(&self) -> &[usize] {
        &self.first
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Straight filaments of one edge each, 1, 2, 3 and 4 long; each begins where the previous one
    /// ends.
    fn chain() -> (Vec<Filament>, Vec<Vector3>) {
        let filament = |k: usize| Filament {
            first_node: 2 * k,
            nodes: 2,
            closed: false,
            radius: 0.1,
        };
        let x = [0.0, 1.0, 1.0, 3.0, 3.0, 6.0, 6.0, 10.0];
        (
            (0..4).map(filament).collect(),
            x.map(|x| Vector3::x() * x).to_vec(),
        )
    }

    fn lengths(joined: &[[usize; 2]]) -> Vec<f64> {
        let (filaments, positions) = chain();
        let connections = Connections {
            joined: joined.to_vec(),
            ..Connections::default()
        };
        let mut continuation = Continuation::new(&filaments, &connections);
        continuation.lengths(&filaments, &positions).to_vec()
    }

    #[test]
    fn pieces_in_a_row_have_their_common_length() {
        assert_eq!(lengths(&[]), [1.0, 2.0, 3.0, 4.0]);
        assert_eq!(lengths(&[[5, 6], [1, 2]]), [3.0, 3.0, 7.0, 7.0]);
        assert_eq!(lengths(&[[5, 6], [1, 2], [4, 3]]), [10.0; 4]);
    }

    #[test]
    fn a_branch_keeps_its_own_length() {
        // Three ends meet, and two.
        assert_eq!(lengths(&[[1, 2], [2, 7], [3, 4]]), [1.0, 5.0, 5.0, 4.0]);
    }

    #[test]
    fn pieces_that_have_come_apart_have_their_own_lengths() {
        let (filaments, mut positions) = chain();
        let connections = Connections {
            joined: vec![[1, 2]],
            ..Connections::default()
        };
        positions[1].y = 0.05;
        let mut continuation = Continuation::new(&filaments, &connections);
        let lengths = continuation.lengths(&filaments, &positions);
        assert!(lengths[0] < 1.1 && lengths[1] == 2.0);
    }
}
