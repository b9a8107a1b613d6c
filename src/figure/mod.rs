//! Pictures of plain curves and rows, as SVG and PNG.
//!
//! [`snapshots()`] draws rods as shaded tubes at several times; [`line_plots`] draws curves over time;
//! [`movie_page`] makes the interactive page of rods in motion, [`surface_page`] that of a surface.

mod axis;
mod line_plot;
mod markup;
mod palette;
mod raster;
mod snapshots;
mod surface;
mod tube;
mod view;
mod viewer;

pub use axis::AxisScale;
pub use line_plot::{Curve, LinePlot, PlotStyle, line_plots, styled_line_plots};
pub use markup::{is_page, is_picture};
pub use raster::png;
pub use snapshots::{Snapshot, snapshots};
pub use surface::{ColouredSurface, surface_page};
pub use tube::RodCurve;
pub use view::View;
pub use viewer::{Field, Movie, MovieCase, MovieFrame, MoviePlane, MovieRod, movie_page};
