//! Joints and bodies: nodes that are one point, and frames that turn freely with rods clamped to them.
//!
//! **Points.** The positions of joined nodes are one set of unknowns: that of one of them, the owner. Residuals and rows and
//! columns of the Jacobian of the others are added to its own, x = P r and so Pᵀ R and Pᵀ J P: the joint holds exactly,
//! and its force needs no unknown.
//!
//! **Frames.** Rods that meet rigidly, at a hinge or in a body are clamped to a frame ([`frame::TurningFrame`]), with the half
//! vertex of every clamp ([`crate::mechanics::rod`], `turning_ghost`), so that the joint stands at the node and its
//! error is of second order in the edge length. In the middle of a rod the two half vertices in series are as stiff as the
//! whole one was.
//!
//! Kernels write moments T and their derivatives D = ∂T/∂ψ over rotations ψ seen from outside. For ends of a rotation this
//! is D = S − ½ [T]× with the second derivative S along exp([ψ]×), and over ℓφ
//!
//! ```text
//! Jᵀ T/ℓ,     (Jᵀ D J + ∂(Jᵀ T)/∂φ)/ℓ²
//! ```
//!
//! which is symmetric. With a hinge of the axis a, seen from outside, the moment T' on its frame counts in T and in the moment
//! a·T' over its angle; the derivative of the one over the other is D' a.
//!
//! **Slides.** A node that slides along a rod has the position of a place there ([`slide`]), which depends on the rod and
//! on one unknown. Since other nodes bear it from edge to edge, it is not eliminated from the matrix, but by a border of it
//! ([`border`]).

pub mod border;
pub mod frame;
mod plan;
pub mod slide;
mod track;

use super::System;
use crate::linalg::{Element, ElementMatrix, SharedUnknown, UNUSED};
use crate::mechanics::rod::topology::add_to_node;
use crate::mechanics::rod::{GhostEdge, STRIDE, TURNING_ROTATION};
use crate::mechanics::{Matrix3, UnitQuaternion, Vector3, rotation};
pub use border::Border;
use frame::TurningFrame;
pub(super) use plan::{JointPlan, PlannedSlide};
pub use plan::{check_joints, joint_unknowns};
pub(super) use slide::Slide;
pub(super) use track::Track;

/// Where the angle of a hinge lies among the unknowns of a half vertex, and of the element of a frame.
const HINGE: usize = TURNING_ROTATION + 3;
const OWN_HINGE: usize = 3;

/// Joints and bodies of a scene, with its unknowns numbered.
#[derive(Clone, Debug, Default)]
pub struct Joints {
    /// Nodes that have the position of another one: own number and that of the owner.
    pub points: Vec<[usize; 2]>,
    /// Frames; those that hinges tie come after those that they are tied to.
    pub frames: Vec<TurningFrame>,
    /// Nodes that slide along rods; each owns its point.
    pub slides: Vec<Slide>,
    /// Unknowns at the start of the step of which a scheme solves the middle; `None` where it solves the end.
    start: Option<Vec<f64>>,
    /// Scratch: rotation of each frame at the last evaluation.
    rotations: Vec<UnitQuaternion>,
    /// Scratch: moment on each frame, those on frames that hinges tie to it included, at the last evaluation, N m.
    moments: Vec<Vector3>,
    /// Scratch: forces on the tips of bodies at the last evaluation, N.
    tip_forces: Vec<[Vector3; 3]>,
}

impl Joints {
    /// With every frame as placed.
    pub fn new(points: Vec<[usize; 2]>, frames: Vec<TurningFrame>) -> Self {
        Self {
            rotations: vec![UnitQuaternion::identity(); frames.len()],
            moments: vec![Vector3::zeros(); frames.len()],
            tip_forces: vec![[Vector3::zeros(); 3]; frames.len()],
            points,
            frames,
            slides: Vec::new(),
            start: None,
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty() && self.frames.is_empty() && self.slides.is_empty()
    }

    /// The unknowns that others own.
    pub fn shared(&self) -> Vec<SharedUnknown> {
        let of_point = |&[node, owner]: &[usize; 2]| {
            (0..3).map(move |axis| SharedUnknown {
                unknown: STRIDE * node + axis,
                owner: STRIDE * owner + axis,
            })
        };
        self.points.iter().flat_map(of_point).collect()
    }

    /// The unknowns of an element of the rods as the Jacobian has them: half vertices of hinges know the frame that these
    /// are tied to, and the angle.
    pub fn elements(&self, of_rods: &[Element]) -> Vec<Element> {
        let mut elements = of_rods.to_vec();
        for frame in &self.frames {
            let rotation = self.free_rotation(frame);
            for &element in &frame.elements {
                for axis in 0..3 {
                    elements[element][TURNING_ROTATION + axis] = rotation + axis;
                }
                if frame.hinge.is_some() {
                    elements[element][HINGE] = frame.first_unknown + 3;
                }
            }
            let own = &mut elements[frame.element];
            *own = [UNUSED; 12];
            for axis in 0..3 {
                own[axis] = rotation + axis;
            }
            if frame.hinge.is_some() {
                own[OWN_HINGE] = frame.first_unknown + 3;
            }
        }
        elements
    }

    /// First unknown of the rotation that a frame takes part in.
    fn free_rotation(&self, frame: &TurningFrame) -> usize {
        let base = frame.hinge.map_or(frame, |(base, _)| &self.frames[base]);
        base.first_unknown
    }

    /// Computes the rotations of all frames.
    fn rotate(&mut self, unknowns: &[f64]) {
        for number in 0..self.frames.len() {
            let frame = &self.frames[number];
            self.rotations[number] = match frame.hinge {
                None => rotation::from_vector(frame.rotation_vector(unknowns)) * frame.base,
                Some((base, axis)) => {
                    let turn = rotation::from_vector(axis * frame.hinge_angle(unknowns));
                    self.rotations[base] * turn
                }
            };
        }
    }

    /// Writes the ghost edges that turn with the frames at `unknowns`.
    pub fn turn_ghosts(&mut self, unknowns: &[f64], ghosts: &mut [GhostEdge]) {
        self.rotate(unknowns);
        for (frame, rotation) in self.frames.iter().zip(&self.rotations) {
            let turn = rotation::to_vector(&(rotation * frame.committed.inverse()));
            for (ghost, placed) in &frame.ghosts {
                let tangent = rotation * placed.tangent;
                ghosts[*ghost] = GhostEdge {
                    tangent,
                    director: rotation * placed.director,
                    spin: turn.dot(&tangent),
                };
            }
        }
    }

    /// The frames of the last evaluation are those from which the next step counts turns.
    pub fn commit(&mut self) {
        for (frame, rotation) in self.frames.iter_mut().zip(&self.rotations) {
            frame.committed = *rotation;
        }
    }

    /// Writes what follows from other unknowns: positions of joined nodes, tips of the principal axes of bodies.
    pub fn complete(&mut self, unknowns: &mut [f64]) {
        if self.is_empty() {
            return;
        }
        self.spread_points(unknowns);
        if !self.slides.is_empty() {
            for slide in &self.slides {
                slide.complete(unknowns, self.start.as_deref());
            }
            self.spread_points(unknowns);
        }
        self.rotate(unknowns);
        for (frame, rotation) in self.frames.iter().zip(&self.rotations) {
            let Some((first, tips)) = frame.tips(rotation) else {
                continue;
            };
            for (k, tip) in tips.iter().enumerate() {
                let unknown = first + STRIDE * k;
                unknowns[unknown..unknown + 3].copy_from_slice(tip.as_slice());
            }
        }
    }

    /// From now on unknowns are those in the middle of a step from `start`, or, without one, those of its end.
    pub fn begin_step(&mut self, start: Option<&[f64]>) {
        if !self.slides.is_empty() {
            self.start = start.map(<[f64]>::to_vec);
        }
    }

    /// Takes the places of sliding nodes from `unknowns`.
    pub fn place(&mut self, unknowns: &[f64]) {
        for slide in &mut self.slides {
            slide.place(unknowns, self.start.as_deref());
        }
    }

    /// Whether a node, or the one whose position it has, slides along a rod.
    pub fn slides_at(&self, node: usize) -> bool {
        let mut points = self.points.iter();
        let owner = points.find_map(|&[own, owner]| (own == node).then_some(owner));
        let owner = owner.unwrap_or(node);
        self.slides.iter().any(|slide| slide.node == owner)
    }

    /// Unknowns that others determine: those of joined and of sliding nodes.
    pub fn dependent(&self) -> Vec<usize> {
        let mut dependent: Vec<usize> = self.shared().iter().map(|one| one.unknown).collect();
        let of_slide = |slide: &Slide| STRIDE * slide.node..STRIDE * slide.node + 3;
        dependent.extend(self.slides.iter().flat_map(of_slide));
        dependent
    }

    /// Adds what acts on nodes whose positions others determine to what acts on these.
    pub fn gather(&self, forces: &mut [f64]) {
        self.gather_points(forces);
        if !self.slides.is_empty() {
            self.slides.iter().for_each(|slide| slide.gather(forces));
            self.gather_points(forces);
        }
    }

    /// Adds what acts on joined nodes to what acts on the owners of their positions.
    pub fn gather_points(&self, forces: &mut [f64]) {
        for &[node, owner] in &self.points {
            for axis in 0..3 {
                forces[STRIDE * owner + axis] += std::mem::take(&mut forces[STRIDE * node + axis]);
            }
        }
    }

    /// Moves joined nodes as the owners of their positions.
    pub fn spread_points(&self, moves: &mut [f64]) {
        for &[node, owner] in &self.points {
            moves.copy_within(STRIDE * owner..STRIDE * owner + 3, STRIDE * node);
        }
    }

    /// Makes a mass matrix of all nodes and tips of bodies one over the free unknowns, Pᵀ M P, with frames as placed.
    pub fn gather_masses(&self, unknowns: &[f64], matrix: &mut nalgebra::DMatrix<f64>) {
        for SharedUnknown { unknown, owner } in self.shared() {
            let row = matrix.row(unknown).clone_owned();
            let mut owners = matrix.row_mut(owner);
            owners += row;
            let column = matrix.column(unknown).clone_owned();
            let mut owners = matrix.column_mut(owner);
            owners += column;
            matrix.row_mut(unknown).fill(0.0);
            matrix.column_mut(unknown).fill(0.0);
        }
        self.reduce(matrix);
        for (number, frame) in self.frames.iter().enumerate() {
            let Some((first, tips)) = frame.tips(&self.rotations[number]) else {
                continue;
            };
            let base = frame.hinge.map_or(frame, |(base, _)| &self.frames[base]);
            let vector = base.rotation_vector(unknowns);
            let jacobian = rotation::left_jacobian(&vector) / base.length;
            let axis = frame.hinge.map(|(base, axis)| self.rotations[base] * axis);
            for (k, tip) in tips.iter().enumerate() {
                let mass = matrix[(first + STRIDE * k, first + STRIDE * k)];
                // ṗ = ω × p for the rotation of the base, and of the hinge about its axis.
                let turned = -tip.cross_matrix() * jacobian;
                let mut rates: Vec<(usize, Vector3)> = (0..3)
                    .map(|i| (base.first_unknown + i, turned.column(i).into_owned()))
                    .collect();
                rates.extend(axis.map(|axis| (frame.first_unknown + 3, axis.cross(tip))));
                for (i, one) in &rates {
                    for (j, other) in &rates {
                        matrix[(*i, *j)] += mass * one.dot(other);
                    }
                }
            }
        }
    }

    /// Makes a matrix over the owners of all positions one over the free unknowns: Pᵀ M P over those that sliding nodes
    /// follow.
    fn reduce(&self, matrix: &mut nalgebra::DMatrix<f64>) {
        for slide in &self.slides {
            let own = STRIDE * slide.node;
            let mut rates = nalgebra::DMatrix::zeros(matrix.nrows(), 3);
            for axis in 0..3 {
                let mut column = vec![0.0; matrix.nrows()];
                column[own + axis] = 1.0;
                slide.gather(&mut column);
                self.gather_points(&mut column);
                rates.column_mut(axis).copy_from_slice(&column);
            }
            let block = matrix.fixed_view::<3, 3>(own, own).clone_owned();
            let mut rows = matrix.rows(own, 3).clone_owned();
            let mut columns = matrix.columns(own, 3).clone_owned();
            rows.columns_mut(own, 3).fill(0.0);
            columns.rows_mut(own, 3).fill(0.0);
            matrix.rows_mut(own, 3).fill(0.0);
            matrix.columns_mut(own, 3).fill(0.0);
            *matrix += &rates * rows + columns * rates.transpose();
            *matrix += &rates * block * rates.transpose();
        }
    }

    /// Makes a Jacobian over the owners of all positions, of which some unknowns are `held`, one over the free unknowns.
    pub fn reduce_jacobian(&self, matrix: &mut nalgebra::DMatrix<f64>, held: &[bool]) {
        self.reduce(matrix);
        for slide in &self.slides {
            let weights = &slide.grip.weights;
            matrix[(slide.unknown, slide.unknown)] += slide.residual.dot(&slide.grip.curvature);
            let mut turning = vec![0.0; held.len()];
            for (node, slope) in weights.nodes.iter().zip(&weights.slopes) {
                for axis in 0..3 {
                    turning[STRIDE * node + axis] += slope * slide.residual[axis];
                }
            }
            self.gather_points(&mut turning);
            for (k, entry) in turning.iter().enumerate() {
                matrix[(slide.unknown, k)] += entry;
                matrix[(k, slide.unknown)] += entry;
            }
            for axis in 0..3 {
                let own = STRIDE * slide.node + axis;
                matrix[(own, own)] = 1.0;
            }
        }
        if self.slides.is_empty() {
            return;
        }
        for k in (0..held.len()).filter(|k| held[*k]) {
            matrix.row_mut(k).fill(0.0);
            matrix.column_mut(k).fill(0.0);
            matrix[(k, k)] = 1.0;
        }
    }

    /// Makes moments on frames, seen from outside, and forces on the tips of bodies generalised forces over the unknowns;
    /// `unknowns` are those of the last [`Self::turn_ghosts`].
    pub fn gather_moments(&mut self, unknowns: &[f64], forces: &mut [f64]) {
        for (number, frame) in self.frames.iter().enumerate() {
            let slot = frame.first_unknown;
            let mut moment = take(forces, slot);
            if let Some((first, tips)) = frame.tips(&self.rotations[number]) {
                let on_tips = [0, 1, 2].map(|k| take(forces, first + STRIDE * k));
                for (tip, force) in tips.iter().zip(&on_tips) {
                    moment += tip.cross(force);
                }
                self.tip_forces[number] = on_tips;
            }
            self.moments[number] = moment;
        }
        for (number, frame) in self.frames.iter().enumerate() {
            if let Some((base, axis)) = frame.hinge {
                let moment = self.moments[number];
                self.moments[base] += moment;
                forces[frame.first_unknown + 3] += moment.dot(&(self.rotations[base] * axis));
            }
        }
        for (frame, moment) in self.frames.iter().zip(&self.moments) {
            if frame.hinge.is_none() {
                let jacobian = rotation::left_jacobian(&frame.rotation_vector(unknowns));
                let over = jacobian.transpose() * moment / frame.length;
                add_to_node(forces, frame.first_unknown / STRIDE, &over);
            }
        }
    }

    /// Makes the elements of half vertices, which hold second derivatives over rotations seen from outside, and those of the
    /// frames themselves derivatives of the residual over the unknowns. In a stage inertia is `per_square`, 1/(h hₐ), times
    /// the masses of all unknowns; to be called after [`Self::gather_moments`].
    pub fn transform(
        &self,
        unknowns: &[f64],
        per_square: Option<f64>,
        masses: &[f64],
        matrices: &mut [ElementMatrix],
    ) {
        for (number, frame) in self.frames.iter().enumerate() {
            let base = frame.hinge.map_or(frame, |(base, _)| &self.frames[base]);
            let vector = base.rotation_vector(unknowns);
            let jacobian = rotation::left_jacobian(&vector) / base.length;
            let axis = frame.hinge.map(|(base, axis)| self.rotations[base] * axis);
            for &element in &frame.elements {
                turn_with_hinge(&mut matrices[element], axis.as_ref());
                over_vector(&mut matrices[element], &jacobian);
            }
            let mut own = Matrix3::zeros();
            let moment = self.moments[number];
            if frame.hinge.is_none() {
                let bent = jacobian.transpose() * moment.cross_matrix() * jacobian * -0.5;
                let curved = rotation::left_jacobian_derivative(&vector, &moment);
                own += bent + curved / (base.length * base.length);
            }
            if let Some(per_square) = per_square
                && let Some((first, tips)) = frame.tips(&self.rotations[number])
            {
                let mut second = Matrix3::zeros();
                for (k, tip) in tips.iter().enumerate() {
                    let force = self.tip_forces[number][k];
                    let mass = masses[first + STRIDE * k] * per_square;
                    let product = tip * force.transpose();
                    second += (product + product.transpose()) * 0.5
                        - Matrix3::identity() * tip.dot(&force)
                        + (Matrix3::identity() * tip.norm_squared() - tip * tip.transpose()) * mass;
                }
                let mut whole: ElementMatrix = [[0.0; 12]; 12];
                for i in 0..3 {
                    for j in 0..3 {
                        whole[TURNING_ROTATION + i][TURNING_ROTATION + j] = second[(i, j)];
                    }
                }
                turn_with_hinge(&mut whole, axis.as_ref());
                over_vector(&mut whole, &jacobian);
                let (from, to) = (TURNING_ROTATION, &mut matrices[frame.element]);
                for i in 0..4 {
                    for j in 0..4 {
                        to[i][j] += whole[from + i][from + j];
                    }
                }
            }
            let to = &mut matrices[frame.element];
            for i in 0..3 {
                for j in 0..3 {
                    to[i][j] += own[(i, j)];
                }
            }
            if let Some(axis) = axis {
                let mixed = jacobian.transpose() * moment.cross(&axis) * -0.5;
                for i in 0..3 {
                    to[i][OWN_HINGE] += mixed[i];
                    to[OWN_HINGE][i] += mixed[i];
                }
            }
        }
    }
}

/// Takes three entries out of a vector.
fn take(entries: &mut [f64], first: usize) -> Vector3 {
    let entries = &mut entries[first..first + 3];
    let taken = Vector3::from_column_slice(entries);
    entries.fill(0.0);
    taken
}

/// Fills in row and column of the angle of a hinge: those of a rotation about its axis.
fn turn_with_hinge(matrix: &mut ElementMatrix, axis: Option<&Vector3>) {
    let Some(axis) = axis else { return };
    let along = |values: [f64; 3]| Vector3::from(values).dot(axis);
    for row in matrix.iter_mut().take(HINGE) {
        row[HINGE] = along([row[HINGE - 3], row[HINGE - 2], row[HINGE - 1]]);
    }
    for column in 0..=HINGE {
        let rotation = [3, 2, 1].map(|before| matrix[HINGE - before][column]);
        matrix[HINGE][column] = along(rotation);
    }
}

/// From derivatives over a rotation seen from outside to those over ℓφ: rows by Jᵀ, columns by J.
fn over_vector(matrix: &mut ElementMatrix, jacobian: &Matrix3) {
    let places: [usize; 3] = std::array::from_fn(|axis| TURNING_ROTATION + axis);
    for row in matrix.iter_mut() {
        let turned = jacobian.transpose() * Vector3::from(places.map(|place| row[place]));
        places
            .iter()
            .zip(turned.iter())
            .for_each(|(place, value)| row[*place] = *value);
    }
    for column in 0..12 {
        let turned =
            jacobian.transpose() * Vector3::from(places.map(|place| matrix[place][column]));
        places
            .iter()
            .zip(turned.iter())
            .for_each(|(place, value)| matrix[*place][column] = *value);
    }
}

impl System {
    /// Writes what follows from other unknowns: positions of joined nodes, and how bodies point.
    pub fn complete(&mut self, unknowns: &mut [f64]) {
        self.assembly.joints.complete(unknowns);
    }

    /// Makes a residual over all nodes, frames and bodies one over the free unknowns.
    pub(super) fn gather_at_joints(&mut self, unknowns: &[f64]) {
        self.breaking.note(&self.residual);
        let joints = &mut self.assembly.joints;
        joints.gather_moments(unknowns, &mut self.residual);
        joints.gather_points(&mut self.residual);
        for slide in &mut joints.slides {
            slide.note(&self.residual, unknowns, joints.start.as_deref());
        }
        joints.gather(&mut self.residual);
    }

    /// From now on unknowns are those in the middle of a step from `start`, or, without one, those of its end.
    pub fn begin_step(&mut self, start: Option<&[f64]>) {
        self.assembly.joints.begin_step(start);
    }

    /// Lets rotation vectors that have become long begin anew in a motion: its unknowns and velocities now, and earlier ones.
    pub fn begin_rotations_anew(&mut self, motions: &mut [[&mut [f64]; 2]]) {
        for frame in &mut self.assembly.joints.frames {
            if frame.hinge.is_none() {
                frame.begin_anew(motions);
            }
        }
    }

    /// The rotations from which those of the frames count, for a checkpoint.
    pub fn frame_bases(&self) -> Vec<UnitQuaternion> {
        let frames = self.assembly.joints.frames.iter();
        frames.map(|frame| frame.base).collect()
    }

    /// Goes on with those of a checkpoint.
    ///
    /// # Errors
    /// What of it does not fit.
    pub fn restore_frame_bases(&mut self, bases: &[UnitQuaternion]) -> Result<(), &'static str> {
        let frames = &mut self.assembly.joints.frames;
        if bases.len() != frames.len() {
            return Err("joints");
        }
        for (frame, base) in frames.iter_mut().zip(bases) {
            frame.base = *base;
        }
        Ok(())
    }
}

#[cfg(test)]
mod slide_tests;
#[cfg(test)]
mod tests;
