//! Cantilevers with large deflections, against the elastica.

use super::check::order;
use super::rods::{clamp, farthest, force_on, gravity, run_until, steady, steps_of, straight};
use super::{Check, Expectation, GroupError};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::{
    IntegrationParameters, Scheme, Simulation, SimulationError,
};
use rodlab_engine::mechanics::kirchhoff::{Cantilever, CantileverLoad};
use rodlab_engine::mechanics::scene::{LoadKind, Scene};

const HEAVY: Expectation = Expectation::new("θ'' = −γ (1−s) cos θ", "elastica by shooting");
const TIP_LOADED: Expectation = Expectation::new("θ'' = −α cos θ", "Bisshopp & Drucker 1945");
const RELAXED: Expectation =
    Expectation::new("rest of damped motion = equilibrium", "static solution");

/// Ratio γ of weight to bending stiffness for which the released codes were compared.
const GAMMA: f64 = 15.696;

/// Checks the shapes of heavy and tip-loaded cantilevers, their order of convergence, and the end
/// of a damped motion.
pub fn checks(full: bool) -> Result<Vec<Check>, GroupError> {
    let mut checks = Vec::new();
    let gammas: &[f64] = if full {
        &[1.0, 2.0, 5.0, 10.0, GAMMA, 30.0, 60.0, 100.0]
    } else {
        &[1.0, GAMMA, 100.0]
    };
    for &gamma in gammas {
        let bound = if gamma > GAMMA { 7e-4 } else { 3e-4 };
        let error = shape_error(CantileverLoad::OwnWeight(gamma), 50)?;
        let name = format!("heavy cantilever, γ = {gamma}, 50 edges: farthest node");
        checks.push(HEAVY.of(name, "m").zero(error, bound));
    }
    let error = |edges| shape_error(CantileverLoad::OwnWeight(GAMMA), edges);
    for edges in [50, 100] {
        let name = format!("heavy cantilever, {edges} to {} edges: order", 2 * edges);
        checks.push(order(name, error(edges)? / error(2 * edges)?));
    }
    checks.push(relaxation()?);
    for alpha in [1.0, 2.0, 5.0, 10.0] {
        let error = shape_error(CantileverLoad::TipForce(alpha), 50)?;
        let name = format!("tip-loaded cantilever, F L²/EI = {alpha}: farthest node");
        checks.push(TIP_LOADED.of(name, "m").zero(error, 5e-4));
    }
    Ok(checks)
}

fn cantilever(load: CantileverLoad, edges: usize) -> Scene {
    let force = match load {
        CantileverLoad::OwnWeight(gamma) => gravity(gamma),
        CantileverLoad::TipForce(alpha) => steady(force_on(edges, -alpha * Vector3::z())),
    };
    Scene {
        rods: vec![straight(edges)],
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

/// A horizontal rod that is released in a viscous medium comes to rest in the static shape.
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
        force_tolerance: 1e-9,
        displacement_tolerance: 1e-7,
        ..steps_of(0.05)
    };
    let mut simulation = Simulation::new(&scene, &parameters)?;
    run_until(&mut simulation, 20.0)?;
    let distance = farthest(simulation.positions(), resting.positions());
    let name = "heavy cantilever, damped motion to rest: farthest node";
    Ok(RELAXED.of(name, "m").zero(distance, 1e-6))
}
