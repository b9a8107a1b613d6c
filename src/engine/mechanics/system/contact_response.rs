//! Responses of uncoupled rods to forces at contacts: A⁻¹Hᵀ of
//! [`super::contact_prediction`], rod by rod from the factors of a band.

use super::Assembly;
use crate::linalg::BandedFactor;
use crate::linalg::instruction_set::{InstructionSet, kernel};
use crate::mechanics::Vector3;
use crate::mechanics::contact::ContactConstraint;
use crate::mechanics::rod::STRIDE;

/// Response of one rod to a force at a contact.
#[derive(Clone, Copy)]
pub(super) struct Part {
    /// First unknown of the rod, and number of its unknowns.
    first: usize,
    count: usize,
    /// Start of the responses of these unknowns among those of all contacts: to a unit force along
    /// the first axis, then along the second and the third.
    begin: usize,
}

/// Response of a contact to its own force.
pub(super) struct Response {
    parts: [Option<Part>; 2],
    /// Response to a force along the normal, m/N.
    pub by_pressure: Vector3,
    /// Two directions along the surfaces, and the motion along them under forces along them, m/N.
    along: [Vector3; 2],
    yielding: [f64; 3],
}

/// Responses of rods to forces on single nodes, computed on first use.
pub(super) struct Responses<'a> {
    set: InstructionSet,
    factor: &'a BandedFactor,
    assembly: &'a Assembly,
    found: &'a mut Found,
}

/// The responses found so far; its storage is reused.
#[derive(Default)]
pub(super) struct Found {
    /// Start of the rows of each node and of the angle of each edge; only the first entries of
    /// these rows are used.
    of_node: Vec<Option<usize>>,
    of_angle: Vec<Option<usize>>,
    /// Motion of an unknown under unit forces on a node along the three axes, m/N.
    rows: Vec<[f64; 4]>,
    /// Motion of the unknowns of a rod under unit forces at a contact, m/N.
    of_contacts: Vec<f64>,
}

impl Response {
    /// The friction, N, of at most `most`, that stops the slip at a contact, or opposes it if it
    /// cannot; `drag` is the present friction.
    pub(crate) fn friction(&self, drag: &Vector3, apart: &Vector3, most: f64) -> Vector3 {
        let [p, q] = self.along.map(|direction| direction.dot(apart));
        let [a, b, c] = self.yielding;
        let determinant = a * c - b * b;
        if determinant > 0.0 {
            let [x, y] = [(c * p - b * q) / determinant, (a * q - b * p) / determinant];
            let sticking = drag - self.along[0] * x - self.along[1] * y;
            if sticking.norm() <= most {
                return sticking;
            }
        }
        let softest = 0.5 * (a + c) + (0.25 * (a - c) * (a - c) + b * b).sqrt();
        let slip = self.along[0] * p + self.along[1] * q;
        let sliding = if softest > 0.0 {
            drag - slip / softest
        } else {
            *drag
        };
        let size = sliding.norm();
        if size > most {
            sliding * (most / size)
        } else {
            sliding
        }
    }
}

impl<'a> Responses<'a> {
    /// Begins without responses, in the storage of `found`.
    pub(crate) fn new(
        factor: &'a BandedFactor,
        assembly: &'a Assembly,
        found: &'a mut Found,
    ) -> Self {
        for of_unknown in [&mut found.of_node, &mut found.of_angle] {
            of_unknown.clear();
            of_unknown.resize(assembly.held.len() / STRIDE, None);
        }
        found.rows.clear();
        found.of_contacts.clear();
        Self {
            set: InstructionSet::best(),
            factor,
            assembly,
            found,
        }
    }

    /// −A⁻¹R.
    pub(crate) fn free_motion(&self, residual: &[f64]) -> Vec<f64> {
        let entries = residual.iter().zip(&self.assembly.held);
        let mut motion: Vec<f64> = entries
            .map(|(residual, held)| if *held { 0.0 } else { -residual })
            .collect();
        self.factor.solve(&mut motion);
        motion
    }

    /// First unknown and number of unknowns of the rod of a node.
    fn rod_of(&self, node: usize) -> (usize, usize) {
        let range = &self.assembly.rods.rods[self.assembly.locate(node).0];
        (STRIDE * range.first_node, STRIDE * range.nodes)
    }

    /// Start of the rows of a node.
    fn of_node(&mut self, node: usize) -> usize {
        if let Some(begin) = self.found.of_node[node] {
            return begin;
        }
        let begin = self.found.rows.len();
        let (first, count) = self.rod_of(node);
        self.found.rows.resize(begin + count, [0.0; 4]);
        for axis in 0..3 {
            let unknown = STRIDE * node + axis;
            if !self.assembly.held[unknown] {
                self.found.rows[begin + unknown - first][axis] = 1.0;
            }
        }
        self.factor.solve_part(first, &mut self.found.rows[begin..]);
        self.found.of_node[node] = Some(begin);
        begin
    }

    /// Start of the rows of the angle of an edge.
    fn of_angle(&mut self, edge: usize) -> usize {
        if let Some(begin) = self.found.of_angle[edge] {
            return begin;
        }
        let begin = self.found.rows.len();
        let (first, count) = self.rod_of(edge);
        self.found.rows.resize(begin + count, [0.0; 4]);
        let unknown = STRIDE * edge + 3;
        if !self.assembly.held[unknown] {
            self.found.rows[begin + unknown - first][0] = 1.0;
        }
        self.factor.solve_part(first, &mut self.found.rows[begin..]);
        self.found.of_angle[edge] = Some(begin);
        begin
    }

    pub(crate) fn of_contact(&mut self, constraint: &ContactConstraint) -> Response {
        let ContactConstraint {
            nodes,
            weights,
            normal,
            ..
        } = *constraint;
        let mut parts = [None; 2];
        for (part, [m, n]) in parts.iter_mut().zip([[0, 1], [2, 3]]) {
            // Obstacles do not yield.
            let is_of_rod = nodes[m] < self.found.of_node.len();
            if !is_of_rod || (weights[m] == 0.0 && weights[n] == 0.0) {
                continue;
            }
            let n = if nodes[n] < self.found.of_node.len() {
                n
            } else {
                m
            };
            let second = if n == m { 0.0 } else { weights[n] };
            let (first, count) = self.rod_of(nodes[m]);
            let [p, q] = [m, n].map(|m| self.of_node(nodes[m]));
            let begin = self.found.of_contacts.len();
            for axis in 0..3 {
                let of_nodes = self.found.rows[p..p + count]
                    .iter()
                    .zip(&self.found.rows[q..]);
                let along = of_nodes.map(|(p, q)| weights[m] * p[axis] + second * q[axis]);
                self.found.of_contacts.extend(along);
            }
            *part = Some(Part {
                first,
                count,
                begin,
            });
        }
        // A contact of one rod turns the edges on both sides of the contact point.
        for (k, turn) in constraint.turns.iter().enumerate() {
            if let (Some((edge, slide)), Some(part)) = (turn, parts[k].or(parts[0])) {
                let begin = self.of_angle(*edge);
                let of_part = &mut self.found.of_contacts[part.begin..part.begin + 3 * part.count];
                for (own, slide) in of_part.chunks_exact_mut(part.count).zip(slide.iter()) {
                    for (own, by_moment) in own.iter_mut().zip(&self.found.rows[begin..]) {
                        *own += slide * by_moment[0];
                    }
                }
            }
        }
        let mut response = Response {
            parts,
            by_pressure: Vector3::zeros(),
            along: directions_along(&normal),
            yielding: [0.0; 3],
        };
        let moved = |force: &Vector3| {
            let of_node = |node| self.motion_of(node, &response.parts, force);
            let of_edge = |edge| self.turn_of(edge, &response.parts, force);
            constraint.relative_motion(of_node) + constraint.turned_motion(of_edge)
        };
        let [first, second] = response.along;
        let by = [moved(&first), moved(&second)];
        let yielding = [first.dot(&by[0]), first.dot(&by[1]), second.dot(&by[1])];
        response.by_pressure = moved(&normal);
        response.yielding = yielding;
        response
    }

    /// Motion of a node under a force at a contact, m; zero for vertices of obstacles.
    fn motion_of(&self, node: usize, parts: &[Option<Part>; 2], force: &Vector3) -> Vector3 {
        Vector3::from_fn(|axis, _| self.moved(STRIDE * node + axis, parts, force))
    }

    /// Rotation of an edge under a force at a contact, rad.
    fn turn_of(&self, edge: usize, parts: &[Option<Part>; 2], force: &Vector3) -> f64 {
        self.moved(STRIDE * edge + 3, parts, force)
    }

    /// Change of an unknown under a force at a contact.
    fn moved(&self, unknown: usize, parts: &[Option<Part>; 2], force: &Vector3) -> f64 {
        let of_part = |part: &Part| {
            let local = unknown.checked_sub(part.first)?;
            let along =
                |axis: usize| self.found.of_contacts[part.begin + axis * part.count + local];
            (local < part.count)
                .then(|| along(0) * force.x + along(1) * force.y + along(2) * force.z)
        };
        parts
            .iter()
            .flatten()
            .filter_map(of_part)
            .fold(0.0, |sum, part| sum + part)
    }

    /// Adds the motion under a force at a contact.
    pub(crate) fn push(&self, response: Option<&Response>, force: &Vector3, motion: &mut [f64]) {
        if *force == Vector3::zeros() {
            return;
        }
        let parts = response.iter().flat_map(|response| response.parts);
        for part in parts.flatten() {
            let of_rod = &mut motion[part.first..part.first + part.count];
            let along = &self.found.of_contacts[part.begin..part.begin + 3 * part.count];
            add_motion(self.set, of_rod, along, force.as_ref());
        }
    }
}

kernel! {
    /// Adds the motion of the unknowns of a rod under a force, from those under unit forces along
    /// the first, second and third axis.
    fn add_motion(motion: &mut [f64], along: &[f64], force: &[f64; 3]) {
        let count = motion.len();
        let (x, others) = along.split_at(count);
        let (y, z) = others.split_at(count);
        let [by_x, by_y, by_z] = *force;
        for (own, ((x, y), z)) in motion.iter_mut().zip(x.iter().zip(y).zip(z)) {
            *own += x * by_x + y * by_y + z * by_z;
        }
    }
}

/// Two unit vectors that are perpendicular to each other and to a unit normal.
fn directions_along(normal: &Vector3) -> [Vector3; 2] {
    let axis = Vector3::from_fn(|k, _| if k == normal.iamin() { 1.0 } else { 0.0 });
    let first = normal.cross(&axis).normalize();
    [first, normal.cross(&first)]
}
