//! Keys of free bodies.

use crate::scenario::keys::{FINITE, NON_NEGATIVE, POSITIVE, keys};
use crate::scenario::units::{
    Angle, AngularVelocity, Density, Dimensionless, Length, Mass, Moment, MomentOfInertia, Velocity,
};

/// Upwards, the default axis of rotations.
const UP: [f64; 3] = [0.0, 0.0, 1.0];
/// Sides of the prism that represents a cylinder.
const SIDES: usize = 24;
const MOST_SIDES: usize = 200;

keys! {
    /// A rigid body. It moves freely or turns about an axle, and touches rods, planes, obstacles and
    /// other free bodies with friction if there is a table `[contact]`.
    table FreeBodyKeys "free_body" {
        /// Name for probes, loads and messages. Default: "free body 0", "free body 1", ...
        name: text() derived,
        /// Shape of the body, about its centre.
        shape: raw(FreeShapeKeys) raw,
        /// Position of its centre: for a mesh, that of the origin of its vertices.
        position: vector(Length) required,
        /// Axis of its rotation.
        axis: direction() default(UP),
        /// Angle of its rotation about its centre.
        angle: number(Angle, FINITE) default(0.0),
        /// Mass of the body, which is uniform; give `mass` or `density`.
        mass: number(Mass, POSITIVE) optional,
        /// Density of the body.
        density: number(Density, POSITIVE) optional,
        /// Velocity of its centre of mass at time zero.
        velocity: vector(Velocity) default([0.0; 3]),
        /// Angular velocity at time zero.
        angular_velocity: vector(AngularVelocity) default([0.0; 3]),
        /// Friction coefficient of the body with all that it touches; with a body that has a
        /// coefficient of its own, the geometric mean of both. Needs [contact]. Default: that of
        /// the plane, obstacle or rod, or `contact.friction`.
        friction: number(Dimensionless, NON_NEGATIVE) optional,
        /// Direction of an axle through its centre of mass, which does not move: the body only
        /// turns about it, as a pulley, a drum or a roller.
        axle: direction() optional,
        /// Moment of inertia about the axle. Default: that of the uniform body.
        inertia: number(MomentOfInertia, POSITIVE) optional,
        /// Largest moment of the friction in the bearing of the axle.
        brake: number(Moment, NON_NEGATIVE) optional,
        /// Moment about the axle at given times, [[time, moment], ...], linear between them and
        /// constant outside: a motor. Default: none.
        torque: corners(Moment) derived,
        /// Rods that are joined to the body where their nodes are placed: a weight on a rope, a
        /// table on legs.
        #[serde(default)]
        joined: tables(Vec<JoinedKeys>) raw,
    }
}

keys! {
    /// A node of a rod that is a point of the body.
    table JoinedKeys "joined_rod" {
        /// Name of the rod.
        rod: text("the name of a rod") required,
        /// Node that is joined: "start", "end" or a number.
        at: place() required,
        /// What the joint leaves free: "ball" (every rotation of the rod against the body), "rigid"
        /// (nothing) or "hinge" (the rotation about `axis`).
        kind: word(JoinedKind) default(JoinedKind::Ball),
        /// Axis of a hinge as placed; it turns with the body.
        axis: direction() optional,
    }
}

/// What a joint of a rod and a body leaves free.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    serde::Serialize,
    serde::Deserialize,
    schemars::JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum JoinedKind {
    #[default]
    /// Every rotation.
    Ball,
    /// Nothing.
    Rigid,
    /// The rotation about an axis.
    Hinge,
}

/// The shape of a free body. Corners and edges are rounded.
#[derive(Debug, serde::Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(tag = "kind", rename = "free_shape")]
pub enum FreeShapeKeys {
    /// A sphere.
    Sphere(SphereKeys),
    /// A cylinder with round ends, along z.
    Capsule(CapsuleKeys),
    /// A box with sides along x, y and z.
    Box(BoxKeys),
    /// A cylinder with flat ends, along z, as a prism whose corners are on the circle.
    Cylinder(CylinderKeys),
    /// A convex mesh.
    Mesh(MeshKeys),
}

keys! {
    /// A sphere.
    table SphereKeys "free_sphere" {
        /// Radius of the sphere.
        radius: number(Length, POSITIVE) required,
    }
}

keys! {
    /// A cylinder with round ends, along z.
    table CapsuleKeys "free_capsule" {
        /// Radius of the capsule.
        radius: number(Length, POSITIVE) required,
        /// Length of its axis between the centres of its ends.
        length: number(Length, POSITIVE) required,
    }
}

keys! {
    /// A box with sides along x, y and z.
    table BoxKeys "free_box" {
        /// Lengths of its sides, from surface to surface.
        size: vector(Length, POSITIVE) required,
        /// Radius of the rounding of its edges, less than half of the shortest side. Default: a
        /// twentieth of the shortest side.
        rounding: number(Length, POSITIVE) derived,
    }
}

keys! {
    /// A cylinder with flat ends, along z.
    table CylinderKeys "free_cylinder" {
        /// Radius of the cylinder.
        radius: number(Length, POSITIVE) required,
        /// Length of the cylinder, from surface to surface.
        length: number(Length, POSITIVE) required,
        /// Radius of the rounding of its edges, less than its radius and half of its length.
        /// Default: a tenth of the smaller of the two.
        rounding: number(Length, POSITIVE) derived,
        /// Number of its flat sides.
        sides: count(3..=MOST_SIDES) default(SIDES),
    }
}

keys! {
    /// A convex mesh; give `file`, or `vertices` and `triangles`. The surface is at the distance `rounding` from its triangles.
    table MeshKeys "free_mesh" {
        /// STL or OBJ file, relative to the scenario file.
        file: raw(String) raw,
        /// Length of a unit of the file, for example "1 mm".
        unit: number(Length, POSITIVE) default(1.0),
        /// The vertices, in m.
        vertices: raw(Vec<[f64; 3]>) raw,
        /// Three vertices of each triangle, counted from 0, anticlockwise as seen from outside.
        triangles: raw(Vec<[i64; 3]>) raw,
        /// Distance of the surface from the triangles.
        rounding: number(Length, POSITIVE) required,
    }
}
