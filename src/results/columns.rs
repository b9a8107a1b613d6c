//! What the files of a results directory hold, column by column, in words: `rodlab explain series`.
//!
//! The one place for these words. `tests/explained.rs` runs scenarios of every kind and fails where a file or a
//! column that they write is missing here.

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

macro_rules! columns {
    ($($name:literal: $meaning:literal),* $(,)?) => {
        &[$(Column { name: $name, meaning: $meaning }),*]
    };
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

const SERIES: &[Column] = columns! {
    "time_s": "Simulated time, s; of a path of equilibria, its parameter.",
    "step_s": "Size of the last time step, s; empty where none was taken.",
    "steps": "Accepted time steps since the row before.",
    "newton_iterations": "Mean number of Newton iterations per step, those of repeated steps included.",
    "fluid_iterations": "Mean number of Krylov iterations of the fluid solves per step.",
    "contacts": "Contacts that bear force at the end of the last step; empty where no step was taken.",
    "min_distance_m": "Smallest distance between centrelines that may touch, m, looked for near contact only; empty where \
        none is near. Surfaces touch at the sum of the radii.",
    "kinetic_energy_j": "Kinetic energy, J.",
    "stretching_energy_j": "Elastic energy of stretching, J.",
    "bending_energy_j": "Elastic energy of bending, J.",
    "twisting_energy_j": "Elastic energy of twisting, J.",
    "contact_energy_j": "Potential of the contact forces, J; 0 for rigid contact.",
    "gravitational_energy_j": "Potential of gravity, J, measured from the origin.",
};

const KNOT_SERIES: &[Column] = columns! {
    "end_to_end_m": "Distance of the ends, m; of two rods, of those on the left from those on the right.",
    "shortening_m": "Length of a rod less the distance of the ends, m.",
    "traction_start_n": "Force with which the first end is pulled outwards, N.",
    "traction_end_n": "Force with which the last end is pulled outwards, N.",
    "loop_radius_m": "Radius R of the circle fitted to the loop, the part that is out of contact, m; empty without contact.",
    "force_normalized": "F̄ = F h²/EI with the mean F of the tractions of all ends and the radius h of the rod.",
    "epsilon": "ε = √(h/R), radius of the rod over that of the loop: how tight the knot is; empty without a loop.",
    "length_normalized": "l̄_k = (L − l_c)/h, the shortening over the radius of the rod (thesis Eq. 3.4).",
    "loop_height_m": "Clear height H of the loop of an overhand knot, m: from its middle to the braid, surface to surface; \
        empty without contact.",
    "braid_width_m": "Width W of the knot, m: from end to end of the braid.",
    "height_normalized": "H̄ = H/W.",
    "contact_force_n": "Sum P of all normal forces between the strands, N.",
    "work_of_ends_j": "Work of the clamps at the ends since the start, J.",
    "friction_loss_j": "Energy lost to friction since the start, J.",
    "drag_loss_j": "Energy lost to drag since the start, J.",
    "knot_determinant": "Determinant of the knot, 2n + 1 for an overhand knot of unknotting number n. If it changes, a rod \
        has passed through another, and the run ends with exit code 4. Empty where it cannot be determined.",
    "second_traction_start_n": "Force with which the first end of the second rod is pulled outwards, N; empty with one rod.",
    "second_traction_end_n": "Force with which the last end of the second rod is pulled outwards, N; empty with one rod.",
};

const NODES: &[Column] = columns! {
    "time_s": "Simulated time, s.",
    "rod": "Name of the rod.",
    "node": "Number of the node along the rod, from 0.",
    "x_m": "Position along x, m.",
    "y_m": "Position along y, m.",
    "z_m": "Position along z, m.",
    "theta_rad": "Angle of the material frame from the reference frame on the edge that starts at the node, rad; empty at \
        the last node of an open rod.",
};

const NODE_FORCES: &[Column] = columns! {
    "time_s": "Simulated time, s.",
    "rod": "Name of the rod.",
    "node": "Number of the node along the rod, from 0.",
    "velocity_x_m_per_s": "Velocity along x, m/s.",
    "velocity_y_m_per_s": "Velocity along y, m/s.",
    "velocity_z_m_per_s": "Velocity along z, m/s.",
    "fluid_force_x_n": "Force of the fluid on the node along x, N; 0 without a fluid.",
    "fluid_force_y_n": "Force of the fluid on the node along y, N; 0 without a fluid.",
    "fluid_force_z_n": "Force of the fluid on the node along z, N; 0 without a fluid.",
    "contact_force_x_n": "Contact force on the node along x, friction included, N.",
    "contact_force_y_n": "Contact force on the node along y, friction included, N.",
    "contact_force_z_n": "Contact force on the node along z, friction included, N.",
    "twist_rad_per_m": "Twist per length at the node, rad/m; 0 at free ends.",
};

const SUMMARY: &[Column] = columns! {
    "case": "Id of the case: its values and a short hash; `main` for a single run.",
    "status": "How it ended: finished, or pending, running, interrupted, time-limit (all continue), no-convergence, \
        unphysical, invalid, failed.",
    "simulated_time_s": "Simulated time reached, s.",
    "steps": "Accepted time steps.",
    "retries": "Times that a step was halved before it was accepted.",
    "newton_iterations_mean": "Mean number of Newton iterations per step.",
    "newton_iterations_mean_with_contact": "Mean number of Newton iterations per step with contact; empty where there was none.",
    "fluid_iterations_mean": "Mean number of Krylov iterations of the fluid solves per step.",
    "steps_with_contact": "Steps that ended with contact.",
    "first_contact_s": "End of the first step with contact, s; empty where there was none.",
    "min_distance_m": "Smallest distance between centrelines at the output times, m; empty where none came near.",
    "min_distance_ratio": "That distance over twice the largest radius: below 1 the rods penetrate each other.",
    "elastic_energy_j": "Energy of stretching, bending and twisting at the last output, J.",
    "gravitational_energy_j": "Potential of gravity at the last output, J.",
    "critical_parameter": "Path parameter of the first fold or bifurcation; empty where there is no path, or none on it.",
};

const KNOT_SUMMARY: &[Column] = columns! {
    "may_invert": "Whether an inversion was looked for: in overhand knots of unknotting number 2 and more, and in all of \
        \"knot-inversion\".",
    "inversion_by_force": "l̄_k at which the traction fell most steeply as the knot inverted; empty where it did not.",
    "inversion_by_height": "l̄_k at which the loop had come to lie on the braid; empty where it did not.",
    "inversion_difference": "Difference of the two over their mean.",
    "kinetic_over_elastic": "Largest kinetic over elastic energy at the output times while the ends moved, before the inversion.",
    "kinetic_bound": "What it should not exceed for a quasi-static pull: knot.kinetic_bound.",
    "energy_balance": "Gain of energy and losses to friction and drag, over the work of the ends; 1 where nothing is lost to \
        the time steps.",
    "knot_ending": "Why the run ended before its time: inverted, or locked (the rod stretches instead of slipping); empty \
        where it did not.",
    "length_normalized": "l̄_k at the last output.",
    "traction_n": "Mean traction of the ends at the last output, N.",
};

const TIMINGS: &[Column] = columns! {
    "case": "Id of the case.",
    "wall_time_s": "Time on the clock, all calls that worked on it together, s.",
    "wall_time_with_contact_s": "The part of it that went into steps with contact, s.",
    "cpu_time_s": "Processor time of all threads, s; empty where the system does not report it.",
    "peak_memory_bytes": "Largest resident memory of the process, bytes; of a sweep, the cases of a process share it.",
};

const BRANCH: &[Column] = columns! {
    "branch": "Number of the branch; 0 begins at the start of the path.",
    "parameter": "The path parameter, which stands in the place of time.",
    "parameter_error": "Width of the last bracket around a critical point; 0 at other points.",
    "displacement_rms_m": "Root mean square of the nodes' displacement from where they were placed, m.",
    "elastic_energy_j": "Energy of stretching, bending and twisting, J.",
    "energy_j": "Elastic energy with the potentials of contact and gravity, J; that of other loads is not in it.",
    "negative_pivots": "Negative pivots of the Hessian: independent directions in which the energy falls.",
    "stable": "Whether there are none: true or false.",
    "lowest_eigenvalue_n_per_m": "Lowest eigenvalue of the Hessian, N/m.",
    "kind": "regular, fold (the parameter turns back) or bifurcation (another branch crosses).",
    "newton_iterations": "Newton iterations from the point before.",
};

const BOUNDARY: &[Column] = columns! {
    "part": "surface, or the plane section: kappa_tau (ω = 0), kappa_omega (τ = 0), tau_omega (κ = 0, straight rods).",
    "kappa": "Curvature of the unit direction.",
    "tau": "Torsion of the unit direction.",
    "omega": "Twisting moment of the unit direction.",
    "outcome": "buckles, touches_itself (before it buckles), stable (up to the largest distance), or no_convergence.",
    "critical": "Distance at which the discrete rod loses stability; empty where it does not.",
    "extrapolated": "The same in the limit of a fine mesh, from this mesh and one of half as many edges; empty where it is not asked \
        for or the coarse rod stays stable.",
    "theory": "The same by the conjugate points of the smooth rod; empty where there are none up to 100.",
    "relative_difference": "critical/theory − 1.",
    "relative_difference_extrapolated": "extrapolated/theory − 1.",
    "contact": "Distance at which the rod first touches itself; empty where it does not before it buckles.",
};

const COMPARISON: &[Column] = columns! {
    "quantity": "What is compared with theory: critical or extrapolated of boundary.csv.",
    "from": "Least distance of the band, by theory.",
    "to": "Largest distance of the band, by theory; empty where there is no end.",
    "directions": "Directions for which both have a value.",
    "mean_difference": "Mean of |distance/theory − 1|.",
    "largest_difference": "Largest |distance/theory − 1|.",
    "within_2e_4": "Part of the directions that differ by at most 0.02 %.",
    "within_1e_3": "Part of the directions that differ by at most 0.1 %.",
    "within_5e_3": "Part of the directions that differ by at most 0.5 %.",
};

const SEARCH: &[Column] = columns! {
    "from": "One end of the last interval.",
    "to": "The other end.",
    "evaluations": "Cases that the search took.",
    "failure": "Why it found nothing; empty where it did.",
};

const MANIFEST: &[Column] = columns! {
    "version": "Version of the program.",
    "commit": "Commit of the program, where the build knew it (environment variable RODLAB_COMMIT); else null.",
    "command_line": "The last command line that wrote here.",
    "name": "Short name of the scenario.",
    "experiment": "Its experiment.",
    "title": "Its title.",
    "scenario": "The resolved scenario as TOML, as in scenario.toml.",
    "scenario_hash": "Its BLAKE3 hash, by which the directory is recognised.",
    "rods": "Name, number of nodes, radius (m) of each rod, and whether it is closed.",
    "host": "Name of the machine.",
    "threads": "Threads that the run could use.",
    "start": "When the run was first started.",
    "end": "When it last ended; null while it runs, or where it was killed.",
    "continuations": "Times that the run was continued from a checkpoint.",
    "seeds": "Seeds of random choices by name.",
    "cases": "By id: status, outcome (the numbers of summary.csv), cost (wall_time in s, ...) and error, the reason why it ended \
        early. A single run is the case `main`.",
};

const SLURM: &[Column] = columns! {
    "tasks": "Number of tasks of the job array.",
    "jobs": "Numbers of the jobs, in the order in which they were submitted.",
};

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
