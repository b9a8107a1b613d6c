//! The motions of both arms that tie a knot, planned and checked before anything moves.

use super::choreography::{Choreography, Laying, Stretch, held};
use super::plan::KnotPlan;
use super::request::TieMotionRequest;
use super::two_arms::joined;
use crate::cell::{PlanError, PlanReport};
use crate::task::room::is_in_room;
use rodlab_robot::{FAR, JointTrajectory, Pose, pose};

/// Number of points of a motion between two clearance checks of the arms.
const STRIDE: usize = 5;

/// The planned motions.
pub struct TieMotion {
    /// Motions that lay the rods in sequence; the first arm lays the first rod.
    pub layings: Vec<Laying>,
    /// Motions that lead ends and lift strands.
    pub stretches: Vec<Stretch>,
    /// Arm that holds an end after the last stretch, and the motion of both arms while it returns
    /// home after the release.
    pub last: usize,
    /// See `last`.
    pub retreat: JointTrajectory,
    /// All motions as one motion of both arms, for the page.
    pub whole: JointTrajectory,
    /// Numbers of the path of the first arm.
    pub report: PlanReport,
    /// Least distance of the arms from each other and from anything else, m; 0.2 means 0.2 or
    /// more.
    pub least_clearance: f64,
    /// The frame of the patterns in the cell.
    pub frame: Pose,
}

impl TieMotion {
    /// Plans all motions.
    ///
    /// # Errors
    /// A pattern leaves the table or the picture, an arm cannot follow its path, or something
    /// comes too near to something else.
    pub fn plan(request: &TieMotionRequest<'_>, knot: &KnotPlan) -> Result<Self, PlanError> {
        let (first, report) = request.best(0, held(knot, 0), request.place)?;
        let frame = pose(report.place_position, report.place_quaternion);
        let frame = frame.expect("the pose of a plan");
        in_room(request, &frame, knot)?;
        let mut choreography = Choreography::from(request, frame, first);
        let layings = choreography.layings(knot)?;
        let (last, stretches) = choreography.stretches(knot)?;
        choreography.homewards(last)?;
        let retreat = choreography.ended();
        let done = &choreography.done;
        let found = done.iter().map(|motion| clearance(request, motion));
        let least_clearance = found
            .collect::<Result<Vec<f64>, String>>()
            .map_err(PlanError::Path)?;
        Ok(Self {
            whole: joined(done),
            layings,
            stretches,
            last,
            retreat,
            report,
            least_clearance: least_clearance.into_iter().fold(f64::INFINITY, f64::min),
            frame,
        })
    }
}

/// Checks that rods are on the table and visible to the camera.
fn in_room(request: &TieMotionRequest<'_>, frame: &Pose, knot: &KnotPlan) -> Result<(), PlanError> {
    let mut points = knot.rods.iter().flat_map(|planned| planned.points());
    let outside = points.find(|point| !is_in_room(request.cell, frame, *point));
    outside.map_or(Ok(()), |point| {
        Err(PlanError::Input(format!(
            "at {:.3},{:.3} the pattern is off the table or outside the picture of the camera; move it by --place, or \
             make it smaller by --size",
            point.x, point.y
        )))
    })
}

/// Least distance of the arms to each other and to anything else during a motion of both.
fn clearance(request: &TieMotionRequest<'_>, motion: &JointTrajectory) -> Result<f64, String> {
    let surroundings = request.cell.surroundings();
    let mut postures = surroundings.homes();
    let columns = request
        .arms
        .map(|arm| motion.columns_of(&request.cell.arms[arm].name));
    let mut least = FAR;
    for (point, time) in motion.points.iter().zip(&motion.times).step_by(STRIDE) {
        for (arm, columns) in request.arms.iter().zip(&columns) {
            postures[*arm] = columns.iter().map(|column| point[*column]).collect();
        }
        let Some(near) = surroundings.nearest(&postures, None) else {
            continue;
        };
        if near.distance < request.margin {
            let [one, other] = &near.between;
            return Err(format!(
                "{one} comes within {:.3} m of {other} {time:.1} s after the start of one of their motions; \
                 allowed: {} m, see --margin",
                near.distance.max(0.0),
                request.margin
            ));
        }
        least = least.min(near.distance);
    }
    Ok(least)
}
