//! Orientation of a rectangular section, and axes about which natural curvatures bend: scenario
//! files against beam theory.

use rodlab::experiment;
use rodlab::mechanics::Vector3;
use rodlab::mechanics::dynamics::Simulation;
use rodlab::mechanics::kirchhoff::{Cantilever, CantileverLoad};
use std::path::Path;

const EDGES: usize = 100;
const WIDTH: f64 = 12e-3;
const THICKNESS: f64 = 4e-3;
const DENSITY: f64 = 1000.0;

/// Position at rest, m, of the tip of a strip of 1 m that is clamped at the origin along x.
fn tip(youngs_modulus: f64, director: [f64; 3], gravity: [f64; 3], natural: [f64; 2]) -> Vector3 {
    let text = format!(
        r#"experiment = "scene"
title = "strip"
[material]
youngs_modulus = {youngs_modulus:e}
poissons_ratio = 0.5
density = {DENSITY:e}
[[rods]]
name = "strip"
edges = {EDGES}
shape = {{ kind = "straight", start = [0, 0, 0], end = [1, 0, 0] }}
cross_section = {{ kind = "rectangle", width = {WIDTH:e}, thickness = {THICKNESS:e} }}
director = {director:?}
natural_curvature = {natural:?}
[[clamps]]
rod = "strip"
at = "start"
[[loads]]
kind = "gravity"
acceleration = {gravity:?}
[time]
mode = "static"
"#
    );
    let loaded = experiment::from_text("strip", &text, Path::new(""), &[]).unwrap();
    let prepared = experiment::prepare(&loaded.scenario).unwrap();
    let mut simulation = Simulation::new(&prepared.scene, &prepared.integration).unwrap();
    simulation.find_equilibrium().unwrap();
    simulation.positions()[EDGES]
}

/// EI, N m², of a rectangle that bends about the axis along its side `along`.
fn stiffness(youngs_modulus: f64, along: f64, across: f64) -> f64 {
    youngs_modulus * along * across.powi(3) / 12.0
}

#[test]
fn the_sag_of_a_strip_depends_on_its_orientation() {
    // A strip on edge stays in its plane: its weight is 7.2 √(EI₁ GJ)/L³, and it would tip over at
    // 12.9.
    let young = 1e9;
    let weight = DENSITY * 9.81 * WIDTH * THICKNESS;
    for (director, bending) in [
        ([0.0, 1.0, 0.0], stiffness(young, WIDTH, THICKNESS)),
        ([0.0, 0.0, 1.0], stiffness(young, THICKNESS, WIDTH)),
    ] {
        let theory = Cantilever::new(CantileverLoad::OwnWeight(weight / bending)).position(1.0);
        let found = tip(young, director, [0.0, 0.0, -9.81], [0.0; 2]);
        let expected = Vector3::new(theory[0], 0.0, -theory[1]);
        let error = (found - expected).norm();
        assert!(
            error < 2e-4,
            "director {director:?}: {found} for {expected}"
        );
    }
}

#[test]
fn a_tilted_strip_bends_about_both_axes() {
    // The load is a thousandth of one with large deflections, so that deflections are additive.
    let (young, gravity, tilt) = (100e6, 9.81e-3, 0.4_f64);
    let load = DENSITY * gravity * WIDTH * THICKNESS;
    let (first, second) = (
        Vector3::new(0.0, tilt.cos(), tilt.sin()),
        Vector3::new(0.0, -tilt.sin(), tilt.cos()),
    );
    let found = tip(young, first.into(), [0.0, 0.0, -gravity], [0.0; 2]);
    let weight = Vector3::new(0.0, 0.0, -load);
    let deflection = |towards: &Vector3, bending: f64| weight.dot(towards) / (8.0 * bending);
    for (towards, bending) in [
        (first, stiffness(young, THICKNESS, WIDTH)),
        (second, stiffness(young, WIDTH, THICKNESS)),
    ] {
        let expected = deflection(&towards, bending);
        let error = found.dot(&towards) / expected - 1.0;
        assert!(error.abs() < 2e-3, "{expected:e}: {error:e}");
    }
}

#[test]
fn natural_curvatures_turn_about_the_directors() {
    // The directors are m₁ = y and m₂ = x × y = z, so that dt/ds = (a y + b z) × t.
    for [a, b] in [[0.8, 0.0], [0.0, 0.8], [0.5, -1.1]] {
        let curvature = f64::hypot(a, b);
        let towards = Vector3::new(0.0, b, -a) / curvature;
        let expected = Vector3::x() * (curvature.sin() / curvature)
            + towards * ((1.0 - curvature.cos()) / curvature);
        let found = tip(100e6, [0.0, 1.0, 0.0], [0.0; 3], [a, b]);
        let error = (found - expected).norm();
        assert!(error < 1e-4, "[{a}, {b}]: {found} for {expected}");
    }
}
