//! The flow of a fluid without rods: the velocity U(x, t) to which drag is relative.
//!
//! ```text
//! uniform    U = s(t) U₀
//! shear      U = s(t) γ ((x − p)·g) d
//! rotation   U = s(t) ω × (x − p)
//! extension  U = s(t) ε (d dᵀ − c cᵀ) (x − p), or with (1 − d dᵀ)/2 for c cᵀ
//! profile    U = s(t) u(x·g) d
//! ```
//!
//! The factor s(t) is piecewise linear, 1 without corners; a profile u is piecewise linear in the
//! position x·g along a direction g, and constant beyond its ends. The flow turns the fluid at
//! half its curl. A particle of the fluid accelerates by ∂U/∂t + (∇U) U.

use crate::mechanics::piecewise::{piecewise_linear, piecewise_slope};
use crate::mechanics::{Matrix3, Vector3};

/// The flow of the fluid without rods.
#[derive(Clone, Debug, PartialEq)]
pub struct BackgroundFlow {
    /// Velocity of the flow as a function of the place, where the schedule is 1.
    pub kind: FlowKind,
    /// Factor at given times, s, piecewise linear and constant outside; empty for 1.
    pub schedule: Vec<(f64, f64)>,
}

/// Velocity of a flow over space.
#[derive(Clone, Debug, PartialEq)]
pub enum FlowKind {
    /// The same everywhere.
    Uniform {
        /// U₀, m/s.
        velocity: Vector3,
    },
    /// Proportional to the distance from a plane.
    Shear {
        /// A point p of the plane at rest, m.
        point: Vector3,
        /// Unit vector d of the velocity.
        direction: Vector3,
        /// Unit vector g along which the velocity grows.
        gradient: Vector3,
        /// Shear rate γ, 1/s.
        rate: f64,
    },
    /// Rotation as a rigid body.
    Rotation {
        /// A point p of the axis, m.
        point: Vector3,
        /// ω, rad/s.
        angular_velocity: Vector3,
    },
    /// Stretching without rotation.
    Extension {
        /// The stagnation point p, m.
        point: Vector3,
        /// Gradient of the velocity, symmetric and without trace, 1/s.
        gradient: Matrix3,
    },
    /// Tabulated along a direction.
    Profile {
        /// Unit vector d of the velocity.
        direction: Vector3,
        /// Unit vector g along which positions count.
        along: Vector3,
        /// Positions x·g (m), growing, with the speed there, m/s.
        speeds: Vec<(f64, f64)>,
    },
}

impl FlowKind {
    /// An extension at the rate ε (1/s) along the unit vector d, with compression along the unit
    /// vector c, perpendicular to d, or in all directions across d.
    pub fn extension(point: Vector3, rate: f64, d: Vector3, c: Option<Vector3>) -> Self {
        let along = d * d.transpose();
        let across = match c {
            Some(c) => c * c.transpose(),
            None => (Matrix3::identity() - along) * 0.5,
        };
        Self::Extension {
            point,
            gradient: (along - across) * rate,
        }
    }

    /// Velocity at a place, m/s.
    fn velocity(&self, x: &Vector3) -> Vector3 {
        match self {
            Self::Uniform { velocity } => *velocity,
            Self::Shear {
                point,
                direction,
                gradient,
                rate,
            } => direction * (rate * (x - point).dot(gradient)),
            Self::Rotation {
                point,
                angular_velocity,
            } => angular_velocity.cross(&(x - point)),
            Self::Extension { point, gradient } => gradient * (x - point),
            Self::Profile {
                direction,
                along,
                speeds,
            } => direction * piecewise_linear(speeds, x.dot(along)).unwrap_or(0.0),
        }
    }

    /// Derivative of the velocity with respect to the place, 1/s. At a corner of a profile it is
    /// that of the piece before.
    fn gradient(&self, x: &Vector3) -> Matrix3 {
        match self {
            Self::Uniform { .. } => Matrix3::zeros(),
            Self::Shear {
                direction,
                gradient,
                rate,
                ..
            } => direction * gradient.transpose() * *rate,
            Self::Rotation {
                angular_velocity, ..
            } => angular_velocity.cross_matrix(),
            Self::Extension { gradient, .. } => *gradient,
            Self::Profile {
                direction,
                along,
                speeds,
            } => direction * along.transpose() * piecewise_slope(speeds, x.dot(along)),
        }
    }
}

impl BackgroundFlow {
    /// The same flow at all times.
    pub fn steady(kind: FlowKind) -> Self {
        Self {
            kind,
            schedule: Vec::new(),
        }
    }

    /// s(t).
    fn factor(&self, time: f64) -> f64 {
        piecewise_linear(&self.schedule, time).unwrap_or(1.0)
    }

    /// Velocity at a place and time (s), m/s.
    pub fn velocity(&self, x: &Vector3, time: f64) -> Vector3 {
        self.kind.velocity(x) * self.factor(time)
    }

    /// Derivative of the velocity with respect to the place, 1/s.
    pub fn gradient(&self, x: &Vector3, time: f64) -> Matrix3 {
        self.kind.gradient(x) * self.factor(time)
    }

    /// Angular velocity of the fluid, half the curl of the velocity, rad/s.
    pub fn spin(&self, x: &Vector3, time: f64) -> Vector3 {
        let g = self.gradient(x, time);
        Vector3::new(g.m32 - g.m23, g.m13 - g.m31, g.m21 - g.m12) * 0.5
    }

    /// Acceleration of the fluid, m/s², and its derivative with respect to the place, 1/s².
    pub fn acceleration(&self, x: &Vector3, time: f64) -> (Vector3, Matrix3) {
        let (factor, rate) = (self.factor(time), piecewise_slope(&self.schedule, time));
        let (velocity, gradient) = (self.kind.velocity(x), self.kind.gradient(x));
        (
            velocity * rate + gradient * velocity * (factor * factor),
            gradient * rate + gradient * gradient * (factor * factor),
        )
    }

    /// Whether the fluid is at rest on a plane at all times, as at a no-slip wall.
    pub fn rests_on(&self, point: &Vector3, normal: &Vector3) -> bool {
        let is_along = |direction: &Vector3| direction.cross(normal).norm() < ROUNDING;
        match &self.kind {
            FlowKind::Uniform { velocity } => *velocity == Vector3::zeros(),
            FlowKind::Shear {
                point: own,
                direction,
                gradient,
                rate,
            } => {
                let height = (point - own).dot(gradient);
                let size = point.norm().max(own.norm());
                *rate == 0.0
                    || is_along(gradient)
                        && direction.dot(normal).abs() < ROUNDING
                        && height.abs() <= ROUNDING * size
            }
            FlowKind::Rotation {
                angular_velocity, ..
            } => *angular_velocity == Vector3::zeros(),
            FlowKind::Extension { gradient, .. } => *gradient == Matrix3::zeros(),
            FlowKind::Profile {
                direction,
                along,
                speeds,
            } => {
                let fastest = speeds.iter().map(|(_, speed)| speed.abs());
                let fastest = fastest.fold(0.0, f64::max);
                let speed = piecewise_linear(speeds, point.dot(along)).unwrap_or(0.0);
                fastest == 0.0
                    || is_along(along)
                        && direction.dot(normal).abs() < ROUNDING
                        && speed.abs() <= ROUNDING * fastest
            }
        }
    }
}

/// Deviation of unit vectors, and relative deviation of lengths and speeds, that counts as
/// rounding.
const ROUNDING: f64 = 1e-9;

#[cfg(test)]
mod tests {
    use super::*;

    fn flows() -> [FlowKind; 6] {
        let [direction, across] = [Vector3::new(0.6, 0.0, 0.8), Vector3::y()];
        [
            FlowKind::Uniform {
                velocity: Vector3::new(0.3, -1.0, 2.0),
            },
            FlowKind::Shear {
                point: Vector3::new(0.1, 0.2, 0.3),
                direction,
                gradient: across,
                rate: 1.7,
            },
            FlowKind::Rotation {
                point: Vector3::new(0.1, 0.2, 0.3),
                angular_velocity: Vector3::new(0.4, -0.5, 0.9),
            },
            FlowKind::Profile {
                direction,
                along: across,
                speeds: vec![(-1.0, 0.0), (0.0, 0.5), (2.0, -1.5)],
            },
            FlowKind::extension(Vector3::new(0.1, 0.2, 0.3), 1.3, direction, Some(across)),
            FlowKind::extension(Vector3::new(0.1, 0.2, 0.3), 1.3, direction, None),
        ]
    }

    #[test]
    fn gradients_accelerations_and_spins_are_derivatives_of_the_velocity() {
        let (x, time, step) = (Vector3::new(0.7, 0.4, -0.2), 0.35, 1e-5);
        for kind in flows() {
            let flow = BackgroundFlow {
                kind,
                schedule: vec![(0.0, 0.2), (1.0, 1.4)],
            };
            let difference = |of: &dyn Fn(f64) -> Vector3| (of(step) - of(-step)) / (2.0 * step);
            let gradient = flow.gradient(&x, time);
            for axis in 0..3 {
                let along = |by: f64| x + Vector3::ith(axis, by);
                let found = difference(&|by| flow.velocity(&along(by), time));
                assert!((found - gradient.column(axis)).norm() < 1e-9, "{flow:?}");
                let found = difference(&|by| flow.acceleration(&along(by), time).0);
                let (_, exact) = flow.acceleration(&x, time);
                assert!((found - exact.column(axis)).norm() < 1e-9, "{flow:?}");
            }
            // A particle moves with the fluid.
            let found = difference(&|by| {
                let moved = x + flow.velocity(&x, time) * by;
                flow.velocity(&moved, time + by)
            });
            let (exact, _) = flow.acceleration(&x, time);
            assert!((found - exact).norm() < 1e-9, "{flow:?}");
            let turning = (gradient - gradient.transpose()) * 0.5;
            let spin = flow.spin(&x, time);
            assert!((turning - spin.cross_matrix()).norm() < 1e-14);
        }
    }

    #[test]
    fn an_extension_keeps_volumes_and_spins_nothing() {
        let [.., planar, axial] = flows().map(BackgroundFlow::steady);
        let stretched = Vector3::new(0.6, 0.0, 0.8);
        for (flow, across) in [(&planar, 1.3), (&axial, 0.65)] {
            let gradient = flow.gradient(&Vector3::x(), 0.0);
            assert!(gradient.trace().abs() < 1e-15);
            assert!((gradient * stretched - stretched * 1.3).norm() < 1e-15);
            assert!((gradient * Vector3::y() + Vector3::y() * across).norm() < 1e-15);
            assert!(flow.spin(&Vector3::x(), 0.0).norm() < 1e-15);
        }
    }

    #[test]
    fn a_rotation_spins_the_fluid_at_its_angular_velocity() {
        let [_, _, rotation, ..] = flows();
        let flow = BackgroundFlow::steady(rotation);
        let spin = flow.spin(&Vector3::x(), 0.0);
        assert!((spin - Vector3::new(0.4, -0.5, 0.9)).norm() < 1e-15);
    }

    #[test]
    fn only_flows_along_a_wall_at_rest_there_have_walls() {
        let [uniform, shear, rotation, profile, planar, axial] = flows();
        let rests = |kind: &FlowKind, height: f64, normal: Vector3| {
            BackgroundFlow::steady(kind.clone()).rests_on(&(Vector3::y() * height), &normal)
        };
        assert!(rests(&shear, 0.2, Vector3::y()));
        assert!(rests(&shear, 0.2, -Vector3::y()));
        assert!(!rests(&shear, 0.3, Vector3::y()));
        assert!(!rests(&shear, 0.2, Vector3::x()));
        assert!(rests(&profile, -1.0, Vector3::y()));
        assert!(rests(&profile, 0.5, Vector3::y()));
        assert!(!rests(&profile, 0.0, Vector3::y()));
        assert!(!rests(&uniform, 0.0, Vector3::y()));
        for kind in [rotation, planar, axial] {
            assert!(!rests(&kind, 0.2, Vector3::y()));
        }
    }
}
