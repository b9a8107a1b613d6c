//! The flow of the fluid without rods.

use crate::scenario::declaration::keys;
use crate::scenario::section::{FINITE, Section};
use crate::scenario::units::{AngularVelocity, Dimensionless, Frequency, Length, Velocity};

keys! {
    /// Flow of the fluid without rods: wind, a current, a shear. Drag acts on the velocity of rods
    /// relative to it.
    kinds FlowKeys "flow", "kebab-case" => Flow()
    before {}
    also {}
    FlowKind {
        /// The same velocity everywhere.
        Uniform {
            /// The velocity.
            velocity: vector(Velocity) required,
        },
        /// A velocity that grows in proportion to the distance from a plane.
        Shear {
            /// Direction of the velocity.
            direction: direction() required,
            /// Direction in which the velocity grows: the normal of the plane.
            gradient: direction() required,
            /// Velocity per distance from the plane.
            rate: number(Frequency, FINITE) required,
            /// A point of the plane, where the fluid is at rest.
            point: vector(Length) default([0.0; 3]),
        },
        /// Rotation of the fluid as a rigid body.
        Rotation {
            /// Direction of the axis.
            axis: direction() required,
            /// Angular velocity about the axis.
            angular_velocity: number(AngularVelocity, FINITE) required,
            /// A point of the axis.
            point: vector(Length) default([0.0; 3]),
        },
        /// A velocity in one direction, tabulated along another, such as a wind over its height.
        Profile {
            /// Direction of the velocity.
            direction: direction() required,
            /// Direction along which positions are measured, from the origin.
            along: direction() required,
            /// Velocity at given positions, [[position, velocity], ...], linear between them and
            /// constant beyond.
            velocities: rows(Length, Velocity) required,
        },
    }
    after {
        /// Factor at given times, [[time, factor], ...], linear between them: gusts. Default: 1
        /// always.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        schedule: corners(Dimensionless) derived(Vec::new()),
    }
}

impl Flow {
    /// Reports a schedule in a run without time.
    pub fn refuse_schedule(&self, section: &Section<'_>) {
        if !self.schedule.is_empty() {
            section.below("flow").fault(
                "schedule",
                "a static run has no time; leave the key out, and give the flow at rest",
            );
        }
    }
}
