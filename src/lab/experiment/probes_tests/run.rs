//! Probes during a run: conditions that end it, and statistics after an interruption.

use super::{CANTILEVER, Ran, prepared, ran};
use crate::run::{PreparedRun, RunError, StopRequest, run_until};
use crate::test_support::quiet;
use rodlab_files::results::{BRANCH, NODES, SERIES, SUMMARY};
use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

const FALLING: &str = r#"
[[probes]]
name = "tip"
kind = "position"
at = "end"
summary = "min"
"#;

fn falling(probes: &str) -> String {
    let text = CANTILEVER
        .replace("mode = \"static\"", "step = 2e-3, end = 0.2")
        .replace("nodes = true", "interval = 0.01");
    text + FALLING + probes
}

#[test]
fn a_condition_ends_the_run_at_the_first_output_where_it_holds() {
    let whole = ran(&falling(""));
    let stopped = ran(&falling(
        "[stop_when]\nprobe = \"tip_z_m\"\nbelow = -0.03\n",
    ));
    let heights = |run: &Ran| -> Vec<f64> {
        let column = run.series.numbers("tip_z_m").unwrap();
        column.into_iter().flatten().collect()
    };
    let (all, some) = (heights(&whole), heights(&stopped));
    assert_eq!(all[..some.len()], some);
    assert!(some.len() < all.len());
    let low = some.iter().position(|height| *height < -0.03);
    assert_eq!(low, Some(some.len() - 1));
    let word: Vec<&str> = stopped.summary.column("stopped_by").unwrap().collect();
    assert_eq!(word, ["tip_z_m"]);
    let sentence = stopped.outcome.case.ending.unwrap().sentence;
    assert!(sentence.contains("below -0.03"), "{sentence}");
    assert!(whole.summary.column("stopped_by").is_none());
    let least = stopped.summary.numbers("tip_z_min_m").unwrap()[0];
    assert_eq!(least, some.last().copied());
    let never = ran(&falling("[stop_when]\nprobe = \"tip_z_m\"\nabove = 1.0\n"));
    assert_eq!(heights(&never), all);
    let word: Vec<&str> = never.summary.column("stopped_by").unwrap().collect();
    assert_eq!(word, [""]);
}

fn interrupted_every(calls: usize, prepared: &PreparedRun, directory: &Path) -> usize {
    let mut interruptions = 0;
    loop {
        let asked = AtomicUsize::new(0);
        let stop = || (asked.fetch_add(1, Relaxed) == calls).then_some(StopRequest::Interrupt);
        match run_until(prepared, &quiet(directory), &stop) {
            Ok(_) => return interruptions,
            Err(RunError::Interrupted { .. }) => interruptions += 1,
            Err(error) => panic!("{error}"),
        }
    }
}

#[test]
fn probes_of_an_interrupted_motion_end_with_the_same_bytes() {
    let text = falling(
        "[[probes]]\nname = \"root\"\nkind = \"reaction\"\nat = \"start\"\nsummary = \"mean\"\n\
         [[probes]]\nname = \"bending\"\nkind = \"bending_moment\"\nsummary = \"max\"\n\
         [stop_when]\nprobe = \"bending\"\nabove = 1.0\n",
    );
    let whole = ran(&text);
    let pieces = tempfile::tempdir().unwrap();
    let count = interrupted_every(11, &prepared(&text).unwrap(), pieces.path());
    assert!(count > 5, "{count}");
    for name in [SERIES, SUMMARY] {
        let read = |directory: &Path| fs::read(directory.join(name)).unwrap();
        assert!(
            read(whole.directory.path()) == read(pieces.path()),
            "{name}"
        );
    }
}

#[test]
fn probes_follow_a_path_of_equilibria_and_can_end_it() {
    let column = include_str!("../../../../scenarios/euler_column.toml")
        .replace("edges = 100", "edges = 20")
        .replace("step = 0.05", "step = 0.3")
        + "largest_step = 0.3\n[[probes]]\nname = \"middle\"\nkind = \"displacement\"\nat = 10\nsummary = \"max\"\n\
           [[probes]]\nname = \"foot\"\nkind = \"reaction\"\nat = \"start\"\n";
    let whole = ran(&column);
    let parameters = whole.series.numbers("time_s").unwrap();
    assert_eq!(
        whole.series.numbers("middle_x_m").unwrap().len(),
        parameters.len()
    );
    assert!(whole.series.numbers("foot_force_z_n").unwrap()[1].is_some());
    let pieces = tempfile::tempdir().unwrap();
    let count = interrupted_every(7, &prepared(&column).unwrap(), pieces.path());
    assert!(count > 2, "{count}");
    for name in [BRANCH, SERIES, NODES, SUMMARY] {
        let read = |directory: &Path| fs::read(directory.join(name)).ok();
        assert!(
            read(whole.directory.path()) == read(pieces.path()),
            "{name}"
        );
    }
    let mut sizes = whole.series.numbers("foot_force_z_n").unwrap();
    let second = sizes.remove(1).unwrap();
    let side = if second > 0.0 { "above" } else { "below" };
    let limit = 0.5 * second;
    let stopped = ran(&format!(
        "{column}[stop_when]\nprobe = \"foot_force_z_n\"\n{side} = {limit:?}\n"
    ));
    assert_eq!(stopped.series.len(), 2);
    assert_eq!(stopped.outcome.case.ending.unwrap().word, "foot_force_z_n");
}
