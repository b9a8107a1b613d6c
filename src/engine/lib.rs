//! Implicit dynamics of slender elastic rods: discrete elastic rods (Bergou et al. 2008), frictional contact, Stokes flow.
//!
//! A [`Scene`](mechanics::scene::Scene) describes rods, clamps, loads and obstacles in SI units and plain types; a
//! [`Simulation`](mechanics::dynamics::Simulation) steps it in time or brings it to rest. A cantilever of 30 cm that swings under its
//! weight:
//!
//! ```
//! use rodlab_engine::mechanics::Vector3;
//! use rodlab_engine::mechanics::dynamics::{IntegrationParameters, Simulation};
//! use rodlab_engine::mechanics::scene::{Clamp, Load, LoadKind, Motion, RodDescription, Scene, Stiffness};
//!
//! let nodes = (0..=30).map(|k| Vector3::x() * (0.01 * f64::from(k))).collect();
//! let stiffness = Stiffness { stretching: 1e3, bending: [1e-3, 1e-3], twisting: 7e-4 };
//! let scene = Scene {
//!     rods: vec![RodDescription::uniform("cantilever", nodes, stiffness, 2e-3, 0.01)],
//!     clamps: vec![Clamp { rod: 0, node: 0, holds_position: true, holds_frame: true, motion: Motion::default() }],
//!     loads: vec![Load { kind: LoadKind::Gravity { acceleration: Vector3::z() * -9.81 }, schedule: Vec::new() }],
//!     ..Scene::default()
//! };
//! let mut simulation = Simulation::new(&scene, &IntegrationParameters::default())?;
//! while simulation.time() < 0.1 {
//!     simulation.advance(0.1)?;   // one step, not beyond 0.1 s
//! }
//! assert!(simulation.positions()[30].z < -0.01);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | module | contents |
//! |---|---|
//! | [`mechanics`] | rods, contact, fluid, time stepping, equilibria |
//! | [`linalg`] | banded and sparse factorisations |
//!
//! The crate neither reads nor writes files and has no command line. Loops over many pairs run on
//! the global pool of `rayon`; results do not depend on the number of its threads. Scenario files,
//! results directories and the program `rodlab` are in other crates.

// Public items are meant for users of the library.
#![warn(unreachable_pub)]
// Tests compare with a tolerance, so they may use any mathematical library.
#![cfg_attr(test, allow(clippy::disallowed_methods))]

pub mod linalg;
pub mod mechanics;
pub mod random;
