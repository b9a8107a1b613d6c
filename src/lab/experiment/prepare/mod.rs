//! Turns a validated scenario into a scene that is ready to run.

mod catenary;
mod coil;
pub mod curve;
mod estimate;
mod flow;
mod gripper_motion;
mod jitter;
mod joint;
mod moved_clamps;
mod natural_strains;
mod obstacle;
mod place;
mod round_rod;
mod sections;
mod settings;
mod slack;
#[cfg(test)]
mod tests;
mod warnings;

use super::flow_guard::FlowGuard;
use super::{KINDS, kind_named, parts, probes};
use crate::run::{
    LinkingGuard, Mode, Observer, OutputPlan, PreparedRun, RunError, rod_records, start_from,
};
use crate::scenario::{self, Begin, Continuation, Issue, Issues, KeyPath, Scenario, Time};
use joint::{judge_joints, place_body, place_joint};
use obstacle::place_obstacle;
use place::{place_clamp, place_load, place_plane, place_rod, same_node};
use rodlab_engine::mechanics::dynamics::Simulation;
use rodlab_engine::mechanics::scene as mechanics;
use rodlab_engine::mechanics::statics::{PathMethod, PathPlan};
use rodlab_files::results::read_end_state;
use settings::{
    background_flow, contact_parameters, fluid_model, integration_parameters, resists_spin,
};

pub use jitter::Jitter;
pub use obstacle::place_obstacles;
pub use round_rod::round_rod;

/// Builds the mechanics of a scenario.
///
/// # Errors
/// Faults that are detected only when the rods are placed: edges of zero length, names of rods
/// that do not exist, nodes beyond the end of their rod. Each fault names its key.
pub fn prepare(scenario: &Scenario) -> Result<PreparedRun, Issues> {
    let mut scene = mechanics::Scene::default();
    let mut issues = Issues::default();
    let kind = kind_named(scenario.experiment.name()).expect("a scenario is of one of the kinds");
    if let Err(issue) = kind.build(scenario, &mut scene) {
        issues.push(issue);
    }
    let rods = place_all("rods", &scenario.rods, &mut issues, place_rod);
    scene.rods.extend(rods);
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
    for (index, joint) in scenario.joints.iter().enumerate() {
        let path = KeyPath::from("joints").index(index);
        if let Err(issue) = place_joint(joint, &mut scene, &path) {
            issues.push(issue);
        }
    }
    let rods = &scene.rods;
    let bodies = place_all("bodies", &scenario.bodies, &mut issues, |body, path| {
        place_body(body, rods, path)
    });
    scene.bodies.extend(bodies);
    if issues.0.is_empty()
        && let Err(issue) = judge_joints(&scene, scenario)
    {
        issues.push(issue);
        return Err(issues);
    }
    let rods = &scene.rods;
    scene.planes.extend(scenario.planes.iter().map(place_plane));
    let obstacles = place_all(
        "obstacles",
        &scenario.obstacles,
        &mut issues,
        |one, path| place_obstacle(one, rods, path),
    );
    parts::place(scenario, &mut scene, &mut issues);
    let loads = place_all("loads", &scenario.loads, &mut issues, |load, path| {
        place_load(load, &scene, path)
    });
    scene.loads.extend(loads);
    scene.obstacles.extend(obstacles);
    if scene.obstacles.len() < scenario.obstacles.len() {
        // Later steps may look these obstacles up.
        return Err(issues);
    }
    scene.contact = contact_parameters(&scenario.contact);
    scene.fluid = fluid_model(&scenario.fluid);
    scene.flow = background_flow(&scenario.fluid);
    scene.spin_drag = resists_spin(&scenario.fluid);
    match flow::wall(&scene, scenario) {
        Ok(wall) => scene.wall = wall,
        Err(issue) => issues.push(issue),
    }
    if let Err(issue) = parts::judge_free_bodies(&scene) {
        issues.push(issue);
        return Err(issues);
    }
    if issues.0.is_empty()
        && !scene.sheaths.is_empty()
        && let Err(issue) = parts::judge_sheaths(&scene)
    {
        issues.push(issue);
        return Err(issues);
    }
    if let Err((rod, message)) = estimate::refuse_countless_pairs(&scene) {
        // Rods built by the kind come first; [rod] sets their number of nodes.
        let built = scene.rods.len() - scenario.rods.len();
        issues.push(Issue::new(
            match rod.checked_sub(built) {
                Some(rod) => KeyPath::from("rods").index(rod).key("edges"),
                None => KeyPath::from("rod.nodes"),
            },
            message,
        ));
        // Later steps may search for these pairs themselves.
        return Err(issues);
    }
    let mut prepared = PreparedRun {
        name: scenario.name.clone(),
        experiment: scenario.experiment.name().to_owned(),
        title: scenario.title.clone(),
        scenario_toml: scenario.to_toml(),
        scene,
        mode: match (scenario.time, scenario.continuation) {
            (Time::Dynamic { end, begin, .. }, _) => Mode::Dynamic {
                end,
                settles: begin == Begin::Equilibrium,
            },
            (_, Some(path)) => Mode::Continuation(path_plan(&path)),
            _ => Mode::Static,
        },
        integration: integration_parameters(scenario),
        output: OutputPlan {
            // A static run writes once and does not use the interval.
            interval: scenario.output.interval.unwrap_or(0.0),
            nodes: scenario.output.nodes,
            forces: scenario.output.forces,
            contacts: scenario.output.contacts,
            vtk: scenario.output.vtk,
        },
        observers: Vec::new(),
        warnings: Vec::new(),
        controllers: Vec::new(),
        own_files: names_of_own_files(),
        table: None,
        start: None,
    };
    if let Some(start) = &scenario.start
        && let Err(message) = begin_at(&mut prepared, start)
    {
        issues.push(Issue::new(KeyPath::from("start").key("from"), message));
    }
    if issues.0.is_empty()
        && let Err(issue) = moved_clamps::carry(&mut prepared, scenario)
    {
        issues.push(issue);
    }
    if let Err(issue) = kind.attach(scenario, &mut prepared) {
        issues.push(issue);
    }
    if prepared.table.is_some() && prepared.start.is_some() {
        let message = "this experiment places its own rods repeatedly; leave the table out";
        issues.push(Issue::new(KeyPath::from("start"), message));
    }
    if prepared.table.is_none() {
        let guard = LinkingGuard::of(&prepared.scene);
        (prepared.observers).extend(guard.map(|guard| Box::new(guard) as Box<dyn Observer>));
        let flow = FlowGuard::of(&prepared.scene);
        (prepared.observers).extend(flow.map(|guard| Box::new(guard) as Box<dyn Observer>));
    }
    if prepared.table.is_none() {
        let has_controllers = !prepared.controllers.is_empty();
        prepared.warnings = warnings::warnings(scenario, &prepared.scene, has_controllers);
        (prepared.warnings).extend(flow::left_out(&prepared.scene, scenario));
    }
    if let Err(found) = probes::add(&mut prepared, scenario) {
        found.0.into_iter().for_each(|issue| issues.push(issue));
    }
    issues.or_ok(prepared)
}

/// Converts the list `table` of the scenario; reports entries that cannot be placed.
fn place_all<T, P>(
    table: &str,
    listed: &[T],
    issues: &mut Issues,
    place: impl Fn(&T, &KeyPath) -> Result<P, Issue>,
) -> Vec<P> {
    let path = KeyPath::from(table);
    let mut placed = Vec::new();
    for (index, one) in listed.iter().enumerate() {
        match place(one, &path.index(index)) {
            Ok(one) => placed.push(one),
            Err(issue) => issues.push(issue),
        }
    }
    placed
}

/// Names of the files that kinds of experiments write in addition to those of every run. A run of
/// one kind may replace the results of another.
fn names_of_own_files() -> Vec<&'static str> {
    let of_kinds = KINDS.iter().flat_map(|kind| kind.files());
    of_kinds.flat_map(|file| file.names).copied().collect()
}

/// Largest distance of joined nodes in a state, in edges.
const LARGEST_JOINT_GAP: f64 = 1e-3;

/// Starts the scene from the end of another run.
///
/// # Errors
/// A state of other rods.
fn begin_at(prepared: &mut PreparedRun, start: &scenario::Start) -> Result<(), String> {
    let rows = read_end_state(&start.contents)?;
    let mut state = start_from(&rows, &rod_records(prepared))?;
    refuse_broken_joints(&prepared.scene, &state)?;
    if !start.velocities {
        state.velocities.clear();
        state.spins.clear();
        state.turning.clear();
    }
    prepared.scene.start = Some(state);
    prepared.start = Some(start.contents.clone());
    Ok(())
}

/// Checks that nodes that are joined in the scene coincide in the state.
///
/// # Errors
/// The joint whose nodes are apart.
fn refuse_broken_joints(scene: &mechanics::Scene, state: &mechanics::Start) -> Result<(), String> {
    let first_node = |rod: usize| -> usize {
        let before = scene.rods[..rod].iter();
        before.map(|rod| rod.centreline.len()).sum()
    };
    for joint in scene.joints.iter().filter(|joint| !joint.kind.slides()) {
        let [one, other] = joint
            .nodes
            .map(|at| state.positions[first_node(at.rod) + at.node]);
        let centreline = &scene.rods[joint.nodes[0].rod].centreline;
        let edge = (centreline[1] - centreline[0]).norm();
        let distance = (one - other).norm();
        if distance > LARGEST_JOINT_GAP * edge {
            return Err(format!(
                "the nodes of joint `{}` are {distance:.2e} m apart at the end of that run: \
                 was it broken there, or not a joint?",
                joint.name
            ));
        }
    }
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

/// Does everything that a run does before its first step, except for its files. This detects rods
/// that start inside each other, contradicting clamps, paths that cannot begin, and controllers
/// that cannot act.
///
/// # Errors
/// [`RunError::Scene`] names what is impossible.
pub fn try_scene(prepared: &PreparedRun) -> Result<Vec<String>, RunError> {
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
    .map_err(RunError::Scene)?;
    Ok(simulation.remarks())
}
