//! Baseline methods of folding in the thesis (sec. 4.6.2).

use super::FoldError;
use super::atlas::solve_from;
use super::equilibrium::Fold;
use super::graph_search::neighbours;
use super::manifold::ForceManifold;
use super::path::{Sheet, lift_of, thin};
use super::pose::FoldPose;
use std::f64::consts::PI;

/// Poses of the circle (thesis sec. 4.6.2).
const POSES: usize = 250;

/// The edge moves on a semicircle about the crease, tangent to it, as if the sheet were a hinged
/// plate (thesis Eq. 4.17):
///
/// > x̄ = C̄/2 (1 − cos θ), z̄ = C̄/2 sin θ, α = θ, θ from 0 to π
pub fn circle(target: f64) -> Vec<FoldPose> {
    let radius = 0.5 * target;
    let pose = |index| {
        let angle = PI * index as f64 / POSES as f64;
        let (sine, cosine) = libm::sincos(angle);
        FoldPose {
            gripper: [radius * (1.0 - cosine), radius * sine],
            angle,
        }
    };
    (0..=POSES).map(pose).collect()
}

/// Greedy steps: the gripper moves around the crease, each time to the neighbouring cell with the
/// smallest λ, and holds without a moment.
///
/// This follows the description of the method of Petrík et al. in the thesis: a beam on a table,
/// whose current state alone determines the next grasp.
///
/// # Errors
/// There is no further cell before the edge is down.
pub fn step_by_step(
    manifold: &ForceManifold,
    sheet: &Sheet,
    target: f64,
) -> Result<Vec<FoldPose>, FoldError> {
    let lost = FoldError::NoPath(target);
    // The lift has no force along the table, and continues until the whole sheet is lifted.
    let mut folds = lift_of(sheet);
    let is_known = |fold: &Fold| manifold.fold(manifold.cell(fold.gripper)).is_some();
    let end = folds.iter().rposition(is_known).ok_or(lost)?;
    folds.truncate(end + 1);
    let mut last = folds[end];
    thin(&mut folds, manifold.spacing());
    let around = |[x, z]: [f64; 2]| libm::atan2(z, x - 0.5 * target);
    let mut cell = manifold.cell(last.gripper);
    while cell[1] > 0 {
        let here = around(manifold.place(cell));
        let ahead = neighbours(cell).filter_map(|next| {
            let fold = manifold.fold(next)?;
            let continues = around(fold.gripper) < here && sheet.allows(fold);
            continues.then_some((next, fold))
        });
        let best = ahead.min_by(|(_, one), (_, other)| {
            let ratios = [one, other].map(|fold| fold.force_ratio());
            ratios[0].total_cmp(&ratios[1])
        });
        let (next, fold) = best.ok_or(lost)?;
        (cell, last) = (next, *fold);
        folds.push(last);
    }
    let along = (target - last.gripper[0]).abs() / manifold.spacing();
    let [begin, height] = last.gripper;
    let parts = along.ceil().max(1.0) as usize;
    for part in 1..=parts {
        let part = part as f64 / parts as f64;
        let place = [begin + part * (target - begin), (1.0 - part) * height];
        last = solve_from(&last, place).ok_or(lost)?;
        folds.push(last);
    }
    Ok(folds.iter().map(FoldPose::of).collect())
}

#[cfg(test)]
mod tests {
    use super::super::FoldAtlas;
    use super::*;

    #[test]
    fn the_circle_begins_flat_and_ends_upside_down() {
        let poses = circle(5.0);
        let [first, last] = [poses[0], poses[POSES]];
        assert_eq!((first.gripper, first.angle), ([0.0; 2], 0.0));
        assert!((last.gripper[0] - 5.0).abs() < 1e-12 && last.gripper[1].abs() < 1e-12);
        assert!((last.angle - PI).abs() < 1e-12);
        // The edge moves along the tangent of a plate that rotates about the crease.
        for pair in poses.windows(2) {
            let [dx, dz] = [0, 1].map(|k| pair[1].gripper[k] - pair[0].gripper[k]);
            let middle = 0.5 * (pair[0].angle + pair[1].angle);
            assert!((dx * middle.cos() - dz * middle.sin()).abs() < 1e-9);
        }
    }

    #[test]
    fn looking_at_the_next_step_alone_runs_into_a_large_push_later() {
        let atlas = FoldAtlas::new();
        let manifold = ForceManifold::new(&atlas, 0.11, 6.19);
        let sheet = Sheet::A4;
        let poses = step_by_step(&manifold, &sheet, sheet.length).unwrap();
        let last = poses[poses.len() - 1];
        assert!((last.gripper[0] - sheet.length).abs() < 1e-9 && last.gripper[1].abs() < 1e-9);
        let high = poses.iter().map(|pose| pose.gripper[1]).fold(0.0, f64::max);
        let best = super::super::fold_path(
            &atlas,
            &manifold,
            &sheet,
            sheet.length,
            super::super::Objective::Sum,
        );
        let other = best.unwrap().folds;
        let low = other.iter().map(|fold| fold.gripper[1]).fold(0.0, f64::max);
        assert!(high > 1.5 * low, "{high} {low}");
    }
}
