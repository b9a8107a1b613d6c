//! The program and the library from outside, and rules for the whole repository. All tests are in
//! one binary, so that the library is linked only once. A new file in this folder needs a line
//! below.

#![allow(clippy::disallowed_methods)] // tests may call any mathematical library

mod architecture;
mod browser;
mod cli;
mod cluster;
mod continuation;
mod cross_sections;
mod deployment;
mod drawn_files;
mod exact_answers;
mod explained;
mod exploration;
mod export;
mod fold_in_cell;
mod folding;
mod fuzz;
mod guide;
mod helix_boundary;
mod identify;
mod incremental_potential;
mod knots;
mod language;
mod learning;
mod linking_number;
mod long_steps;
mod mathematical_library;
mod movie;
mod parts;
mod passing_through;
mod piles;
mod planted_faults;
mod probes;
mod random_scenes;
mod reference_trajectory;
mod robots;
mod rod_photographs;
mod schema;
mod sweep;
mod tie_in_cell;
mod view;
mod virtual_cell;
mod vision;
mod vision_measure;
mod vtk;
