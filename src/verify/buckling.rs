//! Loads at which straight rods and rings buckle, because the stiffness matrix loses positive
//! definiteness, and a load at which small motions begin to flutter.

use super::check::order;
use super::rods::{STIFFNESS_RATIO, clamp, line, steady, straight, unit_rod, unit_stiffness};
use super::theory::beam::{CLAMPED_COLUMN, beck_load, clamped_twist_moment, ring_twist};
use super::{Check, Expectation, GroupError};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::{IntegrationParameters, Simulation, SimulationError};
use rodlab_engine::mechanics::kirchhoff::numerics::bisect;
use rodlab_engine::mechanics::scene::{LoadKind, NaturalShape, RodDescription, Scene};
use std::f64::consts::TAU;

const EULER: Expectation = Expectation::new("P = 4π² EI/L²", "Euler");
const GREENHILL: Expectation = Expectation::new("M = 2x EI/L, tan x = x", "Greenhill 1883");
const MICHELL: Expectation = Expectation::new("Θ = 2π√3 EI/GJ", "Michell 1889, Zajac 1962");
const BECK: Expectation = Expectation::new("P = 20.0509 EI/L²", "Beck 1952");
const EDGES: usize = 80;
/// Number of edges of Beck's column on the coarser of two meshes.
const BECK_EDGES: usize = 30;
/// Number of edges of the ring, which buckles into two waves. With 80 edges its error would be 0.5
/// %.
const RING_EDGES: usize = 140;
/// Allowed relative error.
const BOUND: f64 = 2e-3;

/// Checks Beck's column, Euler's column, the twisted rod and the twisted ring.
pub fn checks(_full: bool) -> Result<Vec<Check>, GroupError> {
    let [coarse, fine] = [flutter_load(BECK_EDGES)?, flutter_load(2 * BECK_EDGES)?];
    let exact = beck_load();
    let column = critical(
        0.5 * CLAMPED_COLUMN..2.0 * CLAMPED_COLUMN,
        compressed_column,
    )?;
    let rod = critical(5.0..15.0, twisted_rod)?;
    let ring = critical(10.0..25.0, twisted_ring)?;
    let beck = "Beck's column, pushed along its end, 60 edges: flutter load P L²/EI";
    Ok(vec![
        BECK.of(beck, "").relative(exact, fine, BOUND),
        order(
            "the same, 30 to 60 edges: order",
            (coarse - exact) / (fine - exact),
        ),
        EULER
            .of("column with clamped ends: critical load P L²/EI", "")
            .relative(CLAMPED_COLUMN, column, BOUND),
        GREENHILL
            .of("twisted rod with clamped ends: critical moment M L/EI", "")
            .relative(clamped_twist_moment(), rod, BOUND),
        MICHELL.of("twisted ring: critical twist", "rad").relative(
            ring_twist() * STIFFNESS_RATIO,
            ring,
            BOUND,
        ),
    ])
}

/// The load at which the lowest eigenvalue of the stiffness matrix turns negative.
fn critical(range: std::ops::Range<f64>, scene: fn(f64) -> Scene) -> Result<f64, SimulationError> {
    // Errors of a scene do not depend on the load, so that one run before the search reports them.
    Simulation::new(&scene(range.start), &IntegrationParameters::default())?;
    Ok(bisect(range.start, range.end, |load| {
        let simulation = Simulation::new(&scene(load), &IntegrationParameters::default());
        simulation.map_or(f64::NAN, |mut simulation| stability(&mut simulation))
    }))
}

/// The load at which Beck's column begins to flutter.
fn flutter_load(edges: usize) -> Result<f64, SimulationError> {
    let flutters = |load: f64| -> Result<bool, SimulationError> {
        let column = Scene {
            rods: vec![straight(edges)],
            clamps: vec![clamp(0)],
            loads: vec![steady(LoadKind::FollowerForce {
                rod: 0,
                node: edges,
                force: -load * Vector3::z(),
            })],
            ..Scene::default()
        };
        let mut simulation = Simulation::new(&column, &IntegrationParameters::default())?;
        simulation.find_nearby_equilibrium()?;
        let motions = simulation.small_motions();
        Ok(motions.is_some_and(|motions| motions.unstable.flutter > 0))
    };
    let (mut low, mut high) = (15.0, 25.0);
    while high - low > 1e-7 {
        let middle = 0.5 * (low + high);
        if flutters(middle)? {
            high = middle;
        } else {
            low = middle;
        }
    }
    Ok(low)
}

/// 1 if the configuration is stable, otherwise −1. Free rings have modes without stiffness, so
/// that an eigenvalue counts as negative only if its size exceeds the rounding error of the
/// largest.
fn stability(simulation: &mut Simulation) -> f64 {
    let mut matrix = simulation.stiffness_matrix();
    let rounding = 1e-12 * matrix.diagonal().amax();
    for i in 0..matrix.nrows() {
        matrix[(i, i)] += rounding;
    }
    if matrix.cholesky().is_some() {
        1.0
    } else {
        -1.0
    }
}

fn clamped(rod: RodDescription) -> Scene {
    let last = rod.centreline.len() - 1;
    Scene {
        rods: vec![rod],
        clamps: vec![clamp(0), clamp(last)],
        ..Scene::default()
    }
}

/// A column that is held at its length under the compressive force P.
fn compressed_column(force: f64) -> Scene {
    let shortening = force / unit_stiffness().stretching;
    let natural = line(Vector3::zeros(), Vector3::x(), EDGES);
    clamped(RodDescription {
        natural_shape: NaturalShape::Centreline(natural.clone()),
        ..unit_rod(natural.iter().map(|x| x * (1.0 - shortening)).collect())
    })
}

/// A straight rod under the twisting moment M. The twist between the first and the last edge does
/// not include half an edge at each end.
fn twisted_rod(moment: f64) -> Scene {
    let twist = moment / unit_stiffness().twisting * (EDGES as f64 - 1.0) / EDGES as f64;
    clamped(RodDescription {
        twist,
        ..straight(EDGES)
    })
}

/// A free ring of unit length with the given total twist.
fn twisted_ring(twist: f64) -> Scene {
    let corner = |k: usize| {
        let angle = TAU * k as f64 / RING_EDGES as f64;
        Vector3::new(libm::cos(angle), libm::sin(angle), 0.0) / TAU
    };
    Scene {
        rods: vec![RodDescription {
            closed: true,
            twist,
            ..unit_rod((0..RING_EDGES).map(corner).collect())
        }],
        ..Scene::default()
    }
}
