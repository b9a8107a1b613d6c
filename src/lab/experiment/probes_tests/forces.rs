//! Forces and moments of rods and clamps in equilibrium.

use super::{CANTILEVER, cantilever, near, ran, weight_of};
use rodlab_engine::mechanics::Vector3;
use rodlab_files::results::read_nodes;

#[test]
fn the_reaction_of_a_cantilever_balances_its_weight_and_the_moment_of_it() {
    let run = cantilever(
        r#"
        [[probes]]
        name = "root"
        kind = "reaction"
        at = "start"
        summary = "last"
        [[probes]]
        name = "bending"
        kind = "bending_moment"
        at = "start"
        [[probes]]
        name = "largest"
        kind = "bending_moment"
        [[probes]]
        name = "free"
        kind = "bending_moment"
        at = "end"
        "#,
    );
    let length = 0.1_f64.sqrt();
    let force = run.vector("root_force", "n");
    near(force.z, weight_of(length), 1e-6);
    assert!(force.xy().norm() < 1e-6 * force.z);
    // The clamp bears the moments of all nodes about its own node.
    let nodes = read_nodes(run.directory.path(), 41).unwrap();
    let positions = &nodes[0].positions;
    let mut expected = Vector3::zeros();
    for (k, position) in positions.iter().enumerate() {
        let part = if k == 0 || k == 40 { 0.5 } else { 1.0 };
        let load = Vector3::z() * (-part * weight_of(length / 40.0));
        expected -= (position - positions[0]).cross(&load);
    }
    let moment = run.vector("root_moment", "n_m");
    assert!((moment - expected).norm() < 1e-6 * expected.norm());
    // Moment and strain of the discrete rod differ by a quarter of the square of the turning
    // angle.
    near(run.last("bending_n_m").unwrap(), expected.norm(), 2e-3);
    assert_eq!(run.last("largest_n_m"), run.last("bending_n_m"));
    assert_eq!(run.last("free_n_m"), None);
    assert_eq!(
        run.summary.numbers("root_force_z_last_n").unwrap(),
        [Some(force.z)]
    );
    assert!(run.summary.numbers("bending_last_n_m").is_none());
    let highlights = &run.outcome.highlights;
    assert_eq!(highlights.len(), 6);
    assert_eq!(highlights[2].0, "root_force_z_last_n");
}

/// An edge with both ends held, and a held inner node, bear the rest of the weight.
#[test]
fn the_reactions_of_several_clamps_add_up_to_the_weight() {
    let text = CANTILEVER.replace("at = \"start\"", "at = 12")
        + "[[clamps]]\nrod = \"beam\"\nat = 13\nhold = \"position\"\n"
        + "[[clamps]]\nrod = \"beam\"\nat = \"end\"\n";
    let mut probes = String::new();
    for (name, at) in [("a", "12"), ("b", "13"), ("c", "\"end\"")] {
        probes += &format!("[[probes]]\nname = \"{name}\"\nkind = \"reaction\"\nat = {at}\n");
    }
    let run = ran(&(text + &probes));
    let [a, b, c] = ["a", "b", "c"].map(|name| run.vector(&format!("{name}_force"), "n"));
    near((a + b + c).z, weight_of(0.1_f64.sqrt()), 1e-6);
    assert!((a + b + c).xy().norm() < 1e-6);
    // Balance of moments about the origin.
    let nodes = read_nodes(run.directory.path(), 41).unwrap();
    let positions = &nodes[0].positions;
    let moments = ["a", "b", "c"].map(|name| run.vector(&format!("{name}_moment"), "n_m"));
    let mut sum: Vector3 = moments.iter().sum();
    sum += positions[12].cross(&a) + positions[13].cross(&b) + positions[40].cross(&c);
    let size = moments.iter().map(|moment| moment.norm()).sum::<f64>();
    for (k, position) in positions.iter().enumerate() {
        let part = if k == 0 || k == 40 { 0.5 } else { 1.0 };
        let load = Vector3::z() * (-part * weight_of(0.1_f64.sqrt() / 40.0));
        sum += position.cross(&load);
    }
    assert!(sum.norm() < 1e-6 * size, "{sum:?} of {size}");
}

#[test]
fn a_hanging_rod_bears_the_weight_below_and_grows_longer() {
    let text = CANTILEVER.replace("end = [0.3, 0.1, 0]", "end = [0, 0, -0.4]");
    let run = ran(&(text
        + r#"
        [[probes]]
        name = "top"
        kind = "tension"
        at = "start"
        [[probes]]
        name = "most"
        kind = "tension"
        [[probes]]
        name = "length"
        kind = "arc_length"
        [[probes]]
        name = "ends"
        kind = "distance"
        at = "start"
        to = "end"
        [[probes]]
        name = "tip"
        kind = "displacement"
        at = "end"
        "#));
    // Half of the weight of an edge is carried directly by the clamp.
    near(
        run.last("top_n").unwrap(),
        weight_of(0.4) * (1.0 - 1.0 / 80.0),
        1e-6,
    );
    assert_eq!(run.last("most_n"), run.last("top_n"));
    let stiffness = 1e7 * std::f64::consts::PI * 0.004_f64.powi(2);
    let growth = 0.5 * weight_of(0.4) * 0.4 / stiffness;
    near(run.last("length_m").unwrap() - 0.4, growth, 1e-5);
    near(run.last("ends_m").unwrap(), 0.4 + growth, 1e-9);
    near(run.last("tip_z_m").unwrap(), -growth, 1e-5);
}

#[test]
fn springs_bear_the_weight_of_what_hangs_from_them() {
    let run = ran(r#"
        experiment = "scene"
        material = { youngs_modulus = 1e7, poissons_ratio = 0.5, density = 1000.0 }
        time = { mode = "static" }
        [[rods]]
        name = "beam"
        radius = 0.004
        held = true
        edges = 1
        shape = { kind = "straight", start = [0, 0, 0.1], end = [0.2, 0, 0.1] }
        [[rods]]
        name = "rod"
        radius = 0.004
        edges = 20
        shape = { kind = "straight", start = [0, 0, 0], end = [0.2, 0, 0] }
        [[joints]]
        name = "left"
        kind = "spring"
        rods = ["beam", "rod"]
        at = ["start", "start"]
        stiffness = 10
        [[joints]]
        name = "right"
        kind = "spring"
        rods = ["rod", "beam"]
        at = ["end", "end"]
        stiffness = 20
        [[loads]]
        kind = "gravity"
        acceleration = [0, 0, -9.81]
        [[probes]]
        name = "left"
        kind = "spring_force"
        joint = "left"
        [[probes]]
        name = "right"
        kind = "spring_force"
        joint = "right"
        summary = "max"
        "#);
    let half = 0.5 * weight_of(0.2);
    // The springs tilt a little, since the rod hangs askew and sags.
    for column in ["left_n", "right_n"] {
        near(run.last(column).unwrap(), half, 2e-2);
    }
    assert_eq!(
        run.summary.numbers("right_max_n").unwrap(),
        [run.last("right_n")]
    );
}
