//! A knot that is pulled until it inverts, with the parameters of the thesis, chapter 3.

use super::cases::{Case, Run, prepared};
use rodlab_files::results::ResultsError;
use rodlab_lab::experiment::{KnotOutcome, KnotRow, read_knot_series};
use rodlab_lab::run::PreparedRun;

/// The inversion of figure 3.4 in the thesis.
const BASE: &str = include_str!("../../scenarios/inversion_n3.toml");

/// A knot that is pulled until it inverts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Inversion {
    /// Unknotting number n.
    pub unknotting_number: usize,
    /// Radius of the rod h, m.
    pub radius: f64,
    /// Friction coefficient μ.
    pub friction: f64,
    /// Number of nodes of the rod.
    pub nodes: usize,
    /// l̄_k = (L − l_c)/h at the start.
    pub start: f64,
    /// l̄_k at which the run ends without an inversion.
    pub last: f64,
    /// Speed of each end, m/s.
    pub pull_speed: f64,
    /// Contact modelas named in scenario files.
    pub model: &'static str,
    /// Gap at which contact forces begin, in radii of the rod.
    pub tolerance: f64,
    /// Decrease of l̄_k between two outputs.
    pub resolution: f64,
    /// Time for which the knot settles, s.
    pub settling: f64,
}

/// Radii of figure 3.5, m.
const RADII: [f64; 5] = [1.6e-3, 2.0e-3, 2.4e-3, 2.8e-3, 3.2e-3];
/// Unknotting numbers of figure 3.6, and the initial tightness of each.
const NUMBERS: [(usize, f64); 5] = [(1, 125.0), (2, 125.0), (3, 210.0), (4, 320.0), (5, 425.0)];
/// Friction coefficients of figure 3.7.
const FRICTIONS: [f64; 4] = [0.1, 0.3, 0.5, 0.7];
/// Initial tightness of the knots of figure 3.7. With strong friction the effect of the start
/// lasts long, so that these knots start loose. The radius of the thesis is 3.4 mm, for which such
/// a loose knot would be longer than the rod.
const START_OF_FRICTION: f64 = 312.5;
/// Length of the rods, m.
const LENGTH: f64 = 1.0;
/// Length of an edge, in radii, for the comparison of radii and numbers. The corners of the
/// polyline slip over each other and shake the knot. With edges of two radii, the inversion point
/// of n = 2 is uncertain by 4 %.
const EDGE: f64 = 1.04;
/// Time step of the scenario, s.
const STEP: f64 = 2.5e-3;
/// Fraction of the initial tightness at which a run without inversion ends.
const LAST: f64 = 0.3;
/// Fraction of the initial tightness at which a quick version ends, which has no inversion.
const QUICK_LAST: f64 = 0.95;

impl Inversion {
    /// The inversion of figure 3.4; the same with one changed choice at a time; and a short
    /// version with IMC and with IPC.
    pub fn of_figure_3_4(quick: bool) -> Vec<Self> {
        let base = Self {
            nodes: 301,
            resolution: 0.0625,
            ..Self::fine(3, 1.6e-3, 0.1, 225.0, quick)
        };
        let coarse = Self {
            resolution: 0.25,
            ..base
        };
        let looser = Self {
            start: 312.5,
            ..coarse
        };
        let finer = Self {
            nodes: 601,
            ..coarse
        };
        let slower = Self {
            pull_speed: 0.5 * base.pull_speed,
            ..coarse
        };
        let harder = Self {
            tolerance: 0.5 * base.tolerance,
            ..coarse
        };
        let short = |model| Self {
            model,
            start: 165.0,
            last: if quick { 164.0 } else { 150.0 },
            pull_speed: 4.0 * base.pull_speed,
            settling: 0.5,
            ..coarse
        };
        let mut runs = vec![base, looser, finer, slower, harder];
        runs.extend(["imc", "ipc"].map(short));
        runs
    }

    /// A run for each radius.
    pub fn of_figure_3_5(quick: bool) -> Vec<Self> {
        RADII
            .map(|radius| Self::fine(3, radius, 0.1, 210.0, quick))
            .to_vec()
    }

    /// A run for each unknotting number.
    pub fn of_figure_3_6(quick: bool) -> Vec<Self> {
        NUMBERS
            .map(|(number, start)| Self::fine(number, RADII[0], 0.1, start, quick))
            .to_vec()
    }

    /// A run for each friction coefficient.
    pub fn of_figure_3_7(quick: bool) -> Vec<Self> {
        FRICTIONS
            .map(|friction| Self::fine(3, RADII[0], friction, START_OF_FRICTION, quick))
            .to_vec()
    }

    fn fine(number: usize, radius: f64, friction: f64, start: f64, quick: bool) -> Self {
        Self {
            unknotting_number: number,
            radius,
            friction,
            nodes: (LENGTH / (EDGE * radius)).round() as usize + 1,
            start,
            last: if quick { QUICK_LAST } else { LAST } * start,
            pull_speed: 1e-3,
            model: "imc",
            tolerance: 0.025,
            resolution: 0.25,
            settling: 2.0,
        }
    }

    /// Outcome of the knot.
    pub fn outcome(case: &Case<Self>) -> KnotOutcome {
        KnotOutcome::of(&case.record.outcome).unwrap_or_default()
    }

    /// Measurements of the knot while its ends moved.
    pub fn pulled_rows(case: &Case<Self>) -> Result<Vec<(f64, KnotRow)>, ResultsError> {
        let rows = read_knot_series(&case.directory)?.into_iter();
        Ok(rows
            .map(|(series, knot)| (series.time_s, knot))
            .filter(|(time, _)| *time >= case.run.settling)
            .collect())
    }
}

impl Run for Inversion {
    /// Name of the run, such as `inversion_n3_mu0.1_h1.6mm_imc_301nodes_from225_1mms_gap0.025h`.
    fn id(&self) -> String {
        let millimetres = |metres: f64| (1e7 * metres).round() / 1e4;
        format!(
            "inversion_n{}_mu{}_h{}mm_{}_{}nodes_from{}_{}mms_gap{}h",
            self.unknotting_number,
            self.friction,
            millimetres(self.radius),
            self.model,
            self.nodes,
            self.start,
            millimetres(self.pull_speed),
            self.tolerance
        )
    }

    fn prepare(&self) -> PreparedRun {
        let interval = 0.5 * self.resolution * self.radius / self.pull_speed;
        let mut overrides = vec![
            format!("title=\"{}\"", self.id()),
            format!("knot.unknotting_number={}", self.unknotting_number),
            format!("knot.end_to_end={:?}", LENGTH - self.start * self.radius),
            format!("knot.pull_speed={:?}", self.pull_speed),
            format!("knot.settling_time={:?}", self.settling),
            format!("rod.radius={:?}", self.radius),
            format!("rod.nodes={}", self.nodes),
            format!("contact.model=\"{}\"", self.model),
            format!("contact.friction={:?}", self.friction),
            format!(
                "contact.distance_tolerance={:?}",
                self.tolerance * self.radius
            ),
            format!("contact.slip_tolerance={:?}", self.pull_speed),
            format!("time.end={:?}", self.end()),
            format!("output.interval={interval:?}"),
        ];
        if self.model == "imc" {
            // The stiffness of the thesis, for any radius.
            overrides.push("contact.stiffness_factor=1e5".to_owned());
        }
        prepared(&self.id(), BASE, &overrides)
    }

    fn end(&self) -> f64 {
        self.settling + 0.5 * (self.start - self.last) * self.radius / self.pull_speed
    }

    fn cost(&self) -> f64 {
        let steps = self.end() / STEP;
        2e-6 * self.nodes as f64 * steps
    }

    #[cfg(test)]
    fn shortened(&self) -> Self {
        let last = self.start - 0.005 * self.pull_speed / self.radius;
        Self {
            settling: 0.0,
            last,
            resolution: 0.5 * (self.start - last),
            ..*self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_have_the_requested_numbers() {
        let run = Inversion::of_figure_3_5(false)[4];
        let prepared = run.prepare();
        let observer = prepared
            .observer::<rodlab_lab::experiment::KnotMonitor>()
            .unwrap()
            .observer;
        assert!(observer.ends_after_inversion);
        assert_eq!((observer.radius, observer.determinant), (3.2e-3, 7));
        let contact = prepared.scene.contact.unwrap();
        assert!((contact.distance_tolerance - 8e-5).abs() < 1e-18);
        let nodes = &prepared.scene.rods[0].centreline;
        let distance = (nodes[nodes.len() - 1] - nodes[0]).norm();
        assert!(((LENGTH - distance) / 3.2e-3 - 210.0).abs() < 1e-9);
        assert_eq!(nodes.len(), 301);
    }
}
