//! Close-ups of knots: the part of a rod between straight ends.

use rodlab_engine::mechanics::Vector3;
use rodlab_files::figure::{RodCurve, Snapshot};
use std::ops::RangeInclusive;

/// Distance from the line through both ends of a rod, in radii, up to which a node belongs to a
/// straight end.
const STRAIGHT: f64 = 3.0;
/// Largest ratio of the extent of the bent part to the distance of the ends for which a close-up
/// is drawn. A longer part is clearly visible in a picture of the whole rod.
const LONGEST: f64 = 0.4;
/// Length of straight rod shown on either side of the bent part, over the length of the bent part.
const BESIDE: f64 = 0.3;

/// Cuts most of the straight ends off a single rod that is bent only in between, such as a tight
/// knot. Returns whether the ends were cut. All snapshots show the same length.
pub fn cut_straight_ends(snapshots: &mut [Snapshot]) -> bool {
    let windows: Option<Vec<[f64; 2]>> = snapshots.iter().map(window).collect();
    let Some(windows) = windows.filter(|windows| !windows.is_empty()) else {
        return false;
    };
    let widest = windows.iter().map(|[from, to]| to - from);
    let half = (0.5 + BESIDE) * widest.fold(0.0, f64::max);
    for (snapshot, [from, to]) in snapshots.iter_mut().zip(windows) {
        let middle = 0.5 * (from + to);
        let rod = &mut snapshot.rods[0];
        let along = places_along(&rod.points);
        let is_shown = |place: &f64| (place - middle).abs() <= half;
        let (Some(first), Some(last)) = (
            along.iter().position(is_shown),
            along.iter().rposition(is_shown),
        ) else {
            continue;
        };
        let axis = (rod.points[rod.points.len() - 1] - rod.points[0]).normalize();
        let centre = rod.points[0] + middle * axis;
        // Each is centred in its picture, regardless of its position along the rod.
        let shown = rod.points[first..=last].iter();
        rod.points = shown.map(|point| point - centre).collect();
    }
    true
}

/// Start and end of the bent part of the only rod, along the line through the ends of the rod, m;
/// `None` if the rod is not straight on both sides of a short part.
fn window(snapshot: &Snapshot) -> Option<[f64; 2]> {
    let [rod] = &snapshot.rods[..] else {
        return None;
    };
    let bent = bent_part(rod)?;
    let along = places_along(&rod.points);
    let length = *along.last()?;
    let part = &along[bent];
    let from = part.iter().copied().fold(f64::INFINITY, f64::min);
    let to = part.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    (from > 0.0 && to < length && to - from < LONGEST * length).then_some([from, to])
}

/// The nodes between the straight ends.
fn bent_part(rod: &RodCurve) -> Option<RangeInclusive<usize>> {
    let (first, last) = (rod.points.first()?, rod.points.last()?);
    let axis = (last - first).try_normalize(0.0)?;
    let is_beside = |point: &Vector3| {
        let to = point - first;
        (to - axis * axis.dot(&to)).norm() > STRAIGHT * rod.radius
    };
    let bent = |points: &[Vector3]| points.iter().position(is_beside);
    let begin = bent(&rod.points)?;
    let end = rod.points.iter().rposition(is_beside)?;
    (!rod.closed && !rod.held).then_some(begin..=end)
}

/// Coordinates of nodes along the line from the first to the last, m.
fn places_along(points: &[Vector3]) -> Vec<f64> {
    let (Some(first), Some(last)) = (points.first(), points.last()) else {
        return Vec::new();
    };
    let axis = (last - first).try_normalize(0.0).unwrap_or_default();
    points
        .iter()
        .map(|point| axis.dot(&(point - first)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A rod along x with a circular loop in its middle.
    fn looped(radius: f64) -> Snapshot {
        let straight = |k: usize| Vector3::new(0.01 * k as f64, 0.0, 0.0);
        let ring = (0..=40).map(|k| {
            let angle = std::f64::consts::TAU * f64::from(k) / 40.0;
            Vector3::new(
                0.5 + radius * angle.sin(),
                radius - radius * angle.cos(),
                0.0,
            )
        });
        let points = (0..50)
            .map(straight)
            .chain(ring)
            .chain((51..=100).map(straight));
        Snapshot {
            title: String::new(),
            rods: vec![RodCurve {
                points: points.collect(),
                closed: false,
                radius: 1e-3,
                radii: Vec::new(),
                held: false,
            }],
        }
    }

    #[test]
    fn a_small_loop_is_shown_with_short_ends() {
        let mut snapshots = [looped(0.05), looped(0.08)];
        assert!(cut_straight_ends(&mut snapshots));
        for snapshot in &snapshots {
            let points = &snapshot.rods[0].points;
            let (first, last) = (points[0].x, points[points.len() - 1].x);
            assert!((last - first - 1.6 * 0.16).abs() < 0.03, "{first} {last}");
            assert!(
                (first + last).abs() < 0.03,
                "not in the middle: {first} {last}"
            );
        }
    }

    #[test]
    fn rods_that_are_bent_along_most_of_their_length_are_whole() {
        let whole = looped(0.3);
        let mut arch = looped(0.05);
        for (k, point) in arch.rods[0].points.iter_mut().enumerate() {
            point.z += 1e-3 * k as f64 * (141.0 - k as f64);
        }
        let mut straight = looped(0.05);
        straight.rods[0].points.truncate(50);
        for snapshot in [whole, arch, straight] {
            let mut snapshots = [looped(0.05), snapshot.clone()];
            assert!(!cut_straight_ends(&mut snapshots));
            assert_eq!(snapshots[1], snapshot);
        }
    }
}
