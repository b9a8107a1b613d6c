//! Monitors a knot that is pulled tight, to end the run and record the outcome.

use super::observer::{KnotObserver, KnotSample, changed_knot};
use super::{KnotEnding, KnotOutcome, KnotRow};
use crate::run::{Finding, Observer, Sample};
use rodlab_files::results::{CaseOutcome, NamedValues, SeriesRow, Value};
use rodlab_planning::knot::{InversionWatch, TightenedKnot};
use serde::{Deserialize, Serialize};

/// Decrease of l̄_k between two samples. The traction between samples is a mean, so that
/// vibrations cancel. An inversion, which takes 1 or less, is detected with any output interval.
const BETWEEN_SAMPLES: f64 = 0.1;
/// Decrease of l̄_k for which a knot is followed after its inversion.
const FOLLOWED: f64 = 10.0;
/// Decrease of l̄_k between two checks of whether the rod slips.
const LOOK: f64 = 4.0;
/// Fraction of that distance that is taken up by stretching: the maximum for a rod that slips, and
/// the minimum for one that is locked. A rod also stretches at the start until friction gives way,
/// and again after it has slackened in an inversion. Therefore a rod counts as locked only if it
/// has slipped before and is pulled harder than ever.
const SLIPPING: f64 = 0.5;
const LOCKED: f64 = 0.9;

/// Monitors a knot that is pulled tight, to end the run and record the outcome.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct KnotMonitor {
    /// Observer of the knot.
    pub observer: KnotObserver,
    watch: InversionWatch,
    /// End-to-end distance (m) and work of the ends (J) at the last sample.
    sample: Option<(f64, f64)>,
    /// Time of the next sample, s.
    next: f64,
    /// l̄_k and F̄ at the last check.
    look: Option<(f64, f64)>,
    slipped: bool,
    /// Largest F̄ of all checks.
    strongest: f64,
    /// Why the run is over.
    ending: Option<KnotEnding>,
    /// The outputs while the ends moved.
    pulled: Vec<PulledOutput>,
    /// l̄_k and F̄ at the last output.
    last: Option<(f64, f64)>,
}

/// Record of an output while the ends move.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct PulledOutput {
    /// l̄_k.
    length: f64,
    kinetic_over_elastic: f64,
    /// Energy and losses, J.
    spent: f64,
    /// Work of the ends since the start, J.
    work: f64,
}

impl Observer for KnotMonitor {
    fn name(&self) -> &str {
        "knot"
    }

    fn columns(&self) -> Vec<String> {
        let cells = KnotRow::default().cells();
        cells.map(|(name, _)| name.to_owned()).into()
    }

    /// There is a sample at the start of the pull.
    fn is_due(&self, time: f64) -> bool {
        time >= self.observer.pulled_from.max(self.next)
    }

    fn sample(&mut self, sample: &Sample<'_>) -> Finding {
        let seen = self.observer.sample(sample.simulation);
        self.add(sample.time(), &seen, sample.exchange.clamp_work);
        match self.ending {
            Some(ending) => Finding::End(ending.into()),
            None => Finding::GoOn,
        }
    }

    fn measure(&mut self, sample: &Sample<'_>, row: &SeriesRow) -> (Vec<Value>, Finding) {
        let knot = KnotRow {
            work_of_ends_j: sample.exchange.clamp_work,
            friction_loss_j: sample.exchange.friction_loss,
            drag_loss_j: sample.exchange.drag_loss,
            ..self.observer.measure(sample.simulation)
        };
        self.note(row, &knot);
        let finding = if self.observer.recognises(&knot) {
            Finding::GoOn
        } else {
            let expected = self.observer.determinant;
            Finding::Fail(changed_knot(row.time_s, expected, knot.knot_determinant))
        };
        (knot.cells().map(|(_, value)| value).into(), finding)
    }

    fn outcomes(&self) -> NamedValues {
        self.outcome().values()
    }

    fn remarks(&self) -> Vec<String> {
        let remarks = [self.outcome().remark(), self.watch.remark()];
        remarks.into_iter().flatten().collect()
    }

    fn highlights(&self, outcome: &CaseOutcome) -> Vec<(String, String)> {
        KnotOutcome::of(outcome).map_or_else(Vec::new, |knot| knot.highlights())
    }
}

impl KnotMonitor {
    /// A monitor of a knot before the pull.
    pub fn new(observer: KnotObserver) -> Self {
        Self {
            observer,
            watch: InversionWatch::default(),
            sample: None,
            next: 0.0,
            look: None,
            slipped: false,
            strongest: 0.0,
            ending: None,
            pulled: Vec::new(),
            last: None,
        }
    }

    /// Records the observation of the knot at a sample, when the ends have done the `work` (J).
    fn add(&mut self, time: f64, seen: &KnotSample, work: f64) {
        let observer = self.observer;
        self.next = time + 0.5 * BETWEEN_SAMPLES * observer.radius / observer.pull_speed;
        let now = (seen.end_to_end, work);
        let Some((distance, earlier)) = self.sample.replace(now) else {
            return;
        };
        let pulled = (now.0 - distance) * observer.rods as f64;
        if pulled <= 0.0 {
            return;
        }
        let knot = TightenedKnot {
            length: (observer.length - seen.end_to_end) / observer.radius,
            force: (work - earlier) / pulled * observer.force_unit(),
            height: seen.loop_height.map(|height| height / observer.radius),
        };
        if observer.may_invert {
            self.watch_inversion(&knot);
        }
        self.watch_slip(&knot);
    }

    fn watch_inversion(&mut self, knot: &TightenedKnot) {
        self.watch.look(knot);
        let followed = |start: f64| start - knot.length >= FOLLOWED;
        if self.observer.ends_after_inversion && self.watch.point().by_height.is_some_and(followed)
        {
            self.ending = Some(KnotEnding::Inverted);
        }
    }

    fn watch_slip(&mut self, knot: &TightenedKnot) {
        let observer = self.observer;
        let now = (knot.length, knot.force);
        let &mut (length, force) = self.look.get_or_insert(now);
        let pulled = (length - now.0) * observer.radius;
        if pulled >= LOOK * observer.radius {
            let traction = (now.1 - force) / observer.force_unit();
            let stretch = traction / observer.stretching_stiffness * observer.length;
            if self.slipped && force >= self.strongest && stretch > LOCKED * pulled {
                self.ending = Some(KnotEnding::Locked);
            }
            self.slipped |= stretch < SLIPPING * pulled;
            self.strongest = self.strongest.max(now.1);
            self.look = Some(now);
        }
    }

    /// Records the data of an output for the outcome.
    fn note(&mut self, row: &SeriesRow, knot: &KnotRow) {
        self.last = Some((knot.length_normalized, knot.force_normalized));
        if row.time_s > self.observer.pulled_from {
            self.pulled.push(PulledOutput {
                length: knot.length_normalized,
                kinetic_over_elastic: row.kinetic_energy_j / row.elastic_energy(),
                spent: row.energy() + knot.friction_loss_j + knot.drag_loss_j,
                work: knot.work_of_ends_j,
            });
        }
    }

    /// Outcome of the knot so far.
    pub fn outcome(&self) -> KnotOutcome {
        let observer = &self.observer;
        let point = self.watch.point();
        let before = |output: &&PulledOutput| point.is_ahead_of(output.length);
        let slow: Vec<&PulledOutput> = self.pulled.iter().filter(before).collect();
        let ratios = slow.iter().map(|output| output.kinetic_over_elastic);
        KnotOutcome {
            may_invert: observer.may_invert,
            inversion_by_force: point.by_force,
            inversion_by_height: point.by_height,
            inversion_difference: point.difference(),
            kinetic_over_elastic: ratios.max_by(f64::total_cmp),
            kinetic_bound: Some(observer.kinetic_bound),
            energy_balance: energy_balance(&slow),
            knot_ending: self.ending,
            length_normalized: self.last.map(|(length, _)| length),
            traction_n: self.last.map(|(_, force)| force / observer.force_unit()),
        }
    }
}

/// Gain of energy and losses, over the work of the ends, between the first and the last output;
/// `None` without work.
fn energy_balance(outputs: &[&PulledOutput]) -> Option<f64> {
    let (first, last) = (outputs.first()?, outputs.last()?);
    let work = last.work - first.work;
    (work > 0.0).then(|| (last.spent - first.spent) / work)
}

#[cfg(test)]
mod tests {
    use super::*;

    const OBSERVER: KnotObserver = KnotObserver {
        rods: 1,
        nodes: 101,
        has_braid: true,
        radius: 1e-3,
        bending_stiffness: 1e-6,
        stretching_stiffness: 4.0,
        length: 1.0,
        tolerance: 1e-4,
        determinant: 7,
        pulled_from: 2.0,
        pull_speed: 5e-4,
        kinetic_bound: 1e-3,
        may_invert: true,
        ends_after_inversion: true,
    };

    /// The monitor of a knot that is pulled from a distance of 0.8 m in steps of 0.1 mm, up to 100
    /// mm. The traction (N) and the height of the loop (m) depend on the pulled distance (m). Also
    /// returns the pulled distance at the end of the run.
    fn pull(
        observer: &KnotObserver,
        traction: impl Fn(f64) -> f64,
        height: impl Fn(f64) -> f64,
    ) -> (KnotMonitor, Option<f64>) {
        let (mut monitor, mut work, mut over) = (KnotMonitor::new(*observer), 0.0, None);
        for k in 0..1000 {
            let pulled = 1e-4 * f64::from(k);
            work += 1e-4 * traction(pulled);
            let seen = KnotSample {
                end_to_end: 0.8 + pulled,
                loop_height: Some(height(pulled)),
            };
            monitor.add(0.1 * f64::from(k), &seen, work);
            if monitor.ending.is_some() {
                over.get_or_insert(pulled);
            }
        }
        (monitor, over)
    }

    fn collapsing(pulled: f64) -> f64 {
        if pulled < 0.05 { 2e-2 } else { 1e-4 }
    }

    #[test]
    fn an_inverted_knot_is_followed_for_ten_radii() {
        let (monitor, over) = pull(&OBSERVER, |_| 0.01, collapsing);
        assert_eq!(monitor.ending, Some(KnotEnding::Inverted));
        assert!((over.unwrap() - 0.06).abs() < 1.5e-4, "{over:?}");
        let tightened = KnotObserver {
            ends_after_inversion: false,
            ..OBSERVER
        };
        assert_eq!(pull(&tightened, |_| 0.01, collapsing).1, None);
    }

    #[test]
    fn a_knot_that_cannot_invert_is_not_watched() {
        let trefoil = KnotObserver {
            may_invert: false,
            ..OBSERVER
        };
        let outcome = pull(&trefoil, |_| 0.01, collapsing).0.outcome();
        assert_eq!(outcome.inversion_by_height, None);
    }

    #[test]
    fn a_rod_that_has_slipped_and_stretches_is_locked() {
        // Friction gives way after 20 mm, the knot locks after 60 mm.
        let stretch = |pulled: f64| pulled.min(0.02) + (pulled - 0.06).max(0.0);
        let (monitor, over) = pull(&OBSERVER, |pulled| 4.0 * stretch(pulled), |_| 2e-2);
        assert_eq!(monitor.ending, Some(KnotEnding::Locked));
        assert!((0.06..0.07).contains(&over.unwrap()), "{over:?}");
    }

    #[test]
    fn a_rod_that_stretches_after_its_inversion_is_not_locked() {
        // It slips at 1 N, loses half of this traction as the knot inverts after 50 mm, and
        // stretches until it slips again.
        let traction = |pulled: f64| {
            if pulled < 0.05 {
                1.0
            } else {
                (0.5 + 4.0 * (pulled - 0.05)).min(1.0)
            }
        };
        let (monitor, _) = pull(&OBSERVER, traction, collapsing);
        assert_eq!(monitor.ending, Some(KnotEnding::Inverted));
    }

    #[test]
    fn the_outcome_leaves_out_what_was_before_the_pull_and_after_the_inversion() {
        let traction = |pulled: f64| if pulled < 0.05 { 0.02 } else { 0.01 };
        let (mut monitor, _) = pull(&OBSERVER, traction, collapsing);
        for k in 0..100 {
            let series = SeriesRow {
                time_s: f64::from(k),
                kinetic_energy_j: if (3..50).contains(&k) { 1e-4 } else { 1.0 },
                bending_energy_j: 1.0,
                ..SeriesRow::default()
            };
            let knot = KnotRow {
                length_normalized: 200.0 - f64::from(k),
                force_normalized: 0.01,
                ..KnotRow::default()
            };
            monitor.note(&series, &knot);
        }
        let outcome = monitor.outcome();
        assert!((outcome.inversion_by_force.unwrap() - 150.0).abs() < 0.15);
        assert!((outcome.inversion_by_height.unwrap() - 150.0).abs() < 0.15);
        assert_eq!(outcome.kinetic_over_elastic, Some(1e-4));
        assert_eq!(outcome.length_normalized, Some(101.0));
        assert!((outcome.traction_n.unwrap() - 0.01).abs() < 1e-15);
    }
}
