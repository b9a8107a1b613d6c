//! Search for the best place of a path on a table.

use super::{PathFailure, PathProblem, subdivide};
use crate::pose::Pose;
use nalgebra::{Translation3, UnitQuaternion, Vector3};
use rayon::prelude::*;

/// Number of poses of the path tested at each place.
const PROBES: usize = 16;
/// Spacing of places, m.
const GRID: f64 = 0.05;
/// Number of rotations about the normal of the table that are tried.
const TURNS: usize = 8;
/// Number of places tested with the full path.
const FINALISTS: usize = 12;

/// A place for a path.
#[derive(Clone, Copy, Debug)]
pub struct Placement {
    /// Pose of the path's frame in the base frame of the arm.
    pub pose: Pose,
    /// Shift on the table from its centre along its x and y, m, and turn about its normal, rad.
    pub on_table: [f64; 3],
    /// Least distance to a singularity along the path.
    pub least_distance_to_singularity: f64,
}

/// Finds the place on a table at which an arm can follow a path and stays farthest from
/// singularities. `top` is the pose of the centre of the table top in the base frame. All points
/// of the path must be above the table.
///
/// # Errors
/// No place was found. The error is that of the most promising place, if any probe was reachable.
pub fn place(
    problem: &PathProblem<'_>,
    path: &[Pose],
    top: &Pose,
    sides: [f64; 2],
    step: f64,
) -> Result<Placement, Option<Box<PathFailure>>> {
    let probes = PROBES.min(path.len());
    let probes: Vec<Pose> = (0..probes)
        .map(|k| path[k * (path.len() - 1) / (probes - 1).max(1)])
        .collect();
    let count = |side: f64| (side / GRID) as i32 / 2;
    let [nx, ny] = sides.map(count);
    let places: Vec<[f64; 3]> = (-nx..=nx)
        .flat_map(|i| (-ny..=ny).map(move |j| (i, j)))
        .flat_map(|(i, j)| {
            (0..TURNS).map(move |k| {
                let turn = std::f64::consts::TAU * k as f64 / TURNS as f64;
                [GRID * f64::from(i), GRID * f64::from(j), turn]
            })
        })
        .collect();
    let mut scored: Vec<(f64, usize)> = places
        .par_iter()
        .enumerate()
        .filter_map(|(index, place)| Some((score(problem, &probes, top, sides, *place)?, index)))
        .collect();
    scored.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut failure = None;
    for (_, index) in scored.into_iter().take(FINALISTS) {
        let pose = frame(top, places[index]);
        let placed: Vec<Pose> = path.iter().map(|local| pose * local).collect();
        match problem.solve(&subdivide(&placed, step)) {
            Ok(found) => {
                return Ok(Placement {
                    pose,
                    on_table: places[index],
                    least_distance_to_singularity: found.least_distance_to_singularity,
                });
            }
            Err(error) => failure = failure.or(Some(error)),
        }
    }
    Err(failure)
}

fn frame(top: &Pose, [x, y, turn]: [f64; 3]) -> Pose {
    let shift = Translation3::new(x, y, 0.0);
    top * Pose::from_parts(
        shift,
        UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn),
    )
}

/// Smallest distance to a singularity at the probes; `None` if a probe is not above the table, or
/// cannot be reached from the posture of the previous one.
fn score(
    problem: &PathProblem<'_>,
    probes: &[Pose],
    top: &Pose,
    sides: [f64; 2],
    place: [f64; 3],
) -> Option<f64> {
    let frame = frame(top, place);
    let on_table = top.inverse() * frame;
    let beside = probes.iter().any(|probe| {
        let at = (on_table * probe).translation;
        at.x.abs() > sides[0] / 2.0 || at.y.abs() > sides[1] / 2.0
    });
    if beside {
        return None;
    }
    let mut joints = problem.from.to_vec();
    let mut least = f64::INFINITY;
    for probe in probes {
        joints = problem.chain.follow(&(frame * probe), &joints)?;
        if !problem.is_free(&joints) {
            return None;
        }
        let (_, jacobian) = problem.chain.hand_and_jacobian(&joints);
        least = least.min(jacobian.smallest_singular_value());
    }
    Some(least)
}
