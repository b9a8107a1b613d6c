//! Remarks at the end of a run, from the scenario file to the tables.

use crate::run::run_until;
use crate::test_support::{prepared, quiet, ran};
use rodlab_files::results::{MAIN_CASE, Manifest, SUMMARY, Table};

/// Remarks of a run, which are also in its summary and manifest.
fn remarks(text: &str) -> Vec<String> {
    let prepared = prepared("remarks", text).unwrap();
    let (outcome, directory) = ran(&prepared).unwrap();
    let remarks = outcome.case.remarks;
    let summary = Table::read(&directory.path().join(SUMMARY)).unwrap();
    let told: Vec<&str> = summary.column("remarks").unwrap().collect();
    assert_eq!(told, [remarks.join("; ")]);
    let manifest = Manifest::read(directory.path()).unwrap().unwrap();
    assert_eq!(manifest.cases[MAIN_CASE].outcome.remarks, remarks);
    // A finished run is left alone and repeats its remarks.
    let again = run_until(&prepared, &quiet(directory.path()), &|| None).unwrap();
    assert_eq!(again.case.remarks, remarks);
    remarks
}

/// A naturally straight rod with the radius 5 mm, closed to a ring of the given radius: κh is 5 mm
/// over that radius.
fn ring(radius: &str) -> Vec<String> {
    remarks(&format!(
        r#"
        experiment = "scene"
        material = {{ youngs_modulus = "1 MPa", poissons_ratio = 0.5, density = 1000.0 }}
        time = {{ mode = "static" }}
        [[rods]]
        name = "ring"
        radius = "5 mm"
        edges = 40
        shape = {{ kind = "ring", centre = [0, 0, 0], normal = [0, 0, 1], radius = "{radius}" }}
        natural_shape = "straight"
        "#
    ))
}

#[test]
fn bending_beyond_the_theory_of_rods_is_remarked() {
    let found = ring("20 mm");
    assert_eq!(found.len(), 1, "{found:?}");
    // 5/20.
    assert!(
        found[0].contains("`ring` was bent") && found[0].contains("25 %"),
        "{found:?}"
    );
    assert!(ring("40 mm").is_empty());
}

/// A rod of 0.1 m with the radius 5 mm whose end is turned by φ: its surface is sheared by φ h/L.
#[test]
fn twist_beyond_the_theory_of_rods_is_remarked() {
    let twisted = |angle: f64| {
        remarks(&format!(
            r#"
            experiment = "scene"
            material = {{ youngs_modulus = "1 MPa", poissons_ratio = 0.5, density = 1000.0 }}
            time = {{ end = 0.5, step = 0.01 }}
            [[rods]]
            name = "shaft"
            radius = "5 mm"
            edges = 20
            shape = {{ kind = "straight", start = [0, 0, 0], end = [0.1, 0, 0] }}
            [[clamps]]
            rod = "shaft"
            at = "start"
            [[clamps]]
            rod = "shaft"
            at = "end"
            turn = [[0.0, 0.0], [0.2, {angle}]]
            "#
        ))
    };
    let found = twisted(6.0);
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(
        found[0].contains("`shaft` was twisted") && found[0].contains("30 %"),
        "{found:?}"
    );
    assert!(twisted(2.0).is_empty());
}
