//! The content of a film or a page.

use super::super::View;
use super::strip::Strip;
use nalgebra::Vector3;

/// The content of a page: a run, or the cases of a sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct Movie {
    /// Title for people.
    pub title: String,
    /// A line below it.
    pub subtitle: String,
    /// The cases; a single run is one case.
    pub cases: Vec<MovieCase>,
    /// Seconds after which the page reloads during a run; `None` for a static page.
    pub reload: Option<f64>,
}

/// A run in motion. Arrays over nodes are ordered rod after rod.
#[derive(Clone, Debug, PartialEq)]
pub struct MovieCase {
    /// Id of the case.
    pub name: String,
    /// Differences of the case from the other cases, as (key, value).
    pub distinction: Vec<(String, String)>,
    /// The scenario, as (dotted key, value).
    pub parameters: Vec<(String, String)>,
    /// The rods.
    pub rods: Vec<MovieRod>,
    /// The planes.
    pub planes: Vec<MoviePlane>,
    /// The obstacles.
    pub obstacles: Vec<MovieObstacle>,
    /// Initial view of the rods.
    pub view: View,
    /// The outputs in the order of time.
    pub frames: Vec<MovieFrame>,
    /// Fields for colouring the rods.
    pub fields: Vec<Field>,
    /// Series that can be plotted beside the motion.
    pub series: Vec<MovieSeries>,
    /// Branches of the frames if these are equilibria along a path; the time of a frame is then
    /// the path parameter.
    pub branches: Option<Vec<usize>>,
}

/// A number of the whole scene at each frame.
#[derive(Clone, Debug, PartialEq)]
pub struct MovieSeries {
    /// Display name.
    pub name: String,
    /// Unit of the series.
    pub unit: String,
    /// Values by frame.
    pub values: Vec<Option<f64>>,
}

/// A rod of a movie.
#[derive(Clone, Debug, PartialEq)]
pub struct MovieRod {
    /// Name of the rod.
    pub name: String,
    /// Number of nodes.
    pub nodes: usize,
    /// Whether the last node is joined to the first.
    pub closed: bool,
    /// Radius, m; the largest one if it varies.
    pub radius: f64,
    /// Radius at each node, m, if it varies.
    pub radii: Vec<f64>,
    /// Whether it is an obstacle, which does not move.
    pub held: bool,
    /// Whether its segments are drawn straight, with corners at its nodes, rather than as a smooth
    /// curve.
    pub straight: bool,
    /// Cross-section of the rod if rectangular; `None` for a circle.
    pub strip: Option<Strip>,
}

impl MovieRod {
    /// Radius at a node, m.
    pub fn radius_at(&self, node: usize) -> f64 {
        self.radii.get(node).copied().unwrap_or(self.radius)
    }
}

/// A rigid half space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MoviePlane {
    /// Any point of its surface, m.
    pub point: [f64; 3],
    /// Unit normal.
    pub normal: [f64; 3],
}

/// A rigid body.
#[derive(Clone, Debug, PartialEq)]
pub struct MovieObstacle {
    /// The triangles of its surface at time zero, m.
    pub triangles: Vec<[Vector3<f64>; 3]>,
    /// The transformation from time zero to each frame, in column-major order; empty if the body
    /// does not move.
    pub poses: Vec<[f64; 16]>,
    /// Whether rods are inside: it is then drawn translucent.
    pub hollow: bool,
    /// Whether it belongs to rods: it then moves with them and is included in the bounds of
    /// pictures.
    pub is_carried: bool,
}

/// The rods at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct MovieFrame {
    /// Time, s.
    pub time: f64,
    /// Positions of all nodes, m.
    pub positions: Vec<Vector3<f64>>,
    /// Positions of contacts between rods or with a plane, m.
    pub contacts: Vec<Vector3<f64>>,
}

/// A number at each node, by which rods can be coloured.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Display name.
    pub name: String,
    /// Unit of the field.
    pub unit: String,
    /// Whether its sign is meaningful: zero then has the middle colour.
    pub signed: bool,
    /// Values by frame and node.
    pub values: Vec<Vec<f64>>,
}
