//! Gap at rest between surfaces that carry contact forces.
//!
//! A force law N(g) carries a load at a nonzero gap: two rods of radius h that rest at a gap g
//! behave like touching rods of radius h + g/2. With the stiffness k and, for the implicit contact
//! model, r = 15 N h̄²/(2 k δ),
//!
//! - implicit contact (Eq. 2.15): ln(1 + eᵗ)/(1 + e⁻ᵗ) = r at t = −15 g/δ, so that g ≈ −(δ/30) ln r for r ≪ 1, which is
//!   always so at the adaptive stiffness k = s F, F = max‖F‖ near contact and at least EI/L² of the softer rod: a force N
//!   needs g ≈ (δ/30) ln(2 s δ F/(15 h̄² N));
//! - barrier (Eq. 2.1): w (w + 2 ln(1 + w))/(1 + w) = N h̄²/(k δ) at g = δ/(1 + w); with its stiffness, g = δ/2 at N = F, and
//!   g ≈ δ (1 − 0.63 √(N/F)) for much smaller forces;
//! - complementarity: g = 0.

use super::contact_system::ContactSystem;

impl ContactSystem {
    /// Mean gap between the surfaces in contact at the last evaluation, weighted by their normal
    /// forces, m: Σ N g/Σ N over all pairs of edges and all nodes at planes. Here g is the
    /// distance of the centrelines minus the sum of the radii, or the distance of a node from its
    /// plane minus its radius. Negative if the surfaces penetrate; `None` if no force acts.
    ///
    /// The weights exclude pairs that are near but carry no force, whatever the range of the force
    /// law.
    pub(crate) fn mean_gap(&self) -> Option<f64> {
        let edges = self.contacts().iter();
        let edges = edges.map(|one| (one.normal_force, one.distance - one.threshold));
        let planes = self.plane_contacts().iter();
        let planes = planes.map(|one| (one.normal_force, one.distance - one.threshold));
        let (force, moment) = edges.chain(planes).fold((0.0, 0.0), |sum, (force, gap)| {
            (sum.0 + force, sum.1 + force * gap)
        });
        (force > 0.0).then(|| moment / force)
    }
}

#[cfg(test)]
mod tests {
    use super::super::normal_law::NormalLaw;
    use super::super::parameters::{ContactModel, ContactParameters};
    use crate::mechanics::test_support::contact;

    /// Gap over δ at the part `load` of the largest force F on a node, at the adaptive stiffness.
    fn gap(model: ContactModel, radius: f64, tolerance: f64, load: f64) -> f64 {
        let parameters = ContactParameters {
            stiffness_factor: match model {
                ContactModel::IncrementalPotential => 1.0,
                _ => 1e5,
            },
            ..contact(model, tolerance)
        };
        // Only the ratio of the forces matters.
        let largest = 0.037;
        let stiffness = parameters.stiffness_per_force(radius) * largest;
        let law = NormalLaw::new(&parameters, radius, stiffness);
        law.gap_of_force(load * largest) / tolerance
    }

    /// The table of the guide.
    #[test]
    fn the_rest_gaps_of_the_guide_are_those_of_the_laws() {
        let guide = include_str!("../../../guide/contact.md");
        for (load, row) in [
            (10.0, "10"),
            (1.0, "1"),
            (0.1, "0.1"),
            (0.01, "0.01"),
            (1e-3, "0.001"),
        ] {
            let penalty = |h, delta| gap(ContactModel::ImplicitContact, h, delta, load);
            let barrier = gap(ContactModel::IncrementalPotential, 1.6e-3, 16e-6, load);
            let line = format!(
                "| {row} | {:.2} δ | {:.2} δ | {barrier:.2} δ | 0 |",
                penalty(1.6e-3, 16e-6),
                penalty(1.6e-3, 0.5e-3),
            );
            assert!(guide.contains(&line), "the guide lacks: {line}");
        }
    }

    #[test]
    fn the_limits_of_the_laws_hold() {
        for (radius, tolerance) in [(1e-4, 1e-6), (1.6e-3, 16e-6), (1e-2, 1e-3)] {
            for load in [1.0, 0.1, 1e-3_f64] {
                let argument = 2e5 * tolerance / (15.0 * radius * radius * load);
                let penalty = gap(ContactModel::ImplicitContact, radius, tolerance, load);
                assert!((penalty - argument.ln() / 30.0).abs() < 1e-3 * penalty);
            }
            let middle = gap(ContactModel::IncrementalPotential, radius, tolerance, 1.0);
            assert!((middle - 0.5).abs() < 1e-12);
            let far = gap(ContactModel::IncrementalPotential, radius, tolerance, 1e-6);
            let nearly = 1.0 - ((0.5 + std::f64::consts::LN_2) / 3.0 * 1e-6).sqrt();
            assert!((far - nearly).abs() < 1e-5);
        }
    }
}
