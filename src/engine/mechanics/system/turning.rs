//! Rotation of edges and free bodies within a step.
//!
//! In each step the twist of a vertex is chosen, from all values that differ by whole turns, as
//! the one nearest to the last twist. If an edge turns by nearly half a turn within a step this is
//! a guess, and a wrong guess loses a turn of the rod. If its ends are held or it is closed, the
//! rod keeps this error permanently.
//!
//! The rotational energy of a free body is that of masses at the tips of its axes, whose velocities
//! are those of chords. If a body turns far within a step, these add energy.

use super::System;
use crate::mechanics::rotation;
use std::f64::consts::PI;

/// Largest angle by which an edge may turn within a step, rad.
const LARGEST: f64 = 2.0;

/// Largest angle by which a free body may turn within a step, rad.
const LARGEST_OF_BODY: f64 = 0.3;

/// An edge or a free body that turns too far within a step.
#[derive(Clone, Debug)]
pub(crate) struct Turn {
    /// Its name, in words.
    pub what: String,
    /// Its rotation, rad.
    pub angle: f64,
    /// What may go wrong.
    pub consequence: &'static str,
}

impl System {
    /// The free body or the edge that turns farthest between the start of a step and the last
    /// evaluation, if that is too far for the body, or for a rod that keeps its turns.
    pub(crate) fn excessive_turn(&self) -> Option<Turn> {
        let of_body = self.excessive_turn_of_body();
        of_body.or_else(|| self.excessive_turn_of_edge())
    }

    fn excessive_turn_of_body(&self) -> Option<Turn> {
        let joints = &self.assembly.joints;
        let turns = joints.free_frames().map(|(number, frame, vertices)| {
            let turn = joints.rotation(number) * frame.committed.inverse();
            // On an axle it may turn by more than π. Elsewhere, rotation vectors longer than that
            // are no solutions of a step: near 2π, where J is singular, no moment remains.
            let beyond = if frame.turned > PI { frame.turned } else { 0.0 };
            let angle = rotation::angle(&turn).max(frame.hinge_turn().abs());
            (vertices.centre, angle.max(beyond))
        });
        let (node, angle) = turns.max_by(|one, other| one.1.total_cmp(&other.1))?;
        (angle > LARGEST_OF_BODY).then(|| Turn {
            what: format!(
                "body `{}`",
                self.assembly.names[self.assembly.locate(node).0]
            ),
            angle,
            consequence: "its spin is too fast for the step",
        })
    }

    fn excessive_turn_of_edge(&self) -> Option<Turn> {
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
            what: format!("edge {along} of rod `{}`", self.assembly.names[rod]),
            angle: libm::acos(cosine(farthest).clamp(-1.0, 1.0)),
            consequence: "whole turns of twist may be lost",
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
                assert_eq!(turn.what, "edge 1 of rod `rod`");
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
