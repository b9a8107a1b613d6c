//! Kinematics against finite differences, closed forms and degenerate chains.

use super::*;
use nalgebra::{UnitVector3, Vector3};
use std::f64::consts::{FRAC_PI_2, PI};

pub(crate) fn revolute(origin: Pose, limits: (f64, f64)) -> (Joint, Pose) {
    let joint = Joint {
        name: String::new(),
        kind: JointKind::Revolute,
        limits: Limits {
            lower: limits.0,
            upper: limits.1,
            velocity: 1.0,
            acceleration: 1.0,
            jerk: 1.0,
        },
    };
    (joint, origin)
}

pub(crate) fn chain(joints: Vec<(Joint, Pose)>, tool: Pose) -> Chain {
    let segments = joints
        .iter()
        .enumerate()
        .map(|(k, (joint, origin))| Segment {
            link: format!("link{k}"),
            origin: *origin,
            motion: Motion::Driven {
                kind: joint.kind,
                axis: Vector3::z_axis(),
                joint: k,
                ratio: 1.0,
                offset: 0.0,
            },
        });
    Chain {
        segments: segments.collect(),
        followers: Vec::new(),
        joints: joints.into_iter().map(|(joint, _)| joint).collect(),
        tool,
    }
}

/// The kinematics of a Universal Robots arm: shoulder, three parallel joints, two wrist joints.
fn ur() -> Chain {
    let at = |position, angles| revolute(pose_of_angles(position, angles), (-2.0 * PI, 2.0 * PI));
    chain(
        vec![
            at([0.0, 0.0, 0.1625], [0.0; 3]),
            at([0.0; 3], [FRAC_PI_2, 0.0, 0.0]),
            at([-0.425, 0.0, 0.0], [0.0; 3]),
            at([-0.3922, 0.0, 0.1333], [0.0; 3]),
            at([0.0, -0.0997, 0.0], [FRAC_PI_2, 0.0, 0.0]),
            at([0.0, 0.0996, 0.0], [FRAC_PI_2, PI, PI]),
        ],
        Pose::identity(),
    )
}

/// Number of postures of the arm above for a pose by its closed form (Hawkins 2013): shoulder ±, wrist ±, elbow ±.
fn closed_form_count(target: &Pose) -> usize {
    let (d4, d6, a2, a3) = (0.1333_f64, 0.0996_f64, 0.425_f64, 0.3922_f64);
    let hand_axis = target.rotation * Vector3::z();
    let wrist = target.translation.vector - d6 * hand_axis;
    let radius = wrist.x.hypot(wrist.y);
    if radius < d4 {
        return 0;
    }
    let mut count = 0;
    for shoulder in [1.0, -1.0] {
        let q1 = wrist.y.atan2(wrist.x) + shoulder * (d4 / radius).acos() + FRAC_PI_2;
        let side = target.translation.x * q1.sin() - target.translation.y * q1.cos();
        let cosine = (side - d4) / d6;
        if cosine.abs() > 1.0 {
            continue;
        }
        for wrist_sign in [1.0, -1.0] {
            let q5 = wrist_sign * cosine.acos();
            // The axes of the hand in the wrist frame give q6; the three parallel joints form a
            // planar arm.
            let (x, y) = (
                target.rotation * Vector3::x(),
                target.rotation * Vector3::y(),
            );
            let across = Vector3::new(q1.sin(), -q1.cos(), 0.0);
            let q6 = (-y.dot(&across) / q5.sin()).atan2(x.dot(&across) / q5.sin());
            let chain = ur();
            // Remove the last two joints, which gives the pose of the fourth link.
            let last = chain.segments[4].pose(&[0.0, 0.0, 0.0, 0.0, q5, 0.0])
                * chain.segments[5].pose(&[0.0, 0.0, 0.0, 0.0, 0.0, q6]);
            let fourth = target * last.inverse();
            let first = chain.segments[0].pose(&[q1, 0.0, 0.0, 0.0, 0.0, 0.0])
                * chain.segments[1].pose(&[0.0; 6]);
            let planar = (first.inverse() * fourth).translation;
            let reach = planar.x.hypot(planar.y);
            if (a2 - a3).abs() < reach && reach < a2 + a3 {
                count += 2;
            }
        }
    }
    count
}

#[test]
fn every_branch_of_a_six_joint_arm_is_found() {
    let chain = ur();
    let mut eights = 0;
    for k in 0..100 {
        let target = chain.hand(&chain.start(1000 + k));
        let branches = chain.branches(&target);
        assert_eq!(branches.len(), closed_form_count(&target), "pose {k}");
        eights += usize::from(branches.len() == 8);
        for joints in &branches {
            let (distance, angle) = distance_and_angle(&chain.hand(joints), &target);
            assert!(distance < 1e-9 && angle < 1e-9);
            assert!(joints.iter().all(|q| q.abs() <= PI + 1e-9));
        }
    }
    assert!(eights > 50, "{eights}");
}

#[test]
fn the_jacobian_is_the_derivative_of_the_hand() {
    let mut chain = ur();
    chain.tool = pose_of_angles([0.1, 0.05, 0.2], [0.1, 0.2, 0.3]);
    // A prismatic joint, and a joint that mimics another with a gear ratio.
    chain.segments[2].motion = Motion::Driven {
        kind: JointKind::Prismatic,
        axis: UnitVector3::new_normalize(Vector3::new(1.0, 2.0, -1.0)),
        joint: 2,
        ratio: 1.0,
        offset: 0.1,
    };
    chain.segments[4].motion = Motion::Driven {
        kind: JointKind::Revolute,
        axis: Vector3::y_axis(),
        joint: 1,
        ratio: -0.5,
        offset: 0.3,
    };
    let joints = [0.3, -1.1, 0.2, 0.7, 0.0, -2.0];
    let (hand, jacobian) = chain.hand_and_jacobian(&joints);
    assert_eq!(hand, chain.hand(&joints));
    for k in 0..6 {
        let moved = |by: f64| {
            let mut joints = joints;
            joints[k] += by;
            chain.hand(&joints)
        };
        let h = 1e-5;
        let slope = difference(&moved(-h), &moved(h)) / (2.0 * h);
        assert!((slope - jacobian.columns()[k]).norm() < 1e-9, "joint {k}");
    }
}

#[test]
fn a_stretched_arm_is_singular() {
    let chain = ur();
    let stretched = Posture::new(&chain, &[0.0; 6], None);
    assert!(stretched.distance_to_singularity < 1e-12 && stretched.manipulability < 1e-12);
    let bent = Posture::new(&chain, &[0.0, -1.2, 1.6, -2.0, -1.5, 0.0], None);
    assert!(bent.distance_to_singularity > 0.05, "{bent:?}");
    assert!((bent.distance_to_limits.unwrap() - (2.0 * PI - 2.0)).abs() < 1e-12);
}

#[test]
fn a_pose_out_of_reach_is_answered_by_the_nearest_one() {
    let chain = ur();
    let target = pose_of_angles([3.0, 0.0, 0.1625], [0.0; 3]);
    let nearest = chain.reach(&target, &[0.0; 6]).unwrap_err();
    assert!(
        nearest.distance > 1.9 && nearest.distance < 2.3,
        "{nearest:?}"
    );
    assert!(chain.branches(&target).is_empty());
}

#[test]
fn self_motion_does_not_move_the_hand() {
    let mut joints: Vec<_> = ur()
        .segments
        .iter()
        .map(|s| revolute(s.origin, (-3.0, 3.0)))
        .collect();
    joints.insert(
        2,
        revolute(
            pose_of_angles([-0.2, 0.0, 0.0], [0.3, 0.0, 0.0]),
            (-3.0, 3.0),
        ),
    );
    let chain = chain(joints, Pose::identity());
    let target = chain.hand(&[0.2, -1.0, 0.4, 1.2, 0.3, -1.0, 0.5]);
    let curves = chain.self_motions(&target);
    assert!(!curves.is_empty());
    for curve in &curves {
        for joints in curve {
            assert!(chain.outside_limits(joints).is_none());
            let (distance, angle) = distance_and_angle(&chain.hand(joints), &target);
            assert!(distance < 1e-9 && angle < 1e-9);
        }
        for pair in curve.windows(2) {
            let gap = super::self_motion::separation(&pair[0], &pair[1]);
            assert!(gap > 0.02 && gap < 0.16, "{gap}");
        }
    }
    assert!(ur().self_motions(&ur().hand(&[0.3; 6])).is_empty());
}

const TWO_LINKS: &str = r#"<robot name="two">
  <link name="base"/>
  <link name="upper"><collision><origin xyz="0 0 0.2"/><geometry><cylinder radius="0.04" length="0.4"/></geometry></collision></link>
  <link name="lower"/><link name="slide"/><link name="mirror"/>
  <joint name="a" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/><limit effort="1" velocity="2"/></joint>
  <joint name="b" type="revolute"><origin xyz="0 0 0.4"/><parent link="upper"/><child link="lower"/><axis xyz="0 1 0"/><limit lower="-1" upper="2" effort="1" velocity="3"/></joint>
  <joint name="c" type="prismatic"><origin xyz="0 0 0.3" rpy="0 0 0"/><parent link="lower"/><child link="slide"/><axis xyz="0 0 1"/><limit lower="0" upper="0.1" effort="1" velocity="0.5"/></joint>
  <joint name="m" type="revolute"><parent link="slide"/><child link="mirror"/><axis xyz="0 1 0"/><limit lower="-9" upper="9" effort="1" velocity="3"/><mimic joint="b" multiplier="-1" offset="0.5"/></joint>
</robot>"#;

fn urdf(text: &str) -> Result<UrdfArm, UrdfError> {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("arm.urdf");
    std::fs::write(&path, text).unwrap();
    read_urdf(&path, None, None)
}

#[test]
fn a_urdf_gives_sliding_turning_and_mimicking_joints() {
    let arm = urdf(TWO_LINKS).unwrap();
    let names: Vec<&str> = arm
        .chain
        .joints
        .iter()
        .map(|joint| joint.name.as_str())
        .collect();
    assert_eq!(names, ["a", "b", "c"]);
    assert_eq!(arm.chain.joints[0].limits.lower, f64::NEG_INFINITY);
    assert_eq!(arm.bodies.len(), 1);
    let hand = arm.chain.hand(&[0.3, 0.4, 0.05]);
    let expected = Vector3::new(
        0.4 * 0.3_f64.sin() + 0.35 * 0.7_f64.sin(),
        0.0,
        0.4 * 0.3_f64.cos() + 0.35 * 0.7_f64.cos(),
    );
    assert!((hand.translation.vector - expected).norm() < 1e-15);
    // Sum of the angles: 0.3 + 0.4 − 0.4 + 0.5.
    assert!((hand.rotation.scaled_axis() - Vector3::y() * 0.8).norm() < 1e-15);
}

/// Text replaced in [`TWO_LINKS`], its replacement, and a part of the error message.
const FAULTS: &str = r#"
<child link="lower"/> | <child link="upper"/> | loop
<parent link="base"/> | <parent link="mirror"/> | loop
<parent link="base"/> | <parent link="bas"/> | `bas` is not in the file
lower="-1" upper="2" | lower="2" upper="-1" | joint `b`: its lower limit 2
<axis xyz="0 0 1"/> | <axis xyz="0 0 0"/> | joint `c`: its axis
mimic joint="b" | mimic joint="z" | `z`, which it mimics, is not in the file
<axis xyz="0 0 1"/> | <axis xyz="0 1"/> | line 7: <axis>: `xyz` is "0 1", expected three numbers
<parent link="lower"/> | | line 7: joint `c` has no <parent>
<link name="lower"/> | <link/> | line 4: <link> of `two` has no `name`
<origin xyz="0 0 0.4"/> | <origin xyz="0 0 ${length}"/> | line 6: <origin>: this is a xacro file; convert it to URDF first: `xacro arm.urdf > arm_expanded.urdf`
<origin xyz="0 0 0.3" rpy="0 0 0"/> | <origin xyz="nan 0 0.3" rpy="0 0 0"/> | joint `c`: `xyz` of its origin is not a finite number
<origin xyz="0 0 0.3" rpy="0 0 0"/> | <origin xyz="0 0 0.3" rpy="0 inf 0"/> | joint `c`: `rpy` of its origin
<axis xyz="0 0 1"/> | <axis xyz="0 0 1e999"/> | joint `c`: `xyz` of its axis
upper="0.1" effort="1" velocity="0.5" | upper="0.1" effort="1" velocity="nan" | joint `c`: `velocity` of its limit
multiplier="-1" | multiplier="inf" | joint `m`: `multiplier`
<cylinder radius="0.04" | <cylinder radius="NaN" | its collision shape: its `radius` NaN is not allowed
type="prismatic" | type="floating" | joint `c`
</robot> | | not a URDF
radius="0.04" | radius="-0.04" | link `upper`: its collision shape: its `radius` -0.04 is not allowed; allowed: above 0
length="0.4" | length="0" | `length` 0
<cylinder radius="0.04" length="0.4"/> | <box size="0.1 -0.1 0.1"/> | `size` -0.1
<cylinder radius="0.04" length="0.4"/> | <mesh filename="t.stl" scale="1 0 1"/> | `scale` 0
velocity="0.5" | velocity="-0.5" | `velocity` of its limit is -0.5
<joint name="c" | <joint name="b" | joint `b` is in the file twice
<link name="slide"/> | <link name="slide"/><link name="base"/> | link `base` is in the file twice
lower="-9" upper="9" | lower="2" upper="3" | joint `m`: its limits, 2 to 3, leave no range for joint `b`, which it mimics
"#;

#[test]
fn faulty_urdfs_are_rejected_with_the_faulty_part() {
    for case in FAULTS.trim().lines() {
        let [good, bad, expected] = *case.split('|').map(str::trim).collect::<Vec<_>>() else {
            panic!("{case}");
        };
        assert!(TWO_LINKS.contains(good));
        let error = urdf(&TWO_LINKS.replace(good, bad)).unwrap_err().to_string();
        assert!(
            error.contains(expected) && error.contains("arm.urdf"),
            "{error}"
        );
    }
}

/// Additions and replacements in [`TWO_LINKS`] that kinematics ignores, or for which there is a
/// default.
const HARMLESS: &str = r#"
<link name="slide"/> | <link name="slide"><inertial><mass/><inertia ixx="1"/></inertial><visual><geometry><mesh/></geometry><material name="m"><texture/><color rgba="1 0 0"/></material></visual></link> |
<link name="slide"/> | <link name="slide"><visual/><visual><origin xyz="a"/><geometry><teapot/></geometry></visual></link> |
<link name="slide"/> | <link name="slide"/><material/><transmission><joint name="a"/></transmission><gazebo reference="x"><link/></gazebo><self_collision_checking/> |
<link name="slide"/> | <link name="slide"/><loop_joint name="l" type="spherical"><link1/></loop_joint><d:joint xmlns:d="http://d"/> |
<cylinder radius="0.04" length="0.4"/> | <mesh filename="upper.stl"/> |
<cylinder radius="0.04" length="0.4"/> | <mesh filename="upper.dae" scale="0.001"/> |
<cylinder radius="0.04" length="0.4"/> | <plane/> | link `upper`: collision shapes <plane>
<geometry><cylinder radius="0.04" length="0.4"/></geometry> | | without a shape
<limit lower="-1" upper="2" effort="1" velocity="3"/> | | joint `b` does not state all of its <limit>; assumed: a range from -π to π, a velocity of at most 1 rad/s
lower="-1" upper="2" effort="1" velocity="3" | lower="-1" upper="2" | velocity of at most 1 rad/s
upper="0.1" effort="1" velocity="0.5" | upper="0.1" velocity="0" | velocity of at most 0.1 m/s
</robot> | <joint name="f" type="floating"><parent link="base"/><child link="free"/></joint><link name="free"/></robot> | the tip is link `mirror`
</robot> | <joint name="f" type="fixed"><parent link="upper"/><child link="base_frame"/></joint><link name="base_frame"/></robot> |
"#;

#[test]
fn unused_elements_do_not_reject_a_urdf() {
    for case in HARMLESS.trim().lines() {
        let [good, other, note] = *case.split('|').map(str::trim).collect::<Vec<_>>() else {
            panic!("{case}");
        };
        assert!(TWO_LINKS.contains(good), "{case}");
        let text = TWO_LINKS.replacen(good, other, 1);
        if text.contains("base_frame") {
            // With a second moving end, the tip must be given.
            let error = urdf(&text).unwrap_err().to_string();
            assert!(
                error.contains("base_frame (1 moving joint), mirror (4 moving joints)"),
                "{error}"
            );
            continue;
        }
        let arm = urdf(&text).unwrap_or_else(|error| panic!("{case}: {error}"));
        assert_eq!(arm.chain.joints.len(), 3);
        assert!(arm.notes.concat().contains(note), "{case}: {:?}", arm.notes);
        assert_eq!(arm.notes.is_empty(), note.is_empty(), "{:?}", arm.notes);
    }
    for (text, expected) in [
        (
            "<mujoco/>",
            "`python -c \"from mjcf_urdf_simple_converter import convert; convert('arm.urdf', 'arm_expanded.urdf')\"`",
        ),
        (
            "<sdf version='1.6'/>",
            "sdf2urdf.py arm.urdf arm_expanded.urdf",
        ),
        ("<html/>", "line 1: its root is <html>, expected <robot>"),
        (
            "<robot name='r' xmlns:xacro='http://www.ros.org/wiki/xacro'><xacro:arm/></robot>",
            "line 1: <arm>: this is a xacro file",
        ),
    ] {
        let error = urdf(text).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
    // Latin-1, as some editors write it.
    let latin = TWO_LINKS.replace(
        "<robot",
        "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?><!-- gr\u{fc}n --><robot",
    );
    let bytes: Vec<u8> = latin
        .chars()
        .map(|letter| u32::from(letter) as u8)
        .collect();
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("latin.urdf");
    std::fs::write(&path, bytes).unwrap();
    assert!(read_urdf(&path, None, None).is_ok());
}

#[test]
fn limits_of_mimic_joints_narrow_those_of_the_joint_they_follow() {
    // The follower is at 0.5 − 2b; it is between −0.5 and 1 if b is between −0.25 and 0.5.
    let narrow = r#"lower="-0.5" upper="1" effort="1" velocity="1""#;
    let text = TWO_LINKS.replace(r#"lower="-9" upper="9" effort="1" velocity="3""#, narrow);
    let text = text.replace(r#"multiplier="-1""#, r#"multiplier="-2""#);
    let limits = urdf(&text).unwrap().chain.joints[1].limits;
    assert_eq!((limits.lower, limits.upper), (-0.25, 0.5));
    assert_eq!(limits.velocity, 0.5);
}

#[test]
fn nested_and_large_urdfs_are_refused_at_once() {
    let deep = TWO_LINKS.replace(
        "</robot>",
        &format!("{}{}</robot>", "<b>".repeat(20_000), "</b>".repeat(20_000)),
    );
    let error = urdf(&deep).unwrap_err().to_string();
    assert!(error.contains("nested more than 100 levels"), "{error}");
    let links: String = (0..1000)
        .map(|k| format!("<link name=\"more{k}\"/>"))
        .collect();
    let error = urdf(&TWO_LINKS.replace("</robot>", &format!("{links}</robot>")))
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("1005 links; allowed: at most 1000"),
        "{error}"
    );
}

/// A tetrahedron with one corner at the origin and one a unit along each axis, as an STL file.
const TETRAHEDRON: &str = "solid t
facet normal 0 0 -1 outer loop vertex 0 0 0 vertex 0 1 0 vertex 1 0 0 endloop endfacet
facet normal 0 -1 0 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 0 1 endloop endfacet
facet normal -1 0 0 outer loop vertex 0 0 0 vertex 0 0 1 vertex 0 1 0 endloop endfacet
facet normal 1 1 1 outer loop vertex 1 0 0 vertex 0 1 0 vertex 0 0 1 endloop endfacet
endsolid t
";

#[test]
fn a_mesh_of_a_urdf_keeps_the_distance_of_its_convex_hull() {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("t.stl"), TETRAHEDRON).unwrap();
    let path = directory.path().join("arm.urdf");
    let mesh = r#"<mesh filename="t.stl" scale="0.1 0.1 0.1"/>"#;
    let text = TWO_LINKS.replace(r#"<cylinder radius="0.04" length="0.4"/>"#, mesh);
    std::fs::write(&path, text.replace("0 0 0.2", "0.3 0 0")).unwrap();
    let arm = read_urdf(&path, None, None).unwrap();
    assert!(arm.meshes.is_empty());
    let Shape::Hull(hull) = &arm.bodies[0].shape else {
        panic!("{:?}", arm.bodies);
    };
    let points: Vec<_> = hull.outlines().concat();
    assert!(
        points
            .iter()
            .flatten()
            .all(|x| (x.abs() - 0.05).abs() < 1e-12)
    );
    let member = Member {
        name: "arm".into(),
        home: vec![0.0; arm.chain.joints.len()],
        chain: arm.chain,
        base: Pose::identity(),
        bodies: arm.bodies,
        may_touch: Vec::new(),
    };
    // The slanted face is x + y + z = 0.1 beyond (0.3, 0, 0); the box is in front of its middle,
    // with a corner towards it.
    let stand = |away: f64| StandingBox {
        name: "box".into(),
        pose: pose_of_angles([0.3 + away, away, away], [0.0; 3]),
        half: [0.02; 3],
    };
    for away in [0.06, 0.08, 0.1] {
        let surroundings = Surroundings::new(vec![member.clone()], vec![stand(away)]);
        let expected = (3.0 * (away - 0.02) - 0.1) / 3.0_f64.sqrt();
        let found = surroundings.clearance(&surroundings.homes(), None);
        assert!((found - expected).abs() < 1e-6, "{found} {expected}");
    }
    let far = TETRAHEDRON.replace("vertex 0 0 1 ", "vertex 0 0 1e300 ");
    std::fs::write(directory.path().join("t.stl"), far).unwrap();
    let error = read_urdf(&path, None, None).unwrap_err().to_string();
    assert!(error.contains("corners beyond 1000000 m"), "{error}");
    std::fs::write(directory.path().join("t.stl"), "solid t\nendsolid t\n").unwrap();
    let error = read_urdf(&path, None, None).unwrap_err().to_string();
    assert!(
        error.contains("link `upper`") && error.contains("spans no surface"),
        "{error}"
    );
}
