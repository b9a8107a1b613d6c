//! The course of a knot that is pulled tight: when all has been seen, and what it came to.

use super::KnotObserver;
use crate::knot::{InversionPoint, LoopWatch, TightenedKnot, inversion_point};
use crate::results::{KnotEnding, KnotOutcome, KnotRow, SeriesRow};
use serde::{Deserialize, Serialize};

/// Decrease of l̄_k over which a knot is followed after it has inverted.
const FOLLOWED: f64 = 10.0;
/// Distance by which the ends are pulled between two looks at whether the rod slips, in radii.
const LOOK: f64 = 4.0;
/// Part of that distance that a rod which slips takes up by its stretch at most, and one that is locked at least.
/// At the start a rod stretches, too, until friction gives way: only one that has slipped can be locked.
const SLIPPING: f64 = 0.5;
const LOCKED: f64 = 0.9;

/// What a run remembers of its knot to know when all has been seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct KnotCourse {
    watch: LoopWatch,
    /// l̄_k when the knot had inverted.
    inverted: Option<f64>,
    /// End-to-end distance (m) and mean traction (N) at the last look.
    look: Option<(f64, f64)>,
    slipped: bool,
    /// Why the run is over.
    pub ending: Option<KnotEnding>,
}

impl KnotCourse {
    /// Takes note of the knot at an output time while its ends move.
    pub fn add(&mut self, row: &KnotRow, observer: &KnotObserver) {
        if self.watch.sees_inversion(&tightened(row, observer)) {
            self.inverted.get_or_insert(row.length_normalized);
        }
        let followed = |start: f64| start - row.length_normalized >= FOLLOWED;
        if observer.ends_after_inversion && self.inverted.is_some_and(followed) {
            self.ending = Some(KnotEnding::Inverted);
        }
        let unit = observer.bending_stiffness / observer.radius.powi(2);
        let now = (row.end_to_end_m, row.force_normalized * unit);
        let &mut (distance, traction) = self.look.get_or_insert(now);
        let pulled = now.0 - distance;
        if pulled >= LOOK * observer.radius {
            let stretch = (now.1 - traction) / observer.stretching_stiffness * observer.length;
            if self.slipped && stretch > LOCKED * pulled {
                self.ending = Some(KnotEnding::Locked);
            }
            self.slipped |= stretch < SLIPPING * pulled;
            self.look = Some(now);
        }
    }

    /// What the knot came to, from the whole series.
    pub fn outcome(&self, rows: &[(SeriesRow, KnotRow)], observer: &KnotObserver) -> KnotOutcome {
        let pulled = || {
            rows.iter()
                .filter(|(series, _)| series.time_s > observer.pulled_from)
        };
        let course: Vec<TightenedKnot> = pulled()
            .map(|(_, knot)| tightened(knot, observer))
            .collect();
        let point = if observer.has_braid {
            inversion_point(&course)
        } else {
            InversionPoint::default()
        };
        let before = |knot: &KnotRow| {
            [point.by_force, point.by_height]
                .into_iter()
                .flatten()
                .all(|length| knot.length_normalized > length)
        };
        let slow: Vec<&(SeriesRow, KnotRow)> = pulled().filter(|(_, knot)| before(knot)).collect();
        let kinetic_over_elastic = slow
            .iter()
            .map(|(series, _)| series.kinetic_energy_j / series.elastic_energy())
            .max_by(f64::total_cmp);
        KnotOutcome {
            inversion_by_force: point.by_force,
            inversion_by_height: point.by_height,
            inversion_difference: point.difference(),
            kinetic_over_elastic,
            kinetic_bound: Some(observer.kinetic_bound),
            energy_balance: energy_balance(&slow),
            knot_ending: self.ending,
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

fn tightened(row: &KnotRow, observer: &KnotObserver) -> TightenedKnot {
    TightenedKnot {
        length: row.length_normalized,
        force: row.force_normalized,
        height: row.loop_height_m.map(|height| height / observer.radius),
    }
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
        kinetic_bound: 1e-3,
        ends_after_inversion: true,
    };

    /// Pulled by `pulled` (m) from a distance of 0.8 m, with a traction and a height of the loop.
    fn row(pulled: f64, traction: f64, height: f64) -> KnotRow {
        KnotRow {
            end_to_end_m: 0.8 + pulled,
            length_normalized: (0.2 - pulled) / 1e-3,
            traction_start_n: traction,
            traction_end_n: traction,
            force_normalized: traction,
            loop_height_m: Some(height),
            ..KnotRow::default()
        }
    }

    #[test]
    fn an_inverted_knot_is_followed_for_ten_radii() {
        let mut course = KnotCourse::default();
        let mut tightening = KnotCourse::default();
        let tightened = KnotObserver {
            ends_after_inversion: false,
            ..OBSERVER
        };
        for k in 0..100 {
            let pulled = 1e-3 * f64::from(k);
            let height = if k < 50 { 2e-2 } else { 1e-4 };
            course.add(&row(pulled, 0.01, height), &OBSERVER);
            tightening.add(&row(pulled, 0.01, height), &tightened);
            assert_eq!(course.ending.is_some(), k >= 60, "{k}");
        }
        assert_eq!(course.ending, Some(KnotEnding::Inverted));
        assert_eq!(tightening.ending, None);
    }

    #[test]
    fn a_rod_that_has_slipped_and_stretches_is_locked() {
        let mut course = KnotCourse::default();
        // Friction gives way after 20 mm, the knot locks after 60 mm.
        for k in 0..100 {
            let pulled = 1e-3 * f64::from(k);
            let stretch = pulled.min(0.02) + (pulled - 0.06).max(0.0);
            course.add(&row(pulled, 4.0 * stretch, 2e-2), &OBSERVER);
            assert!(k >= 60 || course.ending.is_none(), "{k}");
        }
        assert_eq!(course.ending, Some(KnotEnding::Locked));
    }

    #[test]
    fn the_outcome_leaves_out_what_was_before_the_pull_and_after_the_inversion() {
        let rows: Vec<(SeriesRow, KnotRow)> = (0..100)
            .map(|k| {
                let series = SeriesRow {
                    time_s: f64::from(k),
                    kinetic_energy_j: if (3..50).contains(&k) { 1e-4 } else { 1.0 },
                    bending_energy_j: 1.0,
                    ..SeriesRow::default()
                };
                let (traction, height) = if k < 50 { (0.02, 2e-2) } else { (0.01, 0.0) };
                (series, row(1e-3 * f64::from(k), traction, height))
            })
            .collect();
        let outcome = KnotCourse::default().outcome(&rows, &OBSERVER);
        assert!((outcome.inversion_by_force.unwrap() - 151.0).abs() < 1e-9);
        assert!((outcome.inversion_by_height.unwrap() - 150.0).abs() < 1e-9);
        assert_eq!(outcome.kinetic_over_elastic, Some(1e-4));
    }
}
