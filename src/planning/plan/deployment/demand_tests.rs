//! Friction demands at the contact node, between poses.

use super::{DeployedRod, Feasibility, GripperPose};
use crate::plan::pattern::{PatternPoint, Point};
use rodlab_engine::mechanics::{UnitQuaternion, Vector3};

/// A straight point at an arc length, m.
fn point(s: f64) -> PatternPoint {
    PatternPoint {
        s,
        position: Point::new(s, 0.0),
        angle: 0.0,
        curvature: 0.0,
        curvature_slope: 0.0,
        curvature_bend: 0.0,
    }
}

#[test]
fn between_poses_the_demand_is_between_theirs() {
    let poses = [(0.0, 0.2), (0.1, 0.6), (0.3, 0.1)].map(|(s, demand)| GripperPose {
        contact_demand: Some(demand),
        ..GripperPose::new(s, Vector3::zeros(), UnitQuaternion::identity())
    });
    let rod = DeployedRod::GREEN;
    for (s, demand) in [
        (0.0, 0.2),
        (0.025, 0.3),
        (0.1, 0.6),
        (0.14, 0.5),
        (0.3, 0.1),
    ] {
        let asked = Feasibility::of(&[point(s)], &rod, None, &poses);
        assert!(
            (asked.largest_demand - demand).abs() < 1e-12,
            "{s}: {asked:?}"
        );
        assert_eq!(asked.largest_lying_demand, 0.0);
    }
    // The largest is at the second pose, and two thirds of the points ask for more than 0.3.
    let points = [0.05, 0.1, 0.25].map(point);
    let asked = Feasibility::of(&points, &rod, Some(0.3), &poses);
    assert_eq!(asked.largest_demand_at_m, 0.1);
    assert!((asked.share_above_friction.unwrap() - 2.0 / 3.0).abs() < 1e-12);
}
