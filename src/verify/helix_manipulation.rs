//! Helical rods manipulated slowly in time: the onset of their deviation from the helix, against
//! conjugate points.

use super::rods::{run_until, steps_of};
use super::{Check, Expectation, GroupError};
use rodlab_engine::mechanics::dynamics::{Simulation, SimulationError};
use rodlab_engine::mechanics::kirchhoff::{Helix, critical_distance};
use rodlab_engine::random::uniform_numbers;
use rodlab_lab::experiment::helix::manipulation::{
    Buckling, EndPath, Manipulation, Observation, helix_error,
};
use rodlab_lab::experiment::helix::stability::DiscreteRod;
use std::f64::consts::TAU;

const SLOW: Expectation = Expectation::new("e(‖(κ, τ, ω)‖) = 0.1, slowly", "Borum & Bretl 2020");
const ROD: DiscreteRod = DiscreteRod {
    edges: 100,
    stiffness_ratio: 1.0 / 1.33,
    bending_stiffness: 1.0,
};
/// Speed of the end in units of L/T, with T = L² √(ρA/EI): half of the rod length in a hundred T.
/// The period of the first vibration of the straight rod is 0.28 T.
const SPEED: f64 = 0.005;
/// Time step in units of T.
const STEP: f64 = 0.02;
/// Number of outputs along a path.
const OUTPUTS: usize = 500;
/// Length of a path, as a multiple of the critical distance.
const BEYOND: f64 = 1.1;
/// Least curvature of a manipulated direction, which is needed for a radius.
const LEAST_CURVATURE: f64 = 0.1;
/// Largest critical distance of a manipulated direction, for which 100 edges are sufficient.
const FARTHEST: f64 = 14.0;

/// Checks the distance at which the rod leaves the helix, for the worst of some random directions.
pub fn checks(full: bool) -> Result<Vec<Check>, GroupError> {
    let count = if full { 10 } else { 1 };
    let mut number = uniform_numbers(65);
    let mut worst = (1.0, 1.0);
    let mut taken = 0;
    while taken < count {
        let curvature = number();
        let (sine, cosine) = libm::sincos(TAU * number());
        let across = (1.0 - curvature * curvature).sqrt();
        let helix = Helix::from([curvature, across * cosine, across * sine]);
        let critical = critical_distance(&helix).map_or(f64::INFINITY, |found| found.distance);
        if curvature < LEAST_CURVATURE || critical > FARTHEST {
            continue;
        }
        taken += 1;
        let pair = (critical, leaves_helix(helix, critical)?);
        let difference = |(expected, got): (f64, f64)| (got / expected - 1.0).abs();
        if !(difference(pair) <= difference(worst)) {
            worst = pair;
        }
    }
    let name = format!("{count} random helices, manipulated slowly: buckling distance");
    Ok(vec![SLOW.of(name, "").relative(worst.0, worst.1, 3e-2)])
}

/// Distance at which the manipulated rod leaves the helix; NaN if it does not.
fn leaves_helix(direction: Helix, critical: f64) -> Result<f64, SimulationError> {
    let path = EndPath::new(&Manipulation {
        rod: ROD,
        direction,
        farthest: BEYOND * critical,
        speed: SPEED,
        jitter: 0.0,
        seed: 0,
    });
    let mut scene = ROD.straight();
    scene.clamps[1].motion = path.motion();
    let mut simulation = Simulation::new(&scene, &steps_of(STEP))?;
    let unit = direction.scaled(1.0 / direction.distance());
    let mut observations = Vec::new();
    for output in 1..=OUTPUTS {
        let until = path.duration() * output as f64 / OUTPUTS as f64;
        run_until(&mut simulation, until)?;
        let distance = path.distance(until);
        let helix = unit.scaled(distance);
        observations.push(Observation {
            distance,
            error: helix_error(simulation.positions(), &helix, ROD.enlargement(&helix)),
            kinetic_energy: simulation.energies().kinetic / (0.5 * SPEED * SPEED),
        });
    }
    Ok(Buckling::of(&observations).deviates.unwrap_or(f64::NAN))
}
