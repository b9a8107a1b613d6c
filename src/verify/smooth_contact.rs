//! The pressure of a stretched ring on a held rod, by contact of smooth curves.

use super::contact::contact_parameters;
use super::rods::{line, run_until, steps_of};
use super::{Check, Expectation, GroupError};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::contact::{ContactModel, ContactParameters, Geometry};
use rodlab_engine::mechanics::dynamics::Simulation;
use rodlab_engine::mechanics::scene::{NaturalShape, RodDescription, Scene, Stiffness};
use std::f64::consts::TAU;

const PRESSURE: Expectation = Expectation::new("Σ N = 2π T", "balance of a ring, p = T/R");

const RADIUS: f64 = 5e-3;
const EDGES: usize = 18;
const SECTION: Stiffness = Stiffness {
    stretching: 200.0,
    bending: [1e-3; 2],
    twisting: 1e-3,
};
/// Strain of the ring as placed.
const STRETCH: f64 = 0.3;

/// A ring of edges of about one radius, stretched over a rod of twice its radius.
pub fn checks(_full: bool) -> Result<Vec<Check>, GroupError> {
    let models = [
        (ContactModel::ImplicitContact, "imc"),
        (ContactModel::IncrementalPotential, "ipc"),
    ];
    let rows = models.map(|(model, name)| {
        let [expected, found] = pressed(model)?;
        let row =
            format!("ring stretched over a rod, smooth geometry, {name}: sum of its pressure");
        Ok(PRESSURE.of(row, "N").relative(expected, found, 1e-2))
    });
    rows.into_iter().collect()
}

/// The expected and the found sum of the contact forces of the ring at rest, N.
fn pressed(model: ContactModel) -> Result<[f64; 2], GroupError> {
    let step = TAU / EDGES as f64;
    // Nodes of a polyline that touches the inner circle.
    let placed = 3.02 * RADIUS / libm::cos(0.5 * step);
    let ring = (0..EDGES).map(|k| {
        let angle = step * k as f64;
        Vector3::new(libm::cos(angle), libm::sin(angle), 0.0) * placed
    });
    let mut ring = RodDescription::uniform("ring", ring.collect(), SECTION, RADIUS, 1e-2);
    ring.closed = true;
    ring.natural_shape = NaturalShape::AsPlaced;
    ring.pretension = SECTION.stretching * STRETCH;
    let [bottom, top] = [-1.0, 1.0].map(|z| Vector3::z() * (10.0 * RADIUS * z));
    let mut post =
        RodDescription::uniform("post", line(bottom, top, 2), SECTION, 2.0 * RADIUS, 1e-2);
    post.held = true;
    let scene = Scene {
        rods: vec![ring, post],
        contact: Some(ContactParameters {
            geometry: Geometry::Smooth,
            distance_tolerance: 0.01 * RADIUS,
            ..contact_parameters(model, 0.0)
        }),
        ..Scene::default()
    };
    let mut simulation = Simulation::new(&scene, &steps_of(1e-2))?;
    run_until(&mut simulation, 1.0)?;
    let radius = 3.0 * RADIUS + simulation.mean_gap().unwrap_or(f64::NAN);
    let tension = SECTION.stretching * (radius * (1.0 + STRETCH) / placed - 1.0);
    let contacts = simulation.contacts();
    let found = contacts.iter().map(|contact| contact.normal_force).sum();
    Ok([TAU * tension, found])
}
