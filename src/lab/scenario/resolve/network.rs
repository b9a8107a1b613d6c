//! Resolves networks to rods, joints at their crossings, and clamps at their rim.

use super::columns::read_columns;
use super::polyline;
use super::rod;
use super::rod::{CommonMaterial, MOST_EDGES, Member};
use crate::scenario::resolved::{
    Clamp, HeldEnds, Hold, Joint, JointKind, Movement, NetworkJoint, Place, Rod, Shape, Time,
};
use crate::scenario::section::{POSITIVE, Section};
use crate::scenario::typed;
use std::collections::BTreeMap;

/// Maximum numbers of rods (along one side of a grid, or in a table) and of points: larger numbers
/// are taken for typing errors.
const MOST_RODS: usize = 1_000;
const MOST_POINTS: usize = 100_000;

/// Elements that networks add to a scenario.
#[derive(Debug, Default)]
pub struct Networks {
    /// Rods.
    pub rods: Vec<Rod>,
    /// Joints at crossings.
    pub joints: Vec<Joint>,
    /// Clamps at the rim.
    pub clamps: Vec<Clamp>,
}

/// Points, and the polylines through them.
struct Layout {
    points: Vec<[f64; 3]>,
    rods: Vec<Vec<usize>>,
}

/// Resolves all networks.
pub fn networks(
    top: &Section<'_>,
    typed: &[typed::Network],
    common: &CommonMaterial<'_>,
) -> Networks {
    let mut all = Networks::default();
    let mut names = Vec::new();
    for (index, (below, typed)) in top.elements("networks", typed).enumerate() {
        let name = rod::name(&below, typed.name.as_deref().or(Some("net")), index);
        if names.contains(&name) {
            below.fault("name", format!("another network is called `{name}`"));
        }
        add(&below, typed, &name, common, &mut all);
        names.push(name);
    }
    all
}

/// Rejects a moving rim in a run without time.
pub fn refuse_static_motion(top: &Section<'_>, typed: &[typed::Network], time: &Time) {
    for (section, network) in top.elements("networks", typed) {
        let rim = network.boundary.as_ref();
        if rim.is_some_and(|rim| rim.scale.is_some()) && *time == Time::Static {
            section.below("boundary").fault_with_help(
                "scale",
                "a static run has no time in which the rim could move",
                Some("take time.mode = \"dynamic\" or \"continuation\"".to_owned()),
            );
        }
    }
}

fn add(
    section: &Section<'_>,
    typed: &typed::Network,
    name: &str,
    common: &CommonMaterial<'_>,
    all: &mut Networks,
) {
    let of_shape = section.needed(
        "shape",
        typed.shape.as_ref(),
        "a table such as { kind = \"grid\", sides = [[1, 0, 0], [0, 1, 0]], rods = [10, 10] }",
    );
    let of_rod = section.needed(
        "rod",
        typed.rod.as_ref(),
        "the properties of its rods, such as { radius = \"2 mm\", edges = 5 }",
    );
    let (Some(of_shape), Some(of_rod)) = (of_shape, of_rod) else {
        return;
    };
    let below = section.below("rod");
    below.refuse(
        &[
            ("name", of_rod.name.is_some()),
            ("shape", of_rod.shape.is_some()),
            ("closed", of_rod.closed.is_some()),
        ],
        "the network sets this for each of its rods; leave the key out",
    );
    let sections = [
        ("sections", !of_rod.sections.is_empty()),
        ("profile", of_rod.profile.is_some()),
    ];
    below.refuse(
        &sections,
        "rods of networks have the same section everywhere",
    );
    let edges = below.count("edges", of_rod.edges.or(Some(1)), 1..=MOST_EDGES);
    let layout = match of_shape {
        typed::NetworkShape::Grid { .. } => grid(&section.below("shape"), of_shape),
        typed::NetworkShape::Table { .. } => table(&section.below("shape"), of_shape),
    };
    let (Some(edges), Some(layout)) = (edges, layout) else {
        return;
    };
    let places: usize = layout.rods.iter().map(|rod| rod.len() - 1).sum();
    if places.saturating_mul(edges) > MOST_EDGES {
        let message =
            format!("{places} pieces of {edges} edges; allowed: {MOST_EDGES} edges in all");
        below.fault("edges", message);
        return;
    }
    let is_grid = matches!(of_shape, typed::NetworkShape::Grid { .. });
    for (number, points) in layout.rods.iter().enumerate() {
        let at = |point: usize| layout.points[points[point]];
        let last = points.len() - 1;
        let member = Member {
            name: format!("{name}_{number}"),
            edges: edges * last,
            shape: if is_grid {
                Shape::Straight {
                    start: at(0),
                    end: at(last),
                }
            } else {
                Shape::Points {
                    points: divided(
                        &points.iter().map(|p| layout.points[*p]).collect::<Vec<_>>(),
                        edges,
                    ),
                }
            },
        };
        all.rods.push(rod::member(&below, of_rod, common, member));
    }
    let kind = match typed.joint.unwrap_or_default() {
        NetworkJoint::Ball => JointKind::Ball,
        NetworkJoint::Rigid => JointKind::Rigid,
    };
    let visits = visits(&layout, edges);
    for (point, visits) in &visits {
        for (rod, node) in &visits[1..] {
            all.joints.push(Joint {
                name: format!("{name} at point {point}"),
                rods: [visits[0].0, *rod].map(|rod| format!("{name}_{rod}")),
                at: [Place::Number(visits[0].1), Place::Number(*node)],
                break_at: None,
                break_at_moment: None,
                kind,
            });
        }
    }
    if let Some(boundary) = &typed.boundary {
        let section = section.below("boundary");
        hold(&section, boundary, kind, name, &layout, &visits, edges, all);
    }
}

/// Every point with the rods that pass through it, and their nodes there.
fn visits(layout: &Layout, edges: usize) -> BTreeMap<usize, Vec<(usize, usize)>> {
    let mut visits: BTreeMap<usize, Vec<(usize, usize)>> = BTreeMap::new();
    for (rod, points) in layout.rods.iter().enumerate() {
        for (place, point) in points.iter().enumerate() {
            visits.entry(*point).or_default().push((rod, edges * place));
        }
    }
    visits
}

/// Two families of straight rods.
fn grid(section: &Section<'_>, typed: &typed::NetworkShape) -> Option<Layout> {
    let typed::NetworkShape::Grid {
        corner,
        sides,
        rods,
    } = typed
    else {
        return None;
    };
    let corner = section.vector("corner", corner).unwrap_or_default();
    let sides = section.needed(
        "sides",
        sides.as_ref(),
        "two vectors, such as [[1, 0, 0], [0, 1, 0]]",
    )?;
    let below = section.below("sides");
    let sides: [[f64; 3]; 2] = std::array::from_fn(|k| below.components(&k.to_string(), &sides[k]));
    let [a, b] = sides;
    let cross = [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ];
    if cross.iter().all(|component| *component == 0.0) {
        section.fault(
            "sides",
            "the two sides are parallel: there is nothing between them",
        );
        return None;
    }
    let rods = section.needed(
        "rods",
        *rods,
        "numbers of rods along either side, such as [10, 10]",
    )?;
    let below = section.below("rods");
    let along_first = below.count("0", Some(rods[0]), 2..=MOST_RODS)?;
    let along_second = below.count("1", Some(rods[1]), 2..=MOST_RODS)?;
    // Point (i, j) is the one after i parts along the first side and j parts along the second.
    // Rods along the first side are numbered by j.
    let number = |i: usize, j: usize| j * along_second + i;
    let mut points = Vec::new();
    for j in 0..along_first {
        for i in 0..along_second {
            let parts = [
                i as f64 / (along_second - 1) as f64,
                j as f64 / (along_first - 1) as f64,
            ];
            points.push(std::array::from_fn(|k| {
                corner[k] + parts[0] * a[k] + parts[1] * b[k]
            }));
        }
    }
    let first = (0..along_first).map(|j| (0..along_second).map(|i| number(i, j)).collect());
    let second = (0..along_second).map(|i| (0..along_first).map(|j| number(i, j)).collect());
    Some(Layout {
        points,
        rods: first.chain(second).collect(),
    })
}

/// Polylines through listed points.
fn table(section: &Section<'_>, typed: &typed::NetworkShape) -> Option<Layout> {
    let typed::NetworkShape::Table {
        points_file,
        rods_file,
        points,
        rods,
    } = typed
    else {
        return None;
    };
    let points = polyline::corners(section, "points_file", points_file, points);
    let rods: Vec<Vec<i64>> = match (rods_file, rods) {
        (None, Some(rods)) => rods.clone(),
        (Some(file), None) => {
            let path = section.path_of("rods_file", file);
            match read_columns(&path, ["rod", "point"]) {
                Ok(rows) => by_rods(&rows),
                Err(message) => {
                    section.fault("rods_file", message);
                    return None;
                }
            }
        }
        (Some(_), Some(_)) => {
            section.fault("rods", "give `rods_file` or `rods`, not both");
            return None;
        }
        (None, None) => {
            section.missing(
                "rods",
                "the points of each rod, such as [[0, 1, 2], [3, 1]], or a `rods_file`",
            );
            return None;
        }
    };
    if points.is_empty() {
        return None;
    }
    if points.len() > MOST_POINTS || rods.len() > MOST_POINTS {
        section.fault("rods", format!("more than {MOST_POINTS} points or rods"));
        return None;
    }
    let below = section.below(if rods_file.is_some() {
        "rods_file"
    } else {
        "rods"
    });
    let mut lines = Vec::new();
    for (index, rod) in rods.iter().enumerate() {
        let known: Vec<usize> = rod
            .iter()
            .map(|point| usize::try_from(*point).unwrap_or(usize::MAX))
            .collect();
        let wrong = known.iter().position(|point| *point >= points.len());
        let repeated = known.windows(2).any(|pair| pair[0] == pair[1]);
        let message = if let Some(place) = wrong {
            format!(
                "rod {index}: there is no point {}; allowed: 0 to {}",
                rod[place],
                points.len() - 1
            )
        } else if known.len() < 2 {
            format!("rod {index} needs at least 2 points")
        } else if repeated {
            format!("rod {index} runs through the same point twice in a row")
        } else {
            lines.push(known);
            continue;
        };
        below.fault(&index.to_string(), message);
        return None;
    }
    if lines.is_empty() {
        section.missing("rods", "at least one rod");
        return None;
    }
    Some(Layout {
        points,
        rods: lines,
    })
}

/// The points of each rod, in the order of the rods' first rows.
fn by_rods(rows: &[(u64, [f64; 2])]) -> Vec<Vec<i64>> {
    let mut rods: Vec<(f64, Vec<i64>)> = Vec::new();
    let mut places: BTreeMap<u64, usize> = BTreeMap::new();
    for (_, [rod, point]) in rows {
        let place = *places.entry(rod.to_bits()).or_insert_with(|| {
            rods.push((*rod, Vec::new()));
            rods.len() - 1
        });
        // A fraction is rejected like the number of a point that does not exist.
        let whole = if point.fract() == 0.0 {
            *point as i64
        } else {
            -1
        };
        rods[place].1.push(whole);
    }
    rods.into_iter().map(|(_, points)| points).collect()
}

/// A polyline with every segment divided into this number of edges.
fn divided(points: &[[f64; 3]], edges: usize) -> Vec<[f64; 3]> {
    let mut all = Vec::with_capacity(edges * (points.len() - 1) + 1);
    for pair in points.windows(2) {
        for part in 0..edges {
            let s = part as f64 / edges as f64;
            all.push(std::array::from_fn(|k| {
                pair[0][k] * (1.0 - s) + pair[1][k] * s
            }));
        }
    }
    all.extend(points.last());
    all
}

/// Clamps at the ends of the rods.
#[allow(clippy::too_many_arguments)] // one private call; a struct of these would have no other use
fn hold(
    section: &Section<'_>,
    typed: &typed::Boundary,
    kind: JointKind,
    name: &str,
    layout: &Layout,
    visits: &BTreeMap<usize, Vec<(usize, usize)>>,
    edges: usize,
    all: &mut Networks,
) {
    let hold = typed.hold.unwrap_or(Hold::Position);
    let scale = section.corners(
        "scale",
        typed.scale.as_deref().unwrap_or_default(),
        |corner, factor| corner.number("1", factor, POSITIVE),
    );
    let is_end =
        |rod: usize, node: usize| node == 0 || node == edges * (layout.rods[rod].len() - 1);
    let held: Vec<(usize, Vec<(usize, usize)>)> = (visits.iter())
        .map(|(point, visits)| {
            let ends = visits.iter().filter(|(rod, node)| is_end(*rod, *node));
            (*point, ends.copied().collect::<Vec<_>>())
        })
        .filter(|(_, ends)| {
            ends.len()
                >= if typed.ends == Some(HeldEnds::Corners) {
                    2
                } else {
                    1
                }
        })
        .collect();
    let mut centre = [0.0; 3];
    for (point, _) in &held {
        for (k, sum) in centre.iter_mut().enumerate() {
            *sum += layout.points[*point][k] / held.len() as f64;
        }
    }
    for (point, ends) in &held {
        let at = layout.points[*point];
        let moved = |factor: f64| std::array::from_fn(|k| (factor - 1.0) * (at[k] - centre[k]));
        let holds_position = hold != Hold::Frame;
        for (index, (rod, node)) in ends.iter().enumerate() {
            // One clamp holds the point, and the frame of a rigid joint. Other clamps at this
            // point hold the frames of their rods.
            let own = match (index, hold) {
                (0, _) => hold,
                _ if kind == JointKind::Rigid => continue,
                (_, Hold::Frame) => hold,
                (_, Hold::Position) => continue,
                (_, Hold::Both) => Hold::Frame,
            };
            let follows = holds_position && own != Hold::Frame;
            all.clamps.push(Clamp {
                rod: format!("{name}_{rod}"),
                at: Place::Number(*node),
                hold: own,
                offset: [0.0; 3],
                rotation: [0.0; 3],
                movement: Movement {
                    translation: if follows {
                        scale
                            .iter()
                            .map(|(time, factor)| (*time, moved(*factor)))
                            .collect()
                    } else {
                        Vec::new()
                    },
                    ..Movement::default()
                },
            });
        }
    }
}
