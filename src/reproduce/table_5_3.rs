//! Table 5.3: trajectories with exact grasps and with the network; times and errors.

use super::laying::{Laying, PATTERNS, RODS};
use super::prelude::*;
use rodlab_files::results::SCENARIO;
use rodlab_lab::experiment::{DeploymentTables, from_text};
use rodlab_planning::plan::deployment::{
    DeployedRod, DeploymentError, GripperPose, OptimalGrasps, Scheme, network_trajectory,
    trajectory,
};
use rodlab_planning::plan::grasp::NeuralGrasps;
use rodlab_planning::plan::pattern::PatternPoint;
use std::time::Instant;

pub(super) const ARTIFACT: Artifact = Artifact {
    name: "tab5.3",
    title: "Table 5.3: trajectories by exact grasps and by the network",
    recipe: &Tabled::new(Laying::of_table_5_3, Rows::All(rows), write, figures),
};

/// Number of poses along a letter, as in the thesis.
const POSES: usize = 190;
/// Number of timings of a trajectory, of which the fastest is used.
const REPEATS: usize = 10;
/// Times of the solvers of the thesis in the same table, s.
const THESIS_EXACT_S: [f64; 2] = [666.0, 4777.0];
const THESIS_NEURAL_S: [f64; 2] = [0.391, 0.431];

/// A row of the CSV file.
#[derive(Clone, Serialize, Deserialize)]
struct Row {
    rod: usize,
    rod_name: String,
    pattern: String,
    poses: usize,
    out_of_range: usize,
    exact_ms: f64,
    neural_ms: f64,
    mean_position_error: f64,
    largest_position_error: f64,
    mean_position_error_m: f64,
    mean_angle_degrees: f64,
    largest_angle_degrees: f64,
    laid_exact_cm: Option<f64>,
    laid_neural_cm: Option<f64>,
}

/// Writes table and figure.
fn write(page: &mut Page, _: &[Case<Laying>], rows: &[Row]) -> Result<()> {
    page.text(&format!(
        "Trajectories of {POSES} poses along the patterns of Tab. 5.2, by exact grasps (collocation) and by the \
         network of this program, which was not trained on them: times of whole trajectories on one thread, the \
         fastest of {REPEATS}, and the difference of their poses. Poses for suspended lengths or curvatures outside \
         the training range of the network are exact in both, and are excluded from the errors. The last columns are \
         mean distances of simulated rods from their patterns (thesis Eq. 5.11) at the medium friction, laid along \
         each of the two trajectories. The thesis' solvers took {:.0} to {:.0} s and {} to {} s, with mean position \
         errors of 0.0007 to 0.0021 m.",
        THESIS_EXACT_S[0], THESIS_EXACT_S[1], THESIS_NEURAL_S[0], THESIS_NEURAL_S[1],
    ));
    page.table(columns! { row in rows;
        "rod" => format!("{} {}", row.rod, row.rod_name),
        "pattern" => row.pattern.clone(),
        "out of range" => row.out_of_range.to_string(),
        "exact, ms" => number(row.exact_ms, 1),
        "network, ms" => number(row.neural_ms, 1),
        "position, mean in L_gb" => number(row.mean_position_error, 4),
        "largest" => number(row.largest_position_error, 4),
        "rotation, mean in °" => number(row.mean_angle_degrees, 3),
        "largest" => number(row.largest_angle_degrees, 3),
        "laid exactly, cm" => number(row.laid_exact_cm, 3),
        "by the network, cm" => number(row.laid_neural_cm, 3),
    });
    page.text(&verdict(rows));
    Ok(())
}

fn rows(cases: &[Case<Laying>]) -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    for case in cases.iter().filter(|case| !case.run.is_neural) {
        let twin = |other: &&Case<Laying>| {
            other.run.is_neural
                && (other.run.rod, other.run.pattern) == (case.run.rod, case.run.pattern)
        };
        let laid = cases.iter().find(twin).and_then(Case::mean_error_cm);
        rows.push(row(case, laid)?);
    }
    Ok(rows)
}

fn row(case: &Case<Laying>, laid_neural_cm: Option<f64>) -> Result<Row> {
    let (points, rod) = planned(case);
    let (exact, exact_ms) =
        timed(|| trajectory(&points, &rod, Scheme::Optimal, OptimalGrasps::Exact));
    // These outputs of the network are not checked; `plan deployment` would check them.
    let (neural, neural_ms) = timed(|| network_trajectory(&points, &rod, NeuralGrasps::built_in()));
    let unit = rod.gravito_bending_length;
    let pairs = || {
        let pairs = exact.iter().zip(&neural);
        pairs.filter(|(_, neural)| neural.grasp.is_none())
    };
    let errors: Vec<[f64; 2]> = pairs()
        .map(|(exact, neural)| {
            let distance = (neural.position - exact.position).norm() / unit;
            let angle = neural.rotation.angle_to(&exact.rotation).to_degrees();
            [distance, angle]
        })
        .collect();
    let parts = |part: usize| errors.iter().map(move |error| error[part]);
    let mean = |part: usize| mean(parts(part)).unwrap_or(f64::NAN);
    let largest = |part: usize| largest(parts(part));
    Ok(Row {
        rod: RODS[case.run.rod].number,
        rod_name: RODS[case.run.rod].name.into(),
        pattern: PATTERNS[case.run.pattern].name.into(),
        poses: points.len(),
        out_of_range: points.len() - errors.len(),
        exact_ms,
        neural_ms,
        mean_position_error: mean(0),
        largest_position_error: largest(0),
        mean_position_error_m: mean(0) * unit,
        mean_angle_degrees: mean(1),
        largest_angle_degrees: largest(1),
        laid_exact_cm: case.mean_error_cm(),
        laid_neural_cm,
    })
}

/// The points of the pattern and the rod of a run.
fn planned(case: &Case<Laying>) -> (Vec<PatternPoint>, DeployedRod) {
    let text = std::fs::read_to_string(case.directory.join(SCENARIO));
    let text = text.expect("a run leaves its scenario");
    let loaded = from_text("laid", &text, &case.directory, &[]).expect("its scenario is one");
    let tables: &DeploymentTables = loaded
        .scenario
        .experiment
        .tables()
        .expect("a deployment has its tables");
    let deployment = &tables.deployment;
    let pattern = deployment.pattern.source().pattern();
    let pattern = pattern
        .expect("a pattern that was laid")
        .with_lead_in(deployment.lead_in);
    let spacing = pattern.length() / (POSES - 1) as f64;
    (
        pattern.sampled(spacing * (1.0 + 1e-9)),
        deployment.rod.deployed(),
    )
}

/// A trajectory, and the shortest time of its computation, ms.
fn timed(
    trajectory: impl Fn() -> Result<Vec<GripperPose>, DeploymentError>,
) -> (Vec<GripperPose>, f64) {
    let mut shortest = f64::INFINITY;
    let mut poses = Vec::new();
    for _ in 0..REPEATS {
        let begin = Instant::now();
        poses = trajectory().expect("a pattern that was laid has grasps");
        shortest = shortest.min(1e3 * begin.elapsed().as_secs_f64());
    }
    (poses, shortest)
}

/// Means over all trajectories, and the worst.
fn verdict(rows: &[Row]) -> String {
    let mean = |value: fn(&Row) -> f64| mean(rows.iter().map(value)).unwrap_or(f64::NAN);
    let largest = |value: fn(&Row) -> f64| largest(rows.iter().map(value));
    format!(
        "On average over all trajectories the network is {:.4} L_gb and {:.3}° off, at worst {:.4} L_gb and {:.2}°; it \
         takes {:.1} ms, the exact solver {:.1} ms.",
        mean(|row| row.mean_position_error),
        mean(|row| row.mean_angle_degrees),
        largest(|row| row.largest_position_error),
        largest(|row| row.largest_angle_degrees),
        mean(|row| row.neural_ms),
        mean(|row| row.exact_ms),
    )
}

fn figures(rows: &[Row]) -> Vec<PageFigure> {
    let over_patterns = |label: &str, value: fn(&Row) -> f64| {
        let curves = RODS.iter().map(|rod| {
            let rows = rows.iter().filter(|row| row.rod == rod.number).enumerate();
            curve(rod.name, rows, |(index, row)| {
                (index as f64 + 1.0, value(row))
            })
        });
        plot(label, curves.map(|curve| curve.looking(Look::Marks)))
    };
    let plots = [
        over_patterns("mean position error in L_{gb}", |row| {
            row.mean_position_error
        }),
        over_patterns("mean rotation error in degrees", |row| {
            row.mean_angle_degrees
        }),
    ];
    let names = PATTERNS.iter().map(|pattern| pattern.name);
    vec![PageFigure::new(
        "tab5.3",
        "Mean errors of the network's trajectories along each pattern",
        named_plots(plots, names),
    )]
}
