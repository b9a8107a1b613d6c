//! A run of bundling flagella with the parameters of the thesis, section 2.4.2.

use super::cases::{Run, prepared};
use rodlab_lab::run::PreparedRun;

/// The common part of the flagella scenarios.
const BASE: &str = include_str!("../../scenarios/flagella_base.toml");

/// A run of bundling flagella.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bundling {
    /// Number of flagella M.
    pub flagella: usize,
    /// Contact model.
    pub model: ContactModel,
    /// Friction coefficient μ.
    pub friction: f64,
    /// Distance tolerance δ, m.
    pub distance_tolerance: f64,
    /// Time scheme.
    pub scheme: Scheme,
    /// Time step.
    pub step: Step,
    /// Relative enlargement of the helix radius; it shows the growth of a small difference.
    pub widening: f64,
    /// Simulated time, s.
    pub end: f64,
}

/// Radius of the helices of the thesis, m.
const HELIX_RADIUS: f64 = 0.01;

/// Time scheme of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scheme {
    /// The implicit Euler method, as in the thesis.
    ImplicitEuler,
    /// Backward differences of third order.
    BackwardDifferences,
}

impl Scheme {
    /// Name of the scheme in scenario files.
    pub fn key(self) -> &'static str {
        match self {
            Self::ImplicitEuler => "implicit-euler",
            Self::BackwardDifferences => "backward-differences",
        }
    }
}

/// Time step of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Step {
    /// Fixed step, s.
    Fixed(f64),
    /// Step chosen from the local error.
    Auto,
}

/// Time step of the thesis, 1 ms.
pub(super) const STEP: Step = Step::Fixed(1e-3);

impl Step {
    /// Name of the scheme in scenario files.
    pub fn key(self) -> String {
        match self {
            Self::Fixed(step) => format!("{step:?}"),
            Self::Auto => "\"auto\"".into(),
        }
    }

    /// The step as in tables: in s, or "auto".
    pub fn in_words(self) -> String {
        self.key().trim_matches('"').to_owned()
    }
}

/// Distance tolerance of the thesis, m.
pub(super) const DISTANCE_TOLERANCE: f64 = 1e-5;

/// Numbers of flagella of the thesis (section 2.4.2).
pub(super) const FLAGELLA: [usize; 4] = [2, 3, 5, 10];
/// Numbers of flagella whose cost is measured.
const FLAGELLA_OF_COST: [usize; 6] = [2, 5, 10, 20, 50, 100];
/// Simulated time of the thesis, and of a quick version, s.
const END: [f64; 2] = [250.0, 20.0];
/// Simulated time of the difference of two models, and of its quick version with 20 s of contact,
/// s.
const END_OF_DIFFERENCE: [f64; 2] = [250.0, 25.0];
/// Simulated time of the cost of steps, and of its quick version, s: 400 steps, of which the first
/// few dozen build the preconditioner.
const END_OF_COST: [f64; 2] = [0.4, 0.05];
/// Simulated time of the comparison of steps, and of its quick version, s.
const END_OF_STEPS: [f64; 2] = [20.0, 5.0];

/// Distance tolerance δ for the comparison of contact models, m: a fifth of that of the thesis,
/// since ē decreases with it. Smaller values are unnecessarily stiff.
pub(super) const DISTANCE_TOLERANCE_OF_DIFFERENCE: f64 = 2e-6;
/// Time steps that are compared; the first is the reference.
pub(super) const COMPARED_STEPS: [(Scheme, Step); 12] = [
    (Scheme::BackwardDifferences, Step::Fixed(2.5e-4)),
    (Scheme::BackwardDifferences, Step::Fixed(1e-3)),
    (Scheme::BackwardDifferences, Step::Fixed(2e-3)),
    (Scheme::BackwardDifferences, Step::Fixed(5e-3)),
    (Scheme::BackwardDifferences, Step::Fixed(1e-2)),
    (Scheme::BackwardDifferences, Step::Auto),
    (Scheme::ImplicitEuler, Step::Fixed(1e-3)),
    (Scheme::ImplicitEuler, Step::Fixed(2e-3)),
    (Scheme::ImplicitEuler, Step::Fixed(5e-3)),
    (Scheme::ImplicitEuler, Step::Fixed(1e-2)),
    (Scheme::ImplicitEuler, Step::Fixed(2e-2)),
    (Scheme::ImplicitEuler, Step::Auto),
];

/// Numbers of flagella with automatic steps.
const FLAGELLA_OF_AUTO_STEPS: [usize; 2] = [2, 10];

/// Pairs of step and widening of the helices; the first pair is the reference.
pub(super) const STEP_VARIANTS: [(Step, f64); 3] = [(STEP, 0.0), (Step::Auto, 0.0), (STEP, 1e-8)];

/// Contact models that the thesis compares.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ContactModel {
    /// Implicit contact model.
    Imc,
    /// Incremental potential contact.
    Ipc,
}

impl ContactModel {
    /// Abbreviation in the literature.
    pub fn name(self) -> &'static str {
        match self {
            Self::Imc => "IMC",
            Self::Ipc => "IPC",
        }
    }

    fn key(self) -> &'static str {
        match self {
            Self::Imc => "imc",
            Self::Ipc => "ipc",
        }
    }
}

impl Bundling {
    /// Flagella without friction, with the contact model of the thesis.
    fn free(flagella: usize, ends: [f64; 2], quick: bool) -> Self {
        Self {
            flagella,
            model: ContactModel::Imc,
            friction: 0.0,
            distance_tolerance: DISTANCE_TOLERANCE,
            scheme: Scheme::ImplicitEuler,
            step: STEP,
            widening: 0.0,
            end: ends[usize::from(quick)],
        }
    }

    /// Each run with both contact models: first all runs with IMC, then all with IPC.
    fn by_both_models(runs: &[Self]) -> Vec<Self> {
        let models = [ContactModel::Imc, ContactModel::Ipc];
        let run = |model| runs.iter().map(move |run| Self { model, ..*run });
        models.into_iter().flat_map(run).collect()
    }

    /// All numbers of flagella with both contact models.
    pub fn of_table_2_1(quick: bool) -> Vec<Self> {
        Self::by_both_models(&FLAGELLA.map(|flagella| Self::free(flagella, END, quick)))
    }

    /// Two flagella with increasing friction.
    pub fn of_table_2_2(quick: bool) -> Vec<Self> {
        let run = |tenths| Self {
            friction: f64::from(tenths) / 10.0,
            ..Self::free(2, END, quick)
        };
        (1..=10).map(run).collect()
    }

    /// Five flagella with both contact models, with a small distance tolerance.
    pub fn of_figure_2_5(quick: bool) -> Vec<Self> {
        Self::by_both_models(&[Self {
            distance_tolerance: DISTANCE_TOLERANCE_OF_DIFFERENCE,
            ..Self::free(5, END_OF_DIFFERENCE, quick)
        }])
    }

    /// Two flagella with three frictions.
    pub fn of_figure_2_6(quick: bool) -> Vec<Self> {
        let run = |friction| Self {
            friction,
            ..Self::free(2, END, quick)
        };
        [0.0, 0.3, 0.7].map(run).to_vec()
    }

    /// Increasing numbers of flagella for a short time.
    pub fn of_cost(quick: bool) -> Vec<Self> {
        let run = |flagella| Self::free(flagella, END_OF_COST, quick);
        FLAGELLA_OF_COST.map(run).to_vec()
    }

    /// Two flagella with time steps of increasing size.
    pub fn of_drag_steps(quick: bool) -> Vec<Self> {
        let run = |(scheme, step)| Self {
            scheme,
            step,
            ..Self::free(2, END_OF_STEPS, quick)
        };
        COMPARED_STEPS.map(run).to_vec()
    }

    /// Fixed and automatic steps over the whole time, and the growth of a small difference for
    /// comparison.
    pub fn of_auto_steps(quick: bool) -> Vec<Self> {
        let variants = |flagella| {
            STEP_VARIANTS.map(|(step, widening)| Self {
                scheme: Scheme::BackwardDifferences,
                step,
                widening,
                ..Self::free(flagella, END, quick)
            })
        };
        FLAGELLA_OF_AUTO_STEPS
            .into_iter()
            .flat_map(variants)
            .collect()
    }
}

impl Run for Bundling {
    /// Name of the run, such as `m2_imc_mu0.3_250s`.
    fn id(&self) -> String {
        let Self {
            flagella,
            model,
            friction,
            distance_tolerance,
            scheme,
            step,
            widening,
            end,
        } = self;
        let mut name = format!("m{flagella}_{}_mu{friction}_{end}s", model.key());
        if *distance_tolerance != DISTANCE_TOLERANCE {
            name += &format!("_delta{distance_tolerance:e}");
        }
        if *scheme != Scheme::ImplicitEuler {
            name = format!("{name}_{}", scheme.key());
        }
        if *widening != 0.0 {
            name += &format!("_wider{widening:e}");
        }
        match *step {
            STEP => name,
            Step::Fixed(step) => format!("{name}_step{step}"),
            Step::Auto => name + "_auto",
        }
    }

    fn prepare(&self) -> PreparedRun {
        let mut overrides = vec![
            format!("title=\"Bundling flagella, {}\"", self.id()),
            format!("flagella.count={}", self.flagella),
            format!("contact.model=\"{}\"", self.model.key()),
            format!("contact.friction={:?}", self.friction),
            format!("contact.distance_tolerance={:?}", self.distance_tolerance),
            format!("time.step={}", self.step.key()),
            format!("time.end={:?}", self.end),
        ];
        if self.scheme != Scheme::ImplicitEuler {
            overrides.push(format!("time.scheme=\"{}\"", self.scheme.key()));
        }
        if self.widening != 0.0 {
            let radius = HELIX_RADIUS * (1.0 + self.widening);
            overrides.push(format!("flagella.helix_radius={radius:?}"));
        }
        prepared(&self.id(), BASE, &overrides)
    }

    fn end(&self) -> f64 {
        self.end
    }

    /// Rough cost on one core, s. The cost of the fluid grows with the square of the number of
    /// flagella up to a thousand nodes; beyond, the fluid is computed with clusters.
    fn cost(&self) -> f64 {
        let flagella = self.flagella as f64;
        let rubbing = 1.0 + 3.0 * self.friction;
        let cost_of_step = 0.1e-3 * flagella + 0.04e-3 * flagella * flagella.min(40.0);
        let step = match self.step {
            Step::Fixed(step) => step,
            // Mean step, as measured with two flagella in contact.
            Step::Auto => 3e-3,
        };
        self.end / step * cost_of_step * rubbing
    }

    #[cfg(test)]
    fn shortened(&self) -> Self {
        Self { end: 2e-3, ..*self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rodlab_engine::mechanics::dynamics::{self, StepSize};
    use rodlab_lab::run::Mode;

    #[test]
    fn the_runs_of_table_2_1_come_in_pairs_of_models() {
        let runs = Bundling::of_table_2_1(false);
        let (penalty, barrier) = runs.split_at(FLAGELLA.len());
        for (imc, ipc) in penalty.iter().zip(barrier) {
            assert_eq!(
                (imc.model, ipc.model),
                (ContactModel::Imc, ContactModel::Ipc)
            );
            assert_eq!(imc.flagella, ipc.flagella);
        }
    }

    #[test]
    fn the_requested_number_of_flagella_is_built() {
        for run in Bundling::of_cost(true) {
            assert_eq!(run.prepare().scene.rods.len(), run.flagella);
        }
    }

    #[test]
    fn ids_describe_the_runs() {
        let bundling = Bundling {
            flagella: 3,
            model: ContactModel::Ipc,
            friction: 0.7,
            ..Bundling::free(2, [20.0; 2], false)
        };
        assert_eq!(bundling.id(), "m3_ipc_mu0.7_20s");
        let plain = bundling.prepare();
        assert_eq!(plain.name, bundling.id());
        assert_eq!(
            plain.mode,
            Mode::Dynamic {
                end: 20.0,
                settles: false
            }
        );
        assert_eq!(plain.scene.contact.unwrap().friction, 0.7);
        let changed = |change: fn(&mut Bundling), behind: &str| {
            let mut run = bundling;
            change(&mut run);
            assert_eq!(run.id(), format!("m3_ipc_mu0.7_20s{behind}"));
            run.prepare()
        };
        let tighter = changed(|run| run.distance_tolerance = 2e-6, "_delta2e-6");
        assert_eq!(tighter.scene.contact.unwrap().distance_tolerance, 2e-6);
        let coarser = changed(|run| run.step = Step::Fixed(5e-3), "_step0.005");
        assert_eq!(coarser.integration.step, StepSize::Fixed(5e-3));
        let finer = changed(
            |run| run.scheme = Scheme::BackwardDifferences,
            "_backward-differences",
        );
        let scheme = finer.integration.scheme;
        assert_eq!(scheme, dynamics::Scheme::BackwardDifferences);
        let wider = changed(|run| run.widening = 1e-8, "_wider1e-8");
        let automatic = changed(|run| run.step = Step::Auto, "_auto");
        let step = automatic.integration.step;
        assert!(matches!(step, StepSize::Auto { .. }));
        let place = |run: &PreparedRun| run.scene.rods[0].centreline[60];
        let difference = (place(&wider) - place(&plain)).norm();
        assert!((difference - 1e-10).abs() < 2e-13, "{difference}");
    }
}
