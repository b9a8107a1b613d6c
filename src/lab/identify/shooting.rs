//! Multiple shooting: a motion is divided into windows, each of which begins from an estimated
//! state.
//!
//! After an instability, the motion is a rough function of the keys: a rod that snaps a moment too
//! late is somewhere else from then on. Within a short window this function is smooth. Each window
//! begins from the state of a reference motion of the same scenario, with the same keys, which
//! follows the measured markers; the residuals are those of the windows.
//!
//! A few markers do not determine a state. The reference is therefore a Luenberger observer
//! (Luenberger 1971): a motion of the whole rod with all loads and the additional force
//!
//! ```text
//! f = M S (ω² e + 2ω ė),    e = y − C x,    ω = 1/(4 Δt)
//! ```
//!
//! with the mass M, the markers C x of the positions x, their measured places y with their rates,
//! and the time Δt between measurements. S interpolates the gaps e between the markers with the
//! least Σ |second difference|², and lets them fall to zero at held nodes. With the true keys, e
//! decays as (1 + ωt) exp(−ωt); bending, twist and contact between the markers follow from
//! mechanics. With wrong keys, the reference is off by about the error of the acceleration over
//! ω², which a window longer than 1/ω reveals.
//!
//! A window that begins at a wrong state biases the keys; the bias is smaller for longer windows.
//! The windows therefore become four times as long in each round, until one window is the whole
//! motion without a reference. The last fit and its error bars are then those of a plain fit.

use super::data::DataFile;
use super::observe::{Observation, Prediction, Unpredicted};
use super::reading::Reading;
use crate::run::{LiveRun, Mode, PreparedRun};
use nalgebra::{DMatrix, DVector, Matrix3};
use rodlab_engine::mechanics::Vector3;
use std::collections::BTreeMap;

/// Rate ω of the reference times the time between measurements. With twice this rate the reference
/// follows the noise; with half of it, the reference lags.
const RATE: f64 = 0.25;
/// Number of measured times from which the place of a marker and its rate are estimated.
const SAMPLES: usize = 5;
/// Stiffness that holds nodes without markers and clamps, and stiffness that holds clamped nodes,
/// both over the bending stiffness between nodes.
const FREE: f64 = 1e-9;
const HELD: f64 = 1e3;
/// Fraction of the gaps that remains at markers if several are at one place.
const LEFT: f64 = 1e-6;

/// A coordinate of a marker over time.
struct Track {
    weights: Vec<(usize, f64)>,
    direction: Vector3,
    /// Times, s, and places, m.
    samples: Vec<[f64; 2]>,
}

/// Markers that a reference follows.
pub(super) struct Followed {
    tracks: Vec<Track>,
}

impl Followed {
    /// The markers of an experiment; `None` if it does not move, or if no marker was measured
    /// often enough.
    pub fn new(run: &PreparedRun, observation: &Observation, files: &[DataFile]) -> Option<Self> {
        if !matches!(run.mode, Mode::Dynamic { .. }) {
            return None;
        }
        let mut tracks: BTreeMap<(usize, &str), Track> = BTreeMap::new();
        for (reading, (file, index)) in observation.readings() {
            let datum = &files[file].data[index];
            let (Reading::Along { weights, direction }, Some(time)) = (reading, datum.time) else {
                continue;
            };
            let track = tracks.entry((file, &datum.series));
            let track = track.or_insert_with(|| Track {
                weights: weights.clone(),
                direction: *direction,
                samples: Vec::new(),
            });
            if track.weights == *weights && track.direction == *direction {
                track.samples.push([time, datum.value]);
            }
        }
        let mut tracks: Vec<Track> = tracks.into_values().collect();
        for track in &mut tracks {
            track
                .samples
                .sort_by(|one, other| one[0].total_cmp(&other[0]));
        }
        tracks.retain(|track| track.samples.len() >= SAMPLES);
        (!tracks.is_empty()).then_some(Self { tracks })
    }

    /// Maximum number of windows into which the motion can be divided, so that each has enough
    /// measured times to estimate the state at its start.
    pub fn most_windows(&self) -> usize {
        let counts = self.tracks.iter().map(|track| track.samples.len());
        counts.max().unwrap_or(0) / SAMPLES
    }

    /// Mean time between measurements, s.
    fn interval(&self) -> f64 {
        let of = |track: &Track| {
            let samples = &track.samples;
            (samples[samples.len() - 1][0] - samples[0][0]) / (samples.len() - 1) as f64
        };
        self.tracks.iter().map(of).fold(f64::INFINITY, f64::min)
    }

    /// Predicts the numbers of an experiment in windows.
    pub fn predict(
        &self,
        run: &PreparedRun,
        observation: &Observation,
        windows: usize,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Prediction, Unpredicted> {
        let moments = observation.moments();
        let end = moments.last().map_or(0.0, |(time, _)| *time);
        let length = end / windows as f64;
        let mut live = LiveRun::new(run)?;
        let pull = Pull::new(self, run, &live, RATE / self.interval());
        let mut values = vec![f64::NAN; observation.readings().count()];
        let mut moments = moments.into_iter().peekable();
        for window in 1..=windows {
            let until = end * window as f64 / windows as f64;
            let start = live.save();
            while let Some((time, together)) =
                moments.next_if(|(time, _)| *time <= until || window == windows)
            {
                while live.simulation.time() < time {
                    live.advance(time, goes_on)?.ok_or(Unpredicted::Stopped)?;
                }
                observation.read(&mut live, &together, &mut values)?;
            }
            if window == windows {
                break;
            }
            live.restore(start)?;
            while live.simulation.time() < until {
                pull.act(&mut live, length);
                live.advance(until, goes_on)?.ok_or(Unpredicted::Stopped)?;
            }
            pull.let_go(&mut live);
        }
        Ok(Prediction {
            values,
            remarks: live.simulation.remarks(),
        })
    }
}

impl Track {
    /// The measured place, m, and its rate, m/s: both are taken from the parabola that fits the
    /// nearest times best. `None` before and after all times, and if the nearest times are further
    /// apart than `length`, s.
    fn at(&self, time: f64, length: f64) -> Option<[f64; 2]> {
        let samples = &self.samples;
        let after = samples.partition_point(|sample| sample[0] < time);
        let first = after
            .saturating_sub(SAMPLES / 2)
            .min(samples.len() - SAMPLES);
        let near = &samples[first..first + SAMPLES];
        let span = near[SAMPLES - 1][0] - near[0][0];
        let is_inside = (samples[0][0]..=samples[samples.len() - 1][0]).contains(&time);
        if !is_inside || span <= 0.0 || span > length {
            return None;
        }
        let (mut matrix, mut right) = (Matrix3::zeros(), Vector3::zeros());
        for [at, value] in near {
            let x = (at - time) / span;
            let row = Vector3::new(1.0, x, x * x);
            matrix += row * row.transpose();
            right += row * *value;
        }
        let [value, rate, _] = matrix.cholesky()?.solve(&right).into();
        Some([value, rate / span])
    }

    /// Coordinate of the marker for the positions of the nodes, m, or its rate for their velocities,
    /// m/s.
    fn of(&self, nodes: &[Vector3]) -> f64 {
        let parts = self.weights.iter();
        parts
            .map(|(node, weight)| weight * nodes[*node].dot(&self.direction))
            .sum()
    }
}

/// The forces on the reference.
struct Pull<'a> {
    tracks: &'a [Track],
    /// Masses of the nodes, kg.
    masses: Vec<f64>,
    /// Displacement of all nodes by a unit force at each marker, and of each marker by a unit
    /// force at every other marker.
    fields: Vec<DVector<f64>>,
    compliance: DMatrix<f64>,
    /// ω, 1/s.
    rate: f64,
}

impl<'a> Pull<'a> {
    fn new(followed: &'a Followed, run: &PreparedRun, live: &LiveRun, rate: f64) -> Self {
        let tracks = &followed.tracks;
        let count = live.simulation.positions().len();
        let mut is_held = vec![true; count];
        for unknown in live.simulation.free_unknowns() {
            if let Some(held) = is_held.get_mut(unknown / 4) {
                *held &= unknown % 4 == 3;
            }
        }
        let stiffness = |held: bool| if held { HELD } else { FREE };
        let mut matrix =
            DMatrix::from_diagonal(&DVector::from_fn(count, |node, _| stiffness(is_held[node])));
        let mut masses = Vec::with_capacity(count);
        for rod in &run.scene.rods {
            let (first, nodes) = (masses.len(), rod.centreline.len());
            let after = |node: usize| first + (node + 1) % nodes;
            for node in 0..nodes - if rod.closed { 0 } else { 2 } {
                let three = [first + node, after(node), after(node + 1)];
                for (one, part) in three.into_iter().zip([1.0, -2.0, 1.0]) {
                    for (other, others) in three.into_iter().zip([1.0, -2.0, 1.0]) {
                        matrix[(one, other)] += part * others;
                    }
                }
            }
            let edges = nodes - usize::from(!rod.closed);
            let mass = rod.mass_per_length
                * (rod
                    .centreline
                    .windows(2)
                    .map(|pair| (pair[1] - pair[0]).norm()))
                .sum::<f64>()
                / (nodes - 1) as f64;
            for node in 0..nodes {
                let is_end = !rod.closed && (node == 0 || node == edges);
                masses.push(if is_end { 0.5 * mass } else { mass });
            }
        }
        let factor = matrix.cholesky();
        let of_track = |track: &Track| {
            let mut force = DVector::zeros(count);
            for (node, weight) in &track.weights {
                force[*node] += weight;
            }
            if let Some(factor) = &factor {
                factor.solve_mut(&mut force);
            }
            force
        };
        let fields: Vec<DVector<f64>> = tracks.iter().map(of_track).collect();
        let compliance = DMatrix::from_fn(tracks.len(), tracks.len(), |one, other| {
            let parts = tracks[one].weights.iter();
            let moved: f64 = parts
                .map(|(node, weight)| weight * fields[other][*node])
                .sum();
            let left = if one == other { 1.0 + LEFT } else { 1.0 };
            left * moved * tracks[one].direction.dot(&tracks[other].direction)
        });
        Self {
            tracks,
            masses,
            fields,
            compliance,
            rate,
        }
    }

    /// Sets the forces for the next step.
    fn act(&self, live: &mut LiveRun, length: f64) {
        let simulation = &mut live.simulation;
        let mut which = Vec::new();
        let mut gaps = Vec::new();
        for (number, track) in self.tracks.iter().enumerate() {
            if let Some([place, rate]) = track.at(simulation.time(), length) {
                let gap = place - track.of(simulation.positions());
                let closing = rate - track.of(simulation.velocities());
                gaps.push(self.rate * (self.rate * gap + 2.0 * closing));
                which.push(number);
            }
        }
        let own = DMatrix::from_fn(which.len(), which.len(), |one, other| {
            self.compliance[(which[one], which[other])]
        });
        let mut forces = vec![Vector3::zeros(); self.masses.len()];
        if let Some(factor) = own.cholesky() {
            let shares = factor.solve(&DVector::from_vec(gaps));
            for (number, share) in which.iter().zip(shares.iter()) {
                let direction = self.tracks[*number].direction;
                for (node, force) in forces.iter_mut().enumerate() {
                    *force += direction * (share * self.masses[node] * self.fields[*number][node]);
                }
            }
        }
        let moments = vec![0.0; forces.len()];
        simulation.set_external_forces(&forces, &moments);
    }

    fn let_go(&self, live: &mut LiveRun) {
        let count = self.masses.len();
        (live.simulation).set_external_forces(&vec![Vector3::zeros(); count], &vec![0.0; count]);
    }
}
