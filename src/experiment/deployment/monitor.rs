//! Watches a rod while it is laid: how well it lies, how far it slides, how hard the gripper pulls.

use super::keys::Peg;
use super::knot_proof::determinant_on_table;
use super::laid_rod::{LaidError, PatternMark, laid_error};
use super::outcome::{DeploymentOutcome, DerivedDeployment, PassedPegs, TiedKnot};
use super::pegs;
use crate::mechanics::Vector3;
use crate::mechanics::scene::piecewise_linear;
use crate::results::{CaseOutcome, NamedValues, SeriesRow, Value};
use crate::run::{Finding, Observer, Sample};
use serde::{Deserialize, Serialize};

/// What is watched.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Watched {
    /// Points of the pattern that are compared.
    pub marks: Vec<PatternMark>,
    /// Times (s) and what has been laid then, m.
    pub laid: Vec<(f64, f64)>,
    /// Length of the rod, m.
    pub length: f64,
    /// Nodes of the rod.
    pub nodes: usize,
    /// Height of a node below which it lies on the table, m.
    pub lying_height: f64,
    /// Friction of the table.
    pub friction: f64,
    /// Posts on the table.
    pub pegs: Vec<Peg>,
    /// The pattern from above, m, where there are pegs.
    pub outline: Vec<[f64; 2]>,
    /// Whether a knot is tied, and then the determinant of the pattern.
    pub knot: Option<Option<u64>>,
    /// What the pattern asks for.
    pub derived: DerivedDeployment,
}

/// Watches a rod that is laid, the first of its scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DeploymentMonitor {
    /// What is watched.
    pub watched: Watched,
    /// Time between samples, s.
    interval: f64,
    /// Time of the next sample, s.
    next: f64,
    /// Where nodes first lay, m.
    touched: Vec<Option<[f64; 2]>>,
    largest_sliding: f64,
    largest_force: f64,
    /// Mean, standard deviation and largest of the distances at the last output, m.
    last: Option<(f64, f64, f64)>,
    /// Pegs that were passed as the pattern does at the last output.
    passed: usize,
    /// Determinant of the rod at the last output.
    determinant: Option<u64>,
}

/// Samples in the time of a run.
const SAMPLES: f64 = 600.0;

impl DeploymentMonitor {
    /// A monitor of a rod that still hangs.
    pub fn new(watched: Watched) -> Self {
        let end = watched.laid.last().map_or(0.0, |(time, _)| *time);
        Self {
            touched: vec![None; watched.nodes],
            interval: end / SAMPLES,
            watched,
            next: 0.0,
            largest_sliding: 0.0,
            largest_force: 0.0,
            last: None,
            passed: 0,
            determinant: None,
        }
    }

    /// What has been laid at a time, m.
    fn laid_at(&self, time: f64) -> f64 {
        piecewise_linear(&self.watched.laid, time).unwrap_or(0.0)
    }

    fn look(&mut self, sample: &Sample<'_>) -> (Option<LaidError>, f64) {
        let rod = &sample.simulation.positions()[..self.watched.nodes];
        let laid = self.laid_at(sample.time());
        self.follow_sliding(rod, laid);
        let force = if sample.steps == 0 {
            0.0
        } else {
            sample.simulation.reaction(self.watched.nodes - 1).norm()
        };
        self.largest_force = self.largest_force.max(force);
        (
            laid_error(&self.watched.marks, rod, self.watched.length, laid),
            force,
        )
    }

    /// Notes where nodes first lie, of the part that has been laid, and how far they have come from there.
    fn follow_sliding(&mut self, rod: &[Vector3], laid: f64) {
        let edge = self.watched.length / (self.watched.nodes - 1) as f64;
        for (index, (node, touched)) in rod.iter().zip(&mut self.touched).enumerate() {
            if index as f64 * edge > laid {
                break;
            }
            match touched {
                None if node.z < self.watched.lying_height => *touched = Some([node.x, node.y]),
                None => {}
                Some([x, y]) => {
                    let slid = libm::hypot(node.x - *x, node.y - *y);
                    self.largest_sliding = self.largest_sliding.max(slid);
                }
            }
        }
    }

    /// How many pegs the part of the rod that belongs to the pattern passes as the pattern does.
    fn pegs_passed(&self, rod: &[Vector3]) -> usize {
        let Watched { pegs, outline, .. } = &self.watched;
        let part = self.watched.derived.pattern_length / self.watched.length;
        let laid = pegs::first_part(rod, part);
        let passed = pegs.iter().filter(|peg| pegs::passes(&laid, outline, peg));
        passed.count()
    }

    fn outcome(&self) -> DeploymentOutcome {
        let error = self.last;
        DeploymentOutcome {
            mean_error_m: error.map(|error| error.0),
            error_deviation_m: error.map(|error| error.1),
            largest_error_m: error.map(|error| error.2),
            largest_sliding_m: self.largest_sliding,
            largest_gripper_force_n: self.largest_force,
            largest_friction_demand: self.watched.derived.largest_friction_demand,
            share_above_friction: self.watched.derived.share_above_friction,
            pegs: (!self.watched.pegs.is_empty()).then_some(PassedPegs {
                count: self.watched.pegs.len(),
                passed: self.passed,
            }),
            knot: self.watched.knot.map(|pattern| TiedKnot {
                pattern,
                rod: self.determinant,
            }),
        }
    }
}

impl Observer for DeploymentMonitor {
    fn name(&self) -> &str {
        "deployment"
    }

    fn columns(&self) -> Vec<String> {
        let names = [
            "laid_m",
            "mean_error_m",
            "largest_sliding_m",
            "gripper_force_n",
        ];
        names.map(str::to_owned).into()
    }

    fn is_due(&self, time: f64) -> bool {
        time >= self.next
    }

    fn sample(&mut self, sample: &Sample<'_>) -> Finding {
        self.next = sample.time() + self.interval;
        self.look(sample);
        Finding::GoOn
    }

    fn measure(&mut self, sample: &Sample<'_>, _row: &SeriesRow) -> (Vec<Value>, Finding) {
        // Sliding and largest force are those of the samples, lest they depend on the outputs.
        let kept = (
            self.touched.clone(),
            self.largest_sliding,
            self.largest_force,
        );
        let (error, force) = self.look(sample);
        (self.touched, self.largest_sliding, self.largest_force) = kept;
        // A rod whose end is led on leaves the pattern along which it was laid.
        let laid_by = self.watched.laid.last().map_or(0.0, |(time, _)| *time);
        let is_led = self.watched.knot.is_some() && sample.time() > laid_by * (1.0 + 1e-9);
        let error = error.filter(|_| !is_led);
        if !is_led {
            self.last = error.map(|error| (error.mean, error.deviation, error.largest));
        }
        let rod = &sample.simulation.positions()[..self.watched.nodes];
        self.passed = self.pegs_passed(rod);
        if self.watched.knot.is_some() {
            self.determinant = determinant_on_table(rod);
        }
        let values = vec![
            self.laid_at(sample.time()).into(),
            error.map(|error| error.mean).into(),
            self.largest_sliding.into(),
            force.into(),
        ];
        (values, Finding::GoOn)
    }

    fn outcomes(&self) -> NamedValues {
        self.outcome().values()
    }

    fn remarks(&self) -> Vec<String> {
        self.outcome()
            .remark(self.watched.friction)
            .into_iter()
            .collect()
    }

    fn highlights(&self, outcome: &CaseOutcome) -> Vec<(String, String)> {
        DeploymentOutcome::of(outcome).map_or_else(Vec::new, |laid| laid.highlights())
    }
}
