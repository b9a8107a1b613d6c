//! The camera of a virtual cell: pictures of the table, rendered in a separate thread.

use super::message::published;
use super::sheet_picture::{SeenSheet, SheetView};
use crate::cell::sums;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use image::RgbImage;
use rodlab_engine::mechanics::Vector3;
use rodlab_vision::{Camera, Point, RenderOptions, RenderedRod, render};
use serde_json::{Value, json};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::{Duration, Instant};

/// Colours of the rod and of a second rod.
const RODS: [[u8; 3]; 2] = [[205, 60, 70], [90, 190, 80]];
/// Colour of the table.
const TABLE: [f64; 3] = [40.0, 44.0, 48.0];
/// Colour of pegs.
const PEG: [f64; 3] = [120.0, 122.0, 126.0];
/// Length and radius of a marker, m.
const MARKER: [f64; 2] = [7e-3, 3.5e-3];
/// Colour of a marker.
const MARKER_COLOUR: [u8; 3] = [50, 95, 235];
/// Spacing of the points of a rendered rod, relative to its radius.
const SPACING: f64 = 0.5;
/// Largest number of points of a rendered rod.
const MOST_POINTS: usize = 50_000;
/// Distance from the camera below which objects are out of focus, m.
const NEAREST: f64 = 0.2;

/// Visible objects.
#[derive(Default)]
pub struct Scenery {
    /// Nodes of each rod, m, its radius, m, and its kind, 0 or 1, which sets the colour.
    pub rods: Vec<(Vec<Vector3>, f64, usize)>,
    /// Positions of markers along the first rod, as fractions of its length.
    pub markers: Vec<f64>,
    /// A sheet.
    pub sheet: Option<SeenSheet>,
    /// Axes of pegs, up to the centre of their round tops, and their radii, m.
    pub pegs: Vec<([Vector3; 2], f64)>,
}

/// Wall time after a picture in which the next one does not begin: a client that needs only one
/// can leave.
const PAUSE: Duration = Duration::from_millis(20);

/// Takes pictures, one at a time, in a separate thread.
pub struct PictureTaker {
    camera: Camera,
    taken: u64,
    under_way: Option<Receiver<String>>,
    /// Time at which the last picture was finished.
    finished: Option<Instant>,
}

impl PictureTaker {
    /// Creates a picture taker for a camera.
    pub fn new(camera: Camera) -> Self {
        Self {
            camera,
            taken: 0,
            under_way: None,
            finished: None,
        }
    }

    /// Whether a picture is being rendered.
    pub fn is_busy(&self) -> bool {
        self.under_way.is_some()
    }

    /// Whether the next picture may begin.
    pub fn is_ready(&self) -> bool {
        let is_over = |finished: Instant| finished.elapsed() >= PAUSE;
        !self.is_busy() && self.finished.is_none_or(is_over)
    }

    /// Starts a picture for a topic, with a time stamp.
    pub fn begin(&mut self, scenery: Scenery, topic: &str, stamp: Value) {
        let camera = self.camera;
        self.taken += 1;
        let number = self.taken;
        let topic = topic.to_owned();
        let (sender, receiver) = channel();
        self.under_way = Some(receiver);
        std::thread::spawn(move || {
            let picture = picture(&camera, scenery, number);
            // Sending fails only if the receiver no longer exists.
            let _ = sender.send(message(&picture, &topic, number, &stamp));
        });
    }

    /// The message with the picture, once it is finished.
    pub fn finished(&mut self) -> Option<String> {
        let received = self.under_way.as_ref()?.try_recv();
        if received != Err(TryRecvError::Empty) {
            self.under_way = None;
            self.finished = Some(Instant::now());
        }
        received.ok()
    }
}

/// Renders the picture of the camera; `number` is the seed of its noise.
pub fn picture(camera: &Camera, scenery: Scenery, number: u64) -> RgbImage {
    let mut options = RenderOptions {
        seed: number,
        ..RenderOptions::default()
    };
    // A rod with markers hangs in the air, where its shadow is almost invisible.
    if !scenery.markers.is_empty() {
        options.shadow = 0.0;
    }
    let mut rods = Vec::new();
    let mut draw = |points: Vec<Vector3>, radius: f64, colour: [u8; 3]| {
        rods.push(RenderedRod {
            points: visible(camera, points),
            radius,
            colour,
        });
    };
    let mut markers = scenery.markers;
    for (nodes, radius, kind) in &scenery.rods {
        let points = fine(nodes, SPACING * radius);
        for place in markers.drain(..) {
            draw(marker(&points, place), MARKER[1], MARKER_COLOUR);
        }
        draw(points, *radius, RODS[*kind % RODS.len()]);
    }
    let tops = peg_tops(camera, &scenery.pegs);
    let sheet = scenery
        .sheet
        .map(|sheet| SheetView::new(sheet, camera, options.light));
    let is_peg = |point: &Point| {
        let mut tops = tops.iter();
        tops.any(|(middle, radius)| (point - middle).norm() < *radius)
    };
    let ground = |point: Point| match &sheet {
        Some(sheet) => sheet.colour(point, TABLE),
        None if is_peg(&point) => PEG,
        None => TABLE,
    };
    render(camera, &rods, ground, &options)
}

/// Apparent positions and radii of the round tops of pegs on the table, m.
fn peg_tops(camera: &Camera, pegs: &[([Vector3; 2], f64)]) -> Vec<(Point, f64)> {
    let tops = pegs.iter().filter_map(|([_, top], radius)| {
        let side = top + camera.pose.rotation * (Vector3::x() * *radius);
        let [middle, side] = [*top, side].map(|place| camera.on_table(camera.project(place)?).ok());
        Some((middle?, (side? - middle?).norm()))
    });
    tops.collect()
}

/// A marker: a sleeve around the point of a curve at the fraction `place` of its length.
fn marker(points: &[Vector3], place: f64) -> Vec<Vector3> {
    let pairs = points.windows(2);
    let lengths = sums(pairs.map(|pair| (pair[1] - pair[0]).norm()));
    let middle = place * lengths[lengths.len() - 1];
    let within = points.iter().zip(&lengths);
    let within = within.filter(|(_, length)| (*length - middle).abs() <= 0.5 * MARKER[0]);
    within.map(|(point, _)| *point).collect()
}

/// The part of the rod from its start up to the first point that is too near to the camera.
fn visible(camera: &Camera, points: Vec<Vector3>) -> Vec<Vector3> {
    let depth = |point: &Vector3| camera.pose.inverse_transform_point(&(*point).into()).z;
    points
        .into_iter()
        .take_while(|point| depth(point) > NEAREST)
        .collect()
}

/// Points on the smooth curve through nodes (Catmull and Rom 1974), at most `spacing` apart, m.
fn fine(nodes: &[Vector3], spacing: f64) -> Vec<Vector3> {
    let Some(last) = nodes.len().checked_sub(1) else {
        return Vec::new();
    };
    let length: f64 = nodes
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).norm())
        .sum();
    let spacing = spacing.max(length / MOST_POINTS as f64);
    let mut points = Vec::new();
    for index in 0..last {
        let (from, to) = (nodes[index], nodes[index + 1]);
        let before = if index == 0 {
            2.0 * from - to
        } else {
            nodes[index - 1]
        };
        let after = nodes.get(index + 2).copied().unwrap_or(2.0 * to - from);
        let count = ((to - from).norm() / spacing).ceil().max(1.0) as usize;
        let slopes = [(to - before) * 0.5, (after - from) * 0.5];
        points.extend((0..count).map(|step| {
            let t = step as f64 / count as f64;
            let (t2, t3) = (t * t, t * t * t);
            from * (2.0 * t3 - 3.0 * t2 + 1.0)
                + to * (3.0 * t2 - 2.0 * t3)
                + slopes[0] * (t3 - 2.0 * t2 + t)
                + slopes[1] * (t3 - t2)
        }));
    }
    points.push(nodes[last]);
    points
}

/// A `sensor_msgs/Image` as rosbridge sends it.
fn message(picture: &RgbImage, topic: &str, number: u64, stamp: &Value) -> String {
    let message = json!({
        "header": { "seq": number, "stamp": stamp, "frame_id": "camera" },
        "height": picture.height(),
        "width": picture.width(),
        "encoding": "rgb8",
        "is_bigendian": 0,
        "step": 3 * picture.width(),
        "data": STANDARD.encode(picture.as_raw()),
    });
    published(topic, message)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_cells::gantry;
    use rodlab_vision::{TraceOptions, trace};

    #[test]
    fn the_curve_between_nodes_is_smooth_and_fine() {
        let node = |k: i32| {
            let (sine, cosine) = libm::sincos(0.1 * f64::from(k));
            Vector3::new(0.1 * cosine, 0.1 * sine, 0.0)
        };
        let nodes: Vec<Vector3> = (0..=20).map(node).collect();
        let points = fine(&nodes, 1e-3);
        let mut steps = points.windows(2).map(|pair| (pair[1] - pair[0]).norm());
        assert!(steps.all(|step| step <= 1.01e-3));
        // Chords deviate by 1.2e-4 m; the direction at both ends is undefined.
        let inner = &points[20..points.len() - 20];
        let off = inner.iter().map(|point| (point.norm() - 0.1).abs());
        assert!(off.fold(0.0, f64::max) < 1e-6);
        assert_eq!((points[0], points[points.len() - 1]), (nodes[0], nodes[20]));
    }

    #[test]
    fn a_rod_on_the_table_is_seen_where_it_lies() {
        let camera = gantry().camera.unwrap().seeing(0.0016);
        let node = |k: i32| {
            let x = 5e-3 * f64::from(k) - 0.1;
            Vector3::new(x, 0.05 * libm::cos(15.0 * x), 0.0016)
        };
        let nodes: Vec<Vector3> = (0..=40).map(node).collect();
        let scenery = Scenery {
            rods: vec![(nodes.clone(), 0.0016, 0)],
            ..Scenery::default()
        };
        let picture = picture(&camera, scenery, 1);
        let found = trace(&picture, &TraceOptions::default()).unwrap();
        assert_eq!(found.strands.len(), 1);
        for point in &found.strands[0].points {
            let seen = camera.on_table(*point).unwrap();
            let away = nodes.windows(2).map(|pair| {
                let part = ((seen.x - pair[0].x) / (pair[1].x - pair[0].x)).clamp(0.0, 1.0);
                ((pair[0] + part * (pair[1] - pair[0])).xy() - seen).norm()
            });
            assert!(away.fold(f64::INFINITY, f64::min) < 0.6e-3, "{seen}");
        }
    }
}
