//! Tests of the fluid as a whole.

use super::*;
use crate::mechanics::{Matrix3, Vector3};
use proptest::prelude::*;
use std::f64::consts::PI;

const STOKESLETS: FluidModel = FluidModel::RegularizedStokeslets {
    viscosity: 0.1,
    regularization: 1.02,
    far_field_error: 1e-4,
};

/// The right-handed helix of thesis 2.4.2, rotated by an angle about its axis.
fn helix(nodes: usize, centre: Vector3, angle: f64) -> Vec<Vector3> {
    (0..nodes)
        .map(|i| {
            let z = 0.2 * i as f64 / (nodes - 1) as f64;
            let angle = 2.0 * PI * z / 0.05 + angle;
            centre + Vector3::new(0.01 * angle.cos(), 0.01 * angle.sin(), z)
        })
        .collect()
}

/// Velocities of a rotation about z.
fn turning(positions: &[Vector3], rate: f64) -> Vec<Vector3> {
    let rate = Vector3::new(0.0, 0.0, rate);
    positions.iter().map(|x| rate.cross(x)).collect()
}

fn open_filaments(count: usize, nodes: usize, radius: f64) -> Vec<Filament> {
    (0..count)
        .map(|k| Filament {
            first_node: k * nodes,
            nodes,
            closed: false,
            radius,
        })
        .collect()
}

/// Calls [`Fluid::drag`] and returns its results in new vectors.
fn drag(
    fluid: &mut Fluid,
    positions: &[Vector3],
    velocities: &[Vector3],
) -> (Vec<Vector3>, Vec<Matrix3>, report::FluidReport) {
    let mut forces = vec![Vector3::zeros(); positions.len()];
    let mut resistance = vec![Matrix3::zeros(); positions.len()];
    let report = fluid
        .drag(positions, velocities, &[], &mut forces, &mut resistance)
        .unwrap();
    (forces, resistance, report)
}

/// Force and torque about the origin that the rods exert on the fluid.
fn wrench(positions: &[Vector3], forces: &[Vector3]) -> (Vector3, Vector3) {
    let force: Vector3 = forces.iter().sum();
    let torque: Vector3 = positions.iter().zip(forces).map(|(x, f)| x.cross(f)).sum();
    (-force, -torque)
}

/// A straight rod of unit length along x in a fluid of unit viscosity: force along and across it
/// at unit speed.
fn straight_rod_drag(aspect: f64, nodes: usize) -> [f64; 2] {
    let model = FluidModel::RegularizedStokeslets {
        viscosity: 1.0,
        regularization: 1.02,
        far_field_error: 1e-4,
    };
    let positions: Vec<Vector3> = (0..nodes)
        .map(|i| Vector3::new(i as f64 / (nodes - 1) as f64, 0.0, 0.0))
        .collect();
    [Vector3::x(), Vector3::y()].map(|velocity| {
        let mut fluid = Fluid::new(&model, &open_filaments(1, nodes, 1.0 / aspect)).unwrap();
        let (forces, _, _) = drag(&mut fluid, &positions, &vec![velocity; nodes]);
        wrench(&positions, &forces).0.dot(&velocity)
    })
}

/// Rows of numbers of a reference file; `None`, with a message, if it is absent.
fn reference(name: &str) -> Option<Vec<Vec<f64>>> {
    let folder = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../..",
        "/../shared/reference/fluid/"
    );
    let Ok(text) = std::fs::read_to_string(format!("{folder}{name}")) else {
        eprintln!("skipped: no reference file {name}");
        return None;
    };
    let rows = text.lines().filter(|line| !line.starts_with('#')).skip(1);
    // The first column of some files is a name.
    let numbers = |row: &str| {
        row.split(',')
            .filter_map(|cell| cell.parse().ok())
            .collect()
    };
    Some(rows.map(numbers).collect())
}

fn relative_error(got: f64, expected: f64) -> f64 {
    (got / expected - 1.0).abs()
}

#[test]
fn a_helix_turning_and_translating_agrees_with_dense_solves() {
    for row in reference("drag_helix_thesis.csv").unwrap_or_default() {
        let nodes = row[0] as usize;
        let positions = helix(nodes, Vector3::zeros(), 0.0);
        let motions = [turning(&positions, 15.0), vec![Vector3::z(); nodes]];
        for (velocities, expected) in motions.iter().zip([&row[1..3], &row[3..5]]) {
            let mut fluid = Fluid::new(&STOKESLETS, &open_filaments(1, nodes, 1e-3)).unwrap();
            let (forces, _, _) = drag(&mut fluid, &positions, velocities);
            let (force, torque) = wrench(&positions, &forces);
            assert!(relative_error(force.z, expected[0]) < 1e-5, "{nodes}");
            assert!(relative_error(torque.z, expected[1]) < 1e-5, "{nodes}");
        }
    }
}

#[test]
fn a_straight_rod_agrees_with_dense_solves() {
    for row in reference("drag_straight_rod.csv").unwrap_or_default() {
        // Nodes an eighth of ε apart are ill-conditioned: the error of the drag then exceeds the
        // residual.
        if row[0] / (row[1] - 1.0) < 0.2 {
            continue;
        }
        let [along, across] = straight_rod_drag(row[0], row[1] as usize);
        assert!(relative_error(along, row[2]) < 1e-5, "{row:?}");
        assert!(relative_error(across, row[3]) < 1e-5, "{row:?}");
    }
}

#[test]
fn a_straight_rod_drags_like_a_slender_spheroid() {
    // Oberbeck 1876; Chwang and Wu 1975, Eq. 34. A cylinder is somewhat thicker than the spheroid.
    let aspect: f64 = 200.0;
    let e = (1.0 - (2.0 / aspect).powi(2)).sqrt();
    let logarithm = ((1.0 + e) / (1.0 - e)).ln();
    let length = 1.0;
    let along = 8.0 * PI * length * e.powi(3) / (-2.0 * e + (1.0 + e * e) * logarithm);
    let across = 16.0 * PI * length * e.powi(3) / (2.0 * e + (3.0 * e * e - 1.0) * logarithm);
    let [got_along, got_across] = straight_rod_drag(aspect, 81);
    assert!(
        relative_error(got_along, along) < 0.03,
        "{got_along} {along}"
    );
    assert!(
        relative_error(got_across, across) < 0.03,
        "{got_across} {across}"
    );
}

#[test]
fn forces_leave_the_residual_they_report() {
    // Rods of different radii, one of them closed, and a node that belongs to none; A is built
    // from single segments.
    let mut positions = helix(20, Vector3::zeros(), 0.3);
    positions.push(Vector3::new(0.5, 0.5, 0.5));
    positions.extend((0..30).map(|i| {
        let angle = 2.0 * PI * i as f64 / 30.0;
        Vector3::new(0.03 + 0.02 * angle.cos(), 0.02 * angle.sin(), 0.1)
    }));
    let filaments = [
        Filament {
            first_node: 0,
            nodes: 20,
            closed: false,
            radius: 1e-3,
        },
        Filament {
            first_node: 21,
            nodes: 30,
            closed: true,
            radius: 2e-3,
        },
    ];
    let velocities = turning(&positions, 15.0);
    let mut fluid = Fluid::new(&STOKESLETS, &filaments).unwrap();
    let (forces, resistance, report) = drag(&mut fluid, &positions, &velocities);
    assert_eq!(forces[20], Vector3::zeros());
    assert_eq!(resistance[20], Matrix3::zeros());

    let mut lengths = vec![0.0; positions.len()];
    let mut edges = Vec::new();
    for filament in &filaments {
        for edge in 0..filament.edges() {
            let ends = [edge, (edge + 1) % filament.nodes].map(|k| filament.first_node + k);
            edges.push((ends, 1.02 * filament.radius));
            for node in ends {
                lengths[node] += 0.5 * (positions[ends[1]] - positions[ends[0]]).norm();
            }
        }
    }
    let (mut residual, mut size) = (0.0, 0.0);
    for node in (0..20).chain(21..51) {
        let mut u = Vector3::zeros();
        for &(ends, epsilon) in &edges {
            let [start, end] = ends.map(|k| positions[k]);
            let a = segment_integral(&positions[node], &start, &end, epsilon);
            for (a, end) in a.iter().zip(ends) {
                u -= a * (forces[end] / lengths[end]) / (8.0 * PI * 0.1);
            }
        }
        residual += (u - velocities[node]).norm_squared();
        size += velocities[node].norm_squared();
    }
    let relative = (residual / size).sqrt();
    assert!(relative < 1e-6, "{relative:e}");
    // The operator is stored in single precision.
    assert!(
        (relative - report.residual).abs() < f64::from(f32::EPSILON),
        "{relative:e} {report:?}"
    );
}

#[test]
fn local_resistance_is_symmetric_and_positive_definite() {
    let positions = helix(68, Vector3::zeros(), 0.0);
    for model in [STOKESLETS, FluidModel::Resistive { viscosity: 0.1 }] {
        let mut fluid = Fluid::new(&model, &open_filaments(1, 68, 1e-3)).unwrap();
        let (_, resistance, _) = drag(&mut fluid, &positions, &turning(&positions, 15.0));
        for d in resistance {
            assert_eq!(d, d.transpose());
            assert!(d.cholesky().is_some());
        }
    }
}

#[test]
fn power_is_dissipated() {
    let positions = helix(68, Vector3::zeros(), 0.0);
    let velocities = turning(&positions, 15.0);
    let mut fluid = Fluid::new(&STOKESLETS, &open_filaments(1, 68, 1e-3)).unwrap();
    let (forces, _, _) = drag(&mut fluid, &positions, &velocities);
    let power: f64 = forces.iter().zip(&velocities).map(|(f, v)| f.dot(v)).sum();
    // Angular velocity ω times the torque of the reference.
    assert!(
        relative_error(power, -15.0 * 1.244818746e-4) < 1e-5,
        "{power}"
    );
}

/// Four rotating helices that also approach each other: their nodes at a step, and their
/// velocities since the previous one.
fn bundle(step: usize) -> (Vec<Vector3>, Vec<Vector3>) {
    converging(4, 0.02, step)
}

/// Rotating helices on a circle that approach each other.
fn converging(count: usize, radius: f64, step: usize) -> (Vec<Vector3>, Vec<Vector3>) {
    let at = |t: f64| -> Vec<Vector3> {
        (0..count)
            .flat_map(|k| {
                let direction = 2.0 * PI * k as f64 / count as f64;
                let centre = Vector3::new(direction.cos(), direction.sin(), 0.0);
                helix(
                    68,
                    centre * (radius - 0.1 * t),
                    15.0 * t + 0.1 * (k as f64 + 20.0 * t).sin(),
                )
            })
            .collect()
    };
    let (now, before) = (at(1e-3 * step as f64), at(1e-3 * (step as f64 - 1.0)));
    let velocities = now
        .iter()
        .zip(&before)
        .map(|(a, b)| (a - b) / 1e-3)
        .collect();
    (now, velocities)
}

/// Twenty helices, enough for clusters.
fn swarm(step: usize) -> (Vec<Vector3>, Vec<Vector3>) {
    converging(20, 0.1, step)
}

fn stokeslets(far_field_error: f64) -> FluidModel {
    FluidModel::RegularizedStokeslets {
        viscosity: 0.1,
        regularization: 1.02,
        far_field_error,
    }
}

#[test]
fn the_far_field_error_bounds_the_error_of_the_drag() {
    let filaments = open_filaments(20, 68, 1e-3);
    let mut exact = Fluid::new(&stokeslets(0.0), &filaments).unwrap();
    let models = [1e-3, 1e-4, 1e-5];
    let mut approximate = models.map(|e| Fluid::new(&stokeslets(e), &filaments).unwrap());
    for step in 0..6 {
        let (positions, velocities) = swarm(step);
        let (expected, _, _) = drag(&mut exact, &positions, &velocities);
        let size: f64 = expected.iter().map(|f| f.norm_squared()).sum();
        for (fluid, bound) in approximate.iter_mut().zip(models) {
            let (forces, _, _) = drag(fluid, &positions, &velocities);
            let difference: f64 = (forces.iter().zip(&expected))
                .map(|(a, b)| (a - b).norm_squared())
                .sum();
            let error = (difference / size).sqrt();
            assert!(error < bound, "step {step}: {error:e} for {bound:e}");
        }
    }
}

#[test]
fn one_thread_and_four_threads_give_the_same_bytes() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let mut fluid = Fluid::new(&STOKESLETS, &open_filaments(4, 68, 1e-3)).unwrap();
            let mut last = Vec::new();
            for step in 0..5 {
                let (positions, velocities) = bundle(step);
                last = drag(&mut fluid, &positions, &velocities).0;
            }
            last
        })
    };
    assert_eq!(run(1), run(4));
}

#[test]
fn restored_memory_continues_with_the_same_bytes() {
    continues_with_the_same_bytes(4, bundle, 60);
}

#[test]
fn restored_memory_of_many_nodes_continues_with_the_same_bytes() {
    continues_with_the_same_bytes(20, swarm, 12);
}

/// Takes six steps, then continues from the memory.
fn continues_with_the_same_bytes(
    count: usize,
    scene: impl Fn(usize) -> (Vec<Vector3>, Vec<Vector3>),
    steps: usize,
) {
    let filaments = open_filaments(count, 68, 1e-3);
    let mut fluid = Fluid::new(&STOKESLETS, &filaments).unwrap();
    for step in 0..6 {
        let (positions, velocities) = scene(step);
        drag(&mut fluid, &positions, &velocities);
    }
    let saved = postcard::to_stdvec(&fluid.memory()).unwrap();
    let mut restored = Fluid::new(&STOKESLETS, &filaments).unwrap();
    restored
        .restore(postcard::from_bytes(&saved).unwrap())
        .unwrap();
    for step in 6..steps {
        let (positions, velocities) = scene(step);
        let (forces, _, report) = drag(&mut fluid, &positions, &velocities);
        let (again, _, report_again) = drag(&mut restored, &positions, &velocities);
        assert_eq!(forces, again, "step {step}");
        assert_eq!(report, report_again, "step {step}");
    }
    assert_eq!(fluid.memory(), restored.memory());
}

#[test]
fn foreign_memory_is_refused() {
    let mut small = Fluid::new(&STOKESLETS, &open_filaments(1, 20, 1e-3)).unwrap();
    let large = Fluid::new(&STOKESLETS, &open_filaments(1, 30, 1e-3)).unwrap();
    let resistive = FluidModel::Resistive { viscosity: 0.1 };
    let resistive = Fluid::new(&resistive, &open_filaments(1, 20, 1e-3)).unwrap();
    assert_eq!(
        small.restore(large.memory()),
        Err(FluidError::ForeignMemory)
    );
    assert_eq!(
        small.restore(resistive.memory()),
        Err(FluidError::ForeignMemory)
    );
}

#[test]
fn a_repeated_call_needs_no_iterations() {
    let mut fluid = Fluid::new(&STOKESLETS, &open_filaments(4, 68, 1e-3)).unwrap();
    let (positions, velocities) = bundle(0);
    let (forces, _, first) = drag(&mut fluid, &positions, &velocities);
    for _ in 0..4 {
        let (again, _, report) = drag(&mut fluid, &positions, &velocities);
        assert_eq!(report.iterations, 0);
        for (a, b) in forces.iter().zip(&again) {
            assert!((a - b).norm() <= 1e-9 * a.norm());
        }
    }
    assert!(first.iterations > 0);
}

#[test]
fn fluid_at_rest_exerts_no_force() {
    let mut fluid = Fluid::new(&STOKESLETS, &open_filaments(4, 68, 1e-3)).unwrap();
    let (positions, velocities) = bundle(0);
    drag(&mut fluid, &positions, &velocities);
    let rest = vec![Vector3::zeros(); positions.len()];
    let (forces, _, report) = drag(&mut fluid, &positions, &rest);
    assert_eq!(forces, rest);
    assert_eq!(report.residual, 0.0);
}

#[test]
fn wrong_numbers_are_errors() {
    let mut fluid = Fluid::new(&STOKESLETS, &open_filaments(1, 20, 1e-3)).unwrap();
    let positions = helix(20, Vector3::zeros(), 0.0);
    let velocities = turning(&positions, 15.0);
    let mut forces = vec![Vector3::zeros(); 20];
    let mut resistance = vec![Matrix3::zeros(); 20];
    let mut attempt = |positions: &[Vector3], velocities: &[Vector3]| {
        fluid.drag(positions, velocities, &[], &mut forces, &mut resistance)
    };
    let mut broken = velocities.clone();
    broken[3].y = f64::NAN;
    assert_eq!(attempt(&positions, &broken), Err(FluidError::NotFinite));
    let mut broken = positions.clone();
    broken[3].y = f64::INFINITY;
    assert_eq!(attempt(&broken, &velocities), Err(FluidError::NotFinite));
    let mut broken = positions.clone();
    broken[3] = broken[4];
    assert_eq!(attempt(&broken, &velocities), Err(FluidError::Singular));
    // The fluid still works after each of these errors.
    assert!(attempt(&positions, &velocities).is_ok());
}

#[test]
fn bad_descriptions_are_refused() {
    let good = open_filaments(2, 10, 1e-3);
    let refused = |model: &FluidModel, filaments: &[Filament]| {
        matches!(Fluid::new(model, filaments), Err(FluidError::BadInput(_)))
    };
    assert!(!refused(&STOKESLETS, &good));
    for viscosity in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(refused(&FluidModel::Resistive { viscosity }, &good));
        let model = FluidModel::RegularizedStokeslets {
            viscosity,
            regularization: 1.02,
            far_field_error: 1e-4,
        };
        assert!(refused(&model, &good));
    }
    for error in [-1e-4, 1e-7, 0.1, f64::NAN] {
        assert!(refused(&stokeslets(error), &good));
    }
    let mut overlapping = good.clone();
    overlapping[1].first_node = 9;
    assert!(refused(&STOKESLETS, &overlapping));
    let mut point = good.clone();
    point[1].nodes = 1;
    assert!(refused(&STOKESLETS, &point));
    let mut thin = good;
    thin[1].radius = 0.0;
    assert!(refused(&STOKESLETS, &thin));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    #[test]
    fn a_rigid_motion_of_the_scene_moves_the_forces_along(
        angles in prop::array::uniform3(-3.0..3.0_f64),
        shift in prop::array::uniform3(-1.0..1.0_f64),
    ) {
        let rotation = nalgebra::Rotation3::from_scaled_axis(Vector3::from(angles));
        let positions = helix(68, Vector3::zeros(), 0.0);
        let velocities = turning(&positions, 15.0);
        let moved: Vec<_> = positions.iter().map(|x| rotation * x + Vector3::from(shift)).collect();
        let turned: Vec<_> = velocities.iter().map(|v| rotation * v).collect();
        let filaments = open_filaments(1, 68, 1e-3);
        let (forces, resistance, _) =
            drag(&mut Fluid::new(&STOKESLETS, &filaments).unwrap(), &positions, &velocities);
        let (moved_forces, moved_resistance, _) =
            drag(&mut Fluid::new(&STOKESLETS, &filaments).unwrap(), &moved, &turned);
        let scale = forces.iter().map(|f| f.norm()).fold(0.0, f64::max);
        for i in 0..68 {
            // The operator is stored in single precision; its rounding does not rotate with the
            // scene.
            let rounding = f64::from(f32::EPSILON);
            prop_assert!((rotation * forces[i] - moved_forces[i]).norm() < 2.0 * rounding * scale);
            let expected = rotation * resistance[i] * rotation.inverse();
            prop_assert!((expected - moved_resistance[i]).norm() < rounding * expected.norm());
        }
    }

    #[test]
    fn drag_is_linear_in_the_velocity(factor in -5.0..5.0_f64) {
        let positions = helix(68, Vector3::zeros(), 0.0);
        let velocities = turning(&positions, 15.0);
        let scaled: Vec<_> = velocities.iter().map(|v| v * factor).collect();
        let filaments = open_filaments(1, 68, 1e-3);
        let (forces, _, _) =
            drag(&mut Fluid::new(&STOKESLETS, &filaments).unwrap(), &positions, &velocities);
        let (scaled_forces, _, _) =
            drag(&mut Fluid::new(&STOKESLETS, &filaments).unwrap(), &positions, &scaled);
        for (a, b) in forces.iter().zip(&scaled_forces) {
            prop_assert!((a * factor - b).norm() <= 1e-12 * (a * factor).norm());
        }
    }
}

#[test]
fn the_largest_ratio_of_the_resistance_to_its_local_part_is_that_of_the_dense_matrix() {
    // Edges of 2.5 radii and of 20 radii, and a bundle.
    for (count, nodes, length) in [(1, 41, 0.01), (1, 11, 0.02), (3, 20, 0.05)] {
        let filaments = open_filaments(count, nodes, 1e-4);
        let spacing = length / (nodes - 1) as f64;
        let positions: Vec<Vector3> = (0..count * nodes)
            .map(|k| {
                let (rod, node) = (k / nodes, k % nodes);
                Vector3::new(node as f64 * spacing, rod as f64 * 4e-4, 0.0)
            })
            .collect();
        let mut fluid = Fluid::new(&STOKESLETS, &filaments).unwrap();
        let velocities = vec![Vector3::x(); positions.len()];
        drag(&mut fluid, &positions, &velocities);
        let found = fluid.coupling().unwrap().largest_ratio;

        let mut operator = FlowOperator::new(&filaments, 1.02);
        operator.assemble(&positions);
        let unknowns = 3 * positions.len();
        let [matrix, local] = [false, true].map(|only_local| {
            nalgebra::DMatrix::from_fn(unknowns, unknowns, |i, j| {
                if only_local && i / 3 != j / 3 {
                    0.0
                } else {
                    operator.block(i / 3, j / 3)[(i % 3, j % 3)]
                }
            })
        });
        let ratios = matrix.lu().solve(&local).unwrap().complex_eigenvalues();
        let largest = ratios.iter().map(|ratio| ratio.norm()).fold(0.0, f64::max);
        let error = found / largest - 1.0;
        assert!(
            (-0.15..0.25).contains(&error),
            "{count} {nodes}: {found} {largest}"
        );
    }
}

#[test]
fn the_drag_is_linear_in_the_velocities() {
    let positions = helix(68, Vector3::zeros(), 0.0);
    let mut fluid = Fluid::new(&STOKESLETS, &open_filaments(1, 68, 1e-3)).unwrap();
    let [first, second] = [
        turning(&positions, 15.0),
        vec![Vector3::new(0.1, 0.2, 0.3); 68],
    ];
    let (of_first, resistance, _) = drag(&mut fluid, &positions, &first);
    let mut of_second = vec![Vector3::zeros(); 68];
    fluid
        .drag_of(&second, &[], &resistance, &mut of_second)
        .unwrap();
    let both: Vec<Vector3> = first
        .iter()
        .zip(&second)
        .map(|(a, b)| a - b * 2.0)
        .collect();
    let mut of_both = vec![Vector3::zeros(); 68];
    fluid
        .drag_of(&both, &[], &resistance, &mut of_both)
        .unwrap();
    let largest = of_both.iter().map(|f| f.norm()).fold(0.0, f64::max);
    for k in 0..68 {
        let error = of_both[k] - (of_first[k] - of_second[k] * 2.0);
        assert!(error.norm() < 1e-4 * largest, "{k}: {error}");
    }
    let (again, ..) = drag(&mut fluid, &positions, &both);
    for (again, before) in again.iter().zip(&of_both) {
        assert!((again - before).norm() < 1e-4 * largest);
    }
}
