//! Coulomb friction, smoothed near zero slip (thesis Eqs. 2.9–2.11).
//!
//! A surface moves with the velocity v relative to another one and is pressed against it by the
//! normal force N along the unit normal n. The friction on it is
//!
//! F = −μ N γ(ρ) u/ρ, u = v − (v·n) n, ρ = ‖u‖, γ(ρ) = 2/(1 + exp(−K₂ρ)) − 1 = tanh(K₂ρ/2), K₂ = 15/ν.
//!
//! γ(ρ)/ρ is an even, smooth function of ρ, so that the force is smooth at rest too. The power of
//! the force, −μ N γ ρ, is never positive. There is no true sticking: a load of a fraction f of μN
//! creeps at the slip speed ln((1+f)/(1−f)) ν/15.
//!
//! As in the thesis, v is the velocity of the centrelines and the force acts on them. The spin of
//! a rod about its centreline causes no slip and is not driven by friction, so rods do not roll.
//! They do roll if friction acts at the surfaces: see [`super::turning`].

use super::directed_friction::Grain;
use crate::mechanics::{Matrix3, Vector3};

/// K₂ν, the slope of the smoothing (Eq. 2.10).
const SLOPE: f64 = 15.0;

/// Iterations of [`FrictionLaw::resolved`], which mostly takes two or three.
const RESOLVING_ITERATIONS: usize = 30;
/// Relative change of the speed at which the iterations end: its square is negligible.
const RESOLVED_CHANGE: f64 = 1e-6;

/// Largest slope of the friction per normal force over the slip speed, at rest: μ K₂/2, s/m.
pub(super) fn steepest_slope(coefficient: f64, slip_tolerance: f64) -> f64 {
    0.5 * coefficient * SLOPE / slip_tolerance
}

/// Coulomb friction with a slip tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FrictionLaw {
    /// Friction coefficient μ; with a grain, that across the rod.
    pub coefficient: f64,
    /// Slip tolerance ν, m/s.
    pub slip_tolerance: f64,
    /// Coefficients along the rod, if they differ: see [`super::directed_friction`].
    pub grain: Option<Grain>,
}

/// Friction per normal force, with its derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Traction {
    /// −μ γ u/ρ.
    pub value: Vector3,
    /// Derivative with respect to the relative velocity v, s/m.
    pub by_velocity: Matrix3,
    /// Derivative with respect to the normal n, for turns of n (changes normal to n).
    pub by_normal: Matrix3,
}

impl FrictionLaw {
    /// Friction per normal force at the relative velocity `velocity` (m/s).
    #[cfg(test)]
    pub(crate) fn traction(&self, normal: &Vector3, velocity: &Vector3) -> Vector3 {
        self.traction_of_slip(&slip(normal, velocity))
    }

    /// Friction per normal force at a slip, m/s: a velocity without its normal part.
    pub(crate) fn traction_of_slip(&self, slip: &Vector3) -> Vector3 {
        let (factor, _) = self.smoothing(slip.norm());
        match &self.grain {
            None => slip * (-self.coefficient * factor),
            Some(grain) => grain.weighted(self.coefficient, slip) * -factor,
        }
    }

    /// A friction per normal force, shortened where it exceeds the largest one in its direction.
    pub(crate) fn limited(&self, traction: Vector3) -> Vector3 {
        match &self.grain {
            None => cut(traction, self.coefficient),
            Some(grain) => grain.limited(self.coefficient, &traction),
        }
    }

    /// The slip (m/s) at which the friction per normal force has a given value below μ.
    #[cfg(test)]
    pub(crate) fn slip_of_traction(&self, traction: &Vector3) -> Vector3 {
        let relative = traction.norm() / self.coefficient;
        if relative == 0.0 {
            return Vector3::zeros();
        }
        let speed = 2.0 * self.slip_tolerance / SLOPE * libm::atanh(relative);
        traction * (-speed / (relative * self.coefficient))
    }

    /// The slip u (m/s) with t(u) − c u = `sum` for c = `resistance` (s/m).
    pub(crate) fn resolved(&self, sum: &Vector3, resistance: f64) -> Vector3 {
        let size = sum.norm();
        if size == 0.0 {
            return Vector3::zeros();
        }
        let rate = 0.5 * SLOPE / self.slip_tolerance;
        if let Some(grain) = &self.grain {
            return grain.resolved(self.coefficient, rate, sum, resistance);
        }
        // μ tanh(kρ) + c ρ = ‖sum‖ is concave in ρ, so Newton's method is monotone from below.
        let stiffest = self.coefficient * rate + resistance;
        let mut speed = ((size - self.coefficient) / resistance).max(size / stiffest);
        for _ in 0..RESOLVING_ITERATIONS {
            let smoothed = libm::tanh(rate * speed);
            let excess = self.coefficient * smoothed + resistance * speed - size;
            let slope = self.coefficient * rate * (1.0 - smoothed * smoothed) + resistance;
            speed -= excess / slope;
            if excess.abs() < RESOLVED_CHANGE * slope * speed {
                break;
            }
        }
        sum * (-speed / size)
    }

    /// Derivative of [`Self::traction_of_slip`], s/m.
    pub(crate) fn slope(&self, slip: &Vector3) -> Matrix3 {
        let (factor, factor_rate) = self.smoothing(slip.norm());
        match &self.grain {
            None => {
                (Matrix3::identity() * factor + slip * slip.transpose() * factor_rate)
                    * -self.coefficient
            }
            Some(grain) => {
                let weighted = grain.weighted(self.coefficient, slip);
                let tensor = grain.tensor(self.coefficient, slip);
                -(tensor * factor + weighted * slip.transpose() * factor_rate)
            }
        }
    }

    /// Friction at the slip `at` (m/s) with its derivatives there; the dependence of the slip on
    /// velocity and normal is that of the present `velocity`.
    pub(crate) fn traction_derivatives(
        &self,
        normal: &Vector3,
        velocity: &Vector3,
        at: &Vector3,
    ) -> Traction {
        let approach = velocity.dot(normal);
        let by_slip = self.slope(at);
        let per_square = 1.0 / normal.norm_squared();
        let tangent = Matrix3::identity() - normal * normal.transpose() * per_square;
        let slip_by_normal =
            (Matrix3::identity() * approach + normal * velocity.transpose()) * -per_square;
        Traction {
            value: self.traction_of_slip(at),
            by_velocity: by_slip * tangent,
            by_normal: by_slip * slip_by_normal,
        }
    }

    /// φ = γ(ρ)/ρ and φ'(ρ)/ρ at the slip speed ρ.
    fn smoothing(&self, speed: f64) -> (f64, f64) {
        let half_rate = 0.5 * SLOPE / self.slip_tolerance;
        let z = half_rate * speed;
        let z2 = z * z;
        // tanh(z)/z and its derivative divided by z. Below 0.02 the closed form of the derivative
        // cancels, so their power series are used, whose next terms are below rounding error.
        let (ratio, ratio_rate) = if z < 0.02 {
            (
                1.0 - z2 * (1.0 / 3.0 - z2 * (2.0 / 15.0 - z2 * (17.0 / 315.0))),
                -2.0 / 3.0 + z2 * (8.0 / 15.0 - z2 * (34.0 / 105.0 - z2 * (496.0 / 2835.0))),
            )
        } else {
            let tanh = libm::tanh(z);
            let ratio = tanh / z;
            (ratio, (1.0 - tanh * tanh - ratio) / z2)
        };
        (half_rate * ratio, half_rate.powi(3) * ratio_rate)
    }
}

/// The velocity without its part along the normal.
pub(super) fn slip(normal: &Vector3, velocity: &Vector3) -> Vector3 {
    tangential(normal, velocity)
}

/// The part of a vector across a normal of any length.
///
/// The normal of smoothed closest points is shorter than 1 by about 1e-5. If it were treated as a
/// unit vector, an approach of 0.05 m/s would leave 5e-7 m/s in the slip, and at slips of that
/// size friction is steep.
pub(super) fn tangential(normal: &Vector3, vector: &Vector3) -> Vector3 {
    vector - normal * (vector.dot(normal) / normal.norm_squared())
}

/// The vector, shortened to `length` where it is longer.
pub(crate) fn cut(vector: Vector3, length: f64) -> Vector3 {
    let norm = vector.norm();
    if norm > length {
        vector * (length / norm)
    } else {
        vector
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_support::*;
    use super::*;
    use nalgebra::SVector;
    use num_dual::jacobian;

    const LAW: FrictionLaw = FrictionLaw {
        coefficient: 0.4,
        slip_tolerance: 1e-4,
        grain: None,
    };

    #[test]
    fn smoothing_of_the_reference_table() {
        let path = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../..",
            "/../shared/reference/contact/friction_smoothing_values.csv"
        );
        let Ok(table) = std::fs::read_to_string(path) else {
            println!("skipped: {path} is absent");
            return;
        };
        let mut rows = 0;
        for line in table.lines().filter(|line| !line.starts_with(['#', 'n'])) {
            let row: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
            let law = FrictionLaw {
                coefficient: 1.0,
                slip_tolerance: row[0],
                grain: None,
            };
            let traction = law.traction(&Vector3::z(), &Vector3::new(row[1], 0.0, 0.3));
            assert!((traction + Vector3::x() * row[2]).norm() < 1e-14, "{line}");
            rows += 1;
        }
        assert_eq!(rows, 16);
    }

    #[test]
    fn series_and_closed_form_of_the_smoothing_meet() {
        let law = FrictionLaw {
            coefficient: 1.0,
            slip_tolerance: 7.5,
            grain: None,
        }; // z = ρ
        let (below, rate_below) = law.smoothing(0.02 - 1e-12);
        let (above, rate_above) = law.smoothing(0.02 + 1e-12);
        assert!((below - above).abs() < 1e-13);
        assert!((rate_below - rate_above).abs() < 3e-12);
    }

    /// The friction law as printed, in dual numbers; the speed must not be zero.
    fn printed_traction<D: Dual>(normal: DualVector<D>, velocity: DualVector<D>) -> DualVector<D> {
        let slip = subtract(velocity, scale(normal, dot(velocity, normal)));
        let speed = norm(slip);
        let k2 = 15.0 / LAW.slip_tolerance;
        let gamma = ((-speed * k2).exp() + 1.0).recip() * 2.0 - 1.0;
        scale(slip, -gamma / speed * LAW.coefficient)
    }

    #[test]
    fn derivatives_of_the_traction() {
        let mut random = Random::new(3);
        for decade in -3..=3 {
            let speed = LAW.slip_tolerance * 10f64.powi(decade);
            for _ in 0..20 {
                let normal = random.vector().normalize();
                let velocity = random.vector() * speed;
                let found = LAW.traction_derivatives(&normal, &velocity, &slip(&normal, &velocity));
                assert_eq!(found.value, LAW.traction(&normal, &velocity));

                let fixed = [normal.x, normal.y, normal.z];
                let v = SVector::<f64, 3>::from(velocity);
                let (_, expected) = jacobian(
                    |v| SVector::from(printed_traction(fixed.map(From::from), v.into())),
                    &v,
                );
                let error = relative_error(found.by_velocity.as_slice(), expected.as_slice());
                assert!(error < 1e-8, "10^{decade}: {error:e}");

                // Turns of the normal: two directions in the tangent plane.
                let fixed = [velocity.x, velocity.y, velocity.z];
                let (_, expected) = jacobian(
                    |n| SVector::from(printed_traction(unit(n.into()), fixed.map(From::from))),
                    &normal,
                );
                let tangent = Matrix3::identity() - normal * normal.transpose();
                let by_turns = found.by_normal * tangent;
                let error = relative_error(by_turns.as_slice(), expected.as_slice());
                assert!(error < 1e-8, "10^{decade}: {error:e}");
            }
        }
    }

    #[test]
    fn friction_never_does_positive_work_and_is_bounded_by_coulomb() {
        let mut random = Random::new(5);
        for _ in 0..1000 {
            let normal = random.vector().normalize();
            let velocity = random.vector() * 3.0 * LAW.slip_tolerance;
            let traction = LAW.traction(&normal, &velocity);
            assert!(traction.dot(&velocity) <= 0.0);
            assert!(traction.norm() <= LAW.coefficient * (1.0 + 1e-15));
        }
    }
}
