//! Dry friction by Coulomb's law.

use rodlab_engine::mechanics::kirchhoff::numerics::bisect;

/// Acceleration g (sin α − μ cos α) of a body that slides down an incline of angle α.
pub fn sliding_acceleration(gravity: f64, incline: f64, friction: f64) -> f64 {
    gravity * (libm::sin(incline) - friction * libm::cos(incline))
}

/// Square of the speed of a bead that slides down a hoop of a radius R, in a vertical plane, from
/// rest at the height of the centre, after the angle φ, (m/s)².
///
/// The wire carries g sin φ + v²/R per mass of the bead, so that dv²/dφ = 2gR (cos φ − μ sin φ) −
/// 2μ v².
pub fn speed_on_hoop_squared(gravity: f64, radius: f64, friction: f64, angle: f64) -> f64 {
    let square = friction * friction;
    let falling = (1.0 - 2.0 * square) * libm::sin(angle);
    let rubbing = 3.0 * friction * (libm::cos(angle) - libm::exp(-2.0 * friction * angle));
    2.0 * gravity * radius * (falling + rubbing) / (1.0 + 4.0 * square)
}

/// Acceleration g sin α/(1 + I/(m h²)) of a solid cylinder that rolls down an incline of angle α.
pub fn rolling_acceleration(gravity: f64, incline: f64) -> f64 {
    2.0 / 3.0 * gravity * libm::sin(incline)
}

/// Angular acceleration μ m g h cos α/I of a solid cylinder of a radius h that slips on it, rad/s².
pub fn spinning_acceleration(gravity: f64, incline: f64, friction: f64, radius: f64) -> f64 {
    2.0 * friction * gravity * libm::cos(incline) / radius
}

/// Final speed of a solid cylinder that is laid at rest on a moving belt, over the speed of the belt.
///
/// Friction moves and turns it by the same impulse, m v = I ω/h, until v + ω h is the speed of the
/// belt.
pub const PART_OF_BELT: f64 = 1.0 / 3.0;

/// A rope of bending stiffness EI that slides around a post and turns by the total angle φ.
///
/// On the post the curvature is 1/ρ (ρ: radius of the rope's centreline) and the tension grows
/// with the angle as in Euler's capstan. A leg of tension T turns by a further angle ψ, T (1 − cos
/// ψ) = EI/2ρ², after it has left the post, since its bending moment decays over some length. At
/// the last contact, T = t + EI/2ρ² with the tension t at the post. The shear force T sin ψ is
/// carried by a concentrated contact force, which also causes friction:
///
/// T₂ − EI/2ρ² − μ T₂ sin ψ₂ = (T₁ − EI/2ρ² + μ T₁ sin ψ₁) exp(μ (φ − ψ₁ − ψ₂)).
///
/// Without bending stiffness this is Euler's T₂ = T₁ exp(μφ). Derivation: on a leg, n·t + EI κ²/2
/// = T is constant; at the post κ is continuous, and n·t' = μ n·t/ρ on it. The shear force jumps
/// from T sin ψ to zero at the first contact.
#[derive(Clone, Copy, Debug)]
pub struct Capstan {
    /// Friction coefficient μ.
    pub friction: f64,
    /// Total turning angle φ between the legs, rad.
    pub angle: f64,
    /// Bending stiffness EI, N m².
    pub bending: f64,
    /// Radius ρ of the centreline around the post, m.
    pub radius: f64,
}

impl Capstan {
    /// Larger tension T₂ for the smaller T₁, N.
    pub fn greater_tension(&self, lesser: f64) -> f64 {
        let excess = self.bending / (2.0 * self.radius * self.radius);
        let turning = |tension: f64| libm::acos(1.0 - excess / tension);
        let rubbing = |tension: f64| self.friction * tension * libm::sin(turning(tension));
        let start = lesser - excess + rubbing(lesser);
        let imbalance = |greater: f64| {
            let contact_angle = self.angle - turning(lesser) - turning(greater);
            greater - excess - rubbing(greater) - start * libm::exp(self.friction * contact_angle)
        };
        let largest = 2.0 * lesser * libm::exp(self.friction * self.angle);
        bisect(lesser, largest, imbalance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn ratio(bending: f64) -> f64 {
        let capstan = Capstan {
            friction: 0.3,
            angle: PI,
            bending,
            radius: 1.0,
        };
        capstan.greater_tension(2.0) / 2.0
    }

    #[test]
    fn a_limp_rope_obeys_euler() {
        assert!((ratio(0.0) / (0.3 * PI).exp() - 1.0).abs() < 1e-14);
    }

    #[test]
    fn bending_matters_to_second_order_in_the_turning_of_the_legs() {
        // ψ₁ = 0.1 and 0.05: the concentrated forces compensate for the angles ψ without contact.
        let deviation = |bending: f64| (ratio(bending) / ratio(0.0) - 1.0).abs();
        let (stiff, soft) = (deviation(2e-2), deviation(5e-3));
        assert!(
            stiff < 6e-3 && (3.0..6.0).contains(&(stiff / soft)),
            "{stiff} {soft}"
        );
    }
}
