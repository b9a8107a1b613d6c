//! Pairing of arms where strands run along each other or are interrupted.
//!
//! If a strand meets another one at a small angle and leaves it later, each of the two junctions
//! has one unpaired arm. Such arms are joined through the branches between them, which already
//! belong to the other strand. A strand that is partly hidden by another one is joined across the
//! gap. All arms are paired so that the sum of energies is least: the energies of the connections,
//! from bending and colour change, and those of the remaining ends. Starting from the pairs of
//! each crossing, pairs are exchanged while the sum decreases. A global minimum is not guaranteed.

use super::Point;
use super::connection::{Connection, Connections, MOST_ENERGY, ordered};
use super::crossing::{Crossing, END_ENERGY};
use super::mask::Mask;
use super::skeleton::{Arm, Skeleton};
use std::collections::BTreeMap;

/// Largest number of arms; more mean that the mask is noise.
const MOST_ARMS: usize = 200;
/// Maximum number of exchanges.
const MOST_EXCHANGES: usize = 200;

/// Pairs the arms of a skeleton. `colour` returns L\*a\*b\* of a pixel; the mask contains all
/// strands.
pub(super) fn join_arms(
    skeleton: &Skeleton,
    links: &[bool],
    crossings: &mut Vec<Crossing>,
    mask: &Mask,
    colour: impl Fn(Point) -> [f64; 3],
) {
    let mut connections = Connections::new(skeleton, links, crossings, colour);
    if connections.departures.len() > MOST_ARMS {
        return;
    }
    let mut partner = BTreeMap::new();
    for [a, b] in crossings.iter().flat_map(|crossing| &crossing.pairs) {
        partner.insert(*a, *b);
        partner.insert(*b, *a);
        connections.add_direct(*a, *b);
    }
    connections.find_along_branches();
    let arms = connections.departures.keys().copied();
    let loose: Vec<Arm> = arms
        .filter(|arm| !partner.contains_key(arm) || connections.is_at_corner(*arm))
        .collect();
    connections.find_across_gaps(&loose, mask);
    let mut pairing = Pairing {
        connections,
        partner,
    };
    pairing.exchange();
    pairing.uncross();
    pairing.write(crossings);
}

/// Arms and their partners.
struct Pairing<'a> {
    connections: Connections<'a>,
    partner: BTreeMap<Arm, Arm>,
}

/// An exchange: a new pair, the pair of their former partners, and the saved energy.
struct Exchange {
    pair: [Arm; 2],
    rest: Option<[Arm; 2]>,
    gained: f64,
}

impl Pairing<'_> {
    /// Energy of the pair of an arm, or of its end.
    fn energy_of(&self, arm: Arm) -> f64 {
        match self.partner.get(&arm) {
            Some(other) => self.connections.known[&ordered(arm, *other)].energy,
            None => END_ENERGY,
        }
    }

    /// Exchanges pairs while the sum of energies decreases. The exchange that saves most is made
    /// first.
    fn exchange(&mut self) {
        for _ in 0..MOST_EXCHANGES {
            let exchanges = self
                .connections
                .known
                .iter()
                .filter_map(|(pair, connection)| {
                    let is_paired = self.partner.get(&pair[0]) == Some(&pair[1]);
                    (!is_paired).then(|| self.exchange_for(*pair, connection))
                });
            let best = exchanges.reduce(|best, other| {
                if other.gained > best.gained {
                    other
                } else {
                    best
                }
            });
            let Some(best) = best.filter(|best| best.gained > 1e-9) else {
                return;
            };
            for arm in best.pair {
                if let Some(other) = self.partner.remove(&arm) {
                    self.partner.remove(&other);
                }
            }
            for [a, b] in [Some(best.pair), best.rest].into_iter().flatten() {
                self.pair(a, b);
            }
        }
    }

    fn exchange_for(&self, pair: [Arm; 2], connection: &Connection) -> Exchange {
        let before = self.energy_of(pair[0]) + self.energy_of(pair[1]);
        let (rest, after) = match pair.map(|arm| self.partner.get(&arm)) {
            [Some(c), Some(d)] => {
                let rest = ordered(*c, *d);
                let connection = self.connections.known.get(&rest);
                match connection.filter(|connection| connection.energy < MOST_ENERGY) {
                    Some(connection) => (Some(rest), connection.energy),
                    None => (None, 2.0 * END_ENERGY),
                }
            }
            [None, None] => (None, 0.0),
            _ => (None, END_ENERGY),
        };
        Exchange {
            pair,
            rest,
            gained: before - connection.energy - after,
        }
    }

    fn pair(&mut self, a: Arm, b: Arm) {
        self.partner.insert(a, b);
        self.partner.insert(b, a);
    }

    /// Exchanges the arms of two strands that share a stretch, if the direct paths between the
    /// arms then have less energy. The bending at the ends of the stretch is the same in both
    /// cases.
    fn uncross(&mut self) {
        let pairs: Vec<[Arm; 2]> = self.partner.iter().map(|(a, b)| [*a, *b]).collect();
        for [a, b] in pairs {
            if a > b || self.partner.get(&a) != Some(&b) {
                continue;
            }
            let Connection { route, energy, .. } = self.connections.known[&[a, b]].clone();
            let Some([first, p, q]) = self.strand_along(&route) else {
                continue;
            };
            if p == b || q == a || p == q {
                continue;
            }
            let energy_of = |x: Arm, y: Arm| self.connections.energy(x, y);
            if energy_of(p, b) + energy_of(a, q) >= energy_of(p, q) + energy_of(a, b) {
                continue;
            }
            let route = if p < b {
                route
            } else {
                route.iter().rev().map(|arm| arm.opposite()).collect()
            };
            let connection = Connection {
                route,
                is_direct: false,
                energy,
            };
            self.connections.known.insert(ordered(p, b), connection);
            self.connections.add_direct(a, first);
            self.pair(a, first);
            self.pair(p, b);
        }
    }

    /// For the strand along a route, returns the arm at which it enters, and its arms before and
    /// after the route.
    fn strand_along(&self, route: &[Arm]) -> Option<[Arm; 3]> {
        let (first, last) = (*route.first()?, route.last()?.opposite());
        let is_one = route
            .windows(2)
            .all(|pair| self.partner.get(&pair[0].opposite()) == Some(&pair[1]));
        let (p, q) = (self.partner.get(&first)?, self.partner.get(&last)?);
        is_one.then_some([first, *p, *q])
    }

    /// Writes the pairs into their crossings. A pair of arms from different crossings gets its own
    /// crossing.
    fn write(&self, crossings: &mut Vec<Crossing>) {
        for crossing in crossings.iter_mut() {
            crossing.pairs.clear();
        }
        for (a, b) in self.partner.iter().filter(|(a, b)| a < b) {
            let pair = [*a, *b];
            if self.connections.known[&pair].is_direct {
                crossings[self.connections.crossing_of[a]].pairs.push(pair);
            } else {
                crossings.push(Crossing {
                    position: (self.connections.place(*a) + self.connections.place(*b)) * 0.5,
                    arms: pair.to_vec(),
                    pairs: vec![pair],
                    route: self.connections.known[&pair].route.clone(),
                });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::crossing::crossings;
    use super::super::mask::tests::{drawn, strokes};
    use super::super::strand::paths;
    use super::*;

    /// Strokes of 7 pixels along lines.
    fn mask(lines: &[&[[f64; 2]]]) -> Mask {
        strokes(240, 120, 7.0, lines)
    }

    /// Ends of the strands, from left to right for each strand.
    fn ends(mask: &Mask, colour: impl Fn(Point) -> [f64; 3] + Copy) -> Vec<[Point; 2]> {
        let skeleton = Skeleton::new(mask);
        let (mut crossings, links) = crossings(&skeleton, colour);
        join_arms(&skeleton, &links, &mut crossings, mask, colour);
        let place = |arm: Arm| {
            let nodes = skeleton.branches[arm.branch].nodes.expect("an open branch");
            skeleton.nodes[nodes[arm.side]].position
        };
        let ends = |entries: &[Arm]| {
            let last = entries[entries.len() - 1].opposite();
            let (first, last) = (place(entries[0]), place(last));
            if first.x < last.x {
                [first, last]
            } else {
                [last, first]
            }
        };
        let mut found: Vec<[Point; 2]> = paths(&skeleton, &crossings, &links)
            .iter()
            .map(|path| ends(&path.entries))
            .collect();
        found.sort_by(|a, b| a[0].y.total_cmp(&b[0].y));
        found
    }

    /// Two strands that run side by side for twenty widths and then separate.
    fn together() -> Mask {
        let upper = [[8.0, 20.0], [50.0, 60.0], [190.0, 60.0], [232.0, 20.0]];
        let lower = [[8.0, 100.0], [50.0, 60.0], [190.0, 60.0], [232.0, 100.0]];
        mask(&[&upper, &lower])
    }

    #[test]
    fn strands_that_run_side_by_side_are_two() {
        let found = ends(&together(), |_| [50.0, 0.0, 0.0]);
        assert_eq!(found.len(), 2, "{found:?}");
        for [left, right] in found {
            assert!(left.x < 20.0 && right.x > 220.0);
        }
    }

    #[test]
    fn strands_keep_their_colours_where_they_part() {
        for crosses in [false, true] {
            // The strand that begins at the lower left lies on top.
            let colour = move |point: Point| {
                let is_shared = (50.0..190.0).contains(&point.x);
                let is_upper = point.y < 60.0;
                let is_red = !is_shared && is_upper != (crosses && point.x > 120.0);
                [50.0, if is_red { 60.0 } else { -60.0 }, 0.0]
            };
            let found = ends(&together(), colour);
            assert_eq!(found.len(), 2, "{found:?}");
            for [left, right] in found {
                assert_eq!((left.y < 60.0) != (right.y < 60.0), crosses);
            }
        }
    }

    #[test]
    fn a_gap_is_closed_under_a_strand_and_not_in_the_open() {
        let left = [[8.0, 60.0], [100.0, 60.0]];
        let right = [[140.0, 60.0], [232.0, 60.0]];
        let colour = |_: Point| [50.0, 0.0, 0.0];
        let apart = mask(&[&left, &right]);
        assert_eq!(ends(&apart, colour).len(), 2);
        let whole = drawn(240, 120, |pixel| {
            let is_hidden = (106.0..134.0).contains(&pixel.x);
            is_hidden || apart.contains(pixel.x as usize, pixel.y as usize)
        });
        // The skeleton contains only the interrupted strand; the mask also contains the strand
        // that hides it.
        let skeleton = Skeleton::new(&apart);
        let (mut crossings, links) = crossings(&skeleton, colour);
        join_arms(&skeleton, &links, &mut crossings, &whole, colour);
        assert_eq!(paths(&skeleton, &crossings, &links).len(), 1);
    }
}
