//! Helical rods with clamped ends: where the discrete rod loses stability, against conjugate points.

use super::{Check, Claim, FamilyError};
use crate::experiment::helix_stability::discrete_critical_distance;
use crate::mechanics::dynamics::SimulationError;
use crate::mechanics::kirchhoff::{HeavyLoop, Helix, critical_distance};

const CONJUGATE_POINT: Claim = Claim {
    formula: "det J(s) = 0",
    source: "Borum & Bretl 2020",
};
const MIRRORED: Claim = Claim {
    formula: "(κ, τ, ω) → (κ, −τ, −ω)",
    source: "mirror image",
};
const HEAVY_LOOP: Claim = Claim {
    formula: "θ'' = −(V + s/2) cos θ",
    source: "elastica by shooting",
};
/// Height of a folded rod's loop in gravito-bending lengths: 0.906597 (EI/ρgA)^(1/3).
const LOOP_HEIGHT: f64 = 1.142_240;
/// Edges of the finer mesh of an extrapolation; the coarser has half as many.
const EDGES: usize = 100;
/// Beyond this distance 100 edges are too few: (0.29, 0.34, 0.90), at 18.2, is 0.8 % off. Twice as many are
/// taken there.
const FAR: f64 = 12.0;

/// Critical distances on a mesh and extrapolated in it, the mirror image, the loop's height.
pub fn checks(full: bool) -> Result<Vec<Check>, FamilyError> {
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
        let far = expected > FAR;
        let edges = if far { 2 * EDGES } else { EDGES };
        let [coarse, fine] = [discrete(&helix, edges / 2)?, discrete(&helix, edges)?];
        let extrapolated = fine + (fine - coarse) / 3.0;
        for (how, got, bound) in [
            (
                format!("{edges} edges"),
                fine,
                if far { 5e-3 } else { 1e-3 },
            ),
            (
                "extrapolated".into(),
                extrapolated,
                if far { 1e-3 } else { 2e-4 },
            ),
        ] {
            let name = format!("{name}: critical distance, {how}");
            checks.push(CONJUGATE_POINT.relative(name, "", expected, got, bound));
        }
    }
    checks.push(mirror_image()?);
    let height = HeavyLoop::new().height;
    let name = "folded heavy rod: height of the loop h/L_gb";
    checks.push(HEAVY_LOOP.relative(name, "", LOOP_HEIGHT, height, 2e-4));
    Ok(checks)
}

fn discrete(helix: &Helix, edges: usize) -> Result<f64, SimulationError> {
    Ok(discrete_critical_distance(helix, edges)?.unwrap_or(f64::NAN))
}

fn mirror_image() -> Result<Check, SimulationError> {
    let helix = |sign: f64| Helix {
        curvature: 0.8,
        torsion: sign * 0.5,
        twisting_moment: sign * 0.3,
    };
    let [expected, got] = [
        discrete(&helix(1.0), EDGES)?,
        discrete(&helix(-1.0), EDGES)?,
    ];
    let name = "mirrored helix: critical distance";
    Ok(MIRRORED.relative(name, "", expected, got, 1e-6))
}
