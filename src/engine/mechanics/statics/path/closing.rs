//! Branches that return to where branches begin.
//!
//! A branch may connect two bifurcations and return to the first one on its other side. Such a loop
//! is followed once: it ends where it began, and the branches that would begin along it at the
//! bifurcations on the way are the same loop. A branch that joins the first one ends at the next
//! bifurcation of that one.

use super::location::{Location, Origin, Tangent};
use super::tracer::{SMALLEST_COSINE, Tracer};
use crate::mechanics::rod::STRIDE;

/// Largest distance of the start of a branch from the chord of a step that passes it, relative to
/// the chord.
const BESIDE: f64 = 0.15;

impl Tracer {
    /// Forgets the branches that begin on the way from `here` to `next`, along it; returns the place
    /// on the way where the present branch ends, if it has returned to its start or has joined the
    /// first branch.
    pub(super) fn close_loops(&mut self, here: &Location, next: &Location) -> Option<Location> {
        let start = self.start_of_branch.as_ref()?;
        let cosine = self.cosine_at(start, here, next);
        if cosine <= -SMALLEST_COSINE {
            // It has turned round: what begins on the other side of its start is another branch.
            return Some(start.location.clone());
        }
        let returned = (cosine >= SMALLEST_COSINE).then(|| start.location.clone());
        let is_along =
            |origin: &Origin| self.cosine_at(origin, here, next).abs() >= SMALLEST_COSINE;
        let joined = self.crossings.iter().find(|crossing| is_along(crossing));
        let joined = joined.map(|crossing| crossing.location.clone());
        let passed: Vec<bool> = self.origins.iter().map(is_along).collect();
        let mut each = passed.iter();
        self.origins.retain(|_| each.next() == Some(&false));
        returned.or(joined.filter(|_| !passed.contains(&true)))
    }

    /// Cosine of the direction of a branch to the way from `here` to `next`; 0 if the branch does not
    /// begin on the way. Places are compared without angles, which count from frames that depend on
    /// the path.
    fn cosine_at(&self, origin: &Origin, here: &Location, next: &Location) -> f64 {
        let whole = between(here, next);
        let [mut way, mut offset] = [whole.clone(), between(here, &origin.location)];
        for moved in [&mut way, &mut offset] {
            moved
                .unknowns
                .iter_mut()
                .skip(3)
                .step_by(STRIDE)
                .for_each(|angle| *angle = 0.0);
        }
        let squared = self.inner(&way, &way);
        let along = self.inner(&offset, &way) / squared;
        let beside = self.inner(&offset, &offset) - along * along * squared;
        if along <= 0.0 || along > 1.0 || beside > BESIDE * BESIDE * squared {
            return 0.0;
        }
        self.inner(&origin.direction, &whole) / self.inner(&whole, &whole).sqrt()
    }
}

fn between(from: &Location, to: &Location) -> Tangent {
    let moved = from.unknowns.iter().zip(&to.unknowns);
    Tangent {
        unknowns: moved.map(|(from, to)| to - from).collect(),
        parameter: to.parameter - from.parameter,
    }
}
