//! Places on rods: numbers of nodes and edges.

use crate::scenario::{Issue, KeyPath, Place};
use rodlab_engine::mechanics::scene::RodDescription;

/// The number of a place given at a key, among the `count` nodes or edges of a rod.
pub fn find_place(
    place: Place,
    count: usize,
    what: &str,
    rod: &RodDescription,
    key: &KeyPath,
) -> Result<usize, Issue> {
    match place {
        Place::Start => Ok(0),
        Place::End => Ok(count - 1),
        Place::Number(number) if number < count => Ok(number),
        Place::Number(number) => Err(Issue::new(
            key.clone(),
            format!(
                "rod `{}` has no {what} {number}; allowed: 0 to {}, \"start\" or \"end\"",
                rod.name,
                count - 1
            ),
        )),
    }
}
