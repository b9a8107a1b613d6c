//! Monitors rods while they are laid: their distance from the pattern, their sliding, and the
//! forces of the grippers.

use super::keys::Peg;
use super::knot_proof::knot_on_table;
use super::laid_rod::{LaidError, PatternMark, distances};
use super::outcome::{DeploymentOutcome, DerivedDeployment, PassedPegs, TiedKnot};
use super::pegs;
use crate::run::{Finding, Observer, Sample};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::scene::piecewise_linear;
use rodlab_files::results::{CaseOutcome, NamedValues, SeriesRow, Value};
use rodlab_planning::knot::KnotInvariants;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// A rod that is laid.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WatchedRod {
    /// Compared points of its pattern.
    pub marks: Vec<PatternMark>,
    /// Times (s) and the length laid by then, m.
    pub laid: Vec<(f64, f64)>,
    /// Length of the rod, m.
    pub length: f64,
    /// Nodes of the rod.
    pub nodes: Range<usize>,
    /// Height of a node below which it lies on the table, m.
    pub lying_height: f64,
    /// Friction demand of its pattern.
    pub derived: DerivedDeployment,
}

/// Parameters of the monitor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Watched {
    /// The rods in the order of laying: the first ones of the scene.
    pub rods: Vec<WatchedRod>,
    /// Friction of the table.
    pub friction: f64,
    /// Posts on the table.
    pub pegs: Vec<Peg>,
    /// The pattern seen from above, m, if there are pegs.
    pub outline: Vec<[f64; 2]>,
    /// Knot of the patterns, if a knot is tied; the inner `None` is a knot that depends on how
    /// ends are joined.
    pub knot: Option<Option<KnotInvariants>>,
}

impl WatchedRod {
    /// Length laid by a time, m.
    fn laid_at(&self, time: f64) -> f64 {
        piecewise_linear(&self.laid, time).unwrap_or(0.0)
    }

    /// Length of an edge, m.
    fn edge(&self) -> f64 {
        self.length / (self.nodes.len() - 1) as f64
    }
}

impl Watched {
    /// Time at which all rods are laid, s.
    fn laid_by(&self) -> f64 {
        let ends = self.rods.iter().filter_map(|rod| rod.laid.last());
        ends.map(|(time, _)| *time).fold(0.0, f64::max)
    }
}

/// Monitors rods that are laid.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DeploymentMonitor {
    /// Parameters of the monitor.
    pub watched: Watched,
    /// Time between samples, s.
    interval: f64,
    /// Time of the next sample, s.
    next: f64,
    /// Places where nodes were first laid, m.
    touched: Vec<Option<[f64; 2]>>,
    largest_sliding: f64,
    largest_force: f64,
    /// Mean, standard deviation and maximum of the distances at the last output, m.
    last: Option<(f64, f64, f64)>,
    /// Number of pegs that were passed on the side of the pattern at the last output.
    passed: usize,
    /// The knot of the rods at the last output.
    knot: Option<KnotInvariants>,
}

/// Number of samples during a run.
const SAMPLES: f64 = 600.0;

impl DeploymentMonitor {
    /// A monitor of rods that still hang.
    pub fn new(watched: Watched) -> Self {
        let nodes = watched.rods.last().map_or(0, |rod| rod.nodes.end);
        Self {
            touched: vec![None; nodes],
            interval: watched.laid_by() / SAMPLES,
            watched,
            next: 0.0,
            largest_sliding: 0.0,
            largest_force: 0.0,
            last: None,
            passed: 0,
            knot: None,
        }
    }

    fn look(&mut self, sample: &Sample<'_>) -> (Option<LaidError>, f64) {
        let positions = sample.simulation.positions();
        let mut off = Vec::new();
        let mut force: f64 = 0.0;
        for rod in &self.watched.rods {
            // A rod that is still waiting has not started.
            if rod
                .laid
                .first()
                .is_some_and(|first| sample.time() < first.0)
            {
                continue;
            }
            let nodes = &positions[rod.nodes.clone()];
            let laid = rod.laid_at(sample.time());
            let touched = &mut self.touched[rod.nodes.clone()];
            self.largest_sliding = self.largest_sliding.max(sliding(rod, nodes, laid, touched));
            off.extend(distances(&rod.marks, nodes, rod.length, laid));
            if sample.steps > 0 {
                force = force.max(sample.simulation.reaction(rod.nodes.end - 1).norm());
            }
        }
        self.largest_force = self.largest_force.max(force);
        (LaidError::of(&off), force)
    }

    /// Number of pegs that the rod passes on the same side as the pattern. Only the part of the
    /// rod that belongs to the pattern counts.
    fn pegs_passed(&self, rod: &[Vector3]) -> usize {
        let Watched {
            rods,
            pegs,
            outline,
            ..
        } = &self.watched;
        let part = rods[0].derived.pattern_length / rods[0].length;
        let laid = pegs::first_part(rod, part);
        let passed = pegs.iter().filter(|peg| pegs::passes(&laid, outline, peg));
        passed.count()
    }

    fn outcome(&self) -> DeploymentOutcome {
        let error = self.last;
        let derived = DerivedDeployment::of_all(self.watched.rods.iter().map(|rod| rod.derived));
        DeploymentOutcome {
            mean_error_m: error.map(|error| error.0),
            error_deviation_m: error.map(|error| error.1),
            largest_error_m: error.map(|error| error.2),
            largest_sliding_m: self.largest_sliding,
            largest_gripper_force_n: self.largest_force,
            largest_friction_demand: derived.largest_friction_demand,
            share_above_friction: derived.share_above_friction,
            pegs: (!self.watched.pegs.is_empty()).then_some(PassedPegs {
                count: self.watched.pegs.len(),
                passed: self.passed,
            }),
            knot: self.watched.knot.map(|pattern| TiedKnot {
                pattern,
                rod: self.knot,
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
        // Sliding and largest force come from the samples only, so that they do not depend on the
        // outputs.
        let kept = (
            self.touched.clone(),
            self.largest_sliding,
            self.largest_force,
        );
        let (error, force) = self.look(sample);
        (self.touched, self.largest_sliding, self.largest_force) = kept;
        // A rod whose end is led on leaves the pattern along which it was laid.
        let is_led =
            self.watched.knot.is_some() && sample.time() > self.watched.laid_by() * (1.0 + 1e-9);
        let error = error.filter(|_| !is_led);
        if !is_led {
            self.last = error.map(|error| (error.mean, error.deviation, error.largest));
        }
        let positions = sample.simulation.positions();
        let rods: Vec<&[Vector3]> = self
            .watched
            .rods
            .iter()
            .map(|rod| &positions[rod.nodes.clone()])
            .collect();
        self.passed = self.pegs_passed(rods[0]);
        if self.watched.knot.is_some() {
            self.knot = knot_on_table(&rods);
        }
        let laid: f64 = self
            .watched
            .rods
            .iter()
            .map(|rod| rod.laid_at(sample.time()))
            .sum();
        let values = vec![
            laid.into(),
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

/// Records where nodes of the laid part of a rod were first laid, and their largest displacement
/// since then, m.
fn sliding(
    rod: &WatchedRod,
    nodes: &[Vector3],
    laid: f64,
    touched: &mut [Option<[f64; 2]>],
) -> f64 {
    let edge = rod.edge();
    let mut largest: f64 = 0.0;
    for (index, (node, touched)) in nodes.iter().zip(touched).enumerate() {
        if index as f64 * edge > laid {
            break;
        }
        match touched {
            None if node.z < rod.lying_height => *touched = Some([node.x, node.y]),
            None => {}
            Some([x, y]) => largest = largest.max(libm::hypot(node.x - *x, node.y - *y)),
        }
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_node_slides_from_where_it_first_lay_once_it_is_laid() {
        let rod = WatchedRod {
            marks: Vec::new(),
            laid: Vec::new(),
            length: 0.4,
            nodes: 0..5,
            lying_height: 3e-3,
            derived: DerivedDeployment {
                pattern_length: 0.4,
                lead_in: 0.0,
                least_radius: None,
                largest_friction_demand: 0.0,
                share_above_friction: 0.0,
                largest_gripper_speed: 0.0,
            },
        };
        let place = |k: usize| Vector3::new(0.1 * k as f64, 0.0, 2e-3);
        let mut nodes: Vec<Vector3> = (0..5).map(place).collect();
        // The third node is still above the table, and the fourth is not laid.
        nodes[2].z = 0.01;
        let mut touched = vec![None; 5];
        let mut slid = |nodes: &[Vector3]| sliding(&rod, nodes, 0.25, &mut touched);
        assert_eq!(slid(&nodes), 0.0);
        nodes[2] = place(2) + Vector3::new(0.05, 0.0, 0.0);
        nodes[3].x += 0.07;
        assert_eq!(slid(&nodes), 0.0);
        nodes[1] += Vector3::new(3e-3, -4e-3, 0.02);
        nodes[2].y += 1e-3;
        assert!((slid(&nodes) - 5e-3).abs() < 1e-15);
    }
}
