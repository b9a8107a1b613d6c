//! The drag of a flow that couples nodes, computed within the step.
//!
//! In a flow the motion of every node acts on every other: the drag is −R v with a resistance R
//! that is dense. The Newton matrix holds its local part D alone, so a step is solved with the
//! drag F₀ − D (v − v₀) of a predicted motion v₀. The remainder, (D − R) (v − v₀), may be left to
//! the next step, whose prediction improves by it, only if velocities do not ring: see
//! [`TimeScheme::largest_lagged_ratio`](super::scheme::TimeScheme::largest_lagged_ratio). With the
//! inertia of the thesis' flagella they do not. If drag dominates they ring for any step, as soon
//! as R and D differ by half.
//!
//! If they ring, the drag is evaluated again for the motion of the solved step, and the step
//! solved again, until the remainder is small compared with the drag on every rod. The step is
//! then one of the implicit scheme with the whole resistance, which is positive: it is stable for
//! every ratio of drag to inertia, as the scheme is.
//!
//! Predicting the last solution would converge only for R < 2 D. So the next prediction is the combination of all
//! solutions so far with the least remainder, by generalised conjugate residuals (Eisenstat, Elman & Schultz 1983, Alg. 2): for
//! a linear step this is GMRES for the whole Jacobian, preconditioned by the Newton matrix, and converges for every R.
//!
//! The flow is solved to a fraction of all velocities. A rod that only moves along with the flow
//! of another one has almost no drag; the error of the flow solver there may exceed the tolerated
//! fraction of it. So a stalled search also ends when the remainder of no rod exceeds the error of
//! the flow solver.

use crate::mechanics::Vector3;
use crate::mechanics::fluid::Coupling;
use crate::mechanics::system::Stage;

/// Number of directions that are remembered; a further one replaces the oldest. R and D differ
/// strongly in few directions only: filaments of 40 edges take five to eight.
const DIRECTIONS: usize = 12;

/// Number of solutions of a step after which it counts as failed.
pub(super) const MOST_SOLUTIONS: usize = 40;

/// Remainder allowed, relative to the drag on a rod, as a multiple of the error of the flow
/// solver.
const TOLERANCE: f64 = 10.0;

/// A search has stalled if the remainder of a solution is more than this fraction of the previous
/// one.
const STALLED: f64 = 0.5;

/// A motion, its drag, and the remainder of the step solved with it.
#[derive(Clone, Debug, Default)]
struct Motion {
    /// m/s per node.
    velocity: Vec<Vector3>,
    /// −R v, N per node.
    drag: Vec<Vector3>,
    /// N per node.
    left_out: Vec<Vector3>,
}

impl Motion {
    fn copy_from(&mut self, other: &Self) {
        for (own, other) in self.parts_mut().into_iter().zip(other.parts()) {
            own.clone_from(other);
        }
    }

    fn add(&mut self, factor: f64, other: &Self) {
        for (own, other) in self.parts_mut().into_iter().zip(other.parts()) {
            for (own, other) in own.iter_mut().zip(other) {
                *own += *other * factor;
            }
        }
    }

    fn scale(&mut self, factor: f64) {
        for part in self.parts_mut() {
            part.iter_mut().for_each(|own| *own *= factor);
        }
    }

    fn parts(&self) -> [&Vec<Vector3>; 3] {
        [&self.velocity, &self.drag, &self.left_out]
    }

    fn parts_mut(&mut self) -> [&mut Vec<Vector3>; 3] {
        [&mut self.velocity, &mut self.drag, &mut self.left_out]
    }
}

/// Scratch of the search for the drag of a step.
#[derive(Debug, Default)]
pub(super) struct DragCoupling {
    /// 1/D of each node, mean of the three axes, m/(N s); 0 at held nodes and out of the fluid.
    mobilities: Vec<f64>,
    /// The prediction with the smallest remainder.
    best: Motion,
    /// Directions with orthonormal remainders, the newest first.
    directions: Vec<Motion>,
    /// Number of directions of this step.
    count: usize,
    /// The last solution.
    solution: Motion,
    /// Norm of the remainders of the last solution and the one before, √(N m/s).
    sizes: [f64; 2],
    solutions: usize,
}

impl DragCoupling {
    /// Begins the search in a step whose first drag is that of `stage`.
    pub(crate) fn begin(&mut self, stage: &Stage, is_held: impl Fn(usize) -> bool) {
        self.solutions = 0;
        self.sizes = [f64::INFINITY; 2];
        self.count = 0;
        self.mobilities.clear();
        let mobilities = stage.resistance.iter().enumerate().map(|(node, local)| {
            let resistance = local.trace() / 3.0;
            if resistance > 0.0 && !is_held(node) {
                1.0 / resistance
            } else {
                0.0
            }
        });
        self.mobilities.extend(mobilities);
    }

    /// Adds a solution of the step: its velocities, those relative to the flow, and their drag.
    /// Returns whether its remainder is below the tolerance on each run of nodes of `rods`, or has
    /// stalled at the error of the flow solver. If so, `stage` has the drag of the solution itself.
    pub(crate) fn record(
        &mut self,
        stage: &mut Stage,
        [velocity, relative]: [&[Vector3]; 2],
        drag: &[Vector3],
        rods: impl Iterator<Item = std::ops::Range<usize>>,
        flow: &Coupling,
    ) -> bool {
        self.solutions += 1;
        let Motion { left_out, .. } = &mut self.solution;
        left_out.clear();
        left_out.extend(drag.iter().enumerate().map(|(node, drag)| {
            let change = velocity[node] - stage.drag_velocity[node];
            drag - (stage.drag[node] - stage.resistance[node] * change)
        }));
        self.solution.velocity.clear();
        self.solution.velocity.extend_from_slice(velocity);
        self.solution.drag.clear();
        self.solution.drag.extend_from_slice(drag);
        stage.drag.copy_from_slice(drag);
        stage.drag_velocity.copy_from_slice(velocity);
        let tolerance = TOLERANCE * flow.tolerance;
        let (solution, mobilities) = (&self.solution, &self.mobilities);
        let size = |forces: &[Vector3], nodes: std::ops::Range<usize>| {
            nodes
                .map(|node| mobilities[node] * forces[node].norm_squared())
                .sum::<f64>()
        };
        self.sizes = [
            size(&solution.left_out, 0..mobilities.len()).sqrt(),
            self.sizes[0],
        ];
        // An error of the flow velocities causes an error of the drag, by a resistance of at most
        // `ratio` times the local one.
        let unsolved = if self.has_stalled() {
            let local = stage.resistance.iter().map(|local| local.trace() / 3.0);
            let speed = relative.iter().map(Vector3::norm_squared).sum::<f64>();
            // With spheres the ratio is not available.
            let ratio = if flow.largest_ratio.is_finite() {
                flow.largest_ratio
            } else {
                1.0
            };
            ratio.powi(2) * local.fold(0.0, f64::max) * speed
        } else {
            0.0
        };
        rods.into_iter().all(|nodes| {
            let left_out = size(&solution.left_out, nodes.clone());
            left_out <= tolerance * tolerance * size(&solution.drag, nodes).max(unsolved)
        })
    }

    /// Whether the last remainder is more than half of the previous one.
    pub(crate) fn has_stalled(&self) -> bool {
        let [last, before] = self.sizes;
        last > STALLED * before
    }

    /// Whether the step has taken too many solutions.
    pub(crate) fn is_exhausted(&self) -> bool {
        self.solutions >= MOST_SOLUTIONS
    }

    /// Writes the next predicted motion to `stage`: the best combination of the solutions so far.
    pub(crate) fn expect(&mut self, stage: &mut Stage) {
        if self.solutions == 1 {
            self.best.copy_from(&self.solution);
        } else {
            self.add_direction();
        }
        stage.drag.copy_from_slice(&self.best.drag);
        stage.drag_velocity.copy_from_slice(&self.best.velocity);
    }

    /// Moves from the best motion towards the last solution, as far as the remainder decreases.
    fn add_direction(&mut self) {
        if self.directions.len() < DIRECTIONS {
            self.directions.push(Motion::default());
        }
        self.count = self.directions.len().min(self.count + 1);
        let (known, unused) = self.directions.split_at_mut(self.count);
        known.rotate_right(1);
        debug_assert!(unused.len() <= DIRECTIONS);
        let (new, known) = known.split_first_mut().expect("the new direction");
        new.copy_from(&self.solution);
        new.add(-1.0, &self.best);
        let product = |a: &Motion, b: &Motion| {
            let nodes = self
                .mobilities
                .iter()
                .zip(a.left_out.iter().zip(&b.left_out));
            nodes
                .map(|(mobility, (a, b))| mobility * a.dot(b))
                .sum::<f64>()
        };
        for other in &*known {
            let part = product(other, new);
            new.add(-part, other);
        }
        let size = product(new, new).sqrt();
        if size > 0.0 {
            new.scale(1.0 / size);
            let part = product(new, &self.best);
            self.best.add(-part, new);
        } else {
            // No new direction: discard all and restart with the solution.
            self.count = 0;
            self.best.copy_from(&self.solution);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::Matrix3;
    use nalgebra::{DMatrix, DVector};

    /// A stage of free nodes with a local resistance of one, and its drag search.
    fn begun(nodes: usize) -> (Stage, DragCoupling) {
        let stage = Stage {
            step: 1.0,
            acceleration_step: 1.0,
            keeps_spin: false,
            start: Vec::new(),
            velocity: Vec::new(),
            drag: vec![Vector3::zeros(); nodes],
            drag_velocity: vec![Vector3::zeros(); nodes],
            resistance: vec![Matrix3::identity(); nodes],
            flow_torque: Vec::new(),
            positions: Vec::new(),
            angles: Vec::new(),
        };
        let mut coupling = DragCoupling::default();
        coupling.begin(&stage, |_| false);
        (stage, coupling)
    }

    /// A linear step (S + D) v = b + F₀ + D v₀ of nodes with a local resistance of one and a dense
    /// resistance with the eigenvalues `ratios`. Returns the number of solutions and their error.
    fn solutions(ratios: &[f64], inertia: f64) -> (usize, f64) {
        let count = ratios.len();
        let nodes = count / 3;
        let mut numbers = crate::random::uniform_numbers(7);
        let basis = DMatrix::from_fn(count, count, |_, _| numbers() - 0.5)
            .qr()
            .q();
        let resistance = &basis
            * DMatrix::from_diagonal(&DVector::from_column_slice(ratios))
            * basis.transpose();
        let load = DVector::from_fn(count, |_, _| numbers() - 0.5);
        let exact = (&resistance + DMatrix::identity(count, count) * inertia)
            .lu()
            .solve(&load)
            .unwrap();
        let vectors = |v: &DVector<f64>| -> Vec<Vector3> {
            v.as_slice()
                .chunks_exact(3)
                .map(Vector3::from_column_slice)
                .collect()
        };
        let (mut stage, mut coupling) = begun(nodes);
        loop {
            let flat = |vectors: &[Vector3]| {
                DVector::from_iterator(count, vectors.iter().flat_map(|v| [v.x, v.y, v.z]))
            };
            let [drag, velocity] = [&stage.drag, &stage.drag_velocity].map(|v| flat(v));
            let solved = (&load + drag + velocity) / (inertia + 1.0);
            let (velocity, drag) = (vectors(&solved), vectors(&(-&resistance * &solved)));
            let rods = std::iter::once(0..nodes);
            let flow = Coupling {
                largest_ratio: ratios.iter().copied().fold(0.0, f64::max),
                tolerance: 1e-9,
            };
            if coupling.record(&mut stage, [&velocity; 2], &drag, rods, &flow) {
                return (coupling.solutions, (solved - &exact).norm() / exact.norm());
            }
            assert!(!coupling.is_exhausted(), "{ratios:?}");
            coupling.expect(&mut stage);
        }
    }

    #[test]
    fn the_drag_is_found_for_every_ratio_of_resistances_and_inertia() {
        for inertia in [0.0, 0.1, 10.0] {
            for ratios in [
                [0.2, 0.5, 1.0, 1.3, 2.5, 6.0],
                [0.01, 0.1, 1.0, 10.0, 30.0, 100.0],
            ] {
                let (solutions, error) = solutions(&ratios, inertia);
                // The search takes one solution for each distinct ratio, and one more to confirm
                // the result.
                assert!(solutions <= 8, "{ratios:?} {inertia}: {solutions}");
                assert!(error < 1e-6, "{ratios:?} {inertia}: {error}");
            }
        }
    }

    #[test]
    fn more_directions_than_are_remembered_lead_to_the_solution() {
        let ratios: Vec<f64> = (0..60).map(|k| 0.2 + 0.05 * f64::from(k)).collect();
        let (_, error) = solutions(&ratios, 0.01);
        assert!(error < 1e-6, "{error}");
    }

    #[test]
    fn a_rod_that_floats_along_with_a_driven_one_is_coupled_within_the_error_of_the_flow() {
        let (nodes, tolerance, inertia) = (8, 1e-6, 1e-9);
        let mut numbers = crate::random::uniform_numbers(3);
        // Every node moves with the others: R is the identity minus 0.08 in every entry.
        let resistance_times = |v: &[Vector3]| -> Vec<Vector3> {
            let sum: Vector3 = v.iter().sum();
            v.iter().map(|v| v - 0.08 * sum).collect()
        };
        let (mut stage, mut coupling) = begun(nodes);
        let flow = Coupling {
            largest_ratio: 1.0,
            tolerance,
        };
        loop {
            // Only the first four nodes are loaded. The drag of the others is balanced only by
            // their inertia, which is almost zero.
            let velocity: Vec<_> = (0..nodes)
                .map(|node| {
                    let load = if node < 4 {
                        Vector3::x()
                    } else {
                        Vector3::zeros()
                    };
                    (load + stage.drag[node] + stage.drag_velocity[node]) / (inertia + 1.0)
                })
                .collect();
            let speed = velocity.iter().map(Vector3::norm_squared).sum::<f64>();
            let drag: Vec<_> = resistance_times(&velocity)
                .into_iter()
                .map(|force| tolerance * speed.sqrt() * (numbers() - 0.5) * Vector3::x() - force)
                .collect();
            let rods = [0..4, 4..8].into_iter();
            if coupling.record(&mut stage, [&velocity; 2], &drag, rods, &flow) {
                // The velocity of an unloaded node: the load on four nodes, divided by one minus
                // the sum over all eight.
                let exact = 1.0 / (1.0 - 0.08 * 8.0) * 0.08 * 4.0;
                let error = velocity[7].x / exact - 1.0;
                assert!(error.abs() < 1e-4, "{error}");
                return;
            }
            assert!(!coupling.is_exhausted());
            coupling.expect(&mut stage);
        }
    }
}
