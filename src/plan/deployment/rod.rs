//! A rod that is laid on a table.

/// What of a rod matters for laying it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeployedRod {
    /// L_gb, (E h²/(8ρg))^(1/3), m.
    pub gravito_bending_length: f64,
    /// h, m.
    pub radius: f64,
    /// L, m.
    pub length: f64,
}

impl DeployedRod {
    /// k̄_s = k_s L_gb²/EI = 4 L_gb²/h² of a round rod (thesis Eq. 5.10).
    pub fn stretch_stiffness(&self) -> f64 {
        4.0 * (self.gravito_bending_length / self.radius).powi(2)
    }
}
