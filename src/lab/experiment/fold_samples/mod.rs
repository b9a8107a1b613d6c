//! Folds of a sheet at many positions of the gripper: samples from which a network learns the
//! force manifold (thesis 4.3.3).

mod figure;
mod files;
mod keys;
mod kind;
mod lifted_sheet;
mod places;
mod row;
mod samples;
#[cfg(test)]
mod tests;

pub use kind::FOLD_SAMPLES;
