//! Helical rods with clamped ends: the loss of stability of the discrete rod, against conjugate
//! points.

use super::{Check, Expectation, GroupError};
use rodlab_engine::mechanics::dynamics::SimulationError;
use rodlab_engine::mechanics::kirchhoff::{HeavyLoop, Helix, critical_distance};
use rodlab_engine::random::uniform_numbers;
use rodlab_lab::experiment::helix::stability::{
    DiscreteRod, HelixSearch, discrete_critical_distance,
};
use std::f64::consts::TAU;

const CONJUGATE_POINT: Expectation = Expectation::new("det J(s) = 0", "Borum & Bretl 2020");
const MIRRORED: Expectation = Expectation::new("(κ, τ, ω) → (κ, −τ, −ω)", "mirror image");
const HEAVY_LOOP: Expectation = Expectation::new("θ'' = −(V + s/2) cos θ", "elastica by shooting");
/// Height of a folded rod's loop in gravito-bending lengths: 0.906597 (EI/ρgA)^(1/3).
const LOOP_HEIGHT: f64 = 1.142_240;
/// Number of edges of the finer mesh of an extrapolation; the coarser mesh has half as many.
const EDGES: usize = 100;
/// Distance beyond which the mesh has twice as many edges, since 100 edges are too few: the error
/// of (0.29, 0.34, 0.90), at 18.2, is 0.8 %.
const FAR: f64 = 12.0;

const MATERIAL: Expectation =
    Expectation::new("critical distance of (κ, τ, ω) L", "Borum & Bretl 2020");
const PATH: Expectation = Expectation::new(
    "rod placed on the helix, or followed from straight",
    "two paths to one boundary",
);

/// Checks critical distances on a mesh and extrapolated in the mesh size, their independence of
/// material and path, the mirror image, and the height of the loop.
pub fn checks(full: bool) -> Result<Vec<Check>, GroupError> {
    let directions: &[(&str, [f64; 3])] = &[
        ("planar ring (1, 0, 0)", [1.0, 0.0, 0.0]),
        ("pushed straight rod (0, 1, 0)", [0.0, 1.0, 0.0]),
        ("twisted straight rod (0, 0, 1)", [0.0, 0.0, 1.0]),
        ("helix (1, 1, −1)/√3", [1.0, 1.0, -1.0]),
        ("helix (1, 1, 1)/√3", [1.0, 1.0, 1.0]),
        ("helix (0.594, 0.698, 0.4)", [0.594, 0.698, 0.4]),
        ("helix (0.29, 0.34, 0.90)", [0.289, 0.340, 0.895]),
    ];
    let count = if full { directions.len() } else { 5 };
    let mut checks = Vec::new();
    for &(name, [curvature, torsion, twisting_moment]) in &directions[..count] {
        let helix = Helix {
            curvature,
            torsion,
            twisting_moment,
        };
        let expected = critical_distance(&helix).map_or(f64::NAN, |critical| critical.distance);
        let (edges, [of_mesh, of_limit]) = if expected > FAR {
            (2 * EDGES, [5e-3, 1e-3])
        } else {
            (EDGES, [1e-3, 2e-4])
        };
        let [coarse, fine] = [discrete(&helix, edges / 2)?, discrete(&helix, edges)?];
        let extrapolated = fine + (fine - coarse) / 3.0;
        for (how, got, bound) in [
            (format!("{edges} edges"), fine, of_mesh),
            ("extrapolated".into(), extrapolated, of_limit),
        ] {
            let quantity = CONJUGATE_POINT.of(format!("{name}: critical distance, {how}"), "");
            checks.push(quantity.relative(expected, got, bound));
        }
    }
    checks.push(mirror_image()?);
    checks.extend(materials()?);
    checks.push(path(if full { 100 } else { 5 })?);
    let height = HeavyLoop::new().height;
    let name = "folded heavy rod: height of the loop h/L_gb";
    checks.push(HEAVY_LOOP.of(name, "").relative(LOOP_HEIGHT, height, 2e-4));
    Ok(checks)
}

fn discrete(helix: &Helix, edges: usize) -> Result<f64, SimulationError> {
    Ok(discrete_critical_distance(helix, edges)?.unwrap_or(f64::NAN))
}

fn rod() -> DiscreteRod {
    DiscreteRod {
        edges: EDGES,
        stiffness_ratio: 1.0 / 1.5,
        bending_stiffness: 1.0,
    }
}

/// Checks a rod with another stiffness ratio, and one with a material a thousand times stiffer.
fn materials() -> Result<[Check; 2], SimulationError> {
    let helix = Helix::from([1.0, 1.0, 1.0]);
    let critical = |rod: DiscreteRod| -> Result<f64, SimulationError> {
        let found = rod.critical_distance(&helix, HelixSearch::Fast, 20.0, None, &|| true)?;
        Ok(found.unwrap_or(f64::NAN))
    };
    let expected = critical(rod())?;
    let other_ratio = DiscreteRod {
        stiffness_ratio: 1.0,
        ..rod()
    };
    let stiffer = DiscreteRod {
        bending_stiffness: 1e3,
        ..rod()
    };
    let check = |what: &str, rod| -> Result<Check, SimulationError> {
        let name = format!("helix (1, 1, 1)/√3, {what}: critical distance");
        Ok(MATERIAL
            .of(name, "")
            .relative(expected, critical(rod)?, 1e-4))
    };
    Ok([
        check("GJ/EI = 1 and 2/3", other_ratio)?,
        check("Young's modulus 1000 and 1", stiffer)?,
    ])
}

/// Compares the direct search with the path from the straight rod for `count` random directions;
/// reports the direction with the largest difference.
fn path(count: usize) -> Result<Check, SimulationError> {
    let mut number = uniform_numbers(6);
    let mut worst = (1.0, 1.0);
    for _ in 0..count {
        let height = number();
        let (sine, cosine) = libm::sincos(TAU * number());
        let across = (1.0 - height * height).sqrt();
        let helix = Helix::from([height, across * cosine, across * sine]);
        let critical =
            |search| rod().critical_distance(&helix, search, 0.25 * EDGES as f64, None, &|| true);
        // A direction without a boundary must have none in both searches.
        let pair = match (critical(HelixSearch::Fast)?, critical(HelixSearch::Path)?) {
            (None, None) => continue,
            (fast, path) => (fast.unwrap_or(f64::NAN), path.unwrap_or(f64::NAN)),
        };
        let difference = |(fast, path): (f64, f64)| (path / fast - 1.0).abs();
        if !(difference(pair) <= difference(worst)) {
            worst = pair;
        }
    }
    let name = format!("{count} random helices, reached along paths: critical distance");
    Ok(PATH.of(name, "").relative(worst.0, worst.1, 2e-3))
}

fn mirror_image() -> Result<Check, SimulationError> {
    let helix = |sign: f64| Helix {
        curvature: 0.8,
        torsion: sign * 0.5,
        twisting_moment: sign * 0.3,
    };
    let expected = discrete(&helix(1.0), EDGES)?;
    let got = discrete(&helix(-1.0), EDGES)?;
    let name = "mirrored helix: critical distance";
    Ok(MIRRORED.of(name, "").relative(expected, got, 1e-6))
}
