//! The rod of the checks. The unit rod is a metre long and has unit bending stiffness, so that
//! loads are dimensionless.

use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::{
    IntegrationParameters, Scheme, Simulation, SimulationError, StepSize,
};
use rodlab_engine::mechanics::scene::{
    Clamp, Load, LoadKind, Motion, RodDescription, Scene, Stiffness,
};

/// Radius of the rod, m: slender enough for the theories of inextensible, unshearable rods.
pub const RADIUS: f64 = 1e-3;
/// Ratio EI/GJ of a circular cross-section of an incompressible material.
pub const STIFFNESS_RATIO: f64 = 1.5;

/// Stiffness of the unit rod: EI = 1 N m², GJ = EI/1.5, EA = 4 EI/h².
pub fn unit_stiffness() -> Stiffness {
    Stiffness {
        stretching: 4.0 / (RADIUS * RADIUS),
        bending: [1.0; 2],
        twisting: 1.0 / STIFFNESS_RATIO,
    }
}

/// An open, naturally straight rod of unit stiffness and 1 kg/m along a polyline.
pub fn unit_rod(centreline: Vec<Vector3>) -> RodDescription {
    RodDescription::uniform("rod", centreline, unit_stiffness(), RADIUS, 1.0)
}

/// A round rod with the given radius (m) and Young's modulus (Pa) and with 1000 kg/m³ along a
/// polyline; its material is incompressible.
pub fn round_rod(centreline: Vec<Vector3>, youngs_modulus: f64, radius: f64) -> RodDescription {
    let stiffness = Stiffness::circular(youngs_modulus, STIFFNESS_RATIO - 1.0, radius);
    let mass_per_length = 1000.0 * std::f64::consts::PI * radius * radius;
    RodDescription::uniform("rod", centreline, stiffness, radius, mass_per_length)
}

/// A rod of unit stiffness along x, from the origin.
pub fn straight(edges: usize) -> RodDescription {
    unit_rod(line(Vector3::zeros(), Vector3::x(), edges))
}

/// Fixed time steps, s.
pub fn steps_of(step: f64) -> IntegrationParameters {
    IntegrationParameters {
        step: StepSize::Fixed(step),
        ..IntegrationParameters::default()
    }
}

/// Advances a simulation to a time, s.
///
/// # Errors
/// The simulation fails before that time.
pub fn run_until(simulation: &mut Simulation, end: f64) -> Result<(), SimulationError> {
    while simulation.time() < end {
        simulation.advance(end)?;
    }
    Ok(())
}

/// Simulates a scene with fixed steps (s) up to a time (s).
///
/// # Errors
/// The simulation fails before that time.
pub fn run(
    scene: &Scene,
    scheme: Scheme,
    step: f64,
    end: f64,
) -> Result<Simulation, SimulationError> {
    let parameters = IntegrationParameters {
        scheme,
        ..steps_of(step)
    };
    let mut simulation = Simulation::new(scene, &parameters)?;
    run_until(&mut simulation, end)?;
    Ok(simulation)
}

/// Largest distance between corresponding nodes of two lists, m.
pub fn farthest(a: &[Vector3], b: &[Vector3]) -> f64 {
    let distances = a.iter().zip(b).map(|(a, b)| (a - b).norm());
    distances.fold(0.0, f64::max)
}

/// Equally spaced nodes from `start` to `end`.
pub fn line(start: Vector3, end: Vector3, edges: usize) -> Vec<Vector3> {
    (0..=edges)
        .map(|k| start.lerp(&end, k as f64 / edges as f64))
        .collect()
}

/// A clamp that holds position and frame of a node of the first rod.
pub fn clamp(node: usize) -> Clamp {
    Clamp {
        rod: 0,
        node,
        holds_position: true,
        holds_frame: true,
        motion: Motion::default(),
    }
}

/// A load that acts from the start.
pub fn steady(kind: LoadKind) -> Load {
    Load {
        kind,
        schedule: Vec::new(),
    }
}

/// Weight along −z.
pub fn gravity(acceleration: f64) -> Load {
    steady(LoadKind::Gravity {
        acceleration: -acceleration * Vector3::z(),
    })
}

/// A force on a node of the first rod, N.
pub fn force_on(node: usize, force: Vector3) -> LoadKind {
    LoadKind::Force {
        rod: 0,
        node,
        force,
    }
}
