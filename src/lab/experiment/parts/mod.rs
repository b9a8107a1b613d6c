//! Parts that scenes of all experiments may have, each with an array of tables of its own: the one list of them.
//!
//! A part is one file or folder here and an entry in the list: its keys, how they are resolved, and what they add to the scene.

mod actuation;

#[cfg(test)]
pub use actuation::{Actuation, ActuationKind};

use crate::scenario::keys::{OwnTable, Part};
use crate::scenario::{Issue, Issues, KeyPath, Scenario};
use rodlab_engine::mechanics::scene::Scene;

/// A part of a scene.
trait ScenePart: Part {
    /// Adds it to a scene with all its rods, clamps and joints; `path` is that of its table.
    ///
    /// # Errors
    /// A part that cannot be placed, at its key.
    fn place(&self, scene: &mut Scene, path: &KeyPath) -> Result<(), Issue>;
}

macro_rules! parts {
    ($($part:ty),* $(,)?) => {
        /// Their tables.
        pub static TABLES: &[OwnTable] = &[$(OwnTable::of_part::<$part>()),*];

        /// Places the parts of a scenario; reports those that cannot be placed.
        pub fn place(scenario: &Scenario, scene: &mut Scene, issues: &mut Issues) {
            $(place_all::<$part>(scenario, scene, issues);)*
        }
    };
}

parts! {
    actuation::Actuation,
}

fn place_all<P: ScenePart>(scenario: &Scenario, scene: &mut Scene, issues: &mut Issues) {
    let path = KeyPath::from(P::KEY);
    for (index, part) in scenario.parts.all::<P>().iter().enumerate() {
        if let Err(issue) = part.place(scene, &path.index(index)) {
            issues.push(issue);
        }
    }
}
