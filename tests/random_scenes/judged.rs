//! A random scene judged by a second scheme with a tenth of the step.
//!
//! Final positions are compared, relative to the distance moved. The difference between the second
//! scheme's own results with the whole step and with a tenth of it shows what the step does not
//! resolve, and is allowed. A larger difference is a silent wrong result.
//!
//! Schemes damp oscillations that their steps do not resolve, implicit Euler most of all. If this
//! may be the reason for a wrong result, the result must be right with finer steps. The second
//! scheme may itself be wrong with a tenth of the step although this agrees with its result for
//! the whole step. An apparently wrong result is therefore judged again with a hundredth of the
//! step.
//!
//! A rod that is released far from its equilibrium may vibrate so fast that its end depends on
//! phases which neither scheme resolves with a hundredth of the step. If both schemes then differ
//! from each other, without contact and fluid, there is no reference and no verdict.

use rodlab::experiment;
use rodlab::mechanics::Vector3;
use rodlab::mechanics::dynamics::{Simulation, SimulationError};
use rodlab::run::Mode;
use std::path::Path;

/// Number of steps of a judged scene.
pub const STEPS: usize = 16;
/// Number of steps of the second scheme within one of these steps.
const FINER: f64 = 10.0;
/// Allowed distance, as a fraction of the distance moved.
const PART_OF_MOVE: f64 = 0.1;
/// Allowed distance, as a multiple of the distance that the step does not resolve.
const PART_OF_UNRESOLVED: f64 = 3.0;
/// First step of backward differences, as a fraction of the whole step. If the fluid stops a
/// motion within this step, the rod moves about as far as the initial speed times the step,
/// whatever the true distance is.
const FIRST_STEP: f64 = 1.0 / 64.0;
/// Allowed distance for rounding and for the tolerances of Newton's method, in radii.
const RADII: f64 = 1e-3;
/// Largest number of steps that a run may take instead of one.
const MOST_STEPS: usize = 100;

/// A scene of a family.
pub struct Case {
    /// The scenario file.
    pub text: String,
    /// Radius of the thinnest rod, m.
    pub radius: f64,
    /// Time step, s; the run ends after [`STEPS`] of them.
    pub step: f64,
    /// Other changes of the second run besides the step.
    pub second: Vec<String>,
    /// Factor by which finer steps may be needed to resolve oscillations that the scheme otherwise
    /// damps; `None` if the step itself must suffice.
    pub resolved_by: Option<f64>,
    /// Indices of rods that must have no contact forces, since everything that they touch is
    /// prescribed.
    pub forceless: Vec<usize>,
}

/// Verdict on a scene.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// Both schemes agree.
    Right,
    /// The scene was rejected, or ended with an error that gives the reason.
    Refused(String),
    /// The second scheme rejected the scene, or no reference is resolved, so that there is no verdict.
    Unjudged(String),
    /// The result is wrong without an error.
    Wrong(String),
}

/// Runs a scene and judges its end.
pub fn judge(case: &Case) -> Verdict {
    let tested = match run(case, &[]) {
        Ok(tested) => tested,
        Err(Failed::Clearly(message)) => return Verdict::Refused(message),
        Err(Failed::Without(message)) => return Verdict::Wrong(message),
    };
    match judge_by(case, &tested, FINER) {
        Verdict::Wrong(message) => match judge_by(case, &tested, FINER * FINER) {
            Verdict::Right => Verdict::Right,
            _ => match without_reference(case, FINER * FINER) {
                Some(apart) => Verdict::Unjudged(format!(
                    "{message}; both schemes differ by {apart:.3e} m with a hundredth of the step"
                )),
                None => Verdict::Wrong(message),
            },
        },
        verdict => verdict,
    }
}

/// Distance of both schemes from each other with finer steps, m, if it is too large for one of them
/// to be a reference, in a scene that may vibrate with neither contact nor fluid.
fn without_reference(case: &Case, finer: f64) -> Option<f64> {
    case.resolved_by?;
    if ["[contact]", "[fluid]"]
        .iter()
        .any(|table| case.text.contains(table))
    {
        return None;
    }
    let mut overrides = case.second.clone();
    overrides.push(format!("time.step = {:e}", case.step / finer));
    let reference = run_within(case, &overrides, finer).ok()?;
    let moved = farthest(&reference.start, &reference.positions);
    let apart = with_finer_steps(case, &reference, finer);
    (apart.is_finite() && apart > PART_OF_MOVE * moved).then_some(apart)
}

/// Judges the end of a run by the second scheme, with a number of steps in each step.
fn judge_by(case: &Case, tested: &Run, steps: f64) -> Verdict {
    let second = |finer: f64| {
        let mut overrides = case.second.clone();
        overrides.push(format!("time.step = {:e}", case.step / finer));
        run_within(case, &overrides, finer)
    };
    let reference = match second(steps) {
        Ok(reference) => reference,
        Err(failed) => return Verdict::Unjudged(failed.message().into()),
    };
    let unresolved = second(1.0).map_or(0.0, |coarse| {
        farthest(&coarse.positions, &reference.positions)
    });
    let moved = farthest(&reference.start, &reference.positions);
    let apart = farthest(&tested.positions, &reference.positions);
    let moved = moved.max(FIRST_STEP * case.step * reference.speed);
    let allowed = PART_OF_MOVE * moved + PART_OF_UNRESOLVED * unresolved + RADII * case.radius;
    let is_right_with = |finer: f64| {
        let first_step = reference.speed * case.step / finer;
        with_finer_steps(case, &reference, finer) <= allowed + first_step
    };
    if apart <= allowed || case.resolved_by.is_some_and(is_right_with) {
        Verdict::Right
    } else {
        Verdict::Wrong(format!(
            "{apart:.3e} m from the second scheme, which moved by {moved:.3e} m and differs by {unresolved:.3e} m from itself at the whole step"
        ))
    }
}

/// Distance (m) from the reference with steps finer by a factor; infinite if that run fails.
fn with_finer_steps(case: &Case, reference: &Run, finer: f64) -> f64 {
    let overrides = [format!("time.step = {:e}", case.step / finer)];
    run_within(case, &overrides, finer).map_or(f64::INFINITY, |fine| {
        farthest(&fine.positions, &reference.positions)
    })
}

/// Table for a single scene: the distances moved with both schemes and steps of three sizes, and
/// the distances of the final positions from the last run of the table.
pub fn convergence(case: &Case) -> String {
    let runs: Vec<_> = [Vec::new(), case.second.clone()]
        .into_iter()
        .flat_map(|scheme| [1.0, FINER, FINER * FINER].map(|finer| (scheme.clone(), finer)))
        .map(|(mut overrides, finer)| {
            overrides.push(format!("time.step = {:e}", case.step / finer));
            let name = overrides.join(", ");
            (name, run_within(case, &overrides, finer))
        })
        .collect();
    let last = runs.last().and_then(|(_, last)| last.as_ref().ok());
    let rows = runs.iter().map(|(name, run)| match run {
        Ok(run) => {
            let moved = farthest(&run.start, &run.positions);
            let apart = last.map_or(f64::NAN, |last| farthest(&run.positions, &last.positions));
            format!("{name}: moved by {moved:.4e} m, {apart:.4e} m from the last\n")
        }
        Err(failed) => format!("{name}: {}\n", failed.message()),
    });
    rows.collect()
}

/// Largest distance between two lists of points, m; infinite if a number is NaN.
fn farthest(a: &[Vector3], b: &[Vector3]) -> f64 {
    let distances = a.iter().zip(b).map(|(a, b)| (a - b).norm());
    distances.fold(0.0, |most, d| {
        if d.is_nan() {
            f64::INFINITY
        } else {
            f64::max(most, d)
        }
    })
}

/// Start and end of a run.
pub struct Run {
    /// Positions at the start, m.
    pub start: Vec<Vector3>,
    /// Largest speed at the start, m/s.
    pub speed: f64,
    /// Positions at the end, m.
    pub positions: Vec<Vector3>,
    /// Velocities at the end, m/s.
    pub velocities: Vec<Vector3>,
}

/// Reason why a run did not reach its end.
pub enum Failed {
    /// A clear error for the user.
    Clearly(String),
    /// Invalid numbers without a clear error.
    Without(String),
}

impl Failed {
    /// The words.
    pub fn message(&self) -> &str {
        match self {
            Self::Clearly(message) | Self::Without(message) => message,
        }
    }
}

/// Runs a scene to its end with overrides.
///
/// # Errors
/// The failure that ended the run early.
pub fn run(case: &Case, overrides: &[String]) -> Result<Run, Failed> {
    run_within(case, overrides, 1.0)
}

/// Runs a scene with a larger allowed number of steps.
fn run_within(case: &Case, overrides: &[String], finer: f64) -> Result<Run, Failed> {
    let most_steps = finer * (MOST_STEPS * STEPS) as f64;
    let clearly = |error: &dyn ToString| Failed::Clearly(error.to_string());
    let loaded = experiment::from_text("random", &case.text, Path::new(""), overrides)
        .map_err(|error| clearly(&error))?;
    let prepared =
        experiment::prepare(&loaded.scenario).map_err(|issues| clearly(&loaded.locate(issues)))?;
    let Mode::Dynamic { end, .. } = prepared.mode else {
        return Err(Failed::Without("not a dynamic scene".into()));
    };
    let mut simulation =
        Simulation::new(&prepared.scene, &prepared.integration).map_err(|error| clearly(&error))?;
    let start = simulation.positions().to_vec();
    let speeds = simulation.velocities().iter().map(Vector3::norm);
    let speed = speeds.fold(0.0, f64::max);
    let mut steps = 0.0;
    while simulation.time() < end {
        if let Err(error) = simulation.advance(end) {
            return Err(match error {
                SimulationError::BadScene(_) => Failed::Clearly(error.to_string()),
                _ => told(&error.to_string()),
            });
        }
        steps += 1.0;
        if steps > most_steps {
            return Err(Failed::Clearly(format!(
                "at t = {:e} s after {steps} steps",
                simulation.time()
            )));
        }
    }
    let finite = |vectors: &[Vector3]| vectors.iter().flatten().all(|x| x.is_finite());
    if !finite(simulation.positions()) || !finite(simulation.velocities()) {
        return Err(Failed::Without("numbers are not finite".into()));
    }
    let remarks = simulation.remarks();
    if let Some(remark) = remarks
        .iter()
        .find(|remark| remark.contains("in the fluid"))
    {
        return Err(Failed::Clearly(remark.clone()));
    }
    let forces = simulation.contact_forces();
    let mut first = 0;
    for (index, rod) in prepared.scene.rods.iter().enumerate() {
        let nodes = first..first + rod.centreline.len();
        first = nodes.end;
        let pressed = forces
            .get(nodes)
            .into_iter()
            .flatten()
            .any(|force| force.norm() > 0.0);
        if case.forceless.contains(&index) && pressed {
            return Err(Failed::Without(format!(
                "a contact force between held parts at rod {index}"
            )));
        }
    }
    Ok(Run {
        start,
        speed,
        positions: simulation.positions().to_vec(),
        velocities: simulation.velocities().to_vec(),
    })
}

/// An error is clear unless its message contains NaN or infinity.
fn told(message: &str) -> Failed {
    if message.contains("NaN") || message.contains("inf ") {
        Failed::Without(message.into())
    } else {
        Failed::Clearly(message.into())
    }
}
