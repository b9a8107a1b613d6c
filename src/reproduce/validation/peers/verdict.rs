//! Where another program is better, in words that the page begins with.

use super::PeerRow;
use crate::reproduce::validation::benchmark::Row;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Least part by which an error must be smaller to be reported.
const LEAST_GAIN: f64 = 0.01;

/// Sentences on the quantities in which another program is more accurate at the same number of
/// edges, or as accurate in less processor time; empty if there are none.
pub(in super::super) fn verdict(own: &[Row], peers: &[PeerRow]) -> String {
    let mut text = String::new();
    for (program, rows) in by_program(peers) {
        let mut say = |what: &str, quantities: Vec<String>| {
            if !quantities.is_empty() {
                let gap = if text.is_empty() { "" } else { " " };
                // Writing to a string cannot fail.
                let _ = write!(text, "{gap}{program} is {what}: {}.", quantities.join("; "));
            }
        };
        say(
            "more accurate at the same number of edges",
            better(own, &rows, more_accurate),
        );
        say(
            "faster at the same error or a smaller one",
            better(own, &rows, faster),
        );
    }
    text
}

/// The quantities in which a comparison holds for a row of a program, each with the numbers of the
/// finest such mesh.
fn better(own: &[Row], peers: &[&PeerRow], compare: Comparison) -> Vec<String> {
    let mut quantities: Vec<(&str, String)> = Vec::new();
    for peer in peers {
        let same = |row: &&Row| row.case == peer.case && row.quantity == peer.quantity;
        let same: Vec<&Row> = own.iter().filter(same).collect();
        if let Some(numbers) = compare(&same, peer) {
            quantities.retain(|(known, _)| *known != peer.quantity);
            quantities.push((&peer.quantity, numbers));
        }
    }
    let in_words = |(quantity, numbers)| format!("{quantity} ({numbers})");
    quantities.into_iter().map(in_words).collect()
}

/// Compares a row of another program with those of this one; returns the numbers if it is better.
type Comparison = fn(&[&Row], &PeerRow) -> Option<String>;

/// Holds if the error is smaller than that of the same mesh.
fn more_accurate(own: &[&Row], peer: &PeerRow) -> Option<String> {
    let (error, edges) = (peer.error.abs(), peer.edges);
    let same = own.iter().find(|row| row.edges == peer.edges)?;
    let ours = same.error.abs();
    let is_less = error < (1.0 - LEAST_GAIN) * ours;
    is_less.then(|| format!("an error of {error:.1e}, not {ours:.1e}, with {edges} edges"))
}

/// Holds if it takes less time than a mesh whose error is not smaller.
fn faster(own: &[&Row], peer: &PeerRow) -> Option<String> {
    let slower = own.iter().find_map(|row| {
        let time = row.cpu_time_s.filter(|time| peer.cpu_time_s < *time)?;
        (peer.error.abs() <= row.error.abs()).then_some((row.error.abs(), time))
    });
    let (error, time) = slower?;
    let [theirs, seconds] = [peer.error.abs(), peer.cpu_time_s];
    Some(format!(
        "an error of {theirs:.1e} in {seconds:.3} s, not {error:.1e} in {time:.3} s"
    ))
}

/// The row of the finest mesh of each program for a quantity of a case.
pub(in super::super) fn best_of_peers<'a>(row: &Row, peers: &'a [PeerRow]) -> Vec<&'a PeerRow> {
    let same = |peer: &&PeerRow| peer.case == row.case && peer.quantity == row.quantity;
    let of_program = |rows: Vec<&'a PeerRow>| {
        let same = rows.into_iter().filter(same);
        same.max_by_key(|peer| peer.edges)
    };
    by_program(peers)
        .into_values()
        .filter_map(of_program)
        .collect()
}

/// Rows of each program.
fn by_program(peers: &[PeerRow]) -> BTreeMap<&str, Vec<&PeerRow>> {
    let mut programs: BTreeMap<&str, Vec<&PeerRow>> = BTreeMap::new();
    for peer in peers {
        programs.entry(&peer.program).or_default().push(peer);
    }
    programs
}
