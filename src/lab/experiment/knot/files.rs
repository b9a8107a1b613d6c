//! Descriptions of the files of knots in a results directory.

use rodlab_files::columns;
use rodlab_files::results::{Column, ColumnGroup, FileDescription, file, table};

/// Name of the figure of a knot's traction over its tightness.
pub const TRACTION_FIGURE: &str = "traction.svg";

/// Columns of the knot in the common files, and its figure.
pub static FILES: [FileDescription; 3] = [
    table(
        &["series.csv"],
        "The knot at each output time.",
        &[pulled(SERIES)],
    ),
    table(&["summary.csv"], "Outcome of a knot.", &[pulled(SUMMARY)]),
    file(
        &[TRACTION_FIGURE, "traction.png"],
        "Traction of a knot over its tightness, with the laws of its theory. Written by `rodlab plot`.",
    ),
];

const fn pulled(columns: &'static [Column]) -> ColumnGroup {
    ColumnGroup {
        when: "where a knot is pulled",
        columns,
    }
}

const SERIES: &[Column] = columns! {
    "end_to_end_m": "Distance of the ends, m; with two rods, of the left ends from the right ends.",
    "shortening_m": "Length of a rod minus the distance of the ends, m.",
    "traction_start_n": "Force with which the first end is pulled outwards, N.",
    "traction_end_n": "Force with which the last end is pulled outwards, N.",
    "loop_radius_m": "Radius R of the circle fitted to the loop, the part that is out of contact, m; empty without contact.",
    "force_normalized": "F̄ = F h²/EI with the mean F of the tractions of all ends and the radius h of the rod.",
    "epsilon": "ε = √(h/R), radius of the rod over that of the loop: how tight the knot is; empty without a loop.",
    "length_normalized": "l̄_k = (L − l_c)/h, the shortening over the radius of the rod (thesis Eq. 3.4).",
    "loop_height_m": "Clear height H of the loop of an overhand knot, m: from its middle to the braid, surface to surface; \
        empty without contact.",
    "braid_width_m": "Width W of the knot, m: from end to end of the braid.",
    "height_normalized": "H̄ = H/W.",
    "contact_force_n": "Sum P of all normal forces between the strands, N.",
    "work_of_ends_j": "Work of the clamps at the ends since the start, J.",
    "friction_loss_j": "Energy lost to friction since the start, J.",
    "drag_loss_j": "Energy lost to drag and to the viscosity of the rods since the start, J.",
    "knot_determinant": "Determinant of the knot, 2n + 1 for an overhand knot of unknotting number n. If it changes, a rod \
        has passed through another, and the run ends with exit code 4. Empty where it cannot be determined.",
    "second_traction_start_n": "Force with which the first end of the second rod is pulled outwards, N; empty with one rod.",
    "second_traction_end_n": "Force with which the last end of the second rod is pulled outwards, N; empty with one rod.",
};

const SUMMARY: &[Column] = columns! {
    "may_invert": "Whether an inversion was to be detected: in overhand knots of unknotting number 2 and more, and in all of \
        \"knot-inversion\".",
    "inversion_by_force": "l̄_k at which the traction began to fall most steeply while the loop fell onto the braid; empty if the loop did not fall, or if \
        the traction fell by less than 30 %.",
    "inversion_by_height": "l̄_k at which the loop touched the braid; empty if it never did.",
    "inversion_difference": "Difference of these two values over their mean.",
    "kinetic_over_elastic": "Largest kinetic over elastic energy at the output times while the ends moved, before the inversion.",
    "kinetic_bound": "Upper bound of this ratio for a quasi-static pull: knot.kinetic_bound.",
    "energy_balance": "Gain of energy and losses to friction and drag, over the work of the ends; 1 if the time steps lose \
        no energy.",
    "knot_ending": "Why the run ended early: inverted, or locked (the rod stretches instead of slipping); empty \
        if it did not.",
    "length_normalized": "l̄_k at the last output.",
    "traction_n": "Mean traction of the ends at the last output, N.",
};
