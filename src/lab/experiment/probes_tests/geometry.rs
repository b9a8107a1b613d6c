//! Curvature, torsion, twist, linking and distances of known curves.

use super::{near, ran};

#[test]
fn curvature_torsion_and_twist_of_known_curves() {
    let bodies = r#"
        experiment = "scene"
        material = { youngs_modulus = 1e7, poissons_ratio = 0.5, density = 1000.0 }
        time = { mode = "static" }
        [[rods]]
        name = "arc"
        radius = 0.001
        edges = 60
        twist = 1.5
        shape = { kind = "arc", start = [0.5, 0, 0], tangent = [0, 1, 0], normal = [0, 0, 1], radius = 0.5, angle = 2.0 }
        [[rods]]
        name = "helix"
        radius = 0.001
        edges = 200
        shape = { kind = "helix", centre = [0, 0, 0], radius = 0.1, pitch = 0.2, turns = 2 }
        [[clamps]]
        rod = "arc"
        at = "start"
        [[clamps]]
        rod = "helix"
        at = "start"
        [[probes]]
        name = "bend"
        kind = "curvature"
        rod = "arc"
        at = 30
        [[probes]]
        name = "screw"
        kind = "torsion"
        rod = "helix"
        at = 100
        [[probes]]
        name = "helix"
        kind = "curvature"
        rod = "helix"
        at = 100
        [[probes]]
        name = "turn"
        kind = "twist"
        rod = "arc"
        at = 30
        [[probes]]
        name = "moment"
        kind = "twisting_moment"
        rod = "arc"
        [[probes]]
        name = "flat"
        kind = "torsion"
        rod = "arc"
        at = "start"
        "#;
    let run = ran(bodies);
    near(run.last("bend_per_m").unwrap(), 2.0, 1e-3);
    let pitch = 0.2 / std::f64::consts::TAU;
    let square = 0.1_f64.powi(2) + pitch * pitch;
    near(run.last("screw_per_m").unwrap(), pitch / square, 1e-3);
    near(run.last("helix_per_m").unwrap(), 0.1 / square, 1e-3);
    // Placed with this twist, which is free of stress.
    near(run.last("turn_rad_per_m").unwrap(), 1.5, 0.02);
    assert!(run.last("moment_n_m").unwrap().abs() < 1e-12);
    assert_eq!(run.last("flat_per_m"), None);
}

#[test]
fn linked_rings_are_linked_once_and_keep_their_distance() {
    let run = ran(r#"
        experiment = "scene"
        material = { youngs_modulus = 1e7, poissons_ratio = 0.5, density = 1000.0 }
        time = { step = 1e-3, end = 0.01 }
        [[rods]]
        name = "one"
        radius = 0.01
        edges = 40
        shape = { kind = "ring", centre = [0, 0, 0], radius = 1 }
        [[rods]]
        name = "two"
        radius = 0.01
        edges = 40
        velocity = [0.5, 0, 0]
        shape = { kind = "ring", centre = [1, 0, 0], radius = 1, normal = [0, 1, 0] }
        [[probes]]
        name = "link"
        kind = "linking_number"
        rod = "one"
        to_rod = "two"
        [[probes]]
        name = "gap"
        kind = "distance"
        rod = "one"
        to_rod = "two"
        summary = "min"
        [[probes]]
        name = "writhe"
        kind = "writhe"
        rod = "one"
        [[probes]]
        name = "first"
        kind = "energy"
        rod = "one"
        [[probes]]
        name = "second"
        kind = "energy"
        rod = "two"
        [[probes]]
        name = "node"
        kind = "velocity"
        rod = "two"
        at = 3
        "#);
    near(run.last("link").unwrap().abs(), 1.0, 1e-12);
    assert!(run.last("writhe").unwrap().abs() < 1e-9);
    // The second ring moves towards the rim of the first, and passes near its centre.
    let gaps = run.series.numbers("gap_m").unwrap();
    near(gaps[0].unwrap(), 1.0, 1e-2);
    let least = run.summary.numbers("gap_min_m").unwrap()[0];
    assert_eq!(least, run.last("gap_m"));
    assert!(least < gaps[0].map(|gap| gap - 4e-3));
    for energy in ["kinetic", "stretching", "bending", "twisting"] {
        let of = |name: &str| run.last(&format!("{name}_{energy}_j")).unwrap();
        let total = run.last(&format!("{energy}_energy_j")).unwrap();
        assert!((of("first") + of("second") - total).abs() <= 1e-12 * total.abs() + 1e-15);
    }
    assert!(run.last("first_kinetic_j").unwrap() < 1e-9);
    near(run.last("node_x_m_per_s").unwrap(), 0.5, 1e-6);
}
