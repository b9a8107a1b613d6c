//! Every fault names file, line, column, key and the allowed values; nothing panics.

use super::{BEAM, EXPERIMENTS, read};
use crate::scenario::{CaseSet, from_text, load};
use proptest::prelude::*;
use std::path::Path;

/// The messages for a text in which `from` is replaced by `to`.
fn faults(from: &str, to: &str) -> String {
    assert!(BEAM.contains(from), "{from}");
    read(&BEAM.replacen(from, to, 1)).unwrap_err().to_string()
}

/// The messages for a table of helices.
fn faults_of_helices(table: &str) -> String {
    let text = format!("experiment = \"helix-stability\"\n[helix_stability]\n{table}");
    read(&text).unwrap_err().to_string()
}

#[test]
fn faults_of_helices_name_what_is_allowed() {
    let lattice = "directions = { kind = \"fibonacci\", count = 10 }\n";
    insta::assert_snapshot!(faults_of_helices(&format!("edges = 7\n{lattice}")), @r##"beam.toml:3:9: `helix_stability.edges`: 7 is out of range; allowed: 8 to 10000"##);
    insta::assert_snapshot!(faults_of_helices(&format!("edges = 21\nextrapolate = true\n{lattice}")), @r##"
beam.toml:3:9: `helix_stability.edges`: 21 is out of range; allowed with extrapolate = true: even numbers from 16
"##);
    insta::assert_snapshot!(faults_of_helices(&format!("largest_distance = 60\n{lattice}")), @r##"beam.toml:3:20: `helix_stability.largest_distance`: 60.0 is out of range; allowed: greater than 0 and at most 50, where the rod turns by half a radian from edge to edge of the coarsest mesh"##);
    insta::assert_snapshot!(faults_of_helices(&format!("radius = 0.2\n{lattice}[time]\nend = 1\n[[loads]]\nkind = \"gravity\"\n")), @r##"
beam.toml:3:10: `helix_stability.radius`: 0.2 is out of range; allowed: greater than 0 and at most 0.05, a slender rod
beam.toml:5:1: `time`: helices are tested in equilibrium and in a vacuum; leave the table out
beam.toml:7:1: `loads`: the rod has length 1 and bending stiffness 1; [helix_stability] defines everything
beam.toml:7:1: `loads.0`: missing key `acceleration` (three numbers [x, y, z], each an acceleration)
"##);
    insta::assert_snapshot!(faults_of_helices("directions = { kind = \"list\", points = [[-1, 0, 1], [0, 0, 0], [1, 1, 1]] }\n"), @r##"
beam.toml:3:41: `helix_stability.directions.points.0`: the curvature -1.0 is out of range; allowed: at least 0. A helix of curvature −κ is a turned helix of curvature κ
beam.toml:3:53: `helix_stability.directions.points.1`: a direction cannot be [0, 0, 0]
"##);
    insta::assert_snapshot!(faults_of_helices("directions = { kind = \"list\", file = \"nowhere.csv\" }\n"), @r##"beam.toml:3:38: `helix_stability.directions.file`: nowhere.csv cannot be read: No such file or directory (os error 2)"##);
    insta::assert_snapshot!(faults_of_helices("directions = { kind = \"grid\", polar = 0 }\n"), @r##"
beam.toml:3:14: `helix_stability.directions`: missing key `azimuthal` (a whole number, 1 to 10000000)
beam.toml:3:39: `helix_stability.directions.polar`: 0 is out of range; allowed: 1 to 10000000
"##);
    insta::assert_snapshot!(faults_of_helices("search = \"slow\"\n"), @r##"beam.toml:3:10: `helix_stability.search`: "slow" is not a valid value; allowed: fast, path"##);
    insta::assert_snapshot!(read("experiment = \"helix-stability\"\n").unwrap_err().to_string(), @r##"beam.toml:1:1: missing key `helix_stability` (a table [helix_stability])"##);
}

#[test]
fn faults_of_poses_name_what_is_allowed() {
    let moving = BEAM.replace("mode = \"static\"", "end = 1");
    let clamped = |keys: &str| {
        let text = moving.replacen("at = \"start\"", &format!("at = \"start\"\n{keys}"), 1);
        read(&text).unwrap_err().to_string()
    };
    let pose = "poses = [[0, [0, 0, 0], [1, 0, 0, 0]]]";
    insta::assert_snapshot!(clamped("poses = []"), @"beam.toml:18:9: `clamps.0.poses`: a gripper needs at least one pose");
    insta::assert_snapshot!(clamped("poses = [[1, [0, 0, 0], [1, 0, 0, 0]], [1, [0, 0, 0], [2, 0, 0, 0]]]"), @r##"
beam.toml:18:41: `clamps.0.poses.1.0`: time 1.0 s is not after 1.0 s; times must increase
beam.toml:18:55: `clamps.0.poses.1.2`: the quaternion qw, qx, qy, qz = [2.0, 0.0, 0.0, 0.0] has the norm 2.0000; allowed: unit quaternions
"##);
    insta::assert_snapshot!(clamped("follow = \"nowhere.csv\""), @"beam.toml:18:10: `clamps.0.follow`: nowhere.csv cannot be read: No such file or directory (os error 2)");
    insta::assert_snapshot!(clamped(&format!("{pose}\nfollow = \"nowhere.csv\"")), @"beam.toml:18:9: `clamps.0.poses`: give `follow` or `poses`, not both");
    insta::assert_snapshot!(clamped(&format!("{pose}\naxis = [1, 0, 0]")), @"beam.toml:19:8: `clamps.0.axis`: the poses define how it moves and turns; leave the key out");
}

#[test]
fn dotted_keys_of_60000_levels_are_refused() {
    let key = vec!["a"; 60_000].join(".");
    let deep = [format!("{key}=1")];
    let error = from_text(*EXPERIMENTS, "beam", BEAM, Path::new(""), &deep).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("60000 steps; allowed: at most 32")
    );
    let sweep = format!("{BEAM}\n[sweep]\n\"{key}\" = [1, 2]\n");
    let case_set = CaseSet::from_text(*EXPERIMENTS, "beam", &sweep, Path::new("")).unwrap();
    let error = case_set.scenario_of(0).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("60000 steps; allowed: at most 32")
    );
}

#[test]
fn chains_of_3000_extended_files_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let path = |number: usize| directory.path().join(format!("{number}.toml"));
    for number in 0..3000 {
        let text = format!("extends = \"{}.toml\"\n", number + 1);
        std::fs::write(path(number), text).unwrap();
    }
    std::fs::write(path(3000), BEAM).unwrap();
    let error = load(*EXPERIMENTS, &path(0), &[]).unwrap_err().to_string();
    assert!(
        error.contains("too many files extend each other in a row"),
        "{error}"
    );
    // A chain of realistic length is read.
    load(*EXPERIMENTS, &path(2950), &[]).unwrap();
}

#[test]
fn of_20000_unknown_keys_a_hundred_are_reported() {
    let keys: String = (0..20_000)
        .map(|number| format!("key_{number} = 1\n"))
        .collect();
    let error = read(&format!("{keys}{BEAM}")).unwrap_err();
    assert_eq!(error.0.len(), 100);
}

#[test]
fn numbers_beyond_any_measure_are_refused() {
    insta::assert_snapshot!(faults("end = [1, 0, 0]", "end = [1e308, 0, 0]"), @"beam.toml:13:56: `rods.0.shape.end.0`: 1e308 is out of range; allowed: at most 1e100 in magnitude");
    insta::assert_snapshot!(faults("radius = \"5 mm\"", "radius = -1e308"), @"beam.toml:11:10: `rods.0.radius`: -1e308 is out of range; allowed: greater than 0");
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
    insta::assert_snapshot!(faults("kind = \"straight\"", "kind = \"strait\""), @r#"beam.toml:13:18: `rods.0.shape.kind`: "strait" is not a valid value; allowed: straight, helix, arc, ring, catenary, slack, coil, points (did you mean `straight`?)"#);
    insta::assert_snapshot!(faults("end = [1, 0, 0]", "end = [1, 0]"), @"beam.toml:13:55: `rods.0.shape.end`: expected an array of 3 values, found 2");
    insta::assert_snapshot!(faults("end = [1, 0, 0]", "end = [0, 0, 0]"), @"beam.toml:13:55: `rods.0.shape.end`: the line has no length: `start` and `end` are the same");
    insta::assert_snapshot!(faults("kind = \"straight\", ", ""), @"beam.toml:13:9: `rods.0.shape`: missing key `kind`; allowed: straight, helix, arc, ring, catenary, slack, coil, points");
    insta::assert_snapshot!(faults("kind = \"gravity\"", "kind = \"gravitation\""), @r#"beam.toml:20:8: `loads.0.kind`: "gravitation" is not a valid value; allowed: gravity, force, moment, distributed, drag (did you mean `gravity`?)"#);
    insta::assert_snapshot!(faults("at = \"start\"", "at = \"middle\""), @r#"beam.toml:17:6: `clamps.0.at`: invalid value: string "middle", expected "start", "end" or a number counted from zero"#);
    insta::assert_snapshot!(faults("at = \"start\"", "at = -1"), @"beam.toml:17:6: `clamps.0.at`: -1 is out of range; allowed: 0 and up");
    insta::assert_snapshot!(faults("mode = \"static\"", "mode = \"continuation\""), @"beam.toml:1:1: missing key `continuation` (a table [continuation] with the end of the parameter, `to`)");
    insta::assert_snapshot!(faults("mode = \"static\"", "mode = \"continuation\"\n[continuation]\nfrom = 2\nto = 2"), @"beam.toml:27:6: `continuation.to`: 2.0 is out of range; allowed: any but `from`");
    insta::assert_snapshot!(faults("mode = \"static\"", "mode = \"continuation\"\n[continuation]\nto = -2\nstep = 3"), @"beam.toml:27:8: `continuation.step`: 3.0 is out of range; allowed: at most |to − from| = 2.0");
    insta::assert_snapshot!(faults("[output]", "[contact]\nmodel = \"imc\"\nfriction = 0.1\n[output]"), @r#"beam.toml:28:12: `contact.friction`: an equilibrium has no friction: leave the key out, or let the rods come to rest with time.mode = "dynamic""#);
    insta::assert_snapshot!(faults("[output]", "[[planes]]\npoint = [0, 0, -1]\nnormal = [0, 0, 1]\nfriction = 0.1\n[output]"), @r#"beam.toml:29:12: `planes.0.friction`: an equilibrium has no friction: leave the key out, or let the rods come to rest with time.mode = "dynamic""#);
    insta::assert_snapshot!(faults("[output]", "[contact]\nmodel = \"imc\"\n[[planes]]\npoint = [0, 0, -1]\ndirected_friction = { forwards = 0.1, backwards = 0.2, sideways = 0.3 }\n[output]"), @r#"beam.toml:30:21: `planes.0.directed_friction`: an equilibrium has no friction: leave the key out, or let the rods come to rest with time.mode = "dynamic""#);
    insta::assert_snapshot!(faults("mode = \"static\"", "mode = \"static\"\n[solver]\nforce_tolerance = 1e300\ndisplacement_tolerance = 2"), @r"
beam.toml:26:19: `solver.force_tolerance`: 1e300 is out of range; allowed: greater than 0 and at most 0.001
beam.toml:27:26: `solver.displacement_tolerance`: 2.0 is out of range; allowed: greater than 0 and at most 1
");
    insta::assert_snapshot!(faults("mode = \"static\"", "end = 0"), @"beam.toml:24:7: `time.end`: 0.0 is out of range; allowed: greater than 0");
    insta::assert_snapshot!(faults("mode = \"static\"", "end = 1\nstep = 0"), @"beam.toml:25:8: `time.step`: 0.0 is out of range; allowed: greater than 0");
    insta::assert_snapshot!(faults("mode = \"static\"", "end = 1\nstep = 1e-12\n[solver]\nminimum_step = 1e-9"), @"beam.toml:25:8: `time.step`: 1e-12 s is out of range; allowed: at least solver.minimum_step = 1e-9 s");
    insta::assert_snapshot!(faults("mode = \"static\"", "mode = \"static\"\nend = 3"), @"beam.toml:25:7: `time.end`: a static run has no time steps; leave the key out");
    insta::assert_snapshot!(faults("[output]", "[contact]\nmodel = \"complementarity\"\nslip_tolerance = 1\n[output]"), @r#"
beam.toml:27:9: `contact.model`: "complementarity" needs a dynamic run with the scheme "implicit-euler"
beam.toml:28:18: `contact.slip_tolerance`: the model "complementarity" is rigid and sticks; leave the key out
"#);
    insta::assert_snapshot!(faults("[output]", "[contact]\nmodel = \"complementarity\"\nfriction_at = \"surface\"\n[output]"), @r#"
beam.toml:27:9: `contact.model`: "complementarity" needs a dynamic run with the scheme "implicit-euler"
beam.toml:28:15: `contact.friction_at`: the model "complementarity" allows "centreline" only; "surface" needs the model "imc" or "ipc"
"#);
    insta::assert_snapshot!(faults("[output]", "[contact]\nmodel = \"complementarity\"\ngeometry = \"smooth\"\n[output]"), @r#"
beam.toml:27:9: `contact.model`: "complementarity" needs a dynamic run with the scheme "implicit-euler"
beam.toml:28:12: `contact.geometry`: the model "complementarity" allows "polyline" only; "smooth" needs the model "imc" or "ipc"
"#);
    insta::assert_snapshot!(faults("[output]", "[contact]\ngeometry = \"smooth\"\nfriction_at = \"surface\"\n[output]"), @r#"beam.toml:27:12: `contact.geometry`: "smooth" needs friction on the centrelines; leave out friction_at"#);
    insta::assert_snapshot!(faults("[output]", "[contact]\nmodel = \"ipc\"\nmaximum_penetration = 0.1\n[output]"), @r#"beam.toml:28:23: `contact.maximum_penetration`: the model "ipc" allows no penetration; leave the key out"#);
    insta::assert_snapshot!(faults("[output]", "[contact]\nmodel = \"ipc\"\ndistance_tolerance = \"6 mm\"\nfriction = -0.1\nslip_tolerance = 0\n[output]"), @r#"
beam.toml:28:22: `contact.distance_tolerance`: 0.006 m is out of range; allowed: at most the smallest radius, 0.005 m
beam.toml:29:12: `contact.friction`: -0.1 is out of range; allowed: at least 0
beam.toml:30:18: `contact.slip_tolerance`: 0.0 is out of range; allowed: greater than 0
"#);
    insta::assert_snapshot!(faults("[output]", "[sweep]\nrods = 1\n[output]"), @"beam.toml:26:2: `sweep`: expected a single case, found a sweep");
    insta::assert_snapshot!(faults("[output]", "[fluid]\nmodel = \"resistive\"\n[output]"), @"beam.toml:26:1: `fluid`: missing key `viscosity` (a viscosity, greater than 0)");
    insta::assert_snapshot!(faults("[output]", "[fluid]\nviscosity = 1\nfar_field_error = 1e-9\n[output]"), @"beam.toml:28:19: `fluid.far_field_error`: 1e-9 is out of range; allowed: 0, or from 1e-6 to 1e-2");
    insta::assert_snapshot!(faults("nodes = true", "nodes = 1979-05-27"), @"beam.toml:27:9: `output.nodes`: expected `true` or `false`, found a date");
    insta::assert_snapshot!(faults("nodes = true", "nodes = "), @"beam.toml:27:9: not TOML: string values must be quoted, expected literal string");
    insta::assert_snapshot!(faults("experiment = \"scene\"\n", ""), @r#"beam.toml:1:1: missing key `experiment` ("scene", "flagella", "knot-tightening", "knot-inversion" or "helix-stability")"#);
    insta::assert_snapshot!(faults("experiment = \"scene\"\n", "experiment = \"folding\"\n"), @r#"beam.toml:1:14: `experiment`: "folding" is not a valid value; allowed: scene, flagella, knot-tightening, knot-inversion, helix-stability"#);
    insta::assert_snapshot!(read("").unwrap_err().to_string(), @r###"
beam.toml:1:1: `time`: missing key `end` (a time, greater than 0)
beam.toml:1:1: missing key `experiment` ("scene", "flagella", "knot-tightening", "knot-inversion" or "helix-stability")
"###);
}

#[test]
fn friction_by_direction_names_the_contact_that_it_needs() {
    let moving = BEAM.replace("mode = \"static\"", "end = 1");
    let fault = |contact: &str, plane: &str| {
        let own = "directed_friction = { forwards = 0.1, backwards = 0.2, sideways = 0.3 }";
        let text = format!(
            "{moving}\n[contact]\n{contact}\n[[planes]]\npoint = [0, 0, -1]\n{own}\n{plane}"
        );
        let faults = read(&text).unwrap_err().to_string();
        let (_, reason) = faults.split_once("`planes.0.directed_friction`: ").unwrap();
        reason.to_owned()
    };
    for (contact, plane, word) in [
        ("", "friction = 0.1", "`friction` exclude each other"),
        (
            "model = \"complementarity\"",
            "",
            "the model \"imc\" or \"ipc\"",
        ),
        (
            "friction_at = \"surface\"",
            "",
            "leave out contact.friction_at",
        ),
        (
            "geometry = \"smooth\"",
            "",
            "contact.geometry = \"polyline\"",
        ),
    ] {
        let reason = fault(contact, plane);
        assert!(reason.contains(word), "{reason}");
    }
}

/// Such a run would silently stay at its configuration at time 0.
#[test]
fn a_static_run_with_a_motion_or_a_schedule_is_refused() {
    let moving = BEAM.replace(
        "at = \"start\"",
        "at = \"start\"\nmove = [[0, [0, 0, 0]], [1, [0, 0, 0.1]]]\nturn = [[0, 0], [1, 2]]",
    );
    let error = read(&moving).unwrap_err().to_string();
    for key in ["clamps.0.move", "clamps.0.turn"] {
        assert!(error.contains(key), "{error}");
    }
    assert!(error.contains("a static run has no time"), "{error}");
    // The axis could be misread as the direction in which the clamp holds the rod.
    let turned = BEAM.replace("at = \"start\"", "at = \"start\"\naxis = [0, 1, 0]");
    let error = read(&turned).unwrap_err().to_string();
    assert!(error.contains("clamps.0.axis"), "{error}");
    let growing = BEAM.replace("-9.81]", "-9.81]\nschedule = [[0, 0], [1, 1]]");
    let error = read(&growing).unwrap_err().to_string();
    assert!(error.contains("loads.0.schedule"), "{error}");
    let dynamic = moving.replace("mode = \"static\"", "end = 1");
    assert!(read(&dynamic).is_ok());
}

#[test]
fn actuations_that_make_no_sense_are_refused() {
    let fault = |keys: &str| {
        let table = format!("[[actuation]]\n{keys}\n[output]");
        faults("[output]", &table)
    };
    insta::assert_snapshot!(fault("kind = \"curvature\"\nrod = \"beam\""), @r##"beam.toml:26:1: `actuation.0`: missing key `values` ([[time, strain], ...], or the `amplitude` of a wave)"##);
    insta::assert_snapshot!(fault("kind = \"curvature\"\nvalues = []"), @r##"
beam.toml:26:1: `actuation.0`: missing key `rod` (the name of a rod)
beam.toml:28:10: `actuation.0.values`: no values; give [[time, strain], ...]
"##);
    insta::assert_snapshot!(fault("kind = \"curvature\"\nrod = \"beam\"\nvalues = [[0, 1]]\ndirection = 3"), @r##"beam.toml:30:13: `actuation.0.direction`: 3 is out of range; allowed: 1 to 2"##);
    insta::assert_snapshot!(fault("kind = \"twist\"\nrod = \"beam\"\nvalues = [[0, \"1 1/m\"]]\nfrequency = 3"), @r##"beam.toml:30:13: `actuation.0.frequency`: this key is for waves; give it or `values`, not both"##);
    insta::assert_snapshot!(fault("kind = \"twist\"\nrod = \"beam\"\nvalues = [[0, \"1 m\"]]"), @r##"beam.toml:29:15: `actuation.0.values.0.1`: "1 m" is a length, but this key takes a twist; allowed units: rad/m, deg/m, turn/m, 1/m"##);
    insta::assert_snapshot!(fault("kind = \"twist\"\nrod = \"beam\"\nvalues = [[0, 1], [1, 2]]"), @r##"beam.toml:29:10: `actuation.0.values`: a static run has no time, so nothing changes in it (give one value, such as values = [[0, 5]]; or follow the equilibria with time.mode = "continuation", whose parameter replaces the time; or run dynamically)"##);
    insta::assert_snapshot!(fault("kind = \"twist\"\nrod = \"beam\"\namplitude = 1\nfrequency = 1"), @r##"beam.toml:30:13: `actuation.0.frequency`: a static run has no time, so nothing changes in it (give one value, such as values = [[0, 5]]; or follow the equilibria with time.mode = "continuation", whose parameter replaces the time; or run dynamically)"##);
    insta::assert_snapshot!(fault("kind = \"length\"\nrod = \"beam\"\nvalues = [[0, -0.5]]\n[[actuation]]\nkind = \"length\"\nrod = \"beam\"\namplitude = 0.5"), @r##"beam.toml:33:13: `actuation.1.amplitude`: the rod would be shorter by 1.0 of its length at once; allowed: at most 0.9"##);
    insta::assert_snapshot!(fault("kind = \"twist\"\nrod = \"beam\"\nvalues = [[0, 1]]\nfrom = 0.3\nto = 0.2"), @r##"beam.toml:31:6: `actuation.0.to`: 0.2 m is out of range; allowed: greater than `from` = 0.3 m"##);
    insta::assert_snapshot!(fault("kind = \"bend\"\nrod = \"beam\""), @r##"beam.toml:27:8: `actuation.0.kind`: "bend" is not a valid value; allowed: curvature, twist, length"##);
}

#[test]
fn a_scene_in_which_nothing_can_move_is_refused() {
    insta::assert_snapshot!(faults("edges = 50", "edges = 50\nheld = true"), @"beam.toml:9:1: `rods`: every rod is held; at least one must be free to move");
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
beam.toml:7:11: `material.density`: "1 kg" is a mass, but this key takes a density; allowed units: kg/m^3, g/cm^3
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
    insta::assert_snapshot!(faults("[[clamps]]", two), @"beam.toml:16:8: `rods.1.name`: rod 0 has the same name, `beam`; names must be unique");
    insta::assert_snapshot!(faults("name = \"beam\"", "name = \"a.b\""), @r#"beam.toml:10:8: `rods.0.name`: "a.b" cannot be a name; allowed: letters, digits, `_` and `-`, not digits alone"#);
}

proptest! {
    #[test]
    fn no_bytes_in_a_file_make_it_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("noise.toml");
        std::fs::write(&path, bytes).unwrap();
        if let Err(error) = load(*EXPERIMENTS, &path, &[]) {
            error.render(false);
        }
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

#[test]
fn a_tangent_modulus_needs_a_yield_stress_and_is_below_youngs_modulus() {
    let with = |keys: &str| {
        let keys = format!("density = 1000.0\n{keys}");
        BEAM.replacen("density = 1000.0", &keys, 1)
    };
    let fault = |keys: &str| read(&with(keys)).unwrap_err().to_string();
    for (keys, expected) in [
        ("tangent_modulus = 1e6", "missing key `yield_stress`"),
        ("yield_stress = 0.0", "greater than 0"),
        (
            "yield_stress = 1e6\ntangent_modulus = 1e15",
            "less than Young's modulus",
        ),
    ] {
        let error = fault(keys);
        assert!(error.contains(expected), "{error}");
    }
    let text = with("yield_stress = \"2 MPa\"\ntangent_modulus = \"1 MPa\"");
    let scenario = read(&text).unwrap();
    let material = scenario.rods[0].material;
    assert_eq!(
        (material.yield_stress, material.tangent_modulus),
        (2e6, 1e6)
    );
    assert_eq!(read(&scenario.to_toml()).unwrap(), scenario);
}

#[test]
fn the_viscosity_of_a_material_is_given_once_and_what_relaxes_with_its_time() {
    let fault = |keys: &str| {
        let with =
            |text: &str| text.replacen("density = 1000.0", &format!("density = 1000.0\n{keys}"), 1);
        read(&with(BEAM)).unwrap_err().to_string()
    };
    insta::assert_snapshot!(fault("viscosity = -1.0"), @"beam.toml:8:13: `material.viscosity`: -1.0 is out of range; allowed: at least 0");
    insta::assert_snapshot!(fault("loss_factor = 0.1"), @"beam.toml:4:1: `material`: missing key `loss_frequency` (the frequency at which that is the loss factor)");
    insta::assert_snapshot!(fault("loss_frequency = 10"), @"beam.toml:4:1: `material`: missing key `loss_factor` (the loss factor at `loss_frequency`)");
    insta::assert_snapshot!(fault("viscosity = 1\nloss_factor = 0.1\nloss_frequency = 10"), @"beam.toml:9:15: `material.loss_factor`: give `viscosity` or `loss_factor`, not both");
    insta::assert_snapshot!(fault("relaxing_modulus = 0.0\nrelaxation_time = 1"), @"beam.toml:8:20: `material.relaxing_modulus`: 0.0 is out of range; allowed: greater than 0");
    insta::assert_snapshot!(fault("relaxing_modulus = 1e6"), @"beam.toml:4:1: `material`: missing key `relaxation_time` (the time in which `relaxing_modulus` relaxes)");
    insta::assert_snapshot!(fault("relaxation_time = 1"), @"beam.toml:4:1: `material`: missing key `relaxing_modulus` (the modulus that relaxes)");
    let relaxing = BEAM.replace(
        "density = 1000.0",
        "density = 1000.0\nrelaxing_modulus = \"2 MPa\"\nrelaxation_time = \"0.1 s\"",
    );
    let scenario = read(&relaxing).unwrap();
    let material = scenario.rods[0].material;
    assert_eq!(
        (material.relaxing_modulus, material.relaxation_time),
        (2e6, 0.1)
    );
    assert_eq!(read(&scenario.to_toml()).unwrap(), scenario);
    let viscous = BEAM.replace(
        "density = 1000.0",
        "density = 1000.0\nloss_factor = 0.1\nloss_frequency = \"10 Hz\"",
    );
    let scenario = read(&viscous).unwrap();
    let viscosity = 0.1 * 1e8 / (20.0 * std::f64::consts::PI);
    let found = scenario.rods[0].material.viscosity;
    assert!((found / viscosity - 1.0).abs() < 1e-14);
    assert_eq!(read(&scenario.to_toml()).unwrap(), scenario);
    // The material of a rod takes precedence over the common one.
    let own = viscous.replace("edges = 50", "edges = 50\nmaterial = { viscosity = 2.0 }");
    assert_eq!(read(&own).unwrap().rods[0].material.viscosity, 2.0);
    let midpoint = viscous.replace(
        "mode = \"static\"",
        "scheme = \"implicit-midpoint\"\nend = 1",
    );
    let error = read(&midpoint).unwrap_err().to_string();
    assert!(error.contains("time.scheme"), "{error}");
}

#[test]
fn chains_that_cannot_hang_are_refused() {
    let fault = |shape: &str| {
        let straight = "kind = \"straight\", start = [0, 0, 0], end = [1, 0, 0]";
        faults(straight, &format!("kind = \"catenary\", {shape}"))
    };
    insta::assert_snapshot!(fault("start = [0, 0, 0], end = [3, 0, 4], length = 5"), @r##"beam.toml:13:75: `rods.0.shape.length`: 5.0 m is out of range; allowed: greater than the distance of the ends, 5.0 m"##);
    insta::assert_snapshot!(fault("start = [0, 0, 0], end = [0, 0, 4], length = 5"), @r##"beam.toml:13:55: `rods.0.shape.end`: the horizontal distance of the ends is 0.0 m; allowed: at least a thousandth of the length"##);
    insta::assert_snapshot!(fault("start = [0, 0, 0], end = [0, 0, 4]"), @r##"beam.toml:13:9: `rods.0.shape`: missing key `length` (a length, greater than 0)"##);
}

#[test]
fn slack_rods_and_coils_that_cannot_lie_so_are_refused() {
    let straight = "kind = \"straight\", start = [0, 0, 0], end = [1, 0, 0]";
    let slack = |keys: &str| faults(straight, &format!("kind = \"slack\", {keys}"));
    insta::assert_snapshot!(slack("start = [0, 0, 0], end = [3, 0, 4], length = 5, towards = [0, 1, 0]"), @r##"beam.toml:13:72: `rods.0.shape.length`: 5.0 m is out of range; allowed: greater than the distance of the ends, 5.0 m"##);
    insta::assert_snapshot!(slack("start = [0, 0, 0], end = [3, 0, 4], length = 6000, towards = [0, 1, 0]"), @r##"beam.toml:13:52: `rods.0.shape.end`: the ends are 5.0 m apart; allowed: at least a thousandth of the length"##);
    insta::assert_snapshot!(slack("start = [0, 0, 0], end = [3, 0, 4], length = 6, towards = [6, 0, 8]"), @r##"beam.toml:13:85: `rods.0.shape.towards`: the direction must not be along the line from `start` to `end`"##);
    insta::assert_snapshot!(slack("start = [0, 0, 0], end = [3, 0, 4], length = 6"), @r##"beam.toml:13:9: `rods.0.shape`: missing key `towards` (a direction [x, y, z])"##);
    insta::assert_snapshot!(slack("start = [0, 0, 0], end = [0, 0, 0], length = 6, towards = [0, 1, 0]"), @r##"beam.toml:13:52: `rods.0.shape.end`: the ends are 0.0 m apart; allowed: at least a thousandth of the length"##);
    let coil = |keys: &str| {
        faults(
            straight,
            &format!("kind = \"coil\", centre = [0, 0, 0], {keys}"),
        )
    };
    insta::assert_snapshot!(coil("inner_radius = 0.1, spacing = 0.01, length = 2"), @r##"beam.toml:13:76: `rods.0.shape.spacing`: 0.01 m is out of range; allowed: greater than the diameter of the rod, 0.01 m"##);
    insta::assert_snapshot!(coil("inner_radius = 0.01, spacing = 0.02, length = 2"), @r##"beam.toml:12:9: `rods.0.edges`: 50 is out of range; allowed: 200 to 1000000"##);
    insta::assert_snapshot!(coil("inner_radius = 0, spacing = 0.02, length = 2"), @r##"beam.toml:13:61: `rods.0.shape.inner_radius`: 0.0 is out of range; allowed: greater than 0"##);
}

#[test]
fn a_tension_that_no_rod_begins_with_is_refused() {
    let straight = "shape = { kind = \"straight\", start = [0, 0, 0], end = [1, 0, 0] }";
    let fault = |keys: &str| faults(straight, &format!("{straight}\n{keys}"));
    insta::assert_snapshot!(fault("pretension = \"5 m\""), @r##"beam.toml:14:14: `rods.0.pretension`: "5 m" is a length, but this key takes a force; allowed units: N, kN, mN, µN, uN"##);
    insta::assert_snapshot!(fault("pretension = \"-8 kN\""), @r##"beam.toml:14:14: `rods.0.pretension`: -8000.0 N is out of range; allowed: at least -0.9 EA = -7068.583470577035 N"##);
    insta::assert_snapshot!(fault("pretension = 1\nnatural_shape = { kind = \"straight\", start = [0, 0, 0], end = [0.9, 0, 0] }"), @r##"beam.toml:14:14: `rods.0.pretension`: the natural shape has its own lengths; give it or `pretension`, not both"##);
}
