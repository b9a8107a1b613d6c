use super::*;
use crate::mechanics::contact::edge_contact::contact_force;
use crate::mechanics::contact::friction::{FrictionLaw, slip};
use crate::mechanics::contact::test_support::{Random, relative_error};

const KINDS: [i8; 6] = [RIM, RIM_START, RIM_END, RIM_JOINT, RIM_JOINT_END, RIM_NODE];

/// A rotated rim about the origin, and pieces of rods that pass it from the inside; edges are from
/// a tenth of its radius to the full radius long.
fn cases() -> Vec<(i8, [Vector3; 4], Rim)> {
    let mut random = Random::new(17);
    let mut cases = Vec::new();
    for index in 0..240 {
        let size = 10f64.powi(index as i32 % 4 - 3);
        let outwards = random.vector().normalize();
        let rim = Rim {
            centre: random.vector() * size,
            outwards,
            radius: size,
        };
        let side = KINDS[index % KINDS.len()];
        let across = outwards.cross(&random.vector()).normalize();
        let middle = rim.centre + across * (0.7 * size) + random.vector() * (0.15 * size);
        let length = size * (0.4 + 0.3 * random.symmetric());
        let along = (outwards + random.vector() * 0.5).normalize() * length;
        let mut nodes = [middle - along, middle, middle + along, rim.centre];
        for node in &mut nodes[..3] {
            *node += random.vector() * (0.2 * length);
        }
        cases.push((side, nodes, rim));
    }
    cases
}

fn nearest(side: i8, nodes: &[Vector3; 4], rim: &Rim) -> RimPoint {
    RimPoint::nearest(side, nodes, rim)
}

#[test]
fn no_point_of_a_piece_is_nearer() {
    let mut free = 0;
    for (side, nodes, rim) in cases() {
        let found = nearest(side, &nodes, &rim);
        let nodes = [nodes[0], nodes[1], nodes[2]];
        for sample in 0..=100 {
            let ratio = f64::from(sample) / 100.0;
            let other = RimPoint::at(side, &nodes, &rim, ratio, true);
            let slack = 1e-12 * rim.radius;
            assert!(
                found.distance() <= other.distance() + slack,
                "{side} {ratio}"
            );
        }
        free += usize::from(found.free);
    }
    assert!(free > 30, "{free}");
}

#[test]
fn force_and_jacobian_are_derivatives_of_the_energy() {
    let (force_of, slope) = (|gap: f64| (-3.0 * gap).exp(), -3.0);
    for (side, nodes, rim) in cases() {
        let point = nearest(side, &nodes, &rim);
        // Lengths in units of the rim, so that one law suits all sizes.
        let force = force_of(point.distance() / rim.radius);
        let response = NormalResponse {
            energy: -force / slope * rim.radius,
            force,
            force_slope: slope * force / rim.radius,
        };
        let found = rim_jacobian(&point, &response, None, true);
        let at = |nodes: &[Vector3; 4]| {
            let point = nearest(side, nodes, &rim);
            let force = force_of(point.distance() / rim.radius);
            let on_nodes = contact_force(
                &point.all_weights(),
                &point.normal(),
                force,
                &Vector3::zeros(),
            );
            (-force / slope * rim.radius, on_nodes)
        };
        let h = 1e-6 * rim.radius;
        let (mut gradient, mut jacobian) = (Vec::new(), vec![0.0; 81]);
        for column in 0..9 {
            let moved = |by: f64| {
                let mut nodes = nodes;
                nodes[column / 3][column % 3] += by;
                at(&nodes)
            };
            let ((less, before), (more, after)) = (moved(-h), moved(h));
            gradient.push((less - more) / (2.0 * h));
            for row in 0..9 {
                jacobian[9 * row + column] = (after[row] - before[row]) / (2.0 * h);
            }
        }
        let error = relative_error(&at(&nodes).1[..9], &gradient);
        assert!(error < 1e-7, "{side}: {error:e}");
        let rows: Vec<f64> = (0..81).map(|k| found.jacobian[k / 9][k % 9]).collect();
        let error = relative_error(&rows, &jacobian);
        assert!(error < 1e-5, "{side}: {error:e}");
        for k in 0..81 {
            let (entry, other) = (rows[k], rows[9 * (k % 9) + k / 9]);
            assert!((entry - other).abs() < 1e-9 * force / rim.radius * 1e3);
        }
    }
}

#[test]
fn friction_and_its_jacobian() {
    const TIME_STEP: f64 = 1e-3;
    let mut random = Random::new(29);
    for (side, nodes, rim) in cases() {
        let law = FrictionLaw {
            coefficient: 0.3,
            slip_tolerance: rim.radius,
            grain: None,
        };
        let speed = rim.radius * 10f64.powf(random.symmetric());
        let previous = nodes.map(|node| node - random.vector() * speed * TIME_STEP);
        let sliding_at = |nodes: &[Vector3; 4]| Sliding {
            law,
            velocities: std::array::from_fn(|k| match k {
                3 => Vector3::zeros(),
                _ => (nodes[k] - previous[k]) / TIME_STEP,
            }),
            swing: Vector3::zeros(),
            time_step: TIME_STEP,
        };
        let slip_at = |point: &RimPoint, sliding: &Sliding| {
            let velocity = sliding.relative_velocity(&point.all_weights());
            slip(&point.normal(), &velocity)
        };
        let at = |nodes: &[Vector3; 4]| {
            let (point, sliding) = (nearest(side, nodes, &rim), sliding_at(nodes));
            let traction = law.traction_of_slip(&slip_at(&point, &sliding));
            contact_force(&point.all_weights(), &point.normal(), 1.0, &traction)
        };
        let response = NormalResponse {
            energy: 1.0,
            force: 1.0,
            force_slope: 0.0,
        };
        let (point, sliding) = (nearest(side, &nodes, &rim), sliding_at(&nodes));
        let slip = slip_at(&point, &sliding);
        let found = rim_jacobian(&point, &response, Some((&sliding, slip)), true);
        let h = 1e-7 * rim.radius;
        let mut jacobian = vec![0.0; 81];
        for column in 0..9 {
            let moved = |by: f64| {
                let mut nodes = nodes;
                nodes[column / 3][column % 3] += by;
                at(&nodes)
            };
            let (before, after) = (moved(-h), moved(h));
            for row in 0..9 {
                jacobian[9 * row + column] = (after[row] - before[row]) / (2.0 * h);
            }
        }
        let rows: Vec<f64> = (0..81).map(|k| found.jacobian[k / 9][k % 9]).collect();
        let error = relative_error(&rows, &jacobian);
        assert!(error < 1e-5, "{side}: {error:e}");
    }
}

#[test]
fn pieces_follow_each_other_without_kinks() {
    let nodes = [0.0, 1.0, 2.5, 2.9].map(|x: f64| Vector3::new(x, x.sin(), 0.2 * x * x));
    let centreline = nodes.to_vec();
    for closed in [false, true] {
        let mut surface = ContactSurface::new();
        surface.add_rod(0, &centreline, closed, 0.1, false);
        let pieces = pieces_of(&surface);
        let (curves, joints): (Vec<_>, Vec<_>) = pieces
            .iter()
            .partition(|piece| matches!(piece.side, RIM | RIM_START | RIM_END));
        assert_eq!(
            (curves.len(), joints.len()),
            if closed { (4, 4) } else { (4, 3) }
        );
        let of = |piece: &RodPiece, ratio: f64| {
            let corners = piece.nodes.map(|node| nodes[node]);
            let [weights, rates, _] = weights(piece.side, ratio);
            (weighted(&corners, &weights), weighted(&corners, &rates))
        };
        let count = curves.len();
        for k in 0..if closed { count } else { count - 1 } {
            let (end, start) = (of(curves[k], 1.0), of(curves[(k + 1) % count], 0.0));
            assert!((end.0 - start.0).norm() < 1e-14, "{k}");
            let (before, after) = (end.1.normalize(), start.1.normalize());
            assert!((before - after).norm() < 1e-14, "{k}");
            let is_joint = |joint: &&&RodPiece| (of(joint, 0.0).0 - end.0).norm() < 1e-14;
            assert_eq!(joints.iter().filter(is_joint).count(), 1);
        }
    }
}

#[test]
fn the_rim_is_felt_from_within_the_tube_and_from_in_front_of_it() {
    let rim = Rim {
        centre: Vector3::zeros(),
        outwards: Vector3::z(),
        radius: 1.0,
    };
    let at = |radial: f64, axial: f64| {
        let point = Vector3::new(1.0 + radial, 0.0, axial);
        let nodes = [point, point, point, Vector3::zeros()];
        [RIM, RIM_NODE].map(|side| RimPoint::of(side, &nodes, &rim).is_some())
    };
    assert_eq!(at(-0.1, -0.05), [true, true]);
    assert_eq!(at(-0.1, 0.05), [true, false], "beyond the mouth");
    assert_eq!(at(0.05, 0.1), [true, false], "hanging over the rim");
    assert_eq!(at(0.1, 0.05), [false, false], "passing outside");
    assert_eq!(at(0.1, -0.05), [false, false], "along the tube");
    assert_eq!(at(-1.0, 0.1), [true, false], "on the axis");
}

#[test]
fn no_passage_through_a_rim_is_missed() {
    let mut random = Random::new(5);
    let (mut passed, mut free) = (0, 0);
    for (side, start, rim) in cases() {
        let shift = random.vector() * rim.radius;
        let end = [
            start[0] + shift,
            start[1] + shift,
            start[2] + shift,
            start[3],
        ];
        let kept = 0.05 * rim.radius;
        if nearest(side, &start, &rim).distance() < 2.0 * kept {
            continue;
        }
        let bounds = [kept, 0.1 * kept];
        let paths = [&start, &end];
        let fraction = fraction_beyond_rim(side, paths, [&rim, &rim], bounds, 1.0);
        let least = (0..=400)
            .map(|sample| {
                let t = fraction * f64::from(sample) / 400.0;
                let nodes = std::array::from_fn(|k| start[k] + (end[k] - start[k]) * t);
                nearest(side, &nodes, &rim).distance()
            })
            .fold(f64::INFINITY, f64::min);
        assert!(least > kept, "{side}: {least:e}");
        if fraction < 1.0 {
            passed += 1;
        } else {
            free += 1;
        }
    }
    assert!(passed > 5 && free > 50, "{passed} {free}");
}
