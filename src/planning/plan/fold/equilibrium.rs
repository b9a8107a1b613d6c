//! One equilibrium of a folded sheet, and Newton's method for it.

use nalgebra::Vector3;
use rodlab_engine::mechanics::kirchhoff::elastica::{Elastica, Forces, Place, State};

/// Maximum number of iterations of Newton's method.
const ITERATIONS: usize = 30;
/// Relative change of length and forces at which the method has converged.
const CONVERGED: f64 = 1e-12;
/// Largest change in one iteration: of a force, in EI/l̄_s², and of the length, relative.
const LARGEST_CHANGE: [f64; 2] = [4.0, 0.2];

/// A sheet that is held without moment at its edge, dimensionless: lengths in L_gb, forces in EI/L_gb².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fold {
    /// (x̄, z̄): position of the gripper relative to the initial position of the held edge on the
    /// flat sheet; x̄ towards the sheet, z̄ up.
    pub gripper: [f64; 2],
    /// α, rad, the angle of the held edge.
    pub angle: f64,
    /// l̄_s.
    pub suspended_length: f64,
    /// Force of the suspended part on the lying one.
    pub forces: Forces,
    /// θ'(l̄_s): the moment at the gripper, in EI/L_gb.
    pub moment: f64,
}

/// A condition on a fold; three of them determine it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Condition {
    /// H.
    Horizontal(f64),
    /// l̄_s.
    Length(f64),
    /// x̄ of the gripper.
    Along(f64),
    /// z̄ of the gripper.
    Up(f64),
    /// No moment at the gripper.
    NoMoment,
    /// α.
    Angle(f64),
    /// Ratio of H to the pressure on the table, which is the weight of the lying rest and −V, for
    /// a sheet of length L̄.
    Push { ratio: f64, length: f64 },
}

impl Condition {
    /// Residual of the condition at an end, and its derivatives with respect to H, V and l̄_s.
    fn fault(self, forces: Forces, (end, by_length): &(Place, State)) -> (f64, [f64; 3]) {
        let of = |part: fn(&State) -> f64| {
            let by = [&end.by_horizontal, &end.by_vertical, by_length].map(part);
            (part(&end.state), by)
        };
        match self {
            Self::Horizontal(horizontal) => (forces.horizontal - horizontal, [1.0, 0.0, 0.0]),
            Self::Length(length) => (end.arc_length - length, [0.0, 0.0, 1.0]),
            Self::Along(along) => {
                let (x, [by_h, by_v, by_length]) = of(|state| state.x);
                (end.arc_length - x - along, [-by_h, -by_v, 1.0 - by_length])
            }
            Self::Up(up) => {
                let (z, by) = of(|state| state.z);
                (z - up, by)
            }
            Self::NoMoment => of(|state| state.curvature),
            Self::Angle(angle) => {
                let (found, by) = of(|state| state.angle);
                (found - angle, by)
            }
            Self::Push { ratio, length } => {
                let press = 0.5 * (length - end.arc_length) - forces.vertical;
                (forces.horizontal - ratio * press, [1.0, ratio, 0.5 * ratio])
            }
        }
    }
}

impl Fold {
    /// Longest suspended length at which folds are searched, L_gb.
    pub const LONGEST: f64 = 7.4;

    /// The nearly flat fold without a force along the table. The initial guess is that of a beam:
    /// α = l̄³/24, z̄ = l̄⁴/48 and V = −l̄/4.
    pub fn just_lifted(suspended_length: f64) -> Option<Self> {
        let guess = Forces {
            horizontal: 0.0,
            vertical: -0.25 * suspended_length,
        };
        Self::without_push(suspended_length, guess)
    }

    /// The fold without a force along the table, with V such that θ'(l̄_s) = 0.
    pub fn without_push(suspended_length: f64, guess: Forces) -> Option<Self> {
        let conditions = [
            Condition::Horizontal(guess.horizontal),
            Condition::Length(suspended_length),
            Condition::NoMoment,
        ];
        Self::solved(guess, suspended_length, conditions, end)
    }

    /// The fold with a given suspended length and angle, with H and V such that θ(l̄_s) = α and
    /// θ'(l̄_s) = 0.
    pub fn at_angle(suspended_length: f64, angle: f64, guess: Forces) -> Option<Self> {
        let conditions = [
            Condition::Length(suspended_length),
            Condition::Angle(angle),
            Condition::NoMoment,
        ];
        Self::solved(guess, suspended_length, conditions, end)
    }

    /// The fold with the gripper at (x̄, z̄), found from another fold nearby.
    pub fn at(gripper: [f64; 2], near: &Self) -> Option<Self> {
        Self::held(gripper, Condition::NoMoment, near)
    }

    /// The fold with the gripper at (x̄, z̄), held at the angle α by the required moment, found
    /// from another fold nearby.
    pub fn clamped_at(gripper: [f64; 2], angle: f64, near: &Self) -> Option<Self> {
        Self::held(gripper, Condition::Angle(angle), near)
    }

    /// The fold with the gripper at (x̄, z̄), at the angle for which the force along the table is
    /// `ratio` times the pressure on the table: H = `ratio` ((L̄ − l̄_s)/2 − V) for a sheet of
    /// length L̄. The search starts from another fold nearby.
    pub fn pushing_at(gripper: [f64; 2], ratio: f64, length: f64, near: &Self) -> Option<Self> {
        Self::held(gripper, Condition::Push { ratio, length }, near)
    }

    fn held([x, z]: [f64; 2], condition: Condition, near: &Self) -> Option<Self> {
        let conditions = [condition, Condition::Along(x), Condition::Up(z)];
        Self::solved(near.forces, near.suspended_length, conditions, end)
    }

    /// Newton's method, starting at given forces and a suspended length. `end` computes the end of
    /// a sheet from them, and its derivatives with respect to the length.
    pub(super) fn solved(
        mut forces: Forces,
        mut length: f64,
        conditions: [Condition; 3],
        end: impl Fn(Forces, f64) -> (Place, State),
    ) -> Option<Self> {
        for _ in 0..ITERATIONS {
            let here = end(forces, length);
            let faults = conditions.map(|condition| condition.fault(forces, &here));
            let [(one, a), (two, b), (three, c)] =
                faults.map(|(fault, by)| (fault, Vector3::from(by)));
            let minors = [b.cross(&c), c.cross(&a), a.cross(&b)];
            let change =
                (one * minors[0] + two * minors[1] + three * minors[2]) / a.dot(&minors[0]);
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
                return Some(Self::of(forces, &end(forces, length).0));
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

    /// arctan(H/|V|), rad: inclination of the force on the lying part from the vertical; positive
    /// if the sheet is pulled. λ is the magnitude of its tangent.
    pub fn force_inclination(&self) -> f64 {
        libm::atan(self.forces.horizontal / self.forces.vertical.abs())
    }

    /// Least coefficient of friction that holds a sheet of total length L̄, whose lying rest also
    /// presses on the table,
    ///
    /// > |F_x| / (|F_z| + (L̄ − l̄_s)/2)
    pub fn friction_demand(&self, length: f64) -> f64 {
        let lying = 0.5 * (length - self.suspended_length).max(0.0);
        self.forces.horizontal.abs() / (lying - self.forces.vertical)
    }

    /// Points of the suspended sheet from the touchdown point to the gripper, `[parts + 1][x̄, z̄]`, in the frame of
    /// [`gripper`](Self::gripper).
    pub fn shape(&self, parts: usize) -> Vec<[f64; 2]> {
        let places = Elastica::heavy(self.forces).places(self.suspended_length, parts);
        let point = |place: &Place| [self.suspended_length - place.state.x, place.state.z];
        places.iter().map(point).collect()
    }
}

/// The sheet at the suspended length from the touchdown point, and its derivatives with respect to
/// this length.
fn end(forces: Forces, length: f64) -> (Place, State) {
    let sheet = Elastica::heavy(forces);
    let end = sheet.place(length);
    (end, sheet.slope(&end))
}

/// Linear interpolation between two positions.
pub(super) fn between(from: [f64; 2], to: [f64; 2], part: f64) -> [f64; 2] {
    [0, 1].map(|k| from[k] + part * (to[k] - from[k]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Energy of the suspended sheet, ∫ ½ θ'² + ½ z ds, by Simpson's rule.
    fn energy(fold: &Fold) -> f64 {
        const PARTS: usize = 400;
        let places = Elastica::heavy(fold.forces).places(fold.suspended_length, PARTS);
        let parts = places.iter().enumerate().map(|(k, place)| {
            let weight = match k {
                0 | PARTS => 1.0,
                _ => 2.0 + 2.0 * (k % 2) as f64,
            };
            weight * 0.5 * (place.state.curvature.powi(2) + place.state.z)
        });
        parts.sum::<f64>() * fold.suspended_length / PARTS as f64 / 3.0
    }

    /// The gripper exerts the derivative of the energy with respect to its position; the table
    /// carries the rest of the weight, and holds against all of the force along it.
    #[test]
    fn the_table_bears_what_the_gripper_does_not() {
        let lifted = Fold::just_lifted(2.5).unwrap();
        for push in [0.2, -0.05] {
            let [x, z] = lifted.gripper;
            let fold = Fold::at([x + push, z], &lifted).unwrap();
            let [along, up] = [0, 1].map(|axis| {
                let [more, less] = [1e-3, -1e-3].map(|step| {
                    let mut place = fold.gripper;
                    place[axis] += step;
                    energy(&Fold::at(place, &fold).unwrap())
                });
                (more - less) / 2e-3
            });
            assert!(along * push > 0.0, "{along}");
            for length in [fold.suspended_length, 6.0] {
                let expected = along.abs() / (0.5 * length - up);
                let demand = fold.friction_demand(length);
                assert!(
                    (demand / expected - 1.0).abs() < 1e-4,
                    "{demand} {expected}"
                );
            }
            let inclined = libm::atan(-along / (0.5 * fold.suspended_length - up));
            assert!((fold.force_inclination() / inclined - 1.0).abs() < 1e-4);
        }
    }
}
