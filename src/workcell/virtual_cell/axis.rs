//! External axes of a virtual cell; they follow joint trajectories as arms do.

use crate::cell::{Arm, Axis, Cell, Driver};
use nalgebra::Vector3;
use rodlab_robot::{Chain, Joint, JointKind, Motion, Pose, Segment};

/// Indices of the axes that a virtual cell moves: those with a driver of kind `rosbridge`. As
/// moving parts they are numbered after the arms.
pub fn served_axes(cell: &Cell) -> impl Iterator<Item = usize> + '_ {
    let axes = cell.axes.iter().enumerate();
    let served = axes.filter(|(_, axis)| matches!(axis.driver, Some(Driver::Rosbridge { .. })));
    served.map(|(index, _)| index)
}

/// An axis as an arm with one joint, at zero.
pub fn as_arm(axis: &Axis) -> Arm {
    let joint = Joint {
        name: axis.name.clone(),
        kind: JointKind::Revolute,
        limits: axis.limits,
    };
    Arm {
        name: axis.name.clone(),
        chain: Chain {
            joints: vec![joint],
            segments: vec![Segment {
                link: axis.name.clone(),
                origin: Pose::identity(),
                motion: Motion::Driven {
                    kind: JointKind::Revolute,
                    axis: Vector3::x_axis(),
                    joint: 0,
                    ratio: 1.0,
                    offset: 0.0,
                },
            }],
            followers: Vec::new(),
            tool: Pose::identity(),
        },
        base: Pose::identity(),
        home: vec![0.0],
        bodies: Vec::new(),
        may_touch: Vec::new(),
        efforts: Vec::new(),
        driver: axis.driver.clone(),
        gripper: None,
    }
}

/// The arms of a cell, then its served axes.
pub fn moving_parts(cell: &Cell) -> Vec<Arm> {
    let arms = cell.arms.iter().cloned();
    arms.chain(served_axes(cell).map(|axis| as_arm(&cell.axes[axis])))
        .collect()
}
