//! Scenarios as models for other simulators. Each format lists what its model does not contain, and
//! refuses scenes of which a model would be another scene.

mod left_out;
mod mjcf;
mod newton;
mod refusals;
mod scene_model;
mod surroundings;

pub use mjcf::mjcf;
pub use newton::newton;
pub use scene_model::SceneModel;
