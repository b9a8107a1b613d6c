//! Safety limits of the hands: a box that they must not leave, and a greatest speed. Signals that
//! end motions.

use super::signal_rule::SignalRule;
use nalgebra::Vector3;

/// Fraction of the greatest speed that planned motions use.
const PLANNED: f64 = 0.8;

/// Limits of the hands of all arms, and signals.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Safety {
    /// Corners of the box with the lower and the upper coordinates, m, in the frame of the cell.
    pub workspace: Option<[[f64; 3]; 2]>,
    /// Greatest speed, m/s.
    pub hand_speed: Option<f64>,
    /// Speed, relative to the planned one, of a motion that has not been carried out yet.
    pub first_run: Option<f64>,
    /// Topics that are watched.
    pub signals: Vec<SignalRule>,
}

impl Safety {
    /// Whether hands have limits.
    pub(super) fn limits_hands(&self) -> bool {
        self.workspace.is_some() || self.hand_speed.is_some()
    }

    /// The speed, m/s, with which a motion is planned if it should have a `speed`.
    pub(super) fn planned(&self, speed: f64) -> f64 {
        self.hand_speed
            .map_or(speed, |most| speed.min(PLANNED * most))
    }

    /// Whether a hand is farther than a distance, m, outside the box; the message names the place.
    pub(super) fn outside(&self, hand: &Vector3<f64>, distance: f64) -> Option<String> {
        let [lower, upper] = self.workspace?;
        let is_inside = (0..3)
            .all(|axis| (lower[axis] - distance..=upper[axis] + distance).contains(&hand[axis]));
        (!is_inside).then(|| {
            let [low, high, at] = [lower, upper, (*hand).into()]
                .map(|[x, y, z]: [f64; 3]| format!("{x:.3}, {y:.3}, {z:.3} m"));
            format!("the hand at {at} is outside `safety.workspace`, from {low} to {high}")
        })
    }

    /// Whether a speed, m/s, is above the greatest one times a factor.
    pub(super) fn too_fast(&self, speed: f64, factor: f64) -> Option<String> {
        let most = self.hand_speed?;
        (speed > factor * most).then(|| {
            format!("the hand moves at {speed:.3} m/s, faster than `safety.hand_speed`, {most} m/s")
        })
    }
}
