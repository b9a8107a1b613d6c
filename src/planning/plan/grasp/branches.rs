//! All grasps that are found: planar rods by shooting, continued to the requested curvature and
//! length.

use super::continuation::{settled, walk};
use super::mesh::first_mesh;
use super::shape::{March, Shape};
use super::{GraspProblem, Vector3};
use rodlab_engine::mechanics::kirchhoff::elastica::{Elastica, Forces};
use rodlab_engine::mechanics::kirchhoff::numerics::bisect;

/// Searched range of forces n_z(0).
const FORCES: [f64; 2] = [-12.0, 4.0];
/// Steps between them.
const FORCE_STEPS: usize = 6400;
/// Suspended length up to which shooting separates solutions; longer rods are continued from it.
const SHOOTING_LENGTH: f64 = 8.0;
/// Number of intervals of the initial guess.
const PARTS: usize = 2000;
/// Largest difference of forces that belong to one solution.
const SAME: f64 = 1e-6;

/// The solutions except the gentle one, which has the force `gentle`.
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

/// The planar inextensible rod without a force along the lying part.
fn elastica(force: f64) -> Elastica {
    Elastica::heavy(Forces {
        horizontal: 0.0,
        vertical: force,
    })
}

/// n_z(0) of the planar inextensible rods without a moment at the gripper.
fn planar_forces(length: f64) -> Vec<f64> {
    let end_moment = |force: f64| elastica(force).place(length).state.curvature;
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
    let length = problem.suspended_length;
    let path = elastica(force).places(length, PARTS);
    let shape = Shape::guess(*problem, &first_mesh(problem), [0.0, force], |s| {
        let nearest = (s / length * PARTS as f64).round() as usize;
        let state = path[nearest.min(PARTS)].state;
        (
            Vector3::new(libm::cos(state.angle), 0.0, libm::sin(state.angle)),
            -state.curvature * Vector3::y(),
        )
    });
    let shape = settled(shape, march)?;
    ((shape.force[1] - force).abs() < 0.05).then_some(shape)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference;

    #[test]
    fn planar_rods_agree_with_the_reference() {
        let rows = reference::rows("grasp/planar_branches.csv");
        let mut lengths: Vec<(f64, Vec<f64>)> = Vec::new();
        assert!(rows.is_empty() || rows.len() > 40);
        for row in rows {
            if lengths.last().is_none_or(|(length, _)| *length != row[0]) {
                lengths.push((row[0], planar_forces(row[0])));
            }
            let forces = &lengths.last().unwrap().1;
            assert!(
                forces.iter().any(|force| (force - row[1]).abs() < 2e-6),
                "{row:?}: {forces:?}"
            );
        }
    }
}
