//! A lead-out after a pattern, over which the curvature returns to zero.

use super::PatternPoint;
use super::lead_in::LeadIn;
use std::f64::consts::PI;

/// The [`LeadIn`] of the reversed pattern.
#[derive(Clone, Debug)]
pub struct LeadOut {
    /// Length, m.
    pub length: f64,
    /// End of the pattern, m.
    begin: f64,
    lead_in: LeadIn,
}

impl LeadOut {
    /// The lead-out after the last point of a pattern. The curvature decreases to zero over the
    /// length `bent`, m, or over the whole length if that is shorter.
    pub fn new(last: &PatternPoint, bent: f64, length: f64) -> Self {
        Self {
            length,
            begin: last.s,
            lead_in: LeadIn::new(&last.turned_round(), (length - bent).max(0.0), bent),
        }
    }

    pub fn at(&self, s: f64) -> PatternPoint {
        let back = self.lead_in.length() - (s - self.begin);
        PatternPoint {
            s,
            ..self.lead_in.at(back).turned_round()
        }
    }
}

impl PatternPoint {
    /// The point of the reversed curve. The curvature and its second derivative change sign; the
    /// first derivative does not.
    pub fn turned_round(&self) -> Self {
        Self {
            angle: self.angle + PI,
            curvature: -self.curvature,
            curvature_bend: -self.curvature_bend,
            ..*self
        }
    }
}
