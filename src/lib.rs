//! `rodlab`: a laboratory for slender elastic rods.
//!
//! A scenario file (TOML) goes in; the implicit rod engine runs it; a results directory comes out.
//! The rooms, and who may import whom (an arrow means "may import"):
//!
//! ```text
//! cli ──> experiment ──> knot ──> mechanics ──> linalg
//!  └──────────┴──> scenario, results, figure, cluster, vision
//! ```
//!
//! | room | what lives there |
//! |---|---|
//! | [`cli`] | one file per subcommand: parse, call one library function, print |
//! | [`scenario`] | the TOML schema as Rust types, units, validation with source positions |
//! | [`experiment`] | scenario → scene, the run loop, `verify`, `reproduce` |
//! | [`knot`] | knots from parameters, the knot determinant, theory of tightening |
//! | [`mechanics`] | rods, contact, fluid, time stepping, equilibria |
//! | [`linalg`] | banded and sparse factorisations |
//! | [`results`] | results directories, checkpoints, VTK |
//! | [`cluster`] | Slurm job arrays |
//! | [`figure`] | pictures of plain curves and rows |
//! | [`vision`] | images → centrelines in pixels and metres, cameras, scores |
//!
//! Inside [`mechanics`], [`rod`](mechanics::rod), [`contact`](mechanics::contact) and
//! [`fluid`](mechanics::fluid) do not know each other; [`system`](mechanics::system) adds their forces up into one
//! residual, which [`dynamics`](mechanics::dynamics) steps in time and [`statics`](mechanics::statics) brings to
//! rest. The time step loop is [`mechanics::dynamics::Simulation::advance`]. `tests/architecture.rs` holds the
//! direction of imports.
//!
//! All quantities are in SI units unless a name says otherwise.

pub mod cli;
pub mod cluster;
pub mod experiment;
pub mod figure;
pub mod knot;
pub mod linalg;
pub mod mechanics;
pub mod results;
pub mod scenario;
pub mod vision;
