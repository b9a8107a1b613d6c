//! Positions of the obstacles, and search for their parts near a rod.
//!
//! Each obstacle has a tree of boxes around its segments and faces in its own frame. The tree
//! never changes; edges of rods are transformed into the frame by the pose of the obstacle. So the
//! cost of a search per edge of a rod is logarithmic in the size of the mesh, whether the mesh
//! moves or not.

use super::box_tree::{AlignedBox, BoxTree};
use super::closest_points::{ClosestPoints, edge_distance};
use super::contacts::{ABOVE, BELOW, CandidatePair, EDGE, RIM_NODE, TUBE};
use super::foot::{Foot, Points};
use super::rim::{RimPoint, RodPiece, pieces_of};
use super::surface::{ContactEdge, ContactFace, ContactNode, ContactSurface};
use crate::mechanics::Vector3;
use crate::mechanics::rigid_body::RigidBody;
use crate::mechanics::rotation::{Pose, to_vector};
use std::collections::BTreeMap;

/// The obstacles at the start and the end of the present step.
#[derive(Clone, Default)]
pub(super) struct PlacedObstacles {
    vertices: Vec<Vector3>,
    vertices_at_start: Vec<Vector3>,
    /// Normals of smooth meshes.
    normals: Vec<Vector3>,
    normals_at_start: Vec<Vector3>,
    placed: Vec<Placed>,
    /// Pieces of rods that may touch the rim of a tube; empty without tubes.
    pieces: Vec<RodPiece>,
    /// Whether an obstacle has moved since the candidates were built.
    pub moved: bool,
}

#[derive(Clone)]
struct Placed {
    pose: Pose,
    pose_at_start: Pose,
    /// Indices of its first vertex, segment and face among those of all obstacles; segments are
    /// counted among all edges.
    first_vertex: usize,
    first_edge: usize,
    first_face: usize,
    first_normal: usize,
    /// Boxes around its segments, and boxes around its faces, in its own frame.
    tree: BoxTree,
    /// Boxes around the segments that edges of rods touch, if these are fewer, and their numbers.
    sharp: Option<(BoxTree, Vec<usize>)>,
    /// Smooth parts of its mesh.
    regions: Vec<Region>,
}

/// A smooth part of a mesh.
#[derive(Clone)]
struct Region {
    /// Its first face.
    first: usize,
    /// Boxes around its faces, and their numbers.
    tree: BoxTree,
    faces: Vec<usize>,
    /// Largest distance of the smooth surface from its faces, m.
    bulge: f64,
}

impl std::fmt::Debug for PlacedObstacles {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let poses = self.placed.iter().map(|placed| placed.pose);
        formatter.debug_list().entries(poses).finish()
    }
}

impl PlacedObstacles {
    /// The obstacles of a surface at time zero.
    pub(crate) fn new(surface: &ContactSurface) -> Self {
        let mut all = Self::default();
        if surface.obstacles().iter().any(|obstacle| obstacle.hollow) {
            all.pieces = pieces_of(surface);
        }
        let mut first_edge = surface.rod_edges().len();
        let mut first_face = surface.body_faces().len();
        for obstacle in surface.obstacles() {
            let box_of = |corners: &[usize]| {
                let corners = corners.iter().map(|&corner| obstacle.vertices[corner]);
                AlignedBox::around(corners, obstacle.radius)
            };
            let segments = obstacle.segments.iter().map(|segment| box_of(segment));
            let faces = obstacle.faces.iter().map(|face| box_of(face));
            all.placed.push(Placed {
                pose: Pose::default(),
                pose_at_start: Pose::default(),
                first_vertex: all.vertices.len(),
                first_edge,
                first_face,
                first_normal: all.normals.len(),
                tree: BoxTree::new(segments.chain(faces)),
                sharp: obstacle.smooth.as_ref().map(|smooth| {
                    let own = 0..obstacle.segments.len();
                    let sharp: Vec<usize> = own.filter(|index| smooth.sharp[*index]).collect();
                    let boxes = sharp.iter().map(|index| box_of(&obstacle.segments[*index]));
                    (BoxTree::new(boxes), sharp)
                }),
                regions: regions_of(obstacle, first_face),
            });
            let normals = obstacle.smooth.iter().flat_map(|smooth| &smooth.normals);
            all.normals.extend(normals);
            all.vertices.extend(&obstacle.vertices);
            first_edge += obstacle.segments.len();
            first_face += obstacle.faces.len();
        }
        all.vertices_at_start.clone_from(&all.vertices);
        all.normals_at_start.clone_from(&all.normals);
        all
    }

    /// Moves an obstacle to a pose.
    pub(crate) fn place(&mut self, surface: &ContactSurface, index: usize, pose: Pose) {
        let placed = &mut self.placed[index];
        if placed.pose == pose {
            return;
        }
        placed.pose = pose;
        let vertices = &surface.obstacles()[index].vertices;
        let now = &mut self.vertices[placed.first_vertex..];
        for (now, vertex) in now.iter_mut().zip(vertices) {
            *now = pose.of(vertex);
        }
        if let Some(smooth) = &surface.obstacles()[index].smooth {
            let now = &mut self.normals[placed.first_normal..];
            for (now, normal) in now.iter_mut().zip(&smooth.normals) {
                *now = pose.rotation * normal;
            }
        }
        self.moved = true;
    }

    /// Whether an obstacle moves in the step.
    pub(crate) fn moves(&self, index: usize) -> bool {
        let placed = &self.placed[index];
        placed.pose != placed.pose_at_start
    }

    /// Rotation vector of an obstacle in the step, rad.
    pub(crate) fn turn(&self, index: usize) -> Vector3 {
        let placed = &self.placed[index];
        if placed.pose.rotation == placed.pose_at_start.rotation {
            return Vector3::zeros();
        }
        to_vector(&(placed.pose.rotation * placed.pose_at_start.rotation.inverse()))
    }

    /// Whether a point is within the box around an obstacle.
    pub(crate) fn is_near(&self, index: usize, point: &Vector3) -> bool {
        let placed = &self.placed[index];
        let around = placed.tree.whole();
        around.contains(&placed.pose.back_of(point))
    }

    /// Stores the present poses as the start of the next step.
    pub(crate) fn commit(&mut self) {
        if !(0..self.placed.len()).any(|index| self.moves(index)) {
            return;
        }
        self.vertices_at_start.clone_from(&self.vertices);
        self.normals_at_start.clone_from(&self.normals);
        for placed in &mut self.placed {
            placed.pose_at_start = placed.pose;
        }
    }

    /// Nodes of rods, and the present vertices.
    pub(crate) fn points<'a>(&'a self, nodes: &'a [Vector3]) -> Points<'a> {
        Points {
            nodes,
            vertices: &self.vertices,
            normals: &self.normals,
        }
    }

    /// Nodes of rods, and the vertices at the start of the step.
    pub(crate) fn points_at_start<'a>(&'a self, nodes: &'a [Vector3]) -> Points<'a> {
        Points {
            nodes,
            vertices: &self.vertices_at_start,
            normals: &self.normals_at_start,
        }
    }

    /// Largest displacement of a vertex in the step, m.
    pub(crate) fn largest_move(&self) -> f64 {
        if !(0..self.placed.len()).any(|index| self.moves(index)) {
            return 0.0;
        }
        let vertices = self.vertices.iter().zip(&self.vertices_at_start);
        let largest = vertices.fold(0.0, |largest, (now, before)| {
            f64::max(largest, (now - before).norm_squared())
        });
        largest.sqrt()
    }

    /// Adds all pairs of an edge or node of a rod and a part of an obstacle with surfaces nearer
    /// than `clearance` (m), together with the distance of the edge or node from the surface of
    /// the obstacle.
    pub(crate) fn find(
        &self,
        surface: &ContactSurface,
        nodes: &[Vector3],
        clearance: f64,
        found: &mut Vec<(CandidatePair, f64)>,
    ) {
        let points = self.points(nodes);
        let roots = &surface.roots;
        for (number, (placed, obstacle)) in self.placed.iter().zip(surface.obstacles()).enumerate()
        {
            let segments = obstacle.segments.len();
            let near = |ends: &[usize], radius: f64| {
                let ends = ends.iter().map(|&end| placed.pose.back_of(&nodes[end]));
                AlignedBox::around(ends, radius + clearance)
            };
            for (index, edge) in surface.rod_edges().iter().enumerate() {
                if edge.held || obstacle.hollow || roots.free_edge(index, number) {
                    continue;
                }
                let sought = near(&edge.nodes, edge.radius);
                for part in placed.segments_meeting(surface, edge, segments, sought) {
                    let pair = placed.pair_of_edges(surface, index, part);
                    let distance = edge_distance(&points.of(pair.nodes)) - obstacle.radius;
                    if distance < edge.radius + clearance {
                        found.push((pair, distance));
                    }
                }
            }
            if obstacle.hollow {
                placed.find_in_tube(surface, number, &points, clearance, found);
                placed.find_at_rims(surface, &self.pieces, &points, clearance, found);
            }
            if obstacle.faces.is_empty() {
                continue;
            }
            for end in surface.nodes() {
                if roots.free_node(end.node, number) {
                    continue;
                }
                if obstacle.smooth.is_some() && surface.is_rod_node(end.node) {
                    placed.find_at_regions(surface, number, end, &points, clearance, found);
                    continue;
                }
                let box_of_node = near(&[end.node], end.radius);
                for part in placed.tree.meeting(box_of_node) {
                    let Some(part) = part.checked_sub(segments) else {
                        continue;
                    };
                    let face = placed.first_face + part;
                    let corners = points.of(surface.faces()[face].with(end.node));
                    let Some(foot) = Foot::in_plane(&corners, 1.0) else {
                        continue;
                    };
                    let distance = distance_from_face(&corners, &foot) - obstacle.radius;
                    let is_behind = foot.distance < 0.0;
                    if distance < end.radius + clearance {
                        let side = if is_behind && !obstacle.closed { -1 } else { 1 };
                        let pair = pair_with_face(surface, [end.edge, face], end.node, side);
                        found.push((pair, distance));
                    }
                }
            }
        }
    }

    /// Adds all pairs of an edge or node of a rod and a part of an obstacle whose paths from
    /// `start` to `end` come near each other. Paths are straight lines in the frame of the
    /// obstacle.
    pub(crate) fn find_swept(
        &self,
        surface: &ContactSurface,
        start: &[Vector3],
        end: &[Vector3],
        found: &mut Vec<CandidatePair>,
    ) {
        let roots = &surface.roots;
        for (number, (placed, obstacle)) in self.placed.iter().zip(surface.obstacles()).enumerate()
        {
            let segments = obstacle.segments.len();
            let swept = |nodes: &[usize], radius: f64| {
                let before = nodes
                    .iter()
                    .map(|&node| placed.pose_at_start.back_of(&start[node]));
                let after = nodes.iter().map(|&node| placed.pose.back_of(&end[node]));
                AlignedBox::around(before.chain(after), radius)
            };
            for (index, edge) in surface.rod_edges().iter().enumerate() {
                if edge.held || obstacle.hollow || roots.free_edge(index, number) {
                    continue;
                }
                let sought = swept(&edge.nodes, edge.radius);
                let parts = placed.segments_meeting(surface, edge, segments, sought);
                found.extend(parts.map(|part| placed.pair_of_edges(surface, index, part)));
            }
            if obstacle.hollow {
                let nodes = surface.nodes().iter();
                let nodes = nodes.filter(|node| !roots.free_node(node.node, number));
                found.extend(nodes.map(|node| placed.pair_in_tube(surface, node)));
                let pairs = placed.pairs_at_rims(surface, &self.pieces);
                found.extend(pairs.filter(|pair| pair.sign() > 0.0));
            }
            if obstacle.faces.is_empty() {
                continue;
            }
            for node in surface.nodes() {
                if roots.free_node(node.node, number) {
                    continue;
                }
                let parts = swept(&[node.node], node.radius);
                let parts = placed.tree.meeting(parts);
                let faces = parts.filter_map(|part| part.checked_sub(segments));
                found.extend(faces.map(|face| {
                    let face = placed.first_face + face;
                    pair_with_face(surface, [node.edge, face], node.node, 1)
                }));
            }
        }
    }
}

impl Placed {
    /// The segments near a box that an edge of a rod or of a free body may touch; `segments` is the
    /// number of all.
    fn segments_meeting(
        &self,
        surface: &ContactSurface,
        edge: &ContactEdge,
        segments: usize,
        sought: AlignedBox,
    ) -> impl Iterator<Item = usize> {
        let sharp = self.sharp.as_ref();
        let sharp = sharp.filter(|_| surface.is_rod_node(edge.nodes[0]));
        let tree = sharp.map_or(&self.tree, |(tree, _)| tree);
        tree.meeting(sought).filter_map(move |part| match sharp {
            Some((_, numbers)) => Some(numbers[part]),
            None => (part < segments).then_some(part),
        })
    }

    /// Adds the pairs of a node and the smooth parts near it. A node that is not over such a part
    /// now may be over it later; its pair has a distance below all others.
    fn find_at_regions(
        &self,
        surface: &ContactSurface,
        number: usize,
        node: &ContactNode,
        points: &Points,
        clearance: f64,
        found: &mut Vec<(CandidatePair, f64)>,
    ) {
        let obstacle = &surface.obstacles()[number];
        let position = points.at(node.node);
        let place = self.pose.back_of(&position);
        for region in &self.regions {
            let flat = |part: usize| {
                let [a, b, c] = obstacle.faces[region.faces[part]].map(|k| obstacle.vertices[k]);
                let corners = [place, a, b, c];
                let foot = Foot::in_plane(&corners, 1.0);
                foot.map_or(f64::INFINITY, |foot| distance_from_face(&corners, &foot))
            };
            let within = node.radius + clearance + region.bulge;
            let Some((part, _)) = region.tree.nearest(&place, within, flat) else {
                continue;
            };
            let start = self.first_face + region.faces[part];
            let foot = surface.foot_from(start, 1.0, &position, points);
            let height = match &foot {
                Some(foot) => foot.distance,
                None => {
                    let corners = points.of(surface.faces()[start].with(node.node));
                    Foot::in_plane(&corners, 1.0).map_or(0.0, |foot| foot.distance)
                }
            };
            let is_below = height < 0.0 && !obstacle.closed;
            let distance = match &foot {
                Some(_) if is_below => -height,
                Some(_) => height,
                None => f64::NEG_INFINITY,
            };
            if distance < node.radius + clearance {
                let pair = CandidatePair {
                    start: start as u32,
                    side: if is_below { BELOW } else { ABOVE },
                    edges: [node.edge, surface.edges().len() + region.first],
                    nodes: surface.faces()[start].with(node.node),
                };
                found.push((pair, distance));
            }
        }
    }

    fn pair_of_edges(
        &self,
        surface: &ContactSurface,
        edge: usize,
        segment: usize,
    ) -> CandidatePair {
        let other = self.first_edge + segment;
        let ([a, b], [c, d]) = (surface.edges()[edge].nodes, surface.edges()[other].nodes);
        CandidatePair {
            edges: [edge, other],
            nodes: [a, b, c, d],
            side: EDGE,
            start: 0,
        }
    }

    fn pair_in_tube(&self, surface: &ContactSurface, node: &ContactNode) -> CandidatePair {
        let [a, b] = surface.edges()[self.first_edge].nodes;
        CandidatePair {
            edges: [node.edge, self.first_edge],
            nodes: [node.node, node.node, a, b],
            side: TUBE,
            start: 0,
        }
    }

    /// All pairs of a rod and a rim of the tube.
    fn pairs_at_rims<'a>(
        &self,
        surface: &'a ContactSurface,
        pieces: &'a [RodPiece],
    ) -> impl Iterator<Item = CandidatePair> + use<'a> {
        let tube = self.first_edge;
        let pieces = pieces
            .iter()
            .map(|piece| (piece.edge, piece.nodes, piece.side));
        let nodes = surface.nodes().iter();
        let nodes = nodes.filter(move |node| !surface.is_ball(node.edge));
        let nodes = nodes.map(|node| (node.edge, [node.node; 3], RIM_NODE));
        let ends = surface.edges()[tube].nodes;
        pieces
            .chain(nodes)
            .flat_map(move |(edge, [a, b, c], side)| {
                ends.map(|end| CandidatePair {
                    edges: [edge, tube],
                    nodes: [a, b, c, end],
                    side,
                    start: 0,
                })
            })
    }

    /// Adds the pieces of rods that are near a rim of the tube, on either side of it.
    fn find_at_rims(
        &self,
        surface: &ContactSurface,
        pieces: &[RodPiece],
        points: &Points,
        clearance: f64,
        found: &mut Vec<(CandidatePair, f64)>,
    ) {
        for pair in self.pairs_at_rims(surface, pieces) {
            let rim = surface.rim_of(&pair, points);
            let point = RimPoint::nearest(pair.side, &points.of(pair.nodes), &rim);
            if point.distance() < surface.threshold(pair.edges) + clearance {
                found.push((pair, point.distance()));
            }
        }
    }

    /// Adds the nodes in a tube that are near its wall. Nodes outside do not touch the wall.
    fn find_in_tube(
        &self,
        surface: &ContactSurface,
        number: usize,
        points: &Points,
        clearance: f64,
        found: &mut Vec<(CandidatePair, f64)>,
    ) {
        let tube = &surface.obstacles()[number];
        for node in surface.nodes() {
            if surface.roots.free_node(node.node, number) {
                continue;
            }
            let pair = self.pair_in_tube(surface, node);
            let Some(closest) = ClosestPoints::within_tube(&points.of(pair.nodes)) else {
                continue;
            };
            let distance = closest.distance() + tube.radius;
            if 0.0 < distance && distance < node.radius + clearance {
                found.push((pair, distance));
            }
        }
    }
}

/// The smooth parts of an obstacle whose faces are numbered from `first_face`.
fn regions_of(obstacle: &RigidBody, first_face: usize) -> Vec<Region> {
    let Some(smooth) = &obstacle.smooth else {
        return Vec::new();
    };
    let mut faces: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (face, region) in smooth.regions.iter().enumerate() {
        faces.entry(*region).or_default().push(face);
    }
    let of_region = |(first, faces): (u32, Vec<usize>)| {
        let boxes = faces.iter().map(|face| {
            let corners = obstacle.faces[*face].iter();
            AlignedBox::around(corners.map(|corner| obstacle.vertices[*corner]), 0.0)
        });
        let bulges = faces.iter().map(|face| obstacle.bulge_of(*face));
        Region {
            first: first_face + first as usize,
            tree: BoxTree::new(boxes),
            bulge: bulges.fold(0.0, f64::max),
            faces,
        }
    };
    faces.into_iter().map(of_region).collect()
}

fn pair_with_face(
    surface: &ContactSurface,
    [edge, face]: [usize; 2],
    node: usize,
    side: i8,
) -> CandidatePair {
    CandidatePair {
        edges: [edge, surface.edges().len() + face],
        nodes: ContactFace::with(&surface.faces()[face], node),
        side,
        start: 0,
    }
}

/// Distance of a node from a triangle with the foot in its plane, m.
fn distance_from_face([node, a, b, c]: &[Vector3; 4], foot: &Foot) -> f64 {
    if foot.weights.iter().all(|weight| *weight >= 0.0) {
        return foot.distance.abs();
    }
    let sides = [[a, b], [b, c], [c, a]].map(|[from, to]| {
        let side = to - from;
        let along = (node - from).dot(&side) / side.norm_squared();
        (node - from - side * along.clamp(0.0, 1.0)).norm()
    });
    sides.into_iter().fold(f64::INFINITY, f64::min)
}
