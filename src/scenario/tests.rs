//! Whole scenario files: what is accepted, what is refused and how.

use super::*;
use proptest::prelude::*;
use std::path::Path;

const BEAM: &str = r#"experiment = "scene"
title = "Heavy cantilever"

[material]
youngs_modulus = "100 MPa"
poissons_ratio = 0.5
density = 1000.0

[[rods]]
name = "beam"
radius = "5 mm"
edges = 50
shape = { kind = "straight", start = [0, 0, 0], end = [1, 0, 0] }

[[clamps]]
rod = "beam"
at = "start"

[[loads]]
kind = "gravity"
acceleration = [0, 0, -9.81]

[time]
mode = "static"

[output]
nodes = true
"#;

fn read(text: &str) -> Result<Scenario, ScenarioError> {
    from_text("beam", text, Path::new("")).map(|loaded| loaded.scenario)
}

/// The messages for a text in which `from` is replaced by `to`.
fn faults(from: &str, to: &str) -> String {
    assert!(BEAM.contains(from), "{from}");
    read(&BEAM.replacen(from, to, 1)).unwrap_err().to_string()
}

#[test]
fn a_good_file_is_resolved_to_si_units() {
    let scenario = read(BEAM).unwrap();
    let rod = &scenario.rods[0];
    assert_eq!(rod.radius, 5e-3);
    assert_eq!(rod.material.youngs_modulus, 1e8);
    assert_eq!(rod.natural_shape, NaturalShape::AsPlaced);
    let second_moment = std::f64::consts::PI * 5e-3f64.powi(4) / 4.0;
    assert!((rod.stiffness.bending_1 / (1e8 * second_moment) - 1.0).abs() < 1e-15);
    assert_eq!(scenario.time, Time::Static);
    assert_eq!(scenario.clamps[0].hold, Hold::Both);
}

#[test]
fn faults_name_file_line_column_key_and_range() {
    insta::assert_snapshot!(faults("radius = \"5 mm\"", "radius = -5.0"), @"beam.toml:11:10: `rods.0.radius`: -5.0 is out of range; allowed: greater than 0");
    insta::assert_snapshot!(faults("radius = \"5 mm\"", "raduis = \"5 mm\""), @"beam.toml:11:1: `rods.0.raduis`: unknown key (did you mean `radius`?)");
    insta::assert_snapshot!(faults("radius = \"5 mm\"", "radius = \"5 MPa\""), @r#"beam.toml:11:10: `rods.0.radius`: "5 MPa" is a pressure, but this key takes a length; allowed units: m, cm, mm, µm, um, nm, km, in"#);
    insta::assert_snapshot!(faults("radius = \"5 mm\"", "radius = nan"), @"beam.toml:11:10: `rods.0.radius`: NaN is not a finite number");
    insta::assert_snapshot!(faults("radius = \"5 mm\"", "radius = inf"), @"beam.toml:11:10: `rods.0.radius`: inf is not a finite number");
    insta::assert_snapshot!(faults("radius = \"5 mm\"", "radius = true"), @"beam.toml:11:10: `rods.0.radius`: expected a length as a number in SI units or as text with a unit, found a boolean");
    insta::assert_snapshot!(faults("radius = \"5 mm\"", "radius = 1e-200"), @"beam.toml:11:10: `rods.0.radius`: radius and material give the stiffnesses EA = 0.0 N, EI = 0.0 N m²; check their units");
    insta::assert_snapshot!(faults("radius = \"5 mm\"\n", ""), @"beam.toml:9:1: `rods.0`: missing key `radius` (a length, greater than 0)");
    insta::assert_snapshot!(faults("edges = 50", "edges = 0"), @"beam.toml:12:9: `rods.0.edges`: 0 is out of range; allowed: 1 to 1000000");
    insta::assert_snapshot!(faults("edges = 50", "edges = 50.5"), @"beam.toml:12:9: `rods.0.edges`: expected a whole number, found a number");
    insta::assert_snapshot!(faults("edges = 50", "edges = 99999999999999999999"), @"beam.toml:12:9: `rods.0.edges`: expected a whole number, found a number");
    insta::assert_snapshot!(faults("poissons_ratio = 0.5", "poissons_ratio = 0.6"), @"beam.toml:6:18: `material.poissons_ratio`: 0.6 is out of range; allowed: greater than -1 and at most 0.5");
    insta::assert_snapshot!(faults("kind = \"straight\"", "kind = \"strait\""), @r#"beam.toml:13:18: `rods.0.shape.kind`: "strait" is not known here; allowed: straight, helix, arc, ring, points (did you mean `straight`?)"#);
    insta::assert_snapshot!(faults("end = [1, 0, 0]", "end = [1, 0]"), @"beam.toml:13:55: `rods.0.shape.end`: expected an array of 3 values, found 2");
    insta::assert_snapshot!(faults("end = [1, 0, 0]", "end = [0, 0, 0]"), @"beam.toml:13:55: `rods.0.shape.end`: the line has no length: `start` and `end` are the same");
    insta::assert_snapshot!(faults("kind = \"straight\", ", ""), @"beam.toml:13:9: `rods.0.shape`: missing key `kind`; allowed: straight, helix, arc, ring, points");
    insta::assert_snapshot!(faults("kind = \"gravity\"", "kind = \"gravitation\""), @r#"beam.toml:20:8: `loads.0.kind`: "gravitation" is not known here; allowed: gravity, force, moment, distributed, drag (did you mean `gravity`?)"#);
    insta::assert_snapshot!(faults("at = \"start\"", "at = \"middle\""), @r#"beam.toml:17:6: `clamps.0.at`: invalid value: string "middle", expected "start", "end" or a number counted from zero"#);
    insta::assert_snapshot!(faults("at = \"start\"", "at = -1"), @"beam.toml:17:6: `clamps.0.at`: -1 is out of range; allowed: 0 and up");
    insta::assert_snapshot!(faults("mode = \"static\"", "mode = \"continuation\""), @r#"beam.toml:24:8: `time.mode`: continuation is not built yet; allowed: "dynamic", "static""#);
    insta::assert_snapshot!(faults("mode = \"static\"", "end = 0"), @"beam.toml:24:7: `time.end`: 0.0 is out of range; allowed: greater than 0");
    insta::assert_snapshot!(faults("mode = \"static\"", "end = 1\nstep = 0"), @"beam.toml:25:8: `time.step`: 0.0 is out of range; allowed: greater than 0");
    insta::assert_snapshot!(faults("mode = \"static\"", "end = 1\nstep = 1e-12"), @"beam.toml:25:8: `time.step`: 1e-12 s is out of range; allowed: at least solver.minimum_step = 1e-9 s");
    insta::assert_snapshot!(faults("mode = \"static\"", "mode = \"static\"\nend = 3"), @"beam.toml:25:7: `time.end`: a static run has no time steps; leave the key out");
    insta::assert_snapshot!(faults("[output]", "[contact]\nmodel = \"complementarity\"\n[output]"), @r#"beam.toml:27:9: `contact.model`: this contact model is not built yet; allowed: "imc", "ipc", "none""#);
    insta::assert_snapshot!(faults("[output]", "[contact]\nmodel = \"ipc\"\nmaximum_penetration = 0.1\n[output]"), @r#"beam.toml:28:23: `contact.maximum_penetration`: the model "ipc" allows no penetration; leave the key out"#);
    insta::assert_snapshot!(faults("[output]", "[contact]\nmodel = \"ipc\"\ndistance_tolerance = \"6 mm\"\nfriction = -0.1\nslip_tolerance = 0\n[output]"), @r#"
beam.toml:28:22: `contact.distance_tolerance`: 0.006 m is out of range; allowed: at most the smallest radius, 0.005 m
beam.toml:29:12: `contact.friction`: -0.1 is out of range; allowed: at least 0
beam.toml:30:18: `contact.slip_tolerance`: 0.0 is out of range; allowed: greater than 0
"#);
    insta::assert_snapshot!(faults("[output]", "[sweep]\nrods = 1\n[output]"), @"beam.toml:26:2: `sweep`: sweeps are not in this version of rodlab (take the table out, and run the cases one by one with --set)");
    insta::assert_snapshot!(faults("[output]", "[fluid]\nmodel = \"resistive\"\n[output]"), @"beam.toml:26:1: `fluid`: missing key `viscosity` (a viscosity, greater than 0)");
    insta::assert_snapshot!(faults("nodes = true", "nodes = 1979-05-27"), @"beam.toml:27:9: `output.nodes`: expected `true` or `false`, found a date");
    insta::assert_snapshot!(faults("nodes = true", "nodes = "), @"beam.toml:27:9: not TOML: string values must be quoted, expected literal string");
    insta::assert_snapshot!(faults("experiment = \"scene\"\n", ""), @r#"beam.toml:1:1: missing key `experiment` ("scene" or "flagella")"#);
    insta::assert_snapshot!(faults("experiment = \"scene\"\n", "experiment = \"folding\"\n"), @r#"beam.toml:1:14: `experiment`: "folding" is not known here; allowed: scene, flagella"#);
    insta::assert_snapshot!(read("").unwrap_err().to_string(), @r###"
beam.toml:1:1: missing key `experiment` ("scene" or "flagella")
beam.toml:1:1: `time`: missing key `end` (a time, greater than 0)
"###);
}

#[test]
fn several_faults_are_reported_together() {
    let text = BEAM
        .replace("radius = \"5 mm\"", "raduis = 5")
        .replace("edges = 50", "edges = \"fifty\"")
        .replace("nodes = true", "node = true");
    insta::assert_snapshot!(read(&text).unwrap_err().to_string(), @r###"
beam.toml:11:1: `rods.0.raduis`: unknown key (did you mean `radius`?)
beam.toml:12:9: `rods.0.edges`: expected a whole number, found text
beam.toml:27:1: `output.node`: unknown key (did you mean `nodes`?)
"###);
    let text = BEAM
        .replace("radius = \"5 mm\"", "radius = 0")
        .replace("edges = 50", "edges = -2")
        .replace("density = 1000.0", "density = \"1 kg\"");
    insta::assert_snapshot!(read(&text).unwrap_err().to_string(), @r###"
beam.toml:7:11: `material.density`: "1 kg" has an unknown unit; allowed units: kg/m^3, g/cm^3
beam.toml:11:10: `rods.0.radius`: 0.0 is out of range; allowed: greater than 0
beam.toml:12:9: `rods.0.edges`: -2 is out of range; allowed: 1 to 1000000
"###);
}

#[test]
fn faults_are_shown_in_their_lines() {
    let text = BEAM.replace("radius = \"5 mm\"", "raduis = \"5 mm\"");
    insta::assert_snapshot!(read(&text).unwrap_err().render(false), @r###"
 × `rods.0.raduis`: unknown key
   ╭─[beam.toml:11:1]
10 │ name = "beam"
11 │ raduis = "5 mm"
   · ───┬──
   ·    ╰── here
12 │ edges = 50
   ╰────
 help: did you mean `radius`?
"###);
}

#[test]
fn names_of_rods_are_checked() {
    let two = "[[rods]]\nname = \"beam\"\nradius = 1\nedges = 3\nshape = { kind = \"ring\", centre = [0, 0, 0], radius = 9 }\n\n[[clamps]]";
    insta::assert_snapshot!(faults("[[clamps]]", two), @"beam.toml:16:8: `rods.1.name`: rod 0 is called `beam` too; names must differ");
    insta::assert_snapshot!(faults("name = \"beam\"", "name = \"a.b\""), @r#"beam.toml:10:8: `rods.0.name`: "a.b" cannot be a name; allowed: letters, digits, `_` and `-`, not digits alone"#);
}

#[test]
fn resolved_scenarios_read_back_to_themselves() {
    let scenario = read(BEAM).unwrap();
    insta::assert_snapshot!(scenario.to_toml(), @r###"
title = "Heavy cantilever"
experiment = "scene"

[[rods]]
name = "beam"
radius = 0.005
edges = 50
closed = false
held = false
natural_shape = "as-placed"
twist = 0.0
velocity = [0.0, 0.0, 0.0]
angular_velocity = [0.0, 0.0, 0.0]

[rods.shape]
kind = "straight"
start = [0.0, 0.0, 0.0]
end = [1.0, 0.0, 0.0]

[rods.material]
youngs_modulus = 100000000.0
poissons_ratio = 0.5
density = 1000.0

[rods.cross_section]
kind = "circle"

[rods.stiffness]
stretching = 7853.981633974483
bending_1 = 0.04908738521234052
bending_2 = 0.04908738521234052
twisting = 0.032724923474893676

[[clamps]]
rod = "beam"
at = "start"
hold = "both"
angular_velocity = 0.0

[[loads]]
kind = "gravity"
acceleration = [0.0, 0.0, -9.81]

[contact]
model = "none"

[fluid]
model = "none"

[time]
mode = "static"

[solver]
force_tolerance = 0.000001
displacement_tolerance = 0.0001
maximum_iterations = 40
minimum_step = 0.000000001

[output]
nodes = true
forces = false
vtk = false
"###);
    assert_eq!(read(&scenario.to_toml()).unwrap(), scenario);
}

/// Every kind of shape, section, clamp and load, with units.
const EVERYTHING: &str = r#"experiment = "scene"

[material]
youngs_modulus = "1.3 MPa"
poissons_ratio = 0.49
density = "1.18 g/cm^3"

[[rods]]
radius = "1.6 mm"
edges = 30
shape = { kind = "helix", start = [0.1, 0.2, 0.3], axis = [1, 2, 3], radius = "3 cm", pitch = "7 cm", turns = 2.3, handedness = "left", phase = "33 deg" }
natural_shape = "straight"
velocity = ["1 mm/s", 0, 0]

[[rods]]
name = "strip"
edges = 10
cross_section = { kind = "rectangle", width = "10 mm", thickness = "1 mm" }
shape = { kind = "arc", start = [1, 0, 0], tangent = [0, 1, 1], normal = [1, 0.3, 0], radius = 0.3, angle = "170 deg" }
natural_curvature = ["3 1/m", 0]
natural_twist = "20 deg/m"
director = [1, 1, 1]
twist = "1 turn"
material = { youngs_modulus = "200 GPa" }
stiffness = { stretching = "7 kN", twisting = "3 N mm^2" }

[[rods]]
name = "ring"
radius = "2 mm"
edges = 20
shape = { kind = "ring", centre = [0, 0, 1], normal = [0.1, 0.2, 0.3], radius = "10 cm" }
natural_shape = { kind = "ring", centre = [0, 0, 0], radius = "11 cm" }

[[rods]]
name = "post"
radius = "2 cm"
held = true
shape = { kind = "points", points = [[0, 0, -1], [0, 0, 0], [0, 0.1, "120 cm"]] }

[[clamps]]
rod = "rod_1"
at = "start"
move = [[0, [0, 0, 0]], ["2 s", [0, 0, "10 cm"]]]
turn = [[0, 0], ["1 min", "90 deg"]]
axis = [1, 1, 0]
pivot = [0, 0, 1]

[[clamps]]
rod = "strip"
at = 3
hold = "position"
angular_velocity = "15 rpm"

[[loads]]
kind = "gravity"
acceleration = [0, 0, -9.81]
schedule = [[0, 0], [1, 1]]

[[loads]]
kind = "force"
rod = "strip"
at = "end"
force = [0, "3 mN", 0]

[[loads]]
kind = "moment"
rod = "strip"
at = 2
moment = [0, "3 mN m", 0]

[[loads]]
kind = "distributed"
force_per_length = [0, 1, 0]

[[loads]]
kind = "drag"
rod = "ring"
translation = 0.1

[[planes]]
point = [0, 0, -3]
normal = [0, 1, 7]
friction = 0.3

[contact]
friction = 0.2

[fluid]
model = "rss"
viscosity = "0.1 Pa s"

[time]
scheme = "implicit-midpoint"
step = "auto"
end = "2 min"

[output]
vtk = true
"#;

#[test]
fn every_kind_reads_back_to_itself() {
    let scenario = read(EVERYTHING).unwrap_or_else(|error| panic!("{error}"));
    let again = read(&scenario.to_toml()).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(
        again,
        Scenario {
            title: scenario.title.clone(),
            ..scenario.clone()
        }
    );
    assert_eq!(again.to_toml(), scenario.to_toml());
}

#[test]
fn defaults_follow_from_what_is_given() {
    let scenario = read(EVERYTHING).unwrap();
    let Contact::Imc {
        distance_tolerance, ..
    } = scenario.contact
    else {
        panic!("{:?}", scenario.contact);
    };
    // The strip has the smallest radius: half its thickness.
    assert_eq!(scenario.rods[1].radius, 0.5e-3);
    assert_eq!(distance_tolerance, 0.01 * 0.5e-3);
    assert_eq!(scenario.rods[1].material.density, 1180.0);
    assert_eq!(scenario.rods[1].stiffness.stretching, 7000.0);
    assert_eq!(
        scenario.rods[2].natural_shape,
        NaturalShape::Curve(Shape::Ring {
            centre: [0.0; 3],
            normal: [0.0, 0.0, 1.0],
            radius: 0.11
        })
    );
    assert!(scenario.rods[2].closed);
    assert_eq!(scenario.rods[3].edges, 2);
    assert_eq!(scenario.output.interval, Some(1.2));
}

/// Writes files into a fresh directory.
fn directory(files: &[(&str, &str)]) -> tempfile::TempDir {
    let directory = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(directory.path().join(name), text).unwrap();
    }
    directory
}

/// Loads a file of a directory; faults without the directory's name.
fn load_from(directory: &tempfile::TempDir, name: &str, set: &[&str]) -> Result<Scenario, String> {
    let set: Vec<String> = set.iter().map(|&text| text.to_owned()).collect();
    load(&directory.path().join(name), &set)
        .map(|loaded| loaded.scenario)
        .map_err(|error| {
            let place = format!("{}/", directory.path().display());
            error.to_string().replace(&place, "")
        })
}

#[test]
fn a_scenario_extends_another() {
    let directory = directory(&[
        ("base.toml", BEAM),
        (
            "longer.toml",
            "extends = \"base.toml\"\ntitle = \"Longer\"\n[material]\ndensity = 2000\n",
        ),
        (
            "broken.toml",
            "extends = \"base.toml\"\n[material]\ndensity = -1\n",
        ),
        ("circle.toml", "extends = \"circle.toml\""),
        ("lost.toml", "extends = \"nowhere.toml\""),
    ]);
    let scenario = load_from(&directory, "longer.toml", &[]).unwrap();
    assert_eq!(scenario.name, "longer");
    assert_eq!(scenario.title, "Longer");
    assert_eq!(scenario.rods[0].material.density, 2000.0);
    assert_eq!(scenario.rods[0].material.youngs_modulus, 1e8);
    let fault = |name| load_from(&directory, name, &[]).unwrap_err();
    insta::assert_snapshot!(fault("broken.toml"), @"broken.toml:3:11: `material.density`: -1.0 is out of range; allowed: greater than 0");
    insta::assert_snapshot!(fault("circle.toml"), @"circle.toml:1:11: `extends`: circle.toml extends this file in turn: a circle");
    insta::assert_snapshot!(fault("lost.toml"), @"lost.toml:1:11: `extends`: nowhere.toml cannot be read: No such file or directory (os error 2)");
    insta::assert_snapshot!(fault("none.toml"), @"none.toml cannot be read: No such file or directory (os error 2)");
}

#[test]
fn keys_are_set_from_the_command_line() {
    let directory = directory(&[("beam.toml", BEAM)]);
    let rod = |set| {
        load_from(&directory, "beam.toml", &[set])
            .unwrap()
            .rods
            .remove(0)
    };
    assert_eq!(rod("rods.0.radius=\"7 mm\"").radius, 7e-3);
    assert_eq!(rod("rods.0.radius=7 mm").radius, 7e-3);
    assert_eq!(rod("rods.beam.radius = 0.007").radius, 7e-3);
    assert_eq!(
        rod("rods.beam.stiffness.twisting=3").stiffness.twisting,
        3.0
    );
    assert_eq!(
        rod("rods.beam.shape.end=[2, 0, 0]").shape,
        Shape::Straight {
            start: [0.0; 3],
            end: [2.0, 0.0, 0.0]
        }
    );
    let fault = |set| load_from(&directory, "beam.toml", &[set]).unwrap_err();
    insta::assert_snapshot!(fault("rods.beem.radius=1"), @"--set:1:1: `rods.beem.radius`: no element is called `beem` (did you mean `beam`?)");
    insta::assert_snapshot!(fault("rods.1.radius=1"), @"--set:1:1: `rods.1.radius`: there is no element 1; the array has 1");
    insta::assert_snapshot!(fault("rods.0.radius=-1"), @"--set:1:15: `rods.0.radius`: -1.0 is out of range; allowed: greater than 0");
    insta::assert_snapshot!(fault("rods.0.raduis=1"), @"--set:1:1: `rods.0.raduis`: unknown key (did you mean `radius`?)");
    insta::assert_snapshot!(fault("title.long=1"), @"--set:1:1: `title.long`: there is no `long` here: text has no keys");
    insta::assert_snapshot!(fault("rods.0.radius"), @r#"--set:1:1: expected key=value (for example --set rods.0.radius="5 mm")"#);
    insta::assert_snapshot!(fault("rods..radius=1"), @"--set:1:1: expected keys joined by dots, such as time.end");
    insta::assert_snapshot!(fault("extends=other.toml"), @"--set:1:1: `extends`: this key cannot be set from the command line");
    // A value cannot smuggle in further keys.
    let title = "\"a\"
rods=3";
    let scenario = load_from(&directory, "beam.toml", &[&format!("title={title}")]);
    assert_eq!(scenario.unwrap().title, title);
}

#[test]
fn shape_files_are_found_beside_the_scenario() {
    let curve = BEAM.replace(
        "kind = \"straight\", start = [0, 0, 0], end = [1, 0, 0]",
        "kind = \"points\", file = \"curve.csv\"",
    );
    let directory = directory(&[
        ("beam.toml", &curve),
        ("curve.csv", "x,y,z\n0,0,0\n1,0,0\n1,1,0\n"),
    ]);
    let scenario = load_from(&directory, "beam.toml", &[]).unwrap();
    assert_eq!(
        scenario.rods[0].shape,
        Shape::Points {
            points: vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]
        }
    );
    std::fs::write(directory.path().join("curve.csv"), "x,y,z\n0,0,0\n1,0\n").unwrap();
    insta::assert_snapshot!(load_from(&directory, "beam.toml", &[]).unwrap_err(), @"beam.toml:13:35: `rods.0.shape.file`: curve.csv, line 3: expected 3 columns, found 2");
}

proptest! {
    #[test]
    fn no_bytes_in_a_file_make_it_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let directory = directory(&[]);
        let path = directory.path().join("noise.toml");
        std::fs::write(&path, bytes).unwrap();
        if let Err(error) = load(&path, &[]) {
            error.render(false);
        }
    }

    #[test]
    fn no_override_makes_it_panic(text in "[a-z0-9.]{0,12}=?\\PC{0,12}") {
        let directory = directory(&[("beam.toml", BEAM)]);
        let _ = load_from(&directory, "beam.toml", &[&text]);
    }

    #[test]
    fn resolved_numbers_read_back_exactly(
        radius in 1e-6..1e-1f64,
        pitch in 1e-3..1.0f64,
        turns in 0.1..20.0f64,
        phase in -400.0..400.0f64,
        axis in prop::array::uniform3(-1.0..1.0f64),
        end in 1e-3..1e3f64,
    ) {
        prop_assume!(axis.iter().any(|c| c.abs() > 1e-3));
        let text = EVERYTHING
            .replace("radius = \"1.6 mm\"", &format!("radius = {radius:?}"))
            .replace("pitch = \"7 cm\"", &format!("pitch = {pitch:?}"))
            .replace("turns = 2.3", &format!("turns = {turns:?}"))
            .replace("33 deg", &format!("{phase:?} deg"))
            .replace("axis = [1, 2, 3]", &format!("axis = {axis:?}"))
            .replace("2 min", &format!("{end:?} min"));
        let scenario = read(&text).unwrap();
        prop_assert_eq!(read(&scenario.to_toml()).unwrap(), scenario);
    }

    #[test]
    fn no_text_makes_it_panic(text in "\\PC*") {
        if let Err(error) = read(&text) {
            error.render(false);
        }
    }

    #[test]
    fn no_damage_to_a_file_makes_it_panic(
        at in 0..BEAM.len(),
        length in 0..20usize,
        insert in "[\\[\\]{}=\"'\\n#.,a-z0-9é-]{0,6}",
    ) {
        let mut text = BEAM.to_owned();
        text.replace_range(at..(at + length).min(BEAM.len()), &insert);
        if let Err(error) = read(&text) {
            error.render(false);
        }
    }
}
