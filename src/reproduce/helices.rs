//! The boundary of the stable helices (thesis 6.2).

use super::cases::{Run, prepared};
use rodlab_lab::run::PreparedRun;

const BASE: &str = include_str!("../../scenarios/helix_boundary.toml");
/// Number of directions in the thesis.
const DIRECTIONS: usize = 58_352;
/// Number of directions in a quick version.
const QUICK_DIRECTIONS: usize = 2_000;
/// Processor time of a direction, s (measured; correct within a factor of two).
const SECONDS_PER_DIRECTION: f64 = 3e-3;

/// The search over all directions, which is done once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Helices {
    /// Number of directions of the surface.
    pub directions: usize,
    /// Number of directions of each of the three sections.
    pub section_directions: usize,
}

impl Helices {
    /// The run of figures 6.2 and 6.6.
    pub fn of_the_thesis(quick: bool) -> Self {
        Self {
            directions: if quick { QUICK_DIRECTIONS } else { DIRECTIONS },
            section_directions: 361,
        }
    }
}

impl Run for Helices {
    fn id(&self) -> String {
        format!("helices_{}", self.directions)
    }

    fn prepare(&self) -> PreparedRun {
        let overrides = [
            format!("helix_stability.directions.count={}", self.directions),
            format!(
                "helix_stability.section_directions={}",
                self.section_directions
            ),
        ];
        prepared(&self.id(), BASE, &overrides)
    }

    fn extent(&self) -> String {
        format!("{} directions were searched", self.directions)
    }

    fn cost(&self) -> f64 {
        SECONDS_PER_DIRECTION * (self.directions + 3 * self.section_directions) as f64
    }

    #[cfg(test)]
    fn shortened(&self) -> Self {
        Self {
            directions: 60,
            section_directions: 9,
        }
    }
}
