//! Joints, bodies and networks as typed.

use crate::scenario::place::TypedPlace;
use crate::scenario::quantity::{Quantity, Vector};
use super::rod::Rod;
use crate::scenario::resolved::{Hold, NetworkJoint};
use crate::scenario::units::{
    Angle, Dimensionless, Force, ForcePerLength, Length, Mass, Moment, MomentOfInertia, Time,
    TurningStiffness,
};
use schemars::JsonSchema;
use serde::Deserialize;

/// Two nodes, of one rod or of two, that are one point from time zero on, of which one slides along the rod of the other, or
/// that a spring ties. Where three rods meet, two
/// joints share a node.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(tag = "kind", deny_unknown_fields, rename = "joint")]
pub enum Joint {
    /// The rods turn freely against each other.
    Ball {
        /// Name by which messages call it. Default: "joint 0", "joint 1", ...
        name: Option<String>,
        /// Names of the two rods; the same one twice to join a rod to itself.
        rods: Option<[String; 2]>,
        /// "start", "end", or the number of a node, of each: ["end", 4].
        at: Option<[TypedPlace; 2]>,
        /// Largest force that it bears, in a dynamic run; where a step ends with more it breaks. Only of a joint that shares its
        /// nodes with no other one. Default: it never breaks.
        break_at: Option<Quantity<Force>>,
    },
    /// The rods are welded: angles between them, and between their cross-sections, stay as placed.
    Rigid {
        /// Name by which messages call it. Default: "joint 0", "joint 1", ...
        name: Option<String>,
        /// Names of the two rods; the same one twice to join a rod to itself.
        rods: Option<[String; 2]>,
        /// "start", "end", or the number of a node, of each: ["end", 4].
        at: Option<[TypedPlace; 2]>,
        /// Largest force that it bears, in a dynamic run; where a step ends with more it breaks. Only of a joint that shares its
        /// nodes with no other one. Default: it never breaks.
        break_at: Option<Quantity<Force>>,
        /// Largest moment that it bears, as `break_at`.
        break_at_moment: Option<Quantity<Moment>>,
    },
    /// The second rod turns against the first about an axis only.
    Hinge {
        /// Name by which messages call it. Default: "joint 0", "joint 1", ...
        name: Option<String>,
        /// Names of the two rods.
        rods: Option<[String; 2]>,
        /// "start", "end", or the number of a node, of each: ["end", 4].
        at: Option<[TypedPlace; 2]>,
        /// Direction of the axis as placed; it turns with the first rod.
        axis: Option<Vector<Dimensionless>>,
        /// Moment per angle of a spring about the axis. Default: none.
        stiffness: Option<Quantity<TurningStiffness>>,
        /// Angle of the second rod against the first, from where they are placed, at which that spring exerts no moment.
        /// Default: 0.
        rest_angle: Option<Quantity<Angle>>,
        /// Largest force that it bears, in a dynamic run; where a step ends with more it breaks. Only of a joint that shares its
        /// nodes with no other one. Default: it never breaks.
        break_at: Option<Quantity<Force>>,
        /// Largest moment that it bears, that of the spring included, as `break_at`.
        break_at_moment: Option<Quantity<Moment>>,
    },
    /// The first node slides along the rod of the second, without friction, between stops at its ends.
    Slide {
        /// Name by which messages call it. Default: "joint 0", "joint 1", ...
        name: Option<String>,
        /// Names of the rod with the node that slides, and of that along which it slides; the same one twice for a noose.
        rods: Option<[String; 2]>,
        /// "start", "end", or the number of a node, of each: the one that slides, and where it begins: ["end", 4].
        at: Option<[TypedPlace; 2]>,
        /// Largest force that it bears, in a dynamic run; where a step ends with more it breaks. Default: it never breaks.
        break_at: Option<Quantity<Force>>,
    },
    /// A spring pulls the nodes together and pushes them apart, or turns the rods towards each other there; the nodes need not
    /// lie at one point. It has a `stiffness`, a `turning_stiffness`, or both.
    Spring {
        /// Name by which messages call it. Default: "joint 0", "joint 1", ...
        name: Option<String>,
        /// Names of the two rods; the same one twice to tie a rod to itself.
        rods: Option<[String; 2]>,
        /// "start", "end", or the number of a node, of each: ["end", 4].
        at: Option<[TypedPlace; 2]>,
        /// Force per lengthening.
        stiffness: Option<Quantity<ForcePerLength>>,
        /// Length without force. Default: the distance of the nodes as placed.
        rest_length: Option<Quantity<Length>>,
        /// Moment per angle by which the material frame of the second rod has turned against that of the first, about whatever
        /// axis, up to half a turn. Default: none.
        turning_stiffness: Option<Quantity<TurningStiffness>>,
        /// Rotation vector of the second frame against the first, from where they are placed, without moment: its direction is
        /// the axis, which turns with the first rod, its length the angle. Default: [0, 0, 0].
        rest_rotation: Option<Vector<Angle>>,
        /// Largest force that it bears, pulled or pushed, in a dynamic run; where a step ends with more it breaks. Default: it
        /// never breaks.
        break_at: Option<Quantity<Force>>,
        /// Largest moment by which it turns the rods, as `break_at`.
        break_at_moment: Option<Quantity<Moment>>,
    },
}

/// A mass at a node of a rod, or a rigid body welded to it there.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "body")]
pub struct Body {
    /// Name by which messages call it. Default: "body 0", "body 1", ...
    pub name: Option<String>,
    /// Name of the rod.
    pub rod: Option<String>,
    /// "start", "end", or the number of a node.
    pub at: Option<TypedPlace>,
    /// Its mass.
    pub mass: Option<Quantity<Mass>>,
    /// Its shape, of uniform density, which gives its inertia. With [contact] a sphere without `offset` touches rods, planes,
    /// obstacles and other spheres; other shapes touch nothing. Default: a point mass.
    pub shape: Option<BodyShape>,
    /// From the node to its centre of mass, along the two material directors and the tangent of the rod at the node. Default:
    /// [0, 0, 0].
    pub offset: Option<Vector<Length>>,
    /// Instead of a shape, its principal moments of inertia about its centre of mass, and axes along the two material directors
    /// and the tangent of the rod at the node.
    pub inertia: Option<[Quantity<MomentOfInertia>; 3]>,
}

/// Shape of a body of uniform density, around its centre of mass.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(tag = "kind", deny_unknown_fields, rename = "body_shape")]
pub enum BodyShape {
    /// A sphere.
    Sphere {
        /// Its radius.
        radius: Option<Quantity<Length>>,
    },
    /// A disk, or cylinder, about the tangent of the rod.
    Disk {
        /// Its radius.
        radius: Option<Quantity<Length>>,
        /// Its length along the tangent. Default: 0.
        thickness: Option<Quantity<Length>>,
    },
    /// A box with sides along the two material directors and the tangent of the rod.
    Box {
        /// Lengths of these sides.
        size: Option<Vector<Length>>,
    },
}

/// Many rods joined at their crossings, from one table.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "network")]
pub struct Network {
    /// Its rods are called by it and a number: "net_0", "net_1", ... Default: "net", which then must be the only one.
    pub name: Option<String>,
    /// What all its rods are: the keys of [[rods]] but `name`, `shape` and `closed`. `edges` counts between neighbouring
    /// crossings.
    pub rod: Option<Rod>,
    /// Where its rods lie.
    pub shape: Option<NetworkShape>,
    /// What joins them at crossings: "ball" (the default) or "rigid".
    pub joint: Option<NetworkJoint>,
    /// What of it is held.
    pub boundary: Option<Boundary>,
}

/// Where the rods of a network lie.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(tag = "kind", deny_unknown_fields, rename = "network_shape")]
pub enum NetworkShape {
    /// Two families of straight rods across a parallelogram: first those along `sides[0]`, then those along `sides[1]`,
    /// each in the order of the other side.
    Grid {
        /// A corner. Default: [0, 0, 0].
        corner: Option<Vector<Length>>,
        /// The two sides from there.
        sides: Option<[Vector<Length>; 2]>,
        /// Numbers of rods along the first side and along the second, at least 2 each; the outer ones lie on the rim.
        rods: Option<[i64; 2]>,
    },
    /// Polylines through numbered points: a tree, a lattice, whatever was designed elsewhere.
    Table {
        /// CSV file of the points, relative to the scenario file: columns x_m, y_m, z_m; the first one is number 0.
        points_file: Option<String>,
        /// CSV file of the rods: columns rod and point, a row for each point that a rod runs through, in order.
        rods_file: Option<String>,
        /// The points themselves, instead of the file.
        points: Option<Vec<Vector<Length>>>,
        /// The points of each rod, instead of the file: [[0, 1, 2], [3, 1, 4], ...].
        rods: Option<Vec<Vec<i64>>>,
    },
}

/// The rim of a network: ends of its rods.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "boundary")]
pub struct Boundary {
    /// "position" (the default), "frame", or "both".
    pub hold: Option<Hold>,
    /// Which ends are held: "all" (the default), or only those at "corners", where ends of two rods meet.
    pub ends: Option<crate::scenario::resolved::HeldEnds>,
    /// How far they are from their centre, over how far they are as placed, at given times: [[time, factor], ...].
    pub scale: Option<Vec<(Quantity<Time>, Quantity<Dimensionless>)>>,
}
