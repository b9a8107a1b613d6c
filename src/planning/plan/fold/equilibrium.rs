//! One equilibrium of a folded sheet, and Newton's method for it.

use nalgebra::Vector3;
use rodlab_engine::mechanics::kirchhoff::elastica::{Elastica, Forces, Place, State};

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
    /// H over the weight of the lying rest and −V, for a sheet of length L̄.
    Push { ratio: f64, length: f64 },
}

impl Condition {
    /// Its residual at an end, and the derivatives by H, V and l̄_s.
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
        let conditions = [
            Condition::Horizontal(guess.horizontal),
            Condition::Length(suspended_length),
            Condition::NoMoment,
        ];
        Self::solved(guess, suspended_length, conditions, end)
    }

    /// The fold of a suspended length and an angle: θ(l̄_s) = α and θ'(l̄_s) = 0 by the choice of H
    /// and V.
    pub fn at_angle(suspended_length: f64, angle: f64, guess: Forces) -> Option<Self> {
        let conditions = [
            Condition::Length(suspended_length),
            Condition::Angle(angle),
            Condition::NoMoment,
        ];
        Self::solved(guess, suspended_length, conditions, end)
    }

    /// With the gripper at (x̄, z̄), from another fold nearby.
    pub fn at(gripper: [f64; 2], near: &Self) -> Option<Self> {
        Self::held(gripper, Condition::NoMoment, near)
    }

    /// With the gripper at (x̄, z̄) and its angle held at α, by the required moment, from another
    /// fold nearby.
    pub fn clamped_at(gripper: [f64; 2], angle: f64, near: &Self) -> Option<Self> {
        Self::held(gripper, Condition::Angle(angle), near)
    }

    /// Fold with the gripper at (x̄, z̄) at the angle where the force of a sheet of length L̄ along the table is `ratio` times its
    /// pressure on the table, H = `ratio` ((L̄ − l̄_s)/2 − V). The search starts from another fold nearby.
    pub fn pushing_at(gripper: [f64; 2], ratio: f64, length: f64, near: &Self) -> Option<Self> {
        Self::held(gripper, Condition::Push { ratio, length }, near)
    }

    fn held([x, z]: [f64; 2], condition: Condition, near: &Self) -> Option<Self> {
        let conditions = [condition, Condition::Along(x), Condition::Up(z)];
        Self::solved(near.forces, near.suspended_length, conditions, end)
    }

    /// Newton's method from forces and a suspended length nearby; `end` finds the end of a sheet from them, and its derivatives by
    /// the length.
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
        let places = Elastica::heavy(self.forces).places(self.suspended_length, parts);
        let point = |place: &Place| [self.suspended_length - place.state.x, place.state.z];
        places.iter().map(point).collect()
    }
}

/// The sheet at the suspended length from the touchdown point, and its derivatives by that.
fn end(forces: Forces, length: f64) -> (Place, State) {
    let sheet = Elastica::heavy(forces);
    let end = sheet.place(length);
    (end, sheet.slope(&end))
}

/// Linear interpolation between two positions.
pub(super) fn between(from: [f64; 2], to: [f64; 2], part: f64) -> [f64; 2] {
    [0, 1].map(|k| from[k] + part * (to[k] - from[k]))
}
