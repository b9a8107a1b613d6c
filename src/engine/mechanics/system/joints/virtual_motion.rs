//! Transposes for adjoints: derivatives with respect to all unknowns as forces on the free ones,
//! and virtual motions of the free unknowns as motions of all nodes, frames and bodies.

use super::super::System;
use super::Joints;
use crate::mechanics::Vector3;
use crate::mechanics::rod::STRIDE;

impl Joints {
    /// Unknowns of the tips of bodies: they follow the frames.
    pub(crate) fn of_tips(&self) -> impl Iterator<Item = usize> {
        let bodies = self.frames.iter().filter_map(|frame| frame.body);
        bodies.flat_map(|(first, _)| first..first + 3 * STRIDE)
    }

    /// Rotations of the ghost edges along a virtual motion, with the indices of these edges among
    /// all ghost edges; the last evaluation was at `unknowns`.
    pub(crate) fn turns_of_ghosts<'a>(
        &'a self,
        unknowns: &'a [f64],
        motion: &'a [f64],
    ) -> impl Iterator<Item = (usize, Vector3)> + 'a {
        self.frames.iter().enumerate().flat_map(|(number, frame)| {
            let turn = self.turn_of_frame(number, unknowns, motion);
            frame.ghosts.iter().map(move |(ghost, _)| (*ghost, turn))
        })
    }
}

impl System {
    /// Forces on the unknowns, of which dependent ones remain for [`System::solve`], from
    /// derivatives `over` all unknowns and from other `forces`, which contain moments on frames in
    /// the fixed frame; the last evaluation was at `unknowns`.
    pub(crate) fn gather_over(
        &mut self,
        unknowns: &[f64],
        over: &[f64],
        mut forces: Vec<f64>,
    ) -> Vec<f64> {
        let joints = &mut self.assembly.joints;
        let frames = joints.frames.iter().map(|frame| frame.first_unknown);
        let of_vectors: Vec<usize> = frames.flat_map(|first| first..first + 3).collect();
        // Those of rotation vectors already are derivatives with respect to unknowns.
        let mut others = over.to_vec();
        of_vectors.iter().for_each(|&k| others[k] = 0.0);
        let pairs = forces.iter_mut().zip(others);
        pairs.for_each(|(force, over)| *force += over);
        joints.gather_moments(unknowns, &mut forces);
        of_vectors.iter().for_each(|&k| forces[k] += over[k]);
        forces
    }

    /// Transfers forces on dependent nodes at `unknowns`, which need not be those of the last
    /// evaluation, to the nodes that determine their positions.
    pub(crate) fn gather_places(&self, unknowns: &[f64], forces: &mut [f64]) {
        let joints = &self.assembly.joints;
        joints.gather_points(forces);
        for slide in &joints.slides {
            let mut slide = slide.clone();
            slide.place(unknowns, None);
            slide.gather(forces);
        }
        joints.gather_points(forces);
    }

    /// Moves dependent nodes in a virtual motion of the free unknowns.
    pub(crate) fn spread_points(&self, motion: &mut [f64]) {
        let joints = &self.assembly.joints;
        joints.spread_points(motion);
        joints.slides.iter().for_each(|slide| slide.spread(motion));
        joints.spread_points(motion);
    }

    /// Completes a virtual motion with that of the tips of bodies; the last evaluation was at
    /// `unknowns`.
    pub(crate) fn spread_virtual(&self, unknowns: &[f64], motion: &mut [f64]) {
        let explicit = vec![0.0; motion.len()];
        self.spread_change(unknowns, &explicit, motion);
    }
}
