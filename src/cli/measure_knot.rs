//! `rodlab measure knot`: the knot invariant of a curve.

use super::prelude::*;
use rodlab_engine::mechanics::Vector3;
use rodlab_lab::scenario::read_polyline;
use rodlab_planning::knot::{closed_far_away, determinant_of_closed, fewest_crossings};

/// Largest number of points, since crossings are searched among all pairs.
const MOST_POINTS: usize = 5000;

/// Arguments of `rodlab measure knot`.
#[derive(Debug, Args)]
#[command(after_help = "\
Example:
  rodlab measure knot scenarios/three_twist.csv

An open curve is closed far away, along the line through both of its ends. The determinant is 1 for
a curve without a knot, 2n + 1 for an overhand knot of unknotting number n, 5 for a figure-eight,
9 for a reef or granny knot. Different knots may have the same determinant.")]
pub struct KnotArguments {
    /// CSV file with a header line and columns x, y and z
    curve: PathBuf,
    /// Join the last point to the first; curves whose ends coincide are always closed
    #[arg(long)]
    closed: bool,
}

#[derive(Serialize)]
struct Answer {
    points: usize,
    closed: bool,
    length_m: f64,
    /// Number of crossings in the best of many views: an upper bound on the crossing number of the
    /// knot.
    crossings: usize,
    knot_determinant: u64,
}

/// Finds the determinant and prints it.
pub fn measure_knot(arguments: &KnotArguments) -> Result<(), Failure> {
    let corners = read_polyline(&arguments.curve).map_err(Failure::Input)?;
    let mut points: Vec<Vector3> = corners.into_iter().map(Vector3::from).collect();
    let place = arguments.curve.display();
    if points.len() > MOST_POINTS {
        return Err(Failure::Input(format!(
            "{place} has {} points; allowed: {MOST_POINTS} at most",
            points.len()
        )));
    }
    let returns = points.first() == points.last();
    if returns {
        points.pop();
    }
    let closed = arguments.closed || returns;
    if closed && points.len() < 3 {
        return Err(Failure::Input(format!(
            "{place}: a closed curve needs at least 3 points"
        )));
    }
    let joined = if closed {
        points.clone()
    } else {
        closed_far_away(&points).unwrap_or_default()
    };
    let (Some(crossings), Some(knot_determinant)) =
        (fewest_crossings(&joined), determinant_of_closed(&joined))
    else {
        return Err(Failure::Input(format!(
            "{place}: the curve intersects itself"
        )));
    };
    let last = if closed { points.first() } else { None };
    let ends = points.iter().skip(1).chain(last);
    print_json(&Answer {
        points: points.len(),
        closed,
        length_m: points.iter().zip(ends).map(|(a, b)| (b - a).norm()).sum(),
        crossings,
        knot_determinant,
    })
}
