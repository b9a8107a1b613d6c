//! Monitors a sheet while it is folded: its slide, the force of the gripper, and the position of
//! the crease.

use super::outcome::FoldingOutcome;
use crate::run::{Finding, Observer, Sample};
use rodlab_engine::mechanics::Vector3;
use rodlab_files::results::{CaseOutcome, NamedValues, SeriesRow, Value};
use serde::{Deserialize, Serialize};

/// Number of samples during a run.
const SAMPLES: f64 = 1000.0;

/// Parameters of the monitor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Watched {
    /// Nodes of the sheet, the free end first.
    pub nodes: usize,
    /// Length of the sheet, m.
    pub length: f64,
    /// Target of the edge, m.
    pub target: f64,
    /// Height below which the edge is down, m.
    pub down: f64,
    /// Weight of the sheet divided by that of the simulated strip.
    pub weight: f64,
    /// Time of the run, s.
    pub end: f64,
    /// L_gb, m.
    pub gravito_bending_length: f64,
    /// Poses of the gripper.
    pub poses: usize,
    /// Largest planned speed of the gripper, m/s.
    pub largest_speed: f64,
}

/// Monitors the folded sheet, the first rod of its scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FoldingMonitor {
    /// Parameters of the monitor.
    pub watched: Watched,
    next: f64,
    /// Time and nodes of the last sample, s and m.
    before: Option<(f64, Vec<Vector3>)>,
    outcome: FoldingOutcome,
}

impl FoldingMonitor {
    /// A monitor of a flat sheet.
    pub fn new(watched: Watched) -> Self {
        Self {
            watched,
            next: 0.0,
            before: None,
            outcome: FoldingOutcome::default(),
        }
    }

    fn slid(&self, sample: &Sample<'_>) -> f64 {
        sample.simulation.positions()[0].x - self.watched.length
    }

    fn force(&self, sample: &Sample<'_>) -> f64 {
        if sample.steps == 0 {
            return 0.0;
        }
        self.watched.weight * sample.simulation.reaction(self.watched.nodes - 1).norm()
    }

    /// Length from the edge to the crease, along the sheet. The crease is pressed half a crease
    /// target behind the edge, into the layer on the table, which has slid. `None` if the edge is
    /// not down, or if there is no layer at that place.
    fn fold_length(&self, edge: Vector3, slid: f64) -> Option<f64> {
        let crease = edge.x - 0.5 * self.watched.target;
        let length = crease - slid;
        let lies = (0.0..self.watched.length).contains(&length);
        (edge.z < self.watched.down && lies).then_some(length)
    }
}

impl Observer for FoldingMonitor {
    fn name(&self) -> &str {
        "folding"
    }

    fn columns(&self) -> Vec<String> {
        let names = ["sliding_m", "gripper_x_m", "gripper_z_m", "gripper_force_n"];
        names.map(str::to_owned).into()
    }

    fn is_due(&self, time: f64) -> bool {
        time >= self.next
    }

    fn sample(&mut self, sample: &Sample<'_>) -> Finding {
        self.next = sample.time() + self.watched.end / SAMPLES;
        let nodes = &sample.simulation.positions()[..self.watched.nodes];
        let slid = self.slid(sample);
        let force = self.force(sample);
        let speed = match &self.before {
            Some((time, before)) if sample.time() > *time => {
                let moved = nodes
                    .iter()
                    .zip(before)
                    .map(|(node, other)| (node - other).norm());
                moved.fold(0.0, f64::max) / (sample.time() - time)
            }
            _ => 0.0,
        };
        self.before = Some((sample.time(), nodes.to_vec()));
        let outcome = &mut self.outcome;
        outcome.largest_sliding_m = outcome.largest_sliding_m.max(slid.abs());
        outcome.largest_gripper_force_n = outcome.largest_gripper_force_n.max(force);
        outcome.largest_speed_m_s = outcome.largest_speed_m_s.max(speed);
        Finding::GoOn
    }

    fn measure(&mut self, sample: &Sample<'_>, _row: &SeriesRow) -> (Vec<Value>, Finding) {
        let edge = sample.simulation.positions()[self.watched.nodes - 1];
        let slid = self.slid(sample);
        let fold = self.fold_length(edge, slid);
        self.outcome.final_sliding_m = slid;
        self.outcome.fold_length_m = fold;
        self.outcome.fold_length_error_m = fold.map(|fold| fold - 0.5 * self.watched.target);
        let values = vec![
            slid.into(),
            edge.x.into(),
            edge.z.into(),
            self.force(sample).into(),
        ];
        (values, Finding::GoOn)
    }

    fn outcomes(&self) -> NamedValues {
        self.outcome.values()
    }

    fn highlights(&self, outcome: &CaseOutcome) -> Vec<(String, String)> {
        FoldingOutcome::of(outcome).map_or_else(Vec::new, |folded| folded.highlights())
    }
}
