//! Figures, pages and films of a results directory: the output of `plot`, `view` and `movie`.
//! `export` writes files for other programs.

mod branches;
mod carried_bodies;
mod case_folders;
mod export;
mod film;
mod free_bodies;
mod labels;
mod models;
mod motion;
mod obstacles;
mod plot;
mod rod_frame;
mod rod_places;
mod threads;
mod view;

pub use export::{ExportError, ExportFormat, ExportRequest, WrittenExport, write_export};
pub use film::{FilmRequest, MovieError, WrittenFilm, write_film};
pub use models::{SceneModel, mjcf, newton};
pub use plot::rods_figure;
pub use plot::{
    CustomFigure, PlotError, custom_figure, plot_results, write_figure, write_in_formats,
};
pub use view::{ViewError, WrittenPage, write_page, write_page_that_reloads};
