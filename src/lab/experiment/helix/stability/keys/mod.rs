//! The keys of the stability of helical rods: modules `typed` and `resolved`, and the conversion
//! between them here.

mod resolved;
mod typed;

pub use resolved::{Directions, HelixSearch, HelixStability};

use crate::scenario::keys::{OwnTable, Request, Section, read_columns};
use serde::Serialize;

/// The table of this experiment.
pub static TABLES: [OwnTable; 1] = [OwnTable::new::<typed::HelixStability>(
    "helix_stability",
    "Rod and directions of the experiment \"helix-stability\".",
)];

/// Maximum number of edges, and maximum number of directions of a list.
const MOST_EDGES: usize = 10_000;
const MOST_DIRECTIONS: usize = 10_000_000;
/// Radius over length of the rod of the thesis (section 6.3.4).
const RADIUS: f64 = 0.781e-3;

/// Keys that this experiment reads.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HelixTables {
    /// Rod and directions.
    pub helix_stability: HelixStability,
}

/// Resolves the table of this experiment; `None` after a faulty whole number or list, which is
/// reported.
pub fn resolve(request: &Request<'_>) -> Option<HelixTables> {
    let typed: &typed::HelixStability = request.table("helix_stability")?;
    let section = request.top.below("helix_stability");
    let edges = section.count(
        "edges",
        typed.edges.or(Some(100)),
        HelixStability::FEWEST_EDGES..=MOST_EDGES,
    );
    let radius = typed.radius(&section);
    if radius > 0.05 {
        let allowed = "greater than 0 and at most 0.05, a slender rod";
        section.out_of_range("radius", radius, allowed);
    }
    let stiffness_ratio = typed.stiffness_ratio(&section);
    let section_directions = section.count(
        "section_directions",
        typed.section_directions.or(Some(0)),
        0..=MOST_DIRECTIONS,
    );
    let directions = directions(&section, typed.directions.as_ref());
    let edges = edges?;
    let extrapolate = typed.extrapolate(&section);
    if extrapolate && (edges % 2 == 1 || edges < 2 * HelixStability::FEWEST_EDGES) {
        section.fault(
            "edges",
            format!(
                "{edges} is out of range; allowed with extrapolate = true: even numbers from {}",
                2 * HelixStability::FEWEST_EDGES
            ),
        );
    }
    let coarsest = if extrapolate { edges / 2 } else { edges };
    let farthest = HelixStability::LARGEST_TURN * coarsest as f64;
    let largest_distance = typed.largest_distance(&section, (0.25 * edges as f64).min(farthest));
    if largest_distance > farthest {
        let allowed = format_args!(
            "greater than 0 and at most {farthest}, where the rod turns by half a radian from edge to edge of the \
             coarsest mesh"
        );
        section.out_of_range("largest_distance", largest_distance, allowed);
    }
    Some(HelixTables {
        helix_stability: HelixStability {
            edges,
            extrapolate,
            search: typed.search(&section),
            radius,
            stiffness_ratio,
            largest_distance,
            directions: directions?,
            section_directions: section_directions?,
        },
    })
}

fn directions(section: &Section<'_>, typed: Option<&typed::Directions>) -> Option<Directions> {
    let kinds = "{ kind = \"fibonacci\", count = 1000 }, { kind = \"grid\", ... } or { kind = \"list\", ... }";
    let typed = section.needed("directions", typed, kinds)?;
    let section = section.below("directions");
    let count = |key, typed| section.count(key, typed, 1..=MOST_DIRECTIONS);
    match typed {
        typed::Directions::Fibonacci(lattice) => Some(Directions::Fibonacci {
            count: count("count", lattice.count)?,
        }),
        typed::Directions::Grid(grid) => {
            let (polar, azimuthal) = (
                count("polar", grid.polar),
                count("azimuthal", grid.azimuthal),
            );
            Some(Directions::Grid {
                polar: polar?,
                azimuthal: azimuthal?,
            })
        }
        typed::Directions::List(list) => Some(Directions::List {
            points: points(&section, list)?,
        }),
    }
}

fn points(section: &Section<'_>, typed: &typed::List) -> Option<Vec<[f64; 3]>> {
    match (&typed.file, &typed.points) {
        (Some(file), None) => {
            let path = section.path_of("file", file);
            let read = read_columns(&path, ["kappa", "tau", "omega"]).and_then(|rows| {
                for (line, point) in &rows {
                    if let Some(fault) = fault_of(point) {
                        return Err(format!("{}, line {line}: {fault}", path.display()));
                    }
                }
                Ok(rows.into_iter().map(|(_, point)| point).collect())
            });
            read.map_err(|message| section.fault("file", message)).ok()
        }
        (None, Some(points)) => {
            let below = section.below("points");
            let mut resolved = Vec::new();
            for (index, typed) in points.iter().enumerate() {
                let index = index.to_string();
                let point = below.components(&index, typed);
                if let Some(fault) = fault_of(&point) {
                    below.fault(&index, fault);
                }
                resolved.push(point);
            }
            if resolved.is_empty() {
                section.fault("points", "a list needs at least 1 direction");
            }
            Some(resolved)
        }
        (None, None) => {
            let help = "a CSV file with columns kappa, tau, omega, or the `points` themselves";
            section.missing("file", help);
            None
        }
        (Some(_), Some(_)) => {
            section.fault("points", "give `file` or `points`, not both");
            None
        }
    }
}

/// The fault of a direction, if any.
fn fault_of(point: &[f64; 3]) -> Option<String> {
    if point[0] < 0.0 {
        return Some(format!(
            "the curvature {:?} is out of range; allowed: at least 0. \
             A helix of curvature −κ is a turned helix of curvature κ",
            point[0]
        ));
    }
    (*point == [0.0; 3]).then(|| "a direction cannot be [0, 0, 0]".into())
}
