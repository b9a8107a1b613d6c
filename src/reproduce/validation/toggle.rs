//! Williams' toggle, which snaps through.

use super::benchmark::{Benchmark, Measure, Quantity};
use super::planar_frame::{End, PlanarFrame, Segment, Start};
use rodlab_files::results::BranchKind;

/// Rise over half of the span.
const RISE: f64 = 0.386 / 12.943;
/// Thickness of the beams over half of the span.
const THICKNESS: f64 = 0.243 / 12.943;

pub(super) static TOGGLE: Benchmark = Benchmark {
    name: "validation/toggle",
    title: "Williams' toggle, which snaps through",
    about: "Two beams between clamps form a flat roof with a rigid joint at its apex, which carries a force P. Half \
            of the span is L = 12.943 in, the rise is 0.386 in, and the beams are rectangles of 0.753 in × 0.243 in \
            with E = 1.03·10⁷ psi. P is in units of EI/L² = 55.36 lbf. It has a maximum, where the roof snaps \
            through, and a minimum beyond.",
    source: "Williams 1964, Quart. J. Mech. Appl. Math. 17, 451, who measured and computed load over deflection; the \
             numbers here are not from a table of his",
    means: "shooting of the planar frame along its path of equilibria up to both folds",
    scene: include_str!("scenes/toggle.toml"),
    edges: [20, 40, 80],
    quantities: &[
        Quantity::new("maximum of P L²/EI"),
        Quantity::new("minimum of P L²/EI"),
    ],
    exact: || {
        let angle = libm::atan(RISE);
        let length = libm::hypot(1.0, RISE);
        let beams = [(0.0, false), (-2.0 * angle, true)].map(|(corner, is_loaded)| Segment {
            length,
            curvature: 0.0,
            corner,
            is_loaded,
        });
        let frame = PlanarFrame {
            start: Start::Clamped(angle),
            segments: &beams,
            end: [2.0, 0.0],
            support: End::Clamped(-angle),
            stretching: 12.0 / (THICKNESS * THICKNESS),
        };
        frame.limit_loads().unwrap_or([f64::NAN; 2]).to_vec()
    },
    measure: Measure::Critical(BranchKind::Fold),
};
