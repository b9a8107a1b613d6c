//! Poses of the gripper along a pattern (thesis Algorithm 9).

use super::{DeployedRod, DeploymentError};
use crate::learn::ModelError;
use crate::plan::grasp::{
    Grasp, GraspMethod, GraspProblem, GraspSolver, LearnedGrasp, NeuralGrasps, contact_demand,
    force_of_pose,
};
use crate::plan::pattern::PatternPoint;
use rodlab_engine::mechanics::{UnitQuaternion, Vector3, rotation};
use serde::Serialize;
use std::f64::consts::FRAC_PI_2;

/// Scheme of the gripper.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scheme {
    /// The optimal grasp of each point.
    Optimal,
    /// Upright above the contact node, at a height that decreases by the laid length (thesis
    /// 5.1.1, Fig. 5.2): the gripper moves along the pattern and, at the same rate, down.
    Intuitive,
}

/// Interval of the network outputs that are compared with the equations. Those between are
/// compared with interpolated grasps.
const CHECKED: usize = 8;
/// Allowed error of an output, L_gb and rad: three times the largest error of the built-in
/// network.
const TOLERANCES: [f64; 2] = [0.05, 0.02];

/// Solver for the optimal grasps.
#[derive(Clone, Copy, Debug)]
pub enum OptimalGrasps<'a> {
    /// The equations of the suspended rod.
    Exact,
    /// A network whose outputs are checked. The equations replace it outside the range of its
    /// samples, and where an output is wrong.
    Neural(&'a NeuralGrasps),
}

/// Poses of the gripper along a pattern.
#[derive(Clone, Debug)]
pub struct Trajectory {
    /// The poses.
    pub poses: Vec<GripperPose>,
    /// Number of replaced outputs of a network that differ from the equations.
    pub rejected: usize,
}

/// Pose of the gripper when the rod touches the table at an arc length of the pattern.
#[derive(Clone, Debug)]
pub struct GripperPose {
    /// Arc length of the contact node, m.
    pub s: f64,
    /// Position, m. The table is z = 0; the lying rod's centreline is a radius above it.
    pub position: Vector3,
    /// Orientation: the frame of the lying rod, (t, ẑ × t, ẑ), carried along the rod without twist.
    /// The x axis is the tangent of the rod, towards the gripper.
    pub rotation: UnitQuaternion,
    /// The exact grasp, dimensionless; `None` for the intuitive scheme and for a network.
    pub grasp: Option<Grasp>,
    /// Friction demand at the contact node; `None` without a grasp.
    pub contact_demand: Option<f64>,
}

impl GripperPose {
    /// A pose without a grasp.
    pub fn new(s: f64, position: Vector3, rotation: UnitQuaternion) -> Self {
        Self {
            s,
            position,
            rotation,
            grasp: None,
            contact_demand: None,
        }
    }

    /// Whether all its numbers are finite.
    pub fn is_finite(&self) -> bool {
        let position = self.position.iter();
        let mut numbers = position.chain(self.rotation.coords.iter()).chain([&self.s]);
        numbers.all(|number| number.is_finite())
    }
}

/// The gripper's poses for the points of a pattern; the signs of quaternions are continuous.
///
/// # Errors
/// There is no grasp at some point.
pub fn trajectory(
    points: &[PatternPoint],
    rod: &DeployedRod,
    scheme: Scheme,
    grasps: OptimalGrasps<'_>,
) -> Result<Vec<GripperPose>, DeploymentError> {
    checked_trajectory(points, rod, scheme, grasps).map(|trajectory| trajectory.poses)
}

/// Computes [`trajectory`] and returns also the number of replaced outputs of a network, which is
/// logged as a warning.
///
/// # Errors
/// There is no grasp at some point.
pub fn checked_trajectory(
    points: &[PatternPoint],
    rod: &DeployedRod,
    scheme: Scheme,
    grasps: OptimalGrasps<'_>,
) -> Result<Trajectory, DeploymentError> {
    let (found, rejected) = match (scheme, grasps) {
        (Scheme::Intuitive, _) => (
            points.iter().map(|point| intuitive(point, rod)).collect(),
            0,
        ),
        (Scheme::Optimal, OptimalGrasps::Exact) => {
            let mut solver = GraspSolver::new();
            let poses = points.iter().map(|point| optimal(point, rod, &mut solver));
            (poses.collect::<Result<Vec<_>, _>>()?, 0)
        }
        (Scheme::Optimal, OptimalGrasps::Neural(network)) => learned(points, rod, network)?,
    };
    if rejected > 0 {
        let [position, angle] = TOLERANCES;
        tracing::warn!(
            "{rejected} of {} outputs of the network were wrong by more than {position} L_gb or {:.1}° \
             and were replaced by exact grasps",
            points.len(),
            angle.to_degrees()
        );
    }
    Ok(Trajectory {
        poses: continuous(found)?,
        rejected,
    })
}

/// Poses by a network without checks. Points outside its range use the equations.
///
/// # Errors
/// There is no grasp at some point, or an output of the network is not finite.
pub fn network_trajectory(
    points: &[PatternPoint],
    rod: &DeployedRod,
    network: &NeuralGrasps,
) -> Result<Vec<GripperPose>, DeploymentError> {
    let mut solver = GraspSolver::new();
    let answers = predictions(points, rod, network)?;
    let poses = points
        .iter()
        .zip(answers)
        .map(|(point, (problem, answer))| match answer {
            Some(answer) => Ok(placed_answer(point, rod, &problem, &answer)),
            None => optimal(point, rod, &mut solver),
        });
    continuous(poses.collect::<Result<_, _>>()?)
}

/// The poses after checking that they are finite, with quaternions of consistent sign.
fn continuous(found: Vec<GripperPose>) -> Result<Vec<GripperPose>, DeploymentError> {
    let mut poses: Vec<GripperPose> = Vec::with_capacity(found.len());
    for mut pose in found {
        if !pose.is_finite() {
            return Err(DeploymentError::NotFinite { s_m: pose.s });
        }
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
    let problem = problem(point, rod)?;
    let grasp = exact(point, &problem, solver)?;
    Ok(placed_grasp(point, rod, grasp))
}

fn exact(
    point: &PatternPoint,
    problem: &GraspProblem,
    solver: &mut GraspSolver,
) -> Result<Grasp, DeploymentError> {
    let found = solver.solve(problem, GraspMethod::Theory);
    found.map_err(|error| DeploymentError::Grasp {
        s_m: point.s,
        error,
    })
}

/// The exact grasp at a point of the pattern.
fn placed_grasp(point: &PatternPoint, rod: &DeployedRod, grasp: Grasp) -> GripperPose {
    let force = [-grasp.contact_force.y, -grasp.contact_force.z];
    GripperPose {
        contact_demand: Some(contact_demand(force, curvature_slope(point, rod))),
        grasp: Some(grasp.clone()),
        ..placed(point, rod, grasp.position, grasp.rotation)
    }
}

/// An output of a network at a point of the pattern.
fn placed_answer(
    point: &PatternPoint,
    rod: &DeployedRod,
    problem: &GraspProblem,
    answer: &LearnedGrasp,
) -> GripperPose {
    let force = force_of_pose(problem, answer.position, &answer.rotation);
    GripperPose {
        contact_demand: force.map(|force| contact_demand(force, curvature_slope(point, rod))),
        ..placed(point, rod, answer.position, answer.rotation)
    }
}

/// κ̄' = κ' L_gb².
fn curvature_slope(point: &PatternPoint, rod: &DeployedRod) -> f64 {
    point.curvature_slope * rod.gravito_bending_length.powi(2)
}

/// Outputs of a network at all points; `None` outside its range.
fn predictions(
    points: &[PatternPoint],
    rod: &DeployedRod,
    network: &NeuralGrasps,
) -> Result<Vec<(GraspProblem, Option<LearnedGrasp>)>, DeploymentError> {
    let problems: Vec<GraspProblem> = points
        .iter()
        .map(|point| problem(point, rod))
        .collect::<Result<_, _>>()?;
    let found = network.predict(&problems);
    let found = found.map_err(|error: ModelError| DeploymentError::Network(error.to_string()))?;
    Ok(problems.into_iter().zip(found).collect())
}

/// Poses by a network with checked outputs, and the number of replaced outputs.
///
/// Every eighth output is compared with the exact grasp. The others are compared with the
/// interpolation of the exact grasps on either side. If they differ, for example because the
/// curvature changes, the equations are solved for that point as well. An output with an error
/// beyond the tolerances is replaced by the exact grasp.
fn learned(
    points: &[PatternPoint],
    rod: &DeployedRod,
    network: &NeuralGrasps,
) -> Result<(Vec<GripperPose>, usize), DeploymentError> {
    let answers = predictions(points, rod, network)?;
    let mut solver = GraspSolver::new();
    let last = points.len().saturating_sub(1);
    let is_known = |index: usize| index.is_multiple_of(CHECKED) || index == last;
    let mut grasps = Vec::with_capacity(points.len());
    for (index, (point, (problem, answer))) in points.iter().zip(&answers).enumerate() {
        let is_solved = answer.is_none() || is_known(index);
        let grasp = is_solved.then(|| exact(point, problem, &mut solver));
        grasps.push(grasp.transpose()?);
    }
    let mut poses = Vec::with_capacity(points.len());
    let mut rejected = 0;
    for (index, (point, (problem, answer))) in points.iter().zip(&answers).enumerate() {
        let grasp = match (&grasps[index], answer) {
            (Some(grasp), _) => grasp.clone(),
            (None, Some(answer))
                if between(&grasps, points, index).is_some_and(|known| is_near(answer, &known)) =>
            {
                poses.push(placed_answer(point, rod, problem, answer));
                continue;
            }
            (None, _) => exact(point, problem, &mut solver)?,
        };
        poses.push(match answer {
            Some(answer) if is_near(answer, &learned_of(&grasp)) => {
                placed_answer(point, rod, problem, answer)
            }
            _ => {
                rejected += usize::from(answer.is_some());
                placed_grasp(point, rod, grasp)
            }
        });
    }
    Ok((poses, rejected))
}

fn learned_of(grasp: &Grasp) -> LearnedGrasp {
    LearnedGrasp {
        position: grasp.position,
        rotation: grasp.rotation,
    }
}

/// Whether an output equals a reference within the tolerances; false for numbers that are not
/// finite.
fn is_near(answer: &LearnedGrasp, known: &LearnedGrasp) -> bool {
    let [farthest, most] = TOLERANCES;
    (answer.position - known.position).norm() <= farthest
        && answer.rotation.angle_to(&known.rotation) <= most
}

/// Interpolates by arc length between the exact grasps on either side of a point.
fn between(
    grasps: &[Option<Grasp>],
    points: &[PatternPoint],
    index: usize,
) -> Option<LearnedGrasp> {
    let before = (0..index).rev().find(|known| grasps[*known].is_some())?;
    let after = (index + 1..grasps.len()).find(|known| grasps[*known].is_some())?;
    let [one, other] = [before, after].map(|known| grasps[known].as_ref());
    let (one, other) = (one?, other?);
    let part = (points[index].s - points[before].s) / (points[after].s - points[before].s);
    // A quaternion and its negative are the same rotation.
    let sign = one.rotation.coords.dot(&other.rotation.coords).signum();
    let end = UnitQuaternion::new_unchecked(sign * other.rotation.into_inner());
    Some(LearnedGrasp {
        position: one.position.lerp(&other.position, part),
        rotation: one.rotation.nlerp(&end, part),
    })
}

/// The grasp for a point of the pattern.
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

/// A dimensionless grasp at a point of the pattern.
fn placed(
    point: &PatternPoint,
    rod: &DeployedRod,
    position: Vector3,
    rotation: UnitQuaternion,
) -> GripperPose {
    let lying = lying(point);
    let position = contact(point, rod) + rod.gravito_bending_length * (lying * position);
    GripperPose::new(point.s, position, lying * rotation)
}

fn intuitive(point: &PatternPoint, rod: &DeployedRod) -> GripperPose {
    let upright = rotation::from_vector(-FRAC_PI_2 * Vector3::y());
    let position = contact(point, rod) + (rod.hanging_length() - point.s) * Vector3::z();
    GripperPose::new(point.s, position, lying(point) * upright)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::pattern::{Circle, Line, Pattern, Point};

    const GREEN: DeployedRod = DeployedRod::GREEN;

    /// A wavy curve, moved in the plane; mirrored about x first if requested.
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
            // Upright, except over the last few gravito-bending lengths.
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

    /// The network of the program with its last bias moved by some standard deviations.
    fn damaged(by: f32) -> NeuralGrasps {
        let bytes = include_bytes!("../../../../results/models/grasps.safetensors");
        let path = std::path::Path::new("damaged");
        let model = crate::learn::Model::from_bytes(path, bytes, NeuralGrasps::SAMPLES).unwrap();
        let layers: Vec<_> = model.network().tensors();
        let mut layers: Vec<_> = layers
            .into_iter()
            .map(|[weight, bias]| [weight.clone(), bias.clone()])
            .collect();
        let last = layers.last_mut().unwrap();
        last[1] = last[1].affine(1.0, f64::from(by)).unwrap();
        let network = crate::learn::Network::from_tensors(layers).unwrap();
        NeuralGrasps::of(path, crate::learn::Model::new(model.about.clone(), network)).unwrap()
    }

    #[test]
    fn wrong_outputs_of_a_network_are_replaced_by_exact_grasps() {
        let circle = Pattern::new(Box::new(Circle { radius: 0.09 }), 0.0).unwrap();
        let points = circle.with_lead_in(0.2).sampled(0.003);
        let planned = |network: &NeuralGrasps| {
            let grasps = OptimalGrasps::Neural(network);
            checked_trajectory(&points, &GREEN, Scheme::Optimal, grasps).unwrap()
        };
        let exact = exact(&points, Scheme::Optimal).unwrap();
        let off = |poses: &[GripperPose]| {
            let pairs = poses.iter().zip(&exact);
            pairs.fold([0.0; 2], |[far, turned]: [f64; 2], (pose, exact)| {
                let distance = (pose.position - exact.position).norm() / 0.032;
                [
                    far.max(distance),
                    turned.max(pose.rotation.angle_to(&exact.rotation)),
                ]
            })
        };
        let built_in = planned(NeuralGrasps::built_in());
        assert_eq!(built_in.rejected, 0);
        let by_network =
            |poses: &[GripperPose]| poses.iter().filter(|pose| pose.grasp.is_none()).count();
        assert!(by_network(&built_in.poses) > points.len() / 2);
        // Slightly wrong, far off, and so far off that its numbers overflow.
        for by in [0.1, 30.0, 3e38] {
            let network = damaged(by);
            let trajectory = planned(&network);
            assert!(
                trajectory.rejected > points.len() / 2,
                "{by}: {}",
                trajectory.rejected
            );
            assert!(trajectory.poses.iter().all(GripperPose::is_finite));
            let [far, turned] = off(&trajectory.poses);
            // The interpolation between exact grasps also has an error.
            assert!(
                far < 2.0 * TOLERANCES[0] && turned < 2.0 * TOLERANCES[1],
                "{by}: {far} {turned}"
            );
        }
        let unchecked = network_trajectory(&points, &GREEN, &damaged(30.0)).unwrap();
        assert!(off(&unchecked)[0] > 1.0);
        let overflown = network_trajectory(&points, &GREEN, &damaged(3e38));
        assert!(overflown.is_err() || off(&overflown.unwrap())[0] > 1e6);
    }

    #[test]
    fn a_rod_that_is_too_short_has_no_grasp_there() {
        let line = Pattern::new(Box::new(Line { length: 0.9 }), 0.0).unwrap();
        let found = exact(&line.sampled(0.05), Scheme::Optimal);
        assert!(matches!(found, Err(DeploymentError::Grasp { s_m, .. }) if s_m > 0.85));
    }
}
