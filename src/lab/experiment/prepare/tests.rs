//! Names and places become indices; messages name the key of a fault.

use super::*;
use crate::experiment::{case_set, case_set_from_table, from_text};
use crate::scenario::{CaseSet, Loaded};
use crate::sweep::check_every_value;
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::contact::ContactParameters;
use rodlab_engine::mechanics::dynamics::IntegrationParameters;
use std::path::Path;
use std::time::{Duration, Instant};

const TWO_RODS: &str = r#"
experiment = "scene"
material = { youngs_modulus = 1e6, poissons_ratio = 0.5, density = 1000.0 }
time = { end = 1.0 }
[[rods]]
name = "beam"
radius = 0.01
edges = 10
shape = { kind = "straight", start = [0, 0, 0], end = [1, 0, 0] }
[[rods]]
name = "ring"
radius = 0.01
edges = 12
shape = { kind = "ring", centre = [0, 0, 3], radius = 1 }
[[clamps]]
rod = "beam"
at = 10
[[loads]]
kind = "moment"
rod = "beam"
at = "end"
moment = [1, 0, 0]
"#;

fn loaded(text: &str) -> Loaded {
    crate::test_support::loaded("two", text).unwrap_or_else(|error| panic!("{error}"))
}

fn fault(from: &str, to: &str) -> String {
    assert!(TWO_RODS.contains(from));
    let loaded = loaded(&TWO_RODS.replacen(from, to, 1));
    let issues = prepare(&loaded.scenario).unwrap_err();
    loaded.locate(issues).to_string()
}

#[test]
fn names_and_numbers_become_indices() {
    let run = prepare(&loaded(TWO_RODS).scenario).unwrap();
    assert_eq!(run.name, "two");
    assert_eq!(
        run.mode,
        Mode::Dynamic {
            end: 1.0,
            settles: false
        }
    );
    assert_eq!(run.scene.rods[0].centreline.len(), 11);
    assert_eq!(run.scene.rods[1].centreline.len(), 12);
    assert_eq!((run.scene.clamps[0].rod, run.scene.clamps[0].node), (0, 10));
    let mechanics::LoadKind::Moment { edge, .. } = run.scene.loads[0].kind else {
        panic!("{:?}", run.scene.loads[0]);
    };
    assert_eq!(edge, 9);
    let area = std::f64::consts::PI * 1e-4;
    assert!((run.scene.rods[0].mass_per_length / (1000.0 * area) - 1.0).abs() < 1e-15);
    let inertia = 1000.0 * std::f64::consts::PI * 1e-8 / 2.0;
    let got = run.scene.rods[0].rotational_inertia_per_length;
    assert!((got / inertia - 1.0).abs() < 1e-15);
}

#[test]
fn faults_of_the_scene_point_at_their_keys() {
    insta::assert_snapshot!(fault("rod = \"beam\"", "rod = \"beem\""), @"two.toml:16:7: `clamps.0.rod`: no rod is called `beem` (did you mean `beam`?)");
    insta::assert_snapshot!(fault("rod = \"beam\"", "rod = \"x\""), @"two.toml:16:7: `clamps.0.rod`: no rod is called `x` (the rods are: beam, ring)");
    insta::assert_snapshot!(fault("at = 10", "at = 11"), @r#"two.toml:17:6: `clamps.0.at`: rod `beam` has no node 11; allowed: 0 to 10, "start" or "end""#);
    insta::assert_snapshot!(fault("at = \"end\"", "at = 10"), @r#"two.toml:21:6: `loads.0.at`: rod `beam` has no edge 10; allowed: 0 to 9, "start" or "end""#);
    let twice = "[[clamps]]\nrod = \"beam\"\nat = \"end\"\n[[loads]]";
    insta::assert_snapshot!(fault("[[loads]]", twice), @"two.toml:20:6: `clamps.1.at`: another clamp holds this node already");
    let closed = "shape = { kind = \"points\", points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0]] }\nclosed = true";
    let straight =
        "edges = 10\nshape = { kind = \"straight\", start = [0, 0, 0], end = [1, 0, 0] }";
    insta::assert_snapshot!(fault(straight, closed), @"two.toml:8:9: `rods.0.shape`: edge 3 has no length: nodes 3 and 0 lie in the same place");
}

#[test]
fn a_hundred_thousand_edges_within_a_few_diameters_are_refused_before_they_take_memory() {
    let text = TWO_RODS
        .replacen("edges = 10\n", "edges = 100000\n", 1)
        .replacen("at = 10", "at = 0", 1);
    let refused = loaded(&format!("{text}\n[contact]\n"));
    let error = refused
        .locate(prepare(&refused.scenario).unwrap_err())
        .to_string();
    assert!(error.starts_with("two.toml:8:9: `rods.0.edges`"), "{error}");
    assert!(
        error.contains("2.0e8 pairs of edges to check, which take 16.0 GB"),
        "{error}"
    );
    // A knot with a hundred thousand nodes: its check once took minutes.
    let knot = include_str!("../../../../scenarios/trefoil.toml").replace("= 301", "= 100000");
    let refused = loaded(&knot);
    let error = refused.locate(prepare(&refused.scenario).unwrap_err());
    assert!(error.to_string().contains("pairs of edges"), "{error}");
    // With a curve from a file, the scene was still built, which took half a minute.
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../..",
        "/scenarios/three_twist.toml"
    );
    let cases = case_set(Path::new(file), &["rod.nodes=100000".into()], &[]).unwrap();
    let refused = cases.scenario_of(0).unwrap();
    let start = Instant::now();
    let error = refused.locate(prepare(&refused.scenario).unwrap_err());
    assert!(error.to_string().contains("pairs of edges"), "{error}");
    assert!(start.elapsed() < Duration::from_secs(5));
    // Without contact the edges are only long.
    assert!(prepare(&loaded(&text).scenario).is_ok());
}

#[test]
fn the_defaults_of_scenarios_are_those_of_the_engine() {
    let text = format!("{TWO_RODS}\n[contact]\ndistance_tolerance = 1e-5\n");
    let run = prepare(&loaded(&text).scenario).unwrap();
    assert_eq!(run.integration, IntegrationParameters::default());
    // The default of the engine is for a radius of 1 mm.
    let contact = ContactParameters {
        stiffness_factor: 1e6,
        ..ContactParameters::default()
    };
    assert_eq!(run.scene.contact, Some(contact));
}

/// The values of a file as a table in memory give the same cases.
fn assert_same_from_table(path: &Path, of_file: &CaseSet) {
    let table: toml::Table = std::fs::read_to_string(path).unwrap().parse().unwrap();
    let directory = path.parent().unwrap();
    let of_table = case_set_from_table(of_file.name(), table, directory, &[], &[]).unwrap();
    assert_eq!(of_table.count(), of_file.count());
    for index in of_file.probes() {
        let scenario = |cases: &CaseSet| cases.scenario_of(index).unwrap().scenario.to_toml();
        assert_eq!(scenario(&of_table), scenario(of_file), "{}", path.display());
    }
    let toml = |cases: &CaseSet| cases.portable().unwrap().toml;
    assert_eq!(toml(&of_table), toml(of_file));
}

#[test]
fn all_scenarios_of_the_repository_prepare() {
    let directory = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..", "/scenarios"));
    let mut names = Vec::new();
    for entry in std::fs::read_dir(directory).unwrap() {
        let path = entry.unwrap().path();
        // Curves, points, robot cells and a page are in the same folder as the scenarios.
        if path.is_dir() || path.extension().is_none_or(|ending| ending != "toml") {
            continue;
        }
        let case_set = case_set(&path, &[], &[]).unwrap_or_else(|error| panic!("{error}"));
        check_every_value(&case_set).unwrap_or_else(|error| panic!("{error}"));
        assert_same_from_table(&path, &case_set);
        if case_set.search().is_some() {
            continue;
        }
        let loaded = case_set.scenario_of(0).unwrap();
        let run = prepare(&loaded.scenario).unwrap_or_else(|error| panic!("{error}"));
        assert!(run.warnings.is_empty(), "{}: {:?}", run.name, run.warnings);
        let again = from_text(&run.name, &run.scenario_toml, Path::new(""), &[]).unwrap();
        assert_eq!(again.scenario, loaded.scenario, "{}", path.display());
        names.push(run.name);
    }
    for name in [
        "flagella_m2",
        "flagella_m3",
        "flagella_m5",
        "flagella_m10",
        "flagella_quick",
    ] {
        assert!(names.iter().any(|found| found == name), "{name}");
    }
}

#[test]
fn files_of_every_kind_of_experiment_may_give_way_to_a_new_run() {
    let run = prepare(&loaded(TWO_RODS).scenario).unwrap();
    for name in [
        "traction.svg",
        "boundary.csv",
        "boundary.vtp",
        "section_tau_omega.svg",
    ] {
        assert!(run.own_files.contains(&name), "{name}");
    }
}

#[test]
fn a_heavy_soft_rope_that_starts_as_a_catenary_hardly_moves() {
    let text = |shape: &str| {
        format!(
            r#"
experiment = "scene"
material = {{ youngs_modulus = 1e6, poissons_ratio = 0.5, density = 1000.0 }}
time = {{ mode = "static" }}
[[rods]]
name = "rope"
radius = "1 mm"
edges = 60
shape = {{ {shape} }}
natural_shape = "straight"
stiffness = {{ stretching = 1000.0 }}
[[clamps]]
rod = "rope"
at = "start"
hold = "position"
[[clamps]]
rod = "rope"
at = "end"
hold = "position"
[[loads]]
kind = "gravity"
acceleration = [0, 0, -9.81]
"#
        )
    };
    let shape = r#"kind = "catenary", start = [0, 0, 0], end = [1, 0.2, 0.3], length = 1.5"#;
    let run = prepare(&loaded(&text(shape)).scenario).unwrap();
    let mut simulation = Simulation::new(&run.scene, &run.integration).unwrap();
    let start = simulation.positions().to_vec();
    let report = simulation.find_equilibrium().unwrap();
    let moves = simulation
        .positions()
        .iter()
        .zip(&start)
        .map(|(x, y)| (x - y).norm());
    let farthest = moves.fold(0.0, f64::max);
    println!("{farthest} {}", report.newton_iterations);
    // It resists bending by EI/(weight per length · L³) = 8e-6.
    assert!(farthest < 1e-3 && report.newton_iterations <= 8);
}

#[test]
fn a_rod_under_pretension_starts_at_rest_and_pulls_on_its_clamps() {
    for tension in [30.0, -0.2] {
        let text = TWO_RODS
            .replacen(
                "edges = 10",
                &format!("edges = 10\ninertia = \"lumped\"\npretension = {tension:?}"),
                1,
            )
            .replace("[[loads]]", "[[clamps]]\nrod = \"beam\"\nat = 0\n[[loads]]")
            .replace("moment = [1, 0, 0]", "moment = [0, 0, 0]");
        let run = prepare(&loaded(&text).scenario).unwrap();
        let beam = &run.scene.rods[0];
        let stretch = 1.0 + tension / beam.stiffness.stretching;
        let mut simulation = Simulation::new(&run.scene, &run.integration).unwrap();
        for _ in 0..5 {
            simulation.advance(1.0).unwrap();
        }
        for edge in 0..10 {
            let found = simulation.tension(edge).unwrap();
            assert!((found / tension - 1.0).abs() < 1e-9, "{found}");
        }
        // The clamps bear the tension, and nothing has moved.
        for (node, sign) in [(0, -1.0), (10, 1.0)] {
            let force = simulation.reaction(node) - Vector3::x() * (sign * tension);
            assert!(force.norm() < 1e-6 * tension.abs(), "{force}");
        }
        let moved = (simulation.positions().iter().zip(&beam.centreline))
            .fold(0.0, |most: f64, (x, placed)| most.max((x - placed).norm()));
        assert!(moved < 1e-9, "{moved}");
        // Its mass follows from its shorter natural length.
        let masses = simulation.mass_matrix();
        let free = simulation.free_unknowns();
        let diagonal = masses.diagonal();
        let along = free.iter().zip(diagonal.iter());
        let beam_only = along.filter(|(unknown, _)| *unknown % 4 == 0 && **unknown < 44);
        let mass: f64 = beam_only.map(|(_, mass)| mass).sum();
        let expected = 0.9 * beam.mass_per_length / stretch;
        assert!((mass / expected - 1.0).abs() < 1e-9, "{mass} {expected}");
        let from = |place: f64| {
            let more = format!(
                "\n[[actuation]]\nkind = \"twist\"\nrod = \"beam\"\nfrom = {place}\nvalues = [[0, 1]]\n"
            );
            prepare(&loaded(&format!("{text}{more}")).scenario).is_ok()
        };
        // Positions along the rod refer to its natural length.
        assert!(from(0.999 / stretch) && !from(1.001 / stretch));
    }
}

#[test]
fn slack_rods_and_coils_have_exactly_the_length_that_is_stated() {
    let shapes = [
        (
            "slack",
            "start = [0, 0, 0], end = [1, 0.2, 0.3], length = 1.5, towards = [0, 1, 1]",
        ),
        (
            "coil",
            "centre = [0, 0, 9], inner_radius = 0.05, spacing = 0.03, length = 1.5",
        ),
    ];
    for (kind, keys) in shapes {
        let text = TWO_RODS.replace("edges = 10", "edges = 50").replace(
            "kind = \"straight\", start = [0, 0, 0], end = [1, 0, 0]",
            &format!("kind = {kind:?}, {keys}"),
        );
        let run = prepare(&loaded(&text).scenario).unwrap();
        let beam = &run.scene.rods[0];
        assert_eq!(beam.centreline.len(), 51);
        let length: f64 = beam
            .centreline
            .windows(2)
            .map(|x| (x[1] - x[0]).norm())
            .sum();
        assert!((length / 1.5 - 1.0).abs() < 1e-12, "{kind}: {length}");
        // The tangents at the ends are those of the curve, half the turning angle of a node ahead
        // of the edges.
        for (tangent, edge) in beam.end_tangents.iter().zip([0, 49]) {
            let edge = (beam.centreline[edge + 1] - beam.centreline[edge]).normalize();
            let ahead = tangent.unwrap().angle(&edge);
            assert!(ahead > 1e-3 && ahead < 0.35, "{kind}: {ahead}");
        }
    }
}
