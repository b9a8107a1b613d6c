//! Plan of a deployment, and detection of the rod in a picture.

use super::look::Seen;
use super::motion::DeployMotion;
use super::stopped::LaidAlong;
use crate::cell::Cell;
use image::RgbImage;
use rodlab_lab::experiment::Fixtures;
use rodlab_planning::plan::deployment::{DeployedRod, LaidPath, falls_straight, friction_demands};
use rodlab_vision::{ColourRule, Point, SeenLength, VisionError};

/// Plan of a deployment.
pub struct DeployPlan {
    /// Index of the arm.
    pub arm: usize,
    /// The motion.
    pub motion: DeployMotion,
    /// Greatest speed of the hand on the way to the rod, m/s.
    pub approach_speed: f64,
    /// The pattern, as given.
    pub name: String,
    /// The pattern in its own frame, without lead-in and lead-out, m.
    pub pattern: Vec<Point>,
    /// The path along which the rod is laid: the pattern with lead-in and lead-out.
    pub path: LaidPath,
    /// The rod with its estimated properties.
    pub rod: DeployedRod,
    /// Colour of the rod.
    pub colour: ColourRule,
    /// Pegs in the frame of the pattern, if there are any.
    pub fixtures: Option<Fixtures>,
}

impl DeployPlan {
    /// Start of the rod in the frame of the pattern, m.
    pub fn start(&self) -> Point {
        self.path.points[0].position
    }

    /// The path along which the rod is laid, in the cell.
    pub fn along(&self) -> LaidAlong<'_> {
        LaidAlong {
            poses: &self.path.poses,
            frame: self.motion.frame,
            unit: self.rod.gravito_bending_length,
        }
    }

    /// Largest coefficient of friction that the path needs.
    pub fn largest_friction_demand(&self) -> f64 {
        let demands = friction_demands(&self.rod, &self.path.points, &self.path.poses);
        demands.into_iter().fold(0.0, f64::max)
    }

    /// Detects the rod in a picture.
    pub fn seen(&self, picture: &RgbImage, cell: &Cell) -> Result<Seen, VisionError> {
        let (frame, radius) = (&self.motion.frame, self.rod.radius);
        Seen::of(picture, cell, frame, radius, &self.colour)
    }

    /// Compares the visible length of the rod with its real length. Only the path along which it
    /// was laid must be visible if its end is outside the picture, or if a long remainder fell
    /// from the gripper and may lie in a heap.
    pub fn seen_length(&self, seen: &Seen, rod: &[Point]) -> Result<SeenLength, VisionError> {
        let length = SeenLength::of(rod, self.rod.length);
        let laid = self.path.points.last().map_or(0.0, |point| point.s);
        if falls_straight(&self.rod, laid) && !seen.leaves_picture(self.start())? {
            return Ok(length);
        }
        Ok(length.with_least(laid))
    }
}
