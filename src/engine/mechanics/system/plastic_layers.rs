//! Layers of the section of a vertex that yield one after another; [`super::plasticity`] derives their law.

use super::virtual_work::OF_VERTEX;
use crate::mechanics::rod::Vertex;
use crate::mechanics::rod::vertex::VertexStrains;
use crate::mechanics::scene::{Layer, PlasticBending, Yielding};

/// C of a vertex, N m.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tangent {
    /// Of κ¹ and κ² in the frame of each edge: the entries 11, 12 and 22.
    bending: [[f64; 3]; 2],
    twisting: f64,
    /// Whether any layer yields.
    pub yields: bool,
}

impl Tangent {
    /// C ε.
    pub(super) fn times(&self, strains: &[f64; OF_VERTEX]) -> [f64; OF_VERTEX] {
        let [k0, k1, k2, k3, twist] = *strains;
        let [before, after] = &self.bending;
        [
            before[0] * k0 + before[1] * k1,
            before[1] * k0 + before[2] * k1,
            after[0] * k2 + after[1] * k3,
            after[1] * k2 + after[2] * k3,
            self.twisting * twist,
        ]
    }
}

/// Strains to which a layer belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Strains {
    /// κ¹ and κ² in the frame of an edge.
    Bending(usize),
    /// One of κ¹⁰, κ²⁰, κ¹¹, κ²¹.
    Component(usize),
    /// τ.
    Twist,
}

/// A layer of a vertex.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlasticLayer {
    pub strains: Strains,
    /// K c, N m.
    pub stiffness: f64,
    /// c.
    share: f64,
    /// ε_y, rad.
    limit: f64,
    /// pₙ and p, rad; without a second component if there is one strain.
    pub start: [f64; 2],
    pub plastic: [f64; 2],
}

impl PlasticLayer {
    /// The strains of the layer among those of a vertex.
    pub(super) fn strain(&self, strains: &VertexStrains) -> [f64; 2] {
        let curvature = &strains.curvature;
        match self.strains {
            Strains::Bending(frame) => [curvature[2 * frame], curvature[2 * frame + 1]],
            Strains::Component(component) => [curvature[component], 0.0],
            Strains::Twist => [strains.twist, 0.0],
        }
    }

    /// Returns p to the surface of yielding, and adds C to that of the vertex.
    pub(super) fn flow(&mut self, strain: [f64; 2], tangent: &mut Tangent) {
        let trial = [strain[0] - self.start[0], strain[1] - self.start[1]];
        let size = (trial[0] * trial[0] + trial[1] * trial[1]).sqrt();
        if size <= self.limit {
            self.plastic = self.start;
            return;
        }
        let ratio = self.limit / size;
        self.plastic = std::array::from_fn(|k| strain[k] - ratio * trial[k]);
        tangent.yields = true;
        let normal = trial.map(|own| own / size);
        let across = self.stiffness * (1.0 - ratio);
        let along = self.stiffness - across;
        match self.strains {
            Strains::Bending(frame) => {
                let own = &mut tangent.bending[frame];
                own[0] -= across + along * normal[0] * normal[0];
                own[1] -= along * normal[0] * normal[1];
                own[2] -= across + along * normal[1] * normal[1];
            }
            Strains::Component(component) => {
                tangent.bending[component / 2][2 * (component % 2)] -= self.stiffness;
            }
            Strains::Twist => tangent.twisting -= self.stiffness,
        }
    }

    /// Adds c p to natural strains.
    pub(super) fn bend(&self, natural: &mut VertexStrains) {
        let [first, second] = self.plastic.map(|plastic| self.share * plastic);
        match self.strains {
            Strains::Bending(frame) => {
                natural.curvature[2 * frame] += first;
                natural.curvature[2 * frame + 1] += second;
            }
            Strains::Component(component) => natural.curvature[component] += first,
            Strains::Twist => natural.twist += first,
        }
    }

    /// K c ε_y |p − pₙ|, J.
    pub(super) fn loss(&self) -> f64 {
        let [first, second] = [0, 1].map(|k| self.plastic[k] - self.start[k]);
        self.stiffness * self.limit * (first * first + second * second).sqrt()
    }
}

/// Adds the layers of a vertex of a rod with the stiffnesses EI₁, EI₂, GJ.
pub(super) fn list_layers(
    layers: &mut Vec<PlasticLayer>,
    law: &Yielding,
    [bending_1, bending_2, twisting]: [f64; 3],
    vertex: &Vertex,
) {
    let mut add = |own: &[Layer], strains: Strains, stiffness: f64, length: f64| {
        layers.extend(own.iter().map(|layer| PlasticLayer {
            strains,
            stiffness: stiffness * layer.share,
            share: layer.share,
            limit: layer.limit * length,
            start: [0.0; 2],
            plastic: [0.0; 2],
        }));
    };
    // The lengths over which strains are curvatures: those in the stiffness EI/2l̄ and GJ/l̄.
    let [along_1, along_2] = vertex.stiffness.bending;
    for frame in 0..2 {
        match &law.bending {
            PlasticBending::Round(own) => {
                let length = 0.5 * bending_2 / along_1;
                add(own, Strains::Bending(frame), along_1, length);
            }
            PlasticBending::AboutDirectors([about_1, about_2]) => {
                let first = Strains::Component(2 * frame);
                add(about_2, first, along_1, 0.5 * bending_2 / along_1);
                let second = Strains::Component(2 * frame + 1);
                add(about_1, second, along_2, 0.5 * bending_1 / along_2);
            }
        }
    }
    let stiffness = vertex.stiffness.twisting;
    add(
        &law.twisting,
        Strains::Twist,
        stiffness,
        twisting / stiffness,
    );
}
