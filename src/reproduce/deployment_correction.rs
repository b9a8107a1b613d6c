//! Effect of the online correction for jitter of the gripper and errors of the gravito-bending
//! length.

use super::laying::{Laying, PATTERNS};
use super::prelude::*;
use rodlab_files::figure::Figure;

pub(super) const ARTIFACT: Artifact = Artifact {
    name: "deployment-correction",
    title: "Laid rods: effect of the online correction",
    recipe: &Tabled::new(Laying::of_correction, Rows::All(rows), write, figures),
};

/// A row of the CSV file.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Row {
    pattern: String,
    jitter_mm: f64,
    seed: u64,
    length_error: f64,
    open_cm: Option<f64>,
    corrected_cm: Option<f64>,
    corrected_with_noise_cm: Option<f64>,
    corrected_sliding_cm: Option<f64>,
}

impl Row {
    /// The patternand the disturbance during laying.
    fn trial(&self) -> (&str, String) {
        let name = disturbance(self.jitter_mm, self.seed, self.length_error);
        (&self.pattern, name)
    }
}

/// Writes the table.
fn write(page: &mut Page, _: &[Case<Laying>], rows: &[Row]) -> Result<()> {
    page.text(
        "The green rod of thesis Tab. 5.1 on a table of friction 0.4, laid by the optimal scheme: mean distance from \
         the pattern in cm (thesis Eq. 5.11) along the initially planned path (open), and along one that is replanned \
         every 0.8 gravito-bending lengths, 2.6 cm, from the observed position of the rod (`[deployment.correction]`). \
         The gripper deviates from its path at random (root mean square in each direction, periods from 1 to 5 s), or \
         the path is planned for a gravito-bending length that is a tenth too large or too small. The camera measures \
         positions of the lying rod exactly, or with an error of 0.5 mm root mean square in each direction.",
    );
    page.table(columns! { row in rows;
        "pattern" => row.pattern.clone(),
        "jitter in mm" => number(row.jitter_mm, 1),
        "seed" => row.seed.to_string(),
        "error of L_gb" => format!("{:+.0} %", 1e2 * row.length_error),
        "open" => number(row.open_cm, 3),
        "corrected" => number(row.corrected_cm, 3),
        "with noise of 0.5 mm" => number(row.corrected_with_noise_cm, 3),
        "slid, corrected" => number(row.corrected_sliding_cm, 3),
    });
    let errors = rows.iter().map(|row| Errors {
        jitter: row.jitter_mm,
        length: row.length_error,
        open: row.open_cm,
        corrected: row.corrected_cm,
    });
    page.text(&verdict(&errors.collect::<Vec<_>>()));
    Ok(())
}

fn rows(cases: &[Case<Laying>]) -> Result<Vec<Row>> {
    let open = cases.iter().filter(|case| !case.run.is_corrected());
    let rows = open.map(|case| {
        let disturbance = case.run.disturbance;
        let corrected = |is_seen: fn(f64) -> bool| {
            let mut cases = cases.iter();
            cases.find(|other| other.run.corrects(&case.run, is_seen))
        };
        let exact = corrected(|noise| noise == 0.0);
        let sliding = exact.and_then(Case::laid);
        Row {
            pattern: PATTERNS[case.run.pattern].name.into(),
            jitter_mm: 1e3 * disturbance.jitter,
            seed: disturbance.seed,
            length_error: disturbance.length_error,
            open_cm: case.mean_error_cm(),
            corrected_cm: exact.and_then(Case::mean_error_cm),
            corrected_with_noise_cm: corrected(|noise| noise > 0.0).and_then(Case::mean_error_cm),
            corrected_sliding_cm: sliding.map(|laid| 1e2 * laid.largest_sliding_m),
        }
    });
    Ok(rows.collect())
}

/// Disturbance during the laying of a rod, and distances of the rod from the pattern, cm.
pub(super) struct Errors {
    pub jitter: f64,
    pub length: f64,
    pub open: Option<f64>,
    pub corrected: Option<f64>,
}

/// Means over the runs with each kind of error.
pub(super) fn verdict(errors: &[Errors]) -> String {
    let of = |name: &str, wanted: fn(&&Errors) -> bool| {
        let of = || errors.iter().filter(wanted);
        let open = mean(of().filter_map(|errors| errors.open));
        let corrected = mean(of().filter_map(|errors| errors.corrected));
        let ratio = corrected.zip(open);
        format!(
            "{name}: {} cm open, {} cm corrected, {} of it",
            number(open, 3),
            number(corrected, 3),
            number(ratio.map(|(corrected, open)| corrected / open), 2)
        )
    };
    format!(
        "On average {}; {}; {}.",
        of("with jitter", |errors| errors.jitter > 0.0),
        of("with a wrong L_gb", |errors| errors.length != 0.0),
        of("without an error", |errors| errors.jitter == 0.0
            && errors.length == 0.0),
    )
}

/// A quantity of rows with its name.
type Quantity<Row> = (&'static str, fn(&Row) -> Option<f64>);

/// Disturbance during the laying of a rod, as text.
pub(super) fn disturbance(jitter_mm: f64, seed: u64, length_error: f64) -> String {
    match (jitter_mm > 0.0, length_error != 0.0) {
        (true, _) => format!("jitter {jitter_mm} mm, seed {seed}"),
        (_, true) => format!("L_{{gb}} {:+.0} %", 1e2 * length_error).replace('-', "−"),
        _ => "no error".into(),
    }
}

/// Mean distances from each pattern for each disturbance; `trial` returns pattern and disturbance
/// of a row.
pub(super) fn distances<Row>(
    rows: &[Row],
    trial: fn(&Row) -> (&str, String),
    quantities: &[Quantity<Row>],
) -> Figure {
    let first = rows.first().map_or("", |row| trial(row).0);
    let of_first = rows.iter().map(trial).filter(|(of, _)| *of == first);
    let names: Vec<String> = of_first.map(|(_, name)| name).collect();
    let laid = rows.chunks(names.len().max(1)).map(|rows| {
        let curves = quantities.iter().map(|(name, value)| {
            let numbered = rows.iter().enumerate();
            let point = |(index, row): (usize, &Row)| (index as f64 + 1.0, value(row));
            curve(*name, numbered, point).looking(Look::Marks)
        });
        let pattern = rows.first().map_or("", |row| trial(row).0);
        plot(format!("{pattern}: distance in cm"), curves)
    });
    named_plots(laid.collect::<Vec<_>>(), names)
}

fn figures(rows: &[Row]) -> Vec<PageFigure> {
    let figure = distances(
        rows,
        Row::trial,
        &[
            ("as planned", |row| row.open_cm),
            ("corrected", |row| row.corrected_cm),
            ("corrected, camera with noise", |row| {
                row.corrected_with_noise_cm
            }),
        ],
    );
    vec![PageFigure::new(
        "deployment-correction",
        "Mean distance from each pattern, as initially planned and as corrected online, for each disturbance of the \
         hand or the plan. Runs that did not finish have no mark",
        figure,
    )]
}
