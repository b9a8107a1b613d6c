//! From a validated scenario to a scene that is ready to run.

pub(crate) mod curve;
mod estimate;
mod gripper_motion;
mod round_rod;

use super::{kind_named, probes};
use crate::mechanics::Vector3;
use crate::mechanics::contact::{ContactModel, ContactParameters};
use crate::mechanics::dynamics::{self, IntegrationParameters, Simulation, StepSize};
use crate::mechanics::fluid::FluidModel;
use crate::mechanics::scene as mechanics;
use crate::mechanics::statics::{PathMethod, PathPlan};
use crate::results::read_end_state;
use crate::run::RunError;
use crate::run::{LinkingGuard, Mode, Observer, OutputPlan, PreparedRun, rod_records, start_from};
use crate::scenario::{
    self, Clamp, Contact, Continuation, Fluid, Hold, Issue, Issues, KeyPath, Load, LoadKind,
    NaturalShape, Place, Plane, Rod, Scenario, Scheme, Step, Time, did_you_mean,
};
use curve::{SampledCurve, sample};
use gripper_motion::gripper_motion;

pub use round_rod::round_rod;

/// Builds the mechanics of a scenario.
///
/// # Errors
/// Faults that show only when the rods are placed: edges of no length, names of rods that do not exist,
/// nodes beyond the end of their rod. Each names its key.
pub fn prepare(scenario: &Scenario) -> Result<PreparedRun, Issues> {
    let mut scene = mechanics::Scene::default();
    let mut issues = Issues::default();
    let kind = kind_named(scenario.experiment.name()).expect("a scenario is of one of the kinds");
    if let Err(issue) = kind.build(scenario, &mut scene) {
        issues.push(issue);
    }
    for (index, rod) in scenario.rods.iter().enumerate() {
        match place_rod(rod, &KeyPath::from("rods").index(index)) {
            Ok(description) => scene.rods.push(description),
            Err(issue) => issues.push(issue),
        }
    }
    if !issues.0.is_empty() {
        return Err(issues);
    }
    for (index, clamp) in scenario.clamps.iter().enumerate() {
        let path = KeyPath::from("clamps").index(index);
        match place_clamp(clamp, &scene.rods, &path) {
            Ok(clamp) if scene.clamps.iter().any(|other| same_node(other, &clamp)) => {
                let message = "another clamp holds this node already";
                issues.push(Issue::new(path.key("at"), message));
            }
            Ok(clamp) => scene.clamps.push(clamp),
            Err(issue) => issues.push(issue),
        }
    }
    for (index, load) in scenario.loads.iter().enumerate() {
        match place_load(load, &scene.rods, &KeyPath::from("loads").index(index)) {
            Ok(load) => scene.loads.push(load),
            Err(issue) => issues.push(issue),
        }
    }
    scene.planes.extend(scenario.planes.iter().map(place_plane));
    scene.contact = contact_parameters(&scenario.contact);
    scene.fluid = fluid_model(&scenario.fluid);
    if let Err((rod, message)) = estimate::refuse_countless_pairs(&scene) {
        // Rods of the kind come first; their nodes are counted in [rod].
        let built = scene.rods.len() - scenario.rods.len();
        issues.push(Issue::new(
            match rod.checked_sub(built) {
                Some(rod) => KeyPath::from("rods").index(rod).key("edges"),
                None => KeyPath::from("rod.nodes"),
            },
            message,
        ));
    }
    let mut prepared = PreparedRun {
        name: scenario.name.clone(),
        experiment: scenario.experiment.name().to_owned(),
        title: scenario.title.clone(),
        scenario_toml: scenario.to_toml(),
        scene,
        mode: match (scenario.time, scenario.continuation) {
            (Time::Dynamic { end, .. }, _) => Mode::Dynamic { end },
            (_, Some(path)) => Mode::Continuation(path_plan(&path)),
            _ => Mode::Static,
        },
        integration: integration_parameters(scenario),
        output: OutputPlan {
            // A static run writes once and never asks.
            interval: scenario.output.interval.unwrap_or(0.0),
            nodes: scenario.output.nodes,
            forces: scenario.output.forces,
            vtk: scenario.output.vtk,
        },
        observers: Vec::new(),
        controllers: Vec::new(),
        table: None,
        start: None,
    };
    if let Some(start) = &scenario.start
        && let Err(message) = begin_at(&mut prepared, start)
    {
        issues.push(Issue::new(KeyPath::from("start").key("from"), message));
    }
    if let Err(issue) = kind.attach(scenario, &mut prepared) {
        issues.push(issue);
    }
    if prepared.table.is_some() && prepared.start.is_some() {
        let message =
            "this experiment places its rods itself, again and again; leave the table out";
        issues.push(Issue::new(KeyPath::from("start"), message));
    }
    if prepared.table.is_none() {
        let guard = LinkingGuard::of(&prepared.scene);
        (prepared.observers).extend(guard.map(|guard| Box::new(guard) as Box<dyn Observer>));
    }
    if let Err(found) = probes::add(&mut prepared, scenario) {
        found.0.into_iter().for_each(|issue| issues.push(issue));
    }
    issues.or_ok(prepared)
}

/// Lets the scene start from the end of another run.
///
/// # Errors
/// Why that does not fit.
fn begin_at(prepared: &mut PreparedRun, start: &scenario::Start) -> Result<(), String> {
    let rows = read_end_state(&start.contents)?;
    let mut state = start_from(&rows, &rod_records(prepared))?;
    if !start.velocities {
        state.velocities.clear();
        state.spins.clear();
    }
    prepared.scene.start = Some(state);
    prepared.start = Some(start.contents.clone());
    Ok(())
}

fn path_plan(path: &Continuation) -> PathPlan {
    PathPlan {
        from: path.from,
        to: path.to,
        step: path.step,
        largest_step: path.largest_step,
        method: match path.method {
            scenario::PathMethod::Natural => PathMethod::Natural,
            scenario::PathMethod::Arclength => PathMethod::Arclength,
        },
        switch_branches: path.switch_branches,
        most_points: path.most_points,
    }
}

/// Does all that a run does before its first step, but for its files: finds rods that start inside each other,
/// contradicting clamps, paths that cannot begin, and controllers that cannot act.
///
/// # Errors
/// [`RunError::Scene`] says what is impossible.
pub fn try_scene(prepared: &PreparedRun) -> Result<(), RunError> {
    let simulation = Simulation::new(&prepared.scene, &prepared.integration);
    let mut simulation = simulation.map_err(RunError::Scene)?;
    match prepared.mode {
        _ if prepared.table.is_some() => Ok(()),
        Mode::Static => Ok(()),
        Mode::Continuation(plan) => simulation.path(plan).map(drop),
        Mode::Dynamic { .. } => {
            let mut controllers = prepared.controllers.clone();
            let mut controllers = controllers.iter_mut();
            controllers.try_for_each(|controller| controller.act(&mut simulation))
        }
    }
    .map_err(RunError::Scene)
}

fn place_rod(rod: &Rod, path: &KeyPath) -> Result<mechanics::RodDescription, Issue> {
    let SampledCurve {
        nodes: centreline,
        end_tangents,
    } = sample(&rod.shape, rod.edges, rod.closed);
    refuse_short_edges(&centreline, rod.closed, &path.key("shape"))?;
    let natural_shape = match &rod.natural_shape {
        NaturalShape::AsPlaced => mechanics::NaturalShape::AsPlaced,
        NaturalShape::Straight => mechanics::NaturalShape::Straight,
        NaturalShape::Curved { curvature, twist } => mechanics::NaturalShape::Curved {
            curvature: *curvature,
            twist: *twist,
        },
        NaturalShape::Curve(shape) => {
            let nodes = sample(shape, rod.edges, rod.closed).nodes;
            refuse_short_edges(&nodes, rod.closed, &path.key("natural_shape"))?;
            mechanics::NaturalShape::Centreline(nodes)
        }
    };
    let area = rod.cross_section.area(rod.radius);
    let [second_moment_1, second_moment_2] = rod.cross_section.second_moments(rod.radius);
    let density = rod.material.density;
    Ok(mechanics::RodDescription {
        name: rod.name.clone(),
        centreline,
        closed: rod.closed,
        end_tangents,
        first_director: rod.director.map(Vector3::from),
        twist: rod.twist,
        natural_shape,
        stiffness: mechanics::Stiffness {
            stretching: rod.stiffness.stretching,
            bending: [rod.stiffness.bending_1, rod.stiffness.bending_2],
            twisting: rod.stiffness.twisting,
        },
        radius: rod.radius,
        mass_per_length: density * area,
        rotational_inertia_per_length: density * (second_moment_1 + second_moment_2),
        velocity: Vector3::from(rod.velocity),
        angular_velocity: Vector3::from(rod.angular_velocity),
        held: rod.held,
    })
}

/// Edges shorter than this fraction of the mean edge are no edges: their direction is lost in round-off.
const SHORTEST_EDGE: f64 = 1e-6;

fn refuse_short_edges(nodes: &[Vector3], closed: bool, path: &KeyPath) -> Result<(), Issue> {
    let edges = if closed { nodes.len() } else { nodes.len() - 1 };
    let length = |edge: usize| (nodes[(edge + 1) % nodes.len()] - nodes[edge]).norm();
    let mean = (0..edges).map(length).sum::<f64>() / edges as f64;
    if !mean.is_finite() {
        let message = "the coordinates are too large, or too close together, to measure the edges";
        return Err(Issue::new(path.clone(), message));
    }
    match (0..edges).find(|&edge| length(edge) <= SHORTEST_EDGE * mean) {
        None => Ok(()),
        Some(edge) => Err(Issue::new(
            path.clone(),
            format!(
                "edge {edge} has no length: nodes {edge} and {} lie in the same place",
                (edge + 1) % nodes.len()
            ),
        )),
    }
}

fn place_clamp(
    clamp: &Clamp,
    rods: &[mechanics::RodDescription],
    path: &KeyPath,
) -> Result<mechanics::Clamp, Issue> {
    let rod = find_rod(&clamp.rod, rods, path)?;
    Ok(mechanics::Clamp {
        rod,
        node: find_node(clamp.at, &rods[rod], path)?,
        holds_position: matches!(clamp.hold, Hold::Position | Hold::Both),
        holds_frame: matches!(clamp.hold, Hold::Frame | Hold::Both),
        motion: if clamp.poses.is_empty() {
            mechanics::Motion {
                translation: clamp
                    .translation
                    .iter()
                    .map(|&(time, displacement)| (time, Vector3::from(displacement)))
                    .collect(),
                axis: clamp.axis.map(Vector3::from),
                angle: clamp.angle.clone(),
                angular_velocity: clamp.angular_velocity,
                pivot: clamp.pivot.map(Vector3::from),
                ..mechanics::Motion::default()
            }
        } else {
            gripper_motion(&clamp.poses)
        },
    })
}

fn same_node(one: &mechanics::Clamp, other: &mechanics::Clamp) -> bool {
    (one.rod, one.node) == (other.rod, other.node)
}

fn place_load(
    load: &Load,
    rods: &[mechanics::RodDescription],
    path: &KeyPath,
) -> Result<mechanics::Load, Issue> {
    let find_any = |name: &Option<String>| {
        name.as_ref()
            .map(|name| find_rod(name, rods, path))
            .transpose()
    };
    let kind = match &load.kind {
        LoadKind::Gravity { acceleration } => mechanics::LoadKind::Gravity {
            acceleration: Vector3::from(*acceleration),
        },
        LoadKind::Force { rod, at, force } => {
            let rod = find_rod(rod, rods, path)?;
            mechanics::LoadKind::Force {
                rod,
                node: find_node(*at, &rods[rod], path)?,
                force: Vector3::from(*force),
            }
        }
        LoadKind::Moment { rod, at, moment } => {
            let rod = find_rod(rod, rods, path)?;
            mechanics::LoadKind::Moment {
                rod,
                edge: find_edge(*at, &rods[rod], path)?,
                moment: Vector3::from(*moment),
            }
        }
        LoadKind::Distributed {
            rod,
            force_per_length,
        } => mechanics::LoadKind::Distributed {
            rod: find_any(rod)?,
            force_per_length: Vector3::from(*force_per_length),
        },
        LoadKind::Drag {
            rod,
            translation,
            rotation,
        } => mechanics::LoadKind::Drag {
            rod: find_any(rod)?,
            translation: *translation,
            rotation: *rotation,
        },
    };
    Ok(mechanics::Load {
        kind,
        schedule: load.schedule.clone(),
    })
}

fn find_rod(
    name: &str,
    rods: &[mechanics::RodDescription],
    path: &KeyPath,
) -> Result<usize, Issue> {
    rods.iter().position(|rod| rod.name == name).ok_or_else(|| {
        let names: Vec<&str> = rods.iter().map(|rod| rod.name.as_str()).collect();
        let help = did_you_mean(name, names.iter().copied())
            .unwrap_or_else(|| format!("the rods are: {}", names.join(", ")));
        Issue::new(path.key("rod"), format!("no rod is called `{name}`")).with_help(help)
    })
}

fn find_node(
    place: Place,
    rod: &mechanics::RodDescription,
    path: &KeyPath,
) -> Result<usize, Issue> {
    find_place(place, rod.centreline.len(), "node", rod, path)
}

fn find_edge(
    place: Place,
    rod: &mechanics::RodDescription,
    path: &KeyPath,
) -> Result<usize, Issue> {
    let edges = rod.centreline.len() - usize::from(!rod.closed);
    find_place(place, edges, "edge", rod, path)
}

fn find_place(
    place: Place,
    count: usize,
    what: &str,
    rod: &mechanics::RodDescription,
    path: &KeyPath,
) -> Result<usize, Issue> {
    match place {
        Place::Start => Ok(0),
        Place::End => Ok(count - 1),
        Place::Number(number) if number < count => Ok(number),
        Place::Number(number) => Err(Issue::new(
            path.key("at"),
            format!(
                "rod `{}` has no {what} {number}; allowed: 0 to {}, \"start\" or \"end\"",
                rod.name,
                count - 1
            ),
        )),
    }
}

fn place_plane(plane: &Plane) -> mechanics::Plane {
    mechanics::Plane {
        point: Vector3::from(plane.point),
        normal: Vector3::from(plane.normal),
        friction: plane.friction,
    }
}

fn contact_parameters(contact: &Contact) -> Option<ContactParameters> {
    match *contact {
        Contact::None => None,
        Contact::Imc {
            friction,
            distance_tolerance,
            slip_tolerance,
            stiffness_factor,
            maximum_penetration,
        } => Some(ContactParameters {
            model: ContactModel::ImplicitContact,
            distance_tolerance,
            friction,
            slip_tolerance,
            stiffness_factor,
            maximum_penetration,
        }),
        Contact::Ipc {
            friction,
            distance_tolerance,
            slip_tolerance,
            stiffness_factor,
        } => Some(ContactParameters {
            model: ContactModel::IncrementalPotential,
            distance_tolerance,
            friction,
            slip_tolerance,
            stiffness_factor,
            maximum_penetration: 0.0,
        }),
        Contact::Complementarity {
            friction,
            distance_tolerance,
            maximum_penetration,
        } => Some(ContactParameters {
            model: ContactModel::Complementarity,
            distance_tolerance,
            friction,
            maximum_penetration,
            ..ContactParameters::default()
        }),
    }
}

fn fluid_model(fluid: &Fluid) -> Option<FluidModel> {
    match *fluid {
        Fluid::None => None,
        Fluid::Rss {
            viscosity,
            regularization,
            far_field_error,
        } => Some(FluidModel::RegularizedStokeslets {
            viscosity,
            regularization,
            far_field_error,
        }),
        Fluid::Resistive { viscosity } => Some(FluidModel::Resistive { viscosity }),
    }
}

fn integration_parameters(scenario: &Scenario) -> IntegrationParameters {
    let defaults = IntegrationParameters::default();
    let (scheme, step) = match scenario.time {
        Time::Static | Time::Continuation => (defaults.scheme, defaults.step),
        Time::Dynamic { scheme, step, .. } => (
            match scheme {
                Scheme::ImplicitEuler => dynamics::Scheme::ImplicitEuler,
                Scheme::ImplicitMidpoint => dynamics::Scheme::ImplicitMidpoint,
                Scheme::BackwardDifferences => dynamics::Scheme::BackwardDifferences,
            },
            match step {
                Step::Fixed(step) => StepSize::Fixed(step),
                Step::Auto { tolerance, maximum } => StepSize::Auto { tolerance, maximum },
            },
        ),
    };
    IntegrationParameters {
        scheme,
        step,
        force_tolerance: scenario.solver.force_tolerance,
        displacement_tolerance: scenario.solver.displacement_tolerance,
        maximum_iterations: scenario.solver.maximum_iterations,
        minimum_step: scenario.solver.minimum_step,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::{case_set, from_text};
    use crate::scenario::Loaded;
    use crate::sweep::check_every_value;
    use std::path::Path;

    const TWO_RODS: &str = r#"
experiment = "scene"
material = { youngs_modulus = 1e6, poissons_ratio = 0.5, density = 1000.0 }
time = { end = 1.0 }
[[rods]]
name = "beam"
radius = 0.01
edges = 10
shape = { kind = "straight", start = [0, 0, 0], end = [1, 0, 0] }
[[rods]]
name = "ring"
radius = 0.01
edges = 12
shape = { kind = "ring", centre = [0, 0, 3], radius = 1 }
[[clamps]]
rod = "beam"
at = 10
[[loads]]
kind = "moment"
rod = "beam"
at = "end"
moment = [1, 0, 0]
"#;

    fn loaded(text: &str) -> Loaded {
        from_text("two", text, Path::new(""), &[]).unwrap_or_else(|error| panic!("{error}"))
    }

    fn fault(from: &str, to: &str) -> String {
        assert!(TWO_RODS.contains(from));
        let loaded = loaded(&TWO_RODS.replacen(from, to, 1));
        let issues = prepare(&loaded.scenario).unwrap_err();
        loaded.locate(issues).to_string()
    }

    #[test]
    fn names_and_numbers_become_indices() {
        let run = prepare(&loaded(TWO_RODS).scenario).unwrap();
        assert_eq!(run.name, "two");
        assert_eq!(run.mode, Mode::Dynamic { end: 1.0 });
        assert_eq!(run.scene.rods[0].centreline.len(), 11);
        assert_eq!(run.scene.rods[1].centreline.len(), 12);
        assert_eq!((run.scene.clamps[0].rod, run.scene.clamps[0].node), (0, 10));
        let mechanics::LoadKind::Moment { edge, .. } = run.scene.loads[0].kind else {
            panic!("{:?}", run.scene.loads[0]);
        };
        assert_eq!(edge, 9);
        let area = std::f64::consts::PI * 1e-4;
        assert!((run.scene.rods[0].mass_per_length / (1000.0 * area) - 1.0).abs() < 1e-15);
        let inertia = 1000.0 * std::f64::consts::PI * 1e-8 / 2.0;
        let got = run.scene.rods[0].rotational_inertia_per_length;
        assert!((got / inertia - 1.0).abs() < 1e-15);
    }

    #[test]
    fn faults_of_the_scene_point_at_their_keys() {
        insta::assert_snapshot!(fault("rod = \"beam\"", "rod = \"beem\""), @"two.toml:16:7: `clamps.0.rod`: no rod is called `beem` (did you mean `beam`?)");
        insta::assert_snapshot!(fault("rod = \"beam\"", "rod = \"x\""), @"two.toml:16:7: `clamps.0.rod`: no rod is called `x` (the rods are: beam, ring)");
        insta::assert_snapshot!(fault("at = 10", "at = 11"), @r#"two.toml:17:6: `clamps.0.at`: rod `beam` has no node 11; allowed: 0 to 10, "start" or "end""#);
        insta::assert_snapshot!(fault("at = \"end\"", "at = 10"), @r#"two.toml:21:6: `loads.0.at`: rod `beam` has no edge 10; allowed: 0 to 9, "start" or "end""#);
        let twice = "[[clamps]]\nrod = \"beam\"\nat = \"end\"\n[[loads]]";
        insta::assert_snapshot!(fault("[[loads]]", twice), @"two.toml:20:6: `clamps.1.at`: another clamp holds this node already");
        let closed = "shape = { kind = \"points\", points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0]] }\nclosed = true";
        let straight =
            "edges = 10\nshape = { kind = \"straight\", start = [0, 0, 0], end = [1, 0, 0] }";
        insta::assert_snapshot!(fault(straight, closed), @"two.toml:8:9: `rods.0.shape`: edge 3 has no length: nodes 3 and 0 lie in the same place");
    }

    #[test]
    fn a_hundred_thousand_edges_within_a_few_diameters_are_refused_before_they_take_memory() {
        let text = TWO_RODS
            .replacen("edges = 10\n", "edges = 100000\n", 1)
            .replacen("at = 10", "at = 0", 1);
        let refused = loaded(&format!("{text}\n[contact]\n"));
        let error = refused
            .locate(prepare(&refused.scenario).unwrap_err())
            .to_string();
        assert!(error.starts_with("two.toml:8:9: `rods.0.edges`"), "{error}");
        assert!(
            error.contains("2.0e8 pairs of edges to look at, which take 16.0 GB"),
            "{error}"
        );
        // Without contact the edges are only long.
        assert!(prepare(&loaded(&text).scenario).is_ok());
    }

    #[test]
    fn the_defaults_of_scenarios_are_those_of_the_engine() {
        let text = format!("{TWO_RODS}\n[contact]\ndistance_tolerance = 1e-5\n");
        let run = prepare(&loaded(&text).scenario).unwrap();
        assert_eq!(run.integration, IntegrationParameters::default());
        assert_eq!(run.scene.contact, Some(ContactParameters::default()));
    }

    #[test]
    fn all_scenarios_of_the_repository_prepare() {
        let directory = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios"));
        let mut names = Vec::new();
        for entry in std::fs::read_dir(directory).unwrap() {
            let path = entry.unwrap().path();
            // Curves, points and robot cells lie beside the scenarios.
            if path.is_dir() || path.extension().is_some_and(|ending| ending == "csv") {
                continue;
            }
            let case_set = case_set(&path, &[], &[]).unwrap_or_else(|error| panic!("{error}"));
            check_every_value(&case_set).unwrap_or_else(|error| panic!("{error}"));
            if case_set.search().is_some() {
                continue;
            }
            let loaded = case_set.scenario_of(0).unwrap();
            let run = prepare(&loaded.scenario).unwrap_or_else(|error| panic!("{error}"));
            let again = from_text(&run.name, &run.scenario_toml, Path::new(""), &[]).unwrap();
            assert_eq!(again.scenario, loaded.scenario, "{}", path.display());
            names.push(run.name);
        }
        for name in [
            "flagella_m2",
            "flagella_m3",
            "flagella_m5",
            "flagella_m10",
            "flagella_quick",
        ] {
            assert!(names.iter().any(|found| found == name), "{name}");
        }
    }
}
