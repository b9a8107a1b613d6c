//! The natural shape of a rod whose equilibrium is given.
//!
//! The nodes x_j of the equilibrium are given, and so are all forces except the elastic ones of
//! this rod. The gradient of the energy of its vertices and edges with respect to the edge vectors
//! e_k and angles φ_k is
//!
//! ```text
//! q_k = EA (l/l̃ − 1) t_k + ∂E_k/∂e¹ + ∂E_{k+1}/∂e⁰,      0 = m_k + ∂E_k/∂φ¹ + ∂E_{k+1}/∂φ⁰
//! q_{j−1} − q_j = f_j
//! ```
//!
//! with the vertices k before and k + 1 after the edge k, the external force f_j on node j and
//! moment m_k on edge k. The force q_k in an edge follows from the last node by summation; its
//! part along t_k fixes the natural length l̃ of the edge. The gradient of a vertex is linear in
//! its natural curvatures and twist. Three equations of the edge k, two across t_k and one of
//! moments, fix the three strains of vertex k, from the last edge to the first: a recursion with a
//! 3×3 matrix for each node.
//!
//! A held last node adds the three components of its reaction to the unknowns, and a clamped one
//! those of its moment. A first node that is not held, and a first frame that is not clamped, must
//! be in balance by themselves: three equations each. Of all solutions, the one with the least
//! elastic energy in the given shape is returned.
//!
//! Weights and stiffnesses depend on natural lengths. So the residual of the scene with the
//! natural strains found so far is corrected in the same way until only rounding is left; each
//! correction multiplies it by about the largest stretching strain.

use crate::mechanics::rod::vertex::VertexStrains;
use crate::mechanics::rod::{RodRange, STRIDE, Vertex};
use crate::mechanics::scene::{NaturalShape, NaturalStrains, Scene};
use crate::mechanics::system::System;
use crate::mechanics::{Matrix3, SceneError, Vector3};
use nalgebra::{DMatrix, DVector, RowSVector, SMatrix, SVector};

/// Most corrections.
const CORRECTIONS: usize = 30;
/// Number of corrections without halving the residual after which only rounding is left.
const STALLED: usize = 3;
/// Number of corrections that minimise the elastic energy; later ones minimise the change.
const CHOSEN: usize = 2;
/// Residual that rounding may leave, relative to the largest force in the rod.
const TOLERANCE: f64 = 1e-9;
/// Columns: the known part, and the reaction and the moment at the last node.
const COLUMNS: usize = 7;
/// Singular values that count as zero, relative to the largest.
const SINGULAR: f64 = 1e-12;
/// Compressive strain beyond which no natural length exists.
const CRUSHED: f64 = -0.9;

type Affine = SMatrix<f64, 3, COLUMNS>;
type AffineRow = RowSVector<f64, COLUMNS>;

/// Reason why there is no natural shape.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DesignError {
    /// The scene is wrong.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The rod is not open, or is clamped at inner nodes.
    #[error("{0}")]
    Unsuitable(&'static str),
    /// The external forces are not in balance with reactions at the clamps.
    #[error(
        "no natural shape holds this curve: the external forces and moments on the rod are not in balance ({imbalance:.3e} N are left); clamp an end"
    )]
    Unbalanced {
        /// Force that is left, N.
        imbalance: f64,
    },
    /// An edge is compressed too much.
    #[error("edge {edge} would be compressed by {:.0} %; use a stiffer or shorter rod", -100.0 * strain)]
    Crushed {
        /// The edge.
        edge: usize,
        /// Strain of the edge.
        strain: f64,
    },
    /// The corrections leave a residual.
    #[error("the natural shape was not found: {residual:.3e} N of {force:.3e} N are not balanced")]
    NotFound {
        /// Largest residual, N.
        residual: f64,
        /// Largest force, N.
        force: f64,
    },
}

/// Natural strains with which the placed nodes are an equilibrium.
#[derive(Clone, Debug, PartialEq)]
pub struct Designed {
    /// The natural strains.
    pub natural: NaturalStrains,
    /// Largest residual of a free unknown of the rod, N; moments are divided by the length of the edge.
    pub residual: f64,
    /// Largest force in an edge, or external force on a node, N.
    pub force: f64,
    /// Largest absolute stretching strain.
    pub largest_strain: f64,
}

/// Finds the natural lengths, curvatures and twists of an open rod for which the placed nodes of
/// `scene` are an equilibrium. All other forces are those of the scene at time zero: loads,
/// springs and contact. The rod may be clamped at its ends.
///
/// # Errors
/// [`DesignError`]: an invalid scene, or a curve for which no natural shape exists.
pub fn natural_strains(scene: &Scene, rod: usize) -> Result<Designed, DesignError> {
    let description = &scene.rods[rod];
    let last = description.centreline.len().saturating_sub(1);
    let is_inner = |node: usize| node != 0 && node != last;
    if description.closed || description.held || last < 2 {
        return Err(DesignError::Unsuitable(
            "a natural shape is found for open rods of at least two edges that are not held",
        ));
    }
    if (scene.clamps.iter()).any(|clamp| clamp.rod == rod && is_inner(clamp.node)) {
        return Err(DesignError::Unsuitable(
            "a natural shape is found for rods that are clamped at their ends only",
        ));
    }
    if description.yielding.is_some() {
        return Err(DesignError::Unsuitable(
            "a natural shape is found for rods that do not yield",
        ));
    }
    let is_plain = scene.joints.is_empty()
        && scene.actuations.is_empty()
        && scene.tendons.is_empty()
        && scene.sheaths.is_empty()
        && scene.start.is_none();
    if !is_plain {
        return Err(DesignError::Unsuitable(
            "a natural shape is found for scenes without joints, actuation, tendons, sheaths and `start`",
        ));
    }
    let mut scene = scene.clone();
    let mut best: Option<Designed> = None;
    let mut stalled = 0;
    for correction in 0..CORRECTIONS {
        let mut system = System::new(&scene)?;
        let mut unknowns = system.assembly.unknowns.clone();
        system.drive(0.0, &mut unknowns);
        system.update_geometry(&unknowns);
        system.update_candidates(&unknowns);
        system.evaluate(&unknowns, None);
        let design = Design::new(&system, rod);
        let residual = design.largest_residual();
        let natural = design.natural();
        let is_better = best
            .as_ref()
            .is_none_or(|best: &Designed| residual < 0.5 * best.residual);
        let is_exact = matches!(&scene.rods[rod].natural_shape, NaturalShape::Strains(_));
        if !is_better && is_exact {
            stalled += 1;
        }
        if stalled == STALLED {
            break;
        }
        let corrected = design.corrected(&natural, correction < CHOSEN)?;
        if is_exact && is_better {
            best = Some(Designed {
                natural,
                residual,
                force: corrected.force,
                largest_strain: corrected.largest_strain,
            });
        }
        scene.rods[rod].pretension = 0.0;
        scene.rods[rod].natural_shape = NaturalShape::Strains(corrected.natural);
    }
    let best = best.expect("the second correction is of such strains");
    match best.residual <= TOLERANCE * best.force {
        true => Ok(best),
        false => Err(DesignError::NotFound {
            residual: best.residual,
            force: best.force,
        }),
    }
}

/// One correction.
struct Design<'a> {
    system: &'a System,
    range: RodRange,
    /// Vertex at each node; none at ends that are not clamped.
    vertices: Vec<Option<usize>>,
    /// Natural and present lengths of the edges, m.
    natural_lengths: Vec<f64>,
    lengths: Vec<f64>,
    stretching: f64,
    holds: [bool; 2],
}

/// Integrated natural strains as linear functions of the unknowns at the last node.
struct Recursion {
    /// Change of the natural curvatures and the twist of each vertex, rad.
    strains: Vec<Option<Affine>>,
    /// Change of the tension of each edge, N.
    tensions: Vec<AffineRow>,
    /// What must vanish, N.
    constraints: Vec<AffineRow>,
    force: f64,
}

struct Corrected {
    natural: NaturalStrains,
    force: f64,
    largest_strain: f64,
}

impl<'a> Design<'a> {
    fn new(system: &'a System, rod: usize) -> Self {
        let assembly = &system.assembly;
        let range = assembly.rods.rods[rod];
        let mut vertices = vec![None; range.nodes];
        let edges = range.edge_indices();
        for (index, vertex) in assembly.rods.vertices.iter().enumerate() {
            if edges.contains(&vertex.after) {
                vertices[vertex.after - range.first_node] = Some(index);
            } else if edges.contains(&vertex.before) {
                vertices[vertex.before - range.first_node + 1] = Some(index);
            }
        }
        let own = (assembly.rods.edges.iter()).filter(|edge| edges.contains(&edge.start));
        let natural_lengths: Vec<f64> = own.clone().map(|edge| edge.natural_length).collect();
        let lengths = own
            .clone()
            .map(|edge| system.geometry.edges[edge.start].length);
        Self {
            system,
            range,
            vertices,
            natural_lengths,
            lengths: lengths.collect(),
            stretching: own.map(|edge| edge.stretching).fold(0.0, f64::max),
            holds: [0, range.nodes - 1]
                .map(|node| assembly.held[STRIDE * (range.first_node + node)]),
        }
    }

    fn vertex(&self, node: usize) -> Option<&'a Vertex> {
        self.vertices[node].map(|index| &self.system.assembly.rods.vertices[index])
    }

    fn force_on(&self, node: usize) -> Vector3 {
        let first = STRIDE * (self.range.first_node + node);
        Vector3::from_column_slice(&self.system.residual[first..first + 3])
    }

    fn moment_on(&self, edge: usize) -> f64 {
        self.system.residual[STRIDE * (self.range.first_node + edge) + 3]
    }

    fn largest_residual(&self) -> f64 {
        let nodes = 0..self.range.nodes;
        let is_free = |node: &usize| {
            !(*node == 0 && self.holds[0] || *node + 1 == self.range.nodes && self.holds[1])
        };
        let forces = nodes.filter(is_free).map(|node| self.force_on(node).norm());
        let edges = 0..self.range.edges();
        let moments = edges.map(|edge| self.moment_on(edge).abs() / self.lengths[edge]);
        forces.chain(moments).fold(0.0, f64::max)
    }

    /// Voronoi length of a node, m; half an edge at ends.
    fn voronoi(&self, node: usize, lengths: &[f64]) -> f64 {
        let before = node.checked_sub(1).map_or(0.0, |edge| lengths[edge]);
        0.5 * (before + lengths.get(node).unwrap_or(&0.0))
    }

    /// The present natural strains, averaged over the frames of both edges.
    fn natural(&self) -> NaturalStrains {
        let of = |node: usize| {
            let [a, b, twist] = self.vertex(node).map_or([0.0; 3], |vertex| {
                mean_strains(&vertex.natural.curvature, vertex.natural.twist)
            });
            let voronoi = self.voronoi(node, &self.natural_lengths);
            ([a / voronoi, b / voronoi], twist / voronoi)
        };
        let (curvature, twist) = (0..self.range.nodes).map(of).unzip();
        NaturalStrains {
            lengths: self.natural_lengths.clone(),
            curvature,
            twist,
        }
    }

    /// Stiffness for the curvatures about both directors and for the twist, N m.
    fn stiffness(vertex: &Vertex) -> Vector3 {
        let [towards_1, towards_2] = vertex.stiffness.bending;
        Vector3::new(2.0 * towards_2, 2.0 * towards_1, vertex.stiffness.twisting)
    }

    /// Derivatives of the gradient of a vertex with respect to its natural strains: e⁰, φ⁰, e¹,
    /// φ¹.
    fn derivatives(&self, node: usize) -> Option<([Matrix3; 2], [Vector3; 2])> {
        let index = self.vertices[node]?;
        let vertex = &self.system.assembly.rods.vertices[index];
        let geometry = &self.system.geometry;
        let edges = [
            &geometry.edges[vertex.before],
            &geometry.edges[vertex.after],
        ];
        let strains = geometry.strains(index, vertex);
        let mut without = *vertex;
        without.natural = VertexStrains::default();
        let zero = without.gradient(edges, &strains);
        let (mut forces, mut moments) = ([Matrix3::zeros(); 2], [Vector3::zeros(); 2]);
        for strain in 0..3 {
            let mut unit = without;
            match strain {
                0 => unit.natural.curvature = [0.0, -1.0, 0.0, -1.0],
                1 => unit.natural.curvature = [1.0, 0.0, 1.0, 0.0],
                _ => unit.natural.twist = 1.0,
            }
            let one = unit.gradient(edges, &strains);
            forces[0].set_column(strain, &(one.e0 - zero.e0));
            forces[1].set_column(strain, &(one.e1 - zero.e1));
            moments[0][strain] = one.phi0 - zero.phi0;
            moments[1][strain] = one.phi1 - zero.phi1;
        }
        Some((forces, moments))
    }

    /// Runs from the last edge to the first.
    fn recursion(&self) -> Result<Recursion, DesignError> {
        let edges = self.range.edges();
        let length: f64 = self.lengths.iter().sum();
        let inner = self.vertex(1).expect("a rod of two edges");
        let softest = Self::stiffness(inner).min() * self.voronoi(1, &self.natural_lengths);
        let mut result = Recursion {
            strains: vec![None; edges + 1],
            tensions: vec![AffineRow::zeros(); edges],
            constraints: Vec::new(),
            // At a held node, adds the reaction.
            force: self.force_on(edges).norm(),
        };
        let mut force = Affine::zeros();
        if !self.holds[1] {
            force.set_column(0, &-self.force_on(edges));
        } else {
            for axis in 0..3 {
                force[(axis, 1 + axis)] = softest / (length * length);
            }
        }
        if let Some(ghost) = self.vertex(edges) {
            let mut strains = Affine::zeros();
            for (axis, stiffness) in Self::stiffness(ghost).iter().enumerate() {
                strains[(axis, 4 + axis)] = softest / (length * stiffness);
            }
            result.strains[edges] = Some(strains);
        }
        for edge in (0..edges).rev() {
            let frame = &self.system.geometry.edges[self.range.first_node + edge];
            let axes = Matrix3::from_columns(&[frame.director_1, frame.director_2, frame.tangent]);
            let mut missing = axes.transpose() * force;
            result.tensions[edge] = missing.row(2).into_owned();
            missing.row_mut(2).fill(0.0);
            missing[(2, 0)] = -self.moment_on(edge) / self.lengths[edge];
            if let (Some(strains), Some((forces, moments))) =
                (&result.strains[edge + 1], self.derivatives(edge + 1))
            {
                missing -= self.across(&axes, &forces[0], &moments[0], edge) * strains;
            }
            match self.derivatives(edge) {
                Some((forces, moments)) => {
                    let matrix = self.across(&axes, &forces[1], &moments[1], edge);
                    let solved = matrix.lu().solve(&missing);
                    result.strains[edge] = Some(solved.ok_or(DesignError::Unsuitable(
                        "the rod has no stiffness at a node, or turns back there",
                    ))?);
                }
                None => result
                    .constraints
                    .extend(missing.row_iter().map(|row| row.into_owned())),
            }
            let external = self.force_on(edge);
            result.force = result
                .force
                .max(force.column(0).norm())
                .max(external.norm());
            if edge > 0 || !self.holds[0] {
                for axis in 0..3 {
                    force[(axis, 0)] -= external[axis];
                }
            }
        }
        if !self.holds[0] {
            result
                .constraints
                .extend(force.row_iter().map(|row| row.into_owned()));
        }
        Ok(result)
    }

    /// Two rows across an edge, and a row of moments divided by its length.
    fn across(&self, axes: &Matrix3, forces: &Matrix3, moments: &Vector3, edge: usize) -> Matrix3 {
        let mut rows = axes.transpose() * forces;
        rows.set_row(2, &(moments / self.lengths[edge]).transpose());
        rows
    }

    fn corrected(
        &self,
        natural: &NaturalStrains,
        is_chosen: bool,
    ) -> Result<Corrected, DesignError> {
        let recursion = self.recursion()?;
        let values = self.least_energy(&recursion, is_chosen)?;
        let mut force = recursion.force;
        let mut largest_strain = 0.0_f64;
        let mut lengths = Vec::with_capacity(self.lengths.len());
        for (edge, row) in recursion.tensions.iter().enumerate() {
            let change = (row * values)[0];
            let tension = self.tension(edge) + change;
            force = force.max(tension.abs());
            let strain = tension / self.stretching;
            if strain.is_nan() || strain < CRUSHED {
                return Err(DesignError::Crushed { edge, strain });
            }
            largest_strain = largest_strain.max(strain.abs());
            lengths.push(self.lengths[edge] / (1.0 + strain));
        }
        let mut result = natural.clone();
        for (node, strains) in recursion.strains.iter().enumerate() {
            let Some(strains) = strains else { continue };
            let change = strains * values;
            let old = self.voronoi(node, &self.natural_lengths);
            let new = self.voronoi(node, &lengths);
            for axis in 0..2 {
                let curvature = &mut result.curvature[node][axis];
                *curvature = (*curvature * old + change[axis]) / new;
            }
            result.twist[node] = (result.twist[node] * old + change[2]) / new;
        }
        result.lengths = lengths;
        Ok(Corrected {
            natural: result,
            force,
            largest_strain,
        })
    }

    fn tension(&self, edge: usize) -> f64 {
        self.stretching * (self.lengths[edge] / self.natural_lengths[edge] - 1.0)
    }

    /// Values of the columns, the first of which is 1. They leave no imbalance and minimise the
    /// energy: with `is_total` that of the rod, otherwise that of the change.
    fn least_energy(
        &self,
        recursion: &Recursion,
        is_total: bool,
    ) -> Result<SVector<f64, COLUMNS>, DesignError> {
        let is_clamped = self.vertex(self.range.edges()).is_some();
        let unknown: Vec<usize> = (1..COLUMNS)
            .filter(|column| {
                if *column < 4 {
                    self.holds[1]
                } else {
                    is_clamped
                }
            })
            .collect();
        let count = unknown.len();
        let (mut hessian, mut gradient) = (DMatrix::zeros(count, count), DVector::zeros(count));
        let mut add = |row: AffineRow, weight: f64| {
            for (i, one) in unknown.iter().enumerate() {
                gradient[i] += weight * row[*one] * row[0];
                for (j, other) in unknown.iter().enumerate() {
                    hessian[(i, j)] += weight * row[*one] * row[*other];
                }
            }
        };
        for (node, strains) in recursion.strains.iter().enumerate() {
            let (Some(strains), Some(index)) = (strains, self.vertices[node]) else {
                continue;
            };
            let vertex = &self.system.assembly.rods.vertices[index];
            let present = vertex.elastic_strains(&self.system.geometry.strains(index, vertex));
            let present = mean_strains(&present.curvature, present.twist);
            for (axis, stiffness) in Self::stiffness(vertex).iter().enumerate() {
                let mut row = -strains.row(axis);
                if is_total {
                    row[0] += present[axis];
                }
                add(row, *stiffness);
            }
        }
        for (edge, row) in recursion.tensions.iter().enumerate() {
            let mut row = *row;
            if is_total {
                row[0] += self.tension(edge);
            }
            add(row, self.lengths[edge] / self.stretching);
        }
        let mut values = SVector::<f64, COLUMNS>::zeros();
        values[0] = 1.0;
        let rows = &recursion.constraints;
        if count > 0 {
            let scale = hessian.diagonal().max();
            let columns = rows
                .iter()
                .flat_map(|row| unknown.iter().map(|k| row[*k].abs()));
            let weight = match columns.fold(0.0, f64::max) {
                0.0 => 1.0,
                largest => scale / largest,
            };
            let size = count + rows.len();
            let mut matrix = DMatrix::zeros(size, size);
            let mut right = DVector::zeros(size);
            matrix.view_mut((0, 0), (count, count)).copy_from(&hessian);
            right.rows_mut(0, count).copy_from(&-gradient);
            for (index, row) in rows.iter().enumerate() {
                right[count + index] = -weight * row[0];
                for (i, column) in unknown.iter().enumerate() {
                    matrix[(count + index, i)] = weight * row[*column];
                    matrix[(i, count + index)] = weight * row[*column];
                }
            }
            let decomposed = matrix.svd(true, true);
            let least = SINGULAR * decomposed.singular_values.max();
            if let Ok(solved) = decomposed.solve(&right, least) {
                for (i, column) in unknown.iter().enumerate() {
                    values[*column] = solved[i];
                }
            }
        }
        let imbalance = rows.iter().map(|row| (row * values)[0].abs());
        let imbalance = imbalance.fold(0.0, f64::max);
        match imbalance <= TOLERANCE * recursion.force {
            true => Ok(values),
            false => Err(DesignError::Unbalanced { imbalance }),
        }
    }
}

/// Curvatures about both directors, averaged over the frames of both edges, and the twist.
fn mean_strains(curvature: &[f64; 4], twist: f64) -> [f64; 3] {
    [
        -0.5 * (curvature[1] + curvature[3]),
        0.5 * (curvature[0] + curvature[2]),
        twist,
    ]
}
