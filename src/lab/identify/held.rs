//! Scenario of the free part of a rod that a hand holds.

use super::error::IdentifyError;
use super::hanging::LENGTH_KEY;
use super::parameter::Request;
use crate::experiment::{case_set_from_text, prepare};
use nalgebra::Isometry3;
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::Simulation;
use std::path::Path;

/// Keys of the natural curvature, 1/m, about the y and the z axis of the hand.
const CURVATURE_KEYS: [&str; 2] = ["parameters.curvature_1", "parameters.curvature_2"];
/// Edges of the simulated rod.
pub(super) const EDGES: usize = 48;
/// Minimum angle, rad, of the arc in which the rod is placed, and minimum sine of the angle
/// between the rod's direction and the vertical for which the two define a plane.
const VERTICAL: f64 = 0.05;
/// Factor by which the gravito-bending length may differ from the expected one.
const RANGE: f64 = 5.0;
/// Prior standard deviation of the natural curvatures times the free length.
pub const CURLED: f64 = 1.0;
/// Standard deviation of the place of the hand along each axis across the view, m.
pub const HAND_ERROR: f64 = 3e-4;
/// Twisting stiffness over the bending stiffness of a round incompressible rod.
const TWISTING: f64 = 2.0 / 3.0;
/// Stretching stiffness over the weight of the free part.
const STRETCHING: f64 = 1e4;
/// Acceleration of free fall, m/s².
const GRAVITY: f64 = 9.81;

/// The free part of a rod that a hand holds.
#[derive(Clone, Debug)]
pub struct HeldRod {
    /// Name of the rod for readers.
    pub title: String,
    /// Length of the free part, m.
    pub length: f64,
    /// Radius, m.
    pub radius: f64,
    /// Density, kg/m³; the shape does not depend on it.
    pub density: f64,
    /// Expected gravito-bending length, m.
    pub gravito_bending_length: f64,
}

impl HeldRod {
    /// Computes its nodes in equilibrium from the hand to the free end, m. `values` are the
    /// gravito-bending length, m, and the natural curvature about the y and the z axis of the
    /// hand, 1/m.
    ///
    /// # Errors
    /// The equilibrium is not found.
    pub fn nodes(
        &self,
        hand: &Isometry3<f64>,
        values: [f64; 3],
    ) -> Result<Vec<Vector3>, IdentifyError> {
        let name = "held";
        let failed = |source| IdentifyError::Simulation {
            scenario: name.to_owned(),
            source,
        };
        let text = self.scenario(hand, &Shifts::default(), values);
        let cases = case_set_from_text(name, &text, Path::new(""))?;
        let loaded = cases.scenario_of(0)?;
        let prepared = prepare(&loaded.scenario).map_err(|issues| loaded.locate(issues))?;
        let mut simulation =
            Simulation::new(&prepared.scene, &prepared.integration).map_err(failed)?;
        simulation.find_equilibrium().map_err(failed)?;
        Ok(simulation.positions().to_vec())
    }

    pub(super) fn scenario(
        &self,
        hand: &Isometry3<f64>,
        shifts: &Shifts,
        values: [f64; 3],
    ) -> String {
        let [unit, one, other] = values;
        let start = hand.translation.vector;
        let [tangent, director] = [-Vector3::x(), Vector3::y()].map(|axis| hand.rotation * axis);
        let shape = self.placed(&shifts.of(start), tangent);
        let shifts = &shifts.keys;
        let director = list(director);
        let radius = self.radius;
        let weight = self.density * std::f64::consts::PI * radius * radius * GRAVITY;
        let stretching = STRETCHING * weight * self.length;
        let (title, density) = (toml::Value::from(self.title.as_str()), self.density);
        format!(
            r#"experiment = "scene"
title = {title}
[parameters]
gravito_bending_length = {unit:?}
curvature_1 = {one:?}
curvature_2 = {other:?}
{shifts}ei = "2*{weight:?}*gravito_bending_length^3"
[material]
youngs_modulus = "1 MPa"
poissons_ratio = 0.5
density = {density:?}
[[rods]]
name = "rod"
radius = {radius:?}
edges = {EDGES}
inertia = "consistent"
shape = {shape}
natural_curvature = ["curvature_1", "curvature_2"]
director = {director}
stiffness = {{ bending_1 = "ei", bending_2 = "ei", twisting = "{TWISTING:?}*ei", stretching = {stretching:?} }}
[[clamps]]
rod = "rod"
at = "start"
[[loads]]
kind = "gravity"
acceleration = [0, 0, {:?}]
[time]
mode = "static"
"#,
            -GRAVITY
        )
    }

    /// Initial shape, close to the hanging one: an arc that starts at the hand and ends straight
    /// down.
    fn placed(&self, start: &str, tangent: Vector3) -> String {
        let down = -Vector3::z();
        let mut normal = tangent.cross(&down);
        // If the rod points straight up or down, any plane will do.
        if normal.norm() < VERTICAL {
            normal = tangent.cross(&Vector3::x());
        }
        let angle = tangent.angle(&down).max(VERTICAL);
        let (normal, radius) = (list(normal.normalize()), self.length / angle);
        let tangent = list(tangent);
        format!(
            "{{ kind = \"arc\", start = {start}, tangent = {tangent}, normal = {normal}, radius = {radius:?}, angle = {angle:?} }}"
        )
    }

    pub(super) fn keys(&self, views: usize) -> Vec<Request> {
        let unit = self.gravito_bending_length;
        let length = Request {
            key: LENGTH_KEY.to_owned(),
            bounds: Some([unit / RANGE, unit * RANGE]),
            prior: None,
        };
        let curvatures = CURVATURE_KEYS.map(|key| Request {
            key: key.to_owned(),
            bounds: None,
            prior: Some([0.0, CURLED / self.length]),
        });
        let shifts = (1..=views).flat_map(shift_names).map(|name| Request {
            key: format!("parameters.{name}"),
            bounds: None,
            prior: Some([0.0, HAND_ERROR]),
        });
        let keys = [length].into_iter().chain(curvatures);
        keys.chain(shifts).collect()
    }
}

/// Shifts of a hand across the view, which are parameters of its scenario.
#[derive(Default)]
pub(super) struct Shifts {
    /// Their keys, a line each.
    keys: String,
    /// Their names and the directions.
    along: Vec<(String, Vector3)>,
}

/// Names of the shifts of a hand in a picture, from 1.
fn shift_names(number: usize) -> [String; 2] {
    ["x", "y"].map(|axis| format!("hand_{axis}_{number}"))
}

impl Shifts {
    /// The shifts in a picture, from 1, along the axes of its camera.
    pub fn new(number: usize, camera: &Isometry3<f64>) -> Self {
        let names = shift_names(number);
        let axes = [Vector3::x(), Vector3::y()].map(|axis| camera.rotation * axis);
        Self {
            keys: names.iter().map(|name| format!("{name} = 0.0\n")).collect(),
            along: names.into_iter().zip(axes).collect(),
        }
    }

    /// Adds the shifts to a place, as a list of expressions.
    fn of(&self, place: Vector3) -> String {
        if self.along.is_empty() {
            return list(place);
        }
        let sums = [0, 1, 2].map(|axis| {
            let parts = self.along.iter();
            let parts = parts.map(|(name, along)| format!(" + ({:?})*{name}", along[axis]));
            format!("\"{:?}{}\"", place[axis], parts.collect::<String>())
        });
        format!("[{}]", sums.join(", "))
    }
}

/// A vector as a list.
fn list(vector: Vector3) -> String {
    format!("{:?}", [vector.x, vector.y, vector.z])
}
