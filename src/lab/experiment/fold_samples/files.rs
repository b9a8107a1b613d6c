//! Descriptions of the files of samples of folds in a results directory.

use crate::experiment::data_set::{SAMPLES, SAMPLES_FIGURE};
use rodlab_files::columns;
use rodlab_files::results::{Column, FileDescription, always, file, table};

/// The files of this experiment.
pub static FILES: [FileDescription; 2] = [
    table(
        &[SAMPLES],
        "Folds of a sheet that is held at its edge without a moment (experiment \"fold-samples\"), a row per position of the gripper. \
     Lengths are in gravito-bending lengths L_gb, forces in EI/L_gb².",
        &[always(SAMPLE_COLUMNS)],
    ),
    file(
        &[SAMPLES_FIGURE, "samples.png"],
        "Positions of the gripper in samples.csv, with the workspace and the penalty region.",
    ),
];

const SAMPLE_COLUMNS: &[Column] = columns! {
    "x": "x̄: displacement of the edge towards the sheet.",
    "z": "z̄: height of the edge above the table.",
    "outcome": "found, or out_of_reach: then the rest of the row is empty.",
    "lambda": "λ = |H|/|V| at the touchdown point.",
    "alpha": "α: angle by which the edge is turned, rad.",
    "suspended_length": "l̄_s, the suspended length.",
    "force_inclination": "arctan(H/|V|), in rad: positive if the sheet is pulled, negative if it is pushed. λ is the magnitude of its \
     tangent. A network learns this angle more easily than λ, which has a kink at 0 and is large for a short or taut sheet.",
    "horizontal_force": "H, horizontal force of the suspended part on the part that lies on the table.",
    "vertical_force": "V, vertical force on that part; negative if it presses on the table.",
    "penalty": "Whether the suspended length is below fold_samples.least_suspended_length.",
};
