//! The simplified knot of the thesis, section 3.6: a braid of two helices and a loop between its
//! ends.
//!
//! The model omits tails, friction, contact between loop and braid, and twist of the braid. The
//! total energy over EI/h is Ē(θ) = Ē_b + Ē_l at fixed φ and ε. The rotation θ of the ends makes
//! the energy stationary.
//!
//! The source does not state how the loop is held. Here its ends are on the axis of the braid or,
//! by `offset`, on the strands; their tangents make the angle φ with the axis; and they either keep
//! their twist or may spin.

use super::helical_braid::HelicalBraid;
use rodlab_engine::mechanics::kirchhoff::{EndSpin, LoopEnds, SuspendedLoop, numerics::bisect};
use std::f64::consts::FRAC_PI_3;

/// Largest rotation θ of the search, rad, as in figure 3.9 of the thesis.
const LARGEST_ROTATION: f64 = 5.0;
/// Step of θ, rad. Folds are found between steps by parabolas, to about 1e-4 of l̄_k.
const ROTATION_STEP: f64 = 0.05;
/// Largest l̄_k of an equilibrium; beyond it, the braid has no significant effect.
const LARGEST_LENGTH: f64 = 1e4;
/// Maximum number of iterations for the offset over the loop's length, which depends on l̄_k; each
/// gains a digit or more.
const SUBSTITUTIONS: usize = 30;
/// Relative change at which the iteration ends.
const SUBSTITUTION_TOLERANCE: f64 = 1e-9;

/// A braid and its loop, apart from their size and the rotation of the ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimplifiedKnot {
    /// Full turns of the strands around each other: the unknotting number n.
    pub turns: f64,
    /// Angle φ between the axis of the braid and the tangents of the loop's ends, rad.
    pub tilt: f64,
    /// ε = l_b/l_l, length of the braid over that of the loop, below 1.
    pub ratio: f64,
    /// Distance of the loop's ends from the axis, in radii of the rod: 0 on the axis, 1 on a right-handed strand, −1
    /// on a left-handed one.
    pub offset: f64,
    /// Spin of the loop's ends about their tangents.
    pub spin: EndSpin,
}

/// A knot with ends held at a given rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RotatedKnot {
    /// θ, rad.
    pub rotation: f64,
    /// Ē = E h/EI.
    pub energy: f64,
    /// ∂Ē/∂θ.
    pub moment: f64,
    /// Height of the loop's middle above the axis over the length of the braid; negative on the other side.
    pub height: f64,
}

/// A stationary rotation and its size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Equilibrium {
    /// θ, rad.
    pub rotation: f64,
    /// l̄_k = (l_b + l_l)/h.
    pub length: f64,
}

/// A fold, where a stable and an unstable equilibrium meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fold {
    /// θ, rad.
    pub rotation: f64,
    /// l̄_k.
    pub length: f64,
    /// Whether a knot loses its equilibrium here when it is tightened: the inversion. At the other
    /// kind of fold two equilibria appear.
    pub is_inversion: bool,
}

impl SimplifiedKnot {
    /// The knot of the thesis: φ = π/3 and ε = 0.7, with the loop's ends on the axis.
    pub fn of_thesis(unknotting_number: usize, spin: EndSpin) -> Self {
        Self {
            turns: unknotting_number as f64,
            tilt: FRAC_PI_3,
            ratio: 0.7,
            offset: 0.0,
            spin,
        }
    }

    fn braid(&self, rotation: f64, length: f64) -> HelicalBraid {
        let braid = self.ratio / (1.0 + self.ratio) * length;
        HelicalBraid::new(self.turns, rotation, braid)
    }

    /// Length of the loop over the radius of the rod.
    fn loop_length(&self, length: f64) -> f64 {
        length / (1.0 + self.ratio)
    }

    /// The planar loop of a knot of size l̄_k = `length`; `None` if there is none.
    fn planar_loop(&self, length: f64) -> Option<SuspendedLoop> {
        let offset = self.offset / self.loop_length(length);
        SuspendedLoop::planar(self.ratio, self.tilt, offset, self.spin)
    }

    /// Energy and moment of a knot of size l̄_k = `length` from θ = 0 on, in steps of 0.05 up to
    /// 5, or as long as the loop's shape changes continuously with its ends; free ends snap over
    /// near π/2.
    pub fn over_rotation(&self, length: f64) -> Vec<RotatedKnot> {
        let loop_length = self.loop_length(length);
        let Some(planar) = self.planar_loop(length) else {
            return Vec::new();
        };
        self.turned(planar, |_, ends| ends)
            .iter()
            .map(|turned| {
                let braid = self.braid(turned.ends.rotation, length);
                RotatedKnot {
                    rotation: turned.ends.rotation,
                    energy: braid.energy() + turned.energy() / loop_length,
                    moment: turned.turning_moment() / loop_length - braid.unwinding_moment(),
                    height: turned.height() / self.ratio,
                }
            })
            .collect()
    }

    /// Loops with ends turned step by step. `adjust` may change the ends further, given the
    /// previous loop.
    fn turned(
        &self,
        planar: SuspendedLoop,
        adjust: impl Fn(&SuspendedLoop, LoopEnds) -> LoopEnds,
    ) -> Vec<SuspendedLoop> {
        let largest = LARGEST_ROTATION.min(0.9 * self.turns * std::f64::consts::PI);
        let mut loops = vec![planar];
        let mut before = planar;
        for step in 1.. {
            let rotation = f64::from(step) * ROTATION_STEP;
            let last = loops[loops.len() - 1];
            let ends = adjust(
                &last,
                LoopEnds {
                    rotation,
                    ..last.ends
                },
            );
            let next = last.continued_to(&before, ends);
            let Some(next) = next.filter(|_| rotation < largest + 0.5 * ROTATION_STEP) else {
                break;
            };
            before = last;
            loops.push(next);
        }
        loops
    }

    /// The size l̄_k at which a loop is in balance with the braid; `None` if the loop has no
    /// resistance, or a resistance that a loose braid cannot overcome.
    fn balanced_length(&self, turned: &SuspendedLoop) -> Option<f64> {
        let rotation = turned.ends.rotation;
        let resistance = (1.0 + self.ratio) * turned.turning_moment();
        let surplus =
            |length: f64| length * self.braid(rotation, length).unwinding_moment() - resistance;
        let unit = self.braid(rotation, 1.0).pitch();
        let smallest = HelicalBraid::steepest_pitch() / unit;
        (surplus(smallest) > 0.0 && surplus(LARGEST_LENGTH) < 0.0)
            .then(|| bisect(smallest, LARGEST_LENGTH, surplus))
    }

    /// The equilibria θ, l̄_k in the order of θ, as continuous pieces of curves.
    pub fn equilibria(&self) -> Vec<Vec<Equilibrium>> {
        let Some(planar) = self.planar_loop(LARGEST_LENGTH) else {
            return Vec::new();
        };
        let mut pieces = vec![Vec::new()];
        let loops = self.turned(planar, |last, ends| LoopEnds {
            offset: self.balanced_offset(last, ends),
            ..ends
        });
        for turned in loops {
            match self.balanced_length(&turned) {
                Some(length) => pieces[0].push(Equilibrium {
                    rotation: turned.ends.rotation,
                    length,
                }),
                None => pieces.insert(0, Vec::new()),
            }
        }
        pieces.retain(|piece| !piece.is_empty());
        pieces.reverse();
        pieces
    }

    /// The offset over the loop's length of the knot in balance with these ends. The length
    /// depends on the loop, and the loop depends weakly on the offset over the length.
    fn balanced_offset(&self, near: &SuspendedLoop, ends: LoopEnds) -> f64 {
        let mut offset = ends.offset;
        if self.offset == 0.0 {
            return offset;
        }
        let mut solution = *near;
        for _ in 0..SUBSTITUTIONS {
            let Some(moved) = solution.moved_to(LoopEnds { offset, ..ends }) else {
                return offset;
            };
            solution = moved;
            let length = self.balanced_length(&solution).unwrap_or(LARGEST_LENGTH);
            let before = offset;
            offset = self.offset / self.loop_length(length);
            if (offset - before).abs() <= SUBSTITUTION_TOLERANCE * offset.abs() {
                break;
            }
        }
        offset
    }

    /// All folds, in the order of θ.
    pub fn folds(&self) -> Vec<Fold> {
        self.equilibria()
            .iter()
            .flat_map(|piece| piece.windows(3).filter_map(fold_between))
            .collect()
    }

    /// The fold at which a knot inverts when it is tightened from a large loop.
    pub fn inversion(&self) -> Option<Fold> {
        self.folds().into_iter().find(|fold| fold.is_inversion)
    }
}

/// The extremum of l̄_k over θ on the parabola through three equilibria, if it lies in the middle.
///
/// An equilibrium is stable if l̄_k decreases with θ. A looser braid pushes less, so ∂²Ē/∂θ² and
/// −dl̄_k/dθ have the same sign.
fn fold_between(points: &[Equilibrium]) -> Option<Fold> {
    let [before, middle, after] = [0, 1, 2].map(|k| points[k]);
    let [left, right] = [middle.length - before.length, after.length - middle.length];
    if left * right > 0.0 {
        return None;
    }
    let curvature = right - left;
    let part = -0.5 * (left + right) / curvature;
    Some(Fold {
        rotation: middle.rotation + part * (after.rotation - middle.rotation),
        length: middle.length + 0.25 * (left + right) * part,
        is_inversion: curvature > 0.0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const CLAMPED: EndSpin = EndSpin::Clamped {
        stiffness_ratio: 2.0 / 3.0,
    };

    #[test]
    fn two_equilibria_vanish_at_the_fold() {
        let knot = SimplifiedKnot::of_thesis(3, CLAMPED);
        let fold = knot.inversion().unwrap();
        let changes = |length: f64| {
            let knots = knot.over_rotation(length);
            let below = knots.iter().filter(|turned| turned.rotation < 2.5);
            let signs: Vec<bool> = below.map(|turned| turned.moment > 0.0).collect();
            signs.windows(2).filter(|pair| pair[0] != pair[1]).count()
        };
        assert_eq!(changes(1.02 * fold.length), 2);
        assert_eq!(changes(0.98 * fold.length), 0);
    }

    #[test]
    fn the_moment_is_the_slope_of_the_energy() {
        let knot = SimplifiedKnot {
            offset: 1.0,
            ..SimplifiedKnot::of_thesis(3, CLAMPED)
        };
        for around in knot.over_rotation(137.5).windows(3) {
            let slope = (around[2].energy - around[0].energy) / (2.0 * ROTATION_STEP);
            assert!((slope - around[1].moment).abs() < 2e-3, "{around:?}");
        }
    }

    #[test]
    fn a_trefoil_has_no_fold() {
        for spin in [CLAMPED, EndSpin::Free] {
            assert_eq!(SimplifiedKnot::of_thesis(1, spin).inversion(), None);
        }
    }

    #[test]
    fn parabolas_are_met_exactly() {
        let at = |rotation: f64| Equilibrium {
            rotation,
            length: 7.0 + 3.0 * (rotation - 1.02).powi(2),
        };
        let fold = fold_between(&[at(0.9), at(1.0), at(1.1)]).unwrap();
        assert!((fold.rotation - 1.02).abs() < 1e-12 && (fold.length - 7.0).abs() < 1e-12);
        assert!(fold.is_inversion);
    }

    #[test]
    fn knots_of_more_turns_invert_earlier_and_an_offset_moves_the_fold_little() {
        let lengths: Vec<f64> = (2..=5)
            .map(|n| SimplifiedKnot::of_thesis(n, EndSpin::Free))
            .map(|knot| knot.inversion().unwrap().length)
            .collect();
        assert!(lengths.windows(2).all(|pair| pair[1] > 1.3 * pair[0]));
        let shifted = SimplifiedKnot {
            offset: 1.0,
            ..SimplifiedKnot::of_thesis(3, EndSpin::Free)
        };
        let change = shifted.inversion().unwrap().length / lengths[1] - 1.0;
        assert!(change.abs() < 0.1 && change != 0.0, "{change}");
    }
}
