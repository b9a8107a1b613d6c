//! Plans of gripper motions that lay a rod or fold a sheet.

pub mod deployment;
pub mod files;
pub mod fold;
mod fold_figures;
pub mod fold_request;
pub mod grasp;
pub mod pattern;
pub mod remedy;
pub mod request;
pub mod tying;
