//! Error over the rounds of a training.

use super::training::Epoch;
use rodlab_files::figure::{AxisScale, Curve, LinePlot, Look, Paper, PlotStyle, styled_line_plots};

/// Errors of the rounds, on a logarithmic axis.
pub fn loss_figure(epochs: &[Epoch]) -> String {
    let curve = |value: fn(&Epoch) -> f64| {
        let points = epochs.iter().enumerate();
        points
            .map(|(index, epoch)| (index as f64 + 1.0, Some(value(epoch))))
            .collect::<Vec<_>>()
    };
    let plot = LinePlot::new(
        "mean absolute error of the standardised outputs",
        [
            Curve::new("learned from", curve(|epoch| epoch.training)).looking(Look::Dashed),
            Curve::new("held back", curve(|epoch| epoch.held_back)),
        ],
    );
    let style = PlotStyle {
        vertical: vec![AxisScale::Logarithmic],
        ..PlotStyle::default()
    };
    styled_line_plots([plot], "rounds over all samples", style).svg(&Paper::default())
}
