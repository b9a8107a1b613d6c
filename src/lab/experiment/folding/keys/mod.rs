//! The keys of folds: `typed`, `resolved`, and here the way from the one to the other.

mod resolved;
mod typed;

pub use resolved::{AlgorithmName, Crease, Feedback, Folding, Paper};
pub use typed::Paper as TypedPaper;

use crate::experiment::on_table::{self, GRAVITY, JITTER_PERIOD};
use crate::scenario::keys::{NON_NEGATIVE, OwnTable, POSITIVE, Request, Section};
use rodlab_planning::plan::fold::FoldedSheet;

/// Least suspended length of paper, in L_gb (thesis sec. 4.6.5).
const LEAST_SUSPENDED: f64 = 0.958;
/// Thickness (m) and mass per volume (kg/m³) of paper.
const THICKNESS: f64 = 1e-4;
const DENSITY: f64 = 800.0;
/// Edges per gravito-bending length where nothing is said.
const EDGES_PER_LENGTH: f64 = 20.0;
/// Parts of a path that may be asked for.
const PARTS: [usize; 2] = [2, 1000];
/// Parts where none are given (thesis sec. 4.6.5).
const USUAL_PARTS: usize = 5;

/// The table of this experiment.
pub static TABLES: [OwnTable; 1] = [OwnTable::new::<typed::Folding>(
    "folding",
    "Sheet, crease and gripper of the experiment \"folding\".",
)];

/// Resolves sheet and gripper; `None` where a fault was reported that leaves nothing to go on with.
pub fn resolve(request: &Request<'_>) -> Option<Folding> {
    request.refuse(
        &["material", "rod"],
        "the sheet of a fold and its material are [folding.paper]",
    );
    on_table::need_time(request, "a sheet is folded in time");
    let typed: &typed::Folding = request.table("folding")?;
    let section = request.top.below("folding");
    let help = "a table [folding.paper], or extends = \"papers/a4.toml\"";
    let paper = section.needed("paper", typed.paper.as_ref(), help);
    let paper = paper.and_then(|paper| resolve_paper(&section.below("paper"), paper));
    let crease = match &typed.crease {
        None => Crease::Half,
        Some(typed) if typed.is_word("half") => Crease::Half,
        Some(typed) if typed.is_word(Crease::DIAGONAL_STRIP) => Crease::Diagonal,
        Some(typed) if typed.is_word("diagonal") => {
            section.fault("crease", Crease::NO_DIAGONAL);
            return None;
        }
        Some(typed) => Crease::At(section.number("crease", typed, POSITIVE)),
    };
    let length_error = on_table::length_error(&section, &typed.length_error);
    let jitter = section.with_default("jitter", &typed.jitter, NON_NEGATIVE, 0.0);
    let jitter_angle = section.with_default("jitter_angle", &typed.jitter_angle, NON_NEGATIVE, 0.0);
    let period = &typed.jitter_period;
    let jitter_period = section.with_default("jitter_period", period, POSITIVE, JITTER_PERIOD);
    let seed = on_table::seed(&section, typed.seed);
    let feedback = match &typed.feedback {
        Some(typed) => Some(resolve_feedback(&section.below("feedback"), typed)?),
        None => None,
    };
    let algorithm = typed.algorithm.unwrap_or(AlgorithmName::Optimal);
    if feedback.is_some() && !algorithm.is_planned_anew() {
        let message = "this way of folding is not planned anew: use \"optimal\", \"least-friction\" or \"held\"";
        section.fault("feedback", message);
        return None;
    }
    let paper = paper?;
    if let Err(message) = paper.target(crease) {
        section.fault("crease", message);
        return None;
    }
    Some(Folding {
        algorithm,
        crease,
        length_error,
        jitter,
        jitter_angle,
        jitter_period,
        seed,
        feedback,
        paper,
    })
}

fn resolve_feedback(section: &Section<'_>, typed: &typed::Feedback) -> Option<Feedback> {
    let [fewest, most] = PARTS;
    let parts = match typed.parts {
        Some(_) => section.count("parts", typed.parts, fewest..=most)?,
        None => USUAL_PARTS,
    };
    let noise = section.with_default("noise", &typed.noise, NON_NEGATIVE, 0.0);
    Some(Feedback { parts, noise })
}

/// Resolves a sheet; `None` where a fault was reported.
pub fn resolve_paper(section: &Section<'_>, typed: &TypedPaper) -> Option<Paper> {
    let length = section.required("length", &typed.length, POSITIVE);
    let width = section.required("width", &typed.width, POSITIVE);
    let given = (&typed.gravito_bending_length, &typed.youngs_modulus);
    let (thickness, density, gravito_bending_length) = match given {
        (Some(unit), None) => (
            section.with_default("thickness", &typed.thickness, POSITIVE, THICKNESS),
            section.with_default("density", &typed.density, POSITIVE, DENSITY),
            section.number("gravito_bending_length", unit, POSITIVE),
        ),
        (None, Some(modulus)) => {
            let thickness = section.required("thickness", &typed.thickness, POSITIVE);
            let density = section.required("density", &typed.density, POSITIVE);
            let modulus = section.number("youngs_modulus", modulus, POSITIVE);
            let unit = FoldedSheet::gravito_bending_length_of(modulus, thickness, density, GRAVITY);
            (thickness, density, unit)
        }
        (Some(_), Some(_)) => {
            let message = "give `gravito_bending_length` or `youngs_modulus`, not both";
            section.fault("youngs_modulus", message);
            return None;
        }
        (None, None) => {
            let help = "a length; or `youngs_modulus`, `thickness` and `density`";
            section.missing("gravito_bending_length", help);
            return None;
        }
    };
    let least = &typed.least_suspended_length;
    let least_suspended_length =
        section.with_default("least_suspended_length", least, POSITIVE, LEAST_SUSPENDED);
    let friction = section.optional("friction", &typed.friction, NON_NEGATIVE);
    let numbers = [length, width, gravito_bending_length, thickness, density];
    let is_known = numbers.iter().all(|number| number.is_finite())
        && least_suspended_length.is_finite()
        && friction.is_none_or(f64::is_finite);
    let usual = EDGES_PER_LENGTH * length / gravito_bending_length;
    let edges = on_table::edges(section, typed.edges, usual)?;
    is_known.then_some(Paper {
        length,
        width,
        gravito_bending_length,
        thickness,
        density,
        least_suspended_length,
        friction,
        edges,
    })
}
