//! Stretch, twist, bending and mass of rods whose section varies.

use super::{IntegrationParameters, Simulation};
use crate::mechanics::Vector3;
use crate::mechanics::scene::{
    EdgeSection, Inertia, RodDescription, Scene, Section, Stiffness, edge_sections,
};
use crate::mechanics::test_support::{assert_close, assert_close_in, clamp, line, simulation_of};

const YOUNG: f64 = 1e9;
const DENSITY: f64 = 1000.0;
const THICK: f64 = 5e-3;
const THIN: f64 = 3e-3;

/// The section of a round rod of a radius, m.
fn round(radius: f64) -> Section {
    let area = std::f64::consts::PI * radius * radius;
    Section {
        stiffness: Stiffness::circular(YOUNG, 0.5, radius),
        radius,
        mass_per_length: DENSITY * area,
        rotational_inertia_per_length: 0.5 * DENSITY * area * radius * radius,
        friction: None,
    }
}

/// A rod of 1 m along x whose radius is a function of the place.
fn rod(edges: usize, joints: &[f64], radius: impl Fn(f64) -> f64) -> RodDescription {
    let centreline = line(Vector3::zeros(), Vector3::x(), edges);
    let nodes: Vec<f64> = centreline.iter().map(|node| node.x).collect();
    let thick = round(THICK);
    let uniform = RodDescription {
        first_director: Some(Vector3::z()),
        ..RodDescription::uniform(
            "rod",
            centreline,
            thick.stiffness,
            THICK,
            thick.mass_per_length,
        )
    };
    let sections = edge_sections(&nodes, joints, &|place| round(radius(place)));
    uniform.with_sections(sections, &vec![1.0 / edges as f64; edges])
}

/// A rod that is thinner beyond a place.
fn stepped(edges: usize, step: f64) -> RodDescription {
    rod(
        edges,
        &[step],
        |place| if place < step { THICK } else { THIN },
    )
}

fn tapered(edges: usize) -> RodDescription {
    rod(edges, &[], |place| THICK + (THIN - THICK) * place)
}

/// The rod clamped at its start.
fn cantilever(rod: RodDescription) -> Simulation {
    simulation_of(&Scene {
        rods: vec![rod],
        clamps: vec![clamp(0, 0)],
        ..Scene::default()
    })
}

/// Displacement of an unknown under a unit load on it.
fn compliance(simulation: &mut Simulation, unknown: usize) -> f64 {
    let unknowns = simulation.free_unknowns();
    let place = unknowns.iter().position(|own| *own == unknown).unwrap();
    let inverse = simulation.stiffness_matrix().try_inverse().unwrap();
    inverse[(place, place)]
}

#[test]
fn means_of_a_uniform_section_are_the_section() {
    let own = EdgeSection::uniform(&round(THICK));
    for edge in edge_sections(&[0.0, 0.3, 0.4], &[0.05, 0.15], &|_| round(THICK)) {
        assert_close(edge.stretching, own.stretching, 1e-14);
        for end in 0..2 {
            assert_close(edge.bending[end][1], own.bending[end][1], 1e-14);
            assert_close(edge.twisting[end], own.twisting[end], 1e-14);
            assert_close(edge.mass_per_length[end], own.mass_per_length[end], 1e-14);
        }
        let [inertia, expected] = [edge, own].map(|one| one.rotational_inertia_per_length);
        assert_close(inertia, expected, 1e-14);
        assert_close(edge.radius, THICK, 1e-14);
        assert_eq!(edge.end_radii, [THICK; 2]);
    }
}

#[test]
fn a_stepped_cantilever_bends_with_second_order_wherever_the_step_is() {
    for step in [0.25, 0.5, 0.517, 0.6, 0.61, 0.88] {
        // ∫ (1 − s)²/EI ds over both parts.
        let [thick, thin] = [THICK, THIN].map(|radius| round(radius).stiffness.bending[0]);
        let rest: f64 = (1.0 - step) * (1.0 - step) * (1.0 - step);
        let exact = ((1.0 - rest) / thick + rest / thin) / 3.0;
        let error = |edges: usize| {
            let deflection = compliance(&mut cantilever(stepped(edges, step)), 4 * edges + 2);
            deflection / exact - 1.0
        };
        let errors = [20, 40, 80].map(error);
        println!("{step}: {errors:?}");
        // h²/12 ∫ g''/EI with g'' = 2.
        let expected = (step / thick + (1.0 - step) / thin) / 6.0 / 400.0 / exact;
        assert_close_in(step, errors[0], expected, 0.15);
        for pair in errors.windows(2) {
            assert_close_in(step, pair[0] / pair[1], 4.0, 0.1);
        }
    }
}

#[test]
fn a_tapered_cantilever_bends_with_second_order() {
    // F L³/3EI₀ · r₀/r₁ with EI₀ and r₀ at the clamp.
    let exact = THICK / THIN / (3.0 * round(THICK).stiffness.bending[0]);
    let error =
        |edges: usize| compliance(&mut cantilever(tapered(edges)), 4 * edges + 2) / exact - 1.0;
    let errors = [20, 40, 80].map(error);
    println!("{errors:?}");
    for pair in errors.windows(2) {
        assert_close(pair[0] / pair[1], 4.0, 0.05);
    }
}

#[test]
fn rods_are_stretched_and_twisted_exactly() {
    let edges = 8;
    // A cone of the radii a and b over the length l: ∫ ds/r² = l/ab, and ∫ ds/r⁴ = l (a² + ab +
    // b²)/(3 a³ b³).
    let end = THICK + (THIN - THICK) * (1.0 - 0.5 / edges as f64);
    let turned = (1.0 - 0.5 / edges as f64) * (THICK * THICK + THICK * end + end * end)
        / (3.0 * (THICK * end).powi(3));
    let unit = round(1.0).stiffness;
    let mut cone = cantilever(tapered(edges));
    let stretched = compliance(&mut cone, 4 * edges);
    assert_close(stretched, 1.0 / (THICK * THIN * unit.stretching), 1e-9);
    let twisted = compliance(&mut cone, 4 * (edges - 1) + 3);
    assert_close(twisted, turned / unit.twisting, 1e-9);
    // A step within an edge, beyond and before its middle.
    for step in [0.55, 0.7] {
        let mut rod = cantilever(stepped(edges, step));
        let [thick, thin] = [THICK, THIN].map(|radius| round(radius).stiffness);
        let exact = step / thick.stretching + (1.0 - step) / thin.stretching;
        assert_close_in(step, compliance(&mut rod, 4 * edges), exact, 1e-9);
        let exact = step / thick.twisting + (1.0 - step - 0.5 / edges as f64) / thin.twisting;
        assert_close_in(step, compliance(&mut rod, 4 * (edges - 1) + 3), exact, 1e-9);
    }
}

#[test]
fn mass_and_centre_of_mass_are_those_of_the_sections() {
    let edges = 7;
    let masses = |rod: RodDescription| -> [f64; 2] {
        let simulation = simulation_of(&Scene {
            rods: vec![rod],
            ..Scene::default()
        });
        let masses = simulation.mass_matrix();
        let places = simulation.positions();
        (simulation.free_unknowns().iter().enumerate())
            .filter(|(_, unknown)| **unknown % 4 == 0)
            .fold([0.0; 2], |[mass, moment], (row, unknown)| {
                let own = masses[(row, row)];
                [mass + own, moment + own * places[unknown / 4].x]
            })
    };
    let [thick, thin] = [THICK, THIN].map(|radius| round(radius).mass_per_length);
    let step = 0.47;
    let [mass, moment] = masses(stepped(edges, step));
    assert_close(mass, thick * step + thin * (1.0 - step), 1e-12);
    assert_close(
        moment,
        0.5 * (thick * step * step + thin * (1.0 - step * step)),
        1e-12,
    );
    // ∫ r² ds and ∫ r² s ds of a cone.
    let unit = round(1.0).mass_per_length;
    let (a, b) = (THICK, THIN);
    let [mass, moment] = masses(tapered(edges));
    assert_close(mass, unit * (a * a + a * b + b * b) / 3.0, 1e-12);
    assert_close(
        moment,
        unit * (a * a + 2.0 * a * b + 3.0 * b * b) / 12.0,
        1e-12,
    );
}

#[test]
fn radii_at_nodes_are_those_of_the_thicker_side() {
    let rod = stepped(4, 0.5);
    assert_eq!(
        [0, 1, 2, 3, 4].map(|node| rod.radius_at(node)),
        [THICK, THICK, THICK, THIN, THIN]
    );
    assert_eq!((rod.radius, rod.least_radius()), (THICK, THIN));
}

#[test]
fn sections_that_do_not_fit_are_refused() {
    let scene = |rod: RodDescription| Scene {
        rods: vec![rod],
        ..Scene::default()
    };
    let mut short = stepped(4, 0.5);
    short.sections.pop();
    let mut consistent = stepped(4, 0.5);
    consistent.inertia = Inertia::Consistent;
    for (rod, word) in [(short, "3 sections"), (consistent, "lumped")] {
        let refused = Simulation::new(&scene(rod), &IntegrationParameters::default());
        let message = refused.err().expect("refused").to_string();
        assert!(message.contains(word), "{message}");
    }
}
