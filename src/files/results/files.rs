//! The names of the files in a results directory.

/// Manifest of a run: scenario, program, machine, times and outcome.
pub const MANIFEST: &str = "manifest.json";
/// The resolved scenario, which can be run again.
pub const SCENARIO: &str = "scenario.toml";
/// A row per output time.
pub const SERIES: &str = "series.csv";
/// Node positions at each output time.
pub const NODES: &str = "nodes.csv";
/// Node velocities and forces at each output time.
pub const NODE_FORCES: &str = "node_forces.csv";
/// Places of contacts.
pub const CONTACTS: &str = "contacts.csv";
/// The final state of the run.
pub const END_STATE: &str = "end_state.csv";
/// The initial state of the run, if it did not start as placed.
pub const START: &str = "start_state.csv";
/// A row per case: outcomes.
pub const SUMMARY: &str = "summary.csv";
/// A row per case: cost.
pub const TIMINGS: &str = "timings.csv";
/// Figure of the rods at several times, drawn from the node positions.
pub const RODS_FIGURE: &str = "rods.svg";
/// Figure of the series over time.
pub const SERIES_FIGURE: &str = "series.svg";
/// Normal forces on the nodes of rods over time.
pub const CONTACTS_FIGURE: &str = "contacts.svg";
/// Figure of the outcomes of a sweep over its parameters.
pub const SWEEP_FIGURE: &str = "sweep.svg";
/// Points of a path of equilibria.
pub const BRANCH: &str = "branch.csv";
/// Drawing of the branches.
pub const BRANCH_FIGURE: &str = "branch.svg";
/// The interactive page of the rods in motion.
pub const PAGE: &str = "view.html";
/// The ParaView collection.
pub const VTK_COLLECTION: &str = "rods.pvd";
/// Folder of the frames of the collection.
pub const VTK_FOLDER: &str = "vtk";
/// Pattern of the frames of obstacles in that folder, as used in marks.
pub(super) const OBSTACLE_FRAMES: &str = "vtk/obstacles";
/// Lock file of the writing process.
pub(super) const LOCK: &str = ".lock";

/// Path of a frame in a results directory.
pub(super) fn frame_name(index: usize) -> String {
    format!("{VTK_FOLDER}/rods_{index:06}.vtp")
}

/// Path of the obstacles of a frame.
pub(super) fn obstacle_frame_name(index: usize) -> String {
    format!("{OBSTACLE_FRAMES}_{index:06}.vtp")
}

/// File names of a series of frames, by the name of its mark; `None` for other files.
pub(super) fn frame_names(marked: &str) -> Option<fn(usize) -> String> {
    match marked {
        VTK_FOLDER => Some(frame_name),
        OBSTACLE_FRAMES => Some(obstacle_frame_name),
        _ => None,
    }
}

/// Whether a file in the folder of frames has the name of a frame.
pub(super) fn is_frame_name(name: &str) -> bool {
    let prefixes = ["rods_", "obstacles_"];
    let rest = prefixes.iter().find_map(|prefix| name.strip_prefix(prefix));
    let number = rest.and_then(|rest| rest.strip_suffix(".vtp"));
    number.is_some_and(|number| number.len() >= 6 && number.bytes().all(|b| b.is_ascii_digit()))
}

/// Names of all files that runs of any kind write; `--force` removes them, the manifest last.
const FILES: [&str; 17] = [
    SCENARIO,
    SERIES,
    NODES,
    NODE_FORCES,
    CONTACTS,
    END_STATE,
    START,
    SUMMARY,
    TIMINGS,
    VTK_COLLECTION,
    RODS_FIGURE,
    SERIES_FIGURE,
    CONTACTS_FIGURE,
    SWEEP_FIGURE,
    BRANCH,
    BRANCH_FIGURE,
    PAGE,
];

/// All possible names of files of a run. `own` lists those of kinds of experiments. A figure may
/// exist in every format.
pub(super) fn files_of_runs(own: &[&str]) -> impl Iterator<Item = String> {
    let names = FILES.iter().chain(own).flat_map(|name| {
        let formats: &[&str] = match name.strip_suffix(".svg") {
            Some(_) => &["svg", "png", "pdf"],
            None => &[],
        };
        let others = formats
            .iter()
            .map(|format| name.replace(".svg", &format!(".{format}")));
        std::iter::once((*name).to_owned())
            .chain(others)
            .collect::<Vec<_>>()
    });
    names
        .chain([MANIFEST.to_owned()])
        .collect::<Vec<_>>()
        .into_iter()
}
