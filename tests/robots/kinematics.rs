//! `rodlab solve fk` and `ik`, `rodlab plan joints`, compared with pinocchio.

use super::{rodlab, said};
use crate::parts::python_with;
use rodlab::cell::Cell;
use rodlab::robot::{Chain, Motion, Pose, distance_and_angle, pose, read_urdf};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

fn cell(name: &str) -> String {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    root.join("scenarios/cells")
        .join(name)
        .display()
        .to_string()
}

fn json(arguments: &[&str]) -> Value {
    let output = rodlab(Path::new("."), arguments);
    assert!(output.status.success(), "{}", said(&output));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    value
        .as_array()
        .unwrap()
        .iter()
        .map(|x| x.as_f64().unwrap())
        .collect()
}

fn joined(numbers: &[f64]) -> String {
    numbers
        .iter()
        .map(f64::to_string)
        .collect::<Vec<_>>()
        .join(",")
}

#[test]
fn solved_joints_bring_the_hand_to_its_pose() {
    let cell = cell("two_sawyers.toml");
    let joints = "--joints=0.3,-1.18,0.1,2.18,0,0.57,3.3161";
    let forward = json(&["solve", "fk", "--cell", &cell, "--arm", "right", joints]);
    let mut pose = numbers(&forward["position"]);
    pose.extend(numbers(&forward["quaternion"]));
    let pose = format!("--pose={}", joined(&pose));
    let inverse = json(&["solve", "ik", "--cell", &cell, "--arm", "right", &pose]);
    assert!(inverse["residual"].as_f64().unwrap() < 1e-8);
    let back = format!("--joints={}", joined(&numbers(&inverse["joints"])));
    let again = json(&["solve", "fk", "--cell", &cell, "--arm", "right", &back]);
    for key in ["position", "quaternion"] {
        for (a, b) in numbers(&again[key]).iter().zip(numbers(&forward[key])) {
            assert!((a - b).abs() < 1e-8, "{key}");
        }
    }
    let all = json(&[
        "solve",
        "ik",
        "--cell",
        &cell,
        "--arm",
        "left",
        &pose,
        "--all",
        "--samples",
        "5",
    ]);
    assert!(
        all["curves"]
            .as_array()
            .unwrap()
            .iter()
            .all(|curve| curve.as_array().unwrap().len() <= 5)
    );
}

#[test]
fn bad_arguments_are_rejected_with_the_allowed_values() {
    let sawyers = cell("two_sawyers.toml");
    let six = cell("six_joints.toml");
    for (arguments, code, expected) in [
        (
            vec!["solve", "fk", "--cell", &sawyers, "--joints=1"],
            2,
            "arms of",
        ),
        (
            vec!["solve", "fk", "--cell", &six, "--joints=1,2"],
            2,
            "6 positions are needed",
        ),
        (
            vec!["solve", "ik", "--cell", &six, "--pose=1,2,3"],
            2,
            "seven numbers",
        ),
        (
            vec!["solve", "ik", "--cell", &six, "--pose=5,0,0,1,0,0,0"],
            3,
            "the nearest found is",
        ),
        (
            vec!["solve", "fk", "--cell", "none.toml", "--joints=1"],
            2,
            "no cell preset of this name",
        ),
        (vec!["check", &six], 0, "UR-like"),
    ] {
        let output = rodlab(Path::new("."), &arguments);
        assert_eq!(output.status.code(), Some(code), "{}", said(&output));
        assert!(said(&output).contains(expected), "{}", said(&output));
    }
}

/// A circle of the gripper above the table.
fn circle(radius: f64) -> String {
    let mut table = "time_s,x_m,y_m,z_m,qw,qx,qy,qz\n".to_owned();
    for k in 0..=60 {
        let angle = std::f64::consts::TAU * f64::from(k) / 60.0;
        let (x, y) = (radius * angle.cos(), radius * angle.sin());
        table.push_str(&format!("{k},{x},{y},0.1,0,1,0,0\n"));
    }
    table
}

#[test]
fn a_planned_circle_passes_a_dry_run_of_stream() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("circle.csv"), circle(0.05)).unwrap();
    let six = cell("six_joints.toml");
    let plan = [
        "plan",
        "joints",
        "circle.csv",
        "--cell",
        &six,
        "--place",
        "auto",
        "--out",
        "joints.csv",
    ];
    let output = rodlab(folder.path(), &plan);
    assert!(output.status.success(), "{}", said(&output));
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(report["largest_jump"].as_f64().unwrap() < 0.05);
    for key in ["velocity_used", "acceleration_used", "jerk_used"] {
        assert!(report[key].as_f64().unwrap() <= 1.0, "{report}");
    }
    let output = rodlab(
        folder.path(),
        &["stream", "joints.csv", "--cell", &six, "--dry-run"],
    );
    assert!(output.status.success(), "{}", said(&output));
    // Three times the speed exceeds the limits.
    let output = rodlab(
        folder.path(),
        &[
            "stream",
            "joints.csv",
            "--cell",
            &six,
            "--dry-run",
            "--speed",
            "9",
        ],
    );
    assert_eq!(output.status.code(), Some(2));
    assert!(said(&output).contains("allowed"), "{}", said(&output));

    fs::write(folder.path().join("circle.csv"), circle(0.9)).unwrap();
    let far = [
        "plan",
        "joints",
        "circle.csv",
        "--cell",
        &six,
        "--place",
        "0.5,0,0",
    ];
    let output = rodlab(folder.path(), &far);
    assert_eq!(output.status.code(), Some(3));
    assert!(
        said(&output).contains("cannot be followed beyond its pose 1 "),
        "{}",
        said(&output)
    );
}

const URDF: &str = r#"<robot name="odd">
  <link name="base"/><link name="a"/><link name="b"/><link name="c"/><link name="d"/><link name="e"/><link name="tip"/>
  <joint name="j1" type="revolute"><origin xyz="0.1 0.2 0.3" rpy="0.1 -0.2 0.3"/><parent link="base"/><child link="a"/><axis xyz="0 1 1"/><limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
  <joint name="j2" type="prismatic"><origin xyz="0 0 0.2" rpy="1.1 0.4 -0.6"/><parent link="a"/><child link="b"/><axis xyz="1 0 2"/><limit lower="-0.3" upper="0.4" effort="1" velocity="1"/></joint>
  <joint name="j3" type="revolute"><origin xyz="0.3 0 0" rpy="-1.5 0 0.2"/><parent link="b"/><child link="c"/><axis xyz="0 0 -1"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
  <joint name="f" type="fixed"><origin xyz="0 0.1 0" rpy="0.5 0.5 0.5"/><parent link="c"/><child link="d"/></joint>
  <joint name="j4" type="revolute"><origin xyz="0 0 0.25" rpy="0 1.2 0"/><parent link="d"/><child link="e"/><axis xyz="1 0 0"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
  <joint name="t" type="fixed"><origin xyz="0.02 0.03 0.1" rpy="-0.4 0.2 2.8"/><parent link="e"/><child link="tip"/></joint>
</robot>"#;

const PINOCCHIO: &str = r"
import json, sys
import pinocchio
model = pinocchio.buildModelFromUrdf(sys.argv[1])
data = model.createData()
frame = model.getFrameId('tip')
for line in sys.stdin:
    q = pinocchio.utils.np.array(json.loads(line))
    pinocchio.framesForwardKinematics(model, data, q)
    jacobian = pinocchio.computeFrameJacobian(model, data, q, frame, pinocchio.LOCAL_WORLD_ALIGNED)
    pose = pinocchio.SE3ToXYZQUAT(data.oMf[frame])
    print(json.dumps({'pose': list(pose), 'jacobian': jacobian.T.tolist()}))
";

/// A Python with pinocchio, in the build directory since it is large.
fn pinocchio() -> Option<PathBuf> {
    python_with("pinocchio", "pin>=3", "to compare kinematics with")
}

/// An arm of a cell file as a URDFwith the hand named `tip`.
fn urdf_of(chain: &Chain) -> String {
    let mut text = r#"<robot name="arm"><link name="base"/>"#.to_owned();
    let mut parent = "base".to_owned();
    let mut add = |child: &str, origin: &Pose, kind: &str, rest: &str| {
        let (x, y, z) = (
            origin.translation.x,
            origin.translation.y,
            origin.translation.z,
        );
        let (roll, pitch, yaw) = origin.rotation.euler_angles();
        text.push_str(&format!(
            r#"<link name="{child}"/><joint name="to_{child}" type="{kind}"><origin xyz="{x} {y} {z}" rpy="{roll} {pitch} {yaw}"/>
               <parent link="{parent}"/><child link="{child}"/>{rest}</joint>"#
        ));
        parent = child.to_owned();
    };
    for segment in &chain.segments {
        match &segment.motion {
            Motion::Driven { axis, joint, .. } => {
                let limits = chain.joints[*joint].limits;
                let rest = format!(
                    r#"<axis xyz="{} {} {}"/><limit lower="{}" upper="{}" effort="1" velocity="1"/>"#,
                    axis.x, axis.y, axis.z, limits.lower, limits.upper
                );
                add(&segment.link, &segment.origin, "revolute", &rest);
            }
            Motion::Fixed => add(&segment.link, &segment.origin, "fixed", ""),
        }
    }
    add("tip", &chain.tool, "fixed", "");
    text + "</robot>"
}

#[test]
fn pinocchio_puts_the_hands_of_arms_in_the_same_places() {
    let Some(python) = pinocchio() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("odd.urdf");
    fs::write(&path, URDF).unwrap();
    let odd = read_urdf(&path, None, None).unwrap().chain;
    compare_with_pinocchio(&python, &path, &odd, 1e-12);
    for name in ["two_sawyers.toml", "seven_joints.toml", "six_joints.toml"] {
        let arm = Cell::read(cell(name).as_ref()).unwrap().arms.remove(0);
        let path = folder.path().join("arm.urdf");
        fs::write(&path, urdf_of(&arm.chain)).unwrap();
        // The angles of the pose are rounded more than the pose itself.
        compare_with_pinocchio(&python, &path, &arm.chain, 1e-9);
        // Reading the file again gives the same chain.
        let read = read_urdf(&path, None, None).unwrap().chain;
        compare_with_pinocchio(&python, &path, &read, 1e-12);
    }
}

fn compare_with_pinocchio(python: &Path, urdf: &Path, chain: &Chain, tolerance: f64) {
    use std::io::Write;
    let postures: Vec<Vec<f64>> = (0..100).map(|k| chain.start(k)).collect();
    let mut process = Command::new(python)
        .args(["-c", PINOCCHIO])
        .arg(urdf)
        .stdin(std::process::Stdio::piped())
        .stdout(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let lines: String = postures
        .iter()
        .map(|q| format!("{}\n", serde_json::json!(q)))
        .collect();
    process
        .stdin
        .take()
        .unwrap()
        .write_all(lines.as_bytes())
        .unwrap();
    let output = process.wait_with_output().unwrap();
    assert!(output.status.success(), "pinocchio: {}", output.status);
    let answers = String::from_utf8(output.stdout).unwrap();
    assert_eq!(answers.lines().count(), postures.len());
    for (joints, answer) in postures.iter().zip(answers.lines()) {
        let answer: Value = serde_json::from_str(answer).unwrap();
        let [x, y, z, qx, qy, qz, qw] = numbers(&answer["pose"]).try_into().unwrap();
        let theirs = pose([x, y, z], [qw, qx, qy, qz]).unwrap();
        let (hand, jacobian) = chain.hand_and_jacobian(joints);
        let (distance, angle) = distance_and_angle(&hand, &theirs);
        assert!(
            distance < tolerance && angle < 1e-7,
            "{distance:e} {angle:e}"
        );
        for (ours, theirs) in jacobian
            .columns()
            .iter()
            .zip(answer["jacobian"].as_array().unwrap())
        {
            for (a, b) in ours.iter().zip(numbers(theirs)) {
                assert!((a - b).abs() < tolerance, "{a} {b}");
            }
        }
    }
}
