//! Monitors a knot that is pulled tight: when all has been seen, and what it came to.

use super::observer::{KnotObserver, KnotSample};
use crate::knot::{InversionWatch, TightenedKnot};
use crate::results::{KnotEnding, KnotOutcome, KnotRow, SeriesRow};
use serde::{Deserialize, Serialize};

/// Decrease of l̄_k from one sample to the next. The traction between them is a mean, so that its vibrations do not
/// count; an inversion, which takes 1 or less, is seen whatever the output interval.
const BETWEEN_SAMPLES: f64 = 0.1;
/// Decrease of l̄_k over which a knot is followed after it has inverted.
const FOLLOWED: f64 = 10.0;
/// Decrease of l̄_k between two looks at whether the rod slips.
const LOOK: f64 = 4.0;
/// Part of that distance that a rod which slips takes up by its stretch at most, and one that is locked at least.
/// At the start a rod stretches, too, until friction gives way, and again after it has slackened in an inversion: only
/// one that has slipped, and is pulled harder than ever before, can be locked.
const SLIPPING: f64 = 0.5;
const LOCKED: f64 = 0.9;

/// What a run remembers of its knot to know when all has been seen.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct KnotMonitor {
    watch: InversionWatch,
    /// End-to-end distance (m) and work of the ends (J) at the last sample.
    sample: Option<(f64, f64)>,
    /// Time of the next sample, s.
    next: f64,
    /// l̄_k and F̄ at the last look.
    look: Option<(f64, f64)>,
    slipped: bool,
    /// Largest F̄ of all looks.
    strongest: f64,
    /// Why the run is over.
    pub ending: Option<KnotEnding>,
}

impl KnotMonitor {
    /// Whether a sample at the knot is due; there is one at the start of the pull.
    pub fn is_due(&self, time: f64, observer: &KnotObserver) -> bool {
        time >= observer.pulled_from.max(self.next)
    }

    /// Takes note of what was seen of the knot at a sample, when its ends had done so much `work` (J).
    pub fn add(&mut self, time: f64, seen: &KnotSample, work: f64, observer: &KnotObserver) {
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
            self.watch_inversion(&knot, observer);
        }
        self.watch_slip(&knot, observer);
    }

    fn watch_inversion(&mut self, knot: &TightenedKnot, observer: &KnotObserver) {
        self.watch.look(knot);
        let followed = |start: f64| start - knot.length >= FOLLOWED;
        if observer.ends_after_inversion && self.watch.point().by_height.is_some_and(followed) {
            self.ending = Some(KnotEnding::Inverted);
        }
    }

    fn watch_slip(&mut self, knot: &TightenedKnot, observer: &KnotObserver) {
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

    /// What the knot came to, with the energies of the whole series.
    pub fn outcome(&self, rows: &[(SeriesRow, KnotRow)], observer: &KnotObserver) -> KnotOutcome {
        let point = self.watch.point();
        let before = |knot: &KnotRow| point.is_ahead_of(knot.length_normalized);
        let slow: Vec<&(SeriesRow, KnotRow)> = rows
            .iter()
            .filter(|(series, knot)| series.time_s > observer.pulled_from && before(knot))
            .collect();
        let kinetic_over_elastic = slow
            .iter()
            .map(|(series, _)| series.kinetic_energy_j / series.elastic_energy())
            .max_by(f64::total_cmp);
        let last = rows.last().map(|(_, knot)| knot);
        KnotOutcome {
            may_invert: observer.may_invert,
            inversion_by_force: point.by_force,
            inversion_by_height: point.by_height,
            inversion_difference: point.difference(),
            kinetic_over_elastic,
            kinetic_bound: Some(observer.kinetic_bound),
            energy_balance: energy_balance(&slow),
            knot_ending: self.ending,
            length_normalized: last.map(|knot| knot.length_normalized),
            traction_n: last.map(|knot| knot.force_normalized / observer.force_unit()),
        }
    }
}

/// Gain of energy and losses over the work of the ends between the first and the last row; `None` without work.
fn energy_balance(rows: &[&(SeriesRow, KnotRow)]) -> Option<f64> {
    let (first, last) = (rows.first()?, rows.last()?);
    let spent = |(series, knot): &(SeriesRow, KnotRow)| {
        series.energy() + knot.friction_loss_j + knot.drag_loss_j
    };
    let work = last.1.work_of_ends_j - first.1.work_of_ends_j;
    (work > 0.0).then(|| (spent(last) - spent(first)) / work)
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

    /// A record in which the knot is pulled from a distance of 0.8 m in steps of 0.1 mm, up to 100 mm, with a traction
    /// (N) and a height of the loop (m) that depend on how far (m); and how far it had been when it was over.
    fn pull(
        observer: &KnotObserver,
        traction: impl Fn(f64) -> f64,
        height: impl Fn(f64) -> f64,
    ) -> (KnotMonitor, Option<f64>) {
        let (mut monitor, mut work, mut over) = (KnotMonitor::default(), 0.0, None);
        for k in 0..1000 {
            let pulled = 1e-4 * f64::from(k);
            work += 1e-4 * traction(pulled);
            let seen = KnotSample {
                end_to_end: 0.8 + pulled,
                loop_height: Some(height(pulled)),
            };
            monitor.add(0.1 * f64::from(k), &seen, work, observer);
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
        let outcome = pull(&trefoil, |_| 0.01, collapsing)
            .0
            .outcome(&[], &trefoil);
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
        // It slips at 1 N, loses half of that as the knot inverts after 50 mm, and stretches until it slips again.
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
        let (monitor, _) = pull(&OBSERVER, traction, collapsing);
        let rows: Vec<(SeriesRow, KnotRow)> = (0..100)
            .map(|k| {
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
                (series, knot)
            })
            .collect();
        let outcome = monitor.outcome(&rows, &OBSERVER);
        assert!((outcome.inversion_by_force.unwrap() - 150.0).abs() < 0.15);
        assert!((outcome.inversion_by_height.unwrap() - 150.0).abs() < 0.15);
        assert_eq!(outcome.kinetic_over_elastic, Some(1e-4));
        assert_eq!(outcome.length_normalized, Some(101.0));
        assert!((outcome.traction_n.unwrap() - 0.01).abs() < 1e-15);
    }
}
