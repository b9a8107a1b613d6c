//! Traction of a knot over its tightness, with the laws of its theory.

use super::{KnotKind, KnotRow, KnotTables, read_knot_series};
use crate::experiment::kind::FigureError;
use crate::experiment::load;
use rodlab_files::figure::{
    AxisScale, Curve, Figure, LinePlot, Look, PlotStyle, styled_line_plots,
};
use rodlab_files::results::{SCENARIO, SERIES, Table};
use rodlab_planning::knot::{TREFOIL_FRICTION, audoly_traction, jawed_traction};
use std::path::Path;

/// F̄ = F h²/EI over ε = √(h/R) while the ends move apart, on logarithmic axes; `None` if no knot
/// was pulled in this run.
///
/// The figure also shows Audoly's law of the trefoil at the same ε (thesis Eq. 2.29) and, with
/// friction, the traction at which the law of Jawed et al. has the same shortening (thesis Eq.
/// 2.30). Other knots have no theory.
///
/// # Errors
/// [`FigureError::Scenario`] or [`FigureError::Results`] if files of the run cannot be read.
pub fn traction_figure(directory: &Path) -> Result<Option<Figure>, FigureError> {
    let series = directory.join(SERIES);
    if !series.exists() || Table::read(&series)?.column("force_normalized").is_none() {
        return Ok(None);
    }
    let scenario = load(&directory.join(SCENARIO), &[])?.scenario;
    let Some(KnotTables { rod, knot, .. }) = scenario.experiment.tables() else {
        return Ok(None);
    };
    let rows = read_knot_series(directory)?.into_iter();
    let pulled: Vec<(f64, KnotRow)> = rows
        .filter(|(series, _)| series.time_s > knot.settling_time)
        .filter_map(|(_, row)| Some((row.epsilon?, row)))
        .collect();
    if pulled.len() < 2 {
        return Ok(None);
    }
    let curve = |name: &str, traction: &dyn Fn(f64, &KnotRow) -> f64| {
        let points = pulled.iter();
        let points = points.map(|(epsilon, row)| (*epsilon, Some(traction(*epsilon, row))));
        Curve::new(name, points.collect())
    };
    let friction = scenario.contact.friction();
    let overhand = match knot.start.kind() {
        Some(KnotKind::Overhand { unknotting_number }) => Some(unknotting_number),
        _ => None,
    };
    let mut curves = vec![curve("rodlab", &|_, row| row.force_normalized)];
    if overhand == Some(1) {
        let law = curve("Audoly et al. 2007", &|epsilon, _| {
            audoly_traction(epsilon, friction, TREFOIL_FRICTION)
        });
        curves.push(law.looking(Look::Dashed));
    }
    if let Some(turns) = overhand.map(|number| number as f64)
        && friction > 0.0
    {
        let law = curve("Jawed et al. 2015", &|_, row| {
            let scaled = turns * turns * rod.radius / row.shortening_m;
            jawed_traction(scaled, friction) / (turns * turns)
        });
        curves.push(law.looking(Look::Dashed));
    }
    let plot = LinePlot::new("F̄ = F h²/EI", curves);
    let style = PlotStyle {
        horizontal: AxisScale::Logarithmic,
        vertical: vec![AxisScale::Logarithmic],
        ..PlotStyle::default()
    };
    Ok(Some(styled_line_plots([plot], "ε = √(h/R)", style)))
}
