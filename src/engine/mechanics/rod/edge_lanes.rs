//! Stretching of [`LANES`] edges at a time, and the contribution of the spin of their frames: the
//! formulas of [`super::edge`] and [`super::holonomy`] lane by lane.

use super::discretization::Edge;
use super::edge::{stretching_gradient, stretching_hessian};
use super::frame_lanes::{FrameLanes, TransportLanes, VectorLanes, set_vector};
use super::holonomy::holonomy_hessian;
use crate::linalg::instruction_set::{LANES, Lanes, kernel};

/// Symmetric 3×3 matrices, structure of arrays: xx, xy, xz, yy, yz, zz.
pub(super) type SymmetricLanes = [Lanes; 6];

/// Up to [`LANES`] edges, structure of arrays.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct EdgeLanes {
    /// Tangents and directors from which frames are transported.
    pub from: TransportLanes,
    /// The frames.
    pub frames: FrameLanes,
    natural_length: Lanes,
    stiffness: Lanes,
}

impl EdgeLanes {
    /// Natural lengths and stiffness of `edges`; unused lanes hold edges without stiffness.
    pub(crate) fn new(edges: &[Edge]) -> Self {
        let mut lanes = Self {
            from: TransportLanes::new(),
            frames: FrameLanes::new(),
            natural_length: [1.0; LANES],
            stiffness: [0.0; LANES],
        };
        lanes.take_natural_strains(edges);
        lanes
    }

    /// Copies the natural lengths and stiffnesses of `edges`.
    pub(crate) fn take_natural_strains(&mut self, edges: &[Edge]) {
        for (lane, edge) in edges.iter().enumerate() {
            self.natural_length[lane] = edge.natural_length;
            self.stiffness[lane] = edge.stretching;
        }
    }

    /// Copies the natural length and the stiffness of an edge from the lane `from` of `others`.
    pub(crate) fn take_lane(&mut self, lane: usize, others: &Self, from: usize) {
        self.natural_length[lane] = others.natural_length[from];
        self.stiffness[lane] = others.stiffness[from];
    }
}

kernel! {
    /// Computes [`stretching_gradient`] in every lane.
    fn forces(edges: &EdgeLanes, forces: &mut VectorLanes) {
        for lane in 0..LANES {
            let (stiffness, natural) = (edges.stiffness[lane], edges.natural_length[lane]);
            let frame = edges.frames.get(lane);
            let force = stretching_gradient(stiffness, &frame.tangent, frame.length, natural);
            set_vector(forces, lane, &force);
        }
    }
}

kernel! {
    /// Computes [`stretching_gradient`] in every lane, and [`stretching_hessian`] with
    /// [`holonomy_hessian`] for the moments ∂E/∂φ.
    fn derivatives(
        edges: &EdgeLanes,
        moments: &Lanes,
        forces: &mut VectorLanes,
        hessians: &mut SymmetricLanes,
    ) {
        for lane in 0..LANES {
            let (stiffness, natural) = (edges.stiffness[lane], edges.natural_length[lane]);
            let frame = edges.frames.get(lane);
            let force = stretching_gradient(stiffness, &frame.tangent, frame.length, natural);
            set_vector(forces, lane, &force);
            set_hessian(edges, moments, lane, hessians);
        }
    }
}

kernel! {
    /// Computes only the Hessians of [`derivatives`].
    fn hessians(edges: &EdgeLanes, moments: &Lanes, hessians: &mut SymmetricLanes) {
        for lane in 0..LANES {
            set_hessian(edges, moments, lane, hessians);
        }
    }
}

#[inline(always)]
fn set_hessian(edges: &EdgeLanes, moments: &Lanes, lane: usize, hessians: &mut SymmetricLanes) {
    let (stiffness, natural) = (edges.stiffness[lane], edges.natural_length[lane]);
    let frame = edges.frames.get(lane);
    let hessian = stretching_hessian(stiffness, &frame.tangent, frame.length, natural)
        + holonomy_hessian(&edges.from.source(lane), &frame, moments[lane]);
    hessians[0][lane] = hessian[(0, 0)];
    hessians[1][lane] = hessian[(1, 0)];
    hessians[2][lane] = hessian[(2, 0)];
    hessians[3][lane] = hessian[(1, 1)];
    hessians[4][lane] = hessian[(2, 1)];
    hessians[5][lane] = hessian[(2, 2)];
}
