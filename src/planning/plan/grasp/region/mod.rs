//! Allowed positions of a gripper above a straight line (thesis 5.3.2, Algorithm 6).
//!
//! The thesis does not state the conditions at the two ends. The solver of the thesis gets only the
//! position of the gripper, and Eq. 5.3 requires zero bending there. Here, therefore, the contact
//! node is clamped level on the table, and the gripper holds a position and turns freely. Each
//! position has its force (F_x, F_z) on the contact node, its moment M(0) and its direction α. The
//! constraints of Eq. 5.6, a rod above the table and F_z ≥ 0, bound a region M of positions. Along
//! a ray from the contact node they hold between two distances. Beyond the outer one the rod is
//! stretched and pulls upwards (region I of Fig. 5.4b). Within the inner one it touches the table
//! (region III), somewhere along its length or, if M(0) < 0, at the contact node itself. Rods are
//! continued inwards from stretched ones, so folded rods at the same positions are not included.
//!
//! The lying part carries no moment: on a straight pattern the rod has κ̄ = M(0) = 0. Such grasps
//! form a curve. The curve is the inner boundary where that has M(0) = 0, and continues beyond it.
//! The grasps of Eq. 5.3 are the points of this curve with F_x = 0.

mod chebyshev;
mod planar_rod;
mod ray;

use super::sideways::largest_sideways;
use super::stability::{TWIST_STIFFNESS, negative_modes};
use super::{GraspError, GraspProblem};
use planar_rod::PlanarRod;
use ray::{JUMP, Ray};

/// Direction of the first ray, rad, and steps of F_z, for the grasps without a contact moment.
const FREE_START: f64 = 1.3;
const FORCE_STEP: f64 = 0.05;

/// A position of the gripper in the plane of a straight pattern, EI = L_gb = 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarGrasp {
    /// x and z of the gripper.
    pub gripper: [f64; 2],
    /// α, the direction of the rod at the gripper above the table, rad.
    pub angle: f64,
    /// F_x and F_z of the lying part on the suspended one.
    pub contact_force: [f64; 2],
    /// M(0) of the clamped contact node; zero for a lying rod.
    pub contact_moment: f64,
    /// Lowest height away from the contact node.
    pub lowest: f64,
}

/// A grasp whose lying part carries no moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeGrasp {
    /// The grasp.
    pub grasp: PlanarGrasp,
    /// Response of the grasp to a push.
    pub answer: SidewaysAnswer,
}

/// Constraint that is violated at the end of the grasps along a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GraspBound {
    /// The contact node would have to be held down: F_z < 0.
    Pull,
    /// The contact node would have to hold the rod off the table: M(0) < 0.
    Moment,
    /// The rod touches the table elsewhere.
    Table,
}

/// Grasps between two distances along a ray from the contact node.
#[derive(Clone, Debug)]
pub struct GraspStretch {
    /// Direction above the table, rad.
    pub direction: f64,
    /// The farthest and the nearest grasp.
    pub ends: [PlanarGrasp; 2],
    /// The constraint at each of the two ends.
    pub bounds: [GraspBound; 2],
    compliance: f64,
    rods: [(f64, PlanarRod); 2],
}

/// Response of a planar grasp to a push out of the plane, with both ends held.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SidewaysAnswer {
    /// Number of unstable modes without a push.
    pub unstable_modes: usize,
    /// Ratio of the largest sideways displacement of the rod to a small one of the gripper: at
    /// least 1.
    pub largest_over_push: f64,
}

/// The region of grasps of a straight pattern along rays (rad above the table, 0 to π), each from
/// the outside in.
///
/// # Errors
/// The length or the stiffness is out of range.
pub fn grasp_region(
    suspended_length: f64,
    stretch_stiffness: f64,
    directions: &[f64],
) -> Result<Vec<GraspStretch>, GraspError> {
    let problem = GraspProblem::new(suspended_length, 0.0, stretch_stiffness)?;
    let of = |&direction: &f64| {
        let ray = Ray::new(&problem, direction);
        let rod = ray.stretched();
        rod.map_or(Vec::new(), |rod| ray.stretches(rod))
    };
    Ok(directions.iter().flat_map(of).collect())
}

/// The grasps without a moment in the lying part, in ascending order of `contact_forces` F_z, from
/// the inner boundary of the region as far as they are found.
///
/// # Errors
/// The length or the stiffness is out of range.
pub fn free_grasps(
    suspended_length: f64,
    stretch_stiffness: f64,
    contact_forces: &[f64],
) -> Result<Vec<FreeGrasp>, GraspError> {
    let problem = GraspProblem::new(suspended_length, 0.0, stretch_stiffness)?;
    let ray = Ray::new(&problem, FREE_START);
    let stretches = ray.stretched().map(|rod| ray.stretches(rod));
    let Some([_, (_, start)]) = stretches.and_then(|found| Some(found.first()?.rods.clone()))
    else {
        return Ok(Vec::new());
    };
    // From the starting point to larger forces, and to smaller ones.
    let begin = -start.force()[1];
    let (mut above, mut below): (Vec<f64>, Vec<f64>) =
        contact_forces.iter().partition(|force| **force >= begin);
    above.sort_by(f64::total_cmp);
    below.sort_by(|one, other| other.total_cmp(one));
    let mut found = Vec::new();
    for forces in [above, below] {
        let mut rod = start.clone();
        for force in forces {
            let Some(next) = walked(&rod, force) else {
                break;
            };
            found.push(FreeGrasp {
                grasp: PlanarGrasp::of(next.gripper(), &next),
                answer: SidewaysAnswer::of(&next, problem.stretch_compliance),
            });
            rod = next;
        }
    }
    let force = |free: &FreeGrasp| free.grasp.contact_force[1];
    found.sort_by(|one, other| force(one).total_cmp(&force(other)));
    Ok(found)
}

/// Changes the force of the table step by step, without a contact moment.
fn walked(rod: &PlanarRod, contact_force: f64) -> Option<PlanarRod> {
    let mut rod = rod.clone();
    loop {
        let now = -rod.force()[1];
        let left = contact_force - now;
        let is_last = left.abs() <= FORCE_STEP;
        let next = if is_last {
            contact_force
        } else {
            now + FORCE_STEP.copysign(left)
        };
        let moved = rod.without_contact_moment(next)?;
        if moved.largest_turn_from(&rod) > JUMP {
            return None;
        }
        rod = moved;
        if is_last {
            return Some(rod);
        }
    }
}

/// Nodes (x, z) at equal arc lengths of the rod with the gripper at a distance along a ray; `None`
/// if there is no such rod.
///
/// # Errors
/// The length or the stiffness is out of range.
pub fn rod_along_ray(
    suspended_length: f64,
    stretch_stiffness: f64,
    [direction, distance]: [f64; 2],
    edges: usize,
) -> Result<Option<Vec<[f64; 2]>>, GraspError> {
    let problem = GraspProblem::new(suspended_length, 0.0, stretch_stiffness)?;
    let ray = Ray::new(&problem, direction);
    let start = ray.stretched();
    let rod = start.and_then(|rod| ray.walk(rod, distance));
    Ok(rod.map(|(_, rod)| rod.places(edges)))
}

impl GraspStretch {
    /// At least two grasps at equal distances from the farthest to the nearest, each with its
    /// response to a sideways push. There are fewer if one is not found.
    pub fn grasps(&self, count: usize) -> Vec<(PlanarGrasp, SidewaysAnswer)> {
        let [(far, rod), (near, _)] = &self.rods;
        let (sine, cosine) = libm::sincos(self.direction);
        let mut rod = rod.clone();
        let mut found = Vec::with_capacity(count);
        for index in 0..count {
            let part = index as f64 / (count - 1).max(1) as f64;
            let distance = far + part * (near - far);
            let place = [distance * cosine, distance * sine];
            let Some(moved) = rod.moved(place) else {
                break;
            };
            rod = moved;
            let answer = SidewaysAnswer::of(&rod, self.compliance);
            found.push((PlanarGrasp::of(place, &rod), answer));
        }
        found
    }
}

impl PlanarGrasp {
    fn of(gripper: [f64; 2], rod: &PlanarRod) -> Self {
        Self {
            gripper,
            angle: rod.gripper_angle(),
            contact_force: rod.force().map(|force| -force),
            contact_moment: rod.contact_moment(),
            lowest: rod.lowest(),
        }
    }
}

impl SidewaysAnswer {
    fn of(rod: &PlanarRod, compliance: f64) -> Self {
        let elements = rod.elements();
        Self {
            unstable_modes: negative_modes(&elements, TWIST_STIFFNESS, compliance),
            largest_over_push: largest_sideways(&elements, TWIST_STIFFNESS, compliance),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{GraspMethod, GraspSolver};
    use super::*;

    const LENGTH: f64 = 17.68;
    const STIFFNESS: f64 = 1600.0;

    fn problem() -> GraspProblem {
        GraspProblem::new(LENGTH, 0.0, STIFFNESS).unwrap()
    }

    #[test]
    fn the_optimal_grasps_are_free_of_moment_and_axial_force() {
        // Local minimum 1 is the gentle grasp, local minimum 2 the other one with the fewest
        // unstable modes.
        let found = GraspSolver::new()
            .solve_all(&problem(), GraspMethod::Theory)
            .unwrap();
        let others = found[1..].iter().filter(|grasp| grasp.is_feasible());
        let second = others.min_by_key(|grasp| grasp.unstable_modes).unwrap();
        assert_eq!((found[0].unstable_modes, second.unstable_modes), (0, 2));
        for grasp in [&found[0], second] {
            let free = free_grasps(LENGTH, STIFFNESS, &[grasp.contact_force.z]).unwrap();
            let FreeGrasp {
                grasp: planar,
                answer,
            } = free[0];
            let off = libm::hypot(
                planar.gripper[0] - grasp.position.x,
                planar.gripper[1] - grasp.position.z,
            );
            assert!(off < 1e-5, "{planar:?} {:?}", grasp.position);
            assert!(planar.contact_force[0].abs() < 1e-6, "{planar:?}");
            assert!(planar.lowest > 0.0);
            assert_eq!(answer.unstable_modes, grasp.unstable_modes);
        }
        // The first of them lies on the inner boundary.
        let direction = libm::atan2(found[0].position.z, found[0].position.x);
        let region = grasp_region(LENGTH, STIFFNESS, &[direction]).unwrap();
        let inner = region[0].ends[1];
        assert_eq!(region[0].bounds, [GraspBound::Pull, GraspBound::Moment]);
        assert!((inner.gripper[0] - found[0].position.x).abs() < 1e-6);
        assert!(inner.contact_force[0].abs() < 1e-6, "{inner:?}");
    }

    #[test]
    fn boundaries_are_where_the_constraints_end() {
        let directions = [0.3, 0.9, 1.5, 2.0, 2.6];
        let region = grasp_region(LENGTH, STIFFNESS, &directions).unwrap();
        assert_eq!(region.len(), directions.len());
        for stretch in &region {
            assert_eq!(stretch.bounds[0], GraspBound::Pull);
            for (end, bound) in stretch.ends.iter().zip(stretch.bounds) {
                let bound = match bound {
                    GraspBound::Pull => end.contact_force[1],
                    GraspBound::Moment => end.contact_moment,
                    GraspBound::Table => end.lowest,
                };
                assert!((0.0..1e-6).contains(&bound), "{end:?}");
            }
            let grasps = stretch.grasps(7);
            assert_eq!(grasps.len(), 7);
            for (grasp, answer) in &grasps[1..6] {
                assert!(grasp.contact_force[1] > 0.0 && grasp.contact_moment > 0.0);
                assert!(grasp.lowest > 0.0 && answer.largest_over_push >= 1.0 - 1e-6);
            }
        }
    }

    #[test]
    fn moments_about_the_contact_node_are_in_balance() {
        // M(0) = x_M n_z(l) − z_M n_x − ∫ x w ds.
        for direction in [0.5, 1.4, 2.2] {
            let region = grasp_region(LENGTH, STIFFNESS, &[direction]).unwrap();
            let (distance, rod) = &region[0].rods[1];
            let places = rod.places(20_000);
            let step = LENGTH / 20_000.0;
            let pairs = places.windows(2);
            let weight: f64 = pairs
                .map(|pair| 0.25 * step * (pair[0][0] + pair[1][0]))
                .sum();
            let [h, v] = rod.force();
            let (sine, cosine) = libm::sincos(direction);
            let moment = distance * (cosine * (v + 0.5 * LENGTH) - sine * h) - weight;
            assert!((moment - rod.contact_moment()).abs() < 1e-5, "{direction}");
        }
    }
}
