//! Criteria of balance: the residual of every rod compared with the forces that act on the rod.
//!
//! A correction of Newton's method must leave a residual, at every unknown of a rod, of at most
//! the force tolerance times the largest of the rod's EI/L², its loads and its contact forces. The
//! criterion does not depend on other rods: the residual of a soft beam must be equally small with
//! and without a stiff post beside it.
//!
//! EI/L² may be far above the forces that act: a short steel rod hardly bends under its weight.
//! The deflection of such a rod is linear in the forces, and one correction finds it to many
//! digits, whatever the allowed residual. This correction must be made. A predicted configuration
//! without any correction counts as balanced only if the residual at every unknown is small
//! compared with the forces at that unknown ([`System::is_balanced_as_predicted`]).
//!
//! In a time step a rod may also turn, which is not linear. Forces that turn with the rod leave a
//! residual after one correction, and its work may not be negligible compared with the energy of a
//! slow motion. Such a residual is corrected once more ([`System::residual_does_work`]).
//!
//! The allowed residual is never smaller than the effect of rounding the unknowns on elastic
//! forces and, in a time step, on inertia and friction, since the slip is the difference of two
//! positions over the step.

use super::contact::visit_forces;
use super::joints::Slide;
use super::{Assembly, Stage, System};
use crate::mechanics::contact::ContactSystem;
use crate::mechanics::rod::{RodRange, STRIDE};

/// Number of units in the last place of the unknowns to which a residual must vanish.
const ROUNDINGS: f64 = 8.0;
/// Factor on the rounding estimate, which is made for single terms of a sum. Below this bound, a
/// residual that corrections no longer reduce counts as rounding error.
const NEAR_ROUNDING: f64 = 8.0;

/// Negligible work of the remaining residual, relative to the energy of a rod: such works add up
/// over many steps.
pub(super) const NEGLIGIBLE_WORK: f64 = 1e-5;

/// Tolerances of the residual.
pub(super) struct Tolerances {
    rods: Vec<RodTolerance>,
    /// Tolerance relative to the acting forces.
    relative: f64,
    /// Scratch: which nodes are in contact.
    in_contact: Vec<bool>,
}

impl Tolerances {
    /// Creates tolerances that are not set yet.
    pub(crate) fn new(assembly: &Assembly) -> Self {
        Self {
            rods: vec![RodTolerance::default(); assembly.rods.rods.len()],
            relative: 0.0,
            in_contact: vec![false; assembly.rods.nodes],
        }
    }
}

/// Tolerance of the residual of one rod.
#[derive(Clone, Copy, Debug, Default)]
struct RodTolerance {
    /// Tolerance of the residual, N; infinite for a rod that is held.
    force: f64,
    /// Rounding error of the residual, N.
    rounding: f64,
    /// Weight of the residual of the rod among all rods: 1 for the rod with the least tolerance.
    weight: f64,
}

/// Largest magnitudes on a rod, for each kind of unknown at a node.
#[derive(Default)]
struct Sizes {
    unknowns: [f64; STRIDE],
    /// Weighted.
    loads: [f64; STRIDE],
    /// Weighted masses times free unknowns.
    inertia: [f64; STRIDE],
}

impl Sizes {
    /// Collects unknowns, loads and masses; `held` marks held unknowns.
    fn of(numbers: [&[f64]; 3], held: &[bool], weights: [f64; STRIDE]) -> Self {
        let [unknowns, loads, masses] = numbers.map(|own| own.as_chunks::<STRIDE>().0);
        let (held, _) = held.as_chunks::<STRIDE>();
        let mut largest = Self::default();
        let numbers = unknowns.iter().zip(loads).zip(masses);
        for (((unknowns, loads), masses), held) in numbers.zip(held) {
            for k in 0..STRIDE {
                let size = unknowns[k].abs();
                let inertia = if held[k] {
                    0.0
                } else {
                    weights[k] * masses[k] * size
                };
                keep_larger(&mut largest.unknowns[k], size);
                keep_larger(&mut largest.loads[k], weights[k] * loads[k].abs());
                keep_larger(&mut largest.inertia[k], inertia);
            }
        }
        largest
    }
}

/// Keeps the larger value. Like [`f64::max`] for a kept value that is a number, but a single
/// instruction.
pub(crate) fn keep_larger(kept: &mut f64, size: f64) {
    *kept = if size > *kept { size } else { *kept };
}

fn largest(of: [f64; STRIDE]) -> f64 {
    of.into_iter().fold(0.0, f64::max)
}

/// Imbalance of forces.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Imbalance {
    /// Largest ratio of the residual of a free unknown to its tolerance: balanced if at most 1.
    pub ratio: f64,
    /// That residual, N; moments are divided by the shortest edge of their rod.
    pub residual: f64,
    /// Its unknown.
    pub unknown: usize,
}

impl Imbalance {
    /// Whether every residual is within its tolerance.
    pub(crate) fn is_balanced(&self) -> bool {
        self.ratio <= 1.0
    }

    /// Replaces this imbalance by the residual of an unknown if that is worse or NaN.
    fn compare(&mut self, residual: f64, allowed: f64, unknown: usize) {
        let ratio = residual / allowed;
        if ratio > self.ratio || ratio.is_nan() {
            *self = Self {
                ratio,
                residual,
                unknown,
            };
        }
    }
}

impl System {
    /// Sets the tolerance of the residual near `unknowns`: `relative` times the forces of each
    /// rod, but at least the effect of rounding.
    pub(crate) fn set_tolerances(
        &mut self,
        relative: f64,
        unknowns: &[f64],
        stage: Option<&Stage>,
    ) {
        self.tolerances.relative = relative;
        let mut tolerances = std::mem::take(&mut self.tolerances.rods);
        tolerances.clear();
        let contact = self.contact();
        let friction = contact.map_or(0.0, ContactSystem::steepest_friction);
        for (rod, range) in self.assembly.rods.rods.iter().enumerate() {
            let scale = &self.assembly.scales[rod];
            let own = STRIDE * range.first_node..STRIDE * (range.first_node + range.nodes);
            let weights = [1.0, 1.0, 1.0, 1.0 / scale.shortest_edge];
            let numbers = [unknowns, &self.terms.loads.present, &self.assembly.masses];
            let numbers = numbers.map(|of_all| &of_all[own.clone()]);
            let held = &self.assembly.held[own.clone()];
            let sizes = Sizes::of(numbers, held, weights);
            let [largest_load, inertia] = [sizes.loads, sizes.inertia].map(largest);
            let farthest = largest([sizes.unknowns[0], sizes.unknowns[1], sizes.unknowns[2], 0.0]);
            let inertia = stage.map_or(0.0, |stage| {
                inertia * f64::EPSILON / (stage.step * stage.acceleration_step)
            });
            let friction =
                stage.map_or(0.0, |stage| friction * farthest * f64::EPSILON / stage.step);
            let elastic = scale.rounding_stiffness * farthest * self.terms.damping.stiffening(rod);
            let rounding = ROUNDINGS * elastic.max(inertia).max(friction);
            let force = (relative * scale.force.max(largest_load)).max(rounding);
            tolerances.push(RodTolerance {
                force: if self.assembly.obstacle[range.first_node] {
                    f64::INFINITY
                } else {
                    force
                },
                rounding,
                weight: 1.0,
            });
        }
        if let Some(contact) = self.contact() {
            let pressed = contact.candidates().iter().zip(contact.normal_forces());
            for (pair, force) in pressed.filter(|(_, force)| **force > 0.0) {
                let nodes = [pair.nodes[0], pair.nodes[3]].into_iter();
                for node in nodes.filter(|node| contact.is_of_rod(*node)) {
                    let rod = self.assembly.locate(contact.node_of(node)).0;
                    tolerances[rod].force = tolerances[rod].force.max(relative * force);
                }
            }
        }
        // At a joint, the residual of each rod contains the rounding errors of the other rod's
        // forces.
        let joints = &self.assembly.joints;
        let slides = (joints.slides.iter()).map(|slide| [slide.node, slide.rail().start]);
        let pins = joints.pins.iter().map(|pin| {
            let frame = &joints.frames[pin.frame];
            [pin.node, frame.node]
        });
        for nodes in joints.points.iter().copied().chain(slides).chain(pins) {
            let rods = nodes.map(|node| self.assembly.locate(node).0);
            let rounding = rods.map(|rod| tolerances[rod].rounding);
            let rounding = rounding[0].max(rounding[1]);
            for rod in rods {
                tolerances[rod].rounding = rounding;
                tolerances[rod].force = tolerances[rod].force.max(rounding);
            }
        }
        let least = tolerances
            .iter()
            .fold(f64::INFINITY, |least, rod| least.min(rod.force));
        for tolerance in &mut tolerances {
            if tolerance.force > least && tolerance.force.is_finite() {
                tolerance.weight = least / tolerance.force;
            }
        }
        self.tolerances.rods = tolerances;
    }

    /// The tolerance of a rod, N, and its weight among those of all rods.
    pub(super) fn allowance(&self, rod: usize) -> (f64, f64) {
        let tolerance = &self.tolerances.rods[rod];
        (tolerance.force, tolerance.weight)
    }

    /// The least tolerance of all rods, N; 0 where all rods are held.
    pub(super) fn least_tolerance(&self) -> f64 {
        let forces = self.tolerances.rods.iter().map(|rod| rod.force);
        let least = forces.fold(f64::INFINITY, f64::min);
        if least.is_finite() { least } else { 0.0 }
    }

    /// Whether no rod has a residual larger than a few times the rounding error of the forces on
    /// it.
    pub(crate) fn is_at_rounding(&self) -> bool {
        let imbalance = self.imbalance_against(|rod| NEAR_ROUNDING * rod.rounding);
        imbalance.is_balanced()
    }

    /// Imbalance of the residual of the last evaluation.
    pub(crate) fn imbalance(&self) -> Imbalance {
        self.imbalance_against(|rod| rod.force)
    }

    /// Imbalance with another tolerance for each rod, N.
    fn imbalance_against(&self, allowed_of: impl Fn(&RodTolerance) -> f64) -> Imbalance {
        let allowed_at =
            |node: usize| allowed_of(&self.tolerances.rods[self.assembly.locate(node).0]);
        let mut worst = Imbalance {
            ratio: 0.0,
            residual: 0.0,
            unknown: 0,
        };
        for (rod, range) in self.assembly.rods.rods.iter().enumerate() {
            if !self.tolerances.rods[rod].force.is_finite() {
                continue;
            }
            let (size, unknown) = self.worst_of(range, self.assembly.scales[rod].shortest_edge);
            worst.compare(size, allowed_of(&self.tolerances.rods[rod]), unknown);
        }
        for frame in &self.assembly.joints.frames {
            let rod = self.assembly.locate(frame.node).0;
            let size = self.residual_of_frame(frame.first_unknown, rod);
            worst.compare(size, allowed_at(frame.node), STRIDE * frame.node);
        }
        for slide in &self.assembly.joints.slides {
            let size = self.residual_along(slide);
            worst.compare(size, allowed_at(slide.node), STRIDE * slide.node);
        }
        worst
    }

    /// Residual of a sliding node along its rod, N.
    fn residual_along(&self, slide: &Slide) -> f64 {
        self.residual[slide.unknown].abs() / slide.edge()
    }

    /// Largest residual of the unknowns of a frame of a joint, N; the moment about a hinge is divided by the shortest edge.
    fn residual_of_frame(&self, first: usize, rod: usize) -> f64 {
        let free = |k: usize| match self.assembly.held[first + k] {
            true => 0.0,
            false => self.residual[first + k],
        };
        let own: [f64; STRIDE] = std::array::from_fn(free);
        let per_length = 1.0 / self.assembly.scales[rod].shortest_edge;
        // A NaN stays one.
        let larger = |most: f64, size: f64| {
            if size > most || size.is_nan() {
                size
            } else {
                most
            }
        };
        let turning = own[..3].iter().map(|r| r.abs()).fold(0.0, larger);
        turning + own[3].abs() * per_length
    }

    /// Largest residual of a free unknown of a rod, N, with moments divided by `edge` (m), and the
    /// index of that unknown.
    fn worst_of(&self, range: &RodRange, edge: f64) -> (f64, usize) {
        let mut worst = (0.0, STRIDE * range.first_node);
        let per_length = 1.0 / edge;
        for k in STRIDE * range.first_node..STRIDE * (range.first_node + range.nodes) {
            if self.assembly.held[k] {
                continue;
            }
            let value = self.residual[k].abs();
            let size = if k % STRIDE == 3 {
                value * per_length
            } else {
                value
            };
            if size > worst.0 || size.is_nan() {
                worst = (size, k);
            }
        }
        worst
    }

    /// Whether the residual of the last evaluation, at `unknowns` that were only predicted, is so
    /// small that no correction is needed. At every unknown with a load the residual is compared
    /// with that load alone. At other unknowns it is compared with the largest force on their rod
    /// (loads, inertia, drag, contact, springs, reactions of clamps) or, without any such force,
    /// with the rounding error.
    pub(crate) fn is_balanced_as_predicted(
        &mut self,
        unknowns: &[f64],
        stage: Option<&Stage>,
    ) -> bool {
        let mut acting = std::mem::take(&mut self.corrected_residual);
        acting.fill(0.0);
        let at = self.at(unknowns, stage);
        for term in self.terms.all() {
            term.add_sizes(&at, &mut acting);
        }
        let mut in_contact = std::mem::take(&mut self.tolerances.in_contact);
        in_contact.fill(false);
        if let Some(contact) = &self.terms.contact.model {
            visit_forces(contact, |node, _| in_contact[node] = true);
        }
        let rods = self.assembly.rods.rods.iter().enumerate();
        let balanced = rods
            .filter(|(rod, _)| self.tolerances.rods[*rod].force.is_finite())
            .all(|(rod, range)| self.is_rod_balanced(rod, range, &acting, &in_contact))
            && self.assembly.joints.frames.iter().all(|frame| {
                let rod = self.assembly.locate(frame.node).0;
                let rounding = self.tolerances.rods[rod].rounding;
                self.residual_of_frame(frame.first_unknown, rod) <= rounding
            })
            && self.assembly.joints.slides.iter().all(|slide| {
                let rod = self.assembly.locate(slide.node).0;
                self.residual_along(slide) <= self.tolerances.rods[rod].rounding
            });
        self.corrected_residual = acting;
        self.tolerances.in_contact = in_contact;
        balanced
    }

    /// Applies this criterion to one rod; `acting` are the forces on its unknowns except loads.
    fn is_rod_balanced(
        &self,
        rod: usize,
        range: &RodRange,
        acting: &[f64],
        in_contact: &[bool],
    ) -> bool {
        let per_length = 1.0 / self.assembly.scales[rod].shortest_edge;
        let weights = [1.0, 1.0, 1.0, per_length];
        let unknowns = STRIDE * range.first_node..STRIDE * (range.first_node + range.nodes);
        let rounding = self.tolerances.rods[rod].rounding;
        let (mut largest, mut reactions) = (0.0_f64, 0.0_f64);
        for k in unknowns.clone() {
            let weight = weights[k % STRIDE];
            largest = largest.max(weight * self.terms.loads.present[k].abs().max(acting[k].abs()));
            if self.assembly.held[k] {
                reactions = reactions.max(weight * self.residual[k].abs());
            }
        }
        // A clamp of a rod without other forces still carries the rounding errors of its elastic forces.
        if reactions > rounding {
            largest = largest.max(reactions);
        }
        unknowns.filter(|&k| !self.assembly.held[k]).all(|k| {
            let weight = weights[k % STRIDE];
            let load = weight * self.terms.loads.present[k].abs();
            let allowed = if largest == 0.0 {
                rounding
            } else if load > 0.0 && !in_contact[k / STRIDE] {
                self.tolerances.relative * load
            } else {
                self.tolerances.relative * largest
            };
            weight * self.residual[k].abs() <= allowed
        })
    }

    /// Whether the remaining residual does significant work on a rod in a step that ends at
    /// `unknowns`, where it was last evaluated: more than is negligible compared with the energy
    /// of the rod and the work of its loads, and more than rounding errors.
    pub(crate) fn residual_does_work(&self, unknowns: &[f64], stage: &Stage) -> bool {
        let mut rods = self.assembly.rods.rods.iter().enumerate();
        rods.any(|(rod, range)| {
            let tolerance = self.tolerances.rods[rod];
            if !tolerance.force.is_finite() {
                return false;
            }
            let (mut work, mut energy) = (0.0, 0.0);
            for k in STRIDE * range.first_node..STRIDE * (range.first_node + range.nodes) {
                if self.assembly.held[k] {
                    continue;
                }
                let moved = unknowns[k] - stage.start[k];
                let velocity = moved / stage.step;
                work += self.residual[k] * moved;
                energy += 0.5 * self.assembly.masses[k] * velocity * velocity;
                energy += (self.terms.loads.present[k] * moved).abs();
            }
            let counts = |energy: f64| work.abs() > NEGLIGIBLE_WORK * energy;
            counts(energy)
                && counts(energy + self.elastic_energy_of(rod).total())
                && self
                    .worst_of(range, self.assembly.scales[rod].shortest_edge)
                    .0
                    > tolerance.rounding
        })
    }

    /// Sum of squares of the residual of the free unknowns, N². Moments are divided by the
    /// shortest edge of their rod, and each rod is weighted by how small its residual must become.
    pub(crate) fn squared_residual(&self) -> f64 {
        self.square(&self.residual)
    }

    pub(super) fn square(&self, residual: &[f64]) -> f64 {
        let mut sums = [0.0; STRIDE];
        for (rod, range) in self.assembly.rods.rods.iter().enumerate() {
            let weight = self.tolerances.rods[rod].weight;
            let per_length = weight / self.assembly.scales[rod].shortest_edge;
            let weights = [weight, weight, weight, per_length];
            let unknowns = STRIDE * range.first_node..STRIDE * (range.first_node + range.nodes);
            let held = self.assembly.held[unknowns.clone()].chunks_exact(STRIDE);
            for (values, held) in residual[unknowns].chunks_exact(STRIDE).zip(held) {
                for k in 0..STRIDE {
                    let value = if held[k] { 0.0 } else { weights[k] * values[k] };
                    sums[k] += value * value;
                }
            }
        }
        for frame in &self.assembly.joints.frames {
            let rod = self.assembly.locate(frame.node).0;
            let weight = self.tolerances.rods[rod].weight;
            let per_length = weight / self.assembly.scales[rod].shortest_edge;
            let own = frame.first_unknown..frame.first_unknown + STRIDE;
            let held = &self.assembly.held[own.clone()];
            for (k, residual) in residual[own].iter().enumerate() {
                let weight = if k == 3 { per_length } else { weight };
                let value = if held[k] { 0.0 } else { weight * residual };
                sums[k] += value * value;
            }
        }
        for slide in &self.assembly.joints.slides {
            let rod = self.assembly.locate(slide.node).0;
            let along = residual[slide.unknown] * self.tolerances.rods[rod].weight / slide.edge();
            sums[3] += along * along;
        }
        sums.iter().sum()
    }
}
