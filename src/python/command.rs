//! The command line, runs with files, traces of pictures.

use crate::arrays::table;
use crate::attention::Attention;
use crate::errors::{bad_argument, of_exit_code, of_run};
use crate::scenario::Scenario;
use image::RgbImage;
use numpy::{PyArray2, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rodlab::cli;
use rodlab_lab::run::{RunOptions, StopRequest, run_until};
use rodlab_vision::{Region, TraceOptions};
use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::Mutex;

/// Run the command line, and return its exit code.
#[pyfunction]
pub fn main(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| cli::run(arguments))
}

/// Run the command line, and return its standard output; a failure raises its error.
#[pyfunction]
pub fn command(py: Python<'_>, arguments: Vec<OsString>) -> PyResult<String> {
    let answer = py.detach(|| cli::call(arguments));
    match answer.exit_code {
        0 => Ok(answer.output),
        exit_code => Err(of_exit_code(exit_code, &answer.error)),
    }
}

/// Return the demonstrations that a command line requests; None for any other command.
#[pyfunction]
pub fn demonstrations<'py>(
    py: Python<'py>,
    arguments: Vec<OsString>,
) -> PyResult<Option<Bound<'py, PyDict>>> {
    let Some(wanted) = cli::demonstrations(arguments) else {
        return Ok(None);
    };
    let answer = PyDict::new(py);
    answer.set_item("task", wanted.task)?;
    answer.set_item("count", wanted.count)?;
    answer.set_item("out", wanted.out)?;
    answer.set_item("format", wanted.format)?;
    answer.set_item("seed", wanted.seed)?;
    answer.set_item("pictures", wanted.pictures)?;
    answer.set_item("quiet", wanted.quiet)?;
    Ok(Some(answer))
}

/// Run a scenario as `rodlab run` does, and return its outcome as JSON.
#[pyfunction]
#[pyo3(signature = (scenario, out, force = false, progress = false))]
pub fn run(
    py: Python<'_>,
    scenario: &Scenario,
    out: PathBuf,
    force: bool,
    progress: bool,
) -> PyResult<String> {
    let prepared = scenario.prepare()?;
    let options = RunOptions {
        force,
        progress,
        ..RunOptions::new(out)
    };
    // Requests may come from several threads.
    let attention = Mutex::new(Attention::new());
    let (outcome, attention) = py.detach(|| {
        let requested = || {
            let attention = attention.lock().expect("no thread panics with it");
            (!attention.continues()).then_some(StopRequest::Interrupt)
        };
        let outcome = run_until(&prepared, &options, &requested);
        (outcome, attention)
    });
    attention
        .into_inner()
        .expect("no thread panics with it")
        .finish()?;
    let outcome = outcome.map_err(|error| of_run(&error))?;
    Ok(serde_json::json!({
        "results": outcome.directory,
        "wall_time_s": outcome.wall_time.as_secs_f64(),
        "outcome": outcome.case,
    })
    .to_string())
}

/// Trace the rods of an RGB image, h × w × 3; a centreline is an array k × 2 of pixels u, v.
#[pyfunction]
#[pyo3(signature = (image, colours, least_area, strands, region, least_length))]
pub fn trace<'py>(
    py: Python<'py>,
    image: PyReadonlyArray3<'py, u8>,
    colours: Vec<String>,
    least_area: usize,
    strands: Option<u16>,
    region: Option<String>,
    least_length: f64,
) -> PyResult<Vec<Bound<'py, PyArray2<f64>>>> {
    let &[height, width, 3] = image.shape() else {
        return Err(bad_argument(
            "image: expected an array of shape (height, width, 3)",
        ));
    };
    let bytes: Vec<u8> = image.as_array().iter().copied().collect();
    let picture = RgbImage::from_raw(width as u32, height as u32, bytes);
    let picture = picture.ok_or_else(|| bad_argument("image: too large"))?;
    let coloured = TraceOptions::of_colours(&colours);
    let region = region.as_deref().map(Region::parse).transpose();
    let options = TraceOptions {
        region: region.map_err(|error| bad_argument(error.to_string()))?,
        strands: strands.map(usize::from),
        least_length,
        least_area,
        ..coloured.map_err(|error| bad_argument(format!("colour: {error}")))?
    };
    let trace = py.detach(|| rodlab_vision::trace(&picture, &options));
    let trace = trace.map_err(|error| bad_argument(format!("image: {error}")))?;
    let strands = trace.strands.iter().map(|strand| {
        let points = &strand.points;
        let flat = points.iter().flat_map(|point| [point.x, point.y]).collect();
        table(py, [points.len(), 2], flat)
    });
    Ok(strands.collect())
}
