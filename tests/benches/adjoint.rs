//! A cantilever of 500 edges that swings for 400 steps, and the derivatives of the position of its
//! tip with respect to the two natural curvatures of every node, 1,000 parameters.

use criterion::{Criterion, criterion_group, criterion_main};
use rodlab::mechanics::Vector3;
use rodlab::mechanics::dynamics::adjoint::Recording;
use rodlab::mechanics::dynamics::{IntegrationParameters, Simulation, StepSize};
use rodlab::mechanics::scene::{Clamp, Load, LoadKind, Motion, RodDescription, Scene, Stiffness};

const EDGES: usize = 500;
const STEPS: usize = 400;
const STEP: f64 = 2e-3;

fn scene() -> Scene {
    let nodes = (0..=EDGES).map(|k| Vector3::x() * (0.6 * k as f64 / EDGES as f64));
    let stiffness = Stiffness {
        stretching: 565.0,
        bending: [1.27e-3; 2],
        twisting: 8.5e-4,
    };
    Scene {
        rods: vec![RodDescription::uniform(
            "wire",
            nodes.collect(),
            stiffness,
            3e-3,
            0.034,
        )],
        clamps: vec![Clamp {
            rod: 0,
            node: 0,
            holds_position: true,
            holds_frame: true,
            motion: Motion::default(),
        }],
        loads: vec![Load {
            kind: LoadKind::Gravity {
                acceleration: Vector3::new(0.0, 2.0, -9.81),
            },
            schedule: Vec::new(),
        }],
        ..Scene::default()
    }
}

fn adjoint(criterion: &mut Criterion) {
    let parameters = IntegrationParameters {
        step: StepSize::Fixed(STEP),
        ..IntegrationParameters::default()
    };
    let end = STEP * STEPS as f64;
    let mut group = criterion.benchmark_group("400 steps of 500 edges");
    group.sample_size(10);
    group.bench_function("run", |bencher| {
        bencher.iter(|| {
            let mut simulation = Simulation::new(&scene(), &parameters).expect("a sound scene");
            while simulation.time() < end {
                simulation.advance(end).expect("converges");
            }
            simulation.positions()[EDGES]
        });
    });
    let mut recording = Recording::new(&scene(), &parameters).expect("a sound scene");
    while recording.simulation().time() < end {
        recording.advance(end).expect("converges");
    }
    let height = |simulation: &Simulation| vec![simulation.positions()[EDGES].z];
    group.bench_function("derivatives of one result", |bencher| {
        bencher.iter(|| {
            recording
                .gradients(&height)
                .expect("a motion with derivatives")
        });
    });
    let place = |simulation: &Simulation| {
        let tip = simulation.positions()[EDGES];
        vec![tip.x, tip.y, tip.z]
    };
    group.bench_function("derivatives of three results", |bencher| {
        bencher.iter(|| {
            recording
                .gradients(&place)
                .expect("a motion with derivatives")
        });
    });
    group.finish();
}

criterion_group!(benches, adjoint);
criterion_main!(benches);
