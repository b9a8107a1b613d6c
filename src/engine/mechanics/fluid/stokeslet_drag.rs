//! Drag by regularized Stokeslet segments: one resistance problem per time step.

mod setup;

use super::age::Age;
use super::chain::{Link, links};
use super::flow::Flow;
use super::gmres::{Convergence, Gmres, dot};
use super::initial_guess::{InitialGuess, KEPT};
use super::largest_ratio::largest_ratio;
use super::preconditioner::{NEIGHBOURHOOD, Preconditioner};
use super::report::FluidReport;
use super::rotlets::Rotlets;
use super::stations::{are_finite, nodes_of, symmetric_inverse, voronoi_lengths};
use super::ties::{Rail, Ties, smaller_regularization};
use super::wall::FlowWall;
use super::{Filament, FluidError};
use crate::mechanics::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Relative residual ‖b − A f‖/‖b‖ at which a solve stops. The discretisation itself has an error
/// of some 10⁻³ (thesis' helix), so that 10⁻⁶ never limits the accuracy; a smaller value costs
/// about an iteration per decade.
const TOLERANCE: f64 = 1e-6;
/// The relative residual for an approximate operator, as a fraction of the error allowed in the
/// drag. The operator's own error in the velocities is about a twentieth of that error, so a
/// smaller residual would not improve the result.
const TOLERANCE_OF_FAR_FIELD_ERROR: f64 = 0.1;
/// Number of operations above which a preconditioner is no longer enlarged. This one takes half a
/// minute; enlarging it would be four times as expensive.
const MOST_OPERATIONS: f64 = 2e11;
/// Number of iterations above which the preconditioner counts as too coarse. Tight bundles take
/// some twenty.
const MOST_ITERATIONS: usize = 40;
/// Results of earlier solves, used in later ones.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct StokesletMemory {
    /// Ties of stations that are one point.
    ties: Ties,
    /// The last solutions, newest first, three numbers per point.
    densities: [Vec<f64>; KEPT],
    age: Age,
    /// Positions of the stations for which the preconditioner was built; empty before the first solve.
    preconditioned_at: Vec<[f64; 3]>,
    /// Number of nodes of its neighbourhoods.
    neighbourhood: usize,
}

/// Solver for A f = 8πη u, called repeatedly for nodes that move a little in between (thesis Eq.
/// 2.27). If nodes of several filaments are one point, the unknowns are those of the points
/// ([`Points`]).
///
/// GMRES starts from the best combination of the last solutions and is preconditioned by inverses
/// of neighbourhoods at some earlier time; these are rebuilt when their age has made solves too
/// expensive. If solves do not converge even with new ones, the size of the neighbourhoods is
/// doubled. That happens for nodes much closer than ε, whose operator is ill-conditioned, and ends
/// when a neighbourhood contains all nodes.
pub(super) struct StokesletDrag {
    viscosity: f64,
    filaments: Vec<Filament>,
    rails: Vec<Rail>,
    links: Vec<Link>,
    /// Ties of stations that are one point.
    ties: Ties,
    /// The plane at which the fluid is at rest.
    wall: Option<FlowWall>,
    operator: Flow,
    /// Relative residual at which a solve stops.
    tolerance: f64,
    preconditioner: Preconditioner,
    /// Positions of the stations for which the preconditioner was built; empty before the first
    /// solve.
    preconditioned_at: Vec<Vector3>,
    age: Age,
    guess: InitialGuess,
    gmres: Gmres,
    /// Positions of the stations, m.
    positions: Vec<Vector3>,
    /// Velocities of the stations, m/s.
    velocities: Vec<Vector3>,
    /// Flow of spinning edges.
    rotlets: Rotlets,
    /// Positions of all nodes and sphere tips of a scene with spheres, m.
    places: Vec<Vector3>,
    /// Voronoi lengths Δl of the stations, m.
    lengths: Vec<f64>,
    /// Symmetric part of the inverse of A_pp of each point.
    inverses: Vec<Matrix3>,
    /// Estimate of the largest eigenvalue of D⁻¹ R, when the preconditioner was built.
    largest_ratio: f64,
    right_hand_side: Vec<f64>,
    residual: Vec<f64>,
    /// Scratch: a product.
    image: Vec<f64>,
    densities: Vec<f64>,
}

impl StokesletDrag {
    /// Allocates all storage that solves need.
    pub(crate) fn new(
        viscosity: f64,
        regularization: f64,
        far_field_error: f64,
        filaments: &[Filament],
    ) -> Self {
        let operator = Flow::new(filaments, regularization, far_field_error);
        let nodes = operator.nodes();
        let unknowns = operator.unknowns();
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
            rotlets: Rotlets::new(filaments),
            places: Vec::new(),
            lengths: vec![0.0; nodes],
            inverses: vec![Matrix3::zeros(); nodes],
            largest_ratio: f64::INFINITY,
            right_hand_side: vec![0.0; unknowns],
            residual: vec![0.0; unknowns],
            image: vec![0.0; unknowns],
            densities: vec![0.0; unknowns],
        }
    }

    /// The wall, if there is one.
    pub(crate) fn wall(&self) -> Option<&FlowWall> {
        self.wall.as_ref()
    }

    /// Pairs of unjoined nodes that were at one place when the filaments were placed.
    pub(crate) fn met_by_chance(&self) -> Vec<[usize; 2]> {
        let nodes: Vec<usize> = nodes_of(&self.filaments).collect();
        let met = self.ties.pairs.iter().filter(|tie| !tie.is_joined);
        met.map(|tie| tie.stations.map(|station| nodes[station]))
            .collect()
    }

    /// See [`Fluid::nearest_nodes`](super::Fluid::nearest_nodes).
    pub(crate) fn nearest_nodes(&self, positions: &[Vector3]) -> Option<([usize; 2], f64)> {
        let nodes: Vec<usize> = nodes_of(&self.filaments).collect();
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
    /// where u_p is the velocity of the point: joined nodes have no other velocity. For a sliding
    /// node, f_p and u_p are the density and the velocity of the rail at its position. The sliding
    /// node has a block of A of its own, so that its motion along the rail meets the resistance of
    /// its own length. Arguments as in [`Fluid::drag`](super::Fluid::drag).
    pub(crate) fn drag(
        &mut self,
        positions: &[Vector3],
        velocities: &[Vector3],
        spins: &[f64],
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
        if !self.operator.spheres().is_empty() {
            self.places.clear();
            self.places.extend_from_slice(positions);
            (self.operator).assemble_spheres(&self.filaments, &self.positions, positions);
        }
        self.set_velocities(velocities, spins)?;
        let report = self.solve(Start::Guess)?;
        self.write_resistance(resistance)?;
        self.write_forces(forces, resistance);
        Ok(report)
    }

    /// Computes the force on each node for other velocities. The nodes stay where they were in the
    /// last [`drag`](Self::drag), which determined the local `resistance`.
    pub(crate) fn drag_of(
        &mut self,
        velocities: &[Vector3],
        spins: &[f64],
        resistance: &[Matrix3],
        forces: &mut [Vector3],
    ) -> Result<FluidReport, FluidError> {
        self.set_velocities(velocities, spins)?;
        let report = self.solve(Start::LastSolution)?;
        self.write_forces(forces, resistance);
        Ok(report)
    }

    /// Solves to a smaller relative residual from now on; returns whether the operator is accurate
    /// enough for that.
    pub(crate) fn sharpen(&mut self, tolerance: f64) -> bool {
        let is_exact = self.operator.exact().is_some();
        if is_exact {
            self.tolerance = self.tolerance.min(tolerance);
        }
        is_exact
    }

    pub(crate) fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// Estimate of the largest eigenvalue of D⁻¹ R, the largest ratio of the resistance R of the
    /// nodes to its local part D over all velocities; infinite with spheres. The estimate is valid
    /// for the positions at which the preconditioner was built.
    pub(crate) fn largest_ratio(&self) -> f64 {
        self.largest_ratio
    }

    /// Power that the last drag takes from the motion of nodes and spheres relative to the flow of
    /// spinning edges, W.
    pub(crate) fn dissipation(&self) -> f64 {
        let points = self.operator.points();
        let of_points = 3 * points.count();
        let of_spheres = (self.operator.spheres()).power(
            &self.densities[of_points..],
            &self.right_hand_side[of_points..],
        );
        let power: f64 = (0..self.positions.len())
            .map(|station| {
                let [density, velocity] = [&self.densities, &self.right_hand_side]
                    .map(|values| points.value_at(station, values));
                self.lengths[station] * density.dot(&velocity)
            })
            .sum();
        8.0 * PI * self.viscosity * (power + of_spheres)
    }

    fn set_velocities(&mut self, velocities: &[Vector3], spins: &[f64]) -> Result<(), FluidError> {
        for (own, node) in (self.velocities.iter_mut()).zip(nodes_of(&self.filaments)) {
            *own = velocities[node];
        }
        if !are_finite(&self.velocities) {
            return Err(FluidError::NotFinite);
        }
        self.average_velocities();
        // Points in the wall and in spheres take no force, for any motion.
        for point in 0..self.operator.nodes() {
            if self.takes_no_force(self.operator.points().representatives()[point]) {
                self.right_hand_side[3 * point..3 * point + 3].fill(0.0);
            }
        }
        let of_points = 3 * self.operator.nodes();
        let of_spheres = &mut self.right_hand_side[of_points..];
        (self.operator.spheres()).write_velocities(&self.places, velocities, of_spheres);
        if !spins.is_empty() {
            (self.rotlets).set(&self.filaments, &self.positions, spins);
            self.subtract_rotlets();
        }
        Ok(())
    }

    /// Subtracts the flow of spinning edges from the velocities that force densities must produce.
    fn subtract_rotlets(&mut self) {
        if !self.rotlets.spin() {
            return;
        }
        let stations = self.operator.points().representatives();
        for (point, &station) in stations.iter().enumerate() {
            if self.takes_no_force(station) {
                continue;
            }
            let flow = self.rotlets.velocity(&self.positions[station]);
            for axis in 0..3 {
                self.right_hand_side[3 * point + axis] -= flow[axis];
            }
        }
        let of_spheres = &mut self.right_hand_side[3 * stations.len()..];
        let centres = self.operator.spheres().centres();
        for (centre, velocities) in centres.zip(of_spheres.chunks_exact_mut(6)) {
            let flow = self.rotlets.velocity(&self.places[centre]);
            for (velocity, flow) in velocities.iter_mut().zip(&flow) {
                *velocity -= flow;
            }
        }
    }

    /// Whether a station is in the wall or in a sphere and so takes no force.
    fn takes_no_force(&self, station: usize) -> bool {
        self.operator.spheres().hold(station)
            || (self.wall.as_ref())
                .is_some_and(|wall| wall.holds(station, &self.positions[station]))
    }

    /// Sets the velocity of each point to the mean of its stations' velocities, weighted by their
    /// lengths.
    fn average_velocities(&mut self) {
        let points = self.operator.points();
        let of_points = 3 * points.count();
        let means = self.right_hand_side[..of_points].chunks_exact_mut(3);
        for (point, mean) in means.enumerate() {
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
            resistance[node] = if self.takes_no_force(station) {
                Matrix3::zeros()
            } else {
                inverse * (factor * self.lengths[station])
            };
        }
        (self.operator.spheres()).add_resistance(self.viscosity, resistance);
        Ok(())
    }

    /// Writes the forces on the nodes from the solution for the points.
    fn write_forces(&self, forces: &mut [Vector3], resistance: &[Matrix3]) {
        let factor = 8.0 * PI * self.viscosity;
        let points = self.operator.points();
        for (station, node) in nodes_of(&self.filaments).enumerate() {
            if self.takes_no_force(station) {
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
        let of_spheres = &self.densities[3 * self.operator.nodes()..];
        (self.operator.spheres()).write_forces(factor, of_spheres, &self.places, forces);
    }

    /// Data of a checkpoint.
    pub(crate) fn memory(&self) -> StokesletMemory {
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
    /// [`FluidError::ForeignMemory`] if sizes do not fit, [`FluidError::Singular`] if its
    /// positions coincide.
    pub(crate) fn restore(&mut self, memory: StokesletMemory) -> Result<(), FluidError> {
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
        let unknowns = self.operator.unknowns();
        if memory.densities.iter().any(|d| d.len() != unknowns) {
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

    /// Solves A f = u for the assembled operator; the factor 8πη is left out of f.
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

    fn estimate_largest_ratio(&mut self) {
        // The preconditioner omits the interaction of spheres and filaments.
        self.largest_ratio = if self.operator.spheres().is_empty() {
            largest_ratio(
                &self.operator,
                &mut self.preconditioner,
                &mut self.residual,
                &mut self.image,
            )
        } else {
            f64::INFINITY
        };
    }
}

/// Start of a solve.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Start {
    /// From the best combination of the solutions of earlier steps.
    Guess,
    /// From the last solution, which belongs to the same step.
    LastSolution,
}
