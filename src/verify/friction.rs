//! Coulomb friction: a rod on an incline, a rope around a post, and rods that roll.

use super::contact::contact_parameters;
use super::rods::{clamp, force_on, line, run_until, steady, steps_of, unit_rod};
use super::theory::friction::{Capstan, sliding_acceleration};
use super::{Check, Expectation, GroupError, crawling, rolling};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::contact::{ContactModel, ContactParameters};
use rodlab_engine::mechanics::dynamics::{IntegrationParameters, Simulation};
use rodlab_engine::mechanics::scene::{
    Body, Clamp, EdgeSection, Joint, JointKind, LoadKind, Motion, Plane, RodDescription, RodNode,
    Scene, Stiffness, Strength,
};
use std::f64::consts::PI;

const SLIDING: Expectation = Expectation::new("a = g (sin α − μ cos α)", "Coulomb");
const COATED: Expectation = Expectation::new(
    "a = g (sin α − ½ (√μ₁μ₀ + √μ₂μ₀) cos α)",
    "Coulomb; geometric mean",
);
const STICKING: Expectation = Expectation::new("v = 0 for μ > tan α", "Coulomb");
const CAPSTAN: Expectation = Expectation::new(
    "T₂ = T₁ exp(μφ), corrected for EI",
    "Euler; balance of the elastica",
);
const GRAVITY: f64 = 9.81;

/// The contact models with their names in scenario files, and the allowed creep speed of sticking
/// contacts, as a fraction of the slip tolerance.
///
/// With the smoothed law, sticking contacts creep below the slip tolerance; rigid contacts stick
/// within the tolerance of Newton's method.
const MODELS: [(ContactModel, &str, f64); 3] = [
    (ContactModel::ImplicitContact, "imc", 1.0),
    (ContactModel::IncrementalPotential, "ipc", 1.0),
    (ContactModel::Complementarity, "complementarity", 1e-6),
];

/// Sliding and sticking on an incline, and the capstan, by every contact model; rolling by those that turn rods.
pub fn checks(_full: bool) -> Result<Vec<Check>, GroupError> {
    let (steep_angle, shallow_angle) = (30f64.to_radians(), 20f64.to_radians());
    let slip_tolerance = ContactParameters::default().slip_tolerance;
    let mut checks = Vec::new();
    for (model, name, creep) in MODELS {
        let steep = slide(model, steep_angle, 0.3)?;
        let shallow = slide(model, shallow_angle, 0.5)?;
        let sliding = format!("rod on an incline of 30°, μ = 0.3, {name}: acceleration");
        let sticking =
            format!("rod on an incline of 20°, μ = 0.5, {name}: speed over slip tolerance");
        let expected = sliding_acceleration(GRAVITY, steep_angle, 0.3);
        checks.extend([
            SLIDING
                .of(sliding, "m/s²")
                .relative(expected, steep.acceleration, 1e-2),
            STICKING
                .of(sticking, "")
                .zero(shallow.speed / slip_tolerance, creep),
            coated(model, name, steep_angle)?,
            capstan(model, name)?,
        ]);
    }
    checks.extend(slide_joined(steep_angle, shallow_angle)?);
    checks.extend(rolling::checks()?);
    checks.push(crawling::check()?);
    Ok(checks)
}

/// A chain of two rods, of which one carries a body, on an incline by complementarity: the creep
/// is compared with a speed, not with a slip tolerance, which the model does not have.
fn slide_joined(steep_angle: f64, shallow_angle: f64) -> Result<Vec<Check>, GroupError> {
    let model = ContactModel::Complementarity;
    let mut checks = Vec::new();
    for (kind, name) in [(JointKind::Ball, "ball"), (JointKind::Rigid, "rigid")] {
        let steep = release(chain(kind, steep_angle, contact_parameters(model, 0.3)))?;
        let shallow = release(chain(kind, shallow_angle, contact_parameters(model, 0.5)))?;
        let sliding =
            format!("two rods with a {name} joint and a body, 30°, μ = 0.3, complementarity: a");
        let sticking = format!(
            "two rods with a {name} joint and a body, 20°, μ = 0.5, complementarity: speed over 1 mm/s"
        );
        let expected = sliding_acceleration(GRAVITY, steep_angle, 0.3);
        checks.extend([
            SLIDING
                .of(sliding, "m/s²")
                .relative(expected, steep.acceleration, 1e-6),
            STICKING.of(sticking, "").zero(shallow.speed / 1e-3, 1e-9),
        ]);
    }
    Ok(checks)
}

/// Two rods at an angle to each other that lie on an incline, with a body at the end of the first.
fn chain(kind: JointKind, incline: f64, contact: ContactParameters) -> Scene {
    let mut scene = on_incline(incline, contact);
    let first = &scene.rods[0];
    let middle = first.centreline[EDGES];
    let along = Vector3::new(0.08, 0.06, 0.0);
    let second = unit_rod(line(middle, middle + along, EDGES));
    scene.rods.push(second);
    let [end, start] = [(0, EDGES), (1, 0)].map(|(rod, node)| RodNode { rod, node });
    scene.joints.push(Joint {
        name: "joint".into(),
        nodes: [end, start],
        kind,
        strength: Strength::default(),
    });
    scene.bodies.push(Body {
        name: "body".into(),
        at: RodNode { rod: 0, node: 0 },
        mass: 0.01,
        offset: Vector3::zeros(),
        inertia: Some([2e-6, 3e-6, 4e-6]),
        ball: None,
    });
    scene
}

/// Motion of a rod on an incline.
struct Slide {
    /// Mean acceleration over the second half of the time, m/s².
    acceleration: f64,
    /// Speed at the end, m/s.
    speed: f64,
}

/// Number of edges of a rod on an incline.
const EDGES: usize = 4;

/// A rod along the line of steepest descent, released at rest.
fn slide(model: ContactModel, incline: f64, friction: f64) -> Result<Slide, GroupError> {
    release(on_incline(incline, contact_parameters(model, friction)))
}

/// A rod whose halves have the friction coefficients 0.1 and 0.4 of their own, on a plane with 0.1.
fn coated(model: ContactModel, name: &str, incline: f64) -> Result<Check, GroupError> {
    let mut scene = on_incline(incline, contact_parameters(model, 0.3));
    scene.planes[0].friction = Some(0.1);
    let rod = &scene.rods[0];
    let section = |edge: usize| EdgeSection {
        friction: Some(if edge < EDGES / 2 { 0.1 } else { 0.4 }),
        ..rod.section(edge)
    };
    let sections = (0..EDGES).map(section).collect();
    scene.rods[0] = rod
        .clone()
        .with_sections(sections, &[0.1 / EDGES as f64; EDGES]);
    let found = release(scene)?.acceleration;
    let expected = sliding_acceleration(GRAVITY, incline, 0.5 * (0.1 + 0.2));
    let case = format!(
        "halves of a rod with μ = 0.1 and 0.4 on an incline of 30° with μ = 0.1, {name}: acceleration"
    );
    Ok(COATED.of(case, "m/s²").relative(expected, found, 1e-6))
}

/// A rod along the line of steepest descent.
fn on_incline(incline: f64, contact: ContactParameters) -> Scene {
    let rod = unit_rod(line(Vector3::zeros(), 0.1 * Vector3::x(), EDGES));
    let height = rod.radius + 0.5 * contact.distance_tolerance;
    let lifted = rod.centreline.iter().map(|x| x + height * Vector3::z());
    Scene {
        rods: vec![RodDescription {
            centreline: lifted.collect(),
            ..rod
        }],
        loads: vec![steady(LoadKind::Gravity {
            acceleration: GRAVITY * Vector3::new(libm::sin(incline), 0.0, -libm::cos(incline)),
        })],
        planes: vec![Plane {
            point: Vector3::zeros(),
            normal: Vector3::z(),
            friction: None,
            directed_friction: None,
        }],
        contact: Some(contact),
        ..Scene::default()
    }
}

/// Motion of the rods of a scene, released at rest.
fn release(scene: Scene) -> Result<Slide, GroupError> {
    // A sticking rod moves by the residual of Newton's method.
    let integration = IntegrationParameters {
        force_tolerance: 1e-8,
        ..IntegrationParameters::default()
    };
    let mut simulation = Simulation::new(&scene, &integration)?;
    let speed_at = |simulation: &mut Simulation, time: f64| -> Result<f64, GroupError> {
        run_until(simulation, time)?;
        let velocities = simulation.velocities();
        Ok(velocities.iter().map(|v| v.x).sum::<f64>() / velocities.len() as f64)
    };
    let middle = speed_at(&mut simulation, 0.2)?;
    let speed = speed_at(&mut simulation, 0.4)?;
    Ok(Slide {
        acceleration: (speed - middle) / 0.2,
        speed,
    })
}

/// Radius of the post, m.
pub(super) const POST_RADIUS: f64 = 0.02;
/// Radius of the rope, m.
const ROPE_RADIUS: f64 = 1e-3;
/// Radius of the centreline of the rope around the post, m.
const WRAP_RADIUS: f64 = POST_RADIUS + ROPE_RADIUS;
/// Number of edges around the post.
const WRAPPED_EDGES: usize = 40;
/// Number of edges in each leg.
const LEG_EDGES: usize = 24;
/// Weight on the leg with the smaller tension, N.
const WEIGHT: f64 = 1.0;
const ROPE_FRICTION: f64 = 0.3;
/// Speed at which the other leg is pulled, m/s: far above the slip tolerance and far below the
/// speed of sound.
const PULL: f64 = 0.02;

/// A rope over a post, in contact over half a turn; a weight hangs on one leg, and the other leg
/// is pulled.
fn capstan(model: ContactModel, name: &str) -> Result<Check, GroupError> {
    let rope = rope();
    let (stiffness, nodes) = (rope.stiffness, rope.centreline.clone());
    let mut simulation = Simulation::new(&capstan_scene(model, rope), &steps_of(5e-4))?;
    let tensions = leg_tensions(&mut simulation, &nodes, stiffness.stretching, LEG_EDGES)?;
    let name = format!("rope over a post, μ = 0.3, half a turn, {name}: T₂/T₁");
    Ok(capstan_check(name, tensions, stiffness.bending[0], 3e-2))
}

/// Check of the ratio of the two tensions (N) of a rope with the given bending stiffness (N m²)
/// over the post, in contact over half a turn.
pub(super) fn capstan_check(name: String, tensions: [f64; 2], bending: f64, bound: f64) -> Check {
    let [lesser, greater] = tensions;
    let theory = Capstan {
        friction: ROPE_FRICTION,
        angle: PI,
        bending,
        radius: WRAP_RADIUS,
    };
    let expected = theory.greater_tension(lesser) / lesser;
    CAPSTAN
        .of(name, "")
        .relative(expected, greater / lesser, bound)
}

/// Mean tensions of the straight parts of both legs, N: see [`tension_samples`].
pub(super) fn leg_tensions(
    simulation: &mut Simulation,
    nodes: &[Vector3],
    stretching: f64,
    leg_edges: usize,
) -> Result<[f64; 2], GroupError> {
    let samples = tension_samples(simulation, nodes, stretching, leg_edges)?;
    let mean = |leg: usize| {
        let sum: f64 = samples.iter().map(|tensions| tensions[leg]).sum();
        sum / samples.len() as f64
    };
    Ok([mean(0), mean(1)])
}

/// Tensions of the straight parts of both legs, N, of a rope with the given stretching stiffness
/// (N) that was placed at `nodes`, in every step from 0.3 s, when the pull has settled, to 0.5 s.
pub(super) fn tension_samples(
    simulation: &mut Simulation,
    nodes: &[Vector3],
    stretching: f64,
    leg_edges: usize,
) -> Result<Vec<[f64; 2]>, GroupError> {
    let tension = |simulation: &Simulation, edge: usize| {
        let natural = (nodes[edge + 1] - nodes[edge]).norm();
        let now = simulation.positions();
        stretching * ((now[edge + 1] - now[edge]).norm() / natural - 1.0)
    };
    // The edges in the middle of the legs.
    let edges = [leg_edges / 2, nodes.len() - 2 - leg_edges / 2];
    let (settled, end) = (0.3, 0.5);
    let mut samples = Vec::new();
    while simulation.time() < end {
        simulation.advance(end)?;
        if simulation.time() > settled {
            samples.push(edges.map(|edge| tension(simulation, edge)));
        }
    }
    Ok(samples)
}

/// Nodes of a rope over the post, from the end with the weight to the pulled end, with given
/// numbers of edges around the post and in each leg. The nodes are slightly outside, so that the
/// middles of the edges touch the post, up to a gap, which is a fraction of the radius.
pub(super) fn rope_over_post(wrapped: usize, leg_edges: usize, gap: f64) -> Vec<Vector3> {
    let step = PI / wrapped as f64;
    let edge = 2.0 * WRAP_RADIUS * libm::tan(0.5 * step);
    let corner = WRAP_RADIUS / libm::cos(0.5 * step);
    let gap = 1.0 + gap;
    let leg = |k: usize, side: f64| Vector3::new(side * corner, -edge * k as f64, 0.0) * gap;
    let around = |k: usize| {
        let angle = PI - step * k as f64;
        Vector3::new(libm::cos(angle), libm::sin(angle), 0.0) * (corner * gap)
    };
    (1..=leg_edges)
        .rev()
        .map(|k| leg(k, -1.0))
        .chain((0..=wrapped).map(around))
        .chain((1..=leg_edges).map(|k| leg(k, 1.0)))
        .collect()
}

/// A thin rope, placed over the post.
fn rope() -> RodDescription {
    let centreline = rope_over_post(WRAPPED_EDGES, LEG_EDGES, 1e-4);
    // Bending is a small correction, EI/(2ρ² T₁) = 0.5 %; at the greater tension the rope stretches by 0.3 %.
    let bending = 0.01 * WEIGHT * WRAP_RADIUS * WRAP_RADIUS;
    let stiffness = Stiffness {
        stretching: 1e3 * WEIGHT,
        bending: [bending; 2],
        twisting: bending,
    };
    RodDescription::uniform("rod", centreline, stiffness, ROPE_RADIUS, 0.01)
}

fn capstan_scene(model: ContactModel, rope: RodDescription) -> Scene {
    let last = rope.centreline.len() - 1;
    let half = 0.05 * Vector3::z();
    let post = RodDescription {
        name: "post".into(),
        radius: POST_RADIUS,
        held: true,
        ..unit_rod(vec![-half, half])
    };
    let pull = Motion {
        translation: vec![(0.0, Vector3::zeros()), (1.0, -PULL * Vector3::y())],
        ..Motion::default()
    };
    Scene {
        rods: vec![rope, post],
        clamps: vec![Clamp {
            holds_frame: false,
            motion: pull,
            ..clamp(last)
        }],
        loads: vec![
            steady(force_on(0, -WEIGHT * Vector3::y())),
            // This drag damps the swinging of the legs; along the rope it is 3e-4 N.
            steady(LoadKind::Drag {
                rod: Some(0),
                translation: 0.1,
                rotation: 0.0,
            }),
        ],
        contact: Some(contact_parameters(model, ROPE_FRICTION)),
        ..Scene::default()
    }
}
