//! The Jacobian of the residual: shifts, factors, Newton directions.

use super::turned_elements::over_unknowns;
use super::{Border, System, joints};
use crate::linalg::{Inertia, SingularMatrix};
use crate::mechanics::rod::STRIDE;

impl System {
    /// Adds `shift` times the unit matrix (in N/m and N m) to the Jacobian of the last linearisation.
    pub(crate) fn shift(&mut self, shift: f64, spin_shift: f64) {
        let all = 0..self.residual.len();
        self.matrix
            .shift(all, shift, spin_shift, &self.assembly.held);
    }

    /// Adds a shift for each rod (N/m) to the Jacobian, including the rod's frames and the nodes
    /// that slide with it; for angles and parameters along rods the shift is multiplied by `spin`
    /// (m²).
    pub(crate) fn shift_rods(&mut self, shift_of: impl Fn(usize) -> f64, spin: f64) {
        for (rod, range) in self.assembly.rods.rods.iter().enumerate() {
            let unknowns = STRIDE * range.first_node..STRIDE * (range.first_node + range.nodes);
            let shift = shift_of(rod);
            self.matrix
                .shift(unknowns, shift, shift * spin, &self.assembly.held);
        }
        // Frames that turn and nodes that slide, with the rod that carries each.
        let joints = &self.assembly.joints;
        let frames = joints
            .frames
            .iter()
            .map(|frame| (frame.node, frame.first_unknown));
        let slides = joints
            .slides
            .iter()
            .map(|slide| (slide.node, slide.unknown));
        for (node, unknown) in frames.chain(slides) {
            let shift = shift_of(self.assembly.locate(node).0);
            let place = unknown - unknown % STRIDE;
            self.matrix.shift(
                place..place + STRIDE,
                shift,
                shift * spin,
                &self.assembly.held,
            );
        }
    }

    /// Factors the Jacobian; returns its inertia if it is symmetric.
    ///
    /// # Errors
    /// The unknown at which the matrix is singular.
    pub fn factor(&mut self) -> Result<Option<Inertia>, SingularMatrix> {
        let slides = &self.assembly.joints.slides;
        if slides.is_empty() && self.assembly.joints.pins.is_empty() {
            // The last factorisation may have failed.
            self.border = Border::default();
            return self.matrix.factor();
        }
        let parameters = slides.iter().map(|slide| slide.unknown);
        let diagonals: Vec<f64> = parameters.map(|own| self.matrix.isolate(own)).collect();
        let inertia = self.matrix.factor()?;
        let (joints, held) = (&self.assembly.joints, &self.assembly.held);
        let solve = |right_hand_side: &mut [f64]| self.matrix.solve(right_hand_side);
        (self.border).factor(joints, held, &diagonals, inertia, solve)
    }

    /// Writes the Newton direction −J⁻¹R, zero at held unknowns. R contains the contact forces of
    /// the linearised laws, to which the Jacobian belongs.
    ///
    /// # Errors
    /// If the system is singular to working precision.
    pub fn direction(&mut self, direction: &mut [f64]) -> Result<(), SingularMatrix> {
        self.correct_residual();
        for k in 0..direction.len() {
            let held = self.assembly.held[k];
            direction[k] = if held {
                0.0
            } else {
                -self.corrected_residual[k]
            };
        }
        let matrix = &mut self.matrix;
        (self.border).solve(direction, |right_hand_side| matrix.solve(right_hand_side))?;
        self.spread(direction);
        Ok(())
    }

    /// Whether the Jacobian of an equilibrium is the Hessian of an energy.
    pub(crate) fn is_symmetric(&self) -> bool {
        self.matrix.is_symmetric()
    }

    /// Nodes that slide along rods.
    pub(crate) fn slides(&self) -> &[joints::Slide] {
        &self.assembly.joints.slides
    }

    /// Whether a node slides along a rod with friction.
    pub(crate) fn slides_rub(&self) -> bool {
        self.assembly.joints.rub()
    }

    /// Whether a node slides that a clamp holds.
    pub(crate) fn slides_yield(&self) -> bool {
        self.assembly.joints.yields()
    }

    /// Whether there is friction: the forces of an equilibrium then depend on its history.
    pub(crate) fn rubs(&self) -> bool {
        self.terms.contact.rubs()
    }

    /// Solves J x = b in place with the factors of the last factorisation; x is zero at held unknowns.
    ///
    /// # Errors
    /// If the system is singular to working precision.
    pub(crate) fn solve(&mut self, right_hand_side: &mut [f64]) -> Result<(), SingularMatrix> {
        let joints = &self.assembly.joints;
        joints.gather_points(right_hand_side);
        self.border.gather(right_hand_side);
        joints.gather_points(right_hand_side);
        for (entry, held) in right_hand_side.iter_mut().zip(&self.assembly.held) {
            if *held {
                *entry = 0.0;
            }
        }
        let matrix = &mut self.matrix;
        (self.border).solve(right_hand_side, |rest| matrix.solve(rest))?;
        self.spread(right_hand_side);
        Ok(())
    }

    /// Moves nodes with dependent positions, with the coefficients of the factored Jacobian.
    fn spread(&self, moves: &mut [f64]) {
        let joints = &self.assembly.joints;
        joints.spread_points(moves);
        self.border.spread(moves);
        joints.spread_points(moves);
    }

    /// Writes the residual with the contact forces of the linearised laws.
    fn correct_residual(&mut self) {
        self.corrected_residual.copy_from_slice(&self.residual);
        let Some(contact) = &self.terms.contact.model else {
            return;
        };
        let corrections = contact.linear_corrections();
        for (pair, correction) in contact.contacts().iter().zip(corrections.edges) {
            for (corner, &node) in pair.nodes.iter().enumerate() {
                if !contact.is_of_rod(node) {
                    continue;
                }
                let own = std::array::from_fn(|axis| correction[3 * corner + axis]);
                contact.spread(node, own, |node, part| {
                    for axis in 0..3 {
                        self.corrected_residual[STRIDE * node + axis] -= part[axis];
                    }
                });
            }
        }
        for (touch, correction) in contact.plane_contacts().iter().zip(corrections.planes) {
            contact.spread(touch.node, *correction, |node, part| {
                for axis in 0..3 {
                    self.corrected_residual[STRIDE * node + axis] -= part[axis];
                }
            });
        }
        for one in contact.turned() {
            for (unknown, correction) in over_unknowns(one, &one.correction) {
                self.corrected_residual[unknown] -= correction;
            }
        }
        let attached = self.matrix.attached();
        attached.gather(&mut self.corrected_residual);
        for one in contact.all_spun() {
            for (body, moment) in one.bodies.iter().zip(&one.corrections) {
                if let Some(body) = body {
                    attached.add_moment(*body, &-moment, &mut self.corrected_residual);
                }
            }
        }
        self.assembly.joints.gather(&mut self.corrected_residual);
    }
}
