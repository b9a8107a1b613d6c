//! Fits a few keys of a scenario so that its equilibrium is closest to a curve.

use super::check::{Check, FORCE_TOLERANCE};
use super::curve::{length, wanted_nodes};
use super::error::DesignError;
use super::request::Request;
use crate::experiment;
use crate::identify::{
    At, DataFile, Datum, Exact, Experiment, IdentifyError, Measured, Parameter, Place,
    Request as KeyRequest, arc_lengths, closest,
};
use crate::run::{Mode, PreparedRun};
use crate::scenario::CaseSet;
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::Simulation;
use rodlab_engine::mechanics::scene::RodDescription;
use serde::Serialize;

/// Distance, over the length, up to which the curve counts as met.
const MET: f64 = 1e-8;
/// Root mean square distance, over the length, below which the fit stops.
const NEGLIGIBLE: f64 = 1e-11;

/// A key with the value that was found.
#[derive(Clone, Debug, Serialize)]
pub struct DesignedKey {
    /// The dotted key.
    pub key: String,
    /// The value, in the SI unit.
    pub value: f64,
    /// The SI unit; empty if it has none.
    pub unit: String,
    /// The value in the given scenario.
    pub start: f64,
}

/// Fitted values of keys and their check.
#[derive(Clone, Debug, Serialize)]
pub struct DesignedNumbers {
    /// Name of the rod.
    pub rod: String,
    /// Number of edges of the rod.
    pub edges: usize,
    /// Length of the target curve, m.
    pub curve_length_m: f64,
    /// Length of the rod without stress, m.
    pub natural_length_m: f64,
    /// The keys.
    pub keys: Vec<DesignedKey>,
    /// Whether the equilibrium meets the curve, to 1e-8 of the length.
    pub met: bool,
    /// Largest distance of a node in equilibrium from the target curve, m.
    pub distance_m: f64,
    /// Largest distance over the length.
    pub distance_over_length: f64,
    /// Mean distance of the nodes, m.
    pub mean_distance_m: f64,
    /// Mean distance over the length.
    pub mean_distance_over_length: f64,
    /// Root mean square distance in each coordinate with the given values of the scenario, m.
    pub distance_before_m: f64,
    /// Largest distance from the curve of the equilibrium reached from a displaced start, m; none
    /// if there is no such equilibrium.
    pub distance_from_displaced_start_m: Option<f64>,
    /// Number of directions in which the energy of the equilibrium falls: 0 if it is stable; none
    /// with friction and rigid contact.
    pub unstable_directions: Option<usize>,
    /// Derivatives computed.
    pub iterations: usize,
    /// Whether no step decreases the distances any further.
    pub converged: bool,
    /// What limits the design.
    pub remarks: Vec<String>,
    /// The scenario with the values.
    #[serde(skip)]
    pub scenario_toml: String,
    /// Nodes of the target curve, of the equilibrium, and of the equilibrium before the design, m.
    #[serde(skip)]
    pub nodes: [Vec<Vector3>; 3],
}

/// Finds the values of `keys`, all stated in `scenario`, and checks them with the equilibrium.
///
/// # Errors
/// [`DesignError`]: a curve that does not fit the rod, or a start without equilibrium.
pub fn numbers(
    request: &Request<'_>,
    scenario: &CaseSet,
    keys: &[String],
    goes_on: &(dyn Fn() -> bool + Sync),
) -> Result<DesignedNumbers, DesignError> {
    let before = prepared(scenario, &[])?;
    if before.mode != Mode::Static {
        return Err(DesignError::Input(format!(
            "--vary {}: the design needs an equilibrium; allowed: time.mode = \"static\"",
            keys[0]
        )));
    }
    let rod = rod_of(request.rod, &before)?;
    let description = &before.scene.rods[rod];
    let lengths = arc_lengths(description);
    let natural_length = lengths[lengths.len() - 1];
    let edges = lengths.len() - 1;
    let wanted = wanted_nodes(request.shape, edges, natural_length, true)?;
    let exact = before.integration.force_tolerance.min(FORCE_TOLERANCE);
    let wanted_of = Experiment {
        scenario: scenario.changed(&[format!("solver.force_tolerance={exact:?}")])?,
        files: vec![data(request, description, &wanted)],
    };
    let scenarios = [wanted_of.scenario.clone()];
    let parameter = |key: &String| {
        let request = KeyRequest {
            key: key.clone(),
            ..KeyRequest::default()
        };
        let mut parameter = Parameter::new(&request, &scenarios).map_err(of_vary)?;
        let size = size(&parameter.unit, description, natural_length);
        parameter.scale = parameter.start.abs().max(size);
        Ok(parameter)
    };
    let parameters: Result<Vec<Parameter>, DesignError> = keys.iter().map(parameter).collect();
    let parameters = parameters?;
    let negligible = NEGLIGIBLE * natural_length;
    let found = closest(
        &wanted_of,
        &parameters,
        &Exact::default(),
        negligible,
        goes_on,
    )?;
    let values = keys
        .iter()
        .map(String::as_str)
        .zip(found.values.iter().copied());
    let run = prepared(scenario, &values.collect::<Vec<_>>())?;
    let check = Check::new(&run, rod, &wanted, false)?;
    let keys = parameters.iter().zip(&found.values);
    let mut designed = DesignedNumbers {
        rod: description.name.clone(),
        edges,
        curve_length_m: length(&wanted),
        natural_length_m: natural_length,
        keys: keys
            .map(|(parameter, value)| DesignedKey {
                key: parameter.key.clone(),
                value: *value,
                unit: parameter.unit.clone(),
                start: parameter.start,
            })
            .collect(),
        met: check.distance < MET * natural_length,
        distance_m: check.distance,
        distance_over_length: check.distance / natural_length,
        mean_distance_m: check.mean_distance,
        mean_distance_over_length: check.mean_distance / natural_length,
        distance_before_m: found.residuals[0],
        distance_from_displaced_start_m: check.from_displaced_start,
        unstable_directions: check.unstable_directions,
        iterations: found.iterations,
        converged: found.converged,
        remarks: check.remarks(natural_length),
        scenario_toml: run.scenario_toml.clone(),
        nodes: [wanted, check.nodes, equilibrium(&before, rod)?],
    };
    if !designed.met {
        designed.remarks.push(format!(
            "with these keys the rod does not meet the curve: its distance is at most {:.3e} m, on average {:.3e} m",
            designed.distance_m, designed.mean_distance_m
        ));
    }
    for combination in &found.undetermined {
        let names: Vec<String> = (combination.iter())
            .map(|(key, _)| format!("`{}`", designed.keys[*key].key))
            .collect();
        designed.remarks.push(format!(
            "{} can change, alone or together, without changing the shape: their values are not unique",
            names.join(", ")
        ));
    }
    Ok(designed)
}

/// An error of the identification, with the name of this command's option.
fn of_vary(error: IdentifyError) -> DesignError {
    match error {
        IdentifyError::Input(message) => {
            DesignError::Input(message.replacen("--fit ", "--vary ", 1))
        }
        other => other.into(),
    }
}

fn prepared(scenario: &CaseSet, numbers: &[(&str, f64)]) -> Result<PreparedRun, DesignError> {
    let loaded = scenario.scenario_with(numbers)?;
    Ok(experiment::prepare(&loaded.scenario).map_err(|issues| loaded.locate(issues))?)
}

/// The rod whose shape is wanted.
fn rod_of(name: Option<&str>, run: &PreparedRun) -> Result<usize, DesignError> {
    let rods = &run.scene.rods;
    let names: Vec<&str> = rods.iter().map(|rod| rod.name.as_str()).collect();
    let fault = |what: &str| {
        DesignError::Input(format!("--rod: {what}; the rods are: {}", names.join(", ")))
    };
    let index = match name {
        Some(name) => {
            let found = rods.iter().position(|rod| rod.name == name);
            found.ok_or_else(|| fault(&format!("no rod is called `{name}`")))?
        }
        None if rods.len() == 1 => 0,
        None => return Err(fault("name the rod to design")),
    };
    match rods[index].closed {
        true => Err(fault("this rod is closed; allowed: open rods")),
        false => Ok(index),
    }
}

/// The nodes of the rod in the equilibrium of a run.
fn equilibrium(run: &PreparedRun, rod: usize) -> Result<Vec<Vector3>, DesignError> {
    let mut simulation = Simulation::new(&run.scene, &run.integration)?;
    simulation.find_equilibrium()?;
    let before = run.scene.rods[..rod].iter();
    let first: usize = before.map(|rod| rod.centreline.len()).sum();
    let nodes = run.scene.rods[rod].centreline.len();
    Ok(simulation.positions()[first..first + nodes].to_vec())
}

/// The wanted nodes as measurements.
fn data(request: &Request<'_>, rod: &RodDescription, wanted: &[Vector3]) -> DataFile {
    let mut data = Vec::new();
    for (node, point) in wanted.iter().enumerate() {
        for axis in 0..3 {
            data.push(Datum {
                line: node + 2,
                time: None,
                measured: Measured::Coordinate {
                    place: Place {
                        rod: Some(rod.name.clone()),
                        at: At::Node(node),
                    },
                    axis,
                },
                value: point[axis],
                deviation: None,
                series: String::new(),
            });
        }
    }
    DataFile {
        path: request.shape.to_owned(),
        data,
    }
}

/// A change of a quantity that has a noticeable effect on a rod of a length (m), by its unit.
fn size(unit: &str, rod: &RodDescription, length: f64) -> f64 {
    let [one, other] = rod.stiffness.bending;
    let moment = one.min(other) / length;
    match unit {
        "m" => 0.1 * length,
        "1/m" => 1.0 / length,
        "N" => moment / length,
        "N m" => moment,
        "N/m" => moment / length / length,
        _ => 1.0,
    }
}
