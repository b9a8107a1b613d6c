//! Conversion of a scene description to numbered rods, masses, held unknowns and moving clamps.

use super::clamps::{Drive, HeldEdge};
use super::joints::{JointPlan, Joints};
use super::rod_scale::RodScale;
use super::shared_mass::ConsistentMasses;
use crate::mechanics::rod::vertex::{VertexStiffness, VertexStrains};
use crate::mechanics::rod::{
    BendingStrain, Edge, ElasticRods, GhostEdge, Placement, ReferenceFrames, RodRange, STRIDE,
    TURNING_ROTATION, Vertex, VertexUnknowns, VertexWeights,
};
use crate::mechanics::scene::{
    EdgeSection, FreeBody, Inertia, NaturalShape, RodDescription, Scene,
};
use crate::mechanics::{RodError, SceneError, Vector3};

/// The rods of a scene, numbered and placed, with their clamps and joints.
#[derive(Clone, Debug)]
pub struct Assembly {
    /// The elastic rods.
    pub rods: ElasticRods,
    /// Name of each rod.
    pub names: Vec<String>,
    /// Name of each obstacle.
    pub obstacles: Vec<String>,
    /// Smallest radius of each rod, m.
    pub radii: Vec<f64>,
    /// Unknowns at time zero, 4 per node, then those of the frames of joints and bodies.
    pub unknowns: Vec<f64>,
    /// Velocities at time zero, 4 per node.
    pub velocity: Vec<f64>,
    /// Frames at time zero.
    pub reference: ReferenceFrames,
    /// Ghost edges at time zero.
    pub ghosts: Vec<GhostEdge>,
    /// Lumped mass (kg) or moment of inertia (kg m²) of each unknown, the sum of its row of the
    /// mass matrix; zero if it has none.
    pub masses: Vec<f64>,
    /// Densities of the rods with consistent inertia, and the masses that their neighbours share.
    pub consistent: ConsistentMasses,
    /// Unknowns that are prescribed.
    pub held: Vec<bool>,
    /// Nodes of rods that are held as a whole, as rigid obstacles.
    pub obstacle: Vec<bool>,
    /// Clamps that hold or drive nodes and ghost edges.
    pub drives: Vec<Drive>,
    /// Nodes that coincide, and frames that turn.
    pub joints: Joints,
    /// Scales of each rod.
    pub scales: Vec<RodScale>,
    /// Force scale EI/L² of the stiffest free rod, N; 1 N if every rod is held.
    pub force_scale: f64,
    /// Smallest EI/L² of the free rods, N.
    pub softest_scale: f64,
    /// Smallest natural edge length of the free rods, m.
    pub shortest_edge: f64,
    /// Rounding error of an elastic force per coordinate, N/m: EA ε/l̃ of the stiffest free rod.
    pub rounding_stiffness: f64,
}

/// Clamp of the direction and the material frame of a rod at a node.
#[derive(Clone, Copy)]
enum Wall {
    /// A clamp, by its number.
    Clamp(usize),
    /// The frame of a joint or body, by its index.
    Frame(usize),
}

impl Assembly {
    /// Numbers and places all parts of a scene.
    ///
    /// # Errors
    /// [`SceneError`] names the invalid rod or clamp.
    pub(crate) fn new(scene: &Scene) -> Result<Self, SceneError> {
        if scene.rods.is_empty() && scene.free_bodies.is_empty() {
            return Err(SceneError::NoRods);
        }
        let of_rods = scene.rods.iter().map(|rod| rod.centreline.len());
        let nodes = of_rods
            .chain(scene.free_bodies.iter().map(FreeBody::nodes))
            .sum();
        let plan = JointPlan::new(scene)?;
        let places = nodes + plan.places();
        let mut assembly = Self {
            rods: ElasticRods {
                nodes,
                ..ElasticRods::default()
            },
            names: Vec::new(),
            obstacles: (scene.obstacles.iter())
                .map(|obstacle| obstacle.name.clone())
                .collect(),
            radii: Vec::new(),
            unknowns: vec![0.0; STRIDE * places],
            velocity: vec![0.0; STRIDE * places],
            reference: ReferenceFrames {
                tangent: vec![Vector3::x(); nodes],
                director: vec![Vector3::y(); nodes],
                twist: Vec::new(),
            },
            ghosts: Vec::new(),
            masses: vec![0.0; STRIDE * places],
            consistent: ConsistentMasses::default(),
            held: vec![false; STRIDE * places],
            joints: plan.with_unknowns(nodes),
            obstacle: vec![false; nodes],
            drives: Vec::new(),
            scales: Vec::new(),
            force_scale: 0.0,
            softest_scale: f64::INFINITY,
            shortest_edge: f64::INFINITY,
            rounding_stiffness: 0.0,
        };
        let mut first_node = 0;
        for (index, rod) in scene.rods.iter().enumerate() {
            assembly
                .add_rod(index, rod, first_node, scene, &plan)
                .map_err(|reason| SceneError::Rod {
                    name: rod.name.clone(),
                    reason,
                })?;
            first_node += rod.centreline.len();
        }
        assembly.consistent.share(&assembly.rods);
        assembly.add_free_bodies(scene, first_node)?;
        assembly.join(scene, &plan)?;
        if assembly.force_scale == 0.0 {
            assembly.force_scale = 1.0;
            assembly.shortest_edge = 1.0;
        }
        Ok(assembly)
    }

    fn add_rod(
        &mut self,
        index: usize,
        rod: &RodDescription,
        first_node: usize,
        scene: &Scene,
        plan: &JointPlan,
    ) -> Result<(), RodError> {
        let least = if rod.closed { 3 } else { 2 };
        if rod.centreline.len() < least {
            return Err(RodError::TooFewNodes {
                least,
                nodes: rod.centreline.len(),
            });
        }
        let range = RodRange {
            first_node,
            nodes: rod.centreline.len(),
            closed: rod.closed,
            rigid: false,
        };
        check_sections(rod, &range)?;
        let place = |nodes: &[Vector3], twist: f64, tangents| {
            Placement::new(nodes, rod.closed, rod.first_director, twist, tangents)
        };
        let placed = place(&rod.centreline, rod.twist, rod.end_tangents)?;
        let natural_placement = match &rod.natural_shape {
            NaturalShape::Centreline(points) if points.len() != rod.centreline.len() => {
                return Err(RodError::NaturalShape {
                    natural: points.len(),
                    nodes: rod.centreline.len(),
                });
            }
            NaturalShape::Centreline(points) => Some(place(points, 0.0, [None, None])?),
            _ => None,
        };
        let natural_lengths = match (&rod.natural_shape, &natural_placement) {
            (NaturalShape::Strains(natural), _) => {
                let counts = [natural.curvature.len(), natural.twist.len()];
                for count in counts
                    .into_iter()
                    .chain([natural.lengths.len() + range.nodes - range.edges()])
                {
                    if count != range.nodes {
                        return Err(RodError::NaturalShape {
                            natural: count,
                            nodes: range.nodes,
                        });
                    }
                }
                &natural.lengths
            }
            (_, Some(natural)) => &natural.lengths,
            (_, None) => &placed.lengths,
        };
        let natural_lengths = rod.relaxed(natural_lengths.clone());
        self.place_nodes(rod, &range, &placed);
        self.add_edges_and_masses(rod, &range, &natural_lengths);
        let first_vertex = self.rods.vertices.len();
        self.add_vertices(
            index,
            rod,
            &range,
            scene,
            &placed,
            natural_placement.as_ref(),
            &natural_lengths,
            plan,
        )?;
        // The weights beside clamps are those of walls at rest.
        let turns = (0..range.nodes).any(|node| plan.frame_at(index, node).is_some());
        if rod.inertia == Inertia::Consistent && !rod.held && !turns {
            self.rods.refine(first_vertex);
            self.consistent.add_rod(range, rod);
        }
        let scale = RodScale::of(rod, &natural_lengths);
        self.scales.push(scale);
        if !rod.held {
            let length: f64 = natural_lengths.iter().sum();
            self.force_scale = self.force_scale.max(scale.force);
            let soft = rod.softest_bending();
            self.softest_scale = self.softest_scale.min(soft / (length * length));
            self.shortest_edge = self.shortest_edge.min(scale.shortest_edge);
            self.rounding_stiffness = self.rounding_stiffness.max(scale.rounding_stiffness);
        }
        self.rods.rods.push(range);
        self.names.push(rod.name.clone());
        self.radii.push(rod.least_radius());
        Ok(())
    }

    fn place_nodes(&mut self, rod: &RodDescription, range: &RodRange, placed: &Placement) {
        let centroid = rod.centreline.iter().sum::<Vector3>() / range.nodes as f64;
        for (k, (node, x)) in range.node_indices().zip(&rod.centreline).enumerate() {
            self.unknowns[STRIDE * node..STRIDE * node + 3].copy_from_slice(x.as_slice());
            if !rod.held {
                let velocity = rod.velocity + rod.angular_velocity.cross(&(x - centroid));
                self.velocity[STRIDE * node..STRIDE * node + 3]
                    .copy_from_slice(velocity.as_slice());
            }
            if k < range.edges() {
                self.reference.tangent[node] = placed.tangents[k];
                self.reference.director[node] = placed.directors[k];
                self.unknowns[STRIDE * node + 3] = placed.angles[k];
            }
            self.obstacle[node] = rod.held;
            for axis in 0..STRIDE {
                let unused = axis == 3 && k >= range.edges();
                self.held[STRIDE * node + axis] = rod.held || unused;
            }
        }
    }

    fn add_edges_and_masses(
        &mut self,
        rod: &RodDescription,
        range: &RodRange,
        natural_lengths: &[f64],
    ) {
        for (k, edge) in range.edge_indices().enumerate() {
            let (end, length) = (range.end_of(edge), natural_lengths[k]);
            let section = rod.section(k);
            self.rods.edges.push(Edge {
                start: edge,
                end,
                natural_length: length,
                stretching: section.stretching,
            });
            let [at_start, at_end] = section.mass_per_length;
            for axis in 0..3 {
                self.masses[STRIDE * edge + axis] += 0.5 * at_start * length;
                self.masses[STRIDE * end + axis] += 0.5 * at_end * length;
            }
            self.masses[STRIDE * edge + 3] = section.rotational_inertia_per_length * length;
        }
    }

    #[allow(clippy::too_many_arguments)] // one private call; a struct of these would have no other use
    fn add_vertices(
        &mut self,
        index: usize,
        rod: &RodDescription,
        range: &RodRange,
        scene: &Scene,
        placed: &Placement,
        natural_placement: Option<&Placement>,
        natural_lengths: &[f64],
        plan: &JointPlan,
    ) -> Result<(), RodError> {
        let mut drive_of_node = vec![None; range.nodes];
        for clamp in scene.clamps.iter().filter(|clamp| clamp.rod == index) {
            if clamp.node >= range.nodes {
                return Err(RodError::ClampOutside {
                    node: clamp.node,
                    nodes: range.nodes,
                });
            }
            if drive_of_node[clamp.node].is_some() {
                return Err(RodError::TwoClamps { node: clamp.node });
            }
            let node = range.first_node + clamp.node;
            let frame = placed.frame_at_node(clamp.node);
            if clamp.holds_position {
                self.held[STRIDE * node..STRIDE * node + 3].fill(true);
            }
            drive_of_node[clamp.node] = Some((self.drives.len(), clamp.holds_frame));
            self.drives
                .push(Drive::new(clamp, node, rod.centreline[clamp.node], frame));
        }
        let natural = |node: usize,
                       placed_strains: VertexStrains,
                       of_shape: &dyn Fn(&Placement) -> VertexStrains,
                       voronoi: f64| {
            match &rod.natural_shape {
                NaturalShape::AsPlaced => placed_strains,
                NaturalShape::Straight => VertexStrains::default(),
                NaturalShape::Curved { curvature, twist } => {
                    let integrated = curvature.map(|curvature| curvature * voronoi);
                    VertexStrains::about_directors(integrated, twist * voronoi)
                }
                NaturalShape::Strains(natural) => {
                    let integrated = natural.curvature[node].map(|one| one * voronoi);
                    VertexStrains::about_directors(integrated, natural.twist[node] * voronoi)
                }
                NaturalShape::Centreline(_) => of_shape(natural_placement.expect("placed above")),
            }
        };
        let edges = range.edges();
        for k in 0..range.nodes {
            let before = if k > 0 {
                Some(k - 1)
            } else if rod.closed {
                Some(edges - 1)
            } else {
                None
            };
            let after = (k < edges).then_some(k);
            let clamp = drive_of_node[k].and_then(|(drive, frame)| frame.then_some(drive));
            let frame = plan.frame_at(index, k).map(Wall::Frame);
            if let Some(wall) = clamp.map(Wall::Clamp).or(frame) {
                // The wall is at the node: there is a half vertex on each side that has an edge.
                for (edge, ghost_first) in [(before, false), (after, true)] {
                    let Some(edge) = edge else { continue };
                    let start = range.first_node + edge;
                    let end = range.end_of(start);
                    let other = if ghost_first { end } else { start } - range.first_node;
                    let whole = drive_of_node[other].is_some_and(|(neighbour, frame)| {
                        !frame && self.drives[neighbour].holds_position
                    });
                    if let Wall::Clamp(drive) = wall
                        && whole
                        && self.drives[drive].holds_position
                    {
                        // The edge itself is the wall and turns with the clamp.
                        let director = placed.material_director(edge);
                        self.held[STRIDE * start + 3] = true;
                        let angle = placed.angles[edge];
                        self.drives[drive]
                            .edges
                            .push(HeldEdge::new([start, end], director, angle));
                        continue;
                    }
                    let voronoi = 0.5 * natural_lengths[edge];
                    let placed_strains = placed.ghost_strains(k, edge, ghost_first);
                    let of_shape = |shape: &Placement| shape.ghost_strains(k, edge, ghost_first);
                    let ghost = self.rods.nodes + self.rods.ghosts;
                    let unknowns = match wall {
                        Wall::Clamp(drive) => {
                            self.add_clamped_ghost(drive);
                            let (from, to) = if ghost_first { (4, 11) } else { (0, 7) };
                            self.unknowns_of(range, k, from, to)
                        }
                        Wall::Frame(frame) => {
                            let frame_there = placed.frame_at_node(k);
                            let length = natural_lengths[edge];
                            let element =
                                self.add_turning_ghost(frame, frame_there, [start, end], length);
                            VertexUnknowns::Turning {
                                element,
                                ghost_first,
                            }
                        }
                    };
                    let angle = placed.angles[edge];
                    let (before, after, change) = if ghost_first {
                        (ghost, start, angle)
                    } else {
                        (start, ghost, -angle)
                    };
                    self.reference.twist.push(placed_strains.twist - change);
                    self.rods.vertices.push(Vertex {
                        before,
                        after,
                        natural: natural(k, placed_strains, &of_shape, voronoi),
                        stiffness: stiffness(
                            rod,
                            &[(edge, usize::from(!ghost_first))],
                            natural_lengths,
                            voronoi,
                        ),
                        strain: BendingStrain::default(),
                        weights: VertexWeights::default(),
                        joint_twist: 0.0,
                        unknowns,
                    });
                }
            } else if let (Some(before), Some(after)) = (before, after) {
                let voronoi = 0.5 * (natural_lengths[before] + natural_lengths[after]);
                let placed_strains = placed.strains(before, after);
                let of_shape = |shape: &Placement| shape.strains(before, after);
                // Around a ring the frames need not match: the closing vertex contains the
                // difference.
                let change = placed.angles[after] - placed.angles[before];
                let mut reference_twist = placed_strains.twist - change;
                let mut joint_twist = 0.0;
                if after < before {
                    let around = placed.joint_reference_twist();
                    joint_twist = change + around - placed_strains.twist;
                    reference_twist = around;
                }
                self.reference.twist.push(reference_twist);
                let unknowns = self.unknowns_of(range, k, 0, 11);
                self.rods.vertices.push(Vertex {
                    before: range.first_node + before,
                    after: range.first_node + after,
                    natural: natural(k, placed_strains, &of_shape, voronoi),
                    stiffness: stiffness(rod, &[(before, 1), (after, 0)], natural_lengths, voronoi),
                    strain: BendingStrain::default(),
                    weights: VertexWeights::default(),
                    joint_twist,
                    unknowns,
                });
            }
        }
        Ok(())
    }

    /// Adds a ghost edge that follows a clamp.
    fn add_clamped_ghost(&mut self, drive: usize) {
        let ghost = self.rods.ghosts;
        self.rods.ghosts += 1;
        self.ghosts.push(self.drives[drive].frame);
        self.drives[drive].ghosts.push(ghost);
    }

    /// Adds a ghost edge that turns with a frame beside the edge between two nodes; returns the
    /// index of the element of its half vertex.
    fn add_turning_ghost(
        &mut self,
        frame: usize,
        placed: GhostEdge,
        [start, end]: [usize; 2],
        length: f64,
    ) -> usize {
        let ghost = self.rods.ghosts;
        self.rods.ghosts += 1;
        self.rods.turning_ghosts.push(ghost);
        self.ghosts.push(placed);
        let frame = &mut self.joints.frames[frame];
        frame.ghosts.push((ghost, placed));
        frame.elements.push(self.rods.elements.len());
        frame.length = frame.length.min(length);
        let mut element = [usize::MAX; 12];
        for axis in 0..3 {
            element[axis] = STRIDE * start + axis;
            element[STRIDE + axis] = STRIDE * end + axis;
            element[TURNING_ROTATION + axis] = frame.first_unknown + axis;
        }
        element[3] = STRIDE * start + 3;
        self.rods.elements.push(element);
        self.rods.elements.len() - 1
    }

    /// Location of the local unknowns `from..to` of the vertex at node `k` of a rod.
    fn unknowns_of(
        &mut self,
        range: &RodRange,
        k: usize,
        from: usize,
        to: usize,
    ) -> VertexUnknowns {
        let previous = if k == 0 { range.nodes - 1 } else { k - 1 };
        let next = if k + 1 == range.nodes { 0 } else { k + 1 };
        let consecutive = (k > 0 || from >= 4) && (k + 1 < range.nodes || to <= 7);
        if consecutive {
            return VertexUnknowns::Consecutive {
                first: STRIDE * (range.first_node + k) + from - 4,
                from,
                to,
            };
        }
        let mut element = [usize::MAX; 12];
        for local in from..to {
            let node = [previous, k, next][local / STRIDE];
            element[local] = STRIDE * (range.first_node + node) + local % STRIDE;
        }
        self.rods.elements.push(element);
        VertexUnknowns::Closing {
            element: self.rods.elements.len() - 1,
        }
    }

    /// Fastest steady rotation of a clamp, rad/s; 0 if none rotates.
    pub(crate) fn steady_turning(&self) -> f64 {
        let rates = self.drives.iter().map(Drive::angular_velocity);
        rates.fold(0.0, |fastest, rate| fastest.max(rate.abs()))
    }

    /// Whether an index belongs to a node whose position is not prescribed. Vertices of obstacles
    /// have larger indices, as places of frames and slides do among the unknowns.
    pub(crate) fn is_free(&self, node: usize) -> bool {
        node < self.rods.nodes && !self.held[STRIDE * node]
    }

    /// Node of a vertex.
    pub(crate) fn node_of(&self, vertex: &Vertex) -> usize {
        if vertex.after < self.rods.nodes {
            return vertex.after;
        }
        let (rod, _) = self.locate(vertex.before);
        self.rods.rods[rod].end_of(vertex.before)
    }

    /// Place of a vertex that stays the same when clamps are added or removed elsewhere: its node,
    /// and whether its edges are those of clamps.
    pub(super) fn place_of(&self, vertex: &Vertex) -> (usize, [bool; 2]) {
        let is_of_clamp = |edge: usize| edge >= self.rods.nodes;
        let edges = [vertex.before, vertex.after];
        (self.node_of(vertex), edges.map(is_of_clamp))
    }

    /// Includes the rounding error of a position in the rounding error of a force with a stiffness
    /// (N/m) at a node.
    pub(super) fn round(&mut self, node: usize, stiffness: f64) {
        let rounding = stiffness * f64::EPSILON;
        let (rod, _) = self.locate(node);
        let scale = &mut self.scales[rod];
        scale.rounding_stiffness = scale.rounding_stiffness.max(rounding);
        self.rounding_stiffness = self.rounding_stiffness.max(rounding);
    }

    /// Rod of a node of the whole scene, and the index of the node along it.
    pub(crate) fn locate(&self, node: usize) -> (usize, usize) {
        let rod = self
            .rods
            .rods
            .partition_point(|range| range.first_node <= node)
            - 1;
        (rod, node - self.rods.rods[rod].first_node)
    }
}

/// Checks the number of sections of a rod, and that its inertia may vary.
fn check_sections(rod: &RodDescription, range: &RodRange) -> Result<(), RodError> {
    match rod.sections.len() {
        0 => Ok(()),
        sections if sections != range.edges() => Err(RodError::Sections {
            sections,
            edges: range.edges(),
        }),
        _ if rod.inertia == Inertia::Consistent => Err(RodError::ConsistentSections),
        _ => Ok(()),
    }
}

/// Stiffness of a vertex to which `halves` of edges belong, each given by the edge and its end at
/// the vertex: their compliances add up.
fn stiffness(
    rod: &RodDescription,
    halves: &[(usize, usize)],
    lengths: &[f64],
    voronoi: f64,
) -> VertexStiffness {
    let stiffness = &rod.stiffness;
    if rod.sections.is_empty() {
        return VertexStiffness::about_directors(stiffness.bending, stiffness.twisting, voronoi);
    }
    let mean = |of: &dyn Fn(&EdgeSection, usize) -> f64| {
        let parts = halves.iter();
        let compliances =
            parts.map(|&(edge, end)| 0.5 * lengths[edge] / of(&rod.sections[edge], end));
        voronoi / compliances.sum::<f64>()
    };
    let bending = [0, 1].map(|axis| mean(&|section, end| section.bending[end][axis]));
    let twisting = mean(&|section, end| section.twisting[end]);
    VertexStiffness::about_directors(bending, twisting, voronoi)
}
