//! A rod laid along a pattern, with the rods and the patterns of the thesis, section 5.5.

use super::cases::{Case, Run, prepared_table, table_of, value};
use rodlab_lab::experiment::DeploymentOutcome;
use rodlab_lab::run::PreparedRun;
use rodlab_planning::plan::pattern::{chosen_stroke, read_svg};
use toml::{Table, toml};

/// A pattern.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LaidPattern {
    /// Name, for display and files.
    pub name: &'static str,
    source: Source,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Source {
    /// The keys of a formula, one per line.
    Formula(&'static str),
    /// A drawing as SVG.
    Drawing(&'static str),
}

/// A rod of thesis Tab. 5.1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LaidRod {
    /// Number in the table.
    pub number: usize,
    /// Name of the rod.
    pub name: &'static str,
    /// The substrates with a friction of 0.2, 0.4 and 0.8.
    pub substrates: [Substrate; 3],
    scenario: &'static str,
}

/// A substrate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Substrate {
    Fabric,
    Steel,
    Foam,
}

/// The seven patterns of Tab. 5.2. Line, circle and sine have the sizes of those in the released
/// data of the thesis; letters were redrawn.
pub(super) const PATTERNS: [LaidPattern; 7] = [
    formula("line", "kind = 'line'\nlength = 0.5"),
    formula("circle", "kind = 'circle'\nradius = 0.09"),
    formula(
        "sine",
        "kind = 'sine'\namplitude = 0.085\nwavelength = 0.51\nwaves = 1",
    ),
    drawing("U", include_str!("../../scenarios/patterns/U.svg")),
    drawing("C", include_str!("../../scenarios/patterns/C.svg")),
    drawing("L", include_str!("../../scenarios/patterns/L.svg")),
    drawing("A", include_str!("../../scenarios/patterns/A.svg")),
];

const fn formula(name: &'static str, keys: &'static str) -> LaidPattern {
    LaidPattern {
        name,
        source: Source::Formula(keys),
    }
}

const fn drawing(name: &'static str, svg: &'static str) -> LaidPattern {
    LaidPattern {
        name,
        source: Source::Drawing(svg),
    }
}

/// The three rods of Tab. 5.2.
pub(super) const RODS: [LaidRod; 3] = {
    use Substrate::{Fabric, Foam, Steel};
    [
        LaidRod {
            number: 1,
            name: "pink VPS",
            substrates: [Fabric, Steel, Foam],
            scenario: include_str!("../../scenarios/rods/pink_vps.toml"),
        },
        LaidRod {
            number: 2,
            name: "green VPS",
            substrates: [Fabric, Steel, Foam],
            scenario: include_str!("../../scenarios/rods/green_vps.toml"),
        },
        LaidRod {
            number: 3,
            name: "rope",
            substrates: [Steel, Fabric, Foam],
            scenario: include_str!("../../scenarios/rods/rope.toml"),
        },
    ]
};

/// Coefficients of friction that the thesis calls low, medium and high.
pub(super) const FRICTIONS: [f64; 3] = [0.2, 0.4, 0.8];

/// Duration of laying a pattern, s. The mean distance of the green rod, which slides, from the
/// pattern A at the medium friction is 0.652 cm; with a duration of 80 s it is 0.640 cm.
const END: f64 = 40.0;
/// Time step, s. The mean distance of the same rod from its pattern is 0.647 cm with this step,
/// 0.652 cm with 5 ms and 0.672 cm with 2 ms. The distance is 0.652 cm with twice the 111 edges,
/// 0.654 cm with δ = 20 µm instead of 50 µm, and 0.651 cm with a slip tolerance of 3 µm/s instead
/// of 10 µm/s.
const STEP: f64 = 1e-2;
/// A few steps.
#[cfg(test)]
const FEW_STEPS: f64 = 0.05;

/// A rod laid along a pattern.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Laying {
    /// Index into [`RODS`].
    pub rod: usize,
    /// Index into [`FRICTIONS`].
    pub friction: usize,
    /// Whether the rod is laid with the optimal grasps instead of the intuitive scheme.
    pub is_optimal: bool,
    /// Whether the optimal grasps are computed by a network.
    pub is_neural: bool,
    /// Index into [`PATTERNS`].
    pub pattern: usize,
    /// Time, s.
    pub end: f64,
    /// Disturbances of the laying.
    pub disturbance: Disturbance,
}

/// Disturbances of the laying of a rod.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Disturbance {
    /// Root mean square of the gripper's jitter in each direction, m.
    pub jitter: f64,
    /// Seed of the disturbance.
    pub seed: u64,
    /// Relative error of the gravito-bending length assumed in the plan.
    pub length_error: f64,
    /// Root mean square of the noise of the camera, m, if the path is corrected during laying.
    pub correction: Option<f64>,
}

/// Jitters, m.
const JITTERS: [f64; 4] = [0.5e-3, 1e-3, 2e-3, 5e-3];
/// Seeds of the jitter.
const SEEDS: [u64; 3] = [1, 2, 3];
/// Relative errors of the gravito-bending length.
const LENGTH_ERRORS: [f64; 4] = [-0.1, -0.05, 0.05, 0.1];
/// Jitter of runs with online correction, m.
const CORRECTED_JITTER: f64 = 2e-3;
/// Noise of the camera in these runs, m.
const CAMERA_NOISE: f64 = 0.5e-3;
/// The patterns that are laid with errors: circle, U and L.
const DISTURBED: [usize; 3] = [1, 3, 5];

/// Disturbances in sequence: none, jitters with all seeds, errors of the gravito-bending length.
fn disturbances(jitters: &[f64], length_errors: &[f64]) -> Vec<Disturbance> {
    let none = Disturbance::default();
    let mut disturbances = vec![none];
    for &jitter in jitters {
        disturbances.extend(SEEDS.map(|seed| Disturbance {
            jitter,
            seed,
            ..none
        }));
    }
    let wrong = length_errors.iter();
    disturbances.extend(wrong.map(|&length_error| Disturbance {
        length_error,
        ..none
    }));
    disturbances
}

/// The patterns that are laid with errors; a quick version has one.
fn patterns_of_errors(quick: bool) -> &'static [usize] {
    if quick { &DISTURBED[..1] } else { &DISTURBED }
}

impl LaidRod {
    /// File of the rod.
    pub fn file(&self) -> &'static str {
        self.scenario
    }
}

impl Laying {
    /// An undisturbed run of the optimal scheme with exact grasps.
    fn optimal(rod: usize, friction: usize, pattern: usize) -> Self {
        Self {
            rod,
            friction,
            is_optimal: true,
            is_neural: false,
            pattern,
            end: END,
            disturbance: Disturbance::default(),
        }
    }

    /// All of Tab. 5.2; a quick version has the green rod at the medium friction.
    pub fn of_table_5_2(quick: bool) -> Vec<Self> {
        let mut runs = Vec::new();
        for rod in 0..RODS.len() {
            for friction in 0..FRICTIONS.len() {
                for is_optimal in [false, true] {
                    runs.extend((0..PATTERNS.len()).map(|pattern| Self {
                        is_optimal,
                        ..Self::optimal(rod, friction, pattern)
                    }));
                }
            }
        }
        if quick {
            runs.retain(|run| run.rod == 1 && run.friction == 1);
        }
        runs
    }

    /// All rods on fabric; a quick version has the green one.
    pub fn of_figure_5_10(quick: bool) -> Vec<Self> {
        let mut runs = Self::of_table_5_2(false);
        runs.retain(|run| {
            RODS[run.rod].substrates[run.friction] == Substrate::Fabric && (run.rod == 1 || !quick)
        });
        runs
    }

    /// The green rod on fabric with the optimal scheme and all patterns; a quick version has two
    /// patterns.
    pub fn of_cell(quick: bool) -> Vec<Self> {
        let mut runs = Self::of_table_5_2(false);
        runs.retain(|run| {
            run.rod == 1
                && run.is_optimal
                && RODS[run.rod].substrates[run.friction] == Substrate::Fabric
                && (run.pattern < 2 || !quick)
        });
        runs
    }

    /// The green rod on all tables; a quick version has the medium friction.
    pub fn of_figure_5_11(quick: bool) -> Vec<Self> {
        let mut runs = Self::of_table_5_2(false);
        runs.retain(|run| run.rod == 1 && (run.friction == 1 || !quick));
        runs
    }

    /// All rods and patterns at the medium friction, with exact grasps and with the network; a
    /// quick version has the green rod.
    pub fn of_table_5_3(quick: bool) -> Vec<Self> {
        let mut runs = Self::of_table_5_2(false);
        runs.retain(|run| run.is_optimal && run.friction == 1 && (run.rod == 1 || !quick));
        let neural = runs.clone().into_iter().map(|run| Self {
            is_neural: true,
            ..run
        });
        runs.extend(neural);
        runs
    }

    /// The green rod at the medium friction with errors; a quick version has one pattern.
    pub fn of_errors(quick: bool) -> Vec<Self> {
        let disturbances = disturbances(&JITTERS, &LENGTH_ERRORS);
        let of = |&pattern: &usize| {
            disturbances.iter().map(move |&disturbance| Self {
                disturbance,
                ..Self::optimal(1, 1, pattern)
            })
        };
        patterns_of_errors(quick).iter().flat_map(of).collect()
    }

    /// The green rod at the medium friction with errors, without and with online correction; a
    /// quick version has one pattern.
    pub fn of_correction(quick: bool) -> Vec<Self> {
        let mut runs = Vec::new();
        for &pattern in patterns_of_errors(quick) {
            // Camera noise is added only for the first pattern.
            let noise = (pattern == DISTURBED[0]).then_some(Some(CAMERA_NOISE));
            for correction in [None, Some(0.0)].into_iter().chain(noise) {
                for disturbance in disturbances(&[CORRECTED_JITTER], &[-0.1, 0.1]) {
                    runs.push(Self {
                        disturbance: Disturbance {
                            correction,
                            ..disturbance
                        },
                        ..Self::optimal(1, 1, pattern)
                    });
                }
            }
        }
        runs
    }

    /// The runs of the correction without camera noise; a quick version has one pattern with one
    /// jitter.
    pub fn of_cell_correction(quick: bool) -> Vec<Self> {
        let mut runs = Self::of_correction(quick);
        runs.retain(|run| {
            let disturbance = &run.disturbance;
            disturbance.correction.is_none_or(|noise| noise == 0.0)
                && (disturbance.seed == 1 || !quick)
        });
        runs
    }

    /// Whether the path is corrected while the rod is laid.
    pub fn is_corrected(&self) -> bool {
        self.disturbance.correction.is_some()
    }

    /// Whether this run equals another one except for its correction; `is_seen` accepts the noise
    /// of the camera.
    pub fn corrects(&self, other: &Self, is_seen: fn(f64) -> bool) -> bool {
        let without = Disturbance {
            correction: None,
            ..self.disturbance
        };
        self.disturbance.correction.is_some_and(is_seen)
            && self.pattern == other.pattern
            && without == other.disturbance
    }

    /// Name of the scheme.
    pub fn scheme(&self) -> &'static str {
        if self.is_optimal {
            "optimal"
        } else {
            "intuitive"
        }
    }

    fn keys_of_the_pattern(&self) -> Table {
        if self.end < END {
            return toml! { kind = "line" length = 0.002 };
        }
        match PATTERNS[self.pattern].source {
            Source::Formula(keys) => table_of(keys),
            Source::Drawing(svg) => {
                let strokes = read_svg(svg).and_then(|strokes| chosen_stroke(strokes, None));
                let points = strokes.expect("the drawings of the repository are patterns");
                let points: Vec<_> = points.iter().map(|point| [point.x, point.y]).collect();
                toml! { points = (value(points)) }
            }
        }
    }
}

impl Case<Laying> {
    /// Outcome of the rod, also for unfinished runs.
    pub fn laid(&self) -> Option<DeploymentOutcome> {
        DeploymentOutcome::of(&self.record.outcome)
    }

    /// Outcome of a completely laid rod.
    pub fn laid_to_the_end(&self) -> Option<DeploymentOutcome> {
        let has_ended = self.record.outcome.simulated_time >= self.run.end * (1.0 - 1e-9);
        self.laid().filter(|_| has_ended)
    }

    /// Mean distance of a completely laid rod from its pattern, cm (thesis Eq. 5.11).
    pub fn mean_error_cm(&self) -> Option<f64> {
        let mean = self.laid_to_the_end()?.mean_error_m?;
        Some(1e2 * mean)
    }
}

impl Run for Laying {
    fn id(&self) -> String {
        let Disturbance {
            jitter,
            seed,
            length_error,
            correction,
        } = self.disturbance;
        let mut errors = String::new();
        if jitter > 0.0 {
            errors += &format!("-jitter_{jitter}_{seed}");
        }
        if length_error != 0.0 {
            errors += &format!("-length_{length_error}");
        }
        if let Some(noise) = correction {
            errors += &format!("-corrected_{noise}");
        }
        format!(
            "{}-{}-{}-{}{errors}",
            PATTERNS[self.pattern].name,
            RODS[self.rod].name.replace(' ', "_"),
            FRICTIONS[self.friction],
            if self.is_optimal && self.is_neural {
                "neural"
            } else {
                self.scheme()
            }
        )
    }

    fn prepare(&self) -> PreparedRun {
        let rod = table_of(RODS[self.rod].scenario)["deployment"]["rod"].clone();
        let Disturbance {
            jitter,
            seed,
            length_error,
            correction,
        } = self.disturbance;
        let mut scenario = toml! {
            experiment = "deployment"
            title = (self.id())
            [contact]
            friction = (FRICTIONS[self.friction])
            distance_tolerance = 50e-6
            slip_tolerance = 1e-5
            [time]
            step = STEP
            end = (self.end)
            [output]
            interval = (self.end / 20.0)
            [deployment]
            pattern = (self.keys_of_the_pattern())
            rod = rod
            scheme = (self.scheme())
            solver = (if self.is_neural { "neural" } else { "exact" })
            jitter = jitter
            seed = seed
            length_error = length_error
        };
        if let (Some(noise), Some(deployment)) = (correction, scenario["deployment"].as_table_mut())
        {
            deployment.insert("correction".into(), toml! { noise = noise }.into());
        }
        prepared_table(&self.id(), scenario, &[])
    }

    fn end(&self) -> f64 {
        self.end
    }

    fn cost(&self) -> f64 {
        0.08 * self.end
    }

    #[cfg(test)]
    fn shortened(&self) -> Self {
        Self {
            end: FEW_STEPS,
            ..*self
        }
    }

    fn extent(&self) -> String {
        if self.end < END {
            format!("{} s were simulated", self.end)
        } else {
            "the green rod was laid on one table".to_owned()
        }
    }
}
