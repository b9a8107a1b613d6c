//! What a model does not contain.

use super::surroundings::is_carried_over;
use crate::run::{Mode, PreparedRun};
use rodlab_engine::mechanics::scene::{LoadKind, RodDescription};

/// Phrases that depend on the simulator.
pub(super) struct Phrases {
    /// What always differs.
    pub always: Vec<String>,
    /// Contact.
    pub contact: &'static str,
    /// How forces are applied.
    pub forces: &'static str,
    /// How the model comes to rest.
    pub rest: String,
    /// What else differs.
    pub more: Vec<String>,
}

/// What the model of a scenario does not contain, or replaces, a phrase each.
pub(super) fn left_out(prepared: &PreparedRun, phrases: Phrases) -> Vec<String> {
    let scene = &prepared.scene;
    let mut lines = phrases.always;
    let mut add = |is_there: bool, line: &str| {
        if is_there {
            lines.push(line.to_owned());
        }
    };
    add(scene.contact.is_some(), phrases.contact);
    let is = |test: fn(&LoadKind) -> bool| scene.loads.iter().any(|load| test(&load.kind));
    add(
        is(|kind| {
            matches!(
                kind,
                LoadKind::Force { .. } | LoadKind::FollowerForce { .. }
            )
        }),
        phrases.forces,
    );
    add(
        is(|kind| {
            matches!(
                kind,
                LoadKind::Moment { .. } | LoadKind::FollowerMoment { .. }
            )
        }),
        "loads: moments",
    );
    add(
        is(|kind| {
            let distributed = matches!(kind, LoadKind::Distributed { .. });
            distributed || matches!(kind, LoadKind::FollowerDistributed { .. })
        }),
        "loads: forces per length",
    );
    add(
        is(|kind| matches!(kind, LoadKind::Drag { .. })),
        "loads: drag",
    );
    add(
        scene
            .loads
            .iter()
            .any(|load| !load.schedule.is_empty() && matches!(load.kind, LoadKind::Gravity { .. })),
        "loads: changes of gravity; the file has that at time zero",
    );
    add(scene.fluid.is_some(), "fluid");
    add(
        (scene.planes.iter()).any(|plane| plane.directed_friction.is_some()),
        "friction by direction: planes have the largest coefficient",
    );
    let own = scene.rods.iter().flat_map(RodDescription::frictions);
    add(
        own.flatten().count() > 0,
        "friction coefficients of single rods: all rods have that of the contact model",
    );
    add(!scene.springs.is_empty(), "springs");
    add(!scene.tendons.is_empty(), "tendons");
    add(!scene.sheaths.is_empty(), "sheaths");
    add(!scene.free_bodies.is_empty(), "free bodies");
    add(!scene.actuations.is_empty(), "actuation");
    add(!scene.forces.is_empty(), "forces of other parts");
    add(
        scene.bodies.iter().any(|body| body.inertia.is_some()),
        "bodies with moments of inertia; point masses are in the file",
    );
    add(
        scene
            .obstacles
            .iter()
            .any(|obstacle| !is_carried_over(obstacle)),
        "obstacles with faces, hollow or moving ones",
    );
    add(
        scene
            .clamps
            .iter()
            .any(|clamp| clamp.holds_frame && !clamp.holds_position),
        "clamps that hold only the frame of a node",
    );
    add(
        scene.rods.iter().any(|rod| rod.pretension != 0.0),
        "pretension",
    );
    add(
        scene.rods.iter().any(|rod| rod.relaxation.is_some()),
        "relaxation of the material",
    );
    add(
        scene.rods.iter().any(|rod| rod.yielding.is_some()),
        "yielding of the material",
    );
    add(
        scene
            .rods
            .iter()
            .any(|rod| rod.velocity.norm() > 0.0 || rod.angular_velocity.norm() > 0.0),
        "velocities at time zero",
    );
    add(
        !prepared.controllers.is_empty(),
        "the controller of the experiment",
    );
    let is_dynamic = match prepared.mode {
        Mode::Dynamic { settles, .. } => {
            add(settles, "the equilibrium at time zero");
            true
        }
        _ => false,
    };
    if !is_dynamic {
        lines.push(phrases.rest);
    }
    lines.extend(phrases.more);
    lines
}
