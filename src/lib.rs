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
//! [using the library](guide::library). The rooms, and the allowed imports (an arrow means "may import", and what those
//! may import, too):
//!
//! ```text
//! python         ──> cli
//! cli            ──> sweep, identify, sensitivity, design, verify, reproduce, task, live, recording, virtual_cell, guide, presets, site, cluster
//! task           ──> virtual_cell, report, identify
//! live           ──> task
//! design         ──> identify
//! sweep, identify, verify ──> sensitivity
//! sensitivity    ──> experiment
//! reproduce      ──> report, task, virtual_cell
//! report         ──> experiment
//! experiment     ──> run, knot, plan, scenario, figure
//! run            ──> mechanics, results
//! knot           ──> mechanics
//! plan           ──> mechanics, learn
//! learn          ──> results, figure
//! site           ──> guide, results, figure
//! mechanics      ──> linalg
//! recording      ──> cell
//! virtual_cell   ──> cell, experiment
//! cell           ──> robot, vision, scenario, figure
//! vision         ──> figure
//! linalg         ──> random
//! scenario       ──> mesh, random
//! robot          ──> mesh
//! mesh           ──> finite, input
//! results, figure ──> finite, input, origin
//! ```
//!
//! Each room is in a crate of the workspace, below `src`; this crate re-exports the rooms of all:
//!
//! ```text
//! rodlab            cli, guide, presets, site, verify, reproduce
//! rodlab-workcell   cell, virtual_cell, task, live, recording
//! rodlab-lab        scenario, experiment, run, sweep, identify, sensitivity, design, report,
//!                   cluster
//! rodlab-planning   knot, learn, plan
//! rodlab-engine     random, linalg, mechanics: a library of its own, without files and command line
//! rodlab-robot, rodlab-vision    a room each
//! rodlab-files      results, figure, mesh, finite, input, origin
//! ```
//!
//! The crate `rodlab-python` in `src/python` depends on all of them; it is the module `rodlab._rodlab` of the Python package
//! beside it.
//!
//! | room | contents |
//! |---|---|
//! | [`cli`] | one file per subcommand: parse, call one library function, print |
//! | [`guide`] | the guide's pages, here and in `rodlab guide` |
//! | [`presets`] | scenarios, rods, papers, cells and patterns that the program carries |
//! | [`site`] | the documentation as a web site |
//! | [`scenario`] | the TOML schema as Rust types, units, validation with source positions |
//! | [`experiment`] | one folder per kind of experiment: its keys, scene, observers, figures; the list of kinds |
//! | [`run`] | the run loop on a results directory |
//! | [`sweep`], [`verify`], [`reproduce`] | many cases; physics checks; tables and figures of the thesis |
//! | [`identify`] | keys of scenarios from measurements, with error bars |
//! | [`design`] | natural shapes, poses and loads for a target equilibrium |
//! | [`sensitivity`] | derivatives of what a scenario measures over its keys |
//! | [`report`] | figures and pages of a results directory |
//! | [`knot`] | knots from parameters, the knot determinant, theory of tightening |
//! | [`learn`] | samples, networks, training, models in files |
//! | [`plan`] | patterns, optimal grasps, trajectories of a gripper |
//! | [`mechanics`] | rods, contact, fluid, time stepping, equilibria |
//! | [`linalg`] | banded and sparse factorisations |
//! | [`random`] | repeatable random numbers, evenly spread points |
//! | [`robot`] | kinematic chains, inverse kinematics, joint paths, time, drivers |
//! | [`cell`] | a robot cell from its file: arms, axes, table, camera, drivers |
//! | [`task`] | tasks of the cell: a rod laid along a pattern, a knot tied, a sheet folded, seen and scored |
//! | [`live`] | the live page of a task in the browser |
//! | [`recording`] | the log of a task: its measured motion, and as an MCAP file |
//! | [`virtual_cell`] | the same cell simulated, with a rod or a sheet, behind the protocol of real ones |
//! | [`results`] | results directories, checkpoints, VTK |
//! | [`cluster`] | Slurm job arrays |
//! | [`figure`] | pictures of plain curves and rows |
//! | [`mesh`] | triangle meshes in files: STL, OBJ |
//! | [`finite`] | the gate for numbers in files |
//! | [`input`] | the gate for files: their size, the depth of XML |
//! | [`origin`] | the version and commit of the program, as files state them |
//! | [`vision`] | images → centrelines in pixels and metres, cameras, scores |
//!
//! Inside [`mechanics`], [`rod`](mechanics::rod), [`contact`](mechanics::contact) and
//! [`fluid`](mechanics::fluid) are independent of each other; [`system`](mechanics::system) adds their forces up into one
//! residual, which [`dynamics`](mechanics::dynamics) steps in time and [`statics`](mechanics::statics) brings to
//! rest. The time step loop is [`mechanics::dynamics::Simulation::advance`]. `tests/architecture` holds the
//! direction of imports.
//!
//! All quantities are in SI units unless a name states another unit.

// Tests compare with a tolerance, and may ask any mathematical library.
#![cfg_attr(test, allow(clippy::disallowed_methods))]

pub use rodlab_engine::{linalg, mechanics, random};
pub use rodlab_files::{figure, finite, input, mesh, origin, results};
pub use rodlab_lab::{
    cluster, design, experiment, identify, report, run, scenario, sensitivity, sweep,
};
pub use rodlab_planning::{knot, learn, plan};
pub use rodlab_robot as robot;
pub use rodlab_vision as vision;
pub use rodlab_workcell::{cell, live, recording, task, virtual_cell};

pub mod cli;
pub mod guide;
pub mod presets;
pub mod reproduce;
pub mod site;
pub mod verify;
