//! Tests of the fluid beside a wall.

use super::*;
use crate::mechanics::{Matrix3, Vector3};
use std::f64::consts::PI;

const STOKESLETS: FluidModel = FluidModel::RegularizedStokeslets {
    viscosity: 1.0,
    regularization: 1.65,
    far_field_error: 1e-4,
};

fn filament(nodes: usize) -> Filament {
    Filament {
        first_node: 0,
        nodes,
        closed: false,
        radius: 1.0,
    }
}

/// The wall z = 0 with some held nodes.
fn floor(held: &[usize]) -> Wall {
    Wall {
        point: Vector3::zeros(),
        normal: Vector3::z(),
        held: held.to_vec(),
    }
}

/// A straight filament of radius 1 along x.
fn lying(nodes: usize, length: f64, height: f64) -> Vec<Vector3> {
    (0..nodes)
        .map(|k| Vector3::new(length * k as f64 / (nodes - 1) as f64, 0.0, height))
        .collect()
}

/// Forces and resistances of one filament of radius 1, beside a wall or without one.
fn drag(
    wall: Option<Wall>,
    positions: &[Vector3],
    velocities: &[Vector3],
) -> Result<(Vec<Vector3>, Vec<Matrix3>), FluidError> {
    let filaments = [filament(positions.len())];
    let mut fluid = match wall {
        Some(wall) => Fluid::beside_wall(&STOKESLETS, &filaments, wall)?,
        None => Fluid::new(&STOKESLETS, &filaments)?,
    };
    let mut forces = vec![Vector3::zeros(); positions.len()];
    let mut resistance = vec![Matrix3::zeros(); positions.len()];
    fluid.drag(positions, velocities, &[], &mut forces, &mut resistance)?;
    Ok((forces, resistance))
}

#[test]
fn a_long_cylinder_glides_along_a_wall_as_in_bipolar_coordinates() {
    let nodes = 121;
    let positions = lying(nodes, 600.0, 0.0);
    for (height, bound) in [(3.0, 0.04), (5.0, 0.015), (10.0, 0.005)] {
        let placed: Vec<_> = (positions.iter())
            .map(|x| x + Vector3::z() * height)
            .collect();
        let (forces, _) = drag(Some(floor(&[])), &placed, &vec![Vector3::x(); nodes]).unwrap();
        let got = -forces[nodes / 2].x / 5.0;
        let expected = 2.0 * PI / libm::acosh(height);
        let error = (got / expected - 1.0).abs();
        assert!(error < bound, "{height}: {got} {expected}");
    }
}

#[test]
fn drag_grows_as_the_gap_closes_and_is_free_far_away() {
    let nodes = 41;
    for direction in [Vector3::x(), Vector3::y(), Vector3::z()] {
        let total = |wall: Option<Wall>, height: f64| {
            let (forces, _) =
                drag(wall, &lying(nodes, 200.0, height), &vec![direction; nodes]).unwrap();
            -forces.iter().sum::<Vector3>().dot(&direction)
        };
        let mut last = total(None, 0.0);
        let free = last;
        let far = total(Some(floor(&[])), 1e6);
        assert!((far / free - 1.0).abs() < 1e-4, "{far} {free}");
        for height in [100.0, 30.0, 10.0, 5.0, 3.0, 2.0, 1.2, 0.5, 0.1] {
            let now = total(Some(floor(&[])), height);
            assert!(now > last, "{direction} {height}");
            last = now;
        }
        assert!(last > 10.0 * free, "{last} {free}");
    }
}

#[test]
fn a_wall_turns_with_the_scene() {
    let nodes = 30;
    let positions: Vec<Vector3> = (0..nodes)
        .map(|k| {
            let s = 0.4 * k as f64;
            Vector3::new(20.0 * s.cos(), 8.0 * s.sin(), 3.0 + s)
        })
        .collect();
    let velocities: Vec<Vector3> = positions
        .iter()
        .map(|x| Vector3::new(0.1, -0.2, 0.3).cross(x) + Vector3::y())
        .collect();
    let (forces, resistance) = drag(Some(floor(&[])), &positions, &velocities).unwrap();
    let rotation = nalgebra::Rotation3::from_scaled_axis(Vector3::new(0.8, -1.7, 0.4));
    let shift = Vector3::new(3.0, -40.0, 7.0);
    let moved: Vec<_> = positions.iter().map(|x| rotation * x + shift).collect();
    let turned: Vec<_> = velocities.iter().map(|v| rotation * v).collect();
    let wall = Wall {
        point: rotation * Vector3::new(100.0, 30.0, 0.0) + shift,
        normal: rotation * Vector3::z(),
        held: Vec::new(),
    };
    let (moved_forces, moved_resistance) = drag(Some(wall), &moved, &turned).unwrap();
    let scale = forces.iter().map(|f| f.norm()).fold(0.0, f64::max);
    for k in 0..nodes {
        assert!(
            (rotation * forces[k] - moved_forces[k]).norm() < 1e-5 * scale,
            "{k}"
        );
        let expected = rotation * resistance[k] * rotation.inverse();
        assert!(
            (expected - moved_resistance[k]).norm() < 1e-5 * expected.norm(),
            "{k}"
        );
    }
}

#[test]
fn resistances_beside_a_wall_are_positive_and_forces_do_not_depend_on_the_solver() {
    // In a fluid at rest, drag takes energy from any motion.
    let nodes = 60;
    let positions: Vec<Vector3> = (0..nodes)
        .map(|k| {
            Vector3::new(
                2.0 * k as f64,
                (0.3 * k as f64).sin(),
                1.5 + 0.05 * k as f64,
            )
        })
        .collect();
    for mode in 0..6 {
        let velocities: Vec<Vector3> = (0..nodes)
            .map(|k| {
                let phase = 0.2 * (mode * k) as f64;
                Vector3::new(phase.cos(), (1.3 * phase).sin(), (0.7 * phase).cos())
            })
            .collect();
        let (forces, resistance) = drag(Some(floor(&[])), &positions, &velocities).unwrap();
        let power: f64 = forces.iter().zip(&velocities).map(|(f, v)| f.dot(v)).sum();
        assert!(power < 0.0, "{mode}: {power}");
        for matrix in resistance {
            assert!(matrix.symmetric_eigenvalues().min() > 0.0, "{matrix}");
        }
    }
}

#[test]
fn a_rod_clamped_in_the_wall_takes_no_force_there() {
    let nodes = 21;
    let upright = |depth: f64| -> Vec<Vector3> {
        (0..nodes)
            .map(|k| Vector3::z() * (5.0 * k as f64 - if k == 0 { depth } else { 0.0 }))
            .collect()
    };
    let velocities: Vec<Vector3> = (0..nodes).map(|k| Vector3::x() * k as f64).collect();
    let (forces, resistance) = drag(Some(floor(&[0])), &upright(0.0), &velocities).unwrap();
    assert_eq!(forces[0], Vector3::zeros());
    assert_eq!(resistance[0], Matrix3::zeros());
    assert!(forces[1..].iter().all(|force| force.x < 0.0));
    // The result does not depend on the depth of the clamped end, since its edge starts at the
    // wall.
    let (deep, _) = drag(Some(floor(&[0])), &upright(7.0), &velocities).unwrap();
    for (force, deep) in forces.iter().zip(&deep) {
        assert!((force - deep).norm() < 1e-6 * forces[10].norm());
    }
    let free = drag(Some(floor(&[])), &upright(0.0), &velocities);
    assert!(
        matches!(free, Err(FluidError::BehindWall { node: 0, .. })),
        "{free:?}"
    );
}

#[test]
fn more_than_a_thousand_nodes_feel_the_wall_exactly() {
    // Compared with the same filament with every second node: a straight rod in uniform motion.
    let at = |nodes: usize| {
        let positions = lying(nodes, 4400.0, 3.0);
        let (forces, _) = drag(Some(floor(&[])), &positions, &vec![Vector3::x(); nodes]).unwrap();
        forces.iter().map(|force| force.x).sum::<f64>()
    };
    let (fine, coarse) = (at(1101), at(551));
    assert!((fine / coarse - 1.0).abs() < 1e-3, "{fine} {coarse}");
    let many = Fluid::beside_wall(&STOKESLETS, &[filament(5001)], floor(&[]));
    assert!(matches!(many, Err(FluidError::BadInput(_))));
}

#[test]
fn only_regularized_stokeslets_have_walls() {
    let resistive = FluidModel::Resistive { viscosity: 1.0 };
    let refused = Fluid::beside_wall(&resistive, &[filament(9)], floor(&[]));
    assert!(matches!(refused, Err(FluidError::BadInput(_))));
    let crooked = Wall {
        normal: Vector3::new(0.0, 0.0, 2.0),
        ..floor(&[])
    };
    let refused = Fluid::beside_wall(&STOKESLETS, &[filament(9)], crooked);
    assert!(matches!(refused, Err(FluidError::BadInput(_))));
}

#[test]
fn a_restored_fluid_beside_a_wall_continues_with_the_same_bytes() {
    let nodes = 50;
    let at = |time: f64| -> Vec<Vector3> {
        let place = |k: usize| {
            let s = 3.0 * k as f64;
            Vector3::new(s, (0.1 * s + time).sin(), 4.0 + (0.1 * s - time).cos())
        };
        (0..nodes).map(place).collect()
    };
    let mut fluid = Fluid::beside_wall(&STOKESLETS, &[filament(nodes)], floor(&[])).unwrap();
    let mut forces = vec![Vector3::zeros(); nodes];
    let mut resistance = vec![Matrix3::zeros(); nodes];
    let velocities = vec![Vector3::new(1.0, 0.5, -0.1); nodes];
    for step in 0..3 {
        let positions = at(0.01 * f64::from(step));
        (fluid.drag(&positions, &velocities, &[], &mut forces, &mut resistance)).unwrap();
    }
    let mut restored = Fluid::beside_wall(&STOKESLETS, &[filament(nodes)], floor(&[])).unwrap();
    restored.restore(fluid.memory()).unwrap();
    let positions = at(0.03);
    (fluid.drag(&positions, &velocities, &[], &mut forces, &mut resistance)).unwrap();
    let mut again = vec![Vector3::zeros(); nodes];
    (restored.drag(&positions, &velocities, &[], &mut again, &mut resistance)).unwrap();
    assert_eq!(forces, again);
}
