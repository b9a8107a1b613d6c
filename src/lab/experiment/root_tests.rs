//! Rods whose clamped ends overlap or touch something: a floor, a scalp, a tube wall, each other.

use crate::test_support::{advance_to, simulation};
use std::f64::consts::PI;

/// A stalk of 10 MPa, 20 cm long and 3 mm thick, clamped upright at the origin and pushed sideways
/// at its tip by 0.1 mN.
fn stalk(body: &str, model: &str) -> String {
    format!(
        r#"
        experiment = "scene"
        material = {{ youngs_modulus = "10 MPa", poissons_ratio = 0.5, density = 1000.0 }}
        time = {{ step = "10 ms", end = "6 s" }}
        contact = {{ model = "{model}", friction = 0.3 }}
        [[rods]]
        name = "stalk"
        radius = "3 mm"
        edges = 40
        shape = {{ kind = "straight", start = [0, 0, 0], end = [0, 0, 0.2] }}
        [[clamps]]
        rod = "stalk"
        at = "start"
        [[loads]]
        kind = "force"
        rod = "stalk"
        at = "end"
        force = ["0.1 mN", 0, 0]
        [[loads]]
        kind = "drag"
        translation = 0.1
        {body}
        "#
    )
}

const FLOOR: &str = "[[planes]]\npoint = [0, 0, 0]\n";
const SCALP: &str = r#"
    [[obstacles]]
    name = "scalp"
    shape = { kind = "sphere", centre = [0, 0, "-50 mm"], radius = "50 mm" }
"#;
const POST: &str = r#"
    [[rods]]
    name = "post"
    radius = "8 mm"
    edges = 4
    held = true
    shape = { kind = "straight", start = [-0.1, 0, "-7 mm"], end = [0.1, 0, "-7 mm"] }
"#;
const WALL: &str = r#"
    [[obstacles]]
    name = "wall"
    shape = { kind = "tube", start = [0, -1, 0.299], end = [0, 1, 0.299], radius = 0.3 }
"#;

#[test]
fn a_stalk_set_in_a_body_bends_as_a_cantilever_and_bears_nothing() {
    let stiffness = 1e7 * PI / 4.0 * 0.003_f64.powi(4);
    let expected = 1e-4 * 0.2_f64.powi(3) / (3.0 * stiffness);
    for (body, named, model) in [
        (FLOOR, "plane 0", "imc"),
        (SCALP, "obstacle `scalp`", "imc"),
        (SCALP, "obstacle `scalp`", "ipc"),
        (FLOOR, "plane 0", "complementarity"),
        (POST, "rod `post`", "imc"),
        (WALL, "obstacle `wall`", "imc"),
    ] {
        let mut simulation = simulation("roots", &stalk(body, model)).unwrap();
        let notes = simulation.remarks();
        assert_eq!(notes.len(), 1, "{notes:?}");
        assert!(
            notes[0].contains(named) && notes[0].contains("`stalk`"),
            "{notes:?}"
        );
        advance_to(&mut simulation, 6.0);
        let tip = simulation.positions()[40].x;
        assert!(
            (tip / expected - 1.0).abs() < 5e-3,
            "{named}, {model}: {tip} of {expected}"
        );
        let forces = simulation.contact_forces();
        assert!(
            forces.iter().all(|force| force.norm() == 0.0),
            "{named}, {model}"
        );
    }
}

#[test]
fn what_lies_farther_than_a_root_reaches_is_refused_and_touches() {
    // The stalk lies in the floor along its whole length.
    let flat = stalk(FLOOR, "imc").replace("end = [0, 0, 0.2]", "end = [0.2, 0, 0]");
    let error = simulation("roots", &flat).err().unwrap();
    assert!(error.contains("interpenetrate"), "{error}");
    // A clamp that moves relative to the floor is not set in it.
    let moving = stalk(FLOOR, "imc").replace(
        "at = \"start\"",
        "at = \"start\"\nmove = [[0, [0, 0, 0]], [1, [0.1, 0, 0]]]",
    );
    assert!(simulation("roots", &moving).is_err());
    // When pushed over, the stalk lies on the floor beyond its root, not in it.
    let bent = stalk(FLOOR, "imc").replace("[\"0.1 mN\", 0, 0]", "[\"30 mN\", 0, \"-150 mN\"]");
    let mut simulation = simulation("roots", &bent).unwrap();
    advance_to(&mut simulation, 3.0);
    let lowest = simulation.positions()[3..].iter().map(|x| x.z);
    let lowest = lowest.fold(f64::INFINITY, f64::min);
    assert!(lowest > 0.95 * 0.003, "{lowest}");
    assert!(
        simulation
            .plane_contacts()
            .iter()
            .any(|touch| touch.normal_force > 0.0)
    );
}

/// Two rods of 10 MPa side by side, both clamped at their starts.
fn chuck(model: &str, apart: &str) -> String {
    format!(
        r#"
        experiment = "scene"
        material = {{ youngs_modulus = "10 MPa", poissons_ratio = 0.5, density = 1000.0 }}
        time = {{ step = "5 ms", end = "4 s" }}
        contact = {{ model = "{model}" }}
        [[rods]]
        name = "a"
        radius = "3 mm"
        edges = 20
        shape = {{ kind = "straight", start = [0, 0, 0], end = [0.2, 0, 0] }}
        [[rods]]
        name = "b"
        radius = "3 mm"
        edges = 20
        shape = {{ kind = "straight", start = [0, "{apart}", 0], end = [0.2, "{apart}", 0] }}
        [[clamps]]
        rod = "a"
        at = "start"
        [[clamps]]
        rod = "b"
        at = "start"
        [[loads]]
        kind = "drag"
        translation = 0.05
        "#
    )
}

#[test]
fn held_nodes_that_touch_bear_no_force() {
    for (model, apart) in [
        ("imc", "6 mm"),
        ("ipc", "6.001 mm"),
        ("complementarity", "6 mm"),
    ] {
        let mut simulation = simulation("roots", &chuck(model, apart)).unwrap();
        advance_to(&mut simulation, 4.0);
        let forces = simulation.contact_forces();
        let largest = forces.iter().map(|force| force.norm()).fold(0.0, f64::max);
        // The force that keeps the second nodes apart by less than δ = 30 µm is at most 3 EI δ/(2
        // h³), with the edges h = 10 mm.
        let stiffness = 1e7 * PI / 4.0 * 0.003_f64.powi(4);
        let bound = 1.5 * stiffness * 3e-5 / 1e-6;
        assert!(largest < bound, "{model}: {largest} of {bound}");
        // The held nodes themselves carry none of it.
        assert!(forces[0].norm() < 1e-3 * bound, "{model}: {}", forces[0]);
        let reaction = simulation.reaction(0).norm();
        assert!(reaction < 2.0 * bound, "{model}: {reaction}");
    }
}

/// Two hairs from one point, 19 degrees apart.
fn tuft(clamps: &str) -> String {
    format!(
        r#"
        experiment = "scene"
        material = {{ youngs_modulus = "3 GPa", poissons_ratio = 0.4, density = 1300.0 }}
        time = {{ step = "2 ms", end = "0.2 s" }}
        contact = {{ friction = 0.3 }}
        [[rods]]
        name = "a"
        radius = "40 um"
        edges = 40
        shape = {{ kind = "straight", start = [0, 0, 0], end = [0.04, 0, 0.04] }}
        [[rods]]
        name = "b"
        radius = "40 um"
        edges = 40
        shape = {{ kind = "straight", start = [0, 0, 0], end = [0.04, 0.014, 0.04] }}
        [[loads]]
        kind = "gravity"
        acceleration = [0, 0, -9.81]
        {clamps}
        "#
    )
}

#[test]
fn hairs_from_one_root_are_held_alike_by_clamps_and_by_a_rigid_joint() {
    let two = "[[clamps]]\nrod = \"a\"\nat = \"start\"\n[[clamps]]\nrod = \"b\"\nat = \"start\"\n";
    let rigid = "[[clamps]]\nrod = \"a\"\nat = \"start\"\n[[joints]]\nkind = \"rigid\"\n\
                 rods = [\"a\", \"b\"]\nat = [\"start\", \"start\"]\n";
    let mut tips = Vec::new();
    for clamps in [two, rigid] {
        let mut simulation = simulation("roots", &tuft(clamps)).unwrap();
        let remarks = simulation.remarks();
        assert_eq!(remarks.len(), usize::from(clamps == two), "{remarks:?}");
        advance_to(&mut simulation, 0.2);
        tips.push([40, 81].map(|node| simulation.positions()[node]));
        // The first edges keep their directions: the root does not rotate.
        for (node, end) in [(1, [0.04, 0.0, 0.04]), (42, [0.04, 0.014, 0.04])] {
            let along = simulation.positions()[node] - simulation.positions()[node - 1];
            let placed = rodlab_engine::mechanics::Vector3::from(end).normalize();
            assert!(along.normalize().dot(&placed) > 0.999, "{clamps}");
        }
    }
    for rod in 0..2 {
        let apart = (tips[0][rod] - tips[1][rod]).norm();
        assert!(apart < 3e-4, "{apart} m");
    }
    let both = format!(
        "{two}[[joints]]\nkind = \"ball\"\nrods = [\"a\", \"b\"]\nat = [\"start\", \"start\"]\n"
    );
    let error = simulation("roots", &tuft(&both)).err().unwrap();
    assert!(error.contains("hold = \"frame\""), "{error}");
}
