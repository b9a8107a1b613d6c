//! Proximity of bodies: least distance, penetration, and overlaps of a new scene.

use super::broad_phase::BroadPhase;
use super::candidates::approach;
use super::contact_system::ContactSystem;
use super::contacts::{CandidatePair, ContactPair, Proximity};
use crate::mechanics::Vector3;

/// Surfaces that touch to rounding error do not count as overlapping.
const TOUCHING: f64 = 1e-9;

/// The deepest of several contacts, if it exceeds the penetration `allowed`.
fn deepest_beyond(allowed: f64, contacts: impl Iterator<Item = Proximity>) -> Option<Proximity> {
    contacts
        .filter(|proximity| proximity.penetration() > allowed)
        .min_by(|a, b| a.ratio().total_cmp(&b.ratio()))
}

/// Fraction of the allowed penetration above which a contact is made stiffer at once.
const DEEP: f64 = 0.2;

impl ContactSystem {
    /// Smallest centreline distance over the candidates, m; infinite without candidates.
    pub(crate) fn minimum_distance(&self, positions: &[Vector3]) -> f64 {
        let positions = self.placed(positions);
        let distances = self.candidates().iter();
        distances
            .filter_map(|pair| self.separation(pair, &positions))
            .fold(f64::INFINITY, f64::min)
    }

    /// The bodies nearest to touching at `positions` (m): of all candidates, and all nodes at
    /// planes, those with the least ratio of the distance to that at which their surfaces touch.
    pub(crate) fn nearest(&self, positions: &[Vector3]) -> Option<Proximity> {
        let positions = &*self.placed(positions);
        let edges = self.candidates().iter().filter_map(|pair| {
            Some(Proximity {
                pair: ContactPair::Edges(pair.edges),
                distance: self.separation(pair, positions)?,
                threshold: self.surface.threshold(pair.edges),
            })
        });
        edges
            .chain(self.nodes_and_planes(positions))
            .min_by(|a, b| a.ratio().total_cmp(&b.ratio()))
    }

    /// The contacts of the last evaluation, including those of prescribed points, which carry no force.
    pub(crate) fn touching(&self) -> impl Iterator<Item = Proximity> {
        self.bearing().chain(self.touching_without_force())
    }

    /// The contacts of the last evaluation that may carry a force.
    fn bearing(&self) -> impl Iterator<Item = Proximity> {
        let edges = self.contacts().iter().map(|contact| Proximity {
            pair: ContactPair::Edges(self.candidates()[contact.candidate].edges),
            distance: contact.distance,
            threshold: contact.threshold,
        });
        let planes = self.plane_contacts().iter().map(|contact| Proximity {
            pair: ContactPair::NodeAndPlane {
                node: contact.node,
                plane: contact.plane,
            },
            distance: contact.distance,
            threshold: contact.threshold,
        });
        edges.chain(planes)
    }

    /// Pairs every node of the surface with every plane.
    fn nodes_and_planes(&self, positions: &[Vector3]) -> impl Iterator<Item = Proximity> {
        self.planes
            .iter()
            .enumerate()
            .flat_map(move |(plane, body)| {
                let nodes = self.surface.nodes().iter();
                let roots = &self.surface.roots;
                let nodes = nodes.filter(move |node| !roots.frees_from_plane(node.node, plane));
                nodes.map(move |surface| Proximity {
                    pair: ContactPair::NodeAndPlane {
                        node: surface.node,
                        plane,
                    },
                    distance: body.distance(&positions[surface.node]),
                    threshold: surface.radius,
                })
            })
    }

    fn separation(&self, pair: &CandidatePair, positions: &[Vector3]) -> Option<f64> {
        let points = self.obstacles.points(positions);
        let nearest = self.nearest_in_step(pair, &points, 0.0)?;
        Some(nearest.distance() - self.surface.core(pair))
    }

    /// Nodes inside closed obstacles; the distance is minus that from the nearest face.
    fn within_obstacles<'a>(
        &'a self,
        positions: &'a [Vector3],
    ) -> impl Iterator<Item = Proximity> + 'a {
        let points = self.obstacles.points(positions);
        let obstacles = self.surface.obstacles().iter().enumerate();
        let closed = obstacles.filter(|(_, obstacle)| obstacle.closed);
        closed.flat_map(move |(index, _)| {
            let nodes = self.surface.nodes().iter();
            nodes.filter_map(move |node| {
                let position = positions[node.node];
                let may_be = self.obstacles.is_near(index, &position)
                    && !self.surface.roots.free_node(node.node, index);
                if !may_be || !self.surface.is_inside(index, &position, &points) {
                    return None;
                }
                let (face, distance) = self.surface.nearest_face(index, &position, &points)?;
                Some(Proximity {
                    pair: ContactPair::Edges([node.edge, face]),
                    distance: -distance,
                    threshold: node.radius,
                })
            })
        })
    }

    /// The deepest penetration at the last evaluation, if it exceeds `maximum_penetration`.
    pub(crate) fn excessive_penetration(&self) -> Option<Proximity> {
        let allowed = self.parameters().maximum_penetration;
        deepest_beyond(allowed, self.touching())
    }

    /// Whether a contact of the last evaluation is compressed further than by its design force.
    pub(crate) fn is_deep(&self) -> bool {
        let allowed = DEEP * self.parameters().maximum_penetration;
        deepest_beyond(allowed, self.bearing()).is_some()
    }

    /// Whether, at the last evaluation, surfaces touch or overlap despite a barrier.
    pub(crate) fn touches_barrier(&self) -> bool {
        self.parameters().is_barrier()
            && self
                .touching()
                .any(|proximity| proximity.distance <= proximity.threshold)
    }

    /// The deepest penetration at `positions` (m), if it exceeds `maximum_penetration`. The
    /// candidates must be complete at `positions`.
    pub(crate) fn excessive_penetration_at(&mut self, positions: &[Vector3]) -> Option<Proximity> {
        let allowed = 1.0 - self.parameters.maximum_penetration;
        let positions = self.placed(positions);
        let positions = positions.as_ref();
        self.candidates.motion(positions, &mut self.motion);
        let pairs = self.candidates.pairs().iter().zip(self.candidates.gaps());
        let edges = pairs.filter_map(|(pair, earlier)| {
            let threshold = self.surface.threshold(pair.edges);
            let least = threshold + earlier - approach(pair, &self.motion);
            if least >= allowed * threshold {
                return None;
            }
            Some(Proximity {
                pair: ContactPair::Edges(pair.edges),
                distance: self.separation(pair, positions)?,
                threshold,
            })
        });
        edges
            .chain(self.nodes_and_planes(positions))
            .filter(|proximity| proximity.distance < allowed * proximity.threshold)
            .min_by(|a, b| a.ratio().total_cmp(&b.ratio()))
    }

    /// All pairs whose surfaces overlap at `positions`, sorted. With incremental potential contact
    /// also pairs at which the barrier is infinite. A scene must not start with such pairs.
    pub(crate) fn initial_overlaps(&self, positions: &[Vector3]) -> Vec<Proximity> {
        let positions = &*self.placed(positions);
        let is_barrier = self.parameters().is_barrier();
        let clearance = if is_barrier {
            self.parameters().reach()
        } else {
            0.0
        };
        let mut found = Vec::new();
        BroadPhase::default().find(self.surface(), positions, clearance, &mut found);
        self.surface
            .find_at_bodies(positions, clearance, &mut found);
        self.obstacles
            .find(self.surface(), positions, clearance, &mut found);
        let within = self.surface.within_bodies(positions).into_iter();
        found.extend(within.map(|(pair, depth)| (pair, -depth)));
        // A rim does not act on rods that pass outside the tube, though they may be near it, nor a
        // smooth part of a mesh on nodes beside it.
        let is_felt = |pair: &CandidatePair| {
            let may_be_beside = pair.is_with_rim() || pair.is_with_patch();
            !may_be_beside || self.separation(pair, positions).is_some()
        };
        let found = found.iter().filter(|(pair, _)| is_felt(pair));
        let edges = found.map(|(pair, distance)| Proximity {
            pair: ContactPair::Edges(pair.edges),
            distance: *distance,
            threshold: self.surface().threshold(pair.edges) + self.standoff(pair),
        });
        edges
            .chain(self.within_obstacles(positions))
            .chain(self.nodes_and_planes(positions))
            .filter(|proximity| {
                if is_barrier {
                    proximity.distance <= proximity.threshold
                } else {
                    proximity.penetration() > TOUCHING
                }
            })
            .collect()
    }
}
