//! The scripts of other programs, and the cases that a program is left out of.

use super::super::bending;
use super::{Peer, Program};

/// The file that all scripts import.
pub(super) const COMMON: (&str, &str) = ("peer.py", include_str!("peer.py"));

pub(super) static EXUDYN: Program = Program {
    name: "Exudyn",
    package: "exudyn scipy",
    module: "exudyn",
    common: ("exudyn_rod.py", include_str!("exudyn_rod.py")),
};

pub(super) static MUJOCO: Program = Program {
    name: "MuJoCo",
    package: "mujoco",
    module: "mujoco",
    common: ("mujoco_rod.py", include_str!("mujoco_rod.py")),
};

pub(super) static PYELASTICA: Program = Program {
    name: "PyElastica",
    package: "pyelastica",
    module: "elastica",
    common: ("elastica_rod.py", include_str!("elastica_rod.py")),
};

/// Names and embeds a script.
macro_rules! script {
    ($name:literal) => {
        ($name, include_str!($name))
    };
}

const RELAXATION_IN_MUJOCO: &str = "a flex of dimension 1, a discrete elastic rod whose edges keep their lengths, steps with drag to rest by \
     its implicit `discrete` integrator; errors are those of a rod that does not stretch";
const RELAXATION_IN_PYELASTICA: &str = "explicit steps with damping until the rod rests; errors are those of a rod without stretching and shear, \
     whose part is subtracted";
const CABLES: &str = "planar ANCF cables of cubic shape, static solver";
const MOTION: &str =
    "planar ANCF cables of cubic shape, generalized-α method with the time steps of the scenario";
const RIGID: &str =
    "a rigid body, Runge–Kutta method of fourth order with the time steps of the scenario";
const LIMIT: &str = "planar ANCF cables of cubic shape; the loaded point falls in static steps, and the largest force is \
     found by search";

/// Names and texts of the modules that scripts import.
pub(in super::super) static MODULES: [(&str, &str); 4] =
    [COMMON, EXUDYN.common, MUJOCO.common, PYELASTICA.common];

/// All scripts.
pub(in super::super) static PEERS: &[Peer] = &[
    Peer {
        case: "roll-up",
        program: &EXUDYN,
        script: script!("roll-up_exudyn.py"),
        method: CABLES,
        exact: None,
    },
    Peer {
        case: "roll-up",
        program: &MUJOCO,
        script: script!("roll-up_mujoco.py"),
        method: RELAXATION_IN_MUJOCO,
        exact: None,
    },
    Peer {
        case: "roll-up",
        program: &PYELASTICA,
        script: script!("roll-up_elastica.py"),
        method: RELAXATION_IN_PYELASTICA,
        exact: None,
    },
    Peer {
        case: "tip-force",
        program: &EXUDYN,
        script: script!("tip-force_exudyn.py"),
        method: CABLES,
        exact: None,
    },
    Peer {
        case: "tip-force",
        program: &MUJOCO,
        script: script!("tip-force_mujoco.py"),
        method: RELAXATION_IN_MUJOCO,
        exact: Some(|| bending::tip_under_force(f64::INFINITY)),
    },
    Peer {
        case: "tip-force",
        program: &PYELASTICA,
        script: script!("tip-force_elastica.py"),
        method: RELAXATION_IN_PYELASTICA,
        exact: Some(|| bending::tip_under_force(f64::INFINITY)),
    },
    Peer {
        case: "bend-of-45-degrees",
        program: &EXUDYN,
        script: script!("bend-of-45-degrees_exudyn.py"),
        method: "geometrically exact beams with a stiff shear, static solver",
        exact: None,
    },
    Peer {
        case: "bend-of-45-degrees",
        program: &MUJOCO,
        script: script!("bend-of-45-degrees_mujoco.py"),
        method: RELAXATION_IN_MUJOCO,
        exact: Some(|| bending::tip_of_bend(f64::INFINITY)),
    },
    Peer {
        case: "bend-of-45-degrees",
        program: &PYELASTICA,
        script: script!("bend-of-45-degrees_elastica.py"),
        method: RELAXATION_IN_PYELASTICA,
        exact: Some(|| bending::tip_of_bend(f64::INFINITY)),
    },
    Peer {
        case: "deep-arch",
        program: &EXUDYN,
        script: script!("deep-arch_exudyn.py"),
        method: LIMIT,
        exact: None,
    },
    Peer {
        case: "lees-frame",
        program: &EXUDYN,
        script: script!("lees-frame_exudyn.py"),
        method: LIMIT,
        exact: None,
    },
    Peer {
        case: "heavy-column",
        program: &EXUDYN,
        script: script!("heavy-column_exudyn.py"),
        method: "planar ANCF cables of cubic shape; the weight at which the least eigenvalue of the stiffness matrix is zero",
        exact: None,
    },
    Peer {
        case: "strip-on-edge",
        program: &EXUDYN,
        script: script!("strip-on-edge_exudyn.py"),
        method: "geometrically exact beams; the weight at which the least eigenvalue of the stiffness matrix is zero",
        exact: None,
    },
    Peer {
        case: "toggle",
        program: &EXUDYN,
        script: script!("toggle_exudyn.py"),
        method: LIMIT,
        exact: None,
    },
    Peer {
        case: "princeton-beam",
        program: &EXUDYN,
        script: script!("princeton-beam_exudyn.py"),
        method: "geometrically exact beams with the shear of the section, static solver",
        exact: None,
    },
    Peer {
        case: "strip-with-tip-load",
        program: &EXUDYN,
        script: script!("strip-with-tip-load_exudyn.py"),
        method: "geometrically exact beams; the force at which the least eigenvalue of the stiffness matrix is zero",
        exact: None,
    },
    Peer {
        case: "swinging-cable",
        program: &EXUDYN,
        script: script!("swinging-cable_exudyn.py"),
        method: MOTION,
        exact: None,
    },
    Peer {
        case: "swinging-chain",
        program: &EXUDYN,
        script: script!("swinging-chain_exudyn.py"),
        method: MOTION,
        exact: None,
    },
    Peer {
        case: "swinging-chain",
        program: &MUJOCO,
        script: script!("swinging-chain_mujoco.py"),
        method: "rigid links with hinges, as many as edges, Runge–Kutta method of fourth order with the time steps of the \
                 scenario",
        exact: None,
    },
    Peer {
        case: "rotating-beam",
        program: &EXUDYN,
        script: script!("rotating-beam_exudyn.py"),
        method: MOTION,
        exact: None,
    },
    Peer {
        case: "becks-column",
        program: &EXUDYN,
        script: script!("becks-column_exudyn.py"),
        method: "planar ANCF cables of cubic shape; the force at which the two lowest eigenvalues of M⁻¹K merge",
        exact: None,
    },
    Peer {
        case: "twisted-rod",
        program: &EXUDYN,
        script: script!("twisted-rod_exudyn.py"),
        method: "geometrically exact beams; the twist at which the least eigenvalue of the stiffness matrix is zero",
        exact: None,
    },
    Peer {
        case: "heavy-top",
        program: &MUJOCO,
        script: script!("heavy-top_mujoco.py"),
        method: RIGID,
        exact: None,
    },
    Peer {
        case: "intermediate-axis",
        program: &MUJOCO,
        script: script!("intermediate-axis_mujoco.py"),
        method: RIGID,
        exact: None,
    },
    Peer {
        case: "heavy-cantilevers",
        program: &EXUDYN,
        script: script!("heavy-cantilevers_exudyn.py"),
        method: CABLES,
        exact: None,
    },
    Peer {
        case: "buckled-columns",
        program: &EXUDYN,
        script: script!("buckled-columns_exudyn.py"),
        method: "planar ANCF cables of cubic shape, static solver; a small force across the top begins the bending",
        exact: None,
    },
];

/// Cases that a program is left out of, and the reason.
pub(in super::super) static LEFT_OUT: &[(&[&str], &Program, &str)] = &[
    (
        &["flying-rod"],
        &EXUDYN,
        "its generalized-α solver ended early with 80 cables and the time steps of the scenario",
    ),
    (
        &["toggle", "deep-arch", "lees-frame"],
        &MUJOCO,
        "it steps in time only, and a rod that steps under a growing load snaps near, not at, the limit load",
    ),
    (
        &["toggle", "deep-arch", "lees-frame"],
        &PYELASTICA,
        "it steps in time only, and a rod that steps under a growing load snaps near, not at, the limit load",
    ),
    (
        &[
            "heavy-column",
            "strip-on-edge",
            "strip-with-tip-load",
            "bent-strip",
            "twisted-rod",
            "twisted-ring",
        ],
        &MUJOCO,
        "it has no stiffness matrix of a state at rest, so that a critical load could only be estimated from growing motion",
    ),
    (
        &[
            "heavy-column",
            "strip-on-edge",
            "strip-with-tip-load",
            "bent-strip",
            "twisted-rod",
            "twisted-ring",
        ],
        &PYELASTICA,
        "it has no stiffness matrix of a state at rest, so that a critical load could only be estimated from growing motion",
    ),
    (
        &["twisted-ring"],
        &EXUDYN,
        "the ring turns by more than its Euler angles can, and the stiffness matrix of nodes with Euler parameters leaves \
         out the constraint on their norm",
    ),
];
