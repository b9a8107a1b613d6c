//! Descriptions of the files of a results directory, column by column, for `rodlab explain series`.
//!
//! This module describes the files of every run. A kind of experiment describes its own files, and
//! its columns in the common ones, in its own folder. `tests/explained.rs` runs scenarios of every
//! kind and fails if a written file or column is not described.

/// A list of columns, each as `name: meaning`.
#[macro_export]
macro_rules! columns {
    ($($name:literal: $meaning:literal),* $(,)?) => {
        &[$($crate::results::Column { name: $name, meaning: $meaning }),*]
    };
}

mod tables;

use tables::{
    BRANCH, CONTACTS, END_STATE, MANIFEST, NODE_FORCES, NODES, SEARCH, SERIES, SLURM, SUMMARY,
    TIMINGS,
};

/// A column of a table, or a key of a JSON file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Column {
    /// Name of the column in the header, with its unit at the end.
    pub name: &'static str,
    /// Meaning of the column.
    pub meaning: &'static str,
}

/// Columns that appear together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ColumnGroup {
    /// Condition for their presence; empty if they are always present.
    pub when: &'static str,
    /// The columns, in their order in the file.
    pub columns: &'static [Column],
}

/// A file, a folder, or several files of one kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FileDescription {
    /// Names; the first one represents all.
    pub names: &'static [&'static str],
    /// Content, and when it is written.
    pub meaning: &'static str,
    /// Columns or keys; empty if the file is not a table.
    pub groups: &'static [ColumnGroup],
}

impl FileDescription {
    /// All its columns.
    pub fn columns(&self) -> impl Iterator<Item = &'static Column> {
        self.groups.iter().flat_map(|group| group.columns)
    }

    /// Whether a name given as a key refers to this file; tables and JSON files may omit their
    /// extension.
    pub fn is_called(&self, word: &str) -> bool {
        self.names.iter().any(|&name| {
            let stem = name.strip_suffix(".csv").or(name.strip_suffix(".json"));
            word == name || stem == Some(word)
        })
    }
}

/// A table whose columns are always present.
pub const fn table(
    names: &'static [&'static str],
    meaning: &'static str,
    groups: &'static [ColumnGroup],
) -> FileDescription {
    FileDescription {
        names,
        meaning,
        groups,
    }
}

/// A file that is not a table.
pub const fn file(names: &'static [&'static str], meaning: &'static str) -> FileDescription {
    table(names, meaning, &[])
}

/// Columns that are always present.
pub const fn always(columns: &'static [Column]) -> ColumnGroup {
    ColumnGroup { when: "", columns }
}

/// Every file and folder that a results directory may hold.
pub const FILES: &[FileDescription] = &[
    table(
        &["series.csv"],
        "One row per output time. Means are over the steps since the previous row; they are empty in the first row.",
        &[always(SERIES)],
    ),
    table(
        &["nodes.csv"],
        "The position of every node at each output time ([output] nodes = true). A static run has one time, 0.",
        &[always(NODES)],
    ),
    table(
        &["node_forces.csv"],
        "Velocity, forces and twist of every node at each output time ([output] forces = true).",
        &[always(NODE_FORCES)],
    ),
    table(
        &["contacts.csv"],
        "Places at which surfaces press on each other at each output time ([output] contacts = true).",
        &[always(CONTACTS)],
    ),
    table(
        &["end_state.csv", "start_state.csv"],
        "The final state of a finished run, and its initial state ([start] from), one row per node. Another run can start \
         from it.",
        &[always(END_STATE)],
    ),
    table(
        &["summary.csv"],
        "One row per case with its scalar outcomes, the same bytes for any number of threads and on every machine. In a \
         sweep, the columns after `case` are the varied keys, in SI units.",
        &[always(SUMMARY)],
    ),
    table(
        &["timings.csv"],
        "One row per case with its cost, which differs from machine to machine and from run to run.",
        &[always(TIMINGS)],
    ),
    table(
        &["branch.csv"],
        "One row per point of a path of equilibria (time.mode = \"continuation\"), branch after branch.",
        &[always(BRANCH)],
    ),
    table(
        &["search.csv"],
        "Results of searches ([sweep.search]), one row per search. The columns before `from` are the varied keys and, \
         last, the searched key with the value found; empty if there is none.",
        &[always(SEARCH)],
    ),
    table(
        &["manifest.json"],
        "The scenario, program, machine and times of the run, and the outcome of each case.",
        &[always(MANIFEST)],
    ),
    file(
        &["scenario.toml"],
        "The resolved scenario: every key with its value in SI units, defaults included. It can be run unchanged.",
    ),
    file(
        &["cases"],
        "In a sweep: a folder for each case, named by its id, with the files of a single run.",
    ),
    file(
        &["leases"],
        "In a sweep: the process that works on each case. These files are temporary.",
    ),
    file(
        &["checkpoint.0", "checkpoint.1"],
        "The state of an unfinished run, versioned and checksummed. Two files are written in turn, so that one is \
         always complete; a finished run has none.",
    ),
    file(
        &[".lock"],
        "Lock file of the process that writes to the directory. Empty, and harmless if left behind.",
    ),
    file(
        &["rods.pvd"],
        "The collection that ParaView opens ([output] vtk = true): the frames of vtk/ with their times.",
    ),
    file(
        &["vtk"],
        "One frame per output time as VTK PolyData: polylines with radius, velocity, fluid and contact force at the \
         nodes. Obstacles are in files of their own, as numbered triangles; one file if none moves. ParaView's filter \
         \"Tube\" with \"Vary Radius: By Absolute Scalar\" draws the rods with their radii.",
    ),
    file(
        &["rods.svg", "rods.png"],
        "The rods at up to four times, evenly spread over the run. By `rodlab plot`; needs nodes.csv.",
    ),
    file(
        &["series.svg", "series.png"],
        "Energies, contacts, distance and iterations over time. By `rodlab plot`.",
    ),
    file(
        &["sweep.svg", "sweep.png"],
        "Outcomes of a sweep over the varied keys. By `rodlab plot` and `rodlab gather`.",
    ),
    file(
        &["branch.svg", "branch.png"],
        "Displacement and energy over the parameter of a path, stable and unstable. By `rodlab plot`.",
    ),
    file(
        &["own.svg", "own.png"],
        "The figure of columns of your choice. By `rodlab plot --y ...`, unless --out names another file.",
    ),
    file(
        &["view.html"],
        "The results in 3-D: one file for the browser that needs no network. By `rodlab view`; a run of \
         \"helix-stability\" writes it itself.",
    ),
    table(
        &["slurm.json"],
        "The jobs that `rodlab submit` passed to Slurm.",
        &[always(SLURM)],
    ),
    file(&["slurm"], "Output of the Slurm tasks, one file per task."),
];

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn names_are_unique() {
        let names: Vec<&str> = FILES.iter().flat_map(|file| file.names).copied().collect();
        assert_eq!(names.iter().collect::<BTreeSet<_>>().len(), names.len());
        for file in FILES {
            let columns: Vec<&str> = file.columns().map(|column| column.name).collect();
            let different: BTreeSet<&&str> = columns.iter().collect();
            assert_eq!(different.len(), columns.len(), "{:?}", file.names);
        }
    }
}
