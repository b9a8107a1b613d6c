//! A rod for laying on a table.

use serde::{Deserialize, Serialize};

/// Parameters of a rod for laying.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DeployedRod {
    /// L_gb, (E h²/(8ρg))^(1/3), m.
    pub gravito_bending_length: f64,
    /// h, m.
    pub radius: f64,
    /// L, m.
    pub length: f64,
}

impl DeployedRod {
    /// The green rod of the thesis.
    #[cfg(test)]
    pub(super) const GREEN: Self = Self {
        gravito_bending_length: 0.032,
        radius: 0.0016,
        length: 0.885,
    };

    /// k̄_s = k_s L_gb²/EI = 4 L_gb²/h² of a round rod (thesis Eq. 5.10).
    pub fn stretch_stiffness(&self) -> f64 {
        4.0 * (self.gravito_bending_length / self.radius).powi(2)
    }

    /// Young's modulus of a round rod with a density (kg/m³) in a gravity (m/s²), Pa: L_gb³ = E
    /// h²/(8 ρ g).
    pub fn youngs_modulus(&self, density: f64, gravity: f64) -> f64 {
        8.0 * density * gravity * self.gravito_bending_length.powi(3) / self.radius.powi(2)
    }

    /// Length of the freely hanging rod, stretched by its own weight, m: L (1 + l̄/(4 k̄_s)), l̄ =
    /// L/L_gb.
    pub fn hanging_length(&self) -> f64 {
        let relative = self.length / self.gravito_bending_length;
        self.length * (1.0 + 0.25 * relative / self.stretch_stiffness())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stiffness_and_stretch_follow_from_the_gravito_bending_length() {
        let rod = DeployedRod::GREEN;
        let (density, gravity) = (1180.0, 9.81);
        let modulus = rod.youngs_modulus(density, gravity);
        let back = libm::cbrt(modulus * rod.radius.powi(2) / (8.0 * density * gravity));
        assert!((back - 0.032).abs() < 1e-15);
        // Lengthening of a bar under its own weight: ρ g L²/2E.
        let stretch = density * gravity * rod.length.powi(2) / (2.0 * modulus);
        assert!((rod.hanging_length() - rod.length - stretch).abs() < 1e-12);
    }
}
