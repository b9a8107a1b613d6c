//! A helical rod that is manipulated in time, with the parameters of the thesis, section 6.3.4.

use super::cases::{Case, Run, prepared_table, value};
use rodlab_engine::mechanics::kirchhoff::Helix;
use rodlab_files::results::{ResultsError, read_nodes, read_series};
use rodlab_lab::experiment::helix::manipulation::{
    EndPath, Manipulation, Observation, helix_error,
};
use rodlab_lab::experiment::helix::stability::DiscreteRod;
use rodlab_lab::run::PreparedRun;
use toml::{Table, toml};

/// Direction of the search.
pub(super) const DIRECTION: Helix = Helix {
    curvature: 1.0,
    torsion: 1.0,
    twisting_moment: 1.0,
};
/// Length of the rod, m.
const LENGTH: f64 = 1.0;
/// Radius of the rod, m.
const RADIUS: f64 = 0.781e-3;
/// Density of the rod, kg/m³.
const DENSITY: f64 = 1180.0;
/// Largest distance ‖(κ, τ, ω)‖ of the rod; in theory it is unstable from 10.75.
const FARTHEST: f64 = 13.0;
/// Number of edges of the rod.
const EDGES: usize = 100;
/// Number of edges of the rod in a quick version.
const QUICK_EDGES: usize = 40;
/// Largest time step, relative to the time in which the end moves by the length of the rod.
const STEP: f64 = 1e-4;
/// Largest time step, s; the period of the first vibration of the straight rod is 0.7 s.
const LONGEST_STEP: f64 = 0.02;
/// Number of output times of a run; all are ends of whole steps.
const OUTPUTS: f64 = 600.0;
/// Processor time of a step for each edge, s(measured; correct within a factor of two).
const SECONDS_PER_STEP_AND_EDGE: f64 = 8e-7;
/// Fraction of the time during which gravity grows to its full strength.
const GRAVITY_GROWS: f64 = 0.1;

/// A manipulated rod.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ManipulatedHelix {
    /// Poisson's ratio ν.
    pub poissons_ratio: f64,
    /// Young's modulus E, Pa.
    pub youngs_modulus: f64,
    /// Gravito-bending length relative to the length, L_gb/L; infinite without gravity.
    pub gravito_bending_length: f64,
    /// Speed v of the end, m/s.
    pub speed: f64,
    /// Amplitude d of the jitter relative to the length.
    pub jitter: f64,
    /// Largest distance ‖(κ, τ, ω)‖ of the rod.
    pub farthest: f64,
    /// Number of edges of the rod.
    pub edges: usize,
}

/// The rod of the thesis, undisturbed, without gravity: with that of the earth, its L_gb would be
/// 0.19 L.
pub(super) const UNDISTURBED: ManipulatedHelix = ManipulatedHelix {
    poissons_ratio: 0.33,
    youngs_modulus: 1.12e9,
    gravito_bending_length: f64::INFINITY,
    speed: 0.0025,
    jitter: 0.0,
    farthest: FARTHEST,
    edges: EDGES,
};

impl ManipulatedHelix {
    /// The undisturbed rod, then each parameter varied separately.
    pub fn of_figure_6_5(quick: bool) -> Vec<Self> {
        let usual = UNDISTURBED;
        let mut runs = vec![usual];
        runs.extend([0.0, 0.2, 0.5].map(|poissons_ratio| Self {
            poissons_ratio,
            ..usual
        }));
        runs.extend([0.112e9, 11.2e9, 112e9].map(|youngs_modulus| Self {
            youngs_modulus,
            ..usual
        }));
        runs.extend(
            [0.2, 0.4, 0.6, 0.8, 1.2].map(|gravito_bending_length| Self {
                gravito_bending_length,
                ..usual
            }),
        );
        runs.extend([0.01, 0.05, 0.1, 0.2].map(|speed| Self { speed, ..usual }));
        runs.extend([0.005, 0.01, 0.02, 0.05].map(|jitter| Self { jitter, ..usual }));
        if quick {
            runs.iter_mut().for_each(|run| run.edges = QUICK_EDGES);
        }
        runs
    }

    fn rod(&self) -> DiscreteRod {
        DiscreteRod {
            edges: self.edges,
            stiffness_ratio: 1.0 / (1.0 + self.poissons_ratio),
            bending_stiffness: 1.0,
        }
    }

    fn path(&self) -> EndPath {
        EndPath::new(&Manipulation {
            rod: self.rod(),
            direction: DIRECTION,
            farthest: self.farthest,
            speed: self.speed / LENGTH,
            jitter: self.jitter,
            seed: 65,
        })
    }

    fn step(&self) -> f64 {
        let interval = self.end() / OUTPUTS;
        let largest = (STEP * LENGTH / self.speed).min(LONGEST_STEP);
        interval / (interval / largest).ceil()
    }

    /// Acceleration of free fall that gives the gravito-bending length (E h²/(8ρg))^(1/3), m/s².
    fn gravity(&self) -> f64 {
        let length = self.gravito_bending_length * LENGTH;
        self.youngs_modulus * RADIUS.powi(2) / (8.0 * DENSITY * length.powi(3))
    }

    /// The scenario of the run.
    fn scenario(&self) -> Table {
        let path = self.path();
        let end = path.duration();
        let poses = path.displacements.iter().zip(&path.orientations);
        let poses = poses.map(|((time, displacement), (_, orientation))| {
            let [x, y, z] = (LENGTH * displacement).into();
            let [qx, qy, qz, qw]: [f64; 4] = orientation.coords.into();
            (time, [LENGTH + x, y, z], [qw, qx, qy, qz])
        });
        let poses: Vec<_> = poses.collect();
        toml! {
            experiment = "scene"
            title = (self.id())
            [material]
            youngs_modulus = (self.youngs_modulus)
            poissons_ratio = (self.poissons_ratio)
            density = DENSITY
            [[rods]]
            name = "helix"
            radius = RADIUS
            edges = (self.edges)
            shape = { kind = "straight", start = [0, 0, 0], end = [LENGTH, 0, 0] }
            [time]
            scheme = "implicit-euler"
            step = (self.step())
            end = end
            [output]
            interval = (end / OUTPUTS)
            [[loads]]
            kind = "gravity"
            acceleration = [0, 0, (-self.gravity())]
            schedule = [[0, 0], [(GRAVITY_GROWS * end), 1]]
            [[clamps]]
            rod = "helix"
            at = "start"
            [[clamps]]
            rod = "helix"
            at = "end"
            poses = (value(poses))
        }
    }
}

impl Run for ManipulatedHelix {
    /// Name of the run, such as `helix_nu0.33_E1.12e9_Lgb0.6_v0.01_d0.02`.
    fn id(&self) -> String {
        let Self {
            poissons_ratio,
            youngs_modulus,
            gravito_bending_length,
            speed,
            jitter,
            ..
        } = self;
        format!(
            "helix_nu{poissons_ratio}_E{youngs_modulus:e}_Lgb{gravito_bending_length}_v{speed}_d{jitter}"
        )
    }

    fn prepare(&self) -> PreparedRun {
        prepared_table(&self.id(), self.scenario(), &[])
    }

    fn end(&self) -> f64 {
        self.path().duration()
    }

    fn extent(&self) -> String {
        format!("rods of {} edges were manipulated", self.edges)
    }

    fn cost(&self) -> f64 {
        let steps = self.end() / self.step();
        SECONDS_PER_STEP_AND_EDGE * self.edges as f64 * steps
    }

    #[cfg(test)]
    fn shortened(&self) -> Self {
        Self {
            farthest: 0.05,
            ..*self
        }
    }
}

/// Observations of a run at its output times.
pub(super) fn observations(
    case: &Case<ManipulatedHelix>,
) -> Result<Vec<Observation>, ResultsError> {
    let run = &case.run;
    let (path, rod) = (run.path(), run.rod());
    let unit = DIRECTION.scaled(1.0 / DIRECTION.distance());
    let mass = DENSITY * std::f64::consts::PI * RADIUS.powi(2) * LENGTH;
    let nodes = read_nodes(&case.directory, run.edges + 1)?;
    let series = read_series(&case.directory)?;
    let seen = nodes.iter().zip(&series).map(|(nodes, row)| {
        let distance = path.distance(nodes.time);
        let helix = unit.scaled(distance);
        let positions: Vec<_> = nodes.positions.iter().map(|node| node / LENGTH).collect();
        Observation {
            distance,
            error: helix_error(&positions, &helix, rod.enlargement(&helix)),
            kinetic_energy: row.kinetic_energy_j / (0.5 * mass * run.speed.powi(2)),
        }
    });
    Ok(seen.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gravito_bending_length_is_that_of_the_thesis() {
        let rod = ManipulatedHelix {
            gravito_bending_length: 0.1947,
            ..UNDISTURBED
        };
        assert!((rod.gravity() / 9.81 - 1.0).abs() < 1e-2);
        assert_eq!(UNDISTURBED.gravity(), 0.0);
    }

    #[test]
    fn each_run_differs_from_the_undisturbed_one_in_one_parameter() {
        let runs = ManipulatedHelix::of_figure_6_5(false);
        assert_eq!(runs[0], UNDISTURBED);
        for run in &runs[1..] {
            let differences = [
                run.poissons_ratio != UNDISTURBED.poissons_ratio,
                run.youngs_modulus != UNDISTURBED.youngs_modulus,
                run.gravito_bending_length != UNDISTURBED.gravito_bending_length,
                run.speed != UNDISTURBED.speed,
                run.jitter != UNDISTURBED.jitter,
            ];
            assert_eq!(differences.iter().filter(|differs| **differs).count(), 1);
        }
    }
}
