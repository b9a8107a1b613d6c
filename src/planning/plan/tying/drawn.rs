//! The patterns in the repository, for tests.

use crate::plan::pattern::{Pattern, PatternSource, chosen_stroke, read_svg};

/// The trefoil in one stroke.
pub fn trefoil() -> Pattern {
    pattern(
        include_str!("../../../../scenarios/patterns/trefoil.svg"),
        None,
    )
}

fn pattern(svg: &str, stroke: Option<usize>) -> Pattern {
    let points = chosen_stroke(read_svg(svg).unwrap(), stroke).unwrap();
    let source = PatternSource::Drawn {
        points,
        deviation: 2.5e-4,
    };
    source.pattern().unwrap()
}
