//! Lists and limits of the surfaces that touch.

use super::*;

fn line(nodes: usize, spacing: f64) -> Vec<Vector3> {
    (0..nodes)
        .map(|k| Vector3::new(k as f64 * spacing, 0.0, 0.0))
        .collect()
}

#[test]
fn edges_closer_along_the_rod_than_half_a_turn_are_neighbours() {
    let mut surface = ContactSurface::new();
    surface.add_rod(0, &line(11, 1.0), false, 1.0, false);
    assert!(!surface.may_touch(0, 0));
    assert!(!surface.may_touch(0, 1));
    assert!(!surface.may_touch(0, 4), "gap 3 < π");
    assert!(surface.may_touch(0, 5), "gap 4 > π");
    assert!(surface.may_touch(5, 0));
}

#[test]
fn rods_are_neighbours_through_their_joint() {
    let mut surface = ContactSurface::new();
    surface.add_rod(0, &line(21, 0.1), false, 0.05, false);
    let across: Vec<Vector3> = line(11, 0.1)
        .iter()
        .map(|x| Vector3::new(1.0, x.x - 0.5, 0.0))
        .collect();
    surface.add_rod(21, &across, false, 0.05, false);
    assert!(surface.may_touch(9, 24), "not yet joined");
    surface.add_joint([1, 0], [0.5, 1.0], 0.5 * PI);
    // The reach is π times the sum of the radii, 0.314.
    assert!(!surface.may_touch(9, 24), "both at the joint");
    assert!(!surface.may_touch(25, 12), "0.2 apart");
    assert!(surface.may_touch(8, 28), "0.1 + 0.3 apart");
    // At 20 degrees they overlap over the length 0.1/sin(10°); the reach is 1.5 times that.
    let mut surface = surface.clone();
    surface.add_joint([0, 1], [1.0, 0.5], 20f64.to_radians());
    assert!(!surface.may_touch(8, 28));
    assert!(surface.may_touch(4, 29), "0.5 + 0.4 apart");
}

#[test]
fn rods_pass_into_balls_at_their_nodes_and_touch_others() {
    let mut surface = ContactSurface::new();
    surface.add_rod(0, &line(21, 0.1), false, 0.05, false);
    surface.add_rod(21, &line(21, 0.1), false, 0.05, false);
    let ball = surface.add_ball(10, 0.2, false, &[(0, 1.0)]);
    let beside = surface.add_ball(31, 0.3, false, &[(1, 1.0), (ball, 0.0)]);
    let obstacle = RigidBody::sphere(Vector3::zeros(), 1.0);
    surface.add_obstacle(obstacle, None);
    assert_eq!(surface.rod_edges().len(), 42);
    assert!(surface.is_ball(40) && surface.is_ball(41));
    assert!(!surface.is_ball(39) && !surface.is_ball(42), "an obstacle");
    assert_eq!(surface.obstacle_of(42), Some(0));
    assert_eq!(surface.obstacle_of(40), None);
    assert_eq!([ball, beside], [2, 3]);
    // Within 1.5 (0.2 + 0.05) along the first rod; everywhere along the second.
    assert!(!surface.may_touch(9, 40) && !surface.may_touch(6, 40));
    assert!(surface.may_touch(5, 40) && surface.may_touch(13 + 1, 40));
    assert!(surface.may_touch(30, 40));
    assert!(!surface.may_touch(40, 41), "balls at one point");
    let node = surface.nodes()[10];
    assert_eq!((node.edge, node.radius), (40, 0.2));
    assert!((surface.threshold([5, 40]) - 0.25).abs() < 1e-15);
}

#[test]
fn a_closed_rod_is_measured_the_shorter_way_round() {
    let ring: Vec<Vector3> = (0..40)
        .map(|k| {
            let angle = 2.0 * PI * k as f64 / 40.0;
            Vector3::new(angle.cos(), angle.sin(), 0.0)
        })
        .collect();
    let mut surface = ContactSurface::new();
    surface.add_rod(7, &ring, true, 0.1, false);
    assert_eq!(surface.edges().len(), 40);
    assert_eq!(surface.edges()[39].nodes, [46, 7]);
    assert!(!surface.may_touch(0, 39), "they share a node");
    assert!(!surface.may_touch(0, 37), "gap 0.3138 < 0.1 π");
    assert!(surface.may_touch(0, 36), "gap 0.4708 > 0.1 π");
    assert!(surface.may_touch(0, 20));
}

#[test]
fn held_obstacles_touch_rods_but_not_each_other() {
    let mut surface = ContactSurface::new();
    surface.add_rod(0, &line(2, 1.0), false, 0.1, true);
    surface.add_rod(2, &line(2, 1.0), false, 0.1, true);
    surface.add_rod(4, &line(2, 1.0), false, 0.1, false);
    assert!(!surface.may_touch(0, 1));
    assert!(surface.may_touch(0, 2));
    assert!(surface.may_touch(2, 1));
}
