//! Fits a rod that an arm holds at one end in several poses, each seen by a camera.
//!
//! The poses of the hand and of the camera are known. A point of the traced centreline defines a
//! ray from the camera; its depth along the ray is unknown. Each traced point therefore gives one
//! number: the distance of the rod from a plane. The plane contains the ray, and the direction of
//! the rod at the point that is nearest to the ray in the picture. With the eye c, the direction d
//! of the ray, and the position p and tangent t of the rod at that point,
//!
//! ```text
//! n · p = n · c,    n = d × t/|d × t|,
//! ```
//!
//! which is linear in p even in perspective. To first order it does not depend on the chosen point
//! of the rod, because n · t = 0. Points are matched with the rod again after each fit, until the
//! gravito-bending length no longer changes.
//!
//! Besides the noise of the points, the error bars include errors of the traced curve that are
//! smooth along it.
//!
//! Only the direction of the hand is known exactly. The place of the hand across the view of each
//! picture is fitted, too, with the prior [`HAND_ERROR`](super::held::HAND_ERROR). The prior covers
//! errors of the arm and of the camera's calibration, and the shading of the rod, which moves its
//! traced middle towards the bright side.

use super::data::{At, DataFile, Datum, Measured, Place};
use super::error::IdentifyError;
use super::exact::Exact;
use super::fit::Loss;
use super::held::{EDGES, HeldRod, Shifts};
use super::identified::Identified;
use super::problem::Experiment;
use super::statistics::Shared;
use super::task::{Task, identify};
use crate::experiment::case_set_from_text;
use nalgebra::Isometry3;
use rodlab_engine::mechanics::Vector3;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Maximum number of points of a traced centreline that are compared.
const POINTS: usize = 80;
/// Minimum number of points of a traced centreline.
const FEWEST: usize = 10;
/// Maximum number of fits; the points are matched again before each.
const ROUNDS: usize = 8;
/// Relative change of the gravito-bending length in a round below which the points are matched for the last time.
const SAME: f64 = 1e-3;
/// Change of that length in a round, over its standard error, below which the same holds.
const PART: f64 = 0.1;
/// Standard deviation of the smooth error of a traced curve over the radius of the rod, and its
/// correlation length over the length of the curve. Light from a side moves the middle of the mask
/// towards the light: by 0.11 radii if the light is 27° from the line of sight and a level rod is
/// 6.6 pixels wide, and by more if the rod is steep. The fitted shift of the hand absorbs the part
/// that is uniform along the curve; this is the rest.
const TRACED: f64 = 0.03;
const SMOOTH: f64 = 0.25;
/// Common name of the files of all pictures, because all pictures have the same noise.
const PICTURES: &str = "pictures";

/// A rod in a picture.
#[derive(Clone, Debug)]
pub struct HeldView {
    /// The picture, for messages and files.
    pub picture: PathBuf,
    /// The hand: the rod begins at its origin and points against its x axis.
    pub hand: Isometry3<f64>,
    /// The camera, which looks along its z axis.
    pub camera: Isometry3<f64>,
    /// Traced points from the hand to the free end, X/Z and Y/Z in the axes of the camera.
    pub points: Vec<[f64; 2]>,
}

/// Fits the gravito-bending length and the natural curvature of a rod to pictures. Returns the experiments of the last fit, too.
///
/// # Errors
/// The errors of [`identify`], or a picture has too few points.
pub fn identify_held(
    rod: &HeldRod,
    views: &[HeldView],
    goes_on: &(dyn Fn() -> bool + Sync),
) -> Result<(Identified, Vec<Experiment>), IdentifyError> {
    let start = [rod.gravito_bending_length, 0.0, 0.0];
    let mut values = start;
    // Outliers are limited once the points are matched.
    let mut loss = Loss::Squares;
    let mut rounds = 0;
    loop {
        rounds += 1;
        let numbered = (1..).zip(views);
        let experiments = numbered.map(|(number, view)| experiment(rod, number, view, values));
        let task = Task {
            experiments: experiments.collect::<Result<_, _>>()?,
            keys: rod.keys(views.len()),
            loss,
            noise: BTreeMap::new(),
            shared: Some(Shared {
                deviation: TRACED * rod.radius,
                length: SMOOTH,
            }),
            windows: 1,
        };
        let mut found = identify(&task, &Exact::default(), goes_on, &mut |_| {})?;
        let last = values[0];
        for (value, parameter) in values.iter_mut().zip(&found.parameters) {
            *value = parameter.value;
        }
        let error = (found.parameters.first()).and_then(|length| length.standard_error);
        let small = (SAME * last).max(PART * error.unwrap_or(0.0));
        let is_same = (values[0] - last).abs() < small;
        if loss == Loss::Huber && (is_same || rounds >= 2 * ROUNDS) {
            found.converged &= is_same;
            for (parameter, start) in found.parameters.iter_mut().zip(start) {
                parameter.start = start;
            }
            return Ok((found, task.experiments));
        }
        if is_same || rounds >= ROUNDS {
            loss = Loss::Huber;
        }
    }
}

/// Scenario of a view, with its traced points matched with the rod at given values.
fn experiment(
    rod: &HeldRod,
    number: usize,
    view: &HeldView,
    values: [f64; 3],
) -> Result<Experiment, IdentifyError> {
    if view.points.len() < FEWEST {
        let picture = view.picture.display();
        return Err(IdentifyError::Input(format!(
            "{picture}: the traced rod is too short to be fitted"
        )));
    }
    let nodes = rod.nodes(&view.hand, values)?;
    let seen: Vec<[f64; 2]> = nodes
        .iter()
        .map(|node| {
            let seen = view.camera.inverse_transform_point(&(*node).into());
            [seen.x / seen.z, seen.y / seen.z]
        })
        .collect();
    let stride = view.points.len().div_ceil(POINTS);
    let points = view.points.iter().enumerate().step_by(stride);
    let data = points.map(|(index, point)| {
        let (edge, along) = nearest(&seen, *point);
        let ray = view.camera.rotation * Vector3::new(point[0], point[1], 1.0);
        let normal = ray.cross(&(nodes[edge + 1] - nodes[edge])).normalize();
        Datum {
            line: index + 1,
            time: None,
            measured: Measured::Along {
                place: Place {
                    rod: None,
                    at: At::Part((edge as f64 + along) / EDGES as f64),
                },
                direction: normal.into(),
            },
            value: normal.dot(&view.camera.translation.vector),
            deviation: None,
            series: "across".to_owned(),
        }
    });
    let file = DataFile {
        path: PICTURES.into(),
        data: data.collect(),
    };
    let stem = view.picture.file_stem().unwrap_or_default();
    let text = rod.scenario(&view.hand, &Shifts::new(number, &view.camera), values);
    Ok(Experiment {
        scenario: case_set_from_text(&stem.to_string_lossy(), &text, Path::new(""))?,
        files: vec![file],
    })
}

/// The edge of a curve that is nearest to a point, and the fraction along the edge, 0 to 1.
fn nearest(curve: &[[f64; 2]], point: [f64; 2]) -> (usize, f64) {
    let mut found = (0, 0.0);
    let mut least = f64::INFINITY;
    for (edge, pair) in curve.windows(2).enumerate() {
        let [along, to] = [pair[1], point].map(|end| [end[0] - pair[0][0], end[1] - pair[0][1]]);
        let square = along[0] * along[0] + along[1] * along[1];
        let part = match square > 0.0 {
            true => ((to[0] * along[0] + to[1] * along[1]) / square).clamp(0.0, 1.0),
            false => 0.0,
        };
        let away = (to[0] - part * along[0]).powi(2) + (to[1] - part * along[1]).powi(2);
        if away < least {
            (least, found) = (away, (edge, part));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Translation3, UnitQuaternion};

    /// A camera that looks down from 1.6 m.
    fn camera() -> Isometry3<f64> {
        let down = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
        Isometry3::from_parts(Translation3::new(0.0, 0.0, 1.6), down)
    }

    /// A hand with a heading, whose rod is turned by an angle out of the vertical.
    fn hand(place: [f64; 3], heading: f64, tilt: f64) -> Isometry3<f64> {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), heading);
        let tilt = tilt - std::f64::consts::FRAC_PI_2;
        let tilt = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), tilt);
        Isometry3::from_parts(Translation3::from(place), turn * tilt)
    }

    /// A fit moves from a straight rod to a slightly curved one without a jump of its shape.
    #[test]
    fn the_shape_of_a_held_rod_changes_smoothly_with_its_natural_curvature() {
        let rod = HeldRod {
            title: "rod".to_owned(),
            length: 0.15,
            radius: 2e-3,
            density: 1000.0,
            gravito_bending_length: 0.03,
        };
        let hand = hand([0.12, 0.0, 1.1], 1.5, 1.57);
        let shapes = (0..12).map(|k| {
            let curvature = 0.01 * f64::from(k);
            rod.nodes(&hand, [0.03, 0.2 * curvature, curvature])
                .unwrap()
        });
        let shapes: Vec<_> = shapes.collect();
        for three in shapes.windows(3) {
            for ((before, here), after) in three[0].iter().zip(&three[1]).zip(&three[2]) {
                let bend = (before - here * 2.0 + after).norm();
                assert!(bend < 1e-6, "{bend:e}");
            }
        }
    }

    #[test]
    fn three_pictures_from_above_give_length_and_curvature_of_a_rod_that_is_not_the_expected_one() {
        let rod = HeldRod {
            title: "rod".to_owned(),
            length: 0.2,
            radius: 1.6e-3,
            density: 1000.0,
            gravito_bending_length: 0.048,
        };
        let truth = [0.032, 1.5, -2.0];
        let camera = camera();
        let poses = [
            ([0.12, 0.0, 1.1], 1.5, 1.57),
            ([-0.12, 0.03, 1.1], 1.6, -1.57),
            ([0.1, 0.05, 1.0], 1.2, 2.1),
        ];
        let views: Vec<HeldView> = poses
            .into_iter()
            .enumerate()
            .map(|(number, (place, heading, tilt))| {
                let hand = hand(place, heading, tilt);
                let nodes = rod.nodes(&hand, truth).unwrap();
                // A fifth of a pixel of 1/2200.
                let wave = |k: usize, phase: f64| 1e-4 * (2.9 * k as f64 + phase).sin();
                let seen = nodes.iter().enumerate().map(|(k, node)| {
                    let seen = camera.inverse_transform_point(&(*node).into());
                    let noise = [0.0, 1.0].map(|phase| wave(k, phase + number as f64));
                    [seen.x / seen.z + noise[0], seen.y / seen.z + noise[1]]
                });
                HeldView {
                    picture: format!("look_{}.png", number + 1).into(),
                    hand,
                    camera,
                    points: seen.collect(),
                }
            })
            .collect();
        let (found, experiments) = identify_held(&rod, &views, &|| true).unwrap();
        assert!(found.converged);
        assert_eq!(experiments.len(), 3);
        assert_eq!(found.parameters.len(), 9);
        for (one, truth) in found.parameters.iter().zip(truth) {
            let error = one.standard_error.unwrap();
            println!("{}: {:.5} ± {error:.1e}, {truth}", one.key, one.value);
            assert!((one.value - truth).abs() < 4.0 * error, "{}", one.value);
        }
        let [length, ..] = found.parameters.as_slice() else {
            panic!("three keys");
        };
        assert!((length.value / truth[0] - 1.0).abs() < 0.01);
        assert_eq!(length.start, 0.048);
    }
}
