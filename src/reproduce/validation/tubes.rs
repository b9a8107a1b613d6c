//! Naturally curved rods that are turned in tubes.

use super::benchmark::{Benchmark, BenchmarkRun, Measure, Quantity};
use super::measured::series;
use crate::reproduce::prelude::*;
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::kirchhoff::numerics::{bisect, runge_kutta};
use rodlab_files::results::{BranchKind, read_branches, read_nodes};

/// Steps of the Runge–Kutta method.
const STEPS: usize = 1000;

pub(super) static GUIDEWIRE: Benchmark = Benchmark {
    name: "validation/guidewire",
    title: "A guidewire that whips in a curved tube",
    about: "A wire of unit length with the natural curvature κ₀ = 3, EI = 1.5 and GJ = 1 is in a rigid tube of the curvature \
            κ = 2, without friction and clearance. Its base is turned by θ, its tip is free. Where the wire is turned by φ \
            from the direction of the tube's curvature, it has the energy GJ φ'²/2 − EI κ₀ κ cos φ per length and a constant, \
            so that GJ φ'' = EI κ₀ κ sin φ, φ(0) = θ, φ'(L) = 0. The tip lags behind the base. If c = √(EI κ₀ κ/GJ) > π/2L, as here \
            with c = 3, θ has a largest value above π, at which the tip whips around. The nodes are held \
            on the circle, so that contact plays no part. The first inner one is free, because two held nodes clamp the edge \
            between them instead of the section at the first; half an edge of the wire is outside the tube, because the last half of a \
            discrete rod does not bend.",
    source: "the torsion of concentric tubes of Dupont, Lock, Itkowitz and Butler 2010, IEEE Trans. Robot. 26, 209, with a rigid \
             outer tube; derived in the text above",
    means: "shooting from the tip, with the linearised equation, whose solution vanishes at the base when the wire snaps",
    scene: include_str!("scenes/guidewire.toml"),
    edges: [20, 40, 80],
    quantities: &[
        Quantity::new("turn of the base when it snaps, rad"),
        Quantity::new("torque then, GJ/L"),
    ],
    exact: || {
        let snap = Snap::of(9.0);
        vec![snap.base, snap.rate]
    },
    measure: Measure::Run(|case| {
        let rows = series(case, ["time_s", "root_moment_x_n_m"])?;
        let Some(turn) = snap(case)? else {
            return Ok(vec![f64::NAN; 2]);
        };
        let torque = rows.iter().find(|[at, _]| (at - turn).abs() < 1e-9);
        Ok(vec![
            turn,
            torque.map_or(f64::NAN, |[_, torque]| torque.abs()),
        ])
    }),
};

/// Bending stiffness, twisting stiffness and natural curvature of the inner and of the outer tube.
const TUBES: [[f64; 3]; 2] = [[1.0, 2.0 / 3.0, 3.0], [2.0, 4.0 / 3.0, 1.5]];

pub(super) static CONCENTRIC_TUBES: Benchmark = Benchmark {
    name: "validation/concentric-tubes",
    title: "Two concentric tubes that snap",
    about: "Two tubes of unit length with natural curvatures, one in the other without friction and clearance, have one centreline. The base of the \
            inner one is turned by θ against that of the outer one; their tips are free. Where the directions of their natural curvatures differ \
            by α, the centreline has the curvature of least energy, Σ EIᵢ κᵢ/Σ EIᵢ as a sum of vectors, and the tubes have the energy \
            B (κ₁² + κ₂² − 2 κ₁ κ₂ cos α)/2 per length with 1/B = 1/EI₁ + 1/EI₂. Their torques are opposite, so α'' = c² sin α with \
            c² = B κ₁ κ₂ (1/GJ₁ + 1/GJ₂), α(0) = θ, α'(L) = 0. Since c = 2.598 > π/2L, they snap. The tubes are two rods, \
            joined by a ball joint at each node, and half an edge longer than stated, because the last half of a discrete rod does not bend.",
    source: "Dupont, Lock, Itkowitz and Butler 2010, IEEE Trans. Robot. 26, 209; Gilbert, Hendrick and Webster 2016, IEEE \
             Trans. Robot. 32, 20, on stability",
    means: "shooting of α from the tip, with the linearised equation, and integration of the centreline with a frame that does \
            not twist; errors of the tip are over the length",
    scene: include_str!("scenes/concentric-tubes.toml"),
    edges: [20, 40, 80],
    quantities: &[
        Quantity::new("turn of the base when they snap, rad"),
        Quantity::new("tip then, x/L").over(1.0),
        Quantity::new("tip then, y/L").over(1.0),
        Quantity::new("tip then, z/L").over(1.0),
    ],
    exact: || {
        let [inner, outer] = TUBES;
        let bending = 1.0 / (1.0 / inner[0] + 1.0 / outer[0]);
        let twisting = 1.0 / (1.0 / inner[1] + 1.0 / outer[1]);
        let snap = Snap::of(bending * inner[2] * outer[2] / twisting);
        let tip = tip(&snap);
        vec![snap.base, tip.x, tip.y, tip.z]
    },
    measure: Measure::Run(|case| {
        let Some(turn) = snap(case)? else {
            return Ok(vec![f64::NAN; 4]);
        };
        let outputs = read_nodes(&case.directory, 2 * (case.run.edges + 1))?;
        let output = outputs
            .iter()
            .find(|output| (output.time - turn).abs() < 1e-9);
        // The tip is the middle of the last edge.
        let tip = match output.map(|output| output.positions.as_slice()) {
            Some([.., before, last]) => 0.5 * (before + last),
            _ => Vector3::repeat(f64::NAN),
        };
        Ok(vec![turn, tip.x, tip.y, tip.z])
    }),
};

/// Angles α'' = c² sin α along a length of 1, α'(1) = 0, with the largest α(0).
struct Snap {
    /// c².
    coupling: f64,
    /// α(0).
    base: f64,
    /// −α'(0).
    rate: f64,
}

impl Snap {
    /// Finds the largest α(0) over α(1): there dα(0)/dα(1) = 0.
    fn of(coupling: f64) -> Self {
        let base = |tip: f64| {
            // α, α' and their derivatives with respect to α(1), from the tip.
            let slope = |_: f64, [angle, rate, turned, turning]: &[f64; 4]| {
                let (sin, cos) = libm::sincos(*angle);
                [*rate, coupling * sin, *turning, coupling * cos * turned]
            };
            let states = runge_kutta(0.0, 1.0, [tip, 0.0, 1.0, 0.0], STEPS, slope);
            states[states.len() - 1]
        };
        let tip = bisect(1e-3, std::f64::consts::PI, |tip| base(tip)[2]);
        let [base, rate, ..] = base(tip);
        Self {
            coupling,
            base,
            rate,
        }
    }
}

/// Tip of the centreline of [`TUBES`] that begins at the origin along x, with the outer tube curved towards y.
fn tip(snap: &Snap) -> Vector3 {
    let [inner, outer] = TUBES;
    let part = outer[1] / (inner[1] + outer[1]);
    let stiffness = inner[0] + outer[0];
    // Place, tangent, two normals of a frame without twist, α and α'.
    let slope = |_: f64, state: &[f64; 14]| {
        let [tangent, first, second] =
            [3, 6, 9].map(|at| Vector3::from_column_slice(&state[at..at + 3]));
        let [angle, rate] = [state[12], state[13]];
        // Each tube turns by its part of the loss of α.
        let of_inner = snap.base + part * (angle - snap.base);
        let of_outer = of_inner - angle;
        let bent = |part: fn(f64) -> f64| {
            (inner[0] * inner[2] * part(of_inner) + outer[0] * outer[2] * part(of_outer))
                / stiffness
        };
        let [towards_first, towards_second] = [bent(libm::cos), bent(libm::sin)];
        let mut rates = [0.0; 14];
        rates[..3].copy_from_slice(tangent.as_slice());
        rates[3..6].copy_from_slice((towards_first * first + towards_second * second).as_slice());
        rates[6..9].copy_from_slice((-towards_first * tangent).as_slice());
        rates[9..12].copy_from_slice((-towards_second * tangent).as_slice());
        rates[12] = rate;
        rates[13] = snap.coupling * libm::sin(angle);
        rates
    };
    let mut start = [0.0; 14];
    [start[3], start[7], start[11]] = [1.0; 3];
    [start[12], start[13]] = [snap.base, -snap.rate];
    let states = runge_kutta(0.0, 1.0, start, STEPS, slope);
    Vector3::from_column_slice(&states[states.len() - 1][..3])
}

/// The parameter of the first critical point.
fn snap(case: &Case<BenchmarkRun>) -> Result<Option<f64>> {
    let points = read_branches(&case.directory)?;
    let first = points
        .iter()
        .find(|point| point.kind != BranchKind::Regular);
    Ok(first.map(|point| point.parameter))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    /// Pendulums that swing with the amplitude π − α(1) pass the lowest point after a quarter of their period: below c =
    /// π/2 no wire snaps, and slightly above it snaps slightly beyond π.
    #[test]
    fn wires_snap_from_a_quarter_of_the_period_on() {
        let near = Snap::of((1.001 * FRAC_PI_2).powi(2));
        assert!(near.base > PI && near.base < PI + 1e-3, "{}", near.base);
        let far = Snap::of((2.0 * FRAC_PI_2).powi(2));
        assert!(far.base > PI + 1.0, "{}", far.base);
    }

    /// The first integral of α'' = c² sin α.
    #[test]
    fn torque_follows_from_the_energy() {
        let snap = Snap::of(9.0);
        // Tip angle by the first integral.
        let cos = 0.5 * snap.rate * snap.rate / snap.coupling + libm::cos(snap.base);
        let slope = |_: f64, [angle, rate]: &[f64; 2]| [*rate, snap.coupling * libm::sin(*angle)];
        let states = runge_kutta(0.0, 1.0, [snap.base, -snap.rate], STEPS, slope);
        let [tip, rate] = states[STEPS];
        assert!(rate.abs() < 1e-6, "{rate}");
        assert!((libm::cos(tip) - cos).abs() < 1e-8);
    }
}
