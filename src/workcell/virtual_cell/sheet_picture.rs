//! The image of a folded sheet in a camera: a strip, straight across, above the table.
//!
//! The sheet is drawn as the ground of [`render`](rodlab_vision::render): each point of the table
//! has the colour of the nearest surface on the camera ray through this point.

use crate::cell::sums;
use nalgebra::Point3;
use rodlab_engine::mechanics::Vector3;
use rodlab_robot::Pose;
use rodlab_vision::{Camera, Point};

/// Colour of the upper side of a sheet that lies flat.
const UPPER: [f64; 3] = [232.0, 229.0, 220.0];
/// Colour of the lower side.
const LOWER: [f64; 3] = [168.0, 186.0, 214.0];
/// Fraction of ambient light; the rest comes from the direction of the light.
const AMBIENT: f64 = 0.45;
/// Distance from a point along a ray, as a fraction of the ray, within which nothing hides the
/// point.
const NEAR: f64 = 1e-3;

/// A sheet at one time.
#[derive(Clone, Debug)]
pub struct SeenSheet {
    /// Frame of the sheet in the cell.
    pub frame: Pose,
    /// Middle line in that frame, m, from the free end.
    pub nodes: Vec<Vector3>,
    /// Width of the sheet across the fold, m.
    pub width: f64,
    /// Whether it is a square with a corner at each end of the middle line.
    pub is_diagonal: bool,
}

/// Intersection of a ray with a sheet.
struct Hit {
    /// Position along the ray, as a fraction.
    part: f64,
    /// Place in the frame of the sheet.
    place: Vector3,
    /// Upper normal of the sheet there.
    normal: Vector3,
}

/// A sheet under a camera and a light.
pub struct SheetView {
    sheet: SeenSheet,
    /// Camera in the frame of the sheet.
    eye: Vector3,
    /// Direction of the light in that frame.
    light: Vector3,
    /// Transformation from the cell to the frame of the sheet.
    inwards: Pose,
    /// Height of the table, m.
    table: f64,
    /// Area of the table that the sheet may hide, or darken, in the frame of the sheet: range of x
    /// and y.
    bounds: [[f64; 2]; 2],
    /// Half of the extent of the sheet across at each node, m.
    half: Vec<f64>,
}

impl SheetView {
    /// A sheet seen by a camera; the light comes from a direction in the cell.
    pub fn new(sheet: SeenSheet, camera: &Camera, light: Vector3) -> Self {
        let inwards = sheet.frame.inverse();
        let eye = (inwards * Point3::from(camera.pose.translation.vector)).coords;
        let light = (inwards.rotation * light).normalize();
        let table = (inwards * Point3::new(0.0, 0.0, camera.table_height))
            .coords
            .z;
        let half = halves(&sheet);
        let mut bounds = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for (node, half) in sheet.nodes.iter().zip(&half) {
            for side in [-half, *half] {
                let corner = node + side * Vector3::y();
                let by_eye = eye + (corner - eye) * ((table - eye.z) / (corner.z - eye.z));
                let by_light = corner - light * ((corner.z - table) / light.z);
                for place in [by_eye, by_light] {
                    for (bound, value) in bounds.iter_mut().zip([place.x, place.y]) {
                        *bound = [bound[0].min(value), bound[1].max(value)];
                    }
                }
            }
        }
        Self {
            sheet,
            eye,
            light,
            inwards,
            table: camera.table_height,
            bounds,
            half,
        }
    }

    /// Colour of a point of the table with colour `table`, or of the sheet that hides it.
    pub fn colour(&self, point: Point, table: [f64; 3]) -> [f64; 3] {
        let place = (self.inwards * Point3::new(point.x, point.y, self.table)).coords;
        let is_outside = |value: f64, [from, to]: [f64; 2]| value < from || value > to;
        if is_outside(place.x, self.bounds[0]) || is_outside(place.y, self.bounds[1]) {
            return table;
        }
        let Some(hit) = self.hit(self.eye, place, |part| part > 0.0) else {
            return shaded(table, if self.is_lit(place) { 1.0 } else { AMBIENT });
        };
        let towards = self.eye - hit.place;
        let side = hit.normal.dot(&towards).signum();
        let colour = if side < 0.0 { LOWER } else { UPPER };
        let direct = (side * hit.normal.dot(&self.light)).max(0.0);
        let direct = if self.is_lit(hit.place) { direct } else { 0.0 };
        // A sheet that lies flat in the light has its own colour.
        let flat = AMBIENT + (1.0 - AMBIENT) * self.light.z;
        shaded(colour, (AMBIENT + (1.0 - AMBIENT) * direct) / flat)
    }

    fn is_lit(&self, place: Vector3) -> bool {
        let farthest = place + self.light;
        self.hit(place, farthest, |part| part > NEAR).is_none()
    }

    /// The first intersection of the line through two points with the sheet, at fractions that
    /// `is_allowed` accepts; also beyond the second point.
    fn hit(&self, from: Vector3, to: Vector3, is_allowed: impl Fn(f64) -> bool) -> Option<Hit> {
        let way = to - from;
        let square = way.x * way.x + way.z * way.z;
        let side = |node: &Vector3| way.x * (node.z - from.z) - way.z * (node.x - from.x);
        let mut nearest: Option<Hit> = None;
        let mut before = side(&self.sheet.nodes[0]);
        for (index, pair) in self.sheet.nodes.windows(2).enumerate() {
            let after = side(&pair[1]);
            let sides = [before, after];
            before = after;
            if (sides[0] < 0.0) == (sides[1] < 0.0) {
                continue;
            }
            let along = sides[0] / (sides[0] - sides[1]);
            let node = pair[0] + along * (pair[1] - pair[0]);
            let offset = node - from;
            let part = (offset.x * way.x + offset.z * way.z) / square;
            let place = from + part * way;
            let half = self.half[index] + along * (self.half[index + 1] - self.half[index]);
            let is_nearer = nearest.as_ref().is_none_or(|hit| part < hit.part);
            if is_allowed(part) && is_nearer && (place.y - node.y).abs() <= half {
                let tangent = pair[1] - pair[0];
                // In the order of the nodes, towards the edge, a flat sheet extends along −x.
                let normal = Vector3::new(tangent.z, 0.0, -tangent.x).normalize();
                nearest = Some(Hit {
                    part,
                    place,
                    normal,
                });
            }
        }
        nearest
    }
}

/// Half of the extent of a sheet across, at each node.
fn halves(sheet: &SeenSheet) -> Vec<f64> {
    let pairs = sheet.nodes.windows(2);
    let ways = sums(pairs.map(|pair| (pair[1] - pair[0]).norm()));
    let length = ways[ways.len() - 1];
    let half = |way: &f64| {
        if sheet.is_diagonal {
            way.min(length - way)
        } else {
            0.5 * sheet.width
        }
    };
    ways.iter().map(half).collect()
}

fn shaded(colour: [f64; 3], brightness: f64) -> [f64; 3] {
    colour.map(|channel| (channel * brightness).min(255.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_cells::gantry;

    const TABLE: [f64; 3] = [40.0, 44.0, 48.0];

    fn view(nodes: Vec<Vector3>, is_diagonal: bool) -> SheetView {
        let sheet = SeenSheet {
            frame: Pose::translation(-0.1, 0.0, 0.0),
            nodes,
            width: 0.1,
            is_diagonal,
        };
        let camera = gantry().camera.unwrap().seeing(0.0);
        SheetView::new(sheet, &camera, Vector3::new(0.3, 0.4, 1.0))
    }

    fn flat() -> Vec<Vector3> {
        let node = |k: i32| Vector3::new(0.2 - 0.01 * f64::from(k), 0.0, 1e-4);
        (0..=20).map(node).collect()
    }

    #[test]
    fn a_flat_sheet_is_a_rectangle_or_a_square_on_its_corner() {
        let rectangle = view(flat(), false);
        let square = view(flat(), true);
        for (x, y, in_rectangle, in_square) in [
            (0.0, 0.0, true, true),
            (0.099, 0.049, true, false),
            (-0.099, -0.049, true, false),
            (0.0, 0.09, false, true),
            (0.101, 0.0, false, false),
            (0.0, 0.101, false, false),
        ] {
            let colour = |view: &SheetView| view.colour(Point::new(x, y), TABLE);
            let seen = [colour(&rectangle), colour(&square)].map(|colour| colour == UPPER);
            assert_eq!(seen, [in_rectangle, in_square], "{x} {y}");
        }
    }

    #[test]
    fn a_raised_part_is_seen_in_perspective_and_casts_a_shadow() {
        // The sheet is folded over at its middle, 16 cm above the table.
        let mut nodes: Vec<Vector3> = flat()[..=10].to_vec();
        let half_circle = (1..=20).map(|k| {
            let (sine, cosine) = libm::sincos(std::f64::consts::PI * f64::from(k) / 20.0);
            Vector3::new(0.1 - 0.08 * sine, 0.0, 0.08 * (1.0 - cosine))
        });
        nodes.extend(half_circle);
        nodes.push(Vector3::new(0.2, 0.0, 0.16));
        let view = view(nodes, false);
        // The camera is 1.6 m above the middle; a point at a height of 16 cm and a distance of 0.1
        // m appears at 0.111 m.
        let at = |x: f64, y: f64| view.colour(Point::new(x, y), TABLE);
        assert!(at(0.110, 0.0)[2] > at(0.110, 0.0)[0], "its lower side");
        assert_ne!(at(0.110, 0.0), TABLE);
        assert_eq!(at(0.1125, 0.053), TABLE);
        // The light comes from +x and +y: the shadow falls the other way.
        let shade = shaded(TABLE, AMBIENT);
        assert_eq!(at(0.02, -0.09), shade);
        assert_eq!(at(0.02, 0.09), TABLE);
    }
}
