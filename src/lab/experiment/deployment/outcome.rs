//! Outcome of a deployment.

use rodlab_files::results::{CaseOutcome, NamedValues};
use rodlab_planning::knot::KnotInvariants;
use serde::{Deserialize, Serialize};

/// Numbers of a deployment.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DerivedDeployment {
    /// Length of the pattern with its lead-in, m.
    pub pattern_length: f64,
    /// Length of the lead-in, m.
    pub lead_in: f64,
    /// Least radius of curvature, m; `None` if the pattern is straight.
    pub least_radius: Option<f64>,
    /// The largest friction demand of the pattern.
    pub largest_friction_demand: f64,
    /// Fraction of the pattern that demands more friction than the table has.
    pub share_above_friction: f64,
    /// Largest speed of the gripper, m/s.
    pub largest_gripper_speed: f64,
}

impl DerivedDeployment {
    /// Combines the numbers of all rods of a deployment.
    pub fn of_all(rods: impl Iterator<Item = Self>) -> Self {
        let least = |one: Option<f64>, other: Option<f64>| match (one, other) {
            (Some(one), Some(other)) => Some(one.min(other)),
            _ => one.or(other),
        };
        let joined = rods.reduce(|one, other| {
            let length = one.pattern_length + other.pattern_length;
            let above = one.share_above_friction * one.pattern_length
                + other.share_above_friction * other.pattern_length;
            Self {
                pattern_length: length,
                lead_in: one.lead_in + other.lead_in,
                least_radius: least(one.least_radius, other.least_radius),
                largest_friction_demand: one
                    .largest_friction_demand
                    .max(other.largest_friction_demand),
                share_above_friction: above / length,
                largest_gripper_speed: one.largest_gripper_speed.max(other.largest_gripper_speed),
            }
        });
        joined.expect("a deployment has a rod")
    }
}

/// Outcomes of a deployment: the last columns of `summary.csv`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DeploymentOutcome {
    /// Mean distance of the laid rod from the pattern, e_mean of thesis Eq. 5.11, m.
    pub mean_error_m: Option<f64>,
    /// Standard deviation σ of that distance, m.
    pub error_deviation_m: Option<f64>,
    /// Largest distance, m.
    pub largest_error_m: Option<f64>,
    /// Largest displacement of a node from where it was first laid, m.
    pub largest_sliding_m: f64,
    /// Largest force of the gripper on the rod, N.
    pub largest_gripper_force_n: f64,
    /// The largest friction that the pattern demands (thesis Eq. 5.2).
    pub largest_friction_demand: f64,
    /// Fraction of the pattern that demands more friction than the table has.
    pub share_above_friction: f64,
    /// Outcome of the pegs; `None` without pegs.
    pub pegs: Option<PassedPegs>,
    /// Outcome of the knot; `None` without a knot.
    pub knot: Option<TiedKnot>,
}

/// Knots by their invariants.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TiedKnot {
    /// Knot of the pattern, or of both patterns; `None` if it depends on how ends are joined.
    pub pattern: Option<KnotInvariants>,
    /// Knot of the rod, or of both rods; `None` if it depends on how ends are joined.
    pub rod: Option<KnotInvariants>,
}

impl TiedKnot {
    /// Whether the knot of the pattern is tied.
    pub fn is_tied(&self) -> bool {
        self.rod.is_some() && self.rod == self.pattern
    }
}

/// Number of pegs that a rod passes on the same side as its pattern, below their tops.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PassedPegs {
    /// Number of pegs.
    pub count: usize,
    /// Number of pegs that are passed in this way.
    pub passed: usize,
}

impl PassedPegs {
    /// Whether the rod is placed: it passes all pegs in this way.
    pub fn are_all(&self) -> bool {
        self.passed == self.count
    }
}

fn tied_knot(observed: &NamedValues) -> Option<TiedKnot> {
    let invariants = |determinant: &str, signature: &str| {
        Some(KnotInvariants {
            determinant: observed.number(determinant)? as u64,
            signature: observed.number(signature)? as i64,
        })
    };
    let knot = TiedKnot {
        pattern: invariants("pattern_determinant", "pattern_signature"),
        rod: invariants("rod_determinant", "rod_signature"),
    };
    (knot.pattern.is_some() || knot.rod.is_some()).then_some(knot)
}

fn passed_pegs(observed: &NamedValues) -> Option<PassedPegs> {
    let count = |name: &str| Some(observed.number(name)? as usize);
    Some(PassedPegs {
        count: count("pegs")?,
        passed: count("pegs_passed")?,
    })
}

impl DeploymentOutcome {
    /// The outcome of a case; `None` if no rod was laid.
    pub fn of(case: &CaseOutcome) -> Option<Self> {
        let observed = &case.observed;
        Some(Self {
            mean_error_m: observed.number("mean_error_m"),
            error_deviation_m: observed.number("error_deviation_m"),
            largest_error_m: observed.number("largest_error_m"),
            largest_sliding_m: observed.number("largest_sliding_m")?,
            largest_gripper_force_n: observed.number("largest_gripper_force_n")?,
            largest_friction_demand: observed.number("largest_friction_demand")?,
            share_above_friction: observed.number("share_above_friction")?,
            pegs: passed_pegs(observed),
            knot: tied_knot(observed),
        })
    }

    /// The columns of the summary.
    pub fn values(&self) -> NamedValues {
        let Self { pegs, knot, .. } = self;
        let [pattern, rod] = [
            knot.and_then(|knot| knot.pattern),
            knot.and_then(|knot| knot.rod),
        ];
        let determinant = |knot: KnotInvariants| knot.determinant;
        // An integer, which a table may write with a sign.
        let signature = |knot: KnotInvariants| knot.signature as f64;
        NamedValues::from([
            ("mean_error_m", self.mean_error_m.into()),
            ("error_deviation_m", self.error_deviation_m.into()),
            ("largest_error_m", self.largest_error_m.into()),
            ("largest_sliding_m", self.largest_sliding_m.into()),
            (
                "largest_gripper_force_n",
                self.largest_gripper_force_n.into(),
            ),
            (
                "largest_friction_demand",
                self.largest_friction_demand.into(),
            ),
            ("share_above_friction", self.share_above_friction.into()),
            ("pegs", pegs.map(|pegs| pegs.count as u64).into()),
            ("pegs_passed", pegs.map(|pegs| pegs.passed as u64).into()),
            ("pattern_determinant", pattern.map(determinant).into()),
            ("pattern_signature", pattern.map(signature).into()),
            ("rod_determinant", rod.map(determinant).into()),
            ("rod_signature", rod.map(signature).into()),
        ])
    }

    /// Returns a warning if the table has less `friction` than the pattern demands. There is no
    /// warning with pegs, which hold the rod instead, and for knots, whose rods slide anyway.
    pub fn remark(&self, friction: f64) -> Option<String> {
        let friction_alone = self.pegs.is_none() && self.knot.is_none();
        (friction_alone && self.share_above_friction > 0.0).then(|| {
            format!(
                "{:.0} % of the pattern demands more friction than the {friction} of the table, up to {:.2}: there \
                 the rod slides out of its bends (thesis Eq. 5.2)",
                (1e2 * self.share_above_friction).max(1.0),
                self.largest_friction_demand
            )
        })
    }

    /// Main results for the user: names and texts, a line each.
    pub fn highlights(&self) -> Vec<(String, String)> {
        let mut lines = Vec::new();
        if let (Some(mean), Some(deviation)) = (self.mean_error_m, self.error_deviation_m) {
            let text = format!("{:.3} ± {:.3} cm", 1e2 * mean, 1e2 * deviation);
            lines.push(("off the pattern".to_owned(), text));
        }
        let slid = format!("{:.2} cm at most", 1e2 * self.largest_sliding_m);
        lines.push(("slid".to_owned(), slid));
        if self.share_above_friction > 0.0 && (self.pegs.is_some() || self.knot.is_some()) {
            let (share, most) = (self.share_above_friction, self.largest_friction_demand);
            let text = format!(
                "up to {most:.2}, above that of the table for {:.0} % of the pattern",
                1e2 * share
            );
            lines.push(("friction demand".to_owned(), text));
        }
        if let Some(pegs) = self.pegs {
            let verdict = if pegs.are_all() {
                "placed"
            } else {
                "not placed"
            };
            let text = format!(
                "{} of {} passed on the side of the pattern: {verdict}",
                pegs.passed, pegs.count
            );
            lines.push(("pegs".to_owned(), text));
        }
        if let Some(knot) = self.knot {
            let verdict = if knot.is_tied() {
                "as drawn"
            } else {
                "not as drawn"
            };
            let words = |knot: Option<KnotInvariants>| {
                knot.map_or("depends on how the ends are joined".to_owned(), |knot| {
                    format!(
                        "determinant {}, signature {}",
                        knot.determinant, knot.signature
                    )
                })
            };
            let text = format!(
                "{}; that of the pattern: {}: {verdict}",
                words(knot.rod),
                words(knot.pattern)
            );
            lines.push(("knot".to_owned(), text));
        }
        lines
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outcomes_are_read_back_by_their_columns() {
        let outcome = DeploymentOutcome {
            mean_error_m: Some(1e-3),
            error_deviation_m: Some(2e-3),
            largest_error_m: Some(3e-3),
            largest_sliding_m: 4e-3,
            largest_gripper_force_n: 0.5,
            largest_friction_demand: 1.5,
            share_above_friction: 0.25,
            pegs: Some(PassedPegs {
                count: 4,
                passed: 3,
            }),
            knot: Some(TiedKnot {
                pattern: Some(KnotInvariants {
                    determinant: 3,
                    signature: -2,
                }),
                rod: None,
            }),
        };
        let case = CaseOutcome {
            observed: outcome.values(),
            ..CaseOutcome::default()
        };
        assert_eq!(DeploymentOutcome::of(&case), Some(outcome));
        assert_eq!(DeploymentOutcome::of(&CaseOutcome::default()), None);
        assert_eq!(outcome.remark(0.4), None, "pegs hold it");
        let lying = DeploymentOutcome {
            pegs: None,
            knot: None,
            ..outcome
        };
        assert!(lying.remark(0.4).unwrap().contains("25 %"));
        let held = DeploymentOutcome {
            share_above_friction: 0.0,
            ..lying
        };
        assert_eq!(held.remark(0.4), None);
    }
    #[test]
    fn rods_count_by_their_lengths_and_by_the_worst_of_them() {
        let [one, other] = [(1.0, 0.2, Some(0.05), 0.3), (3.0, 0.6, None, 0.1)].map(
            |(pattern_length, share_above_friction, least_radius, largest)| DerivedDeployment {
                pattern_length,
                lead_in: 0.1 * pattern_length,
                least_radius,
                largest_friction_demand: largest,
                share_above_friction,
                largest_gripper_speed: 2.0 * largest,
            },
        );
        for rods in [[one, other], [other, one]] {
            let all = DerivedDeployment::of_all(rods.into_iter());
            // 0.2 m of one metre and 1.8 m of three.
            assert!((all.share_above_friction - 0.5).abs() < 1e-15);
            assert_eq!((all.pattern_length, all.least_radius), (4.0, Some(0.05)));
            assert!((all.lead_in - 0.4).abs() < 1e-15);
            assert_eq!(all.largest_friction_demand, 0.3);
            assert_eq!(all.largest_gripper_speed, 0.6);
        }
    }
}
