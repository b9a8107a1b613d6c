//! Pictures of plain curves and rows, as SVG and PNG.
//!
//! [`snapshots()`] draws rods as shaded tubes at several times; [`line_plots`] draws curves over time;
//! [`movie_page`] makes the interactive page of rods in motion.

mod axis;
mod line_plot;
mod palette;
mod raster;
mod snapshots;
mod tube;
mod view;
mod viewer;

pub use axis::AxisScale;
pub use line_plot::{Curve, LinePlot, PlotStyle, line_plots, styled_line_plots};
pub use raster::png;
pub use snapshots::{Snapshot, snapshots};
pub use tube::RodCurve;
pub use view::View;
pub use viewer::{Field, Movie, MovieCase, MovieFrame, MoviePlane, MovieRod, movie_page};
