//! What a deployment leaves in a results directory, in words.

use crate::results::{Column, ColumnGroup, FileDescription, columns, file, table};

/// Name of the figure of a laid rod beside its pattern.
pub const LAID_FIGURE: &str = "deployment.svg";

/// Columns of a deployment in the common files, and its figure.
pub static FILES: [FileDescription; 3] = [
    table(
        &["series.csv"],
        "The rod at each output time, as far as it is laid.",
        &[laid(SERIES)],
    ),
    table(
        &["summary.csv"],
        "What a deployment came to.",
        &[laid(SUMMARY)],
    ),
    file(
        &["deployment.svg", "deployment.png"],
        "The laid rod from above beside its pattern. By `rodlab plot`.",
    ),
];

const fn laid(columns: &'static [Column]) -> ColumnGroup {
    ColumnGroup {
        when: "where a rod is laid along a pattern",
        columns,
    }
}

const SERIES: &[Column] = columns! {
    "laid_m": "Arc length of the pattern, its lead-in included, that the gripper has laid, m.",
    "mean_error_m": "Mean distance of the rod from the pattern at equal arc lengths, as far as it is laid, over 50 points of the \
        whole without its lead-in, m; empty before the first of them, and while a laid rod is tied.",
    "largest_sliding_m": "Farthest that a laid node has come from where it first lay, m.",
    "gripper_force_n": "Force of the gripper on the rod, N.",
};

const SUMMARY: &[Column] = columns! {
    "mean_error_m": "Mean distance of the laid rod from the pattern at equal arc lengths, e_mean of thesis Eq. 5.11 over 50 points, \
        the lead-in left out, m; of a rod that is tied, before its end was led on.",
    "error_deviation_m": "Standard deviation of that distance, m.",
    "largest_error_m": "Largest such distance, m.",
    "largest_sliding_m": "Farthest that a laid node has come from where it first lay, m.",
    "largest_gripper_force_n": "Largest force of the gripper on the rod, N.",
    "largest_friction_demand": "The largest friction that the pattern asks for, 2 L_gb³|κ''| (thesis Eq. 5.2).",
    "share_above_friction": "Part of the pattern that asks for more friction than the table has; there the rod slides.",
    "pegs": "Pegs on the table, two of each clip; empty without any.",
    "pegs_passed": "Pegs that the rod, as far as it belongs to the pattern, passes at the end on the side on which the pattern does, below \
        their tops.",
    "pattern_determinant": "Determinant of the knot that is drawn, by the crossings of the pattern, 3 for a trefoil; empty where none is tied.",
    "rod_determinant": "Determinant of the rod at the end; empty where none is tied, and where it depends on whether the ends are joined above or below the table.",
};
