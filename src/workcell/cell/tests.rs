//! Tests of cell files: those that come with the program, and faulty ones.

use super::*;
use crate::test_cells::{cell as shipped, file};
use rodlab_robot::{Middleware, distance_and_angle, pose};

fn read(text: &str) -> Result<Cell, String> {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("cell.toml");
    std::fs::write(&path, text).unwrap();
    Cell::read(&path).map_err(|error| error.to_string())
}

/// Cells with arms that come with the program.
const ARMS: [&str; 3] = ["two_sawyers", "seven_joints", "six_joints"];

const ONE_JOINT: &str = r#"[[arms]]
name = "arm"
velocity = 1.0
joints = [{ kind = "revolute", name = "a", axis = [0, 0, 1], lower = "-90 deg", upper = 2.0 }]
tool = { position = ["10 cm", 0, 0] }

[[axes]]
name = "twister"
velocity = "60 rpm"
acceleration = 10.0
driver = { kind = "stepper", port = "/dev/ttyACM0", steps_per_turn = 3200 }

[table]
size = [1, 1, "4 cm"]
"#;

#[test]
fn limits_of_mimic_joints_bound_the_joint_they_follow() {
    let with = |follower: &str| {
        let joints = format!("lower = \"-90 deg\", upper = 2.0 }}, {{ {follower} }}]");
        read(&ONE_JOINT.replace("lower = \"-90 deg\", upper = 2.0 }]", &joints))
    };
    let mimic = "mimic = { joint = \"a\", multiplier = 2.0, offset = 0.5 }";
    let follower = format!(
        "kind = \"revolute\", name = \"b\", {mimic}, lower = -0.5, upper = 1.5, velocity = 1.0"
    );
    let limits = with(&follower).unwrap().arms[0].chain.joints[0].limits;
    assert_eq!((limits.lower, limits.upper), (-0.5, 0.5));
    // Half of the limit of the mimicked joint, although the arm gives 1 rad/s for all joints.
    assert_eq!(limits.velocity, 0.5);
    for (good, bad, expected) in [
        ("offset = 0.5", "offset = 90.0", "leave no range for joint"),
        ("lower = -0.5", "lower = 2.0", "must be below `upper`"),
        ("offset = 0.5", "offset = nan", "finite"),
        ("multiplier = 2.0", "multiplier = inf", "finite"),
        ("velocity = 1.0", "velocity = -1.0", "above 0"),
        ("name = \"b\"", "name = \"a\"", "another joint is called"),
        ("name = \"b\"", "name = \"b\", axis = [0, 0, inf]", "axis"),
    ] {
        let text = follower.replace(good, bad);
        let error = with(&text).unwrap_err();
        assert!(error.contains(expected), "{bad}: {error}");
    }
}

#[test]
fn the_hand_of_the_sawyer_agrees_with_three_libraries() {
    let path = file("../shared/facts/sawyer_fk_samples.csv");
    let Ok(mut samples) = csv::Reader::from_path(&path) else {
        eprintln!("SKIPPED: {} is not there", path.display());
        return;
    };
    let cell = shipped("two_sawyers");
    let mut count = 0;
    for sample in samples.deserialize() {
        let sample: Vec<f64> = sample.unwrap();
        let position = [sample[7], sample[8], sample[9]];
        let quaternion = [sample[10], sample[11], sample[12], sample[13]];
        let expected = pose(position, quaternion).unwrap();
        for arm in &cell.arms {
            let (distance, angle) = distance_and_angle(&arm.chain.hand(&sample[..7]), &expected);
            assert!(
                distance < 1e-9 && angle < 1e-7,
                "{distance:e} m, {angle:e} rad"
            );
        }
        count += 1;
    }
    assert_eq!(count, 200);
}

/// For the time per pose, run `cargo bench --bench inverse_kinematics`.
#[test]
fn a_thousand_reachable_poses_of_every_arm_are_solved() {
    for name in ARMS {
        let cell = shipped(name);
        let arm = &cell.arms[0];
        for k in 0..1000 {
            let target = arm.chain.hand(&arm.chain.start(100_000 + k));
            let joints = arm
                .chain
                .reach(&target, &arm.home)
                .unwrap_or_else(|nearest| panic!("{name}, pose {k}: {nearest:?}"));
            let (distance, angle) = distance_and_angle(&arm.chain.hand(&joints), &target);
            assert!(distance < 1e-9 && angle < 1e-9);
            assert!(arm.chain.outside_limits(&joints).is_none());
        }
    }
}

#[test]
fn units_and_defaults_are_resolved() {
    let cell = read(ONE_JOINT).unwrap();
    let arm = cell.arm("arm").unwrap();
    let limits = arm.chain.joints[0].limits;
    assert!((limits.lower + std::f64::consts::FRAC_PI_2).abs() < 1e-15);
    assert_eq!((limits.upper, limits.velocity), (2.0, 1.0));
    assert_eq!(arm.chain.tool.translation.x, 0.1);
    assert!((cell.axes[0].limits.velocity - std::f64::consts::TAU).abs() < 1e-15);
    assert_eq!(cell.streaming, rodlab_robot::StreamBounds::default());
    assert!(matches!(
        cell.axes[0].driver,
        Some(Driver::Stepper { baud: 115_200, .. })
    ));
}

#[test]
fn the_gripper_of_an_arm_of_ros_1_is_moved_by_its_master() {
    let cell = shipped("mujoco");
    let (_, openings) = cell.gripper(0).unwrap();
    assert_eq!(openings, [0.04, 0.0]);
}

#[test]
fn the_gripper_of_an_arm_of_ros_2_grips_with_an_effort() {
    if !rodlab_robot::Ros2Address::IS_BUILT {
        return;
    }
    let with = |keys: &str| {
        let gripper = format!("[arms.gripper]\naction = \"/grip\"\n{keys}\n[arms.driver]\n");
        let driver = "kind = \"ros2\"\naction = \"/arm\"\njoint_states = \"/joints\"\n\n[[axes]]";
        read(&ONE_JOINT.replacen("[[axes]]", &(gripper + driver), 1))
    };
    let effort = |keys: &str| {
        let cell = with(keys).unwrap();
        assert!(cell.gripper(0).is_some());
        cell.arms[0].gripper.as_ref().unwrap().max_effort
    };
    assert_eq!(effort(""), 10.0);
    assert_eq!(effort("max_effort = \"25 N\""), 25.0);
    assert_eq!(effort("max_effort = 0"), 0.0);
    let refused = with("max_effort = \"-1 N\"").unwrap_err();
    assert!(refused.contains("`arms.0.gripper.max_effort`"), "{refused}");
}

/// Faults of this file: text, replacement, reported place, and words of the message.
const FAULTS: &str = r#"name = "a" | nam = "a" | cell.toml:4: | nam
velocity = 1.0\n | | cell.toml:1: | needs a `velocity`
upper = 2.0 | upper = "-100 deg" | `arms.0.joints.0.lower` | must be below
axis = [0, 0, 1] | axis = [0, 0, 0] | `arms.0.joints.0.axis` | direction
"10 cm" | "10 kg" | `arms.0.tool.position.0` | is a mass, but this key takes a length
"stepper" | "steper" | cell.toml:11: | allowed: file, rosbridge, ros1, ros2, stepper
"stepper", port = "/dev/ttyACM0", steps_per_turn = 3200 | "ros2", domain = 300, action = "/a", joint_states = "/s" | `axes.0.driver.domain` | allowed: 0 to 232
"stepper", port = "/dev/ttyACM0", steps_per_turn = 3200 | "ros2", middleware = "zenoh", action = "/a", joint_states = "/s" | `axes.0.driver.middleware` | allowed: fast-dds, cyclone-dds
name = "twister" | name = "arm" | `axes.0.name` | another arm or axis
velocity = 1.0 | velocity = [1.0, 2.0] | `arms.0.velocity` | found 2
velocity = 1.0 | velocity = 1.0\nhome = [3.0] | `arms.0.home.0` | out of the range
velocity = 1.0 | velocity = 1.0\nquaternion = [1, 1, 0, 0] | `arms.0.quaternion` | length 1
velocity = 1.0 | velocity = 1.0\nurdf = "x.urdf" | `arms.0.joints` | not both
velocity = 1.0 | velocity = 1.0\nlink_radius = "-1 cm" | `arms.0.link_radius` | above 0
size = [1, 1, "4 cm"] | size = [1, 0, 1] | `table.size.1` | above 0"#;

#[test]
fn faults_name_file_line_and_key() {
    let gripper = "[arms.gripper]\naction = \"/grip\"\n[arms.driver]\nkind = \"file\"\npath = \"-\"\n\n[[axes]]";
    let refused = read(&ONE_JOINT.replacen("[[axes]]", gripper, 1)).unwrap_err();
    assert!(
        refused.contains("`arms.0.gripper`") && refused.contains("\"ros1\" or \"ros2\""),
        "{refused}"
    );
    for case in FAULTS.lines() {
        let parts: Vec<String> = case
            .split('|')
            .map(|part| part.trim().replace("\\n", "\n"))
            .collect();
        let [good, bad, place, expected] = &parts[..] else {
            panic!("{case}");
        };
        assert!(ONE_JOINT.contains(good), "{good}");
        let error = read(&ONE_JOINT.replacen(good, bad, 1)).unwrap_err();
        assert!(error.contains(place) && error.contains(expected), "{error}");
    }
    let empty = read("title = \"empty\"").unwrap_err();
    assert!(empty.contains("needs an arm"), "{empty}");
    let missing = read("[[arms]]\nname = \"a\"\nurdf = \"none.urdf\"\n").unwrap_err();
    assert!(missing.contains("none.urdf: cannot be read"), "{missing}");
}

#[test]
fn diagnostics_have_a_topic_of_ros_1_or_ros_2() {
    let with = |topic: &str| {
        let streaming = format!("\n[streaming]\ndiagnostics = \"{topic}\"\n");
        read(&(ONE_JOINT.to_owned() + &streaming))
    };
    let cell = with("ros1://10.0.0.1:11311/diagnostics").unwrap();
    assert_eq!(cell.diagnostics.unwrap().topic(), "/diagnostics");
    for wrong in [
        "rosbridge://10.0.0.1:9090/diagnostics",
        "/diagnostics",
        "ros1://host",
    ] {
        let error = with(wrong).unwrap_err();
        assert!(error.contains("streaming.diagnostics"), "{error}");
        assert!(error.contains("ros1://"), "{error}");
    }
}

#[test]
fn a_signal_is_compared_by_the_keys_of_its_message() {
    let with = |keys: &str| {
        let signal = format!("\n[[safety.signals]]\nname = \"s\"\n{keys}\n");
        read(&(ONE_JOINT.to_owned() + &signal)).map(|mut cell| cell.safety.signals.remove(0))
    };
    let at = "topic = \"ros1://10.0.0.1:11311/stop\"\n";
    let of = |message: &str, keys: &str| with(&format!("{at}message = \"{message}\"\n{keys}"));
    let button = of("std_msgs/msg/Bool", "stop_at = true").unwrap();
    assert_eq!(button.topic.topic(), "/stop");
    assert_eq!((button.bounds, button.silence), (Bounds::Not(true), None));
    let mode = of(
        "ur_dashboard_msgs/RobotMode",
        "allowed = [7]\nsilence = \"2 s\"",
    )
    .unwrap();
    assert_eq!(mode.bounds, Bounds::Numbers(vec![7.0]));
    assert_eq!(mode.silence.unwrap().as_secs(), 2);
    let range = of("std_msgs/Float64", "upper = 3.0").unwrap();
    assert_eq!(range.bounds, Bounds::Range([f64::NEG_INFINITY, 3.0]));
    let wrench = of("geometry_msgs/WrenchStamped", "torque = \"50 Nmm\"").unwrap();
    let (force, torque) = (f64::INFINITY, 0.05);
    assert_eq!(wrench.bounds, Bounds::Wrench { force, torque });
    for (message, keys, expected) in [
        ("std_msgs/Bool", "", "no message and no silence would end"),
        ("std_msgs/Bool", "upper = 1", "are compared by stop_at"),
        ("std_msgs/Empty", "stop_at = true", "has no content"),
        (
            "std_msgs/Pose",
            "stop_at = true",
            "\"std_msgs/Pose\" is not read; allowed: std_msgs/Bool",
        ),
        ("std_msgs/Int8", "allowed = [\"a\"]", "numbers are needed"),
        ("std_msgs/String", "allowed = [1]", "texts are needed"),
        (
            "std_msgs/Int8",
            "allowed = [1]\nupper = 2",
            "either `allowed`, or",
        ),
        ("std_msgs/Int8", "lower = 2\nupper = 2", "below `upper`"),
        ("geometry_msgs/WrenchStamped", "force = \"2 m\"", "a force"),
        (
            "std_msgs/Empty",
            "silence = \"1 ms\"",
            "allowed: 0.01 s to 3600 s",
        ),
    ] {
        let error = of(message, keys).unwrap_err();
        assert!(error.contains(expected), "{keys}: {error}");
        assert!(error.contains("safety.signals.0"), "{error}");
    }
    let error = with("topic = \"/stop\"\nmessage = \"std_msgs/Empty\"").unwrap_err();
    assert!(
        error.contains("cell.toml:") && error.contains("is not a topic"),
        "{error}"
    );
}

#[test]
fn ten_lines_of_the_guide_connect_an_arm() {
    let page = include_str!("../../guide/robots.md");
    let block = |k: usize| {
        let after = page.split("```toml cell\n").nth(k).unwrap();
        after.split("```").next().unwrap()
    };
    assert_eq!(block(1).lines().count(), 10);
    let directory = tempfile::tempdir().unwrap();
    let urdf = r#"<robot name="r"><link name="base"/><link name="hand"/><joint name="a" type="revolute"><parent link="base"/>
        <child link="hand"/><axis xyz="0 0 1"/><limit lower="-1" upper="2" effort="1" velocity="3"/></joint></robot>"#;
    std::fs::write(directory.path().join("my_arm.urdf"), urdf).unwrap();
    let path = directory.path().join("cell.toml");
    std::fs::write(&path, [block(1), block(3)].concat()).unwrap();
    let cell = Cell::read(&path).unwrap_or_else(|error| panic!("{error}"));
    let Some(Driver::Ros2(address)) = &cell.arms[0].driver else {
        panic!("{:?}", cell.arms[0].driver);
    };
    assert_eq!(
        (address.domain, address.middleware),
        (0, Middleware::FastDds)
    );
    assert!(cell.table.is_some() && cell.obstacles.len() == 1 && cell.axes.len() == 1);
    let joints = format!(
        "[[arms]]\nname = \"arm\"\nacceleration = 1.0\njerk = 1.0\n{}",
        block(2)
    );
    std::fs::write(&path, joints).unwrap();
    let arm = &Cell::read(&path)
        .unwrap_or_else(|error| panic!("{error}"))
        .arms[0];
    assert_eq!(arm.chain.joints.len(), 2);
}

#[test]
fn a_report_names_every_part() {
    let report = CellReport::new(&shipped("two_sawyers"));
    let text = report.to_string();
    let parts = "right,left,twister,table top,rosbridge,/dev/ttyACM0";
    for part in parts.split(',') {
        assert!(text.contains(part), "{text}");
    }
    assert!(serde_json::from_str::<serde_json::Value>(&report.to_json()).is_ok());
}

/// Pose of a hand above the table, gripper down, in the frame of the table's top.
fn down(at: [f64; 3], turn: f64) -> rodlab_robot::Pose {
    use nalgebra::{Translation3, UnitQuaternion, Vector3};
    let rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn)
        * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
    rodlab_robot::Pose::from_parts(Translation3::from(at), rotation)
}

/// Three turns of a helix of radius 5 cm and pitch 4 cm, with the gripper turning along by half a turn.
fn helix() -> Vec<rodlab_robot::Pose> {
    (0..=500)
        .map(|k| {
            let part = f64::from(k) / 500.0;
            let angle = 6.0 * std::f64::consts::PI * part;
            let at = [0.05 * angle.cos(), 0.05 * angle.sin(), 0.1 + 0.12 * part];
            down(at, std::f64::consts::PI * part)
        })
        .collect()
}

/// The letter R, 16 cm high, drawn 12 cm above the table.
fn letter() -> Vec<rodlab_robot::Pose> {
    let mut corners = vec![[-0.05, -0.08], [-0.05, 0.08], [0.0, 0.08]];
    corners.extend((0..=20).map(|k| {
        let angle = std::f64::consts::FRAC_PI_2 - std::f64::consts::PI * f64::from(k) / 20.0;
        [0.04 * angle.cos(), 0.04 + 0.04 * angle.sin()]
    }));
    corners.extend([[-0.05, 0.0], [0.05, -0.08]]);
    corners
        .iter()
        .map(|[x, y]| down([*x, *y, 0.12], 0.0))
        .collect()
}

#[test]
fn helices_and_letters_become_smooth_joint_paths_where_they_fit_best() {
    use rodlab_robot::{LARGEST_JUMP, PathProblem, place, subdivide};
    for name in ARMS {
        let cell = shipped(name);
        let arm = &cell.arms[0];
        let surroundings = cell.surroundings();
        let homes = surroundings.homes();
        let clearance = |joints: &[f64]| {
            let mut postures = homes.clone();
            postures[0] = joints.to_vec();
            surroundings.clearance(&postures, Some(0))
        };
        let problem = PathProblem {
            chain: &arm.chain,
            from: &arm.home,
            clearance: &clearance,
            margin: 0.01,
        };
        let table = cell.table.unwrap();
        let top = arm.base.inverse() * table.top;
        for (what, path) in [("helix", helix()), ("letter", letter())] {
            let sides = [table.size[0], table.size[1]];
            let placement = place(&problem, &path, &top, sides, 1e-3)
                .unwrap_or_else(|failure| panic!("{name}, {what}: {failure:?}"));
            let poses: Vec<_> = path.iter().map(|local| placement.pose * local).collect();
            let points = subdivide(&poses, 1e-3);
            let found = problem.solve(&points).unwrap();
            assert!(found.largest_jump <= LARGEST_JUMP && found.least_clearance >= 0.01);
            for (point, joints) in points.iter().zip(&found.joints) {
                let (distance, angle) = distance_and_angle(&arm.chain.hand(joints), &point.pose);
                assert!(distance < 1e-9 && angle < 1e-9);
                assert!(arm.chain.outside_limits(joints).is_none());
            }
        }
    }
}

#[test]
fn planned_helices_and_letters_hold_every_limit_at_a_kilohertz() {
    for name in ARMS {
        for (what, path) in [("helix", helix()), ("letter", letter())] {
            planned_within_limits(name, what, &path);
        }
    }
}

fn planned_within_limits(name: &str, what: &str, path: &[rodlab_robot::Pose]) {
    const SPEED: f64 = 0.25;
    let cell = shipped(name);
    let arm = &cell.arms[0];
    let request = PlanRequest {
        arm: 0,
        path: path.to_vec(),
        place: Place::Auto,
        margin: 0.01,
        speed: SPEED,
        rate: 1000,
    };
    let plan = cell
        .plan(&request)
        .unwrap_or_else(|error| panic!("{name}, {what}: {error}"));
    let points = &plan.trajectory.points;
    let used = rodlab_robot::utilisation(points, &arm.limits());
    assert!(
        used.velocity <= 1.0 && used.acceleration <= 1.0 && used.jerk <= 1.0,
        "{used:?}"
    );
    let outside = points
        .iter()
        .find(|q| arm.chain.outside_limits(q).is_some());
    assert!(outside.is_none(), "{outside:?}");
    assert!(plan.report.largest_jump <= rodlab_robot::LARGEST_JUMP);
    // The hand passes every pose within the error of sampling at 1 ms, and never exceeds its
    // speed.
    let frame =
        rodlab_robot::pose(plan.report.place_position, plan.report.place_quaternion).unwrap();
    let to_base = arm.base.inverse() * frame;
    let hands: Vec<_> = points
        .iter()
        .map(|q| arm.chain.hand(q).translation.vector)
        .collect();
    for pose in path {
        let place = (to_base * pose).translation.vector;
        let distances = hands.iter().map(|hand| (hand - place).norm());
        let nearest = distances.fold(f64::INFINITY, f64::min);
        assert!(nearest < 5e-4, "{name}, {what}: {nearest}");
    }
    let fastest = hands.windows(2).map(|pair| (pair[1] - pair[0]).norm());
    assert!(fastest.fold(0.0, f64::max) < SPEED * 1e-3 * 1.001);
}

#[test]
fn a_chuck_names_the_axis_that_turns_it() {
    let cell = shipped("helix_gantry");
    let chuck = cell.chuck.unwrap();
    assert_eq!(cell.axes[chuck.axis].name, "stepper");
    assert!((chuck.pose.translation.z - 0.6).abs() < 1e-12);
    assert!(matches!(
        cell.axes[chuck.axis].driver,
        Some(Driver::Rosbridge { .. })
    ));
    let error = read(&format!("{ONE_JOINT}\n[chuck]\naxis = \"twist\"\n")).unwrap_err();
    assert!(
        error.contains("no axis is called \"twist\"; there are twister"),
        "{error}"
    );
}
