//! `scatter`: random places without overlap.
//!
//! Random sequential addition (Widom 1966): each copy is placed at random until it is far enough
//! from all earlier copies. The first copies therefore stay where they are if `count` grows.

use super::scope::{Place, uniform};
use super::values::Evaluator;
use crate::scenario::decode::decode;
use crate::scenario::document::Entry;
use crate::scenario::error::Located;
use crate::scenario::expression::{Amount, uniform_between};
use crate::scenario::issue::{Issue, Issues, KeyPath};
use crate::scenario::schema_tree::SchemaTree;
use crate::scenario::typed::{Quantity, Vector};
use crate::scenario::units::{Dimension, Dimensionless, Length};
use schemars::JsonSchema;
use serde::Deserialize;
use std::f64::consts::TAU;

/// Maximum number of trial places for a copy.
const MOST_ATTEMPTS: usize = 10_000;
/// Maximum number of copies: each is compared with all earlier ones.
const MOST_COPIES: usize = 10_000;
/// Maximum number of comparisons of two copies, which take some seconds.
const MOST_COMPARISONS: usize = 500_000_000;
/// Names of the coordinates of a centre.
const CENTRE: [&str; 3] = ["x", "y", "z"];
/// Names of the components of a direction.
const DIRECTION: [&str; 3] = ["u", "v", "w"];

/// Random places of the copies of a table, without overlap. They define the names x, y, z of a
/// centre and u, v, w of a unit direction.
#[derive(Debug, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "scatter")]
pub struct Scatter {
    /// Two opposite corners of the box of the centres, [[x, y, z], [x, y, z]]; equal coordinates
    /// make the box flat.
    region: Option<[Vector<Length>; 2]>,
    /// Least distance between two centres, or with `length` between two straight segments; 0 or
    /// greater.
    distance: Option<Quantity<Length>>,
    /// Length of the straight segment about each centre, along u, v, w. Default: 0, a point.
    length: Option<Quantity<Length>>,
    /// Common direction of all copies. Default: random directions.
    axis: Option<Vector<Dimensionless>>,
    /// Axis to which random directions are normal. Default: any direction.
    normal: Option<Vector<Dimensionless>>,
}

type Point = [f64; 3];

/// A straight segment: one end, and the vector to the other end.
type Piece = (Point, Point);

/// The request, in SI units.
struct Request {
    corners: [Point; 2],
    distance: f64,
    length: f64,
    axis: Option<Point>,
    normal: Option<Point>,
}

/// The names of a number of places; `None` after a fault.
pub fn places(
    evaluator: &Evaluator<'_>,
    table: &Entry,
    place: &Place,
    count: usize,
    faults: &mut Vec<Located>,
) -> Option<Vec<Vec<(String, Amount)>>> {
    let schema = schemars::schema_for!(Scatter).to_value();
    let within = Evaluator {
        tree: SchemaTree::new(&schema),
        ..*evaluator
    };
    let mut node = table.node.clone();
    let before = faults.len();
    within.visit(&mut node, Some(&schema), place, faults);
    if faults.len() > before {
        return None;
    }
    let scattered = decode::<Scatter>(&node)
        .and_then(|typed| Request::new(&typed))
        .and_then(|request| {
            let key = format!("{}", place.named);
            request.places(count, uniform(evaluator.parameters.seed(), &key))
        });
    match scattered {
        Ok(scattered) => Some(scattered.into_iter().map(|place| named(&place)).collect()),
        Err(issues) => {
            for issue in issues.0 {
                let (key, value) = node.locate(&issue.path);
                let span = if issue.labels_key { key } else { value };
                let span = if issue.path.steps().is_empty() {
                    table.key_span.clone()
                } else {
                    span
                };
                let path = issue
                    .path
                    .steps()
                    .iter()
                    .fold(place.path.clone(), |path, step| path.key(step));
                let issue = Issue { path, ..issue };
                faults.push(Located::new(evaluator.sources, issue, Some(span)));
            }
            None
        }
    }
}

fn named((centre, direction): &(Point, Point)) -> Vec<(String, Amount)> {
    let centre = CENTRE.iter().zip(centre).map(|(name, value)| {
        let amount = Amount {
            value: *value,
            powers: Length::POWERS,
        };
        ((*name).to_owned(), amount)
    });
    let direction = DIRECTION.iter().zip(direction);
    let direction = direction.map(|(name, value)| ((*name).to_owned(), Amount::pure(*value)));
    centre.chain(direction).collect()
}

impl Request {
    fn new(typed: &Scatter) -> Result<Self, Issues> {
        let mut issues = Issues::default();
        let top = KeyPath::root;
        let mut missing = |key: &str, what: &str| {
            let issue = Issue::new(top(), format!("missing key `{key}`"));
            issues.push(issue.with_help(what.to_owned()));
        };
        if typed.region.is_none() {
            missing("region", "two opposite corners, [[x, y, z], [x, y, z]]");
        }
        if typed.distance.is_none() {
            missing("distance", "a length, 0 or greater");
        }
        let path = top().key("region");
        let corners = typed
            .region
            .as_ref()
            .map_or([[0.0; 3]; 2], |[first, second]| {
                [
                    vector(first, &path.index(0), &mut issues),
                    vector(second, &path.index(1), &mut issues),
                ]
            });
        let mut positive = |key: &str, typed: &Option<Quantity<Length>>| {
            let message = match typed.as_ref().map_or(Ok(0.0), Quantity::si) {
                Ok(value) if value >= 0.0 => return value,
                Ok(value) => format!("{value:?} is out of range; allowed: 0 or greater"),
                Err(message) => message,
            };
            issues.push(Issue::new(top().key(key), message));
            0.0
        };
        let distance = positive("distance", &typed.distance);
        let length = positive("length", &typed.length);
        let mut direction = |key: &str, typed: &Option<Vector<Dimensionless>>| {
            let vector = vector(typed.as_ref()?, &top().key(key), &mut issues);
            let norm = dot(vector, vector).sqrt();
            if !(norm > 0.0) {
                issues.push(Issue::new(
                    top().key(key),
                    "a direction cannot be [0, 0, 0]",
                ));
            }
            Some(vector.map(|component| component / norm))
        };
        let axis = direction("axis", &typed.axis);
        let normal = direction("normal", &typed.normal);
        if axis.is_some() && normal.is_some() {
            issues.push(Issue::new(
                top().key("normal"),
                "give `axis` or `normal`, not both",
            ));
        }
        issues.or_ok(Self {
            corners,
            distance,
            length,
            axis,
            normal,
        })
    }

    /// Centres and directions.
    fn places(
        &self,
        count: usize,
        mut uniform: impl FnMut() -> f64,
    ) -> Result<Vec<(Point, Point)>, Issues> {
        let fault = |message: String| Issues::from(Issue::new(KeyPath::root(), message));
        if count > MOST_COPIES {
            return Err(fault(format!(
                "{count} places are too many; allowed: at most {MOST_COPIES}"
            )));
        }
        let mut places: Vec<(Point, Point)> = Vec::new();
        let mut comparisons = 0;
        for number in 0..count {
            let found = (0..MOST_ATTEMPTS).find_map(|_| {
                let place = self.random_place(&mut uniform);
                let piece = self.piece(&place);
                let is_free = comparisons <= MOST_COMPARISONS
                    && places.iter().all(|other| {
                        comparisons += 1;
                        squared_distance(&piece, &self.piece(other))
                            >= self.distance * self.distance
                    });
                is_free.then_some(place)
            });
            places.push(found.ok_or_else(|| {
                let message = format!("{number} of {count} copies found a place without overlap");
                let help = "enlarge `region`, or lower `distance`, `length` or `count`".to_owned();
                Issues::from(Issue::new(KeyPath::root(), message).with_help(help))
            })?);
        }
        Ok(places)
    }

    fn random_place(&self, uniform: &mut impl FnMut() -> f64) -> (Point, Point) {
        let [first, second] = self.corners;
        let centre = [0, 1, 2].map(|axis| uniform_between(first[axis], second[axis], uniform()));
        let direction = match (self.axis, self.normal) {
            (Some(axis), _) => axis,
            (None, Some(normal)) => {
                let (a, b) = perpendicular(normal);
                let angle = TAU * uniform();
                let (sine, cosine) = libm::sincos(angle);
                [0, 1, 2].map(|axis| cosine * a[axis] + sine * b[axis])
            }
            (None, None) => {
                // Archimedes: the height of a random point of a sphere is uniform.
                let height = uniform_between(-1.0, 1.0, uniform());
                let radius = (1.0 - height * height).max(0.0).sqrt();
                let (sine, cosine) = libm::sincos(TAU * uniform());
                [radius * cosine, radius * sine, height]
            }
        };
        (centre, direction)
    }

    fn piece(&self, (centre, direction): &(Point, Point)) -> Piece {
        let along = direction.map(|component| self.length * component);
        let start = [0, 1, 2].map(|axis| centre[axis] - 0.5 * along[axis]);
        (start, along)
    }
}

fn vector<D: Dimension>(typed: &Vector<D>, path: &KeyPath, issues: &mut Issues) -> Point {
    [0, 1, 2].map(|axis| {
        typed[axis].si().unwrap_or_else(|message| {
            issues.push(Issue::new(path.index(axis), message));
            0.0
        })
    })
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Point, b: Point) -> Point {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// Two unit vectors at right angles to a unit vector and to each other.
fn perpendicular(normal: Point) -> (Point, Point) {
    let away = if normal[0].abs() < 0.6 {
        [1.0, 0.0, 0.0]
    } else {
        [0.0, 1.0, 0.0]
    };
    let first = cross(normal, away);
    let norm = dot(first, first).sqrt();
    let first = first.map(|component| component / norm);
    (first, cross(normal, first))
}

/// Squared distance of two straight segments (Ericson 2005, Real-Time Collision Detection, 5.1.9).
fn squared_distance((start, along): &Piece, (other_start, other_along): &Piece) -> f64 {
    let from_other = [0, 1, 2].map(|axis| start[axis] - other_start[axis]);
    let a = dot(*along, *along);
    let e = dot(*other_along, *other_along);
    let b = dot(*along, *other_along);
    let c = dot(*along, from_other);
    let f = dot(*other_along, from_other);
    let ratio = |over: f64, under: f64| {
        if under > 0.0 {
            (over / under).clamp(0.0, 1.0)
        } else {
            0.0
        }
    };
    let free = ratio(b * f - c * e, a * e - b * b);
    // If the nearest point of the other line is outside its segment, the nearer end of that
    // segment is used, with the point closest to it.
    let on_other = if e > 0.0 { (b * free + f) / e } else { 0.0 };
    let (s, t) = if on_other < 0.0 || !(e > 0.0) {
        (ratio(-c, a), 0.0)
    } else if on_other > 1.0 {
        (ratio(b - c, a), 1.0)
    } else {
        (free, on_other)
    };
    let between = [0, 1, 2].map(|axis| from_other[axis] + s * along[axis] - t * other_along[axis]);
    dot(between, between)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn request(distance: f64, length: f64) -> Request {
        Request {
            corners: [[0.0; 3], [1.0; 3]],
            distance,
            length,
            axis: None,
            normal: None,
        }
    }

    #[test]
    fn places_are_apart_and_those_of_fewer_copies_are_the_same() {
        let request = request(0.05, 0.3);
        let many = request.places(100, uniform(3, "test")).unwrap();
        let few = request.places(10, uniform(3, "test")).unwrap();
        assert_eq!(few, many[..10]);
        assert_ne!(few, request.places(10, uniform(4, "test")).unwrap());
        for (number, place) in many.iter().enumerate() {
            assert!(place.0.iter().all(|x| (0.0..=1.0).contains(x)));
            assert!((dot(place.1, place.1) - 1.0).abs() < 1e-12);
            for other in &many[..number] {
                let squared = squared_distance(&request.piece(place), &request.piece(other));
                assert!(squared >= 0.05 * 0.05);
            }
        }
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let issues = request(0.9, 0.0)
            .places(100, uniform(0, "test"))
            .unwrap_err();
        assert!(
            issues.to_string().contains("of 100 copies found a place"),
            "{issues}"
        );
    }

    proptest! {
        /// Compares with the least distance of many points of both segments.
        #[test]
        fn distances_of_pieces_are_those_of_their_nearest_points(
            numbers in proptest::array::uniform12(-1.0..1.0f64),
            is_parallel in any::<bool>(),
        ) {
            let point = |at: usize| [numbers[at], numbers[at + 1], numbers[at + 2]];
            let one = (point(0), point(3));
            let other = (point(6), if is_parallel { point(3) } else { point(9) });
            let found = squared_distance(&one, &other).sqrt();
            let at = |piece: &Piece, s: f64| [0, 1, 2].map(|axis| piece.0[axis] + s * piece.1[axis]);
            let mut least = f64::INFINITY;
            for s in 0..=100 {
                for t in 0..=100 {
                    let (a, b) = (at(&one, f64::from(s) / 100.0), at(&other, f64::from(t) / 100.0));
                    let between = [0, 1, 2].map(|axis| a[axis] - b[axis]);
                    least = least.min(dot(between, between).sqrt());
                }
            }
            prop_assert!(found <= least + 1e-9 && found >= least - 0.04, "{} {}", found, least);
        }
    }
}
