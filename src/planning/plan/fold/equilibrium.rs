//! One equilibrium of a folded sheet, and Newton's method for it.

use super::elastica::{Forces, Place, place, places};
use nalgebra::{Matrix3, Vector3};

/// Iterations of Newton's method.
const ITERATIONS: usize = 30;
/// Change of length and forces, relative, at which the method has converged.
const CONVERGED: f64 = 1e-12;
/// Largest change of a force, of EI/l̄_s², and of the length, relative, in one iteration.
const LARGEST_CHANGE: [f64; 2] = [4.0, 0.2];

/// A sheet that is held without moment at its edge, dimensionless: lengths in L_gb, forces in EI/L_gb².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fold {
    /// (x̄, z̄): the gripper, from where the manipulated edge lay when the sheet was flat; towards the sheet, and up.
    pub gripper: [f64; 2],
    /// α, rad, by which the manipulated edge is turned.
    pub angle: f64,
    /// l̄_s.
    pub suspended_length: f64,
    /// What the suspended part exerts on the lying one.
    pub forces: Forces,
    /// θ'(l̄_s): the moment at the gripper, in EI/L_gb.
    pub moment: f64,
}

/// What is given beside the place of the gripper.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Given {
    /// No moment at the gripper.
    NoMoment,
    /// α.
    Angle(f64),
    /// H over the weight of the lying rest and −V, for a sheet of length L̄.
    Push { ratio: f64, length: f64 },
}

impl Fold {
    /// Longest suspended length at which folds are sought, L_gb.
    pub const LONGEST: f64 = 7.4;

    /// Without a force along the table and next to flat: α = l̄³/24, z̄ = l̄⁴/48 and V = −l̄/4 of a beam.
    pub fn just_lifted(suspended_length: f64) -> Option<Self> {
        let guess = Forces {
            horizontal: 0.0,
            vertical: -0.25 * suspended_length,
        };
        Self::without_push(suspended_length, guess)
    }

    /// Without a force along the table: θ'(l̄_s) = 0 by the choice of V.
    pub fn without_push(suspended_length: f64, guess: Forces) -> Option<Self> {
        let mut forces = guess;
        for _ in 0..ITERATIONS {
            let end = place(forces, suspended_length);
            let change = -end.state.curvature / end.by_vertical.curvature;
            let limit = LARGEST_CHANGE[0] / suspended_length.powi(2);
            forces.vertical += change.clamp(-limit, limit);
            if change.abs() <= CONVERGED * forces.vertical.abs() {
                return Some(Self::of(forces, &place(forces, suspended_length)));
            }
        }
        None
    }

    /// Of a suspended length and an angle: θ(l̄_s) = α and θ'(l̄_s) = 0 by the choice of H and V.
    pub fn at_angle(suspended_length: f64, angle: f64, guess: Forces) -> Option<Self> {
        let mut forces = guess;
        let unit = suspended_length.powi(-2);
        for _ in 0..ITERATIONS {
            let end = place(forces, suspended_length);
            let [by_h, by_v] = [&end.by_horizontal, &end.by_vertical];
            let residual = [end.state.angle - angle, end.state.curvature];
            let determinant = by_h.angle * by_v.curvature - by_v.angle * by_h.curvature;
            let change = [
                (residual[0] * by_v.curvature - by_v.angle * residual[1]) / determinant,
                (by_h.angle * residual[1] - by_h.curvature * residual[0]) / determinant,
            ];
            let largest = change[0].abs().max(change[1].abs());
            let part = (LARGEST_CHANGE[0] * unit / largest).min(1.0);
            forces.horizontal -= part * change[0];
            forces.vertical -= part * change[1];
            if largest <= CONVERGED * unit.max(forces.horizontal.abs()).max(forces.vertical.abs()) {
                return Some(Self::of(forces, &place(forces, suspended_length)));
            }
            if !largest.is_finite() {
                return None;
            }
        }
        None
    }

    /// With the gripper at (x̄, z̄), from another fold nearby.
    pub fn at(gripper: [f64; 2], near: &Self) -> Option<Self> {
        Self::held(gripper, Given::NoMoment, near)
    }

    /// With the gripper at (x̄, z̄) and its angle held at α, by whatever moment that takes, from another fold nearby.
    pub fn clamped_at(gripper: [f64; 2], angle: f64, near: &Self) -> Option<Self> {
        Self::held(gripper, Given::Angle(angle), near)
    }

    /// With the gripper at (x̄, z̄) and its angle held so that a sheet of length L̄ pulls along the table with `ratio` of what it
    /// presses on it with, H = `ratio` ((L̄ − l̄_s)/2 − V), from another fold nearby.
    pub fn pushing_at(gripper: [f64; 2], ratio: f64, length: f64, near: &Self) -> Option<Self> {
        Self::held(gripper, Given::Push { ratio, length }, near)
    }

    fn held(gripper: [f64; 2], given: Given, near: &Self) -> Option<Self> {
        let mut forces = near.forces;
        let mut length = near.suspended_length;
        for _ in 0..ITERATIONS {
            let end = place(forces, length);
            let state = &end.state;
            let (sine, cosine) = libm::sincos(state.angle);
            let [by_h, by_v] = [&end.by_horizontal, &end.by_vertical];
            let (fault, faults_by) = match given {
                Given::Angle(angle) => (
                    state.angle - angle,
                    [by_h.angle, by_v.angle, state.curvature],
                ),
                Given::NoMoment => {
                    let load = forces.vertical + 0.5 * length;
                    let slope = forces.horizontal * sine - load * cosine;
                    (state.curvature, [by_h.curvature, by_v.curvature, slope])
                }
                Given::Push {
                    ratio,
                    length: whole,
                } => {
                    let press = 0.5 * (whole - length) - forces.vertical;
                    let fault = forces.horizontal - ratio * press;
                    (fault, [1.0, ratio, 0.5 * ratio])
                }
            };
            let residual = Vector3::new(fault, length - state.x - gripper[0], state.z - gripper[1]);
            let jacobian = Matrix3::new(
                faults_by[0],
                faults_by[1],
                faults_by[2],
                -by_h.x,
                -by_v.x,
                1.0 - cosine,
                by_h.z,
                by_v.z,
                sine,
            );
            let change = jacobian.lu().solve(&residual)?;
            let unit = length.powi(-2);
            let force = change.x.abs().max(change.y.abs()) / unit;
            let stretch = change.z.abs() / length;
            let part = (LARGEST_CHANGE[0] / force)
                .min(LARGEST_CHANGE[1] / stretch)
                .min(1.0);
            forces.horizontal -= part * change.x;
            forces.vertical -= part * change.y;
            length -= part * change.z;
            let scale = 1.0 + forces.horizontal.abs().max(forces.vertical.abs()) / unit;
            if force <= CONVERGED * scale && stretch <= CONVERGED * scale {
                return Some(Self::of(forces, &place(forces, length)));
            }
            if !(force.is_finite() && stretch.is_finite()) {
                return None;
            }
        }
        None
    }

    /// The sheet up to a place.
    pub(super) fn of(forces: Forces, end: &Place) -> Self {
        Self {
            gripper: [end.arc_length - end.state.x, end.state.z],
            angle: end.state.angle,
            suspended_length: end.arc_length,
            forces,
            moment: end.state.curvature,
        }
    }

    /// λ = |F_x|/|F_z| of the force on the lying part at the touchdown point (thesis Eq. 4.6).
    pub fn force_ratio(&self) -> f64 {
        (self.forces.horizontal / self.forces.vertical).abs()
    }

    /// arctan(H/|V|), rad: how far the force on the lying part is inclined from the vertical; positive where the sheet is pulled. λ is
    /// the size of its tangent.
    pub fn force_inclination(&self) -> f64 {
        libm::atan(self.forces.horizontal / self.forces.vertical.abs())
    }

    /// Least coefficient of friction that holds a sheet of total length L̄: the lying rest of it presses on the table, too,
    ///
    /// > |F_x| / (|F_z| + (L̄ − l̄_s)/2)
    pub fn friction_demand(&self, length: f64) -> f64 {
        let lying = 0.5 * (length - self.suspended_length).max(0.0);
        self.forces.horizontal.abs() / (lying - self.forces.vertical)
    }

    /// Points of the suspended sheet from the touchdown point to the gripper, `[parts + 1][x̄, z̄]`, in the frame of
    /// [`gripper`](Self::gripper).
    pub fn shape(&self, parts: usize) -> Vec<[f64; 2]> {
        let places = places(self.forces, self.suspended_length, parts);
        let point = |place: &Place| [self.suspended_length - place.state.x, place.state.z];
        places.iter().map(point).collect()
    }
}
