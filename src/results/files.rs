//! The names of the files in a results directory.

/// What was run, by what, where, when, and how it ended.
pub const MANIFEST: &str = "manifest.json";
/// The resolved scenario, runnable as it stands.
pub const SCENARIO: &str = "scenario.toml";
/// A row per output time.
pub const SERIES: &str = "series.csv";
/// Node positions at each output time.
pub const NODES: &str = "nodes.csv";
/// Node velocities and forces at each output time.
pub const NODE_FORCES: &str = "node_forces.csv";
/// The state in which the run ended.
pub const END_STATE: &str = "end_state.csv";
/// The state from which it started, where it did not start as placed.
pub const START: &str = "start_state.csv";
/// A row per case: outcomes.
pub const SUMMARY: &str = "summary.csv";
/// A row per case: cost.
pub const TIMINGS: &str = "timings.csv";
/// The rods at several times, drawn from the node positions.
pub const RODS_FIGURE: &str = "rods.svg";
/// The series over time, drawn.
pub const SERIES_FIGURE: &str = "series.svg";
/// Outcomes of a sweep over its parameters, drawn.
pub const SWEEP_FIGURE: &str = "sweep.svg";
/// Traction of a knot over its tightness, drawn.
pub const TRACTION_FIGURE: &str = "traction.svg";
/// Points of a path of equilibria.
pub const BRANCH: &str = "branch.csv";
/// Its branches, drawn.
pub const BRANCH_FIGURE: &str = "branch.svg";
/// The interactive page of the rods in motion.
pub const PAGE: &str = "view.html";
/// The ParaView collection.
pub const VTK_COLLECTION: &str = "rods.pvd";
/// Where helical rods lose stability, a row per direction.
pub const BOUNDARY: &str = "boundary.csv";
/// That boundary against theory.
pub const COMPARISON: &str = "comparison.csv";
/// That boundary as a surface for ParaView.
pub const SURFACE: &str = "boundary.vtp";
/// Sections of that boundary, drawn.
pub const SECTION_FIGURES: [&str; 3] = [
    "section_kappa_tau.svg",
    "section_kappa_omega.svg",
    "section_tau_omega.svg",
];
/// Folder of the frames of the collection.
pub const VTK_FOLDER: &str = "vtk";
/// Held locked by the process that writes.
pub(super) const LOCK: &str = ".lock";

/// Where a frame lies in a results directory.
pub(super) fn frame_name(index: usize) -> String {
    format!("{VTK_FOLDER}/rods_{index:06}.vtp")
}

/// Whether a file in the folder of frames is called like one of them.
pub(super) fn is_frame_name(name: &str) -> bool {
    let number = name
        .strip_prefix("rods_")
        .and_then(|rest| rest.strip_suffix(".vtp"));
    number.is_some_and(|number| number.len() >= 6 && number.bytes().all(|b| b.is_ascii_digit()))
}

/// What a run may write: names in a results directory, swept by `--force`.
pub(super) const FILES: [&str; 39] = [
    SCENARIO,
    SERIES,
    NODES,
    NODE_FORCES,
    END_STATE,
    START,
    SUMMARY,
    TIMINGS,
    VTK_COLLECTION,
    RODS_FIGURE,
    SERIES_FIGURE,
    SWEEP_FIGURE,
    TRACTION_FIGURE,
    "rods.png",
    "series.png",
    "sweep.png",
    "traction.png",
    BRANCH,
    BRANCH_FIGURE,
    "branch.png",
    PAGE,
    BOUNDARY,
    COMPARISON,
    SURFACE,
    SECTION_FIGURES[0],
    SECTION_FIGURES[1],
    SECTION_FIGURES[2],
    "section_kappa_tau.png",
    "section_kappa_omega.png",
    "section_tau_omega.png",
    "rods.pdf",
    "series.pdf",
    "sweep.pdf",
    "traction.pdf",
    "branch.pdf",
    "section_kappa_tau.pdf",
    "section_kappa_omega.pdf",
    "section_tau_omega.pdf",
    MANIFEST,
];
