//! Figure 2.6: friction in pictures.

use super::bundling::Bundling;
use super::prelude::*;
use rodlab_lab::report::rods_figure;

pub(super) const ARTIFACT: Artifact = Artifact {
    name: "fig2.6",
    title: "Figure 2.6: two flagella with growing friction, snapshots",
    recipe: &Free::new(Bundling::of_figure_2_6, write),
};

/// A row of the CSV file.
#[derive(Serialize)]
struct Row {
    friction: f64,
    status: &'static str,
    simulated_end_s: f64,
    first_contact_s: Option<f64>,
    steps_with_contact: u64,
    min_distance_ratio: Option<f64>,
}

/// Writes a row of snapshots for each friction coefficient.
fn write(page: &mut Page, cases: &[Case<Bundling>]) -> Result<()> {
    let rows: Vec<Row> = cases.iter().map(row).collect();
    page.csv(&rows)?;
    for case in cases {
        let friction = case.run.friction;
        let name = format!("fig2.6_mu{friction}");
        let snapshots = rods_figure(&case.directory, &case.manifest)?;
        let caption = format!(
            "Two flagella, μ = {friction}, from the beginning to the end of the simulated time"
        );
        page.figure(&PageFigure::new(&name, &caption, snapshots))?;
    }
    Ok(())
}

fn row(case: &Case<Bundling>) -> Row {
    let outcome = &case.record.outcome;
    Row {
        friction: case.run.friction,
        status: case.status(),
        simulated_end_s: outcome.simulated_time,
        first_contact_s: outcome.first_contact,
        steps_with_contact: outcome.steps_with_contact,
        min_distance_ratio: outcome.minimum_distance_ratio,
    }
}
