//! What can be reproduced, and the runs that it takes.

use super::auto_steps;
use super::bundling::{Bundling, ContactModel, DISTANCE_TOLERANCE, STEP, Scheme};
use super::drag_steps;
use super::figure_2_5;
use super::helices::Helices;
use super::inversion::Inversion;
use super::manipulated_helix::ManipulatedHelix;
use super::tightening::Tightening;

/// A table or figure of the thesis, or one about this engine itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Artifact {
    /// IMC against IPC: iterations and time.
    Table2_1,
    /// Convergence for growing friction.
    Table2_2,
    /// Difference between IMC and IPC.
    Figure2_5,
    /// Snapshots for growing friction.
    Figure2_6,
    /// Traction of a trefoil.
    Figure2_7,
    /// Traction of overhand knots.
    Figure2_8,
    /// The inversion of an overhand knot.
    Figure3_4,
    /// Inversion over the radius of the rod.
    Figure3_5,
    /// Inversion over the unknotting number.
    Figure3_6,
    /// Inversion over friction.
    Figure3_7,
    /// Energy and equilibria of the simplified knot.
    Figure3_9,
    /// Its inversion over the radius of the rod.
    Figure3_10,
    /// Its inversion over the unknotting number.
    Figure3_11,
    /// The boundary of the stable helices.
    Figure6_2,
    /// Disturbances of a manipulated helical rod.
    Figure6_5,
    /// The section ω = 0 of the boundary.
    Figure6_6,
    /// Mesh, pull speed and contact tolerance of overhand knots.
    KnotConvergence,
    /// Cost of a step over the number of flagella.
    Cost,
    /// Error over the size of the time step.
    DragSteps,
    /// Automatic steps over the whole time of the thesis.
    AutoSteps,
}

/// The runs of an artefact.
pub(super) enum Runs {
    /// Bundling flagella.
    Bundling(Vec<Bundling>),
    /// Knots pulled tight.
    Tightening(Vec<Tightening>),
    /// Knots pulled until they invert.
    Inversion(Vec<Inversion>),
    /// Stability of helices.
    Helices(Vec<Helices>),
    /// Helical rods manipulated in time.
    ManipulatedHelices(Vec<ManipulatedHelix>),
}

/// Numbers of flagella of the thesis (section 2.4.2).
pub(super) const FLAGELLA: [usize; 4] = [2, 3, 5, 10];
/// Numbers of flagella whose cost is measured.
const FLAGELLA_OF_COST: [usize; 6] = [2, 5, 10, 20, 50, 100];
/// Simulated time of the thesis, s.
const END: f64 = 250.0;
/// Simulated time of a quick look, s; that at a difference has 20 s of contact.
const QUICK_END: f64 = 20.0;
const QUICK_END_OF_DIFFERENCE: f64 = 25.0;
/// Simulated time over which costs are measured, s: 400 steps, of which the first dozens build the preconditioner.
const END_OF_COST: f64 = 0.4;
const QUICK_END_OF_COST: f64 = 0.05;
/// Simulated time of the comparison of steps, s.
const END_OF_STEPS: f64 = 20.0;
const QUICK_END_OF_STEPS: f64 = 5.0;

impl Artifact {
    /// All of them.
    pub const ALL: [Self; 20] = [
        Self::Table2_1,
        Self::Table2_2,
        Self::Figure2_5,
        Self::Figure2_6,
        Self::Figure2_7,
        Self::Figure2_8,
        Self::Figure3_4,
        Self::Figure3_5,
        Self::Figure3_6,
        Self::Figure3_7,
        Self::Figure3_9,
        Self::Figure3_10,
        Self::Figure3_11,
        Self::Figure6_2,
        Self::Figure6_5,
        Self::Figure6_6,
        Self::KnotConvergence,
        Self::Cost,
        Self::DragSteps,
        Self::AutoSteps,
    ];

    /// The artefact of a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|artifact| artifact.name() == name)
    }

    /// What the command line and directories call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Table2_1 => "tab2.1",
            Self::Table2_2 => "tab2.2",
            Self::Figure2_5 => "fig2.5",
            Self::Figure2_6 => "fig2.6",
            Self::Figure2_7 => "fig2.7",
            Self::Figure2_8 => "fig2.8",
            Self::Figure3_4 => "fig3.4",
            Self::Figure3_5 => "fig3.5",
            Self::Figure3_6 => "fig3.6",
            Self::Figure3_7 => "fig3.7",
            Self::Figure3_9 => "fig3.9",
            Self::Figure3_10 => "fig3.10",
            Self::Figure3_11 => "fig3.11",
            Self::Figure6_2 => "fig6.2",
            Self::Figure6_5 => "fig6.5",
            Self::Figure6_6 => "fig6.6",
            Self::KnotConvergence => "knot-convergence",
            Self::Cost => "cost",
            Self::DragSteps => "drag-steps",
            Self::AutoSteps => "auto-steps",
        }
    }

    /// What it shows, with its number.
    pub fn title(self) -> &'static str {
        match self {
            Self::Table2_1 => "Table 2.1: IMC and IPC, iterations and time of bundling flagella",
            Self::Table2_2 => "Table 2.2: two flagella with growing friction, convergence",
            Self::Figure2_5 => "Figure 2.5: difference between IMC and IPC, five flagella",
            Self::Figure2_6 => "Figure 2.6: two flagella with growing friction, snapshots",
            Self::Figure2_7 => "Figure 2.7: a trefoil pulled tight, traction and theory",
            Self::Figure2_8 => "Figure 2.8: overhand knots pulled tight, traction and theory",
            Self::Figure3_4 => "Figure 3.4: an overhand knot pulled until it inverts",
            Self::Figure3_5 => "Figure 3.5: inversion over the radius of the rod",
            Self::Figure3_6 => "Figure 3.6: inversion over the unknotting number",
            Self::Figure3_7 => "Figure 3.7: inversion over friction",
            Self::Figure3_9 => "Figure 3.9: energy and equilibria of the simplified knot",
            Self::Figure3_10 => "Figure 3.10: the simplified knot over the radius",
            Self::Figure3_11 => "Figure 3.11: the simplified knot over the unknotting number",
            Self::Figure6_2 => "Figure 6.2: the boundary of the stable helices",
            Self::Figure6_5 => "Figure 6.5: disturbances of a manipulated helical rod",
            Self::Figure6_6 => "Figure 6.6: the boundary of the stable helices at ω = 0",
            Self::KnotConvergence => {
                "Overhand knots pulled tight: mesh, pull speed and contact tolerance"
            }
            Self::Cost => "Cost of a step over the number of flagella",
            Self::DragSteps => "Error of larger and automatic steps, two flagella",
            Self::AutoSteps => "Automatic steps over 250 s, two and ten flagella",
        }
    }

    /// Rough cost of all its runs on one core, s.
    pub fn cost(self, quick: bool) -> f64 {
        match self.runs(quick) {
            Runs::Bundling(runs) => runs.iter().map(Bundling::cost).sum(),
            Runs::Tightening(runs) => runs.iter().map(Tightening::cost).sum(),
            Runs::Inversion(runs) => runs.iter().map(Inversion::cost).sum(),
            Runs::Helices(runs) => runs.iter().map(Helices::cost).sum(),
            Runs::ManipulatedHelices(runs) => runs.iter().map(ManipulatedHelix::cost).sum(),
        }
    }

    /// Its runs; of flagella those of IMC before those of IPC.
    pub(super) fn runs(self, quick: bool) -> Runs {
        match self {
            Self::Figure2_7 => Runs::Tightening(Tightening::of_figure_2_7(quick)),
            Self::Figure2_8 => Runs::Tightening(Tightening::of_figure_2_8(quick)),
            Self::KnotConvergence => Runs::Tightening(Tightening::of_convergence(quick)),
            Self::Figure3_4 => Runs::Inversion(Inversion::of_figure_3_4(quick)),
            Self::Figure3_5 | Self::Figure3_10 => Runs::Inversion(Inversion::of_figure_3_5(quick)),
            Self::Figure3_6 | Self::Figure3_11 => Runs::Inversion(Inversion::of_figure_3_6(quick)),
            Self::Figure3_9 => Runs::Inversion(vec![Inversion::of_figure_3_5(quick)[0]]),
            Self::Figure3_7 => Runs::Inversion(Inversion::of_figure_3_7(quick)),
            Self::Figure6_2 | Self::Figure6_6 => Runs::Helices(vec![Helices::of_the_thesis(quick)]),
            Self::Figure6_5 => Runs::ManipulatedHelices(ManipulatedHelix::of_figure_6_5(quick)),
            _ => Runs::Bundling(self.bundlings(quick)),
        }
    }

    fn bundlings(self, quick: bool) -> Vec<Bundling> {
        let end = match (quick, self) {
            (false, Self::Cost) => END_OF_COST,
            (true, Self::Cost) => QUICK_END_OF_COST,
            (false, Self::DragSteps) => END_OF_STEPS,
            (true, Self::DragSteps) => QUICK_END_OF_STEPS,
            (false, _) => END,
            (true, Self::Figure2_5) => QUICK_END_OF_DIFFERENCE,
            (true, _) => QUICK_END,
        };
        let both = |counts: &[usize], distance_tolerance: f64| {
            let models = [ContactModel::Imc, ContactModel::Ipc];
            let run = |model, flagella: &usize| Bundling {
                flagella: *flagella,
                model,
                friction: 0.0,
                distance_tolerance,
                scheme: Scheme::ImplicitEuler,
                step: STEP,
                widening: 0.0,
                end,
            };
            models
                .into_iter()
                .flat_map(|model| counts.iter().map(move |flagella| run(model, flagella)))
                .collect()
        };
        let free = |flagella: usize| Bundling {
            flagella,
            model: ContactModel::Imc,
            friction: 0.0,
            distance_tolerance: DISTANCE_TOLERANCE,
            scheme: Scheme::ImplicitEuler,
            step: STEP,
            widening: 0.0,
            end,
        };
        let rubbing = |friction: f64| Bundling {
            friction,
            ..free(2)
        };
        match self {
            Self::Table2_1 => both(&FLAGELLA, DISTANCE_TOLERANCE),
            Self::Table2_2 => (1..=10)
                .map(|tenths| rubbing(f64::from(tenths) / 10.0))
                .collect(),
            Self::Figure2_5 => both(&[5], figure_2_5::DISTANCE_TOLERANCE),
            Self::Figure2_6 => [0.0, 0.3, 0.7].map(rubbing).to_vec(),
            Self::Cost => FLAGELLA_OF_COST.map(free).to_vec(),
            Self::DragSteps => drag_steps::STEPS
                .map(|(scheme, step)| Bundling {
                    scheme,
                    step,
                    ..free(2)
                })
                .to_vec(),
            Self::AutoSteps => auto_steps::FLAGELLA
                .into_iter()
                .flat_map(|flagella| {
                    auto_steps::VARIANTS.map(|(step, widening)| Bundling {
                        scheme: Scheme::BackwardDifferences,
                        step,
                        widening,
                        ..free(flagella)
                    })
                })
                .collect(),
            Self::Figure2_7
            | Self::Figure2_8
            | Self::Figure3_4
            | Self::Figure3_5
            | Self::Figure3_6
            | Self::Figure3_7
            | Self::Figure3_9
            | Self::Figure3_10
            | Self::Figure3_11
            | Self::Figure6_2
            | Self::Figure6_5
            | Self::Figure6_6
            | Self::KnotConvergence => Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::cases::Run;
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn artefacts_are_found_by_their_names() {
        for artifact in Artifact::ALL {
            assert_eq!(Artifact::named(artifact.name()), Some(artifact));
        }
        assert_eq!(Artifact::named("tab9.9"), None);
    }

    #[test]
    fn runs_of_an_artefact_have_different_ids_and_are_scenarios() {
        for artifact in Artifact::ALL {
            for quick in [false, true] {
                let (ids, rods): (Vec<String>, Vec<[usize; 2]>) = match artifact.runs(quick) {
                    Runs::Bundling(runs) => runs
                        .iter()
                        .map(|run| (run.id(), [run.prepare().scene.rods.len(), run.flagella]))
                        .unzip(),
                    Runs::Tightening(runs) => runs
                        .iter()
                        .map(|run| (run.id(), [run.prepare().scene.rods.len(), 1]))
                        .unzip(),
                    Runs::ManipulatedHelices(runs) => runs
                        .iter()
                        .map(|run| (run.id(), [run.prepare().scene.rods.len(), 1]))
                        .unzip(),
                    Runs::Inversion(runs) => runs
                        .iter()
                        .map(|run| (run.id(), [run.prepare().scene.rods.len(), 1]))
                        .unzip(),
                    Runs::Helices(runs) => runs
                        .iter()
                        .map(|run| (run.id(), [run.prepare().scene.rods.len(), 1]))
                        .unzip(),
                };
                assert!(rods.iter().all(|[built, asked]| built == asked));
                let different: BTreeSet<&String> = ids.iter().collect();
                assert_eq!(different.len(), ids.len(), "{artifact:?}");
            }
        }
    }

    #[test]
    fn the_runs_of_table_2_1_come_in_pairs_of_models() {
        let runs = Artifact::Table2_1.bundlings(false);
        let (penalty, barrier) = runs.split_at(FLAGELLA.len());
        for (imc, ipc) in penalty.iter().zip(barrier) {
            assert_eq!(
                (imc.model, ipc.model),
                (ContactModel::Imc, ContactModel::Ipc)
            );
            assert_eq!(imc.flagella, ipc.flagella);
        }
    }
}
