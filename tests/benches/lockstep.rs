//! Sixty-four wires of 48 edges between two moving clamps, in one step of 10 ms: separately and in
//! lockstep, in one thread.

use criterion::{Criterion, criterion_group, criterion_main};
use rodlab::mechanics::Vector3;
use rodlab::mechanics::dynamics::{IntegrationParameters, Lockstep, Simulation, StepSize};
use rodlab::mechanics::scene::{Clamp, Load, LoadKind, Motion, RodDescription, Scene, Stiffness};

const WIRES: usize = 64;
const EDGES: usize = 48;
const STEP: f64 = 1e-2;

fn wires() -> Vec<Simulation> {
    let nodes = (0..=EDGES).map(|k| Vector3::x() * (0.6 * k as f64 / EDGES as f64));
    let stiffness = Stiffness {
        stretching: 565.0,
        bending: [1.27e-3; 2],
        twisting: 8.5e-4,
    };
    let clamp = |node| Clamp {
        rod: 0,
        node,
        holds_position: true,
        holds_frame: true,
        motion: Motion::default(),
    };
    let scene = Scene {
        rods: vec![RodDescription::uniform(
            "wire",
            nodes.collect(),
            stiffness,
            3e-3,
            0.034,
        )],
        clamps: vec![clamp(0), clamp(EDGES)],
        loads: vec![Load {
            kind: LoadKind::Gravity {
                acceleration: Vector3::z() * -9.81,
            },
            schedule: Vec::new(),
        }],
        ..Scene::default()
    };
    let parameters = IntegrationParameters {
        step: StepSize::Fixed(STEP),
        ..IntegrationParameters::default()
    };
    let wire = || Simulation::new(&scene, &parameters).expect("a sound scene");
    (0..WIRES).map(|_| wire()).collect()
}

/// Moves both ends towards each other, with a swing; returns the end of the step.
fn carry(wires: &mut [Simulation]) -> f64 {
    let until = wires[0].time() + STEP;
    for (case, wire) in wires.iter_mut().enumerate() {
        let phase = 3.0 * until + case as f64;
        let swing =
            Vector3::new(0.1, 0.05 * libm::sin(phase), 0.05 * libm::cos(phase)) * until.min(1.0);
        for (clamp, place) in [(0, swing), (1, Vector3::x() * 0.6 - swing)] {
            wire.carry_clamp(clamp, place, None, until)
                .expect("it is held");
        }
    }
    until
}

fn lockstep(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("64 wires of 48 edges, a step");
    let mut alone = wires();
    group.bench_function("alone", |bencher| {
        bencher.iter(|| {
            let until = carry(&mut alone);
            for wire in &mut alone {
                wire.advance(until).expect("converges");
            }
        });
    });
    let (mut together, mut lockstep) = (wires(), Lockstep::default());
    group.bench_function("in lockstep", |bencher| {
        bencher.iter(|| {
            let until = carry(&mut together);
            let mut pairs: Vec<_> = together.iter_mut().map(|wire| (wire, until)).collect();
            for result in lockstep.advance(&mut pairs, &|| true) {
                result.expect("converges");
            }
        });
    });
    group.finish();
}

criterion_group!(benches, lockstep);
criterion_main!(benches);
