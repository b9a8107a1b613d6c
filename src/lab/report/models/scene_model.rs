//! A model for another simulator.

/// A model for another simulator.
#[derive(Clone, Debug)]
pub struct SceneModel {
    /// The file.
    pub text: String,
    /// What the file does not contain, a phrase each.
    pub left_out: Vec<String>,
}
