//! Derivatives, by differences, of functions that depend on few of many variables.
//!
//! The relevant variables are found by bisection: if all variables of a range change at once and
//! no result changes, none of them matters. Finding one node among a thousand takes some tens of
//! evaluations instead of thousands.

use std::ops::Range;

/// Fraction of its step by which each variable in a range differs, multiplied by its index, so
/// that the changes of two variables do not cancel.
const SPREAD: f64 = 0.618_034;

/// Functions of numbers.
pub(super) struct Functions<'a> {
    /// The values at which the function is differentiated; they change for each evaluation.
    pub at: Vec<f64>,
    /// Values there.
    pub here: Vec<f64>,
    pub values: &'a mut dyn FnMut(&[f64]) -> Vec<f64>,
    /// Step of each variable; zero for a variable without a derivative.
    pub step: &'a dyn Fn(usize) -> f64,
}

impl Functions<'_> {
    /// Finds the derivatives with respect to the variables of a range; calls back with each
    /// function, variable and nonzero derivative.
    pub(super) fn differentiate(
        &mut self,
        range: Range<usize>,
        store: &mut dyn FnMut(usize, usize, f64),
    ) {
        let first = range.start;
        if range.len() == 1 {
            let step = (self.step)(first);
            if step == 0.0 {
                return;
            }
            let (plus, minus) = (self.after(range.clone(), 1.0), self.after(range, -1.0));
            for (of, (plus, minus)) in plus.iter().zip(&minus).enumerate() {
                store(of, first, (plus - minus) / (2.0 * step));
            }
        } else if !range.is_empty() && self.after(range.clone(), SPREAD) != self.here {
            let middle = first + range.len() / 2;
            self.differentiate(first..middle, store);
            self.differentiate(middle..range.end, store);
        }
    }

    /// Values with the variables of a range changed by a fraction of their steps, each of several
    /// variables by a different fraction.
    fn after(&mut self, range: Range<usize>, part: f64) -> Vec<f64> {
        let apart = if range.len() > 1 { SPREAD } else { 0.0 };
        let before = self.at[range.clone()].to_vec();
        for number in range.clone() {
            let share = 1.0 + (number as f64 * apart).fract();
            self.at[number] += part * share * (self.step)(number);
        }
        let found = (self.values)(&self.at);
        self.at[range].copy_from_slice(&before);
        found
    }
}
