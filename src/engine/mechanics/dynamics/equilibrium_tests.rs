//! Equilibria with closed forms.

use crate::mechanics::Vector3;
use crate::mechanics::contact::ContactParameters;
use crate::mechanics::scene::{Load, LoadKind, Plane, RodDescription, Scene};
use crate::mechanics::test_support::{
    SOFT_MODELS, assert_close, clamp, contact, gravity, moment_on, point_force, section,
    simulation_of, steady,
};
use std::cell::Cell;
use std::f64::consts::PI;

const EDGES: usize = 60;
const RADIUS: f64 = 5e-3;

/// A rod of 1 m along x with unit bending stiffness.
fn rod() -> RodDescription {
    let centreline = (0..=EDGES)
        .map(|k| k as f64 / EDGES as f64 * Vector3::x())
        .collect();
    let stiffness = section(4.0 / (RADIUS * RADIUS), [1.0; 2], 2.0 / 3.0);
    RodDescription {
        first_director: Some(Vector3::z()),
        ..RodDescription::uniform("rod", centreline, stiffness, RADIUS, 1.0)
    }
}

fn cantilever(load: Load) -> Scene {
    Scene {
        rods: vec![rod()],
        clamps: vec![clamp(0, 0)],
        loads: vec![load],
        ..Scene::default()
    }
}

#[test]
fn a_heavy_cantilever_comes_to_rest_in_a_few_iterations() {
    for weight in [1.0, 15.0, 100.0, 1000.0] {
        let mut simulation = simulation_of(&cantilever(gravity(weight)));
        let report = simulation.find_equilibrium().unwrap();
        println!("{weight}: {}", report.newton_iterations);
        assert!(report.newton_iterations <= 20);
        assert!((simulation.reaction(0).z / weight - 1.0).abs() < 1e-6);
    }
}

#[test]
fn an_end_moment_rolls_the_rod_up() {
    // A moment of fixed direction has no potential; this one winds the rod nearly a whole turn.
    let moment = 6.0;
    let mut simulation =
        simulation_of(&cantilever(moment_on(0, EDGES - 1, -moment * Vector3::y())));
    let report = simulation.find_equilibrium().unwrap();
    println!("{}", report.newton_iterations);
    // The vertex energy ½ EI (2 tan φ/2)²/l determines its turning angle φ; the vertex at the
    // clamp has half the length.
    let length = 1.0 / EDGES as f64;
    let turn = |product: f64| {
        let tangent = (0..100).fold(0.0f64, |t, _| 0.5 * product / (1.0 + t * t));
        2.0 * tangent.atan()
    };
    let (mut angle, mut exact) = (turn(0.5 * moment * length), Vector3::zeros());
    for x in simulation.positions() {
        assert!((x - exact).norm() < 1e-5, "{x} {exact}");
        exact += length * Vector3::new(angle.cos(), 0.0, angle.sin());
        angle += turn(moment * length);
    }
}

#[test]
fn a_strip_turned_at_its_end_about_any_axis_comes_to_rest() {
    // A regression: steps cut short for their length were rejected, and so was every step with a
    // shifted matrix.
    let (mut found, mut count) = (Vec::new(), 0);
    for edges in [20, 50, 60] {
        for moment in [[0.8, 0.0, 0.0], [0.0, 0.0, 0.3], [0.8, -0.5, 0.3]] {
            let nodes = (0..=edges).map(|k| k as f64 / edges as f64 * Vector3::x());
            let strip = RodDescription {
                centreline: nodes.collect(),
                first_director: Some(Vector3::new(0.0, 0.8, 0.6)),
                stiffness: section(7.5e5, [1.0, 9.0], 1.05),
                ..rod()
            };
            let wind = LoadKind::Distributed {
                rod: None,
                force_per_length: Vector3::new(1.6, -4.7, 3.1),
            };
            let turned = LoadKind::Moment {
                rod: 0,
                edge: edges - 1,
                moment: moment.into(),
            };
            let scene = Scene {
                rods: vec![strip],
                loads: vec![steady(wind), steady(turned)],
                ..cantilever(gravity(0.0))
            };
            let result = simulation_of(&scene).find_equilibrium();
            found.extend(result.map(|report| report.newton_iterations));
            count += 1;
        }
    }
    println!("{found:?}");
    assert_eq!(
        found.len(),
        count,
        "iterations of those that were found: {found:?}"
    );
}

#[test]
fn a_straight_column_leaves_its_unstable_equilibrium_and_bends_over() {
    for (load, rests) in [(0.9, true), (1.1, false), (2.0, false)] {
        let mut scene = cantilever(point_force(0, EDGES, -load * 0.25 * PI * PI * Vector3::x()));
        // The section is soft in one plane, which determines the direction.
        scene.rods[0].stiffness.bending = [1.0, 20.0];
        let mut simulation = simulation_of(&scene);
        let report = simulation.find_equilibrium().unwrap();
        println!("{load}: {}", report.newton_iterations);
        let tip = simulation.positions()[EDGES];
        assert_eq!(tip.yz().norm() < 1e-9, rests, "{load}: {tip}");
        assert_eq!(simulation.find_nearby_equilibrium().unwrap(), 0);
    }
}

/// Linear in the load, and zero at Euler's load of the column, π²/4 EI/L².
#[test]
fn the_stiffness_of_a_column_passes_through_zero_at_its_buckling_load() {
    let stiffness = |load: f64| {
        let mut scene = cantilever(point_force(0, EDGES, -load * 0.25 * PI * PI * Vector3::x()));
        scene.rods[0].stiffness.bending = [1.0, 20.0];
        simulation_of(&scene).find_nearby_stiffness().unwrap()
    };
    let loads = [0.97, 1.03];
    let [stable, unstable] = loads.map(stiffness);
    assert!(stable > 0.0 && unstable < 0.0, "{stable} {unstable}");
    let buckling = loads[0] + (loads[1] - loads[0]) * stable / (stable - unstable);
    assert!((buckling - 1.0).abs() < 2e-3, "{buckling}");
}

#[test]
fn a_plane_or_a_post_supports_a_resting_rod() {
    let post = RodDescription {
        name: "post".into(),
        centreline: vec![
            Vector3::new(0.8, -0.1, -0.05),
            Vector3::new(0.8, 0.1, -0.05),
        ],
        held: true,
        ..rod()
    };
    let plane = Plane {
        point: Vector3::new(0.0, 0.0, -0.05),
        normal: Vector3::z(),
        friction: None,
        directed_friction: None,
    };
    for model in SOFT_MODELS {
        for on_plane in [true, false] {
            let mut scene = cantilever(gravity(20.0));
            scene.contact = Some(ContactParameters {
                friction: 0.0,
                ..contact(model, 0.02 * RADIUS)
            });
            if on_plane {
                scene.planes.push(plane.clone());
            } else {
                scene.rods.push(post.clone());
            }
            let mut simulation = simulation_of(&scene);
            let report = simulation.find_equilibrium().unwrap();
            println!(
                "{model:?} {on_plane}: {} {:?}",
                report.newton_iterations, report.nearest
            );
            assert!(report.contacts > 0);
            let lowest = |z: f64, x: &Vector3| z.min(x.z);
            let rod = &simulation.positions()[..=EDGES];
            if on_plane {
                let gap = rod.iter().fold(f64::INFINITY, lowest) + 0.05 - RADIUS;
                assert!(gap.abs() < 0.05 * RADIUS, "{gap}");
            } else {
                let ratio = report.nearest.unwrap().ratio();
                assert!((ratio - 1.0).abs() < 0.05, "{ratio}");
            }
            let contacts: f64 = simulation.contact_forces()[..=EDGES]
                .iter()
                .map(|f| f.z)
                .sum();
            let reaction = simulation.reaction(0).z;
            assert_close(contacts + reaction, 20.0, 1e-5);
        }
    }
}

#[test]
fn a_search_that_is_stopped_leaves_the_rods_where_they_were() {
    let mut simulation = simulation_of(&cantilever(gravity(15.0)));
    let before = simulation.positions().to_vec();
    let asked = Cell::new(0);
    let goes_on = || asked.replace(asked.get() + 1) < 5;
    assert!(
        simulation
            .find_equilibrium_while(&goes_on)
            .unwrap()
            .is_none()
    );
    assert_eq!(simulation.positions(), before);
    let mut untouched = simulation_of(&cantilever(gravity(15.0)));
    simulation.find_equilibrium().unwrap();
    untouched.find_equilibrium().unwrap();
    assert_eq!(simulation.positions(), untouched.positions());
}
