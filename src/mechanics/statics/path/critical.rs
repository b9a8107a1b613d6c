//! Critical points: where the number of negative eigenvalues changes between two points of a path, and
//! where other branches leave from there.

use super::location::{Location, PointKind};
use super::tracer::{Tangent, Tracer};
use crate::mechanics::system::System;

/// Arclength to which a critical point is located; 1 is the range of the parameter.
const TOLERANCE: f64 = 1e-8;
/// Most critical points between two neighbouring points.
const MOST_IN_A_STEP: usize = 8;
/// Halvings of the first step onto a new branch.
const HALVINGS: usize = 6;

/// Where another branch leaves.
#[derive(Clone, Debug)]
pub(super) struct Origin {
    location: Location,
    /// Direction of the branch: plus or minus the null vector.
    direction: Tangent,
}

impl Tracer {
    /// Hands out the critical points between `here` and `next`, which lies `step` ahead along `tangent`.
    pub(super) fn locate_critical_points(
        &mut self,
        system: &mut System,
        here: &Location,
        tangent: &Tangent,
        next: &Location,
        step: f64,
    ) {
        let after = self.tangent.clone();
        let kind = if tangent.parameter * after.parameter < 0.0 {
            PointKind::Fold
        } else {
            PointKind::Bifurcation
        };
        self.tangent = tangent.clone();
        let mut low = here.clone();
        for _ in 0..MOST_IN_A_STEP {
            if low.negative == next.negative {
                break;
            }
            let mut high = next.clone();
            let mut length = step;
            while length > TOLERANCE {
                length *= 0.5;
                match self.halfway(system, &low, &high) {
                    Ok(middle) if middle.negative == low.negative => low = middle,
                    Ok(middle) => high = middle,
                    // So near the critical point that Newton's method cannot tell where it goes.
                    Err(_) => break,
                }
            }
            self.hand_out(system, &high, kind);
            if kind == PointKind::Bifurcation && self.plan.switch_branches && self.branch == 0 {
                self.remember(&high);
            }
            low = high;
        }
        self.tangent = after;
    }

    /// Notes the two branches that leave at a bifurcation along its null vector, in `vector`.
    fn remember(&mut self, location: &Location) {
        let mut direction = Tangent {
            unknowns: self.vector.clone(),
            parameter: 0.0,
        };
        let length = self.inner(&direction, &direction).sqrt();
        for sign in [1.0, -1.0] {
            direction.unknowns.clone_from(&self.vector);
            let factor = sign / length;
            direction.unknowns.iter_mut().for_each(|t| *t *= factor);
            self.origins.push_back(Origin {
                location: location.clone(),
                direction: direction.clone(),
            });
        }
    }

    /// Steps onto a branch; false where there is none to be found.
    pub(super) fn switch(&mut self, system: &mut System, origin: &Origin) -> bool {
        self.begin_branch();
        let Origin {
            location,
            direction,
        } = origin;
        for halving in 0..HALVINGS {
            let length = self.first_step() * 0.5f64.powi(halving as i32);
            let predicted: Vec<f64> = (location.unknowns.iter().zip(&direction.unknowns))
                .map(|(q, t)| q + length * t)
                .collect();
            let condition = self.across(direction, location.parameter, &predicted);
            let Ok(first) = self.correct(system, location, &condition, predicted) else {
                continue;
            };
            self.turn_tangent(Some(direction));
            self.hand_out(system, location, PointKind::Bifurcation);
            self.arrive(system, first, PointKind::Regular);
            return true;
        }
        false
    }
}
