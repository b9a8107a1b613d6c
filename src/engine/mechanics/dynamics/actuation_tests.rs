//! Rods with prescribed changes of curvature, twist and length.

use super::*;
use crate::mechanics::Vector3;
use crate::mechanics::scene::{ActuatedStrain, Actuation, Course, RodDescription, Scene, Wave};
use crate::mechanics::system::Grasp;
use crate::mechanics::test_support::{
    SCHEMES, advance_to, at_rest, clamp, curved, fixed_steps, point_force, run_with, section,
    simulation_of,
};

const LENGTH: f64 = 0.3;

fn rod(edges: usize) -> RodDescription {
    let node = |k: usize| Vector3::x() * (LENGTH * k as f64 / edges as f64);
    let stiffness = section(1e3, [1e-3, 4e-3], 2e-3);
    RodDescription {
        first_director: Some(Vector3::y()),
        ..RodDescription::uniform(
            "arm",
            (0..=edges).map(node).collect(),
            stiffness,
            2e-3,
            0.01,
        )
    }
}

fn actuation(strain: ActuatedStrain, value: f64) -> Actuation {
    Actuation {
        rod: 0,
        strain,
        part: [0.0, f64::INFINITY],
        course: Course::Uniform(vec![(0.0, 0.0), (0.5, value)]),
    }
}

fn scene(actuations: Vec<Actuation>) -> Scene {
    Scene {
        rods: vec![rod(30)],
        clamps: vec![clamp(0, 0)],
        actuations,
        ..Scene::default()
    }
}

/// Finds the equilibrium with the final natural strains of the actuations.
fn settled(mut scene: Scene) -> Simulation {
    for actuation in &mut scene.actuations {
        if let Course::Uniform(values) = &mut actuation.course {
            values.remove(0);
        }
    }
    at_rest(&scene)
}

#[test]
fn a_cantilever_bends_about_the_director_that_is_named() {
    for (strain, towards) in [
        (ActuatedStrain::FirstCurvature, -Vector3::z()),
        (ActuatedStrain::SecondCurvature, Vector3::y()),
    ] {
        let simulation = settled(scene(vec![actuation(strain, 5.0)]));
        let arc = (1.0 - (5.0 * LENGTH).cos()) / 5.0;
        let end = simulation.positions()[30];
        assert!((end.dot(&towards) / arc - 1.0).abs() < 1e-3, "{end}");
        assert!(simulation.energies().elastic() < 1e-16);
    }
}

#[test]
fn actuations_add_up_and_to_the_natural_shape() {
    let mut bent = scene(vec![
        actuation(ActuatedStrain::FirstCurvature, 2.0),
        actuation(ActuatedStrain::FirstCurvature, 1.5),
        actuation(ActuatedStrain::Twist, 4.0),
    ]);
    bent.rods[0].natural_shape = curved([1.0, 0.0], -1.0);
    let mut expected = scene(Vec::new());
    expected.rods[0].natural_shape = curved([4.5, 0.0], 3.0);
    let [got, expected] = [settled(bent), settled(expected)];
    for (one, other) in got.positions().iter().zip(expected.positions()) {
        assert!((one - other).norm() < 1e-9);
    }
}

#[test]
fn a_part_bends_and_the_rest_goes_straight_on() {
    let mut part = actuation(ActuatedStrain::SecondCurvature, 8.0);
    // Starts inside an edge, so that the vertex there is actuated in part.
    part.part = [0.1042, 0.2];
    let simulation = settled(scene(vec![part]));
    let positions = simulation.positions();
    let angle = |from: usize| {
        let along = positions[from + 1] - positions[from];
        along.y.atan2(along.x)
    };
    assert!(angle(8).abs() < 1e-9);
    let turned = 8.0 * (0.2 - 0.1042);
    assert!((angle(25) / turned - 1.0).abs() < 1e-3, "{}", angle(25));
}

#[test]
fn a_rod_that_lengthens_keeps_curvature_and_stiffness_per_length() {
    // Clamped, naturally curved and lengthened by half: without load an arc of the same curvature;
    // under load a rod of the new length.
    let lengthen = actuation(ActuatedStrain::Length, 0.5);
    let mut bent = scene(vec![lengthen.clone()]);
    bent.rods[0].natural_shape = curved([0.0, 3.0], 0.0);
    let end = settled(bent).positions()[30];
    let arc = (1.0 - (3.0 * 1.5 * LENGTH).cos()) / 3.0;
    assert!((end.y / arc - 1.0).abs() < 1e-3, "{end}");
    let force = point_force(0, 30, Vector3::z() * 1e-4);
    let mut loaded = scene(vec![lengthen]);
    loaded.loads = vec![force];
    let end = settled(loaded).positions()[30];
    let deflection = 1e-4 * (1.5 * LENGTH).powi(3) / (3.0 * 1e-3);
    assert!((end.z / deflection - 1.0).abs() < 2e-3, "{end}");
}

#[test]
fn a_rod_that_lengthens_keeps_its_twist_per_length() {
    // Half as long again and free at its end, it has turned about itself by that much more.
    let mut twisted = scene(vec![actuation(ActuatedStrain::Length, 0.5)]);
    twisted.rods[0].natural_shape = curved([0.0; 2], 3.0);
    let simulation = settled(twisted);
    let director = simulation.material_directors()[29];
    // The middle of the last edge is half an edge from the end.
    let turned = 3.0 * 1.5 * LENGTH * (29.5 / 30.0);
    let found = director.z.atan2(director.y);
    assert!((found - turned).abs() < 1e-6, "{found} {turned}");
    assert!(simulation.energies().elastic() < 1e-16);
}

#[test]
fn every_scheme_follows_a_wave_and_a_checkpoint_is_exact() {
    let wave = Actuation {
        rod: 0,
        strain: ActuatedStrain::SecondCurvature,
        part: [0.0, f64::INFINITY],
        course: Course::Wave(Wave {
            amplitude: 6.0,
            wavelength: 0.2,
            frequency: 3.0,
            phase: 0.3,
            schedule: vec![(0.0, 0.0), (0.1, 1.0)],
        }),
    };
    for scheme in SCHEMES {
        let parameters = fixed_steps(scheme, 2e-3);
        let waving = scene(vec![wave.clone()]);
        let mut whole = run_with(&waving, &parameters, 0.2);
        let state = whole.state();
        advance_to(&mut whole, 0.3);
        let mut again = Simulation::new(&waving, &parameters).unwrap();
        again.restore(state).unwrap();
        advance_to(&mut again, 0.3);
        assert_eq!(again.positions(), whole.positions());
        let largest = whole.positions().iter().map(|x| x.y.abs());
        assert!(largest.fold(0.0, f64::max) > 1e-3);
        // A node that is grasped and released does not change the wave.
        whole
            .grasp(
                15,
                Grasp {
                    position: false,
                    frame: true,
                },
            )
            .unwrap();
        let state = whole.state();
        advance_to(&mut whole, 0.4);
        let mut again = Simulation::new(&waving, &parameters).unwrap();
        again.restore(state).unwrap();
        advance_to(&mut again, 0.4);
        assert_eq!(again.positions(), whole.positions());
        whole.release(1).unwrap();
        advance_to(&mut whole, 0.45);
        assert!(
            whole
                .positions()
                .iter()
                .all(|x| x.iter().all(|c| c.is_finite()))
        );
    }
}

#[test]
fn a_path_of_equilibria_takes_its_parameter_for_the_time() {
    use crate::mechanics::statics::{PathMethod, PathPlan};
    let lengthening = [
        actuation(ActuatedStrain::SecondCurvature, 6.0),
        actuation(ActuatedStrain::Length, 0.3),
    ];
    let scene = scene(lengthening.to_vec());
    let plan = PathPlan {
        from: 0.0,
        to: 0.5,
        step: 0.05,
        largest_step: 0.1,
        method: PathMethod::Natural,
        switch_branches: false,
        most_points: 100,
    };
    let mut simulation = simulation_of(&scene);
    let mut tracer = simulation.path(plan).unwrap();
    let mut points = 0;
    while simulation.next_point(&mut tracer).unwrap().is_some() {
        points += 1;
        // Without load the rod has no stress anywhere.
        assert!(simulation.energies().elastic() < 1e-12);
    }
    assert!(points > 4 && simulation.time() == 0.5);
    let expected = settled(scene);
    for (one, other) in simulation.positions().iter().zip(expected.positions()) {
        assert!((one - other).norm() < 1e-7, "{one} {other}");
    }
}

#[test]
fn corners_of_schedules_end_automatic_steps() {
    let parameters = IntegrationParameters {
        step: StepSize::Auto {
            tolerance: 1.0,
            maximum: 0.3,
        },
        ..IntegrationParameters::default()
    };
    let bending = scene(vec![actuation(ActuatedStrain::FirstCurvature, 1.0)]);
    let mut simulation = Simulation::new(&bending, &parameters).unwrap();
    let mut ends = Vec::new();
    while simulation.time() < 2.0 {
        simulation.advance(2.0).unwrap();
        ends.push(simulation.time());
    }
    assert!(ends.contains(&0.5), "{ends:?}");
}

#[test]
fn an_actuation_of_no_rod_is_refused() {
    let mut nowhere = actuation(ActuatedStrain::Twist, 1.0);
    nowhere.rod = 1;
    assert!(Simulation::new(&scene(vec![nowhere]), &IntegrationParameters::default()).is_err());
}
