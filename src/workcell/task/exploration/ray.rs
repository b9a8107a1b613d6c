//! Joint positions along a ray of (κ, τ, ω), up to the last point that the arm can follow.

use crate::cell::{Cell, HandPathRequest};
use nalgebra::{Point3, UnitQuaternion, Vector3};
use rodlab_engine::mechanics::kirchhoff::{Helix, critical_distance};
use rodlab_lab::experiment::{ClampPoses, ClampedRod};
use rodlab_robot::Pose;
use std::f64::consts::FRAC_PI_4;

/// Distance ‖(κ, τ, ω)‖ between points of a ray.
pub const SPACING: f64 = 0.01;
/// Number of points of a ray between two clearance checks of the rod.
const STRIDE: usize = 10;
/// Number of points along the rod that are checked.
const BALLS: usize = 50;
/// Fraction of the rod next to each clamp that is not checked, since the clamp is always near.
const CLAMPED: f64 = 0.1;
/// Turns of the helix about its first tangent, in units of 45°, in the order in which they are
/// tried. None changes the clamps of the straight rod or the stability.
const ROLLS: [i32; 8] = [0, 2, -2, 4, 1, -1, 3, -3];

/// Request for a ray.
pub struct RayRequest<'a> {
    /// The cell, which has a chuck.
    pub cell: &'a Cell,
    /// Index of the arm.
    pub arm: usize,
    /// The rod.
    pub rod: &'a ClampedRod,
    /// Joint positions in which the arm holds the straight rod.
    pub start: &'a [f64],
    /// Distance ‖(κ, τ, ω)‖ at which the ray ends.
    pub farthest: f64,
    /// Least distance of the arm and the rod to anything else, m.
    pub margin: f64,
}

/// A ray along which the arm can move.
#[derive(Clone, Debug)]
pub struct Ray {
    /// The unit vector (κ, τ, ω).
    pub direction: Helix,
    /// Angle by which the helix is turned about its first tangent, rad.
    pub roll: f64,
    /// Joint positions of the arm and angle of the chuck every [`SPACING`], from the straight rod
    /// on.
    pub points: Vec<Vec<f64>>,
    /// Reason why the ray ends before its farthest distance.
    pub limit: Option<String>,
}

impl Ray {
    /// Distance ‖(κ, τ, ω)‖ to which the arm can follow the ray.
    pub fn reach(&self) -> f64 {
        (self.points.len() - 1) as f64 * SPACING
    }

    /// Distance at which the rod loses stability in theory, if there is one.
    pub fn theory(&self) -> Option<f64> {
        critical_distance(&self.direction).map(|critical| critical.distance)
    }

    /// The helix at a point of the ray.
    pub fn helix(&self, index: usize) -> Helix {
        self.direction.scaled(index as f64 * SPACING)
    }

    /// Positions in the cell of points of the rod while it is the helix of a point of the ray.
    /// `places` are fractions of the length of the rod.
    pub fn places(
        &self,
        cell: &Cell,
        length: f64,
        index: usize,
        places: &[f64],
    ) -> Vec<Vector3<f64>> {
        let helix = self.helix(index);
        let chuck = cell.chuck.map_or_else(Pose::identity, |chuck| chuck.pose);
        let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), self.roll);
        let place = |part: &f64| chuck * Point3::from(turn * (length * helix.position(*part)));
        places.iter().map(|part| place(part).coords).collect()
    }

    /// The point of the ray whose joints are nearest to `joints`, with the largest difference of a
    /// joint, rad or m.
    pub fn nearest(&self, joints: &[f64]) -> (usize, f64) {
        let away = |point: &[f64]| {
            let pairs = point.iter().zip(joints);
            pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        };
        let points = self.points.iter().enumerate();
        let all = points.map(|(index, point)| (index, away(point)));
        all.min_by(|a, b| a.1.total_cmp(&b.1))
            .unwrap_or((0, f64::INFINITY))
    }
}

impl RayRequest<'_> {
    /// The ray in a direction of length 1. The helix is turned about its first tangent so that the
    /// arm can follow the ray as far as possible.
    pub fn plan(&self, direction: Helix) -> Ray {
        let mut best: Option<Ray> = None;
        for roll in ROLLS {
            let ray = self.rolled(direction, f64::from(roll) * FRAC_PI_4);
            let is_whole = ray.limit.is_none();
            if best
                .as_ref()
                .is_none_or(|best| ray.points.len() > best.points.len())
            {
                best = Some(ray);
            }
            if is_whole {
                break;
            }
        }
        best.expect("there are rolls")
    }

    fn rolled(&self, direction: Helix, roll: f64) -> Ray {
        let (cell, rod) = (self.cell, self.rod);
        let chuck = cell.chuck.expect("the cell has a chuck");
        let count = (self.farthest / SPACING).round() as usize;
        let mut last = count;
        let mut limit = None;
        let touches = direction.contact_distance(rod.radius / rod.length, self.farthest);
        if let Some(distance) = touches {
            last = (distance / SPACING) as usize;
            limit = Some("the rod touches itself".to_owned());
        }
        let clamps: Vec<ClampPoses> = (0..=last)
            .map(|k| direction.scaled(k as f64 * SPACING))
            .map(|helix| ClampPoses::of(&helix, rod.length, rod.stiffness_ratio(), roll))
            .collect();
        let axis = &cell.axes[chuck.axis];
        let allowed = clamps
            .iter()
            .take_while(|clamps| axis.limits.allow(clamps.chuck))
            .count();
        if allowed <= last {
            limit = Some(format!("axis {} is at the end of its range", axis.name));
        }
        let poses: Vec<Pose> = clamps[..allowed]
            .iter()
            .map(|clamps| chuck.pose * clamps.hand)
            .collect();
        let path = cell.follow_poses(&HandPathRequest {
            arm: self.arm,
            from: self.start.to_vec(),
            poses: &poses,
            margin: self.margin,
        });
        limit = path.ends.or(limit);
        let points = path
            .joints
            .into_iter()
            .zip(&clamps)
            .map(|(mut joints, clamps)| {
                joints.push(clamps.chuck);
                joints
            });
        let mut ray = Ray {
            direction,
            roll,
            points: points.collect(),
            limit,
        };
        self.keep_clear(&mut ray);
        ray
    }

    /// Ends a ray before the rod comes too near to something.
    fn keep_clear(&self, ray: &mut Ray) {
        let surroundings = self.cell.surroundings();
        let mut postures = surroundings.homes();
        let place = |k: usize| CLAMPED + (1.0 - 2.0 * CLAMPED) * k as f64 / (BALLS - 1) as f64;
        let places: Vec<f64> = (0..BALLS).map(place).collect();
        for index in (0..ray.points.len()).step_by(STRIDE) {
            let joints = &ray.points[index];
            postures[self.arm] = joints[..joints.len() - 1].to_vec();
            let balls = ray.places(self.cell, self.rod.length, index, &places);
            let near = surroundings.nearest_to_balls(&postures, &balls, self.rod.radius);
            if let Some((name, _)) = near.filter(|(_, away)| *away < self.margin) {
                ray.points.truncate(index.saturating_sub(STRIDE) + 1);
                ray.limit = Some(format!("the rod comes too near to {name}"));
                return;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_cells::gantry;

    #[test]
    fn a_helix_is_turned_about_its_first_tangent() {
        let cell = gantry();
        let ray = |roll: f64| Ray {
            direction: Helix::from([0.6, 0.0, 0.8]),
            roll,
            points: Vec::new(),
            limit: None,
        };
        let parts = [0.0, 0.3, 1.0];
        let chuck = cell.chuck.map_or_else(Pose::identity, |chuck| chuck.pose);
        let places = |roll: f64| -> Vec<Vector3<f64>> {
            let places = ray(roll).places(&cell, 0.5, 400, &parts);
            let in_chuck = places.iter().map(|place| {
                let place = chuck.inverse_transform_point(&Point3::from(*place));
                place.coords
            });
            in_chuck.collect()
        };
        let angle: f64 = 0.7;
        for (here, there) in places(0.0).iter().zip(places(angle)) {
            let turned = Vector3::new(
                here.x,
                here.y * angle.cos() - here.z * angle.sin(),
                here.y * angle.sin() + here.z * angle.cos(),
            );
            assert!((there - turned).norm() < 1e-12, "{there} {turned}");
        }
        // It is bent at its end.
        assert!(places(0.0)[2].yz().norm() > 0.1);
    }
}
