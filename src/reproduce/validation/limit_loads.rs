//! Limit loads of arches and frames.

use super::benchmark::{Benchmark, Measure, Quantity};
use super::planar_frame::{End, PlanarFrame, Segment, Start};
use rodlab_files::results::BranchKind;
use std::f64::consts::{FRAC_PI_2, PI};

/// Half of the opening of the arch, rad.
const HALF_OPENING: f64 = 107.5 * PI / 180.0;

pub(super) static DEEP_ARCH: Benchmark = Benchmark {
    name: "validation/deep-arch",
    title: "Limit load of a deep arch, clamped and hinged",
    about: "A circular arch of 215° is clamped at its left end and hinged at its right one, and carries a force P at \
            its crown. It leans over to the hinged side, and its load has a maximum. P is in units of EI/R².",
    source: "DaDeppo and Schmidt 1975, J. Appl. Mech. 42, 345",
    means: "shooting of the planar rod along its path of equilibria up to the fold",
    scene: include_str!("scenes/deep-arch.toml"),
    edges: [40, 80, 160],
    quantities: &[Quantity::new("limit load P R²/EI").published(8.97, 5e-3)],
    exact: || {
        static HALVES: [Segment; 2] = [half(false), half(true)];
        let frame = PlanarFrame {
            start: Start::Clamped(HALF_OPENING),
            segments: &HALVES,
            end: [2.0 * libm::sin(HALF_OPENING), 0.0],
            support: End::Hinged,
            stretching: 1e6,
        };
        frame.limit_loads().unwrap_or([f64::NAN]).to_vec()
    },
    measure: Measure::Critical(BranchKind::Fold),
};

/// Half of the arch.
const fn half(is_loaded: bool) -> Segment {
    Segment {
        length: HALF_OPENING,
        curvature: -1.0,
        corner: 0.0,
        is_loaded,
    }
}

pub(super) static LEES_FRAME: Benchmark = Benchmark {
    name: "validation/lees-frame",
    title: "Limit load of Lee's frame",
    about: "A column and a beam of the same length L are joined rigidly at a right angle; both other ends are hinged. \
            A force P pushes the beam down at a fifth of its length from the corner. P is in units of EI/L²; EA \
            L²/EI = 43200, as of the published frame of L = 120, A = 6, I = 2. A held rod below the hinge of the \
            column keeps the frame in its plane.",
    source: "Lee, Manuel and Rossow 1968, J. Eng. Mech. Div. ASCE 94, 521",
    means: "shooting of the planar frame along its path of equilibria up to the fold",
    scene: include_str!("scenes/lees-frame.toml"),
    edges: [20, 40, 80],
    quantities: &[Quantity::new("limit load P L²/EI")],
    exact: || {
        static PIECES: [Segment; 3] = [
            piece(1.0, 0.0, false),
            piece(0.2, -FRAC_PI_2, false),
            piece(0.8, 0.0, true),
        ];
        let frame = PlanarFrame {
            start: Start::Hinged(FRAC_PI_2),
            segments: &PIECES,
            end: [1.0, 1.0],
            support: End::Hinged,
            stretching: 43200.0,
        };
        frame.limit_loads().unwrap_or([f64::NAN]).to_vec()
    },
    measure: Measure::Critical(BranchKind::Fold),
};

/// A straight piece.
const fn piece(length: f64, corner: f64, is_loaded: bool) -> Segment {
    Segment {
        length,
        curvature: 0.0,
        corner,
        is_loaded,
    }
}
