//! Effect of the correction by the camera in the virtual cell, which includes drivers and
//! pictures.

use super::deployment_correction::{Errors, distances, disturbance, verdict};
use super::laying::{Laying, PATTERNS};
use super::prelude::*;
use super::virtual_laying::lay_in_cell;

pub(super) const ARTIFACT: Artifact = Artifact {
    name: "cell-correction",
    title: "Rods laid in the virtual cell: effect of the correction",
    recipe: &Tabled::new(Laying::of_cell_correction, Rows::All(rows), write, figures),
};

/// A row of the CSV file; lengths in cm.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Row {
    pattern: String,
    jitter_mm: f64,
    seed: u64,
    length_error: f64,
    /// In the cell.
    open_cm: Option<f64>,
    corrected_cm: Option<f64>,
    /// Mean distance in plain simulation, without correction.
    simulated_open_cm: Option<f64>,
    simulated_corrected_cm: Option<f64>,
}

impl Row {
    /// The patternand the disturbance during laying.
    fn trial(&self) -> (&str, String) {
        let name = disturbance(self.jitter_mm, self.seed, self.length_error);
        (&self.pattern, name)
    }
}

/// Writes the table. Means are over patterns that were laid both with and without correction.
fn write(page: &mut Page, _: &[Case<Laying>], rows: &[Row]) -> Result<()> {
    page.text(
        "The green rod of thesis Tab. 5.1 on a table of friction 0.4, laid by the gantry of the \
         virtual cell: mean distance from the pattern in cm at equal arc lengths, in the picture \
         of the camera, along the initially planned path (open), and by `rodlab deploy --correct`: \
         every 0.8 gravito-bending lengths the arm stops, the camera takes a picture, and the rest \
         is replanned. The hand has jitter that the joint encoders do not see (root mean square in \
         each direction, periods from 1 to 5 s), or the path is planned for a gravito-bending \
         length that is a tenth too large or too small. Beside these values are those of plain \
         simulation, where the positions of the lying rod are known exactly.",
    );
    page.table(columns! { row in rows;
        "pattern" => row.pattern.clone(),
        "jitter in mm" => number(row.jitter_mm, 1),
        "seed" => row.seed.to_string(),
        "error of L_gb" => format!("{:+.0} %", 1e2 * row.length_error),
        "open" => number(row.open_cm, 3),
        "corrected" => number(row.corrected_cm, 3),
        "open, simulated" => number(row.simulated_open_cm, 3),
        "corrected, simulated" => number(row.simulated_corrected_cm, 3),
    });
    let errors = rows.iter().map(|row| {
        let (open, corrected) = row.open_cm.zip(row.corrected_cm).unzip();
        Errors {
            jitter: row.jitter_mm,
            length: row.length_error,
            open,
            corrected,
        }
    });
    page.text(&verdict(&errors.collect::<Vec<_>>()));
    Ok(())
}

/// Lays the rod with all errors.
fn rows(cases: &[Case<Laying>]) -> Result<Vec<Row>> {
    let mut laid = Vec::new();
    for case in cases {
        laid.push(match lay_in_cell(case)? {
            Ok(laid) => Some(1e2 * laid.score.by_arc_length.mean_m),
            Err(error) => {
                tracing::warn!("{}: {error}", case.directory.display());
                None
            }
        });
    }
    let both = || cases.iter().zip(&laid);
    let open = both().filter(|(case, _)| !case.run.is_corrected());
    let rows = open.map(|(case, laid)| {
        let disturbance = case.run.disturbance;
        let corrected = both().find(|(other, _)| other.run.corrects(&case.run, |_| true));
        Row {
            pattern: PATTERNS[case.run.pattern].name.into(),
            jitter_mm: 1e3 * disturbance.jitter,
            seed: disturbance.seed,
            length_error: disturbance.length_error,
            open_cm: *laid,
            corrected_cm: corrected.and_then(|(_, laid)| *laid),
            simulated_open_cm: case.mean_error_cm(),
            simulated_corrected_cm: corrected.and_then(|(case, _)| case.mean_error_cm()),
        }
    });
    Ok(rows.collect())
}

fn figures(rows: &[Row]) -> Vec<PageFigure> {
    let quantities: [(_, fn(&Row) -> _); 2] = [
        ("as planned", |row| row.open_cm),
        ("corrected by the camera", |row| row.corrected_cm),
    ];
    vec![PageFigure::new(
        "cell-correction",
        "Mean distance from each pattern in the virtual cell, as initially planned and as corrected by the camera, for \
         each disturbance of the hand or the plan. Rods that were not laid completely, or not seen as a whole, have no \
         mark",
        distances(rows, Row::trial, &quantities),
    )]
}
