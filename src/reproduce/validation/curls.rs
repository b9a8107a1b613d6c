//! Naturally curved rods.

use super::benchmark::{Benchmark, BenchmarkRun, Measure, Quantity};
use super::buckled_sideways::HangingRod;
use crate::reproduce::prelude::*;
use rodlab_engine::mechanics::Vector3;
use rodlab_files::results::{BranchKind, read_nodes, read_series};
use std::f64::consts::{FRAC_PI_2, PI};

pub(super) static SUSPENDED_CURL: Benchmark = Benchmark {
    name: "validation/suspended-curl",
    title: "A suspended curl that leaves its plane",
    about: "A rod with the natural curvature 6/L hangs from a clamp whose tangent points down; GJ = 2/3 EI. Without \
            weight it is an arc in a plane. A weight w per length opens the arc and makes it leave the plane; a larger \
            one pulls it straight, and the planar shape is stable again. Whether such a rod \
            stays in its plane depends only on w L³/EI, on the natural curvature times L and on EI/GJ, here 6 and 3/2: the \
            diagram of the bend-twist test of Romero et al. 2021.",
    source: "Miller, Lazarus, Audoly and Reis 2014, Phys. Rev. Lett. 112, 068103, with a diagram of planar and \
             spatial shapes over length and natural curvature; Romero, Ly, Rasheed, Charrondière, Lazarus, Neukirch and \
             Bertails-Descoubes 2021, ACM Trans. Graph. 40, 66, the bend-twist test",
    means: "shooting of the planar equilibrium, and of the linearised equations of rotations out of its plane",
    scene: include_str!("scenes/suspended-curl.toml"),
    edges: [40, 80, 160],
    quantities: &[
        Quantity::new("w L³/EI at which it leaves its plane"),
        Quantity::new("w L³/EI from which the plane is stable again"),
    ],
    exact: || {
        let rod = HangingRod {
            stiffness: [1.0, 1.0, 2.0 / 3.0],
            natural_curvature: 6.0,
            clamp: FRAC_PI_2,
        };
        rod.critical_weights::<2>(0.5).to_vec()
    },
    measure: Measure::Critical(BranchKind::Bifurcation),
};

pub(super) static CURVED_STRIP: Benchmark = Benchmark {
    name: "validation/curved-strip",
    title: "A curved strip on edge that buckles sideways under its own weight",
    about: "A strip on edge rises naturally from its horizontal clamp along an arc of 1 rad. Its stiffness in the \
            vertical plane is 100 EI, and GJ = EI. Its weight w per length bends it down, until it turns over \
            sideways. A straight strip does so at 12.85 √(EI GJ)/L³.",
    source: "Timoshenko and Gere 1961, Theory of Elastic Stability, ch. 7, on curved strips; here with the load of \
             Prandtl 1899",
    means: "shooting of the planar equilibrium, and of the linearised equations of rotations out of its plane",
    scene: include_str!("scenes/curved-strip.toml"),
    edges: [20, 40, 80],
    quantities: &[Quantity::new("critical weight w L³/EI")],
    exact: || {
        let rod = HangingRod {
            stiffness: [100.0, 1.0, 1.0],
            natural_curvature: -1.0,
            clamp: PI,
        };
        rod.critical_weights::<1>(0.5).to_vec()
    },
    measure: Measure::Critical(BranchKind::Bifurcation),
};

pub(super) static FOLDED_RING: Benchmark = Benchmark {
    name: "validation/folded-ring",
    title: "An overcurved ring that folds to three coils",
    about: "A ring of radius R is closed from a rod with the natural curvature 3/R. Flat it has the bending energy \
            4π EI/R. It folds to three coils of radius R/3, in which the rod is neither bent nor twisted: one coil \
            crosses over and one under, so its writhe is 0. Nothing keeps the rod from passing through itself. \
            A polygon with edges of the length h and the natural angle 2 atan(3 h/2R) at its nodes does not close, so \
            energy of the order h⁴ is left.",
    source: "Goto, Watanabe, Kasugai and Obata 1992, Int. J. Solids Struct. 29, 893; Mouthuy, Coulombier, Pardoen, \
             Raskin and Jonas 2012, Nature Comm. 3, 1290",
    means: "closed form; the error of the energy is over that of the flat ring",
    scene: include_str!("scenes/folded-ring.toml"),
    edges: [60, 120, 240],
    quantities: &[
        Quantity::new("radius of gyration over R"),
        Quantity::new("elastic energy over 4π EI/R").over(1.0),
    ],
    exact: || vec![1.0 / 3.0, 0.0],
    measure: Measure::Run(|case: &Case<BenchmarkRun>| {
        let outputs = read_nodes(&case.directory, case.run.edges)?;
        let series = read_series(&case.directory)?;
        let radius = outputs
            .last()
            .map(|last| radius_of_gyration(&last.positions));
        let energy = series.last().map(|row| row.elastic_energy() / (4.0 * PI));
        Ok([radius, energy]
            .map(|value| value.unwrap_or(f64::NAN))
            .to_vec())
    }),
};

/// Root mean square distance of points from their mean.
fn radius_of_gyration(points: &[Vector3]) -> f64 {
    let count = points.len() as f64;
    let mean = points.iter().sum::<Vector3>() / count;
    let squares = points.iter().map(|point| (point - mean).norm_squared());
    (squares.sum::<f64>() / count).sqrt()
}

pub(super) static HELICAL_SPRING: Benchmark = Benchmark {
    name: "validation/helical-spring",
    title: "A helical spring pulled far",
    about: "A spring of three turns and the pitch angle α₀ = 15° is pulled along its axis until α = 45°, without a \
            turn of its ends. For a rod of length L with q = cos α₀/r₀ the curvature and the torsion are q cos α \
            and q sin α; the force q [GJ (τ − τ₀) − EI (κ − κ₀) tan α] along the axis and the moment GJ (τ − τ₀) t + \
            EI (κ − κ₀) b hold the spring. The clamp keeps the tangent at the start, so the axis leans over by 30°.",
    source: "Kirchhoff 1859, J. reine angew. Math. 56, 285; Love 1927, Mathematical Theory of Elasticity, ch. XIX",
    means: "closed form",
    scene: include_str!("scenes/helical-spring.toml"),
    edges: [60, 120, 240],
    quantities: &[
        Quantity::new("length of the spring over L"),
        Quantity::new("lean of its axis, degrees"),
    ],
    exact: || vec![0.5f64.sqrt(), 30.0],
    measure: Measure::Tip(|tip| {
        let length = 6.0 * PI / libm::cos(PI / 12.0);
        let chord = tip - Vector3::x();
        let lean = libm::acos(chord.z / chord.norm());
        vec![chord.norm() / length, lean.to_degrees()]
    }),
};
