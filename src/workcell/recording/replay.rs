//! The measured motion in a log: all arms over time, and how far they were from their plans.

use super::RecordingError;
use super::source::{Joints, MotionLog, motions};
use crate::cell::Cell;
use nalgebra::Vector3;
use rodlab_robot::{Column, JointKind, JointTrajectory};
use serde::Serialize;
use std::path::Path;

/// Largest number of points of a path of a hand.
const MOST_POINTS: usize = 2000;

/// Positions of a hand along its path, m.
pub type HandPath = Vec<[f64; 3]>;

/// The motions of a log, as the joints reported them.
pub struct Replay {
    /// Reported positions of all joints, from the first report on; joints without reports are at
    /// home.
    pub measured: JointTrajectory,
    /// Planned paths of the hands, m: the motion and its path, one for each arm.
    pub planned: Vec<(String, HandPath)>,
    /// The motions in the order of their begin.
    pub motions: Vec<ReplayedMotion>,
}

/// A motion of a log.
#[derive(Clone, Debug, Serialize)]
pub struct ReplayedMotion {
    /// Its folder below the directory; empty for the log of `rodlab stream`.
    pub name: String,
    /// Time of its first report after the first report of the log, s.
    pub begin_s: f64,
    /// Time from its first to its last report, s.
    pub duration_s: f64,
    /// Largest distance of a joint that turns from its commanded position at the same time, rad;
    /// it contains the delay of the controller.
    pub joints_off_rad: f64,
    /// The same for joints that slide, m.
    pub slides_off_m: f64,
    /// Largest distance of a hand from its planned path, m.
    pub hand_off_m: f64,
    /// The last event.
    pub ending: String,
}

/// Reads the log in a directory, of arms in a cell.
///
/// # Errors
/// The directory has no log, a table is damaged, or no joint of the log is in the cell.
pub fn replay(directory: &Path, cell: &Cell) -> Result<Replay, RecordingError> {
    let logs = motions(directory)?;
    if logs.is_empty() {
        return Err(RecordingError::NoLog(directory.to_owned()));
    }
    let columns: Vec<Column> = cell.arms.iter().flat_map(|arm| arm.columns()).collect();
    let mut posture: Vec<f64> = cell.arms.iter().flat_map(|arm| arm.home.clone()).collect();
    let reports = logs.iter().map(|log| log.joints("state.csv"));
    let reports = reports.collect::<Result<Vec<_>, _>>()?;
    let is_known = |joints: &&Joints| !places(&columns, joints).is_empty();
    let first = reports.iter().flatten().find(is_known);
    let origin = first.ok_or_else(|| RecordingError::NoArm {
        directory: directory.to_owned(),
        cell: cell.title.clone(),
    })?;
    let origin = origin.time;
    let mut replay = Replay {
        measured: JointTrajectory {
            columns: columns.clone(),
            times: Vec::new(),
            points: Vec::new(),
        },
        planned: Vec::new(),
        motions: Vec::new(),
    };
    for (log, reports) in logs.iter().zip(&reports) {
        let measured = &mut replay.measured;
        let begin = measured.times.len();
        // The clock of a simulated robot may be faster than that of this machine.
        let overlap = measured.times.last().zip(reports.first());
        let delay = overlap.map_or(0.0, |(last, next)| (last - (next.time - origin)).max(0.0));
        for joints in reports {
            for (column, joint) in places(&columns, joints) {
                posture[column] = joints.positions[joint];
            }
            let time = joints.time - origin + delay;
            match measured.times.last() {
                // Reports of several arms at one time.
                Some(last) if *last >= time => {
                    let index = measured.points.len() - 1;
                    measured.points[index].clone_from(&posture);
                }
                _ => {
                    measured.times.push(time);
                    measured.points.push(posture.clone());
                }
            }
        }
        let moved = begin..measured.times.len();
        let (motion, planned) = compared(log, reports, cell, &replay.measured, moved)?;
        let named = |path| (motion.name.clone(), path);
        replay.planned.extend(planned.into_iter().map(named));
        replay.motions.push(motion);
    }
    Ok(replay)
}

/// Pairs of a column and the joint of a report that it shows.
fn places(columns: &[Column], joints: &Joints) -> Vec<(usize, usize)> {
    let columns = columns.iter().enumerate();
    let of = |column: &Column| {
        let mut names = joints.names.iter();
        let joint = names.position(|name| column.joint.as_ref() == Some(name));
        joint.filter(|_| column.part == joints.part)
    };
    columns
        .filter_map(|(index, column)| Some((index, of(column)?)))
        .collect()
}

/// Compares a motion with its plan. `moved` are its rows in `measured`.
fn compared(
    log: &MotionLog,
    reports: &[Joints],
    cell: &Cell,
    measured: &JointTrajectory,
    moved: std::ops::Range<usize>,
) -> Result<(ReplayedMotion, Vec<HandPath>), RecordingError> {
    let commanded = log.joints("commanded.csv")?;
    let mut off = [0.0_f64; 2];
    for arm in &cell.arms {
        let of_arm = |all: &'_ [Joints]| -> Vec<usize> {
            let rows = all.iter().enumerate();
            rows.filter(|(_, row)| row.part == arm.name)
                .map(|(index, _)| index)
                .collect()
        };
        let (due, seen) = (of_arm(&commanded), of_arm(reports));
        for (row, joint) in seen
            .iter()
            .flat_map(|row| (0..arm.home.len()).map(move |joint| (&reports[*row], joint)))
        {
            let wanted = between(&commanded, &due, row.time, joint);
            let kind = arm.chain.joints[joint].kind;
            if let (Some(wanted), Some(at)) = (wanted, row.positions.get(joint)) {
                let off = &mut off[usize::from(kind == JointKind::Prismatic)];
                *off = off.max((at - wanted).abs());
            }
        }
    }
    let plan = log.plan().map(|plan| cell.hand_paths(&plan, MOST_POINTS));
    let planned = plan.unwrap_or_default();
    let moving: Vec<usize> = (0..cell.arms.len())
        .filter(|arm| commanded.iter().any(|row| row.part == cell.arms[*arm].name))
        .collect();
    let mut hand_off = 0.0_f64;
    for (arm, path) in moving.iter().zip(&planned) {
        let path: Vec<_> = path.iter().map(|point| Vector3::from(*point)).collect();
        for row in moved.clone() {
            let hand = cell.hand_at(measured, row, *arm);
            hand_off = hand_off.max(distance(&hand, &path));
        }
    }
    let times = &measured.times[moved];
    let begin = times.first().copied().unwrap_or_default();
    let motion = ReplayedMotion {
        name: log.name.clone(),
        begin_s: begin,
        duration_s: times.last().map_or(0.0, |last| last - begin),
        joints_off_rad: off[0],
        slides_off_m: off[1],
        hand_off_m: hand_off,
        ending: log
            .events()
            .last()
            .map_or("", |(_, event)| event)
            .to_owned(),
    };
    Ok((motion, planned))
}

/// Commanded position of a joint at a time, linear between rows; `None` before and after them.
fn between(rows: &[Joints], of: &[usize], time: f64, joint: usize) -> Option<f64> {
    let after = of.partition_point(|row| rows[*row].time <= time);
    let [a, b] = [&rows[of[after.checked_sub(1)?]], &rows[*of.get(after)?]];
    let part = (time - a.time) / (b.time - a.time);
    let ends = [a, b].map(|row| row.positions.get(joint).copied());
    Some(ends[0]? + part * (ends[1]? - ends[0]?))
}

/// Distance of a point from a polyline, m.
fn distance(point: &Vector3<f64>, line: &[Vector3<f64>]) -> f64 {
    let to_segment = |pair: &[Vector3<f64>]| {
        let along = pair[1] - pair[0];
        let length = along.norm_squared();
        let part = match length > 0.0 {
            true => ((point - pair[0]).dot(&along) / length).clamp(0.0, 1.0),
            false => 0.0,
        };
        (point - pair[0] - part * along).norm()
    };
    line.windows(2)
        .map(to_segment)
        .fold(f64::INFINITY, f64::min)
}
