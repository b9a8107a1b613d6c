//! Nested dissection (George 1973): a few nodes that separate the others into two halves are
//! eliminated last; each half is divided in the same way.
//!
//! Cuts are chosen by distances along the graph. Landmarks are nodes far from each other. The
//! difference of the distances from two landmarks is a coordinate; in a net with landmarks at two
//! of its corners, its level lines are straight.

use super::node_graph::NodeGraph;
use std::collections::VecDeque;

/// Number of nodes below which a part is ordered by minimum degree.
const SMALLEST_PART: usize = 120;

/// Landmarks of a part.
const LANDMARKS: usize = 4;

/// Least share of the nodes on each side of a separator.
const LEAST_SIDE: f64 = 0.2;

/// Not reached from a landmark.
const FAR: i32 = i32::MAX;

/// An order of elimination: entry k is the node to be eliminated as k-th.
pub(super) fn dissection_order(graph: &NodeGraph) -> Vec<usize> {
    let mut dissection = Dissection {
        neighbours: Neighbours::new(graph),
        number: vec![0; graph.nodes],
        part: vec![Some(0); graph.nodes],
        parts: 0,
        distances: [(); LANDMARKS].map(|()| vec![FAR; graph.nodes]),
        queue: VecDeque::new(),
        sizes: Vec::new(),
        order: Vec::with_capacity(graph.nodes),
    };
    dissection.divide((0..graph.nodes as u32).collect());
    dissection.order
}

/// The neighbours of node k are `list[starts[k]..starts[k + 1]]`.
struct Neighbours {
    starts: Vec<u32>,
    list: Vec<u32>,
}

impl Neighbours {
    fn new(graph: &NodeGraph) -> Self {
        let both = || graph.pairs().iter().flat_map(|&(p, q)| [(p, q), (q, p)]);
        let mut starts = vec![0; graph.nodes + 1];
        both().for_each(|(p, _)| starts[p as usize + 1] += 1);
        for k in 0..graph.nodes {
            starts[k + 1] += starts[k];
        }
        let mut next = starts.clone();
        let mut list = vec![0; 2 * graph.pairs().len()];
        for (p, q) in both() {
            list[next[p as usize] as usize] = q;
            next[p as usize] += 1;
        }
        Self { starts, list }
    }

    fn of(&self, node: u32) -> &[u32] {
        let range = self.starts[node as usize] as usize..self.starts[node as usize + 1] as usize;
        &self.list[range]
    }
}

struct Dissection {
    neighbours: Neighbours,
    /// The part of each node; none once the node is part of a separator.
    part: Vec<Option<u32>>,
    parts: u32,
    /// Number of each node in a part; scratch.
    number: Vec<u32>,
    /// Distance of each node from each landmark of its part, in pairs of the graph.
    distances: [Vec<i32>; LANDMARKS],
    queue: VecDeque<u32>,
    /// For each value of a coordinate, changes of the sizes of the separator and of the part up to
    /// it; scratch.
    sizes: Vec<Sizes>,
    order: Vec<usize>,
}

/// A cut by the difference of the distances from two landmarks. Nodes up to `value` that have
/// neighbours beyond it form the separator.
#[derive(Clone, Copy)]
struct Cut {
    landmarks: [usize; 2],
    value: i32,
}

#[derive(Clone, Copy, Default)]
struct Sizes {
    separator: i32,
    up_to: i32,
}

impl Dissection {
    /// Orders the nodes of a part.
    fn divide(&mut self, nodes: Vec<u32>) {
        if nodes.is_empty() {
            return;
        }
        if nodes.len() <= SMALLEST_PART {
            return self.order_by_degree(&nodes);
        }
        let components = self.components(&nodes);
        if components.len() > 1 {
            return components
                .into_iter()
                .for_each(|component| self.divide(component));
        }
        self.place_landmarks(&nodes);
        let Some(cut) = self.best_cut(&nodes) else {
            return self.order_by_degree(&nodes);
        };
        let (mut separator, mut before, mut beyond) = (Vec::new(), Vec::new(), Vec::new());
        for &node in &nodes {
            if self.coordinate(cut.landmarks, node) > cut.value {
                beyond.push(node);
            } else if self.farthest_neighbour(cut.landmarks, node) > cut.value {
                separator.push(node as usize);
            } else {
                before.push(node);
            }
        }
        for &node in &separator {
            self.part[node] = None;
        }
        self.divide_both(before, beyond);
        self.order.extend(separator);
    }

    fn divide_both(&mut self, one: Vec<u32>, other: Vec<u32>) {
        for nodes in [&one, &other] {
            self.parts += 1;
            for &node in nodes {
                self.part[node as usize] = Some(self.parts);
            }
        }
        self.divide(one);
        self.divide(other);
    }

    /// Makes a part of each connected component of a part, and lists its nodes.
    fn components(&mut self, nodes: &[u32]) -> Vec<Vec<u32>> {
        let whole = self.part[nodes[0] as usize];
        let mut components = Vec::new();
        for &start in nodes {
            if self.part[start as usize] != whole {
                continue;
            }
            self.parts += 1;
            let own = Some(self.parts);
            self.part[start as usize] = own;
            let (mut component, mut next) = (vec![start], 0);
            while let Some(&node) = component.get(next) {
                next += 1;
                for &other in self.neighbours.of(node) {
                    if self.part[other as usize] == whole {
                        self.part[other as usize] = own;
                        component.push(other);
                    }
                }
            }
            components.push(component);
        }
        components
    }

    /// Orders a part by minimum degree.
    fn order_by_degree(&mut self, nodes: &[u32]) {
        for (own, &node) in (0..).zip(nodes) {
            self.number[node as usize] = own;
        }
        let part = self.part[nodes[0] as usize];
        let mut pairs = Vec::new();
        for (own, &node) in (0..).zip(nodes) {
            let others = self.neighbours.of(node).iter();
            let inside = others.filter(|other| self.part[**other as usize] == part);
            pairs.extend(inside.map(|other| (own, self.number[*other as usize])));
        }
        let graph = NodeGraph::of_pairs(nodes.len(), &pairs);
        let order = graph.minimum_degree_order().into_iter();
        self.order.extend(order.map(|k| nodes[k] as usize));
    }

    /// Places landmarks as far from each other as possible. The first is the farthest from any
    /// node.
    fn place_landmarks(&mut self, nodes: &[u32]) {
        self.measure_from(nodes[0], 0, nodes);
        for landmark in 0..LANDMARKS {
            let known = 0..landmark.max(1);
            let nearest = |node: &u32| {
                let distances = self.distances[known.clone()].iter();
                distances
                    .map(|of_landmark| of_landmark[*node as usize])
                    .min()
            };
            let reached = nodes.iter().filter(|node| nearest(node) != Some(FAR));
            let farthest = *reached
                .max_by_key(|node| nearest(node))
                .expect("it reaches itself");
            self.measure_from(farthest, landmark, nodes);
        }
    }

    /// Distances of the nodes of a part from one of them.
    fn measure_from(&mut self, start: u32, landmark: usize, nodes: &[u32]) {
        let distances = &mut self.distances[landmark];
        for &node in nodes {
            distances[node as usize] = FAR;
        }
        distances[start as usize] = 0;
        let part = self.part[start as usize];
        self.queue.push_back(start);
        while let Some(node) = self.queue.pop_front() {
            for &other in self.neighbours.of(node) {
                if self.part[other as usize] == part && distances[other as usize] == FAR {
                    distances[other as usize] = distances[node as usize] + 1;
                    self.queue.push_back(other);
                }
            }
        }
    }

    fn coordinate(&self, [one, other]: [usize; 2], node: u32) -> i32 {
        self.distances[one][node as usize] - self.distances[other][node as usize]
    }

    /// The largest coordinate among a node and its neighbours in the same part.
    fn farthest_neighbour(&self, landmarks: [usize; 2], node: u32) -> i32 {
        let part = self.part[node as usize];
        let neighbours = self.neighbours.of(node).iter();
        neighbours
            .filter(|other| self.part[**other as usize] == part)
            .map(|other| self.coordinate(landmarks, *other))
            .fold(self.coordinate(landmarks, node), i32::max)
    }

    /// The cut with few nodes between two halves that differ little.
    fn best_cut(&mut self, nodes: &[u32]) -> Option<Cut> {
        let mut best: Option<(f64, Cut)> = None;
        for one in 0..LANDMARKS {
            for other in (0..LANDMARKS).filter(|other| *other != one) {
                let landmarks = [one, other];
                let least = self.count_sizes(landmarks, nodes);
                let count = nodes.len() as f64;
                let (mut separator, mut up_to) = (0, 0);
                for (value, sizes) in (least..).zip(&self.sizes) {
                    separator += sizes.separator;
                    up_to += sizes.up_to;
                    let before = f64::from(up_to - separator);
                    let beyond = count - f64::from(up_to);
                    if before.min(beyond) < LEAST_SIDE * count {
                        continue;
                    }
                    let cost = f64::from(separator) * count * count / (before * beyond);
                    if best.is_none_or(|(least, _)| cost < least) {
                        best = Some((cost, Cut { landmarks, value }));
                    }
                }
            }
        }
        best.map(|(_, cut)| cut)
    }

    /// Counts, for each value of a coordinate, how many nodes it adds to the separator and to the
    /// nodes up to it; returns the least value.
    fn count_sizes(&mut self, landmarks: [usize; 2], nodes: &[u32]) -> i32 {
        let values = || nodes.iter().map(|node| self.coordinate(landmarks, *node));
        let least = values().min().unwrap_or(0);
        let largest = values().max().unwrap_or(0);
        let mut sizes = std::mem::take(&mut self.sizes);
        sizes.clear();
        sizes.resize((largest - least + 1) as usize, Sizes::default());
        for &node in nodes {
            let value = (self.coordinate(landmarks, node) - least) as usize;
            let farthest = (self.farthest_neighbour(landmarks, node) - least) as usize;
            sizes[value].up_to += 1;
            sizes[value].separator += 1;
            sizes[farthest].separator -= 1;
        }
        self.sizes = sizes;
        least
    }
}
