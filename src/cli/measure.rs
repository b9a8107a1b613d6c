//! `rodlab measure`: material lengths of real rods and strips from their shape under gravity, the knot of a curve, sheets
//! and markers in photographs.

use super::measure_knot::{KnotArguments, measure_knot};
use super::measure_markers::{MarkerArguments, measure_markers};
use super::measure_rod::{RodArguments, measure_rod};
use super::measure_sheet::{SheetArguments, measure_sheet};
use super::prelude::*;
use rodlab_engine::mechanics::kirchhoff::{HangingStrip, HeavyLoop};

/// Arguments of `rodlab measure`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rodlab measure loop-height --height \"34 mm\" --uncertainty \"0.5 mm\"
  rodlab measure hanging-plate --length \"20 cm\" --drop \"7 cm\" --uncertainty \"1 mm\"
  rodlab measure knot curve.csv
  rodlab measure rod photo.png --pixel \"0.2 mm\"
  rodlab measure sheet before.png after.png --cell camera.toml
  rodlab measure markers frames/ --cell camera.toml --helix helix.toml

The answer is JSON. For loops and plates: the gravito-bending length L_gb, m, and its uncertainty.
Bending stiffness / weight per length = 2 L_gb³.")]
pub struct MeasureArguments {
    /// Quantity that was measured
    #[command(subcommand)]
    shape: Shape,
}

#[derive(Debug, Subcommand)]
enum Shape {
    /// Height of the loop of a rod folded over onto itself on a table
    LoopHeight {
        /// Height of the highest point of the centreline above the lying part, in metres or with a unit
        #[arg(long, value_name = "LENGTH", value_parser = positive_length)]
        height: f64,
        /// Standard uncertainty of the height
        #[arg(long, value_name = "LENGTH", value_parser = positive_length)]
        uncertainty: Option<f64>,
    },
    /// Drop of the free end of a strip whose other end is held horizontally
    HangingPlate {
        /// Length beyond the holder, in metres or with a unit
        #[arg(long, value_name = "LENGTH", value_parser = positive_length)]
        length: f64,
        /// Height of the held end above the free end
        #[arg(long, value_name = "LENGTH", value_parser = positive_length)]
        drop: f64,
        /// Standard uncertainty of the drop
        #[arg(long, value_name = "LENGTH", value_parser = positive_length)]
        uncertainty: Option<f64>,
    },
    /// Knot of a curve, by its determinant
    Knot(KnotArguments),
    /// Corners and edges of a sheet of paper in a photograph, and its slide between two
    Sheet(SheetArguments),
    /// Gravito-bending length, radius and natural curvature of a rod in a photograph, held at one end
    Rod(RodArguments),
    /// Distance of the markers of a rod in photographs from those of a helix
    Markers(MarkerArguments),
}

#[derive(Serialize)]
struct Answer {
    gravito_bending_length_m: f64,
    uncertainty_m: Option<f64>,
}

/// Measures and prints the result.
pub fn measure(arguments: &MeasureArguments) -> Result<(), Failure> {
    match &arguments.shape {
        Shape::Knot(arguments) => measure_knot(arguments),
        Shape::Sheet(arguments) => measure_sheet(arguments),
        Shape::Markers(arguments) => measure_markers(arguments),
        Shape::Rod(arguments) => measure_rod(arguments),
        &Shape::LoopHeight {
            height,
            uncertainty,
        } => {
            let unit_height = HeavyLoop::new().height;
            print_json(&Answer {
                gravito_bending_length_m: height / unit_height,
                uncertainty_m: uncertainty.map(|uncertainty| uncertainty / unit_height),
            })
        }
        &Shape::HangingPlate {
            length,
            drop,
            uncertainty,
        } => {
            let strip = HangingStrip::of_drop(drop / length).map_err(Failure::input)?;
            // With ε = drop/length, L_gb = length/ℓ(ε): |dL_gb/d drop| = ℓ'(ε)/ℓ².
            let by_drop = strip.length_by_drop / strip.length.powi(2);
            print_json(&Answer {
                gravito_bending_length_m: length / strip.length,
                uncertainty_m: uncertainty.map(|uncertainty| uncertainty * by_drop),
            })
        }
    }
}
