//! An approximate inverse of the flow operator from neighbourhoods of nodes.

use super::FluidError;
use super::chain::Link;
use super::elimination::eliminate;
use super::lanes::PARALLEL_FROM;
use super::lanes::{SingleLanes, multiply_rows};
use super::operator::FlowOperator;
use super::patch::Patch;
use super::points::{Points, Share};
use crate::linalg::instruction_set::{InstructionSet, LANES, Lanes};
use crate::mechanics::Vector3;
use rayon::prelude::*;

/// Nodes of a neighbourhood per node of its group. A smaller number shares the cost of an
/// elimination among more nodes, but leaves the nodes at the ends of the group with few
/// neighbours.
const NEIGHBOURS_PER_NODE: usize = 8;

/// Restricted additive Schwarz (Cai and Sarkis 1999): consecutive nodes form small groups, and the
/// forces of a group follow from the exact solution of the flow among the nodes nearest to the
/// group, on any filament.
///
/// Blocks of whole filaments would do as well for distant filaments, but take 46 iterations
/// instead of 17 in a tight bundle, where the nearest neighbours of a node are on other filaments.
pub(super) struct Neighbourhoods {
    set: InstructionSet,
    size: usize,
    groups: Vec<Group>,
    parallel: bool,
}

/// A group, and its rows of the inverse of the neighbourhood's operator.
#[derive(Default)]
struct Group {
    first: usize,
    nodes: usize,
    /// The neighbourhood; the nodes of the group come first.
    neighbours: Vec<usize>,
    /// Rows of the inverse, padded to whole lanes; the approximation does not need more than
    /// single precision.
    rows: Vec<SingleLanes>,
    /// Velocities of the neighbourhood, padded to whole lanes.
    gathered: Vec<Lanes>,
}

/// Positions of the stations, and the points that they form.
struct Site<'a> {
    links: &'a [Link],
    positions: &'a [Vector3],
    points: &'a Points,
    /// The operator beside a wall, which includes the images; without a wall, blocks are evaluated
    /// here.
    walled: Option<&'a FlowOperator>,
}

/// Scratch of building a group.
#[derive(Default)]
struct Workspace {
    /// Distances of all points from the group.
    distances: Vec<(f64, usize)>,
    /// The stations of the neighbourhood's rows.
    rows: Vec<usize>,
    /// All stations that have densities of the neighbourhood, in ascending order.
    columns: Vec<usize>,
    /// Part of the operator that belongs to the neighbourhood.
    patch: Patch,
    /// The system to be solved.
    system: Vec<f64>,
}

impl Neighbourhoods {
    /// Groups the given number of nodes. Each group has a neighbourhood of the given size, or all
    /// nodes if there are fewer.
    pub(crate) fn new(nodes: usize, size: usize) -> Self {
        let nodes_of_a_group = size / NEIGHBOURS_PER_NODE;
        let groups = (0..nodes)
            .step_by(nodes_of_a_group)
            .map(|first| Group {
                first,
                nodes: nodes_of_a_group.min(nodes - first),
                ..Group::default()
            })
            .collect();
        Self {
            set: InstructionSet::best(),
            size,
            groups,
            parallel: nodes >= PARALLEL_FROM,
        }
    }

    /// Nodes of a neighbourhood.
    pub(crate) fn size(&self) -> usize {
        self.size
    }

    /// Floating-point operations of [`build`](Self::build) for `nodes` nodes: 2/3 m³ for the elimination of m unknowns.
    pub(crate) fn operations(&self, nodes: usize) -> f64 {
        let unknowns = (3 * self.size.min(nodes)) as f64;
        self.groups.len() as f64 * unknowns * unknowns * unknowns * 2.0 / 3.0
    }

    /// Finds the neighbourhoods of the points of stations at these positions, and inverts their
    /// parts of the operator.
    ///
    /// # Errors
    /// [`FluidError::Singular`] if a neighbourhood has no inverse.
    pub(crate) fn build(
        &mut self,
        links: &[Link],
        positions: &[Vector3],
        points: &Points,
        walled: Option<&FlowOperator>,
    ) -> Result<(), FluidError> {
        let (set, size) = (self.set, self.size.min(points.count()));
        let site = Site {
            links,
            positions,
            points,
            walled,
        };
        let build =
            |workspace: &mut Workspace, group: &mut Group| group.build(set, &site, size, workspace);
        let worked = if self.parallel {
            self.groups
                .par_iter_mut()
                .map_init(Workspace::default, build)
                .reduce(|| true, |a, b| a & b)
        } else {
            let mut workspace = Workspace::default();
            (self.groups.iter_mut())
                .map(|group| build(&mut workspace, group))
                .fold(true, |a, b| a & b)
        };
        if worked {
            Ok(())
        } else {
            Err(FluidError::Singular)
        }
    }

    /// `y` ≈ A⁻¹ `x`.
    pub(crate) fn apply(&mut self, x: &[f64], y: &mut [f64]) {
        for group in &mut self.groups {
            let own = 3 * group.first..3 * (group.first + group.nodes);
            for (k, &node) in group.neighbours.iter().enumerate() {
                for c in 0..3 {
                    let unknown = 3 * k + c;
                    group.gathered[unknown / LANES][unknown % LANES] = x[3 * node + c];
                }
            }
            multiply_rows(self.set, &group.rows, &group.gathered, &mut y[own]);
        }
    }
}

impl Group {
    fn build(
        &mut self,
        set: InstructionSet,
        site: &Site,
        size: usize,
        workspace: &mut Workspace,
    ) -> bool {
        let Site {
            links,
            positions,
            points,
            walled,
        } = *site;
        let Workspace {
            distances,
            rows,
            columns,
            patch,
            system,
        } = workspace;
        self.find_neighbours(site, size, distances);
        let own = 3 * self.nodes;
        let order = 3 * self.neighbours.len();
        let stride = order + own;
        // The rows W of the inverse of L satisfy Lᵀ Wᵀ = E, where E is the first columns of the
        // identity.
        system.clear();
        system.resize(order * stride, 0.0);
        rows.clear();
        columns.clear();
        for &point in &self.neighbours {
            rows.push(points.representatives()[point]);
            columns.extend_from_slice(points.members(point));
        }
        let is_near = |share: &Share| share.weight != 0.0 && self.neighbours.contains(&share.point);
        columns.extend(
            points
                .sliding()
                .filter(|&station| points.shares(station).iter().any(is_near)),
        );
        columns.sort_unstable();
        if walled.is_none() {
            patch.assemble(set, links, positions, rows, columns);
        }
        let mut slots = patch.columns();
        for &column in columns.iter() {
            let slot = slots.next();
            for share in points.shares(column).iter().filter(|share| is_near(share)) {
                let k = (self.neighbours.iter())
                    .position(|&point| point == share.point)
                    .expect("a point of the neighbourhood");
                for l in 0..self.neighbours.len() {
                    let block = match walled {
                        Some(operator) => operator.block(rows[l], column),
                        None => patch.block(l, slot.expect("a slot of every column")),
                    } * share.weight;
                    for c in 0..3 {
                        for d in 0..3 {
                            system[(3 * k + c) * stride + 3 * l + d] += block[(d, c)];
                        }
                    }
                }
            }
        }
        for i in 0..own {
            system[i * stride + order + i] = 1.0;
        }
        if !eliminate(set, system, order, own) {
            return false;
        }
        let width = order.div_ceil(LANES);
        self.gathered.clear();
        self.gathered.resize(width, [0.0; LANES]);
        self.rows.clear();
        self.rows.resize(own * width, SingleLanes::default());
        for i in 0..own {
            for j in 0..order {
                self.rows[i * width + j / LANES][j % LANES] = system[j * stride + order + i] as f32;
            }
        }
        true
    }

    /// The `size` points nearest to any point of the group; the group itself comes first, at distance zero.
    fn find_neighbours(&mut self, site: &Site, size: usize, distances: &mut Vec<(f64, usize)>) {
        let group = self.first..self.first + self.nodes;
        let place = |&station: &usize| &site.positions[station];
        let all = site.points.representatives();
        let own = &all[group.clone()];
        let distance = |x: &Vector3| {
            own.iter()
                .map(|station| (x - place(station)).norm_squared())
                .fold(f64::INFINITY, f64::min)
        };
        distances.clear();
        distances.extend((all.iter().enumerate()).map(|(point, station)| {
            (
                if group.contains(&point) {
                    -1.0
                } else {
                    distance(place(station))
                },
                point,
            )
        }));
        let order = |a: &(f64, usize), b: &(f64, usize)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
        distances.select_nth_unstable_by(size - 1, order);
        distances[..size].sort_unstable_by(order);
        self.neighbours.clear();
        self.neighbours
            .extend(distances[..size].iter().map(|&(_, node)| node));
    }
}
