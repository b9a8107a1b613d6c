//! Cantilevers that bend far, against the elastica.

use super::rods::{clamp, gravity, line, steady, unit_rod};
use super::{Check, Expectation, GroupError};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::{
    IntegrationParameters, Scheme, Simulation, SimulationError, StepSize,
};
use rodlab_engine::mechanics::kirchhoff::{Cantilever, CantileverLoad};
use rodlab_engine::mechanics::scene::{LoadKind, Scene};

const HEAVY: Expectation = Expectation {
    formula: "θ'' = −γ (1−s) cos θ",
    source: "elastica by shooting",
};
const TIP_LOADED: Expectation = Expectation {
    formula: "θ'' = −α cos θ",
    source: "Bisshopp & Drucker 1945",
};
const ORDER: Expectation = Expectation {
    formula: "log₂(error at N / error at 2N)",
    source: "second order",
};
const RELAXED: Expectation = Expectation {
    formula: "rest of damped motion = equilibrium",
    source: "static solution",
};

/// Ratio γ of weight to bending stiffness at which released codes were compared.
const GAMMA: f64 = 15.696;

/// Shapes of heavy and tip-loaded cantilevers, order of convergence, and the same by damped motion.
pub fn checks(full: bool) -> Result<Vec<Check>, GroupError> {
    let mut checks = Vec::new();
    let loads: &[(f64, f64)] = if full {
        &[
            (1.0, 3e-4),
            (2.0, 3e-4),
            (5.0, 3e-4),
            (10.0, 3e-4),
            (GAMMA, 3e-4),
            (30.0, 7e-4),
            (60.0, 7e-4),
            (100.0, 7e-4),
        ]
    } else {
        &[(1.0, 3e-4), (GAMMA, 3e-4), (100.0, 7e-4)]
    };
    for &(gamma, bound) in loads {
        let error = shape_error(CantileverLoad::OwnWeight(gamma), 50)?;
        let name = format!("heavy cantilever, γ = {gamma}, 50 edges: farthest node");
        checks.push(HEAVY.scaled(name, "m", 0.0, error, 1.0, bound));
    }
    let error = |edges| shape_error(CantileverLoad::OwnWeight(GAMMA), edges);
    for edges in [50, 100] {
        let order = libm::log2(error(edges)? / error(2 * edges)?);
        let name = format!("heavy cantilever, {edges} to {} edges: order", 2 * edges);
        checks.push(ORDER.scaled(name, "", 2.0, order, 1.0, 0.2));
    }
    checks.push(relaxation()?);
    for alpha in [1.0, 2.0, 5.0, 10.0] {
        let error = shape_error(CantileverLoad::TipForce(alpha), 50)?;
        let name = format!("tip-loaded cantilever, F L²/EI = {alpha}: farthest node");
        checks.push(TIP_LOADED.scaled(name, "m", 0.0, error, 1.0, 5e-4));
    }
    Ok(checks)
}

fn cantilever(load: CantileverLoad, edges: usize) -> Scene {
    let force = match load {
        CantileverLoad::OwnWeight(gamma) => gravity(gamma),
        CantileverLoad::TipForce(alpha) => steady(LoadKind::Force {
            rod: 0,
            node: edges,
            force: -alpha * Vector3::z(),
        }),
    };
    Scene {
        rods: vec![unit_rod(line(Vector3::zeros(), Vector3::x(), edges))],
        clamps: vec![clamp(0)],
        loads: vec![force],
        ..Scene::default()
    }
}

fn equilibrium(load: CantileverLoad, edges: usize) -> Result<Simulation, SimulationError> {
    let mut simulation =
        Simulation::new(&cantilever(load, edges), &IntegrationParameters::default())?;
    simulation.find_equilibrium()?;
    Ok(simulation)
}

/// Largest distance of a node from its place on the elastica, m.
fn shape_error(load: CantileverLoad, edges: usize) -> Result<f64, SimulationError> {
    let elastica = Cantilever::new(load);
    let simulation = equilibrium(load, edges)?;
    let distances = simulation.positions().iter().enumerate().map(|(k, node)| {
        let [x, drop] = elastica.position(k as f64 / edges as f64);
        (node - Vector3::new(x, 0.0, -drop)).norm()
    });
    Ok(distances.fold(0.0, f64::max))
}

/// A horizontal rod let go in a viscous medium comes to rest in the static shape.
fn relaxation() -> Result<Check, SimulationError> {
    let (load, edges) = (CantileverLoad::OwnWeight(GAMMA), 50);
    let resting = equilibrium(load, edges)?;
    let mut scene = cantilever(load, edges);
    scene.loads.push(steady(LoadKind::Drag {
        rod: None,
        translation: 10.0,
        rotation: 0.0,
    }));
    let parameters = IntegrationParameters {
        scheme: Scheme::ImplicitEuler,
        step: StepSize::Fixed(0.05),
        force_tolerance: 1e-9,
        displacement_tolerance: 1e-7,
        ..IntegrationParameters::default()
    };
    let mut simulation = Simulation::new(&scene, &parameters)?;
    let end = 20.0;
    while simulation.time() < end {
        simulation.advance(end)?;
    }
    let distance = simulation
        .positions()
        .iter()
        .zip(resting.positions())
        .map(|(moved, rests)| (moved - rests).norm())
        .fold(0.0, f64::max);
    let name = "heavy cantilever, damped motion to rest: farthest node";
    Ok(RELAXED.scaled(name, "m", 0.0, distance, 1.0, 1e-6))
}
