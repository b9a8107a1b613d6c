//! Motions along a ray, pictures from there, and the search for the instability.

use super::ray::{Ray, SPACING};
use crate::task::error::WorkError;
use crate::task::working_arm::{Grip, WorkingArm};
use image::RgbImage;
use rodlab_lab::experiment::ClampedRod;
use rodlab_vision::{ColourRule, MarkerErrors, Point, compare_markers, find_markers};
use serde::Serialize;

/// Smallest and largest number of pixels of a marker.
const MARKER_AREA: [usize; 2] = [6, 2000];
/// Search radius of a marker, over the length of the rod.
const GATE: f64 = 0.1;
/// Part of the markers that must be found: where fewer are, the rod is not where the helix would be.
const FOUND: f64 = 0.5;
/// Distance below which joints count as at their target, rad or m.
const THERE: f64 = 1e-4;
/// Rest of the arm after a step before the camera takes a picture, s.
const REST: f64 = 0.3;
/// The folder of the newest motion.
pub const LOG: &str = "motion";

/// Settings of the search for the instability.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SearchSteps {
    /// Distance ‖(κ, τ, ω)‖ between pictures on the way out.
    pub step: f64,
    /// The same where the instability has been passed once.
    pub precision: f64,
    /// Mean distance of the markers from the helix, over the length of the rod, above which the rod is not a helix.
    pub deviation: f64,
    /// Greatest speed of the hand on the way out, m/s, and ten times that in rad/s, which bounds the chuck, too.
    pub speed: f64,
    /// The same on the way back.
    pub return_speed: f64,
}

/// Measurement in a picture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Look {
    /// Number of the picture.
    pub look: usize,
    /// Distance ‖(κ, τ, ω)‖ of the clamps.
    pub distance: f64,
    /// Mean distance of the markers from those of the helix, over the length of the rod; empty where too few were found.
    pub deviation: Option<f64>,
    /// Markers that were found near their places.
    pub markers: usize,
    /// Whether the rod is that helix.
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

/// A picture with what was found in it.
#[derive(Clone, Debug)]
pub struct Picture {
    /// As it came.
    pub pixels: RgbImage,
    /// All spots of the colour of markers.
    pub spots: Vec<Point>,
    /// Their distances from the expected places.
    pub errors: MarkerErrors,
}

/// An arm and a chuck on a ray.
pub struct Walker<'a> {
    /// The arm. Its motions are logged, each over the one before.
    pub arm: WorkingArm<'a>,
    /// The rod.
    pub rod: &'a ClampedRod,
    /// Colour of the markers.
    pub colour: &'a ColourRule,
    /// Settings of the search.
    pub steps: SearchSteps,
}

impl Walker<'_> {
    /// Searches along a ray from its first point on, and returns there.
    ///
    /// # Errors
    /// A motion or a picture fails, and all arms were commanded to hold; or the rod does not become straight again.
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

    /// Moves from the current joints to a point of a ray, over the points between, and rests there.
    ///
    /// # Errors
    /// The motion fails.
    pub fn return_from(&self, ray: &Ray, joints: Vec<f64>) -> Result<(), WorkError> {
        let (index, away) = ray.nearest(&joints);
        if index == 0 && away < THERE {
            return Ok(());
        }
        let mut points = vec![joints];
        // The nearest point may lie farther out.
        points.extend(ray.points[..index].iter().rev().cloned());
        if index == 0 {
            points.push(ray.points[0].clone());
        }
        self.stream(&points, self.steps.return_speed)
    }

    /// The hand lets the straight rod go, which turns out of its twist, and takes it again.
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
    /// The last point of the ray at which the rod is the helix, and the next one, at which it is not.
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

    /// Returns to the straight rod. A rod that snapped is clamped again there: it retains twist, apparently whole turns,
    /// which a straight rod does not show.
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

    /// Advances in steps of so many points until the rod is not a helix, or the ray ends; returns the last point with a helix.
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

    /// Whether the rod is the helix that it should be.
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

/// A picture of the rod at a point of a ray, compared with the markers of the helix there.
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

/// Mean distance of the markers that were found from their places, over the length of the rod; `None` where too few were. A
/// marker that another one hides, as where the rod crosses itself in the picture, is ignored.
fn deviation(errors: &MarkerErrors, length: f64) -> Option<f64> {
    let found: Vec<f64> = errors.metres.iter().flatten().copied().collect();
    let enough = found.len() as f64 >= FOUND * errors.metres.len() as f64;
    enough.then(|| found.iter().sum::<f64>() / found.len() as f64 / length)
}
