//! What the files of a results directory hold, column by column, in words: `rodlab explain series`.
//!
//! The one place for these words. `tests/explained.rs` runs scenarios of every kind and fails where a file or a
//! column that they write is missing here. `tables` has the columns of all runs, `knot` and `helix` those that their
//! experiments add.

/// A list of columns, each as `name: meaning`.
macro_rules! columns {
    ($($name:literal: $meaning:literal),* $(,)?) => {
        &[$(Column { name: $name, meaning: $meaning }),*]
    };
}

mod helix;
mod knot;
mod tables;

use helix::{BOUNDARY, COMPARISON};
use knot::{KNOT_SERIES, KNOT_SUMMARY};
use tables::{BRANCH, MANIFEST, NODE_FORCES, NODES, SEARCH, SERIES, SLURM, SUMMARY, TIMINGS};

/// A column of a table, or a key of a JSON file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Column {
    /// Its name in the header; the ending is the unit.
    pub name: &'static str,
    /// What it holds.
    pub meaning: &'static str,
}

/// Columns that appear together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ColumnGroup {
    /// When they are there; empty for those that always are.
    pub when: &'static str,
    /// The columns, in their order in the file.
    pub columns: &'static [Column],
}

/// A file, a folder, or several of one kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FileDescription {
    /// Names; the first stands for all.
    pub names: &'static [&'static str],
    /// What it holds, and when it is written.
    pub meaning: &'static str,
    /// Its columns or keys; none where it is no table.
    pub groups: &'static [ColumnGroup],
}

/// What a key of `rodlab explain` such as `series.contacts` stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Described<'a> {
    /// A file.
    File(&'static FileDescription),
    /// A column of a file.
    Column(&'static FileDescription, &'static Column),
    /// A file that has no such column.
    NoColumn(&'static FileDescription, &'a str),
}

impl FileDescription {
    /// All its columns.
    pub fn columns(&self) -> impl Iterator<Item = &'static Column> {
        self.groups.iter().flat_map(|group| group.columns)
    }

    /// How it is called in keys: tables and JSON files also without their ending.
    fn calls_itself(&self, word: &str) -> bool {
        self.names.iter().any(|&name| {
            let stem = name.strip_suffix(".csv").or(name.strip_suffix(".json"));
            word == name || stem == Some(word)
        })
    }
}

/// Looks up a file or a column: `series.csv`, `series`, `series.contacts` or `series.csv.contacts`. `None` where the
/// key names no file.
pub fn describe(key: &str) -> Option<Described<'_>> {
    if let Some(file) = FILES.iter().find(|file| file.calls_itself(key)) {
        return Some(Described::File(file));
    }
    // The longest name of a file counts, so that `series.csv.contacts` is no column `csv.contacts`.
    let dots = key.rmatch_indices('.').map(|(place, _)| place);
    for place in dots {
        let (word, column) = (&key[..place], &key[place + 1..]);
        if let Some(file) = FILES.iter().find(|file| file.calls_itself(word)) {
            let found = file.columns().find(|known| known.name == column);
            return Some(match found {
                Some(column) => Described::Column(file, column),
                None => Described::NoColumn(file, column),
            });
        }
    }
    None
}

/// The files that have a column of this name.
pub fn files_with_column(
    name: &str,
) -> impl Iterator<Item = (&'static FileDescription, &'static Column)> {
    FILES.iter().flat_map(move |file| {
        let columns = file.columns().filter(move |column| column.name == name);
        columns.map(move |column| (file, column))
    })
}

/// A file whose columns are always there.
const fn table(
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

const fn file(names: &'static [&'static str], meaning: &'static str) -> FileDescription {
    table(names, meaning, &[])
}

const fn always(columns: &'static [Column]) -> ColumnGroup {
    ColumnGroup { when: "", columns }
}

/// Every file and folder that a results directory may hold.
pub const FILES: &[FileDescription] = &[
    table(
        &["series.csv"],
        "A row per output time. Means are over the steps since the row before; they are empty in the first row.",
        &[
            always(SERIES),
            ColumnGroup {
                when: "where a knot is pulled",
                columns: KNOT_SERIES,
            },
        ],
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
        &["summary.csv"],
        "A row per case with its scalar outcomes, the same bytes on every machine. Of a sweep, the columns after `case` \
         are the varied keys, in SI units.",
        &[
            always(SUMMARY),
            ColumnGroup {
                when: "where a knot is pulled",
                columns: KNOT_SUMMARY,
            },
        ],
    ),
    table(
        &["timings.csv"],
        "A row per case with its cost, which differs from machine to machine and from run to run.",
        &[always(TIMINGS)],
    ),
    table(
        &["branch.csv"],
        "A row per point of a path of equilibria (time.mode = \"continuation\"), branch after branch.",
        &[always(BRANCH)],
    ),
    table(
        &["boundary.csv"],
        "Where clamped helical rods lose stability (experiment \"helix-stability\"), a row per direction of \
         (κ, τ, ω): curvature, torsion, twisting moment. Distances are norms ‖(κ, τ, ω)‖ for a rod of length 1 and \
         bending stiffness 1.",
        &[always(BOUNDARY)],
    ),
    table(
        &["comparison.csv"],
        "boundary.csv against theory, a row per band of distances.",
        &[always(COMPARISON)],
    ),
    table(
        &["search.csv"],
        "What searches found ([sweep.search]), a row per search. The columns before `from` are the varied keys and, \
         last, the searched one, with the value found; it is empty where there is none.",
        &[always(SEARCH)],
    ),
    table(
        &["manifest.json"],
        "What was run, by which program, where and when, and how each case ended.",
        &[always(MANIFEST)],
    ),
    file(
        &["scenario.toml"],
        "The resolved scenario: every key with its value in SI units, defaults included. It runs as it stands.",
    ),
    file(
        &["cases"],
        "Of a sweep: a folder for each case, called by its id, with the files of a single run.",
    ),
    file(
        &["leases"],
        "Of a sweep: which process works on which case. Files here come and go.",
    ),
    file(
        &["checkpoint.0", "checkpoint.1"],
        "The state of an unfinished run, versioned and checksummed. Two files take turns, so that one is always whole; \
         a finished run has none.",
    ),
    file(
        &[".lock"],
        "Locked by the process that writes to the directory. Empty, and harmless when left behind.",
    ),
    file(
        &["rods.pvd"],
        "The collection that ParaView opens ([output] vtk = true): the frames of vtk/ with their times.",
    ),
    file(
        &["vtk"],
        "A frame per output time as VTK PolyData: polylines with radius, velocity, fluid and contact force at the \
         nodes. ParaView's filter \"Tube\" with \"Vary Radius: By Absolute Scalar\" draws the rods as they are.",
    ),
    file(
        &["boundary.vtp"],
        "The boundary of boundary.csv as a surface for ParaView.",
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
        &["traction.svg", "traction.png"],
        "Traction of a knot over its tightness, beside the laws of its theory. By `rodlab plot`.",
    ),
    file(
        &["branch.svg", "branch.png"],
        "Displacement and energy over the parameter of a path, stable and unstable. By `rodlab plot`.",
    ),
    file(
        &[
            "section_kappa_tau.svg",
            "section_kappa_omega.svg",
            "section_tau_omega.svg",
            "section_kappa_tau.png",
            "section_kappa_omega.png",
            "section_tau_omega.png",
        ],
        "Plane sections of the boundary of stable helices, beside theory.",
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
        "The jobs that `rodlab submit` handed to Slurm.",
        &[always(SLURM)],
    ),
    file(&["slurm"], "What the Slurm tasks printed, a file each."),
];

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn files_and_columns_are_found_with_and_without_their_ending() {
        let contacts = |key| match describe(key) {
            Some(Described::Column(file, column)) => (file.names[0], column.name),
            other => panic!("{key}: {other:?}"),
        };
        for key in ["series.contacts", "series.csv.contacts"] {
            assert_eq!(contacts(key), ("series.csv", "contacts"));
        }
        for key in ["series", "series.csv"] {
            assert!(
                matches!(describe(key), Some(Described::File(file)) if file.names == ["series.csv"])
            );
        }
        assert!(matches!(describe("rods.png"), Some(Described::File(_))));
        assert!(matches!(
            describe("series.contact"),
            Some(Described::NoColumn(_, "contact"))
        ));
        assert_eq!(describe("rods"), None);
        assert_eq!(describe("contact.friction"), None);
        assert_eq!(files_with_column("first_contact_s").count(), 1);
    }

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
