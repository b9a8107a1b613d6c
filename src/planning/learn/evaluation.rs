//! Errors of the predictions of a model on unseen samples.

use super::Samples;
use super::model::{Model, ModelError};
use rodlab_files::figure::{AxisScale, Curve, Figure, LinePlot, PlotStyle, styled_line_plots};
use serde::Serialize;

/// Errors of a quantity over many samples, in its unit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Errors {
    /// The quantity.
    pub quantity: String,
    /// Mean of the sizes.
    pub mean: f64,
    /// The 95th percentile.
    pub percentile_95: f64,
    /// The largest.
    pub largest: f64,
    /// The inputs at the largest error.
    pub largest_at: Vec<f64>,
    /// Magnitudes of all errors, in ascending order.
    #[serde(skip)]
    pub sizes: Vec<f64>,
}

/// A quantity whose errors are reported: a number or a vector computed from inputs and outputs.
#[derive(Clone, Copy, Debug)]
pub struct Compared {
    /// Name of the quantity, with its unit.
    pub quantity: &'static str,
    /// Components of the quantity, computed from inputs and outputs; zeros if it has fewer than three.
    pub components: fn(&[f64], &[f64]) -> [f64; 3],
}

/// Compares a model with samples: the norm of the error of each quantity.
///
/// # Errors
/// [`ModelError::Tensors`].
pub fn evaluate(
    model: &Model,
    samples: &Samples,
    compared: &[Compared],
) -> Result<Vec<Errors>, ModelError> {
    let predicted = model.predict(&samples.inputs)?;
    let width = samples.output_width;
    let errors = compared.iter().map(|compared| {
        let size = |row: usize| {
            let of = |outputs: &[f64]| (compared.components)(samples.input(row), outputs);
            let (found, exact) = (
                of(&predicted[row * width..][..width]),
                of(samples.output(row)),
            );
            let squares = found.iter().zip(&exact).map(|(a, b)| (a - b).powi(2));
            squares.sum::<f64>().sqrt()
        };
        let sizes = (0..samples.rows()).map(|row| (size(row), row));
        let mut sizes: Vec<(f64, usize)> = sizes.collect();
        sizes.sort_by(|one, other| one.0.total_cmp(&other.0));
        let last = sizes.last().copied();
        let sizes_only: Vec<f64> = sizes.iter().map(|(size, _)| *size).collect();
        Errors {
            quantity: compared.quantity.to_owned(),
            mean: sizes_only.iter().sum::<f64>() / sizes.len().max(1) as f64,
            percentile_95: sizes_only
                .get((0.95 * sizes.len() as f64) as usize)
                .copied()
                .unwrap_or(0.0),
            largest: last.map_or(0.0, |(size, _)| size),
            largest_at: last.map_or_else(Vec::new, |(_, row)| samples.input(row).to_vec()),
            sizes: sizes_only,
        }
    });
    Ok(errors.collect())
}

/// Cumulative distribution of the errors: a curve per quantity.
pub fn error_figure(errors: &[Errors]) -> Figure {
    let plots = errors.iter().map(|errors| {
        let count = errors.sizes.len().max(1) as f64;
        let points = errors.sizes.iter().enumerate();
        LinePlot::new(
            format!("share of samples in %, {}", errors.quantity),
            [Curve::new(
                errors.quantity.clone(),
                points
                    .map(|(index, size)| (*size, Some(1e2 * (index as f64 + 1.0) / count)))
                    .collect(),
            )],
        )
    });
    let style = PlotStyle {
        horizontal: AxisScale::Logarithmic,
        ..PlotStyle::default()
    };
    styled_line_plots(plots.collect::<Vec<_>>(), "error of at most", style)
}
