//! Figure 5.5: two optimal grasps that are pushed sideways.

use super::prelude::*;
use super::sideways_push::{RADIUS, SidewaysPush, UNIT, bending_stiffness, push_at};
use rodlab_files::results::{read_nodes, read_series_as};

pub(super) const ARTIFACT: Artifact = Artifact {
    name: "fig5.5",
    title: "Figure 5.5: two optimal grasps pushed sideways",
    recipe: &Tabled::new(
        SidewaysPush::of_figure_5_5,
        Rows::Series(rows_of_case),
        write,
        figures,
    ),
};

/// A row of the CSV file; lengths in L_gb.
#[derive(Clone, Serialize, Deserialize)]
struct Row {
    minimum: usize,
    push: f64,
    largest_sideways: f64,
    /// F̄_y = F_y h²/EI of the gripper on the rod.
    force: f64,
}

/// Columns read from `series.csv`.
#[derive(Deserialize)]
struct SeriesRow {
    time_s: f64,
    gripper_force_y_n: Option<f64>,
}

/// Ratio of sideways displacement to push above which a rod has snapped.
const SNAPPED: f64 = 3.0;

/// Writes table and figure.
fn write(page: &mut Page, _: &[Case<SidewaysPush>], rows: &[Row]) -> Result<()> {
    page.text(
        "A suspended rod of length l̄_s = 17.68 in the local minima 1 and 2 of thesis Fig. 5.4, both of which are solutions of \
         Eq. 5.3, held at both ends, while its gripper is slowly pushed sideways by Δȳ: largest sideways displacement of the \
         rod and force of the gripper in the dynamic simulation, lengths in L_gb.",
    );
    let last = |minimum: usize| rows.iter().rfind(|row| row.minimum == minimum);
    let snapped = |minimum: usize| {
        let of = rows.iter().filter(|row| row.minimum == minimum);
        let mut beyond =
            of.filter(|row| row.push > 0.0 && row.largest_sideways > SNAPPED * row.push.max(0.12));
        beyond.next().map(|row| row.push)
    };
    page.table(columns! { minimum in [1, 2];
        "local minimum" => minimum.to_string(),
        "snaps" => snapped(minimum).map_or("no".into(), |push| format!("at Δȳ = {push:.3}")),
        "last push Δȳ" => number(last(minimum).map(|row| row.push), 2),
        "largest sideways displacement then" => number(last(minimum).map(|row| row.largest_sideways), 3),
    });
    Ok(())
}

/// Largest sideways displacement at a push, L_gb; `None` if the run ended before that push.
pub(super) fn largest_sideways_at(case: &Case<SidewaysPush>, push: f64) -> Result<Option<f64>> {
    let rows = rows_of_case(case)?;
    let there = rows.iter().find(|row| row.push >= push * (1.0 - 1e-9));
    Ok(there.map(|row| row.largest_sideways))
}

fn rows_of_case(case: &Case<SidewaysPush>) -> Result<Vec<Row>> {
    let nodes = case.manifest.rods.iter().map(|rod| rod.nodes).sum();
    let outputs = read_nodes(&case.directory, nodes)?;
    let series = read_series_as::<SeriesRow>(&case.directory)?;
    let force_unit = RADIUS.powi(2) / bending_stiffness();
    let row = |(output, series): (rodlab_files::results::NodePositions, SeriesRow)| Row {
        minimum: case.run.minimum,
        push: push_at(series.time_s),
        largest_sideways: largest(output.positions.iter().map(|node| node.y.abs())) / UNIT,
        force: series.gripper_force_y_n.unwrap_or(0.0) * force_unit,
    };
    Ok(outputs.into_iter().zip(series).map(row).collect())
}

fn figures(rows: &[Row]) -> Vec<PageFigure> {
    let over_push = |label: &str, value: fn(&Row) -> f64| {
        let curve = |minimum: usize| {
            let of = rows.iter().filter(|row| row.minimum == minimum);
            let name = format!("local minimum {minimum}");
            curve(name, of, |row| (row.push, value(row)))
        };
        plot(label, [1, 2].map(curve))
    };
    let figure = line_plots(
        [
            over_push("largest |y|/L_{gb}", |row| row.largest_sideways),
            over_push("F̄_{y} = F_{y} h²/EI", |row| row.force),
        ],
        "Push of the gripper, Δy\u{304} = Δy/L_{gb}",
    );
    vec![PageFigure::new(
        "fig5.5",
        "Two optimal grasps pushed sideways",
        figure,
    )]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reproduce::ReproduceOptions;
    use crate::reproduce::cases::run_all;
    use rodlab_files::figure::FigureOptions;

    #[test]
    fn a_rod_snaps_from_the_second_local_minimum_and_follows_in_the_first() {
        let directory = tempfile::tempdir().unwrap();
        let options = ReproduceOptions {
            directory: directory.path().to_owned(),
            quick: true,
            jobs: 2,
            command_line: Vec::new(),
            figures: FigureOptions::default(),
        };
        let runs = SidewaysPush::up_to(0.06);
        let cases = run_all(&runs, &options, &|_| {}).unwrap();
        let [first, second] = [0, 1].map(|index| {
            let rows = rows_of_case(&cases[index]).unwrap();
            rows.last().unwrap().clone()
        });
        assert!((first.push - 0.06).abs() < 1e-9);
        assert!(first.largest_sideways < 0.07, "{}", first.largest_sideways);
        assert!(second.largest_sideways > 0.5, "{}", second.largest_sideways);
    }
}
