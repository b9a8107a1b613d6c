//! Friction that depends on the direction of sliding relative to a rod.
//!
//! Hu, Nirody, Scott and Shelley (2009, PNAS 106, 10081) describe the scales of a snake by three
//! coefficients of Coulomb: μ_f for sliding forwards (along the tangent s), μ_b backwards, and μ_n
//! sideways (along n, across s in the plane). For sliding in the direction û the friction per
//! normal force is
//!
//! t = −[μ_f H(û·s) + μ_b (1 − H(û·s))] (û·s) s − μ_n (û·n) n,   H the step of Heaviside.
//!
//! As in [`FrictionLaw`](super::friction::FrictionLaw), û becomes γ(ρ) u/ρ with the slip u and the
//! slip speed ρ = ‖u‖:
//!
//! t(u) = −φ(ρ) D u,   D = μ_s s sᵀ + μ_n n nᵀ,   φ(ρ) = γ(ρ)/ρ,
//!
//! where μ_s is μ_f or μ_b by the sign of u·s.
//!
//! The coefficient μ_s jumps only where its factor u·s vanishes, so t is continuous and its
//! derivative
//!
//! ∂t/∂u = −φ D − (φ'/ρ) D u uᵀ
//!
//! has a jump there, from μ_b to μ_f in one entry. At rest the slopes are those of two smoothed
//! laws of the same slip tolerance, and a contact that sticks creeps below it in every direction.
//! The power t·u = −φ uᵀ D u is never positive. The derivative is symmetric for μ_s = μ_n only:
//! there is no potential, not even of the slip.
//!
//! The tangent is that of the rod at the start of the step, so friction does not depend on the
//! turning of a node within the step: this is an error of the first order in the step, like that
//! of implicit Euler. If the rod makes the angle α with the plane, the coefficients along it are
//! μ_n + (μ_s − μ_n) cos²α, so that a rod that stands on its end slides sideways in any direction.

use crate::mechanics::{Matrix3, Vector3};

/// Iterations of [`Grain::resolved`], which mostly takes two or three.
const RESOLVING_ITERATIONS: usize = 30;
/// Relative change of the speed at which the iterations end.
const RESOLVED_CHANGE: f64 = 1e-6;

/// Friction coefficients between a plane and rods by the direction in which a rod slides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectedFriction {
    /// Along the rod, towards higher numbers of its nodes.
    pub forwards: f64,
    /// Along the rod, towards lower numbers of its nodes.
    pub backwards: f64,
    /// Across the rod.
    pub sideways: f64,
}

impl DirectedFriction {
    /// The largest coefficient.
    pub fn largest(&self) -> f64 {
        self.forwards.max(self.backwards).max(self.sideways)
    }

    /// The coefficients along a rod with a tangent of any length on a surface with the unit normal
    /// `normal`.
    pub(super) fn grain(&self, normal: &Vector3, tangent: &Vector3) -> Grain {
        let along = tangent - normal * tangent.dot(normal);
        let size = along.norm();
        if size == 0.0 {
            return Grain {
                axis: Vector3::zeros(),
                forwards: self.sideways,
                backwards: self.sideways,
            };
        }
        let share = (size / tangent.norm()).powi(2);
        let mixed = |coefficient: f64| self.sideways + (coefficient - self.sideways) * share;
        Grain {
            axis: along / size,
            forwards: mixed(self.forwards),
            backwards: mixed(self.backwards),
        }
    }
}

/// Coefficients along a rod at a contact. The coefficient across it is that of the friction law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Grain {
    /// Unit vector along the rod in the plane of contact; zero for a rod normal to the plane.
    pub axis: Vector3,
    pub forwards: f64,
    pub backwards: f64,
}

impl Grain {
    /// Coefficient along the rod for a slip with the component `along` its axis.
    fn coefficient(&self, along: f64) -> f64 {
        if along < 0.0 {
            self.backwards
        } else {
            self.forwards
        }
    }

    /// D at a slip, for the coefficient `sideways` across the rod.
    pub(super) fn tensor(&self, sideways: f64, slip: &Vector3) -> Matrix3 {
        let excess = self.coefficient(slip.dot(&self.axis)) - sideways;
        Matrix3::identity() * sideways + self.axis * self.axis.transpose() * excess
    }

    /// D u for a slip u.
    pub(super) fn weighted(&self, sideways: f64, slip: &Vector3) -> Vector3 {
        let along = slip.dot(&self.axis);
        slip * sideways + self.axis * ((self.coefficient(along) - sideways) * along)
    }

    /// A friction per normal force, shortened where it exceeds the law: to the curve of all D û,
    /// which consists of two halves of ellipses.
    pub(super) fn limited(&self, sideways: f64, traction: &Vector3) -> Vector3 {
        let along = traction.dot(&self.axis);
        let parts = [self.axis * along, traction - self.axis * along];
        let coefficients = [self.coefficient(-along), sideways];
        let (mut sum, mut square) = (Vector3::zeros(), 0.0);
        for (part, coefficient) in parts.into_iter().zip(coefficients) {
            if coefficient > 0.0 {
                sum += part;
                square += part.norm_squared() / (coefficient * coefficient);
            }
        }
        if square > 1.0 {
            sum / square.sqrt()
        } else {
            sum
        }
    }

    /// The slip u (m/s) with t(u) − c u = `sum` for c = `resistance` (s/m) and γ(ρ) = tanh(`rate`
    /// ρ).
    ///
    /// Each component of u has the sign opposite to that of the sum, u_i = −sum_i ρ/a_i(ρ) with
    /// a_i = μ_i γ + c ρ. The speed solves (Σ (sum_i/a_i)²)^(−½) = 1, whose left side is concave
    /// in ρ, so that Newton's method is monotone from below.
    pub(super) fn resolved(
        &self,
        sideways: f64,
        rate: f64,
        sum: &Vector3,
        resistance: f64,
    ) -> Vector3 {
        let along = sum.dot(&self.axis);
        let parts = [self.axis * along, sum - self.axis * along];
        let coefficients = [self.coefficient(-along), sideways];
        let squares = parts.each_ref().map(Vector3::norm_squared);
        let size = sum.norm();
        let largest = coefficients[0].max(coefficients[1]);
        let mut speed = ((size - largest) / resistance).max(size / (largest * rate + resistance));
        let limits = |smoothed: f64, speed: f64| {
            coefficients.map(|coefficient| coefficient * smoothed + resistance * speed)
        };
        for _ in 0..RESOLVING_ITERATIONS {
            let smoothed = libm::tanh(rate * speed);
            let bend = rate * (1.0 - smoothed * smoothed);
            let limits = limits(smoothed, speed);
            let (mut square, mut change) = (0.0, 0.0);
            for k in 0..2 {
                let part = squares[k] / (limits[k] * limits[k]);
                square += part;
                change += part * (coefficients[k] * bend + resistance) / limits[k];
            }
            let value = 1.0 / square.sqrt();
            let (excess, slope) = (value - 1.0, value * change / square);
            speed -= excess / slope;
            if excess.abs() < RESOLVED_CHANGE * slope * speed {
                break;
            }
        }
        let limits = limits(libm::tanh(rate * speed), speed);
        parts[0] * (-speed / limits[0]) + parts[1] * (-speed / limits[1])
    }
}

#[cfg(test)]
#[path = "directed_friction_tests.rs"]
mod tests;
