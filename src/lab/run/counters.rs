//! Counters of the steps of a run.

use super::observer::Finding;
use rodlab_engine::mechanics::contact::Proximity;
use rodlab_engine::mechanics::dynamics::{Energies, Exchange, SimulationError, StepReport};
use rodlab_engine::mechanics::statics::{PathPoint, PointKind};
use rodlab_files::results::{CaseOutcome, SeriesRow};
use serde::{Deserialize, Serialize};

/// Counters of a run: of the whole run, and since the last row of the series.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Counters {
    /// Counters of the whole run.
    pub outcome: CaseOutcome,
    /// Work and losses of the whole run.
    pub exchange: Exchange,
    steps: u64,
    newton_iterations: u64,
    fluid_iterations: u64,
    last_step: Option<f64>,
    contacts: Option<usize>,
    /// Sum of the mean gaps at the outputs with contact, m, and number of these outputs.
    gaps: (f64, u64),
}

impl Counters {
    /// Counts a step of a moving scene.
    pub fn add_step(&mut self, report: &StepReport) {
        self.add(report);
        self.last_step = Some(report.step);
        self.exchange += report.exchange;
        self.outcome.simulated_time = report.time;
        if report.contacts > 0 {
            self.outcome.first_contact.get_or_insert(report.time);
        }
    }

    /// Counts the search for an equilibrium as one step without step size.
    pub fn add_equilibrium(&mut self, report: &StepReport) {
        self.add(report);
    }

    /// Counts a point of a path of equilibria; its time is the path parameter.
    pub fn add_point(&mut self, point: &PathPoint) {
        self.add(&StepReport {
            time: point.parameter,
            newton_iterations: point.iterations,
            ..StepReport::default()
        });
        if point.kind != PointKind::Regular {
            self.outcome
                .critical_parameter
                .get_or_insert(point.parameter);
        }
    }

    /// Records that an observer ended the run.
    ///
    /// # Errors
    /// [`SimulationError::Unphysical`] if an observer found a fault.
    pub fn conclude_from(&mut self, findings: Vec<Finding>) -> Result<(), SimulationError> {
        for finding in findings {
            match finding {
                Finding::GoOn => {}
                Finding::End(ending) => self.outcome.ending = Some(ending),
                Finding::Fail(reason) => return Err(SimulationError::Unphysical(reason)),
            }
        }
        Ok(())
    }

    /// Records the energies at an output; the last ones are an outcome of the run.
    pub fn note_energies(&mut self, energies: &Energies) {
        let elastic = energies.elastic();
        self.outcome.elastic_energy = Some(elastic);
        self.outcome.gravitational_energy = Some(energies.gravitational);
    }

    fn add(&mut self, report: &StepReport) {
        let newton_iterations = report.newton_iterations as u64;
        let fluid_iterations = report.fluid_iterations as u64;
        self.steps += 1;
        self.newton_iterations += newton_iterations;
        self.fluid_iterations += fluid_iterations;
        self.contacts = Some(report.contacts);
        self.note_nearest(report.nearest);
        let outcome = &mut self.outcome;
        outcome.steps += 1;
        outcome.newton_iterations += newton_iterations;
        outcome.fluid_iterations += fluid_iterations;
        outcome.retries += report.retries as u64;
        if report.contacts > 0 {
            outcome.steps_with_contact += 1;
            outcome.newton_iterations_with_contact += newton_iterations;
        }
    }

    /// Records the bodies that are nearest to touching; the pair with the least distance is an outcome of the run.
    pub fn note_nearest(&mut self, nearest: Option<Proximity>) {
        let Some(nearest) = nearest else { return };
        let least = &mut self.outcome.minimum_distance_ratio;
        if least.is_none_or(|least| nearest.ratio() < least) {
            *least = Some(nearest.ratio());
            self.outcome.minimum_distance = Some(nearest.distance);
        }
    }

    /// Records the mean gap of the contacts at an output (m); the mean of all outputs is an outcome of the run.
    pub fn note_gap(&mut self, gap: Option<f64>) {
        let Some(gap) = gap else { return };
        let (sum, outputs) = &mut self.gaps;
        *sum += gap;
        *outputs += 1;
        self.outcome.mean_gap = Some(*sum / *outputs as f64);
    }

    /// The row of the series for the steps since the last call.
    pub fn take_row(
        &mut self,
        time: f64,
        nearest: Option<Proximity>,
        energies: &Energies,
    ) -> SeriesRow {
        let mean = |total: u64| (self.steps > 0).then(|| total as f64 / self.steps as f64);
        let row = SeriesRow {
            time_s: time,
            step_s: self.last_step,
            steps: self.steps,
            newton_iterations: mean(self.newton_iterations),
            fluid_iterations: mean(self.fluid_iterations),
            contacts: self.contacts,
            min_distance_m: nearest.map(|nearest| nearest.distance),
            kinetic_energy_j: energies.kinetic,
            stretching_energy_j: energies.stretching,
            bending_energy_j: energies.bending,
            twisting_energy_j: energies.twisting,
            contact_energy_j: energies.contact,
            gravitational_energy_j: energies.gravitational,
        };
        (self.steps, self.newton_iterations, self.fluid_iterations) = (0, 0, 0);
        row
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rodlab_engine::mechanics::contact::ContactPair;

    fn step(time: f64, newton_iterations: usize, contacts: usize) -> StepReport {
        StepReport {
            time,
            step: 0.5,
            newton_iterations,
            contacts,
            retries: 1,
            fluid_iterations: 4,
            ..StepReport::default()
        }
    }

    #[test]
    fn rows_hold_means_since_the_row_before_and_the_outcome_totals() {
        let mut counters = Counters::default();
        let first = counters.take_row(0.0, None, &Energies::default());
        assert_eq!(
            (
                first.newton_iterations,
                first.contacts,
                first.min_distance_m
            ),
            (None, None, None)
        );
        counters.add_step(&step(0.5, 2, 0));
        counters.add_step(&step(1.0, 5, 3));
        let second = counters.take_row(1.0, Some(apart(2e-3, 2e-3)), &Energies::default());
        assert_eq!((second.steps, second.newton_iterations), (2, Some(3.5)));
        assert_eq!(
            (second.contacts, second.min_distance_m),
            (Some(3), Some(2e-3))
        );
        counters.add_step(&step(1.5, 9, 1));
        let third = counters.take_row(1.5, Some(apart(2e-3, 2e-3)), &Energies::default());
        assert_eq!((third.steps, third.newton_iterations), (1, Some(9.0)));
        let outcome = counters.outcome;
        assert_eq!(
            (outcome.steps, outcome.newton_iterations, outcome.retries),
            (3, 16, 3)
        );
        assert_eq!(
            (
                outcome.steps_with_contact,
                outcome.newton_iterations_with_contact
            ),
            (2, 14)
        );
        assert_eq!(outcome.first_contact, Some(1.0));
    }

    fn apart(distance: f64, threshold: f64) -> Proximity {
        Proximity {
            pair: ContactPair::Edges([0, 7]),
            distance,
            threshold,
        }
    }

    #[test]
    fn the_bodies_that_come_nearest_to_touching_are_kept() {
        let mut counters = Counters::default();
        counters.note_nearest(None);
        assert_eq!(counters.outcome.minimum_distance, None);
        // Two thin rods may be closer to each other than two thick rods, and still have the larger
        // gap.
        for (distance, threshold) in [(44e-3, 22e-3), (22e-3, 22e-3), (7.9e-3, 4e-3)] {
            counters.note_nearest(Some(apart(distance, threshold)));
        }
        assert_eq!(counters.outcome.minimum_distance, Some(22e-3));
        assert_eq!(counters.outcome.minimum_distance_ratio, Some(1.0));
    }
}
