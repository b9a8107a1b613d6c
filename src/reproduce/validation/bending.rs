//! Large bending of cantilevers.

use super::benchmark::{Benchmark, Measure, Quantity};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::kirchhoff::SpatialCantilever;

/// Steps of the solution by multiple shooting.
const STEPS: usize = 800;

pub(super) static ROLL_UP: Benchmark = Benchmark {
    name: "validation/roll-up",
    title: "A cantilever rolled up into a circle by a moment at its end",
    about: "A straight cantilever under the moment M = 2π EI/L at its end becomes a full circle: its tip comes \
            back to the clamp. The moment grows along a path of equilibria.",
    source: "Bathe and Bolourchi 1979, Int. J. Numer. Meth. Eng. 14, 961; Simo and Vu-Quoc 1986, Comput. Meth. \
             Appl. Mech. Eng. 58, 79",
    means: "closed form; errors are over the length",
    scene: include_str!("scenes/roll-up.toml"),
    edges: [20, 40, 80],
    quantities: &[
        Quantity::new("tip along the beam, x/L").over(1.0),
        Quantity::new("tip across it, y/L").over(1.0),
    ],
    exact: || vec![0.0, 0.0],
    measure: Measure::Tip(|tip| vec![tip.x, tip.y]),
};

pub(super) static TIP_FORCE: Benchmark = Benchmark {
    name: "validation/tip-force",
    title: "A cantilever bent far by a force at its tip",
    about: "A straight cantilever carries the force P = 10 EI/L² across its tip, which keeps its direction.",
    source: "Bisshopp and Drucker 1945, Quart. Appl. Math. 3, 272; numbers of Mattiasson 1981, Int. J. Numer. \
             Meth. Eng. 17, 145, by elliptic integrals for a beam that does not stretch",
    means: "multiple shooting of the beam that stretches with the stiffness of the scenario",
    scene: include_str!("scenes/tip-force.toml"),
    edges: [20, 40, 80],
    quantities: &[
        Quantity::new("deflection w/L").published(0.81061, 5e-6),
        Quantity::new("shortening u/L").published(0.55500, 5e-6),
    ],
    exact: || tip_under_force(1e5),
    measure: Measure::Tip(|tip| vec![-tip.z, 1.0 - tip.x]),
};

pub(super) static BEND_OF_45_DEGREES: Benchmark = Benchmark {
    name: "validation/bend-of-45-degrees",
    title: "A bend of 45° under a force across its plane",
    about: "A cantilever along an eighth of a circle of radius 100, with a square section of side 1 and E = 10⁷, G = \
            E/2, is clamped and carries a force of 600 across its plane. The torsion constant is 1/6, as published; \
            that of a square, 0.1406, moves the tip by 0.8 %. The published values are those of eight straight \
            elements.",
    source: "Bathe and Bolourchi 1979, Int. J. Numer. Meth. Eng. 14, 961; numbers of Simo and Vu-Quoc 1986, \
             Comput. Meth. Appl. Mech. Eng. 58, 79",
    means: "multiple shooting of the rod without shear",
    scene: include_str!("scenes/bend-of-45-degrees.toml"),
    edges: [20, 40, 80],
    quantities: &[
        Quantity::new("tip, x").published(15.79, 5e-3),
        Quantity::new("tip, y").published(47.23, 5e-3),
        Quantity::new("tip, z").published(53.37, 5e-3),
    ],
    exact: || tip_of_bend(1e7),
    measure: Measure::Tip(|tip| vec![tip.x, tip.y, tip.z]),
};

/// Deflection and shortening of the cantilever under a force, with its stiffness EA.
pub(super) fn tip_under_force(stretching: f64) -> Vec<f64> {
    let tip = tip(&SpatialCantilever {
        length: 1.0,
        stiffness: [1.0, 1e3, 1e3],
        stretching,
        natural: |_| [0.0; 3],
        director: Vector3::y(),
        tangent: Vector3::x(),
        load_per_length: Vector3::zeros(),
        end_force: -10.0 * Vector3::z(),
        end_moment: Vector3::zeros(),
    });
    vec![-tip.z, 1.0 - tip.x]
}

/// The tip of the bend, with its stiffness EA.
pub(super) fn tip_of_bend(stretching: f64) -> Vec<f64> {
    let tip = tip(&SpatialCantilever {
        length: 25.0 * std::f64::consts::PI,
        stiffness: [1e7 / 12.0; 3],
        stretching,
        natural: |_| [0.01, 0.0, 0.0],
        director: -Vector3::z(),
        tangent: Vector3::y(),
        load_per_length: Vector3::zeros(),
        end_force: 600.0 * Vector3::z(),
        end_moment: Vector3::zeros(),
    });
    vec![tip.x, tip.y, tip.z]
}

/// The free end of a cantilever.
fn tip<N: Fn(f64) -> [f64; 3]>(cantilever: &SpatialCantilever<N>) -> Vector3 {
    let points = cantilever.points(STEPS);
    let tip = points.and_then(|points| points.last().copied());
    tip.expect("the shooting converges for these loads")
}
