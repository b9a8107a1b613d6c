//! Where another program is better, in words that the page begins with.

use super::PeerRow;
use crate::reproduce::validation::benchmark::Row;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Sentences on the quantities in which another program is more accurate at the same number of
/// edges, or as accurate in less processor time; empty if there are none.
pub(in super::super) fn verdict(own: &[Row], peers: &[PeerRow]) -> String {
    let mut text = String::new();
    for (program, rows) in by_program(peers) {
        let mut say = |what: &str, quantities: Vec<&str>| {
            if !quantities.is_empty() {
                let gap = if text.is_empty() { "" } else { " " };
                // Writing to a string cannot fail.
                let _ = write!(text, "{gap}{program} is {what}: {}.", quantities.join("; "));
            }
        };
        say(
            "more accurate at the same number of edges",
            better(own, &rows, is_more_accurate),
        );
        say(
            "faster at the same error or a smaller one",
            better(own, &rows, is_faster),
        );
    }
    text
}

/// The quantities in which a comparison holds for a row of a program.
fn better<'a>(
    own: &[Row],
    peers: &[&'a PeerRow],
    holds: fn(&[&Row], &PeerRow) -> bool,
) -> Vec<&'a str> {
    let mut quantities = Vec::new();
    for peer in peers {
        let same = |row: &&Row| row.case == peer.case && row.quantity == peer.quantity;
        let same: Vec<&Row> = own.iter().filter(same).collect();
        if holds(&same, peer) && !quantities.contains(&peer.quantity.as_str()) {
            quantities.push(peer.quantity.as_str());
        }
    }
    quantities
}

/// Whether the error is smaller than that of the same mesh.
fn is_more_accurate(own: &[&Row], peer: &PeerRow) -> bool {
    let mut of_mesh = own.iter().filter(|row| row.edges == peer.edges);
    of_mesh.any(|row| peer.error.abs() < row.error.abs())
}

/// Whether it takes less time than a mesh whose error is not smaller.
fn is_faster(own: &[&Row], peer: &PeerRow) -> bool {
    own.iter().any(|row| {
        let time = row.cpu_time_s.unwrap_or(0.0);
        peer.error.abs() <= row.error.abs() && peer.cpu_time_s < time
    })
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
