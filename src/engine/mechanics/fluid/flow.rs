//! The flow operator of the solver: exact for few nodes, clustered for many.

use super::Filament;
use super::hierarchy::HierarchicalOperator;
use super::operator::FlowOperator;
use super::points::Points;
use super::spheres::Spheres;
use super::wall::FlowWall;
use crate::mechanics::{Matrix3, Vector3};

/// Number of nodes from which clusters are cheaper than all pairs. A step of 15 helices (1,020
/// nodes, 3 cm apart) costs the same either way. For 10 helices clusters cost 1.6 times as much,
/// for 30 half as much.
const CROSSOVER: usize = 1024;

/// Products with the matrix of the points, R A W ([`Points`]), with exact or clustered A, and with
/// that of the [`Spheres`] among them. Vectors hold three numbers per point, then six per sphere.
pub(super) struct Flow {
    stations: Stations,
    points: Points,
    spheres: Spheres,
    /// Scratch at the stations, used if stations and points differ.
    densities: [Vec<f64>; 3],
    velocities: [Vec<f64>; 3],
}

/// The matrix A of all stations.
enum Stations {
    Exact(FlowOperator),
    Hierarchical(HierarchicalOperator),
}

impl Flow {
    /// Creates an exact operator below [`CROSSOVER`] nodes and for a `far_field_error` of zero,
    /// otherwise one by clusters. Every station is a point.
    pub(crate) fn new(filaments: &[Filament], regularization: f64, far_field_error: f64) -> Self {
        let nodes: usize = filaments.iter().map(|filament| filament.nodes).sum();
        let stations = if far_field_error == 0.0 || nodes < CROSSOVER {
            Stations::Exact(FlowOperator::new(filaments, regularization))
        } else {
            Stations::Hierarchical(HierarchicalOperator::new(
                filaments,
                regularization,
                order_for(far_field_error),
            ))
        };
        Self {
            stations,
            points: Points::plain(nodes),
            spheres: Spheres::default(),
            densities: Default::default(),
            velocities: Default::default(),
        }
    }

    /// The flow beside a wall, which is exact for any number of nodes: clusters do not support images. Every station is a point.
    pub(crate) fn beside_wall(filaments: &[Filament], regularization: f64, wall: FlowWall) -> Self {
        let operator = FlowOperator::beside_wall(filaments, regularization, wall);
        Self {
            points: Points::plain(operator.nodes()),
            stations: Stations::Exact(operator),
            spheres: Spheres::default(),
            densities: Default::default(),
            velocities: Default::default(),
        }
    }

    /// Sets other points of the same stations.
    pub(crate) fn take_points(&mut self, points: Points) {
        let size = if points.are_plain() {
            0
        } else {
            3 * points.stations()
        };
        for scratch in self.densities.iter_mut().chain(&mut self.velocities) {
            scratch.clear();
            scratch.resize(size, 0.0);
        }
        self.spheres.take_points(&points);
        self.points = points;
    }

    /// Takes spheres.
    pub(crate) fn take_spheres(&mut self, spheres: Spheres) {
        self.spheres = spheres;
        self.spheres.take_points(&self.points);
    }

    /// The spheres.
    pub(crate) fn spheres(&self) -> &Spheres {
        &self.spheres
    }

    /// The points.
    pub(crate) fn points(&self) -> &Points {
        &self.points
    }

    /// Number of points.
    pub(crate) fn nodes(&self) -> usize {
        self.points.count()
    }

    /// Number of unknowns: three per point and six per sphere.
    pub(crate) fn unknowns(&self) -> usize {
        3 * self.points.count() + self.spheres.unknowns()
    }

    /// The matrix A if it is exact; `None` for clusters.
    pub(crate) fn exact(&self) -> Option<&FlowOperator> {
        match &self.stations {
            Stations::Exact(operator) => Some(operator),
            Stations::Hierarchical(_) => None,
        }
    }

    /// Evaluates the operator at new positions of the stations, m.
    pub(crate) fn assemble(&mut self, positions: &[Vector3]) {
        self.points.place(positions);
        match &mut self.stations {
            Stations::Exact(operator) => operator.assemble(positions),
            Stations::Hierarchical(operator) => operator.assemble(positions),
        }
    }

    /// Evaluates the interaction of spheres and points at the given stations of `filaments` and
    /// positions in the scene, m. To be called after [`assemble`](Self::assemble).
    pub(crate) fn assemble_spheres(
        &mut self,
        filaments: &[Filament],
        stations: &[Vector3],
        places: &[Vector3],
    ) {
        (self.spheres).assemble(filaments, &self.points, stations, places);
    }

    /// The block of a station's own velocity and density, A_ii.
    pub(crate) fn own_block(&self, station: usize) -> Matrix3 {
        self.block(station, station)
    }

    /// The diagonal block of a point: its velocity by the force densities of all its stations.
    pub(crate) fn diagonal(&self, point: usize) -> Matrix3 {
        let row = self.points.representatives()[point];
        let members = self.points.members(point).iter();
        let mut sum: Matrix3 = members.map(|&station| self.block(row, station)).sum();
        for station in self.points.sliding() {
            for share in self.points.shares(station) {
                if share.point == point && share.weight > 0.0 {
                    sum += self.block(row, station) * share.weight;
                }
            }
        }
        sum
    }

    /// A block of A. With clusters, zero for distant stations, whose block is small.
    fn block(&self, row: usize, column: usize) -> Matrix3 {
        match &self.stations {
            Stations::Exact(operator) => operator.block(row, column),
            Stations::Hierarchical(operator) => operator.block(row, column).unwrap_or_default(),
        }
    }

    /// Computes `velocities` = R A W `densities`, including the spheres.
    pub(crate) fn multiply(&mut self, densities: &[f64], velocities: &mut [f64]) {
        let of_points = 3 * self.nodes();
        self.multiply_points(&densities[..of_points], &mut velocities[..of_points]);
        self.spheres.couple(densities, velocities);
    }

    fn multiply_points(&mut self, densities: &[f64], velocities: &mut [f64]) {
        if self.points.are_plain() {
            return self.stations.multiply(densities, velocities);
        }
        let (f, u) = (&mut self.densities[0], &mut self.velocities[0]);
        self.points.spread(densities, f);
        self.stations.multiply(f, u);
        self.points.restrict(u, velocities);
    }

    /// As [`multiply`](Self::multiply), for three vectors.
    pub(crate) fn multiply_three(
        &mut self,
        densities: &[Vec<f64>; 3],
        velocities: &mut [Vec<f64>; 3],
    ) {
        if !self.spheres.is_empty() {
            for (densities, velocities) in densities.iter().zip(velocities) {
                self.multiply(densities, velocities);
            }
            return;
        }
        if self.points.are_plain() {
            return self.stations.multiply_three(densities, velocities);
        }
        for (at_points, at_stations) in densities.iter().zip(&mut self.densities) {
            self.points.spread(at_points, at_stations);
        }
        (self.stations).multiply_three(&self.densities, &mut self.velocities);
        for (at_stations, at_points) in self.velocities.iter().zip(velocities) {
            self.points.restrict(at_stations, at_points);
        }
    }

    /// Floating-point operations of a product.
    pub(crate) fn operations(&self) -> f64 {
        match &self.stations {
            Stations::Exact(operator) => 18.0 * (operator.nodes() * operator.nodes()) as f64,
            Stations::Hierarchical(operator) => operator.operations(),
        }
    }
}

impl Stations {
    fn multiply(&mut self, densities: &[f64], velocities: &mut [f64]) {
        match self {
            Self::Exact(operator) => operator.multiply(densities, velocities),
            Self::Hierarchical(operator) => operator.multiply(densities, velocities),
        }
    }

    fn multiply_three(&mut self, densities: &[Vec<f64>; 3], velocities: &mut [Vec<f64>; 3]) {
        match self {
            Self::Exact(operator) => operator.multiply_three(densities, velocities),
            Self::Hierarchical(operator) => operator.multiply_three(densities, velocities),
        }
    }
}

/// Degree of the expansions for a relative error of the drag. For helices 3 mm and 3 cm apart the
/// velocities have errors of about 0.015 · 0.37ᵖ at degree p, and the forces ten times as much: the
/// errors vary from node to node, and a velocity that varies so takes a larger force than a smooth
/// one.
fn order_for(far_field_error: f64) -> usize {
    (libm::log(far_field_error / 0.2) / libm::log(0.38f64)).ceil() as usize
}
