//! Descriptions of the files of a deployment in a results directory.

use rodlab_files::columns;
use rodlab_files::results::{Column, ColumnGroup, FileDescription, file, table};

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
        "Outcome of a deployment.",
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
    "laid_m": "Arc length of the pattern, its lead-in included, that the gripper has laid, m; of two rods that of both.",
    "mean_error_m": "Mean distance of the rod from the pattern at equal arc lengths, as far as it is laid, over 50 points of the \
        whole (of each of two rods) without its lead-in, m; empty before the first of them, and while a laid rod is tied.",
    "largest_sliding_m": "Largest displacement of a laid node from where it was first laid, m.",
    "gripper_force_n": "Force of the gripper on the rod that it lays, N; of two rods the larger one.",
};

const SUMMARY: &[Column] = columns! {
    "mean_error_m": "Mean distance of the laid rod from the pattern at equal arc lengths, e_mean of thesis Eq. 5.11 over 50 points \
        (of each of two rods), the lead-in left out, m; of a rod that is tied, before its end was led on.",
    "error_deviation_m": "Standard deviation of that distance, m.",
    "largest_error_m": "Largest such distance, m.",
    "largest_sliding_m": "Largest displacement of a laid node from where it was first laid, m.",
    "largest_gripper_force_n": "Largest force of the gripper on the rod, N.",
    "largest_friction_demand": "The largest friction that the pattern asks for: of the lying rod 2 L_gb³|κ''| (thesis Eq. 5.2), at the contact \
        node |n_y + κ̄'|/|n_z| of the optimal grasp; of the scheme \"intuitive\" that of the lying rod alone.",
    "share_above_friction": "Part of the pattern that demands more friction than the table has; there the rod slides.",
    "pegs": "Pegs on the table, two of each clip; empty without any.",
    "pegs_passed": "Pegs that the rod, as far as it belongs to the pattern, passes at the end on the side on which the pattern does, below \
        their tops.",
    "pattern_determinant": "Determinant of the knot that is drawn, by the crossings of the pattern or of both, 3 for a trefoil, 9 for a reef knot; empty \
        where none is tied.",
    "pattern_signature": "Signature of the knot that is drawn, -2 or 2 for a trefoil, 0 for a reef knot, -4 or 4 for a granny; empty where none is \
        tied.",
    "rod_determinant": "Determinant of the knot of the rod at the end, or of both rods, the end of each joined to the start of the other; empty where \
        none is tied, and where it depends on whether ends are joined above or below the table.",
    "rod_signature": "Signature of that knot; empty as the determinant is.",
};
