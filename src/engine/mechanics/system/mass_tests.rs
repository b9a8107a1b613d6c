//! The mass matrix compared with its definition, on a rod with edges of various lengths and on a
//! ring, beside a rod with lumped masses.

use super::super::Stage;
use super::*;
use crate::linalg::BandedSymmetric;
use crate::mechanics::scene::RodDescription;
use crate::mechanics::scene::{Inertia, Scene};
use crate::mechanics::test_support::{clamp, section};

const MASS_PER_LENGTH: f64 = 0.7;
const INERTIA_PER_LENGTH: f64 = 0.3;
/// Nodes of the rods with consistent inertia; five more have lumped masses.
const CONSISTENT: Range<usize> = 0..10;

fn scene() -> Scene {
    let stiffness = section(30.0, [0.02, 0.05], 0.03);
    let rod = |name: &str, centreline: &[Vector3], closed, inertia| RodDescription {
        closed,
        inertia,
        rotational_inertia_per_length: INERTIA_PER_LENGTH,
        ..RodDescription::uniform(name, centreline.to_vec(), stiffness, 0.01, MASS_PER_LENGTH)
    };
    let uneven = [0.0, 0.1, 0.25, 0.3, 0.5].map(|x| Vector3::new(x, x * x, 0.0));
    let ring = [0, 1, 2, 3, 4].map(|k| {
        let turn = std::f64::consts::TAU * f64::from(k) / 5.0;
        Vector3::new(turn.cos(), turn.sin(), 1.0)
    });
    let clamp = clamp(0, 0);
    Scene {
        rods: vec![
            rod("uneven", &uneven, false, Inertia::Consistent),
            rod("ring", &ring, true, Inertia::Consistent),
            rod("lumped", &uneven, false, Inertia::Lumped),
        ],
        clamps: vec![clamp],
        ..Scene::default()
    }
}

/// Velocities that are not a rigid motion, of nodes only (m/s) or also of angles.
fn velocities(assembly: &Assembly, spins: bool) -> Vec<f64> {
    (0..assembly.unknowns.len())
        .map(|k| {
            if k % STRIDE == 3 && (!spins || assembly.held[k]) {
                0.0
            } else {
                (1.0 + 3.7 * k as f64).sin()
            }
        })
        .collect()
}

/// A stage from rest at the origin of all unknowns, in which unknowns are accelerations.
fn unit_stage(assembly: &Assembly) -> Stage {
    let start = vec![0.0; assembly.unknowns.len()];
    Stage {
        step: 1.0,
        acceleration_step: 1.0,
        keeps_spin: false,
        velocity: start.clone(),
        start,
        drag: Vec::new(),
        drag_velocity: Vec::new(),
        resistance: Vec::new(),
        flow_torque: Vec::new(),
        positions: Vec::new(),
        angles: Vec::new(),
    }
}

/// The forces of inertia of accelerations.
fn inertia(assembly: &Assembly, accelerations: &[f64]) -> Vec<f64> {
    let lumped = accelerations.iter().zip(&assembly.masses);
    let mut forces: Vec<f64> = lumped.map(|(a, m)| a * m).collect();
    assembly.add_shared_inertia(&unit_stage(assembly), accelerations, &mut forces);
    forces
}

#[test]
fn an_edge_moves_linearly_from_node_to_node() {
    let assembly = Assembly::new(&scene()).unwrap();
    let velocity = velocities(&assembly, false);
    let speed = |node: usize| position(&velocity, node);
    let mut kinetic = 0.0;
    for edge in &assembly.rods.edges {
        let mass = MASS_PER_LENGTH * edge.natural_length;
        // Two Gauss points integrate squares of linear functions exactly; evaluation at the two
        // nodes gives the lumped masses.
        let inner = if CONSISTENT.contains(&edge.start) {
            12f64.sqrt().recip()
        } else {
            0.5
        };
        for s in [0.5 - inner, 0.5 + inner] {
            let velocity = speed(edge.start) * (1.0 - s) + speed(edge.end) * s;
            kinetic += 0.25 * mass * velocity.norm_squared();
        }
    }
    let found = assembly.kinetic_energy(&(0..assembly.rods.nodes), &velocity);
    assert!((found / kinetic - 1.0).abs() < 1e-14, "{found} {kinetic}");
}

#[test]
fn forces_energy_and_matrix_are_of_one_positive_form_whose_rows_sum_to_the_lumped_masses() {
    let assembly = Assembly::new(&scene()).unwrap();
    let velocity = velocities(&assembly, true);
    let dense = assembly.mass_matrix();
    let expected = &dense * nalgebra::DVector::from_column_slice(&velocity);
    let forces = inertia(&assembly, &velocity);
    for (k, force) in forces.iter().enumerate() {
        assert!((force - expected[k]).abs() < 1e-15, "{k}");
    }
    let twice: f64 = forces.iter().zip(&velocity).map(|(p, v)| p * v).sum();
    let of_rods = assembly.rods.rods.iter().map(|range| range.node_indices());
    let kinetic: f64 = of_rods
        .map(|nodes| assembly.kinetic_energy(&nodes, &velocity))
        .sum();
    assert!((kinetic / (0.5 * twice) - 1.0).abs() < 1e-14);
    for (row, mass) in dense.row_iter().zip(&assembly.masses) {
        assert!((row.sum() - mass).abs() < 1e-15);
    }
    let last_angles = [4, 14].map(|node| STRIDE * node + 3);
    let lowest = dense
        .clone()
        .remove_rows_at(&last_angles)
        .remove_columns_at(&last_angles)
        .symmetric_eigenvalues()
        .min();
    assert!(lowest > 0.0, "{lowest}");
    // The band and the elements that close the ring contain the same values.
    let mut band = BandedSymmetric::new(velocity.len());
    for (column, mass) in band.columns_mut().iter_mut().zip(&assembly.masses) {
        column[0] = *mass;
    }
    let mut elements = vec![[[0.0; 12]; 12]; assembly.rods.elements.len()];
    assembly.add_shared_masses(1.0, band.columns_mut(), &mut elements);
    let mut sum = DMatrix::from_fn(velocity.len(), velocity.len(), |i, j| band.get(i, j));
    for (unknowns, matrix) in assembly.rods.elements.iter().zip(&elements) {
        for (i, row) in unknowns.iter().zip(matrix) {
            for (j, entry) in unknowns.iter().zip(row).filter(|(_, entry)| **entry != 0.0) {
                sum[(*i, *j)] += entry;
            }
        }
    }
    assert!((sum - dense).amax() < 1e-15);
}

#[test]
fn rods_with_lumped_masses_share_nothing() {
    let mut scene = scene();
    for rod in &mut scene.rods {
        rod.inertia = Inertia::Lumped;
    }
    let assembly = Assembly::new(&scene).unwrap();
    let velocity = velocities(&assembly, true);
    let forces = inertia(&assembly, &velocity);
    for ((force, velocity), mass) in forces.iter().zip(&velocity).zip(&assembly.masses) {
        assert_eq!(*force, velocity * mass);
    }
    let weighed = assembly.rods.vertices.iter().map(|vertex| vertex.weights);
    assert!(
        weighed
            .into_iter()
            .all(|weights| weights == Default::default())
    );
}

#[test]
fn rounding_beside_a_large_stiffness_takes_no_mass_from_a_row() {
    let assembly = Assembly::new(&scene()).unwrap();
    // Units in its last place are some thousandths of the masses.
    let stiffness = 1e12;
    let mut band = BandedSymmetric::new(assembly.unknowns.len());
    for (column, mass) in band.columns_mut().iter_mut().zip(&assembly.masses) {
        (column[0], column[STRIDE]) = (1.5 * stiffness + mass, -stiffness);
    }
    let mut elements = vec![[[0.0; 12]; 12]; assembly.rods.elements.len()];
    assembly.add_shared_masses(1.0, band.columns_mut(), &mut elements);
    let of_columns = band.columns_mut();
    // The first rod; the second closes by an element.
    for row in (0..STRIDE * 5).filter(|row| row % STRIDE != 3) {
        let shared = |column: usize| of_columns[column][STRIDE] + stiffness;
        let before = row.checked_sub(STRIDE).map_or(0.0, shared);
        let sum = of_columns[row][0] - 1.5 * stiffness + shared(row) + before;
        let last_place = f64::EPSILON * (1u64 << 40) as f64;
        let error = (sum - assembly.masses[row]).abs();
        assert!(error <= 1.001 * last_place, "{row}: {sum} {error}");
    }
}

#[test]
fn inertia_takes_momentum_and_angular_momentum_from_nowhere() {
    let assembly = Assembly::new(&scene()).unwrap();
    // Accelerations of a rigid body: the sums of the forces and moments are those of its masses,
    // up to the second moment of the polygon.
    let (pull, turn) = (Vector3::new(0.3, -0.2, 0.5), Vector3::new(1.0, 2.0, -0.7));
    let mut moved = vec![0.0; assembly.unknowns.len()];
    for node in CONSISTENT {
        let own = pull + turn.cross(&position(&assembly.unknowns, node));
        moved[STRIDE * node..STRIDE * node + 3].copy_from_slice(own.as_slice());
    }
    let forces = inertia(&assembly, &moved);
    let [momentum, angular] = assembly.momenta(&assembly.unknowns, &moved);
    let (mut force, mut moment) = (Vector3::zeros(), Vector3::zeros());
    let (mut expected, mut expected_moment) = (Vector3::zeros(), Vector3::zeros());
    for node in 0..assembly.rods.nodes {
        let own = position(&forces, node);
        force += own;
        moment += position(&assembly.unknowns, node).cross(&own);
    }
    for edge in (assembly.rods.edges.iter()).filter(|edge| CONSISTENT.contains(&edge.start)) {
        let mass = MASS_PER_LENGTH * edge.natural_length;
        for s in [0.5 - 12f64.sqrt().recip(), 0.5 + 12f64.sqrt().recip()] {
            let [start, end] =
                [edge.start, edge.end].map(|node| position(&assembly.unknowns, node));
            let place = start * (1.0 - s) + end * s;
            let acceleration = pull + turn.cross(&place);
            expected += acceleration * (0.5 * mass);
            expected_moment += place.cross(&acceleration) * (0.5 * mass);
        }
    }
    assert!((force - expected).norm() < 1e-14);
    assert!((moment - expected_moment).norm() < 1e-14);
    assert!((force - momentum).norm() < 1e-14);
    assert!((moment - angular).norm() < 1e-14);
}
