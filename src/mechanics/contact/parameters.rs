//! Parameters of the contact model.

/// Parameters of the implicit contact model (thesis 2.2–2.3).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactParameters {
    /// Distance tolerance δ, m: force acts within δ of the surfaces (Eq. 2.2).
    /// Smaller is more exact and stiffer; the thesis uses 1e-5 m for a radius of 1 mm.
    pub distance_tolerance: f64,
    /// Friction coefficient μ.
    pub friction: f64,
    /// Slip tolerance ν, m/s: slower sliding counts as sticking (Eq. 2.10).
    pub slip_tolerance: f64,
    /// Factor s of the adaptive contact stiffness k = s max‖F‖ (Eq. 2.19).
    pub stiffness_factor: f64,
    /// Penetration that ends the run, as a fraction of the sum of the two radii.
    pub maximum_penetration: f64,
}

impl Default for ContactParameters {
    fn default() -> Self {
        Self {
            distance_tolerance: 1e-5,
            friction: 0.0,
            slip_tolerance: 1e-4,
            stiffness_factor: 1e5,
            maximum_penetration: 0.05,
        }
    }
}
