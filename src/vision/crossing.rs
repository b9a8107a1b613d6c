//! Crossings of strands in a skeleton: which junctions are one crossing, and which arms of it belong together.
//!
//! Two strands that cross at a small angle share the middle of their skeletons: a link between two forks. A strand
//! has no forks, so forks come in pairs, joined by a link; links are found by that. At a crossing, arms are paired
//! such that the paths through it bend least (the idea of mBEST: Choi et al., IEEE RA-L 8, 2023). The energy of a
//! path is that of the cubic with the positions and directions of both arms, and a path that changes its colour
//! costs extra.

use super::Point;
use super::colour::colour_difference;
use super::skeleton::Skeleton;
use nalgebra::Matrix3;

/// One end of a branch, at a crossing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Arm {
    pub branch: usize,
    /// 0 for the begin of the branch, 1 for its end.
    pub side: usize,
}

/// Arms that meet, and which of them belong together. Arms without a partner are ends of strands.
#[derive(Clone, Debug)]
pub(super) struct Crossing {
    pub position: Point,
    pub arms: Vec<Arm>,
    pub pairs: Vec<[Arm; 2]>,
}

/// Where an arm leaves the part of the skeleton that a crossing distorts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Departure {
    pub position: Point,
    /// Unit vector away from the crossing.
    pub direction: Point,
    pub colour: [f64; 3],
}

/// Longest link between two forks, in widths: strands that cross at 15°.
const LONGEST_LINK: f64 = 6.0;
/// Junctions nearer than this are one crossing whatever their arms, in widths.
const SAME_JUNCTION: f64 = 0.5;
/// Forks nearer than this are two halves of a crossing whatever the direction of their arms, in widths.
const SAME_CROSSING: f64 = 1.5;
/// Cosine of the widest angle between a longer link and the arms that continue it.
const FORK_COSINE: f64 = 0.5;
/// Stretch of an arm that tells its direction, in widths.
const DIRECTION_STRETCH: f64 = 2.5;
/// Energy of an end of a strand at a crossing: a path turns by more than some 60° only where nothing better is there.
pub(super) const END_ENERGY: f64 = 2.0;
/// Colour difference that counts like an energy of one half.
const COLOUR_SCALE: f64 = 20.0;
/// The most a change of colour counts: lights and shadows change colours, too.
const COLOUR_CAP: f64 = 8.0;
/// More arms than this are paired greedily, not by trying all pairings (764 of them for eight arms).
const MOST_ARMS_TRIED: usize = 8;
/// More arms than this are noise: they are not paired at all.
const MOST_ARMS: usize = 40;

/// Finds the crossings of a skeleton, and which branches are links. `colour` gives L\*a\*b\* of a pixel.
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

/// Median width of the branches that meet.
fn width_at(skeleton: &Skeleton, arms: &[Arm]) -> f64 {
    let widths: Vec<f64> = arms
        .iter()
        .map(|arm| 2.0 * skeleton.branches[arm.branch].half_width())
        .collect();
    super::skeleton::median(&widths).max(1.0)
}

/// For each node the node that stands for its crossing; for each branch whether it is a link.
fn group_junctions(skeleton: &Skeleton) -> (Vec<usize>, Vec<bool>) {
    let mut groups = Groups::new(skeleton);
    let mut links = groups.links(skeleton);
    links.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
    for (branch, length, width) in &links {
        if *length < SAME_JUNCTION * width {
            groups.join(skeleton, *branch);
        }
    }
    for (branch, length, width) in &links {
        let [begin, end] = skeleton.branches[*branch].nodes.expect("a link has nodes");
        let (a, b) = (groups.root(begin), groups.root(end));
        let odd = |arms: &[Arm]| arms.len() % 2 == 1;
        let link = Arm {
            branch: *branch,
            side: 0,
        };
        let is_fork = |groups: &Groups, root: usize, side: usize| {
            let others = groups.arms[root]
                .iter()
                .filter(|arm| **arm != Arm { side, ..link });
            others.copied().all(|arm| {
                let away = rough_direction(skeleton, arm, *width);
                let along = rough_direction(skeleton, Arm { side, ..link }, *width);
                away.dot(&along) < -FORK_COSINE
            })
        };
        if a != b
            && *length < LONGEST_LINK * width
            && odd(&groups.arms[a])
            && odd(&groups.arms[b])
            && (*length < SAME_CROSSING * width || is_fork(&groups, a, 0) && is_fork(&groups, b, 1))
        {
            groups.join(skeleton, *branch);
        }
    }
    let roots = (0..skeleton.nodes.len()).map(|node| groups.root(node));
    (roots.collect(), groups.is_link)
}

/// Junctions that are one crossing, by union and find.
struct Groups {
    parent: Vec<usize>,
    /// Arms of each group, at its root.
    arms: Vec<Vec<Arm>>,
    /// For each branch.
    is_link: Vec<bool>,
}

impl Groups {
    fn new(skeleton: &Skeleton) -> Self {
        let mut arms = vec![Vec::new(); skeleton.nodes.len()];
        for (branch, ends) in skeleton.branches.iter().enumerate() {
            for (side, node) in ends.nodes.into_iter().flatten().enumerate() {
                arms[node].push(Arm { branch, side });
            }
        }
        Self {
            parent: (0..skeleton.nodes.len()).collect(),
            arms,
            is_link: vec![false; skeleton.branches.len()],
        }
    }

    fn root(&self, mut node: usize) -> usize {
        while self.parent[node] != node {
            node = self.parent[node];
        }
        node
    }

    /// Branches between different junctions, with the distance between these and the width of the strands there.
    fn links(&self, skeleton: &Skeleton) -> Vec<(usize, f64, f64)> {
        let mut links = Vec::new();
        for (branch, ends) in skeleton.branches.iter().enumerate() {
            let Some([begin, end]) = ends.nodes else {
                continue;
            };
            if begin == end || self.arms[begin].len() < 3 || self.arms[end].len() < 3 {
                continue;
            }
            let ways = [skeleton.nodes[begin].position, skeleton.nodes[end].position];
            let length = match (ends.pixels.first(), ends.pixels.last()) {
                (Some(first), Some(last)) => {
                    (first - ways[0]).norm() + ends.length() + (last - ways[1]).norm()
                }
                _ => (ways[0] - ways[1]).norm(),
            };
            let others: Vec<Arm> = self.arms[begin]
                .iter()
                .chain(&self.arms[end])
                .filter(|arm| arm.branch != branch)
                .copied()
                .collect();
            links.push((branch, length, width_at(skeleton, &others)));
        }
        links
    }

    fn join(&mut self, skeleton: &Skeleton, branch: usize) {
        let [begin, end] = skeleton.branches[branch].nodes.expect("a link has nodes");
        let (a, b) = (self.root(begin), self.root(end));
        self.is_link[branch] = true;
        if a != b {
            let moved = std::mem::take(&mut self.arms[b]);
            self.arms[a].extend(moved);
            self.parent[b] = a;
        }
        self.arms[a].retain(|arm| arm.branch != branch);
    }
}

/// Direction of an arm away from its node, over the first two widths of it.
fn rough_direction(skeleton: &Skeleton, arm: Arm, width: f64) -> Point {
    let branch = &skeleton.branches[arm.branch];
    let ends = branch.nodes.expect("an arm has nodes");
    let from = skeleton.nodes[ends[arm.side]].position;
    let reach = (2.0 * width).ceil() as usize;
    let towards = match branch.pixels.len().min(reach) {
        0 => skeleton.nodes[ends[1 - arm.side]].position,
        count if arm.side == 0 => branch.pixels[count - 1],
        count => branch.pixels[branch.pixels.len() - count],
    };
    unit(towards - from)
}

fn unit(vector: Point) -> Point {
    vector.try_normalize(1e-9).unwrap_or(Point::x())
}

/// How many pixels at an arm's begin a crossing distorts: as far as the mask is wider than along the branch, half a
/// width at least, and never more than a third of the branch.
pub(super) fn distorted_pixels(skeleton: &Skeleton, arm: Arm) -> usize {
    let branch = &skeleton.branches[arm.branch];
    let count = branch.pixels.len();
    let usual = branch.half_width();
    let wide = |index: usize| {
        let index = if arm.side == 0 {
            index
        } else {
            count - 1 - index
        };
        branch.half_widths[index] > 1.1 * usual + 0.3
    };
    let widened = (0..count).take_while(|index| wide(*index)).count();
    widened.max(usual.ceil() as usize).min(count / 3)
}

pub(super) fn departure(
    skeleton: &Skeleton,
    arm: Arm,
    centre: Point,
    colour: impl Fn(Point) -> [f64; 3],
) -> Departure {
    let branch = &skeleton.branches[arm.branch];
    let count = branch.pixels.len();
    let skipped = distorted_pixels(skeleton, arm);
    let stretch = (DIRECTION_STRETCH * 2.0 * branch.half_width()).ceil() as usize;
    let used = stretch.max(4).min(count - skipped);
    let pixel = |index: usize| {
        branch.pixels[if arm.side == 0 {
            skipped + index
        } else {
            count - 1 - skipped - index
        }]
    };
    if used < 3 {
        let ends = branch.nodes.expect("an arm has nodes");
        let far = skeleton.nodes[ends[1 - arm.side]].position;
        let near = if used > 0 { pixel(0) } else { centre };
        return Departure {
            position: near,
            direction: unit(far - centre),
            colour: colour(near),
        };
    }
    let points: Vec<Point> = (0..used).map(pixel).collect();
    let (position, direction) = quadratic_start(&points);
    let mut sum = [0.0; 3];
    for point in &points {
        for (sum, value) in sum.iter_mut().zip(colour(*point)) {
            *sum += value / used as f64;
        }
    }
    Departure {
        position,
        direction: unit(direction),
        colour: sum,
    }
}

/// Position and derivative at the first point of the parabola through points, by least squares.
fn quadratic_start(points: &[Point]) -> (Point, Point) {
    let mut normal = Matrix3::zeros();
    let mut right = [nalgebra::Vector3::zeros(); 2];
    for (index, point) in points.iter().enumerate() {
        let s = index as f64 / points.len() as f64;
        let powers = nalgebra::Vector3::new(1.0, s, s * s);
        normal += powers * powers.transpose();
        right[0] += powers * point.x;
        right[1] += powers * point.y;
    }
    let chord = points[points.len() - 1] - points[0];
    let Some(inverse) = normal.try_inverse() else {
        return (points[0], chord);
    };
    let [x, y] = right.map(|right| inverse * right);
    let derivative = Point::new(x[1], y[1]);
    // Short arms bend less than their pixels say.
    let derivative = if derivative.dot(&chord) > 0.0 {
        derivative
    } else {
        chord
    };
    (Point::new(x[0], y[0]), derivative)
}

/// Energies of the paths between all pairs of arms, with those of the change of colour.
fn pair_energies(departures: &[Departure], width: f64) -> Vec<Vec<f64>> {
    let row = |a: &Departure| {
        let energies = departures.iter().map(|b| pair_energy(a, b, width));
        energies.collect()
    };
    departures.iter().map(row).collect()
}

/// Energy of the path between two arms, with that of the change of colour.
pub(super) fn pair_energy(a: &Departure, b: &Departure, width: f64) -> f64 {
    let colours = colour_difference(a.colour, b.colour) / COLOUR_SCALE;
    bending_energy(a, b, width) + (0.5 * colours * colours).min(COLOUR_CAP)
}

/// Bending energy of the cubic that joins two arms, times the width.
///
/// With L the length of the chord and a, b the angles of the path to it at both ends, a cubic has
/// ∫ κ² ds = 4 (a² + a b + b²)/L.
fn bending_energy(from: &Departure, to: &Departure, width: f64) -> f64 {
    let chord = to.position - from.position;
    let length = chord.norm().max(0.5 * width);
    let chord = unit(chord);
    let angle = |direction: Point| libm::atan2(chord.perp(&direction), chord.dot(&direction));
    let (a, b) = (angle(-from.direction), angle(to.direction));
    4.0 * (a * a + a * b + b * b) * width / length
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
    use super::*;

    fn arm(x: f64, y: f64, degrees: f64) -> Departure {
        let angle = degrees.to_radians();
        Departure {
            position: Point::new(x, y),
            direction: Point::new(angle.cos(), angle.sin()),
            colour: [50.0, 0.0, 0.0],
        }
    }

    #[test]
    fn a_straight_path_does_not_bend_and_an_arc_bends_as_a_circle_does() {
        let straight = bending_energy(&arm(0.0, 0.0, 180.0), &arm(20.0, 0.0, 0.0), 5.0);
        assert!(straight < 1e-12);
        // A quarter of a right angle on a circle: ∫κ² ds = φ²/(R φ) = φ/R.
        let phi = 22.5f64.to_radians();
        let radius = 100.0;
        let from = arm(0.0, 0.0, 180.0);
        let end = Point::new(radius * phi.sin(), radius * (1.0 - phi.cos()));
        let arc = bending_energy(&from, &arm(end.x, end.y, 22.5), 1.0);
        assert!((arc / (phi / radius) - 1.0).abs() < 0.02, "{arc}");
    }

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
        // Two strands that touch with tangents of 45°: both pairings bend alike.
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
    fn many_arms_are_paired_all_the_same() {
        let arms: Vec<Departure> = (0..12)
            .map(|index| {
                let angle = 30.0 * f64::from(index);
                arm(
                    20.0 * angle.to_radians().cos(),
                    20.0 * angle.to_radians().sin(),
                    angle,
                )
            })
            .collect();
        let mut pairs = best_pairs(&pair_energies(&arms, 5.0));
        pairs.sort();
        let across: Vec<[usize; 2]> = (0..6).map(|index| [index, index + 6]).collect();
        assert_eq!(pairs, across);
    }
}
