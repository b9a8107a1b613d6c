//! A prediction of contact forces, for steps in which many contacts change.
//!
//! Newton's method learns which contacts open, stick and slide by an iteration, hence a factorisation, after the other;
//! where rods fall on each other that takes ten. Here the step is linearised without contact, A δq = −R, and contacts
//! with forces λ are added as constraints,
//!
//! ```text
//! A δq = Hᵀλ − R,   w = g + H δq,
//! ```
//!
//! with the gaps and slips w. Without contact rods do not know of each other, A is a band, and the response A⁻¹Hᵀ of a rod
//! to a force at one of its contacts is cheap. So sweeps over the contacts, each of which is given the force that its own
//! laws ask for while all others stay (projected Gauss–Seidel; Moreau 1988, Jean 1999), cost a hundredth of a
//! factorisation with contact. They are slow to converge, but soon tell the states, and Newton's method begins with
//! their forces and where these move the rods.
//!
//! **What holds.** The solution does not depend on it: Newton's method has the last word. The prediction leaves out what closes
//! a ring, the smoothing of friction, and how contacts turn, which is why it is repeated where rods move far.

use super::{Assembly, Stage, System, copy_positions};
use crate::linalg::BandedFactor;
use crate::mechanics::Vector3;
use crate::mechanics::contact::{ContactConstraint, ContactSystem};
use crate::mechanics::rod::{STRIDE, topology::position};

/// Times that the step is linearised.
const PASSES: usize = 3;
/// Move of a position, in radii, below which another linearisation has nothing new.
const SMALL_MOVE: f64 = 0.05;
/// Farthest that one of them moves a position, in radii.
const FARTHEST: f64 = 2.0;
/// Gap up to which contacts count beyond what the step closes without contact, in radii: those that are pushed together.
const MARGIN: f64 = 0.5;
/// Sweeps over the contacts, and the change of a force in units of the largest that ends them.
const SWEEPS: usize = 100;
const SWEPT: f64 = 1e-3;
/// Sweeps after which the gaps at which contacts rest follow their forces.
const SWEEPS_PER_REST: usize = 5;

/// Response of one rod to a force at a contact.
#[derive(Clone, Copy)]
struct Part {
    /// First unknown of the rod.
    first: usize,
    /// Its rows among those of all contacts.
    rows: [usize; 2],
}

/// A contact between sweeps.
struct Touch {
    /// Contact points where nothing moves: gap along the normal, and slip since the step began, m.
    start: Vector3,
    /// Gap at which it rests under its force, m.
    rest: f64,
    force: Vector3,
    response: Option<Response>,
}

/// How a contact yields to its own force.
struct Response {
    parts: [Option<Part>; 2],
    /// What a force along the normal moves, m/N.
    by_pressure: Vector3,
    /// Two directions along the surfaces, and the motion along them under forces along them, m/N.
    along: [Vector3; 2],
    yielding: [f64; 3],
}

/// Responses of rods to forces on single nodes, found when they are first asked for.
struct Responses<'a> {
    factor: &'a BandedFactor,
    assembly: &'a Assembly,
    /// Where the rows of each node begin.
    of_node: Vec<Option<usize>>,
    /// Motion of an unknown by unit forces on a node along the three axes, m/N.
    rows: Vec<[f64; 4]>,
    /// The same by unit forces at a contact.
    of_contacts: Vec<[f64; 4]>,
}

impl System {
    /// Moves `unknowns`, the prediction of a step at which the system has been linearised, by the contact forces that it
    /// leads to, and lets iterations begin with these, where they differ much from those of the last step; says whether
    /// that is so. `radius` is that of the thinnest rod, m.
    pub fn predict_contacts(&mut self, unknowns: &mut [f64], stage: &Stage, radius: f64) -> bool {
        let rods = self.assembly.rods.rods.len();
        let surprised = (self.contact.as_mut()).filter(|contact| contact.is_surprised(rods));
        let Some(contact) = surprised else {
            return false;
        };
        contact.begin_forces_anew();
        for _ in 0..PASSES {
            let Some(moved) = self.predict_once(unknowns, stage, radius) else {
                break;
            };
            if !self.candidates_are_complete(unknowns) {
                self.update_candidates(unknowns);
            }
            if moved <= SMALL_MOVE * radius {
                break;
            }
        }
        true
    }

    /// One of these passes; returns the farthest move of a node, m, or nothing where the rods are not stable or nothing
    /// touches.
    fn predict_once(&mut self, unknowns: &mut [f64], stage: &Stage, radius: f64) -> Option<f64> {
        let mut contact = self.contact.take()?;
        self.linearize(unknowns, Some(stage));
        let moved = self
            .matrix
            .factor_rods()
            .is_some_and(|inertia| inertia.negative == 0)
            .then(|| {
                copy_positions(unknowns, &mut self.positions);
                self.sweep(&mut contact, stage, radius, unknowns)
            });
        contact.release_constraints();
        self.contact = Some(contact);
        moved.flatten()
    }

    fn sweep(
        &self,
        contact: &mut ContactSystem,
        stage: &Stage,
        radius: f64,
        unknowns: &mut [f64],
    ) -> Option<f64> {
        let mut responses = Responses::new(self.matrix.rod_factor(), &self.assembly);
        let mut correction = responses.free_motion(&self.residual);
        let reach = |node: usize| position(&correction, node).norm() + MARGIN * radius;
        let reaches: Vec<f64> = (0..self.positions.len()).map(reach).collect();
        contact.list_constraints(&self.positions, &reaches, &[]);
        contact.load_begun_forces();
        let constraints = contact.constraints();
        if constraints.is_empty() {
            return None;
        }
        let mut touches: Vec<Touch> = constraints
            .iter()
            .map(|constraint| {
                Touch::new(constraint, |node| {
                    self.positions[node] - stage.positions[node]
                })
            })
            .collect();
        for (touch, constraint) in touches.iter_mut().zip(constraints) {
            if touch.force != Vector3::zeros() {
                touch.response = Some(responses.of_contact(constraint));
                responses.push(touch, &touch.force, &mut correction);
            }
        }
        for sweep in 0..SWEEPS {
            if sweep % SWEEPS_PER_REST == 0 {
                for (touch, constraint) in touches.iter_mut().zip(constraints) {
                    touch.rest = contact.rest_gap(constraint, touch.force.dot(&constraint.normal));
                }
            }
            let (mut change, mut largest) = (0.0_f64, 0.0_f64);
            for k in 0..touches.len() {
                // To and fro: what one end of a chain of contacts bears reaches the other in one sweep.
                let k = if sweep % 2 == 0 {
                    k
                } else {
                    touches.len() - 1 - k
                };
                let by = touches[k].relax(&constraints[k], &mut responses, &correction);
                change = change.max(by.norm());
                largest = largest.max(touches[k].force.norm());
                responses.push(&touches[k], &by, &mut correction);
            }
            if change <= SWEPT * largest {
                break;
            }
        }
        if !correction.iter().all(|entry| entry.is_finite()) {
            return None;
        }
        let moves = (0..self.positions.len()).map(|node| position(&correction, node).norm());
        let farthest = moves.fold(0.0, f64::max);
        let part = (FARTHEST * radius / farthest).min(1.0);
        for (own, correction) in unknowns.iter_mut().zip(&correction) {
            *own += part * correction;
        }
        let forces: Vec<Vector3> = touches.iter().map(|touch| touch.force).collect();
        contact.begin_with_forces(&forces);
        Some(farthest)
    }
}

impl Touch {
    fn new(constraint: &ContactConstraint, slid: impl Fn(usize) -> Vector3) -> Self {
        let (slid, normal) = (constraint.relative_motion(slid), constraint.normal);
        Self {
            start: slid + normal * (constraint.gap - normal.dot(&slid)),
            rest: 0.0,
            force: constraint.force,
            response: None,
        }
    }

    /// Takes the force that its laws ask for while all others stay; returns the change, N.
    fn relax(
        &mut self,
        constraint: &ContactConstraint,
        responses: &mut Responses,
        correction: &[f64],
    ) -> Vector3 {
        let normal = constraint.normal;
        let apart = self.start + constraint.relative_motion(|node| position(correction, node));
        let closing = self.rest - normal.dot(&apart);
        if self.response.is_none() && closing > 0.0 {
            self.response = Some(responses.of_contact(constraint));
        }
        let Some(response) = &self.response else {
            return Vector3::zeros();
        };
        let softness = response.by_pressure.dot(&normal);
        if softness <= 0.0 {
            return Vector3::zeros();
        }
        let before = self.force;
        let pressed = before.dot(&normal);
        let pressure = (pressed + closing / softness).max(0.0);
        let apart = apart + response.by_pressure * (pressure - pressed);
        let drag = before - normal * pressed;
        self.force =
            normal * pressure + response.friction(&drag, &apart, constraint.friction * pressure);
        self.force - before
    }
}

impl Response {
    /// The friction, N, of at most `most`, that ends the slip at a contact, or else acts against it; `drag` is the present one.
    fn friction(&self, drag: &Vector3, apart: &Vector3, most: f64) -> Vector3 {
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
    fn new(factor: &'a BandedFactor, assembly: &'a Assembly) -> Self {
        Self {
            factor,
            assembly,
            of_node: vec![None; assembly.held.len() / STRIDE],
            rows: Vec::new(),
            of_contacts: Vec::new(),
        }
    }

    /// −A⁻¹R.
    fn free_motion(&self, residual: &[f64]) -> Vec<f64> {
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

    /// Where the rows of a node begin.
    fn of_node(&mut self, node: usize) -> usize {
        if let Some(begin) = self.of_node[node] {
            return begin;
        }
        let begin = self.rows.len();
        let (first, count) = self.rod_of(node);
        self.rows.resize(begin + count, [0.0; 4]);
        for axis in 0..3 {
            let unknown = STRIDE * node + axis;
            if !self.assembly.held[unknown] {
                self.rows[begin + unknown - first][axis] = 1.0;
            }
        }
        self.factor.solve_part(first, &mut self.rows[begin..]);
        self.of_node[node] = Some(begin);
        begin
    }

    fn of_contact(&mut self, constraint: &ContactConstraint) -> Response {
        let ContactConstraint {
            nodes,
            weights,
            normal,
            ..
        } = *constraint;
        let mut parts = [None; 2];
        for (part, [m, n]) in parts.iter_mut().zip([[0, 1], [2, 3]]) {
            if weights[m] == 0.0 && weights[n] == 0.0 {
                continue;
            }
            let (first, count) = self.rod_of(nodes[m]);
            let [p, q] = [m, n].map(|m| self.of_node(nodes[m]));
            let begin = self.of_contacts.len();
            self.of_contacts.extend((0..count).map(|row| -> [f64; 4] {
                let (p, q) = (&self.rows[p + row], &self.rows[q + row]);
                std::array::from_fn(|axis| weights[m] * p[axis] + weights[n] * q[axis])
            }));
            *part = Some(Part {
                first,
                rows: [begin, begin + count],
            });
        }
        let mut response = Response {
            parts,
            by_pressure: Vector3::zeros(),
            along: directions_along(&normal),
            yielding: [0.0; 3],
        };
        let moved = |force: &Vector3| {
            constraint.relative_motion(|node| self.motion_of(node, &response.parts, force))
        };
        let [first, second] = response.along;
        let by = [moved(&first), moved(&second)];
        let yielding = [first.dot(&by[0]), first.dot(&by[1]), second.dot(&by[1])];
        response.by_pressure = moved(&normal);
        response.yielding = yielding;
        response
    }

    /// Motion of a node under a force at a contact, m.
    fn motion_of(&self, node: usize, parts: &[Option<Part>; 2], force: &Vector3) -> Vector3 {
        let mut motion = Vector3::zeros();
        for part in parts.iter().flatten() {
            let rows = &self.of_contacts[part.rows[0]..part.rows[1]];
            let Some(row) = (STRIDE * node).checked_sub(part.first) else {
                continue;
            };
            for axis in 0..3 {
                if let Some([x, y, z, _]) = rows.get(row + axis) {
                    motion[axis] += x * force.x + y * force.y + z * force.z;
                }
            }
        }
        motion
    }

    /// Adds the motion under a force at a contact.
    fn push(&self, touch: &Touch, force: &Vector3, motion: &mut [f64]) {
        if *force == Vector3::zeros() {
            return;
        }
        let parts = touch.response.iter().flat_map(|response| response.parts);
        for part in parts.flatten() {
            let rows = &self.of_contacts[part.rows[0]..part.rows[1]];
            for (entry, [x, y, z, _]) in motion[part.first..].iter_mut().zip(rows) {
                *entry += x * force.x + y * force.y + z * force.z;
            }
        }
    }
}

/// Two unit vectors that are perpendicular to each other and to a unit normal.
fn directions_along(normal: &Vector3) -> [Vector3; 2] {
    let axis = Vector3::from_fn(|k, _| if k == normal.iamin() { 1.0 } else { 0.0 });
    let first = normal.cross(&axis).normalize();
    [first, normal.cross(&first)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::contact::{ContactModel, ContactParameters};
    use crate::mechanics::scene::{Plane, RodDescription, Scene, Stiffness};
    use crate::mechanics::system::copy_positions;
    use std::f64::consts::PI;

    const RADIUS: f64 = 1e-3;
    const GAP: f64 = 1e-5;
    const STEP: f64 = 1e-3;
    const FRICTION: f64 = 0.3;

    /// Eighteen short rods side by side, a hundredth of a radius above a floor.
    fn raft(model: ContactModel) -> Scene {
        let (modulus, density) = (1e7, 1000.0);
        let area = PI * RADIUS * RADIUS;
        let stiffness = Stiffness {
            stretching: modulus * area,
            bending: [0.25 * modulus * area * RADIUS * RADIUS; 2],
            twisting: modulus / 6.0 * area * RADIUS * RADIUS,
        };
        let rods = (0..18).map(|rod| {
            let node = |k: usize| Vector3::new(0.01 * rod as f64, 5e-3 * k as f64, RADIUS + GAP);
            let nodes = (0..3).map(node).collect();
            let name = format!("rod {rod}");
            RodDescription::uniform(&name, nodes, stiffness, RADIUS, density * area)
        });
        Scene {
            rods: rods.collect(),
            planes: vec![Plane {
                point: Vector3::zeros(),
                normal: Vector3::z(),
                friction: None,
            }],
            contact: Some(ContactParameters {
                model,
                friction: FRICTION,
                ..ContactParameters::default()
            }),
            ..Scene::default()
        }
    }

    /// Where the prediction moves the nodes of a scene in a step that begins with the same velocity everywhere, m.
    fn moves(scene: &Scene, velocity: Vector3) -> Option<Vec<Vector3>> {
        let mut system = System::new(scene).unwrap();
        let start = system.assembly.unknowns.clone();
        let nodes = start.len() / STRIDE;
        let mut stage = Stage {
            step: STEP,
            acceleration_step: STEP,
            start: start.clone(),
            velocity: vec![0.0; start.len()],
            drag: Vec::new(),
            drag_velocity: Vec::new(),
            resistance: Vec::new(),
            positions: vec![Vector3::zeros(); nodes],
        };
        copy_positions(&start, &mut stage.positions);
        for node in 0..nodes {
            for axis in 0..3 {
                stage.velocity[STRIDE * node + axis] = velocity[axis];
            }
        }
        let mut unknowns = start.clone();
        for (unknown, velocity) in unknowns.iter_mut().zip(&stage.velocity) {
            *unknown += STEP * velocity;
        }
        system.update_candidates(&unknowns);
        system.begin_iterations(&stage);
        system.linearize(&unknowns, Some(&stage));
        let predicted = system.predict_contacts(&mut unknowns, &stage, RADIUS);
        let node = |node: usize| position(&unknowns, node) - position(&start, node);
        predicted.then(|| (0..nodes).map(node).collect())
    }

    #[test]
    fn rods_that_land_keep_of_their_speed_what_friction_leaves() {
        for model in [
            ContactModel::ImplicitContact,
            ContactModel::IncrementalPotential,
        ] {
            let scene = raft(model);
            // The floor takes all of the fall, and friction of the slide what it can bear.
            let fall = 0.5;
            for slide in [0.0, 0.1, 0.5, 1.0] {
                let velocity = Vector3::new(0.6 * slide, 0.8 * slide, -fall);
                let left = (slide - FRICTION * (fall - GAP / STEP)).max(0.0);
                let along = Vector3::new(0.6, 0.8, 0.0) * (left * STEP);
                for moved in moves(&scene, velocity).unwrap() {
                    let error = moved - along;
                    assert!(error.xy().norm() < 0.02 * STEP * fall, "{slide}: {moved}");
                    // They rest where the contact law bears what stopped them.
                    assert!(error.z > -GAP && error.z < GAP, "{slide}: {moved}");
                }
            }
        }
    }

    #[test]
    fn rods_that_meet_nothing_are_left_where_they_are() {
        assert!(moves(&raft(ContactModel::ImplicitContact), Vector3::z()).is_none());
    }
}
