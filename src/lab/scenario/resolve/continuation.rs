//! Resolving paths of equilibria.

use crate::scenario::resolved::{Continuation, Fluid, Obstacle, PathMethod, Plane, Time};
use crate::scenario::section::{FINITE, POSITIVE, Section};
use crate::scenario::typed::ScenarioFile;

/// Most points that a branch may have.
const MOST_POINTS: usize = 1_000_000;

/// Resolves the path; `None` where time.mode is another, or a fault was reported.
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
    let from = section.with_default("from", &typed.from, FINITE, 0.0);
    let to = section.required("to", &typed.to, FINITE);
    let range = (to - from).abs();
    if range == 0.0 {
        section.out_of_range("to", to, "any but `from`");
    }
    let step = |key, typed, default| {
        let step = section.with_default(key, typed, POSITIVE, default);
        if step > range {
            let allowed = format_args!("at most |to − from| = {range:?}");
            section.out_of_range(key, step, allowed);
        }
        step
    };
    let first = step("step", &typed.step, 0.01 * range);
    let largest = step(
        "largest_step",
        &typed.largest_step,
        first.max(0.02 * range).min(range),
    );
    let points = typed.most_points.or(Some(1000));
    Some(Continuation {
        from,
        to,
        step: first,
        largest_step: largest,
        method: typed.method.unwrap_or(PathMethod::Arclength),
        switch_branches: typed.switch_branches.unwrap_or(true),
        most_points: section.count("most_points", points, 2..=MOST_POINTS)?,
    })
}

/// Refuses friction, whose forces at rest depend on how the rods came there.
pub fn refuse_friction(
    top: &Section<'_>,
    time: &Time,
    friction: f64,
    planes: &[Plane],
    obstacles: &[Obstacle],
) {
    if !matches!(time, Time::Static | Time::Continuation) {
        return;
    }
    let message = "an equilibrium knows no friction: leave the key out, or let the rods come to rest with time.mode = \"dynamic\"";
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
    }
}

/// Refuses a fluid along a path: drag is nothing at rest.
pub fn refuse_fluid(top: &Section<'_>, time: &Time, fluid: &Fluid) {
    if *time == Time::Continuation && *fluid != Fluid::None {
        top.fault("fluid", "nothing moves in equilibrium; leave the table out");
    }
}
