//! Rods that yield in bending and twisting.
//!
//! The section of a vertex is a sum of layers ([`crate::mechanics::scene::Yielding`]): shares c of
//! the stiffness K of its strains ε, which carry K c (ε − p) and have a plastic strain p. In a step
//! from pₙ, p follows from the *incremental potential*, whose minimum over p is
//!
//! ```text
//! ψ(ε) = min Σ ½ K c |ε − p|² + K c ε_y |p − pₙ|
//! p = pₙ                      if |ε − pₙ| ≤ ε_y, else
//! p = ε − ε_y n,              n = (ε − pₙ)/|ε − pₙ|
//! ```
//!
//! (radial return; Simo and Hughes 1998, Sec. 3.3). ψ is convex, and its gradient K (ε − Σ c p) is
//! that of an elastic section with other natural strains. So a vertex has, at each evaluation, the
//! natural strains Σ c p of its layers, and forces and the stiffness by geometry are those of
//! [`crate::mechanics::rod`]. The remaining part of the Hessian is Bᵀ C B with B = ∂ε/∂q and, for
//! each layer that yields,
//!
//! ```text
//! C = −K c n⊗n − K c (1 − ε_y/|ε − pₙ|) (1 − n⊗n)
//! ```
//!
//! The two frames of a vertex have half the stiffness and plastic strains each. Energy in equilibria
//! is ψ; in motions, p becomes pₙ at the end of a step, and K c ε_y |p − pₙ| is dissipated.

use super::System;
use super::build::Assembly;
use super::demand::Demand;
use super::newton_matrix::Entries;
use super::plastic_layers::{PlasticLayer, Strains, Tangent, list_layers};
use super::term::{Configuration, Kind, Term};
use super::virtual_work::OF_VERTEX as STRAINS;
use crate::linalg::{Element, ElementMatrix, HALF_BANDWIDTH};
use crate::mechanics::rod::vertex::VertexStrains;
use crate::mechanics::rod::{
    EdgeMotion, ElasticEnergy, ElasticRods, RodGeometry, VERTEX_UNKNOWNS, Vertex, VertexUnknowns,
};
use crate::mechanics::scene::{RodDescription, Scene, Yielding};
use crate::mechanics::{SceneError, Vector3};
use std::ops::Range;

const NO_MIDPOINT: SceneError = SceneError::Unsuitable(
    "rods that yield need time.scheme = \"implicit-euler\" or \"backward-differences\"",
);
const NO_PATH: SceneError = SceneError::Unsuitable(
    "rods that yield have no path of equilibria: their shape depends on earlier loads",
);
const NO_START: SceneError =
    SceneError::Unsuitable("rods that yield cannot start from the end of another run");
const NO_DAMPING: SceneError =
    SceneError::Unsuitable("rods that yield support neither viscosity nor relaxation");
const NO_ACTUATION: SceneError = SceneError::Unsuitable("rods that yield cannot be actuated");
const NO_SECTIONS: SceneError =
    SceneError::Unsuitable("rods that yield need the same section everywhere");
const NO_FRAMES: SceneError =
    SceneError::Unsuitable("rods that yield support no rigid joints, hinges and bodies");

/// Plastic strains of all rods that yield.
#[derive(Clone, Debug, Default)]
pub(crate) struct Plasticity {
    /// The law and the bending stiffnesses EI₁, EI₂ and the twisting stiffness GJ of each rod, N m²; `None` if
    /// it is elastic.
    laws: Vec<Option<(Yielding, [f64; 3])>>,
    /// Vertices of these rods.
    vertices: Vec<PlasticVertex>,
    /// Layers of all of these vertices.
    layers: Vec<PlasticLayer>,
}

/// A vertex of a rod that yields.
#[derive(Clone, Debug)]
struct PlasticVertex {
    /// Its index.
    index: usize,
    /// Its node, and whether its edges are those of clamps.
    place: (usize, [bool; 2]),
    /// Natural strains without plastic ones.
    natural: VertexStrains,
    /// Its layers.
    layers: Range<usize>,
    /// Its element in the term, if it closes a ring.
    element: Option<usize>,
    /// C, for κ¹⁰, κ²⁰, κ¹¹, κ²¹, τ.
    tangent: Tangent,
}

impl Plasticity {
    /// Whether all rods are elastic.
    pub(crate) fn is_empty(&self) -> bool {
        self.vertices.is_empty()
    }

    /// Lists the vertices of the rods that yield. Those that were there before keep their plastic
    /// strains.
    pub(super) fn place(&mut self, assembly: &Assembly) {
        if self.laws.iter().all(Option::is_none) {
            return;
        }
        let before = std::mem::take(&mut self.vertices);
        let old = std::mem::take(&mut self.layers);
        let rods = &assembly.rods;
        let mut closing = 0;
        for (index, vertex) in rods.vertices.iter().enumerate() {
            let (rod, _) = assembly.locate(vertex.before.min(vertex.after));
            let Some((law, stiffness)) = &self.laws[rod] else {
                continue;
            };
            let place = assembly.place_of(vertex);
            let first = self.layers.len();
            list_layers(&mut self.layers, law, *stiffness, vertex);
            if let Some(same) = before.iter().find(|earlier| earlier.place == place) {
                let kept = &old[same.layers.clone()];
                for (layer, kept) in self.layers[first..].iter_mut().zip(kept) {
                    (layer.start, layer.plastic) = (kept.start, kept.plastic);
                }
            }
            let closes = matches!(vertex.unknowns, VertexUnknowns::Closing { .. });
            self.vertices.push(PlasticVertex {
                index,
                place,
                natural: vertex.natural,
                layers: first..self.layers.len(),
                element: closes.then(|| {
                    closing += 1;
                    closing - 1
                }),
                tangent: Tangent::default(),
            });
        }
    }

    /// Restores the natural strains of the rods without plastic ones.
    pub(crate) fn withdraw(&self, rods: &mut ElasticRods) {
        for vertex in &self.vertices {
            rods.vertices[vertex.index].natural = vertex.natural;
        }
    }

    /// Lets the layers yield at the strains of the geometry, and sets the natural strains.
    fn flow(&mut self, rods: &mut ElasticRods, geometry: &mut RodGeometry) {
        for plastic in &mut self.vertices {
            let vertex = &mut rods.vertices[plastic.index];
            vertex.natural = plastic.natural;
            let strains = vertex.elastic_strains(&geometry.strains(plastic.index, vertex));
            plastic.tangent = Tangent::default();
            for layer in &mut self.layers[plastic.layers.clone()] {
                layer.flow(layer.strain(&strains), &mut plastic.tangent);
                layer.bend(&mut vertex.natural);
            }
        }
        geometry.take_natural_strains(rods);
    }

    /// Energy that yielding dissipates from the start of a step to the last evaluation, J.
    pub(crate) fn loss(&self) -> f64 {
        self.layers.iter().map(PlasticLayer::loss).sum()
    }

    /// ψ minus the energy of an elastic section with the same natural strains, of the vertices at some nodes.
    pub(super) fn energy_at(
        &self,
        rods: &ElasticRods,
        geometry: &RodGeometry,
        is_at: impl Fn(usize) -> bool,
    ) -> ElasticEnergy {
        let mut energy = ElasticEnergy::default();
        for plastic in self
            .vertices
            .iter()
            .filter(|plastic| is_at(plastic.place.0))
        {
            let vertex = &rods.vertices[plastic.index];
            let present = geometry.strains(plastic.index, vertex);
            let elastic = vertex.elastic_strains(&present);
            let without = Vertex {
                natural: plastic.natural,
                ..*vertex
            }
            .elastic_strains(&present);
            let [k_1, k_2] = vertex.stiffness.bending;
            // Σ ½ K c |ε − p|² with the part that stays elastic, and ½ K |ε − Σ c p|².
            let square = |strains: &VertexStrains| {
                let c = strains.curvature.map(|own| own * own);
                [
                    0.5 * (k_1 * (c[0] + c[2]) + k_2 * (c[1] + c[3])),
                    0.5 * vertex.stiffness.twisting * strains.twist * strains.twist,
                ]
            };
            let mut sum = [0, 1].map(|k| square(&without)[k] - square(&elastic)[k]);
            for layer in &self.layers[plastic.layers.clone()] {
                let strain = layer.strain(&without);
                let size = |own: [f64; 2]| own[0] * own[0] + own[1] * own[1];
                let carried = [0, 1].map(|k| strain[k] - layer.plastic[k]);
                let kind = usize::from(layer.strains == Strains::Twist);
                sum[kind] += 0.5 * layer.stiffness * (size(carried) - size(strain)) + layer.loss();
            }
            energy.bending += sum[0];
            energy.twisting += sum[1];
        }
        energy
    }
}

/// Derivatives ∂ε/∂q of the strains κ¹⁰, κ²⁰, κ¹¹, κ²¹, τ of a vertex with respect to its unknowns;
/// zero for those of a clamp.
fn strains_over_unknowns(
    vertex: &Vertex,
    index: usize,
    rods: &ElasticRods,
    geometry: &RodGeometry,
) -> [[f64; STRAINS]; VERTEX_UNKNOWNS] {
    let edges = [vertex.before, vertex.after];
    let frames = edges.map(|edge| &geometry.edges[edge]);
    let strains = geometry.strains(index, vertex);
    // Direction in which an unknown moves the ends of the edges, and whether it turns them.
    let motion = |edge: usize, change: f64, axis: usize, angle: f64| {
        if edges[edge] >= rods.nodes {
            return EdgeMotion::NONE;
        }
        let mut moved = Vector3::zeros();
        moved[axis] = change;
        EdgeMotion::new(frames[edge], &moved, angle)
    };
    std::array::from_fn(|unknown| {
        let [before, after] = match unknown {
            0..3 => [motion(0, -1.0, unknown, 0.0), EdgeMotion::NONE],
            3 => [motion(0, 0.0, 0, 1.0), EdgeMotion::NONE],
            4..7 => [
                motion(0, 1.0, unknown - 4, 0.0),
                motion(1, -1.0, unknown - 4, 0.0),
            ],
            7 => [EdgeMotion::NONE, motion(1, 0.0, 0, 1.0)],
            _ => [EdgeMotion::NONE, motion(1, 1.0, unknown - 8, 0.0)],
        };
        vertex.strains_along(frames, &strains, [&before, &after])
    })
}

/// Adds Bᵀ C B to the band or to the element of a vertex.
fn scatter(
    matrix: &[[f64; VERTEX_UNKNOWNS]; VERTEX_UNKNOWNS],
    unknowns: VertexUnknowns,
    columns: &mut [[f64; HALF_BANDWIDTH + 1]],
    element: Option<&mut ElementMatrix>,
) {
    match (unknowns, element) {
        (VertexUnknowns::Consecutive { first, from, to }, _) => {
            for j in from..to {
                let column = &mut columns[first + j - from];
                for i in j..to {
                    column[i - j] += matrix[i][j];
                }
            }
        }
        (_, Some(element)) => {
            for i in 0..VERTEX_UNKNOWNS {
                for j in 0..VERTEX_UNKNOWNS {
                    element[i][j] += matrix[i][j];
                }
            }
        }
        _ => unreachable!("rods with frames of joints do not yield"),
    }
}

impl Term for Plasticity {
    /// # Errors
    /// [`SceneError::Unsuitable`] for a rod that yields and is damped, actuated, joined by frames, or of several
    /// sections.
    fn new(scene: &Scene, assembly: &mut Assembly) -> Result<Self, SceneError> {
        let law_of = |rod: &RodDescription| {
            let [bending_1, bending_2] = rod.stiffness.bending;
            let law = rod.yielding.clone().filter(|_| !rod.held);
            law.map(|law| (law, [bending_1, bending_2, rod.stiffness.twisting]))
        };
        let mut plasticity = Self {
            laws: scene.rods.iter().map(law_of).collect(),
            ..Self::default()
        };
        for (number, rod) in scene.rods.iter().enumerate() {
            if plasticity.laws[number].is_none() {
                continue;
            }
            if rod.retardation_time > 0.0 || rod.relaxation.is_some() {
                return Err(NO_DAMPING);
            }
            if scene
                .actuations
                .iter()
                .any(|actuation| actuation.rod == number)
            {
                return Err(NO_ACTUATION);
            }
            if !rod.sections.is_empty() {
                return Err(NO_SECTIONS);
            }
        }
        plasticity.place(assembly);
        let turns = |plastic: &PlasticVertex| {
            let vertex = &assembly.rods.vertices[plastic.index];
            matches!(vertex.unknowns, VertexUnknowns::Turning { .. })
        };
        if plasticity.vertices.iter().any(turns) {
            return Err(NO_FRAMES);
        }
        Ok(plasticity)
    }

    fn kind(&self) -> Kind {
        Kind::Elastic
    }

    fn has_copies(&self) -> bool {
        self.is_empty()
    }

    /// Those of vertices that close rings.
    fn elements(&self, assembly: &Assembly) -> Vec<Element> {
        let closing = self.vertices.iter().filter_map(|plastic| {
            match assembly.rods.vertices[plastic.index].unknowns {
                VertexUnknowns::Closing { element } => Some(assembly.rods.elements[element]),
                _ => None,
            }
        });
        closing.collect()
    }

    fn energy(&self, assembly: &Assembly, geometry: &RodGeometry) -> ElasticEnergy {
        self.energy_at(&assembly.rods, geometry, |_| true)
    }

    /// The natural strains of the rods include the plastic ones; the term itself adds no forces.
    fn add_forces(&self, _: &Configuration, _: &mut [f64]) {}

    fn add_jacobian(&self, at: &Configuration, entries: &mut Entries) {
        let rods = &at.assembly.rods;
        for plastic in self
            .vertices
            .iter()
            .filter(|plastic| plastic.tangent.yields)
        {
            let vertex = &rods.vertices[plastic.index];
            let over = strains_over_unknowns(vertex, plastic.index, rods, at.geometry);
            let forces = over.map(|strains| plastic.tangent.times(&strains));
            let mut matrix = [[0.0; VERTEX_UNKNOWNS]; VERTEX_UNKNOWNS];
            for (row, force) in matrix.iter_mut().zip(&forces) {
                for (entry, strains) in row.iter_mut().zip(&over) {
                    *entry = force.iter().zip(strains).map(|(f, s)| f * s).sum();
                }
            }
            match plastic.element {
                Some(own) => {
                    let element = &mut entries.elements()[own];
                    scatter(&matrix, vertex.unknowns, &mut [], Some(element));
                }
                None => scatter(&matrix, vertex.unknowns, entries.columns(), None),
            }
        }
    }

    fn accept(&mut self, _: &Assembly, _: &RodGeometry) {
        for layer in &mut self.layers {
            layer.start = layer.plastic;
        }
    }

    /// pₙ of all layers.
    fn memory(&self) -> Vec<Vec<f64>> {
        if self.is_empty() {
            return Vec::new();
        }
        vec![self.layers.iter().flat_map(|layer| layer.start).collect()]
    }

    fn restore(&mut self, memory: &mut dyn Iterator<Item = Vec<f64>>) -> Result<(), &'static str> {
        if self.is_empty() {
            return Ok(());
        }
        let kept = memory.next().ok_or("plastic strains")?;
        if kept.len() != 2 * self.layers.len() {
            return Err("plastic strains");
        }
        for (layer, kept) in self.layers.iter_mut().zip(kept.chunks(2)) {
            layer.start = [kept[0], kept[1]];
        }
        Ok(())
    }

    fn refuses(&self, demand: Demand) -> Option<SceneError> {
        let reason = match demand {
            Demand::ImplicitMidpoint => NO_MIDPOINT,
            Demand::Path | Demand::NearbyEquilibrium => NO_PATH,
            Demand::Start => NO_START,
            _ => return None,
        };
        (!self.is_empty()).then_some(reason)
    }
}

impl System {
    /// Lets rods yield at the strains of the present geometry.
    pub(super) fn yield_rods(&mut self) {
        let plasticity = &mut self.terms.plasticity;
        if !plasticity.is_empty() {
            plasticity.flow(&mut self.assembly.rods, &mut self.geometry);
        }
    }

    /// Energy that yielding dissipates from the start of a step to the last evaluation, at its end, J.
    pub(crate) fn plastic_loss(&self) -> f64 {
        self.terms.plasticity.loss()
    }

    /// Whether any rod yields.
    pub(crate) fn yields(&self) -> bool {
        !self.terms.plasticity.is_empty()
    }
}
