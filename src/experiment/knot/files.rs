//! What knots leave in a results directory.

use crate::experiment::kind::FileNote;
use crate::results::{SERIES, SUMMARY, TRACTION_FIGURE};

/// Columns of the knot in the common files, and its figure.
pub static FILES: [FileNote; 3] = [
    FileNote {
        name: SERIES,
        summary: "The knot at each output time.",
        columns: &[
            (
                "end_to_end_m",
                "Distance of the ends; with two rods of those on the left from those on the right.",
            ),
            (
                "shortening_m",
                "Length of a rod less the distance of its ends.",
            ),
            (
                "traction_start_n",
                "Force with which the first end is pulled outwards.",
            ),
            (
                "traction_end_n",
                "Force with which the last end is pulled outwards.",
            ),
            (
                "loop_radius_m",
                "Radius R of the circle fitted to the loop, the part that is out of contact; empty without contact.",
            ),
            (
                "force_normalized",
                "F̄ = F h²/EI with the mean F of the tractions of all ends and the radius h of the rod.",
            ),
            ("epsilon", "Tightness ε = √(h/R); empty without contact."),
            (
                "length_normalized",
                "l̄_k = (L − l_c)/h: the shortening over the radius of the rod (thesis Eq. 3.4).",
            ),
            (
                "loop_height_m",
                "Clear height H of the loop of an overhand knot, from its middle to the braid, surface to surface; empty without contact.",
            ),
            (
                "braid_width_m",
                "Width W of the knot, from end to end of the braid.",
            ),
            ("height_normalized", "H̄ = H/W."),
            (
                "contact_force_n",
                "Sum of all normal forces between the strands.",
            ),
            (
                "work_of_ends_j",
                "Work of the clamps at the ends since the start.",
            ),
            (
                "friction_loss_j",
                "Energy lost to friction since the start.",
            ),
            ("drag_loss_j", "Energy lost to drag since the start."),
            (
                "knot_determinant",
                "Determinant of the knot; empty where it cannot be told.",
            ),
            (
                "second_traction_start_n",
                "Force with which the first end of the second rod is pulled outwards; empty where one rod is tied.",
            ),
            (
                "second_traction_end_n",
                "Force with which the last end of the second rod is pulled outwards; empty where one rod is tied.",
            ),
        ],
    },
    FileNote {
        name: SUMMARY,
        summary: "What became of the knot.",
        columns: &[
            (
                "may_invert",
                "Whether an inversion was looked for: in overhand knots of unknotting number 2 and more, and in all that \
                 are pulled for it.",
            ),
            (
                "inversion_by_force",
                "l̄_k at which the traction fell as the knot inverted; empty where it did not.",
            ),
            (
                "inversion_by_height",
                "l̄_k at which the loop had come to lie on the braid; empty where it did not.",
            ),
            (
                "inversion_difference",
                "Difference of the two inversion points over their mean.",
            ),
            (
                "kinetic_over_elastic",
                "Largest kinetic over elastic energy at the output times while the ends moved, before the inversion.",
            ),
            (
                "kinetic_bound",
                "What kinetic_over_elastic should not exceed for a quasi-static pull: knot.kinetic_bound.",
            ),
            (
                "energy_balance",
                "Gain of energy and losses to friction and drag over the work of the ends, meanwhile.",
            ),
            (
                "knot_ending",
                "Why the run ended before its time, inverted or locked; empty where it did not.",
            ),
            ("length_normalized", "l̄_k at the last output."),
            (
                "traction_n",
                "Mean traction of the ends at the last output.",
            ),
        ],
    },
    FileNote {
        name: TRACTION_FIGURE,
        summary: "Traction over tightness while the ends are pulled apart, with theory.",
        columns: &[],
    },
];
