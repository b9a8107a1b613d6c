//! Forces defined in code, in motion and at rest.

use super::spring_tests::{MASS, STIFFNESS, rod};
use super::*;
use crate::mechanics::scene::{NodeForce, NodeHessian, RodNode, Scene};
use crate::mechanics::test_support::{at, fixed_steps, spring};
use crate::mechanics::{Matrix3, SceneError, Vector3};
use std::f64::consts::TAU;
use std::sync::Arc;

/// E = ½ k ‖x₁ − x₀‖² of a single node, or ½ k ‖x₁ − x₂‖² of two nodes.
#[derive(Debug)]
struct Pull {
    nodes: Vec<RodNode>,
    anchor: Vector3,
    stiffness: f64,
}

impl Pull {
    fn span(&self, positions: &[Vector3]) -> Vector3 {
        positions[0] - positions.get(1).unwrap_or(&self.anchor)
    }
}

impl NodeForce for Pull {
    fn name(&self) -> &str {
        "pull"
    }

    fn nodes(&self) -> Vec<RodNode> {
        self.nodes.clone()
    }

    fn energy(&self, positions: &[Vector3]) -> f64 {
        0.5 * self.stiffness * self.span(positions).norm_squared()
    }

    fn add_gradient(&self, positions: &[Vector3], gradient: &mut [Vector3]) {
        let force = self.stiffness * self.span(positions);
        for (own, sign) in gradient.iter_mut().zip([1.0, -1.0]) {
            *own += sign * force;
        }
    }

    fn add_hessian(&self, positions: &[Vector3], hessian: &mut NodeHessian) {
        for i in 0..positions.len() {
            for j in 0..positions.len() {
                let sign = if i == j { 1.0 } else { -1.0 };
                hessian[i][j] += sign * self.stiffness * Matrix3::identity();
            }
        }
    }
}

/// A rod along x. Springs with stiffness proportional to the node masses pull its nodes towards
/// points 5 mm above them.
fn held() -> Scene {
    let rod = rod("rod", Vector3::zeros(), Vector3::x());
    let force = |(node, place): (usize, &Vector3)| {
        let part = if node % 4 == 0 { 0.125 } else { 0.25 };
        let pull = Pull {
            nodes: vec![at(0, node)],
            anchor: place + 0.005 * Vector3::z(),
            stiffness: part * STIFFNESS,
        };
        Arc::new(pull) as Arc<dyn NodeForce>
    };
    Scene {
        forces: rod.centreline.iter().enumerate().map(force).collect(),
        rods: vec![rod],
        ..Scene::default()
    }
}

#[test]
fn a_rod_on_springs_to_the_ground_swings_as_in_theory() {
    let frequency = (STIFFNESS / MASS).sqrt();
    let step = TAU / frequency / 1000.0;
    let parameters = fixed_steps(Scheme::BackwardDifferences, step);
    let mut simulation = Simulation::new(&held(), &parameters).unwrap();
    let end = 2.0 * TAU / frequency;
    while simulation.time() < end {
        simulation.advance(end).unwrap();
        let height = 0.005 * (1.0 - libm::cos(frequency * simulation.time()));
        for position in simulation.positions() {
            assert!((position.z - height).abs() < 1e-5, "{position} {height}");
        }
        let force = 0.125 * STIFFNESS * (0.005 - simulation.positions()[0].z);
        assert!((simulation.node_force(0).z - force).abs() < 1e-12);
    }
}

#[test]
fn a_rod_on_springs_to_the_ground_rests_at_their_ends() {
    let mut simulation =
        Simulation::new(&held(), &fixed_steps(Scheme::ImplicitEuler, 1e-3)).unwrap();
    simulation.find_equilibrium().unwrap();
    for position in simulation.positions() {
        assert!((position.z - 0.005).abs() < 1e-9, "{position}");
    }
}

#[test]
fn a_force_between_nodes_moves_them_as_a_spring_does() {
    let x = Vector3::x();
    let nodes = [at(0, 4), at(1, 0)];
    let rods = vec![
        rod("left", -0.11 * x, x),
        rod("right", 0.01 * x, Vector3::y()),
    ];
    let of_code = Scene {
        rods: rods.clone(),
        forces: vec![Arc::new(Pull {
            nodes: nodes.to_vec(),
            anchor: Vector3::zeros(),
            stiffness: STIFFNESS,
        })],
        ..Scene::default()
    };
    let mut tie = spring("tie", nodes, STIFFNESS);
    tie.rest_length = Some(0.0);
    let of_numbers = Scene {
        rods,
        springs: vec![tie],
        ..Scene::default()
    };
    let ends = [of_code, of_numbers].map(|scene| {
        let parameters = fixed_steps(Scheme::ImplicitEuler, 1e-3);
        let mut simulation = Simulation::new(&scene, &parameters).unwrap();
        while simulation.time() < 0.05 {
            simulation.advance(0.05).unwrap();
        }
        (
            simulation.positions().to_vec(),
            simulation.energies().stretching,
        )
    });
    let [(one, energy), (other, expected)] = &ends;
    for (one, other) in one.iter().zip(other) {
        assert!((one - other).norm() < 1e-12, "{one} {other}");
    }
    assert!((energy - expected).abs() < 1e-12 * expected);
}

#[test]
fn forces_on_nodes_that_do_not_exist_are_refused() {
    for nodes in [vec![], vec![at(0, 5)], vec![at(1, 0)], vec![at(0, 1); 5]] {
        let mut scene = held();
        scene.forces.push(Arc::new(Pull {
            nodes,
            anchor: Vector3::zeros(),
            stiffness: 1.0,
        }));
        let error = Simulation::new(&scene, &fixed_steps(Scheme::ImplicitEuler, 1e-3)).err();
        let expected = SceneError::Force("pull".to_owned()).to_string();
        assert_eq!(error.map(|error| error.to_string()), Some(expected));
    }
}
