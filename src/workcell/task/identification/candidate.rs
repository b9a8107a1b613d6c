//! View of a rod in a pose by a camera, and the information in the picture.
//!
//! A traced centreline measures only the distance across the rod. With the noise σ of a point, one
//! point for each width b of the rod along the curve, the unit normal m of the curve in the
//! picture, and the derivatives ∂a/∂u of a pixel a of the rod with respect to the unknowns u, the
//! information of the picture is
//!
//! ```text
//! I = ∫ g gᵀ da/(b σ²),   g = (∂a/∂u)ᵀ m
//! ```
//!
//! about u: the logarithm of the gravito-bending length, the two natural curvatures times the free
//! length, and the place of the hand across the view over its standard deviation. This place
//! differs from picture to picture. With the blocks I₁₁ of the first three unknowns and I₂₂ of the
//! last two, the information about the common unknowns is I₁₁ − I₁₂ (I₂₂ + 1)⁻¹ I₂₁.

use nalgebra::{Matrix2, Matrix3, Matrix5, Point3, Translation3, Vector5};
use rodlab_engine::mechanics::{UnitQuaternion, Vector3};
use rodlab_lab::identify::{HAND_ERROR, HeldRod, IdentifyError};
use rodlab_robot::Pose;
use rodlab_vision::{Camera, Point};
use std::f64::consts::FRAC_PI_2;

/// Factors on the expected gravito-bending length for which the whole rod must be visible.
const FACTORS: [f64; 3] = [1.0, 0.6, 1.6];
/// Step of the unknowns for derivatives.
const STEP: f64 = 0.02;
/// Fraction of a derivative by which a point is moved to compute its projected change.
const SMALL: f64 = 1e-3;
/// Noise of a traced point across the rod, pixels.
const NOISE: f64 = 0.3;
/// Fraction of the picture at its border that the rod must not enter.
const BORDER: f64 = 0.04;
/// Minimum distance from the camera, m.
const NEAREST: f64 = 0.35;
/// Minimum height of the rod above the table, m.
const ABOVE_TABLE: f64 = 0.05;
/// Minimum length of the rod in the picture, and minimum distance between parts of it that run
/// side by side, in widths.
pub(super) const LEAST_WIDTHS: [f64; 2] = [8.0, 1.5];

/// Shapes of a rod that leaves the hand at an angle from straight down, about the level y axis of the hand, held at the origin.
pub(super) struct Shape {
    /// The angle, rad.
    pub tilt: f64,
    /// Nodes for each factor, m.
    nodes: Vec<Vec<Vector3>>,
    /// Derivatives of the shapes with respect to the unknowns, at the first factor.
    derivatives: [Vec<Vector3>; 3],
    radius: f64,
    length: f64,
}

/// The pose of a hand with a heading, rad, whose rod leaves it at an angle from straight down, rad.
pub(super) fn hand(place: Vector3, heading: f64, tilt: f64) -> Pose {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), heading);
    let tilt = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), tilt - FRAC_PI_2);
    Pose::from_parts(Translation3::from(place), turn * tilt)
}

impl Shape {
    /// Computes the shapes.
    ///
    /// # Errors
    /// An equilibrium was not found.
    pub fn new(rod: &HeldRod, tilt: f64) -> Result<Self, IdentifyError> {
        let hand = hand(Vector3::zeros(), 0.0, tilt);
        let at = |unknowns: [f64; 3]| {
            let unit = rod.gravito_bending_length * libm::exp(unknowns[0]);
            let curvatures = [unknowns[1], unknowns[2]].map(|one| one / rod.length);
            rod.nodes(&hand, [unit, curvatures[0], curvatures[1]])
        };
        let derivative = |unknown: usize| -> Result<Vec<Vector3>, IdentifyError> {
            let sides = [STEP, -STEP].map(|step| {
                let mut unknowns = [0.0; 3];
                unknowns[unknown] = step;
                at(unknowns)
            });
            let [above, below] = sides;
            let pairs = above?.into_iter().zip(below?);
            Ok(pairs.map(|(a, b)| (a - b) / (2.0 * STEP)).collect())
        };
        let nodes = FACTORS.map(|factor| at([libm::log(factor), 0.0, 0.0]));
        Ok(Self {
            tilt,
            nodes: nodes.into_iter().collect::<Result<_, _>>()?,
            derivatives: [derivative(0)?, derivative(1)?, derivative(2)?],
            radius: rod.radius,
            length: rod.length,
        })
    }

    /// Returns its nodes in a cell, m, if it is held at a place with a heading, rad, and has the
    /// expected gravito-bending length.
    pub fn nodes_at(&self, place: Vector3, heading: f64) -> Vec<Vector3> {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), heading);
        let nodes = self.nodes[0].iter();
        nodes.map(|node| place + turn * node).collect()
    }

    /// Returns the information of a picture of it; `None` if the rod is not seen well, or is too
    /// near to the table.
    pub fn information(
        &self,
        camera: &Camera,
        place: Vector3,
        heading: f64,
    ) -> Option<Matrix3<f64>> {
        // The rod hangs straight down when it is handed over.
        if place.z - self.length < camera.table_height + ABOVE_TABLE {
            return None;
        }
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), heading);
        let mut pixels = Vec::new();
        for nodes in self.nodes.iter().rev() {
            let seen = nodes.iter().map(|node| seen(camera, place + turn * node));
            pixels = seen.collect::<Option<Vec<_>>>()?;
        }
        let lengths = lengths(&pixels);
        let widths = self.nodes[0].iter().map(|node| {
            let depth = camera
                .pose
                .inverse_transform_point(&Point3::from(place + turn * node))
                .z;
            2.0 * self.radius * camera.lens.focal[0] / depth
        });
        let widths: Vec<f64> = widths.collect();
        if is_tangled(&pixels, &lengths, &widths) {
            return None;
        }
        let shifts =
            [Vector3::x(), Vector3::y()].map(|axis| camera.pose.rotation * axis * HAND_ERROR);
        let mut information = Matrix5::zeros();
        for node in 1..pixels.len() - 1 {
            let along = pixels[node + 1] - pixels[node - 1];
            let Some(along) = along.try_normalize(1e-9) else {
                continue;
            };
            let across = Point::new(-along.y, along.x);
            let from = place + turn * self.nodes[0][node];
            let slope = |along: Vector3| {
                let moved = camera.project(from + along * SMALL)?;
                Some((moved - pixels[node]).dot(&across) / SMALL)
            };
            let of = |unknown: usize| slope(turn * self.derivatives[unknown][node]);
            let slopes = Vector5::new(of(0)?, of(1)?, of(2)?, slope(shifts[0])?, slope(shifts[1])?);
            let share = 0.5 * (lengths[node + 1] - lengths[node - 1]) / widths[node];
            information += slopes * slopes.transpose() * (share / (NOISE * NOISE));
        }
        let common = information.fixed_view::<3, 3>(0, 0);
        let mixed = information.fixed_view::<3, 2>(0, 3);
        let own = information.fixed_view::<2, 2>(3, 3) + Matrix2::identity();
        Some(common - mixed * own.try_inverse()? * mixed.transpose())
    }
}

/// Returns the pixel of a point if it is far enough from the camera, the table and the border of
/// the picture.
fn seen(camera: &Camera, point: Vector3) -> Option<Point> {
    let depth = camera.pose.inverse_transform_point(&Point3::from(point)).z;
    if depth < NEAREST || point.z < camera.table_height + ABOVE_TABLE {
        return None;
    }
    let pixel = camera.project(point)?;
    let [width, height] = [camera.width, camera.height].map(f64::from);
    let border = BORDER * width;
    let inside =
        (border..width - border).contains(&pixel.x) && (border..height - border).contains(&pixel.y);
    inside.then_some(pixel)
}

fn lengths(pixels: &[Point]) -> Vec<f64> {
    crate::cell::sums(pixels.windows(2).map(|pair| (pair[1] - pair[0]).norm()))
}

/// Whether a curve in the picture is too short, or comes too near to itself.
fn is_tangled(pixels: &[Point], lengths: &[f64], widths: &[f64]) -> bool {
    let [least, apart] = LEAST_WIDTHS;
    let count = pixels.len();
    let is_near = |one: usize, other: usize| {
        lengths[other] - lengths[one] > 2.0 * apart * widths[one]
            && (pixels[other] - pixels[one]).norm() < apart * widths[one]
    };
    lengths[count - 1] < least * widths[0]
        || (0..count).any(|one| (one + 1..count).any(|other| is_near(one, other)))
}
