//! A suspended rod in one of its optimal grasps, whose gripper is pushed sideways in time (thesis 5.3.3).

use super::cases::{Run, prepared_table, value};
use rodlab_lab::run::PreparedRun;
use rodlab_planning::plan::grasp::{GraspProblem, GraspSolver};
use toml::toml;

/// l̄_s of thesis Figs. 5.4 and 5.5.
pub(super) const SUSPENDED: f64 = 17.68;
/// L_gb of the rod, m: the green one of thesis Tab. 5.1.
pub(super) const UNIT: f64 = 0.032;
/// Radius of the rod, m.
pub(super) const RADIUS: f64 = 0.0016;
/// Number of edges of the suspended part.
const EDGES: usize = 120;
/// Density, kg/m³.
const DENSITY: f64 = 1000.0;
/// Acceleration of free fall, m/s².
const GRAVITY: f64 = 9.81;
/// Largest push Δȳ.
pub(super) const LARGEST: f64 = 0.5;
/// Duration of the push, s: far longer than the oscillations of the rod.
const END: f64 = 20.0;
/// Drag per length that damps these oscillations, N s/m².
const DRAG: f64 = 0.05;

/// A push of the gripper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SidewaysPush {
    /// The local minimum of thesis Fig. 5.4: 1, the gentle one, or 2.
    pub minimum: usize,
    /// Simulated time, s.
    end: f64,
}

/// EI of the rod, N m².
pub(super) fn bending_stiffness() -> f64 {
    let weight = DENSITY * GRAVITY * std::f64::consts::PI * RADIUS * RADIUS;
    2.0 * UNIT.powi(3) * weight
}

/// k̄_s of the rod.
pub(super) fn stretch_stiffness() -> f64 {
    4.0 * (UNIT / RADIUS).powi(2)
}

impl SidewaysPush {
    /// Both minima.
    pub fn of_figure_5_5(quick: bool) -> Vec<Self> {
        let end = if quick { 0.05 } else { END };
        [1, 2].map(|minimum| Self { minimum, end }).into()
    }

    /// Runs for both minima, up to a push Δȳ.
    #[cfg(test)]
    pub fn up_to(push: f64) -> Vec<Self> {
        let end = END * push / LARGEST;
        [1, 2].map(|minimum| Self { minimum, end }).into()
    }

    /// Nodes of the suspended part, m.
    fn nodes(&self) -> Vec<[f64; 3]> {
        let problem = GraspProblem::new(SUSPENDED, 0.0, stretch_stiffness());
        let problem = problem.expect("a length, a curvature and a stiffness in range");
        let found = GraspSolver::new().all_centrelines(&problem, EDGES);
        let mut found = found.expect("there are planar grasps of this length");
        // The second minimum is the one of the other grasps with the fewest unstable modes.
        let chosen = if self.minimum == 1 {
            0
        } else {
            let others = (1..found.len()).filter(|&index| found[index].0.is_feasible());
            let chosen = others.min_by_key(|&index| found[index].0.unstable_modes);
            chosen.expect("there are several grasps of this length")
        };
        let (_, nodes) = found.swap_remove(chosen);
        nodes.iter().map(|node| (UNIT * node).into()).collect()
    }
}

impl Run for SidewaysPush {
    fn id(&self) -> String {
        format!("push-minimum_{}", self.minimum)
    }

    fn prepare(&self) -> PreparedRun {
        let modulus = bending_stiffness() / (0.25 * std::f64::consts::PI * RADIUS.powi(4));
        let scenario = toml! {
            experiment = "scene"
            title = (self.id())
            material = { youngs_modulus = modulus, poissons_ratio = 0.5, density = DENSITY }
            probes = [{ name = "gripper", kind = "reaction", at = "end" }]
            time = { step = 2e-3, end = (self.end) }
            output = { interval = (0.01 * self.end) }
            [[rods]]
            name = "suspended"
            radius = RADIUS
            edges = EDGES
            shape = { kind = "points", points = (value(self.nodes())) }
            natural_shape = { kind = "straight", start = [0, 0, 0], end = [(SUSPENDED * UNIT), 0, 0] }
            [[clamps]]
            rod = "suspended"
            at = "start"
            [[clamps]]
            rod = "suspended"
            at = "end"
            move = [[0, [0, 0, 0]], [END, [0, (LARGEST * UNIT), 0]]]
            [[loads]]
            kind = "gravity"
            acceleration = [0, 0, -GRAVITY]
            [[loads]]
            kind = "drag"
            translation = DRAG
        };
        prepared_table(&self.id(), scenario, &[])
    }

    fn end(&self) -> f64 {
        self.end
    }

    fn cost(&self) -> f64 {
        0.3 * self.end
    }

    #[cfg(test)]
    fn shortened(&self) -> Self {
        Self { end: 0.05, ..*self }
    }
}

/// Push Δȳ at a time, s.
pub(super) fn push_at(time: f64) -> f64 {
    LARGEST * time / END
}
