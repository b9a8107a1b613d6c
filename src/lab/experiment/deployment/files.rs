//! Descriptions of the files of a deployment in a results directory.

use rodlab_files::columns;
use rodlab_files::results::{Column, ColumnGroup, FileDescription, file, table};

/// Name of the figure of a laid rod and its pattern.
pub const LAID_FIGURE: &str = "deployment.svg";

/// Columns of a deployment in the common files, and its figure.
pub static FILES: [FileDescription; 3] = [
    table(
        &["series.csv"],
        "The laid part of the rod at each output time.",
        &[laid(SERIES)],
    ),
    table(
        &["summary.csv"],
        "Outcome of a deployment.",
        &[laid(SUMMARY)],
    ),
    file(
        &["deployment.svg", "deployment.png"],
        "The laid rod from above with its pattern. Written by `rodlab plot`.",
    ),
];

const fn laid(columns: &'static [Column]) -> ColumnGroup {
    ColumnGroup {
        when: "where a rod is laid along a pattern",
        columns,
    }
}

const SERIES: &[Column] = columns! {
    "laid_m": "Arc length of the pattern with its lead-in that the gripper has laid, m; with two rods the sum for both.",
    "mean_error_m": "Mean distance of the laid part of the rod from the pattern at equal arc lengths, m. The whole pattern (with two rods each \
        pattern) has 50 points, without its lead-in. Empty before the first point, and while a laid rod is tied.",
    "largest_sliding_m": "Largest displacement of a laid node from where it was first laid, m.",
    "gripper_force_n": "Force of the gripper on the rod that it lays, N; with two rods the larger force.",
};

const SUMMARY: &[Column] = columns! {
    "mean_error_m": "Mean distance of the laid rod from the pattern at equal arc lengths, e_mean of thesis Eq. 5.11 over 50 points \
        (with two rods for each), without the lead-in, m; for a tied rod, before its end was led on.",
    "error_deviation_m": "Standard deviation of that distance, m.",
    "largest_error_m": "Largest distance of the laid rod from the pattern, m.",
    "largest_sliding_m": "Largest displacement of a laid node from where it was first laid, m.",
    "largest_gripper_force_n": "Largest force of the gripper on the rod, N.",
    "largest_friction_demand": "The largest friction demand of the pattern: 2 L_gb³|κ''| of the lying rod (thesis Eq. 5.2), and |n_y + κ̄'|/|n_z| at the contact \
        node of the optimal grasp; with the scheme \"intuitive\" only that of the lying rod.",
    "share_above_friction": "Fraction of the pattern that demands more friction than the table has; there the rod slides.",
    "pegs": "Number of pegs on the table, with two for each clip; empty without pegs.",
    "pegs_passed": "Number of pegs that the rod passes at the end on the same side as the pattern, below their tops. Only the part of the rod that \
        belongs to the pattern counts.",
    "pattern_determinant": "Determinant of the knot that is drawn, from the crossings of the pattern or of both patterns, 3 for a trefoil, 9 for a reef knot; empty \
        without a knot.",
    "pattern_signature": "Signature of the knot that is drawn, -2 or 2 for a trefoil, 0 for a reef knot, -4 or 4 for a granny; empty without a \
        knot.",
    "rod_determinant": "Determinant of the knot of the rod at the end, or of both rods with the end of each joined to the start of the other. Empty \
        without a knot, or if it depends on whether ends are joined above or below the table.",
    "rod_signature": "Signature of that knot; empty if the determinant is.",
};
