//! The skeleton of a mask as a graph: ends and junctions joined by branches.

use super::Point;
use super::mask::{Mask, chamfer_distances};
use super::thinning::{neighbourhood, neighbours, straighten, thin};

/// A skeleton: nodes, where branches end or meet, and the branches between them.
#[derive(Clone, Debug)]
pub(super) struct Skeleton {
    pub nodes: Vec<Node>,
    pub branches: Vec<Branch>,
}

/// One end of a branch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Arm {
    pub branch: usize,
    /// 0 for the start of the branch, 1 for its end.
    pub side: usize,
}

impl Arm {
    /// The other end of its branch.
    pub fn opposite(self) -> Self {
        Self {
            side: 1 - self.side,
            ..self
        }
    }
}

/// A point where branches end or meet.
#[derive(Clone, Debug)]
pub(super) struct Node {
    /// Mean position of the pixels of the node.
    pub position: Point,
    /// Half width of the mask there, pixels.
    pub half_width: f64,
}

/// A line of pixels.
#[derive(Clone, Debug)]
pub(super) struct Branch {
    /// Pixels in order, without the pixels of the nodes.
    pub pixels: Vec<Point>,
    /// Half width of the mask at each pixel.
    pub half_widths: Vec<f64>,
    /// Nodes at its start and end; a branch without nodes is a closed curve.
    pub nodes: Option<[usize; 2]>,
}

impl Branch {
    /// Length along the pixels, without the distances to the nodes.
    pub fn length(&self) -> f64 {
        let steps = self
            .pixels
            .windows(2)
            .map(|pair| (pair[1] - pair[0]).norm());
        steps.sum()
    }

    /// Median of the half width.
    pub fn half_width(&self) -> f64 {
        median(&self.half_widths)
    }
}

/// Median (the upper of the two middle values); 0 for an empty list.
pub(super) fn median(values: &[f64]) -> f64 {
    let mut values = values.to_vec();
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Number of rounds in which spurs are removed; spurs on spurs are rare.
const PRUNING_ROUNDS: usize = 4;

impl Skeleton {
    /// Thins a mask and follows its lines. Spurs are removed. These are branches with a free end
    /// that are not longer than the width of the mask at their start; they come from corners of
    /// the mask.
    pub fn new(mask: &Mask) -> Self {
        let members = mask.members();
        let distances = chamfer_distances(mask, &members);
        let mut thinned = mask.clone();
        let mut line = thin(&mut thinned, &members);
        let mut tracer = Tracer::new(&distances);
        for _ in 0..PRUNING_ROUNDS {
            let traced = tracer.trace(&thinned, &line);
            let spurs = traced.spurs();
            if spurs.is_empty() {
                return traced.skeleton;
            }
            for pixel in spurs {
                thinned.cells_mut()[pixel] = 0;
            }
            line.retain(|index| thinned.cells()[*index] == 1);
            straighten(&mut thinned, &mut line);
        }
        tracer.trace(&thinned, &line).skeleton
    }
}

impl Skeleton {
    /// Combines skeletons into one, without connecting them.
    pub fn joined(parts: impl IntoIterator<Item = Self>) -> Self {
        let mut joined = Self {
            nodes: Vec::new(),
            branches: Vec::new(),
        };
        for part in parts {
            let offset = joined.nodes.len();
            joined.nodes.extend(part.nodes);
            joined
                .branches
                .extend(part.branches.into_iter().map(|branch| Branch {
                    nodes: branch.nodes.map(|nodes| nodes.map(|node| node + offset)),
                    ..branch
                }));
        }
        joined
    }
}

/// Working data for following lines.
struct Tracer<'a> {
    distances: &'a [u16],
    /// Number of the node plus one for each junction or end pixel; 0 elsewhere.
    node_of: Vec<u32>,
    visited: Vec<bool>,
}

/// A skeleton, and the data to prune it: the cells of its branches and the degrees of its nodes.
struct Traced {
    skeleton: Skeleton,
    cells: Vec<Vec<usize>>,
    node_cells: Vec<Vec<usize>>,
    degrees: Vec<usize>,
    free_ends: Vec<bool>,
}

impl<'a> Tracer<'a> {
    fn new(distances: &'a [u16]) -> Self {
        Self {
            distances,
            node_of: vec![0; distances.len()],
            visited: vec![false; distances.len()],
        }
    }

    fn half_width(&self, index: usize) -> f64 {
        // The correction: distances are measured to the centre of the nearest outside pixel, from
        // a pixel next to the true middle.
        f64::from(self.distances[index]) / 5.0 - 0.25
    }

    fn trace(&mut self, mask: &Mask, line: &[usize]) -> Traced {
        let (cells, stride) = (mask.cells(), mask.stride());
        let degree = |index: usize| neighbourhood(cells, index, stride).count_ones();
        let point = |index: usize| {
            let (column, row) = mask.position(index);
            Point::new(column as f64, row as f64)
        };
        for index in line {
            self.node_of[*index] = 0;
            self.visited[*index] = false;
        }
        let mut nodes = Vec::new();
        let mut free_ends = Vec::new();
        let mut node_cells: Vec<Vec<usize>> = Vec::new();
        for start in line.iter().copied() {
            if degree(start) == 2 || self.node_of[start] != 0 {
                continue;
            }
            let number = nodes.len() as u32 + 1;
            let mut members = vec![start];
            self.node_of[start] = number;
            let junction = degree(start) > 2;
            let mut next = 0;
            // Junction pixels that touch are one junction.
            while junction && next < members.len() {
                for other in neighbours(members[next], stride) {
                    if cells[other] == 1 && self.node_of[other] == 0 && degree(other) > 2 {
                        self.node_of[other] = number;
                        members.push(other);
                    }
                }
                next += 1;
            }
            let sum: Point = members.iter().map(|index| point(*index)).sum();
            let widths = members.iter().map(|index| self.half_width(*index));
            nodes.push(Node {
                position: sum / members.len() as f64,
                half_width: widths.fold(0.0, f64::max),
            });
            free_ends.push(!junction);
            node_cells.push(members);
        }
        let mut branches = Vec::new();
        let mut branch_cells = Vec::new();
        let mut degrees = vec![0; nodes.len()];
        let mut add = |pixels: Vec<usize>, nodes: Option<[usize; 2]>, tracer: &Self| {
            branches.push(Branch {
                half_widths: pixels
                    .iter()
                    .map(|index| tracer.half_width(*index))
                    .collect(),
                pixels: pixels.iter().map(|index| point(*index)).collect(),
                nodes,
            });
            branch_cells.push(pixels);
        };
        for (node, members) in node_cells.iter().enumerate() {
            for start in members {
                for first in neighbours(*start, stride) {
                    if cells[first] == 0 || self.visited[first] {
                        continue;
                    }
                    let number = self.node_of[first] as usize;
                    if number != 0 {
                        // Two nodes touch: they are joined by a branch without pixels, which is
                        // added from the node with the lower number.
                        if number > node + 1 {
                            add(Vec::new(), Some([node, number - 1]), self);
                            degrees[node] += 1;
                            degrees[number - 1] += 1;
                        }
                        continue;
                    }
                    let (pixels, last) = self.follow(cells, stride, *start, first);
                    let end = self.node_of[last] as usize - 1;
                    if end == node && pixels.len() < 4 {
                        // This is a bump of the junction, not a loop.
                        continue;
                    }
                    degrees[node] += 1;
                    degrees[end] += 1;
                    add(pixels, Some([node, end]), self);
                }
            }
        }
        for start in line.iter().copied() {
            if self.visited[start] || self.node_of[start] != 0 {
                continue;
            }
            let mut pixels = vec![start];
            self.visited[start] = true;
            while let Some(next) = neighbours(pixels[pixels.len() - 1], stride)
                .into_iter()
                .find(|other| cells[*other] == 1 && !self.visited[*other])
            {
                self.visited[next] = true;
                pixels.push(next);
            }
            add(pixels, None, self);
        }
        Traced {
            skeleton: Skeleton { nodes, branches },
            cells: branch_cells,
            node_cells,
            degrees,
            free_ends,
        }
    }

    /// Follows a line from the pixel of a node, through pixels with two neighbours, to the pixel
    /// of the next node.
    fn follow(
        &mut self,
        cells: &[u8],
        stride: usize,
        start: usize,
        first: usize,
    ) -> (Vec<usize>, usize) {
        let (mut pixels, mut before, mut current) = (Vec::new(), start, first);
        while self.node_of[current] == 0 {
            self.visited[current] = true;
            pixels.push(current);
            let next = neighbours(current, stride)
                .into_iter()
                .find(|other| cells[*other] == 1 && *other != before);
            let Some(next) = next else {
                break;
            };
            before = current;
            current = next;
        }
        (pixels, current)
    }
}

impl Traced {
    /// Cells of branches that begin at a junction, have a free end, and are not longer than the
    /// width of the mask at the junction.
    fn spurs(&self) -> Vec<usize> {
        let mut spurs = Vec::new();
        for (branch, cells) in self.skeleton.branches.iter().zip(&self.cells) {
            let Some(ends) = branch.nodes else {
                continue;
            };
            for (junction, tip) in [(ends[0], ends[1]), (ends[1], ends[0])] {
                if !self.free_ends[tip] || self.degrees[junction] < 3 {
                    continue;
                }
                let node = &self.skeleton.nodes[junction];
                let length = (self.skeleton.nodes[tip].position - node.position).norm();
                if length < 1.2 * node.half_width + 2.0 {
                    spurs.extend(cells);
                    spurs.extend(&self.node_cells[tip]);
                }
            }
        }
        spurs
    }
}

#[cfg(test)]
mod tests {
    use super::super::mask::tests::strokes;
    use super::*;

    #[test]
    fn a_stroke_is_one_branch_with_its_length() {
        let mask = strokes(120, 80, 9.0, &[&[[15.0, 15.0], [100.0, 60.0]]]);
        let skeleton = Skeleton::new(&mask);
        assert_eq!(skeleton.branches.len(), 1);
        assert_eq!(skeleton.nodes.len(), 2);
        let branch = &skeleton.branches[0];
        let direct = (branch.pixels[0] - branch.pixels[branch.pixels.len() - 1]).norm();
        assert!((direct - 96.2).abs() < 6.0, "{direct}");
        assert!(
            (branch.half_width() - 4.5).abs() < 0.5,
            "{}",
            branch.half_width()
        );
    }

    #[test]
    fn a_cross_has_four_free_ends_and_a_loop_none() {
        let cross = [[[10.0, 10.0], [90.0, 90.0]], [[10.0, 90.0], [90.0, 10.0]]];
        let skeleton = Skeleton::new(&strokes(100, 100, 7.0, &[&cross[0], &cross[1]]));
        let degree = |node: usize| {
            let ends = skeleton.branches.iter().filter_map(|branch| branch.nodes);
            ends.flatten().filter(|end| *end == node).count()
        };
        let free = (0..skeleton.nodes.len()).filter(|node| degree(*node) == 1);
        assert_eq!(free.count(), 4);

        let corners = [[20.0, 20.0], [80.0, 20.0], [80.0, 80.0], [20.0, 80.0]];
        let square = [&corners[..], &corners[..1]].concat();
        let skeleton = Skeleton::new(&strokes(100, 100, 7.0, &[&square]));
        assert_eq!(skeleton.branches.len(), 1);
        assert!(skeleton.branches[0].nodes.is_none());
        let length = skeleton.branches[0].length();
        assert!((length - 240.0).abs() < 20.0, "{length}");
    }
}
