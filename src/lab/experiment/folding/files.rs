//! Descriptions of the files of a fold in a results directory.

use rodlab_files::columns;
use rodlab_files::results::{Column, ColumnGroup, FileDescription, file, table};

/// Name of the figure of a folded sheet.
pub const FOLDED_FIGURE: &str = "folding.svg";

/// Columns of a fold in the common files, and its figure.
pub static FILES: [FileDescription; 3] = [
    table(
        &["series.csv"],
        "The sheet at each output time.",
        &[folded(SERIES)],
    ),
    table(&["summary.csv"], "Outcome of a fold.", &[folded(SUMMARY)]),
    file(
        &["folding.svg", "folding.png"],
        "Side view of the sheet while it is folded, and the path of the gripper. Written by `rodlab plot`.",
    ),
];

const fn folded(columns: &'static [Column]) -> ColumnGroup {
    ColumnGroup {
        when: "where a sheet is folded",
        columns,
    }
}

const SERIES: &[Column] = columns! {
    "sliding_m": "Displacement of the free end of the sheet in the direction in which the edge moves, m.",
    "gripper_x_m": "Displacement of the edge in that direction, m.",
    "gripper_z_m": "Height of the edge, m.",
    "gripper_force_n": "Force of the gripper on the whole sheet, N.",
};

const SUMMARY: &[Column] = columns! {
    "largest_sliding_m": "Largest displacement of the free end of the sheet, m.",
    "final_sliding_m": "Final displacement of the free end, in the direction in which the edge moves, m.",
    "fold_length_m": "Length of the sheet from its edge to the crease, m. The crease is pressed half a crease target behind the edge. Empty if \
        the edge is not down, or if no sheet lies below the crease.",
    "fold_length_error_m": "Error of the fold: its length less half the crease target, m.",
    "largest_gripper_force_n": "Largest force of the gripper on the whole sheet, N.",
    "largest_speed_m_s": "Largest speed of a node of the sheet, m/s; far above that of the gripper if the sheet snaps.",
};
