//! Elements of contacts with free bodies.
//!
//! A contact joins up to four nodes. A vertex of a free body moves by δx + δψ × d with the centre
//! of mass and the rotation of the body, so the vertices of one body in a contact are replaced by
//! these six unknowns: δq = P δr, and the element has the matrix Pᵀ J P. A contact of two bodies
//! has twelve. The change of the moments of forces with the rotation of the body is added by
//! [`super::joints`].

use super::Assembly;
use super::node_element::element_of;
use crate::linalg::{Element, ElementMatrix, UNUSED};
use crate::mechanics::contact::{EdgeJacobian, SPUN, SpunJacobian};
use crate::mechanics::rod::STRIDE;
use crate::mechanics::{Matrix3, Vector3};

/// The free bodies to which nodes belong.
#[derive(Default)]
pub(crate) struct AttachedNodes {
    /// For each node, the body of which it is a vertex; empty without free bodies.
    bodies_of: Vec<Option<usize>>,
    bodies: Vec<Body>,
    /// Vectors d from the centre of mass to each node, m.
    arms: Vec<Vector3>,
}

/// A body as six unknowns.
struct Body {
    /// Index of its frame.
    frame: usize,
    /// Those of its centre of mass, and of its rotation vector or its angle about an axle.
    unknowns: [usize; 6],
    /// Rotation per unknown of the rotation: the columns of J/ℓ, or the axle.
    rates: Matrix3,
}

impl AttachedNodes {
    /// Nodes of the free bodies of a scene.
    pub(crate) fn of(assembly: &Assembly) -> Self {
        let mut attached = Self::default();
        for (number, frame, vertices) in assembly.joints.free_frames() {
            attached.bodies_of.resize(assembly.rods.nodes, None);
            attached.arms.resize(assembly.rods.nodes, Vector3::zeros());
            let body = attached.bodies.len();
            attached.bodies_of[vertices.nodes()].fill(Some(body));
            let [centre, first] = [STRIDE * vertices.centre, frame.first_unknown];
            let turning = match frame.hinge {
                None => [first, first + 1, first + 2],
                Some(_) => [first + 3, UNUSED, UNUSED],
            };
            let [x, y, z] = turning;
            attached.bodies.push(Body {
                frame: number,
                unknowns: [centre, centre + 1, centre + 2, x, y, z],
                rates: Matrix3::identity(),
            });
        }
        attached
    }

    /// Sets the rotations to those of the last evaluation, which was at `unknowns`.
    pub(crate) fn turn(&mut self, assembly: &Assembly, unknowns: &[f64]) {
        for body in &mut self.bodies {
            let joints = &assembly.joints;
            let (of_vector, axle) = joints.rates_of_frame(body.frame, unknowns);
            let about = |axle| Matrix3::from_columns(&[axle, Vector3::zeros(), Vector3::zeros()]);
            body.rates = axle.map_or(of_vector, about);
            let rotation = joints.rotation(body.frame);
            if let Some(vertices) = &joints.frames[body.frame].vertices {
                for (node, arm) in vertices.nodes().zip(&vertices.arms) {
                    self.arms[node] = rotation * arm;
                }
            }
        }
    }

    /// Transfers forces on vertices to forces on the unknowns of their bodies.
    pub(crate) fn gather(&self, forces: &mut [f64]) {
        for (node, body) in self.bodies_of.iter().enumerate() {
            let Some(body) = *body else {
                continue;
            };
            let own = &mut forces[STRIDE * node..STRIDE * node + 3];
            let force = Vector3::from_column_slice(own);
            own.fill(0.0);
            for (unknown, part) in self.bodies[body].unknowns.iter().zip(&force) {
                forces[*unknown] += part;
            }
            self.add_moment(body, &self.arms[node].cross(&force), forces);
        }
    }

    /// Moves the vertices with their bodies.
    pub(crate) fn spread(&self, moves: &mut [f64]) {
        for (node, body) in self.bodies_of.iter().enumerate() {
            let Some(body) = *body else {
                continue;
            };
            let [x, y, z, ..] = self.bodies[body].unknowns;
            let centre = Vector3::new(moves[x], moves[y], moves[z]);
            let moved = centre + self.turn_of(body, moves).cross(&self.arms[node]);
            moves[STRIDE * node..STRIDE * node + 3].copy_from_slice(moved.as_slice());
        }
    }

    /// Rotation of a body, in the fixed frame, for moves of the unknowns, rad.
    pub(crate) fn turn_of(&self, body: usize, moves: &[f64]) -> Vector3 {
        let own = &self.bodies[body];
        let turns = own.unknowns[3..].iter().enumerate();
        turns
            .filter(|(_, unknown)| **unknown != UNUSED)
            .map(|(k, unknown)| own.rates.column(k) * moves[*unknown])
            .sum()
    }

    /// Whether there are none.
    pub(crate) fn is_empty(&self) -> bool {
        self.bodies.is_empty()
    }

    /// Whether a node is a vertex of a body.
    pub(crate) fn contains(&self, node: usize) -> bool {
        self.body_of(node).is_some()
    }

    /// The body of which a node is a vertex.
    fn body_of(&self, node: usize) -> Option<usize> {
        self.bodies_of.get(node).copied().flatten()
    }

    /// Whether one of several nodes is a vertex of a body.
    fn has_any(&self, nodes: &[usize]) -> bool {
        nodes.iter().any(|node| self.body_of(*node).is_some())
    }

    /// The element of up to four nodes.
    pub(crate) fn element_of(&self, nodes: &[usize]) -> Element {
        if !self.has_any(nodes) {
            return element_of(nodes);
        }
        let mut element = [UNUSED; 12];
        self.visit(nodes, |_, node, first| match self.body_of(node) {
            None => (0..3).for_each(|axis| element[first + axis] = STRIDE * node + axis),
            Some(body) => element[first..first + 6].copy_from_slice(&self.bodies[body].unknowns),
        });
        element
    }

    /// The matrix of that element for a derivative of forces over the coordinates of the nodes,
    /// with the opposite sign.
    pub(crate) fn matrix_of(&self, nodes: &[usize], jacobian: &EdgeJacobian) -> ElementMatrix {
        if !self.has_any(nodes) {
            return jacobian.map(|row| row.map(|entry| -entry));
        }
        let motion = self.motion_by_unknowns::<12>(nodes, [None; 2]);
        transformed(&motion, jacobian)
    }

    /// The matrix of the element of several nodes for a contact with friction at the surfaces of
    /// free bodies.
    pub(crate) fn matrix_of_spun(
        &self,
        nodes: &[usize],
        bodies: [Option<usize>; 2],
        jacobian: &SpunJacobian,
    ) -> ElementMatrix {
        let motion = self.motion_by_unknowns::<SPUN>(nodes, bodies);
        transformed(&motion, jacobian)
    }

    /// P: the motion of the coordinates of several nodes, and of the rotations of the given bodies
    /// where they belong to the coordinates of a contact, by the unknowns of the element.
    fn motion_by_unknowns<const N: usize>(
        &self,
        nodes: &[usize],
        bodies: [Option<usize>; 2],
    ) -> [[f64; 12]; N] {
        let mut motion = [[0.0; 12]; N];
        self.visit(nodes, |corner, node, first| {
            for axis in 0..3 {
                motion[3 * corner + axis][first + axis] = 1.0;
            }
            let Some(body) = self.body_of(node) else {
                return;
            };
            let rates = self.bodies[body].rates;
            let turned = -self.arms[node].cross_matrix() * rates;
            for row in 0..3 {
                for column in 0..3 {
                    motion[3 * corner + row][first + 3 + column] = turned[(row, column)];
                    let sides = bodies.iter().enumerate();
                    for (side, _) in sides.filter(|(_, own)| **own == Some(body)) {
                        motion[12 + 3 * side + row][first + 3 + column] = rates[(row, column)];
                    }
                }
            }
        });
        motion
    }

    /// Adds a moment on a body, in the fixed frame, to forces on the unknowns.
    pub(crate) fn add_moment(&self, body: usize, moment: &Vector3, forces: &mut [f64]) {
        let own = &self.bodies[body];
        let over = own.rates.transpose() * moment;
        for (unknown, part) in own.unknowns[3..].iter().zip(&over) {
            if *unknown != UNUSED {
                forces[*unknown] += part;
            }
        }
    }

    /// Passes the corner, the node and its first place in the element of several nodes.
    fn visit(&self, nodes: &[usize], mut visit: impl FnMut(usize, usize, usize)) {
        let mut places: [Option<(usize, usize)>; 2] = [None; 2];
        let mut next = 0;
        for (corner, &node) in nodes.iter().enumerate() {
            let Some(body) = self.body_of(node) else {
                visit(corner, node, next);
                next += 3;
                continue;
            };
            let known = places.iter().flatten().find(|(of, _)| *of == body);
            let first = match known {
                Some((_, first)) => *first,
                None => {
                    let free = places.iter_mut().find(|place| place.is_none());
                    *free.expect("a contact joins two bodies at most") = Some((body, next));
                    next += 6;
                    next - 6
                }
            };
            visit(corner, node, first);
        }
    }
}

/// −Pᵀ J P for the motion P of all coordinates by the unknowns of an element.
fn transformed<const N: usize>(motion: &[[f64; 12]; N], jacobian: &[[f64; N]; N]) -> ElementMatrix {
    let mut matrix = [[0.0; 12]; 12];
    for (moved, row) in motion.iter().zip(jacobian) {
        let mut by_unknowns = [0.0; 12];
        for (factor, own) in row.iter().zip(motion).filter(|(factor, _)| **factor != 0.0) {
            for (entry, value) in by_unknowns.iter_mut().zip(own) {
                *entry += factor * value;
            }
        }
        for (own, part) in matrix
            .iter_mut()
            .zip(moved)
            .filter(|(_, part)| **part != 0.0)
        {
            for (entry, value) in own.iter_mut().zip(&by_unknowns) {
                *entry -= part * value;
            }
        }
    }
    matrix
}
