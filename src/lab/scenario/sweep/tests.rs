//! Sweeps, from their text to the scenarios of the cases.

use super::CaseSet;
use crate::scenario::INPUTS;
use crate::scenario::Scenario;
use crate::scenario::tests::EXPERIMENTS;
use crate::test_support::cases;
use proptest::prelude::*;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

const ROPE: &str = r#"
experiment = "scene"
material = { youngs_modulus = "1 MPa", poissons_ratio = 0.5, density = 1000.0 }
time = { step = "1 ms", end = "20 ms" }

[[rods]]
name = "rope"
radius = "5 mm"
edges = 8
shape = { kind = "straight", start = [0, 0, 0], end = [0.2, 0, 0] }

[contact]
"#;

fn case_set(sweep: &str) -> CaseSet {
    CaseSet::from_text(
        *EXPERIMENTS,
        "rope",
        &format!("{ROPE}{sweep}"),
        Path::new(""),
    )
    .unwrap_or_else(|error| panic!("{error}"))
}

fn fault(sweep: &str) -> String {
    CaseSet::from_text(
        *EXPERIMENTS,
        "rope",
        &format!("{ROPE}{sweep}"),
        Path::new(""),
    )
    .expect_err("a fault")
    .to_string()
}

/// The case set of its own portable scenario, and the directory of that scenario.
fn copied(case_set: &CaseSet, name: &str) -> (CaseSet, tempfile::TempDir) {
    let directory = tempfile::tempdir().unwrap();
    let portable = case_set.portable().unwrap();
    for input in &portable.inputs {
        let path = directory.path().join(INPUTS).join(&input.name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, &input.contents).unwrap();
    }
    let again = CaseSet::from_text(*EXPERIMENTS, name, &portable.toml, directory.path());
    (again.unwrap(), directory)
}

fn scenarios(case_set: &CaseSet) -> Vec<Scenario> {
    (0..case_set.count() as usize)
        .map(|index| case_set.scenario_of(index).unwrap().scenario)
        .collect()
}

fn radii_and_edges(case_set: &CaseSet) -> Vec<(f64, usize)> {
    let rod = |scenario: Scenario| (scenario.rods[0].radius, scenario.rods[0].edges);
    scenarios(case_set).into_iter().map(rod).collect()
}

#[test]
fn a_file_without_sweep_has_one_case() {
    let case_set = case_set("");
    assert!(!case_set.is_sweep());
    assert_eq!(case_set.count(), 1);
    assert_eq!(radii_and_edges(&case_set), [(5e-3, 8)]);
}

#[test]
fn lists_and_ranges_make_a_full_product_whose_last_key_runs_fastest() {
    for sweep in [
        "[sweep]\nrods.rope.radius = [\"1 mm\", 0.002]\n\"rods.0.edges\" = { from = 4, to = 8, count = 3 }",
        "[sweep.rods.rope]\nradius = [\"1 mm\", 0.002]\nedges = [4, 6, 8]",
    ] {
        let case_set = case_set(sweep);
        assert_eq!(
            radii_and_edges(&case_set),
            [
                (1e-3, 4),
                (1e-3, 6),
                (1e-3, 8),
                (2e-3, 4),
                (2e-3, 6),
                (2e-3, 8)
            ]
        );
        let case = case_set.case(4);
        assert_eq!(case.parameters[0].column(), "0.002");
        assert_eq!(case.parameters[1].column(), "6");
        assert!(case.id.starts_with("edges-6_radius-0.002-"), "{}", case.id);
    }
}

#[test]
fn zipped_lists_vary_together() {
    let case_set = case_set(
        "[[sweep.zip]]\nrods.rope.radius = [\"1 mm\", \"2 mm\"]\nrods.rope.edges = [4, 8]\n\
         [[sweep.zip]]\ncontact.friction = [0.0, 0.5]",
    );
    assert_eq!(
        radii_and_edges(&case_set),
        [(1e-3, 4), (1e-3, 4), (2e-3, 8), (2e-3, 8)]
    );
    assert_eq!(
        case_set.keys(),
        ["rods.rope.radius", "rods.rope.edges", "contact.friction"]
    );
}

#[test]
fn points_come_from_a_file_beside_the_scenario() {
    let directory = tempfile::tempdir().unwrap();
    let points = "# made by hand\nrods.rope.radius, rods.rope.edges\n1 mm, 4\n2 mm, 8\n";
    fs::write(directory.path().join("points.csv"), points).unwrap();
    let text = format!("{ROPE}[sweep]\npoints = \"points.csv\"");
    let case_set = CaseSet::from_text(*EXPERIMENTS, "rope", &text, directory.path()).unwrap();
    assert_eq!(radii_and_edges(&case_set), [(1e-3, 4), (2e-3, 8)]);
    fs::write(directory.path().join("points.csv"), "rods.rope.radius\n").unwrap();
    let error = CaseSet::from_text(*EXPERIMENTS, "rope", &text, directory.path()).unwrap_err();
    assert!(error.to_string().contains("no rows"), "{error}");
    fs::write(directory.path().join("points.csv"), "a,b\n1\n").unwrap();
    let error = CaseSet::from_text(*EXPERIMENTS, "rope", &text, directory.path()).unwrap_err();
    assert!(error.to_string().contains("points.csv"), "{error}");
}

#[test]
fn samples_fill_the_ranges_without_a_count() {
    let case_set = case_set(
        "[sweep]\nrods.rope.radius = { from = \"1 mm\", to = \"4 mm\", scale = \"log\" }\n\
         contact.friction = { from = 0, to = 1.0 }\nsample = { method = \"sobol\", count = 8, seed = 3 }",
    );
    assert_eq!((case_set.count(), case_set.seed()), (8, Some(3)));
    let radii: BTreeSet<u64> = scenarios(&case_set)
        .iter()
        .map(|scenario| scenario.rods[0].radius.to_bits())
        .collect();
    assert_eq!(radii.len(), 8);
    assert!(
        radii
            .iter()
            .all(|bits| (1e-3..4e-3).contains(&f64::from_bits(*bits)))
    );
}

#[test]
fn the_family_as_toml_has_the_same_cases_with_the_same_ids() {
    let directory = tempfile::tempdir().unwrap();
    fs::write(
        directory.path().join("curve.csv"),
        "x,y,z\n0,0,0\n0.1,0,0\n0.2,0.1,0\n",
    )
    .unwrap();
    let shape = "shape = { kind = \"straight\", start = [0, 0, 0], end = [0.2, 0, 0] }";
    let text = ROPE.replace(shape, "shape = { kind = \"points\", file = \"curve.csv\" }")
        + "[sweep]\nrods.rope.radius = [\"1 mm\", 0.002]\nmaterial.density = { from = 1e3, to = 2e3, count = 2 }\n\
           contact.friction = { from = 0.0, to = 1.0 }\nsample = { method = \"random\", count = 3 }";
    let case_set = CaseSet::from_text(*EXPERIMENTS, "rope", &text, directory.path()).unwrap();
    let (again, _beside) = copied(&case_set, "scenario");
    assert_eq!(again.count(), 12);
    for index in 0..12 {
        assert_eq!(again.case(index).id, case_set.case(index).id);
        let [one, other] = [&case_set, &again]
            .map(|case_set| case_set.scenario_of(index).unwrap().scenario.to_toml());
        assert_eq!(one, other);
    }
    assert_eq!(again.portable().unwrap(), case_set.portable().unwrap());
}

#[test]
fn swept_files_lie_beside_the_scenario_of_the_sweep() {
    let parent = tempfile::tempdir().unwrap();
    let directory = parent.path().join("scenarios");
    fs::create_dir_all(parent.path().join("data")).unwrap();
    fs::create_dir_all(&directory).unwrap();
    let curve = |y: f64| format!("x,y,z\n0,0,0\n0.1,{y},0\n0.2,0.1,0\n");
    fs::write(directory.join("c1.csv"), curve(0.0)).unwrap();
    fs::write(parent.path().join("data/c2.csv"), curve(0.01)).unwrap();
    let poses = "time,x,y,z,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n";
    fs::write(parent.path().join("poses.csv"), poses).unwrap();
    let text = format!(
        "{ROPE}[[clamps]]\nrod = \"rope\"\nat = \"start\"\nfollow = \"../poses.csv\"\n\
         [sweep]\nrods.rope.shape = [{{ kind = \"points\", file = \"c1.csv\" }}, {{ kind = \"points\", file = \"../data/c2.csv\" }}]\n"
    );
    let case_set = CaseSet::from_text(*EXPERIMENTS, "rope", &text, &directory).unwrap();
    let portable = case_set.portable().unwrap();
    let names: Vec<&str> = portable
        .inputs
        .iter()
        .map(|input| input.name.as_str())
        .collect();
    assert_eq!(names, ["c1.csv", "data/c2.csv", "poses.csv"]);
    let (again, _beside) = copied(&case_set, "rope");
    for index in 0..2 {
        assert_eq!(again.case(index).id, case_set.case(index).id);
    }
    assert_eq!(scenarios(&again), scenarios(&case_set));
    assert_eq!(again.portable().unwrap(), portable);

    fs::write(parent.path().join("c1.csv"), curve(0.02)).unwrap();
    let twice = text.replace("../data/c2.csv", "../c1.csv");
    let case_set = CaseSet::from_text(*EXPERIMENTS, "rope", &twice, &directory).unwrap();
    let error = case_set.portable().unwrap_err().to_string();
    assert!(
        error.contains("another file has the name `c1.csv`"),
        "{error}"
    );
}

#[test]
fn extends_cannot_be_varied() {
    for key in ["extends", "sweep", "sweep.rods.0.edges"] {
        let text = format!("{ROPE}[sweep]\n\"{key}\" = [1, 2]");
        let error = CaseSet::from_text(*EXPERIMENTS, "rope", &text, Path::new("")).unwrap_err();
        assert!(error.to_string().contains("cannot be varied"), "{error}");
    }
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("rope.toml");
    fs::write(&path, ROPE).unwrap();
    let varied = ["extends=a.toml,b.toml".to_owned()];
    let error = CaseSet::load(*EXPERIMENTS, &path, &[], &varied).unwrap_err();
    assert!(error.to_string().contains("cannot be varied"), "{error}");
}

#[test]
fn one_key_by_two_paths_is_varied_twice() {
    let message = fault("[sweep]\nrods.rope.edges = [4, 6]\n\"rods.0.edges\" = [8, 10]");
    assert!(
        message.contains("varied twice, as `rods.rope.edges`, too"),
        "{message}"
    );
    let message = fault(
        "[sweep]\nrods.rope.shape.end = [[1, 0, 0]]\nrods.0.shape = [{ kind = \"straight\", start = [0, 0, 0], end = [2, 0, 0] }]",
    );
    assert!(message.contains("one is a part of the other"), "{message}");

    // On the command line the key replaces the key in the file, even if it is spelt differently.
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("rope.toml");
    fs::write(&path, format!("{ROPE}[sweep]\nrods.rope.edges = [4, 6]")).unwrap();
    let varied = ["rods.0.edges=8,10,12".to_owned()];
    let case_set = CaseSet::load(*EXPERIMENTS, &path, &[], &varied).unwrap();
    assert_eq!(case_set.keys(), ["rods.0.edges"]);
    assert_eq!(case_set.count(), 3);
    // Two arguments for one key are an error; the second must not silently replace the first.
    for second in ["rods.rope.edges=4,6", "rods.0.edges=4,6"] {
        let varied = ["rods.0.edges=8,10".to_owned(), second.to_owned()];
        let error = CaseSet::load(*EXPERIMENTS, &path, &[], &varied).unwrap_err();
        assert!(error.to_string().contains("varied twice"), "{error}");
    }
}

#[test]
fn more_cases_than_can_be_counted_are_not_none() {
    let range = "{ from = 1, to = 2.0, count = 65536 }";
    let keys = ["density", "a", "b", "c", "d", "e", "f", "g"];
    let keys = keys
        .map(|key| format!("material.{key} = {range}\n"))
        .concat();
    let case_set = case_set(&format!("[sweep]\n{keys}"));
    assert_eq!(case_set.count(), u128::MAX);
}

#[test]
fn three_hundred_thousand_cases_have_ids_of_their_own() {
    let mut ids = BTreeSet::new();
    for number in 0..300_000 {
        let value = crate::scenario::document::Value::Float(f64::from(number) * 1e-5);
        let parameter = super::Parameter::new(&"long_name_of_a_key_".repeat(4), &value);
        assert!(ids.insert(super::Case::new(vec![parameter]).id), "{number}");
    }
}

#[test]
fn ids_do_not_depend_on_the_other_cases() {
    let ids = |sweep: &str| -> BTreeSet<String> {
        let case_set = case_set(sweep);
        (0..case_set.count() as usize)
            .map(|index| case_set.case(index).id)
            .collect()
    };
    let few = ids("[sweep]\nrods.rope.edges = [4, 6]\ncontact.friction = [0.1]");
    let many = ids("[sweep]\ncontact.friction = [0.2, 0.1]\nrods.rope.edges = [8, 6, 4]");
    assert!(few.is_subset(&many));
    assert_eq!(many.len(), 6);
}

#[test]
fn a_search_adds_its_key_to_the_cases() {
    let case_set = case_set(
        "[sweep]\nrods.rope.edges = [4, 6]\n[sweep.search]\nmethod = \"bisect\"\nparameter = \"rods.rope.radius\"\n\
         objective = \"bending_energy_j\"\nfrom = \"1 mm\"\nto = \"3 mm\"\ntolerance = \"0.1 mm\"",
    );
    assert_eq!(case_set.count(), 2);
    assert_eq!(case_set.keys(), ["rods.rope.edges", "rods.rope.radius"]);
    assert_eq!(
        case_set.searched_case(1, 2.0).parameters[1].column(),
        "0.002"
    );
    let scenario = case_set.searched_scenario(1, 2.0).unwrap().scenario;
    assert_eq!((scenario.rods[0].edges, scenario.rods[0].radius), (6, 2e-3));
    let (again, _beside) = copied(&case_set, "rope");
    assert_eq!(again.search().unwrap().tolerance, 0.1);
}

#[test]
fn ends_of_ranges_may_be_expressions_over_parameters() {
    let parameters = "[parameters]\nbore = \"4 mm\"\nn = 3\n";
    for range in [
        "rods.rope.radius = { from = \"bore/4\", to = \"3 mm\", count = 3 }",
        "rods.0.radius = { from = 0.001, to = \"bore - 1 mm\", count = 3 }",
    ] {
        let case_set = case_set(&format!("{parameters}[sweep]\n{range}"));
        let radii = radii_and_edges(&case_set)
            .into_iter()
            .map(|(radius, _)| radius);
        assert_eq!(radii.collect::<Vec<_>>(), [1e-3, 2e-3, 3e-3], "{range}");
        assert_eq!(case_set.case(1).parameters[0].typed, "0.002");
    }
    // Whole numbers stay whole.
    let edges = "rods.rope.edges = { from = 2, to = \"2*n\", count = 3 }";
    for sweep in [
        format!("[sweep]\n{edges}"),
        format!("[[sweep.zip]]\n{edges}"),
    ] {
        let case_set = case_set(&format!("{parameters}{sweep}"));
        let edges = radii_and_edges(&case_set)
            .into_iter()
            .map(|(_, edges)| edges);
        assert_eq!(edges.collect::<Vec<_>>(), [2, 4, 6]);
    }
    let search = case_set(&format!(
        "{parameters}[sweep.search]\nmethod = \"bisect\"\nparameter = \"rods.rope.radius\"\n\
         objective = \"bending_energy_j\"\nfrom = \"bore/4\"\nto = \"3 mm\"\ntolerance = \"bore/100\""
    ));
    let ends = search
        .search()
        .map(|search| (search.from, search.to, search.tolerance));
    assert_eq!(ends, Some((1e-3, 3e-3, 4e-5)));
    let (again, _beside) = copied(&search, "rope");
    assert_eq!(again.search().unwrap().from, 1e-3);
}

#[test]
fn faults_of_ends_that_are_expressions_point_into_them() {
    for (range, words) in [
        (
            "{ from = \"bora/4\", to = 1.0, count = 2 }",
            "rope.toml:16:30: `sweep.rods.rope.radius.from`: unknown name `bora` (did you mean",
        ),
        (
            "{ from = \"bore^2\", to = 1.0, count = 2 }",
            "this key takes a length",
        ),
        (
            "{ from = \"bore/4\", to = \"3 s\", count = 2 }",
            "is a time, but this key takes a length",
        ),
    ] {
        let message = fault(&format!(
            "[parameters]\nbore = \"4 mm\"\n[sweep]\nrods.rope.radius = {range}"
        ));
        assert!(message.contains(words), "{words} in {message}");
    }
}

#[test]
fn faults_name_their_place_and_what_is_allowed() {
    for (sweep, words) in cases(
        r#"
        [sweep]; contact.friction = [] => rope.toml:14:20: `sweep.contact.friction`: the list is empty
        [sweep]; contact.friction = 0.3 => expected a list of values or a range
        [sweep]; contact.friction = { from = 0, to = 1 } => needs a `count`
        [sweep]; contact.friction = { from = 0, to = 1, count = 0 } => allowed: 1 to
        [sweep]; contact.friction = { from = 0, to = 1, count = 2, scale = "log" } => greater than 0
        [sweep]; contact.friction = { from = 0, to = "1 mm", count = 2 } => same unit
        [[sweep.zip]]; contact.friction = [1, 2]; rods.rope.edges = [3] => 1 values, but `contact.friction` has 2
        [sweep]; contact.friction = [0.1]; zip = [{ contact.friction = [0.2] }] => varied twice
        [sweep]; points = "nowhere.csv" => nowhere.csv cannot be read
        [sweep]; sample = { method = "sobol", count = 3 } => range without `count`
        [sweep.search]; method = "bisekt" => did you mean `bisect`?
    "#,
    ) {
        let message = fault(&sweep).replace("rope.toml:15", "rope.toml:14");
        assert!(message.contains(words), "{words} in {message}");
    }
}

#[test]
fn faults_of_values_point_at_the_values() {
    let case_set = self::case_set("[sweep]\nrods.rope.radius = [\"1 mm\", -2.0]");
    let error = case_set.scenario_of(1).unwrap_err().to_string();
    assert!(
        error.starts_with("rope.toml:14:29: `rods.0.radius`"),
        "{error}"
    );
    assert!(error.contains("greater than 0"), "{error}");
    let unknown = self::case_set("[sweep]\nrods.rope.raduis = [3]");
    let error = unknown.scenario_of(0).unwrap_err().to_string();
    assert!(
        error.starts_with("rope.toml:14:11: `rods.0.raduis`"),
        "{error}"
    );
    assert!(error.contains("did you mean `radius`?"), "{error}");
    let unknown = self::case_set("[sweep]\nrods.roap.radius = [1.0]");
    let error = unknown.scenario_of(0).unwrap_err().to_string();
    assert!(error.contains("did you mean `rope`?"), "{error}");
}

#[test]
fn probes_show_every_value_once() {
    let case_set = case_set("[sweep]\nrods.rope.edges = [4, 5, 6]\ncontact.friction = [0.1, 0.2]");
    let probes: Vec<usize> = case_set.probes().collect();
    assert_eq!(probes, [0, 2, 4, 1]);
}

#[test]
fn a_billion_cases_are_counted_without_being_made() {
    let range = "{ from = 0, to = 1.0, count = 1000 }";
    let case_set = case_set(&format!(
        "[sweep]\ncontact.friction = {range}\nmaterial.density = {range}\nrods.rope.radius = {range}"
    ));
    assert_eq!(case_set.count(), 1_000_000_000);
    assert_eq!(case_set.case(999_999_999).parameters[2].column(), "1.0");
}

proptest! {
    #[test]
    fn no_sweep_makes_it_panic(text in "(\\[sweep\\]|\\[\\[sweep.zip\\]\\]|)\n([a-z.]{1,9} = [-\\[\\]{}a-z0-9.,= \"]{0,20}\n){0,3}") {
        let _ = CaseSet::from_text(*EXPERIMENTS, "rope", &format!("{ROPE}{text}"), Path::new(""));
    }
}
