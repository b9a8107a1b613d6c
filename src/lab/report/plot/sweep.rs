//! The figure of a sweep: outcomes over the swept parameters.

use super::curves::{Grouping, curves, in_unit, quantity, value_count, varies};
use crate::report::case_folders::parameter_columns;
use rodlab_files::figure::{AxisScale, Figure, LinePlot, PlotStyle, styled_line_plots};
use rodlab_files::results::{SummaryRow, Table};

/// Maximum number of outcomes in a figure; the user can request others by name.
const OUTCOMES: usize = 6;

/// Outcomes that describe the computational cost; they are drawn last.
const EFFORT: [&str; 6] = [
    "simulated_time_s",
    "steps",
    "retries",
    "newton_iterations_mean",
    "newton_iterations_mean_with_contact",
    "fluid_iterations_mean",
];

/// Draws every outcome that varies over the swept number with the most values, with one curve for
/// each combination of the other parameters. `None` if no number is swept or no outcome varies.
///
/// Axes are logarithmic if their numbers are positive and span more than a decade.
pub(super) fn sweep_figure(summary: &Table) -> Option<Figure> {
    let parameters: Vec<&str> = parameter_columns(summary)
        .filter(|key| varies(summary, key))
        .collect();
    let numbers = parameters.iter().filter(|key| is_numeric(summary, key));
    let across = *numbers.rev().max_by_key(|key| value_count(summary, key))?;
    let groups: Vec<&str> = parameters
        .iter()
        .copied()
        .filter(|key| *key != across)
        .collect();
    let known: Vec<&str> = parameter_columns(summary)
        .chain(["case", "status"])
        .collect();
    let (effort, mut outcomes): (Vec<&str>, Vec<&str>) = summary
        .columns()
        .iter()
        .map(String::as_str)
        .filter(|column| {
            !known.contains(column) && is_numeric(summary, column) && varies(summary, column)
        })
        .partition(|column| EFFORT.contains(column));
    // Columns of probes or of the experiment come before the columns that every run has.
    let of_every_run = SummaryRow::columns();
    outcomes.sort_by_key(|column| of_every_run.iter().any(|known| known == column));
    outcomes.extend(effort);
    outcomes.truncate(OUTCOMES);
    if outcomes.is_empty() {
        return None;
    }
    let grouping = Grouping::of(summary, &groups);
    let across = (across, quantity(summary, across));
    let horizontal = in_unit(summary.numbers(across.0)?, &across.1);
    let plots: Vec<LinePlot> = outcomes
        .iter()
        .filter_map(|outcome| {
            Some(LinePlot::new(
                quantity(summary, outcome).label(),
                curves(&horizontal, &summary.numbers(outcome)?, &grouping),
            ))
        })
        .collect();
    let style = PlotStyle {
        horizontal: AxisScale::fitting(horizontal.into_iter().flatten()),
        vertical: plots.iter().map(fitting_scale).collect(),
        ..PlotStyle::default()
    };
    Some(styled_line_plots(plots, &across.1.label(), style))
}

fn fitting_scale(plot: &LinePlot) -> AxisScale {
    let points = plot.curves.iter().flat_map(|curve| &curve.points);
    AxisScale::fitting(points.filter_map(|(_, y)| *y))
}

/// Whether a column holds numbers and no text.
fn is_numeric(table: &Table, column: &str) -> bool {
    let cells = table.column(column).into_iter().flatten();
    let mut cells = cells.filter(|cell| !cell.is_empty()).peekable();
    cells.peek().is_some() && cells.all(|cell| cell.parse::<f64>().is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;
    use rodlab_files::figure::Paper;

    fn table(text: &str) -> Table {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("summary.csv");
        std::fs::write(&path, text).unwrap();
        Table::read(&path).unwrap()
    }

    #[test]
    fn outcomes_that_vary_are_drawn_over_the_first_swept_number_by_the_second() {
        let svg = sweep_figure(&table(
            "case,contact.model,contact.friction,status,steps,peak_force_n,constant_m\n\
             a,imc,0.1,finished,10,1.0,5\nb,imc,0.2,finished,12,300.0,5\n\
             c,ipc,0.1,finished,11,2.0,5\nd,ipc,0.2,failed,9,,5\n",
        ))
        .unwrap()
        .svg(&Paper::default());
        for word in [
            "Contact friction",
            "contact model = imc",
            "contact model = ipc",
            "Peak force in N",
            "Steps",
        ] {
            assert!(svg.contains(word), "{word}");
        }
        assert!(!svg.contains("Constant") && !svg.contains("status"));
        // Disks, closed by a full turn, mark the first curve: two in each plot and one in the
        // legend.
        assert_eq!(svg.matches("0Z\" fill=\"#0072b2\"").count(), 2 + 2 + 1);
        assert!(svg.find("Peak force").unwrap() < svg.find("Steps").unwrap());
    }

    #[test]
    fn probes_precede_the_columns_of_every_run() {
        let svg = sweep_figure(&table(
            "case,contact.friction,status,elastic_energy_j,min_distance_m,tip_z_m\n\
             a,0.1,finished,1.0,3.0,5\nb,0.2,finished,2.0,4.0,6\n",
        ));
        let svg = svg.unwrap().svg(&Paper::default());
        let place = |words: &str| svg.find(&format!("aria-label=\"{words}")).expect(words);
        assert!(place("Tip z") < place("Elastic energy"));
        assert!(place("Elastic energy") < place("Min distance"));
    }

    #[test]
    fn without_a_swept_number_there_is_no_figure() {
        assert_eq!(
            sweep_figure(&table("case,status,steps\nmain,finished,3\n")),
            None
        );
        let words = "case,contact.model,status,steps\na,imc,finished,3\nb,ipc,finished,4\n";
        assert_eq!(sweep_figure(&table(words)), None);
    }
}
