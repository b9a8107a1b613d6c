//! A ray from the contact node: rods with the gripper on it, and the section where they are
//! grasps.

use super::planar_rod::PlanarRod;
use super::{GraspBound, GraspStretch, PlanarGrasp};
use crate::plan::grasp::GraspProblem;
use std::f64::consts::FRAC_PI_2;

/// Distance of the initial guess, and largest searched distance, relative to the suspended length.
const STRETCHED: f64 = 0.985;
const FARTHEST: f64 = 1.5;
/// Steps along a ray, relative to the suspended length.
const STEP: f64 = 0.01;
/// Smallest searched distance, relative to the suspended length.
const NEAREST: f64 = 0.3;
/// Largest rotation of a ray in one step, rad.
const LARGEST_TURN: f64 = 0.02;
/// Rotation of a tangent that counts as a jump, rad.
pub const JUMP: f64 = 0.5;
/// Accuracy of boundaries, L_gb.
const TOLERANCE: f64 = 1e-8;

/// A ray, from the contact node.
pub struct Ray {
    problem: GraspProblem,
    /// Sine and cosine.
    direction: [f64; 2],
}

impl Ray {
    /// The ray in a direction, rad above the table.
    pub fn new(problem: &GraspProblem, direction: f64) -> Self {
        Self {
            problem: *problem,
            direction: libm::sincos(direction).into(),
        }
    }

    fn place(&self, distance: f64) -> [f64; 2] {
        let [sine, cosine] = self.direction;
        [distance * cosine, distance * sine]
    }

    /// The rod at another distance; `None` if there is none near this one.
    fn moved(&self, (_, rod): &(f64, PlanarRod), distance: f64) -> Option<(f64, PlanarRod)> {
        let moved = rod.moved(self.place(distance))?;
        (moved.largest_turn_from(rod) < JUMP).then_some((distance, moved))
    }

    /// A stretched rod, rotated from upright into the direction of the ray.
    pub fn stretched(&self) -> Option<(f64, PlanarRod)> {
        let distance = STRETCHED * self.problem.suspended_length;
        let rod = PlanarRod::stretched(&self.problem, [0.0, distance])?;
        self.turned(FRAC_PI_2, (distance, rod))
    }

    /// A rod of another direction, rotated into this one at the same distance.
    fn turned(&self, from: f64, (distance, rod): (f64, PlanarRod)) -> Option<(f64, PlanarRod)> {
        let [sine, cosine] = self.direction;
        let turn = libm::atan2(sine, cosine) - from;
        let steps = (turn.abs() / LARGEST_TURN).ceil() as usize;
        let mut rod = (distance, rod);
        for step in 1..=steps {
            let direction = from + turn * step as f64 / steps as f64;
            rod = Self::new(&self.problem, direction).moved(&rod, distance)?;
        }
        Some(rod)
    }

    /// Moves step by step to a distance.
    pub fn walk(&self, mut rod: (f64, PlanarRod), distance: f64) -> Option<(f64, PlanarRod)> {
        let step = STEP * self.problem.suspended_length;
        while rod.0 != distance {
            let left = distance - rod.0;
            let next = if left.abs() <= step {
                distance
            } else {
                rod.0 + step.copysign(left)
            };
            rod = self.moved(&rod, next)?;
        }
        Some(rod)
    }

    /// Bisects between two rods that violate different constraints, or of which one violates none.
    /// Returns the two rods next to the point where the state of the first one ends.
    fn bisected(
        &self,
        from: (f64, PlanarRod),
        to: (f64, PlanarRod),
    ) -> Option<[(f64, PlanarRod); 2]> {
        let state = violated(&from.1);
        let (mut from, mut to) = (from, to);
        while (from.0 - to.0).abs() > TOLERANCE {
            let middle = self.moved(&from, 0.5 * (from.0 + to.0))?;
            if violated(&middle.1) == state {
                from = middle;
            } else {
                to = middle;
            }
        }
        Some([from, to])
    }

    /// All grasps along the ray. The search starts at a rod, moves outwards until the rod pulls
    /// upwards, then inwards.
    pub fn stretches(&self, mut rod: (f64, PlanarRod)) -> Vec<GraspStretch> {
        let length = self.problem.suspended_length;
        let step = STEP * length;
        let mut found = Vec::new();
        while violated(&rod.1) != Some(GraspBound::Pull) && rod.0 < FARTHEST * length {
            let Some(next) = self.moved(&rod, rod.0 + step) else {
                break;
            };
            rod = next;
        }
        let mut outer = None;
        while rod.0 > NEAREST * length {
            let Some(next) = self.moved(&rod, rod.0 - step) else {
                break;
            };
            let [before, after] = [violated(&rod.1), violated(&next.1)];
            if before.is_some() && before != after {
                // A step may be longer than the whole section.
                outer = self.first(rod.clone(), &next);
            }
            if after.is_some()
                && let Some(far) = outer.take_if(|_| before != after)
            {
                let grasp = if before.is_some() {
                    far.rod.clone()
                } else {
                    rod
                };
                let near = self.last(grasp, &next);
                found.extend(near.map(|near| self.stretch(far, near)));
            }
            rod = next;
        }
        found
    }

    /// Start of the grasps, between a rod that is not a grasp and another one.
    fn first(&self, rod: (f64, PlanarRod), next: &(f64, PlanarRod)) -> Option<End> {
        let bound = violated(&rod.1)?;
        let [_, grasp] = self.bisected(rod, next.clone())?;
        violated(&grasp.1)
            .is_none()
            .then_some(End { rod: grasp, bound })
    }

    fn stretch(&self, far: End, near: End) -> GraspStretch {
        let of = |end: &End| PlanarGrasp::of(self.place(end.rod.0), &end.rod.1);
        let [sine, cosine] = self.direction;
        GraspStretch {
            direction: libm::atan2(sine, cosine),
            ends: [of(&far), of(&near)],
            bounds: [far.bound, near.bound],
            compliance: self.problem.stretch_compliance,
            rods: [far.rod, near.rod],
        }
    }

    /// End of the grasps, between a grasp and a rod that is not one.
    fn last(&self, grasp: (f64, PlanarRod), next: &(f64, PlanarRod)) -> Option<End> {
        let [rod, beyond] = self.bisected(grasp, next.clone())?;
        let bound = violated(&beyond.1)?;
        Some(End { rod, bound })
    }
}

/// Start or end of grasps along a ray, and the constraint there.
struct End {
    rod: (f64, PlanarRod),
    bound: GraspBound,
}

/// The first violated constraint.
fn violated(rod: &PlanarRod) -> Option<GraspBound> {
    if rod.force()[1] > 0.0 {
        Some(GraspBound::Pull)
    } else if rod.contact_moment() < 0.0 {
        Some(GraspBound::Moment)
    } else if rod.lowest() < 0.0 {
        Some(GraspBound::Table)
    } else {
        None
    }
}
