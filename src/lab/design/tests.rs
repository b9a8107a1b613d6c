use super::*;
use crate::experiment::case_set_from_text;
use rodlab_engine::mechanics::dynamics::{IntegrationParameters, Simulation};
use std::f64::consts::PI;
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;

const ROD: &str = r#"experiment = "scene"
material = { youngs_modulus = "10 MPa", poissons_ratio = 0.4, density = 1100.0 }
loads = [{ kind = "gravity", acceleration = [0, 0, -9.81] }]
time = { mode = "static" }
[[rods]]
name = "wire"
radius = "1 mm"
edges = 100
natural_shape = "straight"
director = [0.1, 0.2, 1]
"#;

fn scenario(length: f64, clamps: &str) -> String {
    format!(
        "{ROD}shape = {{ kind = \"straight\", start = [0, 0, 0], end = [{length}, 0, 0] }}\n{clamps}"
    )
}

const START: &str = "[[clamps]]\nrod = \"wire\"\nat = \"start\"\n";
const END: &str = "[[clamps]]\nrod = \"wire\"\nat = \"end\"\n";

fn curve(of: impl Fn(f64) -> [f64; 3]) -> String {
    let mut text = "x_m,y_m,z_m\n".to_owned();
    for k in 0..=80 {
        let [x, y, z] = of(f64::from(k) / 80.0);
        let _ = writeln!(text, "{x:?},{y:?},{z:?}");
    }
    text
}

fn designed(scenario: &str, curve: &str, vary: &str) -> Result<Designed, String> {
    match found(scenario, curve, &[vary])? {
        Design::Shape(designed) => Ok(designed),
        Design::Numbers(_) => panic!("numbers were designed"),
    }
}

fn found(scenario: &str, curve: &str, vary: &[&str]) -> Result<Design, String> {
    let folder = tempfile::tempdir().unwrap();
    let shape = folder.path().join("curve.csv");
    std::fs::write(&shape, curve).unwrap();
    let scenario = case_set_from_text("wire", scenario, Path::new("")).unwrap();
    let vary: Vec<String> = vary.iter().map(|key| (*key).to_owned()).collect();
    let request = Request {
        scenario: &scenario,
        shape: &shape,
        rod: None,
        vary: &vary,
    };
    let from = Instant::now();
    let found = design(&request, &|| true);
    println!("{:.3} s", from.elapsed().as_secs_f64());
    let name = shape.display().to_string();
    found.map_err(|error| error.to_string().replace(&name, "curve.csv"))
}

const KEY: &str = "rods.wire.natural_curvature";

#[test]
fn a_level_beam_needs_the_curvature_of_its_weight() {
    let length = 0.06;
    let text = scenario(length, START);
    let found = designed(&text, &curve(|part| [length * part, 0.0, 0.0]), KEY).unwrap();
    assert!(found.distance_over_length < 1e-8, "{found:?}");
    assert_eq!(found.unstable_directions, Some(0));
    let stiffness = 1e7 * PI / 4.0 * 1e-12;
    let weight = 1100.0 * PI * 1e-6 * 9.81;
    let expected = weight * length * length / (2.0 * stiffness);
    let ratio = found.natural_curvature_per_m / expected;
    assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
    // Without loads the rod bends upwards.
    let tip = found.nodes[2][100];
    assert!(tip.z > 0.005 && tip.y.abs() < 1e-9, "{tip}");
}

#[test]
fn curves_in_space_with_one_and_two_clamps_are_equilibria_of_their_files() {
    let helix = |part: f64| {
        let angle = 7.0 * part;
        [0.03 * angle.cos(), 0.03 * angle.sin(), -0.1 * part]
    };
    let length = (0.21_f64.powi(2) + 0.01).sqrt();
    for clamps in [START.to_owned(), format!("{START}{END}")] {
        let text = scenario(length, &clamps);
        let found = designed(&text, &curve(helix), KEY).unwrap();
        println!(
            "{:.1e} L, {:?}, displaced {:?}",
            found.distance_over_length,
            found.unstable_directions,
            found.distance_from_displaced_start_m
        );
        assert!(found.distance_over_length < 1e-8, "{found:?}");
        assert!(found.distance_from_displaced_start_m.unwrap() < 1e-8 * length);
        // The written scenario has the same natural shape and equilibrium.
        let again = case_set_from_text("wire", &found.scenario_toml, Path::new("")).unwrap();
        let loaded = again.scenario_with(&[]).unwrap();
        let run = crate::experiment::prepare(&loaded.scenario).unwrap();
        assert_eq!(run.scenario_toml, found.scenario_toml);
        let folder = tempfile::tempdir().unwrap();
        let files = write(folder.path(), &Design::Shape(found.clone())).unwrap();
        assert!(files.iter().all(|file| file.is_file()));
        let table = text.replace(
            "natural_shape = \"straight\"",
            &format!(
                "natural_shape = {{ kind = \"strains\", file = {:?} }}",
                folder.path().join(NATURAL).display().to_string()
            ),
        );
        let table = case_set_from_text("wire", &table, Path::new("")).unwrap();
        assert_eq!(
            table.scenario_with(&[]).unwrap().scenario.rods[0].natural_shape,
            loaded.scenario.rods[0].natural_shape
        );
    }
}

#[test]
fn faults_name_the_file_the_row_and_what_is_allowed() {
    let text = scenario(0.15, START);
    let line = curve(|part| [0.15 * part, 0.0, 0.0]);
    let fault = |curve: &str, vary: &str| designed(&text, curve, vary).unwrap_err();
    insta::assert_snapshot!(fault("x_m,y_m,z_m\n0,0,0\n0.1,0,nan\n", KEY), @r#"curve.csv, line 3: "nan" is not a finite number"#);
    insta::assert_snapshot!(fault("x_m,y_m,z_m\n0,0,0\n0.1,0,0\n0.1,0,0\n", KEY), @"curve.csv, line 4: the point repeats the one before it; consecutive points must differ");
    insta::assert_snapshot!(fault("x_m,y_m,z_m\n0,0,0\n", KEY), @"curve.csv has 1 points; a polyline needs at least 2");
    insta::assert_snapshot!(fault("x_m,y_m,z_m\n0,0,0\n0.2,0,0\n", KEY), @"curve.csv: the curve is 0.200000 m long and the rod 0.150000 m (+33.33 %); allowed: a difference of 1 % at most. Change the length of the rod or scale the curve");
    insta::assert_snapshot!(fault(&line, "rods.other.natural_curvature"), @"--vary rods.other.natural_curvature: no such rod; allowed: rods.wire.natural_curvature");
    insta::assert_snapshot!(fault(&line, "clamps.1.pose"), @"--vary clamps.1.pose: no such clamp; allowed: clamps.0.pose");
    for (key, expected) in [("loads.0.kind", "kind"), ("material.densty", "density")] {
        let error = fault(&line, key);
        println!("{error}");
        assert!(error.contains(expected), "{error}");
    }
    let both = found(&text, &line, &[KEY, "clamps.0.pose"]).unwrap_err();
    assert!(both.contains("allowed: this key alone"), "{both}");
    let twice = found(&text, &line, &["clamps.0.offset.1", "clamps.0.pose"]).unwrap_err();
    assert!(twice.contains("is named twice"), "{twice}");
    let free = designed(&scenario(0.15, ""), &line, KEY).unwrap_err();
    assert!(free.contains("not in balance"), "{free}");
}

#[test]
fn the_shipped_curl_hangs_as_wanted() {
    let scenarios = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    let scenario = crate::experiment::case_set(&scenarios.join("curl.toml"), &[], &[]).unwrap();
    let request = Request {
        scenario: &scenario,
        shape: &scenarios.join("curves/curl.csv"),
        rod: None,
        vary: &["rods.curl.natural_curvature".to_owned()],
    };
    let from = Instant::now();
    let Design::Shape(found) = design(&request, &|| true).unwrap() else {
        panic!("numbers were designed");
    };
    println!("{:.3} s", from.elapsed().as_secs_f64());
    println!("{}", serde_json::to_string_pretty(&found).unwrap());
    assert!(found.distance_over_length < 1e-8);
    assert_eq!(found.unstable_directions, Some(0));
}

/// A scenario with fewer edges.
fn coarse(length: f64, tables: &str) -> String {
    scenario(length, tables).replace("edges = 100", "edges = 24")
}

/// The nodes of a scenario in equilibrium, as a curve.
fn shape_of(scenario: &str) -> String {
    let run = crate::test_support::prepared("wire", scenario).unwrap();
    let parameters = IntegrationParameters {
        force_tolerance: 1e-11,
        ..run.integration
    };
    let mut simulation = Simulation::new(&run.scene, &parameters).unwrap();
    simulation.find_equilibrium().unwrap();
    let mut text = "x_m,y_m,z_m\n".to_owned();
    for node in simulation.positions() {
        let _ = writeln!(text, "{:?},{:?},{:?}", node.x, node.y, node.z);
    }
    text
}

/// Fits `vary` of a scenario to the equilibrium of `truth`.
fn numbers(scenario: &str, truth: &str, vary: &[&str]) -> DesignedNumbers {
    let Design::Numbers(found) = found(scenario, &shape_of(truth), vary).unwrap() else {
        panic!("a shape was designed");
    };
    println!("{}", serde_json::to_string_pretty(&found).unwrap());
    found
}

#[test]
fn the_pose_of_a_clamp_is_found_from_the_shape_that_it_gives() {
    let clamps = |pose: &str| format!("{START}{END}{pose}");
    let start = coarse(0.15, &clamps(""));
    let pose = "offset = [-0.03, 0.01, 0.02]\nrotation = [0.6, -0.5, 0.3]\n";
    let found = numbers(&start, &coarse(0.15, &clamps(pose)), &["clamps.1.pose"]);
    assert!(found.met && found.converged, "{found:?}");
    let expected = [-0.03, 0.01, 0.02, 0.6, -0.5, 0.3];
    for (key, expected) in found.keys.iter().zip(expected) {
        assert!((key.value - expected).abs() < 1e-6, "{key:?}");
    }
    // The written scenario has the pose.
    let again = crate::test_support::prepared("wire", &found.scenario_toml).unwrap();
    assert_eq!(again.scenario_toml, found.scenario_toml);
    assert!(again.scene.start.is_some());
}

#[test]
fn a_load_and_a_parameter_are_found_from_the_shape_that_they_give() {
    let text = |force: &str, lift: f64| {
        let load = format!(
            "[[loads]]\nkind = \"force\"\nrod = \"wire\"\nat = \"end\"\nforce = {force}\n[parameters]\nlift = {lift}\n"
        );
        let tables = format!("{START}rotation = [0, \"lift\", 0]\n{load}");
        let listed = "loads = [{ kind = \"gravity\", acceleration = [0, 0, -9.81] }]\n";
        let gravity = "[[loads]]\nkind = \"gravity\"\nacceleration = [0, 0, -9.81]\n";
        coarse(0.15, &format!("{gravity}{tables}")).replace(listed, "")
    };
    let vary = ["loads.1.force", "parameters.lift"];
    let found = numbers(
        &text("[0, 0, 0]", 0.0),
        &text("[3e-4, -5e-4, 6e-4]", -0.4),
        &vary,
    );
    assert!(found.met && found.converged, "{found:?}");
    for (key, expected) in found.keys.iter().zip([3e-4, -5e-4, 6e-4, -0.4]) {
        assert!(
            (key.value - expected).abs() < 1e-5 * expected.abs(),
            "{key:?}"
        );
    }
}

#[test]
fn a_curve_that_cannot_be_met_is_reported_with_its_distance() {
    let wave = |part: f64| [0.147 * part, 0.0, 0.003 * libm::sin(12.0 * part)];
    let text = coarse(0.15, &format!("{START}{END}"));
    let Design::Numbers(found) = found(&text, &curve(wave), &["clamps.1.pose"]).unwrap() else {
        panic!("a shape was designed");
    };
    println!("{}", serde_json::to_string_pretty(&found).unwrap());
    assert!(!found.met && found.converged, "{}", found.distance_m);
    assert!(found.mean_distance_m < 2.0 * found.distance_before_m);
    assert!(
        found
            .remarks
            .iter()
            .any(|one| one.contains("does not meet the curve"))
    );
}
