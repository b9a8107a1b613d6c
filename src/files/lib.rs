//! Input and output of files: results directories with their marks, triangle meshes, figures of
//! curves and rows, and checks of input files.
//!
//! | module | content |
//! |---|---|
//! | [`results`] | results directories, checkpoints, VTK |
//! | [`figure`] | pictures of plain curves and rows |
//! | [`mesh`] | triangle meshes in files: STL, OBJ |
//! | [`finite`] | checks of numbers in files |
//! | [`input`] | checks of files: their size, the depth of XML |
//! | [`origin`] | version and commit of the program |

// Tests compare with a tolerance, so they may use any mathematical library.
#![cfg_attr(test, allow(clippy::disallowed_methods))]

pub mod figure;
pub mod finite;
pub mod input;
pub mod mesh;
pub mod origin;
pub mod results;
