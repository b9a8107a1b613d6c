//! Heights over curved patches: exact surfaces, derivatives, sides, orders, friction, the search.

use super::super::foot::Points;
use super::super::friction::FrictionLaw;
use super::super::placed_obstacles::PlacedObstacles;
use super::super::surface::ContactSurface;
use super::super::test_support::{Random, relative_error};
use super::*;
use crate::mechanics::rigid_body::RigidBody;

/// A patch with random corners and normals near z.
fn patch(random: &mut Random) -> Patch {
    let flat = [[0.0, 0.0], [1.0, 0.1], [0.2, 0.9]];
    Patch {
        corners: flat.map(|[x, y]| Vector3::new(x, y, 0.0) + random.vector() * 0.1),
        normals: [(); 3].map(|()| (Vector3::z() + random.vector() * 0.3).normalize()),
    }
}

/// A point over the inside of a patch.
fn over(patch: &Patch, random: &mut Random) -> Vector3 {
    let [b, c] = [0.3, 0.3].map(|middle| middle + 0.2 * random.symmetric());
    patch.at([b, c], 0.4 * random.symmetric()).0
}

fn foot(patch: &Patch, point: &Vector3, side: f64) -> PatchPoint {
    patch.foot(0, &patch.coordinates(point).unwrap(), side)
}

fn bend(patch: &Patch, point: &Vector3, side: f64) -> PatchBend {
    patch.bend(&patch.coordinates(point).unwrap(), side)
}

#[test]
fn coordinates_place_a_point() {
    let mut random = Random::new(3);
    for _ in 0..200 {
        let patch = patch(&mut random);
        let point = over(&patch, &mut random);
        let at = patch.coordinates(&point).unwrap();
        let [_, b, c] = at.weights;
        let (found, _) = patch.at([b, c], at.height);
        assert!((found - point).norm() < 1e-14);
    }
}

#[test]
fn spheres_and_cylinders_are_exact() {
    const SIZE: f64 = 1.7;
    let mut random = Random::new(5);
    for flat in [false, true] {
        let across = |x: Vector3| if flat { Vector3::new(x.x, x.y, 0.0) } else { x };
        let normals: [Vector3; 3] = [[1.0, 0.3, 0.1], [0.8, -0.3, 0.4], [0.9, 0.1, -0.5]]
            .map(|x| across(Vector3::from(x)).normalize());
        let along = if flat { [0.3, 0.9, -1.1] } else { [0.0; 3] };
        let corners = [0, 1, 2].map(|k| normals[k] * SIZE + Vector3::z() * along[k]);
        for _ in 0..40 {
            let patch = Patch { corners, normals };
            let point = over(&patch, &mut random);
            for side in [1.0, -1.0] {
                let found = foot(&patch, &point, side);
                let radial = across(point);
                let distance = (radial.norm() - SIZE) * side;
                assert!((found.distance - distance).abs() < 1e-14);
                let normal = radial.normalize() * side;
                assert!((found.normal - normal).norm() < 1e-13);
                let mut turning = Matrix3::identity() - normal * normal.transpose();
                if flat {
                    turning -= Vector3::z() * Vector3::z().transpose();
                }
                turning *= side / radial.norm();
                assert!((bend(&patch, &point, side).turning - turning).norm() < 1e-12);
                let [a, b, c] = [0, 1, 2].map(|k| {
                    (corners[k] + normals[k] * found.surface_height) * found.at.weights[k]
                });
                assert!((across(a + b + c).norm() - SIZE).abs() < 1e-14);
            }
        }
    }
}

#[test]
fn gradients_and_curvatures_are_derivatives() {
    let mut random = Random::new(7);
    let step = 1e-5;
    for _ in 0..60 {
        let patch = patch(&mut random);
        let point = over(&patch, &mut random);
        let (found, bent) = (foot(&patch, &point, -1.0), bend(&patch, &point, -1.0));
        let ends = [0, 1, 2].map(|axis| {
            [1.0, -1.0].map(|sign| {
                let mut moved = point;
                moved[axis] += sign * step;
                foot(&patch, &moved, -1.0)
            })
        });
        let rate = |axis: usize, of: &dyn Fn(&PatchPoint) -> f64| {
            (of(&ends[axis][0]) - of(&ends[axis][1])) / (2.0 * step)
        };
        for axis in 0..3 {
            let slope = rate(axis, &|foot| foot.distance);
            assert!((found.normal[axis] - slope).abs() < 1e-8);
            for row in 0..3 {
                let turned = rate(axis, &|foot| foot.normal[row]);
                assert!((bent.turning[(row, axis)] - turned).abs() < 1e-7);
                let weight = rate(axis, &|foot| foot.at.weights[row]);
                assert!((bent.weight_gradients[row][axis] - weight).abs() < 1e-8);
            }
        }
        assert!((bent.turning - bent.turning.transpose()).norm() < 1e-12);
    }
}

#[test]
fn heights_and_gradients_agree_along_a_common_side() {
    let mut random = Random::new(9);
    for _ in 0..100 {
        let one = patch(&mut random);
        let mut other = one;
        // The side of the first two corners, seen from the other side.
        other.corners = [one.corners[1], one.corners[0], Vector3::new(0.6, -0.8, 0.1)];
        other.normals = [one.normals[1], one.normals[0], Vector3::z()];
        let (point, _) = one.at(
            [0.5 + 0.4 * random.symmetric(), 0.0],
            0.3 * random.symmetric(),
        );
        let [a, b] = [one, other].map(|patch| foot(&patch, &point, 1.0));
        assert!((a.distance - b.distance).abs() < 1e-13);
        assert!((a.normal - b.normal).norm() < 1e-12);
        assert!(a.at.weights[2].abs() < 1e-13 && b.at.weights[2].abs() < 1e-13);
    }
}

/// Largest errors of the height over a torus with radii 1 and 0.4 and of its gradient, in triangles
/// of a size.
fn torus_errors(size: f64) -> [f64; 2] {
    let at = |u: f64, v: f64| {
        let (ring, up) = (Vector3::new(u.cos(), u.sin(), 0.0), Vector3::z());
        let normal = ring * v.cos() + up * v.sin();
        (ring + normal * 0.4, normal)
    };
    let mut worst = [0.0_f64; 2];
    for k in 0..12 {
        let [u, v] = [0.3 * f64::from(k), 0.7 * f64::from(k)];
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.8, 1.0]];
        let all = corners.map(|[x, y]| at(u + x * size, v + 2.0 * y * size));
        let patch = Patch {
            corners: all.map(|(corner, _)| corner),
            normals: all.map(|(_, normal)| normal),
        };
        for weights in [[0.2, 0.3], [0.4, 0.4], [0.0, 0.6]] {
            let (point, _) = patch.at(weights, 0.05);
            let foot = foot(&patch, &point, 1.0);
            let ring = Vector3::new(point.x, point.y, 0.0).normalize();
            let exact = point - ring;
            worst[0] = worst[0].max((foot.distance - (exact.norm() - 0.4)).abs());
            worst[1] = worst[1].max((foot.normal - exact.normalize()).norm());
        }
    }
    worst
}

#[test]
fn errors_are_of_third_order_and_those_of_gradients_of_second() {
    let [coarse, fine] = [0.2, 0.1].map(torus_errors);
    assert!(
        coarse[0] > 7.0 * fine[0] && coarse[1] > 3.5 * fine[1],
        "{coarse:?} {fine:?}"
    );
    assert!(fine[0] < 5e-5 && fine[1] < 5e-3, "{fine:?}");
}

#[test]
fn forces_with_friction_have_their_jacobian() {
    let mut random = Random::new(11);
    let response = |gap: f64| NormalResponse {
        energy: 0.0,
        force: 3.0 - 40.0 * gap,
        force_slope: -40.0,
    };
    let law = FrictionLaw {
        coefficient: 0.4,
        slip_tolerance: 3.0,
        grain: None,
    };
    for _ in 0..40 {
        let patch = patch(&mut random);
        let point = over(&patch, &mut random);
        let before = point - random.vector() * 0.01;
        let corners = [(); 3].map(|()| random.vector());
        let at = |x: &Vector3| {
            let foot = foot(&patch, x, 1.0);
            let [a, b, c] = corners;
            let sliding = Sliding {
                law,
                velocities: [(x - before) / 0.1, a, b, c],
                swing: Vector3::zeros(),
                time_step: 0.1,
            };
            let velocity = sliding.relative_velocity(&foot.all_weights());
            let slip = super::super::friction::slip(&foot.normal, &velocity);
            let response = response(foot.distance);
            let traction = law.traction_of_slip(&slip) * foot.normal.norm();
            (
                (foot.normal + traction) * response.force,
                foot,
                response,
                sliding,
                slip,
            )
        };
        let (_, here, response, sliding, slip) = at(&point);
        let found = patch_jacobian(
            &here,
            &response,
            Some((&sliding, slip)),
            &bend(&patch, &point, 1.0),
        );
        let step = 1e-5;
        let expected: [[f64; 3]; 3] = std::array::from_fn(|row| {
            std::array::from_fn(|column| {
                let mut offset = Vector3::zeros();
                offset[column] = step;
                let change = at(&(point + offset)).0 - at(&(point - offset)).0;
                change[row] / (2.0 * step)
            })
        });
        let error = relative_error(found.jacobian.as_flattened(), expected.as_flattened());
        assert!(error < 1e-7, "{error:e}");
        assert_eq!(found.gap_gradient[..3], *here.normal.as_slice());
    }
}

#[test]
fn the_search_ends_at_the_same_foot_from_every_face() {
    let corner = |k: usize| {
        let [x, y] = [k % 6, k / 6].map(|k| 0.2 * k as f64 - 0.5);
        Vector3::new(x, y, 0.3 * x * x - 0.2 * x * y)
    };
    let cells = (0..5).flat_map(|row| (0..5).map(move |column| 6 * row + column));
    let faces: Vec<[usize; 3]> = cells
        .flat_map(|k| [[k, k + 1, k + 7], [k, k + 7, k + 6]])
        .collect();
    let sheet = RigidBody::of_mesh((0..36).map(corner).collect(), faces, false).unwrap();
    let mut surface = ContactSurface::new();
    surface.add_obstacle(sheet.smoothed(0.5), None);
    let placed = PlacedObstacles::new(&surface);
    let points: Points = placed.points(&[]);
    let mut random = Random::new(13);
    let mut beside = 0;
    for _ in 0..100 {
        let point = random.vector().component_mul(&Vector3::new(0.6, 0.6, 0.1));
        let from = |start: usize| surface.foot_from(start, 1.0, &point, &points);
        let Some(first) = from(0) else {
            assert!((1..50).all(|start| from(start).is_none()));
            beside += 1;
            continue;
        };
        for start in 1..50 {
            let found = from(start).unwrap();
            assert!((found.distance - first.distance).abs() < 1e-14);
            assert!((found.normal - first.normal).norm() < 1e-12);
        }
    }
    assert!((10..60).contains(&beside), "{beside}");
}
