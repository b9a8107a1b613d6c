//! Table 5.2: accuracy of rods laid along patterns: simulation and measurement.

use super::laid_outlines::outlines_figure;
use super::laying::{FRICTIONS, Laying, PATTERNS, RODS, Substrate};
use super::measured_deployments::measured;
use super::page::MarkdownTable;
use super::prelude::*;

pub(super) const ARTIFACT: Artifact = Artifact {
    name: "tab5.2",
    title: "Table 5.2: rods laid along patterns, simulated and measured",
    recipe: &Free::new(Laying::of_table_5_2, write),
};

/// Index of the medium friction, 0.4.
const MEDIUM: usize = 1;

/// A row of the CSV file; lengths in cm, as in the thesis.
#[derive(Serialize, Deserialize)]
pub(super) struct Row {
    rod: usize,
    rod_name: String,
    substrate: String,
    friction: f64,
    scheme: String,
    pattern: String,
    status: String,
    mean_cm: Option<f64>,
    deviation_cm: Option<f64>,
    thesis_mean_cm: f64,
    thesis_deviation_cm: f64,
    largest_friction_demand: Option<f64>,
    share_above_friction: Option<f64>,
    largest_sliding_cm: Option<f64>,
    largest_gripper_force_n: Option<f64>,
    simulated_s: f64,
    wall_time_s: f64,
    cpu_time_s: Option<f64>,
}

impl Row {
    fn is_optimal(&self) -> bool {
        self.scheme == "optimal"
    }

    /// Whether the pattern needs more friction than the table provides.
    fn is_marked(&self) -> bool {
        self.share_above_friction.is_some_and(|share| share > 0.0)
    }

    /// Simulated and measured distances, as text.
    fn cell(&self) -> String {
        let mark = if self.is_marked() && self.is_optimal() {
            "*"
        } else {
            ""
        };
        format!(
            "{} ± {}{mark}<br>{:.2} ± {:.2}",
            number(self.mean_cm, 2),
            number(self.deviation_cm, 2),
            self.thesis_mean_cm,
            self.thesis_deviation_cm
        )
    }

    fn is_worse(&self) -> bool {
        self.mean_cm.is_none_or(|mean| mean > self.thesis_mean_cm)
    }
}

/// Writes table and figures.
fn write(page: &mut Page, cases: &[Case<Laying>]) -> Result<()> {
    let rows: Vec<Row> = cases.iter().map(row).collect();
    page.text(
        "Mean distance and standard deviation in cm between the laid rod and its pattern at equal arc lengths, over 50 \
         points without the lead-in (thesis Eq. 5.11, the deviations squared). Below each value is the value measured \
         in the thesis. The thesis calls friction low, medium and high: 0.2, 0.4 and 0.8 here. Line, circle and sine \
         are as long and as wide as those of the thesis, letters were redrawn. A star marks patterns that need more \
         friction somewhere than the table has, for their curvature (thesis Eq. 5.2) or at the contact node, so that \
         the rod must slide there.",
    );
    page.table(patterns(&rows));
    page.text(&verdict(&rows));
    page.csv(&rows)?;
    for rod in 0..RODS.len() {
        if let Some(figure) = outlines_figure("tab5.2", rod, MEDIUM, cases)? {
            page.figure(&figure)?;
        }
    }
    Ok(())
}

/// Result of a run, with the measurement.
pub(super) fn row(case: &Case<Laying>) -> Row {
    let run = &case.run;
    let rod = &RODS[run.rod];
    let substrate = rod.substrates[run.friction];
    let (outcome, ended) = (case.laid(), case.laid_to_the_end());
    let cm = |metres: f64| 1e2 * metres;
    let (thesis_mean_cm, thesis_deviation_cm) = measured(run, substrate);
    Row {
        rod: rod.number,
        rod_name: rod.name.into(),
        substrate: in_words(substrate).into(),
        friction: FRICTIONS[run.friction],
        scheme: run.scheme().into(),
        pattern: PATTERNS[run.pattern].name.into(),
        status: case.status().into(),
        mean_cm: ended.and_then(|laid| laid.mean_error_m).map(cm),
        deviation_cm: ended.and_then(|laid| laid.error_deviation_m).map(cm),
        thesis_mean_cm,
        thesis_deviation_cm,
        largest_friction_demand: outcome.map(|laid| laid.largest_friction_demand),
        share_above_friction: outcome.map(|laid| laid.share_above_friction),
        largest_sliding_cm: outcome.map(|laid| cm(laid.largest_sliding_m)),
        largest_gripper_force_n: outcome.map(|laid| laid.largest_gripper_force_n),
        simulated_s: case.record.outcome.simulated_time,
        wall_time_s: case.record.wall_time,
        cpu_time_s: case.record.cpu_time,
    }
}

fn in_words(substrate: Substrate) -> &'static str {
    match substrate {
        Substrate::Fabric => "fabric",
        Substrate::Steel => "steel",
        Substrate::Foam => "foam",
    }
}

/// A table with a line for each rod, substrate and scheme, and a column for each pattern.
pub(super) fn patterns(rows: &[Row]) -> MarkdownTable<'static> {
    let names = PATTERNS.iter().map(|pattern| pattern.name);
    let heads_of = |row: &Row| (row.rod, row.friction, row.is_optimal());
    let line = |rows: &[Row]| {
        let first = &rows[0];
        let heads = [
            format!("#{} {}", first.rod, first.rod_name),
            format!("{}, {}", first.substrate, first.friction),
            first.scheme.clone(),
        ];
        heads
            .into_iter()
            .chain(rows.iter().map(Row::cell))
            .collect()
    };
    MarkdownTable {
        header: ["rod", "table", "scheme"]
            .into_iter()
            .chain(names)
            .collect(),
        lines: rows
            .chunk_by(|a, b| heads_of(a) == heads_of(b))
            .map(line)
            .collect(),
    }
}

/// Summary of all results.
fn verdict(rows: &[Row]) -> String {
    let mean = |wanted: fn(&&Row) -> bool, value: fn(&Row) -> Option<f64>| {
        mean(rows.iter().filter(wanted).filter_map(value))
    };
    let simulated: fn(&Row) -> _ = |row| row.mean_cm;
    let measured: fn(&Row) -> _ = |row| Some(row.thesis_mean_cm);
    let optimal = mean(|row| row.is_optimal(), simulated);
    let intuitive = mean(|row| !row.is_optimal(), simulated);
    let held = mean(|row| row.is_optimal() && !row.is_marked(), simulated);
    let ratio = intuitive.zip(optimal).map(|(i, o)| i / o);
    let of_optimal = || rows.iter().filter(|row| row.is_optimal());
    let worse: Vec<&Row> = of_optimal().filter(|row| row.is_worse()).collect();
    let marked = worse.iter().filter(|row| row.is_marked()).count();
    let open = rows.iter().filter(|row| row.mean_cm.is_none()).count();
    let times = rows.iter();
    let times = times.filter_map(|row| Some(row.cpu_time_s? / row.simulated_s));
    let slowest = largest(times);
    let total: f64 = rows.iter().map(|row| row.wall_time_s).sum();
    let mut text = format!(
        "On average the optimal scheme lies {} cm from the pattern ({} cm where friction suffices), the intuitive one \
         {} cm: {} times as far; the thesis measured {} and {} cm. Of {} entries of the optimal scheme {} lie farther from the \
         pattern than measured",
        number(optimal, 3),
        number(held, 3),
        number(intuitive, 2),
        number(ratio, 1),
        number(mean(|row| row.is_optimal(), measured), 2),
        number(mean(|row| !row.is_optimal(), measured), 2),
        of_optimal().count(),
        worse.len(),
    );
    if !worse.is_empty() {
        let names: Vec<String> = worse
            .iter()
            .map(|row| format!("{} of #{} at {}", row.pattern, row.rod, row.friction))
            .collect();
        text += &format!(
            ", {marked} of which need more friction than the table has: {}",
            names.join(", ")
        );
    }
    text += ".";
    if open > 0 {
        text += &format!(" {open} runs did not finish.");
    }
    text += &format!(
        " All took {total:.0} s of wall time, a simulation at most {slowest:.2} s of processor time for each second of motion."
    );
    text
}
