//! Paths of equilibria. Critical loads of columns, strips and rings come from continuation; for
//! columns and strips also from the inertia of the Hessian at loads below and above.

use super::rods::{STIFFNESS_RATIO, clamp, force_on, straight, unit_rod, unit_stiffness};
use super::theory::beam::{CLAMPED_COLUMN, FREE_COLUMN, ring_twist, strip_tip_load};
use super::{Check, Expectation, GroupError};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::{IntegrationParameters, Simulation, SimulationError};
use rodlab_engine::mechanics::kirchhoff::numerics::bisect;
use rodlab_engine::mechanics::scene::{
    Clamp, Load, LoadKind, Motion, NaturalShape, RodDescription, Scene, Stiffness,
};
use rodlab_engine::mechanics::statics::{PathMethod, PathPlan, PointKind};
use std::f64::consts::TAU;

const EULER: Expectation = Expectation::new("P = c π² EI/L²", "Euler");
const PRANDTL: Expectation = Expectation::new("P = 4.0126 √(EI₁ GJ)/L²", "Prandtl 1899");
const MICHELL: Expectation = Expectation::new("Θ = 2π√3 EI/GJ", "Michell 1889, Zajac 1962");
const EDGES: usize = 100;
/// Number of edges of the ring, which buckles into two waves. With 140 edges its error would be
/// 0.18 %.
const RING_EDGES: usize = 200;
/// Allowed relative error.
const BOUND: f64 = 2e-3;
/// Bending stiffness of the strip in its stiff plane relative to that in its soft plane; the
/// theory assumes an infinite ratio.
const STRIP_RATIO: f64 = 1e4;

/// Checks critical loads from continuation and from the inertia.
pub fn checks(_full: bool) -> Result<Vec<Check>, GroupError> {
    let strip = unit_stiffness();
    let strip_unit = (strip.bending[0] * strip.twisting).sqrt();
    let column = "column clamped and free: P L²/EI";
    let clamped = "column with clamped ends: P L²/EI";
    let on_edge = "strip with a tip load: P L²/√(EI₁ GJ)";
    let push = strip.stretching;
    let cases = [
        (EULER, column, free_column(), FREE_COLUMN, 1.0),
        (EULER, clamped, clamped_column(), CLAMPED_COLUMN, push),
        (
            PRANDTL,
            on_edge,
            loaded_strip(),
            strip_tip_load(),
            1.0 / strip_unit,
        ),
    ];
    let mut checks = Vec::new();
    for (claim, name, scene, expected, unit) in cases {
        let end = 1.4 * expected / unit;
        for (how, critical) in [
            ("continuation", critical_on_path(&scene, end)?),
            ("inertia", critical_by_inertia(&scene, end)?),
        ] {
            let quantity = claim.of(format!("{name}, by {how}"), "");
            checks.push(quantity.relative(expected, unit * critical, BOUND));
        }
    }
    let ring = ring_twist() * STIFFNESS_RATIO;
    let name = "twisted ring: critical twist, by continuation";
    let got = critical_on_path(&twisted_ring(), 1.4 * ring)?;
    checks.push(MICHELL.of(name, "rad").relative(ring, got, BOUND));
    Ok(checks)
}

/// Parameter of the first bifurcation on the path from zero.
pub(super) fn critical_on_path(scene: &Scene, end: f64) -> Result<f64, SimulationError> {
    let mut simulation = Simulation::new(scene, &IntegrationParameters::default())?;
    let mut tracer = simulation.path(PathPlan {
        from: 0.0,
        to: end,
        step: 0.01 * end,
        largest_step: 0.01 * end,
        method: PathMethod::Natural,
        switch_branches: false,
        most_points: 200,
    })?;
    while let Some(point) = simulation.next_point(&mut tracer)? {
        if point.kind == PointKind::Bifurcation {
            return Ok(point.parameter);
        }
    }
    Ok(f64::NAN)
}

/// The load up to which the equilibrium is stable.
fn critical_by_inertia(scene: &Scene, end: f64) -> Result<f64, SimulationError> {
    Simulation::new(scene, &IntegrationParameters::default())?;
    Ok(bisect(0.0, end, |load| {
        let mut scene = scene.clone();
        for load_of_scene in &mut scene.loads {
            load_of_scene.schedule = vec![(0.0, load)];
        }
        for clamp in &mut scene.clamps {
            let moved = clamp.motion.translation.last().map(|(_, moved)| *moved);
            clamp.motion.translation = moved.map(|moved| (0.0, load * moved)).into_iter().collect();
        }
        let simulation = Simulation::new(&scene, &IntegrationParameters::default());
        let negative = simulation.and_then(|mut simulation| simulation.find_nearby_equilibrium());
        match negative {
            Ok(0) => 1.0,
            Ok(_) => -1.0,
            Err(_) => f64::NAN,
        }
    }))
}

/// A load that equals the parameter.
pub(super) fn growing(kind: LoadKind) -> Load {
    Load {
        kind,
        schedule: vec![(0.0, 0.0), (1.0, 1.0), (1e3, 1e3)],
    }
}

fn free_column() -> Scene {
    Scene {
        rods: vec![straight(EDGES)],
        clamps: vec![clamp(0)],
        loads: vec![growing(force_on(EDGES, -Vector3::x()))],
        ..Scene::default()
    }
}

/// A column whose far clamp moves towards the other one by the parameter, in m.
fn clamped_column() -> Scene {
    let moving = Clamp {
        motion: Motion {
            translation: vec![(0.0, Vector3::zeros()), (1.0, -Vector3::x())],
            ..Motion::default()
        },
        ..clamp(EDGES)
    };
    Scene {
        rods: vec![straight(EDGES)],
        clamps: vec![clamp(0), moving],
        ..Scene::default()
    }
}

/// A ring cut at one point, where clamps hold both faces; one of them turns by the parameter, in
/// rad. The clamps only remove rigid motions of the ring.
fn twisted_ring() -> Scene {
    let node = |k: usize| {
        let angle = TAU * k as f64 / RING_EDGES as f64;
        Vector3::new(libm::sin(angle), 1.0 - libm::cos(angle), 0.0) / TAU
    };
    let turning = Clamp {
        motion: Motion {
            angle: vec![(0.0, 0.0), (1e3, 1e3)],
            ..Motion::default()
        },
        ..clamp(RING_EDGES)
    };
    Scene {
        rods: vec![RodDescription {
            end_tangents: [Some(Vector3::x()); 2],
            ..unit_rod((0..=RING_EDGES).map(node).collect())
        }],
        clamps: vec![clamp(0), turning],
        ..Scene::default()
    }
}

/// A strip that stands on edge, stiff about y, and carries a load at its tip.
fn loaded_strip() -> Scene {
    let soft = unit_stiffness();
    Scene {
        rods: vec![RodDescription {
            first_director: Some(Vector3::z()),
            natural_shape: NaturalShape::Straight,
            stiffness: Stiffness {
                bending: [soft.bending[0], STRIP_RATIO * soft.bending[1]],
                ..soft
            },
            ..straight(EDGES)
        }],
        clamps: vec![clamp(0)],
        loads: vec![growing(force_on(EDGES, -Vector3::z()))],
        ..Scene::default()
    }
}
