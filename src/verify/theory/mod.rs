//! Independent reference values for the checks, each computed here from its continuum theory.

pub mod beam;
pub mod cable;
pub mod crawler;
pub mod filament;
pub mod friction;
pub mod localized_buckling;
pub mod sections;
pub mod shell;
pub mod stokeslet;
pub mod swimmer;
pub mod tube;
pub mod wall;
