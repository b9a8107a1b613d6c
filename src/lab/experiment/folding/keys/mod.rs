//! The keys of folds: modules `typed` and `resolved`, and the conversion between them here.

mod resolved;
mod typed;

pub use resolved::{AlgorithmName, Crease, Feedback, Folding, Paper};
pub use typed::Paper as TypedPaper;

use crate::experiment::on_table::{self, GRAVITY};
use crate::scenario::keys::{OwnTable, POSITIVE, Request, Section};
use rodlab_planning::plan::fold::FoldedSheet;

/// Least suspended length of paper, in L_gb (thesis sec. 4.6.5).
const LEAST_SUSPENDED: f64 = 0.958;
/// Thickness (m) and mass per volume (kg/m³) of paper.
const THICKNESS: f64 = 1e-4;
const DENSITY: f64 = 800.0;
/// Default number of edges per gravito-bending length.
const EDGES_PER_LENGTH: f64 = 20.0;
/// Allowed numbers of parts of a path.
const PARTS: [usize; 2] = [2, 1000];
/// Default number of parts (thesis sec. 4.6.5).
const USUAL_PARTS: usize = 5;

/// The table of this experiment.
pub static TABLES: [OwnTable; 1] = [OwnTable::new::<typed::Folding>(
    "folding",
    "Sheet, crease and gripper of the experiment \"folding\".",
)];

/// Resolves sheet and gripper; `None` after a fault that prevents further checks.
pub fn resolve(request: &Request<'_>) -> Option<Folding> {
    request.refuse(
        &["material", "rod"],
        "[folding.paper] defines the sheet of a fold and its material",
    );
    on_table::need_time(request, "folding a sheet takes time");
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
    let jitter = typed.jitter(&section);
    let jitter_angle = typed.jitter_angle(&section);
    let jitter_period = typed.jitter_period(&section);
    let seed = on_table::seed(&section, typed.seed);
    let feedback = match &typed.feedback {
        Some(typed) => Some(resolve_feedback(&section.below("feedback"), typed)?),
        None => None,
    };
    let algorithm = typed.algorithm(&section);
    if feedback.is_some() && !algorithm.can_replan() {
        let message =
            "this algorithm cannot replan; use \"optimal\", \"least-friction\" or \"held\"";
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
    let noise = typed.noise(section);
    Some(Feedback { parts, noise })
}

/// Resolves a sheet; `None` after a fault.
pub fn resolve_paper(section: &Section<'_>, typed: &TypedPaper) -> Option<Paper> {
    let length = typed.length(section);
    let width = typed.width(section);
    let given = (&typed.gravito_bending_length, &typed.youngs_modulus);
    let (thickness, density, gravito_bending_length) = match given {
        (Some(_), None) => (
            typed.thickness(section).unwrap_or(THICKNESS),
            typed.density(section).unwrap_or(DENSITY),
            typed.gravito_bending_length(section),
        ),
        (None, Some(_)) => {
            let thickness = section.required("thickness", &typed.thickness, POSITIVE);
            let density = section.required("density", &typed.density, POSITIVE);
            let modulus = typed.youngs_modulus(section);
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
    let least_suspended_length = typed.least_suspended_length(section);
    let friction = typed.friction(section);
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
