//! A parameter, represented by two scenes.

use crate::mechanics::scene::Scene;

/// A parameter of a scene, as the two scenes in which it is changed slightly.
#[derive(Clone, Debug)]
pub struct Variation {
    /// The scene with p + ε and the scene with p − ε. They differ from the scene with p in values
    /// only: the rods, nodes, clamps and loads are the same.
    pub scenes: [Scene; 2],
    /// ε, in the unit of the parameter; about 2e-5 of its size.
    pub step: f64,
}
