//! The workspace: gripper positions between a taut sheet and a sheet whose edge is back on the
//! table.

use super::atlas::{angles_from, lengthened};
use super::equilibrium::Fold;
use rayon::prelude::*;
use rodlab_engine::mechanics::kirchhoff::elastica::Forces;

/// Largest ratio of the suspended lengths of successive curves.
const GROWTH: f64 = 1.02;
/// Maximum number of iterations for the end of a curve, and its accuracy.
const ITERATIONS: usize = 40;
const ACCURACY: f64 = 1e-11;
/// Number of folds added to the outline between two folds of a curve.
const BETWEEN: usize = 4;

/// Positions (x̄, z̄) of gentle folds with a range of suspended lengths (thesis sec. 4.4.1). At
/// one end of this range of folds, sheets are pulled with H = |V|, so that no friction below 1
/// holds them. At the other end their edge is back on the table, or the longest sheets turn over
/// before.
#[derive(Clone, Debug)]
pub struct Workspace {
    outline: Vec<[f64; 2]>,
}

impl Workspace {
    /// Allowed range of suspended lengths of a workspace, L_gb.
    pub const LENGTHS: [f64; 2] = [0.1, Fold::LONGEST];

    /// The workspace of suspended lengths between two limits, L_gb; `None` if they are outside
    /// [`LENGTHS`](Self::LENGTHS) or not ascending.
    pub fn new([from, to]: [f64; 2]) -> Option<Self> {
        let [least, largest] = Self::LENGTHS;
        if !(least <= from && from < to && to <= largest) {
            return None;
        }
        let steps = (libm::log(to / from) / libm::log(GROWTH)).ceil();
        let mut free = vec![free_fold(from)?];
        for step in 1..=steps as usize {
            let length = from * libm::pow(to / from, step as f64 / steps);
            free.push(lengthened(free[free.len() - 1], length)?);
        }
        let curves: Option<Vec<Vec<Fold>>> = free.par_iter().map(curve).collect();
        let curves = curves?;
        let (first, last) = (finer(&curves[0]), finer(&curves[curves.len() - 1]));
        let taut = curves.iter().map(|curve| curve[0]);
        let back = curves.iter().rev().map(|curve| curve[curve.len() - 1]);
        let around = taut.chain(last).chain(back).chain(first.into_iter().rev());
        Some(Self {
            outline: around.map(|fold| fold.gripper).collect(),
        })
    }

    /// Outline of the workspace, in four parts: taut sheets from the shortest to the longest suspended length,
    /// the longest sheet to its end, the ends back to the shortest sheet, and the shortest sheet.
    pub fn outline(&self) -> &[[f64; 2]] {
        &self.outline
    }

    /// Largest x̄ and z̄.
    pub fn reach(&self) -> [f64; 2] {
        let largest = |k: usize| self.outline.iter().map(move |place| place[k]);
        [0, 1].map(|k| largest(k).fold(0.0, f64::max))
    }

    /// Whether a place is in it.
    pub fn contains(&self, [x, z]: [f64; 2]) -> bool {
        let before = self.outline.iter().cycle().skip(self.outline.len() - 1);
        let mut inside = false;
        for ([x_1, z_1], [x_2, z_2]) in before.zip(&self.outline) {
            if (*z_1 > z) != (*z_2 > z) {
                let crossing = x_1 + (z - z_1) / (z_2 - z_1) * (x_2 - x_1);
                inside ^= x < crossing;
            }
        }
        inside
    }

    /// Gripper positions for a suspended length, starting at the taut sheet; `None` if it is
    /// outside [`LENGTHS`](Self::LENGTHS).
    pub fn places_of_length(length: f64) -> Option<Vec<[f64; 2]>> {
        let [least, largest] = Self::LENGTHS;
        let free = (least..=largest).contains(&length).then_some(length);
        let folds = finer(&curve(&free_fold(free?)?)?);
        Some(folds.iter().map(|fold| fold.gripper).collect())
    }
}

/// The fold without a push, found from the flat sheet.
fn free_fold(length: f64) -> Option<Fold> {
    lengthened(Fold::just_lifted(length.min(1.0))?, length)
}

/// Folds of one suspended length with increasing angle.
fn curve(free: &Fold) -> Option<Vec<Fold>> {
    let mut folds = vec![];
    let mut last = *free;
    for fold in angles_from(*free, -1.0) {
        if pull(&fold) > 0.0 {
            folds.push(end(last, fold, pull)?);
            break;
        }
        folds.push(fold);
        last = fold;
    }
    if pull(folds.last()?).abs() > 1e-6 {
        return None;
    }
    folds.reverse();
    folds.push(*free);
    last = *free;
    for fold in angles_from(*free, 1.0) {
        if below(&fold) > 0.0 {
            folds.push(end(last, fold, below)?);
            break;
        }
        if fold.unstable_modes() > 0 {
            break;
        }
        folds.push(fold);
        last = fold;
    }
    Some(folds)
}

/// The curve with additional folds between those given.
fn finer(curve: &[Fold]) -> Vec<Fold> {
    let mut folds = vec![curve[0]];
    for pair in curve.windows(2) {
        for part in 1..BETWEEN {
            folds.extend(between(&pair[0], &pair[1], part as f64 / BETWEEN as f64));
        }
        folds.push(pair[1]);
    }
    folds
}

/// The fold between two folds of the same length, at a fraction of the difference of their angles.
fn between(one: &Fold, other: &Fold, part: f64) -> Option<Fold> {
    let guess = one.forces.towards(&other.forces, part);
    let angle = one.angle + part * (other.angle - one.angle);
    Fold::at_angle(one.suspended_length, angle, guess)
}

/// Excess of the pull over H = |V|, relative to both.
fn pull(fold: &Fold) -> f64 {
    let Forces {
        horizontal,
        vertical,
    } = fold.forces;
    (horizontal + vertical) / (horizontal.abs() + vertical.abs())
}

/// Depth of the edge below the table.
fn below(fold: &Fold) -> f64 {
    -fold.gripper[1]
}

/// The fold at which a function changes sign, between a fold inside, where it is negative, and one
/// outside, both of the same length (regula falsi with the weights of the Illinois algorithm).
fn end(inside: Fold, outside: Fold, beyond: fn(&Fold) -> f64) -> Option<Fold> {
    let mut sides = [(inside, beyond(&inside)), (outside, beyond(&outside))];
    let mut kept = None;
    for _ in 0..ITERATIONS {
        let [(one, low), (other, high)] = sides;
        let middle = between(&one, &other, low / (low - high))?;
        let value = beyond(&middle);
        if value.abs() < ACCURACY || (other.angle - one.angle).abs() < ACCURACY {
            return Some(middle);
        }
        let side = usize::from(value > 0.0);
        sides[side] = (middle, value);
        if kept == Some(1 - side) {
            sides[1 - side].1 *= 0.5;
        }
        kept = Some(1 - side);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::super::FoldAtlas;
    use super::*;

    /// Compares with the folds of the atlas, which are inside or outside according to their
    /// suspended length, pull and height.
    #[test]
    fn it_holds_the_folds_of_its_lengths_and_no_others() {
        let workspace = Workspace::new([0.7, 5.0]).unwrap();
        let mut inside = 0;
        for fold in FoldAtlas::new().folds() {
            let [x, z] = fold.gripper;
            let length = fold.suspended_length;
            // The outline is a polygon, and close to the flat sheet all lengths coincide.
            let is_near = (length - 0.7).abs() < 0.02 || (length - 5.0).abs() < 0.02;
            if is_near || pull(fold).abs() < 0.02 || z.abs() < 0.01 || x < 1e-4 {
                continue;
            }
            let belongs = (0.7..5.0).contains(&length) && pull(fold) < 0.0 && z > 0.0;
            assert_eq!(workspace.contains([x, z]), belongs, "{fold:?}");
            inside += usize::from(belongs);
        }
        assert!(inside > 300, "{inside}");
    }

    #[test]
    fn it_is_bounded_by_the_table_and_a_pull_of_one() {
        let workspace = Workspace::new([0.5, 6.84]).unwrap();
        let lowest = workspace.outline().iter().map(|[_, z]| *z);
        assert!(lowest.fold(1.0, f64::min).abs() < 1e-6);
        let [x, z] = workspace.reach();
        assert!(
            (10.0..11.0).contains(&x) && (5.5..5.7).contains(&z),
            "{x} {z}"
        );
        let taut = curve(&free_fold(2.0).unwrap()).unwrap()[0];
        assert!((taut.force_ratio() - 1.0).abs() < 1e-9 && taut.forces.horizontal > 0.0);
    }

    #[test]
    fn lengths_out_of_bounds_have_none() {
        for lengths in [[0.0, 5.0], [1.0, 8.0], [3.0, 2.0], [f64::NAN, 2.0]] {
            assert!(Workspace::new(lengths).is_none());
        }
        assert!(Workspace::places_of_length(9.0).is_none());
    }
}
