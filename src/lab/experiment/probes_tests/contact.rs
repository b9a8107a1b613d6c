//! Forces of contact and friction, and the gap between surfaces at rest.

use super::{RESTING, near, ran, weight_of};

#[test]
fn a_plane_bears_the_weight_of_the_rod_that_lies_on_it() {
    let probes = r#"
        [[probes]]
        name = "floor"
        kind = "contact_force"
        from_plane = 0
        [[probes]]
        name = "all"
        kind = "contact_force"
        "#;
    let run = ran(&format!("{RESTING}{probes}"));
    let weight = weight_of(0.2);
    near(run.last("floor_z_n").unwrap(), weight, 1e-3);
    near(run.last("floor_normal_n").unwrap(), weight, 1e-3);
    assert!(run.last("floor_tangential_n").unwrap() < 1e-6 * weight);
    assert_eq!(run.last("all_z_n"), run.last("floor_z_n"));
    // Forces are undefined before the first step.
    assert_eq!(run.series.numbers("floor_z_n").unwrap()[0], None);
}

/// A pushed rod slides with μ times its weight as friction.
#[test]
fn friction_is_the_tangential_force() {
    let text = RESTING
        .replace("edges = 20", "edges = 20\nvelocity = [3.0, 0, 0]")
        .replace("translation = 1.0", "translation = 0.1");
    let run = ran(&(text.replace("end = 0.4", "end = 0.2")
        + "[[probes]]\nname = \"floor\"\nkind = \"contact_force\"\nsummary = \"mean\"\n"));
    let [normal, tangential, x] =
        ["floor_normal_n", "floor_tangential_n", "floor_x_n"].map(|name| run.last(name).unwrap());
    near(tangential, 0.3 * normal, 1e-2);
    near(x, -tangential, 1e-6);
    let mean = run.summary.numbers("floor_normal_mean_n").unwrap()[0];
    let values: Vec<f64> = (run.series.numbers("floor_normal_n").unwrap())
        .into_iter()
        .flatten()
        .collect();
    near(
        mean.unwrap(),
        values.iter().sum::<f64>() / values.len() as f64,
        1e-12,
    );
}

#[test]
fn rods_press_on_each_other_with_opposite_forces() {
    let text = RESTING.replace("[[planes]]\n", "").replace(
        "[[loads]]\nkind = \"drag\"",
        r#"[[rods]]
name = "post"
held = true
radius = 0.004
edges = 5
shape = { kind = "straight", start = [0.1, -0.05, -0.004], end = [0.1, 0.05, -0.004] }
[[clamps]]
rod = "rod"
at = "start"
[[loads]]
kind = "drag""#,
    );
    let probe = |name: &str, rod: &str, from: &str| {
        format!(
            "[[probes]]\nname = \"{name}\"\nkind = \"contact_force\"\nrod = \"{rod}\"\nfrom_rod = \"{from}\"\n"
        )
    };
    let run = ran(&(text
        + &probe("up", "rod", "post")
        + &probe("down", "post", "rod")
        + &probe("own", "rod", "rod")));
    let (up, down) = (run.vector("up", "n"), run.vector("down", "n"));
    assert!(up.z > 0.1 * weight_of(0.2));
    assert!((up + down).norm() < 1e-12 * up.norm());
    assert_eq!(run.last("up_normal_n"), run.last("down_normal_n"));
    // Friction is μ times the pressure at most.
    let [along, across] = ["up_tangential_n", "up_normal_n"].map(|name| run.last(name).unwrap());
    assert!(along <= 0.3 * across, "{along} {across}");
    assert_eq!(run.last("own_normal_n"), Some(0.0));
}

/// A light rod lies on a plane and presses on it with its weight, N per node. The contact
/// stiffness follows from its EI/L².
#[test]
fn contact_gap_is_that_of_the_force_law() {
    let (tolerance, radius) = (1e-4_f64, 0.004_f64);
    let bending = 1e7 * std::f64::consts::PI / 4.0 * radius.powi(4);
    let load = weight_of(0.2) / 20.0 / (bending / 0.04);
    // The default stiffness factor is 1e8 radii.
    let penalty = (2e8 * radius * tolerance / (15.0 * radius * radius * load)).ln() / 30.0;
    let relative = |w: f64| w * (w + 2.0 * w.ln_1p()) / (1.0 + w) / (0.5 + 2f64.ln());
    let nearness = (1..)
        .map(|k| 1e-4 * f64::from(k))
        .find(|&w| relative(w) > load);
    let barrier = 1.0 / (1.0 + nearness.unwrap());
    for (model, expected, allowed) in [
        ("imc", penalty, 0.01),
        ("ipc", barrier, 0.01),
        // Forces are accurate to a hundredth of Newton's tolerance, 1e-4 radii.
        ("complementarity", 0.0, 1e-6 * radius / tolerance),
    ] {
        let text = RESTING.replace("\"imc\"", &format!("{model:?}"));
        let gap = ran(&text).summary.numbers("mean_gap_m").unwrap()[0].unwrap();
        assert!(
            (gap / tolerance - expected).abs() < allowed,
            "{model}: {gap:e} instead of {expected} δ"
        );
    }
}

#[test]
fn without_contact_there_is_no_mean_gap() {
    let hovering = RESTING.replace("[0, 0, -9.81]", "[0, 0, 0.01]");
    let run = ran(&hovering);
    assert_eq!(run.summary.numbers("mean_gap_m").unwrap()[0], None);
}
