//! Figures of plain curves and rows, as SVG, PNG and PDF.
//!
//! A [`Figure`] holds the content: [`snapshots()`] shows rods as shaded tubes at several times,
//! [`line_plots`] curves over a common axis. A figure is drawn on a [`Paper`], whose width and font
//! size set everything else, and saved in a [`Format`]. [`movie_page`] makes the interactive page
//! of rods in motion, [`Film`] a film of them, and [`surface_page`] the page of a surface. [`glb`],
//! [`usda`] and [`obj()`] write rods as files for other programs.

mod axis;
mod colour_field;
mod curve;
mod document;
mod drawing;
mod exchange;
mod film;
mod font;
mod legend;
mod line_plot;
mod mark;
mod markup;
mod motion;
mod numbered;
mod palette;
mod panels;
mod paper;
mod pdf;
mod place_names;
mod plot_axes;
mod plot_curves;
mod raster;
mod scale_bar;
mod slug;
mod snapshots;
mod surface;
mod text;
mod tube;
mod view;
mod viewer;

pub use axis::AxisScale;
pub use colour_field::ColourField;
pub use curve::{Curve, LinePlot, Look};
pub use document::{document_page, markdown_html};
pub use exchange::{ExchangeError, Tempo, glb, obj, usda};
pub use film::{Film, FilmError, FilmOptions, Pace};
pub use font::FONT_FILE;
pub use line_plot::{
    LineFigure, PlotStyle, line_plots, named_plots, plot_to_scale, styled_line_plots,
};
pub use markup::{escape, escape_markdown, fill, is_page, is_picture};
pub use motion::{
    Field, Movie, MovieCase, MovieFrame, MovieObstacle, MoviePlane, MovieRod, MovieSeries, Strip,
};
pub use numbered::numbered_strokes;
pub use panels::{Panel, PanelsFigure, panels};
pub use paper::{FigureOptions, Format, Paper};
pub use raster::grey_picture;
pub use snapshots::{Body, Plane, RodsFigure, Snapshot, snapshots};
pub use surface::{ColouredSurface, surface_page};
pub use tube::RodCurve;
pub use view::View;
pub use viewer::movie_page;

/// A figure, not drawn yet.
#[derive(Clone, Debug, PartialEq)]
pub enum Figure {
    /// Curves over a common axis.
    Lines(LineFigure),
    /// Rods at several times.
    Rods(RodsFigure),
    /// Shapes in panels.
    Panels(PanelsFigure),
}

impl Figure {
    /// Draws the figure as SVG.
    pub fn svg(&self, paper: &Paper) -> String {
        match self {
            Self::Lines(figure) => figure.svg(paper),
            Self::Rods(figure) => figure.svg(paper),
            Self::Panels(figure) => figure.svg(paper),
        }
    }
}
