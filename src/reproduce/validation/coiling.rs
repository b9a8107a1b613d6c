//! Rods that coil on a floor.

use super::benchmark::{Benchmark, BenchmarkRun, Measure, Quantity};
use super::measured::series;
use super::root::root;
use crate::reproduce::prelude::*;
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::kirchhoff::numerics::runge_kutta;
use rodlab_files::results::read_nodes;
use std::f64::consts::TAU;

/// Height of the ring over the laid rod.
const HEIGHT: f64 = 5.0;
/// Radius of the rod.
const RADIUS: f64 = 0.005;
/// Nodes of the ring.
const RING: usize = 3;

pub(super) static COILING: Benchmark = Benchmark {
    name: "validation/coiling",
    title: "A rod fed downwards that coils on a floor",
    about: "A rod of the weight w per length is lowered slowly through a ring at the height 5 (EI/w)^⅓ over a floor with the friction \
            coefficient 1, on which it coils. Inertia is negligible, and so is the stiffness GJ of twist. Lengths are in units of (EI/w)^⅓. \
            In steady coiling the laid rod is a circle of the radius R about the axis of the ring. The hanging rod turns about this axis \
            and touches the circle with the same tangent and curvature, where the floor exerts a force on it. The ring holds its place, and the rod above the \
            ring, which is straightened by the weight below it, is a spring against its slope there. These are five equations for R, the hanging length and the force. \
            The force along the circle is −EI/R². R is the mean distance of the last turn from the axis, and the tension below the ring is the mean over the time \
            in which this turn is laid. The turns lie on earlier ones and cross them, which is not in the theory, so the errors do not fall steadily.",
    source: "Mahadevan and Keller 1996, Proc. R. Soc. A 452, 1679; Habibi, Ribe and Bonn 2007, Phys. Rev. Lett. 99, 154302; here without \
             twist and inertia",
    means: "shooting of the hanging rod from the floor to the ring, with the linear equation of the rod above",
    scene: include_str!("scenes/coiling.toml"),
    edges: [80, 160, 320],
    quantities: &[
        Quantity::new("radius of the coil"),
        Quantity::new("tension below the ring"),
    ],
    exact: || {
        let coil = Coil::below(HEIGHT);
        vec![coil.radius, coil.tension()]
    },
    measure: Measure::Run(coils),
};

/// Steady coiling without inertia and twist, for EI = w = 1.
struct Coil {
    radius: f64,
    /// Length of the hanging rod.
    length: f64,
    /// Force outwards, along the coil and upwards that the hanging rod exerts where it touches the floor.
    force: [f64; 3],
}

impl Coil {
    /// Coiling below a ring at a height.
    fn below(height: f64) -> Self {
        // Radius, force where the rod touches the floor, and hanging length. Newton's method begins near the coil
        // below a ring at the height 5.
        let start = [1.19, 0.05, -0.707, -1.61, height + 1.19];
        let [radius, outwards, along, up, length] = root(start, |unknowns| {
            let [x, y, z, tx, ty, _, mx, my, _] = Self::at_ring(unknowns);
            let spring = spring(unknowns[3] + unknowns[4]);
            [x, y, z - height, mx - spring * ty, my + spring * tx]
        });
        Self {
            radius,
            length,
            force: [outwards, along, up],
        }
    }

    /// Tension below the ring.
    fn tension(&self) -> f64 {
        self.force[2] + self.length
    }

    /// Place x, tangent t and moment m at the ring: x' = t, t' = m × t, m' = n × t, n' = (0, 0, 1), from the point
    /// where the rod leaves the floor along a circle.
    fn at_ring([radius, outwards, along, up, length]: [f64; 5]) -> [f64; 9] {
        let slope = |s: f64, state: &[f64; 9]| {
            let [tangent, moment] = [3, 6].map(|at| Vector3::from_column_slice(&state[at..at + 3]));
            let force = Vector3::new(outwards, along, up + s);
            let mut rates = [0.0; 9];
            rates[..3].copy_from_slice(tangent.as_slice());
            rates[3..6].copy_from_slice(moment.cross(&tangent).as_slice());
            rates[6..].copy_from_slice(force.cross(&tangent).as_slice());
            rates
        };
        let start = [radius, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0 / radius];
        let states = runge_kutta(0.0, length, start, 400, slope);
        states[states.len() - 1]
    }
}

/// Moment per slope of the rod above the ring: k of u' = −k u at the ring for u'' = (T + z) u, with the tension T + z and
/// a slope u that decays upwards. The value is the solution of k' = k² − (T + z), integrated
/// downwards from k = √(T + z).
fn spring(tension: f64) -> f64 {
    let top = 6.0;
    let start = [(tension + top).sqrt()];
    let states = runge_kutta(0.0, top, start, 200, |down, [spring]: &[f64; 1]| {
        [tension + top - down - spring * spring]
    });
    states[states.len() - 1][0]
}

/// Measures the radius of the last turn, and the tension below the ring while it was laid.
fn coils(case: &Case<BenchmarkRun>) -> Result<Vec<f64>> {
    let coil = Coil::below(HEIGHT);
    let turn = TAU * coil.radius;
    let rows = series(case, ["top_z_m", "clamp_force_z_n"])?;
    let above = |height: f64| height - HEIGHT - RADIUS;
    let end = rows.last().map_or(f64::NAN, |[height, _]| *height);
    let late = rows.iter().filter(|[height, _]| *height < end + turn);
    // The clamp also holds the weight of the rod above the ring.
    let tension = mean(late.map(|[height, force]| force - above(*height)));
    let outputs = read_nodes(&case.directory, case.run.edges + 1 + RING)?;
    let nodes = outputs
        .last()
        .map_or(&[][..], |output| &output.positions[..=case.run.edges]);
    let laid = above(end) + coil.length;
    let mut from_top = 0.0;
    let mut distances = Vec::new();
    for edge in nodes.windows(2) {
        from_top += (edge[1] - edge[0]).norm();
        if (laid..laid + turn).contains(&from_top) {
            distances.push(libm::hypot(edge[1].x, edge[1].y));
        }
    }
    let radius = mean(distances);
    Ok([radius, tension]
        .map(|value| value.unwrap_or(f64::NAN))
        .to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The ring and the weight exert no moment about the axis: the force along the coil holds the moment EI/R of the
    /// laid rod. The friction that holds the force is below the coefficient of the scenario.
    #[test]
    fn the_floor_holds_the_moment_of_the_coil() {
        for height in [4.5, HEIGHT] {
            let coil = Coil::below(height);
            let [outwards, along, up] = coil.force;
            let balance = along * coil.radius.powi(2) + 1.0;
            assert!(balance.abs() < 1e-8, "{height}: {balance}");
            let friction = libm::hypot(outwards, along) / -up;
            assert!((0.4..0.5).contains(&friction), "{height}: {friction}");
        }
    }

    /// Slopes over the ring are Airy functions of the tension, k = −Ai'(T)/Ai(T), with the asymptotic series √T + 1/4T −
    /// 5/32 T^(−5/2) + ...
    #[test]
    fn the_rod_above_the_ring_is_a_spring() {
        let tension = 25.0f64;
        let series =
            tension.sqrt() + 0.25 / tension - 5.0 / 32.0 / (tension.powi(2) * tension.sqrt());
        let spring = spring(tension);
        assert!((spring - series).abs() < 1e-5, "{spring} {series}");
    }
}
