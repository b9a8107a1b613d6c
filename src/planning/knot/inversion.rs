//! Inversion of an overhand knot while it is pulled tight (thesis 3.4): its loop snaps onto the
//! braid.

use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// A knot at one time while it is pulled tight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TightenedKnot {
    /// l̄_k = (L − l_c)/h, the shortening over the radius of the rod (thesis Eq. 3.4).
    pub length: f64,
    /// F̄ = F h²/EI.
    pub force: f64,
    /// Clear height H of the loop over the radius of the rod; `None` if it cannot be determined.
    pub height: Option<f64>,
}

/// The inversion point by both measures of the thesis, as l̄_k.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct InversionPoint {
    /// Start of the fall of the traction while the loop falls; `None` if there is none.
    pub by_force: Option<f64>,
    /// Point at which the height of the loop reaches zero; `None` if it does not.
    pub by_height: Option<f64>,
}

/// Height of the loop, in radii of the rod, below which it counts as lying on the braid (the bent
/// loop may touch beside its middle), and above which it counts as upright. Just before it snaps
/// its height is at least four radii, depending on the unknotting number.
const LYING: f64 = 1.0;
const UPRIGHT: f64 = 3.0;
/// Decrease of l̄_k within which an inverting loop falls. The loop of a trefoil, which closes
/// without inverting, takes 10.
const FALLING: f64 = 3.0;
/// Decrease of l̄_k within which the traction falls in an inversion, and largest delay of the
/// start of this fall after the loop has fallen. Over the same decrease, slipping corners of the
/// polyline change the traction by less than [`FALL`].
const DURING: f64 = 1.0;
/// Decrease of l̄_k over which tractions are stored, back to a fall before the loop was last
/// upright.
const REMEMBERED: f64 = 2.0 * FALLING + DURING;
/// Smallest relative loss of traction of an inverting knot.
const FALL: f64 = 0.3;
/// Fraction of the steepest fall from which a later fall is preferred, so that vibrations before
/// the fall do not determine its start.
const NEARLY: f64 = 0.95;

/// Observes a knot while it is pulled tight, and finds its inversion.
///
/// The point by height is where the loop reaches the braid, if it was upright within the last 3 of
/// l̄_k. The point by force is the start of the steepest fall of F̄ while the loop falls: the
/// largest relative decrease of F̄ while l̄_k decreases by 1, if it is at least 0.3. Of several
/// similar points the last one is used.
///
/// Tractions also fall steeply elsewhere: at the start of a pull from a loose knot, when the
/// friction of the settled strands gives way, and when the corners of a tight knot jerk. The loop
/// distinguishes these cases, so an inversion by force counts only together with one by height.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct InversionWatch {
    /// l̄_k when the loop was last upright.
    upright: Option<f64>,
    /// History of l̄_k and F̄ over the last decrease of l̄_k by [`REMEMBERED`].
    recent: VecDeque<(f64, f64)>,
    /// Largest and smallest l̄_k at which a fall of the traction may begin: near the fall of the
    /// loop.
    falling: Option<[f64; 2]>,
    /// Largest relative decrease of F̄ in this range.
    steepest: f64,
    point: InversionPoint,
}

impl InversionWatch {
    /// Records a state of the knot, whose l̄_k never increases.
    pub fn look(&mut self, knot: &TightenedKnot) {
        self.remember(knot);
        match self.falling {
            None => {
                self.watch_height(knot);
                for end in 0..self.recent.len() {
                    self.watch_force(end);
                }
            }
            Some([_, least]) if knot.length >= least - DURING => {
                self.watch_force(self.recent.len() - 1);
            }
            Some(_) => {}
        }
    }

    /// The inversion point observed so far.
    pub fn point(&self) -> InversionPoint {
        self.point
    }

    /// Reason why there is an inversion point by height but none by force, as a sentence.
    pub fn remark(&self) -> Option<String> {
        let height = self.point.by_height?;
        self.point.by_force.is_none().then(|| {
            format!(
                "no inversion point by force: while the loop fell, at l̄_k = {height:.2}, the \
                 traction fell by {:.0} %, less than the {:.0} % of an inversion",
                100.0 * self.steepest,
                100.0 * FALL
            )
        })
    }

    fn remember(&mut self, knot: &TightenedKnot) {
        while (self.recent.front()).is_some_and(|(length, _)| length - knot.length > REMEMBERED) {
            self.recent.pop_front();
        }
        self.recent.push_back((knot.length, knot.force));
    }

    fn watch_height(&mut self, knot: &TightenedKnot) {
        let Some(height) = knot.height else { return };
        if height > UPRIGHT {
            self.upright = Some(knot.length);
        }
        let Some(upright) = self.upright else { return };
        if height < LYING && upright - knot.length <= FALLING {
            self.point.by_height = Some(knot.length);
            self.falling = Some([upright + FALLING, knot.length - DURING]);
        }
    }

    /// Evaluates the falls of the traction that end at the sample `end` of the recent ones.
    fn watch_force(&mut self, end: usize) {
        let Some([greatest, least]) = self.falling else {
            return;
        };
        let (length, force) = self.recent[end];
        let starts = self.recent.range(..end).filter(|&&(start, from)| {
            start - length <= DURING && (least..=greatest).contains(&start) && from > 0.0
        });
        let falls = starts.map(|&(start, from)| (start, 1.0 - force / from));
        let steepest = falls.clone().map(|(_, fall)| fall).fold(0.0, f64::max);
        if steepest <= self.steepest {
            return;
        }
        self.steepest = steepest;
        if steepest > FALL {
            let mut latest = falls.rev();
            let start = latest.find(|(_, fall)| *fall >= NEARLY * steepest);
            self.point.by_force = start.map(|(start, _)| start);
        }
    }
}

impl InversionPoint {
    /// Whether a knot at this l̄_k is not inverting yet: l̄_k must be 1 ahead of both measures,
    /// since an inversion is not longer than that.
    pub fn is_ahead_of(&self, length: f64) -> bool {
        let mut measures = [self.by_force, self.by_height].into_iter().flatten();
        measures.all(|point| length >= point + DURING)
    }

    /// Difference of the two measures over their mean; `None` if one is missing.
    pub fn difference(&self) -> Option<f64> {
        let (force, height) = (self.by_force?, self.by_height?);
        Some((force - height).abs() / (0.5 * (force + height)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A traction proportional to 1/l̄_k², which falls by the fraction `fall` within 0.5 at l̄_k =
    /// 150, and a loop that then falls.
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

    /// The friction of the settled strands, which gives way at the start of a pull from a loose
    /// knot, and a jerk of the tight knot long after its inversion.
    #[test]
    fn inversion_by_force_ignores_initial_transients_and_later_jerks() {
        let mut record = pull_record(0.5);
        for knot in &mut record {
            knot.force *= match knot.length {
                199.0.. => 8.0,
                ..=119.0 => 0.2,
                _ => 1.0,
            };
        }
        let point = inversion_point(&record);
        assert_eq!(
            (point.by_force, point.by_height),
            (Some(150.0), Some(149.5))
        );
        let mut loose = record.clone();
        loose.truncate(150);
        assert_eq!(inversion_point(&loose), InversionPoint::default());
    }

    #[test]
    fn an_inversion_by_height_alone_has_a_reason() {
        let mut watch = InversionWatch::default();
        for knot in pull_record(0.5) {
            let force = 1.0 / (knot.length * knot.length);
            watch.look(&TightenedKnot { force, ..knot });
        }
        assert_eq!(
            (watch.point().by_force, watch.point().by_height),
            (None, Some(149.5))
        );
        let remark = watch.remark().unwrap();
        assert!(
            remark.contains("149.50") && remark.contains("30 %"),
            "{remark}"
        );
        assert_eq!(InversionWatch::default().remark(), None);
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
    fn fluctuations_and_slow_changes_are_not_inversions() {
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
