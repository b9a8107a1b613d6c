//! Fits the gravito-bending length and natural curvature of a rod held at one end in a photograph.
//!
//! The shape depends on the weight over the stiffness only, w/EI = 1/(2 L_gb³). The place and the direction at the clamp are
//! fitted, too.

use super::data::{At, DataFile, Datum, Measured, Place};
use super::error::IdentifyError;
use super::fit::Loss;
use super::identified::Identified;
use super::jacobian::CentralDifferences;
use super::parameter::Request;
use super::problem::Experiment;
use super::task::{Task, identify};
use crate::experiment::case_set_from_text;
use libm::{atan2, cbrt};
use std::collections::BTreeMap;
use std::path::Path;

/// Number of points of the curve that are compared.
pub(super) const POINTS: usize = 60;
/// Minimum number of points of a traced rod.
pub(super) const FEWEST: usize = 20;
/// Edges of the simulated rod.
const EDGES: usize = 50;
/// Fraction of the length, at the clamp, from which the direction there is first estimated.
const START: f64 = 0.05;
/// Density of the simulated rod, kg/m³; the shape does not depend on it.
const DENSITY: f64 = 1000.0;
/// Acceleration of free fall, m/s².
const GRAVITY: f64 = 9.81;
/// Twisting stiffness over the bending stiffness. The rod is assumed to stay in a plane; a soft
/// rod with upward natural curvature would turn out of it.
const TWISTING: f64 = 100.0;
/// Stretching stiffness over the weight of the rod.
const STRETCHING: f64 = 1e4;

/// Key of the gravito-bending length, m.
pub const LENGTH_KEY: &str = "parameters.gravito_bending_length";
/// Key of the natural curvature, 1/m, positive if it bends the rod to its left, seen from the
/// clamp.
pub const CURVATURE_KEY: &str = "parameters.curvature";

/// A rod as traced.
#[derive(Clone, Debug)]
pub struct HangingRod<'a> {
    /// The photograph, for messages.
    pub picture: &'a Path,
    /// Centreline of the rod from the clamp to the free end, m.
    pub points: &'a [[f64; 2]],
    /// Radius of the rod, m.
    pub radius: f64,
    /// Direction of gravity in the coordinates of the points; its length does not matter.
    pub down: [f64; 2],
    /// Whether the rod is straight without stress.
    pub is_straight: bool,
}

/// Fits gravito-bending length, natural curvature, and place and direction of the clamp.
///
/// # Errors
/// As [`identify`].
pub fn measure_hanging(
    rod: &HangingRod<'_>,
    goes_on: &(dyn Fn() -> bool + Sync),
) -> Result<Identified, IdentifyError> {
    let fault =
        |message: &str| IdentifyError::Input(format!("{}: {message}", rod.picture.display()));
    let lengths = arc_lengths(rod.points);
    let length = lengths[lengths.len() - 1];
    if rod.points.len() < FEWEST || length <= 0.0 {
        return Err(fault("the traced rod is too short to be fitted"));
    }
    let scenario = case_set_from_text("rod", &scenario(rod, &lengths), Path::new(""))?;
    let file = DataFile {
        path: rod.picture.to_owned(),
        data: data(rod.points, &lengths, At::Part),
    };
    let mut keys = vec![
        LENGTH_KEY,
        "parameters.angle",
        "parameters.x0",
        "parameters.y0",
    ];
    if !rod.is_straight {
        keys.push(CURVATURE_KEY);
    }
    let request = |key: &str| Request {
        key: key.to_owned(),
        // The bounds also set the scales of the fit.
        bounds: match key {
            "parameters.x0" | "parameters.y0" => Some([-0.1 * length, 0.1 * length]),
            CURVATURE_KEY => Some([-20.0 / length, 20.0 / length]),
            _ => None,
        },
        prior: None,
    };
    let task = Task {
        experiments: vec![Experiment {
            scenario,
            files: vec![file],
        }],
        keys: keys.into_iter().map(request).collect(),
        loss: Loss::Huber,
        noise: BTreeMap::new(),
        shared: None,
        windows: 1,
    };
    identify(&task, &CentralDifferences::default(), goes_on, &mut |_| {})
}

/// Coordinates of points at equal distances, relative to the first. `place` maps a fraction of the
/// length of the curve to a place on the rod.
pub(super) fn data(points: &[[f64; 2]], lengths: &[f64], place: impl Fn(f64) -> At) -> Vec<Datum> {
    let mut data = Vec::new();
    for number in 0..=POINTS {
        let part = number as f64 / POINTS as f64;
        let point = point_at(points, lengths, part);
        for (axis, series) in ["x", "y"].into_iter().enumerate() {
            data.push(Datum {
                line: number + 1,
                time: None,
                measured: Measured::Coordinate {
                    place: Place {
                        rod: None,
                        at: place(part),
                    },
                    axis,
                },
                value: point[axis] - points[0][axis],
                deviation: None,
                series: series.to_owned(),
            });
        }
    }
    data
}

/// Returns the point of a polyline at a fraction of its length.
fn point_at(points: &[[f64; 2]], lengths: &[f64], part: f64) -> [f64; 2] {
    let last = lengths.len() - 1;
    let at = part * lengths[last];
    let after = lengths
        .partition_point(|length| *length < at)
        .clamp(1, last);
    let width = lengths[after] - lengths[after - 1];
    let weight = if width > 0.0 {
        (at - lengths[after - 1]) / width
    } else {
        0.0
    };
    [0, 1].map(|axis| (1.0 - weight) * points[after - 1][axis] + weight * points[after][axis])
}

/// Lengths up to each point, m.
pub(super) fn arc_lengths(points: &[[f64; 2]]) -> Vec<f64> {
    let mut lengths = vec![0.0];
    for pair in points.windows(2) {
        let step = [0, 1].map(|axis| pair[1][axis] - pair[0][axis]);
        let last = lengths[lengths.len() - 1];
        lengths.push(last + (step[0] * step[0] + step[1] * step[1]).sqrt());
    }
    lengths
}

/// The scenario of a rod that is held at its first node.
fn scenario(rod: &HangingRod<'_>, lengths: &[f64]) -> String {
    let length = lengths[lengths.len() - 1];
    held_rod(&Held {
        length,
        radius: rod.radius,
        angle: angle_at_start(rod.points, lengths),
        down: rod.down,
        // A rod that hangs visibly but is not limp.
        gravito_bending_length: cbrt(length.powi(3) / 20.0),
        curvature: 0.0,
        twisting: TWISTING,
        roll: 0.0,
        suffix: "",
    })
}

/// Direction of a traced rod at its clamp, rad from x.
pub(super) fn angle_at_start(points: &[[f64; 2]], lengths: &[f64]) -> f64 {
    let length = lengths[lengths.len() - 1];
    let near = lengths.partition_point(|at| *at < START * length).max(1);
    let towards = [0, 1].map(|axis| points[near][axis] - points[0][axis]);
    atan2(towards[1], towards[0])
}

/// Start values of a rod that is held at its first node.
pub(super) struct Held<'a> {
    /// m.
    pub length: f64,
    /// m.
    pub radius: f64,
    /// Direction at the clamp, rad from x.
    pub angle: f64,
    /// Direction of gravity.
    pub down: [f64; 2],
    /// m.
    pub gravito_bending_length: f64,
    /// Natural curvature, 1/m.
    pub curvature: f64,
    /// Twisting stiffness over the bending stiffness.
    pub twisting: f64,
    /// Turn of the rod about its axis at the clamp, rad.
    pub roll: f64,
    /// Suffix of the names of keys that belong to this photograph only.
    pub suffix: &'a str,
}

/// Scenario of a held rod.
pub(super) fn held_rod(held: &Held<'_>) -> String {
    let Held {
        length,
        radius,
        angle,
        gravito_bending_length,
        curvature,
        twisting,
        roll,
        suffix,
        ..
    } = held;
    let size = (held.down[0].powi(2) + held.down[1].powi(2)).sqrt();
    let gravity = held.down.map(|part| part / size * GRAVITY);
    let weight = DENSITY * std::f64::consts::PI * radius * radius * GRAVITY;
    let stretching = STRETCHING * weight * length;
    format!(
        r#"experiment = "scene"
[parameters]
gravito_bending_length = {gravito_bending_length:?}
curvature = {curvature:?}
twisting = {twisting:?}
angle{suffix} = {angle:?}
roll{suffix} = {roll:?}
x0{suffix} = 0.0
y0{suffix} = 0.0
ei = "2*{weight:?}*gravito_bending_length^3"
[material]
youngs_modulus = "1 MPa"
poissons_ratio = 0.5
density = {DENSITY:?}
[[rods]]
name = "rod"
radius = {radius:?}
edges = {EDGES}
shape = {{ kind = "straight", start = ["x0{suffix}", "y0{suffix}", 0], end = ["x0{suffix} + {length:?}*cos(angle{suffix})", "y0{suffix} + {length:?}*sin(angle{suffix})", 0] }}
natural_curvature = [0, "curvature"]
director = ["-sin(angle{suffix})*cos(roll{suffix})", "cos(angle{suffix})*cos(roll{suffix})", "sin(roll{suffix})"]
stiffness = {{ bending_1 = "ei", bending_2 = "ei", twisting = "twisting*ei", stretching = {stretching:?} }}
[[clamps]]
rod = "rod"
at = "start"
[[loads]]
kind = "gravity"
acceleration = [{:?}, {:?}, 0]
[time]
mode = "static"
"#,
        gravity[0], gravity[1]
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::prepare;
    use crate::identify::IdentifiedKey;
    use rodlab_engine::mechanics::dynamics::Simulation;

    /// A centreline with a gravito-bending length and a natural curvature, with waves of the size of a pixel on it.
    fn traced(gravito_bending_length: f64, curvature: f64, waves: f64) -> Vec<[f64; 2]> {
        let straight: Vec<[f64; 2]> = (0..=200).map(|k| [2e-3 * f64::from(k), 0.0]).collect();
        let rod = HangingRod {
            picture: Path::new("photo.png"),
            points: &straight,
            radius: 1e-3,
            down: [0.0, -1.0],
            is_straight: false,
        };
        let text = scenario(&rod, &arc_lengths(&straight));
        let scenario = case_set_from_text("rod", &text, Path::new("")).unwrap();
        let keys = [
            (LENGTH_KEY, gravito_bending_length),
            (CURVATURE_KEY, curvature),
            ("parameters.angle", 0.3),
        ];
        let loaded = scenario.scenario_with(&keys).unwrap();
        let prepared = prepare(&loaded.scenario).unwrap();
        let mut simulation = Simulation::new(&prepared.scene, &prepared.integration).unwrap();
        simulation.find_equilibrium().unwrap();
        let wave = |k: usize, phase: f64| waves * (2.9 * k as f64 + phase).sin();
        let points = simulation.positions().iter().enumerate();
        points
            .map(|(k, point)| [0.2 + point.x + wave(k, 0.0), 0.5 + point.y + wave(k, 1.0)])
            .collect()
    }

    #[test]
    fn length_and_curvature_of_a_hanging_rod_are_found_within_their_error_bars() {
        for (gravito_bending_length, curvature) in [(0.1, 0.0), (0.15, -4.0)] {
            let points = traced(gravito_bending_length, curvature, 2e-4);
            let rod = HangingRod {
                picture: Path::new("photo.png"),
                points: &points,
                radius: 1e-3,
                down: [0.0, -2.0],
                is_straight: false,
            };
            let found = measure_hanging(&rod, &|| true).unwrap();
            let of = |key: &str| found.parameters.iter().find(|one| one.key == key).unwrap();
            let [length, bend] = [of(LENGTH_KEY), of(CURVATURE_KEY)];
            println!(
                "{gravito_bending_length} {curvature}: {:.5} ± {:?}, {:.4} ± {:?}",
                length.value, length.standard_error, bend.value, bend.standard_error
            );
            assert!(
                (length.value / gravito_bending_length - 1.0).abs() < 0.01,
                "{}",
                length.value
            );
            let off = |one: &IdentifiedKey, truth: f64| {
                (one.value - truth).abs() / one.standard_error.unwrap()
            };
            assert!(off(length, gravito_bending_length) < 4.0 && off(bend, curvature) < 4.0);
        }
    }
}
