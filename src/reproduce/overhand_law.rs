//! Tightened knots compared with the law of Jawed et al. 2015 (thesis Eq. 2.30).
//!
//! The law includes only friction, and assumes a braid that is a uniform double helix of n turns.
//! The errors of the law become visible if the traction is split into the part of friction and the
//! rest, which changes the energy of the rod.

use super::prelude::*;
use super::tightening::{Stretch, Tightening, range_before_inversion, stretches};
use rodlab_planning::knot::{jawed_shortening, jawed_traction};

/// Number of intervals before the inversion that are compared.
const PARTS: usize = 10;

/// F̄ from the law at an l̄_k.
pub(super) fn force_by_law(run: &Tightening, length: f64) -> f64 {
    let squared = (run.unknotting_number * run.unknotting_number) as f64;
    jawed_traction(squared / length, run.friction) / squared
}

/// An interval relative to the law.
struct OverLaw {
    /// n² h/e at the same traction.
    shortening: f64,
    /// Friction part of the traction, relative to the traction of the law at the same shortening.
    friction: f64,
    /// Rest of the traction, relative to the same traction of the law.
    rest: f64,
}

impl OverLaw {
    fn of(run: &Tightening, part: &Stretch) -> Self {
        let squared = (run.unknotting_number * run.unknotting_number) as f64;
        let by_law = jawed_shortening(squared * part.force.max(0.0), run.friction);
        let force = force_by_law(run, part.length);
        Self {
            shortening: squared / part.length / by_law,
            friction: part.friction / force,
            rest: (part.force - part.friction) / force,
        }
    }
}

/// Header of the table whose rows are made by [`line`].
pub(super) const HEADER: [&str; 6] = [
    "mean of n² h/e over Eq. 2.30",
    "least",
    "largest",
    "friction over F̄ of Eq. 2.30",
    "rest of F̄ over it",
    "n (1 − friction over it)",
];

/// Means and range over tenths of the range before the inversion.
pub(super) fn line(case: &Case<Tightening>) -> Result<Vec<String>> {
    let range = range_before_inversion(case)?.unwrap_or_default();
    let parts = stretches(case, range, PARTS)?;
    let parts: Vec<OverLaw> = parts
        .iter()
        .map(|part| OverLaw::of(&case.run, part))
        .collect();
    let mean = |of: fn(&OverLaw) -> f64| mean(parts.iter().map(of));
    let extreme = |pick: fn(f64, f64) -> f64| parts.iter().map(|p| p.shortening).reduce(pick);
    let friction = mean(|part| part.friction);
    let lost = friction.map(|part| case.run.unknotting_number as f64 * (1.0 - part));
    let values = [
        mean(|part| part.shortening),
        extreme(f64::min),
        extreme(f64::max),
        friction,
        mean(|part| part.rest),
        lost,
    ];
    Ok(values.map(|value| number(value, 3)).to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_knot_that_follows_the_law_is_all_friction() {
        let run = Tightening::of_figure_2_8(false)[2];
        let force = force_by_law(&run, 300.0);
        let on_the_law = Stretch {
            length: 300.0,
            force,
            friction: force,
        };
        let over = OverLaw::of(&run, &on_the_law);
        assert!((over.shortening - 1.0).abs() < 1e-6);
        assert_eq!((over.friction, over.rest), (1.0, 0.0));
        // A knot with less traction than the law predicts is tighter than predicted.
        let weaker = Stretch {
            force: 0.9 * force,
            ..on_the_law
        };
        assert!(OverLaw::of(&run, &weaker).shortening > 1.04);
    }
}
