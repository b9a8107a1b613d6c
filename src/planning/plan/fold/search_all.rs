//! Search for all folds at a gripper position.

use super::equilibrium::Fold;
use rodlab_engine::mechanics::kirchhoff::elastica::{Elastica, Forces, Piece, Place};

/// Ranges of trial forces, in EI/L_gb².
const HORIZONTAL: [f64; 2] = [-9.0, 5.0];
const VERTICAL: [f64; 2] = [-5.0, 0.0];
/// Forces in each direction.
const GRID: usize = 90;
/// Number of points without curvature that are traced along a sheet.
const INFLECTIONS: usize = 4;
/// Largest difference of the suspended lengths of two folds that count as the same.
const SAME: f64 = 1e-6;

/// Folds with the gripper at (x̄, z̄), sorted by suspended length. For every pair of forces the
/// sheet is traced from the touchdown point to the first points without curvature, any of which
/// can be its edge. If these points enclose the gripper for three neighbouring pairs of forces,
/// Newton's method finds the fold.
pub(super) fn folds_at(gripper: [f64; 2]) -> Vec<Fold> {
    let rows: Vec<Vec<[Option<Fold>; INFLECTIONS]>> = (0..=GRID)
        .map(|i| (0..=GRID).map(|j| edges_of(forces(i, j))).collect())
        .collect();
    let mut found: Vec<Fold> = vec![];
    for i in 0..GRID {
        for j in 0..GRID {
            let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
            for inflection in 0..INFLECTIONS {
                let corners = corners.map(|(i, j)| rows[i][j][inflection]);
                for triangle in [[0, 1, 2], [0, 2, 3]] {
                    let [Some(a), Some(b), Some(c)] = triangle.map(|k| corners[k]) else {
                        continue;
                    };
                    if !contains([a.gripper, b.gripper, c.gripper], gripper) {
                        continue;
                    }
                    let fold = Fold::at(gripper, &a).filter(is_above_the_table);
                    if let Some(fold) =
                        fold.filter(|fold| found.iter().all(|other| differ(fold, other)))
                    {
                        found.push(fold);
                    }
                }
            }
        }
    }
    found.sort_by(|one, other| one.suspended_length.total_cmp(&other.suspended_length));
    found
}

/// Whether two folds are different.
pub(super) fn differ(one: &Fold, other: &Fold) -> bool {
    let length = (one.suspended_length - other.suspended_length).abs();
    length > SAME || (one.angle - other.angle).abs() > SAME
}

fn forces(i: usize, j: usize) -> Forces {
    let between = |[from, to]: [f64; 2], k: usize| from + (to - from) * k as f64 / GRID as f64;
    Forces {
        horizontal: between(HORIZONTAL, i),
        vertical: between(VERTICAL, j),
    }
}

/// The sheets that end at the points without curvature.
fn edges_of(forces: Forces) -> [Option<Fold>; INFLECTIONS] {
    let mut edges = [None; INFLECTIONS];
    let mut count = 0;
    let mut place = Place::default();
    // The touchdown point itself also has no curvature.
    let mut sign = -forces.vertical;
    while place.arc_length < Fold::LONGEST && count < INFLECTIONS {
        let piece = Piece::new(place, Elastica::heavy(forces));
        let end = piece.at(piece.reach.min(Fold::LONGEST));
        if end.state.curvature * sign < 0.0 {
            let (mut a, mut b) = (place.arc_length, end.arc_length);
            for _ in 0..12 {
                let middle = 0.5 * (a + b);
                if piece.at(middle).state.curvature * sign > 0.0 {
                    a = middle;
                } else {
                    b = middle;
                }
            }
            edges[count] = Some(Fold::of(forces, &piece.at(b)));
            count += 1;
            sign = end.state.curvature;
        }
        place = end;
    }
    edges
}

fn is_above_the_table(fold: &Fold) -> bool {
    fold.suspended_length > 0.0
        && fold.suspended_length <= Fold::LONGEST
        && fold.shape(48).iter().all(|[_, z]| *z > -1e-9)
}

/// Whether a triangle contains a point.
fn contains(corners: [[f64; 2]; 3], [x, z]: [f64; 2]) -> bool {
    let side = |from: [f64; 2], to: [f64; 2]| {
        (to[0] - from[0]) * (z - from[1]) - (to[1] - from[1]) * (x - from[0])
    };
    let [a, b, c] = corners;
    let sides = [side(a, b), side(b, c), side(c, a)];
    sides.iter().all(|side| *side >= 0.0) || sides.iter().all(|side| *side <= 0.0)
}
