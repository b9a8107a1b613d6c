//! Connections between arms: at their crossing, along branches that other strands also use, or
//! across a gap under another strand.

use super::Point;
use super::beside::is_double;
use super::colour::colour_difference;
use super::crossing::{Crossing, END_ENERGY};
use super::mask::Mask;
use super::path_energy::{Departure, departure, pair_energy};
use super::skeleton::{Arm, Skeleton};
use std::collections::BTreeMap;

/// Longest shared stretch that is not wide enough for two strands, in widths.
const LONGEST_SHARED: f64 = 40.0;
/// Largest number of branches of a shared stretch.
const MOST_BRANCHES: usize = 4;
/// Energy of a shared stretch.
const SHARED_ENERGY: f64 = 0.2;
/// Widest gap, in widths.
const WIDEST_GAP: f64 = 13.0;
/// Widest gap that no other strand covers, in widths.
const WIDEST_BARE: f64 = 1.6;
/// Fraction of a gap that other strands must fill so that it counts as covered.
const COVERED: f64 = 0.35;
/// Energy of a gap per width of the strand.
const GAP_ENERGY: f64 = 0.1;
/// Energy of a gap under other strands.
const COVERED_ENERGY: f64 = 1.0;
/// Energy of a gap without another strand on it.
const OPEN_ENERGY: f64 = 3.0;
/// Colour difference of strands that are never joined across a gap.
const OTHER_COLOUR: f64 = 25.0;
/// Connections with more energy than two ends are rejected.
pub(super) const MOST_ENERGY: f64 = 2.0 * END_ENERGY;

/// A connection between two arms.
#[derive(Clone, Debug)]
pub(super) struct Connection {
    /// Branches of other strands along which the connection runs, each given by the arm at which
    /// it is entered.
    pub route: Vec<Arm>,
    /// Whether both arms meet at a crossing.
    pub is_direct: bool,
    pub energy: f64,
}

/// Two arms, the lower one first.
pub(super) fn ordered(a: Arm, b: Arm) -> [Arm; 2] {
    if a < b { [a, b] } else { [b, a] }
}

/// All arms of a skeleton and the connections between them.
pub(super) struct Connections<'a> {
    skeleton: &'a Skeleton,
    crossings: Vec<Vec<Arm>>,
    /// Number of the crossing of each arm that ends at one.
    pub crossing_of: BTreeMap<Arm, usize>,
    /// All arms, including free ends.
    pub departures: BTreeMap<Arm, Departure>,
    /// The connection with the least energy of each connected pair.
    pub known: BTreeMap<[Arm; 2], Connection>,
}

impl<'a> Connections<'a> {
    /// Prepares the arms, without connections yet.
    pub fn new(
        skeleton: &'a Skeleton,
        links: &[bool],
        crossings: &[Crossing],
        colour: impl Fn(Point) -> [f64; 3],
    ) -> Self {
        let (mut crossing_of, mut departures) = (BTreeMap::new(), BTreeMap::new());
        for (branch, ends) in skeleton.branches.iter().enumerate() {
            for (side, node) in ends.nodes.into_iter().flatten().enumerate() {
                if !links[branch] {
                    let arm = Arm { branch, side };
                    let place = skeleton.nodes[node].position;
                    departures.insert(arm, departure(skeleton, arm, place, &colour));
                }
            }
        }
        for (index, crossing) in crossings.iter().enumerate() {
            for arm in &crossing.arms {
                crossing_of.insert(*arm, index);
                let departure = departure(skeleton, *arm, crossing.position, &colour);
                departures.insert(*arm, departure);
            }
        }
        Self {
            skeleton,
            crossings: crossings
                .iter()
                .map(|crossing| crossing.arms.clone())
                .collect(),
            crossing_of,
            departures,
            known: BTreeMap::new(),
        }
    }

    /// End of the branch of an arm.
    pub fn place(&self, arm: Arm) -> Point {
        let nodes = self.skeleton.branches[arm.branch].nodes;
        nodes.map_or(Point::zeros(), |nodes| {
            self.skeleton.nodes[nodes[arm.side]].position
        })
    }

    /// Whether an arm meets exactly one other arm, which is a corner where a branch was cut.
    pub fn is_at_corner(&self, arm: Arm) -> bool {
        let crossing = self.crossing_of.get(&arm);
        crossing.is_some_and(|crossing| self.crossings[*crossing].len() == 2)
    }

    fn width(&self, arm: Arm) -> f64 {
        (2.0 * self.skeleton.branches[arm.branch].half_width()).max(1.0)
    }

    /// Length of a branch without the part that is wide enough for two strands of a width.
    fn narrow_length(&self, branch: usize, width: f64) -> f64 {
        let branch = &self.skeleton.branches[branch];
        let half_widths = &branch.half_widths;
        let narrow = half_widths
            .iter()
            .filter(|half| !is_double(2.0 * **half, width));
        branch.length() * narrow.count() as f64 / half_widths.len().max(1) as f64
    }

    /// Energy of the direct path from one arm to another.
    pub fn energy(&self, from: Arm, to: Arm) -> f64 {
        let width = self.width(from).max(self.width(to));
        pair_energy(&self.departures[&from], &self.departures[&to], width)
    }

    /// Energy of the direct path without the part for the change of colour.
    fn bending(&self, from: Arm, to: Arm) -> f64 {
        let width = self.width(from).max(self.width(to));
        let from = self.departures[&from];
        let to = Departure {
            colour: from.colour,
            ..self.departures[&to]
        };
        pair_energy(&from, &to, width)
    }

    /// Energy for the change of colour of the direct path.
    fn change_of_colour(&self, from: Arm, to: Arm) -> f64 {
        let from = self.departures[&from];
        let straight_on = Departure {
            position: from.position - from.direction,
            direction: -from.direction,
            colour: self.departures[&to].colour,
        };
        pair_energy(&from, &straight_on, 1.0)
    }

    /// Adds a connection, unless a better one exists.
    pub fn add(&mut self, pair: [Arm; 2], connection: Connection) {
        let known = self.known.get(&pair);
        if known.is_none_or(|known| connection.energy < known.energy) {
            self.known.insert(pair, connection);
        }
    }

    /// Adds the connection between two arms of one crossing.
    pub fn add_direct(&mut self, a: Arm, b: Arm) {
        let connection = Connection {
            route: Vec::new(),
            is_direct: true,
            energy: self.energy(a, b),
        };
        self.add(ordered(a, b), connection);
    }

    /// Finds the connections at crossings and along branches.
    pub fn find_along_branches(&mut self) {
        let arms: Vec<Arm> = self.crossing_of.keys().copied().collect();
        for from in arms {
            self.search(from, from, 0.0, 0.0, &mut Vec::new());
        }
    }

    /// Continues the search from an arm, with the length and the energy so far.
    fn search(&mut self, from: Arm, here: Arm, length: f64, energy: f64, route: &mut Vec<Arm>) {
        for next in self.crossings[self.crossing_of[&here]].clone() {
            let is_used = route.iter().any(|arm| arm.branch == next.branch);
            // A closed strand meets itself again.
            let is_closing = next == from.opposite() && !route.is_empty();
            let is_own = next.branch == here.branch || next.branch == from.branch;
            if (is_own && !is_closing) || is_used {
                continue;
            }
            if route.is_empty() && self.energy(from, next) < MOST_ENERGY {
                self.add_direct(from, next);
            }
            let energy = energy + self.bending(here, next);
            if energy >= MOST_ENERGY {
                continue;
            }
            if !route.is_empty() && from < next {
                let energy = energy + self.change_of_colour(from, next) + SHARED_ENERGY;
                if energy < MOST_ENERGY {
                    let connection = Connection {
                        route: route.clone(),
                        is_direct: false,
                        energy,
                    };
                    self.add([from, next], connection);
                }
            }
            let far = next.opposite();
            let length = length + self.narrow_length(next.branch, self.width(from));
            if !is_closing
                && route.len() < MOST_BRANCHES
                && length < LONGEST_SHARED * self.width(from)
                && self.crossing_of.contains_key(&far)
            {
                route.push(next);
                self.search(from, far, length, energy, route);
                route.pop();
            }
        }
    }

    /// Finds the connections across gaps between some arms.
    pub fn find_across_gaps(&mut self, arms: &[Arm], mask: &Mask) {
        for (index, a) in arms.iter().enumerate() {
            for b in &arms[index + 1..] {
                let width = self.width(*a).max(self.width(*b));
                let (from, to) = (self.place(*a), self.place(*b));
                let gap = (to - from).norm();
                if gap > WIDEST_GAP * width {
                    continue;
                }
                let ways_on = [-self.departures[a].direction, self.departures[b].direction];
                let covered = covered(mask, [from, to], ways_on);
                let colours = [a, b].map(|arm| self.departures[arm].colour);
                if (1.0 - covered) * gap > WIDEST_BARE * width
                    || colour_difference(colours[0], colours[1]) > OTHER_COLOUR
                {
                    continue;
                }
                let by_cover = if covered < COVERED {
                    OPEN_ENERGY
                } else {
                    COVERED_ENERGY
                };
                let energy = self.energy(*a, *b) + by_cover + GAP_ENERGY * gap / width;
                if energy < MOST_ENERGY {
                    let connection = Connection {
                        route: Vec::new(),
                        is_direct: false,
                        energy,
                    };
                    self.add(ordered(*a, *b), connection);
                }
            }
        }
    }
}

/// Fraction inside the mask of the cubic between two points with given directions.
fn covered(mask: &Mask, [from, to]: [Point; 2], directions: [Point; 2]) -> f64 {
    const SAMPLES: usize = 24;
    let chord = (to - from).norm();
    let [start, end] = directions.map(|direction| direction * chord);
    let inside = (0..SAMPLES).filter(|index| {
        let t = (*index as f64 + 0.5) / SAMPLES as f64;
        let rest = 1.0 - t;
        let point = from * (rest * rest * (1.0 + 2.0 * t))
            + to * (t * t * (3.0 - 2.0 * t))
            + start * (t * rest * rest)
            - end * (t * t * rest);
        mask.contains(point.x.round() as usize, point.y.round() as usize)
    });
    inside.count() as f64 / SAMPLES as f64
}
