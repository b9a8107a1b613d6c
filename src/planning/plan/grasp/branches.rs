//! All grasps that are found: planar rods by shooting, led to the curvature and length that are asked for.

use super::continuation::{settled, walk};
use super::mesh::first_mesh;
use super::shape::{March, Shape};
use super::{GraspProblem, Vector3, WEIGHT};
use rodlab_engine::mechanics::kirchhoff::numerics::{bisect, runge_kutta};

/// Forces n_z(0) that are looked through.
const FORCES: [f64; 2] = [-12.0, 4.0];
/// Steps between them.
const FORCE_STEPS: usize = 6400;
/// Suspended length up to which shooting tells solutions apart; longer rods start from this one.
const SHOOTING_LENGTH: f64 = 8.0;
/// Steps of the shooting, per unit of √|n| s.
const STEPS_PER_LENGTH: f64 = 40.0;
/// Forces nearer than this belong to one solution.
const SAME: f64 = 1e-6;

/// The solutions that are found beside the gentle one, which has the force `gentle`.
pub fn others(problem: &GraspProblem, gentle: [f64; 2], march: &mut March) -> Vec<Shape> {
    let mut found: Vec<Shape> = Vec::new();
    let flat = GraspProblem {
        suspended_length: problem.suspended_length.min(SHOOTING_LENGTH),
        curvature: 0.0,
        stretch_compliance: 0.0,
    };
    let short = GraspProblem {
        suspended_length: flat.suspended_length,
        ..*problem
    };
    for force in planar_forces(flat.suspended_length) {
        let Some(start) = planar(&flat, force, march) else {
            continue;
        };
        let there = walk(start, &short, march).and_then(|bent| walk(bent, problem, march));
        let Some(shape) = there else { continue };
        let mut forces = found.iter().map(|other| other.force).chain([gentle]);
        let is_known =
            forces.any(|[y, z]| libm::hypot(y - shape.force[0], z - shape.force[1]) < SAME);
        if !is_known {
            found.push(shape);
        }
    }
    found
}

/// θ'' = −(n_z(0) + s/2) cos θ, θ(0) = θ'(0) = 0: θ and θ' at the steps.
fn shoot(length: f64, force: f64) -> Vec<[f64; 2]> {
    let rate = force.abs().max((force + WEIGHT * length).abs()).max(1.0);
    let steps = (STEPS_PER_LENGTH * length * rate.sqrt()).ceil().max(50.0) as usize;
    runge_kutta(0.0, length, [0.0, 0.0], steps, |s, state| {
        [state[1], -(force + WEIGHT * s) * libm::cos(state[0])]
    })
}

/// n_z(0) of the planar inextensible rods without a moment at the gripper.
fn planar_forces(length: f64) -> Vec<f64> {
    let end_moment = |force: f64| shoot(length, force).last().map_or(0.0, |end| end[1]);
    let [first, last] = FORCES;
    let at = |step: usize| first + (last - first) * step as f64 / FORCE_STEPS as f64;
    let mut found = Vec::new();
    let mut before = end_moment(at(0));
    for step in 1..=FORCE_STEPS {
        let here = end_moment(at(step));
        if before * here < 0.0 {
            found.push(bisect(at(step - 1), at(step), end_moment));
        }
        before = here;
    }
    found
}

fn planar(problem: &GraspProblem, force: f64, march: &mut March) -> Option<Shape> {
    let path = shoot(problem.suspended_length, force);
    let scale = (path.len() - 1) as f64 / problem.suspended_length;
    let shape = Shape::guess(*problem, &first_mesh(problem), [0.0, force], |s| {
        let place = (s * scale).clamp(0.0, (path.len() - 1) as f64);
        let index = (place as usize).min(path.len() - 2);
        let part = place - index as f64;
        let [angle, rate] =
            std::array::from_fn(|i| path[index][i] + part * (path[index + 1][i] - path[index][i]));
        (
            Vector3::new(libm::cos(angle), 0.0, libm::sin(angle)),
            -rate * Vector3::y(),
        )
    });
    let shape = settled(shape, march)?;
    ((shape.force[1] - force).abs() < 0.05).then_some(shape)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planar_rods_agree_with_the_reference() {
        let file = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../..",
            "/../shared/reference/grasp/planar_branches.csv"
        );
        let Ok(text) = std::fs::read_to_string(file) else {
            println!("skipped: planar_branches.csv is not here");
            return;
        };
        let mut lengths: Vec<(f64, Vec<f64>)> = Vec::new();
        let mut count = 0;
        for line in text.lines().skip(1) {
            let row: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
            if lengths.last().is_none_or(|(length, _)| *length != row[0]) {
                lengths.push((row[0], planar_forces(row[0])));
            }
            let forces = &lengths.last().unwrap().1;
            assert!(
                forces.iter().any(|force| (force - row[1]).abs() < 2e-6),
                "{row:?}: {forces:?}"
            );
            count += 1;
        }
        assert!(count > 40);
    }
}
