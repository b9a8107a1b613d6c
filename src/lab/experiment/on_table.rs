//! Common parts of experiments in which a gripper handles a rod or a sheet on a table.

use crate::scenario::keys::{Dimensionless, FINITE, Quantity, Request, Section};
use crate::scenario::{Begin, Contact, Material, Scheme, Step, Time};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::scene::{Load, LoadKind, Plane, Scene};
use rodlab_planning::plan::deployment::DeployedRod;

/// Acceleration of free fall, m/s².
pub const GRAVITY: f64 = 9.81;
/// Default step, s.
const STEP: f64 = 5e-3;
/// Largest relative error of a length.
const LARGEST_ERROR: f64 = 0.9;
/// Default period of the fastest jitter of a gripper, s.
pub const JITTER_PERIOD: f64 = 1.0;
/// Allowed numbers of edges.
const EDGES: [usize; 2] = [10, 100_000];
/// Minimum and maximum of the default number of edges.
const USUAL_EDGES: [f64; 2] = [80.0, 400.0];

/// The default time steps, up to `end`, s.
pub fn usual_time(end: f64) -> Time {
    Time::Dynamic {
        scheme: Scheme::ImplicitEuler,
        step: Step::Fixed(STEP),
        end,
        begin: Begin::Placed,
    }
}

/// Rejects a run without time; `why` is the process that needs time.
pub fn need_time(request: &Request<'_>, why: &str) {
    if !matches!(request.time, Time::Dynamic { .. }) {
        let message = format!("{why}: use \"dynamic\"");
        request.top.below("time").fault("mode", message);
    }
}

/// Reports a table without contact; `what` is the action on the table.
pub fn need_contact(top: &Section<'_>, contact: &Contact, what: &str) {
    if *contact == Contact::None {
        top.missing("contact", format!("a table that {what} on: [contact]"));
    }
}

/// Resolves the relative error of the gravito-bending length in the plan.
pub fn length_error(section: &Section<'_>, typed: &Option<Quantity<Dimensionless>>) -> f64 {
    let error = section.with_default("length_error", typed, FINITE, 0.0);
    if error.abs() > LARGEST_ERROR {
        let allowed = format_args!("-{LARGEST_ERROR} to {LARGEST_ERROR}");
        section.out_of_range("length_error", error, allowed);
    }
    error
}

/// Resolves the seed of the jitter.
pub fn seed(section: &Section<'_>, typed: Option<i64>) -> u64 {
    let seed = typed.unwrap_or(0);
    if seed < 0 {
        section.out_of_range("seed", seed, "0 and above");
    }
    seed.max(0).unsigned_abs()
}

/// Resolves the number of edges of a simulated rod, about `usual` by default; `None` if it is out
/// of range, which is reported.
pub fn edges(section: &Section<'_>, typed: Option<i64>, usual: f64) -> Option<usize> {
    let [fewest, most] = EDGES;
    if typed.is_some() {
        return section.count("edges", typed, fewest..=most);
    }
    let [fewest, most] = USUAL_EDGES;
    Some(usual.round().clamp(fewest, most) as usize)
}

/// The material that gives a rod its gravito-bending length.
pub fn material(rod: &DeployedRod, density: f64) -> Material {
    Material {
        youngs_modulus: rod.youngs_modulus(density, GRAVITY),
        poissons_ratio: 0.5,
        density,
        viscosity: 0.0,
        relaxing_modulus: 0.0,
        relaxation_time: 0.0,
        yield_stress: 0.0,
        tangent_modulus: 0.0,
    }
}

/// Adds weight, and a table with a friction coefficient.
pub fn add_table(scene: &mut Scene, friction: f64) {
    scene.loads.push(Load {
        kind: LoadKind::Gravity {
            acceleration: -GRAVITY * Vector3::z(),
        },
        schedule: Vec::new(),
    });
    scene.planes.push(Plane {
        point: Vector3::zeros(),
        normal: Vector3::z(),
        friction: Some(friction),
        directed_friction: None,
    });
}
