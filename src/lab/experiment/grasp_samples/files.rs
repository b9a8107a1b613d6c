//! Descriptions of the files of samples of optimal grasps in a results directory.

use crate::experiment::data_set::{SAMPLES, SAMPLES_FIGURE};
use rodlab_files::columns;
use rodlab_files::results::{Column, FileDescription, always, file, table};

/// The files of this experiment.
pub static FILES: [FileDescription; 2] = [
    table(
        &[SAMPLES],
        "Optimal grasps (experiment \"grasp-samples\"), a row per point. Lengths are in gravito-bending lengths L_gb, forces in \
     EI/L_gb²; the contact node is the origin, the lying rod comes along x, z is up.",
        &[always(SAMPLE_COLUMNS)],
    ),
    file(
        &[SAMPLES_FIGURE, "samples.png"],
        "Where the grippers of samples.csv are, over the suspended length.",
    ),
];

const SAMPLE_COLUMNS: &[Column] = columns! {
    "suspended_length": "l̄_s, the suspended length.",
    "curvature": "κ̄, the curvature at the contact node times L_gb; positive to the left.",
    "stretch_compliance": "1/k̄_s = EI/(k_s L_gb²); 0 where the rod does not stretch.",
    "log_length": "ln(1 + l̄_s): grasps change most where the rod is short, and a network learns that more easily from this.",
    "outcome": "found, or no_convergence: then the rest of the row is empty.",
    "x": "Place of the gripper.",
    "y": "Place of the gripper.",
    "z": "Place of the gripper.",
    "drop": "l̄_s + (l̄_s²/4 − 0.7 l̄_s)/k̄_s − z: hardly changes where the rod is long.",
    "y_per_curvature": "y/κ̄, also where the pattern is straight: the other side of a bend is its mirror image.",
    "rotation_x": "Axis times angle, in rad, of the rotation from the lying rod's frame (t, ẑ × t, ẑ) to the gripper's.",
    "rotation_y": "Axis times angle, in rad.",
    "rotation_z": "Axis times angle, in rad.",
    "rotation_x_per_curvature": "rotation_x over κ̄, in rad, also where the pattern is straight.",
    "rotation_z_per_curvature": "rotation_z over κ̄, in rad, also where the pattern is straight.",
    "force_y": "Force at the contact node, sideways.",
    "force_z": "Force at the contact node, upwards.",
    "stable": "Whether the hanging rod is stable.",
    "residual": "Residual of the equations.",
};
