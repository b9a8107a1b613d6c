//! Errors of time steps relative to a reference solution with fine steps.

use super::bundling::{Bundling, Scheme, Step};
use super::difference::{Difference, curve, differences, figure, nodes_of};
use super::prelude::*;

pub(super) const ARTIFACT: Artifact = Artifact {
    name: "drag-steps",
    title: "Error of larger and automatic steps, two flagella",
    recipe: &Free::new(Bundling::of_drag_steps, write),
};

/// A row of the CSV file; differences are ē of thesis Eq. 2.28.
#[derive(Serialize)]
struct Row {
    scheme: &'static str,
    step: String,
    status: &'static str,
    steps: u64,
    iterations_per_step: f64,
    cpu_time_s: Option<f64>,
    first_contact_s: Option<f64>,
    /// Largest difference up to the first contact of the reference solution.
    difference_before_contact_radii: Option<f64>,
    /// Largest difference over the time that both runs reached.
    difference_radii: Option<f64>,
}

/// Writes the table and ē over time.
fn write(page: &mut Page, cases: &[Case<Bundling>]) -> Result<()> {
    let fine = nodes_of(&cases[0])?;
    let radius = cases[0].manifest.rods[0].radius;
    let contact = cases[0].record.outcome.first_contact;
    let (mut rows, mut curves) = (Vec::new(), Vec::new());
    for (index, case) in cases.iter().enumerate() {
        let differences = differences(&fine, &nodes_of(case)?, radius);
        rows.push(row(case, &differences, contact));
        if index > 0 {
            curves.push(named(&case.run, &differences));
        }
    }
    page.text(
        "ē is the mean distance of the nodes from the solution of the first row, in radii (thesis \
         Eq. 2.28), at the output times. The drag is linearised in each node's own velocity, which \
         is taken at the end of the step; the effect of the other nodes is that of their motion at \
         the start of the step for implicit Euler, and that of their predicted motion at its end \
         for backward differences.",
    );
    page.table(columns! { row in &rows;
        "Scheme" => row.scheme.to_owned(),
        "Step in s" => row.step.clone(),
        "Steps" => row.steps.to_string(),
        "Iterations per step" => number(row.iterations_per_step, 2),
        "Processor time in s" => number(row.cpu_time_s, 1),
        "First contact in s" => number(row.first_contact_s, 3),
        "Largest ē before contact" => number(row.difference_before_contact_radii, 3),
        "Largest ē" => number(row.difference_radii, 3),
    });
    page.csv(&rows)?;
    figure(
        page,
        "drag-steps",
        "Mean difference ē of the nodes from the finest solution; a colour for each step, marks where the scheme is \
         backward differences, broken lines where it is implicit Euler",
        curves,
    )
}

/// Steps with their own colours, for both schemes, s.
const STEPS: [f64; 5] = [1e-3, 2e-3, 5e-3, 1e-2, 2e-2];

/// ē of a runas a curve. The colour shows the step, the line style the scheme.
fn named(run: &Bundling, differences: &[Difference]) -> Curve {
    let step = match run.step {
        Step::Fixed(step) => format!("{step} s"),
        Step::Auto => "auto".into(),
    };
    let style_index = match run.step {
        Step::Fixed(step) => STEPS.iter().position(|known| *known == step),
        Step::Auto => None,
    };
    let (name, look) = match run.scheme {
        Scheme::BackwardDifferences => ("backward differences", Look::Line),
        Scheme::ImplicitEuler => ("implicit Euler", Look::Dashed),
    };
    let curve = curve(format!("{name}, {step}"), differences);
    curve.looking(look).like(style_index.unwrap_or(STEPS.len()))
}

fn row(case: &Case<Bundling>, differences: &[Difference], contact: Option<f64>) -> Row {
    let outcome = &case.record.outcome;
    let largest_until = |end: f64| {
        differences
            .iter()
            .filter(|row| row.time_s <= end)
            .map(|row| row.mean_difference_radii)
            .reduce(f64::max)
    };
    Row {
        scheme: case.run.scheme.key(),
        step: case.run.step.in_words(),
        status: case.status(),
        steps: outcome.steps,
        iterations_per_step: outcome.newton_iterations as f64 / outcome.steps as f64,
        cpu_time_s: case.record.cpu_time,
        first_contact_s: outcome.first_contact,
        difference_before_contact_radii: contact.and_then(largest_until),
        difference_radii: largest_until(f64::INFINITY),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_curves_of_drag_steps_look_alike() {
        let runs = Bundling::of_drag_steps(false);
        let curves: Vec<Curve> = runs[1..].iter().map(|run| named(run, &[])).collect();
        assert!(curves.len() > 7);
        for (index, curve) in curves.iter().enumerate() {
            let alike =
                |other: &&Curve| other.look == curve.look && other.style_index == curve.style_index;
            let other = curves[..index].iter().find(alike);
            assert!(
                other.is_none(),
                "{} {:?}",
                curve.name,
                other.map(|other| &other.name)
            );
        }
    }
}
