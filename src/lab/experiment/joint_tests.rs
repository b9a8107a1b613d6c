//! Joints, bodies and networks from scenario files: rejected input with its messages, and the
//! resolved elements.

use crate::scenario::{JointKind, Place, Scenario, Shape, SpringOnly};
use crate::test_support::{assert_reads_back, cases, loaded, simulation};

const RODS: &str = "experiment = \"scene\"\n[material]\nyoungs_modulus = 1e6\npoissons_ratio = 0.5\ndensity = 1000.0\n\
    [[rods]]\nname = \"post\"\nradius = 0.005\nedges = 10\nshape = { kind = \"straight\", start = [0, 0, 0], end = [0, 0, 0.5] }\n\
    [[rods]]\nname = \"boom\"\nradius = 0.005\nedges = 10\nshape = { kind = \"straight\", start = [0, 0, 0.5], end = [0.5, 0, 0.5] }\n";
/// A ball around the end of the boom that is large enough to reach the post.
const BALL: &str = "[[bodies]]\nrod = \"boom\"\nat = \"end\"\nmass = \"1 g\"\nshape = { kind = \"sphere\", radius = 0.6 }\n";
const NET: &str = "[[networks]]\nrod = { radius = \"1 mm\", edges = 2 }\n";

fn scenario(rest: &str) -> Result<Scenario, String> {
    let text = format!(
        "{RODS}{rest}
[time]
end = 0.01
"
    );
    simulation("rods", &text)?;
    Ok(loaded("rods", &text)?.scenario)
}

fn joint(kind: &str, at: &str) -> String {
    format!(
        "[[joints]]\nname = \"knee\"\nkind = \"{kind}\"\nrods = [\"post\", \"boom\"]\nat = {at}\n"
    )
}

#[test]
fn clamps_may_hold_the_frame_of_a_rigid_joint() {
    let clamp = "[[clamps]]\nrod = \"boom\"\nat = \"start\"\n";
    scenario(&(joint("rigid", "[\"end\", \"start\"]") + clamp)).unwrap();
    let net = format!(
        "{NET}joint = \"rigid\"\nboundary = {{ hold = \"both\" }}\n\
         shape = {{ kind = \"grid\", sides = [[1, 0, 0], [0, 1, 0]], rods = [3, 3] }}\n"
    );
    scenario(&net).unwrap();
}

#[test]
fn faults_name_the_joint_and_what_is_allowed() {
    let table = r#"
        glue ["end", "start"] => ball
        ball ["end", 11] => allowed: 0 to 10
        ball ["end", "end"] => 5.000000e-1 m apart
        hinge ["end", "start"] => missing key `axis`
        hinge ["end", "start"]; axis = [0, 1, 0]; rest_angle = 1 => missing key `stiffness`
        hinge ["end", "start"]; axis = [0, 1, 0]; stiffness = "1 N m" => but this key takes a turning stiffness
        slide ["end", "start"]; friction = -0.1 => allowed: at least 0
        slide ["end", "start"]; presliding = 1e-6 => missing key `friction`
        spring ["end", 4] => missing key `stiffness`
        spring ["end", 4]; stiffness = 0 => allowed: greater than 0
        spring ["end", 4]; stiffness = 1; rest_length = -1 => allowed: at least 0
        spring ["end", 4]; turning_stiffness = 1; rest_length = 1 => missing key `stiffness`
        spring ["end", 4]; turning_stiffness = 1; break_at = 1 => missing key `stiffness`
        spring ["end", 4]; turning_stiffness = "1 N/m" => but this key takes a turning stiffness
        spring ["end", 4]; stiffness = 1; rest_rotation = [1, 0, 0] => missing key `turning_stiffness`
        spring ["end", 4]; turning_stiffness = 1; rest_rotation = ["200 deg", 0, 0] => allowed: up to π
        spring ["end", 4]; turning_stiffness = 1; only = "tension" => missing key `stiffness`
        spring ["end", 4]; stiffness = 1; only = "shear" => tension
        spring ["end", 4]; stiffness = 1; only = "compression"; rest_length = 0 => is never compressed
        spring ["end", 4]; stiffness = 1; axis = [0, 1, 0] => unknown key
        spring ["end", 4]; stiffness = 1; break_at = 0 => allowed: greater than 0
        rigid ["end", "start"]; break_at_moment = "1 N" => but this key takes a moment
        ball ["end", "start"]; break_at_moment = 1 => unknown key
        spring ["end", 4]; stiffness = 1; break_at_moment = 1 => missing key `turning_stiffness`
        slide ["start", 4] => m apart, but must be at one point
        slide ["end", 11] => allowed: 0 to 10
        slide ["end", "start"]; stiffness = 1 => unknown key
        slide ["end", "start"]; break_at = -1 => allowed: greater than 0
        spring ["end", "start"]; stiffness = 1; rest_length = "1 cm" => set the rest length to 0
        hinge ["end", "start"]; axis = [0, 1, 0]; [[clamps]]; rod = "boom"; at = "start" => let the clamp hold only the position
    "#;
    let of_one_joint = cases(table).map(|(text, expected)| {
        let (head, keys) = text.split_once('\n').unwrap_or((&text, ""));
        let (kind, at) = head.split_once(' ').unwrap();
        (joint(kind, at) + keys + "\n", expected)
    });
    let others = [(joint("rigid", "[\"end\", \"start\"]")
                + &joint("spring", "[\"end\", \"start\"]").replace("knee", "tie")
                + "turning_stiffness = 1\n", "`tie`: its nodes cannot turn relative to each other"), (joint("slide", "[4, 5]").replace("boom", "post"), "5.000000e-2 m apart"), (joint("slide", "[\"end\", \"start\"]")
                + &joint("rigid", "[\"end\", \"start\"]").replace("knee", "weld"), "`knee`: its first node is joined to the rod along which it should slide"), (joint("slide", "[\"end\", \"start\"]")
                + &joint("slide", "[\"end\", \"start\"]").replace("knee", "again"), "`again`: its first node already slides along another rod"), (joint("ball", "[\"end\", \"start\"]")
                + "break_at = 1\n"
                + &joint("rigid", "[\"end\", \"start\"]"), "`joints.0.break_at`: `knee`: cannot break, because other joints share its point"), (joint("hinge", "[\"end\", \"start\"]")
                + "axis = [0, 1, 0]\nbreak_at_moment = 1\n"
                + &joint("ball", "[\"end\", \"start\"]").replace("knee", "ball"), "`joints.0.break_at_moment`: `knee`: cannot break, because other joints share its point"), (joint("ball", "[\"end\", \"start\"]")
                + &joint("spring", "[\"end\", \"start\"]").replace("knee", "tie")
                + "stiffness = 1\n", "`tie`: other joints already hold its nodes at one point"), (joint("spring", "[4, 4]").replace("boom", "post") + "stiffness = 1\n", "joins a node to itself"), (joint("rigid", "[\"end\", \"start\"]").replace("boom", "bom"), "boom"), (joint("rigid", "[\"end\", \"start\"]") + &joint("rigid", "[\"end\", \"start\"]"), "already hold"), ("[[bodies]]\nrod = \"boom\"\nat = \"end\"\n".to_owned(), "missing key `mass`"), ("[[bodies]]\nrod = \"boom\"\nat = \"end\"\nmass = \"1 g\"\ninertia = [1, 1, 3]\n".to_owned(), "no rigid body has such moments"), ("[[bodies]]\nrod = \"boom\"\nat = \"end\"\nmass = \"1 g\"\nshape = { kind = \"disk\" }\n".to_owned(), "missing key `radius`"), (format!("{BALL}[contact]\nmodel = \"imc\"\n"), "the ball at node 10 of rod `boom`"), (NET.to_owned(), "missing key `shape`"), (format!("{NET}shape = {{ kind = \"grid\", sides = [[1, 0, 0], [2, 0, 0]], rods = [3, 3] }}\n"), "parallel"), (format!("{NET}shape = {{ kind = \"grid\", sides = [[1, 0, 0], [0, 1, 0]], rods = [1, 3] }}\n"), "allowed: 2 to 1000"), (format!("{NET}shape = {{ kind = \"table\", points = [[0, 0, 0], [1, 0, 0]], rods = [[0, 2]] }}\n"), "no point 2; allowed: 0 to 1"), (format!("{NET}shape = {{ kind = \"table\", points = [[0, 0, 0], [1, 0, 0]], rods = [[0, 0]] }}\n"), "same point twice")];
    for (text, expected) in of_one_joint.chain(others) {
        let message = match scenario(&text) {
            Err(message) => message,
            Ok(_) => panic!("{text} is accepted"),
        };
        assert!(message.contains(expected), "{text}\n{message}");
    }
}

#[test]
fn a_scheme_that_extrapolates_from_the_middle_is_refused_beside_frames() {
    let text = format!(
        "{RODS}{}[time]\nscheme = \"implicit-midpoint\"\nend = 1.0\n",
        joint("rigid", "[\"end\", \"start\"]")
    );
    let error = loaded("rods", &text).err().unwrap();
    assert!(error.contains("backward-differences"), "{error}");
    let spring = text.replace("\"rigid\"", "\"spring\"\nturning_stiffness = 1");
    let error = loaded("rods", &spring).err().unwrap();
    assert!(error.contains("springs that turn rods"), "{error}");
    for kind in ["\"ball\"", "\"slide\"", "\"spring\"\nstiffness = 1"] {
        loaded("rods", &text.replace("\"rigid\"", kind)).unwrap();
    }
}

#[test]
fn contact_by_complementarity_supports_every_joint() {
    let hinge = joint("hinge", "[\"end\", \"start\"]") + "axis = [0, 1, 0]\n";
    let others = ["ball", "rigid", "slide"].map(|kind| joint(kind, "[\"end\", \"start\"]"));
    for joint in others.into_iter().chain([hinge]) {
        let text = format!(
            "{RODS}{joint}[contact]\nmodel = \"complementarity\"\n\
             [time]\nscheme = \"implicit-euler\"\nend = 1.0\n"
        );
        simulation("rods", &text).unwrap();
    }
}

#[test]
fn bodies_off_their_node_touch_nothing() {
    let weld = joint("rigid", "[\"end\", \"start\"]");
    let text = format!("{weld}{BALL}offset = [0, 0, \"2 cm\"]\n[contact]\nmodel = \"imc\"\n");
    let scenario = scenario(&text).unwrap();
    assert_eq!(scenario.bodies[0].offset, Some([0.0, 0.0, 0.02]));
    assert_reads_back("rods", &scenario);
}

#[test]
fn what_breaks_needs_time() {
    let text = joint("ball", "[\"end\", \"start\"]") + "break_at = \"1 N\"\n";
    let text = format!("{RODS}{text}[time]\nmode = \"static\"\n");
    let error = loaded("rods", &text).err().unwrap();
    assert!(
        error.contains("`joints.0.break_at`") && error.contains("\"dynamic\""),
        "{error}"
    );
}

#[test]
fn springs_read_back_to_themselves() {
    let text = joint("spring", "[\"end\", 4]")
        + "stiffness = \"2 N/mm\"\nbreak_at = \"3 mN\"\n"
        + &joint("spring", "[3, 4]").replace("knee", "tie")
        + "stiffness = 1\nrest_length = \"3 cm\"\n"
        + &joint("hinge", "[\"end\", \"start\"]").replace("knee", "sprung")
        + "axis = [0, 1, 0]\nstiffness = \"1 N mm/rad\"\nrest_angle = \"90 deg\"\n"
        + &joint("spring", "[7, 8]").replace("knee", "coil")
        + "turning_stiffness = \"2 N mm/rad\"\nrest_rotation = [0, 0, \"90 deg\"]\n";
    let scenario = scenario(&text).unwrap();
    let kinds: Vec<JointKind> = scenario.joints.iter().map(|joint| joint.kind).collect();
    let spring = |stiffness, rest_length| JointKind::Spring {
        stiffness: Some(stiffness),
        rest_length,
        only: None,
        turning_stiffness: None,
        rest_rotation: None,
    };
    assert_eq!(
        kinds,
        [
            spring(2000.0, None),
            spring(1.0, Some(0.03)),
            JointKind::Hinge {
                axis: [0.0, 1.0, 0.0],
                stiffness: Some(1e-3),
                rest_angle: Some(std::f64::consts::FRAC_PI_2),
            },
            JointKind::Spring {
                stiffness: None,
                rest_length: None,
                only: None,
                turning_stiffness: Some(2e-3),
                rest_rotation: Some([0.0, 0.0, std::f64::consts::FRAC_PI_2]),
            },
        ]
    );
    let strengths = scenario.joints.iter().map(|joint| joint.break_at);
    assert!(strengths.eq([Some(3e-3), None, None, None]));
    assert_reads_back("rods", &scenario);
}

#[test]
fn one_sided_springs_read_back_to_themselves() {
    for (word, only) in [
        ("tension", SpringOnly::Tension),
        ("compression", SpringOnly::Compression),
    ] {
        let keys = format!("stiffness = 1\nrest_length = 0.1\nonly = \"{word}\"\n");
        let scenario = scenario(&(joint("spring", "[\"end\", 4]") + &keys)).unwrap();
        let found = match scenario.joints[0].kind {
            JointKind::Spring { only, .. } => only,
            _ => None,
        };
        assert_eq!(found, Some(only));
        assert_reads_back("rods", &scenario);
    }
}

#[test]
fn slides_read_back_to_themselves() {
    let slide = joint("slide", "[\"end\", \"start\"]");
    for (keys, friction, presliding, break_at) in [
        ("break_at = \"3 mN\"", None, None, Some(3e-3)),
        ("friction = 0.3", Some(0.3), None, None),
        (
            "friction = 0.3\npresliding = \"2 um\"",
            Some(0.3),
            Some(2e-6),
            None,
        ),
    ] {
        let scenario = scenario(&format!("{slide}{keys}\n")).unwrap();
        let joint = &scenario.joints[0];
        let kind = JointKind::Slide {
            friction,
            presliding,
        };
        assert_eq!((joint.kind, joint.break_at), (kind, break_at));
        assert_reads_back("rods", &scenario);
    }
}

#[test]
fn friction_of_slides_needs_motion() {
    let slide = joint("slide", "[\"end\", \"start\"]");
    let text = format!("{RODS}{slide}friction = 0.3\n");
    for time in ["mode = \"static\"", "end = 1\nbegin = \"equilibrium\""] {
        let text = format!("{text}[time]\n{time}\n");
        let mut without = simulation("rods", &text.replace("0.3\n", "0.0\n")).unwrap();
        assert!(without.find_equilibrium().is_ok());
        let error = loaded("rods", &text).err().unwrap();
        assert!(
            error.contains("`joints.0.friction`") && error.contains("\"dynamic\""),
            "{error}"
        );
    }
}

#[test]
fn a_network_is_its_rods_joints_and_clamps() {
    let text = format!(
        "{NET}name = \"net\"\nboundary = {{ ends = \"corners\", scale = [[0, 1], [1, 0.5]] }}\n\
         shape = {{ kind = \"grid\", sides = [[0.3, 0, 0], [0, 0.2, 0]], rods = [3, 4] }}\n"
    );
    let scenario = scenario(&text).unwrap();
    let rods = &scenario.rods[2..];
    assert_eq!(rods.len(), 7);
    assert_eq!((rods[0].edges, rods[3].edges), (6, 4));
    assert_eq!(scenario.joints.len(), 12);
    assert_eq!(scenario.clamps.len(), 4);
    // The corner has moved to half its distance from the middle.
    let moved = scenario.clamps[0].movement.translation[1].1;
    assert!((moved[0] - 0.075).abs() < 1e-15 && (moved[1] - 0.05).abs() < 1e-15);
    // The resolved scenario reads back to itself.
    let again = loaded("rods", &scenario.to_toml()).unwrap();
    assert_eq!(again.scenario.joints, scenario.joints);
    assert_eq!(again.scenario.rods, scenario.rods);
    assert_eq!(again.scenario.to_toml(), scenario.to_toml());
}

#[test]
fn a_tree_is_joined_where_its_rods_share_points() {
    let text = format!(
        "{NET}name = \"tree\"\njoint = \"rigid\"\nshape = {{ kind = \"table\", points = [[2, 0, 0], [2, 0, 1], [2.5, 0, 1.5], [1.5, 0, 1.5]], rods = [[0, 1, 2], [1, 3]] }}\n"
    );
    let scenario = scenario(&text).unwrap();
    assert_eq!(scenario.joints.len(), 1);
    assert_eq!(scenario.rods[2].edges, 4);
    // Every segment is cut into two edges, from its first point on. The second rod begins at the
    // corner of the first.
    let Shape::Points { points } = &scenario.rods[2].shape else {
        panic!("{:?}", scenario.rods[2].shape);
    };
    let expected = [
        [2.0, 0.0, 0.0],
        [2.0, 0.0, 0.5],
        [2.0, 0.0, 1.0],
        [2.25, 0.0, 1.25],
        [2.5, 0.0, 1.5],
    ];
    assert_eq!(points[..], expected);
    assert_eq!(scenario.joints[0].at, [Place::Number(2), Place::Number(0)]);
}

/// Three strips that meet at a point, two joined rigidly and the third by a hinge, under a small
/// force at the point.
#[test]
fn a_static_frame_of_many_edges_comes_to_rest_under_any_force() {
    for (edges, size) in [(20, 1.0), (80, 1.0), (80, 1e-2), (80, 10.0), (160, 1.0)] {
        let strip = |name: &str, width: &str, end: &str| {
            format!(
                "[[rods]]\nname = \"{name}\"\nedges = {edges}\ncross_section = {{ kind = \"rectangle\", width = \"{width}\", thickness = \"2.4 mm\" }}\n\
                 shape = {{ kind = \"straight\", start = [0, 0, 0], end = {end} }}\n"
            )
        };
        let force = [-0.00018, -0.00093, -0.00027].map(|force: f64| size * force);
        let text = format!(
            "experiment = \"scene\"\nmaterial = {{ youngs_modulus = \"2 GPa\", poissons_ratio = 0.3, density = 1000.0 }}\n\
             time = {{ mode = \"static\" }}\n{}{}{}\
             [[clamps]]\nrod = \"r0\"\nat = \"end\"\n[[clamps]]\nrod = \"r1\"\nat = \"end\"\n\
             [[clamps]]\nrod = \"r2\"\nat = \"end\"\nhold = \"position\"\n\
             [[joints]]\nkind = \"rigid\"\nrods = [\"r0\", \"r1\"]\nat = [\"start\", \"start\"]\n\
             [[joints]]\nkind = \"hinge\"\nrods = [\"r0\", \"r2\"]\nat = [\"start\", \"start\"]\naxis = [0.0905, -0.9959, 0.005]\n\
             [[loads]]\nkind = \"force\"\nrod = \"r0\"\nat = \"start\"\nforce = {force:?}\n",
            strip("r0", "6.6 mm", "[0.012, -0.168, -0.131]"),
            strip("r1", "5.4 mm", "[-0.096, -0.0125, 0.1196]"),
            strip("r2", "5.6 mm", "[-0.1626, -0.1232, -0.1431]"),
        );
        let mut simulation = simulation("frame", &text).unwrap();
        let report = simulation.find_equilibrium();
        let report = report.unwrap_or_else(|error| panic!("{edges} edges, {size}: {error}"));
        assert!(
            report.newton_iterations < 40,
            "{}",
            report.newton_iterations
        );
        // The walls bear the whole force.
        let borne: rodlab_engine::mechanics::Vector3 = [edges, 2 * edges + 1, 3 * edges + 2]
            .map(|node| simulation.reaction(node))
            .into_iter()
            .sum();
        let acting = rodlab_engine::mechanics::Vector3::from(force);
        assert!(
            (borne + acting).norm() < 1e-5 * acting.norm() + 2e-9,
            "{edges} {size}: {borne}"
        );
    }
}
