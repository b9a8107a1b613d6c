//! The surplus of a rod that is longer than its pattern. The surplus is laid after and before the
//! pattern, so that it does not fall.

use super::{DeployedRod, lead_length};
use crate::plan::pattern::{Pattern, PatternPoint, Point};

/// Suspended length, in gravito-bending lengths, at which the gripper releases the rod; the
/// gripper is then 0.73 L_gb above the table. A longer rest pulls at the lying part when it falls.
/// With a shorter rest the fingers would reach the table.
pub const SUSPENDED: f64 = 2.5;
/// Largest rest, in gravito-bending lengths, that falls straight when the gripper releases it; a
/// longer one may fall onto itself.
const FALLS_STRAIGHT: f64 = SUSPENDED + LEAST;
/// Smallest length, in gravito-bending lengths, of a lead-out or a straight start.
const LEAST: f64 = 1.0;
/// Distance of checked points, and smallest distance between parts of the rod, in radii. At
/// smaller distances pictures would show no gap.
const SPACING: f64 = 2.0;
const CLEARANCE: f64 = 6.0;

/// Maximum number of checked points of the rod.
const MOST_POINTS: f64 = 1000.0;

/// Whether the rest of a rod after a path of this length, m, falls straight when the gripper
/// releases it.
pub fn falls_straight(rod: &DeployedRod, laid: f64) -> bool {
    rod.length - laid <= FALLS_STRAIGHT * rod.gravito_bending_length
}

/// Treatment of a rod that is longer than its pattern.
#[derive(Clone, Copy)]
pub struct Spare<'a> {
    /// Fraction of the surplus, from 0 to 1, that is laid if there is space.
    pub part: f64,
    /// Whether a position in the frame of the pattern, m, is free.
    pub is_free: &'a dyn Fn(Point) -> bool,
}

impl Spare<'_> {
    /// The whole surplus hangs from the gripper until the end.
    pub const HANGS: Spare<'static> = Spare {
        part: 0.0,
        is_free: &|_| true,
    };
}

/// Lays a part of the surplus: after the end of the pattern as far as there is space, and the rest
/// before its lead-in. There is space at positions that `spare` allows and that no other part of
/// the rod occupies.
pub fn with_spare_laid(pattern: Pattern, rod: &DeployedRod, spare: &Spare<'_>) -> Pattern {
    let unit = rod.gravito_bending_length;
    let (whole, bent) = (pattern.length(), pattern.lead_in());
    let left = spare.part * (rod.length - SUSPENDED * unit - whole);
    if left < LEAST * unit {
        return pattern;
    }
    let spacing = (SPACING * rod.radius).max(rod.length / MOST_POINTS);
    let room = Room {
        clearance: CLEARANCE * rod.radius,
        is_free: spare.is_free,
    };
    let back = lead_length(rod, &pattern.at(whole).turned_round());
    let pattern = pattern.with_lead_out(back, left);
    let points = pattern.sampled(spacing);
    let laid = points.partition_point(|point| point.s <= whole);
    let behind = room.along(&points[..laid], &points[laid..], whole);
    let behind = if behind < LEAST * unit { 0.0 } else { behind };
    let rest = left - behind;
    let pattern = pattern
        .with_straight_lead_in(rest, bent)
        .with_lead_out(back, behind);
    let mut points = pattern.sampled(spacing);
    points.reverse();
    let laid = points.partition_point(|point| point.s >= rest);
    let front = room.along(&points[..laid], &points[laid..], rest);
    let front = if front < LEAST * unit { 0.0 } else { front };
    pattern
        .with_straight_lead_in(front, bent)
        .with_lead_out(back, behind)
}

/// Free space for a rod.
struct Room<'a> {
    clearance: f64,
    is_free: &'a dyn Fn(Point) -> bool,
}

impl Room<'_> {
    /// Length by which a rod with the laid points `laid` can be extended along `next`, which
    /// begins at the arc length `from`, m.
    fn along(&self, laid: &[PatternPoint], next: &[PatternPoint], from: f64) -> f64 {
        // Points that are near along the rod are excluded.
        let apart = std::f64::consts::PI * self.clearance;
        let mut far = 0.0;
        for (index, point) in next.iter().enumerate() {
            let mut before = laid.iter().chain(&next[..index]);
            let is_close = before.any(|other| {
                (other.s - point.s).abs() > apart
                    && (other.position - point.position).norm() < self.clearance
            });
            if is_close || !(self.is_free)(point.position) {
                break;
            }
            far = (point.s - from).abs();
        }
        far
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::pattern::{Circle, Line};

    const GREEN: DeployedRod = DeployedRod::GREEN;

    fn line() -> Pattern {
        Pattern::new(Box::new(Line { length: 0.5 }), 0.0).unwrap()
    }

    /// Lays as much of a rod as there is space for.
    fn laid(pattern: Pattern, rod: &DeployedRod, is_free: &dyn Fn(Point) -> bool) -> Pattern {
        with_spare_laid(pattern, rod, &Spare { part: 1.0, is_free })
    }

    #[test]
    fn all_but_the_end_in_the_gripper_is_laid_behind_the_pattern() {
        let laid = laid(line(), &GREEN, &|_| true);
        assert_eq!(laid.lead_in(), 0.0);
        assert!((laid.length() - (0.885 - 2.5 * 0.032)).abs() < 1e-12);
    }

    #[test]
    fn the_surplus_without_space_behind_is_laid_in_front() {
        // The edge of the table is 10 cm beyond the end.
        let wide = laid(line(), &GREEN, &|place| place.x < 0.6);
        assert!(
            (0.096..0.1).contains(&wide.lead_out()),
            "{}",
            wide.lead_out()
        );
        assert!((wide.length() - (0.885 - 2.5 * 0.032)).abs() < 1e-12);
        // The table ends 1 cm beyond the end and 10 cm before the start.
        let narrow = laid(line(), &GREEN, &|place| (-0.1..0.51).contains(&place.x));
        assert_eq!(narrow.lead_out(), 0.0);
        assert!((0.096..0.1).contains(&narrow.lead_in()));
    }

    #[test]
    fn the_surplus_is_not_laid_on_the_lying_rod() {
        let circle = Pattern::new(Box::new(Circle { radius: 0.06 }), 0.0).unwrap();
        let lead_in = lead_length(&GREEN, &circle.at(0.0));
        let circle = circle.with_lead_in(lead_in);
        let laid = laid(circle, &GREEN, &|_| true);
        assert_eq!(laid.lead_out(), 0.0);
        assert!((laid.length() - (0.885 - 2.5 * 0.032)).abs() < 1e-12);
    }

    #[test]
    fn a_rod_that_is_not_longer_is_laid_as_it_was() {
        let short = DeployedRod {
            length: 0.6,
            ..GREEN
        };
        let laid = laid(line(), &short, &|_| true);
        assert_eq!((laid.length(), laid.lead_in()), (0.5, 0.0));
    }
    /// The lead-out runs towards the first side, and ends at the clearance from it.
    #[test]
    fn a_lead_out_keeps_its_clearance_from_the_lying_rod() {
        let corners = [
            [0.0, 0.0],
            [0.16, 0.0],
            [0.16, 0.14],
            [0.06, 0.14],
            [0.06, 0.1],
        ];
        let points: Vec<Point> = corners.iter().map(|corner| Point::from(*corner)).collect();
        let hook = Pattern::along(&points, 2e-3).unwrap();
        let laid = laid(hook, &GREEN, &|_| true);
        assert!(
            (0.05..0.1).contains(&laid.lead_out()),
            "{}",
            laid.lead_out()
        );
        let end = laid.at(laid.length()).position;
        let points = laid.sampled(1e-4);
        let side = points.iter().filter(|point| point.s < laid.lead_in() + 0.1);
        let away = side.map(|point| (point.position - end).norm());
        let away = away.fold(f64::INFINITY, f64::min) / GREEN.radius;
        // Points are checked every two radii.
        assert!((5.9..8.1).contains(&away), "{away}");
    }
}
