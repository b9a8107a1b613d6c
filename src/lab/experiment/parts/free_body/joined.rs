//! Axles of free bodies, and rods that are joined to them.

use super::keys::{FreeBodyKeys, JoinedKeys, JoinedKind};
use crate::experiment::places::{find_place, find_rod};
use crate::scenario::keys::Section;
use crate::scenario::{Issue, KeyPath, Place};
use rodlab_engine::mechanics::scene::{self, BodyJoint, JointKind, RodDescription, RodNode};
use rodlab_engine::mechanics::{Matrix3, Vector3};
use serde::Serialize;

/// Smallest cosine of the angle between an axle and the angular velocity of its body.
const ALONG: f64 = 1.0 - 1e-9;

/// An axle through the centre of mass of a body.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Axle {
    /// Unit vector along it.
    pub axle: [f64; 3],
    /// Moment of inertia about it, kg m²; `None` is that of the uniform body.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub inertia: Option<f64>,
    /// Largest moment of the friction in its bearing, N m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub brake: Option<f64>,
    /// Moment about it at given times, (s, N m).
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub torque: Vec<(f64, f64)>,
}

impl Axle {
    /// The axle of a body; faults name the keys that belong to axles or contradict them.
    pub fn resolve(section: &Section<'_>, typed: &FreeBodyKeys) -> Option<Self> {
        let axle = typed.axle(section);
        let own = Self {
            axle: axle.unwrap_or_default(),
            inertia: typed.inertia(section),
            brake: typed.brake(section),
            torque: typed.torque(section, Vec::new()),
        };
        let Some(axle) = axle else {
            let of_axles = [
                ("inertia", own.inertia.is_some()),
                ("brake", own.brake.is_some()),
                ("torque", !own.torque.is_empty()),
            ];
            section.refuse(&of_axles, "this key belongs to bodies with an `axle`");
            return None;
        };
        if typed.velocity(section) != [0.0; 3] {
            section.fault(
                "velocity",
                "the centre of a body with an `axle` does not move",
            );
        }
        let spin = Vector3::from(typed.angular_velocity(section));
        if spin.dot(&Vector3::from(axle)).abs() < ALONG * spin.norm() {
            section.fault("angular_velocity", "a body turns about its `axle` alone");
        }
        Some(own)
    }

    /// The axle of a body with the given principal moments of inertia (kg m²), whose axes are the
    /// columns of a matrix.
    pub fn placed(&self, moments: [f64; 3], axes: &Matrix3) -> scene::Axle {
        let direction = Vector3::from(self.axle);
        let parts = axes.tr_mul(&direction);
        let uniform = parts.component_mul(&parts).dot(&Vector3::from(moments));
        scene::Axle {
            direction,
            inertia: self.inertia.unwrap_or(uniform),
            brake: self.brake.unwrap_or(0.0),
            torque: self.torque.clone(),
        }
    }
}

/// A rod that is joined to a body.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Joined {
    /// Name of the rod.
    pub rod: String,
    /// The node.
    pub at: Place,
    /// What the joint leaves free.
    pub kind: JoinedKind,
    /// Unit vector along the axis of a hinge.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub axis: Option<[f64; 3]>,
}

impl Joined {
    /// The joint of a table.
    pub fn resolve(section: &Section<'_>, typed: &JoinedKeys) -> Self {
        let (kind, axis) = (typed.kind(section), typed.axis(section));
        match (kind, axis) {
            (JoinedKind::Hinge, None) => {
                section.missing("axis", "the axis of the hinge, such as [0, 1, 0]");
            }
            (JoinedKind::Ball | JoinedKind::Rigid, Some(_)) => {
                section.fault("axis", "this key belongs to joints of the kind \"hinge\"");
            }
            _ => {}
        }
        Self {
            rod: typed.rod(section),
            at: typed.at(section),
            kind,
            axis,
        }
    }

    /// The joint in a scene with these rods.
    ///
    /// # Errors
    /// A rod or node that does not exist.
    pub fn placed(&self, rods: &[RodDescription], path: &KeyPath) -> Result<BodyJoint, Issue> {
        let rod = find_rod(&self.rod, rods, &path.key("rod"))?;
        let nodes = rods[rod].centreline.len();
        let node = find_place(self.at, nodes, "node", &rods[rod], &path.key("at"))?;
        let kind = match self.kind {
            JoinedKind::Ball => JointKind::Ball,
            JoinedKind::Rigid => JointKind::Rigid,
            JoinedKind::Hinge => JointKind::Hinge {
                axis: Vector3::from(self.axis.unwrap_or_default()),
                spring: None,
            },
        };
        let at = RodNode { rod, node };
        Ok(BodyJoint { at, kind })
    }
}
