//! Residual and Jacobian of sliding nodes against finite differences, and invalid slides.

use super::tests::{
    compare_jacobian, compare_residual, compare_to_differences, own, perturbed, stage_at,
};
use super::*;
use crate::mechanics::scene::{
    CoulombFriction, Joint, JointKind, RodDescription, RodNode, Scene, Spring,
};
use crate::mechanics::test_support::{at, body, clamp, curved, joint, section, spring};
use crate::mechanics::{JointError, SceneError};

fn rod(name: &str, nodes: Vec<Vector3>, closed: bool) -> RodDescription {
    let stiffness = section(30.0, [0.02, 0.05], 0.03);
    RodDescription {
        natural_shape: curved([1.0, -2.0], 0.0),
        closed,
        rotational_inertia_per_length: 0.01,
        ..RodDescription::uniform(name, nodes, stiffness, 0.01, 0.8)
    }
}

fn slide(name: &str, nodes: [RodNode; 2]) -> Joint {
    joint(name, nodes, JointKind::FREE_SLIDE)
}

/// A clamped arc with a strut that slides along it at one end, to which the last rod is joined.
/// The other end of the strut slides on a ring. The third rod is a noose: its end slides along the
/// rod itself. Springs load all of them, and a heavy node hangs on the arc.
fn frame() -> Scene {
    let arc = |k: usize| {
        let angle = 0.25 * k as f64;
        Vector3::new(angle.sin(), 0.1 * angle * angle, 1.0 - angle.cos())
    };
    let rail: Vec<Vector3> = (0..7).map(arc).collect();
    let ring: Vec<Vector3> = (0..5)
        .map(|k| {
            let angle = 1.25 * f64::from(k) + 0.1 * f64::from(k * k % 3);
            Vector3::new(2.0 + angle.cos(), angle.sin(), 0.4)
        })
        .collect();
    let (from, to) = (rail[3], ring[2]);
    let strut = (0..=3)
        .map(|k| from + (to - from) * (f64::from(k) / 3.0))
        .collect();
    let mut noose: Vec<Vector3> = (0..8)
        .map(|k| {
            let angle = 0.8 * f64::from(k);
            from + Vector3::new(0.4 * angle.sin(), -0.3 * angle, 0.4 * (1.0 - angle.cos()))
        })
        .collect();
    let tail = [2.0, 1.0, 0.0].map(|k| from + Vector3::new(0.1, 0.2, 0.3) * k);
    let tail = tail.to_vec();
    let caught = noose[2];
    noose.push(caught);
    let spring = |name: &str, nodes, rest_length| Spring {
        rest_length: Some(rest_length),
        ..spring(name, nodes, 0.4)
    };
    Scene {
        rods: vec![
            rod("rail", rail, false),
            rod("strut", strut, false),
            rod("noose", noose, false),
            rod("ring", ring, true),
            rod("tail", tail, false),
        ],
        joints: vec![
            slide("foot", [at(1, 0), at(0, 3)]),
            Joint {
                kind: JointKind::Ball,
                ..slide("hook", [at(1, 0), at(4, 2)])
            },
            slide("head", [at(1, 3), at(3, 2)]),
            slide("noose", [at(2, 8), at(2, 2)]),
        ],
        springs: vec![
            spring("one", [at(1, 1), at(0, 6)], 0.3),
            spring("two", [at(2, 8), at(3, 0)], 0.1),
            spring("three", [at(2, 1), at(4, 0)], 0.2),
        ],
        bodies: vec![body("payload", at(0, 4), 0.3, None)],
        clamps: vec![clamp(0, 0)],
        ..Scene::default()
    }
}

#[test]
fn sliding_nodes_stay_where_they_were_placed() {
    let scene = frame();
    let mut system = System::new(&scene).unwrap();
    assert_eq!(system.assembly.joints.slides.len(), 4 - 1);
    let mut unknowns = system.assembly.unknowns.clone();
    system.complete(&mut unknowns);
    for (rod, description) in scene.rods.iter().enumerate() {
        let first = system.assembly.rods.rods[rod].first_node;
        for (along, placed) in description.centreline.iter().enumerate() {
            let found = crate::mechanics::rod::topology::position(&unknowns, first + along);
            assert!((found - placed).norm() < 1e-14, "{rod} {along}");
        }
    }
}

/// The scene with a clamp that holds one of the sliding nodes, whose joint then yields.
fn held_frame() -> Scene {
    let mut scene = frame();
    scene.clamps.push(clamp(1, 0));
    scene
}

#[test]
fn the_residual_of_sliding_nodes_is_the_gradient_of_the_energy() {
    compare_residual(&frame(), [0.0, 0.02, 0.1]);
    compare_residual(&held_frame(), [0.0, 0.02, 0.1]);
}

#[test]
fn the_jacobian_of_sliding_nodes_is_exact_and_symmetric() {
    for scene in [frame(), held_frame()] {
        compare_jacobian(&scene, &[(0.0, false), (0.1, false), (0.1, true)], 2e-8);
    }
}

/// A scene with friction at all slides, which stick up to a distance.
fn rubbing(mut scene: Scene, presliding: f64) -> Scene {
    let slides = scene.joints.iter_mut().filter(|joint| joint.kind.slides());
    slides.for_each(|joint| {
        joint.kind = JointKind::Slide {
            friction: Some(CoulombFriction {
                coefficient: 0.4,
                presliding: Some(presliding),
            }),
        };
    });
    scene
}

#[test]
fn the_jacobian_of_sliding_nodes_with_friction_is_exact() {
    let scenes = [frame(), held_frame()].into_iter();
    for (scene, presliding, all_slide) in
        scenes.flat_map(|scene| [(scene.clone(), 1e-9, true), (scene, 3.0, false)])
    {
        let mut system = System::new(&rubbing(scene, presliding)).unwrap();
        let stage = stage_at(&system);
        let asymmetry = compare_to_differences(&mut system, Some(&stage), 0.1, 2e-8);
        assert!(asymmetry > 1e-4, "{asymmetry:e}");
        for slide in &system.assembly.joints.slides {
            let [_, state] = slide.rubbing.as_ref().expect("friction").state();
            assert!(state != 0.0 && (state.abs() == 1.0) == all_slide, "{state}");
        }
    }
}

/// Checks J d = −R over the free unknowns.
fn assert_solves(system: &System, jacobian: &nalgebra::DMatrix<f64>, direction: &[f64]) {
    let free = own(system);
    for row in &free {
        let products = free.iter().map(|k| jacobian[(*row, *k)] * direction[*k]);
        let error = (products.sum::<f64>() + system.residual[*row]).abs();
        assert!(error < 1e-9 * jacobian.amax(), "{row}: {error:e}");
    }
}

#[test]
fn newtons_direction_with_friction_is_that_of_the_dense_matrix() {
    let scenes = [frame(), held_frame()].into_iter();
    for (scene, presliding) in scenes.flat_map(|scene| [(scene.clone(), 1e-9), (scene, 3.0)]) {
        let mut system = System::new(&rubbing(scene, presliding)).unwrap();
        let stage = stage_at(&system);
        let unknowns = perturbed(&mut system, 0.05);
        system.linearize(&unknowns, Some(&stage));
        let jacobian = system.dense_matrix();
        system.factor().unwrap();
        let mut direction = vec![0.0; unknowns.len()];
        system.direction(&mut direction).unwrap();
        assert_solves(&system, &jacobian, &direction);
    }
}

#[test]
fn newton_and_its_inertia_are_those_of_the_dense_matrix() {
    for scene in [frame(), held_frame()] {
        newton_and_inertia_are_those_of_the_dense_matrix(&scene);
    }
}

fn newton_and_inertia_are_those_of_the_dense_matrix(scene: &Scene) {
    let mut system = System::new(scene).unwrap();
    let stage = stage_at(&system);
    for stage in [Some(&stage), None] {
        let unknowns = perturbed(&mut system, 0.05);
        let free = own(&system);
        let mut negatives = Vec::new();
        for shift in [0.0, 0.3, 30.0] {
            system.linearize(&unknowns, stage);
            system.shift(shift, 0.0);
            let jacobian = system.dense_matrix();
            let inertia = system.factor().unwrap().expect("symmetric");
            let part = nalgebra::DMatrix::from_fn(free.len(), free.len(), |i, j| {
                jacobian[(free[i], free[j])]
            });
            let eigenvalues = part.symmetric_eigenvalues();
            let negative = eigenvalues.iter().filter(|value| **value < 0.0).count();
            assert_eq!(inertia.negative, negative, "{shift}");
            negatives.push(negative);
            let mut direction = vec![0.0; unknowns.len()];
            system.direction(&mut direction).unwrap();
            assert_solves(&system, &jacobian, &direction);
        }
        if stage.is_none() {
            assert!(negatives[0] > negatives[2], "{negatives:?}");
        }
    }
}

#[test]
fn in_the_middle_of_a_step_newtons_direction_lowers_the_residual_in_proportion() {
    for scene in [frame(), held_frame()] {
        newtons_direction_lowers_the_residual_in_proportion(&scene);
    }
}

fn newtons_direction_lowers_the_residual_in_proportion(scene: &Scene) {
    let mut system = System::new(scene).unwrap();
    let stage = stage_at(&system);
    system.begin_step(Some(&stage.start));
    let unknowns = perturbed(&mut system, 0.05);
    system.linearize(&unknowns, Some(&stage));
    let residual = system.residual.clone();
    let scale = residual.iter().fold(0.0_f64, |m, r| m.max(r.abs()));
    system.factor().unwrap();
    let mut direction = vec![0.0; unknowns.len()];
    system.direction(&mut direction).unwrap();
    let mut residual_after = |part: f64| {
        let ends = unknowns.iter().zip(&direction);
        let mut moved: Vec<f64> = ends.map(|(q, d)| q + part * d).collect();
        system.complete(&mut moved);
        system.evaluate(&moved, Some(&stage));
        system.residual.clone()
    };
    let part = 1e-5;
    let (after, before) = (residual_after(part), residual_after(-part));
    for k in own(&system) {
        let rate = (after[k] - before[k]) / (2.0 * part);
        assert!((rate + residual[k]).abs() < 1e-6 * scale, "{k}");
    }
}

#[test]
fn a_stop_holds_what_is_pushed_out_and_lets_go_what_is_drawn_in() {
    let mut system = System::new(&frame()).unwrap();
    let mut unknowns = system.assembly.unknowns.clone();
    let own = system.assembly.joints.slides[0].unknown;
    for (beyond, end) in [(-0.3, 0.0), (9.0, 6.0)] {
        unknowns[own] = beyond;
        system.complete(&mut unknowns);
        assert!((unknowns[own] - end).abs() < 1e-12);
        system.evaluate(&unknowns, None);
        let slide = &system.assembly.joints.slides[0];
        let along = slide.residual.dot(&slide.grip.tangent);
        let outwards = if beyond < 0.0 { along } else { -along };
        assert_eq!(slide.is_stopped, outwards >= 0.0);
        let left = system.residual[own];
        assert_eq!(left, if slide.is_stopped { 0.0 } else { along });
    }
}

#[test]
fn slides_that_cannot_be_are_named() {
    let refused = |change: &dyn Fn(&mut Scene)| {
        let mut scene = frame();
        change(&mut scene);
        match System::new(&scene).err() {
            Some(SceneError::Joint { name, reason }) => (name, reason),
            other => panic!("{other:?}"),
        }
    };
    let (name, reason) = refused(&|scene| scene.joints[0].nodes[1] = at(0, 4));
    assert_eq!(name, "foot");
    assert!(matches!(reason, JointError::Apart { distance } if distance > 0.2));
    // Slides along its own rod, from its own neighbour.
    let (_, reason) = refused(&|scene| scene.joints[3].nodes[1] = at(2, 7));
    assert!(matches!(reason, JointError::Apart { distance } if distance > 0.2));
    let (name, reason) = refused(&|scene| {
        let mut again = slide("again", [at(1, 0), at(2, 0)]);
        again.nodes = [at(1, 0), at(0, 3)];
        scene.joints.push(again);
    });
    assert_eq!((name.as_str(), reason), ("again", JointError::SlidesTwice));
    let (name, reason) = refused(&|scene| {
        scene.joints.push(Joint {
            kind: JointKind::Ball,
            ..slide("pin", [at(1, 0), at(0, 3)])
        });
    });
    assert_eq!((name.as_str(), reason), ("foot", JointError::JoinedToRail));
    // The strut, whose ends slide, is not a rail.
    let (name, reason) = refused(&|scene| {
        scene.joints[1].kind = JointKind::FREE_SLIDE;
        scene.joints[1].nodes.swap(0, 1);
    });
    let rod = "strut".into();
    assert_eq!(
        (name.as_str(), reason),
        ("foot", JointError::SlidingRail { rod })
    );
    let (_, reason) = refused(&|scene| scene.rods[2].closed = true);
    assert_eq!(reason, JointError::OwnRing);
}
