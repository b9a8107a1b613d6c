//! `rodlab`: a laboratory for slender elastic rods.
//!
//! A scenario file (TOML) goes in; the implicit rod engine runs it; a results directory comes out. A heavy cantilever:
//!
//! ```
//! use rodlab::{experiment::{from_text, prepare}, mechanics::dynamics::Simulation};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let loaded = from_text("cantilever", r#"
//!     experiment = "scene"
//!     material = { youngs_modulus = "100 MPa", poissons_ratio = 0.5, density = 1000.0 }
//!     time = { mode = "static" }
//!     rods = [{ name = "beam", radius = "5 mm", edges = 50, shape = { kind = "straight", start = [0, 0, 0], end = [1, 0, 0] } }]
//!     clamps = [{ rod = "beam", at = "start" }]
//!     loads = [{ kind = "gravity", acceleration = [0, 0, -9.81] }]
//! "#, ".".as_ref(), &[])?;
//! let prepared = prepare(&loaded.scenario)?;
//! let mut simulation = Simulation::new(&prepared.scene, &prepared.integration)?;
//! simulation.find_equilibrium()?;
//! let tip = simulation.positions()[50];
//! assert!(tip.z < -0.7 && tip.x > 0.0);   // it hangs down steeply
//! # Ok(())
//! # }
//! ```
//!
//! The [`guide`] has a page per topic, from [a first run](guide::getting_started) to
//! [using the library](guide::library). The rooms, and who may import whom (an arrow means "may import", and what those
//! may import, too):
//!
//! ```text
//! cli            ──> sweep, verify, reproduce, task, virtual_cell, guide, cluster
//! task           ──> cell, report
//! sweep, verify  ──> experiment
//! reproduce      ──> report, task, virtual_cell
//! report         ──> experiment
//! experiment     ──> run, knot, plan, scenario, figure
//! run            ──> mechanics, results
//! knot           ──> mechanics
//! plan           ──> mechanics, learn
//! learn          ──> results, figure
//! mechanics      ──> linalg
//! virtual_cell   ──> cell, experiment
//! cell           ──> robot, vision, scenario, figure
//! vision         ──> figure
//! robot, scenario ──> mesh
//! mesh, results, figure ──> finite, input
//! ```
//!
//! | room | what lives there |
//! |---|---|
//! | [`cli`] | one file per subcommand: parse, call one library function, print |
//! | [`guide`] | the guide's pages, here and in `rodlab guide` |
//! | [`scenario`] | the TOML schema as Rust types, units, validation with source positions |
//! | [`experiment`] | one folder per kind of experiment: its keys, scene, observers, figures; the list of kinds |
//! | [`run`] | the run loop on a results directory |
//! | [`sweep`], [`verify`], [`reproduce`] | many cases; physics checks; tables and figures of the thesis |
//! | [`report`] | figures and pages of a results directory |
//! | [`knot`] | knots from parameters, the knot determinant, theory of tightening |
//! | [`learn`] | samples, networks, training, models in files |
//! | [`plan`] | patterns, optimal grasps, trajectories of a gripper |
//! | [`mechanics`] | rods, contact, fluid, time stepping, equilibria |
//! | [`linalg`] | banded and sparse factorisations |
//! | [`robot`] | kinematic chains, inverse kinematics, joint paths, time, drivers |
//! | [`cell`] | a robot cell from its file: arms, axes, table, camera, drivers |
//! | [`task`] | tasks of the cell: a rod laid along a pattern, a knot tied, a sheet folded, looked at and scored |
//! | [`virtual_cell`] | the same cell simulated, with a rod or a sheet, behind the protocol of real ones |
//! | [`results`] | results directories, checkpoints, VTK |
//! | [`cluster`] | Slurm job arrays |
//! | [`figure`] | pictures of plain curves and rows |
//! | [`mesh`] | triangle meshes in files: STL, OBJ |
//! | [`finite`] | the gate for numbers in files |
//! | [`input`] | the gate for files: their size, the depth of XML |
//! | [`vision`] | images → centrelines in pixels and metres, cameras, scores |
//!
//! Inside [`mechanics`], [`rod`](mechanics::rod), [`contact`](mechanics::contact) and
//! [`fluid`](mechanics::fluid) do not know each other; [`system`](mechanics::system) adds their forces up into one
//! residual, which [`dynamics`](mechanics::dynamics) steps in time and [`statics`](mechanics::statics) brings to
//! rest. The time step loop is [`mechanics::dynamics::Simulation::advance`]. `tests/architecture` holds the
//! direction of imports.
//!
//! All quantities are in SI units unless a name says otherwise.

// Tests compare with a tolerance, and may ask any mathematical library.
#![cfg_attr(test, allow(clippy::disallowed_methods))]

pub mod cell;
pub mod cli;
pub mod cluster;
pub mod experiment;
pub mod figure;
pub mod finite;
pub mod guide;
pub mod input;
pub mod knot;
pub mod learn;
pub mod linalg;
pub mod mechanics;
pub mod mesh;
pub mod plan;
pub mod report;
pub mod reproduce;
pub mod results;
pub mod robot;
pub mod run;
pub mod scenario;
pub mod sweep;
pub mod task;
pub mod verify;
pub mod virtual_cell;
pub mod vision;
