//! Equations of the active set of a step, which give the derivatives of contact by
//! complementarity.
//!
//! Contacts that press are closed, and stick or slide; all others are open, without a force. With the gap g, the normal n, the weights w, and
//! the slip u = P(n) Σ w_m (x_m − x_mⁿ) of the step across the normal, the equations of a contact are
//!
//! ```text
//! sticks:  F = w ⊗ λ,               n g + u = 0
//! slides:  F = w ⊗ λₙ (n − μ u/|u|),   g = 0
//! ```
//!
//! Here they are written as force laws λ − K (n g + u), or λₙ − K g: at the solution they give the
//! forces of the solution, and a stiffness K far above that of the rods holds gap and slip. The
//! motion of the derivative then violates the equations by the ratio of the rods' stiffness to K.
//! Slips may be far smaller than the steps of a finite difference, so the laws are linear in the
//! positions.

use super::active_law::{ActiveBodies, ActiveLaw, Corners, NOW, START};
use super::contact_system::ContactSystem;
use super::contacts::{ActiveContact, CandidatePair, EdgeJacobian, PlaneContact};
use super::evaluation::Motion;
use super::foot::Points;
use super::friction::tangential;
use super::nearest_points::NearestPoints;
use crate::mechanics::Vector3;

/// A contact slides if its friction is within this relative margin of the friction disk; its slip
/// must then be at least the second value, in units of the threshold.
const DISK: f64 = 1e-6;
const LEAST_SLIP: f64 = 1e-9;
const LOST: &str = "a contact ends there, or is with the rim of a tube or a smooth mesh";
/// Step of the fourth-order differences, in units of the length on which a law changes.
const PART: f64 = 1e-3;

/// A law at some positions.
struct At {
    weights: [f64; 4],
    normal: Vector3,
    /// m.
    gap: f64,
    slip: Vector3,
    friction: f64,
    distance: f64,
    threshold: f64,
}

impl ContactSystem {
    /// The contacts that pressed in the last accepted step.
    pub(crate) fn pressing(&self) -> Vec<ActiveLaw> {
        let (slots, tractions) = (self.slots(), self.carried_tractions.committed());
        let forces = self.multipliers.committed();
        let law = |slot: usize, bodies, nodes| {
            let pressure = forces.get(slot).copied().unwrap_or(0.0);
            (pressure > 0.0).then(|| ActiveLaw {
                bodies,
                nodes,
                pressure,
                traction: tractions.get(slot).copied().flatten().unwrap_or_default(),
                stiffness: [0.0; 2],
                force: Vector3::zeros(),
                slides: false,
                gap: 0.0,
                slip: Vector3::zeros(),
                length: 0.0,
                corners: Corners::default(),
                over: [[[0.0; 12]; 12]; 2],
            })
        };
        let pairs = self.candidates.pairs().iter().enumerate();
        let mut laws: Vec<ActiveLaw> = pairs
            .filter_map(|(slot, pair)| law(slot, ActiveBodies::Pair(*pair), pair.nodes))
            .collect();
        for plane in 0..self.planes.len() {
            for (own, surface) in self.surface.nodes().iter().enumerate() {
                let slot = slots.over_plane(plane, surface.node);
                let bodies = ActiveBodies::Plane { plane, own };
                laws.extend(law(slot, bodies, [surface.node; 4]));
            }
        }
        laws
    }

    /// Completes the laws that [`Self::pressing`] returned, at a solution with `positions`, and
    /// sets them. `stiffness` gives the stiffness of the rods along and across a normal, N/m, for
    /// nodes and their weights.
    ///
    /// # Errors
    /// The reason why the active set is not a function of the data at this solution.
    pub(crate) fn set_active_laws(
        &mut self,
        mut laws: Vec<ActiveLaw>,
        positions: &[Vector3],
        previous: &[Vector3],
        stiffness: impl Fn(&[usize; 4], &[f64; 4], &Vector3) -> [f64; 2],
    ) -> Result<(), &'static str> {
        for law in &mut laws {
            let corners = self.corners(law, positions, previous);
            let At {
                weights,
                normal,
                gap,
                slip,
                friction,
                threshold,
                ..
            } = self
                .at(law, &corners)
                .ok_or("a contact is lost at its end")?;
            let disk = law.traction.norm();
            law.slides = friction == 0.0 || disk > (1.0 - DISK) * friction;
            law.length = threshold;
            if law.slides && friction > 0.0 {
                if slip.norm() < LEAST_SLIP * threshold {
                    return Err("a contact is about to slide");
                }
                law.length = threshold.min(slip.norm());
            }
            law.force = (normal + law.traction) * law.pressure;
            (law.gap, law.slip) = (gap, slip);
            law.stiffness = stiffness(&law.nodes, &weights, &normal);
            let over = [NOW, START].map(|when| self.jacobian(law, &corners, when));
            let [Some(now), Some(start)] = over else {
                return Err(LOST);
            };
            (law.corners, law.over) = (corners, [now, start]);
        }
        self.active_laws = laws;
        Ok(())
    }

    /// The active laws; empty except while derivatives are computed.
    pub(crate) fn active_laws(&self) -> &[ActiveLaw] {
        &self.active_laws
    }

    /// Copies the laws of another simulation of the same rods.
    pub(crate) fn share_active_laws(&mut self, laws: &[ActiveLaw]) {
        self.active_laws.clear();
        self.active_laws.extend_from_slice(laws);
    }

    /// Removes the laws: contact forces are then those of the contact model.
    pub(crate) fn clear_active_laws(&mut self) {
        self.active_laws.clear();
    }

    fn corners(&self, law: &ActiveLaw, positions: &[Vector3], previous: &[Vector3]) -> Corners {
        [
            self.obstacles.points(positions).of(law.nodes),
            self.obstacles.points_at_start(previous).of(law.nodes),
        ]
    }

    fn at(&self, law: &ActiveLaw, [now, before]: &Corners) -> Option<At> {
        let (weights, normal, distance, threshold, friction) = match law.bodies {
            ActiveBodies::Pair(pair) => {
                let points = Points {
                    nodes: now,
                    vertices: &[],
                    normals: &[],
                };
                let own = CandidatePair {
                    nodes: [0, 1, 2, 3],
                    ..pair
                };
                if pair.is_with_rim() || pair.is_with_patch() {
                    return None;
                }
                let nearest = NearestPoints::on_either_side(&self.surface, &own, &points, 0.0)?;
                (
                    nearest.weights(),
                    nearest.normal(),
                    nearest.distance() - self.surface.core(&pair),
                    self.surface.threshold(pair.edges),
                    self.friction_between(&pair),
                )
            }
            ActiveBodies::Plane { plane, own } => {
                let plane = &self.planes[plane];
                let weights = [1.0, 0.0, 0.0, 0.0];
                let node = &self.surface.nodes()[own];
                let distance = plane.distance(&now[0]);
                let friction = self.friction_over(plane, node);
                (weights, plane.normal, distance, node.radius, friction)
            }
        };
        let moves = now.iter().zip(before).zip(weights);
        let moved: Vector3 = moves
            .map(|((now, before), weight)| (now - before) * weight)
            .sum();
        let swing = match &law.bodies {
            ActiveBodies::Pair(pair) => self.swing_of_obstacle(pair),
            ActiveBodies::Plane { .. } => Vector3::zeros(),
        };
        let slip = tangential(&normal, &(moved + normal.cross(&swing)));
        Some(At {
            weights,
            normal,
            gap: distance - threshold,
            slip,
            friction,
            distance,
            threshold,
        })
    }

    /// Force on the corners of a law, N, linear in their positions. The constant part is evaluated
    /// with the data of this scene.
    fn linear_force(&self, law: &ActiveLaw, corners: &Corners) -> Option<[f64; 12]> {
        let mut force = self.force_of(law, &law.corners)?.1;
        for when in [NOW, START] {
            let pairs = corners[when].iter().zip(&law.corners[when]);
            let moves: Vec<Vector3> = pairs.map(|(own, solution)| own - solution).collect();
            for (entry, row) in force.iter_mut().zip(&law.over[when]) {
                let products = row.iter().enumerate();
                *entry += products
                    .map(|(k, rate)| rate * moves[k / 3][k % 3])
                    .sum::<f64>();
            }
        }
        Some(force)
    }

    /// Force on the corners of a law, N.
    fn force_of(&self, law: &ActiveLaw, corners: &Corners) -> Option<(At, [f64; 12])> {
        let at = self.at(law, corners)?;
        let [stiff, stiff_across] = law.stiffness;
        let closed = stiff * (at.gap - law.gap);
        let force = if !law.slides {
            law.force - at.normal * closed - (at.slip - law.slip) * stiff_across
        } else if at.friction > 0.0 {
            (at.normal - at.slip * (at.friction / at.slip.norm())) * (law.pressure - closed)
        } else {
            at.normal * (law.pressure - closed)
        };
        let force = std::array::from_fn(|row| at.weights[row / 3] * force[row % 3]);
        Some((at, force))
    }

    /// Derivative of the force on the corners with respect to their positions at the end or the
    /// start of the step, N/m.
    fn jacobian(&self, law: &ActiveLaw, corners: &Corners, when: usize) -> Option<EdgeJacobian> {
        let mut jacobian = [[0.0; 12]; 12];
        let change = PART * law.length;
        for column in 0..12 {
            let moved = |times: f64| {
                let mut corners = *corners;
                corners[when][column / 3][column % 3] += times * change;
                Some(self.force_of(law, &corners)?.1)
            };
            let [near, far] = [[moved(1.0)?, moved(-1.0)?], [moved(2.0)?, moved(-2.0)?]];
            for (row, entries) in jacobian.iter_mut().enumerate() {
                let [near, far] = [near, far].map(|[plus, minus]| plus[row] - minus[row]);
                entries[column] = (8.0 * near - far) / (12.0 * change);
            }
        }
        Some(jacobian)
    }

    /// Adds the forces of the laws to the contacts.
    pub(super) fn evaluate_active_laws(&mut self, motion: Motion, with_jacobians: bool) {
        for index in 0..self.active_laws.len() {
            let law = self.active_laws[index];
            let corners = self.corners(&law, motion.positions, motion.previous);
            let found = self.linear_force(&law, &corners);
            let (Some(force), Some(at)) = (found, self.at(&law, &corners)) else {
                continue;
            };
            let jacobian = with_jacobians.then_some(law.over[NOW]);
            let At {
                normal,
                distance,
                threshold,
                ..
            } = at;
            let normal_force = law.pressure;
            match law.bodies {
                ActiveBodies::Pair(pair) => {
                    // A pair that is not a candidate has no entries in the matrix; the residual
                    // detects the missing force.
                    let Ok(candidate) = self.candidates.pairs().binary_search(&pair) else {
                        continue;
                    };
                    self.contacts.push(ActiveContact {
                        candidate,
                        nodes: law.nodes,
                        distance,
                        threshold,
                        normal,
                        normal_force,
                        force,
                        first_body: pair.first_body(),
                    });
                    self.tractions.push(law.traction);
                    self.jacobians.extend(jacobian);
                }
                ActiveBodies::Plane { plane, .. } => {
                    self.plane_contacts.push(PlaneContact {
                        node: law.nodes[0],
                        plane,
                        distance,
                        threshold,
                        normal_force,
                        force: std::array::from_fn(|axis| force[axis]),
                    });
                    self.plane_tractions.push(law.traction);
                    self.plane_jacobians.extend(jacobian.map(|of_all| {
                        std::array::from_fn(|row| std::array::from_fn(|k| of_all[row][k]))
                    }));
                }
            }
        }
        self.contact_count = self.contacts.len() + self.plane_contacts.len();
    }
}
