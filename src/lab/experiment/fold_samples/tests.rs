//! Tests of allowed requests, of the positions, and of the contents of a row.

use super::keys::{FoldSamples, Points};
use super::places::places;
use super::samples::Samples;
use crate::experiment::data_set::Span;
use crate::experiment::from_text;
use crate::run::TableJob;
use rodlab_planning::plan::fold::FoldAtlas;
use std::path::Path;

fn plan(points: Points) -> FoldSamples {
    FoldSamples {
        points,
        suspended_length: Span { from: 0.6, to: 4.0 },
        least_suspended_length: 0.958,
    }
}

#[test]
fn faults_name_file_line_and_key() {
    let good = "points = { kind = \"sobol\", count = 10 }";
    for (lines, line, key) in [
        ("suspended_length = { to = 5 }", 2, "points"),
        ("points = { kind = \"sobol\" }", 3, "count"),
        ("points = { kind = \"sobol\", count = 0 }", 3, "count"),
        (
            "points = { kind = \"sobol\", count = 10, first = -1 }",
            3,
            "first",
        ),
        ("points = { kind = \"grid\" }", 3, "spacing"),
        (
            "points = { kind = \"grid\", spacing = 0.001 }",
            3,
            "spacing",
        ),
        ("points = { kind = \"latin\", count = 10 }", 3, "latin"),
        (
            &format!("{good}\nsuspended_length = {{ from = 3, to = 2 }}"),
            4,
            "suspended_length",
        ),
        (
            &format!("{good}\nsuspended_length = {{ to = 9 }}"),
            4,
            "7.4",
        ),
        (
            &format!("{good}\nleast_suspended_length = 0"),
            4,
            "least_suspended_length",
        ),
        (&format!("{good}\nlongest = 3"), 4, "longest"),
    ] {
        let text = format!("experiment = \"fold-samples\"\n[fold_samples]\n{lines}\n");
        let refused = from_text("folds", &text, Path::new(""), &[]);
        let said = refused.map(|_| ()).unwrap_err().to_string();
        assert!(
            said.contains(&format!("folds.toml:{line}")),
            "{lines}: {said}"
        );
        assert!(said.contains(key), "{lines}: {said}");
    }
}

#[test]
fn later_parts_of_the_sequence_are_other_samples() {
    let of = |count, first| places(&plan(Points::Sobol { count, first })).unwrap();
    let (all, later) = (of(300, 0), of(100, 200));
    assert_eq!(all.len(), 300);
    assert_eq!(all[200..], later[..]);
}

/// The workspace limits the number of points: half the spacing gives four times as many.
#[test]
fn a_grid_covers_the_workspace_evenly() {
    let of = |spacing| places(&plan(Points::Grid { spacing })).unwrap().len() as f64;
    let ratio = of(0.05) / of(0.1);
    assert!((ratio - 4.0).abs() < 0.1, "{ratio}");
}

#[test]
fn rows_are_exact_folds() {
    let samples = Samples::new(plan(Points::Sobol {
        count: 40,
        first: 0,
    }));
    let atlas = FoldAtlas::new();
    assert_eq!(samples.count(), 40);
    for index in 0..40 {
        let row = samples.row(index, &|| true).unwrap();
        let fold = atlas.solve([row.x, row.z]).unwrap();
        let (lambda, inclination) = (row.lambda.unwrap(), row.force_inclination.unwrap());
        assert_eq!(lambda, fold.force_ratio());
        assert!((inclination.tan().abs() - lambda).abs() < 1e-12);
        assert_eq!(inclination > 0.0, fold.forces.horizontal > 0.0);
        assert_eq!(row.penalty, Some(fold.suspended_length < 0.958));
        // The outline is a polygon.
        assert!((0.599..4.001).contains(&fold.suspended_length), "{fold:?}");
    }
    assert!(samples.row(0, &|| false).is_none());
}
