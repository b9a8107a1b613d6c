//! Nodes of filaments that count as one point of the flow.
//!
//! Two nodes at one place have the same row in the collocation matrix, and one velocity does not
//! determine two force densities: the matrix is singular, and ill-conditioned if nodes are much
//! closer than ε. Nodes closer than [`CLOSE`] ε are therefore one point, with one velocity and one
//! force density, until they are farther apart than [`APART`] ε. The first distance is about the
//! smallest at which the solution is still accurate. At the second one, the resistance to
//! separating two nodes is about that to moving each of them alone, which is also the resistance
//! of tied nodes. At smaller distances it would be many times as large, and the force would jump
//! when the tie is released. Nodes that return are one point again below [`AGAIN`] ε: two separate
//! nodes of rods that overlap so far are unstable.
//!
//! Only nodes that are joined, or that start so close, are ever tied. A node that slides along a
//! filament is not a point of its own while it is on the filament. Its velocity follows from that
//! of the rail, and its force density is that of the rail there ([`points`](super::points)).

use super::chain::Link;
use super::filament::station_of;
use super::{Connections, Filament};
use crate::mechanics::Vector3;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::ops::Range;

/// Distance below which two nodes become one point, relative to the smaller ε.
pub(super) const CLOSE: f64 = 0.1;
/// Distance above which they are two points again, relative to the smaller ε.
const APART: f64 = 1.0;
/// Distance below which such points are one again, relative to the smaller ε.
const AGAIN: f64 = 0.5;
/// Length along a filament, relative to ε, below which its own nodes are never tied, because they
/// are neighbours.
const NEIGHBOURS: f64 = 1.0;
/// Distance of a node from its rail above which it has left it, relative to ε and to the length of
/// the rail's edge there. A rail is a smooth curve through its nodes; it deviates from the
/// straight edge by an eighth of the edge times its turning angle.
const OFF_THE_RAIL: [f64; 2] = [1.0, 0.25];

/// Two stations that are one point while they are close.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Tie {
    pub stations: [usize; 2],
    /// Whether a joint holds them; if not, they were only this close at the start.
    pub is_joined: bool,
    pub holds: bool,
}

/// The ties of all filaments; part of a checkpoint.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Ties {
    pub pairs: Vec<Tie>,
    /// Whether each sliding station is on its rail.
    pub on_rail: Vec<bool>,
}

/// A station that slides along a rail, and the stations of the rail.
#[derive(Clone, Debug)]
pub(super) struct Rail {
    pub station: usize,
    pub stations: Range<usize>,
    pub closed: bool,
}

/// The sliding stations, without nodes outside the flow.
pub(super) fn rails(filaments: &[Filament], connections: &Connections) -> Vec<Rail> {
    let rail = |sliding: &super::Sliding| {
        let first = station_of(filaments, sliding.rail.start)?;
        Some(Rail {
            station: station_of(filaments, sliding.node)?,
            stations: first..first + sliding.rail.len(),
            closed: sliding.closed,
        })
    };
    connections.sliding.iter().filter_map(rail).collect()
}

impl Rail {
    /// The edge nearest to a position, and the nearest point on it as a fraction from 0 to 1.
    pub(crate) fn nearest(&self, positions: &[Vector3], x: &Vector3) -> Foot {
        let first = self.stations.start;
        let edges = self.stations.len() - usize::from(!self.closed);
        let feet = (0..edges).map(|edge| {
            let ends = [edge, (edge + 1) % self.stations.len()].map(|k| first + k);
            let [start, end] = ends.map(|station| positions[station]);
            let along = end - start;
            let length = along.norm();
            let part = ((x - start).dot(&along) / (length * length)).clamp(0.0, 1.0);
            Foot {
                ends,
                part,
                distance: (x - start - along * part).norm(),
                edge: length,
            }
        });
        feet.min_by(|a, b| a.distance.total_cmp(&b.distance))
            .expect("a rail has an edge")
    }
}

/// The point of a rail nearest to a position.
#[derive(Clone, Copy, Debug)]
pub(super) struct Foot {
    /// Stations at the ends of the edge.
    pub ends: [usize; 2],
    /// Fraction along the edge, from 0 to 1.
    pub part: f64,
    /// Distance, m.
    pub distance: f64,
    /// Length of the edge, m.
    pub edge: f64,
}

impl Ties {
    /// Finds the ties of stations at the start.
    pub(crate) fn find(
        filaments: &[Filament],
        connections: &Connections,
        rails: &[Rail],
        links: &[Link],
        positions: &[Vector3],
    ) -> Self {
        let joined: Vec<[usize; 2]> = (connections.joined.iter())
            .filter_map(|&[a, b]| Some([station_of(filaments, a)?, station_of(filaments, b)?]))
            .collect();
        // A sliding station moves relative to all stations that it passes, including those near it
        // at the start.
        let mut slides = vec![false; positions.len()];
        rails.iter().for_each(|rail| slides[rail.station] = true);
        let mut grows = !rails.is_empty();
        while grows {
            grows = false;
            for &[a, b] in &joined {
                if slides[a] != slides[b] {
                    (slides[a], slides[b]) = (true, true);
                    grows = true;
                }
            }
        }
        let joined: BTreeSet<[usize; 2]> = (joined.into_iter())
            .map(|[a, b]| [a.min(b), a.max(b)])
            .collect();
        let met = close_pairs(links, positions).into_iter().filter(|pair| {
            !joined.contains(pair)
                && !pair.iter().any(|&station| slides[station])
                && !are_neighbours(filaments, links, positions, *pair)
        });
        let tie = |stations, is_joined| Tie {
            stations,
            is_joined,
            holds: false,
        };
        let mut pairs: Vec<Tie> = joined.iter().map(|&pair| tie(pair, true)).collect();
        pairs.extend(met.map(|pair| tie(pair, false)));
        let mut ties = Self {
            pairs,
            on_rail: vec![true; rails.len()],
        };
        ties.update(links, rails, positions);
        ties
    }

    /// Whether every station is permanently a point of its own.
    pub(crate) fn is_empty(&self) -> bool {
        self.pairs.is_empty() && self.on_rail.is_empty()
    }

    /// Whether these ties are between the same stations and rails as `other`.
    pub(crate) fn fit(&self, other: &Self) -> bool {
        let stations = |ties: &Self| -> Vec<[usize; 2]> {
            ties.pairs.iter().map(|tie| tie.stations).collect()
        };
        stations(self) == stations(other) && self.on_rail.len() == other.on_rail.len()
    }

    /// Updates the ties at new positions; returns whether any changed.
    pub(crate) fn update(&mut self, links: &[Link], rails: &[Rail], positions: &[Vector3]) -> bool {
        let mut changed = false;
        for tie in &mut self.pairs {
            let [a, b] = tie.stations;
            let limit = if tie.holds { APART } else { AGAIN };
            let distance = (positions[a] - positions[b]).norm();
            let holds = distance < limit * smaller_regularization(links, [a, b]);
            changed |= holds != tie.holds;
            tie.holds = holds;
        }
        for (on_rail, rail) in self.on_rail.iter_mut().zip(rails) {
            let station = rail.station;
            let foot = rail.nearest(positions, &positions[station]);
            let pair = [station, foot.ends[0]];
            let [regularizations, edges] = OFF_THE_RAIL;
            let limit = regularizations * smaller_regularization(links, pair) + edges * foot.edge;
            let limit = if *on_rail { limit } else { 0.5 * limit };
            let is_on = foot.distance < limit;
            changed |= is_on != *on_rail;
            *on_rail = is_on;
        }
        changed
    }
}

/// The smaller ε of two stations, m.
pub(super) fn smaller_regularization(links: &[Link], pair: [usize; 2]) -> f64 {
    let [a, b] = pair.map(|station| links[station].regularization_squared);
    a.min(b).sqrt()
}

/// Pairs of stations closer than [`CLOSE`] times the smaller ε, without repetition; the stations
/// of a pair are in ascending order.
fn close_pairs(links: &[Link], positions: &[Vector3]) -> Vec<[usize; 2]> {
    let mut order: Vec<usize> = (0..positions.len()).collect();
    order.sort_by(|&a, &b| positions[a].x.total_cmp(&positions[b].x).then(a.cmp(&b)));
    let mut pairs = Vec::new();
    for (k, &a) in order.iter().enumerate() {
        let reach = CLOSE * links[a].regularization_squared.sqrt();
        for &b in &order[k + 1..] {
            if positions[b].x - positions[a].x >= reach {
                break;
            }
            let pair = [a.min(b), a.max(b)];
            let distance = (positions[a] - positions[b]).norm();
            if distance < CLOSE * smaller_regularization(links, pair) {
                pairs.push(pair);
            }
        }
    }
    pairs
}

/// Whether two stations belong to one filament and are near each other along it.
fn are_neighbours(
    filaments: &[Filament],
    links: &[Link],
    positions: &[Vector3],
    [a, b]: [usize; 2],
) -> bool {
    let mut first = 0;
    for filament in filaments {
        let range = first..first + filament.nodes;
        first = range.end;
        if !(range.contains(&a) && range.contains(&b)) {
            continue;
        }
        let length = |stations: Range<usize>| -> f64 {
            let edges =
                stations.filter_map(|k| Some((positions[links[k].next?] - positions[k]).norm()));
            edges.sum()
        };
        let between = length(a..b);
        let around = length(range.clone()) - between;
        let shortest = if filament.closed {
            between.min(around)
        } else {
            between
        };
        return shortest < NEIGHBOURS * links[a].regularization_squared.sqrt();
    }
    false
}
