use super::*;
use crate::experiment::case_set_from_text;
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
    let folder = tempfile::tempdir().unwrap();
    let shape = folder.path().join("curve.csv");
    std::fs::write(&shape, curve).unwrap();
    let scenario = case_set_from_text("wire", scenario, Path::new("")).unwrap();
    let request = Request {
        scenario: &scenario,
        shape: &shape,
        vary,
    };
    let from = Instant::now();
    let found = design(&request);
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
    // Without loads it bends upwards.
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
        // The scenario that is written has the same natural shape and equilibrium.
        let again = case_set_from_text("wire", &found.scenario_toml, Path::new("")).unwrap();
        let loaded = again.scenario_with(&[]).unwrap();
        let run = crate::experiment::prepare(&loaded.scenario).unwrap();
        assert_eq!(run.scenario_toml, found.scenario_toml);
        let folder = tempfile::tempdir().unwrap();
        let files = write(folder.path(), &found).unwrap();
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
    insta::assert_snapshot!(fault(&line, "material.density"), @"--vary material.density: not the natural curvature of a rod; allowed: rods.wire.natural_curvature");
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
        vary: "rods.curl.natural_curvature",
    };
    let from = Instant::now();
    let found = design(&request).unwrap();
    println!("{:.3} s", from.elapsed().as_secs_f64());
    println!("{}", serde_json::to_string_pretty(&found).unwrap());
    assert!(found.distance_over_length < 1e-8);
    assert_eq!(found.unstable_directions, Some(0));
}
