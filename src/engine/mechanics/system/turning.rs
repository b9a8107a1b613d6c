//! Rotation of edges within a step.
//!
//! In each step the twist of a vertex is chosen, from all values that differ by whole turns, as
//! the one nearest to the last twist. If an edge turns by nearly half a turn within a step this is
//! a guess, and a wrong guess loses a turn of the rod. If its ends are held or it is closed, the
//! rod keeps this error permanently.

use super::System;

/// Largest angle by which an edge may turn within a step, rad.
const LARGEST: f64 = 2.0;

/// An edge that turns too far within a step.
#[derive(Clone, Debug)]
pub(crate) struct Turn {
    /// Name of the edge, in words.
    pub edge: String,
    /// Its rotation, rad.
    pub angle: f64,
}

impl System {
    /// The edge that turns farthest between the start of a step and the last evaluation, if that
    /// is too far for a rod that keeps its turns.
    pub(crate) fn excessive_turn(&self) -> Option<Turn> {
        let rods = &self.assembly.rods;
        let cosine = |edge: usize| {
            let before = self.reference.tangent[edge];
            before.dot(&self.geometry.edges[edge].tangent)
        };
        let least = libm::cos(LARGEST);
        let turned = rods.edges.iter().map(|edge| edge.start);
        let turned = turned.filter(|edge| cosine(*edge) < least);
        let kept = turned.filter(|edge| self.keeps_turns(self.assembly.locate(*edge).0));
        let farthest = kept.min_by(|one, other| cosine(*one).total_cmp(&cosine(*other)))?;
        let (rod, along) = self.assembly.locate(farthest);
        Some(Turn {
            edge: format!("edge {along} of rod `{}`", self.assembly.names[rod]),
            angle: libm::acos(cosine(farthest).clamp(-1.0, 1.0)),
        })
    }

    /// Whether a rod cannot lose its twist by turning: it is closed, or its frame is held at two
    /// places.
    fn keeps_turns(&self, rod: usize) -> bool {
        let holds_frame = |drive: &&super::Drive| {
            let holds = !drive.ghosts.is_empty() || !drive.edges.is_empty();
            holds && !drive.released && self.assembly.locate(drive.node).0 == rod
        };
        let drives = self.assembly.drives.iter();
        self.assembly.rods.rods[rod].closed || drives.filter(holds_frame).count() > 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::Vector3;
    use crate::mechanics::scene::{RodDescription, Scene};
    use crate::mechanics::test_support::{clamp, section};

    fn scene(held: &[usize]) -> Scene {
        let stiffness = section(30.0, [0.02; 2], 0.03);
        let nodes = (0..4).map(|k| Vector3::x() * f64::from(k)).collect();
        let clamps = held.iter().map(|&node| clamp(0, node));
        Scene {
            rods: vec![RodDescription::uniform("rod", nodes, stiffness, 4e-3, 0.02)],
            clamps: clamps.collect(),
            ..Scene::default()
        }
    }

    #[test]
    fn an_edge_that_turns_by_half_a_turn_is_named_where_the_rod_keeps_its_turns() {
        for (held, is_named) in [(&[0, 3][..], true), (&[0], false)] {
            let mut system = System::new(&scene(held)).unwrap();
            let mut unknowns = system.assembly.unknowns.clone();
            // The middle nodes pass each other.
            let stride = crate::mechanics::rod::STRIDE;
            (unknowns[stride], unknowns[2 * stride]) = (2.0, 1.0);
            unknowns[stride + 1] = 0.1;
            system.update_geometry(&unknowns);
            let turn = system.excessive_turn();
            assert_eq!(turn.is_some(), is_named);
            if let Some(turn) = turn {
                assert_eq!(turn.edge, "edge 1 of rod `rod`");
                assert!(turn.angle > 3.0, "{}", turn.angle);
            }
            // A third of a turn is too little.
            unknowns[..3 * stride].copy_from_slice(&system.assembly.unknowns[..3 * stride]);
            unknowns[2 * stride + 1] = 1.0;
            system.update_geometry(&unknowns);
            assert!(system.excessive_turn().is_none());
        }
    }
}
