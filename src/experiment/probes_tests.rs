//! Probes against what is known of simple scenes, from the scenario file to the tables.

use super::{from_text, prepare};
use crate::mechanics::Vector3;
use crate::results::{BRANCH, NODES, SERIES, SUMMARY, Table, read_nodes};
use crate::run::{PreparedRun, RunError, RunOptions, RunOutcome, StopRequest, run_until};
use std::cell::Cell;
use std::fs;
use std::path::Path;

fn prepared(text: &str) -> Result<PreparedRun, String> {
    let loaded =
        from_text("probes", text, Path::new(""), &[]).map_err(|error| error.to_string())?;
    let prepared = prepare(&loaded.scenario);
    prepared.map_err(|issues| loaded.locate(issues).to_string())
}

fn options(directory: &Path) -> RunOptions {
    RunOptions {
        progress: false,
        ..RunOptions::new(directory)
    }
}

/// The tables of a run.
struct Ran {
    directory: tempfile::TempDir,
    outcome: RunOutcome,
    series: Table,
    summary: Table,
}

fn ran(text: &str) -> Ran {
    let prepared = prepared(text).unwrap_or_else(|error| panic!("{error}"));
    let directory = tempfile::tempdir().unwrap();
    let outcome = run_until(&prepared, &options(directory.path()), &|| None).unwrap();
    Ran {
        series: Table::read(&directory.path().join(SERIES)).unwrap(),
        summary: Table::read(&directory.path().join(SUMMARY)).unwrap(),
        directory,
        outcome,
    }
}

impl Ran {
    /// The value of a column in the last row of the series.
    fn last(&self, column: &str) -> Option<f64> {
        let column = self.series.numbers(column);
        column.expect("such a column").pop().expect("a row")
    }

    fn vector(&self, name: &str, unit: &str) -> Vector3 {
        let component = |axis: &str| self.last(&format!("{name}_{axis}_{unit}")).unwrap();
        Vector3::new(component("x"), component("y"), component("z"))
    }
}

fn near(got: f64, expected: f64, tolerance: f64) {
    assert!(
        (got - expected).abs() <= tolerance * expected.abs(),
        "{got} instead of {expected}"
    );
}

const CANTILEVER: &str = r#"
experiment = "scene"
material = { youngs_modulus = 1e7, poissons_ratio = 0.5, density = 1000.0 }
time = { mode = "static" }
output = { nodes = true }
[[rods]]
name = "beam"
radius = 0.004
edges = 40
shape = { kind = "straight", start = [0, 0, 0], end = [0.3, 0.1, 0] }
[[clamps]]
rod = "beam"
at = "start"
[[loads]]
kind = "gravity"
acceleration = [0, 0, -9.81]
"#;

fn cantilever(probes: &str) -> Ran {
    ran(&format!("{CANTILEVER}{probes}"))
}

fn weight_of(length: f64) -> f64 {
    1000.0 * std::f64::consts::PI * 0.004_f64.powi(2) * length * 9.81
}

#[test]
fn the_reaction_of_a_cantilever_balances_its_weight_and_the_moment_of_it() {
    let run = cantilever(
        r#"
        [[probes]]
        name = "root"
        kind = "reaction"
        at = "start"
        summary = "last"
        [[probes]]
        name = "bending"
        kind = "bending_moment"
        at = "start"
        [[probes]]
        name = "largest"
        kind = "bending_moment"
        [[probes]]
        name = "free"
        kind = "bending_moment"
        at = "end"
        "#,
    );
    let length = 0.1_f64.sqrt();
    let force = run.vector("root_force", "n");
    near(force.z, weight_of(length), 1e-6);
    assert!(force.xy().norm() < 1e-6 * force.z);
    // The clamp bears the moments of all nodes about its own.
    let nodes = read_nodes(run.directory.path(), 41).unwrap();
    let positions = &nodes[0].positions;
    let mut expected = Vector3::zeros();
    for (k, position) in positions.iter().enumerate() {
        let part = if k == 0 || k == 40 { 0.5 } else { 1.0 };
        let load = Vector3::z() * (-part * weight_of(length / 40.0));
        expected -= (position - positions[0]).cross(&load);
    }
    let moment = run.vector("root_moment", "n_m");
    assert!((moment - expected).norm() < 1e-6 * expected.norm());
    // Moment and strain of the discrete rod differ by a quarter of the square of the turning angle.
    near(run.last("bending_n_m").unwrap(), expected.norm(), 2e-3);
    assert_eq!(run.last("largest_n_m"), run.last("bending_n_m"));
    assert_eq!(run.last("free_n_m"), None);
    assert_eq!(
        run.summary.numbers("root_force_z_last_n").unwrap(),
        [Some(force.z)]
    );
    assert!(run.summary.numbers("bending_last_n_m").is_none());
    let highlights = &run.outcome.highlights;
    assert_eq!(highlights.len(), 6);
    assert_eq!(highlights[2].0, "root_force_z_last_n");
}

/// An edge whose both ends are held and a held inner node bear what is left of it.
#[test]
fn the_reactions_of_several_clamps_add_up_to_the_weight() {
    let text = CANTILEVER.replace("at = \"start\"", "at = 12")
        + "[[clamps]]\nrod = \"beam\"\nat = 13\nhold = \"position\"\n"
        + "[[clamps]]\nrod = \"beam\"\nat = \"end\"\n";
    let mut probes = String::new();
    for (name, at) in [("a", "12"), ("b", "13"), ("c", "\"end\"")] {
        probes += &format!("[[probes]]\nname = \"{name}\"\nkind = \"reaction\"\nat = {at}\n");
    }
    let run = ran(&(text + &probes));
    let [a, b, c] = ["a", "b", "c"].map(|name| run.vector(&format!("{name}_force"), "n"));
    near((a + b + c).z, weight_of(0.1_f64.sqrt()), 1e-6);
    assert!((a + b + c).xy().norm() < 1e-6);
    // Balance of moments about the origin.
    let nodes = read_nodes(run.directory.path(), 41).unwrap();
    let positions = &nodes[0].positions;
    let moments = ["a", "b", "c"].map(|name| run.vector(&format!("{name}_moment"), "n_m"));
    let mut sum: Vector3 = moments.iter().sum();
    sum += positions[12].cross(&a) + positions[13].cross(&b) + positions[40].cross(&c);
    let size = moments.iter().map(|moment| moment.norm()).sum::<f64>();
    for (k, position) in positions.iter().enumerate() {
        let part = if k == 0 || k == 40 { 0.5 } else { 1.0 };
        let load = Vector3::z() * (-part * weight_of(0.1_f64.sqrt() / 40.0));
        sum += position.cross(&load);
    }
    assert!(sum.norm() < 1e-6 * size, "{sum:?} of {size}");
}

#[test]
fn a_hanging_rod_bears_the_weight_below_and_grows_longer() {
    let text = CANTILEVER.replace("end = [0.3, 0.1, 0]", "end = [0, 0, -0.4]");
    let run = ran(&(text
        + r#"
        [[probes]]
        name = "top"
        kind = "tension"
        at = "start"
        [[probes]]
        name = "most"
        kind = "tension"
        [[probes]]
        name = "length"
        kind = "arc_length"
        [[probes]]
        name = "ends"
        kind = "distance"
        at = "start"
        to = "end"
        [[probes]]
        name = "tip"
        kind = "displacement"
        at = "end"
        "#));
    // Half of an edge's weight hangs at the clamp itself.
    near(
        run.last("top_n").unwrap(),
        weight_of(0.4) * (1.0 - 1.0 / 80.0),
        1e-6,
    );
    assert_eq!(run.last("most_n"), run.last("top_n"));
    let stiffness = 1e7 * std::f64::consts::PI * 0.004_f64.powi(2);
    let growth = 0.5 * weight_of(0.4) * 0.4 / stiffness;
    near(run.last("length_m").unwrap() - 0.4, growth, 1e-5);
    near(run.last("ends_m").unwrap(), 0.4 + growth, 1e-9);
    near(run.last("tip_z_m").unwrap(), -growth, 1e-5);
}

#[test]
fn curvature_torsion_and_twist_of_known_curves() {
    let bodies = r#"
        experiment = "scene"
        material = { youngs_modulus = 1e7, poissons_ratio = 0.5, density = 1000.0 }
        time = { mode = "static" }
        [[rods]]
        name = "arc"
        radius = 0.001
        edges = 60
        twist = 1.5
        shape = { kind = "arc", start = [0.5, 0, 0], tangent = [0, 1, 0], normal = [0, 0, 1], radius = 0.5, angle = 2.0 }
        [[rods]]
        name = "helix"
        radius = 0.001
        edges = 200
        shape = { kind = "helix", centre = [0, 0, 0], radius = 0.1, pitch = 0.2, turns = 2 }
        [[clamps]]
        rod = "arc"
        at = "start"
        [[clamps]]
        rod = "helix"
        at = "start"
        [[probes]]
        name = "bend"
        kind = "curvature"
        rod = "arc"
        at = 30
        [[probes]]
        name = "screw"
        kind = "torsion"
        rod = "helix"
        at = 100
        [[probes]]
        name = "helix"
        kind = "curvature"
        rod = "helix"
        at = 100
        [[probes]]
        name = "turn"
        kind = "twist"
        rod = "arc"
        at = 30
        [[probes]]
        name = "moment"
        kind = "twisting_moment"
        rod = "arc"
        [[probes]]
        name = "flat"
        kind = "torsion"
        rod = "arc"
        at = "start"
        "#;
    let run = ran(bodies);
    near(run.last("bend_per_m").unwrap(), 2.0, 1e-3);
    let pitch = 0.2 / std::f64::consts::TAU;
    let square = 0.1_f64.powi(2) + pitch * pitch;
    near(run.last("screw_per_m").unwrap(), pitch / square, 1e-3);
    near(run.last("helix_per_m").unwrap(), 0.1 / square, 1e-3);
    // Placed with that twist, and without stress.
    near(run.last("turn_rad_per_m").unwrap(), 1.5, 0.02);
    assert!(run.last("moment_n_m").unwrap().abs() < 1e-12);
    assert_eq!(run.last("flat_per_m"), None);
}

#[test]
fn linked_rings_are_linked_once_and_keep_their_distance() {
    let run = ran(r#"
        experiment = "scene"
        material = { youngs_modulus = 1e7, poissons_ratio = 0.5, density = 1000.0 }
        time = { step = 1e-3, end = 0.01 }
        [[rods]]
        name = "one"
        radius = 0.01
        edges = 40
        shape = { kind = "ring", centre = [0, 0, 0], radius = 1 }
        [[rods]]
        name = "two"
        radius = 0.01
        edges = 40
        velocity = [0.5, 0, 0]
        shape = { kind = "ring", centre = [1, 0, 0], radius = 1, normal = [0, 1, 0] }
        [[probes]]
        name = "link"
        kind = "linking_number"
        rod = "one"
        to_rod = "two"
        [[probes]]
        name = "gap"
        kind = "distance"
        rod = "one"
        to_rod = "two"
        summary = "min"
        [[probes]]
        name = "writhe"
        kind = "writhe"
        rod = "one"
        [[probes]]
        name = "first"
        kind = "energy"
        rod = "one"
        [[probes]]
        name = "second"
        kind = "energy"
        rod = "two"
        [[probes]]
        name = "node"
        kind = "velocity"
        rod = "two"
        at = 3
        "#);
    near(run.last("link").unwrap().abs(), 1.0, 1e-12);
    assert!(run.last("writhe").unwrap().abs() < 1e-9);
    // The second ring moves towards the rim of the first, where it passes near its centre.
    let gaps = run.series.numbers("gap_m").unwrap();
    near(gaps[0].unwrap(), 1.0, 1e-2);
    let least = run.summary.numbers("gap_min_m").unwrap()[0];
    assert_eq!(least, run.last("gap_m"));
    assert!(least < gaps[0].map(|gap| gap - 4e-3));
    for energy in ["kinetic", "stretching", "bending", "twisting"] {
        let of = |name: &str| run.last(&format!("{name}_{energy}_j")).unwrap();
        let total = run.last(&format!("{energy}_energy_j")).unwrap();
        assert!((of("first") + of("second") - total).abs() <= 1e-12 * total.abs() + 1e-15);
    }
    assert!(run.last("first_kinetic_j").unwrap() < 1e-9);
    near(run.last("node_x_m_per_s").unwrap(), 0.5, 1e-6);
}

const RESTING: &str = r#"
experiment = "scene"
material = { youngs_modulus = 1e7, poissons_ratio = 0.5, density = 1000.0 }
time = { step = 2e-3, end = 0.4 }
output = { interval = 0.05 }
[[rods]]
name = "rod"
radius = 0.004
edges = 20
shape = { kind = "straight", start = [0, 0, 0.00402], end = [0.2, 0, 0.00402] }
[[planes]]
[[loads]]
kind = "gravity"
acceleration = [0, 0, -9.81]
[[loads]]
kind = "drag"
translation = 1.0
[contact]
model = "imc"
friction = 0.3
distance_tolerance = 1e-4
"#;

#[test]
fn a_plane_bears_the_weight_of_the_rod_that_lies_on_it() {
    let probes = r#"
        [[probes]]
        name = "floor"
        kind = "contact_force"
        from_plane = 0
        [[probes]]
        name = "all"
        kind = "contact_force"
        "#;
    let run = ran(&format!("{RESTING}{probes}"));
    let weight = weight_of(0.2);
    near(run.last("floor_z_n").unwrap(), weight, 1e-3);
    near(run.last("floor_normal_n").unwrap(), weight, 1e-3);
    assert!(run.last("floor_tangential_n").unwrap() < 1e-6 * weight);
    assert_eq!(run.last("all_z_n"), run.last("floor_z_n"));
    // Nothing is known of forces before the first step.
    assert_eq!(run.series.numbers("floor_z_n").unwrap()[0], None);
}

/// A pushed rod slides with μ times its weight as friction.
#[test]
fn friction_is_the_tangential_force() {
    let text = RESTING
        .replace("edges = 20", "edges = 20\nvelocity = [3.0, 0, 0]")
        .replace("translation = 1.0", "translation = 0.1");
    let run = ran(&(text.replace("end = 0.4", "end = 0.2")
        + "[[probes]]\nname = \"floor\"\nkind = \"contact_force\"\nsummary = \"mean\"\n"));
    let [normal, tangential, x] =
        ["floor_normal_n", "floor_tangential_n", "floor_x_n"].map(|name| run.last(name).unwrap());
    near(tangential, 0.3 * normal, 1e-2);
    near(x, -tangential, 1e-6);
    let mean = run.summary.numbers("floor_normal_mean_n").unwrap()[0];
    let values: Vec<f64> = (run.series.numbers("floor_normal_n").unwrap())
        .into_iter()
        .flatten()
        .collect();
    near(
        mean.unwrap(),
        values.iter().sum::<f64>() / values.len() as f64,
        1e-12,
    );
}

#[test]
fn rods_press_on_each_other_with_opposite_forces() {
    let text = RESTING.replace("[[planes]]\n", "").replace(
        "[[loads]]\nkind = \"drag\"",
        r#"[[rods]]
name = "post"
held = true
radius = 0.004
edges = 5
shape = { kind = "straight", start = [0.1, -0.05, -0.004], end = [0.1, 0.05, -0.004] }
[[clamps]]
rod = "rod"
at = "start"
[[loads]]
kind = "drag""#,
    );
    let probe = |name: &str, rod: &str, from: &str| {
        format!(
            "[[probes]]\nname = \"{name}\"\nkind = \"contact_force\"\nrod = \"{rod}\"\nfrom_rod = \"{from}\"\n"
        )
    };
    let run = ran(&(text
        + &probe("up", "rod", "post")
        + &probe("down", "post", "rod")
        + &probe("own", "rod", "rod")));
    let (up, down) = (run.vector("up", "n"), run.vector("down", "n"));
    assert!(up.z > 0.1 * weight_of(0.2));
    assert!((up + down).norm() < 1e-12 * up.norm());
    assert_eq!(run.last("up_normal_n"), run.last("down_normal_n"));
    assert_eq!(run.last("own_normal_n"), Some(0.0));
}

const FALLING: &str = r#"
[[probes]]
name = "tip"
kind = "position"
at = "end"
summary = "min"
"#;

fn falling(probes: &str) -> String {
    let text = CANTILEVER
        .replace("mode = \"static\"", "step = 2e-3, end = 0.2")
        .replace("nodes = true", "interval = 0.01");
    text + FALLING + probes
}

#[test]
fn a_condition_ends_the_run_at_the_first_output_where_it_holds() {
    let whole = ran(&falling(""));
    let stopped = ran(&falling(
        "[stop_when]\nprobe = \"tip_z_m\"\nbelow = -0.03\n",
    ));
    let heights = |run: &Ran| -> Vec<f64> {
        let column = run.series.numbers("tip_z_m").unwrap();
        column.into_iter().flatten().collect()
    };
    let (all, some) = (heights(&whole), heights(&stopped));
    assert_eq!(all[..some.len()], some);
    assert!(some.len() < all.len());
    let low = some.iter().position(|height| *height < -0.03);
    assert_eq!(low, Some(some.len() - 1));
    let word: Vec<&str> = stopped.summary.column("stopped_by").unwrap().collect();
    assert_eq!(word, ["tip_z_m"]);
    let sentence = stopped.outcome.case.ending.unwrap().sentence;
    assert!(sentence.contains("below -0.03"), "{sentence}");
    assert!(whole.summary.column("stopped_by").is_none());
    let least = stopped.summary.numbers("tip_z_min_m").unwrap()[0];
    assert_eq!(least, some.last().copied());
    let never = ran(&falling("[stop_when]\nprobe = \"tip_z_m\"\nabove = 1.0\n"));
    assert_eq!(heights(&never), all);
    let word: Vec<&str> = never.summary.column("stopped_by").unwrap().collect();
    assert_eq!(word, [""]);
}

fn interrupted_every(calls: usize, prepared: &PreparedRun, directory: &Path) -> usize {
    let mut interruptions = 0;
    loop {
        let asked = Cell::new(0);
        let stop = || (asked.replace(asked.get() + 1) == calls).then_some(StopRequest::Interrupt);
        match run_until(prepared, &options(directory), &stop) {
            Ok(_) => return interruptions,
            Err(RunError::Interrupted { .. }) => interruptions += 1,
            Err(error) => panic!("{error}"),
        }
    }
}

#[test]
fn probes_of_an_interrupted_motion_end_with_the_same_bytes() {
    let text = falling(
        "[[probes]]\nname = \"root\"\nkind = \"reaction\"\nat = \"start\"\nsummary = \"mean\"\n\
         [[probes]]\nname = \"bending\"\nkind = \"bending_moment\"\nsummary = \"max\"\n\
         [stop_when]\nprobe = \"bending\"\nabove = 1.0\n",
    );
    let whole = ran(&text);
    let pieces = tempfile::tempdir().unwrap();
    let count = interrupted_every(11, &prepared(&text).unwrap(), pieces.path());
    assert!(count > 5, "{count}");
    for name in [SERIES, SUMMARY] {
        let read = |directory: &Path| fs::read(directory.join(name)).unwrap();
        assert!(
            read(whole.directory.path()) == read(pieces.path()),
            "{name}"
        );
    }
}

#[test]
fn probes_follow_a_path_of_equilibria_and_can_end_it() {
    let column = include_str!("../../scenarios/euler_column.toml")
        .replace("edges = 100", "edges = 20")
        .replace("step = 0.05", "step = 0.3")
        + "largest_step = 0.3\n[[probes]]\nname = \"middle\"\nkind = \"displacement\"\nat = 10\nsummary = \"max\"\n\
           [[probes]]\nname = \"foot\"\nkind = \"reaction\"\nat = \"start\"\n";
    let whole = ran(&column);
    let parameters = whole.series.numbers("time_s").unwrap();
    assert_eq!(
        whole.series.numbers("middle_x_m").unwrap().len(),
        parameters.len()
    );
    assert!(whole.series.numbers("foot_force_z_n").unwrap()[1].is_some());
    let pieces = tempfile::tempdir().unwrap();
    let count = interrupted_every(7, &prepared(&column).unwrap(), pieces.path());
    assert!(count > 2, "{count}");
    for name in [BRANCH, SERIES, NODES, SUMMARY] {
        let read = |directory: &Path| fs::read(directory.join(name)).ok();
        assert!(
            read(whole.directory.path()) == read(pieces.path()),
            "{name}"
        );
    }
    let mut sizes = whole.series.numbers("foot_force_z_n").unwrap();
    let second = sizes.remove(1).unwrap();
    let side = if second > 0.0 { "above" } else { "below" };
    let limit = 0.5 * second;
    let stopped = ran(&format!(
        "{column}[stop_when]\nprobe = \"foot_force_z_n\"\n{side} = {limit:?}\n"
    ));
    assert_eq!(stopped.series.len(), 2);
    assert_eq!(stopped.outcome.case.ending.unwrap().word, "foot_force_z_n");
}

#[test]
fn resolved_probes_read_back_to_themselves() {
    let text = format!(
        "{RESTING}{}",
        r#"
        [[probes]]
        name = "a"
        kind = "position"
        at = 3
        summary = "last"
        [[probes]]
        name = "b"
        kind = "distance"
        rod = "rod"
        at = "start"
        to = "end"
        [[probes]]
        name = "c"
        kind = "contact_force"
        from_plane = 0
        [[probes]]
        name = "d"
        kind = "twisting_moment"
        [[probes]]
        name = "e"
        kind = "arc_length"
        summary = "mean"
        [stop_when]
        probe = "b"
        above = 3
        "#
    );
    let loaded = from_text("probes", &text, Path::new(""), &[]).unwrap();
    let resolved = loaded.scenario.to_toml();
    let again = from_text("probes", &resolved, Path::new(""), &[]).unwrap();
    assert_eq!(again.scenario, loaded.scenario, "{resolved}");
    assert_eq!(again.scenario.probes.len(), 5);
}

#[test]
fn faults_of_probes_name_their_keys_and_what_is_allowed() {
    let faults = [
        (
            "kind = \"position\"\nat = 0",
            "probes.0`: missing key `name`",
        ),
        (
            "name = \"a b\"\nkind = \"arc_length\"",
            "probes.0.name`: `a b` cannot begin",
        ),
        (
            "name = \"a_\"\nkind = \"arc_length\"",
            "probes.0.name`: `a_` cannot begin",
        ),
        ("name = \"a\"\nkind = \"lenght\"", "probes.0.kind`"),
        (
            "name = \"a\"\nkind = \"arc_length\"\nat = 3",
            "probes.0.at`",
        ),
        (
            "name = \"a\"\nkind = \"position\"",
            "probes.0`: missing key `at`",
        ),
        (
            "name = \"a\"\nkind = \"position\"\nat = 41",
            "probes.0.at`: rod `beam` has no node 41; allowed: 0 to 40",
        ),
        (
            "name = \"a\"\nkind = \"tension\"\nat = 40",
            "probes.0.at`: rod `beam` has no edge 40; allowed: 0 to 39",
        ),
        (
            "name = \"a\"\nkind = \"energy\"\nrod = \"baem\"",
            "probes.0.rod`: no rod is called `baem` (did you mean `beam`?)",
        ),
        (
            "name = \"a\"\nkind = \"reaction\"\nat = 7",
            "probes.0.at`: no clamp holds node 7 of rod `beam`",
        ),
        (
            "name = \"a\"\nkind = \"contact_force\"",
            "probes.0.kind`: there is no contact",
        ),
        (
            "name = \"a\"\nkind = \"distance\"\nat = 0",
            "probes.0`: missing key `to`",
        ),
        (
            "name = \"a\"\nkind = \"distance\"",
            "probes.0`: missing key `to_rod`",
        ),
        (
            "name = \"a\"\nkind = \"distance\"\nto_rod = \"beam\"",
            "probes.0.to_rod`: a rod has no distance from itself",
        ),
        (
            "name = \"a\"\nkind = \"arc_length\"\nsummary = \"first\"",
            "probes.0.summary`",
        ),
        (
            "name = \"min_distance\"\nkind = \"arc_length\"",
            "probes.0.name`: series.csv has a column `min_distance_m` already",
        ),
        (
            "name = \"a\"\nkind = \"arc_length\"\n[[probes]]\nname = \"a\"\nkind = \"writhe\"",
            "probes.1.name`: another probe is called `a`",
        ),
        (
            "name = \"a\"\nkind = \"arc_length\"\n[[probes]]\nname = \"a_m\"\nkind = \"writhe\"",
            "probes.1.name`: series.csv has a column `a_m` already",
        ),
        (
            "name = \"a\"\nkind = \"arc_length\"\n[stop_when]\nprobe = \"b\"\nabove = 1",
            "stop_when.probe`: no probe has a column `b`",
        ),
        (
            "name = \"a\"\nkind = \"arc_length\"\n[stop_when]\nprobe = \"a\"",
            "stop_when`: missing key `above`",
        ),
        (
            "name = \"a\"\nkind = \"arc_length\"\n[stop_when]\nprobe = \"a\"\nabove = 1\nbelow = 0",
            "stop_when.below`: either",
        ),
        (
            "name = \"a\"\nkind = \"position\"\nat = 0\n[stop_when]\nprobe = \"a\"\nabove = 1",
            "stop_when.probe`: this probe has several columns (name one of them: a_x_m, a_y_m, a_z_m)",
        ),
    ];
    for (probe, expected) in faults {
        let text = format!("{CANTILEVER}[[probes]]\n{probe}\n");
        let error = prepared(&text).expect_err(probe);
        assert!(error.contains(expected), "{probe}\n{error}");
    }
    let text = include_str!("../../scenarios/helix_boundary.toml");
    let text = format!("{text}\n[[probes]]\nname = \"a\"\nkind = \"arc_length\"\n");
    let error = prepared(&text).unwrap_err();
    assert!(
        error.contains("`probes`: this experiment fills a table"),
        "{error}"
    );
}
