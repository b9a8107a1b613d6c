//! Contact: broad phase, distance filter, evaluation of active contacts.
//!
//! The geometry is that of ten flagella of 67 edges (radius 1 mm), loose and bundled.

use criterion::{Criterion, criterion_group, criterion_main};
use rodlab::mechanics::Vector3;
use rodlab::mechanics::contact::{ContactParameters, ContactSurface, ContactSystem};
use std::hint::black_box;

const RADIUS: f64 = 1e-3;
const RODS: usize = 10;
const NODES: usize = 68;

/// Parallel helices (radius 1 cm, pitch 5 cm, 20 cm long) on a circle of the given radius.
fn flagella(circle: f64, friction: f64) -> (ContactSystem, Vec<Vector3>) {
    let mut surface = ContactSurface::new();
    let mut positions = Vec::new();
    for rod in 0..RODS {
        let place = std::f64::consts::TAU * rod as f64 / RODS as f64;
        let centreline: Vec<Vector3> = (0..NODES)
            .map(|k| {
                let height = 0.2 * k as f64 / (NODES - 1) as f64;
                // The phases of the rods differ, so that edges of neighbours cross at an angle.
                let turn = std::f64::consts::TAU * height / 0.05 + 0.05 * (rod % 3) as f64;
                Vector3::new(
                    circle * libm::cos(place) + 0.01 * libm::cos(turn),
                    circle * libm::sin(place) + 0.01 * libm::sin(turn),
                    height,
                )
            })
            .collect();
        surface.add_rod(positions.len(), &centreline, false, RADIUS, false);
        positions.extend(centreline);
    }
    let parameters = ContactParameters {
        friction,
        ..ContactParameters::default()
    };
    (
        ContactSystem::new(parameters, surface, Vec::new(), 1e-3),
        positions,
    )
}

/// Distance between neighbours on the circle.
fn circle_of_spacing(spacing: f64) -> f64 {
    0.5 * spacing / libm::sin(std::f64::consts::PI / RODS as f64)
}

fn broad_phase(criterion: &mut Criterion) {
    for (name, spacing) in [("loose", 3.7 * RADIUS), ("bundled", 2.3 * RADIUS)] {
        let (mut contact, positions) = flagella(circle_of_spacing(spacing), 0.0);
        // The distance between the two states exceeds the margin, so that every update rebuilds
        // the set.
        let shifted: Vec<Vector3> = positions.iter().map(|x| x + Vector3::z()).collect();
        contact.update_candidates(&positions);
        let candidates = contact.candidates().len();
        criterion.bench_function(
            &format!("broad phase, 670 edges, {name}, {candidates} pairs"),
            |b| {
                let mut states = [&positions, &shifted].into_iter().cycle();
                b.iter(|| contact.update_candidates(black_box(states.next().unwrap())))
            },
        );
    }
}

fn distance_filter(criterion: &mut Criterion) {
    for (name, motion) in [
        ("at rest", 0.0),
        ("after a quarter of the margin", 0.49 * RADIUS),
        ("after half the margin", 0.98 * RADIUS),
    ] {
        // The rods are bundled, with gaps between their surfaces.
        let (mut contact, positions) = flagella(circle_of_spacing(3.7 * RADIUS), 0.0);
        contact.update_candidates(&positions);
        let moved: Vec<Vector3> = positions
            .iter()
            .map(|x| x + Vector3::x() * motion)
            .collect();
        contact.evaluate(&moved, &moved, f64::INFINITY);
        let (candidates, active) = (contact.candidates().len(), contact.contacts().len());
        criterion.bench_function(
            &format!("distance filter, {candidates} candidates, {active} active, {name}"),
            |b| b.iter(|| contact.evaluate(black_box(&moved), &moved, f64::INFINITY)),
        );
    }
}

fn evaluation(criterion: &mut Criterion) {
    for (name, friction, with_jacobians) in [
        ("forces", 0.0, false),
        ("forces and Jacobians", 0.0, true),
        ("forces with friction", 0.3, false),
        ("forces and Jacobians with friction", 0.3, true),
    ] {
        let (mut contact, positions) = flagella(circle_of_spacing(1.98 * RADIUS), friction);
        contact.update_candidates(&positions);
        let previous: Vec<Vector3> = positions
            .iter()
            .enumerate()
            .map(|(k, x)| x - Vector3::new(1e-8, 2e-8, 3e-8) * (k % 7) as f64)
            .collect();
        contact.evaluate(&positions, &previous, 1e-3);
        let active = contact.contacts().len();
        criterion.bench_function(&format!("{name}, {active} contacts"), |b| {
            b.iter(|| {
                if with_jacobians {
                    contact.evaluate(black_box(&positions), &previous, 1e-3);
                } else {
                    contact.evaluate_forces(black_box(&positions), &previous, 1e-3);
                }
            })
        });
    }
}

criterion_group!(benches, broad_phase, distance_filter, evaluation);
criterion_main!(benches);
