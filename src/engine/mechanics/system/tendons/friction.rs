//! Tensions of a tendon with friction, and their derivatives ([`super::capstan`]).

use super::capstan::Capstans;
use super::{PlacedTendon, StraightPart};
use crate::linalg::ElementMatrix;
use crate::mechanics::scene::Pull;

/// Most iterations for the tension of the last part.
const ITERATIONS: usize = 100;

/// A derivative over the unknowns of a tendon at constant τ, and the derivative over τ.
#[derive(Clone)]
struct Slope {
    over_unknowns: Vec<f64>,
    over_tension: f64,
}

impl Slope {
    fn zero(unknowns: usize) -> Self {
        Self {
            over_unknowns: vec![0.0; unknowns],
            over_tension: 0.0,
        }
    }

    /// Adds a multiple of another derivative.
    fn add(&mut self, factor: f64, other: &Self) {
        let pairs = self.over_unknowns.iter_mut().zip(&other.over_unknowns);
        pairs.for_each(|(own, other)| *own += factor * other);
        self.over_tension += factor * other.over_tension;
    }
}

impl PlacedTendon {
    /// Sets the tensions under that given in the first part. Such a tendon does not stretch.
    pub(super) fn pass_tension(&mut self, capstans: &mut Capstans) {
        self.stretch_evenly(0.0, capstans);
        let mut tension = self.given;
        for (number, part) in self.parts.iter_mut().enumerate() {
            if let Some(inner) = number.checked_sub(1) {
                tension *= capstans.ratio(inner);
            }
            part.tension = tension;
        }
    }

    /// Sets the tensions of a tendon of the stiffness EA, N, by Newton's method for τ, with
    /// halvings of its range.
    pub(super) fn find_tensions(&mut self, stiffness: f64, capstans: &mut Capstans) {
        let even = stiffness * (self.length / self.given - 1.0);
        if !(even > 0.0 && even.is_finite()) {
            self.try_tension(0.0, stiffness, capstans);
            return;
        }
        let (mut low, mut high) = (0.0, even * capstans.largest_ratio());
        let mut tension = even;
        for _ in 0..ITERATIONS {
            let [excess, slope] = self.try_tension(tension, stiffness, capstans);
            if excess > 0.0 {
                low = tension;
            } else {
                high = tension;
            }
            let next = tension - excess / slope;
            // Before the range: a root that is one of its ends is not inside of it.
            if (next - tension).abs() <= 2.0 * f64::EPSILON * tension {
                break;
            }
            tension = match low < next && next < high {
                true => next,
                false => 0.5 * (low + high),
            };
        }
    }

    /// Sets the tensions for one in the last part, N. Returns by how much the length without
    /// stretch exceeds the rest length, m, and the derivative over that tension.
    fn try_tension(&mut self, last: f64, stiffness: f64, capstans: &mut Capstans) -> [f64; 2] {
        let (mut tension, mut slope) = (last, 1.0);
        let (mut beyond, mut beyond_slope) = (0.0, 0.0);
        for (number, part) in self.parts.iter_mut().enumerate().rev() {
            if number < capstans.count() {
                capstans.slide(number, beyond);
                let ratio = 1.0 / capstans.ratio(number);
                let (.., sticks) = capstans.slopes(number);
                tension *= ratio;
                slope = ratio * slope - capstans.coefficient() * tension * sticks * beyond_slope;
            }
            part.tension = tension;
            let stretch = 1.0 + tension / stiffness;
            beyond += part.length / stretch;
            beyond_slope -= part.length / (stretch * stretch * stiffness) * slope;
        }
        [beyond - self.given, beyond_slope]
    }

    /// Begins with no part of the friction mobilised.
    pub(super) fn begin_friction(&mut self) {
        let Some(mut capstans) = self.capstans.take() else {
            return;
        };
        // Without friction the tension is even.
        self.stretch_evenly(self.tension() * self.compliance(), &mut capstans);
        capstans.begin(self.length);
        self.capstans = Some(capstans);
    }

    /// Sets the lengths beyond the inner eyelets for one strain of all parts.
    fn stretch_evenly(&self, strain: f64, capstans: &mut Capstans) {
        let mut beyond = 0.0;
        for inner in (0..capstans.count()).rev() {
            beyond += self.parts[inner + 1].length / (1.0 + strain);
            capstans.slide(inner, beyond);
        }
    }

    /// 1/EA, 1/N; zero under a given tension.
    fn compliance(&self) -> f64 {
        match self.pull {
            Pull::Tension(_) => 0.0,
            Pull::Stretching { stiffness, .. } => 1.0 / stiffness,
        }
    }

    /// Adds Σ ∂rₖ/∂q ∂Tₖ/∂qᵀ of friction over the straight parts.
    pub(super) fn add_friction(&self, capstans: &Capstans, matrices: &mut [ElementMatrix]) {
        let compliance = self.compliance();
        if self.pull.stretches() && self.length < self.given {
            return;
        }
        let count = self.entries.unknowns();
        let mut beyond = Slope::zero(count);
        let mut own = Slope {
            over_tension: 1.0,
            ..Slope::zero(count)
        };
        let mut of_tensions = Vec::with_capacity(self.parts.len());
        for (number, part) in self.parts.iter().enumerate().rev() {
            if number < capstans.count() {
                own = self.before(number, capstans, &own, &beyond);
            }
            let stretch = 1.0 + part.tension * compliance;
            for (slot, slope) in self.lengthening(number) {
                beyond.over_unknowns[slot] += slope / stretch;
            }
            beyond.add(-part.length * compliance / (stretch * stretch), &own);
            of_tensions.push(own.clone());
        }
        // What stays constant as τ changes with the unknowns.
        let constant = match self.pull {
            Pull::Tension(_) => own,
            Pull::Stretching { .. } => beyond,
        };
        for (number, slope) in of_tensions.iter().rev().enumerate() {
            let factor = slope.over_tension / constant.over_tension;
            let pairs = slope.over_unknowns.iter().zip(&constant.over_unknowns);
            let whole: Vec<f64> = pairs.map(|(own, other)| own - factor * other).collect();
            for (row, lengthening) in self.lengthening(number) {
                for (column, slope) in whole.iter().enumerate() {
                    (self.entries).add(matrices, row, column, lengthening * slope);
                }
            }
        }
    }

    /// Derivative of the tension before an inner eyelet from that after it and that of Λ.
    fn before(&self, inner: usize, capstans: &Capstans, after: &Slope, beyond: &Slope) -> Slope {
        let (state, slopes, sticks) = capstans.slopes(inner);
        let factor = capstans.coefficient() * self.parts[inner].tension;
        let mut before = Slope::zero(after.over_unknowns.len());
        before.add(1.0 / capstans.ratio(inner), after);
        before.add(-factor * sticks, beyond);
        for (side, slope) in [inner, inner + 1].into_iter().zip(slopes) {
            let StraightPart {
                direction, length, ..
            } = self.parts[side];
            if length == 0.0 {
                continue;
            }
            let across = (slope - direction * direction.dot(&slope)) * (factor * state / length);
            for (slot, rate) in self.span(side) {
                before.over_unknowns[slot] += across.dot(&rate);
            }
        }
        before
    }
}
