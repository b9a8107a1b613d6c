//! Pegs on the table of a robot cell, beside the pattern.

use super::keys::{Deployment, Peg};
use super::outcome::PassedPegs;
use super::pegs;
use rodlab_engine::mechanics::scene::RodDescription;
use rodlab_planning::plan::pattern::{PatternError, Point};

/// Pegs and the pattern between them, in the frame of the pattern, m.
#[derive(Clone, Debug)]
pub struct Fixtures {
    pegs: Vec<Peg>,
    outline: Vec<[f64; 2]>,
}

impl Fixtures {
    /// Fixtures of a deployment, possibly without pegs.
    ///
    /// # Errors
    /// The pattern is invalid.
    pub fn of(deployment: &Deployment) -> Result<Self, PatternError> {
        Ok(Self {
            pegs: deployment.pegs.clone(),
            outline: pegs::outline(&deployment.pattern.source().pattern()?),
        })
    }

    /// The pegs.
    pub fn pegs(&self) -> &[Peg] {
        &self.pegs
    }

    /// The pattern seen from above, m.
    pub fn outline(&self) -> Vec<Point> {
        self.outline.iter().map(|&point| point.into()).collect()
    }

    /// The rigid obstacles that represent the pegs in another frame on the same table. `place`
    /// maps to that frame.
    pub fn posts(&self, place: impl Fn([f64; 2]) -> [f64; 2]) -> Vec<RodDescription> {
        let numbered = self.pegs.iter().enumerate();
        let posts = numbered.map(|(number, peg)| {
            let peg = Peg {
                position: place(peg.position),
                ..*peg
            };
            pegs::post(&format!("peg_{}", number + 1), &peg)
        });
        posts.collect()
    }

    /// The pegs that a rod, seen from above, passes on the same side as the pattern; see
    /// [`PassedPegs`].
    pub fn passed(&self, rod: &[Point]) -> PassedPegs {
        let passes = |peg: &&Peg| pegs::passes_beside(rod, &self.outline, peg);
        PassedPegs {
            count: self.pegs.len(),
            passed: self.pegs.iter().filter(passes).count(),
        }
    }

    /// Circles of the pegs seen from above for a plot, with gaps between them, m.
    pub fn circles(&self) -> Vec<(f64, Option<f64>)> {
        pegs::outlines(&self.pegs)
    }
}
