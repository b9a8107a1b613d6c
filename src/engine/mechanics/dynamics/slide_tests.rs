//! Nodes that slide along rods, in motion and at rest.

use super::*;
use crate::mechanics::Vector3;
use crate::mechanics::rigid_body::RigidBody;
use crate::mechanics::scene::{
    CoulombFriction, Joint, JointKind, Load, NaturalShape, RodDescription, Scene, Strength,
};
use crate::mechanics::test_support::{
    SOFT_MODELS, advance_to, at, at_rest, body, contact, drag, fixed_steps, gravity, joint,
    obstacle, pin, point_force, run, section, simulation_of,
};
use std::f64::consts::PI;

const GRAVITY: f64 = 9.81;

fn rod(name: &str, nodes: Vec<Vector3>) -> RodDescription {
    let stiffness = section(1e3, [1e-3; 2], 1e-3);
    RodDescription::uniform(name, nodes, stiffness, 2e-3, 0.01)
}

fn slide(nodes: [[usize; 2]; 2]) -> Joint {
    joint(
        &format!("slide {}", nodes[0][1]),
        nodes.map(|[rod, node]| at(rod, node)),
        JointKind::FREE_SLIDE,
    )
}

const SLOPE: f64 = 0.5;

/// A shuttle of one edge, both ends of which slide along a straight held wire with a slope of
/// [`SLOPE`] (rad).
fn incline() -> Scene {
    let down = Vector3::new(SLOPE.cos(), 0.0, -SLOPE.sin());
    let mut wire = rod(
        "wire",
        (0..=40).map(|k| down * (0.025 * f64::from(k))).collect(),
    );
    wire.held = true;
    let shuttle = rod("shuttle", vec![down * 0.05, down * 0.1]);
    Scene {
        rods: vec![wire, shuttle],
        joints: vec![slide([[1, 0], [0, 2]]), slide([[1, 1], [0, 4]])],
        loads: vec![gravity(GRAVITY)],
        ..Scene::default()
    }
}

/// Distance that the shuttle of [`incline`] has covered at time `end`, m.
fn fallen(scheme: Scheme, step: f64, end: f64) -> f64 {
    let simulation = run(&incline(), scheme, step, end);
    let ends = &simulation.positions()[41..];
    for end in ends {
        let off = end.z * SLOPE.cos() + end.x * SLOPE.sin();
        assert!(off.abs() < 1e-14 && end.y.abs() < 1e-14, "{end}");
    }
    ends[0].norm() - 0.05
}

#[test]
fn it_falls_along_an_incline_without_friction() {
    let end = 0.5;
    let expected = 0.5 * GRAVITY * SLOPE.sin() * end * end;
    // It crosses more than twenty edges.
    assert!(expected > 20.0 * 0.025);
    let error = |scheme, step| fallen(scheme, step, end) / expected - 1.0;
    assert!(error(Scheme::ImplicitMidpoint, 1e-2).abs() < 1e-9);
    let [coarse, fine] = [1e-2, 5e-3].map(|step| error(Scheme::ImplicitEuler, step));
    // With implicit Euler the distance is ½ a t (t + h).
    assert!((coarse / (1e-2 / end) - 1.0).abs() < 1e-6, "{coarse}");
    assert!((coarse / fine - 2.0).abs() < 1e-6, "{coarse} {fine}");
    assert!(error(Scheme::BackwardDifferences, 1e-2).abs() < 1e-3);
}

/// A scene whose slides have friction, with a presliding length of 1 µm.
fn with_friction(mut scene: Scene, coefficient: f64) -> Scene {
    for joint in &mut scene.joints {
        joint.kind = JointKind::Slide {
            friction: Some(CoulombFriction {
                coefficient,
                presliding: Some(1e-6),
            }),
        };
    }
    scene
}

#[test]
fn friction_slows_it_down_an_incline() {
    let (friction, end) = (0.3, 0.5);
    let expected = 0.5 * GRAVITY * (SLOPE.sin() - friction * SLOPE.cos()) * end * end;
    let scene = with_friction(incline(), friction);
    let error = |scheme| {
        let simulation = run(&scene, scheme, 2e-3, end);
        (simulation.positions()[41].norm() - 0.05) / expected - 1.0
    };
    let euler = error(Scheme::ImplicitEuler);
    // With implicit Euler the distance is ½ a t (t + h).
    assert!((euler / (2e-3 / end) - 1.0).abs() < 0.01, "{euler:e}");
    // Backward differences begin with steps of lower order.
    for (scheme, bound) in [
        (Scheme::BackwardDifferences, 3e-3),
        (Scheme::ImplicitMidpoint, 1e-9),
    ] {
        let error = error(scheme);
        assert!(error.abs() < bound, "{scheme:?}: {error:e}");
    }
}

#[test]
fn friction_holds_it_on_an_incline_below_the_angle_of_friction() {
    let scene = with_friction(incline(), 0.6);
    for scheme in [Scheme::ImplicitEuler, Scheme::BackwardDifferences] {
        let mut simulation = Simulation::new(&scene, &fixed_steps(scheme, 2e-3)).unwrap();
        let [early, late] = [0.5, 2.0].map(|end| {
            advance_to(&mut simulation, end);
            simulation.positions()[41].norm() - 0.05
        });
        // It overshoots the presliding length when it is released, and does not creep.
        assert!((0.0..1e-5).contains(&early), "{scheme:?}: {early:e}");
        assert!(
            (late - early).abs() < 1e-12,
            "{scheme:?}: {early:e} {late:e}"
        );
    }
}

/// Square of the speed of a bead that slides down half a circle of unit radius from rest at the
/// height of its centre, over twice the acceleration of gravity, after the angle φ: from dv²/dφ =
/// 2g (cos φ − μ sin φ) − 2μ v².
fn speed_in_bowl(friction: f64, angle: f64) -> f64 {
    let (sine, cosine) = angle.sin_cos();
    let falling = (1.0 - 2.0 * friction * friction) * sine;
    let rubbing = 3.0 * friction * (cosine - (-2.0 * friction * angle).exp());
    (falling + rubbing) / (1.0 + 4.0 * friction * friction)
}

#[test]
fn the_centripetal_force_of_a_bead_rubs_too() {
    let (radius, friction) = (0.2, 0.3);
    let mut scene = with_friction(bowl(), friction);
    // A heavy bead with a light tail, at the upper end of the wire.
    let start = scene.rods[0].centreline[1];
    scene.rods[1] = RodDescription {
        mass_per_length: 1e-6,
        ..rod("tail", vec![start, start + Vector3::x() * 2e-3])
    };
    scene.joints.truncate(1);
    scene.joints[0].nodes[1] = at(0, 1);
    scene.bodies = vec![body("bead", at(1, 0), 0.01, None)];
    let mut simulation =
        Simulation::new(&scene, &fixed_steps(Scheme::BackwardDifferences, 2e-4)).unwrap();
    let began = PI / 40.0;
    let (mut worst, mut most) = (0.0_f64, 0.0_f64);
    while simulation.time() < 0.33 {
        simulation.advance(0.33).unwrap();
        let [place, velocity] = [simulation.positions()[41], simulation.velocities()[41]];
        let angle = (-place.z).atan2(-place.x);
        // The solution from rest at the angle at which it began.
        let decay = (-2.0 * friction * (angle - began)).exp();
        let square = speed_in_bowl(friction, angle) - speed_in_bowl(friction, began) * decay;
        let expected = 2.0 * GRAVITY * radius * square;
        worst = worst.max((velocity.norm_squared() - expected).abs());
        most = most.max(angle);
    }
    assert!(most > 0.5 * PI, "{most}");
    let scale = 2.0 * GRAVITY * radius;
    assert!(worst < 3e-4 * scale, "{worst:e} of {scale}");
}

/// The shuttle on half a circle of radius 0.2 m; it starts where the wire is near the horizontal
/// through the centre.
fn bowl() -> Scene {
    let (radius, edges) = (0.2, 40);
    let place = |angle: f64| Vector3::new(-angle.cos(), 0.0, -angle.sin()) * radius;
    let nodes = (0..=edges)
        .map(|k| place(PI * f64::from(k) / f64::from(edges)))
        .collect();
    let mut wire = rod("wire", nodes);
    wire.held = true;
    let [from, to] = [4, 5].map(|k| wire.centreline[k]);
    Scene {
        rods: vec![wire, rod("shuttle", vec![from, to])],
        joints: vec![slide([[1, 0], [0, 4]]), slide([[1, 1], [0, 5]])],
        loads: vec![gravity(GRAVITY)],
        ..Scene::default()
    }
}

/// Largest deviation of the energy of a scene from its initial value over some time, J.
fn deviation(scene: &Scene, scheme: Scheme, step: f64, end: f64) -> (f64, f64) {
    let mut simulation = Simulation::new(scene, &fixed_steps(scheme, step)).unwrap();
    let start = simulation.energies().total();
    let (mut worst, mut kinetic) = (0.0_f64, 0.0_f64);
    while simulation.time() < end {
        simulation.advance(end).unwrap();
        let energies = simulation.energies();
        worst = worst.max((energies.total() - start).abs());
        kinetic = kinetic.max(energies.kinetic);
    }
    (worst, kinetic)
}

#[test]
fn crossing_edges_costs_no_energy_but_the_schemes() {
    let (coarse, kinetic) = deviation(&bowl(), Scheme::ImplicitMidpoint, 1e-3, 2.0);
    let (fine, _) = deviation(&bowl(), Scheme::ImplicitMidpoint, 5e-4, 2.0);
    // The shuttle moves back and forth several times, over some thirty edges each time.
    assert!(kinetic > 0.5e-4 * GRAVITY * 0.1);
    assert!(fine < 1e-3 * kinetic, "{fine} of {kinetic}");
    assert!(coarse > 2.5 * fine, "{coarse} {fine}");
    let (lost, _) = deviation(&bowl(), Scheme::BackwardDifferences, 5e-4, 0.5);
    assert!(lost < 1e-2 * kinetic, "{lost} of {kinetic}");
}

/// A shuttle that moves along a slender, free rod at rest, slightly across it.
fn free_rail() -> Scene {
    let rail = rod(
        "rail",
        (0..=20)
            .map(|k| Vector3::x() * (0.01 * f64::from(k)))
            .collect(),
    );
    let mut shuttle = rod("shuttle", vec![Vector3::x() * 0.03, Vector3::x() * 0.04]);
    shuttle.velocity = Vector3::new(0.5, 0.0, 0.0);
    let push = |force: f64, end: f64| Load {
        schedule: vec![(0.0, 1.0), (end, 1.0), (end + 1e-6, 0.0)],
        ..point_force(0, 20, Vector3::new(0.0, force, 0.5 * force))
    };
    Scene {
        rods: vec![rail, shuttle],
        joints: vec![slide([[1, 0], [0, 3]]), slide([[1, 1], [0, 4]])],
        loads: vec![push(2e-3, 0.02)],
        ..Scene::default()
    }
}

#[test]
fn momentum_is_kept_along_a_rod_that_bends() {
    let pushed = 0.02 + 0.5e-6;
    for (scheme, angular) in [
        (Scheme::ImplicitMidpoint, 1e-3),
        (Scheme::ImplicitEuler, 1e-2),
        (Scheme::BackwardDifferences, 1e-2),
    ] {
        let mut simulation = Simulation::new(&free_rail(), &fixed_steps(scheme, 5e-4)).unwrap();
        while simulation.time() < pushed {
            simulation.advance(0.021).unwrap();
        }
        advance_to(&mut simulation, 0.03);
        let [before, turning_before] = simulation.momenta();
        let placed = simulation.positions()[21];
        advance_to(&mut simulation, 0.2);
        let [after, turning_after] = simulation.momenta();
        let travelled = (simulation.positions()[21] - placed).norm();
        assert!(travelled > 0.05, "{travelled}");
        let change = (after - before).norm() / before.norm();
        assert!(change < 1e-6, "{scheme:?}: {change:e}");
        let change = (turning_after - turning_before).norm() / turning_before.norm();
        assert!(change < angular, "{scheme:?}: {change:e}");
    }
}

#[test]
fn stops_hold_it_at_the_end() {
    let simulation = run(&incline(), Scheme::ImplicitEuler, 2e-3, 1.2);
    let positions = simulation.positions();
    assert!((positions[40] - positions[42]).norm() < 1e-12);
    let length = (positions[42] - positions[41]).norm();
    assert!((length / 0.05 - 1.0).abs() < 1e-3, "{length}");
    // With less damping the elastic edge rebounds and returns.
    for scheme in [Scheme::BackwardDifferences, Scheme::ImplicitMidpoint] {
        let mut simulation = Simulation::new(&incline(), &fixed_steps(scheme, 2e-3)).unwrap();
        let start = simulation.energies().total();
        let mut farthest = 0.0_f64;
        while simulation.time() < 1.2 {
            simulation.advance(1.2).unwrap();
            farthest = farthest.max(simulation.positions()[42].norm());
            let gained = simulation.energies().total() - start;
            assert!(gained < 1e-9, "{scheme:?}: {gained:e}");
        }
        assert!((farthest - 1.0).abs() < 1e-12, "{scheme:?}: {farthest}");
    }
}

#[test]
fn a_run_resumes_from_a_checkpoint_bit_for_bit_and_breaks() {
    for scheme in [
        Scheme::BackwardDifferences,
        Scheme::ImplicitMidpoint,
        Scheme::ImplicitEuler,
    ] {
        let mut scene = with_friction(bowl(), 0.02);
        // The joints break at the bottom, where the shuttle presses on the wire with 3 m g at each
        // end.
        let pressed = 1.8 * 0.5 * 0.01 * 0.0157 * GRAVITY;
        scene
            .joints
            .iter_mut()
            .for_each(|joint| joint.strength = Strength::of_force(pressed));
        let parameters = fixed_steps(scheme, 1e-3);
        let mut whole = Simulation::new(&scene, &parameters).unwrap();
        let (mut states, end) = (Vec::new(), 0.3);
        while whole.time() < end {
            whole.advance(end).unwrap();
            if whole.time() > 0.1 && states.is_empty() {
                assert_eq!(whole.breaks(), [None, None]);
                states.push(whole.state());
            }
        }
        assert!(
            whole.breaks().iter().any(Option::is_some),
            "{:?}",
            whole.breaks()
        );
        states.push(whole.state());
        // The leading end has left the wire.
        assert!(
            whole.positions()[42].norm() > 0.201,
            "{}",
            whole.positions()[42]
        );
        for state in states {
            let mut resumed = Simulation::new(&scene, &parameters).unwrap();
            resumed.restore(state).unwrap();
            advance_to(&mut resumed, end);
            assert_eq!(whole.positions(), resumed.positions());
            assert_eq!(whole.breaks(), resumed.breaks());
        }
    }
}

const SPAN: f64 = 0.8;
const DROP: f64 = 0.2;
const BENDING: f64 = 8e-5;
const WEIGHT: f64 = 0.02;

/// A ring on a slack rope of 1 m between two posts; it starts at the fraction `part` of the rope.
fn ring_on_rope(edges: usize, part: f64) -> (Scene, usize) {
    let start = (part * edges as f64).round();
    let (one, other) = (start / edges as f64, 1.0 - start / edges as f64);
    // The lower intersection of circles about the posts.
    let across = Vector3::new(SPAN, 0.0, DROP);
    let along = (one * one - other * other + across.norm_squared()) / (2.0 * across.norm());
    let unit = across.normalize();
    let down = Vector3::new(unit.z, 0.0, -unit.x);
    let apex = unit * along + down * (one * one - along * along).sqrt();
    let node = |k: usize| {
        let at = k as f64 / edges as f64;
        if at <= one {
            apex * (at / one)
        } else {
            apex + (across - apex) * ((at - one) / other)
        }
    };
    let stiffness = section(1e3, [BENDING; 2], BENDING);
    let rope = RodDescription {
        natural_shape: NaturalShape::Straight,
        ..RodDescription::uniform(
            "rope",
            (0..=edges).map(node).collect(),
            stiffness,
            2e-4,
            1e-4,
        )
    };
    let start = start as usize;
    let hung = rope.centreline[start];
    let ring = RodDescription::uniform(
        "ring",
        vec![hung, hung - Vector3::z() * 0.02],
        stiffness,
        2e-4,
        1e-4,
    );
    let scene = Scene {
        rods: vec![rope, ring],
        joints: vec![slide([[1, 0], [0, start]])],
        clamps: vec![pin(0, 0), pin(0, edges)],
        loads: vec![point_force(1, 1, Vector3::z() * -WEIGHT)],
        ..Scene::default()
    };
    (scene, edges + 1)
}

/// Rest position of the ring. Both halves of the rope make the angle α with the vertical; near the
/// ring they turn to the horizontal as tan θ/4 ∝ e^(−s/λ), λ² = EI/T, 2T cos α = W.
fn ring_at_rest() -> Vector3 {
    let (mut low, mut high) = (0.0, 0.5 * PI);
    let layer = |angle: f64| {
        let tension = WEIGHT / (2.0 * angle.cos());
        let (size, turn) = ((BENDING / tension).sqrt(), 0.5 * PI - angle);
        let shortening = 2.0 * size * (1.0 - (0.5 * turn).cos());
        (shortening, 2.0 * size * (0.5 * turn).sin(), tension / 1e3)
    };
    for _ in 0..80 {
        let angle: f64 = 0.5 * (low + high);
        let (shortening, aside, strain) = layer(angle);
        let reach = (1.0 + strain - 2.0 * shortening) * angle.sin() + 2.0 * aside * angle.cos();
        if reach < SPAN {
            low = angle;
        } else {
            high = angle;
        }
    }
    let (shortening, aside, strain) = layer(low);
    // The posts have the heights 0 and DROP: the arm to the lower post is the shorter one.
    let arm = 0.5 * (1.0 + strain - DROP / low.cos()) - shortening;
    let (sine, cosine) = low.sin_cos();
    Vector3::new(
        arm * sine + aside * cosine,
        0.0,
        aside * sine - arm * cosine,
    )
}

#[test]
fn a_ring_on_a_slack_rope_rests_where_both_halves_make_the_same_angle() {
    let expected = ring_at_rest();
    let off = |edges: usize, part: f64| {
        let (scene, ring) = ring_on_rope(edges, part);
        let simulation = at_rest(&scene);
        simulation.positions()[ring] - expected
    };
    let errors = [40, 80].map(|edges| off(edges, 0.5));
    for error in errors {
        assert!(error.norm() < 1e-3, "{errors:?}");
    }
    let order = (errors[0].z / errors[1].z).log2();
    assert!((order - 2.0).abs() < 0.2, "{order} {errors:?}");
    // From the other side the ring reaches the same position.
    let difference = (off(80, 0.25) - errors[1]).norm();
    assert!(difference < 1e-6, "{difference:e}");
}

#[test]
fn a_ring_comes_to_rest_on_ropes_of_any_stiffness_and_number_of_edges() {
    let mut most = 0;
    for (edges, factors) in [
        (12, [1e-3, 1.0, 1e3]),
        (40, [1e-2, 1.0, 1e4]),
        (80, [1e-1, 1e1, 1e2]),
    ] {
        for factor in factors {
            let (mut scene, _) = ring_on_rope(edges, 0.25);
            for rod in &mut scene.rods {
                let stiffness = &mut rod.stiffness;
                stiffness.stretching *= factor;
                stiffness.bending = stiffness.bending.map(|bending| bending * factor);
                stiffness.twisting *= factor;
            }
            let mut simulation = simulation_of(&scene);
            let report = simulation.find_equilibrium().unwrap();
            println!("{edges} {factor}: {}", report.newton_iterations);
            // Stiffer ropes bend like beams and take up to 1,300 iterations.
            if factor <= 10.0 {
                most = most.max(report.newton_iterations);
            }
            let borne = simulation.reaction(0) + simulation.reaction(edges);
            let missed = (borne - Vector3::z() * WEIGHT).norm();
            assert!(missed < 1e-4 * WEIGHT, "{edges} {factor}: {borne}");
        }
    }
    assert!(most < 300, "{most}");
}

#[test]
fn edges_too_long_for_what_slides_along_them_are_remarked() {
    let remarks = |edges: usize| {
        let (mut scene, _) = ring_on_rope(edges, 0.5);
        scene.rods[0].stiffness.bending = [4e-6; 2];
        let simulation = at_rest(&scene);
        simulation.remarks()
    };
    // The coefficients 0.1 F h²/EI are 0.31 and 0.02.
    let found = remarks(40);
    assert!(
        found.len() == 1 && found[0].contains("coefficient of up to 0.31"),
        "{found:?}"
    );
    assert!(remarks(160).is_empty(), "{:?}", remarks(160));
}

/// Position along the wire of the centre of a ball in the path of the shuttle of [`incline`], m.
const BALL: f64 = 0.5;
const BALL_RADIUS: f64 = 0.02;

#[test]
fn a_bead_that_runs_against_an_obstacle_rests_on_it() {
    let down = Vector3::new(SLOPE.cos(), 0.0, -SLOPE.sin());
    let tolerance = 2e-5;
    for model in SOFT_MODELS {
        for scheme in [Scheme::ImplicitEuler, Scheme::BackwardDifferences] {
            let mut scene = incline();
            scene.obstacles.push(obstacle(
                "ball",
                RigidBody::sphere(down * BALL, BALL_RADIUS),
            ));
            scene.contact = Some(contact(model, tolerance));
            scene.loads.push(drag(Some(1), 0.1, 0.0));
            let mut simulation = Simulation::new(&scene, &fixed_steps(scheme, 2e-3)).unwrap();
            let gap = |simulation: &Simulation| {
                let lead = simulation.positions()[42];
                (lead - down * BALL).norm() - BALL_RADIUS - 2e-3
            };
            let mut least = f64::INFINITY;
            while simulation.time() < 3.0 {
                simulation.advance(3.0).unwrap();
                least = least.min(gap(&simulation));
            }
            // The shuttle arrives at half a metre per second and penetrates by at most a twentieth
            // of its radius.
            assert!(least > -1e-4, "{model:?} {scheme:?}: {least:e}");
            let gap = gap(&simulation);
            assert!(gap.abs() < 1.5 * tolerance, "{model:?} {scheme:?}: {gap:e}");
            let borne: Vector3 = simulation.contact_forces().iter().sum();
            let weight = 0.01 * 0.05 * GRAVITY * SLOPE.sin();
            let error = borne.dot(&down) / -weight - 1.0;
            assert!(error.abs() < 1e-3, "{model:?} {scheme:?}: {error:e}");
        }
    }
}
