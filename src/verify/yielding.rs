//! Rods that yield: the curvature or twist under a load, and what they keep of it.

use super::rods::run_until;
use super::scenario::simulation;
use super::{Check, Expectation, GroupError};
use rodlab_engine::mechanics::dynamics::{Resultants, Simulation};
use std::f64::consts::PI;

const STRIP: &str = include_str!("scenes/yielding_strip.toml");
const WIRE: &str = include_str!("scenes/yielding_wire.toml");

const BENT: Expectation = Expectation::new("M = M_y (3 − (κ_y/κ)²)/2", "elastic–perfectly plastic");
const HARDENED: Expectation = Expectation::new(
    "M = E_t I κ + (1 − E_t/E) M_y (3 − (κ_y/κ)²)/2",
    "linear hardening",
);
const TWISTED: Expectation =
    Expectation::new("T = T_y (4 − (τ_y/τ)³)/3", "elastic–perfectly plastic");
const KEPT: Expectation = Expectation::new("κ − M/EI", "elastic unloading");
const KEPT_TWIST: Expectation = Expectation::new("τ − T/GJ", "elastic unloading");

/// Allowed relative error; the section is a sum of layers.
const BOUND: f64 = 0.01;

/// Young's modulus and yield stress of both scenes, Pa.
const YOUNG: f64 = 1e9;
const YIELD_STRESS: f64 = 1.5e6;
/// Width and thickness of the strip, and radius of the wire, m.
const STRIP_SIDES: [f64; 2] = [4e-3, 1e-3];
const RADIUS: f64 = 0.5e-3;
/// Node in the middle of the rods.
const MIDDLE: usize = 10;
/// Times at which the rods are loaded and unloaded, s.
const TIMES: [f64; 2] = [4.0, 9.0];

/// Checks bending with and without hardening, and twisting.
pub fn checks(_full: bool) -> Result<Vec<Check>, GroupError> {
    let [width, thickness] = STRIP_SIDES;
    let stiffness = YOUNG * width * thickness.powi(3) / 12.0;
    let limit = 2.0 * YIELD_STRESS / (YOUNG * thickness);
    let mut checks = Vec::new();
    for (load, hardening, law) in [(1.3, 0.0, BENT), (1.6, 0.25, HARDENED)] {
        let over = exceeded(load, |over: f64| {
            hardening * over + (1.0 - hardening) * 0.5 * (3.0 - over.powi(-2))
        });
        let keys = [
            format!("parameters.moment={}", load * stiffness * limit),
            format!("material.tangent_modulus={}", hardening * YOUNG),
        ];
        let [bent, kept] = loaded(STRIP, &keys, |found| found.curvature)?;
        let name = format!("strip under {load} M_y, E_t = {hardening} E: curvature");
        checks.push(law.of(name, "1/m").relative(over * limit, bent, BOUND));
        let name = "the same strip without load: curvature";
        let expected = (over - load) * limit;
        checks.push(KEPT.of(name, "1/m").relative(expected, kept, BOUND));
    }
    let shear_modulus = YOUNG / 3.0;
    let stiffness = shear_modulus * 0.5 * PI * RADIUS.powi(4);
    let limit = YIELD_STRESS / (3.0_f64.sqrt() * shear_modulus * RADIUS);
    let load = 1.2;
    let over = exceeded(load, |over: f64| (4.0 - over.powi(-3)) / 3.0);
    let keys = [format!("parameters.moment={}", load * stiffness * limit)];
    let [twisted, kept] = loaded(WIRE, &keys, |found| found.twist.abs())?;
    let name = format!("wire under {load} T_y: twist per length");
    checks.push(
        TWISTED
            .of(name, "rad/m")
            .relative(over * limit, twisted, BOUND),
    );
    let name = "the same wire without load: twist per length";
    let expected = (over - load) * limit;
    checks.push(KEPT_TWIST.of(name, "rad/m").relative(expected, kept, BOUND));
    Ok(checks)
}

/// Ratio of a strain to that at the onset of yielding, for a load relative to that at the onset.
fn exceeded(load: f64, law: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (1.0, 1e3);
    while high - low > 1e-12 * high {
        let middle = 0.5 * (low + high);
        match law(middle) < load {
            true => low = middle,
            false => high = middle,
        }
    }
    low
}

/// A strain in the middle of a rod under load, and without load again.
fn loaded(
    scene: &str,
    keys: &[String],
    strain: impl Fn(&Resultants) -> f64,
) -> Result<[f64; 2], GroupError> {
    let mut simulation = simulation(scene, keys)?;
    let of = |simulation: &Simulation| {
        let found = &simulation.resultants()[MIDDLE];
        found.as_ref().map_or(f64::NAN, &strain)
    };
    run_until(&mut simulation, TIMES[0])?;
    let under = of(&simulation);
    run_until(&mut simulation, TIMES[1])?;
    Ok([under, of(&simulation)])
}
