//! `rodlab plot`.

use super::failure::Failure;
use super::figure_arguments::FigureArguments;
use super::output::print;
use clap::{Args, ValueEnum};
use rodlab_files::figure::{AxisScale, Format};
use rodlab_lab::report::{CustomFigure, custom_figure, plot_results, write_figure};
use std::path::PathBuf;

/// Arguments of `rodlab plot`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct PlotArguments {
    /// The results directory of a run or a sweep, finished or still running
    pub directory: PathBuf,
    /// Column for the horizontal axis of a figure of your own [default: time, or the first varied number]
    #[arg(long, value_name = "COLUMN", requires = "y")]
    pub x: Option<String>,
    /// Columns to draw, from summary.csv (a point for each case) or series.csv (a curve for each case)
    #[arg(long, value_name = "COLUMN", num_args = 1..)]
    pub y: Vec<String>,
    /// Varied key or column of summary.csv; each of its values gets a curve
    #[arg(long, value_name = "COLUMN", requires = "y")]
    pub group: Option<String>,
    /// Logarithmic axes [default: where numbers are positive and range over a decade]
    #[arg(long, value_name = "AXES", requires = "y")]
    pub log_axes: Option<LogAxes>,
    /// Where to write a figure of your own; the ending .pdf writes that format alone [default: own in the directory]
    #[arg(long, value_name = "FILE", requires = "y")]
    pub out: Option<PathBuf>,
    /// How figures are drawn
    #[command(flatten)]
    pub figures: FigureArguments,
}

const EXAMPLES: &str = "\
Examples:
  rodlab plot results/flagella_quick             rods and series over time
  rodlab plot results/sweep                      outcomes over the varied keys
  rodlab plot results/flagella_quick --y bending_energy_j min_distance_m
  rodlab plot results/sweep --x contact.friction --y newton_iterations_mean --group flagella.count --log-axes y
  rodlab plot results/flagella_quick --format pdf --width 85mm --font-size 8     for a column of a journal

Figures are written as SVG and as PNG unless --format says otherwise. Their text is outlines of letters, so that they
look the same everywhere.";

/// Which axes are logarithmic.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LogAxes {
    /// The horizontal axis.
    X,
    /// The vertical axes.
    Y,
    /// All axes.
    Xy,
    /// No axis.
    None,
}

impl LogAxes {
    fn scales(self) -> [AxisScale; 2] {
        let (linear, logarithmic) = (AxisScale::Linear, AxisScale::Logarithmic);
        match self {
            Self::X => [logarithmic, linear],
            Self::Y => [linear, logarithmic],
            Self::Xy => [logarithmic; 2],
            Self::None => [linear; 2],
        }
    }
}

/// Draws the figures of a results directory, or one of the user's own, and prints where they are.
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
            scales: arguments.log_axes.map(LogAxes::scales),
        };
        let figure = custom_figure(&arguments.directory, &figure)?;
        let own = || arguments.directory.join("own.svg");
        let path = arguments.out.clone().unwrap_or_else(own);
        write_figure(&path, &figure, &options)?
    };
    let lines: String = written
        .iter()
        .map(|path| format!("{}\n", path.display()))
        .collect();
    print(&lines)
}
