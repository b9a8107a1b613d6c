//! Numbers derived from a scenario, for assessing it before it runs.

#[cfg(test)]
mod number_tests;
mod slides;
mod text;

use self::slides::{DerivedSlide, derived_slides};
use super::flow_guard::FlowGuard;
use super::{OwnNumbers, kind_named};
use crate::run::{Mode, PreparedRun};
use nalgebra::Complex;
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::{Scheme, StepSize};
use rodlab_engine::mechanics::fluid::FluidModel;
use rodlab_engine::mechanics::scene::{Clamp, LoadKind, Obstacle, Plane, RodDescription, Scene};
use rodlab_engine::mechanics::system::joint_unknowns;
use serde::Serialize;
use std::f64::consts::TAU;

/// Steps per turn of a drive in the advised step.
const STEPS_PER_TURN: f64 = 400.0;
/// Steps per period of the lowest bending mode in the advised step.
const STEPS_PER_PERIOD: f64 = 50.0;

/// Numbers derived from a scenario.
#[derive(Clone, Debug, Serialize)]
pub struct DerivedNumbers {
    /// Title of the scenario.
    pub title: String,
    /// Name of the experiment.
    pub experiment: String,
    /// The rods.
    pub rods: Vec<DerivedRod>,
    /// Nodes that slide along rods.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub slides: Vec<DerivedSlide>,
    /// Warnings about the scenario.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// The obstacles.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub obstacles: Vec<DerivedObstacle>,
    /// Boundary of the flow of a fluid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flow: Option<String>,
    /// Derived numbers of its kind of experiment.
    #[serde(flatten)]
    pub own: Option<OwnNumbers>,
    /// Unknowns of Newton's method, without those held by clamps and obstacles.
    pub degrees_of_freedom: usize,
    /// Reynolds number ρ v h/η of the fastest driven motion, with the rods' density and radius; `None`
    /// without fluid or drive.
    pub reynolds_number: Option<f64>,
    /// Recommended step that resolves drive and vibration, s; `None` in a static run, or if
    /// nothing sets a time scale.
    pub advised_step: Option<f64>,
    #[serde(skip)]
    scheme: Scheme,
    /// Fraction of its amplitude that the slowest bending oscillation loses per period due to the
    /// time scheme alone; `None` without fixed steps.
    pub lost_per_period: Option<f64>,
    /// Relative increase of its period due to the time scheme alone.
    pub longer_period: Option<f64>,
    /// Steps of the whole run; `None` in a static run or with automatic steps.
    pub steps: Option<f64>,
    /// Creep of contacts that stick by friction; `None` without such contacts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub creep: Option<Creep>,
}

/// Creep of contacts that stick by smoothed friction.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Creep {
    /// Slip tolerance, m/s.
    pub slip_tolerance: f64,
    /// Speed of a contact that transmits nine tenths of the largest friction, m/s.
    pub speed: f64,
    /// Distance covered at that speed in the whole run, m.
    pub way: f64,
    /// Distance `way` over the radius of the thinnest rod.
    pub way_in_radii: f64,
}

/// Numbers of one rod.
#[derive(Clone, Debug, Serialize)]
pub struct DerivedRod {
    /// Name.
    pub name: String,
    /// Number of nodes.
    pub nodes: usize,
    /// Length of the polyline, m.
    pub length: f64,
    /// Stretching stiffness EA, N; stiffnesses are means over rods whose sections vary.
    pub stretching_stiffness: f64,
    /// Bending stiffnesses EI₁ and EI₂, N m².
    pub bending_stiffness: [f64; 2],
    /// Twisting stiffness GJ, N m².
    pub twisting_stiffness: f64,
    /// Gravito-bending length (EI/2w)^⅓ of the smaller stiffness, w the weight per length, m; `None`
    /// without gravity.
    pub gravito_bending_length: Option<f64>,
    /// Period of the lowest bending mode of a straight rod of this kind, clamped at one end, s.
    pub bending_period: f64,
}

/// Numbers of one obstacle.
#[derive(Clone, Debug, Serialize)]
pub struct DerivedObstacle {
    /// Name.
    pub name: String,
    /// Number of triangles; 0 if there are none.
    pub triangles: usize,
    /// Extents along x, y and z, m; those of infinite obstacles are large.
    pub extents: [f64; 3],
}

/// Derives the numbers.
pub fn derived_numbers(prepared: &PreparedRun) -> DerivedNumbers {
    let scene = &prepared.scene;
    let gravity = gravity(scene);
    let rods: Vec<DerivedRod> = scene
        .rods
        .iter()
        .map(|rod| derived_rod(rod, gravity))
        .collect();
    let speed = driven_speed(scene);
    let steps = match (prepared.mode, prepared.integration.step) {
        (Mode::Dynamic { end, .. }, StepSize::Fixed(step)) => Some((end / step).ceil()),
        _ => None,
    };
    let swing = slowest_swing(prepared, &rods);
    let slides = derived_slides(scene);
    DerivedNumbers {
        title: prepared.title.clone(),
        experiment: prepared.experiment.clone(),
        degrees_of_freedom: degrees_of_freedom(scene),
        reynolds_number: reynolds_number(scene, speed),
        advised_step: match prepared.mode {
            Mode::Static | Mode::Continuation(_) => None,
            Mode::Dynamic { .. } => advised_step(scene, &rods, speed),
        },
        scheme: prepared.integration.scheme,
        lost_per_period: swing.map(|swing| swing.lost),
        longer_period: swing.map(|swing| swing.longer),
        steps,
        warnings: (prepared.warnings.iter().cloned())
            .chain(slides.iter().filter_map(DerivedSlide::warning))
            .collect(),
        slides,
        creep: creep(prepared),
        obstacles: scene.obstacles.iter().map(derived_obstacle).collect(),
        flow: prepared.observer::<FlowGuard>().map(FlowGuard::wall),
        own: kind_named(&prepared.experiment).and_then(|kind| kind.derived(prepared)),
        rods,
    }
}

fn derived_rod(rod: &RodDescription, gravity: f64) -> DerivedRod {
    let edges = rod.centreline.len() - usize::from(!rod.closed);
    let length = (0..edges)
        .map(|edge| {
            let next = (edge + 1) % rod.centreline.len();
            (rod.centreline[next] - rod.centreline[edge]).norm()
        })
        .sum::<f64>();
    let bending = rod.stiffness.bending[0].min(rod.stiffness.bending[1]);
    let weight = rod.mass_per_length * gravity;
    // Square of the first root of cos x cosh x = −1: the clamped–free beam.
    let frequency = 3.516 * (bending / rod.mass_per_length).sqrt() / (length * length);
    DerivedRod {
        name: rod.name.clone(),
        nodes: rod.centreline.len(),
        length,
        stretching_stiffness: rod.stiffness.stretching,
        bending_stiffness: rod.stiffness.bending,
        twisting_stiffness: rod.stiffness.twisting,
        gravito_bending_length: (gravity > 0.0).then(|| libm::cbrt(bending / (2.0 * weight))),
        bending_period: TAU / frequency,
    }
}

fn derived_obstacle(obstacle: &Obstacle) -> DerivedObstacle {
    let (vertices, radius) = (&obstacle.body.vertices, obstacle.body.radius);
    let extent = |axis: usize| {
        let places = vertices.iter().map(|vertex| vertex[axis]);
        let (low, high) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), place| {
            (low.min(place), high.max(place))
        });
        high - low + 2.0 * radius
    };
    DerivedObstacle {
        name: obstacle.name.clone(),
        triangles: obstacle.body.faces.len(),
        extents: [0, 1, 2].map(extent),
    }
}

/// Magnitude of the total acceleration of free fall, m/s².
fn gravity(scene: &Scene) -> f64 {
    let total: Vector3 = scene
        .loads
        .iter()
        .filter_map(|load| match load.kind {
            LoadKind::Gravity { acceleration } => Some(acceleration),
            _ => None,
        })
        .sum();
    total.norm()
}

fn degrees_of_freedom(scene: &Scene) -> usize {
    let free: usize = scene
        .rods
        .iter()
        .filter(|rod| !rod.held)
        .map(|rod| 4 * rod.centreline.len() - usize::from(!rod.closed))
        .sum();
    let mut held: Vec<(usize, usize)> = scene
        .clamps
        .iter()
        .filter(|clamp| clamp.holds_position && !scene.rods[clamp.rod].held)
        .map(|clamp| (clamp.rod, clamp.node))
        .collect();
    held.sort_unstable();
    held.dedup();
    let [taken, added] = joint_unknowns(scene);
    (free + added).saturating_sub(3 * held.len() + taken)
}

/// Fraction of the largest friction for which the creep of a contact is derived.
const BORNE: f64 = 0.9;

/// Creep of sticking contacts in a run. By the smoothed law μ tanh(7.5 v/ν), a contact has
/// friction only while it moves.
fn creep(prepared: &PreparedRun) -> Option<Creep> {
    let (scene, Mode::Dynamic { end, .. }) = (&prepared.scene, prepared.mode) else {
        return None;
    };
    let contact = scene
        .contact
        .filter(|contact| !contact.is_complementarity())?;
    let planes = scene.planes.iter();
    let of_planes = planes.map(Plane::own_friction);
    let of_obstacles = scene.obstacles.iter().map(|one| one.friction);
    let friction = of_planes
        .chain(of_obstacles)
        .flatten()
        .chain(scene.own_frictions())
        .fold(contact.friction, f64::max);
    let free = scene.rods.iter().filter(|rod| !rod.held);
    let radius = free.map(RodDescription::least_radius);
    let radius = radius.fold(f64::INFINITY, f64::min);
    if friction <= 0.0 || !radius.is_finite() {
        return None;
    }
    let slip_tolerance = contact.slip_tolerance;
    let speed = slip_tolerance * libm::atanh(BORNE) / 7.5;
    Some(Creep {
        slip_tolerance,
        speed,
        way: speed * end,
        way_in_radii: speed * end / radius,
    })
}

/// Largest speed that clamps would give to any node of their rods if these were rigid, m/s.
fn driven_speed(scene: &Scene) -> f64 {
    let clamp_speed = |clamp: &Clamp| {
        let rod = &scene.rods[clamp.rod];
        let motion = &clamp.motion;
        let node = rod.centreline[clamp.node];
        let pivot = motion.pivot.unwrap_or(node);
        let axis = motion.axis.or_else(|| end_tangent(rod, clamp.node));
        let arm = rod
            .centreline
            .iter()
            .map(|point| match axis {
                Some(axis) => (point - pivot).cross(&axis).norm(),
                None => 0.0,
            })
            .fold(0.0, f64::max);
        let moves = motion
            .translation
            .windows(2)
            .map(|pair| (pair[1].1 - pair[0].1).norm() / (pair[1].0 - pair[0].0));
        moves.fold(0.0, f64::max) + turning(clamp) * arm
    };
    scene.clamps.iter().map(clamp_speed).fold(0.0, f64::max)
}

fn end_tangent(rod: &RodDescription, node: usize) -> Option<Vector3> {
    match node {
        0 => rod.end_tangents[0],
        _ if node + 1 == rod.centreline.len() => rod.end_tangents[1],
        _ => None,
    }
}

/// Largest angular velocity of a clamp, rad/s.
fn turning(clamp: &Clamp) -> f64 {
    let turns = clamp
        .motion
        .angle
        .windows(2)
        .map(|pair| ((pair[1].1 - pair[0].1) / (pair[1].0 - pair[0].0)).abs());
    turns.fold(0.0, f64::max) + clamp.motion.angular_velocity.abs()
}

fn reynolds_number(scene: &Scene, speed: f64) -> Option<f64> {
    let viscosity = match scene.fluid? {
        FluidModel::RegularizedStokeslets { viscosity, .. }
        | FluidModel::Resistive { viscosity } => viscosity,
        FluidModel::Quadratic { .. } => return None,
    };
    let numbers = scene.rods.iter().filter(|rod| !rod.held).map(|rod| {
        let density = rod.mass_per_length / (std::f64::consts::PI * rod.radius * rod.radius);
        density * speed * rod.radius / viscosity
    });
    (speed > 0.0).then(|| numbers.fold(0.0, f64::max))
}

/// A step that resolves the turns of the drives and the lowest bending modes. No driven node moves
/// by more than half a radius in a step.
fn advised_step(scene: &Scene, rods: &[DerivedRod], speed: f64) -> Option<f64> {
    let turning = scene.clamps.iter().map(turning).fold(0.0, f64::max);
    let free = || scene.rods.iter().zip(rods).filter(|(rod, _)| !rod.held);
    let radius = free()
        .map(|(rod, _)| rod.least_radius())
        .fold(f64::INFINITY, f64::min);
    // Viscous fluid damps vibration; then only the drive sets the step.
    let period = match scene.fluid {
        Some(FluidModel::RegularizedStokeslets { .. } | FluidModel::Resistive { .. }) => {
            f64::INFINITY
        }
        None | Some(FluidModel::Quadratic { .. }) => free()
            .map(|(_, rod)| rod.bending_period)
            .fold(f64::INFINITY, f64::min),
    };
    let step = (TAU / turning / STEPS_PER_TURN)
        .min(period / STEPS_PER_PERIOD)
        .min(radius / 2.0 / speed);
    step.is_finite().then_some(step)
}

/// Effect of a time scheme on an oscillation, per period.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Swing {
    /// Fraction of the amplitude that is lost.
    lost: f64,
    /// Relative increase of the period.
    longer: f64,
}

impl Swing {
    /// The effect of a scheme on q̈ + ω² q = 0, with the phase ωh = `turned` (rad) per step h. A
    /// step multiplies q by a complex number, which should have the argument ωh and the modulus 1.
    fn of(scheme: Scheme, turned: f64) -> Self {
        let (modulus, argument) = match scheme {
            // 1/(1 − iωh)
            Scheme::ImplicitEuler => (1.0 / libm::hypot(turned, 1.0), libm::atan(turned)),
            // (1 + iωh/2)/(1 − iωh/2)
            Scheme::ImplicitMidpoint => (1.0, 2.0 * libm::atan(0.5 * turned)),
            Scheme::BackwardDifferences => backward_differences(turned),
        };
        Self {
            lost: 1.0 - libm::pow(modulus, TAU / argument),
            longer: turned / argument - 1.0,
        }
    }
}

/// Modulus and argument of the root near 1 of D₃(w) D₂(w) + ω²h² = 0, where w = 1/z is the shift
/// by one step back. D₃ and D₂ are the differences of third and second order, times the step, for
/// velocities and accelerations.
fn backward_differences(turned: f64) -> (f64, f64) {
    let third = |w: Complex<f64>| 11.0 / 6.0 + w * (-3.0 + w * (1.5 - w / 3.0));
    let second = |w: Complex<f64>| 1.5 + w * (-2.0 + w * 0.5);
    let third_slope = |w: Complex<f64>| -3.0 + w * (3.0 - w);
    let second_slope = |w: Complex<f64>| -2.0 + w;
    // Follows the root from e^{−iωh} for a small step.
    let mut w = Complex::new(1.0, 0.0);
    let stages = 64;
    for stage in 1..=stages {
        let part = turned * f64::from(stage) / f64::from(stages);
        if stage == 1 {
            w = Complex::from_polar(1.0, -part);
        }
        for _ in 0..20 {
            let value = third(w) * second(w) + part * part;
            let slope = third_slope(w) * second(w) + third(w) * second_slope(w);
            w -= value / slope;
        }
    }
    (1.0 / w.norm(), -w.arg())
}

/// Effect of the time scheme on the slowest bending oscillation of the free rods; `None` without fixed steps.
fn slowest_swing(prepared: &PreparedRun, rods: &[DerivedRod]) -> Option<Swing> {
    let (Mode::Dynamic { .. }, StepSize::Fixed(step)) = (prepared.mode, prepared.integration.step)
    else {
        return None;
    };
    let free = rods.iter().zip(&prepared.scene.rods);
    let period = free
        .filter(|(_, rod)| !rod.held)
        .map(|(rod, _)| rod.bending_period)
        .fold(0.0, f64::max);
    (period > 0.0).then(|| Swing::of(prepared.integration.scheme, TAU * step / period))
}

impl DerivedNumbers {
    /// The numbers as JSON.
    pub fn to_json(&self) -> serde_json::Value {
        serde_json::to_value(self).expect("numbers and names are JSON values")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::{load, prepare};
    use std::f64::consts::PI;
    use std::path::Path;

    fn derived(scenario: &str, set: &[&str]) -> DerivedNumbers {
        let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
            .join("scenarios")
            .join(scenario);
        let set: Vec<String> = set.iter().map(|&text| text.to_owned()).collect();
        let loaded = load(&path, &set).unwrap_or_else(|error| panic!("{error}"));
        derived_numbers(&prepare(&loaded.scenario).unwrap())
    }

    #[test]
    fn the_heavy_cantilever_is_as_heavy_as_its_comment_says() {
        let numbers = derived("heavy_cantilever.toml", &[]);
        let length = numbers.rods[0].gravito_bending_length.unwrap();
        // With L = 1 m: w L³/EI = 1/(2 L_gb³).
        let heaviness = 0.5 / length.powi(3);
        assert!((heaviness - 15.696).abs() < 1e-3, "{heaviness}");
        assert_eq!(numbers.degrees_of_freedom, 4 * 51 - 1 - 3);
        assert!(numbers.advised_step.is_none() && numbers.steps.is_none());
    }

    #[test]
    fn equal_rods_at_different_places_share_their_lines() {
        let mut numbers = derived("flagella_m2.toml", &[]);
        let rod = numbers.rods[0].clone();
        // Positions with a limited number of digits, and a rod of another kind among them.
        numbers.rods = (0..20)
            .map(|k| DerivedRod {
                name: format!("link_{k}"),
                length: rod.length * (1.0 + 1e-6 * f64::from(k)),
                nodes: if k == 7 { 3 } else { rod.nodes },
                ..rod.clone()
            })
            .collect();
        let text = numbers.to_string();
        assert_eq!(text.matches("  rod ").count(), 2, "{text}");
        assert!(
            text.contains("link_0, link_1, link_2, link_3 and 15 more"),
            "{text}"
        );
        numbers.rods[7].nodes = rod.nodes;
        assert!(numbers.to_string().contains("link_0 to link_19"));
    }

    #[test]
    fn flagella_move_as_fast_as_their_helices_turn() {
        let numbers = derived("flagella_m2.toml", &["time.end=1.0"]);
        // ρ ω a h/η = 1000 · 15 · 0.01 · 0.001/0.1.
        assert!((numbers.reynolds_number.unwrap() - 1.5).abs() < 1e-9);
        assert_eq!(numbers.degrees_of_freedom, 2 * (4 * 68 - 1 - 3));
        assert_eq!(numbers.steps, Some(1000.0));
        let step = numbers.advised_step.unwrap();
        assert!((step - TAU / 15.0 / 400.0).abs() < 1e-12, "{step}");
        let slow = derived("flagella_m2.toml", &["flagella.angular_velocity=1.5"]);
        assert!((slow.advised_step.unwrap() / step - 10.0).abs() < 1e-9);
    }

    #[test]
    fn every_scheme_reports_its_error_for_the_slowest_mode() {
        // With steps of a fiftieth of the period, compare with the leading terms of the errors.
        let turned = TAU / 50.0;
        let errors = [
            (Scheme::ImplicitEuler, PI * turned, turned * turned / 3.0),
            (Scheme::ImplicitMidpoint, 0.0, turned * turned / 12.0),
            (Scheme::BackwardDifferences, 0.0, turned * turned / 6.0),
        ];
        for (scheme, lost, longer) in errors {
            let swing = Swing::of(scheme, turned);
            assert!(
                (swing.longer / longer - 1.0).abs() < 0.02,
                "{scheme:?} {swing:?}"
            );
            if lost == 0.0 {
                assert!(swing.lost.abs() < 1e-4, "{scheme:?} {swing:?}");
            } else {
                let expected = 1.0 - f64::exp(-lost);
                assert!((swing.lost / expected - 1.0).abs() < 0.02, "{swing:?}");
            }
        }
        // Backward differences damp unresolved modes.
        assert!(Swing::of(Scheme::BackwardDifferences, 1.5).lost > 0.25);
        let numbers = derived("elastic_pendulum.toml", &[]).to_string();
        assert!(numbers.contains("slowest mode              "), "{numbers}");
    }

    #[test]
    fn the_lowest_mode_of_a_cantilever_is_that_of_euler_and_bernoulli() {
        let rod = &derived("elastic_pendulum.toml", &[]).rods[0];
        let mass_per_length = 1100.0 * std::f64::consts::PI * 0.004f64.powi(2);
        let root: f64 = 1.875_104_068_711_961;
        let frequency = (root / 0.6).powi(2) * (rod.bending_stiffness[0] / mass_per_length).sqrt();
        assert!((rod.bending_period * frequency / TAU - 1.0).abs() < 1e-4);
    }
}
