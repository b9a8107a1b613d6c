//! Tables of reference solutions, for tests.

/// The text of a table; `None`, with a message, if it is not available.
pub fn text(file: &str) -> Option<String> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/reference/");
    let text = std::fs::read_to_string(format!("{folder}{file}")).ok();
    if text.is_none() {
        println!("skipped: {file} is not here");
    }
    text
}

/// The rows of numbers below the header of a table; empty if it is not available.
pub fn rows(file: &str) -> Vec<Vec<f64>> {
    let text = text(file).unwrap_or_default();
    let numbers = |line: &str| line.split(',').map(|cell| cell.parse().unwrap()).collect();
    text.lines().skip(1).map(numbers).collect()
}
