//! A rod that twines around itself.

use super::benchmark::{Benchmark, BenchmarkRun, Measure, Quantity};
use super::measured::series;
use crate::reproduce::prelude::*;
use rodlab_engine::mechanics::kirchhoff::numerics::bisect;

/// Radius of the rod.
const RADIUS: f64 = 0.01;

pub(super) static PLECTONEME: Benchmark = Benchmark {
    name: "validation/plectoneme",
    title: "Force and moment of a plectoneme",
    about: "A rod of unit length, the radius 0.01 and EI = GJ = 1, without friction, is turned by five turns at one end, \
            which approaches the other one by 0.45. It twines around itself. In a uniform plectoneme of the helix \
            angle α the external force and moment are F = EI/r² sin⁴α (1/2 + 1/cos 2α) and M = 2 EI/r sin³α cos α/cos 2α: the energy \
            EI sin⁴α/2r² of a length, the work F of the ends and −M sin 2α/2r of the turns are stationary in α, and \
            their sum vanishes, since a length may pass from the straight part into the plectoneme. The force and the moment along it at \
            a clamp are measured; F gives α, and M is compared with that for this α. Few turns of the plectoneme \
            are uniform, with its loop at one end and its fork at the other, and the edges touch where \
            they happen to cross; so the error does not fall steadily.",
    source: "Clauvelin, Audoly and Neukirch 2009, Biophys. J. 96, 3716; derived in the text above",
    means: "closed form",
    scene: include_str!("scenes/plectoneme.toml"),
    edges: [80, 160, 320],
    quantities: &[Quantity::new("moment over M(F)")],
    exact: || vec![1.0],
    measure: Measure::Run(moment),
};

/// The moment over that of a plectoneme under the measured force.
fn moment(case: &Case<BenchmarkRun>) -> Result<Vec<f64>> {
    let columns = [
        "root_force_x_n",
        "root_force_y_n",
        "root_force_z_n",
        "root_moment_x_n_m",
        "root_moment_y_n_m",
        "root_moment_z_n_m",
    ];
    let rows = series(case, columns)?;
    let Some([fx, fy, fz, mx, my, mz]) = rows.last().copied() else {
        return Ok(vec![f64::NAN]);
    };
    let force = (fx * fx + fy * fy + fz * fz).sqrt();
    let along = (fx * mx + fy * my + fz * mz).abs() / force;
    if force.is_nan() {
        return Ok(vec![f64::NAN]);
    }
    let excess = |angle: f64| {
        let tightness = 0.5 + 1.0 / libm::cos(2.0 * angle);
        libm::sin(angle).powi(4) * tightness - force * RADIUS * RADIUS
    };
    // At 45° the force is infinite.
    let angle = bisect(0.0, 0.785, excess);
    let (sin, cos) = libm::sincos(angle);
    let expected = 2.0 * sin.powi(3) * cos / (libm::cos(2.0 * angle) * RADIUS);
    Ok(vec![along / expected])
}
