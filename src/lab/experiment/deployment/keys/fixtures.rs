//! Resolves the fixtures on the table: pegs, and clips as pairs of pegs.

use super::resolved::{Peg, Rod};
use super::typed;
use crate::scenario::keys::{Length, NON_NEGATIVE, POSITIVE, Quantity, Section};
use rodlab_planning::plan::pattern::{Pattern, PatternPoint, Point};

/// Number of points of the pattern from which distances of pegs are measured.
const POINTS: usize = 4000;
/// Maximum number of pegs on a table.
const MOST_PEGS: usize = 10_000;

/// The pegs of a deployment, with those of clips last; `None` after a fault.
pub fn resolve(
    section: &Section<'_>,
    typed: &typed::Deployment,
    rod: &Rod,
    curve: &Pattern,
) -> Option<Vec<Peg>> {
    let Some(pegs) = own_pegs(section, typed, rod, curve) else {
        clips(section, typed, rod, curve);
        return None;
    };
    let clips = clips(section, typed, rod, curve)?;
    Some(pegs.into_iter().chain(clips).collect())
}

fn own_pegs(
    section: &Section<'_>,
    typed: &typed::Deployment,
    rod: &Rod,
    curve: &Pattern,
) -> Option<Vec<Peg>> {
    let Some(typed) = typed.pegs.as_deref().filter(|pegs| !pegs.is_empty()) else {
        return Some(Vec::new());
    };
    if typed.len() > MOST_PEGS {
        let message = format!("{} are too many; allowed: at most {MOST_PEGS}", typed.len());
        section.fault("pegs", message);
        return None;
    }
    let points = curve.sampled(curve.length() / POINTS as f64);
    let pegs = section.elements("pegs", typed).map(|(section, typed)| {
        let position = typed.position.as_ref();
        let position = section.needed("position", position, "two lengths [x, y]");
        let position = position.map(|position| section.components("position", position));
        let size = size(&section, &typed.radius, &typed.height);
        let ([x, y], (radius, height)) = (position?, size?);
        if !(x.is_finite() && y.is_finite()) {
            return None;
        }
        let clear = radius + rod.radius;
        let distance = distance(&points, &Point::new(x, y));
        if distance < clear {
            section.fault(
                "position",
                format!(
                    "the pattern runs through this peg, {distance:.4} m from its axis; allowed: at least {clear:.4} m, the radii of peg and rod"
                ),
            );
            return None;
        }
        Some(Peg {
            position: [x, y],
            radius,
            height,
        })
    });
    // All faults are reported.
    let pegs: Vec<Option<Peg>> = pegs.collect();
    pegs.into_iter().collect()
}

fn clips(
    section: &Section<'_>,
    typed: &typed::Deployment,
    rod: &Rod,
    curve: &Pattern,
) -> Option<Vec<Peg>> {
    let Some(typed) = &typed.clips else {
        return Some(Vec::new());
    };
    let section = section.below("clips");
    let help = "arc lengths of the pattern, [\"2 cm\", \"8 cm\"]";
    let at = section.needed("at", typed.at.as_deref(), help);
    let size = size(&section, &typed.radius, &typed.height);
    let width = section.required("width", &typed.width, POSITIVE);
    let thick = 2.0 * rod.radius;
    if width < thick {
        let message = format!(
            "{width:?} m is too narrow; allowed: at least {thick:?} m, the thickness of the rod"
        );
        section.fault("width", message);
    }
    let ((radius, height), at) = (size?, at?);
    if 2 * at.len() > MOST_PEGS {
        let message = format!(
            "{} are too many; allowed: at most {}",
            at.len(),
            MOST_PEGS / 2
        );
        section.fault("at", message);
        return None;
    }
    let places = section.below("at");
    let length = curve.length() - curve.lead_in();
    let mut pegs = Vec::new();
    let mut is_known = width >= thick;
    for (index, typed) in at.iter().enumerate() {
        let key = index.to_string();
        let s = places.number(&key, typed, NON_NEGATIVE);
        if s > length {
            let allowed = format_args!("0 to {length:.4} m, the length of the pattern");
            places.out_of_range(&key, format_args!("{s:?} m"), allowed);
        }
        is_known &= s <= length;
        if is_known {
            let point = curve.at(curve.lead_in() + s);
            let (sine, cosine) = libm::sincos(point.angle);
            let left = Point::new(-sine, cosine) * (0.5 * width + radius);
            pegs.extend([left, -left].map(|side| Peg {
                position: (point.position + side).into(),
                radius,
                height,
            }));
        }
    }
    is_known.then_some(pegs)
}

/// Radius and height of a peg, m.
fn size(
    section: &Section<'_>,
    radius: &Option<Quantity<Length>>,
    height: &Option<Quantity<Length>>,
) -> Option<(f64, f64)> {
    let radius = section.required("radius", radius, POSITIVE);
    let height = section.required("height", height, POSITIVE);
    if height <= radius {
        let allowed = format_args!("more than the radius of its round top, {radius:?} m");
        section.out_of_range("height", format_args!("{height:?} m"), allowed);
    }
    (height > radius).then_some((radius, height))
}

/// Distance of a place from the pattern, m.
fn distance(points: &[PatternPoint], place: &Point) -> f64 {
    let distances = points.iter().map(|point| (point.position - place).norm());
    distances.fold(f64::INFINITY, f64::min)
}
