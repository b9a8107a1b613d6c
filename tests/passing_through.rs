//! Rods do not pass through each other: scenes in which they once did, with exit code 0, and
//! invariants that detect it.

use crate::linking_number::linking_number;
use rodlab::experiment;
use rodlab::mechanics::Vector3;
use rodlab::mechanics::dynamics::{Simulation, SimulationError};
use std::path::Path;

struct Running {
    simulation: Simulation,
    end: f64,
    rods: Vec<std::ops::Range<usize>>,
    steps: usize,
    retries: usize,
    iterations: usize,
}

impl Running {
    fn new(text: &str) -> Self {
        let loaded = experiment::from_text("scene", text, Path::new(""), &[]).unwrap();
        let prepared = experiment::prepare(&loaded.scenario).unwrap();
        let mut first = 0;
        let rods = prepared.scene.rods.iter().map(|rod| {
            let range = first..first + rod.centreline.len();
            first = range.end;
            range
        });
        let rods = rods.collect();
        // `end` is the last key of every scene here.
        let end = text.rsplit("end = ").next().unwrap();
        Self {
            end: end.trim().parse().unwrap(),
            simulation: Simulation::new(&prepared.scene, &prepared.integration).unwrap(),
            rods,
            steps: 0,
            retries: 0,
            iterations: 0,
        }
    }

    /// Runs to the end; `check` is called after every step.
    fn run(&mut self, check: impl Fn(&Self)) -> Result<(), SimulationError> {
        while self.simulation.time() < self.end {
            let report = self.simulation.advance(self.end)?;
            self.steps += 1;
            self.retries += report.retries;
            self.iterations += report.newton_iterations;
            check(self);
        }
        Ok(())
    }

    fn rod(&self, rod: usize) -> &[Vector3] {
        &self.simulation.positions()[self.rods[rod].clone()]
    }

    /// Height of a rod where it crosses the plane x = 0 or y = 0 (axis 0 or 1).
    fn height_over_axis(&self, rod: usize, axis: usize) -> f64 {
        let nodes = self.rod(rod);
        let edge = nodes
            .windows(2)
            .find(|edge| edge[0][axis] <= 0.0 && edge[1][axis] >= 0.0)
            .expect("the rod crosses the axis");
        let part = edge[0][axis] / (edge[0][axis] - edge[1][axis]);
        edge[0].z + part * (edge[1].z - edge[0].z)
    }
}

fn two_crossing_rods(model: &str, time: &str, speed: f64) -> String {
    format!(
        r#"experiment = "scene"
title = "A rod is shot across a held one"
[material]
youngs_modulus = "1 MPa"
poissons_ratio = 0.5
density = 1000
[[rods]]
name = "held"
radius = "1 mm"
edges = 20
held = true
shape = {{ kind = "straight", start = [-0.1, 0, 0], end = [0.1, 0, 0] }}
[[rods]]
name = "shot"
radius = "1 mm"
edges = 20
shape = {{ kind = "straight", start = [0.0013, -0.1, 0.01], end = [0.0013, 0.1, 0.01] }}
velocity = [0, 0, -{speed:?}]
[contact]
model = "{model}"
[time]
{time}
"#
    )
}

fn linked_rings(model: &str, scheme: &str, speed: f64, step: f64, end: f64) -> String {
    let half = 0.5 * speed;
    format!(
        r#"experiment = "scene"
title = "Linked rings are shot apart"
[material]
youngs_modulus = "1 MPa"
poissons_ratio = 0.5
density = 1000
[[rods]]
name = "a"
radius = 0.002
edges = 24
shape = {{ kind = "ring", centre = [0, 0, 0], normal = [0, 0, 1], radius = 0.05 }}
velocity = [-{half:?}, 0, 0]
[[rods]]
name = "b"
radius = 0.002
edges = 24
shape = {{ kind = "ring", centre = [0.05, 0, 0], normal = [0, 1, 0], radius = 0.05 }}
velocity = [{half:?}, {:?}, {:?}]
[contact]
model = "{model}"
[time]
scheme = "{scheme}"
step = {step:?}
end = {end:?}
"#,
        0.1 * half,
        0.06 * half
    )
}

#[test]
fn a_thread_that_falls_on_a_held_one_does_not_fall_through() {
    for model in ["imc", "ipc", "complementarity"] {
        for step in ["", "step = \"auto\"\n"] {
            let text = format!(
                r#"experiment = "scene"
title = "A thread falls across a held one"
[material]
youngs_modulus = "10 MPa"
poissons_ratio = 0.5
density = 1000
[[rods]]
name = "post"
radius = "0.1 mm"
edges = 10
held = true
shape = {{ kind = "straight", start = [-0.02, 0, 0], end = [0.02, 0, 0] }}
[[rods]]
name = "thread"
radius = "0.1 mm"
edges = 40
shape = {{ kind = "straight", start = [0.0003, -0.02, 0.05], end = [0.0003, 0.02, 0.05] }}
[[loads]]
kind = "gravity"
acceleration = [0, 0, -9.81]
[contact]
model = "{model}"
[time]
{step}end = 0.105
"#
            );
            let mut running = Running::new(&text);
            running
                .run(|now| assert!(now.height_over_axis(1, 1) > 1.9e-4, "{model} {step}"))
                .unwrap();
        }
    }
}

#[test]
fn rods_shot_at_a_held_rod_do_not_pass_through_it() {
    for (model, scheme) in [
        ("imc", "implicit-euler"),
        ("complementarity", "implicit-euler"),
        ("ipc", "implicit-euler"),
        ("imc", "implicit-midpoint"),
        ("imc", "backward-differences"),
    ] {
        for speed in [1.0, 10.0, 200.0] {
            let end = 0.012 / speed + 1e-3;
            let time = format!("scheme = \"{scheme}\"\nstep = \"1 ms\"\nend = {end:?}");
            let mut running = Running::new(&two_crossing_rods(model, &time, speed));
            running
                .run(|now| {
                    let height = now.height_over_axis(1, 1);
                    assert!(
                        height > 1.8e-3,
                        "{model}, {scheme}, {speed} m/s: {height:e}"
                    );
                })
                .unwrap();
        }
    }
}

#[test]
fn linked_rings_stay_linked_at_any_speed() {
    for (model, scheme) in [
        ("imc", "implicit-euler"),
        ("ipc", "implicit-euler"),
        ("complementarity", "implicit-euler"),
        ("imc", "implicit-midpoint"),
        ("imc", "backward-differences"),
    ] {
        for (speed, step, end) in [(10.0, 1e-3, 0.05), (50.0, 1e-3, 0.01), (200.0, 1e-3, 0.004)] {
            let mut running = Running::new(&linked_rings(model, scheme, speed, step, end));
            let before = linking_number(running.rod(0), running.rod(1));
            assert!((before.abs() - 1.0).abs() < 1e-9);
            running.run(|_| ()).unwrap();
            let after = linking_number(running.rod(0), running.rod(1));
            assert!(
                (after - before).abs() < 1e-9,
                "{model}, {scheme}, {speed} m/s, {step} s: {before} became {after}"
            );
        }
    }
}

#[test]
fn clamps_do_not_drive_a_rod_through_another() {
    for model in ["imc", "complementarity"] {
        for speed in [10.0, 50.0] {
            let text = format!(
                r#"experiment = "scene"
title = "Clamps drive a rod at a held one"
[material]
youngs_modulus = "1 MPa"
poissons_ratio = 0.5
density = 1000
[[rods]]
name = "held"
radius = "1 mm"
edges = 20
held = true
shape = {{ kind = "straight", start = [-0.1, 0, 0], end = [0.1, 0, 0] }}
[[rods]]
name = "driven"
radius = "1 mm"
edges = 20
shape = {{ kind = "straight", start = [0.0013, -0.1, 0.01], end = [0.0013, 0.1, 0.01] }}
[[clamps]]
rod = "driven"
at = "start"
hold = "position"
move = [[0, [0, 0, 0]], [{time:?}, [0, 0, -0.05]]]
[[clamps]]
rod = "driven"
at = "end"
hold = "position"
move = [[0, [0, 0, 0]], [{time:?}, [0, 0, -0.05]]]
[contact]
model = "{model}"
[time]
step = "1 ms"
end = {time:?}
"#,
                time = 0.05 / speed
            );
            let mut running = Running::new(&text);
            running
                .run(|now| assert!(now.height_over_axis(1, 1) > 1.8e-3, "{model} {speed}"))
                .unwrap();
        }
    }
}

#[test]
fn the_penetration_bound_holds_at_the_end_of_midpoint_steps() {
    for speed in [1.0, 5.0] {
        let time = "scheme = \"implicit-midpoint\"\nstep = \"1 ms\"\nend = 0.03";
        let mut running = Running::new(&two_crossing_rods("imc", time, speed));
        running
            .run(|now| {
                let ratio = now.simulation.minimum_distance() / 2e-3;
                assert!(ratio >= 0.95, "{speed} m/s: {ratio}");
            })
            .unwrap();
    }
    let text = r#"experiment = "scene"
title = "A rod falls on a floor"
[material]
youngs_modulus = "1 MPa"
poissons_ratio = 0.5
density = 1000
[[rods]]
name = "rod"
radius = "1 mm"
edges = 20
shape = { kind = "straight", start = [-0.05, 0, 0.01], end = [0.05, 0, 0.02] }
velocity = [0.3, 0, -5]
[[planes]]
point = [0, 0, 0]
normal = [0, 0, 1]
[contact]
model = "imc"
[time]
scheme = "implicit-midpoint"
step = "1 ms"
end = 0.02
"#;
    let mut running = Running::new(text);
    running
        .run(|now| {
            let lowest = now.rod(0).iter().map(|x| x.z).fold(f64::INFINITY, f64::min);
            assert!(lowest >= 0.95e-3, "{lowest:e}");
        })
        .unwrap();
}

#[test]
fn a_barrier_may_cost_steps_but_never_fails_the_run() {
    // These runs used to stall at 0.0419 s, when the rods come to lie along each other.
    for (speed, end) in [(5.0, 0.05), (20.0, 0.05)] {
        let text = format!(
            r#"experiment = "scene"
title = "Rod shot at a clamped rod"
[material]
youngs_modulus = "10 MPa"
poissons_ratio = 0.45
density = 1000
[[rods]]
name = "target"
radius = "1 mm"
edges = 20
shape = {{ kind = "straight", start = [-0.1, 0, 0], end = [0.1, 0, 0] }}
[[rods]]
name = "shot"
radius = "1 mm"
edges = 20
shape = {{ kind = "straight", start = [0.003, -0.1, 0.0235], end = [0.003, 0.1, 0.0235] }}
velocity = [0, 0, -{speed:?}]
[[clamps]]
rod = "target"
at = "start"
[[clamps]]
rod = "target"
at = "end"
[contact]
model = "ipc"
friction = 0.3
[time]
step = "1 ms"
end = {end:?}
"#
        );
        let mut running = Running::new(&text);
        running.run(|_| ()).unwrap();
        assert!(running.steps < 150, "{speed} m/s: {} steps", running.steps);
    }
}

#[test]
fn friction_on_a_floor_takes_the_requested_steps() {
    // The penalty used to take 1,340 steps for the first of these scenes, and more for a faster
    // rod.
    for model in ["imc", "ipc"] {
        let text = format!(
            r#"experiment = "scene"
title = "A clamped rod is driven along a floor"
[material]
youngs_modulus = "1 MPa"
poissons_ratio = 0.5
density = 1000
[[rods]]
name = "rod"
radius = "2 mm"
edges = 20
shape = {{ kind = "straight", start = [0, 0, 0.0025], end = [0.2, 0, 0.0025] }}
[[clamps]]
rod = "rod"
at = "start"
move = [[0, [0, 0, 0]], [0.03, [0, 0, -0.0003]], [0.12, [0.006, 0, -0.0003]]]
[[planes]]
point = [0, 0, 0]
normal = [0, 0, 1]
[[loads]]
kind = "gravity"
acceleration = [0, 0, -9.81]
[contact]
model = "{model}"
friction = 0.2
[time]
step = "1 ms"
end = 0.12
"#
        );
        let mut running = Running::new(&text);
        running.run(|_| ()).unwrap();
        assert!(running.steps <= 126, "{model}: {} steps", running.steps);
        assert!(
            running.iterations <= 4 * running.steps,
            "{model}: {}",
            running.iterations
        );
    }
}

/// Two rings that tumble with several metres per second.
fn tumbling_rings(
    model: &str,
    friction: f64,
    scheme: &str,
    radii: [f64; 2],
    motion: [&str; 3],
) -> String {
    let [rod, ring] = radii;
    let [first, spin, second] = motion;
    format!(
        r#"experiment = "scene"
title = "Linked rings tumble"
[material]
youngs_modulus = "12 kPa"
poissons_ratio = 0.5
density = 1000
[[rods]]
name = "a"
radius = {rod:?}
edges = 10
shape = {{ kind = "ring", centre = [0, 0, 0], normal = [0, 0, 1], radius = {ring:?} }}
velocity = {first}
angular_velocity = {spin}
[[rods]]
name = "b"
radius = {rod:?}
edges = 10
shape = {{ kind = "ring", centre = [{ring:?}, 0, 0], normal = [0, 1, 0], radius = {ring:?} }}
velocity = {second}
[contact]
model = "{model}"
friction = {friction:?}
[time]
scheme = "{scheme}"
step = "1 ms"
end = 0.02
"#
    )
}

#[test]
fn a_barrier_with_the_midpoint_rule_does_not_panic() {
    let motion = ["[3.57, -7.26, 6.18]", "[155, 349, -65]", "[6.8, 3.2, 0.9]"];
    let text = tumbling_rings("ipc", 0.0, "implicit-midpoint", [1.1e-3, 0.0216], motion);
    let mut running = Running::new(&text);
    running.run(|_| ()).unwrap();
    let linked = linking_number(running.rod(0), running.rod(1));
    assert!((linked.abs() - 1.0).abs() < 1e-9);
    let time = "scheme = \"implicit-midpoint\"\nstep = \"1 ms\"\nend = 0.004";
    Running::new(&two_crossing_rods("ipc", time, 20.0))
        .run(|_| ())
        .unwrap();
}

#[test]
fn complementarity_without_pressed_contacts_does_not_panic() {
    // The rod is twisted by 100 turns and pushed together. It tangles more than its edges can
    // resolve.
    let text = r#"experiment = "scene"
title = "A rod is twisted until it tangles"
[material]
youngs_modulus = "2 MPa"
poissons_ratio = 0.5
density = 1100.0
[[rods]]
name = "a"
radius = 0.002
edges = 20
shape = { kind = "straight", start = [0, 0, 0], end = [0.2, 0, 0] }
[[clamps]]
rod = "a"
at = "start"
[[clamps]]
rod = "a"
at = "end"
turn = [[0, 0], [0.5, "100 turns"]]
move = [[0, [0, 0, 0]], [0.5, [-0.1, 0, 0]]]
[[loads]]
kind = "gravity"
acceleration = [0, 0, -9.81]
[contact]
model = "complementarity"
[time]
step = 0.001
end = 0.1
"#;
    let mut running = Running::new(text);
    if let Err(error) = running.run(|_| ()) {
        let message = error.to_string();
        assert!(
            !message.contains("NaN") && !message.contains("stiffness"),
            "{message}"
        );
    }
}
