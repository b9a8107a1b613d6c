//! Consecutive rods whose edges and vertices are evaluated together, in parallel with others.

use super::discretization::{ElasticRods, Vertex, VertexUnknowns};
use crate::linalg::instruction_set::LANES;
use std::ops::Range;

/// Least number of vertices of a part: waking a thread takes as long as a hundred of them.
const LEAST_VERTICES: usize = 500;

/// Batches of edges or vertices that are updated together.
pub(super) const BATCHES: usize = 64;

/// Consecutive rods.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Part {
    pub nodes: Range<usize>,
    pub edges: Range<usize>,
    pub vertices: Range<usize>,
    /// Elements of their closing vertices.
    pub elements: Range<usize>,
}

/// Consecutive batches of edges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct EdgeGroup {
    pub first_batch: usize,
    /// First node of the first edge.
    pub first_node: usize,
}

/// Division of all rods for parallel work. It depends on the rods alone, not on the number of
/// threads.
#[derive(Clone, Debug)]
pub(super) struct Parts {
    /// Parts that share no unknowns; the last one contains all nodes that follow.
    pub rods: Vec<Part>,
    /// The vertices from here on are those of nodes that were grasped; they are in no part.
    pub later_vertices: usize,
    /// Groups of edges, in their order.
    pub edges: Vec<EdgeGroup>,
}

impl Parts {
    /// Divides rods. Scenes in which frames of joints turn half vertices have a single part, since
    /// these vertices share the unknowns of the frames.
    pub(super) fn of(rods: &ElasticRods) -> Self {
        let in_order = (rods.edges).is_sorted_by(|one, next| one.start < next.start);
        assert!(in_order, "edges are listed in the order of their nodes");
        let groups = rods.edges.chunks(LANES * BATCHES).enumerate();
        let edges = groups.map(|(group, edges)| EdgeGroup {
            first_batch: BATCHES * group,
            first_node: edges[0].start,
        });
        let (list, later_vertices) = divided(rods).unwrap_or_else(|| {
            let whole = Part {
                nodes: 0..rods.nodes + rods.ghosts,
                edges: 0..rods.edges.len(),
                vertices: 0..rods.vertices.len(),
                elements: 0..rods.elements.len(),
            };
            (vec![whole], rods.vertices.len())
        });
        Self {
            rods: list,
            later_vertices,
            edges: edges.collect(),
        }
    }
}

/// The parts, and the first vertex that is in none; `None` if rods share elements.
fn divided(rods: &ElasticRods) -> Option<(Vec<Part>, usize)> {
    let mut parts: Vec<Part> = Vec::new();
    let [mut edge, mut vertex, mut element] = [0; 3];
    let mut first = [0; 4];
    for range in &rods.rods {
        let node = range.node_indices().end;
        edge += range.edges();
        let own = (rods.vertices[vertex..].iter()).take_while(|vertex| {
            range
                .node_indices()
                .contains(&real_edge(vertex, rods.nodes))
        });
        for own in own {
            match own.unknowns {
                VertexUnknowns::Consecutive { .. } => {}
                VertexUnknowns::Closing { element: own } if own == element => element += 1,
                _ => return None,
            }
            vertex += 1;
        }
        if vertex - first[2] >= LEAST_VERTICES {
            parts.push(Part {
                nodes: first[0]..node,
                edges: first[1]..edge,
                vertices: first[2]..vertex,
                elements: first[3]..element,
            });
            first = [node, edge, vertex, element];
        }
    }
    let has_element =
        |vertex: &Vertex| !matches!(vertex.unknowns, VertexUnknowns::Consecutive { .. });
    let is_complete = edge == rods.edges.len() && element == rods.elements.len();
    if !is_complete || rods.vertices[vertex..].iter().any(has_element) {
        return None;
    }
    // What is left of the rods joins the last part, with the nodes of free bodies and the ghosts.
    let last = parts.last_mut()?;
    last.nodes.end = rods.nodes + rods.ghosts;
    (last.edges.end, last.vertices.end, last.elements.end) = (edge, vertex, element);
    Some((parts, vertex))
}

/// An edge of a vertex that is not a ghost.
fn real_edge(vertex: &Vertex, nodes: usize) -> usize {
    if vertex.before < nodes {
        vertex.before
    } else {
        vertex.after
    }
}
