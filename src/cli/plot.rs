//! `rodlab plot`.

use super::figure_arguments::FigureArguments;
use super::prelude::*;
use rodlab_files::figure::AxisScale::{self, Linear, Logarithmic};
use rodlab_files::figure::Format;
use rodlab_lab::report::{CustomFigure, custom_figure, plot_results, write_figure};

/// Choices of logarithmic axes: horizontal, then vertical.
const LOG_AXES: [Named<[AxisScale; 2]>; 4] = [
    ("x", [Logarithmic, Linear], "The horizontal axis"),
    ("y", [Linear, Logarithmic], "The vertical axes"),
    ("xy", [Logarithmic; 2], "All axes"),
    ("none", [Linear; 2], "No axis"),
];

/// Arguments of `rodlab plot`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct PlotArguments {
    /// The results directory of a run or a sweep, finished or still running
    pub directory: PathBuf,
    /// Column of the horizontal axis of a custom figure [default: time, or the first varied number]
    #[arg(long, value_name = "COLUMN", requires = "y")]
    pub x: Option<String>,
    /// Columns to draw, from summary.csv (a point per case) or series.csv (a curve per case)
    #[arg(long, value_name = "COLUMN", num_args = 1..)]
    pub y: Vec<String>,
    /// Varied key or column of summary.csv; each of its values gets a curve
    #[arg(long, value_name = "COLUMN", requires = "y")]
    pub group: Option<String>,
    /// Logarithmic axes [default: where numbers are positive and range over a decade]
    #[arg(long, value_name = "AXES", requires = "y", value_parser = named(&LOG_AXES))]
    pub log_axes: Option<[AxisScale; 2]>,
    /// Output file of a custom figure; .pdf writes that format alone [default: DIRECTORY/own.svg]
    #[arg(long, value_name = "FILE", requires = "y")]
    pub out: Option<PathBuf>,
    /// Style of the figures
    #[command(flatten)]
    pub figures: FigureArguments,
}

const EXAMPLES: &str = "\
Examples:
  rodlab plot results/flagella_quick             rods and series over time
  rodlab plot results/sweep                      outcomes over the varied keys
  rodlab plot results/flagella_quick --y bending_energy_j min_distance_m
  rodlab plot results/sweep --x contact.friction --y newton_iterations_mean --log-axes y
  rodlab plot results/flagella_quick --format pdf --width 85mm --font-size 8   a journal column

Figures are written as SVG and as PNG unless --format is given. Their text is outlines of letters,
so that they look the same everywhere.";

/// Draws the figures of a results directory, or a custom one, and prints their paths.
pub fn plot(arguments: &PlotArguments) -> Result<(), Failure> {
    let asks_for_pdf = arguments
        .out
        .as_deref()
        .is_some_and(|path| path.extension() == Some("pdf".as_ref()));
    let usual: &[Format] = if asks_for_pdf {
        &[Format::Pdf]
    } else {
        &[Format::Svg, Format::Png]
    };
    let options = arguments.figures.options(usual)?;
    let written = if arguments.y.is_empty() {
        plot_results(&arguments.directory, &options)?
    } else {
        let figure = CustomFigure {
            x: arguments.x.clone(),
            y: arguments.y.clone(),
            group: arguments.group.clone(),
            scales: arguments.log_axes,
        };
        let figure = custom_figure(&arguments.directory, &figure)?;
        let own = || arguments.directory.join("own.svg");
        let path = arguments.out.clone().unwrap_or_else(own);
        write_figure(&path, &figure, &options)?
    };
    print_paths(&written)
}
