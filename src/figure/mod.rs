//! Pictures of plain curves and rows, as SVG.
//!
//! [`snapshots()`] draws rods as shaded tubes at several times; [`line_plots`] draws curves over time;
//! [`movie_page`] makes the interactive page of rods in motion.

mod line_plot;
mod palette;
mod snapshots;
mod tube;
mod view;
mod viewer;

pub use line_plot::{Curve, LinePlot, line_plots};
pub use snapshots::{Snapshot, snapshots};
pub use tube::RodCurve;
pub use view::View;
pub use viewer::{Field, Movie, MovieCase, MovieFrame, MoviePlane, MovieRod, movie_page};
