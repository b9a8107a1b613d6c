//! Rods that are fed out of sheaths, and turned in them.

use super::scenario::moved;
use super::{Check, Expectation, GroupError};
use rodlab_engine::mechanics::kirchhoff::numerics::{bisect, runge_kutta};
use std::f64::consts::FRAC_PI_2;

const TIP: Expectation = Expectation::new("EI θ″ = −P cos θ", "elastica, by shooting");
const PUSHED_OUT: Expectation = Expectation::new(
    "F = −P sin θ",
    "M²/2EI + T along a rod; Bigoni, Dal Corso, Bosi and Misseroni 2015",
);
const TORQUE: Expectation = Expectation::new("GJ φ/ℓ", "constant twist");

/// EI and GJ, N m²; load across the end, N; length outside, m.
const BENDING: f64 = 0.01;
const TWISTING: f64 = 0.008;
const LOAD: f64 = 0.5;
const OUTSIDE: f64 = 0.297;
/// Place of the mouth, m.
const MOUTH: f64 = 0.4;

/// Checks a rod that bends outside, and one that twists.
pub fn checks(_full: bool) -> Result<Vec<Check>, GroupError> {
    let simulation = moved(include_str!("scenes/fed_rod.toml"), &[], 6.0)?;
    let tip = *simulation.positions().last().ok_or("the rod has nodes")?;
    let [force, _] = simulation.sheath_force(0);
    let [x, y, angle] = elastica(LOAD, OUTSIDE);
    let mut checks = vec![
        TIP.of(
            "rod fed out under a load across its end: its end along the sheath",
            "m",
        )
        .scaled(x, tip.x - MOUTH, OUTSIDE, 1e-3),
        TIP.of("the same, across the sheath", "m")
            .scaled(y, tip.y, OUTSIDE, 1e-3),
        PUSHED_OUT
            .of("force of the sheath that holds it back", "N")
            .relative(-LOAD * libm::sin(angle), force, 2e-3),
    ];
    let simulation = moved(include_str!("scenes/turned_rod.toml"), &[], 4.0)?;
    let [_, moment] = simulation.sheath_force(0);
    checks.push(
        TORQUE
            .of("rod drawn in and turned by 8 rad: torque", "N m")
            .relative(TWISTING * 8.0 / (0.3 - 0.043), moment, 1e-6),
    );
    Ok(checks)
}

/// End of a cantilever of a length (m) along and across its clamp, m, and its angle there, under a
/// dead load (N) across it.
fn elastica(load: f64, length: f64) -> [f64; 3] {
    // Angle, curvature and place, from the end on.
    let states = |angle: f64| {
        let slope = |_: f64, [angle, curvature, ..]: &[f64; 4]| {
            let (sin, cos) = libm::sincos(*angle);
            [*curvature, -load / BENDING * cos, cos, sin]
        };
        let states = runge_kutta(0.0, length, [angle, 0.0, 0.0, 0.0], 1000, slope);
        states[states.len() - 1]
    };
    let angle = bisect(0.0, FRAC_PI_2, |angle| states(angle)[0]);
    let [_, _, x, y] = states(angle);
    [x, y, angle]
}
