//! Paths of equilibria with known critical points and branches.

use crate::mechanics::Vector3;
use crate::mechanics::scene::{Load, LoadKind, NaturalShape, RodDescription, Scene};
use crate::mechanics::statics::{PathMethod, PathPlan, PathPoint, PointKind};
use crate::mechanics::test_support::{assert_close, clamp, point_force, section, simulation_of};
use std::f64::consts::{PI, TAU};

const EDGES: usize = 40;

fn rod(centreline: Vec<Vector3>) -> RodDescription {
    // The rod is soft about the first director only: it bends in the plane of x and y.
    let stiffness = section(1e5, [1.0, 50.0], 10.0);
    RodDescription {
        first_director: Some(Vector3::z()),
        natural_shape: NaturalShape::AsPlaced,
        rotational_inertia_per_length: 1e-4,
        ..RodDescription::uniform("rod", centreline, stiffness, 1e-2, 1.0)
    }
}

/// A force equal to the parameter times `force`.
fn growing(node: usize, force: Vector3) -> Load {
    Load {
        schedule: vec![(-1e3, -1e3), (1e3, 1e3)],
        ..point_force(0, node, force)
    }
}

fn column() -> Scene {
    let node = |k: usize| k as f64 / EDGES as f64 * Vector3::x();
    Scene {
        rods: vec![rod((0..=EDGES).map(node).collect())],
        clamps: vec![clamp(0, 0)],
        loads: vec![growing(EDGES, -Vector3::x())],
        ..Scene::default()
    }
}

/// An arch between two walls, pushed down in its middle; it is so shallow that it stays symmetric.
fn arch() -> Scene {
    arch_of_height(0.036)
}

fn arch_of_height(height: f64) -> Scene {
    let node = |k: usize| {
        let s = k as f64 / EDGES as f64;
        Vector3::new(s, 0.5 * height * (1.0 - (2.0 * PI * s).cos()), 0.0)
    };
    Scene {
        rods: vec![rod((0..=EDGES).map(node).collect())],
        clamps: vec![clamp(0, 0), clamp(0, EDGES)],
        loads: vec![growing(EDGES / 2, -Vector3::y())],
        ..Scene::default()
    }
}

fn plan(to: f64, method: PathMethod) -> PathPlan {
    PathPlan {
        from: 0.0,
        to,
        step: 0.02 * to,
        largest_step: 0.04 * to,
        method,
        switch_branches: true,
        most_points: 300,
    }
}

fn follow(scene: &Scene, plan: PathPlan) -> (Vec<PathPoint>, bool) {
    let mut simulation = simulation_of(scene);
    let mut path = simulation.path(plan).unwrap();
    let mut points = Vec::new();
    loop {
        match simulation.next_point(&mut path) {
            Ok(Some(point)) => points.push(point),
            Ok(None) => return (points, true),
            Err(_) => return (points, false),
        }
    }
}

/// The first point of a path that is not regular.
fn first_critical(points: &[PathPoint]) -> &PathPoint {
    let critical = points.iter().find(|point| point.kind != PointKind::Regular);
    critical.unwrap()
}

#[test]
fn a_column_buckles_at_eulers_load_into_two_mirrored_branches() {
    for method in [PathMethod::Natural, PathMethod::Arclength] {
        let (points, finished) = follow(&column(), plan(4.0, method));
        assert!(finished);
        let critical = first_critical(&points);
        assert_eq!(critical.kind, PointKind::Bifurcation);
        assert!((critical.parameter / (0.25 * PI * PI) - 1.0).abs() < 5e-4);
        for point in points
            .iter()
            .filter(|point| point.kind == PointKind::Regular)
        {
            let buckled = point.branch > 0;
            let stable = buckled || point.parameter < critical.parameter;
            assert_eq!(point.negative == 0, stable, "{}", point.parameter);
            assert_eq!(point.lowest_eigenvalue > 0.0, stable, "{}", point.parameter);
        }
        let end = |branch: usize| {
            let last = points.iter().rfind(|point| point.branch == branch).unwrap();
            assert_eq!(last.parameter, 4.0);
            last.unknowns[4 * EDGES + 1]
        };
        // The elastica at P/P_c = 1.6211 has sin²(α/2) = 0.7103 and a tip at 2 √(EI/P) sin(α/2).
        let tip = 2.0 * (1.0f64 / 4.0).sqrt() * tip_modulus(4.0);
        assert!(end(0).abs() < 1e-9);
        assert!((end(1).abs() / tip - 1.0).abs() < 1e-3, "{} {tip}", end(1));
        assert!((end(1) + end(2)).abs() < 1e-6 * tip);
    }
}

/// The Hessian is shifted by a multiple of the rounding error of its stiffest entry; loads must not depend on it.
#[test]
fn the_buckling_load_does_not_depend_on_a_stiff_direction() {
    let load = |stiff: f64| {
        let mut scene = column();
        scene.rods[0].stiffness = section(1e5, [1.0, stiff], 10.0);
        let (points, _) = follow(&scene, plan(4.0, PathMethod::Natural));
        let critical = first_critical(&points);
        (critical.parameter, critical.parameter_error)
    };
    let (usual, error) = load(50.0);
    let (stiff, stiff_error) = load(5e5);
    assert!(error < 1e-6 && stiff_error < 1e-3);
    assert!((stiff - usual).abs() < 1e-4 * usual, "{stiff} {usual}");
}

/// Modulus k of the elastica of unit length and stiffness under the end load P: K(k) = √P.
fn tip_modulus(load: f64) -> f64 {
    let quarter_period = |k: f64| {
        // By the arithmetic–geometric mean (Abramowitz & Stegun 17.6.3).
        let (mut a, mut g): (f64, f64) = (1.0, (1.0 - k * k).sqrt());
        for _ in 0..30 {
            (a, g) = (0.5 * (a + g), (a * g).sqrt());
        }
        PI / (2.0 * a)
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if quarter_period(middle) < load.sqrt() {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

#[test]
fn the_path_of_an_arch_turns_back_at_a_fold_where_it_loses_stability() {
    let mut scene = arch();
    scene.rods[0].stiffness.stretching = 2e4;
    let to = 200.0;
    let (points, finished) = follow(
        &scene,
        PathPlan {
            switch_branches: false,
            largest_step: 0.004 * to,
            step: 0.004 * to,
            most_points: 2000,
            ..plan(to, PathMethod::Arclength)
        },
    );
    assert!(finished);
    let first = points
        .iter()
        .position(|point| point.kind == PointKind::Fold)
        .unwrap();
    let fold = &points[first];
    let (lowest, start) = (fold.lowest_eigenvalue, points[0].lowest_eigenvalue);
    assert!(lowest.abs() < 1e-3 * start, "{lowest} of {start}");
    for point in &points {
        // No point is beyond the fold before the arch has snapped through.
        let up = point.unknowns[4 * (EDGES / 2) + 1] > 0.0;
        assert!(!up || point.parameter <= fold.parameter * (1.0 + 1e-6));
    }
    assert!(points[first - 1].negative == 0 && points[first + 2].negative == 1);
    assert!(points[first + 2].parameter < fold.parameter);
}

/// The path of a higher arch bifurcates into asymmetric shapes before its fold, and again after it
/// has snapped. One loop connects the two bifurcations, and at the end the inverted arch is stable.
#[test]
fn an_arch_that_snaps_asymmetrically_has_one_closed_branch_and_a_stable_inverted_one() {
    let to = 200.0;
    let plan = PathPlan {
        // The inverted arch stays so until it is pulled back.
        from: -150.0,
        ..plan(to, PathMethod::Arclength)
    };
    let (points, finished) = follow(&arch_of_height(0.05), plan);
    assert!(finished);
    let of_branch = |branch: usize| {
        let own = points.iter().filter(move |point| point.branch == branch);
        own.collect::<Vec<_>>()
    };
    let first = of_branch(0);
    let last = first.last().unwrap();
    assert_eq!((last.parameter, last.negative), (to, 0));
    assert!(last.unknowns[4 * (EDGES / 2) + 1] < -0.03);
    // The asymmetric shapes are unstable under a load, and the branch closes.
    let loop_of_shapes = of_branch(1);
    let [begin, end] = [
        &loop_of_shapes[0],
        &loop_of_shapes[loop_of_shapes.len() - 1],
    ];
    let same = (begin.unknowns.iter().zip(&end.unknowns)).all(|(a, b)| (a - b).abs() < 1e-6);
    assert!(same && begin.parameter == end.parameter);
    let leans = |point: &PathPoint| {
        let quarter = [EDGES / 4, EDGES - EDGES / 4].map(|node| point.unknowns[4 * node + 1]);
        quarter[0] - quarter[1]
    };
    let to_either_side = loop_of_shapes.iter().map(|point| leans(point));
    let [most, least] = [f64::max, f64::min].map(|of| to_either_side.clone().fold(0.0, of));
    assert!(
        (most + least).abs() < 0.1 * most && most > 0.01,
        "{most} {least}"
    );
    // It is the only branch there: its other bifurcation is the last one of the path.
    let other = first
        .iter()
        .rfind(|point| point.kind == PointKind::Bifurcation);
    let passed = other.unwrap().parameter;
    let starts = points.iter().filter(|point| point.branch > 1);
    assert!(
        starts
            .clone()
            .all(|point| point.kind != PointKind::Bifurcation || point.parameter != passed)
    );
    // Other branches may join the first one, and end there.
    assert!(starts.count() < 300);
}

#[test]
fn the_lowest_eigenvalue_is_that_of_the_dense_matrix() {
    let mut simulation = simulation_of(&column());
    let mut path = simulation.path(plan(4.0, PathMethod::Natural)).unwrap();
    while let Some(point) = simulation.next_point(&mut path).unwrap() {
        let weight = |unknown: &usize| if unknown % 4 == 3 { EDGES as f64 } else { 1.0 };
        let scales: Vec<f64> = simulation.free_unknowns().iter().map(weight).collect();
        let mut matrix = simulation.stiffness_matrix();
        for i in 0..scales.len() {
            for j in 0..scales.len() {
                matrix[(i, j)] *= scales[i] * scales[j];
            }
        }
        let lowest = matrix.symmetric_eigenvalues().min();
        let error = (point.lowest_eigenvalue - lowest).abs();
        assert!(
            error < 1e-5 * lowest.abs() + 1e-7,
            "{lowest} {}",
            point.lowest_eigenvalue
        );
        if point.branch > 0 {
            break;
        }
    }
}

#[test]
fn an_end_moment_of_fixed_direction_rolls_a_rod_up_along_a_path() {
    let mut scene = column();
    scene.loads = vec![Load {
        kind: LoadKind::Moment {
            rod: 0,
            edge: EDGES - 1,
            moment: Vector3::z(),
        },
        schedule: vec![(-1e3, -1e3), (1e3, 1e3)],
    }];
    let (points, finished) = follow(&scene, plan(PI, PathMethod::Arclength));
    assert!(finished);
    let last = points.last().unwrap();
    assert_eq!(last.parameter, PI);
    // Half a circle of diameter 2/π.
    let tip = Vector3::from_column_slice(&last.unknowns[4 * EDGES..4 * EDGES + 3]);
    assert!((tip - Vector3::y() * (2.0 / PI)).norm() < 3e-3, "{tip}");
    assert!(last.motions.is_some());
}

/// A column clamped at its start under an axial force at its end; the fraction `following` of the
/// force turns with the end.
fn followed_column(following: f64) -> Scene {
    let mut scene = column();
    scene.loads = vec![
        growing(EDGES, Vector3::x() * (following - 1.0)),
        Load {
            kind: LoadKind::FollowerForce {
                rod: 0,
                node: EDGES,
                force: -Vector3::z() * following,
            },
            schedule: vec![(-1e3, -1e3), (1e3, 1e3)],
        },
    ];
    scene
}

#[test]
fn a_column_under_a_force_that_turns_with_its_end_flutters_at_becks_load() {
    for method in [PathMethod::Natural, PathMethod::Arclength] {
        let (points, finished) = follow(&followed_column(1.0), plan(24.0, method));
        assert!(finished);
        let critical = first_critical(&points);
        assert_eq!(critical.kind, PointKind::Flutter);
        // Value from Beck 1952; the error is of second order in the edge length.
        assert_close(critical.parameter, 20.0509, 5e-3);
        for point in points.iter().filter(|p| p.kind == PointKind::Regular) {
            let motions = point.motions.unwrap();
            let stable = point.parameter < critical.parameter;
            assert_eq!(point.negative, if stable { 0 } else { 2 });
            assert_eq!(motions.growth_rate > 0.0, !stable, "{motions:?}");
            assert!(motions.frequency > 0.0);
        }
    }
}

#[test]
fn a_column_under_a_force_that_turns_only_a_little_diverges() {
    // Below one half: buckling at P with a + (1 − a) cos √P = 0, where a is the following fraction
    // (Kordas and Życzkowski 1963).
    let following = 0.2_f64;
    let exact = (-following / (1.0 - following)).acos().powi(2);
    let (points, _) = follow(&followed_column(following), plan(4.0, PathMethod::Natural));
    let critical = first_critical(&points);
    assert_eq!(
        (critical.kind, critical.negative),
        (PointKind::Bifurcation, 1)
    );
    assert_close(critical.parameter, exact, 2e-3);
}

#[test]
fn a_fold_and_a_bifurcation_within_one_step_are_told_apart() {
    let mut scene = arch();
    scene.rods[0].stiffness.stretching = 2e4;
    // The height is such that sideways buckling and snap-through nearly coincide.
    for x in &mut scene.rods[0].centreline {
        x.y *= 0.0224 / 0.018;
    }
    let to = 400.0;
    let (points, finished) = follow(
        &scene,
        PathPlan {
            switch_branches: false,
            ..plan(to, PathMethod::Arclength)
        },
    );
    assert!(finished);
    let critical: Vec<usize> = (0..points.len())
        .filter(|&k| points[k].kind != PointKind::Regular)
        .collect();
    let kinds: Vec<PointKind> = critical.iter().map(|&k| points[k].kind).collect();
    let (fold, bifurcation) = (PointKind::Fold, PointKind::Bifurcation);
    assert_eq!(
        kinds,
        [fold, bifurcation, bifurcation, fold],
        "{critical:?}"
    );
    assert_eq!(critical[0] + 1, critical[1], "{critical:?}");
    for &k in &critical {
        assert!(points[k].parameter_error < 1e-8 * to);
    }
    assert_eq!(points[critical[1]].negative, 2);
}

#[test]
fn a_round_column_buckles_in_two_directions_at_once_and_turns_without_resistance() {
    let mut scene = column();
    scene.rods[0].stiffness.bending = [1.0; 2];
    let (points, finished) = follow(&scene, plan(4.0, PathMethod::Arclength));
    assert!(finished);
    let critical = first_critical(&points);
    assert_eq!(
        (critical.kind, critical.negative),
        (PointKind::Bifurcation, 2)
    );
    let tip = 2.0 * (1.0f64 / 4.0).sqrt() * tip_modulus(4.0);
    let buckled: Vec<_> = points.iter().filter(|point| point.branch > 0).collect();
    assert_eq!(buckled.iter().map(|point| point.branch).max(), Some(4));
    for point in buckled.iter().filter(|point| point.parameter == 4.0) {
        let deflection = point.unknowns[4 * EDGES + 1].hypot(point.unknowns[4 * EDGES + 2]);
        assert!((deflection / tip - 1.0).abs() < 1e-3, "{deflection} {tip}");
        assert_eq!(point.negative, 0);
        // The eigenvalue is not that of rotation about the column, which meets no resistance.
        assert!(
            point.lowest_eigenvalue > 0.01,
            "{}",
            point.lowest_eigenvalue
        );
    }
}

#[test]
fn turns_of_a_clamp_count_along_a_path() {
    let turns = 1000.0;
    let mut scene = column();
    scene.loads.clear();
    let mut head = clamp(0, EDGES);
    head.motion.angle = vec![(0.0, 0.0), (1.0, turns * TAU)];
    scene.clamps.push(head);
    let plan = PathPlan {
        step: 0.25,
        largest_step: 0.5,
        switch_branches: false,
        ..plan(1.0, PathMethod::Natural)
    };
    let mut simulation = simulation_of(&scene);
    let mut path = simulation.path(plan).unwrap();
    while simulation.next_point(&mut path).unwrap().is_some() {
        let angle = simulation.time() * turns * TAU;
        let expected = 0.5 * scene.rods[0].stiffness.twisting * angle * angle;
        let got = simulation.energies().twisting;
        assert!(
            (got - expected).abs() <= 1e-6 * expected,
            "{got} {expected}"
        );
    }
    assert_eq!(simulation.time(), 1.0);
}
