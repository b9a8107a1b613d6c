//! Contact of free bodies with the rods that are joined to them.
//!
//! Near the joint a rod overlaps with the body by design, or lies on it. Contact ignores this
//! within a reach along the rod: 1.5 times the length over which they overlap as placed, without a
//! gap from the joint on, and at least π times the radius of the rod.

use super::centreline::arc_length;
use crate::mechanics::Vector3;
use crate::mechanics::contact::{ContactPair, ContactSystem};
use crate::mechanics::scene::Scene;
use std::f64::consts::PI;

/// Ratio of the reach to the length of the overlap.
const REACH: f64 = 1.5;

/// Ignores contact of free bodies with the rods that are joined to them, near the joints.
pub(super) fn pass_over_joined_bodies(
    contact: &mut ContactSystem,
    scene: &Scene,
    positions: &[Vector3],
) {
    for (number, body) in scene.free_bodies.iter().enumerate() {
        let Some(own) = contact.surface().index_of_body(number) else {
            continue;
        };
        for at in body.joints.iter().map(|joint| joint.at) {
            let rod = &scene.rods[at.rod];
            let place = arc_length(&rod.centreline, at.node);
            let overlaps = contact.initial_overlaps(positions);
            let surface = contact.surface();
            let mut pieces: Vec<[f64; 2]> = (overlaps.iter())
                .filter_map(|overlap| {
                    let ContactPair::Edges([first, second]) = overlap.pair else {
                        return None;
                    };
                    let bodies = [first, second].map(|index| surface.body_of(index));
                    let along = match bodies {
                        [one, other] if one == at.rod && other == own => first,
                        [one, other] if one == own && other == at.rod => second,
                        _ => return None,
                    };
                    Some(surface.edges()[along].arc_length)
                })
                .collect();
            // From the joint on, without a gap.
            let way = |piece: &[f64; 2]| (piece[0] - place).max(place - piece[1]).max(0.0);
            pieces.sort_by(|one, other| way(one).total_cmp(&way(other)));
            let rounding = f64::EPSILON * arc_length(&rod.centreline, rod.centreline.len() - 1);
            let overlap = pieces.iter().fold(0.0, |overlap: f64, piece| {
                let far = piece.map(|end| (end - place).abs());
                match way(piece) <= overlap + 4.0 * rounding {
                    true => overlap.max(far[0]).max(far[1]),
                    false => overlap,
                }
            });
            let reach = (REACH * overlap).max(PI * rod.radius_at(at.node));
            contact.join_body([at.rod, own], place, reach);
        }
    }
}
