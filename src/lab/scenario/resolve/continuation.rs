//! Resolving paths of equilibria.

use crate::scenario::resolved::{Continuation, Fluid, Obstacle, Plane, Time};
use crate::scenario::section::Section;
use crate::scenario::tables;
use crate::scenario::typed::ScenarioFile;

/// Resolves the path; `None` if time.mode differs or a fault was reported.
pub fn continuation(top: &Section<'_>, file: &ScenarioFile, time: &Time) -> Option<Continuation> {
    if *time != Time::Continuation {
        if file.continuation.is_some() {
            let message = "this table is for time.mode = \"continuation\"";
            top.fault("continuation", message);
        }
        return None;
    }
    let help = "a table [continuation] with the end of the parameter, `to`";
    let typed = top.needed("continuation", file.continuation.as_ref(), help)?;
    let section = top.below("continuation");
    Some(tables::continuation(&section, typed))
}

pub const NO_FRICTION: &str = "an equilibrium has no friction: leave the key out, or let the rods come to rest with time.mode = \"dynamic\"";

/// Whether a run finds equilibria.
pub fn is_at_rest(time: &Time) -> bool {
    matches!(time, Time::Static | Time::Continuation)
}

/// Rejects friction, whose forces at rest depend on the history of the rods.
pub fn refuse_friction(
    top: &Section<'_>,
    time: &Time,
    friction: f64,
    planes: &[Plane],
    obstacles: &[Obstacle],
) {
    if !is_at_rest(time) {
        return;
    }
    let message = NO_FRICTION;
    if friction > 0.0 {
        top.below("contact").fault("friction", message);
    }
    for (index, obstacle) in obstacles.iter().enumerate() {
        if obstacle.friction.is_some_and(|friction| friction > 0.0) {
            let section = top.below("obstacles").below(&index.to_string());
            section.fault("friction", message);
        }
    }
    for (index, plane) in planes.iter().enumerate() {
        if plane.friction.is_some_and(|friction| friction > 0.0) {
            let section = top.below("planes").below(&index.to_string());
            section.fault("friction", message);
        }
        if plane.directed_friction.is_some_and(|own| own.rubs()) {
            let section = top.below("planes").below(&index.to_string());
            section.fault("directed_friction", message);
        }
    }
}

/// Rejects a fluid along a path, where drag is zero at rest, and a flow over time in a static run.
pub fn refuse_fluid(top: &Section<'_>, time: &Time, fluid: &Fluid) {
    if *time == Time::Continuation && *fluid != Fluid::None {
        top.fault("fluid", "nothing moves in equilibrium; leave the table out");
    }
    if *time == Time::Static
        && let Some(flow) = fluid.flow()
    {
        flow.refuse_schedule(&top.below("fluid"));
    }
}
