//! Rods that are folded over onto themselves under their own weight (thesis 5.5.1).
//!
//! The upright loop of a round rod that is held only at its two ends falls to the side. The
//! simulated loops are therefore ribbons of the same gravito-bending length, which stay in their
//! plane.

use super::cases::{Run, prepared_table, value};
use rodlab_engine::mechanics::kirchhoff::HeavyLoop;
use rodlab_lab::run::PreparedRun;
use toml::toml;

/// Rods of thesis Tab. 5.1: number, name and L_gb, m.
pub(super) const RODS: [(usize, &str, f64); 5] = [
    (1, "pink VPS", 0.018),
    (4, "thick pink VPS", 0.0286),
    (2, "green VPS", 0.032),
    (3, "rope", 0.034),
    (5, "cable", 0.0801),
];
/// Thickness of the ribbon, m.
const THICKNESS: f64 = 0.001;
/// Width of the ribbon, m.
const WIDTH: f64 = 0.1;
/// Number of edges of the loop.
const EDGES: usize = 200;
/// Density, kg/m³.
const DENSITY: f64 = 1000.0;
/// Acceleration of free fall, m/s².
const GRAVITY: f64 = 9.81;

/// The loop of a rod, given by its index into [`RODS`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct LoopOfRod {
    /// The rod.
    pub rod: usize,
    edges: usize,
}

impl LoopOfRod {
    /// All rods; a quick version has coarse meshes.
    pub fn of_figure_5_8(quick: bool) -> Vec<Self> {
        let edges = if quick { 40 } else { EDGES };
        (0..RODS.len()).map(|rod| Self { rod, edges }).collect()
    }

    /// Number of nodes of the loop.
    pub fn nodes(&self) -> usize {
        self.edges + 1
    }
}

impl Run for LoopOfRod {
    fn id(&self) -> String {
        let (number, ..) = RODS[self.rod];
        format!("loop_rod{number}_{}", self.edges)
    }

    fn prepare(&self) -> PreparedRun {
        let (_, _, unit) = RODS[self.rod];
        let theory = HeavyLoop::new();
        let places = theory.places(self.edges).into_iter();
        let points: Vec<[f64; 3]> = places.map(|[x, z]| [x * unit, 0.0, z * unit]).collect();
        // Young's modulus E from L_gb³ = E h²/(24 ρ g) for a ribbon of thickness h.
        let modulus = 24.0 * DENSITY * GRAVITY * unit.powi(3) / THICKNESS.powi(2);
        let scenario = toml! {
            experiment = "scene"
            title = (self.id())
            material = { youngs_modulus = modulus, poissons_ratio = 0.5, density = DENSITY }
            contact = { model = "none" }
            clamps = [{ rod = "loop", at = "start" }, { rod = "loop", at = "end" }]
            loads = [{ kind = "gravity", acceleration = [0, 0, -GRAVITY] }]
            time = { mode = "static" }
            output = { nodes = true }
            [[rods]]
            name = "loop"
            director = [0, 1, 0]
            edges = (self.edges)
            cross_section = { kind = "rectangle", width = WIDTH, thickness = THICKNESS }
            shape = { kind = "points", points = (value(points)) }
            [rods.natural_shape]
            kind = "straight"
            start = [0, 0, 0]
            end = [(theory.length * unit), 0, 0]
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
        Self { edges: 40, ..*self }
    }
}
