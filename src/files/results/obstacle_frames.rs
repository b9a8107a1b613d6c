//! Frames of obstacles for ParaView, next to those of the rods: `vtk/obstacles_000000.vtp`; a
//! single one if no obstacle moves.

use super::files::obstacle_frame_name;
use super::mark::{FileMark, Marker};
use super::vtk::{self, Surface};
use super::{Frame, ResultsError};
use nalgebra::{Isometry3, Point3};
use std::path::Path;

/// The surfaces of all obstacles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObstacleSurfaces {
    /// Surfaces of the obstacles at time zero, in the order of the obstacles.
    pub surfaces: Vec<Surface>,
    /// Whether any of them moves.
    pub moving: bool,
}

/// The frames of obstacles written so far.
pub(super) struct ObstacleFrames {
    obstacles: ObstacleSurfaces,
    marker: Marker,
}

impl ObstacleFrames {
    /// Continues the series after the marked frames.
    pub fn after(obstacles: ObstacleSurfaces, marker: Marker) -> Self {
        Self { obstacles, marker }
    }

    /// Whether frames must include the poses of obstacles.
    pub fn need_poses(&self) -> bool {
        self.obstacles.moving
    }

    /// Writes the obstacles of frame number `index`, if they have moved.
    pub fn write(
        &mut self,
        directory: &Path,
        index: usize,
        frame: &Frame,
    ) -> Result<(), ResultsError> {
        if !self.obstacles.moving && self.marker.bytes() > 0 {
            return Ok(());
        }
        let unmoved = Isometry3::identity();
        let poses = frame
            .obstacle_poses
            .iter()
            .chain(std::iter::repeat(&unmoved));
        let placed: Vec<Surface> = (self.obstacles.surfaces.iter())
            .zip(poses)
            .map(|(surface, pose)| placed(surface, pose))
            .collect();
        let name = obstacle_frame_name(self.number(index));
        self.marker
            .update(&vtk::write_obstacles(directory, &name, &placed)?);
        Ok(())
    }

    /// The file of the obstacles of frame number `index`.
    pub fn file(&self, index: usize) -> String {
        obstacle_frame_name(self.number(index))
    }

    /// The mark of all frames so far.
    pub fn mark(&self) -> FileMark {
        self.marker.mark()
    }

    fn number(&self, index: usize) -> usize {
        if self.obstacles.moving { index } else { 0 }
    }
}

fn placed(surface: &Surface, pose: &Isometry3<f64>) -> Surface {
    let points = surface.points.iter();
    Surface {
        points: points
            .map(|point| (pose * Point3::from(*point)).coords)
            .collect(),
        triangles: surface.triangles.clone(),
    }
}
