//! Implicit dynamics of slender elastic rods: discrete elastic rods, frictional contact, Stokes flow.
//!
// Tests compare with a tolerance, and may ask any mathematical library.
#![cfg_attr(test, allow(clippy::disallowed_methods))]

pub mod linalg;
pub mod mechanics;
