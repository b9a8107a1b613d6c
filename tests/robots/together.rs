//! Two arms with separate servers and a simulated stepper, moved by three tables on a common
//! clock.

use super::rosbridge::willing;
use super::stepper::Board;
use super::{log, rise, rodlab, said, table};
use std::f64::consts::TAU;
use std::fs;

/// Largest delay of observed positions of the arms and of the simulated stepper, s. The speed of
/// the stepper depends on the machine.
const LATE: [f64; 3] = [0.25, 0.25, 1.0];
/// Largest lead of observed positions, s: the time needed to start all parts.
const EARLY: f64 = 0.1;

fn arm(name: &str, x: f64, address: &str) -> String {
    format!(
        r#"[[arms]]
name = "{name}"
position = [{x}, 0, 0]
velocity = 2.0
acceleration = 20.0
jerk = 400.0
link_radius = "5 cm"
joints = [
    {{ kind = "revolute", name = "right_j0", link = "upper", lower = -3.0, upper = 3.0 }},
    {{ kind = "revolute", name = "right_j1", link = "lower", position = [0.3, 0, 0], axis = [0, 1, 0], lower = -3.0, upper = 3.0 }},
]
tool = {{ position = [0.3, 0, 0] }}
driver = {{ kind = "rosbridge", address = "{address}", action = "/arm", joint_states = "/joint_states" }}

"#
    )
}

#[test]
fn two_arms_and_a_stepper_keep_one_clock() {
    let servers = [willing(), willing()];
    let folder = tempfile::tempdir().unwrap();
    // The simulated board may be a second late on a busy machine.
    let axis = |port: &str| {
        format!(
            "[streaming]\ntracking_tolerance = 7.0\n\n[[axes]]\nname = \"twister\"\nvelocity = \"60 rpm\"\nacceleration = 20.0\n\
         driver = {{ kind = \"stepper\", port = \"{port}\", steps_per_turn = 3200 }}\n",
        )
    };
    let write_cell = |port: &str| {
        let arms = [("right", 0.0), ("left", 2.0)];
        let mut cell: String = arms
            .iter()
            .zip(&servers)
            .map(|((name, x), server)| arm(name, *x, &server.0))
            .collect();
        cell.push_str(&axis(port));
        fs::write(folder.path().join("cell.toml"), cell).unwrap();
    };
    write_cell("/dev/null");
    let right = [("right.right_j0_rad", 1.0), ("right.right_j1_rad", -0.5)];
    let left = [("left.right_j0_rad", -0.8), ("left.right_j1_rad", 0.4)];
    table(folder.path(), "right.csv", &right, 301, 3.0);
    table(folder.path(), "left.csv", &left, 101, 2.0);
    table(folder.path(), "turn.csv", &[("twister_rad", TAU)], 251, 2.5);
    let tables = ["right.csv", "left.csv", "turn.csv"];
    let stream = |tables: &[&str]| {
        let arguments = [
            &["stream"],
            tables,
            &["--cell", "cell.toml", "--out", "log"],
        ];
        rodlab(folder.path(), &arguments.concat())
    };
    let twice = stream(&["right.csv", "right.csv"]);
    assert_eq!(twice.status.code(), Some(2), "{}", said(&twice));
    assert!(said(&twice).contains("right: two trajectories move it"));

    let moved = Board::moved(|board| {
        write_cell(&board.port);
        let _ = fs::remove_dir_all(folder.path().join("log"));
        stream(&tables)
    });
    let Some((board, output)) = moved else { return };
    assert!(output.status.success(), "{}", said(&output));
    assert_eq!(servers[0].1.lock().unwrap().moved, [1.0, -0.5]);
    assert_eq!(servers[1].1.lock().unwrap().moved, [-0.8, 0.4]);
    assert_eq!(board.counts(), (3200, 3200));

    // The observed positions of each part fit the common clock. A busy machine receives some of
    // them late; a separate clock would shift all of them.
    let events = log(folder.path(), "events.csv");
    let started = events
        .lines()
        .find(|line| line.ends_with("\"started\""))
        .unwrap();
    let start: f64 = started.split(',').next().unwrap().parse().unwrap();
    let (mut heard, mut in_time) = ([0; 3], [0; 3]);
    for line in log(folder.path(), "state.csv").lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let time = cells[0].parse::<f64>().unwrap() - start;
        let position: f64 = cells[3].parse().unwrap();
        let (part, by, seconds) = match (cells[1], cells[2]) {
            ("right", "right_j0") => (0, 1.0, 3.0),
            ("left", "right_j0") => (1, -0.8, 2.0),
            ("twister", _) => (2, TAU, 2.5),
            _ => continue,
        };
        if !(0.0..seconds).contains(&time) {
            continue;
        }
        // Tolerance for a step of the motor, and for rounding in a table.
        let places = [time - LATE[part], time + EARLY].map(|time| by * rise(time, seconds));
        let (low, high) = (
            places[0].min(places[1]) - 0.02,
            places[0].max(places[1]) + 0.02,
        );
        heard[part] += 1;
        in_time[part] += usize::from((low..high).contains(&position));
    }
    for part in 0..3 {
        let (heard, in_time) = (heard[part], in_time[part]);
        assert!(
            heard > 40 && 2 * in_time > heard,
            "part {part}: {in_time} of {heard} in time"
        );
    }
    assert!(log(folder.path(), "trajectory-3.csv").starts_with("time_s,twister_rad"));
}
