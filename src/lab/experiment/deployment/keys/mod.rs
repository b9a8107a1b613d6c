//! The keys of deployments: modules `typed` and `resolved`, and the conversion between them here.

mod fixtures;
mod knot;
mod pattern;
mod resolved;
mod second;
mod typed;

pub use pattern::svg_drawing;
#[cfg(test)]
pub use resolved::Second;
pub use resolved::{Correction, Deployment, Knot, Pattern, Peg, Rod, Scheme, Solver};

use crate::experiment::on_table;
use crate::scenario::Time;
use crate::scenario::keys::{Length, NON_NEGATIVE, OwnTable, Quantity, Request, Section};
use rodlab_planning::plan::deployment::{DeployedRod, lead_length, long_enough};
use rodlab_planning::plan::pattern::Pattern as Curve;

/// Default number of edges per gravito-bending length of a simulated rod.
const EDGES_PER_LENGTH: f64 = 4.0;
/// Default density, kg/m³.
const DENSITY: f64 = 1000.0;
/// Default length between corrections over L_gb.
const CORRECTED_EVERY: f64 = 0.8;
/// Default return length over L_gb. The second value is the shortest return length, over L_gb and
/// over the length between corrections.
const RETURN_LENGTH: f64 = 3.5;
const SHORTEST_RETURN: f64 = 3.0;

/// The table of this experiment.
pub static TABLES: [OwnTable; 1] = [OwnTable::new::<typed::Deployment>(
    "deployment",
    "Pattern, rod and gripper of the experiment \"deployment\".",
)];

/// Resolves pattern, rod and gripper; `None` after a fault that prevents further checks.
pub fn resolve(request: &Request<'_>) -> Option<Deployment> {
    request.refuse(
        &["material", "rod"],
        "[deployment.rod] defines the rod of a deployment and its material",
    );
    on_table::need_time(request, "laying a rod takes time");
    let typed: &typed::Deployment = request.table("deployment")?;
    let section = request.top.below("deployment");
    let help = "a table [deployment.rod], or extends = \"rods/green_vps.toml\"";
    let rod = section.needed("rod", typed.rod.as_ref(), help);
    let rod = rod.and_then(|rod| resolve_rod(&section.below("rod"), rod));
    let help = "{ file = \"drawing.svg\" }, or { kind = \"circle\", radius = \"9 cm\" }";
    let pattern = section.needed("pattern", typed.pattern.as_ref(), help);
    let pattern = pattern.and_then(|pattern| pattern::resolve(&section.below("pattern"), pattern));
    let length_error = on_table::length_error(&section, &typed.length_error);
    let jitter = typed.jitter(&section);
    let frame_shift = typed.frame_shift(&section).unwrap_or_default();
    let frame_turn = typed.frame_turn(&section);
    let jitter_angle = typed.jitter_angle(&section);
    let jitter_period = typed.jitter_period(&section);
    let seed = on_table::seed(&section, typed.seed);
    let (rod, pattern) = (rod?, pattern?);
    let is_tied = typed.knot.is_some();
    let curve = with_lead_in(&section, typed.lead_in.as_ref(), is_tied, &rod, &pattern)?;
    let scheme = typed.scheme(&section);
    let second = second::resolve(&section, typed, scheme)?;
    let pegs = fixtures::resolve(&section, typed, &rod, &curve)?;
    let release = release(request, &section, typed)?;
    let knot = knot::resolve(&section, typed, (&rod, &curve), second.as_ref())?;
    let correction = match &typed.correction {
        Some(_) if scheme == Scheme::Intuitive => {
            let message = "the intuitive scheme cannot be corrected; use \"optimal\"";
            section.fault("correction", message);
            return None;
        }
        Some(typed) => Some(resolve_correction(
            &section.below("correction"),
            typed,
            &rod,
        )?),
        None => None,
    };
    Some(Deployment {
        scheme,
        solver: typed.solver(&section),
        lead_in: curve.lead_in(),
        length_error,
        frame_shift,
        frame_turn,
        jitter,
        jitter_angle,
        jitter_period,
        seed,
        correction,
        release,
        pegs,
        knot,
        pattern,
        rod,
        second: second.map(|(second, _)| second),
    })
}

/// Time before the end at which the gripper releases the rod, s; `None` after a fault.
fn release(
    request: &Request<'_>,
    section: &Section<'_>,
    typed: &typed::Deployment,
) -> Option<Option<f64>> {
    let release = typed.release(section);
    let Time::Dynamic { end, .. } = *request.time else {
        return None;
    };
    if let Some(release) = release.filter(|release| *release >= end) {
        section.out_of_range(
            "release",
            format_args!("{release:?} s"),
            format_args!("less than the time in which the rod is laid, {end:?} s (`time.end`)"),
        );
        return None;
    }
    Some(release)
}

fn resolve_correction(
    section: &Section<'_>,
    typed: &typed::Correction,
    rod: &Rod,
) -> Option<Correction> {
    let unit = rod.gravito_bending_length;
    let every = typed.every(section, CORRECTED_EVERY * unit);
    let shortest = SHORTEST_RETURN * every.max(unit);
    let usual = shortest.max(RETURN_LENGTH * unit);
    let return_length = typed.return_length(section, usual);
    let noise = typed.noise(section);
    if ![every, return_length, noise]
        .iter()
        .all(|value| value.is_finite())
    {
        return None;
    }
    let edge = rod.length / rod.edges as f64;
    if every < edge {
        section.fault(
            "every",
            format!("{every:?} m is less than an edge of the rod, {edge:.4} m (`rod.edges`)"),
        );
        return None;
    }
    if return_length < shortest * (1.0 - 1e-9) {
        section.fault(
            "return_length",
            format!(
                "{return_length:?} m is too short, so that the rod would swing about its pattern; allowed: at least {shortest:.4} m, \
                 which is {SHORTEST_RETURN} times the larger of `every` and the gravito-bending length"
            ),
        );
        return None;
    }
    Some(Correction {
        every,
        return_length,
        noise,
    })
}

/// The pattern with its lead-in, checked to be long enough for the rod.
fn with_lead_in(
    section: &Section<'_>,
    lead_in: Option<&Quantity<Length>>,
    is_tied: bool,
    rod: &Rod,
    pattern: &Pattern,
) -> Option<Curve> {
    let rod = rod.deployed();
    let curve = match pattern.source().pattern() {
        Ok(curve) => curve,
        Err(error) => {
            section.fault("pattern", error.to_string());
            return None;
        }
    };
    let length = match lead_in.filter(|typed| !typed.is_word("auto")) {
        Some(typed) => section.number("lead_in", typed, NON_NEGATIVE),
        None => lead_length(&rod, &curve.at(0.0)),
    };
    let curve = curve.with_lead_in(length);
    // The part of the pattern beyond the length of a tied rod is the path of its end.
    if !is_tied && let Err(error) = long_enough(&rod, &curve) {
        section.fault("pattern", error.to_string());
        return None;
    }
    Some(curve)
}

fn resolve_rod(section: &Section<'_>, typed: &typed::Rod) -> Option<Rod> {
    let rod = DeployedRod {
        gravito_bending_length: typed.gravito_bending_length(section),
        radius: typed.radius(section),
        length: typed.length(section),
    };
    let density = typed.density(section);
    for (name, friction) in typed.friction.iter().flatten() {
        if !(*friction >= 0.0 && friction.is_finite()) {
            let below = section.below("friction");
            below.out_of_range(name, friction, "at least 0");
        }
    }
    let is_known = [rod.gravito_bending_length, rod.radius, rod.length, density]
        .iter()
        .all(|value| value.is_finite());
    let usual = EDGES_PER_LENGTH * rod.length / rod.gravito_bending_length;
    let edges = on_table::edges(section, typed.edges, usual)?;
    is_known.then_some(Rod {
        gravito_bending_length: rod.gravito_bending_length,
        radius: rod.radius,
        length: rod.length,
        density,
        edges,
    })
}
