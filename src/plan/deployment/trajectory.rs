//! Poses of the gripper along a pattern (thesis Algorithm 9).

use super::{DeployedRod, DeploymentError};
use crate::learn::ModelError;
use crate::mechanics::{UnitQuaternion, Vector3, rotation};
use crate::plan::grasp::{Grasp, GraspMethod, GraspProblem, GraspSolver, NeuralGrasps};
use crate::plan::pattern::PatternPoint;
use std::f64::consts::FRAC_PI_2;

/// How the gripper leads the rod.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// By the optimal grasp of each point.
    Optimal,
    /// Upright above the contact node, lower by what has been laid (thesis 5.1.1, Fig. 5.2): the gripper goes along the
    /// pattern and, at the same pace, down.
    Intuitive,
}

/// Who finds the optimal grasps.
#[derive(Clone, Copy, Debug)]
pub enum OptimalGrasps<'a> {
    /// The equations of the suspended rod.
    Exact,
    /// A network; out of the range of its samples the equations.
    Neural(&'a NeuralGrasps),
}

/// Where the gripper is when the rod touches the table at an arc length of the pattern.
#[derive(Clone, Debug)]
pub struct GripperPose {
    /// Arc length of the contact node, m.
    pub s: f64,
    /// Place, m. The table is z = 0, and the lying rod's centreline a radius above it.
    pub position: Vector3,
    /// Orientation: its x axis is the tangent of the rod, towards the gripper; the frame of the rod that lies on the
    /// table, (t, ẑ × t, ẑ), goes over into it without twist.
    pub rotation: UnitQuaternion,
    /// The exact grasp, dimensionless; none for the intuitive scheme and for a network, which do not know it.
    pub grasp: Option<Grasp>,
}

/// The gripper's poses for the points of a pattern; quaternions go over into each other without a change of sign.
/// `grasps` says who finds the grasps of the optimal scheme.
///
/// # Errors
/// There is no grasp at some point.
pub fn trajectory(
    points: &[PatternPoint],
    rod: &DeployedRod,
    scheme: Scheme,
    grasps: OptimalGrasps<'_>,
) -> Result<Vec<GripperPose>, DeploymentError> {
    let found = match (scheme, grasps) {
        (Scheme::Intuitive, _) => points.iter().map(|point| intuitive(point, rod)).collect(),
        (Scheme::Optimal, OptimalGrasps::Exact) => {
            let mut solver = GraspSolver::new();
            let poses = points.iter().map(|point| optimal(point, rod, &mut solver));
            poses.collect::<Result<Vec<_>, _>>()?
        }
        (Scheme::Optimal, OptimalGrasps::Neural(network)) => learned(points, rod, network)?,
    };
    let mut poses: Vec<GripperPose> = Vec::with_capacity(points.len());
    for mut pose in found {
        if let Some(before) = poses.last()
            && before.rotation.coords.dot(&pose.rotation.coords) < 0.0
        {
            pose.rotation = UnitQuaternion::new_unchecked(-pose.rotation.into_inner());
        }
        poses.push(pose);
    }
    Ok(poses)
}

/// R_t = (t, ẑ × t, ẑ).
fn lying(point: &PatternPoint) -> UnitQuaternion {
    rotation::from_vector(point.angle * Vector3::z())
}

/// The centreline of the lying rod.
fn contact(point: &PatternPoint, rod: &DeployedRod) -> Vector3 {
    Vector3::new(point.position.x, point.position.y, rod.radius)
}

fn optimal(
    point: &PatternPoint,
    rod: &DeployedRod,
    solver: &mut GraspSolver,
) -> Result<GripperPose, DeploymentError> {
    let failed = |error| DeploymentError::Grasp {
        s_m: point.s,
        error,
    };
    let problem = problem(point, rod)?;
    let grasp = solver
        .solve(&problem, GraspMethod::Theory)
        .map_err(failed)?;
    Ok(GripperPose {
        grasp: Some(grasp.clone()),
        ..placed(point, rod, grasp.position, grasp.rotation)
    })
}

/// Poses by a network, all at once; points out of its range by the equations.
fn learned(
    points: &[PatternPoint],
    rod: &DeployedRod,
    network: &NeuralGrasps,
) -> Result<Vec<GripperPose>, DeploymentError> {
    let problems: Vec<GraspProblem> = points
        .iter()
        .map(|point| problem(point, rod))
        .collect::<Result<_, _>>()?;
    let found = network.predict(&problems);
    let found = found.map_err(|error: ModelError| DeploymentError::Network(error.to_string()))?;
    let mut solver = GraspSolver::new();
    let poses = points.iter().zip(found).map(|(point, grasp)| match grasp {
        Some(grasp) => Ok(placed(point, rod, grasp.position, grasp.rotation)),
        None => optimal(point, rod, &mut solver),
    });
    poses.collect()
}

/// The grasp that a point of the pattern asks for.
fn problem(point: &PatternPoint, rod: &DeployedRod) -> Result<GraspProblem, DeploymentError> {
    let unit = rod.gravito_bending_length;
    let problem = GraspProblem::new(
        (rod.length - point.s) / unit,
        point.curvature * unit,
        rod.stretch_stiffness(),
    );
    problem.map_err(|error| DeploymentError::Grasp {
        s_m: point.s,
        error,
    })
}

/// A dimensionless grasp, brought to a point of the pattern.
fn placed(
    point: &PatternPoint,
    rod: &DeployedRod,
    position: Vector3,
    rotation: UnitQuaternion,
) -> GripperPose {
    let lying = lying(point);
    GripperPose {
        s: point.s,
        position: contact(point, rod) + rod.gravito_bending_length * (lying * position),
        rotation: lying * rotation,
        grasp: None,
    }
}

fn intuitive(point: &PatternPoint, rod: &DeployedRod) -> GripperPose {
    let upright = rotation::from_vector(-FRAC_PI_2 * Vector3::y());
    GripperPose {
        s: point.s,
        position: contact(point, rod) + (rod.hanging_length() - point.s) * Vector3::z(),
        rotation: lying(point) * upright,
        grasp: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::pattern::{Circle, Line, Pattern, Point};

    const GREEN: DeployedRod = DeployedRod {
        gravito_bending_length: 0.032,
        radius: 0.0016,
        length: 0.885,
    };

    /// A wavy curve, moved by a motion of the plane, mirrored about x first where asked for.
    fn wave(turn: f64, shift: Point, mirror: f64) -> Vec<PatternPoint> {
        let turned = nalgebra::Rotation2::new(turn);
        let points: Vec<Point> = (0..=300)
            .map(|index| f64::from(index) / 300.0)
            .map(|t| Point::new(0.4 * t, 0.04 * (9.0 * t).sin()))
            .map(|point| turned * Point::new(point.x, mirror * point.y) + shift)
            .collect();
        Pattern::along(&points, 2e-4).unwrap().sampled(0.01)
    }

    /// The trajectory of the green rod by exact grasps.
    fn exact(points: &[PatternPoint], scheme: Scheme) -> Result<Vec<GripperPose>, DeploymentError> {
        trajectory(points, &GREEN, scheme, OptimalGrasps::Exact)
    }

    #[test]
    fn a_moved_pattern_moves_the_trajectory() {
        let (turn, shift) = (2.4, Point::new(0.3, -0.7));
        let turned = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn);
        for scheme in [Scheme::Optimal, Scheme::Intuitive] {
            let here = exact(&wave(0.0, Point::zeros(), 1.0), scheme).unwrap();
            let there = exact(&wave(turn, shift, 1.0), scheme).unwrap();
            assert_eq!(here.len(), there.len());
            for (here, there) in here.iter().zip(&there) {
                let expected = turned * here.position + Vector3::new(shift.x, shift.y, 0.0);
                assert!((there.position - expected).norm() < 1e-9, "{}", here.s);
                assert!(there.rotation.angle_to(&(turned * here.rotation)) < 1e-7);
            }
        }
    }

    #[test]
    fn a_mirrored_pattern_mirrors_the_trajectory() {
        for scheme in [Scheme::Optimal, Scheme::Intuitive] {
            let here = exact(&wave(0.0, Point::zeros(), 1.0), scheme).unwrap();
            let there = exact(&wave(0.0, Point::zeros(), -1.0), scheme).unwrap();
            for (here, there) in here.iter().zip(&there) {
                let expected = Vector3::new(here.position.x, -here.position.y, here.position.z);
                assert!((there.position - expected).norm() < 1e-9);
                let [w, i, j, k] = [
                    here.rotation.w,
                    here.rotation.i,
                    here.rotation.j,
                    here.rotation.k,
                ];
                let expected =
                    UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(w, -i, j, -k));
                assert!(there.rotation.angle_to(&expected) < 1e-7);
            }
        }
    }

    #[test]
    fn along_a_line_the_gripper_keeps_its_distance_until_the_rod_is_short() {
        let line = Pattern::new(Box::new(Line { length: 0.5 }), 0.0).unwrap();
        let poses = exact(&line.sampled(0.005), Scheme::Optimal).unwrap();
        assert_eq!(poses.len(), 101);
        for pose in &poses {
            let ahead = pose.position.x - pose.s;
            assert!((ahead / 0.032 - 2.566).abs() < 2e-3, "{pose:?}");
            assert!(pose.position.y.abs() < 1e-12);
            // Upright, but for the last few gravito-bending lengths.
            let tangent = pose.rotation * Vector3::x();
            assert!(tangent.z > 0.99999);
        }
    }

    #[test]
    fn rotations_do_not_jump_on_a_circle() {
        let circle = Pattern::new(Box::new(Circle { radius: 0.09 }), 0.0).unwrap();
        let points = circle.with_lead_in(0.1).sampled(0.004);
        for scheme in [Scheme::Optimal, Scheme::Intuitive] {
            let poses = exact(&points, scheme).unwrap();
            for pair in poses.windows(2) {
                assert!(pair[0].rotation.coords.dot(&pair[1].rotation.coords) > 0.99);
                assert!((pair[0].position - pair[1].position).norm() < 0.02);
            }
        }
    }

    #[test]
    fn a_rod_that_is_too_short_has_no_grasp_there() {
        let line = Pattern::new(Box::new(Line { length: 0.9 }), 0.0).unwrap();
        let found = exact(&line.sampled(0.05), Scheme::Optimal);
        assert!(matches!(found, Err(DeploymentError::Grasp { s_m, .. }) if s_m > 0.85));
    }
}
