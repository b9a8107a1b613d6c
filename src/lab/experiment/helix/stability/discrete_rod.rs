//! The clamped rod, either on a helix or straight. The end of a straight rod is moved to that of a
//! helix.

use super::keys::HelixStability;
use nalgebra::Rotation3;
use rodlab_engine::mechanics::dynamics::Simulation;
use rodlab_engine::mechanics::kirchhoff::Helix;
use rodlab_engine::mechanics::rod::transport::{parallel_transport, rotated};
use rodlab_engine::mechanics::scene::{
    Clamp, Motion, NaturalShape, RodDescription, Scene, Stiffness,
};
use rodlab_engine::mechanics::{Matrix3, UnitQuaternion, Vector3};

/// Radius, m. EA = 4 EI/h² makes the rod practically inextensible: forces of 100 EI/L² stretch it
/// by 2.5e-5.
const RADIUS: f64 = 1e-3;
/// Index of the clamp at the end.
pub const END: usize = 1;

/// A rod of unit length as a chain of edges. The stability of the rod does not depend on the two
/// stiffnesses.
#[derive(Clone, Copy, Debug)]
pub struct DiscreteRod {
    /// Number of edges.
    pub edges: usize,
    /// GJ/EI.
    pub stiffness_ratio: f64,
    /// EI, N m².
    pub bending_stiffness: f64,
}

/// The scene of the first direction, as an example of the runs: a rod at distance 1.
pub fn first_scene(plan: &HelixStability) -> Scene {
    let rod = DiscreteRod {
        edges: plan.edges,
        stiffness_ratio: plan.stiffness_ratio,
        bending_stiffness: 1.0,
    };
    let directions = plan.directions.unit_vectors();
    directions.first().map_or_else(Scene::default, |direction| {
        rod.on_helix(&Helix::from(*direction))
    })
}

impl DiscreteRod {
    /// The rod with half as many edges.
    pub fn coarsened(&self) -> Self {
        Self {
            edges: self.edges / 2,
            ..*self
        }
    }

    /// The rod with its nodes on the helix, clamped at both ends.
    ///
    /// The tension stretches the edges. They are evenly twisted by ω/GJ.
    pub fn on_helix(&self, helix: &Helix) -> Scene {
        let centreline: Vec<Vector3> = (0..=self.edges)
            .map(|k| helix.position(k as f64 / self.edges as f64))
            .collect();
        let natural_length = (centreline[1] - centreline[0]).norm() / self.stretch(helix);
        let tangents = [0.0, 1.0].map(|end| helix.tangent(end));
        // The twist acts from the middle of the first edge to the middle of the last.
        let part = (self.edges - 1) as f64 / self.edges as f64;
        let twist = helix.twisting_moment / self.stiffness_ratio * part;
        self.clamped(centreline, tangents, natural_length, twist)
    }

    /// The rod, straight along x and untwisted, clamped at both ends.
    pub fn straight(&self) -> Scene {
        let edge = 1.0 / self.edges as f64;
        let centreline = (0..=self.edges)
            .map(|k| k as f64 * edge * Vector3::x())
            .collect();
        self.clamped(centreline, [Vector3::x(); 2], edge, 0.0)
    }

    /// Motion of the end of the straight rod to the end of a helix.
    ///
    /// The nodes lie on an enlarged helix, whose chords have the length of the edges with their
    /// stretch by the tension. The end is rotated for an even twist ω/GJ along this polygon, which
    /// differs slightly from the rotation of the smooth helix.
    pub fn end_on_helix(&self, helix: &Helix) -> Motion {
        let edge = 1.0 / self.edges as f64;
        let edges = (0..self.edges).map(|k| {
            let [from, to] = [k, k + 1].map(|node| helix.position(node as f64 * edge));
            (to - from).normalize()
        });
        let end = helix.tangent(1.0).normalize();
        let (mut tangent, mut director) = (Vector3::x(), Vector3::y());
        for next in edges.chain([end]) {
            director = parallel_transport(&director, &tangent, &next);
            tangent = next;
        }
        let director = rotated(
            &director,
            &end,
            helix.twisting_moment / self.stiffness_ratio,
        );
        let frame = Matrix3::from_columns(&[end, director, end.cross(&director)]);
        Motion {
            translation: vec![(
                0.0,
                self.enlargement(helix) * helix.position(1.0) - Vector3::x(),
            )],
            orientation: vec![(
                0.0,
                UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(frame)),
            )],
            ..Motion::default()
        }
    }

    /// Factor of the enlarged helix on which the rod's edges fit.
    pub fn enlargement(&self, helix: &Helix) -> f64 {
        let edge = 1.0 / self.edges as f64;
        self.stretch(helix) * edge / helix.position(edge).norm()
    }

    /// Length of the edges over their natural length under the tension n·t = (ω − τ) τ.
    fn stretch(&self, helix: &Helix) -> f64 {
        let tension = (helix.twisting_moment - helix.torsion) * helix.torsion;
        1.0 + tension * self.bending_stiffness / self.stiffness().stretching
    }

    fn stiffness(&self) -> Stiffness {
        Stiffness {
            stretching: 4.0 * self.bending_stiffness / (RADIUS * RADIUS),
            bending: [self.bending_stiffness; 2],
            twisting: self.stiffness_ratio * self.bending_stiffness,
        }
    }

    fn clamped(
        &self,
        centreline: Vec<Vector3>,
        tangents: [Vector3; 2],
        natural_length: f64,
        twist: f64,
    ) -> Scene {
        let natural = (0..=self.edges)
            .map(|k| k as f64 * natural_length * Vector3::x())
            .collect();
        let clamp = |node| Clamp {
            rod: 0,
            node,
            holds_position: true,
            holds_frame: true,
            motion: Motion::default(),
        };
        Scene {
            rods: vec![RodDescription {
                end_tangents: tangents.map(Some),
                twist,
                natural_shape: NaturalShape::Centreline(natural),
                ..RodDescription::uniform("helix", centreline, self.stiffness(), RADIUS, 1.0)
            }],
            clamps: vec![clamp(0), clamp(self.edges)],
            ..Scene::default()
        }
    }
}

/// Largest distance of a node from its place on a helix enlarged by a factor.
pub fn deviation(simulation: &Simulation, helix: &Helix, enlargement: f64) -> f64 {
    let nodes = simulation.positions();
    let edges = (nodes.len() - 1) as f64;
    let distances = nodes
        .iter()
        .enumerate()
        .map(|(k, node)| (node - enlargement * helix.position(k as f64 / edges)).norm());
    distances.fold(0.0, f64::max)
}
