//! Imports run in one direction: every room (a top-level module or crate) imports only the rooms
//! that the plan allows, and no files inside a room import each other in a circle. The compiler
//! checks this between crates; these tests check it within crates.

mod source;

use source::{ItemPath, Source, exports, imports, plain, sources, test_items};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;
use std::process::Command;

/// Files and folders at the top level of the repository.
const TOP_LEVEL: &[&str] = &[
    ".ci",
    ".gitignore",
    "CHANGELOG.md",
    "CITATION.cff",
    "CONTRIBUTING.md",
    "Cargo.lock",
    "Cargo.toml",
    "LICENSE-APACHE",
    "LICENSE-MIT",
    "README.md",
    "clippy.toml",
    "proptest-regressions",
    "pyproject.toml",
    "results",
    "scenarios",
    "scripts",
    "src",
    "tests",
];

/// A table of rooms and the rooms that each may import. A room may also import the rooms that
/// those may import.
type Table = &'static [(&'static str, &'static [&'static str])];

/// Rooms. The documentation of the program shows the same table.
const ROOMS: Table = &[
    ("python", &["cli"]),
    (
        "cli",
        &[
            "sweep",
            "identify",
            "sensitivity",
            "design",
            "verify",
            "reproduce",
            "task",
            "live",
            "recording",
            "virtual_cell",
            "guide",
            "presets",
            "site",
            "cluster",
        ],
    ),
    ("sweep", &["sensitivity"]),
    ("identify", &["sensitivity"]),
    ("verify", &["sensitivity"]),
    ("sensitivity", &["experiment"]),
    ("design", &["identify"]),
    ("reproduce", &["report", "task", "virtual_cell"]),
    ("report", &["experiment"]),
    ("experiment", &["run", "knot", "plan", "scenario", "figure"]),
    ("run", &["mechanics", "results"]),
    ("knot", &["mechanics"]),
    ("plan", &["mechanics", "learn"]),
    ("learn", &["results", "figure"]),
    ("mechanics", &["linalg"]),
    ("task", &["virtual_cell", "report", "identify"]),
    ("virtual_cell", &["cell", "experiment"]),
    ("cell", &["robot", "vision", "scenario", "figure"]),
    ("robot", &["mesh"]),
    ("vision", &["figure"]),
    ("scenario", &["mesh", "random"]),
    ("mesh", &["finite", "input"]),
    ("results", &["finite", "input", "origin"]),
    ("figure", &["finite", "input", "origin"]),
    ("finite", &[]),
    ("origin", &[]),
    ("input", &[]),
    ("cluster", &[]),
    ("live", &["task"]),
    ("recording", &["cell"]),
    ("guide", &[]),
    ("presets", &[]),
    ("site", &["guide", "results", "figure"]),
    ("linalg", &["random"]),
    ("random", &[]),
];

/// Parts of `experiment`. The kinds of experiments are independent of each other.
const EXPERIMENT: Table = &[
    ("derived", &["kind", "flow_guard"]),
    ("described", &["kind"]),
    ("prepare", &["kind", "parts", "probes", "flow_guard"]),
    ("flow_guard", &[]),
    ("parts", &["places"]),
    ("places", &[]),
    ("probes", &["places"]),
    ("scene", &["kind"]),
    ("flagella", &["kind", "prepare"]),
    ("knot", &["kind", "prepare"]),
    ("helix", &["data_set"]),
    ("deployment", &["kind", "prepare", "on_table"]),
    ("folding", &["kind", "prepare", "on_table"]),
    ("on_table", &[]),
    ("data_set", &["kind"]),
    ("grasp_samples", &["data_set"]),
    ("fold_samples", &["data_set"]),
    ("kind", &[]),
];

/// Rooms inside `mechanics`.
const MECHANICS: Table = &[
    ("rod", &[]),
    ("contact", &["rigid_body", "rotation"]),
    ("fluid", &["piecewise"]),
    ("error", &["rod", "fluid"]),
    ("kirchhoff", &[]),
    ("rigid_body", &[]),
    ("rotation", &[]),
    ("piecewise", &["rotation"]),
    ("scene", &["contact", "fluid", "piecewise", "rigid_body"]),
    ("system", &["rod", "contact", "error", "scene", "rotation"]),
    ("statics", &["rod", "system"]),
    (
        "dynamics",
        &[
            "rod", "contact", "fluid", "error", "scene", "system", "statics",
        ],
    ),
];

fn crate_sources() -> Vec<Source> {
    sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"))
}

/// Everything that a room may import: the rooms of its line, and the rooms of their lines.
fn reachable(table: Table, room: &str) -> BTreeSet<&'static str> {
    let mut found = BTreeSet::new();
    let mut next: Vec<&str> = vec![room];
    while let Some(room) = next.pop() {
        let line = table.iter().find(|(name, _)| *name == room);
        for other in line.into_iter().flat_map(|(_, others)| *others) {
            if found.insert(*other) {
                next.push(other);
            }
        }
    }
    found
}

/// Checks imports against a table of the rooms below the module `above`. A room that is not in the
/// table is a fault, too.
fn faults(sources: &[Source], above: &[&str], table: Table) -> Vec<String> {
    let below = |path: &ItemPath| -> Option<String> {
        let names = path.iter().zip(above);
        (path.len() > above.len() && names.clone().count() == above.len())
            .then(|| names.clone().all(|(name, other)| name == other))
            .filter(|same| *same)
            .map(|_| path[above.len()].clone())
    };
    let modules = by_module(sources);
    let mut faults = BTreeSet::new();
    for source in sources {
        let Some(room) = below(&source.module) else {
            continue;
        };
        if !table.iter().any(|(name, _)| *name == room) {
            faults.insert(format!("{room} is not in the plan"));
            continue;
        }
        let allowed = reachable(table, &room);
        for import in &source.imports {
            let Some(other) = below(&origin(import, &modules)) else {
                continue;
            };
            let is_room = table.iter().any(|(name, _)| *name == other);
            if is_room && other != room && !allowed.contains(other.as_str()) {
                faults.insert(format!("{} imports {other}", source.file.display()));
            }
        }
    }
    faults.into_iter().collect()
}

#[test]
fn rooms_import_only_what_the_plan_allows() {
    let faults = faults(&crate_sources(), &[], ROOMS);
    assert!(faults.is_empty(), "{faults:#?}");
}

#[test]
fn rooms_of_mechanics_import_only_what_the_plan_allows() {
    let faults = faults(&crate_sources(), &["mechanics"], MECHANICS);
    assert!(faults.is_empty(), "{faults:#?}");
}

#[test]
fn kinds_of_experiments_are_independent_of_each_other() {
    let faults = faults(&crate_sources(), &["experiment"], EXPERIMENT);
    assert!(faults.is_empty(), "{faults:#?}");
}

/// Circles of files and folders within one folder, from the graph of the imports there. A
/// subfolder counts as one node.
fn circles(sources: &[Source]) -> Vec<String> {
    let modules = by_module(sources);
    let mut folders: BTreeMap<ItemPath, BTreeMap<String, BTreeSet<String>>> = BTreeMap::new();
    for source in sources {
        for import in &source.imports {
            let import = origin(import, &modules);
            // The folder in which both paths diverge. The paths of a parent and its child do not
            // diverge.
            let pairs = source.module.iter().zip(&import);
            let shared = pairs.take_while(|(one, other)| one == other).count();
            let (Some(from), Some(to)) = (source.module.get(shared), import.get(shared)) else {
                continue;
            };
            if modules.contains_key(&import[..=shared]) {
                let folder = folders.entry(import[..shared].to_vec()).or_default();
                folder.entry(from.clone()).or_default().insert(to.clone());
            }
        }
    }
    let mut circles = Vec::new();
    for (folder, graph) in &folders {
        let mut known = BTreeSet::new();
        for start in graph.keys() {
            let circle: Vec<&str> = reached(graph, start)
                .into_iter()
                .filter(|other| reached(graph, other).contains(start))
                .map(String::as_str)
                .collect();
            if !circle.is_empty() && known.insert(circle.clone()) {
                circles.push(format!("{}: {}", folder.join("::"), circle.join(", ")));
            }
        }
    }
    circles
}

/// Everything that can be reached along arrows from `start`.
fn reached<'a>(
    graph: &'a BTreeMap<String, BTreeSet<String>>,
    start: &'a String,
) -> BTreeSet<&'a String> {
    let mut reached = BTreeSet::new();
    let mut next = vec![start];
    while let Some(module) = next.pop() {
        let imported = graph.get(module).into_iter().flatten();
        next.extend(imported.filter(|other| reached.insert(*other)));
    }
    reached
}

fn by_module(sources: &[Source]) -> BTreeMap<&[String], &Source> {
    let modules = sources.iter();
    modules
        .map(|source| (source.module.as_slice(), source))
        .collect()
}

/// The final target of a path, after the re-exports of the modules on it.
fn origin(path: &[String], modules: &BTreeMap<&[String], &Source>) -> ItemPath {
    let mut path = path.to_vec();
    // A path with more re-exports than there are modules is a circle.
    for _ in modules {
        let depth = (0..path.len())
            .rev()
            .find(|depth| modules.contains_key(&path[..*depth]));
        let Some(depth) = depth.filter(|depth| !modules.contains_key(&path[..=*depth])) else {
            break;
        };
        let exports = &modules[&path[..depth]].exports;
        let Some(export) = exports
            .iter()
            .find(|export| export.last() == path.get(depth))
        else {
            break;
        };
        let names = export.iter().chain(&path[depth + 1..]);
        let next = names.cloned().collect();
        if next == path {
            break;
        }
        path = next;
    }
    path
}

/// A parent and its child may import each other, but files in the same folder must not form a
/// circle.
#[test]
fn no_files_import_each_other_in_a_circle() {
    let circles = circles(&crate_sources());
    assert!(circles.is_empty(), "in circles: {circles:#?}");
}

/// Results of a trial run are easily added by mistake.
#[test]
fn the_top_level_contains_what_is_planned() {
    let listed = Command::new("git")
        .args(["ls-files", "-z"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output();
    let Some(listed) = listed.ok().filter(|listed| listed.status.success()) else {
        return crate::parts::skipped("files of the top level: this is not a Git repository");
    };
    let listed = String::from_utf8(listed.stdout).expect("paths in UTF-8");
    let paths = listed.split('\0').filter(|path| !path.is_empty());
    let present: BTreeSet<&str> = paths.filter_map(|path| path.split('/').next()).collect();
    let planned: BTreeSet<&str> = TOP_LEVEL.iter().copied().collect();
    assert_eq!(present, planned);
}

/// A file that no other file names is not compiled, so that its tests would silently be lost.
#[test]
fn every_file_of_tests_is_part_of_the_one_binary() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    let main = fs::read_to_string(folder.join("main.rs")).expect("the root of the tests");
    let named: BTreeSet<String> = main
        .lines()
        .filter_map(|line| line.strip_prefix("mod ")?.strip_suffix(';'))
        .map(str::to_owned)
        .collect();
    let mut present = BTreeSet::new();
    for entry in fs::read_dir(&folder).expect("the folder of the tests") {
        let path = entry.expect("an entry").path();
        let name = path.file_stem().expect("a name").to_string_lossy();
        let is_module = path.is_file() || path.join("mod.rs").is_file();
        if is_module && name != "main" {
            present.insert(name.into_owned());
        }
    }
    assert_eq!(named, present);
}

/// The table in the documentation of the crate has lines such as `sweep, verify ──> experiment`.
#[test]
fn the_documentation_of_the_crate_shows_the_plan() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/lib.rs");
    let text = fs::read_to_string(file).expect("the root of the crate");
    let names = |list: &str| -> Vec<String> {
        let names = list.split(',').map(|name| name.trim().to_owned());
        names.collect()
    };
    let mut shown: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for line in text.lines().filter_map(|line| line.strip_prefix("//! ")) {
        if let Some((rooms, others)) = line.split_once("──>") {
            for room in names(rooms) {
                shown.entry(room).or_default().extend(names(others));
            }
        }
    }
    let planned: BTreeMap<String, BTreeSet<String>> = ROOMS
        .iter()
        .filter(|(_, others)| !others.is_empty())
        .map(|(room, others)| {
            let others = others.iter().map(|other| (*other).to_owned());
            ((*room).to_owned(), others.collect())
        })
        .collect();
    assert_eq!(shown, planned);
}

#[test]
fn full_paths_are_found_in_all_positions() {
    let module: Vec<String> = ["mechanics", "rod"].map(str::to_owned).into();
    let paths = |code: &str| -> Vec<String> {
        let found = imports(&plain(code), &module);
        found.iter().map(|path| path.join("::")).collect()
    };
    assert_eq!(
        paths(
            "use crate::mechanics::{Vector3 as V, contact::{A, B}, fluid};\nuse crate::linalg::X;"
        ),
        [
            "mechanics::Vector3",
            "mechanics::contact::A",
            "mechanics::contact::B",
            "mechanics::fluid",
            "linalg::X"
        ]
    );
    assert_eq!(
        paths("use super::super::run::R; let a: super::fluid::F = self::edge::E::new();"),
        [
            "run::R",
            "mechanics::fluid::F",
            "mechanics::rod::edge::E::new"
        ]
    );
    // A room inside another crate, and a crate that is a room itself.
    assert_eq!(
        paths("use rodlab_files::results::{A, B}; let c: rodlab_robot::Chain;"),
        ["results::A", "results::B", "robot::Chain"]
    );
    let room: ItemPath = vec!["robot".into(), "stream".into()];
    assert_eq!(
        imports("use crate::chain::C;", &room)[0].join("::"),
        "robot::chain::C"
    );
    // Comments and string literals import nothing; a lifetime does not open a character literal.
    assert_eq!(
        paths(
            "// crate::a::B\nlet t: &'static str = \"crate::c::\\\"D\"; let c = '\"'; let e = crate::e::E;"
        ),
        ["e::E"]
    );
    assert!(paths("let t = r#\"crate::a::\"B\"#;").is_empty());
}

#[test]
fn code_after_a_test_is_read() {
    let code = "fn a() {}\n#[cfg(test)]\nmod tests {\n use crate::cli::X;\n fn b() { if c { d() } }\n}\n\
                use crate::run::Y;\n#[cfg(test)]\nmod others;\nimpl Z { #[cfg(test)]\n fn e(&self) -> [u8; 2] { f() }\n \
                fn g() { crate::knot::H } }";
    let (kept, modules) = test_items(code);
    assert_eq!(modules, ["tests", "others"]);
    let paths: Vec<String> = imports(&kept, &[])
        .iter()
        .map(|path| path.join("::"))
        .collect();
    assert_eq!(paths, ["run::Y", "knot::H"]);
}

#[test]
fn circles_are_found_between_files_and_folders_and_through_reexports() {
    let source = |module: &str, code: &str| {
        let module: ItemPath = module.split("::").map(str::to_owned).collect();
        Source {
            file: module.iter().collect(),
            imports: imports(code, &module),
            exports: exports(code, &module),
            module,
        }
    };
    let found = |other: [&str; 2]| {
        circles(&[
            source("room", "pub use a::{A, f}; pub(crate) use b::part::B;"),
            source("room::a", "use super::b::part::B; use crate::room::Room;"),
            source("room::b", "pub use part::B; use std::fs;"),
            source("room::b::part", "use super::super::Room; use super::X;"),
            source(other[0], other[1]),
        ])
    };
    // A parent and its children may import each other.
    assert!(found(["room::c", "use super::A; use super::B;"]).is_empty());
    for import in [
        "crate::room::a::A",
        "super::super::{X, A}",
        "super::super::f",
    ] {
        let code = format!("use {import};");
        assert_eq!(found(["room::b::other", &code]), ["room: a, b"], "{import}");
    }
    let three = found([
        "room::a::c",
        "use crate::other::X; use crate::room::B as Other;",
    ]);
    assert!(three.is_empty(), "{three:?}");
}
