//! Resolved samples of optimal grasps.

use crate::experiment::data_set::Span;
use rodlab_engine::random::sobol;
use serde::Serialize;

/// Optimal grasps at many points of (l̄_s, κ̄, 1/k̄_s).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GraspSamples {
    /// The points.
    pub points: Points,
    /// Suspended lengths, L_gb.
    pub suspended_length: Span,
    /// Curvatures times L_gb.
    pub curvature: Span,
    /// 1/k̄_s.
    pub stretch_compliance: Span,
}

impl Span {
    fn at(&self, part: f64) -> f64 {
        self.from + part * (self.to - self.from)
    }

    /// Uniform in the square root.
    fn at_root(&self, part: f64) -> f64 {
        let roots = Self {
            from: self.from.sqrt(),
            to: self.to.sqrt(),
        };
        roots.at(part).powi(2).clamp(self.from, self.to)
    }
}

/// Points at which grasps are computed.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Points {
    /// Points of Sobol's sequence.
    Sobol {
        /// Number of points.
        count: usize,
        /// Number of the first one.
        first: u64,
    },
    /// A grid.
    Grid {
        /// Number of suspended lengths.
        suspended_lengths: usize,
        /// Number of curvatures.
        curvatures: usize,
        /// Number of compliances.
        stretch_compliances: usize,
    },
}

impl GraspSamples {
    /// Number of points.
    pub fn count(&self) -> usize {
        match self.points {
            Points::Sobol { count, .. } => count,
            Points::Grid {
                suspended_lengths,
                curvatures,
                stretch_compliances,
            } => suspended_lengths * curvatures * stretch_compliances,
        }
    }

    /// l̄_s, κ̄ and 1/k̄_s of a point.
    pub fn point(&self, index: usize) -> [f64; 3] {
        let [length, curvature, compliance] = match self.points {
            Points::Sobol { first, .. } => sobol(first + index as u64),
            Points::Grid {
                suspended_lengths,
                curvatures,
                stretch_compliances,
            } => {
                let part = |index: usize, count: usize| index as f64 / (count - 1).max(1) as f64;
                let column = index / stretch_compliances;
                [
                    part(column / curvatures, suspended_lengths),
                    part(column % curvatures, curvatures),
                    part(index % stretch_compliances, stretch_compliances),
                ]
            }
        };
        [
            self.suspended_length.at_root(length),
            self.curvature.at(curvature),
            self.stretch_compliance.at(compliance),
        ]
    }
}
