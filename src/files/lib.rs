//! Files in and out: results directories with their marks, triangle meshes, pictures of curves and rows, and the gates that foreign
//! files pass.
//!
//! | room | what lives there |
//! |---|---|
//! | [`results`] | results directories, checkpoints, VTK |
//! | [`figure`] | pictures of plain curves and rows |
//! | [`mesh`] | triangle meshes in files: STL, OBJ |
//! | [`finite`] | the gate for numbers in files |
//! | [`input`] | the gate for files: their size, the depth of XML |
//! | [`origin`] | which program writes |

// Tests compare with a tolerance, and may ask any mathematical library.
#![cfg_attr(test, allow(clippy::disallowed_methods))]

pub mod figure;
pub mod finite;
pub mod input;
pub mod mesh;
pub mod origin;
pub mod results;
