//! Derivatives of functions of few numbers among many, by differences.
//!
//! The numbers that matter are found by halving: where all numbers of a range change at once and no result does, none of them
//! matters. The place of one node among a thousand takes some tens of evaluations instead of thousands.

use std::ops::Range;

/// Part of its step by which a number differs in a range, with its number: so that the changes of two do not cancel.
const SPREAD: f64 = 0.618_034;

/// Functions of numbers.
pub(super) struct Functions<'a> {
    /// The numbers where they are differentiated, which change for each evaluation.
    pub at: Vec<f64>,
    /// Values there.
    pub here: Vec<f64>,
    pub values: &'a mut dyn FnMut(&[f64]) -> Vec<f64>,
    /// Step of each number; zero for one over which there is no derivative.
    pub step: &'a dyn Fn(usize) -> f64,
}

impl Functions<'_> {
    /// Finds the derivatives over the numbers of a range: calls with a function, a number, and the derivative that is not zero.
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

    /// Values where the numbers of a range are changed by a part of their steps; of several each by a different one.
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
