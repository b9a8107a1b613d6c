//! Criterion for rebuilding a preconditioner.

use serde::{Deserialize, Serialize};

/// Cost of the present preconditioner since it was built.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Age {
    /// Solves with it.
    pub solves: usize,
    /// Total number of iterations of these solves.
    iterations: usize,
    /// Smoothed number of iterations of recent solves.
    recent: f64,
}

impl Age {
    /// Number of solves over which `recent` is smoothed.
    const MEMORY: f64 = 8.0;

    /// Records a solve.
    pub(crate) fn record(&mut self, iterations: usize) {
        let weight = if self.solves == 0 {
            1.0
        } else {
            1.0 / Self::MEMORY
        };
        self.recent += weight * (iterations as f64 - self.recent);
        self.solves += 1;
        self.iterations += iterations;
    }

    /// Whether to rebuild. This is due once a solve costs more than the average since the last
    /// rebuild, including the price of the rebuild (in iterations). For costs that only grow, this
    /// rule is the best one.
    pub(crate) fn is_over(&self, price: f64) -> bool {
        self.recent * self.solves as f64 > price + self.iterations as f64
    }
}
