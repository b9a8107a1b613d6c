//! Beams that turn steadily about their clamp.

use super::benchmark::{Benchmark, BenchmarkRun, Measure, Quantity};
use super::measured::{self, mean_after};
use crate::reproduce::prelude::*;
use rodlab_engine::mechanics::kirchhoff::numerics::{bisect, runge_kutta};
use rodlab_files::results::read_nodes;

pub(super) static ROTATING_BEAM: Benchmark = Benchmark {
    name: "validation/rotating-beam",
    title: "Extension of a beam that turns steadily",
    about: "A beam of the length 10, EA = 2.8·10⁷, EI = 1.4·10⁴ and mass 1.2 per length turns about its clamp at 6 rad/s. \
            Centrifugal forces stretch it, by ω² ρA L³/3EA to first order. The material damps the first \
            vibration; the extension is the mean from 5 to 6 s.",
    source: "the steady state of the spin-up of Simo and Vu-Quoc 1986, J. Appl. Mech. 53, 855, after Kane, Ryan and \
             Banerjee 1987, J. Guid. Control Dyn. 10, 139",
    means: "closed form tan(k L)/k − L, k = ω √(ρA/EA)",
    scene: include_str!("scenes/rotating-beam.toml"),
    edges: [10, 20, 40],
    quantities: &[Quantity::new("extension, 10⁻⁴").published(5.14, 5e-3)],
    exact: || {
        let wave = 6.0 * (1.2f64 / 2.8e7).sqrt();
        vec![1e4 * (libm::tan(10.0 * wave) / wave - 10.0)]
    },
    measure: Measure::Run(|case| Ok(vec![1e4 * (mean_after(case, "length_m", 5.0)? - 10.0)])),
};

/// Rate of rotation of the vibrating beam.
const SPIN: f64 = 6.0;
/// Steps of the Runge–Kutta method along it, a multiple of the numbers of edges.
const STEPS: usize = 800;

pub(super) static ROTATING_BEAM_FLAP: Benchmark = Benchmark {
    name: "validation/rotating-beam-flap",
    title: "Frequency of a beam that turns steadily",
    about: "A beam of the length 1, EI = 1 and unit mass turns about its clamp at the rate 6, and vibrates along the \
            axis of rotation. Centrifugal forces raise its lowest frequency from 3.516 to 7.360 √(EI/ρA)/L². The \
            motion is projected on the mode by theory; the frequency follows from its changes of sign over \
            some five periods.",
    source: "Wright, Smith, Thresher and Wang 1982, J. Appl. Mech. 49, 197, with 7.3604",
    means: "shooting of w'''' − (T w')' = λ² w, T = ω² (1 − x²)/2, clamped and free",
    scene: include_str!("scenes/rotating-beam-flap.toml"),
    edges: [20, 40, 80],
    quantities: &[Quantity::new("frequency λ").published(7.3604, 5e-5)],
    exact: || vec![frequency()],
    measure: Measure::Run(flap),
};

/// The lowest frequency.
fn frequency() -> f64 {
    bisect(6.5, 8.5, |frequency| {
        let [one, other] = solutions(frequency).map(|states| states[STEPS]);
        one[2] * other[3] - one[3] * other[2]
    })
}

/// Solutions w, w', w'', w''' that begin with a unit curvature and with a unit shear.
fn solutions(frequency: f64) -> [Vec<[f64; 4]>; 2] {
    let slope = |x: f64, [w, first, second, third]: &[f64; 4]| {
        let tension = 0.5 * SPIN * SPIN * (1.0 - x * x);
        let fourth = tension * second - SPIN * SPIN * x * first + frequency * frequency * w;
        [*first, *second, *third, fourth]
    };
    [[0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]]
        .map(|start| runge_kutta(0.0, 1.0, start, STEPS, slope))
}

/// Measures the frequency of the lowest mode.
fn flap(case: &Case<BenchmarkRun>) -> Result<Vec<f64>> {
    let edges = case.run.edges;
    let [one, other] = solutions(frequency());
    let part = -one[STEPS][2] / other[STEPS][2];
    let mode: Vec<f64> = (0..=edges)
        .map(|node| {
            let at = node * STEPS / edges;
            let whole = if node == edges { 0.5 } else { 1.0 };
            whole * (one[at][0] + part * other[at][0])
        })
        .collect();
    let outputs = read_nodes(&case.directory, edges + 1)?;
    Ok(vec![measured::frequency(&outputs, &mode, |x| x.z)])
}
