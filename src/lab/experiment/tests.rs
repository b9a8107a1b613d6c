//! Checks that every kind in the list has all its parts.

use super::{KINDS, Kind, explain, from_text, json_schema, prepare};
use crate::report::plot_results;
use crate::run::{Mode, PreparedRun, run};
use crate::test_support::quiet;
use rodlab_engine::mechanics::dynamics::Simulation;
use rodlab_files::figure::{FigureOptions, Paper};
use rodlab_files::results::{SERIES, SUMMARY, Table};
use std::collections::BTreeSet;
use std::path::Path;

fn prepared(kind: &dyn Kind, text: &str, overrides: &[String]) -> PreparedRun {
    let loaded = from_text("template", text, Path::new(""), overrides)
        .unwrap_or_else(|error| panic!("{}: {error}", kind.name()));
    assert_eq!(loaded.scenario.experiment.name(), kind.name());
    prepare(&loaded.scenario).unwrap_or_else(|error| panic!("{}: {error}", kind.name()))
}

/// A template with the keys that it leaves commented out.
fn with_all_keys(template: &str) -> String {
    let lines = template.lines();
    lines
        .map(|line| format!("{}\n", line.strip_prefix("#: ").unwrap_or(line)))
        .collect()
}

#[test]
fn names_differ_and_each_has_a_sentence() {
    let names: BTreeSet<&str> = KINDS.iter().map(|kind| kind.name()).collect();
    assert_eq!(names.len(), KINDS.len());
    for kind in KINDS {
        assert!(kind.summary().ends_with('.'), "{kind:?}");
    }
}

#[test]
fn templates_are_scenarios_with_and_without_the_keys_left_commented_out() {
    for kind in KINDS {
        let all = with_all_keys(kind.template());
        assert_ne!(all, kind.template(), "{kind:?}");
        for text in [kind.template(), &all] {
            let run = prepared(*kind, text, &[]);
            Simulation::new(&run.scene, &run.integration)
                .unwrap_or_else(|error| panic!("{kind:?}: {error}"));
        }
    }
}

#[test]
fn keys_of_each_kind_are_in_the_schema_and_explained() {
    let schema = json_schema();
    let names = schema["properties"]["experiment"]["oneOf"]
        .as_array()
        .unwrap();
    for (kind, known) in KINDS.iter().zip(names) {
        assert_eq!(known["const"], kind.name());
        for table in kind.tables() {
            let words = explain(table.key()).unwrap();
            assert!(words.lines().count() > 2, "{words}");
            let (_, keys) = words.split_once("  keys: ").unwrap();
            // Further lines of the list begin with four spaces.
            let lines = keys
                .lines()
                .take_while(|line| !line.starts_with("  ") || line.starts_with("    "));
            let keys: String = lines
                .map(str::trim_start)
                .map(|line| format!("{line} "))
                .collect();
            for key in keys.trim_end().split(", ") {
                let words = explain(&format!("{}.{key}", table.key())).unwrap();
                assert!(words.lines().count() > 1, "{words}");
            }
        }
    }
}

/// Runs the template of each kind for two steps, and draws the results.
#[test]
fn each_kind_runs_has_figures_and_describes_its_files() {
    for kind in KINDS {
        let whole = prepared(*kind, kind.template(), &[]);
        let short = match (whole.mode, whole.integration.step) {
            (Mode::Dynamic { .. }, rodlab_engine::mechanics::dynamics::StepSize::Fixed(step)) => {
                vec![
                    format!("time.end={:?}", 2.0 * step),
                    format!("output.interval={step:?}"),
                ]
            }
            _ => Vec::new(),
        };
        let run_ = prepared(*kind, kind.template(), &short);
        let directory = tempfile::tempdir().unwrap();

        run(&run_, &quiet(directory.path())).unwrap_or_else(|error| panic!("{kind:?}: {error}"));
        let figures = plot_results(directory.path(), &FigureOptions::default()).unwrap();
        assert!(!figures.is_empty(), "{kind:?}");
        let own = kind.figures(directory.path()).unwrap();
        for (name, figure) in &own {
            let svg = figure.svg(&Paper::default());
            assert!(svg.starts_with("<svg"), "{name}");
            let said = kind.files().iter().any(|file| file.names.contains(name));
            assert!(said, "{kind:?}: nothing is said of {name}");
        }
        for file in kind.files() {
            assert!(file.meaning.ends_with('.'), "{file:?}");
            assert!(file.columns().all(|column| column.meaning.ends_with('.')));
            let name = file.names[0];
            if !name.ends_with(".csv") {
                continue;
            }
            let table = Table::read(&directory.path().join(name)).unwrap();
            let said: Vec<&str> = file.columns().map(|column| column.name).collect();
            let there: Vec<&str> = table.columns().iter().map(String::as_str).collect();
            // In common files the last columns are those of the kind.
            let own = match name {
                SERIES | SUMMARY => &there[there.len() - said.len()..],
                _ => &there[..],
            };
            assert_eq!(own, said, "{kind:?}: {name}");
        }
    }
}
