//! Poses in which an arm holds a rod before the camera.
//!
//! Candidates combine places on a grid in the picture and in depth, headings, and angles at which
//! the rod leaves the hand. Three are chosen one after the other, each with another angle. Each
//! choice minimises the variance of the gravito-bending length: the first entry of the inverse of
//! the sum of their [information](super::candidate). The arm must reach them.

use super::candidate::{LEAST_WIDTHS, Shape, hand};
use crate::cell::{Cell, PlanError};
use nalgebra::{Matrix3, Point3};
use rodlab_engine::mechanics::Vector3;
use rodlab_lab::identify::{CURLED, HeldRod, IdentifyError};
use rodlab_robot::{JointTrajectory, Pose};
use rodlab_vision::{Camera, Point};
use serde::Serialize;
use std::f64::consts::TAU;

/// Number of poses.
const POSES: usize = 3;
/// Angles from straight down at which the rod leaves the hand, degrees.
const TILTS: [f64; 4] = [60.0, -60.0, 90.0, -90.0];
/// Number of headings.
const HEADINGS: u32 = 12;
/// Number of places along each side of the picture.
const ACROSS: [f64; 7] = [0.08, 0.2, 0.35, 0.5, 0.65, 0.8, 0.92];
/// Distances from the camera, m.
const DEPTHS: [f64; 5] = [0.45, 0.6, 0.8, 1.1, 1.5];
/// Maximum number of candidates whose joints are tried for a pose.
const TRIALS: usize = 60;
/// Number of points of a motion from which it is checked for collisions.
const STRIDE: usize = 10;
/// Fraction of the rod at the hand that may be near to the arm.
const AT_HAND: f64 = 0.2;

/// A request for poses.
pub struct HoldRequest<'a> {
    /// The cell, which has a camera.
    pub cell: &'a Cell,
    /// Index of the arm.
    pub arm: usize,
    /// The free part of the expected rod.
    pub rod: &'a HeldRod,
    /// Minimum distance to anything else, m.
    pub margin: f64,
    /// Maximum speed of the hand, m/s.
    pub speed: f64,
}

/// A pose in which a rod is held.
#[derive(Clone, Debug, Serialize)]
pub struct HeldPose {
    /// Place of the hand in the cell, m.
    pub position_m: [f64; 3],
    /// Heading of the hand, degrees.
    pub heading_deg: f64,
    /// Angle from straight down at which the rod leaves the hand, about its level y axis, degrees.
    pub angle_deg: f64,
    /// Expected relative standard error of the gravito-bending length from pictures up to this one.
    pub expected_error: f64,
    /// Joints of the arm.
    pub joints: Vec<f64>,
}

/// A candidate for a pose.
struct Candidate<'a> {
    shape: &'a Shape,
    place: Vector3,
    heading: f64,
    information: Matrix3<f64>,
}

impl HoldRequest<'_> {
    /// Chooses the poses. Also returns, as the first item, the joints at which the rod is handed
    /// over and hangs straight down.
    ///
    /// # Errors
    /// The camera sees too few poses that the arm reaches, or the rod has no equilibrium.
    pub fn plan(&self) -> Result<(Vec<f64>, Vec<HeldPose>), PlanError> {
        let refused = |message: &str| PlanError::Input(message.to_owned());
        let camera = self.cell.camera.as_ref();
        let camera = camera.ok_or_else(|| refused("the cell has no [camera] to see the rod"))?;
        let camera = camera.seeing(self.cell.table_height());
        let shapes = TILTS.map(|tilt| Shape::new(self.rod, tilt.to_radians()));
        let shapes: Result<Vec<Shape>, IdentifyError> = shapes.into_iter().collect();
        let shapes = shapes.map_err(|error| PlanError::Input(error.to_string()))?;
        let mut candidates = candidates(&camera, &shapes);
        let mut total = Matrix3::from_diagonal(&nalgebra::Vector3::new(
            0.0,
            CURLED.powi(-2),
            CURLED.powi(-2),
        ));
        let mut from = self.cell.arms[self.arm].home.clone();
        let mut handed: Option<Vec<f64>> = None;
        let mut poses: Vec<HeldPose> = Vec::new();
        while poses.len() < POSES {
            let mut ranked: Vec<(f64, &Candidate<'_>)> = candidates
                .iter()
                .map(|one| (variance(&(total + one.information)), one))
                .collect();
            ranked.sort_by(|(one, _), (other, _)| one.total_cmp(other));
            let found = ranked.into_iter().take(TRIALS).find_map(|(error, one)| {
                let first = match handed {
                    None => Some(self.reached(&hand(one.place, one.heading, 0.0), &from, &[])?),
                    Some(_) => None,
                };
                let nodes = one.shape.nodes_at(one.place, one.heading);
                let pose = hand(one.place, one.heading, one.shape.tilt);
                let joints = self.reached(&pose, first.as_ref().unwrap_or(&from), &nodes)?;
                let pose = HeldPose {
                    position_m: one.place.into(),
                    heading_deg: one.heading.to_degrees(),
                    angle_deg: one.shape.tilt.to_degrees(),
                    expected_error: error.sqrt(),
                    joints,
                };
                Some((first, pose, one.information, one.shape.tilt))
            });
            let (first, pose, information, tilt) = found.ok_or_else(|| {
                PlanError::Input(format!(
                    "fewer than three poses were found: in each the camera must see the whole rod \
                     of {:.3} m, at least {} widths long, and arm {} must reach the pose; change --free",
                    self.rod.length, LEAST_WIDTHS[0], self.cell.arms[self.arm].name
                ))
            })?;
            handed = handed.or(first);
            from.clone_from(&pose.joints);
            total += information;
            poses.push(pose);
            candidates.retain(|one| one.shape.tilt != tilt);
        }
        let handed = handed.ok_or_else(|| refused("the rod cannot be handed over"))?;
        Ok((handed, poses))
    }

    /// Returns joints at a pose that are reached by a straight motion from other joints, on which
    /// arm and rod keep the minimum distance from everything.
    fn reached(&self, pose: &Pose, from: &[f64], nodes: &[Vector3]) -> Option<Vec<f64>> {
        let arm = &self.cell.arms[self.arm];
        let target = arm.base.inverse() * pose;
        // Among the joints that reach it, choose those with the shortest turns.
        let starts = [from, &arm.home].into_iter();
        let ways = starts.filter_map(|start| arm.chain.reach(&target, start).ok());
        let joints =
            ways.min_by(|one, other| farthest(from, one).total_cmp(&farthest(from, other)))?;
        let surroundings = self.cell.surroundings();
        let mut postures = surroundings.homes();
        let mut is_clear = |joints: &[f64]| {
            postures[self.arm] = joints.to_vec();
            surroundings.clearance(&postures, Some(self.arm)) >= self.margin
        };
        let way = self.motion(from, &joints).ok()?;
        let mut points = way.iter().flat_map(|way| way.points.iter().step_by(STRIDE));
        if !points.all(|point| is_clear(point)) || !is_clear(&joints) {
            return None;
        }
        let free = &nodes[(AT_HAND * nodes.len() as f64) as usize..];
        let near = surroundings.nearest_to_balls(&postures, free, self.rod.radius);
        near.is_none_or(|(_, away)| away >= self.margin)
            .then_some(joints)
    }

    /// Returns the motion between two sets of joints; `None` if they are the same.
    fn motion(&self, from: &[f64], to: &[f64]) -> Result<Option<JointTrajectory>, PlanError> {
        self.cell.approach(self.arm, from, to, self.speed)
    }
}

/// Returns all poses that a camera sees well.
fn candidates<'a>(camera: &Camera, shapes: &'a [Shape]) -> Vec<Candidate<'a>> {
    let mut found = Vec::new();
    let [width, height] = [camera.width, camera.height].map(f64::from);
    for (column, row) in ACROSS.iter().flat_map(|u| ACROSS.map(|v| (*u, v))) {
        let pixel = Point::new(column * width, row * height);
        let Some(direction) = camera.lens.direction(pixel) else {
            continue;
        };
        for depth in DEPTHS {
            let place = Point3::new(direction.x, direction.y, 1.0) * depth;
            let place = (camera.pose * place).coords;
            for number in 0..HEADINGS {
                let heading = TAU * f64::from(number) / f64::from(HEADINGS);
                found.extend(shapes.iter().filter_map(|shape| {
                    Some(Candidate {
                        information: shape.information(camera, place, heading)?,
                        shape,
                        place,
                        heading,
                    })
                }));
            }
        }
    }
    found
}

/// Largest movement of a joint, rad or m.
fn farthest(from: &[f64], to: &[f64]) -> f64 {
    let pairs = from.iter().zip(to);
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Variance of the first unknown.
fn variance(information: &Matrix3<f64>) -> f64 {
    let inverse = information.try_inverse();
    inverse.map_or(f64::INFINITY, |inverse| inverse[(0, 0)].abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_cells::gantry;

    #[test]
    fn poses_before_the_camera_are_expected_to_determine_the_length_well() {
        let cell = gantry();
        for (unit, length) in [(0.018, 0.072), (0.032, 0.128), (0.08, 0.24)] {
            let rod = HeldRod {
                title: "rod".into(),
                length,
                radius: 1.6e-3,
                density: 1000.0,
                gravito_bending_length: unit,
            };
            let request = HoldRequest {
                cell: &cell,
                arm: 0,
                rod: &rod,
                margin: 0.01,
                speed: 0.1,
            };
            let (handed, poses) = request.plan().unwrap();
            println!("{unit}: {handed:?}\n{poses:#?}");
            assert_eq!((handed.len(), poses.len()), (6, 3));
            let errors: Vec<f64> = poses.iter().map(|pose| pose.expected_error).collect();
            assert!(
                errors.windows(2).all(|pair| pair[1] < pair[0]),
                "{errors:?}"
            );
            assert!(errors[2] < 0.005, "{errors:?}");
        }
    }
}
