//! Learning from arrays: samples, networks, training, and models in files.
//!
//! The module does not depend on the meaning of the numbers.

mod adam;
mod directory;
mod evaluation;
mod layer;
mod loss_figure;
mod model;
mod network;
mod processor;
mod samples;
mod scaling;
#[cfg(test)]
mod tests;
mod trainer;
mod training;

pub use directory::{Status, Task, Trained, TrainingError, train};
pub use evaluation::{Compared, Errors, error_figure, evaluate};
pub use model::{About, Model, ModelError, ModelFault, read_model};
pub use network::Network;
pub use processor::Processor;
pub use samples::{Samples, SamplesError};
pub use scaling::Scaling;
pub use trainer::{FEWEST_SAMPLES, Standing, Trainer};
pub use training::{Decay, Epoch, Method, Phase, Plan, Schedule};
