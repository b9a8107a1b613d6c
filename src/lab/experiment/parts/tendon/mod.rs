//! Tendons: cables through eyelets.

mod keys;

use super::ScenePart;
use crate::experiment::places::{find_place, find_rod};
use crate::scenario::keys::{NON_NEGATIVE, Part, Section};
use crate::scenario::{Issue, KeyPath, Place, Time};
use keys::{EyeletKeys, TendonKeys};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::scene::{self, Pull, RodDescription, RodNode, Scene};
use serde::Serialize;
use std::f64::consts::TAU;

/// A tendon.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Tendon {
    /// Name for probes and messages.
    pub name: String,
    /// Tension at given times, (s, N).
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub tension: Vec<(f64, f64)>,
    /// Coefficient of friction in the eyelets.
    #[serde(skip_serializing_if = "is_zero")]
    pub friction: f64,
    /// Length moved before the tendon slides, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub presliding: Option<f64>,
    /// EA, N; `None` if the tension is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stretching_stiffness: Option<f64>,
    /// Length without tension, m; `None` is the length as placed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rest_length: Option<f64>,
    /// Length taken in at given times, (s, m).
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub taken_in: Vec<(f64, f64)>,
    /// The eyelets.
    pub through: Vec<Eyelets>,
}

/// An eyelet or a row of eyelets.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Eyelets {
    /// A point that does not move, m.
    Fixed {
        /// The point.
        position: [f64; 3],
    },
    /// Nodes of a rod.
    OnRod(Row),
}

/// Eyelets along a rod.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Name of the rod.
    pub rod: String,
    /// The first node.
    pub at: Place,
    /// The last node; `None` for a single eyelet.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub to: Option<Place>,
    /// Distance of the eyelets, in nodes.
    #[serde(skip_serializing_if = "is_one")]
    pub every: usize,
    /// Components along the directors, m.
    pub offset: [f64; 2],
    /// Turns of the offset about the rod.
    #[serde(skip_serializing_if = "is_zero")]
    pub turns: f64,
}

fn is_one(every: &usize) -> bool {
    *every == 1
}

fn is_zero(turns: &f64) -> bool {
    *turns == 0.0
}

impl Part for Tendon {
    type Typed = TendonKeys;

    const KEY: &'static str = "tendons";
    const DESCRIPTION: &'static str =
        "Cables through eyelets: tendons, ropes over pulleys, winches.";

    fn resolve(section: &Section<'_>, typed: &TendonKeys, index: usize) -> Self {
        let tendon = Self {
            name: typed.name(section, format!("tendon {index}")),
            tension: section.corners(
                "tension",
                typed.tension.as_deref().unwrap_or_default(),
                |corner, force| corner.number("1", force, NON_NEGATIVE),
            ),
            friction: typed.friction(section),
            presliding: typed.presliding(section),
            stretching_stiffness: typed.stretching_stiffness(section),
            rest_length: typed.rest_length(section),
            taken_in: typed.taken_in(section, Vec::new()),
            through: (section.elements("through", &typed.through))
                .map(|(section, typed)| Eyelets::resolve(&section, typed))
                .collect(),
        };
        tendon.check(section);
        tendon
    }

    fn judge(array: &Section<'_>, all: &[Self], time: &Time) {
        for (index, _) in (all.iter().enumerate()).filter(|(_, tendon)| tendon.friction > 0.0) {
            let refused = [("friction", time.finds_equilibria())];
            (array.below(&index.to_string())).refuse(&refused, Time::RESTING_FRICTION);
        }
        if *time != Time::Static {
            return;
        }
        for (index, tendon) in all.iter().enumerate() {
            for (key, corners) in [("tension", &tendon.tension), ("taken_in", &tendon.taken_in)] {
                if corners.len() > 1 {
                    array.below(&index.to_string()).fault(
                        key,
                        "a static run has no time, so nothing changes in it; give one value, such as [[0, 5]]",
                    );
                }
            }
        }
    }
}

impl Tendon {
    /// Checks of several keys.
    fn check(&self, section: &Section<'_>) {
        if self.through.is_empty() {
            section.missing("through", "the eyelets, such as [{ position = [0, 0, 1] }, { rod = \"spine\", at = \"end\" }]");
        }
        let pull = "`tension` or `stretching_stiffness`";
        match self.stretching_stiffness {
            None if self.tension.is_empty() => {
                section.missing("tension", format!("give {pull}"));
            }
            Some(_) if !self.tension.is_empty() => {
                section.fault("tension", format!("give {pull}, not both"));
            }
            Some(_) => {}
            None => section.refuse(
                &[
                    ("rest_length", self.rest_length.is_some()),
                    ("taken_in", !self.taken_in.is_empty()),
                ],
                "this key belongs to tendons with `stretching_stiffness`",
            ),
        }
        if self.presliding.is_some() && self.friction == 0.0 {
            section.fault("presliding", "this key belongs to tendons with `friction`");
        }
        let most = self.taken_in.iter().map(|corner| corner.1);
        let most = most.fold(0.0, f64::max);
        if let Some(length) = self.rest_length
            && most >= length
        {
            let allowed = format_args!("less than `rest_length` = {length:?} m");
            section.out_of_range("taken_in", format_args!("{most:?} m"), allowed);
        }
    }
}

impl Eyelets {
    fn resolve(section: &Section<'_>, typed: &EyeletKeys) -> Self {
        let position = typed.position(section);
        let rod = typed.rod(section);
        let of_rods = [
            ("at", typed.at.is_some()),
            ("to", typed.to.is_some()),
            ("every", typed.every.is_some()),
            ("offset", typed.offset.is_some()),
            ("turns", typed.turns.is_some()),
        ];
        if let Some(position) = position {
            if rod.is_some() {
                section.fault("position", "give `position` or `rod`, not both");
            }
            section.refuse(&of_rods, "this key belongs to eyelets on a `rod`");
            return Self::Fixed { position };
        }
        if rod.is_none() {
            section.missing("rod", "the name of a rod, or a `position`");
        }
        let at = section.needed(
            "at",
            typed.at(section),
            "a node: \"start\", \"end\" or a number",
        );
        let to = typed.to(section);
        if to.is_none() {
            let of_rows = [
                ("every", typed.every.is_some()),
                ("turns", typed.turns.is_some()),
            ];
            section.refuse(&of_rows, "this key belongs to rows of eyelets, with `to`");
        }
        Self::OnRod(Row {
            rod: rod.unwrap_or_default(),
            at: at.unwrap_or(Place::Start),
            to,
            every: typed.every(section),
            offset: typed.offset(section),
            turns: typed.turns(section),
        })
    }

    /// The eyelets of the scene; faults name the key.
    fn place(&self, rods: &[RodDescription], path: &KeyPath) -> Result<Vec<scene::Eyelet>, Issue> {
        let row = match self {
            Self::Fixed { position } => {
                return Ok(vec![scene::Eyelet::Fixed(Vector3::from(*position))]);
            }
            Self::OnRod(row) => row,
        };
        let rod = find_rod(&row.rod, rods, &path.key("rod"))?;
        let nodes = rods[rod].centreline.len();
        let node =
            |place: Place, key: &str| find_place(place, nodes, "node", &rods[rod], &path.key(key));
        let first = node(row.at, "at")?;
        let last = row.to.map_or(Ok(first), |to| node(to, "to"))?;
        let eyelet = |(node, offset)| scene::Eyelet::OnRod {
            at: RodNode { rod, node },
            offset,
        };
        Ok(row.between(first, last).map(eyelet).collect())
    }
}

impl Row {
    /// The nodes of the eyelets between two nodes, with their offsets along the directors, m.
    pub fn between(&self, first: usize, last: usize) -> impl Iterator<Item = (usize, [f64; 2])> {
        let count = first.abs_diff(last);
        let steps = (0..count).step_by(self.every).chain([count]);
        let ([a, b], turn) = (self.offset, TAU * self.turns / count.max(1) as f64);
        steps.map(move |step| {
            let (sine, cosine) = libm::sincos(turn * step as f64);
            let node = if last < first {
                first - step
            } else {
                first + step
            };
            (node, [a * cosine - b * sine, a * sine + b * cosine])
        })
    }
}

impl ScenePart for Tendon {
    fn place(&self, scene: &mut Scene, path: &KeyPath) -> Result<(), Issue> {
        let through = path.key("through");
        let mut eyelets = Vec::new();
        for (index, row) in self.through.iter().enumerate() {
            eyelets.extend(row.place(&scene.rods, &through.index(index))?);
        }
        if eyelets.len() < 2 {
            let message = "one eyelet; allowed: two or more";
            return Err(Issue::new(through, message));
        }
        if scene.tendons.iter().any(|other| other.name == self.name) {
            let message = format!("another tendon is called `{}`", self.name);
            return Err(Issue::new(path.key("name"), message));
        }
        scene.tendons.push(scene::Tendon {
            name: self.name.clone(),
            eyelets,
            friction: (self.friction > 0.0).then_some(scene::CoulombFriction {
                coefficient: self.friction,
                presliding: self.presliding,
            }),
            pull: match self.stretching_stiffness {
                Some(stiffness) => Pull::Stretching {
                    stiffness,
                    rest_length: self.rest_length,
                    taken_in: self.taken_in.clone(),
                },
                None => Pull::Tension(self.tension.clone()),
            },
        });
        Ok(())
    }
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
name = "spine"
radius = 0.01
edges = 10
shape = { kind = "straight", start = [0, 0, 0], end = [1, 0, 0] }
[time]
end = 1.0
[[tendons]]
TENDON
"#;

    fn tendons(tendon: &str) -> Result<Vec<scene::Tendon>, String> {
        prepared(&SCENE.replace("TENDON", tendon)).map(|scene| scene.tendons)
    }

    #[test]
    fn a_row_of_eyelets_turns_about_the_rod_and_ends_at_its_last_node() {
        let placed = tendons(
            "tension = [[0, 2]]\nfriction = 0.2\npresliding = 0.001\nthrough = [{ position = [2, 0, 0] }, { rod = \"spine\", at = \"end\", to = 3, every = 4, offset = [\"1 cm\", 0], turns = 0.25 }]",
        );
        let eyelets = &placed.unwrap()[0].eyelets;
        let seen: Vec<_> = eyelets[1..]
            .iter()
            .map(|eyelet| match eyelet {
                scene::Eyelet::OnRod { at, offset } => (at.node, *offset),
                scene::Eyelet::Fixed(_) => panic!("on the rod"),
            })
            .collect();
        assert_eq!(seen.len(), 3);
        for ((node, offset), (expected, angle)) in
            seen.into_iter()
                .zip([(10, 0.0), (6, TAU / 7.0), (3, TAU / 4.0)])
        {
            assert_eq!(node, expected);
            assert!((offset[0] - 0.01 * libm::cos(angle)).abs() < 1e-15);
            assert!((offset[1] - 0.01 * libm::sin(angle)).abs() < 1e-15);
        }
    }

    #[test]
    fn faults_of_tendons_name_the_key_and_what_is_allowed() {
        let spine = "{ rod = \"spine\", at = \"end\" }";
        let through = format!("through = [{{ position = [0, 0, 1] }}, {spine}]");
        for (keys, expected) in [
            (through.clone(), "missing key `tension`"),
            ("tension = [[0, 1]]".to_owned(), "missing key `through`"),
            (format!("tension = [[0, -1]]\n{through}"), "at least 0"),
            (
                format!("tension = [[0, 1]]\nstretching_stiffness = 2\n{through}"),
                "not both",
            ),
            (
                format!("tension = [[0, 1]]\nrest_length = 2\n{through}"),
                "belongs to tendons with `stretching_stiffness`",
            ),
            (
                format!(
                    "stretching_stiffness = 9\nrest_length = 1\ntaken_in = [[0, 0], [1, 2]]\n{through}"
                ),
                "less than `rest_length`",
            ),
            (
                format!("tension = [[0, 1]]\npresliding = 0.1\n{through}"),
                "belongs to tendons with `friction`",
            ),
            (
                format!("tension = [[0, 1]]\nthrough = [{spine}]"),
                "two or more",
            ),
            (
                format!("tension = [[0, 1]]\nthrough = [{spine}, {{ rod = \"spine\", at = 40 }}]"),
                "no node 40",
            ),
            (
                format!("tension = [[0, 1]]\nthrough = [{spine}, {{ rod = \"spin\", at = 4 }}]"),
                "no rod is called `spin`",
            ),
            (
                format!(
                    "tension = [[0, 1]]\nthrough = [{spine}, {{ position = [0, 0, 0], turns = 1 }}]"
                ),
                "belongs to eyelets on a `rod`",
            ),
        ] {
            let error = tendons(&keys).unwrap_err();
            assert!(error.contains(expected), "{keys}: {error}");
            assert!(error.contains("tendons.0"), "{error}");
        }
    }
}
