//! Figure 2.5c: how far IMC and IPC come apart.
//!
//! Both models stand for rigid contact, but their rods rest at different distances within δ of touching: with δ = h/100
//! microns apart, which the bundle amplifies. The figure compares them where both are close to the rigid limit.

use super::ReproduceError;
use super::bundling::{Bundling, DISTANCE_TOLERANCE_OF_DIFFERENCE};
use super::cases::Case;
use super::difference::{Difference, differences, nodes_of};
use super::page::{Page, PageFigure};
use super::table::rows_of;
use rodlab_files::figure::{Curve, LinePlot, line_plots};
use std::path::Path;

/// Time after the first contact over which the difference is summed up, s.
const FIRST_SECONDS: f64 = 20.0;

/// Writes the difference over time; the cases are IMC and IPC.
pub(super) fn write(page: &mut Page, cases: &[Case<Bundling>]) -> Result<(), ReproduceError> {
    let [imc, ipc] = [&cases[0], &cases[1]].map(nodes_of);
    let radius = cases[0].manifest.rods[0].radius;
    let rows = differences(&imc?, &ipc?, radius);
    let largest = |rows: &mut dyn Iterator<Item = &Difference>| {
        rows.map(|row| row.mean_difference_radii)
            .fold(0.0, f64::max)
    };
    let all = largest(&mut rows.iter());
    page.text(&format!(
        "ē is the mean distance of the nodes between IMC and IPC in radii (thesis Eq. 2.28). Largest over the \
         whole time: {all:.4}; the axis of the thesis' figure, 250 s long, ends at 0.1. The distance tolerance is \
         {DISTANCE_TOLERANCE_OF_DIFFERENCE:e} m in both models, a fifth of the thesis' 1e-5 m: the rest distances of the two force laws \
         differ by a part of it."
    ));
    let contacts = [&cases[0], &cases[1]].map(|case| case.record.outcome.first_contact);
    if let [Some(imc), Some(ipc)] = contacts {
        let until = imc + FIRST_SECONDS;
        let early = largest(&mut rows.iter().filter(|row| row.time_s <= until));
        page.text(&format!(
            "First contact at {imc:.3} s (IMC) and {ipc:.3} s (IPC); largest ē up to {FIRST_SECONDS} s after it: \
             {early:.4}."
        ));
    }
    page.csv(&rows)?;
    Ok(page.figure(&figure(&rows))?)
}

/// The figure from the table alone.
pub(super) fn figures_of_table(table: &Path) -> Result<Vec<PageFigure>, ReproduceError> {
    Ok(vec![figure(&rows_of::<Difference>(table)?)])
}

fn figure(rows: &[Difference]) -> PageFigure {
    let points = rows.iter();
    let points = points.map(|row| (row.time_s, Some(row.mean_difference_radii)));
    let plot = LinePlot {
        label: "ē in radii".into(),
        curves: vec![Curve::new("rodlab", points.collect())],
    };
    PageFigure::new(
        "fig2.5c",
        "Mean difference ē of the nodes between IMC and IPC, five flagella",
        line_plots([plot], "Time in s"),
    )
}
