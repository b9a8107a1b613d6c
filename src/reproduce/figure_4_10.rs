//! Figure 4.10: paths of the gripper for US letter paper and C = 0.27 m.

use super::figure_4_11::{HEADER, line, row};
use super::folds::{Folded, METHODS, SCENARIOS};
use super::prelude::*;
use rodlab_lab::experiment::{FigureError, folded_outlines};

pub(super) const ARTIFACT: Artifact = Artifact {
    name: "fig4.10",
    title: "Figure 4.10: paths of the gripper that folds US letter paper",
    recipe: &Free::new(Folded::of_figure_4_10, write),
};

/// Writes table and figure.
fn write(page: &mut Page, cases: &[Case<Folded>]) -> Result<()> {
    page.text(
        "The edge of a sheet of US letter paper (L_gb = 6.0 cm) is moved to C = 0.27 m on a table \
         of friction 0.12, without jitter, by each of the methods of fig4.11. A gripper on half a \
         circle holds the sheet too low at first and too high later; step by step the whole sheet \
         is lifted before it comes down; the two planned paths leave the lift low, and cross the \
         ridge of the force manifold where it is narrow (without a moment) or high (with one).",
    );
    let rows: Vec<_> = cases.iter().map(row).collect();
    let lines = cases.iter().zip(&rows).map(|(case, row)| {
        let run = &case.run;
        line(
            SCENARIOS[run.scenario].name,
            METHODS[run.method].name,
            &[row],
        )
    });
    page.lines(&HEADER, &lines.collect::<Vec<_>>());
    page.csv(&rows)?;
    let mut curves = vec![];
    for case in cases {
        let outlines = match folded_outlines(&case.directory) {
            Ok(outlines) => outlines,
            Err(FigureError::Results(error)) => return Err(error.into()),
            // Embedded scenarios can be read.
            Err(FigureError::Scenario(_)) => None,
        };
        if let Some(outlines) = outlines {
            curves.push(Curve::new(METHODS[case.run.method].name, outlines.gripper));
        }
    }
    page.figure(&PageFigure::new(
        "fig4.10_ways",
        "Paths of the gripper by the method of planning, US letter paper, C = 0.27 m",
        plot_to_scale(plot("z in m", curves), "x in m"),
    ))?;
    Ok(())
}
