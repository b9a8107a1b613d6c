//! Remarks on the validity of a simulation: strains beyond the theory, spurious energy, steps far
//! smaller than requested, rods that overlap in a fluid.
//!
//! Each causes a warning in the log when it first happens, and a remark with its largest size at
//! the end. The numbers are those of the model, but a real rod would behave differently.

use super::flow_overlaps::FlowOverlaps;
use super::parameters::StepSize;
use super::report::{Energies, StepReport};
use super::validity_memory::{
    CaughtSlide, FlowOverlap, Gain, LargeStrain, SmallSteps, ValidityMemory,
};
use crate::mechanics::Vector3;
use crate::mechanics::contact::edge_distance;
use crate::mechanics::scene::{Clamp, FreeBody, Load, LoadKind, RodDescription, Scene, Tendon};
use crate::mechanics::system::{SectionScales, Strain, System};
use tracing::warn;

/// Stretch above which a remark is made: Hooke's law and a constant cross-section have an error of
/// first order in the strain.
const LARGEST_STRETCH: f64 = 0.05;
/// Strain of the outer fibres by bending, and shear of the surface by twist, above which a remark
/// is made: by the symmetry of the section the error of the theory is of second order, 4 % of the
/// moment at this size.
const LARGEST_BEND: f64 = 0.2;
/// Apparent friction coefficient of edges above which a remark is made.
pub const LARGEST_CATCH: f64 = 0.05;
/// Stretch at which a lack of convergence is expected.
const CRUSHING: f64 = 0.5;
/// Gain of energy, relative to the largest explained energy so far, above which rounding, Newton's
/// method or oscillations of the midpoint rule cannot be the cause.
const LARGEST_GAIN: f64 = 0.05;
/// Gain at which a run ends, because its results are meaningless.
const RUINOUS_GAIN: f64 = 1.0;
/// Fraction of all energy exchanged that may be counted wrongly: work is a sum of forces at the
/// ends of steps.
const MISCOUNTED: f64 = 0.1;
/// Gain of energy that is ignored, relative to the energy EI/L that bends each rod by a radian
/// over its length.
const ROUNDING: f64 = 1e-6;
/// Fraction of the explained energy that stiffer contacts may add in all.
const STIFFENED: f64 = 1e-2;
/// Ratio of the distance of centrelines to the sum of the radii below which rods count as close.
const NEAR: f64 = 1.5;
/// Number of steps between checks; a check costs some thousandths of a step.
const INTERVAL: usize = 16;

/// Kind of strain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Stretch,
    Bending,
    Twist,
}

/// Watches a simulation.
#[derive(Clone, Debug, Default)]
pub(super) struct Validity {
    sections: Vec<SectionScales>,
    /// Smaller bending stiffness of each rod, N m².
    bending: Vec<f64>,
    /// Speed √(EA/ρA) of stretching waves in each rod, m/s; infinite in held rods.
    wave_speeds: Vec<f64>,
    /// Whether steps are chosen by their error.
    has_automatic_steps: bool,
    /// Distance tolerance δ of contact, m; 0 without contact.
    distance_tolerance: f64,
    /// Energy below which a gain is ignored, J.
    rounding: f64,
    /// Finds rods that pass through each other in a fluid.
    overlaps: Option<FlowOverlaps>,
    pub memory: ValidityMemory,
}

impl Kind {
    const ALL: [Self; 3] = [Self::Stretch, Self::Bending, Self::Twist];

    fn bound(self) -> f64 {
        match self {
            Self::Stretch => LARGEST_STRETCH,
            Self::Bending | Self::Twist => LARGEST_BEND,
        }
    }

    fn suffered(self, size: f64) -> &'static str {
        match self {
            Self::Stretch if size > 0.0 => "stretched",
            Self::Stretch => "compressed",
            Self::Bending => "bent, with outer fibres strained",
            Self::Twist => "twisted, with its surface sheared",
        }
    }

    fn theory(self) -> &'static str {
        match self {
            Self::Stretch => {
                "the theory of rods holds for strains of a few per cent, and its relative error is about the stretch"
            }
            Self::Bending | Self::Twist => {
                "the relative error of the theory of rods is about the square of that strain, 4 % at 20 %"
            }
        }
    }
}

impl Validity {
    /// Creates the checks for simulations of `scene`.
    pub(crate) fn new(scene: &Scene) -> Self {
        let is_accounted_for = |load: &Load| match load.kind {
            LoadKind::Gravity { .. } => load.schedule.is_empty(),
            LoadKind::Drag { .. } => true,
            LoadKind::Force { .. }
            | LoadKind::Moment { .. }
            | LoadKind::Distributed { .. }
            | LoadKind::FollowerForce { .. }
            | LoadKind::FollowerMoment { .. }
            | LoadKind::FollowerDistributed { .. } => false,
        };
        // The work of rotating clamps is not counted, nor that of changing natural strains.
        let turns = |clamp: &Clamp| {
            let motion = &clamp.motion;
            motion.angular_velocity != 0.0
                || !motion.angle.is_empty()
                || !motion.orientation.is_empty()
        };
        Self {
            sections: scene.rods.iter().map(SectionScales::of).collect(),
            bending: (scene.rods.iter())
                .map(RodDescription::softest_bending)
                .collect(),
            wave_speeds: scene.rods.iter().map(wave_speed).collect(),
            has_automatic_steps: false,
            distance_tolerance: scene
                .contact
                .map_or(0.0, |contact| contact.distance_tolerance),
            rounding: ROUNDING * scene.rods.iter().map(bending_energy).sum::<f64>(),
            overlaps: None,
            memory: ValidityMemory {
                is_conservative: scene.fluid.is_none()
                    && scene.actuations.is_empty()
                    && scene.sheaths.is_empty()
                    && scene.tendons.iter().all(Tendon::is_conservative)
                    && !scene.free_bodies.iter().any(FreeBody::is_driven)
                    && scene.loads.iter().all(is_accounted_for)
                    && !scene.clamps.iter().any(turns),
                ..ValidityMemory::default()
            },
        }
    }

    /// Sets how steps are chosen.
    pub(crate) fn with_steps(mut self, step: &StepSize) -> Self {
        self.has_automatic_steps = matches!(step, StepSize::Auto { .. });
        self
    }

    /// Watches rods that interact through a fluid but do not touch.
    pub(crate) fn with_overlaps(mut self, overlaps: Option<FlowOverlaps>) -> Self {
        self.overlaps = overlaps;
        self
    }

    /// Advice for the case that a scheme adds energy.
    fn gaining(&self) -> &'static str {
        if self.has_automatic_steps {
            "the time steps are too large for this scheme; take a smaller time.tolerance, or time.scheme = \"implicit-euler\""
        } else {
            "the time step is too large for this scheme; take smaller steps, time.step = \"auto\", or time.scheme = \"implicit-euler\""
        }
    }

    /// Stops the energy balance: forces outside the scene act, or a clamp deviates from its
    /// prescribed motion.
    pub(crate) fn stop_counting_energy(&mut self) {
        self.memory.is_conservative = false;
    }

    /// Checks the strains of all rods at `unknowns`, where the system was last evaluated.
    pub(crate) fn check_strains(&mut self, system: &System, unknowns: &[f64], time: f64) {
        let found = system.largest_strains(unknowns, &self.sections);
        self.note_strain(system, Kind::Stretch, found.stretch, time);
        self.note_strain(system, Kind::Bending, found.bending, time);
        self.note_strain(system, Kind::Twist, found.twist, time);
    }

    /// Checks whether edges are short enough for the force of the nodes that slide along them.
    pub(crate) fn check_slides(&mut self, system: &System, time: f64) {
        for slide in system.slides() {
            let [node, rail] = [slide.node, slide.rail().start];
            let (rod, _) = system.assembly.locate(rail);
            if system.assembly.obstacle[rail] {
                continue;
            }
            let friction = apparent_friction(slide.force(), slide.edge(), self.bending[rod]);
            let kept = &mut self.memory.slide;
            if !(friction > LARGEST_CATCH) || kept.is_some_and(|kept| kept.friction >= friction) {
                continue;
            }
            let is_first = kept.is_none();
            let caught = CaughtSlide {
                friction,
                edge: slide.edge() * (LARGEST_CATCH / friction).sqrt(),
                node,
                rail,
                time,
            };
            *kept = Some(caught);
            if is_first {
                warn!("{}", in_words(system, &caught));
            }
        }
    }

    /// Checks whether rods pass through each other in a fluid.
    fn check_overlaps(&mut self, system: &System, unknowns: &[f64], time: f64) {
        let Some(overlaps) = &self.overlaps else {
            return;
        };
        if self.memory.overlap.is_some() {
            return;
        }
        if let Some(nodes) = overlaps.find(system, unknowns) {
            let overlap = FlowOverlap { nodes, time };
            self.memory.overlap = Some(overlap);
            warn!("{}", overlap.in_words(system));
        }
    }

    /// Records the remark on an unstable equilibrium.
    pub(crate) fn note_instability(&mut self, message: String) {
        self.memory.instability.get_or_insert(message);
    }

    fn note_strain(&mut self, system: &System, kind: Kind, found: Option<Strain>, time: f64) {
        let Some(Strain { size, node }) = found.filter(|found| found.size.abs() > kind.bound())
        else {
            return;
        };
        let kept = match kind {
            Kind::Stretch => &mut self.memory.stretch,
            Kind::Bending => &mut self.memory.bending,
            Kind::Twist => &mut self.memory.twist,
        };
        if kept.is_none_or(|kept| kept.size.abs() < size.abs()) {
            let since = kept.map(|kept| kept.since);
            *kept = Some(LargeStrain {
                size,
                node,
                time,
                since: since.unwrap_or(time),
            });
            if since.is_none() {
                let (rod, node) = system.assembly.locate(node);
                warn!(
                    "at t = {time:.4} s rod `{}` is {} by {:.0} % at node {node}: {}",
                    system.assembly.names[rod],
                    kind.suffered(size),
                    100.0 * size.abs(),
                    kind.theory()
                );
            }
        }
    }

    /// Describes two rods that collide faster than stretching waves travel in one of them. Such an
    /// impact cannot propagate along the rod, whose strain is then of the order of one. Used if no
    /// time step converges any more.
    pub(crate) fn fast_impact(
        &self,
        system: &System,
        positions: &[Vector3],
        velocities: &[Vector3],
    ) -> Option<String> {
        let contact = system.contact()?;
        let mut fastest: Option<(f64, String)> = None;
        let of_rods =
            |pair: &&crate::mechanics::contact::CandidatePair| contact.is_of_rod(pair.nodes[3]);
        for pair in contact.candidates().iter().filter(of_rods) {
            let of_point = |point: usize| system.assembly.locate(contact.node_of(point)).0;
            let [a, b] = [pair.nodes[0], pair.nodes[2]].map(of_point);
            let is_free = |rod: usize| system.assembly.rods.rods[rod].rigid;
            if is_free(a) || is_free(b) {
                continue;
            }
            let radii = system.assembly.radii[a] + system.assembly.radii[b];
            let place = |point: usize| contact.motion_of_point(point, |node| positions[node]);
            if edge_distance(&pair.nodes.map(place)) > NEAR * radii {
                continue;
            }
            let velocity =
                |k: usize| contact.motion_of_point(pair.nodes[k], |node| velocities[node]);
            let mean = |k: usize| 0.5 * (velocity(k) + velocity(k + 1));
            let speed = (mean(0) - mean(2)).norm();
            let wave = self.wave_speeds[a].min(self.wave_speeds[b]);
            if speed > wave && fastest.as_ref().is_none_or(|(found, _)| *found < speed) {
                let [first, second] = [a, b].map(|rod| &system.assembly.names[rod]);
                let who = if a == b {
                    format!("parts of rod `{first}`")
                } else {
                    format!("rods `{first}` and `{second}`")
                };
                let reason = format!(
                    "{who} collide at {speed:.3} m/s, faster than stretching waves travel in them ({wave:.3} m/s): such an impact crushes a rod, and the theory of rods does not cover it"
                );
                fastest = Some((speed, reason));
            }
        }
        fastest.map(|(_, reason)| reason)
    }

    /// Describes a rod that is stretched or compressed beyond Hooke's law. Used if no time step
    /// converges any more.
    pub(crate) fn crushed(&self, system: &System, unknowns: &[f64]) -> Option<String> {
        let found = system.largest_strains(unknowns, &self.sections).stretch?;
        (found.size.abs() > CRUSHING).then(|| {
            let (rod, node) = system.assembly.locate(found.node);
            format!(
                "rod `{}` is {} by {:.0} % at node {node} and no time step converges any more: the theory of rods holds for strains of a few per cent",
                system.assembly.names[rod],
                Kind::Stretch.suffered(found.size),
                100.0 * found.size.abs()
            )
        })
    }

    /// Records that velocities ring in the step that ended at `time`, s.
    pub(crate) fn note_ringing(&mut self, time: f64) {
        if self.memory.ringing.is_none() {
            self.memory.ringing = Some(time);
            warn!("at t = {time:.4e} s {RINGING}");
        }
    }

    /// Warns of a series of steps far smaller than requested, once for each advice, and counts
    /// later series.
    pub(crate) fn note_small_steps(&mut self, row: SmallSteps) {
        let known = &mut self.memory.small_steps;
        match known.iter_mut().find(|known| known.advice == row.advice) {
            Some(known) => known.rows += 1,
            None => {
                warn!("{}", row.in_words());
                known.push(row);
            }
        }
    }

    /// Checks some of the accepted steps. Returns the reason to end the run if the spurious energy
    /// is ruinous.
    ///
    /// The energy E of rods and contacts minus the energy W taken in must not grow: the gain is
    /// (E − W) minus its least value so far. The gain is compared with the largest kinetic and
    /// elastic energy that is not gain, plus a tenth of all energy exchanged. Resting contacts hold
    /// some fraction of their force times δ, by which the energy may oscillate.
    pub(crate) fn after_step(
        &mut self,
        system: &System,
        report: &StepReport,
        unknowns: &[f64],
        energies: impl Fn() -> Energies,
    ) -> Option<String> {
        let time = report.time;
        self.count_exchange(report);
        self.memory.steps += 1;
        if self.memory.steps % INTERVAL != 1 {
            return None;
        }
        self.check_strains(system, unknowns, time);
        self.check_slides(system, time);
        self.check_overlaps(system, unknowns, time);
        if !self.memory.is_conservative {
            return None;
        }
        let resting = self.energy_of_resting_contacts(time);
        let advice = self.gaining();
        let memory = &mut self.memory;
        let now = energies();
        let own = now.total() - memory.taken_in;
        let lowest = memory.lowest.map_or(own, |lowest| lowest.min(own));
        memory.lowest = Some(lowest);
        let gain = own - lowest;
        memory.explained = (memory.explained).max(now.kinetic + now.elastic() - gain);
        let scale = memory.explained + MISCOUNTED * memory.exchanged;
        let negligible = resting + self.rounding;
        if gain > LARGEST_GAIN * scale + negligible {
            let relative = gain / scale;
            let earlier = memory.gain;
            memory.gain = Some(Gain {
                relative: earlier.map_or(relative, |earlier| earlier.relative.max(relative)),
                since: earlier.map_or(time, |earlier| earlier.since),
            });
            if earlier.is_none() {
                warn!(
                    "at t = {time:.4} s the rods have gained {gain:.3e} J of spurious energy, {:.0} % of their energy: {advice}",
                    100.0 * relative
                );
            }
        }
        (gain > RUINOUS_GAIN * scale + negligible).then(|| {
            format!(
                "at t = {time:.6e} s the rods have gained {gain:.3e} J of spurious energy, more than the {scale:.3e} J that they had: {advice}"
            )
        })
    }

    /// Adds the energy that a step received and dissipated.
    fn count_exchange(&mut self, report: &StepReport) {
        let exchange = &report.exchange;
        let lost = exchange.friction_loss + exchange.drag_loss;
        let given = exchange.clamp_work + report.obstacle_work;
        self.memory.impulse += report.contact_force * report.step;
        let resting = self.energy_of_resting_contacts(report.time);
        let memory = &mut self.memory;
        // In all, contacts at rest hold no more than this. What is beyond is spurious.
        let room = STIFFENED * memory.explained + resting - memory.stiffened;
        let stiffened = report.stiffening.min(room.max(0.0));
        memory.stiffened += stiffened;
        memory.taken_in += given - lost + stiffened;
        memory.exchanged += exchange.clamp_work.abs() + report.obstacle_work.abs() + lost.abs();
    }

    /// Mean normal force of all contacts so far times δ, J.
    fn energy_of_resting_contacts(&self, time: f64) -> f64 {
        if time > 0.0 {
            self.memory.impulse / time * self.distance_tolerance
        } else {
            0.0
        }
    }

    /// Remarks on the whole motion, one sentence each.
    pub(crate) fn remarks(&self, system: &System) -> Vec<String> {
        let memory = &self.memory;
        let strains = Kind::ALL.map(|kind| {
            let kept = match kind {
                Kind::Stretch => memory.stretch,
                Kind::Bending => memory.bending,
                Kind::Twist => memory.twist,
            };
            kept.map(|kept| {
                let (rod, node) = system.assembly.locate(kept.node);
                let when = match kept.time {
                    0.0 => String::new(),
                    time => format!(
                        ", t = {time:.4} s; beyond {:.0} % from {:.4} s",
                        100.0 * kind.bound(),
                        kept.since
                    ),
                };
                format!(
                    "rod `{}` was {} by up to {:.0} % (node {node}{when}): {}",
                    system.assembly.names[rod],
                    kind.suffered(kept.size),
                    100.0 * kept.size.abs(),
                    kind.theory()
                )
            })
        });
        let gain = memory.gain.map(|gain| {
            format!(
                "from t = {:.4} s the rods gained spurious energy, up to {:.0} % of their energy: {}",
                gain.since,
                100.0 * gain.relative,
                self.gaining()
            )
        });
        let small_steps = memory.small_steps.iter().map(SmallSteps::in_words);
        let ringing = (memory.ringing).map(|since| format!("from t = {since:.4e} s {RINGING}"));
        let slide = memory.slide.map(|caught| in_words(system, &caught));
        let overlap = (memory.overlap).map(|overlap| overlap.in_words(system));
        let rest = [gain, ringing, slide, overlap, memory.instability.clone()];
        let found = strains.into_iter().chain(rest).flatten();
        found.chain(small_steps).collect()
    }
}

/// Apparent friction coefficient of the edges of a rod, of length h, for a node that slides along
/// it under a transverse force F: 0.1 F h²/EI ([`crate::mechanics::system`], `joints::track`).
pub fn apparent_friction(force: f64, edge: f64, bending: f64) -> f64 {
    0.1 * force * edge * edge / bending
}

/// Describes a node that the corners of its rod slow down.
fn in_words(system: &System, caught: &CaughtSlide) -> String {
    let at = |node: usize| {
        let (rod, node) = system.assembly.locate(node);
        (&system.assembly.names[rod], node)
    };
    let ((rod, node), (rail, _)) = (at(caught.node), at(caught.rail));
    let when = match caught.time {
        0.0 => String::new(),
        time => format!(" at t = {time:.4} s"),
    };
    format!(
        "the edges of rod `{rail}` are too long for the force with which node {node} of rod `{rod}` slides along it: the corners resist like friction with a coefficient of up to {:.2}{when}; with edges of {:.2e} m it would be {LARGEST_CATCH}",
        caught.friction, caught.edge
    )
}

/// EI/L of the stiffer direction, J; 0 for a held rod.
fn bending_energy(rod: &RodDescription) -> f64 {
    if rod.held {
        return 0.0;
    }
    let edges = rod.centreline.windows(2);
    let length: f64 = edges.map(|ends| (ends[1] - ends[0]).norm()).sum();
    rod.bending_range()[1] / length
}

fn wave_speed(rod: &RodDescription) -> f64 {
    if rod.held {
        return f64::INFINITY;
    }
    (rod.stiffness.stretching / rod.mass_per_length).sqrt()
}

const RINGING: &str = "drag exceeds inertia within a step, and the midpoint rule does not damp \
    motions that its steps do not resolve: velocities alternate from step to step about their \
    mean, while positions are correct. Use scheme = \"backward-differences\"";

#[cfg(test)]
mod tests {
    use super::super::test_log::Log;
    use super::super::tests::heavy_cantilever;
    use super::*;

    #[test]
    fn rows_of_small_steps_are_warned_of_once_for_each_advice_and_counted() {
        let scene = heavy_cantilever(4);
        let system = System::new(&scene).unwrap();
        let mut validity = Validity::new(&scene);
        let log = Log::default();
        tracing::subscriber::with_default(log.clone(), || {
            for k in 0..11 {
                let message = format!("at t = {k} s: steps are small");
                let advice = if k == 7 { "try that" } else { "try this" };
                validity.note_small_steps(SmallSteps::first(message, advice.into()));
            }
        });
        let warned = [
            "at t = 0 s: steps are small; try this",
            "at t = 7 s: steps are small; try that",
        ];
        assert_eq!(log.lines(), warned);
        let remarked = [
            "at t = 0 s: steps are small (the first of 10 times); try this",
            "at t = 7 s: steps are small; try that",
        ];
        assert_eq!(validity.remarks(&system), remarked);
    }

    /// Stiffer contacts add energy in small parts, without end.
    #[test]
    fn energy_that_stiffer_contacts_add_is_spurious_beyond_a_hundredth() {
        let scene = heavy_cantilever(4);
        let system = System::new(&scene).unwrap();
        let ends_after = |stiffening: f64| {
            let mut validity = Validity::new(&scene);
            let unknowns = system.assembly.unknowns.clone();
            (1..=1000).find(|&step| {
                let report = StepReport {
                    time: 1e-3 * f64::from(step),
                    step: 1e-3,
                    stiffening,
                    ..StepReport::default()
                };
                let energies = || Energies {
                    kinetic: 1.0 + stiffening * f64::from(step),
                    ..Energies::default()
                };
                let ended = validity.after_step(&system, &report, &unknowns, energies);
                ended.is_some()
            })
        };
        assert_eq!(ends_after(0.009), Some(129));
        assert_eq!(ends_after(9e-6), None);
    }

    #[test]
    fn automatic_steps_are_not_advised_where_they_are_in_use() {
        let automatic = StepSize::Auto {
            tolerance: 1e-2,
            maximum: 1e-3,
        };
        let scene = heavy_cantilever(4);
        for (step, offers) in [(StepSize::Fixed(1e-3), true), (automatic, false)] {
            let validity = Validity::new(&scene).with_steps(&step);
            assert_eq!(validity.gaining().contains("auto"), offers);
        }
    }
}
