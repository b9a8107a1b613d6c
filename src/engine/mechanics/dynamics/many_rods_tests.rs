//! Scenes of so many rods that they are evaluated in parallel, and that those which touch nothing
//! are left out of the pattern of the matrix.

use super::*;
use crate::mechanics::Vector3;
use crate::mechanics::contact::ContactModel;
use crate::mechanics::scene::{RodDescription, Scene};
use crate::mechanics::system::Grasp;
use crate::mechanics::test_support::{
    clamp, contact, curved, fixed_steps, gravity, line, resumed, section, straight_rod,
};
use std::f64::consts::TAU;

/// Rods of a group.
const GROUP: usize = 3;
const GROUPS: usize = 45;

/// A ring, a clamped rod and a free rod, the same in each group. Groups are 2 m apart. The free
/// rod of the first group falls on another one if there is contact.
fn groups(count: usize, touches: bool) -> Scene {
    let mut scene = Scene {
        loads: vec![gravity(9.81)],
        ..Scene::default()
    };
    for group in 0..count {
        let origin = Vector3::x() * (2.0 * group as f64);
        let round = |k: usize| {
            let angle = TAU * k as f64 / 24.0;
            origin + Vector3::new(0.2 * angle.cos(), 0.2 * angle.sin(), 0.01 * angle)
        };
        let stiffness = section(1e3, [1e-2, 2e-2], 1e-2);
        let ring = RodDescription {
            closed: true,
            ..RodDescription::uniform("ring", (0..24).map(round).collect(), stiffness, 5e-3, 0.1)
        };
        let place = |from: [f64; 3], to: [f64; 3], edges: usize| RodDescription {
            centreline: line(
                origin + Vector3::from(from),
                origin + Vector3::from(to),
                edges,
            ),
            stiffness,
            ..straight_rod(edges, 1.0)
        };
        let mut clamped = place([0.0, 0.5, 0.0], [0.3, 0.5, 0.0], 10);
        clamped.natural_shape = curved([2.0, 1.0], 1.5);
        let free = place([0.0, 0.7, 0.01005], [0.5, 0.7, 0.01005], 20);
        scene.rods.extend([ring, clamped, free]);
        scene.clamps.push(clamp(GROUP * group + 1, 0));
    }
    if touches {
        let from = Vector3::new(0.23, 0.6, 0.0);
        scene.rods.push(RodDescription {
            centreline: line(from, from + Vector3::y() * 0.2, 8),
            held: true,
            ..straight_rod(8, 0.2)
        });
        scene.contact = Some(contact(ContactModel::ImplicitContact, 1e-4));
    }
    for (rod, description) in scene.rods.iter_mut().enumerate() {
        description.name = format!("rod {rod}");
    }
    scene
}

/// Runs the scene for six steps, after three of which a node of the second rod is grasped. With
/// more threads than one it is continued from its state after each step.
fn run_in(scene: &Scene, scheme: Scheme, threads: usize) -> Vec<Vector3> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    pool.build().unwrap().install(|| {
        let mut simulation = Simulation::new(scene, &fixed_steps(scheme, 1e-3)).unwrap();
        for step in 0..6 {
            if threads > 1 {
                simulation = resumed(scene, &fixed_steps(scheme, 1e-3), &simulation);
            }
            if step == 3 {
                let whole = Grasp {
                    position: true,
                    frame: true,
                };
                simulation.grasp(24 + 6, whole).unwrap();
            }
            let report = simulation.advance(1.0).unwrap();
            assert_eq!(report.retries, 0);
            if scene.contact.is_some() && step == 5 {
                assert!(report.contacts > 0, "{report:?}");
            }
        }
        simulation.positions().to_vec()
    })
}

#[test]
fn many_rods_move_as_few_and_neither_threads_nor_checkpoints_change_a_byte() {
    let of_group = 24 + 11 + 21;
    for scheme in [Scheme::ImplicitEuler, Scheme::BackwardDifferences] {
        for touches in [false, true] {
            let one = run_in(&groups(GROUPS, touches), scheme, 1);
            assert!(
                one == run_in(&groups(GROUPS, touches), scheme, 3),
                "{scheme:?} {touches}"
            );
            // The first group has what touches and is grasped, the second has neither.
            let two = run_in(&groups(2, touches), scheme, 1);
            for (group, nodes) in one.chunks(of_group).take(GROUPS).enumerate() {
                let alone = two.chunks(of_group).nth(group.min(1)).unwrap();
                let apart = Vector3::x() * (2.0 * (group - group.min(1)) as f64);
                for (node, alone) in nodes.iter().zip(alone) {
                    let difference = (node - apart - alone).norm();
                    assert!(
                        difference < 1e-11,
                        "{scheme:?} {touches} {group}: {difference:e}"
                    );
                }
            }
        }
    }
}
