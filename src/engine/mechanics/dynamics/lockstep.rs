//! Simulations of one kind, stepped together: Newton's method solves up to [`LANES`] stages at
//! once, one in each lane.
//!
//! For wires moved at their ends, most of the time goes into kernels too short to fill vector
//! registers, and into waiting for one factorisation at a time. Copies of a scene with other
//! numbers do the same operations, so that a register holds one number of each copy
//! ([`crate::mechanics::system`], `copies`). Each simulation begins and completes a step itself,
//! with its own step control and all its checks; in between, the predictions of all simulations
//! are corrected together.
//!
//! The corrections are those of [`super::newton`] in the same order, and every lane stops where it
//! would stop alone: a simulation gets the same bytes as alone. If a correction needs a line
//! search, leaves the trust region, or does not converge, its simulation is left at its prediction
//! and continues alone.

use super::newton::{Corrected, LAST_DIGITS, SUFFICIENT_REDUCTION, Stopping};
use super::report::{SimulationError, StepReport};
use super::simulation::Simulation;
use crate::linalg::LaneVector;
use crate::linalg::instruction_set::{LANES, Lanes, kernel};
use crate::mechanics::rod::STRIDE;
use crate::mechanics::system::{Allowance, Copies, Member, set_lanes};

const NONE: Lanes = [0.0; LANES];
/// Fewest simulations for which stepping together is faster.
const FEWEST: usize = 3;

/// Scratch for steps of several simulations.
#[derive(Default)]
pub struct Lockstep {
    group: Option<Group>,
    /// Number of steps of simulations that were solved together.
    pub solved: usize,
}

/// Scratch for one kind of scene.
struct Group {
    copies: Copies,
    unknowns: LaneVector,
}

impl Lockstep {
    /// Largest number of simulations in a group.
    pub const LANES: usize = LANES;

    /// Takes one step in each simulation, which ends no later than the time given beside it, as
    /// long as `goes_on` returns true. Returns for each simulation the result of
    /// [`Simulation::advance_while`].
    ///
    /// Simulations of scenes that differ in numbers only are solved together, [`Self::LANES`] at a
    /// time, if the scenes have separate open rods with clamps, dead loads, linear drag and
    /// material damping. All others are stepped one by one. The results do not depend on which
    /// simulations are stepped together.
    pub fn advance(
        &mut self,
        simulations: &mut [(&mut Simulation, f64)],
        goes_on: &dyn Fn() -> bool,
    ) -> Vec<Result<Option<StepReport>, SimulationError>> {
        let mut results = Vec::with_capacity(simulations.len());
        for group in simulations.chunks_mut(LANES) {
            let begun: Vec<_> = group
                .iter_mut()
                .map(|(simulation, until)| {
                    let rests = simulation
                        .integrator
                        .is_same_time(simulation.state.time, *until);
                    (!rests).then(|| simulation.begin(*until))
                })
                .collect();
            let mut together: Vec<(&mut Simulation, f64)> = (group.iter_mut().zip(&begun))
                .filter_map(|((simulation, _), begun)| {
                    let begun = begun.as_ref()?.as_ref().ok()?;
                    Some((&mut **simulation, begun.goal))
                })
                .collect();
            if together.len() >= FEWEST {
                self.correct(&mut together, goes_on);
            }
            results.extend(
                group
                    .iter_mut()
                    .zip(begun)
                    .map(|((simulation, until), begun)| match begun {
                        Some(begun) => simulation.complete(begun, goes_on),
                        None => simulation.advance_while(*until, goes_on),
                    }),
            );
        }
        results
    }

    /// Corrects the predictions of up to [`LANES`] simulations with begun steps, each given with
    /// its end, s.
    fn correct(&mut self, simulations: &mut [(&mut Simulation, f64)], goes_on: &dyn Fn() -> bool) {
        let fits = |copies: &mut Copies, simulation: &Simulation| {
            copies.are_of(&simulation.system, &simulation.integrator.workspace.stage)
        };
        let (first, _) = &simulations[0];
        if !(self.group.as_mut()).is_some_and(|group| fits(&mut group.copies, first)) {
            self.group = Group::of(first);
        }
        let Some(group) = &mut self.group else { return };
        let mut members: Vec<_> = (simulations.iter_mut())
            .filter(|(simulation, _)| fits(&mut group.copies, simulation))
            .collect();
        if members.len() < FEWEST {
            return;
        }
        let stopping = group.set(&mut members);
        let found = group.solve(&stopping, goes_on);
        let mut solved = Vec::with_capacity(members.len());
        for (lane, ((simulation, _), found)) in members.iter_mut().zip(found).enumerate() {
            let workspace = &mut simulation.integrator.workspace;
            workspace.corrected = found;
            if found.is_some() {
                let unknowns = workspace.trial.unknowns.iter_mut();
                let lanes = group.unknowns.iter();
                unknowns
                    .zip(lanes)
                    .for_each(|(own, lanes)| *own = lanes[lane]);
                solved.push((lane, &mut simulation.system));
            }
        }
        self.solved += solved.len();
        group.copies.give(&mut solved);
    }
}

impl Group {
    /// Creates a group for simulations like this one; `None` if its scene has no copies.
    fn of(simulation: &Simulation) -> Option<Self> {
        let copies = Copies::new(&simulation.system)?;
        Some(Self {
            unknowns: LaneVector::new(copies.residual.len()),
            copies,
        })
    }

    /// Loads simulations with begun steps into the lanes, each given with its end, s; spare lanes
    /// repeat the last simulation.
    fn set(&mut self, members: &mut [&mut (&mut Simulation, f64)]) -> Vec<Stopping> {
        let stopping = members.iter_mut().map(|(simulation, goal)| {
            let Simulation {
                system,
                state,
                integrator,
                ..
            } = &mut **simulation;
            let setting = integrator.setting;
            let workspace = &mut integrator.workspace;
            workspace.set_tolerances(&setting, system, state, *goal)
        });
        let stopping = stopping.collect();
        let last = members.len() - 1;
        let of_lanes: [&Simulation; LANES] =
            std::array::from_fn(|lane| &*members[lane.min(last)].0);
        self.copies.set(&of_lanes.map(|simulation| Member {
            system: &simulation.system,
            stage: &simulation.integrator.workspace.stage,
        }));
        let predictions = of_lanes.map(|own| &own.integrator.workspace.trial.unknowns[..]);
        set_lanes(&mut self.unknowns, predictions);
        stopping
    }

    /// Corrects the unknowns of the lanes by Newton's method; returns the corrections of the lanes
    /// that have converged.
    fn solve(
        &mut self,
        stopping: &[Stopping],
        goes_on: &dyn Fn() -> bool,
    ) -> [Option<Corrected>; LANES] {
        let mut found = [None; LANES];
        let mut works = std::array::from_fn(|lane| lane < stopping.len());
        let copies = &mut self.copies;
        let set = copies.set;
        copies.evaluate(&self.unknowns);
        // A prediction that is balanced already is rare and needs further checks, so it is left to
        // its simulation.
        let imbalance = copies.imbalance();
        for lane in 0..LANES {
            works[lane] &= imbalance[lane] > 1.0 && imbalance[lane].is_finite();
        }
        let mut residual_before = copies.squared_residual();
        // Largest magnitude of a position unknown in each lane.
        let mut reach = largest_moves(set, &self.unknowns);
        for iteration in 0.. {
            for (lane, stopping) in stopping.iter().enumerate() {
                works[lane] &= iteration < stopping.iterations;
            }
            if !works.contains(&true) || !goes_on() {
                break;
            }
            copies.solve();
            let moves = largest_moves(set, copies.direction());
            for (lane, stopping) in stopping.iter().enumerate() {
                // A comparison with NaN is false.
                works[lane] &= moves[lane] <= stopping.trust_radius;
                reach[lane] += moves[lane];
            }
            let slope_before = copies.slope();
            let moving = works.map(f64::from);
            move_lanes(set, &moving, copies.direction_mut(), &mut self.unknowns);
            copies.evaluate(&self.unknowns);
            let imbalance = copies.imbalance();
            let changes =
                match (0..LANES).any(|lane| works[lane] && is_small(moves[lane], reach[lane])) {
                    true => exceed_last_digits(set, copies.direction(), &self.unknowns),
                    false => [1.0; LANES],
                };
            let mut is_found = [false; LANES];
            for (lane, stopping) in stopping.iter().enumerate() {
                let changes_nothing = stopping.ends_at_last_digits && changes[lane] == 0.0;
                let is_balanced = imbalance[lane] <= 1.0;
                let is_settled = is_balanced && moves[lane] <= stopping.displacement;
                is_found[lane] = works[lane] && (is_settled || changes_nothing);
                if is_found[lane] {
                    found[lane] = Some(Corrected {
                        iterations: iteration + 1,
                        last_move: moves[lane],
                        changes_nothing,
                        is_balanced,
                        may_do_work: true,
                    });
                }
            }
            if is_found.contains(&true) {
                let may_do_work = copies.may_do_work(&self.unknowns);
                for lane in (0..LANES).filter(|lane| is_found[*lane]) {
                    works[lane] = false;
                    found[lane]
                        .iter_mut()
                        .for_each(|found| found.may_do_work = may_do_work[lane]);
                }
            }
            if !works.contains(&true) {
                break;
            }
            let (residual, slope) = (copies.squared_residual(), copies.slope());
            for lane in 0..LANES {
                let falls = residual[lane] <= residual_before[lane]
                    || slope[lane].abs() <= SUFFICIENT_REDUCTION * slope_before[lane].abs();
                works[lane] &= imbalance[lane].is_finite() && falls;
            }
            residual_before = residual;
        }
        found
    }
}

/// Whether a correction that moves a position by `moves` may be within the last digits, if no
/// position exceeds `reach`.
fn is_small(moves: f64, reach: f64) -> bool {
    moves <= 2.0 * LAST_DIGITS * f64::EPSILON * reach
}

impl Copies {
    /// Largest residual of a free unknown over its tolerance; infinite or NaN if a residual is.
    fn imbalance(&self) -> Lanes {
        let mut largest = NONE;
        for allowance in self.rods_that_move() {
            let own = &self.residual[allowance.unknowns.clone()];
            let held = &self.held[allowance.unknowns.clone()];
            worst_of(self.set, own, held, allowance, &mut largest);
        }
        largest
    }

    /// Sum of squares of the weighted residuals of free unknowns, N².
    fn squared_residual(&self) -> Lanes {
        let mut sums = [NONE; STRIDE];
        for allowance in self.rods_that_move() {
            let own = &self.residual[allowance.unknowns.clone()];
            let held = &self.held[allowance.unknowns.clone()];
            add_squares(self.set, own, held, allowance, &mut sums);
        }
        let mut squares = NONE;
        for sum in sums {
            for lane in 0..LANES {
                squares[lane] += sum[lane];
            }
        }
        squares
    }

    /// Force along the direction, d·R, J.
    fn slope(&self) -> Lanes {
        let mut slope = NONE;
        add_products(self.set, self.direction(), &self.residual, &mut slope);
        slope
    }
}

kernel! {
    /// Moves the unknowns of active lanes along the direction, which becomes zero in the others.
    fn move_lanes(works: &Lanes, direction: &mut [Lanes], unknowns: &mut [Lanes]) {
        for (direction, unknown) in direction.iter_mut().zip(unknowns) {
            for lane in 0..LANES {
                let (rests, moved) = (works[lane] == 0.0, unknown[lane] + direction[lane]);
                unknown[lane] = if rests { unknown[lane] } else { moved };
                direction[lane] = if rests { 0.0 } else { direction[lane] };
            }
        }
    }
}

kernel! {
    /// Largest move of a position along a direction, m; NaN if any move is NaN or infinite.
    fn largest_moves(direction: &[Lanes]) -> Lanes {
        let (mut largest, mut broken) = ([0.0; LANES], [0.0; LANES]);
        for (k, own) in direction.iter().enumerate() {
            for lane in 0..LANES {
                broken[lane] += 0.0 * own[lane];
                if k % STRIDE != 3 {
                    largest[lane] = f64::max(largest[lane], own[lane].abs());
                }
            }
        }
        for lane in 0..LANES {
            largest[lane] += broken[lane];
        }
        largest
    }
}

kernel! {
    /// Updates the largest ratio of a residual to the force tolerance; NaN if any residual is NaN
    /// or infinite.
    fn worst_of(residual: &[Lanes], held: &[bool], allowance: &Allowance, largest: &mut Lanes) {
        let (mut worst, mut broken) = ([0.0; LANES], [0.0; LANES]);
        for (k, own) in residual.iter().enumerate() {
            if held[k] {
                continue;
            }
            for lane in 0..LANES {
                let scale = if k % STRIDE == 3 { allowance.per_length[lane] } else { 1.0 };
                broken[lane] += 0.0 * own[lane];
                worst[lane] = f64::max(worst[lane], own[lane].abs() * scale);
            }
        }
        for lane in 0..LANES {
            let ratio = worst[lane] / allowance.force[lane];
            largest[lane] = f64::max(largest[lane], ratio) + broken[lane];
        }
    }
}

kernel! {
    /// Adds the squares of the weighted residuals, separately for each of the four unknowns of a
    /// node.
    fn add_squares(residual: &[Lanes], held: &[bool], allowance: &Allowance, sums: &mut [Lanes; STRIDE]) {
        for (k, own) in residual.iter().enumerate() {
            if held[k] {
                continue;
            }
            for lane in 0..LANES {
                let scale = if k % STRIDE == 3 { allowance.per_length[lane] } else { 1.0 };
                let value = allowance.weight[lane] * scale * own[lane];
                sums[k % STRIDE][lane] += value * value;
            }
        }
    }
}

kernel! {
    /// Adds d·R.
    fn add_products(direction: &[Lanes], residual: &[Lanes], sum: &mut Lanes) {
        for (direction, residual) in direction.iter().zip(residual) {
            for lane in 0..LANES {
                sum[lane] += direction[lane] * residual[lane];
            }
        }
    }
}

kernel! {
    /// Counts corrections that exceed the last digits of positions and angles. The farthest
    /// position sets the last digit for all positions.
    fn exceed_last_digits(direction: &[Lanes], unknowns: &[Lanes]) -> Lanes {
        let mut farthest = [0.0; LANES];
        for (k, own) in unknowns.iter().enumerate() {
            for lane in 0..LANES {
                if k % STRIDE != 3 {
                    farthest[lane] = f64::max(farthest[lane], own[lane].abs());
                }
            }
        }
        let mut count = [0.0; LANES];
        for (k, (direction, unknown)) in direction.iter().zip(unknowns).enumerate() {
            for lane in 0..LANES {
                let angle = f64::max(unknown[lane].abs(), 1.0);
                let size = if k % STRIDE == 3 { angle } else { farthest[lane] };
                let is_less = direction[lane].abs() <= LAST_DIGITS * f64::EPSILON * size;
                count[lane] += if is_less { 0.0 } else { 1.0 };
            }
        }
        count
    }
}
