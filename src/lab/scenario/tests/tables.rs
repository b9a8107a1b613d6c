//! Scenarios built in memory: faults name the table and the key. All tests of faults also assert,
//! in `read_with`, that these are the faults of the corresponding file.

use super::{BEAM, EXPERIMENTS};
use crate::scenario::{CaseSet, Contact, Loaded, ScenarioError, from_table};
use std::path::Path;
use toml::{Table, Value, toml};

fn beam() -> Table {
    BEAM.parse().unwrap()
}

fn read(table: Table, set: &[&str]) -> Result<Loaded, ScenarioError> {
    let set: Vec<String> = set.iter().map(|&text| text.to_owned()).collect();
    from_table(*EXPERIMENTS, "beam", table, Path::new(""), &set)
}

/// The message for a beam with another radius.
fn fault(radius: impl Into<Value>) -> String {
    let mut table = beam();
    table["rods"][0]["radius"] = radius.into();
    read(table, &[]).unwrap_err().to_string()
}

#[test]
fn faults_name_table_key_and_range() {
    insta::assert_snapshot!(fault(-5.0), @"beam: `rods.0.radius`: -5.0 is out of range; allowed: greater than 0");
    insta::assert_snapshot!(fault(f64::NAN), @"beam: `rods.0.radius`: NaN is not a finite number");
    insta::assert_snapshot!(fault(f64::NEG_INFINITY), @"beam: `rods.0.radius`: -inf is not a finite number");
    insta::assert_snapshot!(fault("5 MPa"), @r#"beam: `rods.0.radius`: "5 MPa" is a pressure, but this key takes a length; allowed units: m, cm, mm, µm, um, nm, km, in"#);
    insta::assert_snapshot!(fault("5*radiu"), @"beam: `rods.0.radius`: unknown name `radiu` (did you mean `random`?)");
    let date: toml::value::Datetime = "1979-05-27".parse().unwrap();
    insta::assert_snapshot!(fault(date), @"beam: `rods.0.radius`: expected a number or text, found a date");
    let list = (0..100).fold(Value::from(1), |list, _| Value::Array(vec![list]));
    assert!(
        fault(list)
            .ends_with(": arrays and tables are nested more than 80 deep; allowed: at most that")
    );
    insta::assert_snapshot!(read(Table::new(), &[]).unwrap_err().to_string(), @r#"
beam: `time`: missing key `end` (a time, greater than 0)
beam: missing key `experiment` ("scene", "flagella", "knot-tightening", "knot-inversion" or "helix-stability")
"#);
    // An override has its own text.
    insta::assert_snapshot!(read(beam(), &["rods.beam.radius=-1"]).unwrap_err().to_string(), @"--set:1:18: `rods.0.radius`: -1.0 is out of range; allowed: greater than 0");
}

#[test]
fn faults_come_in_the_order_of_the_table_and_are_shown_without_lines() {
    let mut table = beam();
    table["output"]["nodes"] = Value::from(1);
    let rod = table["rods"][0].as_table_mut().unwrap();
    rod.insert("raduis".into(), "5 mm".into());
    insta::assert_snapshot!(read(table, &[]).unwrap_err().render(false), @r###"
 × `rods.0.raduis`: unknown key
 help: did you mean `radius`?
 × `output.nodes`: expected `true` or `false`, found a whole number
"###);
}

#[test]
fn files_are_named_relative_to_the_directory() {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("base.toml"), BEAM).unwrap();
    let variant = toml! {
        extends = "base.toml"
        unset = ["title"]
        [parameters]
        radius = "4 mm"
        [contact]
        model = "ipc"
        distance_tolerance = "radius/8"
    };
    let read = |table| from_table(*EXPERIMENTS, "beam", table, directory.path(), &[]);
    let loaded = read(variant.clone()).unwrap();
    let Contact::Ipc {
        distance_tolerance, ..
    } = loaded.scenario.contact
    else {
        panic!("{:?}", loaded.scenario.contact);
    };
    assert_eq!(distance_tolerance, 5e-4);
    // A fault in the extended file is reported at its position there.
    std::fs::write(directory.path().join("base.toml"), BEAM.replace("50", "0")).unwrap();
    let error = read(variant).unwrap_err().to_string();
    assert!(error.contains("base.toml:12:9: `rods.0.edges`"), "{error}");
    let lost = toml! { include = "nowhere.toml" };
    let error = read(lost).unwrap_err().to_string();
    assert!(error.starts_with("beam: `include`: "), "{error}");
}

#[test]
fn sweeps_are_read_with_overrides_and_varied_keys() {
    let mut table = beam();
    let swept = toml! { rods.beam.edges = [10, 20, 30] };
    table.insert("sweep".into(), swept.into());
    let cases = |set: &str, varied: &str| {
        let (set, varied) = ([set.to_owned()], [varied.to_owned()]);
        CaseSet::from_table(
            *EXPERIMENTS,
            "beam",
            table.clone(),
            Path::new(""),
            &set,
            &varied,
        )
    };
    let set = cases("rods.beam.radius=1 mm", "material.density=1,2").unwrap();
    assert_eq!(set.count(), 6);
    let rod = &set.scenario_of(5).unwrap().scenario.rods[0];
    assert_eq!(
        (rod.radius, rod.edges, rod.material.density),
        (1e-3, 30, 2.0)
    );
    let error = cases("rods.beam.radius=1 mm", "sweep=1,2").unwrap_err();
    assert!(error.to_string().starts_with("--vary:1:1: "), "{error}");
}
