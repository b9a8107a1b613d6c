//! Cables and rods that swing and fly.

use super::benchmark::{Benchmark, BenchmarkRun, Measure, Quantity};
use super::links::Links;
use super::measured::{frequency, series};
use crate::reproduce::prelude::*;
use nalgebra::Vector2;
use rodlab_files::results::read_nodes;

/// First zero of the Bessel function J₀.
const ZERO: f64 = 2.404_825_557_695_773;
/// Links of the coarser of two chains.
const LINKS: usize = 60;

pub(super) static SWINGING_CHAIN: Benchmark = Benchmark {
    name: "validation/swinging-chain",
    title: "Frequency of a hanging chain",
    about: "A rope without stiffness hangs from one end and swings with a small amplitude, at the lowest frequency \
            1.2024 √(g/L). The motion is projected on the mode by theory; the frequency follows from its changes \
            of sign over five periods.",
    source: "D. Bernoulli 1733; Lamb 1910, Hydrodynamics, for the mode J₀(j √(1 − s/L))",
    means: "closed form j/2, with the first zero j of J₀",
    scene: include_str!("scenes/swinging-chain.toml"),
    edges: [25, 50, 100],
    quantities: &[Quantity::new("frequency, √(g/L)")],
    exact: || vec![0.5 * ZERO],
    measure: Measure::Run(|case| {
        let edges = case.run.edges;
        let outputs = read_nodes(&case.directory, edges + 1)?;
        let part = |node: usize| {
            let whole = if node == edges { 0.5 } else { 1.0 };
            let from_end = 1.0 - node as f64 / edges as f64;
            whole * libm::j0(ZERO * from_end.sqrt())
        };
        let mode: Vec<f64> = (0..=edges).map(part).collect();
        Ok(vec![frequency(&outputs, &mode, |x| x.x)])
    }),
};

pub(super) static SWINGING_CABLE: Benchmark = Benchmark {
    name: "validation/swinging-cable",
    title: "A cable released from the horizontal",
    about: "A cable of unit length, mass and weight with the bending stiffness EI = 0.01 ρA g L³ is held by a hinge and \
            released from the horizontal. Its free end is compared at the time 2.5 √(L/g), when the cable has swung to the other \
            side.",
    source: "after the swinging ropes of Fritzkowski and Kamiński 2008, J. Mech. Mater. Struct. 3, 1059, which differ in \
             their stiffness",
    means: "chains of 60 and 120 rigid links with springs, advanced explicitly, with Richardson's extrapolation; errors are \
            over the length",
    scene: include_str!("scenes/swinging-cable.toml"),
    edges: [20, 40, 80],
    quantities: &[place("end, x/L", 1.0), place("end, z/L", 1.0)],
    exact: || {
        let cable = Links {
            bending: 0.01,
            length: 1.0,
            start: [Vector2::zeros(), Vector2::x()],
            is_hinged: true,
            gravity: -Vector2::y(),
            load: |_| (Vector2::zeros(), 0.0),
        };
        let [_, end] = cable.ends(2.5, LINKS);
        vec![end.x, end.y]
    },
    measure: Measure::Run(|case| last(case, ["end_x_m", "end_z_m"])),
};

pub(super) static FLYING_ROD: Benchmark = Benchmark {
    name: "validation/flying-rod",
    title: "A rod thrown by a force and a moment (flying spaghetti)",
    about: "A free rod of the length 10 and unit mass per length, at rest from (6, 0) to (0, 8), is thrown by a force along x and a \
            moment on its lower end, which grow to 8 and 80 at 2.5 s and vanish at 5 s. It flies on, turning and \
            bending. Its ends are compared at 6 s. EI = 500 as published; the published rod also has a rotary \
            inertia of 10 per length, as much as that of the whole rod about its centre, which a thin rod does not \
            have. The centre of mass shows that momentum is conserved.",
    source: "the loads of Simo and Vu-Quoc 1986, J. Appl. Mech. 53, 855",
    means: "chains of 60 and 120 rigid links with springs, advanced explicitly, with Richardson's extrapolation; the \
            centre of mass in closed form; errors are over the length",
    scene: include_str!("scenes/flying-rod.toml"),
    edges: [20, 40, 80],
    quantities: &[
        place("lower end, x", 10.0),
        place("lower end, z", 10.0),
        place("upper end, x", 10.0),
        place("upper end, z", 10.0),
        place("centre of mass, x", 10.0),
    ],
    exact: || {
        let rod = Links {
            bending: 500.0,
            length: 10.0,
            start: [Vector2::new(6.0, 0.0), Vector2::new(-0.6, 0.8)],
            is_hinged: false,
            gravity: Vector2::zeros(),
            load: |time| {
                let part = (time.min(5.0 - time) / 2.5).max(0.0);
                // A positive moment turns x towards z.
                (Vector2::new(8.0 * part, 0.0), -80.0 * part)
            },
        };
        let [low, high] = rod.ends(6.0, LINKS);
        // The impulse 20 acts at 2.5 s in the mean.
        vec![
            low.x,
            low.y,
            high.x,
            high.y,
            3.0 + 20.0 / 10.0 * (6.0 - 2.5),
        ]
    },
    measure: Measure::Run(|case| {
        let mut values = last(case, ["low_x_m", "low_z_m", "high_x_m", "high_z_m"])?;
        let outputs = read_nodes(&case.directory, case.run.edges + 1)?;
        let edges = outputs.last().map(|output| {
            let pairs = output.positions.windows(2);
            pairs
                .map(|pair| 0.5 * (pair[0].x + pair[1].x))
                .collect::<Vec<f64>>()
        });
        values.push(mean(edges.unwrap_or_default()).unwrap_or(f64::NAN));
        Ok(values)
    }),
};

/// A coordinate without a published value, with the length of the rod.
const fn place(name: &'static str, length: f64) -> Quantity {
    Quantity {
        name,
        published: None,
        scale: Some(length),
    }
}

/// Values of columns at the last output.
fn last<const N: usize>(case: &Case<BenchmarkRun>, columns: [&str; N]) -> Result<Vec<f64>> {
    let rows = series(case, columns)?;
    Ok(rows.last().map_or(vec![f64::NAN; N], |row| row.to_vec()))
}
