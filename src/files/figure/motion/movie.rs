//! What moves in a film and on the page.

use super::super::View;
use super::strip::Strip;
use nalgebra::Vector3;

/// Everything that a page shows: a run, or the cases of a sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct Movie {
    /// Title for people.
    pub title: String,
    /// A line below it.
    pub subtitle: String,
    /// The cases; a single run is one.
    pub cases: Vec<MovieCase>,
    /// Seconds after which the page loads itself again, while a run is at work; none for a page that stays as it is.
    pub reload: Option<f64>,
}

/// A run in motion. Arrays over nodes run rod after rod.
#[derive(Clone, Debug, PartialEq)]
pub struct MovieCase {
    /// Id of the case.
    pub name: String,
    /// What sets it apart from the other cases, as (key, value).
    pub distinction: Vec<(String, String)>,
    /// The scenario, as (dotted key, value).
    pub parameters: Vec<(String, String)>,
    /// The rods.
    pub rods: Vec<MovieRod>,
    /// The planes.
    pub planes: Vec<MoviePlane>,
    /// The obstacles.
    pub obstacles: Vec<MovieObstacle>,
    /// From where the rods are looked at first.
    pub view: View,
    /// The outputs in the order of time.
    pub frames: Vec<MovieFrame>,
    /// What the rods can be coloured by.
    pub fields: Vec<Field>,
    /// What can be plotted beside the motion.
    pub series: Vec<MovieSeries>,
    /// Branches of the frames where these are equilibria along a path: then their time is its parameter.
    pub branches: Option<Vec<usize>>,
}

/// A number of the whole scene at each frame.
#[derive(Clone, Debug, PartialEq)]
pub struct MovieSeries {
    /// Its name for people.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Values by frame.
    pub values: Vec<Option<f64>>,
}

/// A rod of a movie.
#[derive(Clone, Debug, PartialEq)]
pub struct MovieRod {
    /// Its name.
    pub name: String,
    /// Number of nodes.
    pub nodes: usize,
    /// Whether the last node is joined to the first.
    pub closed: bool,
    /// Radius, m.
    pub radius: f64,
    /// Whether it is an obstacle, which does not move.
    pub held: bool,
    /// Its cross-section where that is a rectangle; circles have none.
    pub strip: Option<Strip>,
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
    /// The matrix that carries it from there to each frame, column after column; none where it stays.
    pub poses: Vec<[f64; 16]>,
    /// Whether rods are inside: it is then drawn half clear.
    pub hollow: bool,
    /// Whether rods carry it: it then moves with them, and pictures leave room for it.
    pub is_carried: bool,
}

/// The rods at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct MovieFrame {
    /// Time, s.
    pub time: f64,
    /// Positions of all nodes, m.
    pub positions: Vec<Vector3<f64>>,
    /// Where rods touch each other or a plane, m.
    pub contacts: Vec<Vector3<f64>>,
}

/// A number at each node that rods can be coloured by.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Its name for people.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Whether its sign means something: then zero has the colour in the middle.
    pub signed: bool,
    /// Values by frame and node.
    pub values: Vec<Vec<f64>>,
}
