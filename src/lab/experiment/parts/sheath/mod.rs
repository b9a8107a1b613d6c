//! Sheaths out of which rods are fed.

mod keys;

use super::ScenePart;
use crate::experiment::places::find_rod;
use crate::scenario::keys::{Part, Section};
use crate::scenario::{Issue, KeyPath, Scheme, Time};
use keys::{InnerEnd, SheathKeys};
use rodlab_engine::mechanics::SceneError;
use rodlab_engine::mechanics::scene::{self, Scene};
use rodlab_engine::mechanics::system::check_sheaths;
use serde::Serialize;

/// A sheath.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sheath {
    /// Name for probes and messages.
    pub name: String,
    /// Name of the rod.
    pub rod: String,
    /// End of the rod in the sheath.
    pub from: InnerEnd,
    /// Natural length of the rod inside at time zero, m.
    pub inside: f64,
    /// Length fed out at given times, (s, m).
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub fed: Vec<(f64, f64)>,
    /// Force that feeds the rod at given times, (s, N), instead of a length.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub pushed: Vec<(f64, f64)>,
    /// Angle at given times, (s, rad).
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub turned: Vec<(f64, f64)>,
}

impl Part for Sheath {
    type Typed = SheathKeys;

    const KEY: &'static str = "sheaths";
    const DESCRIPTION: &'static str = "Sheaths out of which rods are fed.";
    const LUMPS_INERTIA: bool = true;

    fn resolve(section: &Section<'_>, typed: &SheathKeys, index: usize) -> Self {
        Self {
            name: typed.name(section, format!("sheath {index}")),
            rod: typed.rod(section),
            from: typed.from(section),
            inside: typed.inside(section),
            fed: typed.fed(section, Vec::new()),
            pushed: typed.pushed(section, Vec::new()),
            turned: typed.turned(section, Vec::new()),
        }
    }

    fn judge(array: &Section<'_>, all: &[Self], time: &Time) {
        if let Time::Dynamic {
            scheme: Scheme::ImplicitMidpoint,
            ..
        } = time
            && !all.is_empty()
        {
            array.below("0").fault(
                "fed",
                "a rod in a sheath needs time.scheme = \"implicit-euler\" or \"backward-differences\"",
            );
        }
        let pushed = all.iter().position(|sheath| !sheath.pushed.is_empty());
        if let Some(index) = pushed.filter(|_| time.finds_equilibria()) {
            array.below(&index.to_string()).fault(
                "pushed",
                "the length that a force feeds out in an equilibrium is not searched: give `fed`, or run in time with damping, without begin = \"equilibrium\"",
            );
        }
        if *time != Time::Static {
            return;
        }
        for (index, sheath) in all.iter().enumerate() {
            for (key, corners) in [("fed", &sheath.fed), ("turned", &sheath.turned)] {
                if corners.len() > 1 {
                    array.below(&index.to_string()).fault(
                        key,
                        "a static run has no time, so nothing changes in it; give one value, such as [[0, 0.1]]",
                    );
                }
            }
        }
    }
}

impl ScenePart for Sheath {
    fn place(&self, scene: &mut Scene, path: &KeyPath) -> Result<(), Issue> {
        let rod = find_rod(&self.rod, &scene.rods, &path.key("rod"))?;
        if scene.sheaths.iter().any(|other| other.name == self.name) {
            let message = format!("another sheath is called `{}`", self.name);
            return Err(Issue::new(path.key("name"), message));
        }
        scene.sheaths.push(scene::Sheath {
            name: self.name.clone(),
            rod,
            from_end: self.from == InnerEnd::End,
            inside: self.inside,
            fed: self.fed.clone(),
            pushed: self.pushed.clone(),
            turned: self.turned.clone(),
        });
        Ok(())
    }
}

/// Checks whether the sheaths of a scene can hold their rods.
///
/// # Errors
/// The fault of one of them, with its key.
pub fn judge(scene: &Scene) -> Result<(), Issue> {
    let Err(SceneError::Sheath {
        name,
        field,
        reason,
    }) = check_sheaths(scene)
    else {
        return Ok(());
    };
    let mut sheaths = scene.sheaths.iter();
    let index = sheaths.position(|sheath| sheath.name == name);
    let path = KeyPath::from(Sheath::KEY).index(index.unwrap_or_default());
    Err(Issue::new(path.key(field), reason))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::parts::test_support::prepared;

    const SCENE: &str = r#"experiment = "scene"
[material]
youngs_modulus = "1 MPa"
poissons_ratio = 0.5
density = 1000.0
[[rods]]
name = "wire"
radius = 0.01
edges = 10
shape = { kind = "straight", start = [0, 0, 0], end = [1, 0, 0] }
[time]
end = 1.0
[[sheaths]]
SHEATH
"#;

    fn with(sheath: &str) -> String {
        SCENE.replace("SHEATH", sheath)
    }

    #[test]
    fn a_sheath_is_placed_and_its_rod_has_lumped_inertia() {
        let scene = prepared(&with(
            "rod = \"wire\"\nfrom = \"end\"\ninside = \"50 cm\"\nfed = [[0, 0], [1, \"20 cm\"]]\nturned = [[0, 0], [1, \"180 deg\"]]",
        ))
        .unwrap();
        assert_eq!(
            scene.sheaths,
            [scene::Sheath {
                name: "sheath 0".into(),
                rod: 0,
                from_end: true,
                inside: 0.5,
                fed: vec![(0.0, 0.0), (1.0, 0.2)],
                pushed: Vec::new(),
                turned: vec![(0.0, 0.0), (1.0, std::f64::consts::PI)],
            }]
        );
        assert_eq!(scene.rods[0].inertia, scene::Inertia::Lumped);
    }

    #[test]
    fn faults_of_sheaths_name_the_key_and_what_is_allowed() {
        let held = "\n[[clamps]]\nrod = \"wire\"\nat = 3";
        let wire = "rod = \"wire\"\ninside = 0.5";
        for (keys, key, expected) in [
            ("inside = 0.5".to_owned(), "rod", "missing key `rod`"),
            (
                "rod = \"wire\"".to_owned(),
                "inside",
                "missing key `inside`",
            ),
            (
                "rod = \"wir\"\ninside = 0.5".to_owned(),
                "rod",
                "no rod is called `wir`",
            ),
            (
                "rod = \"wire\"\ninside = 1.5".to_owned(),
                "inside",
                "at most 1.0 m",
            ),
            (
                "rod = \"wire\"\ninside = 0.05".to_owned(),
                "inside",
                "at least 0.1 m",
            ),
            (format!("{wire}\nfed = [[0, 0.45]]"), "fed", "at most 0.4 m"),
            (format!("{wire}{held}"), "rod", "at node 3 of its rod"),
            (
                format!("{wire}\nfed = [[0, 0.1]]\npushed = [[0, \"1 N\"]]"),
                "pushed",
                "not both",
            ),
        ] {
            let error = prepared(&with(&keys)).unwrap_err();
            assert!(error.contains(expected), "{keys}: {error}");
            assert!(
                error.contains(&format!("sheaths.0.{key}")) || error.contains("missing"),
                "{error}"
            );
        }
        let keys = format!("{wire}\nfed = [[0, 0], [1, 0.1]]");
        let static_run = with(&keys).replace("end = 1.0", "mode = \"static\"");
        let error = prepared(&static_run).unwrap_err();
        assert!(error.contains("a static run has no time"), "{error}");
        let pushed = with(&format!("{wire}\npushed = [[0, 1]]"));
        for time in ["mode = \"static\"", "end = 1.0\nbegin = \"equilibrium\""] {
            let error = prepared(&pushed.replace("end = 1.0", time)).unwrap_err();
            assert!(error.contains("sheaths.0.pushed"), "{error}");
        }
        let midpoint = "end = 1.0\nscheme = \"implicit-midpoint\"";
        let error = prepared(&with(wire).replace("end = 1.0", midpoint)).unwrap_err();
        assert!(error.contains("backward-differences"), "{error}");
    }
}
