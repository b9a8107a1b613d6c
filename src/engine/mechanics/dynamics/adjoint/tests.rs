//! Derivatives with respect to fields of motions without joints and contact, compared with
//! differences of whole runs.

use super::comparison::{Course, SCHEMES, check_at, course, results};
use super::{LARGEST_TRACE, Recording, SensitivityError};
use crate::mechanics::Vector3;
use crate::mechanics::dynamics::sensitivity::joint_tests::sliding;
use crate::mechanics::dynamics::{IntegrationParameters, Scheme};
use crate::mechanics::fluid::FluidModel;
use crate::mechanics::scene::{
    Clamp, Inertia, LoadKind, Motion, NaturalShape, Relaxation, Scene, Spring, SpringForce,
    TurningStiffness,
};
use crate::mechanics::test_support::{
    SCHEMES as EVERY_SCHEME, at, cantilever, clamp, curved, drag, fixed_steps, gravity, moment_on,
    point_force, section, sheared, spring, steady, straight_rod,
};

/// Largest error relative to the largest derivative of the same field.
const EXACT: f64 = 1e-7;
/// Compares the derivatives with respect to the values of some nodes with differences for changes
/// by `share` times the amounts of the fields.
#[track_caller]
fn check(name: &str, course: &Course, scene: &Scene, share: f64) {
    check_at([0, 3, 7], EXACT, name, course, scene, share);
}

/// The cantilever with a second clamp, at its end, which turns about two axes while it moves.
fn driven() -> Scene {
    let mut scene = cantilever();
    let way = Vector3::new(-0.08, 0.03, 0.05);
    scene.clamps.push(Clamp {
        motion: Motion {
            translation: vec![(0.0, Vector3::zeros()), (0.1, way)],
            axis: Some(Vector3::new(1.0, 0.5, 0.2).normalize()),
            angle: vec![(0.0, 0.0), (0.1, 4.0)],
            ..Motion::default()
        },
        ..clamp(0, 10)
    });
    scene
}

#[test]
fn an_equilibrium() {
    let course = Course {
        settles: true,
        steps: 0,
        scheme: Scheme::ImplicitEuler,
    };
    check("equilibrium", &course, &cantilever(), 1.0);
}

#[test]
fn swings_with_drag() {
    let mut scene = cantilever();
    scene.loads.push(drag(None, 0.05, 1e-5));
    for scheme in SCHEMES {
        check("swing", &course(scheme), &scene, 1.0);
    }
}

#[test]
fn swings_by_the_midpoint_rule() {
    let midpoint = course(Scheme::ImplicitMidpoint);
    let mut scene = cantilever();
    scene.loads.push(drag(None, 0.05, 1e-5));
    check("midpoint", &midpoint, &scene, 1.0);
    let from_rest = Course {
        settles: true,
        ..midpoint
    };
    check("midpoint", &from_rest, &driven(), 0.3);
}

#[test]
fn material_that_relaxes() {
    let mut scene = cantilever();
    scene.rods[0].retardation_time = 0.02;
    scene.rods[0].relaxation = Some(Relaxation {
        ratio: 0.5,
        time: 0.03,
    });
    for scheme in SCHEMES {
        check("relaxation", &course(scheme), &scene, 1.0);
        let from_rest = Course {
            settles: true,
            ..course(scheme)
        };
        check("relaxation", &from_rest, &scene, 1.0);
    }
}

#[test]
fn local_drag_of_a_fluid() {
    let mut scene = cantilever();
    scene.fluid = Some(FluidModel::Resistive { viscosity: 0.05 });
    for scheme in EVERY_SCHEME {
        check("fluid", &course(scheme), &scene, 1.0);
    }
}

#[test]
fn drag_in_background_flows() {
    let quadratic = FluidModel::Quadratic {
        density: 50.0,
        normal: 1.2,
        tangential: 0.3,
        added_mass: 1.0,
    };
    for model in [FluidModel::Resistive { viscosity: 0.05 }, quadratic] {
        let mut scene = cantilever();
        (scene.fluid, scene.flow) = (Some(model), Some(sheared(4.0)));
        scene.spin_drag = true;
        for scheme in EVERY_SCHEME {
            check("flow", &course(scheme), &scene, 1.0);
        }
    }
}

#[test]
fn consistent_inertia_and_dashpots() {
    let mut scene = cantilever();
    scene.rods[0].inertia = Inertia::Consistent;
    scene.rods[0].retardation_time = 0.02;
    let mut straight = scene.clone();
    straight.rods[0].natural_shape = NaturalShape::Straight;
    for scheme in SCHEMES {
        check("dashpots", &course(scheme), &scene, 1.0);
        check("straight", &course(scheme), &straight, 1.0);
    }
}

#[test]
fn clamps_that_move_after_an_equilibrium() {
    for scheme in SCHEMES {
        let course = Course {
            settles: true,
            ..course(scheme)
        };
        check("driven", &course, &driven(), 0.3);
    }
}

/// Two cantilevers side by side.
fn pair() -> Scene {
    let mut scene = cantilever();
    let mut other = scene.rods[0].clone();
    other.name = "other".into();
    for node in &mut other.centreline {
        *node += Vector3::y() * 0.05;
    }
    scene.rods.push(other);
    scene.clamps.push(clamp(1, 0));
    scene
}

#[test]
fn springs() {
    let mut scene = pair();
    let turning = TurningStiffness {
        stiffness: 0.01,
        rest_rotation: Vector3::new(0.1, 0.2, 0.3),
    };
    scene.springs = vec![
        spring("between nodes", [at(0, 3), at(0, 9)], 20.0),
        Spring {
            turning: Some(turning),
            ..spring("between frames", [at(0, 6), at(1, 8)], 5.0)
        },
    ];
    for scheme in SCHEMES {
        check("springs", &course(scheme), &scene, 1.0);
    }
    let rest = Course {
        settles: true,
        steps: 0,
        ..course(Scheme::ImplicitEuler)
    };
    check("springs", &rest, &scene, 0.3);
}

/// A taut tie, and a bumper that is out of touch.
#[test]
fn springs_that_act_in_one_direction() {
    let mut scene = pair();
    let tie = |nodes, rest_length, only| Spring {
        rest_length: Some(rest_length),
        only: Some(only),
        ..spring("tie", nodes, 20.0)
    };
    scene.springs = vec![
        tie([at(0, 9), at(1, 6)], 0.06, SpringForce::Tension),
        tie([at(0, 3), at(0, 9)], 0.15, SpringForce::Compression),
    ];
    for scheme in SCHEMES {
        check("one-sided springs", &course(scheme), &scene, 1.0);
    }
}

#[test]
fn moments_and_forces_that_turn_with_rods() {
    let mut scene = cantilever();
    scene.loads.extend([
        moment_on(0, 5, Vector3::new(2e-3, -3e-3, 4e-3)),
        steady(LoadKind::FollowerForce {
            rod: 0,
            node: 7,
            force: Vector3::new(0.01, 0.02, -0.03),
        }),
        steady(LoadKind::FollowerMoment {
            rod: 0,
            edge: 3,
            moment: Vector3::new(-2e-3, 1e-3, 3e-3),
        }),
    ]);
    for scheme in SCHEMES {
        check("turning", &course(scheme), &scene, 1.0);
    }
}

#[test]
fn forces_on_nodes() {
    let scene = cantilever();
    let course = course(Scheme::BackwardDifferences);
    let gradients = course.gradients(&scene, LARGEST_TRACE);
    let run = |force: f64| {
        let mut scene = scene.clone();
        scene.loads.push(point_force(0, 4, Vector3::z() * force));
        course.run(&scene, |_, _, _| {}, 0, 0.0)
    };
    let central = |by: f64| -> Vec<f64> {
        let [plus, minus] = [by, -by].map(run);
        plus.iter()
            .zip(&minus)
            .map(|(plus, minus)| (plus - minus) / (2.0 * by))
            .collect()
    };
    let (fine, coarse) = (central(1e-5), central(2e-5));
    let largest = fine.iter().fold(0.0_f64, |sum, one| sum.max(one.abs()));
    for (of, gradient) in gradients.iter().enumerate() {
        let expected = (4.0 * fine[of] - coarse[of]) / 3.0;
        assert!((gradient.force[4].z - expected).abs() < 1e-7 * largest);
    }
}

#[test]
fn rings_whose_last_vertex_closes_them() {
    let mut rod = straight_rod(11, 0.3);
    let angle = |node: usize| node as f64 * std::f64::consts::TAU / 12.0;
    rod.centreline = (0..12)
        .map(|node| Vector3::new(angle(node).cos(), angle(node).sin(), 0.0) * 0.05)
        .collect();
    rod.closed = true;
    rod.first_director = None;
    rod.stiffness = section(200.0, [1e-3, 2.5e-3], 1.2e-3);
    rod.natural_shape = curved([12.0, 5.0], 1.5);
    let scene = Scene {
        rods: vec![rod],
        clamps: vec![clamp(0, 0)],
        loads: vec![gravity(2.0)],
        ..Scene::default()
    };
    check("ring", &course(Scheme::BackwardDifferences), &scene, 0.3);
}

#[test]
fn parts_of_a_motion_add_up_to_the_whole() {
    let course = course(Scheme::ImplicitEuler);
    let mut recording = Recording::new(&driven(), &course.parameters()).unwrap();
    while recording.simulation().time() < course.end() {
        recording.advance(course.end()).unwrap();
    }
    let whole = recording.gradients(&results).unwrap();
    let ends = [0.5 * course.end() + 1e-9, f64::INFINITY];
    let parts = recording.gradients_over(&ends, &results).unwrap();
    for (whole, parts) in whole.iter().zip(&parts) {
        for node in 0..11 {
            let [first, second] = [&parts[0], &parts[1]].map(|part| part.natural_twist[node]);
            let error = first + second - whole.natural_twist[node];
            assert!(error.abs() < 1e-14, "{error:e}");
        }
        assert_eq!(whole.velocity, parts[0].velocity);
    }
    assert!(
        parts
            .iter()
            .any(|parts| parts[0].force[5] != parts[1].force[5])
    );
}

#[test]
fn parts_that_are_taken_once_more_give_the_same_bytes() {
    let course = course(Scheme::BackwardDifferences);
    // Some states of eleven nodes each.
    let apart = course.gradients(&driven(), 20_000);
    assert_eq!(apart, course.gradients(&driven(), LARGEST_TRACE));
}

#[test]
fn scenes_without_these_derivatives_are_refused() {
    type Spoil = fn(&mut Scene, &mut IntegrationParameters);
    let spoils: [(Spoil, &str); 2] = [
        (
            |scene, parameters| {
                *scene = sliding();
                parameters.scheme = Scheme::ImplicitMidpoint;
            },
            "time.scheme",
        ),
        (
            |scene, _| {
                scene.fluid = Some(FluidModel::RegularizedStokeslets {
                    viscosity: 0.05,
                    regularization: 1.02,
                    far_field_error: 0.0,
                });
            },
            "fluid.model",
        ),
    ];
    for (spoil, word) in spoils {
        let (mut scene, mut parameters) = (cantilever(), fixed_steps(Scheme::ImplicitEuler, 1e-3));
        spoil(&mut scene, &mut parameters);
        match Recording::new(&scene, &parameters) {
            Err(SensitivityError::Unsuitable(reason)) => assert!(reason.contains(word), "{reason}"),
            Err(error) => panic!("{word}: {error}"),
            Ok(_) => panic!("{word} is not refused"),
        }
    }
}
