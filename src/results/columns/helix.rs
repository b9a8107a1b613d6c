//! Tables of the stability of helices.

use super::Column;

pub(super) const BOUNDARY: &[Column] = columns! {
    "part": "surface, or the plane section: kappa_tau (ω = 0), kappa_omega (τ = 0), tau_omega (κ = 0, straight rods).",
    "kappa": "Curvature of the unit direction.",
    "tau": "Torsion of the unit direction.",
    "omega": "Twisting moment of the unit direction.",
    "outcome": "buckles, touches_itself (before it buckles), stable (up to the largest distance), or no_convergence.",
    "critical": "Distance at which the discrete rod loses stability; empty where it does not.",
    "extrapolated": "The same in the limit of a fine mesh, from this mesh and one of half as many edges; empty where it is not asked \
        for or the coarse rod stays stable.",
    "theory": "The same by the conjugate points of the smooth rod; empty where there are none up to 100.",
    "relative_difference": "critical/theory − 1.",
    "relative_difference_extrapolated": "extrapolated/theory − 1.",
    "contact": "Distance at which the rod first touches itself; empty where it does not before it buckles.",
};

pub(super) const COMPARISON: &[Column] = columns! {
    "quantity": "What is compared with theory: critical or extrapolated of boundary.csv.",
    "from": "Least distance of the band, by theory.",
    "to": "Largest distance of the band, by theory; empty where there is no end.",
    "directions": "Directions for which both have a value.",
    "mean_difference": "Mean of |distance/theory − 1|.",
    "largest_difference": "Largest |distance/theory − 1|.",
    "within_2e_4": "Part of the directions that differ by at most 0.02 %.",
    "within_1e_3": "Part of the directions that differ by at most 0.1 %.",
    "within_5e_3": "Part of the directions that differ by at most 0.5 %.",
};
