//! Rods of viscous material.

use super::*;
use crate::mechanics::Vector3;
use crate::mechanics::rod::STRIDE;
use crate::mechanics::scene::{NaturalShape, Relaxation, RodDescription, Scene};
use crate::mechanics::system::{Stage, System};
use crate::mechanics::test_support::{
    advance_to, assert_close_in, clamp, curved, farthest, fixed_steps, section, weight,
};

const LENGTH: f64 = 0.4;

fn rod(closed: bool) -> RodDescription {
    let nodes = if closed { 9 } else { 11 };
    let node = |k: usize| {
        let s = k as f64 / 10.0;
        let angle = std::f64::consts::TAU * k as f64 / 9.0;
        match closed {
            true => Vector3::new(angle.cos(), angle.sin(), 0.2 * (2.0 * angle).sin()) * 0.06,
            false => Vector3::new(s, 0.2 * (3.0 * s).sin(), 0.1 * s * s) * LENGTH,
        }
    };
    let stiffness = section(30.0, [0.02, 0.05], 0.03);
    RodDescription {
        closed,
        retardation_time: 0.05,
        natural_shape: curved([0.7, -0.4], 0.5),
        ..RodDescription::uniform("rod", (0..nodes).map(node).collect(), stiffness, 4e-3, 0.02)
    }
}

fn scene() -> Scene {
    Scene {
        rods: vec![rod(false)],
        clamps: vec![clamp(0, 0)],
        loads: vec![weight(Vector3::new(0.0, 1.0, -9.81))],
        ..Scene::default()
    }
}

fn parameters(scheme: Scheme) -> IntegrationParameters {
    fixed_steps(scheme, 2e-3)
}

/// The unknowns displaced by some thousandths, differently for every `seed`.
fn moved(unknowns: &[f64], held: &[bool], seed: f64) -> Vec<f64> {
    let shift = |k: usize| match held[k] {
        true => 0.0,
        false => 4e-3 * (7.3 * k as f64 + seed).sin(),
    };
    unknowns
        .iter()
        .enumerate()
        .map(|(k, q)| q + shift(k))
        .collect()
}

/// Without inertia, only the forces of springs and dashpots count.
fn stage(system: &System, start: &[f64], step: f64) -> Stage {
    let mut positions = vec![Vector3::zeros(); system.assembly.rods.nodes];
    crate::mechanics::system::copy_positions(start, &mut positions);
    Stage {
        step,
        acceleration_step: f64::INFINITY,
        keeps_spin: false,
        start: start.to_vec(),
        velocity: vec![0.0; start.len()],
        drag: Vec::new(),
        drag_velocity: Vec::new(),
        resistance: Vec::new(),
        flow_torque: Vec::new(),
        positions,
        angles: crate::mechanics::system::angles_of(start),
    }
}

#[test]
fn forces_are_those_of_dashpots_and_the_jacobian_is_their_derivative() {
    for closed in [false, true] {
        let mut scene = scene();
        scene.rods = vec![rod(closed)];
        scene.loads.clear();
        if closed {
            scene.clamps.clear();
        }
        let mut system = System::new(&scene).unwrap();
        let placed = system.assembly.unknowns.clone();
        let held = system.assembly.held.clone();
        let [earliest, last, start, end] =
            [0.0, 1.0, 2.0, 3.0].map(|seed| moved(&placed, &held, seed));
        for unknowns in [&earliest, &last] {
            system.begin_damping(unknowns);
            system
                .terms
                .damping
                .keep(&system.assembly, &system.geometry);
        }
        system.begin_damping(&start);
        let step = 0.02;
        system.damp(step, step, [-0.3, 0.1]);
        let stage = stage(&system, &start, step);
        // T/H: the dashpots hold ½ T/H K (ε − ε̂)². If ε̂ = εₙ, `viscous_loss` is twice that.
        let mut other = System::new(&scene).unwrap();
        other.begin_damping(&start);
        other.damp(step, step, [0.0; 2]);
        let energy = |system: &mut System, unknowns: &[f64]| {
            system.evaluate(unknowns, Some(&stage));
            system.elastic_energy().total() + 0.5 * system.viscous_loss()
        };
        other.evaluate(&end, Some(&stage));
        let forces = other.residual.clone();
        let shift = 1e-6;
        let largest = forces.iter().fold(0.0, |m: f64, f| m.max(f.abs()));
        for k in (0..end.len()).filter(|&k| !held[k]) {
            let mut ends = [end.clone(), end.clone()];
            ends[0][k] += shift;
            ends[1][k] -= shift;
            let [ahead, behind] = ends.map(|unknowns| energy(&mut other, &unknowns));
            let expected = (ahead - behind) / (2.0 * shift);
            assert!((forces[k] - expected).abs() < 1e-6 * largest, "{k}");
        }
        compare_jacobian(&mut system, &end, &stage);
    }
}

/// Compares the Jacobian of a stage with differences of the residual.
fn compare_jacobian(system: &mut System, end: &[f64], stage: &Stage) {
    let held = system.assembly.held.clone();
    let shift = 1e-6;
    system.linearize(end, Some(stage));
    let matrix = system.dense_matrix();
    assert!((&matrix - matrix.transpose()).amax() < 1e-9 * matrix.amax());
    for column in (0..end.len()).filter(|&k| !held[k]) {
        let mut ends = [end.to_vec(), end.to_vec()];
        ends[0][column] += shift;
        ends[1][column] -= shift;
        let [ahead, behind] = ends.map(|unknowns| {
            system.evaluate(&unknowns, Some(stage));
            system.residual.clone()
        });
        for row in (0..end.len()).filter(|&k| !held[k]) {
            let expected = (ahead[row] - behind[row]) / (2.0 * shift);
            let error = (matrix[(row, column)] - expected).abs();
            assert!(error < 1e-6 * matrix.amax(), "{row} {column}");
        }
    }
}

/// A standard linear solid instead of a spring and dashpot in parallel.
const RELAXATION: Relaxation = Relaxation {
    ratio: 0.8,
    time: 0.03,
};

fn relaxing(closed: bool) -> RodDescription {
    RodDescription {
        retardation_time: 0.0,
        relaxation: Some(RELAXATION),
        ..rod(closed)
    }
}

#[test]
fn the_jacobian_of_what_relaxes_is_symmetric_and_the_derivative_of_its_forces() {
    for closed in [false, true] {
        let mut scene = scene();
        scene.rods = vec![relaxing(closed)];
        scene.loads.clear();
        if closed {
            scene.clamps.clear();
        }
        let mut system = System::new(&scene).unwrap();
        let placed = system.assembly.unknowns.clone();
        let held = system.assembly.held.clone();
        let [earlier, start, end] = [1.0, 2.0, 3.0].map(|seed| moved(&placed, &held, seed));
        let step = 0.02;
        // The stress that relaxes after the first step affects the second.
        for (from, to) in [(&placed, &earlier), (&earlier, &start)] {
            system.begin_damping(from);
            system.damp(step, step, [0.0; 2]);
            let stage = stage(&system, from, step);
            system.evaluate(to, Some(&stage));
            system.accept();
        }
        system.begin_damping(&start);
        system.damp(step, step, [0.0; 2]);
        let stage = stage(&system, &start, step);
        compare_jacobian(&mut system, &end, &stage);
    }
}

/// A straight rod that clamps stretch within 0.1 s and then hold.
fn stretched() -> Scene {
    let mut scene = scene();
    scene.loads.clear();
    scene.rods[0] = RodDescription {
        centreline: (0..=10)
            .map(|k| Vector3::x() * (0.1 * f64::from(k) * LENGTH))
            .collect(),
        natural_shape: NaturalShape::Straight,
        // The rod is so light that the stress of longitudinal waves is negligible, although they
        // ring with backward differences.
        mass_per_length: 1e-8,
        rotational_inertia_per_length: 1e-14,
        ..relaxing(false)
    };
    let mut end = clamp(0, 10);
    let way = Vector3::x() * (0.01 * LENGTH);
    end.motion.translation = vec![(0.0, Vector3::zeros()), (0.1, way), (1.0, way)];
    scene.clamps.push(end);
    scene
}

#[test]
fn tension_relaxes_as_that_of_the_standard_linear_solid() {
    let (scene, Relaxation { ratio, time }) = (stretched(), RELAXATION);
    for scheme in [Scheme::ImplicitEuler, Scheme::BackwardDifferences] {
        let mut simulation = Simulation::new(&scene, &parameters(scheme)).unwrap();
        while simulation.time() < 0.3 {
            simulation.advance(0.3).unwrap();
            let now = simulation.time();
            if (0.2..0.2021).contains(&now) || now > 0.299 {
                // The strain grows uniformly for 0.1 s and then stays constant.
                let grown = ratio * time / 0.1 * -(-0.1 / time).exp_m1();
                let borne = 1.0 + grown * (-(now - 0.1) / time).exp();
                let expected = scene.rods[0].stiffness.stretching * 0.01 * borne;
                let found = simulation.reaction(10).x;
                assert!((found / expected - 1.0).abs() < 1e-5, "{found} {expected}");
            }
        }
    }
}

#[test]
fn a_rigid_turn_meets_no_resistance() {
    let mut scene = scene();
    scene.clamps.clear();
    let node = |k: usize| Vector3::new(k as f64, 0.1 * (k * k) as f64, 0.0) * 0.04;
    scene.rods[0].centreline = (0..=10).map(node).collect();
    let mut system = System::new(&scene).unwrap();
    let start = system.assembly.unknowns.clone();
    system.begin_damping(&start);
    system.damp(1e-3, 1e-3, [0.0; 2]);
    let turn = nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), 1.0);
    let mut end = start.clone();
    for place in end.chunks_exact_mut(STRIDE) {
        let x = turn * Vector3::from_column_slice(&place[..3]);
        place[..3].copy_from_slice(x.as_slice());
    }
    system.update_geometry(&end);
    let turned = system.viscous_loss();
    system.update_geometry(&moved(&start, &system.assembly.held.clone(), 0.0));
    assert!(turned < 1e-20 * system.viscous_loss(), "{turned}");
}

/// Energy that a moving rod has lost after 0.4 s, and the part of it lost in dashpots, J.
fn losses(rod: RodDescription, scheme: Scheme, step: f64) -> [f64; 2] {
    let scene = Scene {
        rods: vec![rod],
        ..scene()
    };
    let fine = IntegrationParameters {
        step: StepSize::Fixed(step),
        ..parameters(scheme)
    };
    let mut simulation = Simulation::new(&scene, &fine).unwrap();
    let start = simulation.energies().total();
    let (mut before, mut lost) = (start, 0.0);
    while simulation.time() < 0.4 {
        let loss = simulation.advance(0.4).unwrap().exchange.drag_loss;
        let now = simulation.energies().total();
        lost += loss;
        if scheme == Scheme::ImplicitEuler {
            assert!(loss >= 0.0 && now <= before, "{loss} {now} {before}");
        }
        before = now;
    }
    [start - before, lost]
}

#[test]
fn energy_falls_by_what_dashpots_take_and_the_scheme_damps() {
    for (rod, scheme) in [
        (rod(false), Scheme::ImplicitEuler),
        (rod(false), Scheme::BackwardDifferences),
        (relaxing(false), Scheme::BackwardDifferences),
    ] {
        let [fallen, lost] = losses(rod, scheme, 2e-4);
        assert_close_in(scheme, lost, fallen, 1e-2);
    }
    // Implicit Euler damps fast modes, which relax little: slow ones in proportion to the step,
    // the fastest less.
    let [coarse, fine] = [2e-4, 1e-4].map(|step| {
        let [fallen, lost] = losses(relaxing(false), Scheme::ImplicitEuler, step);
        1.0 - lost / fallen
    });
    assert!((1.3..2.2).contains(&(coarse / fine)), "{coarse} {fine}");
}

#[test]
fn a_checkpoint_of_a_damped_motion_is_exact() {
    let damped = [rod(false), relaxing(false)];
    let schemes = [Scheme::ImplicitEuler, Scheme::BackwardDifferences];
    for (rod, scheme) in damped
        .into_iter()
        .flat_map(|rod| schemes.map(|scheme| (rod.clone(), scheme)))
    {
        let scene = Scene {
            rods: vec![rod],
            ..scene()
        };
        let mut whole = Simulation::new(&scene, &parameters(scheme)).unwrap();
        advance_to(&mut whole, 0.1);
        let state = whole.state();
        advance_to(&mut whole, 0.2);
        let mut again = Simulation::new(&scene, &parameters(scheme)).unwrap();
        again.restore(state).unwrap();
        advance_to(&mut again, 0.2);
        assert_eq!(again.positions(), whole.positions());
        assert_eq!(again.resultants(), whole.resultants());
    }
}

#[test]
fn at_rest_there_is_no_damping() {
    let at_rest = |retardation_time: f64, relaxation: Option<Relaxation>, moves: bool| {
        let mut scene = scene();
        scene.rods[0].retardation_time = retardation_time;
        scene.rods[0].relaxation = relaxation;
        let mut simulation = Simulation::new(&scene, &parameters(Scheme::ImplicitEuler)).unwrap();
        while moves && simulation.time() < 0.02 {
            simulation.advance(0.02).unwrap();
        }
        simulation.find_equilibrium().unwrap();
        (simulation.positions()[10], simulation.reaction_moment(0))
    };
    let (place, moment) = at_rest(0.0, None, false);
    for (time, relaxation, moves) in [
        (0.05, None, false),
        (0.05, None, true),
        (0.0, Some(RELAXATION), true),
    ] {
        let damped = at_rest(time, relaxation, moves);
        assert!((damped.0 - place).norm() < 1e-7 && (damped.1 - moment).norm() < 1e-7);
    }
}

/// Rods of different materials that do not touch move as each does without the other.
#[test]
fn each_rod_is_damped_by_its_own_material() {
    let materials = [(0.05, None), (0.4, None), (0.0, Some(RELAXATION))];
    let rods = materials.map(|(retardation_time, relaxation)| RodDescription {
        retardation_time,
        relaxation,
        ..rod(false)
    });
    let end = |rods: &[RodDescription]| {
        let scene = Scene {
            rods: rods.to_vec(),
            clamps: (0..rods.len()).map(|rod| clamp(rod, 0)).collect(),
            ..scene()
        };
        let mut simulation =
            Simulation::new(&scene, &parameters(Scheme::BackwardDifferences)).unwrap();
        advance_to(&mut simulation, 0.04);
        simulation
    };
    let together = end(&rods);
    for (index, (rod, nodes)) in rods.iter().zip(together.positions().chunks(11)).enumerate() {
        let alone = end(std::slice::from_ref(rod));
        assert!(farthest(alone.positions(), nodes) < 1e-8, "{index}");
        let [one, other] = [together.energies_of(index), alone.energies_of(0)];
        assert_close_in(index, one.bending, other.bending, 1e-4);
        assert_close_in(index, one.twisting, other.twisting, 1e-4);
    }
    let nodes = together.positions();
    assert!(farthest(&nodes[..11], &nodes[11..22]) > 1e-4);
}

#[test]
fn the_midpoint_rule_refuses_viscous_rods() {
    let refused = Simulation::new(&scene(), &parameters(Scheme::ImplicitMidpoint));
    let message = refused.err().unwrap().to_string();
    assert!(message.contains("backward-differences"), "{message}");
}
