//! The bounding box of points.

use super::Point;

/// Lower left and upper right corner of the bounding box of points; zero without points.
pub fn bounds<'a>(points: impl IntoIterator<Item = &'a Point>) -> [Point; 2] {
    let mut points = points.into_iter();
    let first = points.next().copied().unwrap_or_default();
    points.fold([first; 2], |[low, high], point| {
        [low.inf(point), high.sup(point)]
    })
}
