//! The energy that contacts bring into a step.

use super::{Stage, System};
use crate::mechanics::Vector3;
use crate::mechanics::contact::ContactSystem;
use crate::mechanics::rod::topology::position;

/// Energy that counts as none, of the kinetic and elastic energy of the scene.
const NEGLIGIBLE: f64 = 1e-3;
/// The same of what all contact forces do over the distance tolerance δ.
const NEGLIGIBLE_WAY: f64 = 0.2;

impl System {
    /// Energy that contacts bring into a step that ends at `unknowns`, where they were evaluated last, J, where it is not
    /// negligible; of contact forces that are functions of the gaps.
    ///
    /// The energy k φ(g) of a contact is convex in its gap. As long as the gap is nearly linear in the positions, an implicit step
    /// takes no more out of it than it held: f·(x₁ − x₀) ≤ k φ(g₀) − k φ(g₁). Rods that move around each other by a good part
    /// of their thickness within a step are pushed apart along a normal that has turned meanwhile.
    pub fn work_of_contact(&self, stage: &Stage, unknowns: &[f64]) -> Option<f64> {
        let contact = self.contact.as_ref()?;
        let (work, forces) = work_and_forces(contact, stage, unknowns);
        let way = NEGLIGIBLE_WAY * contact.parameters().distance_tolerance * forces;
        let kinetic = self.kinetic_energy_at_start(stage);
        let is_small = |made: f64, energy: f64| made <= NEGLIGIBLE * energy + way;
        // Before the step they held something, too: that is looked at only where it matters.
        let most = work + contact.energy();
        if is_small(most, kinetic) {
            return None;
        }
        let energy = kinetic + self.elastic_energy().total();
        if is_small(most, energy) {
            return None;
        }
        let mut before = contact.clone();
        before.evaluate_forces(&stage.positions, &stage.positions, f64::INFINITY);
        let made = most - before.energy();
        (!is_small(made, energy)).then_some(made)
    }
}

/// f·(x₁ − x₀) and |f|, summed over the contacts.
fn work_and_forces(contact: &ContactSystem, stage: &Stage, unknowns: &[f64]) -> (f64, f64) {
    let moved = |node: usize| position(unknowns, node) - stage.positions[node];
    let (mut work, mut forces) = (0.0, 0.0);
    for pair in contact.contacts() {
        forces += pair.normal_force.abs();
        for (node, force) in pair.nodes.iter().zip(pair.force.chunks_exact(3)) {
            work += Vector3::new(force[0], force[1], force[2]).dot(&moved(*node));
        }
    }
    for touched in contact.plane_contacts() {
        forces += touched.normal_force.abs();
        work += Vector3::from(touched.force).dot(&moved(touched.node));
    }
    (work, forces)
}
