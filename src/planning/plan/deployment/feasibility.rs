//! Requirements of a pattern on the rod and the table.

use super::lying::least_lying_demand;
use super::{DeployedRod, DeploymentError, GripperPose, Lead};
use crate::plan::grasp::GraspProblem;
use crate::plan::pattern::{LeadBend, Pattern, PatternPoint};
use serde::Serialize;

/// Largest friction demand of a lead-in.
const LEAD_IN_DEMAND: f64 = 0.1;
/// Largest |d²κ/dx²| of a lead-in over x = s/ℓ, for a pattern that continues with constant
/// curvature 1.
const LEAD_IN_BEND: f64 = 5.7735;
/// Smallest radius of curvature of a lead, in radii of the rod.
const LEAD_RADII: f64 = 3.0;
/// Largest rotation of a lead whose curvature overshoots that of the pattern, rad.
const MOST_TURN: f64 = std::f64::consts::PI;
/// Ratio of successive trial lengths of a lead.
const SHORTER: f64 = 0.9;
/// Relative difference of two curvatures that count as equal.
const ROUNDING: f64 = 1e-6;
/// Curvature times L_gb below which a pattern starts straight.
const STRAIGHT: f64 = 0.02;

/// The coefficient of friction that holds a lying rod in its curve: k_b|κ''|/(ρ A g) = 2 L_gb³|κ''| (thesis Eq. 5.2).
pub fn lying_demand(rod: &DeployedRod, point: &PatternPoint) -> f64 {
    2.0 * rod.gravito_bending_length.powi(3) * point.curvature_bend.abs()
}

/// Coefficient of friction that holds a rod at each point of a pattern: in its curve where it
/// lies, and at its contact node when the gripper has the pose for that point.
///
/// Thesis Eq. 5.2 includes only the lying rod. On a curved pattern the suspended part also pushes
/// the contact node sideways, which can need several times as much friction; for a circle this is
/// the whole demand.
pub fn friction_demands(
    rod: &DeployedRod,
    points: &[PatternPoint],
    poses: &[GripperPose],
) -> Vec<f64> {
    let pairs = points.iter().zip(poses);
    let demand = |(point, pose): (&PatternPoint, &GripperPose)| {
        lying_demand(rod, point).max(pose.contact_demand.unwrap_or(0.0))
    };
    pairs.map(demand).collect()
}

/// Demand at the contact node at an arc length, interpolated between the poses on either side.
fn contact_demand_at(poses: &[GripperPose], s: f64) -> f64 {
    let next = poses.partition_point(|pose| pose.s < s);
    let of = |index: usize| poses.get(index).and_then(|pose| pose.contact_demand);
    match (of(next), next.checked_sub(1).and_then(of)) {
        (Some(after), Some(before)) => {
            let [from, to] = [poses[next - 1].s, poses[next].s];
            before + (s - from) / (to - from) * (after - before)
        }
        (one, other) => one.or(other).unwrap_or(0.0),
    }
}

/// Length of the lead-in for a pattern that starts at this point, m: zero if it is nearly straight
/// there. For a lead-out, use the reversed last point.
///
/// The lead-in is shorter than the friction demand alone requires if the lead would bend to less
/// than three radii of the rod, or coil: a rapidly changing curvature at the start of the pattern
/// makes a long lead oscillate.
pub fn lead_length(rod: &DeployedRod, end: &PatternPoint) -> f64 {
    let unit = rod.gravito_bending_length;
    let bent = end.curvature.abs() * unit;
    if bent < STRAIGHT {
        return 0.0;
    }
    let mut length = unit * (2.0 * LEAD_IN_BEND * bent / LEAD_IN_DEMAND).sqrt();
    let own = end.curvature.abs() * (1.0 + ROUNDING);
    let most = sharpest_of_lead(rod).max(own);
    loop {
        let bend = LeadBend::of(end, length);
        let coils = bend.sharpest > own && bend.turn > MOST_TURN;
        if bend.sharpest <= most && !coils {
            return length;
        }
        length *= SHORTER;
    }
}

/// Largest curvature of a lead, 1/m.
fn sharpest_of_lead(rod: &DeployedRod) -> f64 {
    1.0 / (LEAD_RADII * rod.radius)
}

/// Checks that there are grasps of a rod whose whole length is suspended, as at the start of a
/// pattern.
///
/// # Errors
/// [`DeploymentError::RodLength`].
pub fn can_be_held(rod: &DeployedRod) -> Result<(), DeploymentError> {
    let unit = rod.gravito_bending_length;
    let [least_m, most_m] = GraspProblem::LENGTHS.map(|length| length * unit);
    match (least_m..=most_m).contains(&rod.length) {
        true => Ok(()),
        false => Err(DeploymentError::RodLength {
            rod_m: rod.length,
            unit_m: unit,
            least_m,
            most_m,
        }),
    }
}

/// Checks that the gripper still holds the rod at the end of the pattern.
///
/// # Errors
/// [`DeploymentError::TooLong`].
pub fn long_enough(rod: &DeployedRod, pattern: &Pattern) -> Result<(), DeploymentError> {
    let (length, lead_in) = (pattern.length(), pattern.lead_in());
    let least = length + GraspProblem::LENGTHS[0] * rod.gravito_bending_length;
    if rod.length >= least {
        return Ok(());
    }
    Err(DeploymentError::TooLong {
        pattern_m: length,
        lead_in: if lead_in > 0.0 {
            let remedy = match rod.length >= least - lead_in {
                true => "`lead_in`; shorten it, or leave it out by --lead-in none",
                false => "`lead_in`",
            };
            format!(" with a lead-in of {lead_in:.4} m ({remedy})")
        } else {
            String::new()
        },
        rod_m: rod.length,
        least_m: least,
    })
}

/// Largest demands of a pattern.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Feasibility {
    /// Least radius of curvature, m; infinite for a straight line.
    pub least_radius_m: f64,
    /// Position of the least radius, m from the start.
    pub least_radius_at_m: f64,
    /// Largest friction demand, of the lying rod or at the contact node.
    #[serde(rename = "largest_friction_demand")]
    pub largest_demand: f64,
    /// Position of the largest friction demand, m from the start.
    #[serde(rename = "largest_friction_demand_at_m")]
    pub largest_demand_at_m: f64,
    /// Largest friction demand of the lying rod alone (thesis Eq. 5.2).
    #[serde(rename = "largest_lying_friction_demand")]
    pub largest_lying_demand: f64,
    /// Least friction that can hold the lying rod, by the tension that suits it best.
    #[serde(rename = "least_lying_friction_demand")]
    pub least_lying_demand: f64,
    /// Friction of the table, if known.
    pub friction: Option<f64>,
    /// Fraction of the length whose demand exceeds the friction of the table, if that is given.
    pub share_above_friction: Option<f64>,
}

/// Minimum and maximum number of points at which a pattern is checked.
const CHECKED_POINTS: [f64; 2] = [8000.0, 400_000.0];

/// Points at which a pattern is checked. They are closer than the `spacing` (m) of the poses,
/// because corners may be between poses.
///
/// # Errors
/// The pattern is too sharp for the rod.
pub fn checked_points(
    pattern: &Pattern,
    spacing: f64,
    rod: &DeployedRod,
) -> Result<Vec<PatternPoint>, DeploymentError> {
    let [least, most] = CHECKED_POINTS.map(|count| pattern.length() / count);
    let close = spacing.min(0.25 * rod.radius).min(least).max(most);
    let points = pattern.sampled(close);
    leads_bend_little(pattern, &points, rod)?;
    let (sharpest, s_m) = worst(&points, &|point| point.curvature.abs());
    let radius_m = 1.0 / sharpest;
    if radius_m < rod.radius {
        return Err(DeploymentError::TooSharp {
            radius_m,
            s_m,
            rod_m: rod.radius,
        });
    }
    Ok(points)
}

/// Leads must not bend below three radii of the rod, unless the pattern itself does so at its start
/// or end.
fn leads_bend_little(
    pattern: &Pattern,
    points: &[PatternPoint],
    rod: &DeployedRod,
) -> Result<(), DeploymentError> {
    let [begin, end] = [pattern.lead_in(), pattern.length() - pattern.lead_out()];
    let leads = [
        (
            Lead::In,
            &points[..points.partition_point(|point| point.s < begin)],
            begin,
        ),
        (
            Lead::Out,
            &points[points.partition_point(|point| point.s <= end)..],
            end,
        ),
    ];
    for (lead, points, joint) in leads {
        let (sharpest, s_m) = worst(points, &|point| point.curvature.abs());
        let own = pattern.at(joint).curvature.abs() * (1.0 + ROUNDING);
        if sharpest > sharpest_of_lead(rod).max(own) {
            return Err(DeploymentError::SharpLead {
                lead,
                radius_m: 1.0 / sharpest,
                s_m,
                least_m: 1.0 / sharpest_of_lead(rod),
            });
        }
    }
    Ok(())
}

/// The largest value over a pattern, and its position, m from the start.
fn worst(points: &[PatternPoint], value: &dyn Fn(&PatternPoint) -> f64) -> (f64, f64) {
    let values = points.iter().map(|point| (value(point), point.s));
    values.fold(
        (0.0, 0.0),
        |most, here| if here.0 > most.0 { here } else { most },
    )
}

impl Feasibility {
    /// The demands of a pattern at the points of [`checked_points`], including those at the
    /// contact node of the poses. Sliding is not an error; `friction` is that of the table.
    pub fn of(
        points: &[PatternPoint],
        rod: &DeployedRod,
        friction: Option<f64>,
        poses: &[GripperPose],
    ) -> Self {
        let lying = |point: &PatternPoint| lying_demand(rod, point);
        let demand = |point: &PatternPoint| lying(point).max(contact_demand_at(poses, point.s));
        let (sharpest, least_radius_at_m) = worst(points, &|point| point.curvature.abs());
        let (largest_demand, largest_demand_at_m) = worst(points, &demand);
        Self {
            least_radius_m: 1.0 / sharpest,
            least_radius_at_m,
            largest_demand,
            largest_demand_at_m,
            largest_lying_demand: worst(points, &lying).0,
            least_lying_demand: least_lying_demand(rod, points),
            friction,
            share_above_friction: friction.map(|friction| {
                let above = points.iter().filter(|point| demand(point) > friction);
                above.count() as f64 / points.len().max(1) as f64
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{OptimalGrasps, Scheme, trajectory};
    use super::*;
    use crate::plan::grasp::{GraspMethod, GraspSolver};
    use crate::plan::pattern::{Circle, Line, Point};

    const GREEN: DeployedRod = DeployedRod::GREEN;

    fn asked(pattern: &Pattern, scheme: Scheme, friction: f64) -> Feasibility {
        let poses =
            trajectory(&pattern.sampled(3e-3), &GREEN, scheme, OptimalGrasps::Exact).unwrap();
        let points = checked_points(pattern, 3e-3, &GREEN).unwrap();
        Feasibility::of(&points, &GREEN, Some(friction), &poses)
    }

    #[test]
    fn a_circle_asks_for_friction_at_its_contact_node() {
        // By Eq. 5.2 there is no demand along a circle after its lead-in, but a simulated rod
        // slides at a friction of 0.12.
        let circle = Pattern::new(Box::new(Circle { radius: 0.08 }), 0.0).unwrap();
        let lead_in = lead_length(&GREEN, &circle.at(0.0));
        let circle = || {
            let circle = Pattern::new(Box::new(Circle { radius: 0.08 }), 0.0).unwrap();
            circle.with_lead_in(lead_in)
        };
        let asked = asked(&circle(), Scheme::Optimal, 0.12);
        assert!((asked.largest_lying_demand - 0.1).abs() < 1e-3, "{asked:?}");
        // For a long rod x_M n_y = κ̄ = 0.4; n_z is that of the grasp.
        let problem = GraspProblem::new(15.0, 0.4, GREEN.stretch_stiffness()).unwrap();
        let grasp = GraspSolver::new()
            .solve(&problem, GraspMethod::Theory)
            .unwrap();
        let expected = 0.4 / grasp.position.x / grasp.contact_force.z;
        let point = circle().at(GREEN.length - 15.0 * GREEN.gravito_bending_length);
        let pose = trajectory(&[point], &GREEN, Scheme::Optimal, OptimalGrasps::Exact);
        let demand = pose.unwrap()[0].contact_demand.unwrap();
        assert!(
            (demand / expected - 1.0).abs() < 1e-3,
            "{demand} {expected}"
        );
        assert!((demand - 0.228).abs() < 1e-3, "{demand}");
        // Where the curvature of the lead-in increases, its shear force adds to this demand.
        assert!(asked.largest_demand > demand && asked.largest_demand < 1.5 * demand);
        assert!(asked.share_above_friction.unwrap() > 0.5);
    }

    /// A hook that is 12 mm wide: its curvature changes rapidly at its start and end.
    fn hook() -> Pattern {
        let corners = [[2e-3, 2e-3], [12e-3, 2e-3], [0.0, 10e-3], [10e-3, 10e-3]].map(Point::from);
        let points = (0..=100).map(|k| {
            let t = f64::from(k) / 100.0;
            let u = 1.0 - t;
            let weights = [u * u * u, 3.0 * u * u * t, 3.0 * u * t * t, t * t * t];
            corners
                .iter()
                .zip(weights)
                .map(|(corner, weight)| weight * corner)
                .sum()
        });
        Pattern::along(&points.collect::<Vec<Point>>(), 2.5e-4).unwrap()
    }

    #[test]
    fn leads_bend_no_tighter_than_three_radii_of_the_rod() {
        let rod = DeployedRod {
            gravito_bending_length: 0.018,
            radius: 1.6e-3,
            length: 0.875,
        };
        let first = hook().at(0.0);
        let friction = 0.018 * (2.0 * LEAD_IN_BEND * first.curvature.abs() * 0.18).sqrt();
        let length = lead_length(&rod, &first);
        assert!(
            length > 5e-3 && length < 0.5 * friction,
            "{length} {friction}"
        );
        let last = hook().at(hook().length());
        let back = lead_length(&rod, &last.turned_round());
        let pattern = || hook().with_lead_in(length).with_lead_out(back, 2.0 * back);
        checked_points(&pattern(), 3e-3, &rod).unwrap();
        let leads = pattern().sampled(1e-4).into_iter();
        let leads =
            leads.filter(|point| point.s < length || point.s > pattern().length() - 2.0 * back);
        for point in leads {
            assert!(
                point.curvature.abs() * 3.0 * rod.radius < 1.001,
                "{point:?}"
            );
        }
        for (long, lead) in [
            (hook().with_lead_in(0.15), "lead-in"),
            (hook().with_lead_out(0.15, 0.15), "lead-out"),
        ] {
            let words = checked_points(&long, 3e-3, &rod).unwrap_err().to_string();
            assert!(words.contains(&format!("the {lead} bends")), "{words}");
            assert!(words.contains("0.0048 m"), "{words}");
        }
    }

    #[test]
    fn a_lead_in_that_makes_a_pattern_too_long_is_named_with_its_remedy() {
        let circle = |lead_in: f64| {
            let circle = Pattern::new(Box::new(Circle { radius: 0.12 }), 0.0).unwrap();
            circle.with_lead_in(lead_in)
        };
        let words = |lead_in: f64| {
            let refused = long_enough(&GREEN, &circle(lead_in)).unwrap_err();
            refused.to_string()
        };
        assert!(words(0.2).contains("--lead-in none"), "{}", words(0.2));
        let short = DeployedRod {
            length: 0.7,
            ..GREEN
        };
        let refused = long_enough(&short, &circle(0.2)).unwrap_err().to_string();
        assert!(
            refused.contains("lead-in of 0.2000 m") && !refused.contains("none"),
            "{refused}"
        );
    }

    #[test]
    fn a_line_asks_for_no_friction_and_no_grasp_no_contact_demand() {
        let line = Pattern::new(Box::new(Line { length: 0.5 }), 0.0).unwrap();
        let of_line = asked(&line, Scheme::Optimal, 0.12);
        assert!(of_line.largest_demand < 1e-9);
        let circle = Pattern::new(Box::new(Circle { radius: 0.08 }), 0.0).unwrap();
        let upright = asked(&circle, Scheme::Intuitive, 0.12);
        assert_eq!(upright.largest_demand, upright.largest_lying_demand);
    }
}
