//! Tests of requests, and of keys that the data do not determine.

use super::*;

#[test]
fn a_shape_that_does_not_depend_on_a_stiffness_says_so() {
    let flat = TWISTED.replace("twist = 4.0", "");
    let file = measured(&scenario(&flat), POINTS, |_| 1e-4, 3);
    let found = fit(&task(
        vec![Experiment {
            scenario: scenario(&flat),
            files: vec![file.clone()],
        }],
        &["parameters.gj"],
    ));
    assert_eq!(found.parameters[0].standard_error, None);
    assert!(
        found.undetermined[0]
            .words
            .contains("do not determine `parameters.gj`"),
        "{}",
        brief(&found)
    );
    assert!(
        found.undetermined[0].advice.contains("turn a clamp"),
        "{}",
        brief(&found)
    );
    // Without weight the shape depends on the ratio alone, and an arc of a circle stays one.
    let arc = r#"kind = "arc", start = [0, 0, 0], tangent = [0, 0, 1], normal = [0, 1, 0], radius = 0.1, angle = "180 deg""#;
    let bent =
        r#"kind = "points", points = [[0, 0, 0], [0, 0, 0.1], [0.15, 0, 0.1], [0.15, 0, 0.05]]"#;
    let bent = scenario(&TWISTED.replace(arc, bent));
    let file = measured(&bent, POINTS, |_| 1e-4, 4);
    let experiment = Experiment {
        scenario: bent,
        files: vec![file],
    };
    let found = fit(&task(vec![experiment], &["parameters.ei", "parameters.gj"]));
    let [direction] = found.undetermined.as_slice() else {
        panic!("{}", brief(&found));
    };
    assert!(
        (direction.changes[0].1 - direction.changes[1].1).abs() < 1e-3,
        "{direction:?}"
    );
}

#[test]
fn outliers_are_outweighed_by_the_loss_of_huber() {
    let mut file = measured(&scenario(SWING), &swing_rows(), |_| 1e-3, 11);
    for datum in file.data.iter_mut().step_by(9) {
        datum.value += 0.05;
    }
    let mut task = task(
        vec![Experiment {
            scenario: scenario(SWING),
            files: vec![file],
        }],
        &SWING_KEYS,
    );
    let squares = fit(&task);
    task.loss = Loss::Huber;
    let huber = fit(&task);
    let off = |found: &Identified| (found.parameters[0].value / 2e-4 - 1.0).abs();
    assert!(
        off(&huber) < 0.4 * off(&squares) && off(&huber) < 0.01,
        "{} {}",
        off(&huber),
        off(&squares)
    );
}

#[test]
fn priors_and_bounds_hold() {
    let file = measured(&scenario(SWING), &swing_rows(), |_| 1e-3, 5);
    let mut task = task(
        vec![Experiment {
            scenario: scenario(SWING),
            files: vec![file],
        }],
        &SWING_KEYS,
    );
    task.keys[1].prior = Some([5000.0, 1.0]);
    let found = fit(&task);
    assert!(
        (found.parameters[1].value - 5000.0).abs() < 5.0,
        "{}",
        brief(&found)
    );
    task.keys[1].prior = None;
    task.keys[0].bounds = Some([1e-4, 1.9e-4]);
    let outside = identify(&task, &CentralDifferences::default(), &|| true, &mut |_| {});
    assert!(
        outside
            .unwrap_err()
            .to_string()
            .contains("outside of the bounds")
    );
    task.experiments[0].scenario = elsewhere(SWING, &[("stiffness", "1.5e-4")]);
    let found = fit(&task);
    assert!(
        found.parameters[0].at_bound && (found.parameters[0].value - 1.9e-4).abs() < 1e-12,
        "{}",
        brief(&found)
    );
    assert!(
        found
            .remarks
            .iter()
            .any(|remark| remark.contains("at its bound"))
    );
}

#[test]
fn a_mirrored_frame_is_refused_with_its_row() {
    let mut file = measured(&scenario(TWISTED), POINTS, |_| 0.0, 1);
    for datum in &mut file.data {
        if matches!(datum.measured, Measured::Coordinate { axis: 0, .. }) {
            datum.value = -datum.value;
        }
    }
    let task = task(
        vec![Experiment {
            scenario: scenario(TWISTED),
            files: vec![file],
        }],
        &["parameters.gj"],
    );
    let error = identify(&task, &CentralDifferences::default(), &|| true, &mut |_| {})
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("data.csv, line") && error.contains("the axis x is mirrored"),
        "{error}"
    );
}

#[test]
fn requests_that_cannot_be_met_state_what_is_allowed() {
    let file = measured(&scenario(SWING), &swing_rows(), |_| 0.0, 1);
    let experiment = Experiment {
        scenario: scenario(SWING),
        files: vec![file],
    };
    for (keys, expected) in [
        (&["parameters.ei"] as &[&str], "no value for this key"),
        (&["material.youngs_moduls"], "no value for this key"),
        (&[], "--fit KEY"),
        (&["material.density", "material.density"], "fitted twice"),
        (
            &["material.relaxing_modulus"],
            "--set material.relaxing_modulus=VALUE",
        ),
    ] {
        let error = identify(
            &task(vec![experiment.clone()], keys),
            &CentralDifferences::default(),
            &|| true,
            &mut |_| {},
        );
        let error = error.unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
    let mut task = task(vec![experiment], &["material.density"]);
    task.noise.insert("force".into(), 1.0);
    let error = identify(&task, &CentralDifferences::default(), &|| true, &mut |_| {}).unwrap_err();
    assert!(error.to_string().contains("there are: position"), "{error}");
}

#[test]
fn the_files_are_written_and_the_rod_and_the_scenario_can_be_used() {
    let found = swing(2);
    let file = measured(&scenario(SWING), &swing_rows(), |_| 1e-3, 2);
    let experiments = [Experiment {
        scenario: scenario(SWING),
        files: vec![file],
    }];
    let directory = tempfile::tempdir().unwrap();
    let paths = write(directory.path(), &found, &experiments).unwrap();
    assert_eq!(paths.len(), 6);
    let table = std::fs::read_to_string(directory.path().join(PARAMETERS)).unwrap();
    assert!(
        table.starts_with(
            "key,value,unit,standard_error,low_95,high_95,start\nparameters.stiffness,"
        ),
        "{table}"
    );
    let residuals = std::fs::read_to_string(directory.path().join(RESIDUALS)).unwrap();
    assert_eq!(residuals.lines().count(), 201);
    let rod = crate::experiment::RodFile::read(&directory.path().join(ROD)).unwrap();
    let weight = 1000.0 * std::f64::consts::PI * 4e-6 * 9.81;
    let expected = (found.parameters[0].value / (2.0 * weight)).cbrt();
    assert!((rod.rod.gravito_bending_length / expected - 1.0).abs() < 1e-9);
    crate::experiment::load(&directory.path().join(FITTED), &[]).unwrap();
}
