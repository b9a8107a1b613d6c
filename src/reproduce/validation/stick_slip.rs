//! A rod that sticks to a floor and slips on it.

use super::benchmark::{Benchmark, BenchmarkRun, Measure, Quantity};
use super::measured::series;
use super::root::root;
use crate::reproduce::prelude::*;
use rodlab_engine::mechanics::kirchhoff::numerics::{bisect, runge_kutta};
use std::f64::consts::{FRAC_2_PI, FRAC_PI_2};

const FRICTION: f64 = 0.7;
/// Final descent of the clamp.
const DESCENT: f64 = 0.3;

pub(super) static STICK_SLIP: Benchmark = Benchmark {
    name: "validation/stick-slip",
    title: "A rod that sticks and slips on a floor",
    about: "A rod of unit length and stiffness, by nature a quarter circle, is clamped horizontally; its tip stands \
            on a floor with the friction coefficient 0.7. The clamp descends by 0.3. At first the tip sticks, and the ratio of \
            tangential to normal force grows. When it reaches 0.7 the tip slips: it snaps \
            outwards by a fifth of the length, the normal force falls to a fourth, and the tip slides on. Contact is \
            rigid (`complementarity`).",
    source: "after the stick-slip test of Romero, Ly, Rasheed, Charrondière, Lazarus, Neukirch and Bertails-Descoubes 2021, ACM \
             Trans. Graph. 40, 66, with another rod",
    means: "shooting of the planar rod, with its tip held in place until the force leaves the friction cone, and with \
            the ratio 0.7 at the end",
    scene: include_str!("scenes/stick-slip.toml"),
    edges: [20, 40, 80],
    quantities: &[
        quantity("descent at which it slips"),
        quantity("normal force at the end"),
        quantity("place of the tip at the end"),
    ],
    exact: || {
        let held = |descent: f64| {
            // The tip descends from the arc in steps.
            (1..=20).fold([0.0; 3], |start, part| {
                let descent = descent * f64::from(part) / 20.0;
                root(start, |unknowns| {
                    let [x, z, _, moment] = tip(unknowns);
                    [moment, x - FRAC_2_PI, z + FRAC_2_PI - descent]
                })
            })
        };
        let slips = bisect(0.1, DESCENT, |descent| {
            let [_, tangential, normal] = held(descent);
            -tangential / normal - FRICTION
        });
        let slid = |[moment, normal]: [f64; 2]| [moment, -FRICTION * normal, normal];
        // Newton's method finds the same state from other starts, too.
        let at_end = root([1.5, 2.5], |unknowns| {
            let [_, z, _, moment] = tip(slid(unknowns));
            [moment, z + FRAC_2_PI - DESCENT]
        });
        vec![slips, at_end[1], tip(slid(at_end))[0]]
    },
    measure: Measure::Run(slip),
};

/// A quantity without a published value.
const fn quantity(name: &'static str) -> Quantity {
    Quantity {
        name,
        published: None,
        scale: None,
    }
}

/// Place x, z, angle and moment of the tip, for the moment at the clamp and the force n in the rod: θ' = −π/2 + m,
/// m' = n_x sin θ − n_z cos θ.
fn tip([moment, across, along]: [f64; 3]) -> [f64; 4] {
    let slope = |_: f64, [_, _, angle, moment]: &[f64; 4]| {
        let (sin, cos) = libm::sincos(*angle);
        [cos, sin, moment - FRAC_PI_2, across * sin - along * cos]
    };
    let states = runge_kutta(0.0, 1.0, [0.0, 0.0, 0.0, moment], 400, slope);
    states[states.len() - 1]
}

/// Measures the descent at the first slip, by extrapolation of the ratio of forces, and the state at the end.
fn slip(case: &Case<BenchmarkRun>) -> Result<Vec<f64>> {
    let columns = ["time_s", "floor_x_n", "floor_z_n", "tip_x_m"];
    let rows = series(case, columns)?;
    let ratio = |[_, tangential, normal, _]: &[f64; 4]| -tangential / normal;
    let slipped = rows.iter().position(|row| row[3] - FRAC_2_PI > 0.01);
    let slips = slipped.and_then(|index| {
        let [before, last] = [rows.get(index.checked_sub(2)?)?, &rows[index - 1]];
        let slope = (ratio(last) - ratio(before)) / (last[0] - before[0]);
        Some(DESCENT * (last[0] + (FRICTION - ratio(last)) / slope))
    });
    let [_, _, normal, place] = rows.last().copied().unwrap_or([f64::NAN; 4]);
    Ok(vec![slips.unwrap_or(f64::NAN), normal, place])
}
