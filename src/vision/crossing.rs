//! Crossings of strands in a skeleton, and the pairing of their arms.
//!
//! At a crossing, arms are paired so that the paths through it bend least (the idea of mBEST: Choi
//! et al., IEEE RA-L 8, 2023). The energy of a path is that of the cubic with the positions and
//! directions of both arms, and a change of colour adds a penalty.

use super::Point;
use super::junction::{group_junctions, width_at};
use super::path_energy::{Departure, departure, pair_energies};
use super::skeleton::{Arm, Skeleton};

/// Arms that meet at a crossing, and their pairing. Arms without a partner are ends of strands.
#[derive(Clone, Debug)]
pub(super) struct Crossing {
    pub position: Point,
    pub arms: Vec<Arm>,
    pub pairs: Vec<[Arm; 2]>,
    /// Branches along which the arms of the only pair are joined, each given by the arm at which
    /// it is entered. Other strands use them, too.
    pub route: Vec<Arm>,
}

/// Energy of an end of a strand at a crossing. A path turns by more than about 60° only if there
/// is no better one.
pub(super) const END_ENERGY: f64 = 2.0;
/// Largest number of arms for which all pairings are tried (764 for eight arms). More arms are
/// paired greedily.
const MOST_ARMS_TRIED: usize = 8;
/// Largest number of arms that are paired. More arms are noise.
const MOST_ARMS: usize = 40;

/// Finds the crossings of a skeleton, and whether each branch is a link. `colour` returns
/// L\*a\*b\* of a pixel.
pub(super) fn crossings(
    skeleton: &Skeleton,
    colour: impl Fn(Point) -> [f64; 3],
) -> (Vec<Crossing>, Vec<bool>) {
    let (groups, links) = group_junctions(skeleton);
    let mut crossings: Vec<Crossing> = Vec::new();
    let mut crossing_of = vec![usize::MAX; skeleton.nodes.len()];
    let mut nodes_in: Vec<f64> = Vec::new();
    for (node, root) in groups.iter().enumerate() {
        if crossing_of[*root] == usize::MAX {
            crossing_of[*root] = crossings.len();
            nodes_in.push(0.0);
            crossings.push(Crossing {
                position: Point::zeros(),
                arms: Vec::new(),
                pairs: Vec::new(),
                route: Vec::new(),
            });
        }
        let crossing = crossing_of[*root];
        crossing_of[node] = crossing;
        crossings[crossing].position += skeleton.nodes[node].position;
        nodes_in[crossing] += 1.0;
    }
    for (crossing, count) in crossings.iter_mut().zip(nodes_in) {
        crossing.position /= count;
    }
    for (branch, ends) in skeleton.branches.iter().enumerate() {
        let Some([begin, end]) = ends.nodes else {
            continue;
        };
        if !links[branch] {
            for (side, node) in [begin, end].into_iter().enumerate() {
                crossings[crossing_of[node]].arms.push(Arm { branch, side });
            }
        }
    }
    crossings.retain(|crossing| crossing.arms.len() > 1);
    for crossing in &mut crossings {
        if crossing.arms.len() > MOST_ARMS {
            continue;
        }
        let departures: Vec<Departure> = crossing
            .arms
            .iter()
            .map(|arm| departure(skeleton, *arm, crossing.position, &colour))
            .collect();
        let width = width_at(skeleton, &crossing.arms);
        let energies = pair_energies(&departures, width);
        crossing.pairs = best_pairs(&energies)
            .into_iter()
            .map(|[i, j]| [crossing.arms[i], crossing.arms[j]])
            .collect();
    }
    (crossings, links)
}

/// Pairs of arms with the least sum of energies.
fn best_pairs(energies: &[Vec<f64>]) -> Vec<[usize; 2]> {
    let count = energies.len();
    if count > MOST_ARMS_TRIED {
        return greedy_pairs(energies);
    }
    let mut search = Search {
        energies,
        paired: vec![false; count],
        pairs: Vec::new(),
        best: Vec::new(),
        least: f64::INFINITY,
    };
    search.descend(0, 0.0);
    search.best
}

struct Search<'a> {
    energies: &'a [Vec<f64>],
    paired: Vec<bool>,
    pairs: Vec<[usize; 2]>,
    best: Vec<[usize; 2]>,
    least: f64,
}

impl Search<'_> {
    fn descend(&mut self, arm: usize, energy: f64) {
        if energy >= self.least {
            return;
        }
        let Some(arm) = (arm..self.paired.len()).find(|arm| !self.paired[*arm]) else {
            self.least = energy;
            self.best = self.pairs.clone();
            return;
        };
        self.paired[arm] = true;
        for other in arm + 1..self.paired.len() {
            if self.paired[other] {
                continue;
            }
            self.paired[other] = true;
            self.pairs.push([arm, other]);
            self.descend(arm + 1, energy + self.energies[arm][other]);
            self.pairs.pop();
            self.paired[other] = false;
        }
        self.descend(arm + 1, energy + END_ENERGY);
        self.paired[arm] = false;
    }
}

fn greedy_pairs(energies: &[Vec<f64>]) -> Vec<[usize; 2]> {
    let count = energies.len();
    let mut all: Vec<[usize; 2]> = (0..count)
        .flat_map(|i| (i + 1..count).map(move |j| [i, j]))
        .filter(|[i, j]| energies[*i][*j] < 2.0 * END_ENERGY)
        .collect();
    all.sort_by(|[a, b], [c, d]| energies[*a][*b].total_cmp(&energies[*c][*d]));
    let mut paired = vec![false; count];
    let mut pairs = Vec::new();
    for [i, j] in all {
        if !paired[i] && !paired[j] {
            paired[i] = true;
            paired[j] = true;
            pairs.push([i, j]);
        }
    }
    pairs
}

#[cfg(test)]
mod tests {
    use super::super::path_energy::tests::arm;
    use super::*;

    #[test]
    fn arms_are_paired_across() {
        let arms = [
            arm(10.0, 0.0, 0.0),
            arm(0.0, 10.0, 90.0),
            arm(-10.0, 0.0, 180.0),
            arm(0.0, -10.0, 270.0),
        ];
        let pairs = best_pairs(&pair_energies(&arms, 5.0));
        assert_eq!(pairs, [[0, 2], [1, 3]]);
    }

    #[test]
    fn an_end_on_another_strand_stays_an_end() {
        let arms = [
            arm(10.0, 0.0, 0.0),
            arm(0.0, 10.0, 90.0),
            arm(-10.0, 0.0, 180.0),
        ];
        let pairs = best_pairs(&pair_energies(&arms, 5.0));
        assert_eq!(pairs, [[0, 2]]);
    }

    #[test]
    fn colour_decides_where_bending_does_not() {
        // Two strands that touch with tangents of 45°: both pairings bend equally.
        let mut arms = [
            arm(10.0, 10.0, 45.0),
            arm(-10.0, 10.0, 135.0),
            arm(-10.0, -10.0, 225.0),
            arm(10.0, -10.0, 315.0),
        ];
        arms[0].colour = [50.0, 60.0, 0.0];
        arms[1].colour = [50.0, 60.0, 0.0];
        let pairs = best_pairs(&pair_energies(&arms, 20.0));
        assert!(pairs.contains(&[0, 1]) || pairs.contains(&[0, 2]));
        let energies = pair_energies(&arms, 20.0);
        assert!(energies[0][1] < energies[0][3]);
    }

    #[test]
    fn many_arms_are_paired_greedily() {
        let arms: Vec<Departure> = (0..12)
            .map(|index| {
                let angle = 30.0 * f64::from(index);
                let (sine, cosine) = angle.to_radians().sin_cos();
                arm(20.0 * cosine, 20.0 * sine, angle)
            })
            .collect();
        let mut pairs = best_pairs(&pair_energies(&arms, 5.0));
        pairs.sort();
        let across: Vec<[usize; 2]> = (0..6).map(|index| [index, index + 6]).collect();
        assert_eq!(pairs, across);
    }
}
