//! Figures and pages of a results directory: what `plot` and `view` show.

mod branches;
mod carried_bodies;
mod case_folders;
mod drawn_springs;
mod labels;
mod obstacles;
mod plot;
mod rod_places;
mod view;

pub use plot::rods_figure;
pub use plot::{
    CustomFigure, PlotError, custom_figure, plot_results, write_figure, write_in_formats,
};
pub use view::{ViewError, WrittenPage, write_page};
