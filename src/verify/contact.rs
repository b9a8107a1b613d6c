//! Two rods that collide and rub, with every contact model: no penetration, momentum, energy,
//! Coulomb's law.

use super::rods::{RADIUS, line, steps_of, unit_rod};
use super::{Check, Expectation, GroupError};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::contact::{ActiveContact, ContactModel, ContactParameters};
use rodlab_engine::mechanics::dynamics::Simulation;
use rodlab_engine::mechanics::scene::{RodDescription, Scene};

const PENETRATION: Expectation = Expectation::new("max(0, 1 − Δ/2h) = 0", "Signorini");
const MOMENTUM: Expectation = Expectation::new("|Σ F| / Σ |F| = 0", "Newton");
const ENERGY: Expectation = Expectation::new("max(0, E/E₀ − 1) = 0", "second law");
const COULOMB: Expectation = Expectation::new("max |T|/N = μ", "Coulomb");

/// The contact models with their names in scenario files, and the penetration that each allows at
/// the end of a step.
///
/// A penalty needs some penetration; rigid contact has one within the tolerance of Newton's
/// method; a barrier has none.
const MODELS: [(ContactModel, &str, f64); 3] = [
    (ContactModel::ImplicitContact, "imc", 0.02),
    (ContactModel::IncrementalPotential, "ipc", 0.0),
    (ContactModel::Complementarity, "complementarity", 1e-4),
];
const FRICTION: f64 = 0.3;
const LENGTH: f64 = 0.2;
const EDGES: usize = 10;

/// Collisions with all models, and one that is so fast that only a barrier detects it.
pub fn checks(_full: bool) -> Result<Vec<Check>, GroupError> {
    let mut checks = Vec::new();
    for (model, name, penetration) in MODELS {
        let seen = collide(model, Vector3::new(0.3, 0.1, -0.5), 1e-4, 400)?;
        let row = |what: &str| format!("colliding rods, {name}: {what}");
        checks.extend([
            PENETRATION
                .of(row("penetration"), "")
                .zero(seen.penetration, penetration),
            MOMENTUM
                .of(row("sum of the contact forces"), "")
                .zero(seen.imbalance, 1e-10),
            ENERGY
                .of(row("gain of energy between contacts"), "")
                .zero(seen.gain, 1e-9),
            COULOMB.of(row("friction over normal force"), "").relative(
                FRICTION,
                seen.friction,
                1e-6,
            ),
        ]);
    }
    let fast = Vector3::new(0.3, 0.1, -20.0);
    let shot = collide(ContactModel::IncrementalPotential, fast, 1e-3, 40)?;
    let name = "rod shot at a rod, ten diameters a step, ipc: penetration";
    checks.push(PENETRATION.of(name, "").zero(shot.penetration, 0.0));
    Ok(checks)
}

/// Contact parameters of a model, with its default stiffness.
pub(super) fn contact_parameters(model: ContactModel, friction: f64) -> ContactParameters {
    let defaults = ContactParameters::default();
    ContactParameters {
        model,
        friction,
        stiffness_factor: match model {
            ContactModel::IncrementalPotential => 1.0,
            _ => defaults.stiffness_factor,
        },
        ..defaults
    }
}

/// Measures of a collision; NaN if there was none.
struct Collision {
    /// Largest penetration, as a fraction of the diameter.
    penetration: f64,
    /// Largest sum of the contact forces relative to the sum of their magnitudes.
    imbalance: f64,
    /// Largest gain of energy from a time with contact to a later time without contact.
    gain: f64,
    /// Largest ratio of friction to normal force.
    friction: f64,
}

/// Two free rods, one of them thrown at the other.
fn collide(
    model: ContactModel,
    velocity: Vector3,
    step: f64,
    steps: usize,
) -> Result<Collision, GroupError> {
    let mut simulation = Simulation::new(&scene(model, velocity), &steps_of(step))?;
    let before = energy(&simulation);
    let (mut distance, mut friction, mut imbalance, mut gain) =
        (f64::INFINITY, f64::NAN, f64::NAN, f64::NAN);
    for _ in 0..steps {
        let report = simulation.advance(f64::INFINITY)?;
        distance = distance.min(simulation.minimum_distance());
        let contacts = simulation.contacts();
        let loaded = contacts.iter().filter(|c| c.normal_force > 0.0);
        friction = loaded.map(friction_ratio).fold(friction, f64::max);
        let forces = simulation.contact_forces();
        let size: f64 = forces.iter().map(|force| force.norm()).sum();
        if size > 0.0 {
            let sum: Vector3 = forces.iter().sum();
            imbalance = imbalance.max(sum.norm() / size);
        }
        if report.contacts == 0 && !friction.is_nan() {
            gain = gain.max((energy(&simulation) / before - 1.0).max(0.0));
        }
    }
    let touched = !friction.is_nan();
    Ok(Collision {
        penetration: if touched {
            (1.0 - distance / (2.0 * RADIUS)).max(0.0)
        } else {
            f64::NAN
        },
        imbalance,
        gain,
        friction,
    })
}

/// The rods do not cross at right angles, at their middles or at nodes.
fn scene(model: ContactModel, velocity: Vector3) -> Scene {
    let half = 0.5 * LENGTH;
    let straight = |middle: Vector3, direction: Vector3| {
        let end = direction.normalize() * half;
        unit_rod(line(middle - end, middle + end, EDGES))
    };
    let above = Vector3::new(0.006, 0.004, 3.0 * RADIUS);
    Scene {
        rods: vec![
            straight(Vector3::zeros(), Vector3::x()),
            RodDescription {
                name: "thrown".into(),
                velocity,
                ..straight(above, Vector3::new(0.3, 1.0, 0.0))
            },
        ],
        contact: Some(contact_parameters(model, FRICTION)),
        ..Scene::default()
    }
}

/// Kinetic and elastic energy, J.
fn energy(simulation: &Simulation) -> f64 {
    let energies = simulation.energies();
    energies.kinetic + energies.elastic()
}

/// Ratio T/N of the force between two edges: N along their normal, T perpendicular to it.
fn friction_ratio(contact: &ActiveContact) -> f64 {
    let on_first_edge: Vector3 = contact.force[..6]
        .chunks_exact(3)
        .map(Vector3::from_column_slice)
        .sum();
    let normal = contact.normal.normalize();
    let along = on_first_edge.dot(&normal);
    (on_first_edge - normal * along).norm() / along
}
