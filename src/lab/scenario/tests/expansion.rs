//! Parameters, expressions and copies of tables in whole files.

use super::{BEAM, EXPERIMENTS, read_with};
use crate::scenario::{CaseSet, Copied, Scenario, Shape, from_text};
use std::path::Path;

/// Reads the scenario of a text with overrides; faults as lines.
fn read(text: &str, set: &[&str]) -> Result<Scenario, String> {
    let set: Vec<String> = set.iter().map(|&text| text.to_owned()).collect();
    read_with("scene", text, &set).map_err(|error| error.to_string())
}

/// The beam with another text in one place and parameters before its rods.
fn beam(from: &str, to: &str, parameters: &str) -> String {
    assert!(BEAM.contains(from), "{from}");
    let text = BEAM.replacen(from, to, 1);
    text.replacen(
        "[[rods]]",
        &format!("[parameters]\n{parameters}\n\n[[rods]]"),
        1,
    )
}

#[test]
fn a_scene_whose_rods_are_all_counted_zero_names_the_count() {
    let named = "name = \"beam\"";
    assert!(BEAM.contains(named));
    let text = BEAM.replacen(named, "count = 0\nname = \"beam\"", 1);
    let text = text
        .split_once("[[clamps]]")
        .map_or(&*text, |(rods, _)| rods);
    let error = read(text, &[]).unwrap_err();
    assert!(error.contains("count = 0 make none"), "{error}");
}

fn fault(from: &str, to: &str, parameters: &str) -> String {
    read(&beam(from, to, parameters), &[]).unwrap_err()
}

const RADIUS: &str = "radius = \"5 mm\"";

#[test]
fn numbers_are_expressions_of_parameters() {
    let parameters = "n = \"2*half_n\"\nhalf_n = 6\nthickness = \"8 mm\"\nslope = 0.5";
    let text = beam(RADIUS, "radius = \"thickness/2 + 1 mm\"", parameters)
        .replace("edges = 50", "edges = \"n + 1\"")
        .replace(
            "end = [1, 0, 0]",
            "end = [\"1 m\", \"slope\", \"cos(90 deg)\"]",
        );
    let scenario = read(&text, &[]).unwrap();
    assert_eq!(scenario.rods[0].radius, 0.005);
    assert_eq!(scenario.rods[0].edges, 13);
    let end = [1.0, 0.5, libm::cos(90.0 * (std::f64::consts::PI / 180.0))];
    let start = [0.0; 3];
    assert_eq!(scenario.rods[0].shape, Shape::Straight { start, end });
    let scenario = read(&text, &["parameters.thickness=4mm", "parameters.half_n=3"]).unwrap();
    assert_eq!(scenario.rods[0].radius, 0.003);
    assert_eq!(scenario.rods[0].edges, 7);
}

#[test]
fn numbers_with_units_are_what_they_were() {
    let plain = read(BEAM, &[]).unwrap();
    let with_parameters = read(&beam(RADIUS, RADIUS, "radius = 1"), &[]).unwrap();
    assert_eq!(plain.to_toml(), with_parameters.to_toml());
    let as_expression = read(&beam(RADIUS, "radius = \"1*5 mm\"", "n = 1"), &[]).unwrap();
    assert_eq!(plain.to_toml(), as_expression.to_toml());
}

#[test]
fn words_of_keys_are_not_taken_for_parameters() {
    let text = beam(
        "mode = \"static\"",
        "step = \"auto\"\nend = \"end_time\"",
        "auto_step = 1\nend_time = \"2 s\"",
    );
    assert!(read(&text, &[]).is_ok(), "{:?}", read(&text, &[]));
}

#[test]
fn faults_of_expressions_name_the_place_and_the_dimensions() {
    insta::assert_snapshot!(fault(RADIUS, "radius = \"2*raduis\"", "radius = \"2 mm\""), @"scene.toml:14:13: `rods.0.radius`: unknown name `raduis` (did you mean `radius`?)");
    insta::assert_snapshot!(fault(RADIUS, "radius = \"raduis\"", "radius = \"2 mm\""), @"scene.toml:14:11: `rods.0.radius`: unknown name `raduis` (did you mean `radius`?)");
    insta::assert_snapshot!(fault(RADIUS, "radius = \"r + 2 s\"", "r = \"2 mm\""), @"scene.toml:14:11: `rods.0.radius`: a time cannot be added to a length");
    insta::assert_snapshot!(fault(RADIUS, "radius = \"r*2 s\"", "r = \"2 mm\""), @r##"scene.toml:14:11: `rods.0.radius`: "r*2 s" is a quantity in m s, but this key takes a length"##);
    insta::assert_snapshot!(fault(RADIUS, "radius = \"2*end_time\"", "end_time = \"2 s\""), @r##"scene.toml:14:11: `rods.0.radius`: "2*end_time" is a time, but this key takes a length"##);
    insta::assert_snapshot!(fault(RADIUS, "radius = \"-r\"", "r = \"2 mm\""), @"scene.toml:14:10: `rods.0.radius`: -0.002 is out of range; allowed: greater than 0");
    insta::assert_snapshot!(fault(RADIUS, "radius = \"r/0\"", "r = \"2 mm\""), @r##"scene.toml:14:11: `rods.0.radius`: "r/0" is inf, not a finite number"##);
    insta::assert_snapshot!(fault(RADIUS, "radius = \"2*(r\"", "r = \"2 mm\""), @"scene.toml:14:10: `rods.0.radius`: expected `,` or `)`");
    insta::assert_snapshot!(fault("edges = 50", "edges = \"n/4\"", "n = 10"), @r##"scene.toml:15:10: `rods.0.edges`: "n/4" is 2.5, but this key takes a whole number; round it by round(x), floor(x) or ceil(x)"##);
    insta::assert_snapshot!(fault("edges = 50", "edges = \"r\"", "r = \"2 mm\""), @r##"scene.toml:15:10: `rods.0.edges`: "r" is a length, but this key takes a pure number"##);
    insta::assert_snapshot!(fault(RADIUS, RADIUS, "a = \"b + 1\"\nb = \"2*c\"\nc = \"a\""), @r##"
scene.toml:10:5: `parameters.a`: a circle: `a` uses `b` uses `c` uses `a`
scene.toml:11:5: `parameters.b`: a circle: `a` uses `b` uses `c` uses `a`
scene.toml:12:5: `parameters.c`: a circle: `a` uses `b` uses `c` uses `a`
"##);
    insta::assert_snapshot!(fault(RADIUS, RADIUS, "a = true\npi = 3\ni = 1\ns = 2\nauto = 1"), @r##"
scene.toml:10:5: `parameters.a`: expected a number, or text with a unit or an expression, found a boolean
scene.toml:11:1: `parameters.pi`: `pi` has a meaning in expressions; choose another name
scene.toml:12:1: `parameters.i`: `i` is the index of a copy; choose another name
scene.toml:13:1: `parameters.s`: `s` is a unit, as in "1 m/s" or "1 N/m"; choose another name
scene.toml:14:1: `parameters.auto`: `auto` is a word of scenario files; choose another name
"##);
    insta::assert_snapshot!(fault(RADIUS, RADIUS, "seed = 0.5"), @"scene.toml:10:8: `parameters.seed`: the seed of random numbers is a whole number, 0 or greater");
    insta::assert_snapshot!(read(&beam(RADIUS, RADIUS, "radius = 1"), &["parameters.raduis=3mm"]).unwrap_err(), @"--set:1:1: `parameters.raduis`: there is no parameter `raduis` (did you mean `radius`?)");
    // Text that is not an expression keeps its own message.
    insta::assert_snapshot!(fault(RADIUS, "radius = \"5 furlongs\"", "n = 1"), @r##"scene.toml:14:10: `rods.0.radius`: "5 furlongs" has an unknown unit; allowed units: m, cm, mm, µm, um, nm, km, in"##);
    insta::assert_snapshot!(fault(RADIUS, "radius = \"thick\"", "n = 1"), @r##"scene.toml:14:10: `rods.0.radius`: "thick" does not begin with a number; allowed units: m, cm, mm, µm, um, nm, km, in"##);
}

const ROWS: &str = r#"experiment = "scene"
[parameters]
n = 3
gap = "10 mm"

[material]
youngs_modulus = "1 MPa"
poissons_ratio = 0.5
density = 1000.0

[[rods]]
name = "first"
radius = "1 mm"
edges = 10
shape = { kind = "straight", start = [0, 0, 1], end = [0.1, 0, 1] }

[[rods]]
count = ["n", 2]
name = "rod{i}_{j}"
radius = "1 mm + i*0.1 mm"
edges = 10
let = { x = "i*gap", z = "2*x" }
shape = { kind = "straight", start = ["x", "j*gap", 0], end = ["x", "j*gap", "0.1 m + z"] }

[[clamps]]
count = ["n", 2]
rod = "rod{i}_{j}"
at = "start"

[[joints]]
count = "n - 1"
kind = "spring"
rods = ["rod{i}_0", "rod{i + 1}_0"]
at = ["end", "end"]
stiffness = "1 N/m"

[time]
end = "1 s"
"#;

#[test]
fn tables_are_copied() {
    let scenario = read(ROWS, &[]).unwrap();
    let names: Vec<&str> = scenario.rods.iter().map(|rod| rod.name.as_str()).collect();
    assert_eq!(
        names,
        [
            "first", "rod0_0", "rod0_1", "rod1_0", "rod1_1", "rod2_0", "rod2_1"
        ]
    );
    assert_eq!(scenario.rods[6].radius, 1e-3 + 2.0 * 1e-4);
    let start = [2.0 * 0.01, 0.01, 0.0];
    let end = [2.0 * 0.01, 0.01, 0.1 + 2.0 * (2.0 * 0.01)];
    assert_eq!(scenario.rods[6].shape, Shape::Straight { start, end });
    assert_eq!(scenario.clamps.len(), 6);
    assert_eq!(scenario.joints.len(), 2);
    assert_eq!(scenario.joints[1].rods, ["rod1_0", "rod2_0"]);
    let scenario = read(ROWS, &["parameters.n=1", "rods.1.count=[1, 2]"]).unwrap();
    assert_eq!((scenario.rods.len(), scenario.joints.len()), (3, 0));
}

#[test]
fn faults_of_copies_name_the_table_as_written_and_the_copy() {
    let fault = |from: &str, to: &str| {
        assert!(ROWS.contains(from), "{from}");
        read(&ROWS.replacen(from, to, 1), &[]).unwrap_err()
    };
    insta::assert_snapshot!(fault("1 mm + i*0.1 mm", "0.25 mm - 0.1 mm*(i + j)"), @"scene.toml:20:10: `rods.1.radius` (copy 5): -5.000000000000002e-5 is out of range; allowed: greater than 0");
    insta::assert_snapshot!(fault("1 mm + i*0.1 mm", "1 mm + i*0.1"), @"scene.toml:20:11: `rods.1.radius` (copy 0): a pure number cannot be added to a length");
    insta::assert_snapshot!(fault("1 mm + i*0.1 mm", "1 mm + k*0.1 mm"), @"scene.toml:20:18: `rods.1.radius` (copy 0): unknown name `k` (the names are: i, j, x, z, gap, n)");
    insta::assert_snapshot!(fault("name = \"rod{i}_{j}\"", "name = \"rod\""), @r##"scene.toml:19:8: `rods.1.name`: the copies need different names (write "rod{i}")"##);
    insta::assert_snapshot!(fault("name = \"rod{i}_{j}\"", "name = \"rod{i\""), @"scene.toml:19:12: `rods.1.name` (copy 0): this `{` is not closed (write `{{` and `}}` for braces)");
    let infinite = fault("name = \"rod{i}_{j}\"", "name = \"rod{j/0}\"");
    assert!(infinite.contains("`rods.1.name`"), "{infinite}");
    assert!(infinite.contains("not a finite number"), "{infinite}");
    insta::assert_snapshot!(fault("name = \"rod{i}_{j}\"", "nam = \"rod{i}\""), @"scene.toml:19:1: `rods.1.nam` (copy 0): unknown key (did you mean `name`?)");
    insta::assert_snapshot!(fault("count = [\"n\", 2]", "count = -1"), @"scene.toml:18:9: `rods.1.count`: -1 is out of range; allowed: 0 to 100000");
    insta::assert_snapshot!(fault("count = [\"n\", 2]", "count = \"gap\""), @r##"scene.toml:18:9: `rods.1.count`: "gap" is a length, but this key takes a pure number"##);
    insta::assert_snapshot!(fault("count = [\"n\", 2]", "count = [1000, 1000]"), @"scene.toml:18:9: `rods.1.count`: 1000000 copies are too many; allowed: at most 100000");
    insta::assert_snapshot!(fault("count = [\"n\", 2]", "count = [1, 2, 3, 4]"), @"scene.toml:18:9: `rods.1.count`: expected a number of copies, or up to three: [20, 10] has the indices i and j");
    insta::assert_snapshot!(fault("let = { x = \"i*gap\"", "let = { gap = 2, j = 1, x = \"y\", y = \"z\""), @r##"
scene.toml:22:9: `rods.1.let.gap` (copy 0): `gap` is a parameter of the file; choose another name
scene.toml:22:18: `rods.1.let.j` (copy 0): `j` is the index of a copy; choose another name
"##);
}

#[test]
fn random_numbers_depend_on_seed_key_and_copy_only() {
    let text = ROWS.replace(
        "\"x\", \"j*gap\", 0]",
        "\"random(0 mm, 10 mm)\", \"normal(0, 1)\", 0]",
    );
    let starts = |text: &str, set: &[&str]| -> Vec<[f64; 3]> {
        let rods = read(text, set).unwrap().rods;
        let starts = rods
            .iter()
            .filter(|rod| rod.name != "first")
            .map(|rod| match rod.shape {
                Shape::Straight { start, .. } => start,
                _ => [0.0; 3],
            });
        starts.collect()
    };
    let first = starts(&text, &[]);
    assert_eq!(first, starts(&text, &["parameters.seed=0"]));
    assert_ne!(first, starts(&text, &["parameters.seed=1"]));
    // Adding tables before them, or reducing the count, does not change the copies.
    assert_eq!(first[..2], starts(&text, &["parameters.n=1"])[..]);
    let without = text.replacen("name = \"first\"", "count = 2\nname = \"first{i}\"", 1);
    assert_eq!(first, starts(&without, &[])[2..]);
    assert!(first.iter().all(|[x, ..]| (0.0..0.01).contains(x)));
    let different = first
        .iter()
        .all(|one| first.iter().filter(|other| *other == one).count() == 1);
    assert!(different);
}

#[test]
fn copies_are_scattered_without_overlap() {
    let scattered = r#"count = 30
name = "rod{i}"
radius = "1 mm"
edges = 10
scatter = { region = [[0, 0, 0], ["0.2 m", "0.2 m", 0]], distance = "2.1 mm", length = "5 cm", normal = [0, 0, 1] }
shape = { kind = "straight", start = ["x - 25 mm*u", "y - 25 mm*v", "z"], end = ["x + 25 mm*u", "y + 25 mm*v", "z"] }
"#;
    let head = ROWS.split("[[rods]]").next().unwrap();
    let text = format!("{head}[[rods]]\n{scattered}\n[time]\nend = 1\n");
    let scenario = read(&text, &[]).unwrap();
    assert_eq!(scenario.rods.len(), 30);
    for rod in &scenario.rods {
        let Shape::Straight { start, end } = rod.shape else {
            panic!("{rod:?}");
        };
        let length: f64 = (0..3).map(|axis| (end[axis] - start[axis]).powi(2)).sum();
        assert!((length.sqrt() - 0.05).abs() < 1e-12 && start[2] == 0.0);
    }
    let fault = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        read(&text.replacen(from, to, 1), &[]).unwrap_err()
    };
    insta::assert_snapshot!(fault("\"2.1 mm\"", "\"8 cm\""), @"scene.toml:16:1: `rods.0.scatter`: 5 of 30 copies found a place without overlap (enlarge `region`, or lower `distance`, `length` or `count`)");
    insta::assert_snapshot!(fault("\"2.1 mm\"", "\"2*gap*gap\""), @r##"scene.toml:16:70: `rods.0.scatter.distance`: "2*gap*gap" is a quantity in m^2, but this key takes a length"##);
    insta::assert_snapshot!(fault("\"2.1 mm\"", "-1"), @"scene.toml:16:69: `rods.0.scatter.distance`: -1.0 is out of range; allowed: 0 or greater");
    insta::assert_snapshot!(fault("region", "reigon"), @"scene.toml:16:13: `rods.0.scatter.reigon`: unknown key (did you mean `region`?)");
    insta::assert_snapshot!(fault("normal = [0, 0, 1]", "normal = [0, 0, 0]"), @"scene.toml:16:105: `rods.0.scatter.normal`: a direction cannot be [0, 0, 0]");
}

#[test]
fn the_expanded_file_reads_to_the_same_scenario() {
    let loaded = from_text(*EXPERIMENTS, "rows", ROWS, Path::new(""), &[]).unwrap();
    let expanded = loaded.expanded_toml(*EXPERIMENTS);
    assert!(
        !expanded.contains("count") && !expanded.contains("[parameters]"),
        "{expanded}"
    );
    assert_eq!(
        read(&expanded, &[]).unwrap().to_toml(),
        loaded.scenario.to_toml()
    );
    let copied = |key: &str, written, expanded| Copied {
        key: key.to_owned(),
        written,
        expanded,
    };
    let expected = [
        copied("clamps", 1, 6),
        copied("joints", 1, 2),
        copied("rods", 2, 7),
    ];
    assert_eq!(loaded.copied(), expected);
}

#[test]
fn parameters_are_swept() {
    let text = format!("{ROWS}\n[sweep]\nparameters.gap = [\"5 mm\", \"n*2 mm\"]\n");
    let cases = CaseSet::from_text(*EXPERIMENTS, "rows", &text, Path::new("")).unwrap();
    let starts = (0..2).map(
        |case| match cases.scenario_of(case).unwrap().scenario.rods[6].shape {
            Shape::Straight { start, .. } => start[0],
            _ => f64::NAN,
        },
    );
    assert_eq!(starts.collect::<Vec<_>>(), [2.0 * 5e-3, 2.0 * (3.0 * 2e-3)]);
    let portable = cases.portable().unwrap();
    let again = CaseSet::from_text(*EXPERIMENTS, "rows", &portable.toml, Path::new("")).unwrap();
    let toml = |cases: &CaseSet| cases.scenario_of(1).unwrap().scenario.to_toml();
    assert_eq!(toml(&again), toml(&cases));
    let text = text.replace("parameters.gap", "parameters.gape");
    let cases = CaseSet::from_text(*EXPERIMENTS, "rows", &text, Path::new("")).unwrap();
    insta::assert_snapshot!(cases.scenario_of(0).unwrap_err(), @"rows.toml:41:12: `parameters.gape`: there is no parameter `gape` (did you mean `gap`?)");
}

#[test]
fn files_of_copies_go_along_with_a_sweep() {
    let directory = tempfile::tempdir().unwrap();
    for index in 0..3 {
        let curve = format!("x,y,z\n0,0,{index}\n1,0,{index}\n");
        std::fs::write(directory.path().join(format!("curve{index}.csv")), curve).unwrap();
    }
    let rods = "[[rods]]\ncount = \"n\"\nname = \"curve{i}\"\nradius = 0.01\nshape = { kind = \"points\", file = \"curve{i}.csv\" }\n";
    let text = format!("{ROWS}{rods}[sweep]\nparameters.n = [2, 3]\n");
    let cases = CaseSet::from_text(*EXPERIMENTS, "rows", &text, directory.path()).unwrap();
    let portable = cases.portable().unwrap();
    let names: Vec<&str> = portable
        .inputs
        .iter()
        .map(|input| input.name.as_str())
        .collect();
    assert_eq!(names, ["curve0.csv", "curve1.csv", "curve2.csv"]);
    assert!(
        portable.toml.contains("inputs/curve{i}.csv"),
        "{}",
        portable.toml
    );
}

mod any_text {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn at_keys_of_copies_makes_nothing_panic(
            text in "[-+*/^(){}. 0-9a-eij\"]{0,20}",
            key in 0usize..4,
        ) {
            let from = ["\"1 mm + i*0.1 mm\"", "\"rod{i}_{j}\"", "\"n\"", "\"i*gap\""][key];
            let literal = format!("{text:?}");
            let _ = read(&ROWS.replacen(from, &literal, 1), &[]);
        }
    }
}
