//! What a fold leaves in a results directory, in words.

use crate::results::{Column, ColumnGroup, FileDescription, always, columns, file, table};

/// Name of the figure of a folded sheet.
pub const FOLDED_FIGURE: &str = "folding.svg";

/// Columns of a fold in the common files, and its figure.
pub static FILES: [FileDescription; 4] = [
    table(
        &["series.csv"],
        "The sheet at each output time.",
        &[folded(SERIES)],
    ),
    table(&["summary.csv"], "What a fold came to.", &[folded(SUMMARY)]),
    file(
        &["folding.svg", "folding.png"],
        "The sheet from the side while it is folded, and the way of the gripper. By `rodlab plot`.",
    ),
    table(
        &["folds.csv"],
        "The folds of a plan, in the order in which the gripper passes them. By `rodlab plan fold`. Forces and moments are those of the \
         whole sheet over its bending stiffness EI, as those of `rodlab solve fold` and of samples.csv.",
        &[always(FOLDS)],
    ),
];

const fn folded(columns: &'static [Column]) -> ColumnGroup {
    ColumnGroup {
        when: "where a sheet is folded",
        columns,
    }
}

const SERIES: &[Column] = columns! {
    "sliding_m": "How far the free end of the sheet has come from where it lay, in the direction in which the edge goes, m.",
    "gripper_x_m": "How far the edge has gone in that direction, m.",
    "gripper_z_m": "Height of the edge, m.",
    "gripper_force_n": "Force of the gripper on the whole sheet, N.",
};

const FOLDS: &[Column] = columns! {
    "x_m": "How far the edge has moved towards the sheet, m.",
    "z_m": "Height of the edge above the table, m.",
    "suspended_length_m": "Length of the sheet that does not lie on the table, m.",
    "alpha_rad": "By how much the edge is turned, rad.",
    "lambda": "λ = |H|/|V| at the touchdown point (thesis Eq. 4.6).",
    "friction_demand": "Least coefficient of friction that holds the whole sheet, its lying rest included.",
    "horizontal_force_ei_per_lgb2": "H, which the suspended part exerts on the lying one, in EI/L_gb²; negative: it pushes. The weight of a \
        length L_gb of the sheet is 1/2 in this unit.",
    "vertical_force_ei_per_lgb2": "V, likewise; negative: it presses on the table.",
    "moment_ei_per_lgb": "Moment of the gripper on the edge, in EI/L_gb.",
};

const SUMMARY: &[Column] = columns! {
    "largest_sliding_m": "Farthest that the free end of the sheet has come from where it lay, m.",
    "final_sliding_m": "How far it is from there at the end, in the direction in which the edge goes, m.",
    "fold_length_m": "Length of the sheet from its edge to a crease that is pressed half a crease target back from where the edge is, \
        m; empty where the edge is not down, or no sheet lies below it.",
    "fold_length_error_m": "What that is more than half the crease target, m: the error of the fold.",
    "largest_gripper_force_n": "Largest force of the gripper on the whole sheet, N.",
    "largest_speed_m_s": "Largest speed of a node of the sheet, m/s; far above that of the gripper where the sheet snaps.",
};
