//! Figure 2.5c: the difference between IMC and IPC.
//!
//! Both models approximate rigid contact, but their rods rest at different gaps of less than δ.
//! With δ = h/100 these gaps differ by microns, which the bundle amplifies. The figure compares
//! the models with a δ for which both are close to the rigid limit.

use super::bundling::{Bundling, DISTANCE_TOLERANCE_OF_DIFFERENCE};
use super::difference::{Difference, curve, differences, nodes_of};
use super::prelude::*;

pub(super) const ARTIFACT: Artifact = Artifact {
    name: "fig2.5",
    title: "Figure 2.5: difference between IMC and IPC, five flagella",
    recipe: &Tabled::new(Bundling::of_figure_2_5, Rows::All(rows), write, figures),
};

/// Time after the first contact over which the difference is reported, s.
const FIRST_SECONDS: f64 = 20.0;

/// Writes the difference; the cases are IMC and IPC.
fn write(page: &mut Page, cases: &[Case<Bundling>], rows: &[Difference]) -> Result<()> {
    let largest_until = |end: f64| {
        let until = rows.iter().filter(|row| row.time_s <= end);
        largest(until.map(|row| row.mean_difference_radii))
    };
    page.text(&format!(
        "ē is the mean distance of the nodes between IMC and IPC in radii (thesis Eq. 2.28). \
         Largest value over the whole time: {:.4}; the axis of the thesis' figure, 250 s long, \
         ends at 0.1. The distance tolerance is {DISTANCE_TOLERANCE_OF_DIFFERENCE:e} m in both \
         models, a fifth of the thesis' 1e-5 m: the rest distances of the two force laws differ by \
         a fraction of this tolerance.",
        largest_until(f64::INFINITY)
    ));
    let contacts = [&cases[0], &cases[1]].map(|case| case.record.outcome.first_contact);
    if let [Some(imc), Some(ipc)] = contacts {
        page.text(&format!(
            "First contact at {imc:.3} s (IMC) and {ipc:.3} s (IPC); largest ē up to {FIRST_SECONDS} s after it: \
             {:.4}.",
            largest_until(imc + FIRST_SECONDS)
        ));
    }
    Ok(())
}

/// The difference over time.
fn rows(cases: &[Case<Bundling>]) -> Result<Vec<Difference>> {
    let [imc, ipc] = [&cases[0], &cases[1]].map(nodes_of);
    let radius = cases[0].manifest.rods[0].radius;
    Ok(differences(&imc?, &ipc?, radius))
}

fn figures(rows: &[Difference]) -> Vec<PageFigure> {
    let plot = plot("ē in radii", [curve("rodlab".into(), rows)]);
    vec![PageFigure::new(
        "fig2.5c",
        "Mean difference ē of the nodes between IMC and IPC, five flagella",
        line_plots([plot], "Time in s"),
    )]
}
