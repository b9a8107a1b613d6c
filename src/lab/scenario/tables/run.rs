//! Newton's method, and the output of a run.

use crate::scenario::declaration::keys;
use crate::scenario::section::{DISPLACEMENT_TOLERANCE, FORCE_TOLERANCE, POSITIVE};
use crate::scenario::units::{Dimensionless, Time};

keys! {
    /// Newton's method.
    table SolverKeys "solver" => #[derive(Copy)] Solver() {
        /// Largest residual that Newton's method may leave at any degree of freedom, as a multiple
        /// of the largest of EI/L², loads and contact forces of the same rod; at most 1e-3.
        force_tolerance: number(Dimensionless, FORCE_TOLERANCE) default(1e-6),
        /// Largest final correction of Newton's method, as a multiple of the rod radius; at most
        /// 1.
        displacement_tolerance: number(Dimensionless, DISPLACEMENT_TOLERANCE) default(1e-4),
        /// Number of Newton iterations after which a step counts as failed and is halved.
        maximum_iterations: count(1..=100_000) default(40),
        /// Smallest step before the run fails. Default: a millionth of the step; with step = "auto" a millionth of the first
        /// step, which is a thousandth of the largest.
        minimum_step: number(Time, POSITIVE) optional,
    }
}

keys! {
    /// Files that are written, and how often.
    table OutputKeys "output" => #[derive(Copy)] Output() {
        /// Time between outputs, at least a millionth of the end time. Default: a hundredth of the
        /// end time.
        interval: number(Time, POSITIVE) optional,
        /// Whether node positions are written (nodes.csv).
        nodes: flag() default(true),
        /// Whether velocities, fluid and contact forces of the nodes are written (node_forces.csv).
        forces: flag() default(false),
        /// Whether the places at which surfaces press on each other are written, with normal forces
        /// and friction (contacts.csv).
        contacts: flag() default(false),
        /// Whether a VTK PolyData series for ParaView is written.
        vtk: flag() default(false),
    }
}
