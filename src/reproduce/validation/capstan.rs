//! Ropes that rub and rods that hook.

use super::benchmark::{Benchmark, Measure, Quantity};
use super::measured::{mean_after, series};
use super::root::root;
use rodlab_engine::mechanics::kirchhoff::numerics::runge_kutta;
use std::f64::consts::FRAC_PI_2;

pub(super) static CAPSTAN: Benchmark = Benchmark {
    name: "validation/capstan",
    title: "A rope that slides over a round post",
    about: "A limp rope lies over a fixed post of the radius 20 mm by half a turn, with the friction coefficient 0.3. A force of \
            1 N hangs from one end, the other one is pulled at 2 mm/s. The ratio of the tensions is compared; the edges are those over the post. The bending stiffness is 10⁻⁴ of the force times the square of the radius.",
    source: "Euler 1762; Eytelwein 1808",
    means: "closed form exp(μ π)",
    scene: include_str!("scenes/capstan.toml"),
    edges: [20, 40, 80],
    quantities: &[Quantity::new("ratio of tensions")],
    exact: || vec![libm::exp(0.3 * std::f64::consts::PI)],
    measure: Measure::Run(|case| {
        let pulled = mean_after(case, "pulled_n", 0.1)?;
        Ok(vec![pulled / mean_after(case, "hanging_n", 0.1)?])
    }),
};

/// Height of the loaded bows.
const HEIGHT: f64 = 1.08;

pub(super) static CLASP: Benchmark = Benchmark {
    name: "validation/clasp",
    title: "A clasp of two elastic bows",
    about: "Two straight rods of the length π are bent into bows in planes at a right angle, clamped with parallel tangents at ends \
            2 apart, and hooked into each other. Unloaded they are half circles. Their ends are pulled apart until each bow \
            is 1.08 high, from its clamps to the centreline at its crown. They touch at one point, without friction. Forces are those of one \
            clamp, in units of EI over the square of the radius 1. The edges are one more than stated, so that the rods cross in the middles of edges.",
    source: "derived here",
    means: "shooting of half a bow as a planar elastica",
    scene: include_str!("scenes/clasp.toml"),
    edges: [40, 80, 160],
    quantities: &[
        force("force along the pull"),
        force("force between the ends"),
        force("moment of a clamp"),
    ],
    exact: || {
        let [moment, across, along] = bow();
        vec![along, across, -moment]
    },
    measure: Measure::Run(|case| {
        let columns = ["root_force_z_n", "root_force_x_n", "root_moment_y_n_m"];
        let rows = series(case, columns)?;
        let last = rows.last().copied().unwrap_or([f64::NAN; 3]);
        Ok(last.map(f64::abs).to_vec())
    }),
};

/// A quantity without a published value.
const fn force(name: &'static str) -> Quantity {
    Quantity {
        name,
        published: None,
        scale: None,
    }
}

/// Curvature at the clamp, and the forces across and along the pull in a half bow:
/// θ'' = n_x sin θ − n_z cos θ from θ(0) = π/2 to θ(π/2) = 0.
fn bow() -> [f64; 3] {
    let to_height = |height: f64| {
        move |[start, across, along]: [f64; 3]| {
            let slope = |_: f64, [_, _, angle, curvature]: &[f64; 4]| {
                let (sin, cos) = libm::sincos(*angle);
                [cos, sin, *curvature, across * sin - along * cos]
            };
            let start = [-1.0, 0.0, FRAC_PI_2, start];
            let states = runge_kutta(0.0, FRAC_PI_2, start, 400, slope);
            let [x, z, angle, _] = states[states.len() - 1];
            [x, angle, z - height]
        }
    };
    // The half circle is pulled up in steps.
    let heights = (1..=4).map(|part| 1.0 + (HEIGHT - 1.0) * f64::from(part) / 4.0);
    heights.fold([-1.0, 0.0, 0.0], |bow, height| root(bow, to_height(height)))
}
