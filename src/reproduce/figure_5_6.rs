//! Figure 5.6: optimal grasps over curvature, suspended length and stretching stiffness, exact and
//! from the network.

use super::grasp_grid::{GraspGrid, LENGTH, STIFFNESS};
use super::prelude::*;
use super::table::rows_of;
use rodlab_engine::mechanics::rotation;
use rodlab_files::figure::Figure;
use rodlab_planning::plan::grasp::{GraspProblem, NeuralGrasps};

pub(super) const ARTIFACT: Artifact = Artifact {
    name: "fig5.6",
    title: "Figure 5.6: optimal grasps over curvature, length and stiffness",
    recipe: &Tabled::new(
        GraspGrid::of_figure_5_6,
        Rows::Series(rows_of_case),
        write,
        figures,
    ),
};

/// Columns read from `samples.csv`.
#[derive(Deserialize)]
struct Sample {
    suspended_length: f64,
    curvature: f64,
    stretch_compliance: f64,
    x: Option<f64>,
    y: Option<f64>,
    z: Option<f64>,
    rotation_x: Option<f64>,
    rotation_y: Option<f64>,
    rotation_z: Option<f64>,
}

/// A row of the CSV file: lengths in L_gb, rotation vectors in rad; first the exact values, then
/// those of the network.
#[derive(Clone, Serialize, Deserialize)]
struct Row {
    part: String,
    suspended_length: f64,
    curvature: f64,
    stretch_compliance: f64,
    x: f64,
    y: f64,
    z: f64,
    rotation_x: f64,
    rotation_y: f64,
    rotation_z: f64,
    network_x: Option<f64>,
    network_y: Option<f64>,
    network_z: Option<f64>,
    network_rotation_x: Option<f64>,
    network_rotation_y: Option<f64>,
    network_rotation_z: Option<f64>,
}

/// A quantity: its label, its exact value, and that of the network.
type Quantity = (&'static str, fn(&Row) -> f64, fn(&Row) -> Option<f64>);

/// The drawn quantities.
const QUANTITIES: [Quantity; 6] = [
    ("x/L_{gb}", |row| row.x, |row| row.network_x),
    ("y/L_{gb}", |row| row.y, |row| row.network_y),
    ("z/L_{gb}", |row| row.z, |row| row.network_z),
    ("e_{x}", |row| row.rotation_x, |row| row.network_rotation_x),
    ("e_{y}", |row| row.rotation_y, |row| row.network_rotation_y),
    ("e_{z}", |row| row.rotation_z, |row| row.network_rotation_z),
];

/// Writes table and figures.
fn write(page: &mut Page, _: &[Case<GraspGrid>], rows: &[Row]) -> Result<()> {
    page.text(&format!(
        "Optimal grasps over the curvature κ̄ of the pattern, for suspended lengths l̄_s at k̄_s = {STIFFNESS:.0} \
         (Fig. 5.6a) and for stretching stiffnesses k̄_s at l̄_s = {LENGTH} (Fig. 5.6b): place of the gripper in L_gb \
         and rotation vector e in rad, in the frame of the contact node. Lines are exact, by collocation; marks are \
         the outputs of the network of this program. The thesis draws surfaces and does not give their ranges."
    ));
    let header = [
        "part",
        "grasps",
        "position, mean error in L_gb",
        "largest",
        "rotation, mean error in °",
        "largest",
    ];
    let lines: Vec<Vec<String>> = ["a", "b"].iter().map(|part| line(part, rows)).collect();
    page.lines(&header, &lines);
    Ok(())
}

fn rows_of_case(case: &Case<GraspGrid>) -> Result<Vec<Row>> {
    let samples: Vec<Sample> = rows_of(&case.directory.join("samples.csv"))?;
    let problems = samples.iter().map(|sample| {
        let stiffness = 1.0 / sample.stretch_compliance;
        GraspProblem::new(sample.suspended_length, sample.curvature, stiffness)
    });
    let problems: Vec<GraspProblem> = problems
        .collect::<Result<_, _>>()
        .expect("samples of grasps are in range");
    let learned = NeuralGrasps::built_in().predict(&problems);
    let learned = learned.expect("the network of the program answers");
    let part = if case.run.is_over_length { "a" } else { "b" };
    let row = |(sample, learned): (Sample, Option<_>)| {
        let (place, vector) = learned
            .map(|grasp: rodlab_planning::plan::grasp::LearnedGrasp| {
                (grasp.position, rotation::to_vector(&grasp.rotation))
            })
            .unzip();
        Some(Row {
            part: part.into(),
            suspended_length: sample.suspended_length,
            curvature: sample.curvature,
            stretch_compliance: sample.stretch_compliance,
            x: sample.x?,
            y: sample.y?,
            z: sample.z?,
            rotation_x: sample.rotation_x?,
            rotation_y: sample.rotation_y?,
            rotation_z: sample.rotation_z?,
            network_x: place.map(|place| place.x),
            network_y: place.map(|place| place.y),
            network_z: place.map(|place| place.z),
            network_rotation_x: vector.map(|vector| vector.x),
            network_rotation_y: vector.map(|vector| vector.y),
            network_rotation_z: vector.map(|vector| vector.z),
        })
    };
    Ok(samples.into_iter().zip(learned).filter_map(row).collect())
}

fn line(part: &str, rows: &[Row]) -> Vec<String> {
    let error = |row: &Row, quantities: &[Quantity]| -> Option<f64> {
        let differences = quantities
            .iter()
            .map(|(_, exact, network)| Some((network(row)? - exact(row)).powi(2)));
        differences.sum::<Option<f64>>().map(f64::sqrt)
    };
    let rows: Vec<&Row> = rows.iter().filter(|row| row.part == part).collect();
    let mut line = vec![part.to_owned(), rows.len().to_string()];
    for (quantities, unit) in [
        (&QUANTITIES[..3], 1.0),
        (&QUANTITIES[3..], 1f64.to_degrees()),
    ] {
        let errors = rows.iter().filter_map(|row| error(row, quantities));
        let largest = largest(errors.clone());
        line.push(number(unit * mean(errors).unwrap_or(0.0), 4));
        line.push(number(unit * largest, 4));
    }
    line
}

/// A quantity over the curvature, as a curve for each value of the parameter of a part. If
/// `is_difference`, the first curve is subtracted.
fn over_curvature(
    rows: &[Row],
    part: &str,
    value: fn(&Row) -> f64,
    name: &dyn Fn(f64) -> String,
    is_difference: bool,
) -> Figure {
    let rows: Vec<&Row> = rows.iter().filter(|row| row.part == part).collect();
    let mut values: Vec<f64> = rows.iter().map(|row| value(row)).collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    let plots = QUANTITIES.map(|(label, exact, network)| {
        let first = |curvature: f64| {
            let same = |row: &&&Row| value(row) == values[0] && row.curvature == curvature;
            let first = rows.iter().find(same).map(|row| exact(row));
            first.filter(|_| is_difference).unwrap_or(0.0)
        };
        let mut curves: Vec<Curve> = Vec::new();
        let mut marks = Vec::new();
        for (index, &chosen) in values.iter().enumerate() {
            let of_value = || rows.iter().filter(move |row| value(row) == chosen);
            let exact = |row: &&Row| (row.curvature, exact(row) - first(row.curvature));
            curves.push(curve(name(chosen), of_value(), exact));
            // Only every fourth curve, for readability.
            let seen = of_value().step_by(4);
            let seen = seen.map(|row| {
                let learned = network(row).map(|learned| learned - first(row.curvature));
                (row.curvature, learned)
            });
            let name = if index == 0 { "network" } else { "" };
            marks.push(
                Curve::new(name, seen.collect())
                    .looking(Look::OpenMarks)
                    .like(index),
            );
        }
        curves.extend(marks);
        let label = if is_difference {
            format!("Δ{label}")
        } else {
            label.to_owned()
        };
        plot(label, curves)
    });
    line_plots(plots, "curvature κ̄")
}

fn figures(rows: &[Row]) -> Vec<PageFigure> {
    let by_length = over_curvature(
        rows,
        "a",
        |row| row.suspended_length,
        &|length| format!("l̄_{{s}} = {length:.1}"),
        false,
    );
    let by_compliance = over_curvature(
        rows,
        "b",
        |row| row.stretch_compliance,
        &|compliance| format!("1/k̄_{{s}} = {compliance:.5}"),
        true,
    );
    vec![
        PageFigure::new(
            "fig5.6a",
            "Grasps over the curvature for five suspended lengths, exact (lines) and by the network (open marks of the same \
             colours)",
            by_length,
        ),
        PageFigure::new(
            "fig5.6b",
            "Effect of stretching on grasps over the curvature: exact grasps (lines) and those of the network (open \
             marks of the same colours) at five stretching compliances, less the exact grasp of a rod that does not stretch",
            by_compliance,
        ),
    ]
}
