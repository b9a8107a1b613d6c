//! Strips that are held horizontally at one end and hang down under their weight (thesis 4.6.1).

use super::cases::{Run, prepared_table};
use rodlab_lab::run::PreparedRun;
use toml::toml;

/// Free lengths of the strips, L_gb.
pub(super) const LENGTHS: [f64; 8] = [0.8, 1.2, 1.6, 2.0, 2.6, 3.4, 4.5, 6.0];
/// L_gb of the strips, m.
pub(super) const UNIT: f64 = 0.05;
/// Thickness, m.
const THICKNESS: f64 = 0.0001;
/// Width, m.
const WIDTH: f64 = 0.05;
/// Number of edges of a strip.
const EDGES: usize = 100;
/// Density, kg/m³.
const DENSITY: f64 = 800.0;
/// Acceleration of free fall, m/s².
const GRAVITY: f64 = 9.81;

/// A strip, given by its index into [`LENGTHS`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Hanging {
    /// The strip.
    pub strip: usize,
    edges: usize,
}

impl Hanging {
    /// All strips; a quick version has coarse meshes.
    pub fn of_figure_4_9(quick: bool) -> Vec<Self> {
        let edges = if quick { 25 } else { EDGES };
        let strip = |strip| Self { strip, edges };
        (0..LENGTHS.len()).map(strip).collect()
    }

    /// Number of nodes of the strip.
    pub fn nodes(&self) -> usize {
        self.edges + 1
    }
}

impl Run for Hanging {
    fn id(&self) -> String {
        format!("hanging_strip{}_{}", self.strip + 1, self.edges)
    }

    fn prepare(&self) -> PreparedRun {
        // Young's modulus E from L_gb³ = E h²/(24 ρ g).
        let modulus = 24.0 * DENSITY * GRAVITY * UNIT.powi(3) / THICKNESS.powi(2);
        let length = LENGTHS[self.strip] * UNIT;
        let scenario = toml! {
            experiment = "scene"
            title = (self.id())
            material = { youngs_modulus = modulus, poissons_ratio = 0.5, density = DENSITY }
            contact = { model = "none" }
            clamps = [{ rod = "strip", at = "start" }]
            loads = [{ kind = "gravity", acceleration = [0, 0, -GRAVITY] }]
            time = { mode = "static" }
            output = { nodes = true }
            [[rods]]
            name = "strip"
            director = [0, 1, 0]
            edges = (self.edges)
            cross_section = { kind = "rectangle", width = WIDTH, thickness = THICKNESS }
            shape = { kind = "straight", start = [0, 0, 0], end = [length, 0, 0] }
        };
        prepared_table(&self.id(), scenario, &[])
    }

    fn extent(&self) -> String {
        format!("rods of {} edges were bent", self.edges)
    }

    fn cost(&self) -> f64 {
        0.1
    }

    #[cfg(test)]
    fn shortened(&self) -> Self {
        Self { edges: 25, ..*self }
    }
}
