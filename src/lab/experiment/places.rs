//! Lookup of rods by name, and of nodes and edges on them by place.

use crate::scenario::{Issue, KeyPath, Place, did_you_mean};
use rodlab_engine::mechanics::scene::{RodDescription, Scene};

/// The index of a place among the `count` nodes or edges of a rod; faults name the key.
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

/// The rod with a name; faults name the key.
pub fn find_rod(name: &str, rods: &[RodDescription], key: &KeyPath) -> Result<usize, Issue> {
    rods.iter().position(|rod| rod.name == name).ok_or_else(|| {
        let names: Vec<&str> = rods.iter().map(|rod| rod.name.as_str()).collect();
        let help = did_you_mean(name, names.iter().copied())
            .unwrap_or_else(|| format!("the rods are: {}", listed(&names)));
        Issue::new(key.clone(), format!("no rod is called `{name}`")).with_help(help)
    })
}

/// The free body with a name, counted after the rods.
pub fn body_called(name: &str, scene: &Scene) -> Option<usize> {
    let body = scene.free_bodies.iter().position(|body| body.name == name);
    body.map(|body| scene.rods.len() + body)
}

/// Names as text, only the first ones of a long list.
fn listed(names: &[&str]) -> String {
    const MOST: usize = 12;
    match names.get(..MOST) {
        Some(first) if names.len() > MOST => {
            format!("{}, and {} more", first.join(", "), names.len() - MOST)
        }
        _ => names.join(", "),
    }
}
