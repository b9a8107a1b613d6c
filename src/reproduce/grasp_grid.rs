//! Exact grasps on a grid (thesis 5.3.4).

use super::cases::{Run, prepared_table};
use rodlab_lab::run::PreparedRun;
use toml::toml;

/// k̄_s of thesis Fig. 5.6a.
pub(super) const STIFFNESS: f64 = 2087.0;
/// l̄_s of thesis Fig. 5.6b.
pub(super) const LENGTH: f64 = 13.68;
/// Range of suspended lengths of Fig. 5.6a.
const LENGTHS: [f64; 2] = [2.0, 24.0];
/// Range of compliances 1/k̄_s of Fig. 5.6b.
const COMPLIANCES: [f64; 2] = [0.0, 0.003];
/// Range of curvatures.
const CURVATURES: [f64; 2] = [0.0, 2.0];
/// Number of curves.
const CURVES: usize = 5;
/// Number of grasps of each curve.
const GRASPS: usize = 41;

/// A grid of grasps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct GraspGrid {
    /// Whether the grid is over the suspended length instead of the stretching stiffness.
    pub is_over_length: bool,
    /// Number of curvatures for each.
    grasps: usize,
}

impl GraspGrid {
    /// Both parts of figure 5.6; a quick version has fewer curvatures.
    pub fn of_figure_5_6(quick: bool) -> Vec<Self> {
        let grasps = if quick { 11 } else { GRASPS };
        [true, false]
            .map(|is_over_length| Self {
                is_over_length,
                grasps,
            })
            .into()
    }
}

impl Run for GraspGrid {
    fn id(&self) -> String {
        let over = if self.is_over_length {
            "length"
        } else {
            "stiffness"
        };
        format!("grasps_over_{over}_{}", self.grasps)
    }

    fn prepare(&self) -> PreparedRun {
        let same = |value: f64| [value, value];
        let (lengths, compliances, [long, soft]) = if self.is_over_length {
            (LENGTHS, same(1.0 / STIFFNESS), [CURVES, 1])
        } else {
            (same(LENGTH), COMPLIANCES, [1, CURVES])
        };
        let span = |[from, to]: [f64; 2]| toml! { from = from to = to };
        let scenario = toml! {
            experiment = "grasp-samples"
            title = (self.id())
            [grasp_samples]
            suspended_length = (span(lengths))
            curvature = (span(CURVATURES))
            stretch_compliance = (span(compliances))
            [grasp_samples.points]
            kind = "grid"
            suspended_lengths = long
            curvatures = (self.grasps)
            stretch_compliances = soft
        };
        prepared_table(&self.id(), scenario, &[])
    }

    fn extent(&self) -> String {
        format!("rods of {} curvatures were solved for", self.grasps)
    }

    fn cost(&self) -> f64 {
        2e-3 * (CURVES * self.grasps) as f64
    }

    #[cfg(test)]
    fn shortened(&self) -> Self {
        Self { grasps: 3, ..*self }
    }
}
