//! Figure 6.5: effect of material, gravity, speed and jitter on the buckling of a helical rod.

use super::manipulated_helix::{DIRECTION, ManipulatedHelix, UNDISTURBED, observations};
use super::prelude::*;
use rodlab_engine::mechanics::kirchhoff::critical_distance;
use rodlab_lab::experiment::helix::manipulation::{Buckling, Observation};

pub(super) const ARTIFACT: Artifact = Artifact {
    name: "fig6.5",
    title: "Figure 6.5: disturbances of a manipulated helical rod",
    recipe: &Tabled::new(
        ManipulatedHelix::of_figure_6_5,
        Rows::Series(rows),
        write,
        figures,
    ),
};

/// A row of the CSV file: a run at an output time.
#[derive(Serialize, Deserialize)]
struct Row {
    poissons_ratio: f64,
    youngs_modulus_pa: f64,
    /// L_gb/L; empty without gravity.
    gravito_bending_length_over_length: Option<f64>,
    speed_m_s: f64,
    jitter_over_length: f64,
    distance: f64,
    error: f64,
    kinetic_energy_over_that_of_the_end: f64,
}

/// A parameter, and a function that resets it to its value for the undisturbed rod.
struct Parameter {
    name: &'static str,
    symbol: &'static str,
    /// Text before and after its value in a figure.
    around: [&'static str; 2],
    value: fn(&ManipulatedHelix) -> f64,
    set_back: fn(&mut ManipulatedHelix),
}

/// The parameters, in the order of the thesis.
const PARAMETERS: [Parameter; 5] = [
    Parameter {
        name: "poissons_ratio",
        symbol: "ν",
        around: ["ν = ", ""],
        value: |run| run.poissons_ratio,
        set_back: |run| run.poissons_ratio = UNDISTURBED.poissons_ratio,
    },
    Parameter {
        name: "youngs_modulus",
        symbol: "E/GPa",
        around: ["E = ", " GPa"],
        value: |run| run.youngs_modulus * 1e-9,
        set_back: |run| run.youngs_modulus = UNDISTURBED.youngs_modulus,
    },
    Parameter {
        name: "gravity",
        symbol: "L_gb/L",
        around: ["L_{gb}/L = ", ""],
        value: |run| run.gravito_bending_length,
        set_back: |run| run.gravito_bending_length = UNDISTURBED.gravito_bending_length,
    },
    Parameter {
        name: "speed",
        symbol: "v/(m/s)",
        around: ["v = ", " m/s"],
        value: |run| run.speed,
        set_back: |run| run.speed = UNDISTURBED.speed,
    },
    Parameter {
        name: "jitter",
        symbol: "d/L",
        around: ["d/L = ", ""],
        value: |run| run.jitter,
        set_back: |run| run.jitter = UNDISTURBED.jitter,
    },
];

/// Writes the errors over distancein one figure for each parameter, and how the rods buckle.
fn write(page: &mut Page, _: &[Case<ManipulatedHelix>], rows: &[Row]) -> Result<()> {
    let predicted = critical_distance(&DIRECTION).map(|critical| critical.distance);
    page.text(&format!(
        "Error e (Eq. 6.1: mean distance of the nodes from the helix over its radius) of a rod of length 1 m whose end \
         moves along (κ, τ, ω) ∝ (1, 1, 1), by implicit Euler steps. Dashed: the loss of stability by conjugate \
         points, ‖(κ, τ, ω)‖ = {}. Except for the varied parameter, E = 1.12 GPa, ν = 0.33, no gravity, v = 2.5 mm/s, \
         no jitter. v is the speed of the end along its path; c = 1/(1 + ν). Jitter adds to each component of its \
         position a random number of at most d/√3, redrawn every 0.2 of distance and linear between. Gravity is in −z \
         and grows to its strength in the first tenth of the time. The rod may pass through itself.",
        number(predicted, 4)
    ));
    page.text(
        "A rod counts as buckled where e passes 0.1. It snaps if its kinetic energy at a later output exceeds ten \
         times that of a rod that moves as a whole with its end, and buckles continuously otherwise. The same rule \
         applies to a rod that gravity bends away from the helix from the beginning, so its first distance is not a \
         loss of stability.",
    );
    let seen = seen(rows);
    for parameter in &PARAMETERS {
        page.table(columns! { (run, observations) in varying(parameter, &seen);
            parameter.symbol => value_in_words((parameter.value)(run)),
            "Buckling" => Buckling::of(observations).kind(),
            "e passes 0.1 at" => number(Buckling::of(observations).deviates, 3),
            "over prediction" => number(over_prediction(observations, predicted), 4),
            "snap first observed at" => number(Buckling::of(observations).snaps, 3),
        });
        page.next_figure()?;
    }
    Ok(())
}

/// A run and its observations.
type Seen = (ManipulatedHelix, Vec<Observation>);

/// The runs of a table.
fn seen(rows: &[Row]) -> Vec<Seen> {
    let runs = rows.chunk_by(|a, b| a.run() == b.run());
    runs.map(|rows| (rows[0].run(), rows.iter().map(Row::observation).collect()))
        .collect()
}

/// The figures of all parameters.
fn figures(rows: &[Row]) -> Vec<PageFigure> {
    let predicted = critical_distance(&DIRECTION).map(|critical| critical.distance);
    let seen = seen(rows);
    let figure = |parameter| figure(parameter, &varying(parameter, &seen), predicted);
    PARAMETERS.iter().map(figure).collect()
}

/// The runs that differ from the undisturbed one at most in a parameter, ordered by this
/// parameter.
fn varying<'a>(parameter: &Parameter, seen: &'a [Seen]) -> Vec<&'a Seen> {
    let of_parameter = seen.iter();
    let of_parameter = of_parameter.filter(|(run, _)| differs_at_most_in(run, parameter));
    let mut of_parameter: Vec<&Seen> = of_parameter.collect();
    of_parameter.sort_by(|(a, _), (b, _)| (parameter.value)(a).total_cmp(&(parameter.value)(b)));
    of_parameter
}

impl Row {
    /// The run to which the row belongs.
    fn run(&self) -> ManipulatedHelix {
        let gravito_bending_length = self.gravito_bending_length_over_length;
        ManipulatedHelix {
            poissons_ratio: self.poissons_ratio,
            youngs_modulus: self.youngs_modulus_pa,
            gravito_bending_length: gravito_bending_length.unwrap_or(f64::INFINITY),
            speed: self.speed_m_s,
            jitter: self.jitter_over_length,
            ..UNDISTURBED
        }
    }

    fn observation(&self) -> Observation {
        Observation {
            distance: self.distance,
            error: self.error,
            kinetic_energy: self.kinetic_energy_over_that_of_the_end,
        }
    }
}

fn rows(case: &Case<ManipulatedHelix>) -> Result<Vec<Row>> {
    let run = &case.run;
    let gravito_bending_length = Some(run.gravito_bending_length);
    let row = |at: &Observation| Row {
        poissons_ratio: run.poissons_ratio,
        youngs_modulus_pa: run.youngs_modulus,
        gravito_bending_length_over_length: gravito_bending_length.filter(|l| l.is_finite()),
        speed_m_s: run.speed,
        jitter_over_length: run.jitter,
        distance: at.distance,
        error: at.error,
        kinetic_energy_over_that_of_the_end: at.kinetic_energy,
    };
    Ok(observations(case)?.iter().map(row).collect())
}

/// Whether a run differs from the undisturbed one in at most one parameter.
fn differs_at_most_in(run: &ManipulatedHelix, parameter: &Parameter) -> bool {
    let mut set_back = *run;
    (parameter.set_back)(&mut set_back);
    let extent = ManipulatedHelix {
        farthest: run.farthest,
        edges: run.edges,
        ..UNDISTURBED
    };
    set_back == extent
}

fn value_in_words(value: f64) -> String {
    if value.is_finite() {
        // Rounding removes the error of a change of unit.
        ((1e6 * value).round() / 1e6).to_string()
    } else {
        "∞".to_owned()
    }
}

/// Ratio of the distance at which the rod deviates from the helix to the critical distance in
/// theory.
fn over_prediction(observations: &[Observation], predicted: Option<f64>) -> Option<f64> {
    Some(Buckling::of(observations).deviates? / predicted?)
}

fn figure(parameter: &Parameter, runs: &[&Seen], predicted: Option<f64>) -> PageFigure {
    let error = |(run, observations): &&Seen| {
        let [before, behind] = parameter.around;
        let value = value_in_words((parameter.value)(run));
        let name = format!("{before}{value}{behind}");
        curve(name, observations, |at| (at.distance, at.error))
    };
    let mut curves: Vec<Curve> = runs.iter().map(error).collect();
    let seen = runs.iter().flat_map(|(_, observations)| observations);
    let errors = seen.map(|at| at.error).filter(|error| *error > 0.0);
    let largest = largest(errors.clone());
    let smallest = errors.fold(largest, f64::min);
    if let Some(predicted) = predicted {
        let line = vec![(predicted, Some(smallest)), (predicted, Some(largest))];
        curves.push(Curve::new("predicted", line).looking(Look::Dashed).like(6));
    }
    let plot = plot("Mean distance from the helix over its radius, e", curves);
    let style = PlotStyle {
        height: 22.0,
        vertical: vec![AxisScale::Logarithmic],
        ..PlotStyle::default()
    };
    let caption = format!(
        "Error e over distance, {} varies; dashed, the loss of stability by theory",
        parameter.symbol
    );
    PageFigure::new(
        &format!("fig6.5_{}", parameter.name),
        &caption,
        styled_line_plots([plot], "Distance ‖(κ, τ, ω)‖", style),
    )
}
