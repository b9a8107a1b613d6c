//! Moves along a ray, takes pictures, and searches for the instability.

use super::ray::{Ray, SPACING};
use crate::task::error::WorkError;
use crate::task::working_arm::{Grip, WorkingArm};
use image::RgbImage;
use rodlab_lab::experiment::ClampedRod;
use rodlab_vision::{ColourRule, MarkerErrors, Point, compare_markers, find_markers};
use serde::Serialize;

/// Smallest and largest number of pixels of a marker.
const MARKER_AREA: [usize; 2] = [6, 2000];
/// Search radius of a marker, as a fraction of the length of the rod.
const GATE: f64 = 0.1;
/// Fraction of the markers that must be found. With fewer, the rod is not at the place of the
/// helix.
const FOUND: f64 = 0.5;
/// Distance below which joints count as at their target, rad or m.
const THERE: f64 = 1e-4;
/// Rest of the arm after a step before the camera takes a picture, s.
const REST: f64 = 0.3;
/// Folder of the last motion.
pub const LOG: &str = "motion";

/// Settings of the search for the instability.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SearchSteps {
    /// Distance ‖(κ, τ, ω)‖ between pictures on the way out.
    pub step: f64,
    /// Distance between pictures after the instability has been passed once.
    pub precision: f64,
    /// Mean distance of the markers from the helix, as a fraction of the length of the rod, above
    /// which the rod is not a helix.
    pub deviation: f64,
    /// Greatest speed of the hand on the way out, m/s. Ten times that number, rad/s, limits the
    /// rotation of hand and chuck.
    pub speed: f64,
    /// Greatest speed of the hand on the way back, m/s.
    pub return_speed: f64,
}

/// Measurement in a picture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Look {
    /// Number of the picture.
    pub look: usize,
    /// Distance ‖(κ, τ, ω)‖ of the clamps.
    pub distance: f64,
    /// Mean distance of the markers from those of the helix, as a fraction of the length of the
    /// rod; empty if too few were found.
    pub deviation: Option<f64>,
    /// Markers that were found near their places.
    pub markers: usize,
    /// Whether the rod is the expected helix.
    pub is_helix: bool,
}

/// Result of the search along a direction.
#[derive(Clone, Debug)]
pub struct Searched {
    /// Largest distance at which the rod was the helix.
    pub stable: f64,
    /// Next distance, at which the rod was not the helix; `None` if there was none.
    pub lost: Option<f64>,
    /// All measurements.
    pub looks: Vec<Look>,
    /// Picture in which the rod was first seen unstable, with the markers found and expected; `None` if it stayed stable.
    pub lost_picture: Option<Picture>,
}

/// A picture with the markers that were found in it.
#[derive(Clone, Debug)]
pub struct Picture {
    /// As it came.
    pub pixels: RgbImage,
    /// All spots with the colour of markers.
    pub spots: Vec<Point>,
    /// Distances of the markers from their expected places.
    pub errors: MarkerErrors,
}

/// Moves an arm and a chuck along a ray.
pub struct Walker<'a> {
    /// The arm. The log of each motion replaces the one before.
    pub arm: WorkingArm<'a>,
    /// The rod.
    pub rod: &'a ClampedRod,
    /// Colour of the markers.
    pub colour: &'a ColourRule,
    /// Settings of the search.
    pub steps: SearchSteps,
}

impl Walker<'_> {
    /// Searches along a ray from its first point, and returns there.
    ///
    /// # Errors
    /// A motion or a picture fails and all arms were commanded to hold, or the rod does not become
    /// straight again.
    pub fn search(&self, ray: &Ray) -> Result<Searched, WorkError> {
        let mut walk = Walk {
            walker: self,
            ray,
            at: 0,
            looks: Vec::new(),
            last: None,
        };
        let found = walk.outwards()?;
        let lost_picture = walk.last.take().filter(|_| found.1.is_some());
        walk.straighten(found.1.is_some())?;
        let distance = |index: usize| index as f64 * SPACING;
        Ok(Searched {
            stable: distance(found.0),
            lost: found.1.map(distance),
            looks: walk.looks,
            lost_picture,
        })
    }

    /// Moves from the current joints to the start of a ray, through the points between, and rests
    /// there.
    ///
    /// # Errors
    /// The motion fails.
    pub fn return_from(&self, ray: &Ray, joints: Vec<f64>) -> Result<(), WorkError> {
        let (index, away) = ray.nearest(&joints);
        if index == 0 && away < THERE {
            return Ok(());
        }
        let mut points = vec![joints];
        // The nearest point may be farther out on the ray.
        points.extend(ray.points[..index].iter().rev().cloned());
        if index == 0 {
            points.push(ray.points[0].clone());
        }
        self.stream(&points, self.steps.return_speed)
    }

    /// Opens the gripper, so that the straight rod untwists, and closes it again.
    ///
    /// # Errors
    /// The gripper does not move.
    pub fn take_anew(&self) -> Result<(), WorkError> {
        self.arm.grip(Grip::Open)?;
        self.arm.grip(Grip::Close)
    }

    fn stream(&self, points: &[Vec<f64>], speed: f64) -> Result<(), WorkError> {
        let WorkingArm { at, arm } = self.arm;
        let cell = at.cell;
        let chuck = cell.chuck.expect("the cell has a chuck");
        let motion = cell.motion_along(arm, chuck.axis, points, speed, REST);
        self.arm.follow(LOG, &motion.map_err(WorkError::failed)?)
    }
}

/// A walk in progress.
struct Walk<'a> {
    walker: &'a Walker<'a>,
    ray: &'a Ray,
    /// Index of the point where the clamps are.
    at: usize,
    looks: Vec<Look>,
    /// The newest picture.
    last: Option<Picture>,
}

impl Walk<'_> {
    /// Searches outwards; returns the last point of the ray at which the rod is the helix, and the
    /// next one, at which it is not.
    fn outwards(&mut self) -> Result<(usize, Option<usize>), WorkError> {
        let SearchSteps {
            step, precision, ..
        } = self.walker.steps;
        let points = |distance: f64| ((distance / SPACING).round() as usize).max(1);
        let Some(passed) = self.advance(points(step))? else {
            return Ok((self.at, None));
        };
        let lost = self.at;
        if points(precision) >= points(step) {
            return Ok((passed, Some(lost)));
        }
        self.straighten(true)?;
        self.go(passed)?;
        if !self.look()? {
            return Ok((passed, Some(lost)));
        }
        Ok(match self.advance(points(precision))? {
            Some(stable) => (stable, Some(self.at)),
            None => (self.at, None),
        })
    }

    /// Returns to the straight rod. A rod that snapped is gripped again there. Otherwise the rod
    /// would retain twist, apparently whole turns, which a straight rod does not show.
    fn straighten(&mut self, has_snapped: bool) -> Result<(), WorkError> {
        self.go(0)?;
        if !self.look()? {
            return Err(WorkError::failed(
                "the rod does not become straight again; inspect it, and start a new exploration with another one",
            ));
        }
        match has_snapped {
            true => self.walker.take_anew(),
            false => Ok(()),
        }
    }

    /// Advances in steps of `points` points until the rod is not a helix, or the ray ends. Returns
    /// the last point with a helix if the rod lost it.
    fn advance(&mut self, points: usize) -> Result<Option<usize>, WorkError> {
        let last = self.ray.points.len() - 1;
        while self.at < last {
            let before = self.at;
            self.go((before + points).min(last))?;
            if !self.look()? {
                return Ok(Some(before));
            }
        }
        Ok(None)
    }

    fn go(&mut self, to: usize) -> Result<(), WorkError> {
        if to == self.at {
            return Ok(());
        }
        let SearchSteps {
            speed,
            return_speed,
            ..
        } = self.walker.steps;
        let mut points = self.ray.points[self.at.min(to)..=self.at.max(to)].to_vec();
        let mut most = speed;
        if to < self.at {
            points.reverse();
            most = return_speed;
        }
        self.walker.stream(&points, most)?;
        self.at = to;
        Ok(())
    }

    /// Takes a picture; returns whether the rod is the expected helix.
    fn look(&mut self) -> Result<bool, WorkError> {
        let walker = self.walker;
        walker.arm.at.check()?;
        let pixels = walker.arm.at.look();
        let seen = pixels.and_then(|pixels| Ok(compare(walker, self.ray, self.at, pixels)?));
        let picture = seen.map_err(|error| WorkError::Failed(format!("looking: {error}")))?;
        let deviation = deviation(&picture.errors, walker.rod.length);
        let is_helix = deviation.is_some_and(|deviation| deviation <= walker.steps.deviation);
        self.looks.push(Look {
            look: self.looks.len() + 1,
            distance: self.at as f64 * SPACING,
            deviation,
            markers: picture.errors.found.iter().flatten().count(),
            is_helix,
        });
        self.last = Some(picture);
        Ok(is_helix)
    }
}

/// Compares a picture of the rod at a point of a ray with the markers of the helix there.
fn compare(
    walker: &Walker<'_>,
    ray: &Ray,
    index: usize,
    pixels: RgbImage,
) -> Result<Picture, rodlab_vision::VisionError> {
    let cell = walker.arm.at.cell;
    let camera = cell.camera.as_ref().expect("the cell has a camera");
    let camera = camera.seeing(cell.table_height());
    camera.check_size(pixels.width(), pixels.height())?;
    let [least, most] = MARKER_AREA;
    let spots = find_markers(&pixels, walker.colour, least, most)?;
    let length = walker.rod.length;
    let expected = ray.places(cell, length, index, &walker.rod.marker_places());
    let depths = expected.iter();
    let depth =
        |place: &nalgebra::Vector3<f64>| camera.pose.inverse_transform_point(&(*place).into()).z;
    let nearest = depths.map(depth).fold(f64::INFINITY, f64::min);
    let gate = GATE * length * camera.lens.focal[0] / nearest.max(1e-3);
    let errors = compare_markers(&camera, &expected, &spots, gate)?;
    Ok(Picture {
        pixels,
        spots,
        errors,
    })
}

/// Mean distance of the markers that were found from their expected places, as a fraction of the
/// length of the rod; `None` if too few were found. Hidden markers are ignored, such as those
/// where the rod crosses itself in the picture.
fn deviation(errors: &MarkerErrors, length: f64) -> Option<f64> {
    let found: Vec<f64> = errors.metres.iter().flatten().copied().collect();
    let enough = found.len() as f64 >= FOUND * errors.metres.len() as f64;
    enough.then(|| found.iter().sum::<f64>() / found.len() as f64 / length)
}
