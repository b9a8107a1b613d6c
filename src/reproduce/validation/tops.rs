//! Rigid bodies that spin.

use super::benchmark::{Benchmark, Measure, Quantity};
use super::measured::{crossings, series};
use rodlab_engine::mechanics::kirchhoff::numerics::runge_kutta;
use rodlab_files::results::read_end_state;
use std::f64::consts::FRAC_PI_2;

pub(super) static HEAVY_TOP: Benchmark = Benchmark {
    name: "validation/heavy-top",
    title: "A heavy top",
    about: "A symmetric top of 15 kg, 1 m from its pivot, with the moments of inertia 0.234375, 0.46875, 0.234375 kg m² \
            about its centre of mass, begins with its axis along y and the angular velocity (0, 150, −4.61538) \
            rad/s, and falls and precesses under g = 9.81 m/s². The axis after 2 s is compared, when the top has \
            turned 48 times. A light rod carries the top; the time step, 0.4 ms with 4 edges, is halved with each \
            mesh.",
    source: "the top of Brüls and Cardona 2010, J. Comput. Nonlinear Dyn. 5, 031002",
    means: "Runge–Kutta method for the axis n and the angular momentum L: A n' = L × n, L' = m g l e_z × n",
    scene: include_str!("scenes/heavy-top.toml"),
    edges: [4, 8, 16],
    quantities: &[
        Quantity::new("axis after 2 s, x").over(1.0),
        Quantity::new("axis after 2 s, y").over(1.0),
        Quantity::new("axis after 2 s, z").over(1.0),
    ],
    exact: || {
        // About the pivot, and about the axis.
        let [across, along] = [0.234375 + 15.0, 0.46875];
        let weight = 15.0 * 9.81;
        let start = [0.0, 1.0, 0.0, 0.0, 150.0 * along, -4.61538 * across];
        let slope = |_: f64, [x, y, z, l, m, n]: &[f64; 6]| {
            let turned = [m * z - n * y, n * x - l * z, l * y - m * x];
            let [x_rate, y_rate, z_rate] = turned.map(|rate| rate / across);
            [x_rate, y_rate, z_rate, -weight * y, weight * x, 0.0]
        };
        let states = runge_kutta(0.0, 2.0, start, 20_000, slope);
        states[states.len() - 1][..3].to_vec()
    },
    measure: Measure::Run(|case| {
        let path = case.directory.join("end_state.csv");
        let text = std::fs::read(&path).unwrap_or_default();
        let rows = read_end_state(&text).unwrap_or_default();
        let director = rows
            .first()
            .map(|row| [row.director_x, row.director_y, row.director_z]);
        let director = director.unwrap_or_default();
        Ok(director.map(|part| part.unwrap_or(f64::NAN)).to_vec())
    }),
};

/// Principal moments of inertia, kg m².
const MOMENTS: [f64; 3] = [1.0, 2.0, 3.0];
/// Initial angular velocities about the second and the third axis, rad/s.
const SPIN: [f64; 2] = [1.0, 0.01];

pub(super) static INTERMEDIATE_AXIS: Benchmark = Benchmark {
    name: "validation/intermediate-axis",
    title: "A free body that turns over about its intermediate axis",
    about: "A free body with the moments of inertia 1, 2, 3 kg m² rotates about the second axis at 1 rad/s and about \
            the third one at 0.01 rad/s. It turns over again and again. The times are those at which the second axis \
            is normal to the angular momentum. Light rods carry the body; the time step, 40 ms with 4 edges, is \
            halved with each mesh.",
    source: "Euler 1758; seen by Dzhanibekov in orbit in 1985",
    means: "closed form: the quarter of a period is I₂ √(I₁ I₃) K(k)/√(b c), b = I₂ (I₃ − I₂), c = I₂ (I₂ − I₁) ω₂² + I₃ \
            (I₃ − I₁) ω₃², k'² = I₃ (I₃ − I₁) ω₃²/c, with K by the arithmetic-geometric mean",
    scene: include_str!("scenes/intermediate-axis.toml"),
    edges: [4, 8, 16],
    quantities: &[
        Quantity::new("first turn, s"),
        Quantity::new("second turn, s"),
    ],
    exact: || {
        let ([first, second, third], [fast, slow]) = (MOMENTS, SPIN);
        let b = second * (third - second);
        let of_slow = third * (third - first) * slow * slow;
        let c = second * (second - first) * fast * fast + of_slow;
        let (mut mean, mut geometric) = (1.0, (of_slow / c).sqrt());
        for _ in 0..10 {
            (mean, geometric) = (0.5 * (mean + geometric), (mean * geometric).sqrt());
        }
        let quarter = second * (first * third / (b * c)).sqrt() * FRAC_PI_2 / mean;
        vec![quarter, 3.0 * quarter]
    },
    measure: Measure::Run(|case| {
        let rows = series(case, ["time_s", "handle_x_m", "handle_y_m", "handle_z_m"])?;
        // The angular momentum is constant, and known from the start: the third axis is −y.
        let tilt = MOMENTS[2] * SPIN[1] / (MOMENTS[1] * SPIN[0]);
        let along: Vec<[f64; 2]> = rows
            .iter()
            .map(|[time, _, y, z]| [*time, z + tilt * y])
            .collect();
        let mut times = crossings(&along);
        times.resize(2, f64::NAN);
        Ok(times)
    }),
};
