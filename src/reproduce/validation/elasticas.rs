//! Planar cantilevers that bend far: master curves of the elastica.

use super::benchmark::{Benchmark, BenchmarkRun, Measure, Quantity};
use crate::reproduce::prelude::*;
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::kirchhoff::{Cantilever, CantileverLoad};
use rodlab_files::results::read_nodes;
use std::f64::consts::FRAC_PI_2;

/// Weights of the cantilevers of the scene, in units of EI/L².
const WEIGHTS: [f64; 3] = [1.0, 10.0, 100.0];

pub(super) static HEAVY_CANTILEVERS: Benchmark = Benchmark {
    name: "validation/heavy-cantilevers",
    title: "Cantilevers that bend under their weight",
    about: "The slope of the line from the clamp of a horizontal cantilever to its end is a function of Γ = w L³/EI \
            alone: the master curve of the cantilever test. Three cantilevers in one scene give three points of it.",
    source: "Romero, Ly, Rasheed, Charrondière, Lazarus, Neukirch and Bertails-Descoubes 2021, ACM Trans. Graph. 40, \
             the cantilever test",
    means: "the elastica θ'' = −Γ s cos θ by shooting",
    scene: include_str!("scenes/heavy-cantilevers.toml"),
    edges: [20, 40, 80],
    quantities: &[
        Quantity::new("height over width, Γ = 1"),
        Quantity::new("height over width, Γ = 10"),
        Quantity::new("height over width, Γ = 100"),
    ],
    exact: || {
        let slope = |weight| {
            let [x, y] = Cantilever::new(CantileverLoad::OwnWeight(weight)).position(1.0);
            y / x
        };
        WEIGHTS.map(slope).to_vec()
    },
    measure: Measure::Run(|case| of_tips(case, |tip| vec![-tip.z / tip.x])),
};

/// Angles by which the ends of the columns of the scene turn, degrees.
const TURNS: [f64; 3] = [60.0, 120.0, 160.0];

pub(super) static BUCKLED_COLUMNS: Benchmark = Benchmark {
    name: "validation/buckled-columns",
    title: "Columns bent far beyond buckling",
    about: "A column that is clamped at its foot bends over under a force at its top. With the modulus k = sin α/2 the \
            force P = K² EI/L² turns the tangent at the top by α, and the top is at the height (2E/K − 1) L and at \
            the distance 2k L/K from the line of the force at the foot. P is 1.152, 1.885 and 4.030 times the load of \
            buckling.",
    source: "Euler 1744; Timoshenko and Gere 1961, Theory of Elastic Stability, sec. 2.7, table 2-4",
    means: "complete elliptic integrals K and E by the arithmetic–geometric mean",
    scene: include_str!("scenes/buckled-columns.toml"),
    edges: [20, 40, 80],
    quantities: &[
        in_table("α = 60°: height of the top over L", 0.741),
        in_table("α = 60°: distance of the top over L", 0.593),
        in_table("α = 120°: height of the top over L", 0.123),
        in_table("α = 120°: distance of the top over L", 0.803),
        in_table("α = 160°: height of the top over L", -0.340),
        in_table("α = 160°: distance of the top over L", 0.625),
    ],
    exact: || {
        let top = |angle: f64| {
            let modulus = libm::sin(0.5 * angle.to_radians());
            let [first, second] = elliptic_integrals(modulus);
            [2.0 * second / first - 1.0, 2.0 * modulus / first]
        };
        TURNS.iter().flat_map(|&angle| top(angle)).collect()
    },
    measure: Measure::Run(|case| of_tips(case, |tip| vec![tip.z, libm::hypot(tip.x, tip.y)])),
};

/// A quantity of the published table, which has three digits.
const fn in_table(name: &'static str, published: f64) -> Quantity {
    Quantity::new(name).published(published, 5e-4)
}

/// Complete elliptic integrals of the first and the second kind.
fn elliptic_integrals(modulus: f64) -> [f64; 2] {
    let mut means = [1.0, (1.0 - modulus * modulus).sqrt()];
    let mut gap = modulus;
    let [mut sum, mut weight] = [0.0, 0.5];
    while gap.abs() > 1e-12 {
        sum += weight * gap * gap;
        let [a, b] = means;
        gap = 0.5 * (a - b);
        means = [0.5 * (a + b), (a * b).sqrt()];
        weight *= 2.0;
    }
    let first = FRAC_PI_2 / means[0];
    [first, first * (1.0 - sum)]
}

/// Quantities of the free ends of the three rods of a run; NaN if it has no output.
fn of_tips(case: &Case<BenchmarkRun>, of: fn(&Vector3) -> Vec<f64>) -> Result<Vec<f64>> {
    let nodes = case.run.edges + 1;
    let outputs = read_nodes(&case.directory, 3 * nodes)?;
    let Some(last) = outputs.last() else {
        return Ok(vec![f64::NAN; case.run.benchmark.quantities.len()]);
    };
    let tips = last.positions.chunks(nodes).filter_map(|rod| rod.last());
    Ok(tips.flat_map(of).collect())
}
