//! Gradient and Hessian of all terms at random states, against finite differences.

use super::rods::{clamp, unit_rod};
use super::{Check, Expectation, GroupError};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::contact::ContactParameters;
use rodlab_engine::mechanics::scene::{NaturalShape, Plane, RodDescription, Scene};
use rodlab_engine::mechanics::system::{Stage, System};
use rodlab_engine::random::uniform_numbers;
use std::f64::consts::TAU;

const GRADIENT: Expectation = Expectation::new("R = ∇E", "central differences");
const HESSIAN: Expectation = Expectation::new("J = ∂R/∂q", "central differences");
/// Steps of the differences, m and rad. With this size the truncation and rounding errors are
/// about equal.
const STEP: f64 = 2e-5;
/// Width of the contact zone, m; it is large so that these steps resolve it.
const CONTACT_ZONE: f64 = 0.02;
/// Radius of the rods that touch, m.
const THICK: f64 = 0.05;

/// Checks the elasticity of clamped ribbons and rings, contact, and friction with inertia.
pub fn checks(_full: bool) -> Result<Vec<Check>, GroupError> {
    let mut checks = Vec::new();
    for (name, scene) in [
        ("clamped ribbon with natural curvature", ribbon()),
        ("twisted ring", ring()),
        (
            "rods in contact with each other and a plane",
            crossing_rods(0.0),
        ),
    ] {
        let mut sample = Sample::new(&scene)?;
        let gradient = GRADIENT.of(format!("{name}: worst gradient"), "");
        let hessian = HESSIAN.of(format!("{name}: worst Hessian"), "");
        checks.extend([
            gradient.zero(sample.gradient_error(), 1e-8),
            hessian.zero(sample.jacobian_error(None), 1e-6),
        ]);
    }
    let mut sample = Sample::new(&crossing_rods(0.4))?;
    let stage = sample.sliding_stage();
    let error = sample.jacobian_error(Some(&stage));
    let name = "sliding rods, friction and inertia: worst Jacobian";
    checks.push(HESSIAN.of(name, "").zero(error, 1e-6));
    Ok(checks)
}

/// A system at a random state near its initial one.
struct Sample {
    system: System,
    unknowns: Vec<f64>,
    free: Vec<usize>,
}

impl Sample {
    fn new(scene: &Scene) -> Result<Self, GroupError> {
        let mut system = System::new(scene)?;
        let mut number = uniform_numbers(1);
        let mut unknowns = system.assembly.unknowns.clone();
        let free: Vec<usize> = (0..unknowns.len())
            .filter(|&k| !system.assembly.held[k])
            .collect();
        for &k in &free {
            let amplitude = if k % 4 == 3 { 0.3 } else { 2e-3 };
            unknowns[k] += amplitude * (2.0 * number() - 1.0);
        }
        system.drive(0.0, &mut unknowns);
        system.update_candidates(&unknowns);
        Ok(Self {
            system,
            unknowns,
            free,
        })
    }

    /// A stage that starts from a nearby state, so that all contacts slide.
    fn sliding_stage(&self) -> Stage {
        let mut number = uniform_numbers(2);
        let mut start = self.unknowns.clone();
        for &k in &self.free {
            start[k] += 1e-3 * (2.0 * number() - 1.0);
        }
        let position = |node: usize| Vector3::from_column_slice(&start[4 * node..4 * node + 3]);
        Stage {
            step: 0.01,
            keeps_spin: false,
            acceleration_step: 0.012,
            velocity: vec![0.0; start.len()],
            drag: Vec::new(),
            drag_velocity: Vec::new(),
            resistance: Vec::new(),
            flow_torque: Vec::new(),
            positions: (0..start.len() / 4).map(position).collect(),
            angles: start.iter().skip(3).step_by(4).copied().collect(),
            start,
        }
    }

    fn energy(&mut self, unknowns: &[f64]) -> f64 {
        self.system.evaluate(unknowns, None);
        let elastic = self.system.elastic_energy();
        let contact = self
            .system
            .contact()
            .map_or(0.0, |contact| contact.energy());
        elastic.total() + contact
    }

    /// Largest error of the gradient, relative to its largest entry.
    fn gradient_error(&mut self) -> f64 {
        let base = self.unknowns.clone();
        self.system.evaluate(&base, None);
        let gradient = self.system.residual.clone();
        let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
        for k in self.free.clone() {
            let difference = derivative(|shift| {
                let mut unknowns = base.clone();
                unknowns[k] += shift;
                [self.energy(&unknowns)]
            })[0];
            worst = worst.max((difference - gradient[k]).abs());
            largest = largest.max(gradient[k].abs());
        }
        worst / largest
    }

    /// Largest error of the Jacobian, relative to its largest entry.
    fn jacobian_error(&mut self, stage: Option<&Stage>) -> f64 {
        let base = self.unknowns.clone();
        self.system.linearize(&base, stage);
        let jacobian = self.system.dense_matrix();
        let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
        for &column in &self.free {
            let difference = derivative(|shift| {
                let mut unknowns = base.clone();
                unknowns[column] += shift;
                self.system.evaluate(&unknowns, stage);
                self.system.residual.clone()
            });
            for &row in &self.free {
                worst = worst.max((difference[row] - jacobian[(row, column)]).abs());
                largest = largest.max(jacobian[(row, column)].abs());
            }
        }
        worst / largest
    }
}

/// Derivative at zero by central differences of sixth order.
fn derivative<V: AsRef<[f64]>>(mut function: impl FnMut(f64) -> V) -> Vec<f64> {
    let weights = [45.0 / 60.0, -9.0 / 60.0, 1.0 / 60.0];
    let mut sum = Vec::new();
    for (k, weight) in (1..).zip(weights) {
        let shift = f64::from(k) * STEP;
        let (ahead, behind) = (function(shift), function(-shift));
        let (ahead, behind) = (ahead.as_ref(), behind.as_ref());
        sum.resize(ahead.len(), 0.0);
        for (entry, (ahead, behind)) in sum.iter_mut().zip(ahead.iter().zip(behind)) {
            *entry += weight * (ahead - behind) / STEP;
        }
    }
    sum
}

/// A rod that is stretchable enough for differences of the energy to resolve bending and twisting,
/// too.
fn soft_rod(centreline: Vec<Vector3>) -> RodDescription {
    let mut rod = unit_rod(centreline);
    rod.stiffness.stretching = 50.0;
    rod
}

fn ribbon() -> Scene {
    let node = |k: usize| {
        let s = k as f64 / 8.0;
        Vector3::new(s, 0.3 * libm::sin(3.0 * s), 0.2 * s * s)
    };
    let mut rod = soft_rod((0..=8).map(node).collect());
    rod.stiffness.bending = [2.5, 1.0];
    rod.twist = 1.5;
    rod.natural_shape = NaturalShape::Curved {
        curvature: [0.7, -0.4],
        twist: 0.5,
    };
    Scene {
        rods: vec![rod],
        clamps: vec![clamp(0), clamp(8)],
        ..Scene::default()
    }
}

fn ring() -> Scene {
    let node = |k: usize| {
        let angle = TAU * k as f64 / 9.0;
        Vector3::new(
            libm::cos(angle),
            libm::sin(angle),
            0.2 * libm::sin(2.0 * angle),
        ) * 0.2
    };
    let mut rod = soft_rod((0..9).map(node).collect());
    rod.closed = true;
    rod.twist = 4.0;
    Scene {
        rods: vec![rod],
        ..Scene::default()
    }
}

/// Two rods that cross within the contact zone of each other, the lower one within that of a plane.
fn crossing_rods(friction: f64) -> Scene {
    let rod = |centre: Vector3, direction: Vector3| {
        let nodes = (0..5)
            .map(|k| centre + direction * (f64::from(k) * 0.27 - 0.5))
            .collect();
        RodDescription {
            radius: THICK,
            ..soft_rod(nodes)
        }
    };
    let gap = 0.3 * CONTACT_ZONE;
    let lower = Vector3::z() * (THICK + gap);
    let upper = lower + Vector3::z() * (2.0 * THICK + gap);
    Scene {
        rods: vec![
            rod(lower, Vector3::x()),
            rod(upper, Vector3::new(0.3, 0.9, 0.0)),
        ],
        planes: vec![Plane {
            point: Vector3::zeros(),
            normal: Vector3::z(),
            friction: None,
            directed_friction: None,
        }],
        contact: Some(ContactParameters {
            distance_tolerance: CONTACT_ZONE,
            friction,
            slip_tolerance: 0.5,
            stiffness_factor: 1e3,
            ..ContactParameters::default()
        }),
        ..Scene::default()
    }
}
