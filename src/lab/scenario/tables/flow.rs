//! The flow of the fluid without rods.

use crate::scenario::declaration::keys;
use crate::scenario::section::{FINITE, Section};
use crate::scenario::units::{AngularVelocity, Dimensionless, Frequency, Length, Velocity};

/// Largest cosine of directions that count as perpendicular.
const PERPENDICULAR: f64 = 1e-6;

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
            /// Direction in which the velocity grows: the normal of the plane, perpendicular to
            /// `direction`.
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
        /// Stretching of the fluid without rotation, about a stagnation point.
        Extension {
            /// Rate at which the fluid is stretched.
            rate: number(Frequency, FINITE) required,
            /// Direction in which the fluid is stretched.
            stretched: direction() required,
            /// Direction, perpendicular to that, in which it is compressed at the same rate: a
            /// planar flow. Default: all directions across `stretched`, at half the rate.
            compressed: direction() optional,
            /// The stagnation point, where the fluid is at rest.
            point: vector(Length) default([0.0; 3]),
        },
        /// A velocity in one direction, tabulated along another, such as a wind over its height.
        Profile {
            /// Direction of the velocity.
            direction: direction() required,
            /// Direction along which positions are measured, from the origin; perpendicular to
            /// `direction`.
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
    /// Reports directions that are not perpendicular, for which the fluid would be compressible.
    pub fn check_directions(&self, section: &Section<'_>) {
        let (key, pair, fault) = match &self.kind {
            FlowKind::Shear {
                direction,
                gradient,
                ..
            } => (
                "gradient",
                [direction, gradient],
                "it is not perpendicular to `direction`; a velocity that grows along itself would \
                 compress the fluid",
            ),
            FlowKind::Profile {
                direction, along, ..
            } => (
                "along",
                [direction, along],
                "it is not perpendicular to `direction`; a velocity that changes along itself \
                 would compress the fluid",
            ),
            FlowKind::Extension {
                stretched,
                compressed: Some(compressed),
                ..
            } => (
                "compressed",
                [stretched, compressed],
                "it is not perpendicular to `stretched`; without this key the fluid is \
                 compressed in all directions across",
            ),
            _ => return,
        };
        let cosine: f64 = pair[0].iter().zip(pair[1]).map(|(a, b)| a * b).sum();
        if cosine.abs() > PERPENDICULAR {
            section.below("flow").fault(key, fault);
        }
    }

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
