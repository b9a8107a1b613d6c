//! The points of the flow: stations that are distinct from each other.
//!
//! A *station* is a node of a filament; stations are numbered one filament after the other. A
//! *point* is a single station, or several that are tied to each other ([`ties`](super::ties)).
//! With the collocation matrix A of all stations, the flow of the points is
//!
//! ```text
//! 8πη u_p = R A W f_p
//! ```
//!
//! where R takes the row of one station for each point, and W gives each station the force density
//! of its point. The density is thus continuous where filaments meet, as it is along a filament.
//! Two halves of a filament that meet at their ends have exactly the flow of the whole. A station
//! that slides along a rail has no row; its density is that of the rail there, linear between the
//! rail's stations.
//!
//! Stations that are tied but not joined may move relative to each other. Their point has the mean
//! of their velocities, weighted by their Voronoi lengths, which preserves the power of the flow.

use super::ties::{Rail, Ties};
use crate::mechanics::Vector3;

/// A part of the force density at a station: the density of a point times a weight.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Share {
    pub point: usize,
    pub weight: f64,
}

/// Relation of stations and points.
#[derive(Clone, Debug, Default)]
pub(super) struct Points {
    /// The first station of each point, in ascending order.
    representatives: Vec<usize>,
    /// All stations of each point, except sliding ones.
    members: Vec<Vec<usize>>,
    /// Shares of each station; the weight of the second is zero unless the station slides.
    shares: Vec<[Share; 2]>,
    sliding: Vec<SlidingStation>,
}

/// A station on a rail.
#[derive(Clone, Debug)]
struct SlidingStation {
    station: usize,
    rail: Rail,
}

impl Points {
    /// Every station is a point.
    pub(crate) fn plain(stations: usize) -> Self {
        Self {
            representatives: (0..stations).collect(),
            members: (0..stations).map(|station| vec![station]).collect(),
            shares: (0..stations).map(alone).collect(),
            sliding: Vec::new(),
        }
    }

    /// The points of tied stations.
    pub(crate) fn new(ties: &Ties, rails: &[Rail], positions: &[Vector3]) -> Self {
        let mut root: Vec<usize> = (0..positions.len()).collect();
        for tie in ties.pairs.iter().filter(|tie| tie.holds) {
            let [a, b] = tie.stations.map(|station| root_of(&root, station));
            root[a.max(b)] = a.min(b);
        }
        for station in 0..root.len() {
            root[station] = root_of(&root, station);
        }
        let rail_of = |station: usize| {
            let mut rails = rails.iter().zip(&ties.on_rail);
            rails.find_map(|(rail, on_rail)| {
                (*on_rail && root[rail.station] == root[station]).then_some(rail)
            })
        };
        let mut points = Self::default();
        let mut point_of_root = vec![0; root.len()];
        for station in 0..root.len() {
            points.shares.push(alone(0));
            if let Some(rail) = rail_of(station) {
                points.sliding.push(SlidingStation {
                    station,
                    rail: rail.clone(),
                });
                continue;
            }
            if root[station] == station {
                point_of_root[station] = points.representatives.len();
                points.representatives.push(station);
                points.members.push(Vec::new());
            }
            let point = point_of_root[root[station]];
            points.members[point].push(station);
            points.shares[station] = alone(point);
        }
        points.place(positions);
        points
    }

    /// Sets the weights of sliding stations from their present positions.
    pub(crate) fn place(&mut self, positions: &[Vector3]) {
        for SlidingStation { station, rail } in &self.sliding {
            let foot = rail.nearest(positions, &positions[*station]);
            let [start, end] = foot.ends.map(|end| self.shares[end][0].point);
            self.shares[*station] = [
                Share {
                    point: start,
                    weight: 1.0 - foot.part,
                },
                Share {
                    point: end,
                    weight: foot.part,
                },
            ];
        }
    }

    /// Number of points.
    pub(crate) fn count(&self) -> usize {
        self.representatives.len()
    }

    /// Number of stations.
    pub(crate) fn stations(&self) -> usize {
        self.shares.len()
    }

    /// Whether every station is a point.
    pub(crate) fn are_plain(&self) -> bool {
        self.count() == self.stations()
    }

    /// The station whose row stands for each point, for all points in ascending order.
    pub(crate) fn representatives(&self) -> &[usize] {
        &self.representatives
    }

    /// The stations of a point, except sliding ones.
    pub(crate) fn members(&self, point: usize) -> &[usize] {
        &self.members[point]
    }

    /// Composition of the force density of a station.
    pub(crate) fn shares(&self, station: usize) -> &[Share; 2] {
        &self.shares[station]
    }

    /// The stations that slide.
    pub(crate) fn sliding(&self) -> impl Iterator<Item = usize> {
        self.sliding.iter().map(|sliding| sliding.station)
    }

    /// Interpolates a quantity given at the points, three numbers each, to a station.
    pub(crate) fn value_at(&self, station: usize, at_points: &[f64]) -> Vector3 {
        let [first, second] = self.shares[station];
        let of = |point: usize| Vector3::from_column_slice(&at_points[3 * point..3 * point + 3]);
        let value = of(first.point) * first.weight;
        if second.weight == 0.0 {
            value
        } else {
            value + of(second.point) * second.weight
        }
    }

    /// Sets the densities of stations from those of their points.
    pub(crate) fn spread(&self, at_points: &[f64], at_stations: &mut [f64]) {
        for (station, value) in at_stations.chunks_exact_mut(3).enumerate() {
            value.copy_from_slice(self.value_at(station, at_points).as_slice());
        }
    }

    /// Sets the velocities of points from those of stations.
    pub(crate) fn restrict(&self, at_stations: &[f64], at_points: &mut [f64]) {
        for (value, station) in at_points.chunks_exact_mut(3).zip(&self.representatives) {
            value.copy_from_slice(&at_stations[3 * station..3 * station + 3]);
        }
    }
}

fn alone(point: usize) -> [Share; 2] {
    let weight = 1.0;
    [Share { point, weight }, Share { point, weight: 0.0 }]
}

fn root_of(root: &[usize], station: usize) -> usize {
    let mut station = station;
    while root[station] != station {
        station = root[station];
    }
    station
}
