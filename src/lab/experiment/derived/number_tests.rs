//! Numbers derived from small scenes, against closed forms.

use super::{DerivedNumbers, derived_numbers};
use crate::test_support::prepared;

fn derived(rest: &str) -> DerivedNumbers {
    let text = format!(
        r#"
        experiment = "scene"
        material = {{ youngs_modulus = "10 MPa", poissons_ratio = 0.5, density = 1000.0 }}
        time = {{ step = "1 ms", end = "0.5 s" }}
        [[rods]]
        name = "rod"
        radius = "5 mm"
        edges = 20
        shape = {{ kind = "straight", start = [0, 0, 1], end = [0.4, 0, 1] }}
        {rest}
        "#
    );
    let run = prepared("derived", &text).unwrap_or_else(|error| panic!("{error}"));
    derived_numbers(&run)
}

#[test]
fn obstacles_are_as_large_as_they_are_described() {
    for (shape, extents) in [
        (
            r#"kind = "sphere", centre = [0, 0, 0], radius = 0.05"#,
            [0.1; 3],
        ),
        (
            r#"kind = "capsule", start = [0, 0, 0], end = [0.3, 0, 0], radius = 0.05"#,
            [0.4, 0.1, 0.1],
        ),
        (
            r#"kind = "box", centre = [0, 0, 0], size = [0.2, 0.3, 0.4], rounding = 0.02"#,
            [0.2, 0.3, 0.4],
        ),
    ] {
        let numbers = derived(&format!(
            "[contact]\nfriction = 0.3\n[[obstacles]]\nname = \"body\"\nshape = {{ {shape} }}\n"
        ));
        for (found, expected) in numbers.obstacles[0].extents.iter().zip(extents) {
            assert!((found - expected).abs() < 1e-12, "{shape}: {found}");
        }
    }
}

#[test]
fn a_contact_creeps_at_the_speed_at_which_it_bears_nine_tenths() {
    let numbers = derived("[contact]\nfriction = 0.3\nslip_tolerance = \"1 mm/s\"\n");
    let creep = numbers.creep.unwrap();
    // Thesis Eq. 2.10: 2/(1 + e^(−15 v/ν)) − 1.
    let borne = 2.0 / (1.0 + (-15.0 * creep.speed / 1e-3).exp()) - 1.0;
    assert!((borne - 0.9).abs() < 1e-12, "{borne}");
    assert!((creep.way - 0.5 * creep.speed).abs() < 1e-18);
    assert!((creep.way_in_radii * 5e-3 / creep.way - 1.0).abs() < 1e-12);
}

#[test]
fn a_driven_node_moves_by_half_a_radius_in_an_advised_step() {
    let numbers = derived(
        r#"
        [[clamps]]
        rod = "rod"
        at = "start"
        move = [[0, [0, 0, 0]], [0.5, [30, 0, 40]]]
        "#,
    );
    let step = numbers.advised_step.unwrap();
    assert!((100.0 * step - 0.5 * 5e-3).abs() < 1e-12, "{step}");
}
