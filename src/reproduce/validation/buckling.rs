//! Critical loads at which other branches leave a path of equilibria.

use super::benchmark::{Benchmark, Measure, Quantity};
use rodlab_engine::mechanics::kirchhoff::numerics::{bisect, runge_kutta};
use rodlab_files::results::BranchKind;
use std::f64::consts::{PI, TAU};

/// Steps of the Runge–Kutta method.
const STEPS: usize = 2000;

pub(super) static HEAVY_COLUMN: Benchmark = Benchmark {
    name: "validation/heavy-column",
    title: "A column that buckles under its own weight",
    about: "An upright column of weight w per length, clamped at its foot and free at its top, buckles at w = 7.8373 \
            EI/L³.",
    source: "Greenhill 1881, Proc. Camb. Phil. Soc. 4, 65; Timoshenko and Gere 1961, Theory of Elastic Stability, \
             sec. 2.12, with 7.837",
    means: "root of θ'(0) = 0, θ'' = −w s θ, θ(L) = 0 over the length s from the top",
    scene: include_str!("scenes/heavy-column.toml"),
    edges: [20, 40, 80],
    quantities: &[Quantity::new("critical weight w L³/EI").published(7.837, 5e-4)],
    exact: || vec![bisect(7.0, 9.0, |weight| free_end_to_clamp(|s| weight * s))],
    measure: Measure::Critical(BranchKind::Bifurcation),
};

pub(super) static STRIP_ON_EDGE: Benchmark = Benchmark {
    name: "validation/strip-on-edge",
    title: "A strip on edge that buckles sideways under its own weight",
    about: "A horizontal strip on edge of weight w per length is clamped at one end. It is stiff in the vertical plane, \
            where its stiffness is 10⁵ EI here, and turns over sideways at w = 12.85 √(EI GJ)/L³.",
    source: "Prandtl 1899; Timoshenko and Gere 1961, Theory of Elastic Stability, sec. 6.3, with 12.85",
    means: "root of φ'(0) = 0, φ'' = −w² s⁴/(4 EI GJ) φ, φ(L) = 0 over the length s from the free end, for a strip that \
            is rigid in its plane",
    scene: include_str!("scenes/strip-on-edge.toml"),
    edges: [10, 20, 40],
    quantities: &[Quantity::new("critical weight w L³/√(EI GJ)").published(12.85, 5e-3)],
    exact: || {
        let rate = |weight: f64| free_end_to_clamp(|s| 0.25 * weight * weight * s.powi(4));
        vec![bisect(11.0, 15.0, rate)]
    },
    measure: Measure::Critical(BranchKind::Bifurcation),
};

pub(super) static STRIP_WITH_TIP_LOAD: Benchmark = Benchmark {
    name: "validation/strip-with-tip-load",
    title: "A strip on edge that buckles sideways under a force at its end",
    about: "A horizontal strip on edge is clamped at one end and carries a force P at the other. It is stiff in the \
            vertical plane, where its stiffness is 10⁵ EI here, and turns over sideways at P = 4.013 √(EI GJ)/L².",
    source: "Prandtl 1899; Timoshenko and Gere 1961, Theory of Elastic Stability, sec. 6.3, with 4.013",
    means: "root of φ'(0) = 0, φ'' = −P² s²/(EI GJ) φ, φ(L) = 0 over the length s from the free end, for a strip that is rigid in its plane",
    scene: include_str!("scenes/strip-with-tip-load.toml"),
    edges: [10, 20, 40],
    quantities: &[Quantity::new("critical force P L²/√(EI GJ)").published(4.013, 5e-4)],
    exact: || {
        let rate = |force: f64| free_end_to_clamp(|s| force * force * s * s);
        vec![bisect(3.0, 5.0, rate)]
    },
    measure: Measure::Critical(BranchKind::Bifurcation),
};

pub(super) static BENT_STRIP: Benchmark = Benchmark {
    name: "validation/bent-strip",
    title: "A strip that buckles sideways in pure bending",
    about: "Moments M at both ends bend a strip in its stiff plane, where its stiffness is 10⁵ EI here. Its ends \
            cannot turn about the tangent, and turn freely sideways. It buckles sideways at M = π √(EI GJ)/L.",
    source: "Michell 1899, Phil. Mag. 48, 298; Timoshenko and Gere 1961, Theory of Elastic Stability, sec. 6.2",
    means: "closed form, for a strip that is rigid in its plane",
    scene: include_str!("scenes/bent-strip.toml"),
    edges: [20, 40, 80],
    quantities: &[Quantity::new("critical moment M L/√(EI GJ)")],
    exact: || vec![PI],
    measure: Measure::Critical(BranchKind::Bifurcation),
};

pub(super) static TWISTED_ROD: Benchmark = Benchmark {
    name: "validation/twisted-rod",
    title: "A straight rod that buckles under twist",
    about: "The clamped ends of a straight rod are turned against each other. The rod buckles into space at the \
            twisting moment M = 8.9868 EI/L; the twist Θ is M L/GJ, with EI/GJ = 1.5 here.",
    source: "Greenhill 1883, Proc. Inst. Mech. Eng. 34, 182",
    means: "closed form: M L/2EI is the first positive root of tan x = x",
    scene: include_str!("scenes/twisted-rod.toml"),
    edges: [20, 40, 80],
    quantities: &[Quantity::new("critical twist Θ, rad")],
    exact: || vec![3.0 * bisect(4.0, 4.6, |x| libm::sin(x) - x * libm::cos(x))],
    measure: Measure::Critical(BranchKind::Bifurcation),
};

pub(super) static TWISTED_RING: Benchmark = Benchmark {
    name: "validation/twisted-ring",
    title: "A ring that buckles under twist",
    about: "A straight rod is bent into a ring, and its ends are turned against each other before they meet. The ring \
            leaves its plane at the twist Θ = 2π√3 EI/GJ; here EI/GJ = 1.5.",
    source: "Michell 1889, Messenger of Math. 19, 181; Zajac 1962, J. Appl. Mech. 29, 136",
    means: "closed form",
    scene: include_str!("scenes/twisted-ring.toml"),
    edges: [40, 80, 160],
    quantities: &[Quantity::new("critical twist Θ, rad")],
    exact: || vec![TAU * 3.0f64.sqrt() * 1.5],
    measure: Measure::Critical(BranchKind::Bifurcation),
};

/// Computes y(1) for y'' = −k(s) y with y(0) = 1, y'(0) = 0.
fn free_end_to_clamp(stiffness: impl Fn(f64) -> f64) -> f64 {
    let slope = |s: f64, [value, rate]: &[f64; 2]| [*rate, -stiffness(s) * value];
    let states = runge_kutta(0.0, 1.0, [1.0, 0.0], STEPS, slope);
    states[states.len() - 1][0]
}
