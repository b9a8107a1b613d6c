//! Networks as typed.

use super::rod::Rod;
use crate::scenario::quantity::{Quantity, Vector};
use crate::scenario::resolved::{Hold, NetworkJoint};
use crate::scenario::units::{Dimensionless, Length, Time};
use schemars::JsonSchema;
use serde::Deserialize;

/// Many rods joined at their crossings, from one table.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "network")]
pub struct Network {
    /// Prefix of the names of its rods: "net_0", "net_1", ... Default: "net", which only one
    /// network may use.
    pub name: Option<String>,
    /// Properties of all rods of the network: the keys of [[rods]] except `name`, `shape` and `closed`. Here
    /// `edges` is the number of edges between adjacent crossings.
    pub rod: Option<Rod>,
    /// Places of the rods of the network.
    pub shape: Option<NetworkShape>,
    /// Joints at the crossings: "ball" (the default) or "rigid".
    pub joint: Option<NetworkJoint>,
    /// Held boundary of the network.
    pub boundary: Option<Boundary>,
}

/// Layout of the rods of a network.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(tag = "kind", deny_unknown_fields, rename = "network_shape")]
pub enum NetworkShape {
    /// Two families of straight rods across a parallelogram: first the rods along `sides[0]`, then
    /// the rods along `sides[1]`, each family in order along the other side.
    Grid {
        /// A corner. Default: [0, 0, 0].
        corner: Option<Vector<Length>>,
        /// The two sides from there.
        sides: Option<[Vector<Length>; 2]>,
        /// Numbers of rods along the first side and along the second, at least 2 each; the
        /// outermost rods form the rim.
        rods: Option<[i64; 2]>,
    },
    /// Polylines through numbered points: a tree, a lattice, a design from another program.
    Table {
        /// CSV file of the points, relative to the scenario file: columns x_m, y_m, z_m; the first one is number 0.
        points_file: Option<String>,
        /// CSV file of the rods: columns rod and point, a row for each point of a rod, in order
        /// along the rod.
        rods_file: Option<String>,
        /// The points themselves, instead of the file.
        points: Option<Vec<Vector<Length>>>,
        /// The points of each rod, instead of the file: [[0, 1, 2], [3, 1, 4], ...].
        rods: Option<Vec<Vec<i64>>>,
    },
}

/// The rim of a network: clamps at ends of its rods.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "boundary")]
pub struct Boundary {
    /// "position" (the default), "frame", or "both".
    pub hold: Option<Hold>,
    /// Held ends: "all" (the default), or only those at "corners", where ends of two rods meet.
    pub ends: Option<crate::scenario::resolved::HeldEnds>,
    /// Factor of the distances of the held ends from their centre, relative to the placed
    /// distances, at given times: [[time, factor], ...].
    pub scale: Option<Vec<(Quantity<Time>, Quantity<Dimensionless>)>>,
}
