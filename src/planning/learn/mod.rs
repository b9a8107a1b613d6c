//! Learning from arrays: samples, networks, training, and models in files.
//!
//! | file | what |
//! |---|---|
//! | `samples` | rows of inputs and outputs, from CSV |
//! | `scaling` | standardisation |
//! | `network` | the multilayer perceptron |
//! | `processor` | what a network is trained on |
//! | `training` | how its error is made small |
//! | `trainer` | a training that can be interrupted |
//! | `model` | a network with what is needed to use it, and its file |
//! | `directory` | what a training leaves, and how it goes on |
//! | `loss_figure` | how the error fell |
//! | `evaluation` | errors of a model |
//!
//! Nothing here knows what the numbers mean.

mod directory;
mod evaluation;
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
pub use model::{About, Model, ModelError, read_model};
pub use network::Network;
pub use processor::Processor;
pub use samples::{Samples, SamplesError};
pub use scaling::Scaling;
pub use trainer::{FEWEST_SAMPLES, Standing, Trainer};
pub use training::{Decay, Epoch, Method, Phase, Plan, Schedule};
