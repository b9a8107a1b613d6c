//! Scenarios that extend others, are overridden from the command line, or read shape files.

use super::{BEAM, EXPERIMENTS};
use crate::scenario::{Scenario, Shape, load};
use proptest::prelude::*;

/// Writes files into a fresh directory.
fn directory(files: &[(&str, &str)]) -> tempfile::TempDir {
    let directory = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = directory.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
    directory
}

/// Loads a file of a directory; faults do not contain the directory's name.
fn load_from(directory: &tempfile::TempDir, name: &str, set: &[&str]) -> Result<Scenario, String> {
    let set: Vec<String> = set.iter().map(|&text| text.to_owned()).collect();
    load(*EXPERIMENTS, &directory.path().join(name), &set)
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
    insta::assert_snapshot!(fault("circle.toml"), @"circle.toml:1:11: `extends`: circle.toml extends this file again: a circular reference");
    insta::assert_snapshot!(fault("lost.toml"), @"lost.toml:1:11: `extends`: nowhere.toml cannot be read: No such file or directory (os error 2)");
    insta::assert_snapshot!(fault("none.toml"), @"none.toml cannot be read: No such file or directory (os error 2)");
}

#[test]
fn included_files_add_to_a_scenario() {
    let other = BEAM.replace("name = \"beam\"", "name = \"other\"");
    let directory = directory(&[
        ("parts/curve.csv", "x,y,z\n0,0,0\n1,0,0\n1,1,0\n"),
        (
            "parts/curve.toml",
            "include = \"more.toml\"\n[parameters]\nr = \"2 mm\"\n[[rods]]\nname = \"curve\"\nradius = \"r\"\nshape = { kind = \"points\", file = \"curve.csv\" }\n",
        ),
        (
            "parts/more.toml",
            "[material]\ndensity = 7\nviscosity = \"1 Pa s\"\n",
        ),
        (
            "one.toml",
            &format!("include = \"parts/curve.toml\"\n{BEAM}"),
        ),
        (
            "list.toml",
            &format!(
                "include = [\"one.toml\", \"other.toml\"]\n{}",
                BEAM.replace("\"beam\"", "\"third\"")
            ),
        ),
        ("other.toml", &other),
        (
            "extending.toml",
            "extends = \"other.toml\"\ninclude = \"parts/curve.toml\"\n",
        ),
        ("circle.toml", "include = \"parts/circle.toml\"\n"),
        ("parts/circle.toml", "extends = \"../circle.toml\"\n"),
        (
            "wrong.toml",
            &format!("include = [\"other.toml\", 3]\n{BEAM}"),
        ),
        ("lost.toml", &format!("include = \"nowhere.toml\"\n{BEAM}")),
    ]);
    let scenario = load_from(&directory, "one.toml", &[]).unwrap();
    let names = |scenario: &Scenario| -> Vec<String> {
        scenario.rods.iter().map(|rod| rod.name.clone()).collect()
    };
    assert_eq!(names(&scenario), ["beam", "curve"]);
    assert_eq!(scenario.rods[1].radius, 2e-3);
    // Existing keys are kept; missing ones are added.
    assert_eq!(scenario.rods[0].material.density, 1000.0);
    assert_eq!(scenario.rods[0].material.viscosity, 1.0);
    let scenario = load_from(&directory, "list.toml", &["parameters.r=3mm"]).unwrap();
    assert_eq!(names(&scenario), ["third", "beam", "curve", "other"]);
    assert_eq!(scenario.rods[2].radius, 3e-3);
    let scenario = load_from(&directory, "extending.toml", &[]).unwrap();
    assert_eq!(names(&scenario), ["other", "curve"]);
    let fault = |name| load_from(&directory, name, &[]).unwrap_err();
    insta::assert_snapshot!(fault("circle.toml"), @"parts/circle.toml:1:11: `extends`: parts/../circle.toml extends this file again: a circular reference");
    insta::assert_snapshot!(fault("wrong.toml"), @"wrong.toml:1:26: `include`: expected the name of a file, or a list of them, found a whole number");
    insta::assert_snapshot!(fault("lost.toml"), @"lost.toml:1:11: `include`: nowhere.toml cannot be read: No such file or directory (os error 2)");
    let set = load_from(&directory, "one.toml", &["include=other.toml"]);
    insta::assert_snapshot!(set.unwrap_err(), @"--set:1:1: `include`: this key cannot be set from the command line");
}

#[test]
fn an_inherited_key_is_unset() {
    let base = BEAM.replace(
        "mode = \"static\"",
        "step = 0.001\nend = 2.0\nscheme = \"implicit-euler\"",
    );
    let extended = |rest: &str| format!("extends = \"base.toml\"\n{rest}");
    let files = [
        ("base.toml", base.clone()),
        (
            "static.toml",
            extended(
                "unset = [\"time.end\", \"time.step\", \"time.scheme\", \"rods.beam.edges\"]\ntime.mode = \"static\"\nrods = [{ name = \"b\", radius = 1e-3, edges = 3, shape = { kind = \"straight\", start = [0, 0, 0], end = [1, 0, 0] } }]\nclamps = []\n",
            ),
        ),
        ("without.toml", extended("time.mode = \"static\"\n")),
        (
            "again.toml",
            "extends = \"static.toml\"\ntitle = \"again\"\n".to_owned(),
        ),
        ("absent.toml", extended("unset = [\"time.ends\"]\n")),
        ("text.toml", extended("unset = \"time.end\"\n")),
        ("alone.toml", format!("unset = [\"time.end\"]\n{base}")),
    ];
    let files: Vec<(&str, &str)> = files
        .iter()
        .map(|(name, text)| (*name, text.as_str()))
        .collect();
    let directory = directory(&files);
    assert!(load_from(&directory, "without.toml", &[]).is_err());
    assert!(load_from(&directory, "static.toml", &[]).is_ok());
    assert_eq!(
        load_from(&directory, "again.toml", &[]).unwrap().title,
        "again"
    );
    let fault = |name| load_from(&directory, name, &[]).unwrap_err();
    insta::assert_snapshot!(fault("absent.toml"), @"absent.toml:2:10: `unset`: there is no inherited key `time.ends` (did you mean `end`?)");
    insta::assert_snapshot!(fault("text.toml"), @r#"text.toml:2:9: `unset`: expected a list of dotted keys in quotes, found text (unset = ["time.end"])"#);
    insta::assert_snapshot!(fault("alone.toml"), @"alone.toml:1:1: `unset`: nothing is inherited here; this key is allowed only beside `extends`");
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
    // A value cannot contain further keys.
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
    fn no_override_makes_it_panic(text in "[a-z0-9.]{0,12}=?\\PC{0,12}") {
        let directory = directory(&[("beam.toml", BEAM)]);
        let _ = load_from(&directory, "beam.toml", &[&text]);
    }
}
