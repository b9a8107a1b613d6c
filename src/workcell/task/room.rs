//! Room for a rod on the table and in the picture of the camera.

use crate::cell::Cell;
use nalgebra::Point3;
use rodlab_robot::Pose;
use rodlab_vision::Point;

/// Least distance of a lying rod from the edge of the table, m.
const EDGE: f64 = 0.02;
/// Least distance from the edge of the picture, pixels.
const BORDER: f64 = 20.0;

/// Whether a place of a pattern, m, is on the table and in the picture of the camera, if there are
/// a table and a camera. `frame` is the frame of the pattern in the cell.
pub fn is_in_room(cell: &Cell, frame: &Pose, place: Point) -> bool {
    let place = frame * Point3::new(place.x, place.y, 0.0);
    let is_on_table = cell.table.is_none_or(|table| {
        let on_top = table.top.inverse() * place;
        let is_within = |index: usize| on_top[index].abs() + EDGE <= 0.5 * table.size[index];
        is_within(0) && is_within(1)
    });
    let is_seen = cell.camera.as_ref().is_none_or(|camera| {
        let camera = camera.seeing(place.z);
        let far = [camera.width, camera.height].map(|pixels| f64::from(pixels) - BORDER);
        let pixel = camera.project(place.coords);
        pixel.is_some_and(|pixel| {
            let is_within = |index: usize| (BORDER..=far[index]).contains(&pixel[index]);
            is_within(0) && is_within(1)
        })
    });
    is_on_table && is_seen
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_cells::gantry;

    #[test]
    fn a_rod_may_lie_on_the_table_where_the_camera_sees_it() {
        let mut cell = gantry();
        let frame = Pose::translation(0.1, 0.0, 0.0);
        let is_free = |cell: &Cell, x: f64, y: f64| is_in_room(cell, &frame, Point::new(x, y));
        // The picture is 93 cm wide and 70 cm high, the table 120 cm long.
        assert!(is_free(&cell, 0.34, 0.0) && !is_free(&cell, 0.37, 0.0));
        assert!(is_free(&cell, 0.0, 0.33) && !is_free(&cell, 0.0, 0.36));
        cell.camera = None;
        assert!(is_free(&cell, 0.47, 0.0) && !is_free(&cell, 0.49, 0.0));
        cell.table = None;
        assert!(is_free(&cell, 5.0, 0.0));
    }
}
