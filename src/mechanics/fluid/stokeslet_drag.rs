//! Drag by regularized Stokeslet segments: one resistance problem per time step.

use super::chain::{Link, links};
use super::flow::Flow;
use super::gmres::{Convergence, Gmres, dot, scale};
use super::initial_guess::{InitialGuess, KEPT};
use super::points::Points;
use super::preconditioner::{NEIGHBOURHOOD, Preconditioner};
use super::report::FluidReport;
use super::ties::{Rail, Ties, rails, smaller_regularization};
use super::wall::{FlowWall, Wall};
use super::{Connections, Filament, FluidError};
use crate::mechanics::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Relative residual ‖b − A f‖/‖b‖ at which a solve stops. The discretisation itself errs by some 10⁻³
/// (thesis' helix), so that 10⁻⁶ is never what limits; smaller costs about an iteration per decade.
const TOLERANCE: f64 = 1e-6;
/// The same over the error allowed in the drag where the operator is approximate. The operator's own error
/// in the velocities is about a twentieth of that, so that a smaller residual would mean nothing.
const TOLERANCE_OF_FAR_FIELD_ERROR: f64 = 0.1;
/// Operations of a preconditioner that is not made larger any more, four times as dear: this one takes half a minute.
const MOST_OPERATIONS: f64 = 2e11;
/// Iterations after which the preconditioner is held to be too coarse. Tight bundles take some twenty.
const MOST_ITERATIONS: usize = 40;
/// Most nodes beside a wall. All pairs are stored, 36 bytes each: this many take 0.9 GB.
const MOST_NODES_BESIDE_A_WALL: usize = 5000;
/// Power iterations that estimate the largest ratio of the resistance to its local part: ten come within 5 % of it for a
/// straight filament of 40 edges.
const POWER_ITERATIONS: usize = 10;

/// What later solves remember of earlier ones.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StokesletMemory {
    /// Which stations are one point.
    ties: Ties,
    /// The last solutions, newest first, three numbers per point.
    densities: [Vec<f64>; KEPT],
    age: Age,
    /// Positions of the stations for which the preconditioner was built; empty before the first solve.
    preconditioned_at: Vec<[f64; 3]>,
    /// Nodes of its neighbourhoods.
    neighbourhood: usize,
}

/// What the present preconditioner has cost since it was built.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Age {
    /// Solves with it.
    solves: usize,
    /// Iterations of all of them.
    iterations: usize,
    /// Iterations of a solve lately, smoothed.
    recent: f64,
}

impl Age {
    /// Solves over which `recent` is smoothed.
    const MEMORY: f64 = 8.0;

    fn record(&mut self, iterations: usize) {
        let weight = if self.solves == 0 {
            1.0
        } else {
            1.0 / Self::MEMORY
        };
        self.recent += weight * (iterations as f64 - self.recent);
        self.solves += 1;
        self.iterations += iterations;
    }

    /// Whether to build anew: once a solve costs more than solves have cost on average since the last
    /// building, its price (in iterations) included. For costs that only grow this rule is the best one.
    fn is_over(&self, price: f64) -> bool {
        self.recent * self.solves as f64 > price + self.iterations as f64
    }
}

/// Solves A f = 8πη u again and again for nodes that move a little in between (thesis Eq. 2.27); where nodes of several
/// filaments are one point, for the points ([`Points`]).
///
/// GMRES starts from the best combination of the last solutions and is preconditioned by inverses of
/// neighbourhoods at some earlier time; these are built anew when their age has made solves too dear.
/// Where they do not lead to convergence even when new, the neighbourhoods double. That happens for nodes
/// much closer than ε, whose operator is ill-conditioned, and ends when a neighbourhood holds all nodes.
pub(super) struct StokesletDrag {
    viscosity: f64,
    filaments: Vec<Filament>,
    rails: Vec<Rail>,
    links: Vec<Link>,
    /// Which stations are one point.
    ties: Ties,
    /// The plane at which the fluid is at rest.
    wall: Option<FlowWall>,
    operator: Flow,
    /// Relative residual at which a solve stops.
    tolerance: f64,
    preconditioner: Preconditioner,
    /// Empty before the first solve.
    preconditioned_at: Vec<Vector3>,
    age: Age,
    guess: InitialGuess,
    gmres: Gmres,
    /// Of the stations, m.
    positions: Vec<Vector3>,
    /// Of the stations, m/s.
    velocities: Vec<Vector3>,
    /// Voronoi lengths Δl of the stations, m.
    lengths: Vec<f64>,
    /// Inverse of A_pp of each point, its symmetric part.
    inverses: Vec<Matrix3>,
    /// Estimate of the largest eigenvalue of D⁻¹ R where the preconditioner was built.
    largest_ratio: f64,
    right_hand_side: Vec<f64>,
    residual: Vec<f64>,
    /// Scratch: a product.
    image: Vec<f64>,
    densities: Vec<f64>,
}

impl StokesletDrag {
    /// Sets up all room that solves need.
    pub fn new(
        viscosity: f64,
        regularization: f64,
        far_field_error: f64,
        filaments: &[Filament],
    ) -> Self {
        let operator = Flow::new(filaments, regularization, far_field_error);
        let nodes = operator.nodes();
        let unknowns = 3 * nodes;
        Self {
            viscosity,
            filaments: filaments.to_vec(),
            rails: Vec::new(),
            links: links(filaments, regularization),
            ties: Ties::default(),
            wall: None,
            tolerance: match operator.exact() {
                Some(_) => TOLERANCE,
                None => TOLERANCE.max(TOLERANCE_OF_FAR_FIELD_ERROR * far_field_error),
            },
            preconditioner: Preconditioner::new(filaments, &operator, NEIGHBOURHOOD),
            operator,
            preconditioned_at: Vec::with_capacity(nodes),
            age: Age::default(),
            guess: InitialGuess::new(unknowns),
            gmres: Gmres::new(unknowns),
            positions: vec![Vector3::zeros(); nodes],
            velocities: vec![Vector3::zeros(); nodes],
            lengths: vec![0.0; nodes],
            inverses: vec![Matrix3::zeros(); nodes],
            largest_ratio: f64::INFINITY,
            right_hand_side: vec![0.0; unknowns],
            residual: vec![0.0; unknowns],
            image: vec![0.0; unknowns],
            densities: vec![0.0; unknowns],
        }
    }

    /// Puts a wall beside the filaments, before they are connected and anything is solved; `regularization` as in
    /// [`new`](Self::new).
    ///
    /// # Errors
    /// [`FluidError::BadInput`] for more nodes than a wall allows.
    pub fn set_wall(&mut self, regularization: f64, wall: Wall) -> Result<(), FluidError> {
        let nodes = self.positions.len();
        if nodes > MOST_NODES_BESIDE_A_WALL {
            return Err(FluidError::BadInput(format!(
                "the flow beside a wall has no far-field approximation, and holds at most {MOST_NODES_BESIDE_A_WALL} nodes, not {nodes}: \
                 take fewer nodes, or planes.wall = false"
            )));
        }
        let wall = FlowWall::new(wall, &self.filaments);
        self.operator = Flow::beside_wall(&self.filaments, regularization, wall.clone());
        self.tolerance = TOLERANCE;
        self.preconditioner = Preconditioner::new(&self.filaments, &self.operator, NEIGHBOURHOOD);
        self.wall = Some(wall);
        Ok(())
    }

    /// The wall, if there is one.
    pub fn wall(&self) -> Option<&FlowWall> {
        self.wall.as_ref()
    }

    /// Ties what joints hold together, and nodes that are at one place, in filaments placed at `positions` (m, of all nodes).
    pub fn connect(&mut self, connections: &Connections, positions: &[Vector3]) {
        for (station, node) in self.filaments.iter().flat_map(Filament::range).enumerate() {
            self.positions[station] = positions[node];
        }
        self.rails = rails(&self.filaments, connections);
        self.ties = Ties::find(
            &self.filaments,
            connections,
            &self.rails,
            &self.links,
            &self.positions,
        );
        if !self.ties.is_empty() {
            self.take_points();
        }
    }

    /// Pairs of nodes that were at one place when the filaments were placed, without a joint.
    pub fn met_by_chance(&self) -> Vec<[usize; 2]> {
        let nodes: Vec<usize> = self.filaments.iter().flat_map(Filament::range).collect();
        let met = self.ties.pairs.iter().filter(|tie| !tie.is_joined);
        met.map(|tie| tie.stations.map(|station| nodes[station]))
            .collect()
    }

    /// See [`Fluid::nearest_nodes`](super::Fluid::nearest_nodes).
    pub fn nearest_nodes(&self, positions: &[Vector3]) -> Option<([usize; 2], f64)> {
        let nodes: Vec<usize> = self.filaments.iter().flat_map(Filament::range).collect();
        let stations = self.operator.points().representatives();
        let pairs = stations.iter().enumerate().flat_map(|(k, &a)| {
            let others = stations[k + 1..].iter();
            others
                .filter(move |&&b| self.links[a].next != Some(b) && self.links[b].next != Some(a))
                .map(move |&b| [a, b])
        });
        let distances = pairs.map(|pair| {
            let [a, b] = pair.map(|station| nodes[station]);
            let distance = (positions[a] - positions[b]).norm();
            ([a, b], distance / smaller_regularization(&self.links, pair))
        });
        distances.min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Force on each node, and its local resistance D_i. With Δl_i its own Voronoi length, f_p the force density of its
    /// point, and the symmetric part of A_pp⁻¹,
    ///
    /// ```text
    /// F_i = −f_p Δl_i − D_i (u_i − u_p),   D_i = 8πη Δl_i A_pp⁻¹
    /// ```
    ///
    /// where u_p is the velocity of the point: the nodes of a joint have no other. A node that slides has the density and the
    /// velocity of the rail where it is for f_p and u_p, and its own block of A, so that what it moves along the rail
    /// meets the resistance of its own length.
    /// Arguments as in [`Fluid::drag`](super::Fluid::drag).
    pub fn drag(
        &mut self,
        positions: &[Vector3],
        velocities: &[Vector3],
        forces: &mut [Vector3],
        resistance: &mut [Matrix3],
    ) -> Result<FluidReport, FluidError> {
        for (own, node) in (self.positions.iter_mut()).zip(nodes_of(&self.filaments)) {
            *own = positions[node];
        }
        if !are_finite(&self.positions) {
            return Err(FluidError::NotFinite);
        }
        if let Some(wall) = &self.wall {
            wall.clip(&self.links, &mut self.positions)?;
        }
        voronoi_lengths(&self.filaments, &self.positions, &mut self.lengths)?;
        if (self.ties).update(&self.links, &self.rails, &self.positions) {
            self.take_points();
        }
        self.operator.assemble(&self.positions);
        self.set_velocities(velocities)?;
        let report = self.solve(Start::Guess)?;
        self.write_resistance(resistance)?;
        self.write_forces(forces, resistance);
        Ok(report)
    }

    /// Force on each node for other velocities, with the nodes where they were in the last [`drag`](Self::drag), which gave
    /// them a local `resistance`.
    pub fn drag_of(
        &mut self,
        velocities: &[Vector3],
        resistance: &[Matrix3],
        forces: &mut [Vector3],
    ) -> Result<FluidReport, FluidError> {
        self.set_velocities(velocities)?;
        let report = self.solve(Start::LastSolution)?;
        self.write_forces(forces, resistance);
        Ok(report)
    }

    /// Relative residual at which a solve stops.
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// Estimate of the largest eigenvalue of D⁻¹ R: how many times its local part D the resistance R of the nodes is, for
    /// the velocities for which that is most. It belongs to the positions at which the preconditioner was built.
    pub fn largest_ratio(&self) -> f64 {
        self.largest_ratio
    }

    fn set_velocities(&mut self, velocities: &[Vector3]) -> Result<(), FluidError> {
        for (own, node) in (self.velocities.iter_mut()).zip(nodes_of(&self.filaments)) {
            *own = velocities[node];
        }
        if !are_finite(&self.velocities) {
            return Err(FluidError::NotFinite);
        }
        self.average_velocities();
        if let Some(wall) = &self.wall {
            // Points in the wall take no force, however they move.
            let points = self.operator.points().representatives().iter();
            for (&station, velocity) in points.zip(self.right_hand_side.chunks_exact_mut(3)) {
                if wall.holds(station, &self.positions[station]) {
                    velocity.fill(0.0);
                }
            }
        }
        Ok(())
    }

    /// Whether a station is in the wall, where it takes no force.
    fn is_in_wall(&self, station: usize) -> bool {
        (self.wall.as_ref()).is_some_and(|wall| wall.holds(station, &self.positions[station]))
    }

    /// Sets up what depends on the number of points, and forgets earlier solutions.
    fn take_points(&mut self) {
        let points = Points::new(&self.ties, &self.rails, &self.positions);
        self.operator.take_points(points);
        let nodes = self.operator.nodes();
        let unknowns = 3 * nodes;
        self.preconditioner = Preconditioner::new(&self.filaments, &self.operator, NEIGHBOURHOOD);
        self.preconditioned_at.clear();
        self.age = Age::default();
        self.guess = InitialGuess::new(unknowns);
        self.gmres = Gmres::new(unknowns);
        self.inverses = vec![Matrix3::zeros(); nodes];
        for vector in [
            &mut self.right_hand_side,
            &mut self.residual,
            &mut self.image,
            &mut self.densities,
        ] {
            vector.clear();
            vector.resize(unknowns, 0.0);
        }
    }

    /// Gives each point the velocity of its stations, their mean weighted by their lengths.
    fn average_velocities(&mut self) {
        let points = self.operator.points();
        for (point, mean) in self.right_hand_side.chunks_exact_mut(3).enumerate() {
            let members = points.members(point);
            if let [station] = members {
                mean.copy_from_slice(self.velocities[*station].as_slice());
                continue;
            }
            let mut sum = Vector3::zeros();
            let mut length = 0.0;
            for &station in members {
                sum += self.velocities[station] * self.lengths[station];
                length += self.lengths[station];
            }
            mean.copy_from_slice((sum / length).as_slice());
        }
    }

    /// Writes the local resistances of the nodes for the assembled operator.
    fn write_resistance(&mut self, resistance: &mut [Matrix3]) -> Result<(), FluidError> {
        for (point, inverse) in self.inverses.iter_mut().enumerate() {
            *inverse = symmetric_inverse(&self.operator.diagonal(point))?;
        }
        let factor = 8.0 * PI * self.viscosity;
        let points = self.operator.points();
        for (station, node) in nodes_of(&self.filaments).enumerate() {
            let point = points.shares(station)[0].point;
            let slides = !points.members(point).contains(&station);
            let inverse = if slides {
                symmetric_inverse(&self.operator.own_block(station))?
            } else {
                self.inverses[point]
            };
            resistance[node] = if self.is_in_wall(station) {
                Matrix3::zeros()
            } else {
                inverse * (factor * self.lengths[station])
            };
        }
        Ok(())
    }

    /// Writes the forces on the nodes from the solution for the points.
    fn write_forces(&self, forces: &mut [Vector3], resistance: &[Matrix3]) {
        let factor = 8.0 * PI * self.viscosity;
        let points = self.operator.points();
        for (station, node) in nodes_of(&self.filaments).enumerate() {
            if self.is_in_wall(station) {
                forces[node] = Vector3::zeros();
                continue;
            }
            forces[node] =
                points.value_at(station, &self.densities) * -(factor * self.lengths[station]);
            let members = points.members(points.shares(station)[0].point);
            if members.len() > 1 || !members.contains(&station) {
                let carried = points.value_at(station, &self.right_hand_side);
                forces[node] -= resistance[node] * (self.velocities[station] - carried);
            }
        }
    }

    /// What a checkpoint must hold.
    pub fn memory(&self) -> StokesletMemory {
        StokesletMemory {
            ties: self.ties.clone(),
            densities: self.guess.previous().clone(),
            age: self.age,
            preconditioned_at: self.preconditioned_at.iter().map(|&x| x.into()).collect(),
            neighbourhood: self.preconditioner.neighbourhood(),
        }
    }

    /// Continues from a checkpoint.
    ///
    /// # Errors
    /// [`FluidError::ForeignMemory`] where sizes do not fit, [`FluidError::Singular`] where its positions
    /// coincide.
    pub fn restore(&mut self, memory: StokesletMemory) -> Result<(), FluidError> {
        let stations = self.positions.len();
        let built = memory.preconditioned_at.len();
        if !memory.ties.fit(&self.ties)
            || (built != 0 && built != stations)
            || memory.neighbourhood < NEIGHBOURHOOD
        {
            return Err(FluidError::ForeignMemory);
        }
        self.ties = memory.ties;
        self.take_points();
        let nodes = self.operator.nodes();
        if memory.densities.iter().any(|d| d.len() != 3 * nodes) {
            return Err(FluidError::ForeignMemory);
        }
        self.preconditioned_at = memory
            .preconditioned_at
            .into_iter()
            .map(Vector3::from)
            .collect();
        if built != 0 {
            self.preconditioner =
                Preconditioner::new(&self.filaments, &self.operator, memory.neighbourhood);
            self.operator.assemble(&self.preconditioned_at);
            self.preconditioner
                .build(&self.links, &self.preconditioned_at, &self.operator)?;
            self.estimate_largest_ratio();
        }
        self.age = memory.age;
        self.guess.restore(memory.densities);
        Ok(())
    }

    /// Solves A f = u for the assembled operator; f lacks the factor 8πη.
    fn solve(&mut self, start: Start) -> Result<FluidReport, FluidError> {
        let size = dot(&self.right_hand_side, &self.right_hand_side).sqrt();
        let positions = self
            .positions
            .iter()
            .map(Vector3::norm_squared)
            .sum::<f64>();
        if !(size.is_finite() && positions.is_finite()) {
            return Err(FluidError::NotFinite);
        }
        let price = self.preconditioner.price(&self.operator);
        if self.preconditioned_at.is_empty() || self.age.is_over(price) {
            self.build_preconditioner()?;
        }
        let tolerance = self.tolerance * size;
        let Convergence {
            iterations,
            residual,
        } = loop {
            let convergence = self.iterate(start, tolerance);
            if convergence.residual <= tolerance {
                break convergence;
            }
            if !convergence.residual.is_finite() {
                return Err(FluidError::NotFinite);
            }
            if self.age.solves == 0 {
                let neighbourhood = self.preconditioner.neighbourhood();
                if neighbourhood >= self.operator.nodes()
                    || self.preconditioner.operations(&self.operator) > MOST_OPERATIONS
                {
                    return Err(FluidError::NoConvergence {
                        iterations: convergence.iterations,
                        residual: convergence.residual / size,
                    });
                }
                self.preconditioner =
                    Preconditioner::new(&self.filaments, &self.operator, 2 * neighbourhood);
            }
            self.build_preconditioner()?;
        };
        match start {
            Start::Guess => {
                self.age.record(iterations);
                self.guess.remember(&self.densities);
            }
            Start::LastSolution => self.guess.replace_newest(&self.densities),
        }
        Ok(FluidReport {
            iterations,
            residual: if size > 0.0 { residual / size } else { 0.0 },
        })
    }

    fn iterate(&mut self, start: Start, tolerance: f64) -> Convergence {
        match start {
            Start::Guess => {
                self.residual.copy_from_slice(&self.right_hand_side);
                self.guess
                    .start(&mut self.operator, &mut self.residual, &mut self.densities);
            }
            Start::LastSolution => {
                self.operator.multiply(&self.densities, &mut self.residual);
                for (residual, &u) in self.residual.iter_mut().zip(&self.right_hand_side) {
                    *residual = u - *residual;
                }
            }
        }
        self.gmres.solve(
            &mut self.operator,
            &mut self.preconditioner,
            &mut self.residual,
            &mut self.densities,
            tolerance,
            MOST_ITERATIONS,
        )
    }

    fn build_preconditioner(&mut self) -> Result<(), FluidError> {
        self.preconditioned_at.clear();
        self.preconditioner
            .build(&self.links, &self.positions, &self.operator)?;
        self.preconditioned_at.extend_from_slice(&self.positions);
        self.age = Age::default();
        self.estimate_largest_ratio();
        Ok(())
    }

    /// Power iteration with A⁻¹ A_d, which has the eigenvalues of D⁻¹ R, for the assembled operator; the preconditioner
    /// stands for A⁻¹.
    fn estimate_largest_ratio(&mut self) {
        let blocks: Vec<Matrix3> = (0..self.operator.nodes())
            .map(|point| self.operator.diagonal(point))
            .collect();
        let (vector, image) = (&mut self.residual, &mut self.image);
        // Neighbours against each other, with a little of everything else: rough motions meet the most resistance.
        for (k, entry) in vector.iter_mut().enumerate() {
            let node = k / 3;
            let sign = if node.is_multiple_of(2) { 1.0 } else { -1.0 };
            *entry = sign * (1.0 + 0.3 * libm::sin(1.7 * k as f64));
        }
        self.largest_ratio = 0.0;
        for _ in 0..POWER_ITERATIONS {
            scale(1.0 / dot(vector, vector).sqrt(), vector);
            for (point, block) in blocks.iter().enumerate() {
                let own = 3 * point..3 * point + 3;
                let product = block * Vector3::from_column_slice(&vector[own.clone()]);
                image[own].copy_from_slice(product.as_slice());
            }
            self.preconditioner.apply(image, vector);
            self.largest_ratio = dot(vector, vector).sqrt();
        }
    }
}

/// Where a solve starts.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Start {
    /// From the best combination of the solutions of earlier steps.
    Guess,
    /// From the last solution, which belongs to the same step.
    LastSolution,
}

fn are_finite(vectors: &[Vector3]) -> bool {
    vectors.iter().flatten().all(|x| x.is_finite())
}

/// The nodes of filaments among those of the scene.
fn nodes_of(filaments: &[Filament]) -> impl Iterator<Item = usize> {
    filaments.iter().flat_map(Filament::range)
}

/// The symmetric part of the inverse.
fn symmetric_inverse(block: &Matrix3) -> Result<Matrix3, FluidError> {
    let inverse = block.try_inverse().ok_or(FluidError::Singular)?;
    Ok((inverse + inverse.transpose()) * 0.5)
}

/// Half of the lengths of the edges of its filament that meet at each station, m. An edge without length is an error: its
/// two nodes have the same row in the operator.
fn voronoi_lengths(
    filaments: &[Filament],
    positions: &[Vector3],
    lengths: &mut [f64],
) -> Result<(), FluidError> {
    lengths.fill(0.0);
    let mut first = 0;
    for filament in filaments {
        for edge in 0..filament.edges() {
            let ends = [first + edge, first + (edge + 1) % filament.nodes];
            let half = 0.5 * (positions[ends[1]] - positions[ends[0]]).norm();
            if half == 0.0 {
                return Err(FluidError::Singular);
            }
            for node in ends {
                lengths[node] += half;
            }
        }
        first += filament.nodes;
    }
    Ok(())
}
