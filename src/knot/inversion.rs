//! Where an overhand knot inverts while it is pulled tight (thesis 3.4): its loop snaps onto the braid.

use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// A knot at one time while it is pulled tight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TightenedKnot {
    /// l̄_k = (L − l_c)/h, the shortening over the radius of the rod (thesis Eq. 3.4).
    pub length: f64,
    /// F̄ = F h²/EI.
    pub force: f64,
    /// Clear height H of the loop over the radius of the rod; `None` where it cannot be told.
    pub height: Option<f64>,
}

/// The inversion point by both measures of the thesis, as l̄_k.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct InversionPoint {
    /// Where the traction begins to fall; `None` where it does not.
    pub by_force: Option<f64>,
    /// Where the height of the loop has come to zero; `None` where it has not.
    pub by_height: Option<f64>,
}

/// Height of the loop, in radii of the rod, below which it lies on the braid (the bent loop may touch beside its middle)
/// and above which it stands: four radii and more just before it snaps, depending on the unknotting number.
const LYING: f64 = 1.0;
const UPRIGHT: f64 = 3.0;
/// Decrease of l̄_k within which an inverting loop falls. That of a trefoil, which closes and does not invert, takes 10.
const FALLING: f64 = 3.0;
/// Decrease of l̄_k within which the traction falls in an inversion. In the same distance the corners of the polyline,
/// slipping over each other, move it by less than [`FALL`].
const DURING: f64 = 1.0;
/// Least part of its traction that an inverting knot loses.
const FALL: f64 = 0.3;
/// Part of the steepest fall at which another that begins later is as good: vibrations before the fall do not decide
/// where it begins.
const NEARLY: f64 = 0.95;

/// Watches a knot while it is pulled tight, and finds where it inverts.
///
/// By force that is the start of the steepest fall of F̄: where F̄ loses the largest part of itself while l̄_k decreases
/// by 1, if that is 0.3 and more; the last such place where several are nearly as good.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct InversionWatch {
    /// l̄_k when the loop was last seen to stand.
    upright: Option<f64>,
    /// l̄_k and F̄ while l̄_k last decreased by [`DURING`].
    recent: VecDeque<(f64, f64)>,
    /// Largest part of itself that F̄ has lost; 0 as long as that is less than [`FALL`].
    steepest: f64,
    point: InversionPoint,
}

impl InversionWatch {
    /// Looks at the knot, whose l̄_k never increases.
    pub fn look(&mut self, knot: &TightenedKnot) {
        self.watch_height(knot);
        self.watch_force(knot);
    }

    /// The inversion point as far as it has been seen.
    pub fn point(&self) -> InversionPoint {
        self.point
    }

    fn watch_height(&mut self, knot: &TightenedKnot) {
        let Some(height) = knot.height else { return };
        if height > UPRIGHT {
            self.upright = Some(knot.length);
        }
        let upright_before = |length: f64| length - knot.length <= FALLING;
        if height < LYING && self.upright.is_some_and(upright_before) {
            self.point.by_height.get_or_insert(knot.length);
        }
    }

    fn watch_force(&mut self, knot: &TightenedKnot) {
        while (self.recent.front()).is_some_and(|(length, _)| length - knot.length > DURING) {
            self.recent.pop_front();
        }
        let fall = |&(_, force): &(f64, f64)| {
            if force > 0.0 {
                1.0 - knot.force / force
            } else {
                0.0
            }
        };
        let steepest = self.recent.iter().map(fall).fold(0.0, f64::max);
        if steepest > self.steepest.max(FALL) {
            self.steepest = steepest;
            let is_start = |seen: &&(f64, f64)| fall(seen) >= NEARLY * steepest;
            let start = self.recent.iter().rev().find(is_start);
            self.point.by_force = start.map(|(length, _)| *length);
        }
        self.recent.push_back((knot.length, knot.force));
    }
}

impl InversionPoint {
    /// Whether a knot at this l̄_k does not invert yet: it is 1 before both measures, since an inversion takes no more.
    pub fn is_ahead_of(&self, length: f64) -> bool {
        let mut measures = [self.by_force, self.by_height].into_iter().flatten();
        measures.all(|point| length >= point + DURING)
    }

    /// Difference of the two measures over their mean; `None` where one is missing.
    pub fn difference(&self) -> Option<f64> {
        let (force, height) = (self.by_force?, self.by_height?);
        Some((force - height).abs() / (0.5 * (force + height)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A traction as 1/l̄_k² that falls by `fall` of itself within 0.5 at l̄_k = 150, and a loop that then falls.
    fn pull_record(fall: f64) -> Vec<TightenedKnot> {
        (0..400)
            .map(|k| 200.0 - 0.25 * f64::from(k))
            .map(|length| {
                let fallen = ((150.0 - length) / 0.5).clamp(0.0, 1.0);
                TightenedKnot {
                    length,
                    force: (1.0 - fall * fallen) / (length * length),
                    height: Some(15.0 * (1.0 - fallen)),
                }
            })
            .collect()
    }

    fn inversion_point(record: &[TightenedKnot]) -> InversionPoint {
        let mut watch = InversionWatch::default();
        for knot in record {
            watch.look(knot);
        }
        watch.point()
    }

    #[test]
    fn a_fall_of_traction_and_the_loop_on_the_braid_are_found() {
        let point = inversion_point(&pull_record(0.5));
        assert_eq!(point.by_force, Some(150.0));
        assert_eq!(point.by_height, Some(149.5));
        assert!((point.difference().unwrap() - 0.5 / 149.75).abs() < 1e-15);
    }

    #[test]
    fn a_loop_that_closes_slowly_has_not_inverted() {
        let closing: Vec<TightenedKnot> = (0..200)
            .map(|k| 40.0 - 0.2 * f64::from(k))
            .map(|length| TightenedKnot {
                length,
                force: 1.0,
                height: Some(0.1 * length),
            })
            .collect();
        assert_eq!(inversion_point(&closing), InversionPoint::default());
    }

    #[test]
    fn fluctuations_and_slow_changes_are_no_inversion() {
        let point = inversion_point(&pull_record(0.2));
        assert_eq!((point.by_force, point.difference()), (None, None));
        let slackening: Vec<TightenedKnot> = pull_record(0.0)
            .into_iter()
            .map(|knot| TightenedKnot {
                force: knot.length.powi(4),
                height: None,
                ..knot
            })
            .collect();
        assert_eq!(inversion_point(&slackening), InversionPoint::default());
    }
}
