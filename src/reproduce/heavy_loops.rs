//! Rods that are folded over onto themselves under their own weight (thesis 5.5.1).
//!
//! Held at its two ends only, the upright loop of a round rod falls to the side; the simulated loops are ribbons of the
//! same gravito-bending length, which stay in their plane.

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
/// Thickness and width of the ribbon, m.
const THICKNESS: f64 = 0.001;
const WIDTH: f64 = 0.1;
/// Edges of the loop.
const EDGES: usize = 200;
/// Density, kg/m³, and acceleration of free fall, m/s².
const DENSITY: f64 = 1000.0;
const GRAVITY: f64 = 9.81;

/// The loop of a rod, an index into [`RODS`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct LoopOfRod {
    /// The rod.
    pub rod: usize,
    edges: usize,
}

impl LoopOfRod {
    /// All rods; a quick version has coarse ones.
    pub fn of_figure_5_8(quick: bool) -> Vec<Self> {
        let edges = if quick { 40 } else { EDGES };
        (0..RODS.len()).map(|rod| Self { rod, edges }).collect()
    }

    /// Nodes of the loop.
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
        // L_gb³ = E h²/(24 ρ g) for a ribbon of thickness h.
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
