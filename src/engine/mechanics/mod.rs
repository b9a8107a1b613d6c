//! The mechanics of slender rods.
//!
//! [`rod`], [`contact`] and [`fluid`] do not import each other; [`dynamics`] and [`statics`]
//! combine them. [`scene`] describes a simulation, in SI units and plain types.

pub mod contact;
pub mod dynamics;
mod error;
pub mod fluid;
pub mod kirchhoff;
mod piecewise;
pub mod rigid_body;
pub mod rod;
pub mod rotation;
pub mod scene;
pub mod statics;
pub mod system;
#[cfg(test)]
mod test_support;

pub use error::{JointError, LoadError, Overlap, RodError, SceneError};

/// A vector in space.
pub type Vector3 = nalgebra::Vector3<f64>;
/// A rotation in space.
pub type UnitQuaternion = nalgebra::UnitQuaternion<f64>;
/// A 3×3 matrix.
pub type Matrix3 = nalgebra::Matrix3<f64>;
