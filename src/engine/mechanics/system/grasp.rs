//! Grasp and release of nodes while the scene runs.
//!
//! A grasp is a clamp that is added at the present configuration. Held positions leave the Newton
//! system like those of the scene's clamps. A held frame splits the vertex at the node in two
//! halves, one on each side of a ghost edge (as [`crate::mechanics::scene::Clamp`] describes).
//! With Voronoi lengths l̄ = l̄₀ + l̄₁, the halves have the natural strains κ̃ l̄ᵢ/l̄ and the
//! stiffness EI/l̄ᵢ, and the ghost edge is in the middle of turn and twist, so that the energy
//! stays the same up to terms of fourth order in the turning angle. A release joins the halves:
//! their natural strains add, and so do the inverses of their stiffness. Weights of vertices
//! beside clamps ([`VertexWeights`]) do not change, since a change would move a stressed rod. The
//! traces of a released clamp cancel up to the fourth order; the error of a grasp is of second
//! order. At a free end, which carries no moment, the ghost edge continues the last edge without
//! stress.

use super::term::Term;
use super::{Drive, System};
use crate::mechanics::Vector3;
use crate::mechanics::rod::topology::position;
use crate::mechanics::rod::transport::{any_normal, normal_part, parallel_transport, rotated};
use crate::mechanics::rod::vertex::{VertexStiffness, VertexStrains};
use crate::mechanics::rod::{
    GhostEdge, RodGeometry, RodRange, STRIDE, Vertex, VertexUnknowns, VertexWeights,
};
use crate::mechanics::scene::{Clamp, Motion};
use serde::{Deserialize, Serialize};

/// Degrees of freedom that a grasp holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Grasp {
    /// Its position.
    pub position: bool,
    /// Tangent and material frame of the rod at the node.
    pub frame: bool,
}

/// Grasps and releases since the start; part of the state in checkpoints.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Interventions {
    /// Clamps of the scene, then grasps, with their motions.
    drives: Vec<Drive>,
    /// Forces of another solver.
    external_forces: Vec<f64>,
    /// Factors of the loads in addition to their schedules.
    load_factors: Vec<f64>,
    /// Values of the actuations that a program sets.
    given: Vec<(usize, Vec<f64>)>,
    /// Held degrees of freedom and vertices, if any node was grasped or released.
    switched: Option<Switched>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct Switched {
    held: Vec<bool>,
    vertices: Vec<Vertex>,
    ghosts: usize,
}

/// The edges on both sides of a node.
struct Neighbours {
    range: RodRange,
    before: Option<usize>,
    after: Option<usize>,
}

impl System {
    /// Grasps a node of the whole scene at its position in `unknowns`; returns the index of the
    /// new clamp. The clamp rests until it gets a motion, which is relative to the position and
    /// time of the grasp.
    ///
    /// # Errors
    /// A message if the node does not exist, is already held, is part of a rigid obstacle, or is
    /// the joint of a ring, whose frame cannot be grasped.
    pub(crate) fn grasp(
        &mut self,
        node: usize,
        grasp: Grasp,
        unknowns: &[f64],
    ) -> Result<usize, String> {
        if node >= self.assembly.rods.nodes {
            let nodes = self.assembly.rods.nodes;
            return Err(format!(
                "node {node} does not exist; the scene has {nodes} nodes"
            ));
        }
        let (rod, along) = self.assembly.locate(node);
        let refuse = |why: &str| {
            let name = &self.assembly.names[rod];
            Err(format!(
                "node {along} of rod `{name}` cannot be grasped: {why}"
            ))
        };
        if self.assembly.obstacle[node] {
            return refuse("its rod is a rigid obstacle");
        }
        let drives = &self.assembly.drives;
        if drives
            .iter()
            .any(|drive| drive.node == node && !drive.released)
        {
            return refuse("a clamp holds it");
        }
        if !self.assembly.joints.frames.is_empty() {
            return refuse(
                "the scene has joints or bodies that turn, with which grasping is not supported",
            );
        }
        if !self.terms.sheaths.is_empty() {
            return refuse("the scene has sheaths, with which grasping is not supported");
        }
        if self.assembly.joints.slides_at(node) {
            return refuse("it slides along a rod");
        }
        let neighbours = self.neighbours(node);
        if grasp.frame
            && let Err(why) = self.may_hold_frame(&neighbours, node)
        {
            return refuse(why);
        }
        self.update_geometry(unknowns);
        let clamp = Clamp {
            rod,
            node: along,
            holds_position: grasp.position,
            holds_frame: grasp.frame,
            motion: Motion::default(),
        };
        let frame = self.frame_at(&neighbours, node);
        self.terms.plasticity.withdraw(&mut self.assembly.rods);
        self.terms.actuators.withdraw(&mut self.assembly.rods);
        let mut drive = Drive::new(&clamp, node, position(unknowns, node), frame);
        if grasp.position {
            self.assembly.held[STRIDE * node..STRIDE * node + 3].fill(true);
        }
        if grasp.frame {
            drive.ghosts = self.add_walls(&neighbours, node, frame, unknowns);
        }
        self.assembly.drives.push(drive);
        self.rebuild(unknowns);
        Ok(self.assembly.drives.len() - 1)
    }

    /// Releases a clamp of the scene or of a grasp; its index is not used again.
    ///
    /// # Errors
    /// A message if the clamp does not exist, was released, or holds an edge together with an
    /// adjacent clamp.
    pub(crate) fn release(&mut self, clamp: usize, unknowns: &[f64]) -> Result<(), String> {
        let drives = &self.assembly.drives;
        let Some(drive) = drives.get(clamp) else {
            return Err(format!("clamp {clamp} does not exist"));
        };
        if drive.released {
            return Err(format!("clamp {clamp} is already released"));
        }
        if !self.terms.sheaths.is_empty() {
            return Err(format!(
                "clamp {clamp} cannot be released: the scene has sheaths, with which releasing is not supported"
            ));
        }
        let (node, ghosts) = (drive.node, drive.ghosts.clone());
        let holds_position = drive.holds_position;
        let active = drives.iter().filter(|drive| !drive.released);
        let mut held_edges = active.flat_map(|drive| &drive.edges);
        if held_edges.any(|edge| edge.start == node || edge.end == node) {
            return Err(format!(
                "clamp {clamp} cannot be released: it holds an edge together with an adjacent clamp"
            ));
        }
        let mut frames = self.assembly.joints.frames.iter();
        if frames.any(|frame| frame.clamp == Some(clamp)) {
            return Err(format!(
                "clamp {clamp} cannot be released: it holds the frame of a rigid joint"
            ));
        }
        if self.terms.springs.turns_against(clamp) {
            return Err(format!(
                "clamp {clamp} cannot be released: a spring turns against it"
            ));
        }
        self.update_geometry(unknowns);
        if holds_position {
            self.assembly.held[STRIDE * node..STRIDE * node + 3].fill(false);
        }
        self.terms.plasticity.withdraw(&mut self.assembly.rods);
        self.terms.actuators.withdraw(&mut self.assembly.rods);
        self.remove_walls(ghosts);
        let drive = &mut self.assembly.drives[clamp];
        drive.released = true;
        drive.ghosts.clear();
        self.rebuild(unknowns);
        Ok(())
    }

    /// Sets the values of an actuation.
    ///
    /// # Errors
    /// A message if the actuation does not exist, has another course, or has another number of
    /// values.
    pub(crate) fn give_actuation(&mut self, number: usize, values: &[f64]) -> Result<(), String> {
        let actuators = &mut self.terms.actuators;
        actuators.give(number, values, &mut self.assembly)
    }

    /// Grasps and releases since the start.
    pub(crate) fn interventions(&self) -> Interventions {
        let switched = || {
            let mut rods = self.assembly.rods.clone();
            self.terms.plasticity.withdraw(&mut rods);
            self.terms.actuators.withdraw(&mut rods);
            Switched {
                held: self.assembly.held.clone(),
                vertices: rods.vertices,
                ghosts: rods.ghosts,
            }
        };
        Interventions {
            drives: self.assembly.drives.clone(),
            external_forces: self.terms.loads.external().to_vec(),
            load_factors: self.terms.loads.factors().to_vec(),
            given: self.terms.actuators.given(),
            switched: self.switched.then(switched),
        }
    }

    /// Repeats the recorded grasps and releases on a new system of the same scene.
    ///
    /// # Errors
    /// The difference if the record belongs to another scene.
    pub(crate) fn restore_interventions(
        &mut self,
        done: Interventions,
    ) -> Result<(), &'static str> {
        let assembly = &mut self.assembly;
        if done.external_forces.len() != assembly.unknowns.len() {
            return Err("the number of nodes differs");
        }
        if done.load_factors.len() != self.terms.loads.factors().len() {
            return Err("other loads");
        }
        let clamps = assembly.drives.len();
        let fits = if done.switched.is_some() {
            done.drives.len() >= clamps
        } else {
            done.drives.len() == clamps
        };
        if !fits {
            return Err("other clamps");
        }
        assembly.drives = done.drives;
        for (load, factor) in done.load_factors.into_iter().enumerate() {
            for term in self.terms.all_mut() {
                term.scale_load(load, factor);
            }
        }
        (self.terms.loads.external_mut()).copy_from_slice(&done.external_forces);
        if let Some(switched) = done.switched {
            self.terms.plasticity.withdraw(&mut assembly.rods);
            self.terms.actuators.withdraw(&mut assembly.rods);
            assembly.held = switched.held;
            assembly.rods.vertices = switched.vertices;
            assembly.rods.ghosts = switched.ghosts;
            assembly.consistent.share(&assembly.rods);
            self.terms.actuators.resolve(assembly);
            self.terms.plasticity.place(assembly);
            let any = GhostEdge {
                tangent: Vector3::x(),
                director: Vector3::y(),
                spin: 0.0,
            };
            self.ghosts = vec![any; switched.ghosts];
            self.reference.twist = vec![0.0; assembly.rods.vertices.len()];
            self.geometry = RodGeometry::new(&assembly.rods);
            self.matrix.adapt(assembly);
            self.switched = true;
            self.note_prescribed_nodes();
        }
        for (number, values) in done.given {
            let given = self.give_actuation(number, &values);
            given.map_err(|_| "other actuations")?;
        }
        self.list_events();
        Ok(())
    }

    /// Updates all other data for the held degrees of freedom and the present vertices.
    fn rebuild(&mut self, unknowns: &[f64]) {
        self.switched = true;
        self.note_prescribed_nodes();
        self.terms.damping.rest();
        self.terms.damping.place(&self.assembly);
        self.terms.plasticity.place(&self.assembly);
        self.assembly.consistent.share(&self.assembly.rods);
        self.terms.actuators.resolve(&self.assembly);
        self.geometry = RodGeometry::new(&self.assembly.rods);
        let (rods, geometry) = (&mut self.assembly.rods, &mut self.geometry);
        self.terms.actuators.drive(self.time, rods, geometry);
        self.matrix.adapt(&self.assembly);
        self.update_geometry(unknowns);
    }

    fn neighbours(&self, node: usize) -> Neighbours {
        let (rod, along) = self.assembly.locate(node);
        let range = self.assembly.rods.rods[rod];
        let last = range.first_node + range.nodes - 1;
        Neighbours {
            before: match along {
                0 => range.closed.then_some(last),
                _ => Some(node - 1),
            },
            after: (range.closed || node != last).then_some(node),
            range,
        }
    }

    fn may_hold_frame(&self, neighbours: &Neighbours, node: usize) -> Result<(), &'static str> {
        match (neighbours.before, neighbours.after) {
            (Some(before), Some(after)) => {
                let first_or_last = node == neighbours.range.first_node
                    || node + 1 == neighbours.range.first_node + neighbours.range.nodes;
                if neighbours.range.closed && first_or_last {
                    return Err("its frame is the one at which the closed rod is joined");
                }
                match self.vertex_between(before, after) {
                    Some(_) => Ok(()),
                    None => Err("an adjacent edge is held"),
                }
            }
            (Some(edge), None) | (None, Some(edge)) => match self.vertex_at_edge(edge) {
                Some(_) => Ok(()),
                None => Err("its rod has fewer than three nodes, or an adjacent edge is held"),
            },
            (None, None) => Err("no edge begins or ends there"),
        }
    }

    fn vertex_between(&self, before: usize, after: usize) -> Option<usize> {
        let mut vertices = self.assembly.rods.vertices.iter();
        vertices.position(|vertex| (vertex.before, vertex.after) == (before, after))
    }

    fn vertex_at_edge(&self, edge: usize) -> Option<usize> {
        let mut vertices = self.assembly.rods.vertices.iter();
        vertices.position(|vertex| vertex.before == edge || vertex.after == edge)
    }

    /// Half the natural length of an edge, m; zero for ghost edges.
    fn half_length(&self, edge: usize) -> f64 {
        let edges = &self.assembly.rods.edges;
        let found = edges.binary_search_by_key(&edge, |edge| edge.start);
        found.map_or(0.0, |index| 0.5 * edges[index].natural_length)
    }

    /// Tangent and director at a node at the last evaluation: the mean of its two edges, or those
    /// of its only edge.
    fn frame_at(&self, neighbours: &Neighbours, node: usize) -> GhostEdge {
        let edges = &self.geometry.edges;
        let (Some(before), Some(after)) = (neighbours.before, neighbours.after) else {
            let edge = neighbours.before.or(neighbours.after).unwrap_or(node);
            return GhostEdge {
                tangent: edges[edge].tangent,
                director: edges[edge].director_1,
                spin: 0.0,
            };
        };
        let source = &edges[before];
        let sum = source.tangent + edges[after].tangent;
        let tangent = sum.normalize();
        let vertex = self.vertex_between(before, after);
        let twist = vertex.map_or(0.0, |vertex| self.geometry.twist(vertex));
        let carried = parallel_transport(&source.director_1, &source.tangent, &tangent);
        let director = rotated(&carried, &tangent, 0.5 * twist);
        GhostEdge {
            tangent,
            director: normal_part(&director, &tangent).unwrap_or_else(|| any_normal(&tangent)),
            spin: 0.0,
        }
    }

    /// Adds the half vertices of a clamp that holds `frame` at a node; returns its ghost edges.
    fn add_walls(
        &mut self,
        neighbours: &Neighbours,
        node: usize,
        frame: GhostEdge,
        unknowns: &[f64],
    ) -> Vec<usize> {
        let nodes = self.assembly.rods.nodes;
        let angle = |edge: usize| unknowns[STRIDE * edge + 3];
        let mut ghosts = Vec::new();
        // Natural strains per length, stiffness times length, and half of the present twist.
        let (natural, stiffness, strain, weights, half_twist) =
            match (neighbours.before, neighbours.after) {
                (Some(before), Some(after)) => {
                    let index = self.vertex_between(before, after).expect("checked before");
                    let half_twist = 0.5 * self.geometry.twist(index);
                    let vertex = self.assembly.rods.vertices.remove(index);
                    self.reference.twist.remove(index);
                    let length = self.half_length(before) + self.half_length(after);
                    (
                        scaled(&vertex.natural, 1.0 / length),
                        vertex.stiffness.times(length),
                        vertex.strain,
                        vertex.weights,
                        half_twist,
                    )
                }
                (before, after) => {
                    let edge = before.or(after).expect("checked before");
                    let index = self.vertex_at_edge(edge).expect("checked before");
                    let vertex = self.assembly.rods.vertices[index];
                    let length = self.half_length(vertex.before) + self.half_length(vertex.after);
                    let stiffness = of_unit_length(&vertex, length);
                    (
                        VertexStrains::default(),
                        stiffness,
                        vertex.strain,
                        VertexWeights::default(),
                        0.0,
                    )
                }
            };
        for (edge, ghost_first) in [(neighbours.before, false), (neighbours.after, true)] {
            let Some(edge) = edge else { continue };
            let ghost = nodes + self.assembly.rods.ghosts;
            ghosts.push(self.assembly.rods.ghosts);
            self.assembly.rods.ghosts += 1;
            self.ghosts.push(frame);
            let length = self.half_length(edge);
            let first = STRIDE * node;
            let (before, after, twist, at) = if ghost_first {
                (ghost, edge, half_twist - angle(edge), (first, 4, 11))
            } else {
                (
                    edge,
                    ghost,
                    half_twist + angle(edge),
                    (first - STRIDE, 0, 7),
                )
            };
            self.reference.twist.push(twist);
            self.assembly.rods.vertices.push(Vertex {
                before,
                after,
                natural: scaled(&natural, length),
                stiffness: stiffness.times(1.0 / length),
                strain,
                weights,
                joint_twist: 0.0,
                unknowns: VertexUnknowns::Consecutive {
                    first: at.0,
                    from: at.1,
                    to: at.2,
                },
            });
        }
        ghosts
    }

    /// Weights of the vertex formed by two halves.
    fn joined_weights(&self, first: &Vertex, second: &Vertex) -> VertexWeights {
        let [one, other] = [first.before, second.after].map(|edge| self.half_length(edge));
        let mean = |weight: fn(&VertexWeights) -> f64| {
            let excess = |vertex: &Vertex| weight(&vertex.weights) - 1.0;
            1.0 + (one * excess(first) + other * excess(second)) / (one + other)
        };
        VertexWeights {
            bending: mean(|weights| weights.bending),
            twisting: mean(|weights| weights.twisting),
        }
    }

    /// Removes ghost edges with their half vertices, and joins the halves to full vertices.
    fn remove_walls(&mut self, mut ghosts: Vec<usize>) {
        let nodes = self.assembly.rods.nodes;
        let mut halves = Vec::new();
        for ghost in &ghosts {
            let rods = &mut self.assembly.rods;
            let of_ghost =
                |vertex: &Vertex| [vertex.before, vertex.after].contains(&(nodes + ghost));
            let found = rods.vertices.iter().position(of_ghost);
            let index = found.expect("every ghost edge has a vertex");
            let vertex = rods.vertices.remove(index);
            halves.push((vertex, self.reference.twist.remove(index)));
        }
        if let [(one, twist), (other, other_twist)] = halves[..] {
            let (first, second) = if one.after >= nodes {
                (one, other)
            } else {
                (other, one)
            };
            let VertexUnknowns::Consecutive { first: unknown, .. } = first.unknowns else {
                unreachable!("the frame at a joint is never grasped");
            };
            self.assembly.rods.vertices.push(Vertex {
                before: first.before,
                after: second.after,
                natural: VertexStrains {
                    curvature: std::array::from_fn(|k| {
                        first.natural.curvature[k] + second.natural.curvature[k]
                    }),
                    twist: first.natural.twist + second.natural.twist,
                },
                stiffness: in_series(&first.stiffness, &second.stiffness),
                strain: first.strain,
                weights: self.joined_weights(&first, &second),
                joint_twist: 0.0,
                unknowns: VertexUnknowns::Consecutive {
                    first: unknown,
                    from: 0,
                    to: 11,
                },
            });
            self.reference.twist.push(twist + other_twist);
        }
        // In descending order, so that the indices of the others stay valid.
        ghosts.sort_unstable_by(|a, b| b.cmp(a));
        for ghost in ghosts {
            self.ghosts.remove(ghost);
            self.assembly.rods.ghosts -= 1;
            for vertex in &mut self.assembly.rods.vertices {
                for edge in [&mut vertex.before, &mut vertex.after] {
                    *edge -= usize::from(*edge > nodes + ghost);
                }
            }
            for drive in &mut self.assembly.drives {
                for other in &mut drive.ghosts {
                    *other -= usize::from(*other > ghost);
                }
            }
        }
    }
}

/// Stiffness of a vertex of unit length and weight.
fn of_unit_length(vertex: &Vertex, voronoi: f64) -> VertexStiffness {
    let (stiffness, weights) = (&vertex.stiffness, &vertex.weights);
    VertexStiffness {
        bending: (stiffness.bending).map(|bending| voronoi * weights.bending * bending),
        twisting: voronoi * weights.twisting * stiffness.twisting,
    }
}

fn scaled(strains: &VertexStrains, factor: f64) -> VertexStrains {
    VertexStrains {
        curvature: strains.curvature.map(|curvature| factor * curvature),
        twist: factor * strains.twist,
    }
}

fn in_series(one: &VertexStiffness, other: &VertexStiffness) -> VertexStiffness {
    let series = |a: f64, b: f64| a * b / (a + b);
    VertexStiffness {
        bending: std::array::from_fn(|k| series(one.bending[k], other.bending[k])),
        twisting: series(one.twisting, other.twisting),
    }
}
