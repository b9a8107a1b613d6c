//! Charts of the rotations of frames, and the data of joints in a checkpoint.

use super::super::System;
use crate::mechanics::UnitQuaternion;

impl System {
    /// Frames with long rotation vectors at `unknowns`.
    pub(crate) fn long_rotations(&self, unknowns: &[f64]) -> Vec<usize> {
        let frames = self.assembly.joints.frames.iter().enumerate();
        let long = frames.filter(|(_, frame)| frame.is_long(unknowns));
        long.map(|(number, _)| number).collect()
    }

    /// Resets the rotation vectors of some frames, with the present rotations as bases. The change
    /// of chart is exact for all `motions`: the present unknowns and velocities, and earlier ones.
    pub(crate) fn begin_rotations_anew(
        &mut self,
        frames: &[usize],
        motions: &mut [[&mut [f64]; 2]],
    ) {
        for &number in frames {
            self.assembly.joints.frames[number].begin_anew(motions);
        }
    }

    /// Data of sliding nodes and of all terms for a checkpoint.
    pub(crate) fn memory(&self) -> Vec<Vec<f64>> {
        let of_slides = std::iter::once(self.assembly.joints.memory());
        of_slides.chain(self.terms.memory()).collect()
    }

    /// Restores the data of a checkpoint.
    ///
    /// # Errors
    /// The difference if the checkpoint belongs to another scene.
    pub(crate) fn restore(&mut self, memory: Vec<Vec<f64>>) -> Result<(), &'static str> {
        let mut memory = memory.into_iter();
        let of_slides = memory.next().unwrap_or_default();
        self.assembly.joints.restore(&of_slides)?;
        self.terms.restore(memory)
    }

    /// The base rotations of the frames, for a checkpoint.
    pub(crate) fn frame_bases(&self) -> Vec<UnitQuaternion> {
        let frames = self.assembly.joints.frames.iter();
        frames.map(|frame| frame.base).collect()
    }

    /// Restores the base rotations from a checkpoint.
    ///
    /// # Errors
    /// The difference if the checkpoint belongs to another scene.
    pub(crate) fn restore_frame_bases(
        &mut self,
        bases: &[UnitQuaternion],
    ) -> Result<(), &'static str> {
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
