//! Descriptions of the files of a search for the boundary of stable helices in a results directory.

use rodlab_files::columns;
use rodlab_files::results::{Column, FileDescription, always, file, table};

/// Stability limits of helical rods, a row per direction.
pub const BOUNDARY: &str = "boundary.csv";
/// Comparison of the stability limits with theory.
pub const COMPARISON: &str = "comparison.csv";
/// The stability limits as a surface for ParaView.
pub const SURFACE: &str = "boundary.vtp";
/// Figures of sections of this surface.
pub const SECTION_FIGURES: [&str; 3] = [
    "section_kappa_tau.svg",
    "section_kappa_omega.svg",
    "section_tau_omega.svg",
];

/// The files of the boundary.
pub static FILES: [FileDescription; 4] = [
    table(
        &[BOUNDARY],
        "Where clamped helical rods lose stability (experiment \"helix-stability\"), a row per direction of \
         (κ, τ, ω): curvature, torsion, twisting moment. Distances are norms ‖(κ, τ, ω)‖ for a rod of length 1 and \
         bending stiffness 1.",
        &[always(BOUNDARY_COLUMNS)],
    ),
    table(
        &[COMPARISON],
        "boundary.csv compared with theory, a row per band of distances.",
        &[always(COMPARISON_COLUMNS)],
    ),
    file(
        &[SURFACE],
        "The boundary of boundary.csv as a surface for ParaView.",
    ),
    file(
        &[
            SECTION_FIGURES[0],
            SECTION_FIGURES[1],
            SECTION_FIGURES[2],
            "section_kappa_tau.png",
            "section_kappa_omega.png",
            "section_tau_omega.png",
        ],
        "Plane sections of the boundary of stable helices, beside theory.",
    ),
];

const BOUNDARY_COLUMNS: &[Column] = columns! {
    "part": "surface, or the plane section: kappa_tau (ω = 0), kappa_omega (τ = 0), tau_omega (κ = 0, straight rods).",
    "kappa": "Curvature of the unit direction.",
    "tau": "Torsion of the unit direction.",
    "omega": "Twisting moment of the unit direction.",
    "outcome": "buckles, touches_itself (before it buckles), stable (up to the largest distance), or no_convergence.",
    "critical": "Distance at which the discrete rod loses stability; empty if it does not.",
    "extrapolated": "Critical distance in the limit of a fine mesh, from this mesh and one of half as many edges; empty if it is not requested, \
        or if the coarse rod stays stable.",
    "theory": "Critical distance by the conjugate points of the smooth rod; empty if there are none up to 100.",
    "relative_difference": "critical/theory − 1.",
    "relative_difference_extrapolated": "extrapolated/theory − 1.",
    "contact": "Distance at which the rod first touches itself; empty if it does not do so before it buckles.",
};

const COMPARISON_COLUMNS: &[Column] = columns! {
    "quantity": "Column of boundary.csv that is compared with theory: critical or extrapolated.",
    "from": "Least distance of the band, by theory.",
    "to": "Largest distance of the band, by theory; empty if the band has no upper end.",
    "directions": "Number of directions for which both values exist.",
    "mean_difference": "Mean of |distance/theory − 1|.",
    "largest_difference": "Largest |distance/theory − 1|.",
    "within_2e_4": "Fraction of the directions that differ by at most 0.02 %.",
    "within_1e_3": "Fraction of the directions that differ by at most 0.1 %.",
    "within_5e_3": "Fraction of the directions that differ by at most 0.5 %.",
};
