//! A stretch behind a pattern, over which its curvature goes back to zero.

use super::PatternPoint;
use super::lead_in::LeadIn;
use std::f64::consts::PI;

/// The [`LeadIn`] of the pattern that runs the other way.
#[derive(Clone, Debug)]
pub struct LeadOut {
    /// Length, m.
    pub length: f64,
    /// Where the pattern ends, m.
    begin: f64,
    lead_in: LeadIn,
}

impl LeadOut {
    /// Behind the last point of a pattern; the curvature goes to zero over the length `bent`, m, of which there may be less.
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
    /// The point of the same curve run through from its end: curvature and bend change their signs, the slope does not.
    pub fn turned_round(&self) -> Self {
        Self {
            angle: self.angle + PI,
            curvature: -self.curvature,
            curvature_bend: -self.curvature_bend,
            ..*self
        }
    }
}
