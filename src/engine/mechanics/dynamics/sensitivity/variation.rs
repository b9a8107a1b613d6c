//! A parameter as two scenes.

use crate::mechanics::scene::Scene;

/// A parameter of a scene, as the two scenes in which it is changed a little.
#[derive(Clone, Debug)]
pub struct Variation {
    /// The scene with p + ε and the one with p − ε. They differ from that of p in numbers alone: the same rods, nodes, clamps and loads.
    pub scenes: [Scene; 2],
    /// ε, in the unit of the parameter; about 2e-5 of its size.
    pub step: f64,
}
