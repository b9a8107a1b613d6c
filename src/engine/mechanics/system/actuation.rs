//! Rods whose natural strains are functions of time.
//!
//! The natural strain of every vertex and edge is that of the unstressed shape plus the integral
//! of the actuated strain over the Voronoi length, or over the edge. This is exact for schedules
//! and for waves, even for waves shorter than the edges. The actuated strain is taken at the time
//! at which the forces are evaluated: at the end of a step, or at its middle with the midpoint
//! rule. Equilibria use the present time, paths of equilibria use their parameter.
//!
//! **Length.** A section that lengthens keeps its mass, its stiffnesses EA, EI and GJ, and its
//! natural curvature and twist per length. With vertex lengths l̄ = g l̄₀ the natural strains of
//! each vertex scale with g, and its stiffnesses over length with 1/g. Loads and drag coefficients
//! per length refer to the length without actuation.

use super::build::Assembly;
use super::events::Event;
use super::term::{Configuration, Kind, Term};
use crate::mechanics::rod::vertex::{VertexStiffness, VertexStrains};
use crate::mechanics::rod::{ElasticRods, RodGeometry};
use crate::mechanics::scene::{ActuatedStrain, Actuation, Course, Scene};
use crate::mechanics::{LoadError, SceneError};

/// All actuations of a scene, resolved to its vertices and edges.
#[derive(Clone, Debug, Default)]
pub(crate) struct Actuators {
    actuations: Vec<Actuation>,
    /// Share of each actuation at its vertices or edges.
    shares: Vec<Vec<Share>>,
    /// Natural strains and stiffness of the vertices without actuation.
    vertices: Vec<(VertexStrains, VertexStiffness)>,
    /// Natural lengths of the edges without actuation, m.
    lengths: Vec<f64>,
    /// Index of the edge that starts at each node.
    edges: Vec<usize>,
    changes_length: bool,
}

/// A vertex, or an edge, that an actuation reaches.
#[derive(Clone, Copy, Debug)]
struct Share {
    index: usize,
    /// Shares of its piece of the rod, from [`crate::mechanics::scene::Course::shares`].
    parts: [f64; 2],
}

impl Actuators {
    /// Whether no rod is actuated.
    pub(crate) fn is_empty(&self) -> bool {
        self.actuations.is_empty()
    }

    /// Records the present vertices and edges as those without actuation.
    pub(crate) fn resolve(&mut self, assembly: &Assembly) {
        if self.is_empty() {
            return;
        }
        let rods = &assembly.rods;
        let strains = |vertex: &crate::mechanics::rod::Vertex| (vertex.natural, vertex.stiffness);
        self.vertices = rods.vertices.iter().map(strains).collect();
        self.lengths = rods.edges.iter().map(|edge| edge.natural_length).collect();
        self.edges = vec![usize::MAX; rods.nodes];
        // Position of each edge along its rod, m.
        let mut places = vec![[0.0; 2]; rods.nodes];
        let (mut rod, mut along) = (0, 0.0);
        for (number, edge) in rods.edges.iter().enumerate() {
            let (own, _) = assembly.locate(edge.start);
            if own != rod {
                (rod, along) = (own, 0.0);
            }
            self.edges[edge.start] = number;
            places[edge.start] = [along, along + edge.natural_length];
            along += edge.natural_length;
        }
        let is_real = |edge: &usize| *edge < rods.nodes;
        let of_vertices = rods
            .vertices
            .iter()
            .enumerate()
            .flat_map(|(index, vertex)| {
                let before = Some(vertex.before).filter(is_real).map(|edge| {
                    let [from, to] = places[edge];
                    (index, edge, [0.5 * (from + to), to])
                });
                let after = Some(vertex.after).filter(is_real).map(|edge| {
                    let [from, to] = places[edge];
                    (index, edge, [from, 0.5 * (from + to)])
                });
                [before, after].into_iter().flatten()
            });
        let of_vertices: Vec<_> = of_vertices.collect();
        let edges = rods.edges.iter().enumerate();
        let of_edges: Vec<_> = edges
            .map(|(index, edge)| (index, edge.start, places[edge.start]))
            .collect();
        let shares = self.actuations.iter().map(|actuation| {
            let pieces = match actuation.strain {
                ActuatedStrain::Length => &of_edges,
                _ => &of_vertices,
            };
            let own = (pieces.iter()).filter(|piece| assembly.locate(piece.1).0 == actuation.rod);
            let [first, last] = actuation.part;
            let mut shares: Vec<Share> = Vec::new();
            for &(index, _, [from, to]) in own {
                let (from, to) = (from.max(first), to.min(last));
                if from >= to {
                    continue;
                }
                let parts = actuation.course.shares([from, to]);
                match shares.last_mut() {
                    Some(share) if share.index == index => {
                        share.parts = std::array::from_fn(|k| share.parts[k] + parts[k]);
                    }
                    _ => shares.push(Share { index, parts }),
                }
            }
            shares
        });
        self.shares = shares.collect();
    }

    /// Values of the actuations that a program sets, with their indices.
    pub(crate) fn given(&self) -> Vec<(usize, Vec<f64>)> {
        let courses = self.actuations.iter().map(|actuation| &actuation.course);
        let given = courses
            .enumerate()
            .filter_map(|(number, course)| match course {
                Course::Given { values, .. } => Some((number, values.clone())),
                _ => None,
            });
        given.collect()
    }

    /// Sets the values of an actuation that a program controls.
    ///
    /// # Errors
    /// A message if the actuation does not exist, has another course, or has another number of
    /// values.
    pub(crate) fn give(
        &mut self,
        number: usize,
        new: &[f64],
        assembly: &mut Assembly,
    ) -> Result<(), String> {
        let actuation = self.actuations.get_mut(number);
        let Some(Course::Given { values, .. }) = actuation.map(|one| &mut one.course) else {
            return Err(format!(
                "actuation {number} with given values does not exist"
            ));
        };
        if values.len() != new.len() {
            let (places, found) = (values.len(), new.len());
            return Err(format!(
                "actuation {number} takes {places} values, found {found}"
            ));
        }
        values.copy_from_slice(new);
        self.withdraw(&mut assembly.rods);
        self.resolve(assembly);
        Ok(())
    }

    /// Sets the natural strains of the rods at a time, s.
    fn apply(&self, time: f64, rods: &mut ElasticRods) {
        self.withdraw(rods);
        for (actuation, shares) in self.actuations.iter().zip(&self.shares) {
            let [first, second] = actuation.course.weights(time);
            for share in shares {
                let amount = first * share.parts[0] + second * share.parts[1];
                if actuation.strain == ActuatedStrain::Length {
                    rods.edges[share.index].natural_length += amount;
                    continue;
                }
                let VertexStrains { curvature, twist } = &mut rods.vertices[share.index].natural;
                match actuation.strain {
                    ActuatedStrain::FirstCurvature => {
                        [curvature[1], curvature[3]] =
                            [curvature[1] - amount, curvature[3] - amount]
                    }
                    ActuatedStrain::SecondCurvature => {
                        [curvature[0], curvature[2]] =
                            [curvature[0] + amount, curvature[2] + amount]
                    }
                    ActuatedStrain::Twist | ActuatedStrain::Length => *twist += amount,
                }
            }
        }
        if self.changes_length {
            self.lengthen(rods);
        }
    }

    /// Updates the vertices for the lengths of their edges.
    fn lengthen(&self, rods: &mut ElasticRods) {
        for vertex in &mut rods.vertices {
            let own = [vertex.before, vertex.after].into_iter();
            let (mut before, mut now) = (0.0, 0.0);
            for edge in own.filter(|edge| *edge < rods.nodes) {
                before += self.lengths[self.edges[edge]];
                now += rods.edges[self.edges[edge]].natural_length;
            }
            let growth = now / before;
            vertex
                .natural
                .curvature
                .iter_mut()
                .for_each(|strain| *strain *= growth);
            vertex.natural.twist *= growth;
            vertex
                .stiffness
                .bending
                .iter_mut()
                .for_each(|bending| *bending /= growth);
            vertex.stiffness.twisting /= growth;
        }
    }

    /// Restores the natural strains of the rods without actuation.
    pub(crate) fn withdraw(&self, rods: &mut ElasticRods) {
        if self.is_empty() {
            return;
        }
        for (vertex, (natural, stiffness)) in rods.vertices.iter_mut().zip(&self.vertices) {
            (vertex.natural, vertex.stiffness) = (*natural, *stiffness);
        }
        for (edge, length) in rods.edges.iter_mut().zip(&self.lengths) {
            edge.natural_length = *length;
        }
    }
}

impl Term for Actuators {
    /// # Errors
    /// [`LoadError::NoSuchRod`].
    fn new(scene: &Scene, assembly: &mut Assembly) -> Result<Self, SceneError> {
        let (actuations, rods) = (&scene.actuations, assembly.rods.rods.len());
        if let Some(missing) = actuations.iter().find(|actuation| actuation.rod >= rods) {
            return Err(LoadError::NoSuchRod(missing.rod).into());
        }
        let mut actuators = Self {
            changes_length: actuations
                .iter()
                .any(|actuation| actuation.strain == ActuatedStrain::Length),
            actuations: actuations.clone(),
            ..Self::default()
        };
        actuators.resolve(assembly);
        Ok(actuators)
    }

    fn kind(&self) -> Kind {
        Kind::Elastic
    }

    fn has_copies(&self) -> bool {
        true
    }

    /// Sets the natural strains of the rods at the present time.
    fn drive(&mut self, time: f64, rods: &mut ElasticRods, geometry: &mut RodGeometry) {
        if !self.is_empty() {
            self.apply(time, rods);
            geometry.take_natural_strains(rods);
        }
    }

    /// Actuation changes the natural strains of rods, and thereby their elastic forces; the term
    /// itself adds no forces.
    fn add_forces(&self, _: &Configuration, _: &mut [f64]) {}

    fn list_events(&self, events: &mut Vec<Event>) {
        let courses = self.actuations.iter().map(|actuation| &actuation.course);
        events.extend(courses.flat_map(|course| course.corners().map(Event::of_load)));
    }
}
