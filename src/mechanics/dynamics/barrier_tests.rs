//! Incremental potential contact in motion: nothing ever crosses, and the rest is as with the implicit
//! contact model.

use super::tests::{clamp, straight_rod};
use super::*;
use crate::mechanics::Vector3;
use crate::mechanics::contact::{ContactModel, ContactParameters};
use crate::mechanics::scene::{NaturalShape, RodDescription, Scene};

const RADIUS: f64 = 5e-3;
const DIAMETER: f64 = 2.0 * RADIUS;

fn parameters(model: ContactModel, friction: f64) -> ContactParameters {
    let barrier = model == ContactModel::IncrementalPotential;
    ContactParameters {
        model,
        distance_tolerance: 5e-5,
        friction,
        stiffness_factor: if barrier { 1.0 } else { 1e5 },
        ..ContactParameters::default()
    }
}

/// A rod of 10 edges and 20 cm along `direction`, its middle at `middle`.
fn rod(name: &str, middle: Vector3, direction: Vector3) -> RodDescription {
    RodDescription {
        name: name.into(),
        centreline: (0..=10)
            .map(|k| middle + direction * (0.02 * (f64::from(k) - 5.0)))
            .collect(),
        first_director: Some(Vector3::z()),
        natural_shape: NaturalShape::Straight,
        ..straight_rod(10, 0.2)
    }
}

/// A rod clamped at both ends, and another across it, `gap` above.
fn crossing(model: ContactModel, gap: f64, friction: f64) -> Scene {
    let mut end = clamp(10);
    end.rod = 0;
    Scene {
        rods: vec![
            rod("lower", Vector3::zeros(), Vector3::x()),
            rod("upper", Vector3::z() * (DIAMETER + gap), Vector3::y()),
        ],
        clamps: vec![clamp(0), end],
        contact: Some(parameters(model, friction)),
        ..Scene::default()
    }
}

fn fixed(step: f64) -> IntegrationParameters {
    IntegrationParameters {
        step: StepSize::Fixed(step),
        ..IntegrationParameters::default()
    }
}

#[test]
fn a_rod_shot_at_another_never_passes_through() {
    // 20 m/s cross a diameter in half a millisecond: in steps of 2 ms the unhindered way is four diameters.
    for (step, speed) in [(1e-4, 20.0), (2e-3, 20.0), (1e-2, 5.0)] {
        let mut scene = crossing(ContactModel::IncrementalPotential, 0.01, 0.0);
        scene.rods[1].velocity = Vector3::z() * -speed;
        let mut simulation = Simulation::new(&scene, &fixed(step)).unwrap();
        let (mut least, mut touched) = (f64::INFINITY, 0);
        for _ in 0..40 {
            let report = simulation.advance(f64::INFINITY).unwrap();
            touched += report.contacts;
            least = least.min(simulation.minimum_distance());
        }
        println!(
            "step {step}: least distance {:.9} diameters",
            least / DIAMETER
        );
        assert!(touched > 0);
        assert!(least > DIAMETER);
        let above = |rod: usize, node: usize| simulation.positions()[11 * rod + node].z;
        assert!(
            above(1, 5) > above(0, 5) + 0.9 * DIAMETER,
            "the order has changed"
        );
    }
}
