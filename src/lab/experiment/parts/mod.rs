//! Parts that the scenes of all experiments may have, each with an array of tables. This is the
//! only list of them.
//!
//! Each part has a file or folder here, with its keys, their resolution and its contributions to
//! the scene, and an entry in the list.

mod actuation;
mod free_body;
mod sheath;
mod tendon;

#[cfg(test)]
pub use actuation::{Actuation, ActuationKind};
pub use free_body::judge as judge_free_bodies;
pub use sheath::judge as judge_sheaths;
pub use tendon::{Eyelets, Tendon};

use crate::scenario::keys::{OwnTable, Part};
use crate::scenario::{Issue, Issues, KeyPath, Scenario};
use rodlab_engine::mechanics::scene::Scene;

/// A part of a scene.
trait ScenePart: Part {
    /// Adds the part to a scene with all its rods, clamps and joints; `path` is the path of its
    /// table.
    ///
    /// # Errors
    /// A part that cannot be placed, with its key.
    fn place(&self, scene: &mut Scene, path: &KeyPath) -> Result<(), Issue>;
}

macro_rules! parts {
    ($($part:ty),* $(,)?) => {
        /// Tables of the parts.
        pub static TABLES: &[OwnTable] = &[$(OwnTable::of_part::<$part>()),*];

        /// Places the parts of a scenario; reports those that cannot be placed.
        pub fn place(scenario: &Scenario, scene: &mut Scene, issues: &mut Issues) {
            $(place_all::<$part>(scenario, scene, issues);)*
        }
    };
}

parts! {
    actuation::Actuation,
    tendon::Tendon,
    sheath::Sheath,
    free_body::FreeBody,
}

fn place_all<P: ScenePart>(scenario: &Scenario, scene: &mut Scene, issues: &mut Issues) {
    let path = KeyPath::from(P::KEY);
    for (index, part) in scenario.parts.all::<P>().iter().enumerate() {
        if let Err(issue) = part.place(scene, &path.index(index)) {
            issues.push(issue);
        }
    }
}

#[cfg(test)]
mod test_support {
    use crate::experiment::{from_text, prepare};
    use rodlab_engine::mechanics::scene::Scene;
    use std::path::Path;

    /// The scene of a scenario file, which is also written in resolved form and read back.
    ///
    /// # Errors
    /// The faults of the file.
    pub fn prepared(text: &str) -> Result<Scene, String> {
        let loaded = from_text("scene", text, Path::new(""), &[]).map_err(|e| e.to_string())?;
        let again = from_text("scene", &loaded.scenario.to_toml(), Path::new(""), &[]);
        let again = again.map_err(|error| error.to_string())?;
        assert_eq!(again.scenario, loaded.scenario);
        let prepared = prepare(&loaded.scenario);
        Ok(prepared
            .map_err(|issues| loaded.locate(issues).to_string())?
            .scene)
    }
}
