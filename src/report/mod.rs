//! Figures and pages of a results directory: what `plot` and `view` show.

mod case_folders;
mod plot;
mod view;

pub(crate) use plot::rods_figure;
pub use plot::{CustomFigure, PlotError, custom_figure, plot_results, write_figure};
pub use view::{ViewError, WrittenPage, write_page};
