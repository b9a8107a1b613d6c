//! The candidate set: pairs of edges that may touch, kept over many steps (thesis 2.3.2).
//!
//! The candidates are all pairs within a margin beyond the reach of the potential. Two edges
//! approach by at most the motion of their nodes, so the set is complete while no node has moved
//! more than half the margin since it was built. The set is rebuilt at the start of a step if some
//! node has moved more than a quarter of the margin; the other quarter is left for the motion
//! within the step. A long-lived set keeps the sparsity pattern of the Newton system, and with it
//! the symbolic factorisation.
//!
//! The same bound serves as a filter. The gap of a pair is at least its gap when the set was built,
//! minus the motion of its nodes. Most candidates therefore need one comparison instead of a
//! distance.

use super::broad_phase::BroadPhase;
use super::contacts::CandidatePair;
use super::placed_obstacles::PlacedObstacles;
use super::surface::ContactSurface;
use crate::mechanics::Vector3;
use crate::mechanics::rigid_body::RigidBody;

/// Margin of the candidates in radii of the thickest rod that moves.
///
/// A larger margin means fewer rebuilds; a smaller margin means fewer candidates and so fewer
/// entries in the sparse factorisation. The flagella of the thesis (radius 1 mm) move by 0.15 mm
/// per step: with a margin of 2 every fourth step begins with a rebuild, with a margin of 1 every
/// second.
const MARGIN: f64 = 2.0;

/// Least margin beside meshes, in the same unit.
///
/// A rod beside a mesh whose triangles are small compared with the margin has hundreds of candidates
/// an edge, and frequent rebuilds are cheaper. There the margin is the typical side of a triangle,
/// and at least this one.
const MARGIN_AT_MESHES: f64 = 0.2;

/// Part of the margin by which the height of a node over a smooth part of a mesh may fall more than
/// the node moves, because the height is not quite a distance.
const PATCH_SLACK: f64 = 0.1;

/// Part of the margin that the nodes may have used up at the start of a step.
const REBUILD_FRACTION: f64 = 0.25;

/// Part of the margin within which the set is complete.
const COMPLETE_FRACTION: f64 = 0.5;

/// The candidate pairs with the data that determine when they are out of date.
#[derive(Clone, Debug)]
pub(super) struct Candidates {
    /// Reach of the potential beyond the surfaces, m.
    reach: f64,
    /// Margin beyond that, m.
    margin: f64,
    pairs: Vec<CandidatePair>,
    /// Indices of the pairs that the Newton system couples, sorted.
    pub coupled: Vec<usize>,
    /// The pairs before the last build.
    earlier_pairs: Vec<CandidatePair>,
    /// Gap between the surfaces of every pair when the set was built, m.
    gaps: Vec<f64>,
    /// Positions when the set was built, m; empty before the first build.
    positions: Vec<Vector3>,
    broad_phase: BroadPhase,
    found: Vec<(CandidatePair, f64)>,
}

/// Reorders the values of a list of pairs for a newer list; new pairs get the default. Both lists
/// are sorted. Values after those of the pairs stay at the end.
pub(crate) fn carried_over<T: Copy + Default>(
    old: &[CandidatePair],
    values: &[T],
    new: &[CandidatePair],
) -> Vec<T> {
    let mut known = old.iter().zip(values).peekable();
    let carried = new.iter().map(|pair| {
        while known.next_if(|(before, _)| *before < pair).is_some() {}
        known
            .next_if(|(before, _)| *before == pair)
            .map_or_else(T::default, |(_, value)| *value)
    });
    let rest = values.get(old.len()..).unwrap_or_default();
    carried.chain(rest.iter().copied()).collect()
}

/// Margin of the candidates, m.
fn margin_of(surface: &ContactSurface) -> f64 {
    let radius = surface.largest_moving_radius();
    let meshes = surface
        .obstacles()
        .iter()
        .filter(|obstacle| !obstacle.faces.is_empty() && obstacle.smooth.is_none());
    let finest = meshes
        .map(RigidBody::triangle_size)
        .fold(f64::INFINITY, f64::min);
    finest.clamp(MARGIN_AT_MESHES * radius, MARGIN * radius)
}

impl Candidates {
    /// Creates an empty set for a potential that reaches `reach` (m) beyond the surfaces.
    pub(crate) fn new(surface: &ContactSurface, reach: f64) -> Self {
        Self {
            reach,
            margin: margin_of(surface),
            pairs: Vec::new(),
            coupled: Vec::new(),
            earlier_pairs: Vec::new(),
            gaps: Vec::new(),
            positions: Vec::new(),
            broad_phase: BroadPhase::default(),
            found: Vec::new(),
        }
    }

    /// The pairs, sorted by edges.
    pub(crate) fn pairs(&self) -> &[CandidatePair] {
        &self.pairs
    }

    /// The pairs before the last build.
    pub(crate) fn earlier_pairs(&self) -> &[CandidatePair] {
        &self.earlier_pairs
    }

    /// Gap between the surfaces of every pair when the set was built, m.
    pub(crate) fn gaps(&self) -> &[f64] {
        &self.gaps
    }

    /// Positions when the set was built, m; empty before the first build.
    pub(crate) fn positions(&self) -> &[Vector3] {
        &self.positions
    }

    /// Margin beyond the reach of the potential, m.
    pub(crate) fn margin(&self) -> f64 {
        self.margin
    }

    /// Sets the margin, m, and discards the set.
    #[cfg(test)]
    pub(crate) fn set_margin(&mut self, margin: f64) {
        self.margin = margin;
        self.pairs.clear();
        self.coupled.clear();
        self.gaps.clear();
        self.positions.clear();
    }

    /// Whether the nodes have used up too much of the margin for a step to begin with this set.
    pub(crate) fn are_worn(&self, positions: &[Vector3]) -> bool {
        !self.is_within(positions, REBUILD_FRACTION)
    }

    /// Builds the set for these positions and returns whether it changed. Without positions the
    /// set is empty.
    pub(crate) fn rebuild(
        &mut self,
        surface: &ContactSurface,
        obstacles: &PlacedObstacles,
        positions: &[Vector3],
    ) -> bool {
        self.found.clear();
        if !positions.is_empty() {
            let clearance = self.reach + self.margin;
            self.broad_phase
                .find(surface, positions, clearance, &mut self.found);
            let others = !surface.obstacles().is_empty() || !surface.body_faces().is_empty();
            if others {
                surface.find_at_bodies(positions, clearance, &mut self.found);
                obstacles.find(surface, positions, clearance, &mut self.found);
                self.found.sort_unstable_by_key(|(pair, _)| *pair);
            }
        }
        let unchanged = self
            .pairs
            .iter()
            .eq(self.found.iter().map(|(pair, _)| pair));
        if !unchanged {
            self.coupled.clear();
        }
        std::mem::swap(&mut self.pairs, &mut self.earlier_pairs);
        self.pairs.clear();
        self.gaps.clear();
        for &(pair, distance) in &self.found {
            self.pairs.push(pair);
            let slack = if pair.is_with_patch() {
                PATCH_SLACK * self.margin
            } else {
                0.0
            };
            self.gaps
                .push(distance - surface.threshold(pair.edges) - slack);
        }
        self.positions.clear();
        self.positions.extend_from_slice(positions);
        !unchanged
    }

    /// Whether the set contains every pair within reach at these positions.
    pub(crate) fn are_complete(&self, positions: &[Vector3]) -> bool {
        self.is_within(positions, COMPLETE_FRACTION)
    }

    /// A fraction of the path `displacements` from `positions` along which the set is complete: 0
    /// if the set is not complete at `positions`; may exceed 1.
    pub(crate) fn covered_fraction(&self, positions: &[Vector3], displacements: &[Vector3]) -> f64 {
        if self.positions.len() != positions.len() {
            return 0.0;
        }
        let allowed = COMPLETE_FRACTION * self.margin;
        let nodes = positions.iter().zip(&self.positions).zip(displacements);
        nodes
            .map(|((now, before), displacement)| {
                let (left, length) = (allowed - (now - before).norm(), displacement.norm());
                if left <= 0.0 {
                    0.0
                } else {
                    left / length.max(f64::MIN_POSITIVE)
                }
            })
            .fold(f64::INFINITY, f64::min)
    }

    /// Displacement of every node since the set was built, m.
    pub(crate) fn motion(&self, positions: &[Vector3], motion: &mut Vec<f64>) {
        motion.clear();
        motion.extend(
            positions
                .iter()
                .zip(&self.positions)
                .map(|(now, before)| (now - before).norm()),
        );
    }

    fn is_within(&self, positions: &[Vector3], fraction: f64) -> bool {
        let allowed = (fraction * self.margin).powi(2);
        self.positions.len() == positions.len()
            && positions
                .iter()
                .zip(&self.positions)
                .all(|(now, before)| (now - before).norm_squared() <= allowed)
    }
}

/// Largest approach of the edges of a pair for given motions of all nodes, m. Vertices of
/// obstacles do not move.
pub(super) fn approach(pair: &CandidatePair, motion: &[f64]) -> f64 {
    pair.approach(
        pair.nodes
            .map(|node| motion.get(node).copied().unwrap_or(0.0)),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A flat sheet of square cells of a side, m, each of two triangles.
    fn sheet(side: f64) -> RigidBody {
        let corner = |k: usize| Vector3::new((k % 3) as f64, (k / 3) as f64, 0.0) * side;
        let cells = [0, 1, 3, 4].map(|k| [[k, k + 1, k + 4], [k, k + 4, k + 3]]);
        RigidBody::of_mesh((0..9).map(corner).collect(), cells.concat(), false).unwrap()
    }

    #[test]
    fn the_margin_follows_the_triangles_of_fine_meshes() {
        let margin = |bodies: &[RigidBody]| {
            let mut surface = ContactSurface::new();
            let nodes = [1.0, 2.0].map(|height| Vector3::z() * height);
            surface.add_rod(0, &nodes, false, 0.1, false);
            for body in bodies {
                surface.add_obstacle(body.clone(), None);
            }
            margin_of(&surface)
        };
        let ball = RigidBody::sphere(Vector3::zeros(), 0.3);
        for (bodies, expected) in [
            (vec![], 0.2),
            (vec![ball.clone()], 0.2),
            (vec![sheet(0.5)], 0.2),
            (vec![sheet(0.05), ball, sheet(0.5)], 0.05),
            (vec![sheet(0.001)], 0.02),
        ] {
            let found = margin(&bodies);
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }
}
