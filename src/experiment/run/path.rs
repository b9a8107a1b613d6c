//! Runs that follow a path of equilibria.

use super::Stop;
use super::advance::Advance;
use super::session::Session;
use super::stop::StopRequest;
use crate::mechanics::Vector3;
use crate::mechanics::dynamics::{Energies, StepReport};
use crate::mechanics::statics::{PathPlan, PathPoint, PointKind};
use crate::results::{BRANCH, BranchKind, BranchRow, CsvStream};

impl Session {
    /// Follows the path to its ends, a row per point.
    ///
    /// A path is followed in seconds, so that no checkpoint is made of it: after an interruption it starts
    /// again.
    pub(super) fn follow<S: Advance>(
        &mut self,
        simulation: &mut S,
        plan: PathPlan,
        stop_requested: &dyn Fn() -> Option<StopRequest>,
    ) -> Result<(), Stop> {
        let mut path = simulation.path(plan)?;
        let placed = simulation.frame(false).positions;
        let mut branches = CsvStream::create(&self.file(BRANCH))?;
        while let Some(point) = simulation.next_point(&mut path)? {
            let moved = root_mean_square(&placed, &simulation.frame(false).positions);
            branches.write(&row(&point, moved, &simulation.energies()))?;
            branches.flush()?;
            let report = StepReport {
                time: point.parameter,
                newton_iterations: point.iterations,
                ..StepReport::default()
            };
            self.record_point(simulation, &report, point.kind != PointKind::Regular)?;
            self.ask_to_stop(stop_requested)?;
        }
        branches.sync()?;
        Ok(())
    }
}

fn row(point: &PathPoint, displacement_rms_m: f64, energies: &Energies) -> BranchRow {
    let elastic = energies.stretching + energies.bending + energies.twisting;
    BranchRow {
        branch: point.branch,
        parameter: point.parameter,
        parameter_error: point.parameter_error,
        displacement_rms_m,
        elastic_energy_j: elastic,
        energy_j: elastic + energies.contact + energies.gravitational,
        negative_pivots: point.negative,
        stable: point.negative == 0,
        lowest_eigenvalue_n_per_m: point.lowest_eigenvalue,
        kind: match point.kind {
            PointKind::Regular => BranchKind::Regular,
            PointKind::Fold => BranchKind::Fold,
            PointKind::Bifurcation => BranchKind::Bifurcation,
        },
        newton_iterations: point.iterations,
    }
}

fn root_mean_square(from: &[Vector3], to: &[Vector3]) -> f64 {
    let sum: f64 = (from.iter().zip(to))
        .map(|(from, to)| (to - from).norm_squared())
        .sum();
    (sum / from.len() as f64).sqrt()
}
