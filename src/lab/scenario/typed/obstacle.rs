//! Obstacles as typed.

use super::movement::{Pose, Translation, Turn, TypedMovement, moving};
use crate::scenario::declaration::keys;
use crate::scenario::quantity::Quantity;
use crate::scenario::section::{CREASE, FINITE, NON_NEGATIVE, POSITIVE, Section, UP};
use crate::scenario::units::{Angle, AngularVelocity, Dimensionless, Length};
use schemars::JsonSchema;
use serde::Deserialize;

moving! {
    /// A rigid body that rods may touch, fixed or moved.
    table Obstacle "obstacle" {
        /// Name for probes and messages. Default: "obstacle 0", "obstacle 1", ...
        name: raw(String) raw,
        /// Shape of the obstacle, and its place at time zero.
        shape: raw(ObstacleShape) raw,
        /// Friction coefficient between obstacle and rods. Default: the friction of [contact].
        friction: number(Dimensionless, NON_NEGATIVE) optional,
    }
}

/// The shape of an obstacle.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(tag = "kind", rename = "obstacle_shape")]
pub enum ObstacleShape {
    /// A sphere.
    Sphere(Sphere),
    /// A cylinder with round ends.
    Capsule(Capsule),
    /// A cylinder without ends.
    Cylinder(Cylinder),
    /// The inside of a tube, open at both ends. Rods inside stay inside, and a rod that leaves
    /// through an end touches the rim. There is no contact from outside.
    Tube(Capsule),
    /// A box, with edges rounded to the radius `rounding`.
    Box(Cuboid),
    /// A triangle mesh: a body, touched from outside, or with `closed = false` a sheet, touched from both sides.
    Mesh(Mesh),
    /// A surface z(x, y) over a grid, touched from both sides.
    Heights(Heights),
}

keys! {
    /// A sphere.
    table Sphere "sphere" {
        /// Centre.
        centre: vector(Length) required,
        /// Radius.
        radius: number(Length, POSITIVE) required,
    }
}

keys! {
    /// A cylinder with round ends: all points within the radius of a segment; or the inside of a tube, with its inner radius.
    table Capsule "capsule" {
        /// First end of the segment.
        start: vector(Length) required,
        /// Last end.
        end: vector(Length) required,
        /// Radius.
        radius: number(Length, POSITIVE) required,
    }
}

keys! {
    /// A cylinder without ends.
    table Cylinder "cylinder" {
        /// Any point of its axis.
        point: vector(Length) required,
        /// Direction of its axis.
        direction: direction() required,
        /// Radius.
        radius: number(Length, POSITIVE) required,
    }
}

keys! {
    /// A box. Its sides lie along x, y and z, unless it is turned.
    table Cuboid "box" {
        /// Centre.
        centre: vector(Length) required,
        /// Lengths of the three sides, from surface to surface.
        size: vector(Length, POSITIVE) required,
        /// Radius of the rounding of its edges, less than half of the shortest side.
        rounding: number(Length, NON_NEGATIVE) default(0.0),
        /// Axis of its rotation.
        axis: direction() default(UP),
        /// Angle of its rotation about its centre.
        angle: number(Angle, FINITE) default(0.0),
    }
}

keys! {
    /// A triangle mesh; give `file`, or `vertices` and `triangles`. It is first scaled, then
    /// turned, then moved.
    table Mesh "mesh" {
        /// STL or OBJ file, relative to the scenario file.
        file: raw(String) raw,
        /// Length of a unit of the file, for example "1 mm".
        unit: number(Length, POSITIVE) default(1.0),
        /// Position of the origin of the file.
        position: vector(Length) default([0.0; 3]),
        /// Axis of its rotation.
        axis: direction() default(UP),
        /// Angle of its rotation about the origin of the file.
        angle: number(Angle, FINITE) default(0.0),
        /// The vertices themselves, in m.
        vertices: raw(Vec<[f64; 3]>) raw,
        /// Three vertices of each triangle, counted from 0, anticlockwise as seen from outside.
        triangles: raw(Vec<[i64; 3]>) raw,
        /// Whether the triangles enclose a body, which rods touch from outside; false for a sheet, which they touch from both
        /// sides.
        closed: flag() default(true),
        /// Whether the triangles stand for a smooth surface through their corners.
        smooth: flag() default(false),
        /// With `smooth`: largest angle between the normals of two triangles with a smooth side between them; above it the side is a
        /// crease.
        crease_angle: number(Angle, CREASE) optional,
    }
}

keys! {
    /// A surface over a grid along x and y.
    table Heights "heights" {
        /// Position of the first height.
        origin: vector(Length) default([0.0; 3]),
        /// Spacing of the grid.
        spacing: number(Length, POSITIVE) required,
        /// Heights above the origin: rows along y of values along x, at least two of each.
        heights: raw(Vec<Vec<Quantity<Length>>>) raw,
        /// Whether the surface is smooth; otherwise it consists of triangles.
        smooth: flag() default(false),
    }
}
