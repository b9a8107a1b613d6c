//! The rods and obstacles at one output time.

use super::RodRecord;
use nalgebra::{Isometry3, Vector3};

/// All data of the rods that are written at an output time; arrays run over all nodes, rod after
/// rod.
#[derive(Clone, Debug, Default)]
pub struct Frame {
    /// Time, s.
    pub time: f64,
    /// Positions of the nodes, m.
    pub positions: Vec<Vector3<f64>>,
    /// Angle of the edge that starts at each node, rad; values at nodes without an edge are not
    /// read.
    pub edge_angles: Vec<f64>,
    /// Twist per length at each node, rad/m; may be empty unless node forces are written.
    pub twist_rates: Vec<f64>,
    /// Velocities of the nodes, m/s; may be empty unless node forces or VTK are written.
    pub velocities: Vec<Vector3<f64>>,
    /// Forces of the fluid on the nodes, N; empty without a fluid.
    pub fluid_forces: Vec<Vector3<f64>>,
    /// Contact forces on the nodes, N; empty without contact.
    pub contact_forces: Vec<Vector3<f64>>,
    /// Places at which surfaces press on each other; may be empty unless contacts are written.
    pub contacts: Vec<ContactRecord>,
    /// Motion of obstacles since time zero; may be empty if none moves.
    pub obstacle_poses: Vec<Isometry3<f64>>,
}

/// A place at which two surfaces press on each other.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactRecord {
    /// Names of the rods, free bodies, obstacles or planes.
    pub names: [String; 2],
    /// Nodes along rods; `None` for others.
    pub nodes: [Option<usize>; 2],
    /// The place on the surface of the first, m.
    pub place: Vector3<f64>,
    /// Unit normal, towards the first.
    pub normal: Vector3<f64>,
    /// Distance between the surfaces, m.
    pub gap: f64,
    /// Normal force, N.
    pub normal_force: f64,
    /// Friction on the first, N.
    pub friction: Vector3<f64>,
}

/// A node of a frame: its rod, its index along the rod, its index among all nodes.
#[derive(Clone, Copy, Debug)]
pub(super) struct NodePlace<'a> {
    pub rod: &'a RodRecord,
    pub node: usize,
    pub index: usize,
}

impl NodePlace<'_> {
    /// Whether an edge starts at the node: at every node except the last one of an open rod.
    pub fn starts_edge(&self) -> bool {
        self.rod.closed || !self.rod.rigid && self.node + 1 < self.rod.nodes
    }
}

/// All nodes of the rods, in the order of the arrays of a [`Frame`].
pub(super) fn node_places(rods: &[RodRecord]) -> impl Iterator<Item = NodePlace<'_>> {
    rods.iter()
        .flat_map(|rod| (0..rod.nodes).map(move |node| (rod, node)))
        .enumerate()
        .map(|(index, (rod, node))| NodePlace { rod, node, index })
}
