//! From the scenario as typed to the scenario as resolved: units, defaults, ranges.

mod columns;
mod continuation;
mod helix_stability;
mod knot;
mod knot_start;
mod load;
mod model;
mod polyline;
mod poses;
mod probe;
mod rod;
mod section;
mod shape;

pub use polyline::read as read_polyline;

use super::issue::{Issues, KeyPath};
use super::resolved::{
    BuilderRod, Contact, Experiment, Fluid, Knot, KnotKind, Material, Scenario, Time,
};
use super::typed::{self, ScenarioFile};
use section::Section;
use std::cell::RefCell;
use std::path::PathBuf;

/// What resolving needs beside the file's keys.
pub struct Context<'a> {
    /// Stem of the scenario file.
    pub name: &'a str,
    /// The directory against which the value of a key names files.
    pub directory_of: &'a dyn Fn(&KeyPath) -> PathBuf,
}

/// Resolves a scenario.
///
/// # Errors
/// All values that are missing, out of range, of the wrong dimension or at odds with each other.
pub fn resolve(context: &Context<'_>, file: &ScenarioFile) -> Result<Scenario, Issues> {
    let issues = RefCell::new(Issues::default());
    let top = Section::new(KeyPath::root(), &issues);
    let time = match (file.experiment, &file.time) {
        // Equilibria all of them; there is no time to speak of.
        (Some(typed::Experiment::HelixStability), None) => Time::Static,
        _ => model::time(&top, file),
    };
    let experiment = experiment(context, &top, file, &time);
    let rods = rod::rods(context, &top, file);
    if rods.is_empty() && matches!(file.experiment, Some(typed::Experiment::Scene)) {
        top.missing("rods", "a scene needs at least one [[rods]]");
    }
    if !rods.is_empty()
        && rods.iter().all(|rod| rod.held)
        && matches!(file.experiment, Some(typed::Experiment::Scene))
    {
        top.fault(
            "rods",
            "every rod is held; at least one must be free to move",
        );
    }
    let smallest_radius = rods
        .iter()
        .map(|rod| rod.radius)
        .chain(experiment.iter().filter_map(|experiment| match experiment {
            Experiment::Scene | Experiment::HelixStability { .. } => None,
            Experiment::Flagella { rod, .. }
            | Experiment::KnotTightening { rod, .. }
            | Experiment::KnotInversion { rod, .. } => Some(rod.radius),
        }))
        .fold(f64::INFINITY, f64::min);
    let solver = model::solver(&top, &file.solver);
    model::refuse_small_steps(&top, &time, &solver);
    let contact = model::contact(&top, file.contact.as_ref(), smallest_radius);
    model::refuse_rigid_statics(&top, &contact, &time);
    let knotted = experiment.as_ref().and_then(Experiment::knot).is_some();
    if contact == Contact::None && knotted {
        top.missing("contact", "a knot needs contact: a table [contact]");
    }
    let fluid = model::fluid(&top, file.fluid.as_ref());
    if matches!(experiment, Some(Experiment::HelixStability { .. })) {
        for (key, present) in [
            ("time", time != Time::Static),
            ("contact", contact != Contact::None),
            ("fluid", fluid != Fluid::None),
        ] {
            if present {
                top.fault(
                    key,
                    "helices are judged in equilibrium and in a vacuum; leave the table out",
                );
            }
        }
    }
    let continuation = continuation::continuation(&top, file, &time);
    let loads = load::loads(&top, &file.loads);
    let planes = load::planes(&top, &file.planes);
    continuation::refuse_friction(&top, &time, contact.friction(), &planes);
    continuation::refuse_without_energy(&top, &time, &fluid, &loads);
    let scenario = experiment.map(|experiment| Scenario {
        name: context.name.to_owned(),
        title: file
            .title
            .clone()
            .unwrap_or_else(|| context.name.to_owned()),
        experiment,
        clamps: load::clamps(context, &top, &file.clamps),
        loads,
        planes,
        probes: probe::probes(&top, &file.probes),
        stop_when: probe::stop_when(&top, file.stop_when.as_ref()),
        contact,
        fluid,
        output: model::output(&top, &file.output, &time),
        rods,
        time,
        continuation,
        solver,
    });
    match scenario {
        Some(scenario) => issues.into_inner().or_ok(scenario),
        None => Err(issues.into_inner()),
    }
}

/// The experiment and its own tables; `None` if a fault was reported.
fn experiment(
    context: &Context<'_>,
    top: &Section<'_>,
    file: &ScenarioFile,
    time: &Time,
) -> Option<Experiment> {
    let names =
        "\"scene\", \"flagella\", \"knot-tightening\", \"knot-inversion\" or \"helix-stability\"";
    let experiment = top.needed("experiment", file.experiment, names)?;
    let knotted = matches!(
        experiment,
        typed::Experiment::KnotTightening | typed::Experiment::KnotInversion
    );
    for (key, present, owner) in [
        (
            "flagella",
            file.flagella.is_some(),
            experiment == typed::Experiment::Flagella,
        ),
        ("knot", file.knot.is_some(), knotted),
        (
            "helix_stability",
            file.helix_stability.is_some(),
            experiment == typed::Experiment::HelixStability,
        ),
    ] {
        let builder = experiment != typed::Experiment::Scene;
        if present && builder && !owner {
            top.fault(key, "this table is for another experiment");
        }
    }
    match experiment {
        typed::Experiment::Scene => {
            for (key, present) in [
                ("rod", file.rod.is_some()),
                ("flagella", file.flagella.is_some()),
                ("knot", file.knot.is_some()),
                ("helix_stability", file.helix_stability.is_some()),
            ] {
                if present {
                    top.fault(
                        key,
                        "this table is for builders; a scene lists its rods as [[rods]]",
                    );
                }
            }
            Some(Experiment::Scene)
        }
        typed::Experiment::Flagella => {
            let built = built_rod(top, file);
            let flagella = top.needed("flagella", file.flagella.as_ref(), "a table [flagella]");
            let ((rod, material), flagella) = (built?, flagella?);
            model::flagella(top, material, rod, flagella)
        }
        typed::Experiment::KnotTightening => {
            let (material, rod, knot) = knotted_rod(context, top, file, time)?;
            Some(Experiment::KnotTightening {
                material,
                rod,
                knot,
            })
        }
        typed::Experiment::KnotInversion => {
            let (material, rod, knot) = knotted_rod(context, top, file, time)?;
            if !matches!(knot.start.kind(), Some(KnotKind::Overhand { .. })) {
                let message = "other knots do not invert; allowed: \"overhand\"";
                top.below("knot").fault("kind", message);
            }
            Some(Experiment::KnotInversion {
                material,
                rod,
                knot,
            })
        }
        typed::Experiment::HelixStability => {
            for (key, present) in [
                ("material", file.material.is_some()),
                ("rod", file.rod.is_some()),
                ("rods", !file.rods.is_empty()),
                ("clamps", !file.clamps.is_empty()),
                ("loads", !file.loads.is_empty()),
                ("planes", !file.planes.is_empty()),
            ] {
                if present {
                    let message = "the rod has length 1 and bending stiffness 1; [helix_stability] says all of it";
                    top.fault(key, message);
                }
            }
            let typed = file.helix_stability.as_ref();
            let typed = top.needed("helix_stability", typed, "a table [helix_stability]")?;
            helix_stability::helix_stability(context, top, typed)
        }
    }
}

/// The knotted rod of an experiment with knots; `None` if a fault was reported.
fn knotted_rod(
    context: &Context<'_>,
    top: &Section<'_>,
    file: &ScenarioFile,
    time: &Time,
) -> Option<(Material, BuilderRod, Knot)> {
    let built = built_rod(top, file);
    let knot = top.needed("knot", file.knot.as_ref(), "a table [knot]");
    let ((rod, material), knot) = (built?, knot?);
    knot::knot(context, top, material, rod, knot, time)
}

/// Rod and material of a builder; `None` if one is missing, which is reported.
fn built_rod<'a>(
    top: &Section<'_>,
    file: &'a ScenarioFile,
) -> Option<(&'a typed::BuilderRod, &'a typed::Material)> {
    let rod = top.needed(
        "rod",
        file.rod.as_ref(),
        "a table [rod] with radius and nodes",
    );
    let material = top.needed(
        "material",
        file.material.as_ref(),
        "a table [material] with youngs_modulus, poissons_ratio and density",
    );
    Some((rod?, material?))
}
