//! A snake that crawls by waves of its natural curvature, from the scenario file.

use super::rods::run_until;
use super::scenario::simulation;
use super::theory::crawler::Crawler;
use super::{Check, Expectation, GroupError};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::Simulation;

const CRAWLING: Expectation = Expectation::new(
    "Ṗ = ⟨a⟩, ḣ = ⟨x × a⟩ for a curve of prescribed κ(s, t)",
    "Hu et al. 2009, with inertia",
);

/// Edges of the snake.
const EDGES: usize = 80;
/// Number of periods until the motion is steady, to 1e-4 of the speed.
const PERIODS: usize = 4;

/// Speed of the snake over its last period.
pub(super) fn check() -> Result<Check, GroupError> {
    let text = include_str!("../../scenarios/snake.toml");
    let mut simulation = simulation(text, &[])?;
    let centre = |simulation: &Simulation| {
        let positions = simulation.positions();
        let inner: Vector3 = positions[1..EDGES].iter().sum();
        (inner + 0.5 * (positions[0] + positions[EDGES])) / EDGES as f64
    };
    run_until(&mut simulation, (PERIODS - 1) as f64)?;
    let before = centre(&simulation);
    run_until(&mut simulation, PERIODS as f64)?;
    let got = (centre(&simulation) - before).norm();
    let theory = Crawler {
        length: 1.0,
        curvature: 7.0,
        wavelength: 1.0,
        frequency: -1.0,
        gravity: 9.81,
        friction: [0.1, 0.15, 0.3],
    };
    let name = "snake with friction by direction: speed";
    Ok(CRAWLING
        .of(name, "m/s")
        .relative(theory.speed(PERIODS), got, 1e-2))
}
