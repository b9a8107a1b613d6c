//! What can be reproduced: one value for each table and figure, with its runs and what is made of them.

use super::applications::Application;
use super::bundling::Bundling;
use super::cases::{Case, Run, run_all};
use super::cost::{self, Costly};
use super::explored_helices::Explored;
use super::folds::Folded;
use super::grasp_grid::GraspGrid;
use super::hanging_strips::Hanging;
use super::heavy_loops::LoopOfRod;
use super::helices::Helices;
use super::inversion::Inversion;
use super::laying::Laying;
use super::manipulated_helix::ManipulatedHelix;
use super::page::{Heading, Page};
use super::sideways_push::SidewaysPush;
use super::simplified_inversion::{self, Factor};
use super::table::FiguresOfTable;
use super::tightening::Tightening;
use super::{
    ReproduceError, ReproduceOptions, auto_steps, cell_correction, deployment_correction,
    deployment_errors, drag_steps, figure_2_5, figure_2_6, figure_2_7, figure_2_8, figure_3_4,
    figure_3_9, figure_4_5, figure_4_9, figure_4_10, figure_4_11, figure_4_11_cell, figure_5_4,
    figure_5_5, figure_5_6, figure_5_8, figure_6_2, figure_6_5, figure_6_6_robot,
    inversion_factors, knot_convergence, laid_patterns, table_2_1, table_2_2, table_4_1, table_5_2,
    table_5_2_cell, table_5_3, table_5_4, table_5_4_cell,
};
use std::fmt;
use std::path::PathBuf;

/// A table or figure of the thesis, or one about this engine itself.
pub struct Artifact {
    name: &'static str,
    title: &'static str,
    pub(super) recipe: &'static dyn AnyRecipe,
}

/// All tables and figures.
pub static ARTIFACTS: [Artifact; 41] = [
    Artifact {
        name: "tab2.1",
        title: "Table 2.1: IMC and IPC, iterations and time of bundling flagella",
        recipe: &Recipe {
            runs: Bundling::of_table_2_1,
            write: table_2_1::write,
            figures_of_table: Some(table_2_1::figures_of_table),
        },
    },
    Artifact {
        name: "tab2.2",
        title: "Table 2.2: two flagella with growing friction, convergence",
        recipe: &Recipe {
            runs: Bundling::of_table_2_2,
            write: table_2_2::write,
            figures_of_table: Some(table_2_2::figures_of_table),
        },
    },
    Artifact {
        name: "fig2.5",
        title: "Figure 2.5: difference between IMC and IPC, five flagella",
        recipe: &Recipe {
            runs: Bundling::of_figure_2_5,
            write: figure_2_5::write,
            figures_of_table: Some(figure_2_5::figures_of_table),
        },
    },
    Artifact {
        name: "fig2.6",
        title: "Figure 2.6: two flagella with growing friction, snapshots",
        recipe: &Recipe {
            runs: Bundling::of_figure_2_6,
            write: figure_2_6::write,
            figures_of_table: None,
        },
    },
    Artifact {
        name: "fig2.7",
        title: "Figure 2.7: a trefoil pulled tight, traction and theory",
        recipe: &Recipe {
            runs: Tightening::of_figure_2_7,
            write: figure_2_7::write,
            figures_of_table: Some(figure_2_7::figures_of_table),
        },
    },
    Artifact {
        name: "fig2.8",
        title: "Figure 2.8: overhand knots pulled tight, traction and theory",
        recipe: &Recipe {
            runs: Tightening::of_figure_2_8,
            write: figure_2_8::write,
            figures_of_table: Some(figure_2_8::figures_of_table),
        },
    },
    Artifact {
        name: "fig3.4",
        title: "Figure 3.4: an overhand knot pulled until it inverts",
        recipe: &Recipe {
            runs: Inversion::of_figure_3_4,
            write: figure_3_4::write,
            figures_of_table: Some(figure_3_4::figures_of_table),
        },
    },
    Artifact {
        name: "fig3.5",
        title: "Figure 3.5: inversion over the radius of the rod",
        recipe: &Recipe {
            runs: Inversion::of_figure_3_5,
            write: |page, cases| inversion_factors::write(page, &inversion_factors::RADIUS, cases),
            figures_of_table: Some(|table| inversion_factors::figures_of_table("fig3.5", table)),
        },
    },
    Artifact {
        name: "fig3.6",
        title: "Figure 3.6: inversion over the unknotting number",
        recipe: &Recipe {
            runs: Inversion::of_figure_3_6,
            write: |page, cases| inversion_factors::write(page, &inversion_factors::NUMBER, cases),
            figures_of_table: Some(|table| inversion_factors::figures_of_table("fig3.6", table)),
        },
    },
    Artifact {
        name: "fig3.7",
        title: "Figure 3.7: inversion over friction",
        recipe: &Recipe {
            runs: Inversion::of_figure_3_7,
            write: |page, cases| {
                inversion_factors::write(page, &inversion_factors::FRICTION, cases)
            },
            figures_of_table: Some(|table| inversion_factors::figures_of_table("fig3.7", table)),
        },
    },
    Artifact {
        name: "fig3.9",
        title: "Figure 3.9: energy and equilibria of the simplified knot",
        recipe: &Recipe {
            runs: |quick| vec![Inversion::of_figure_3_5(quick)[0]],
            write: figure_3_9::write,
            figures_of_table: Some(figure_3_9::figures_of_table),
        },
    },
    Artifact {
        name: "fig3.10",
        title: "Figure 3.10: the simplified knot over the radius",
        recipe: &Recipe {
            runs: Inversion::of_figure_3_5,
            write: |page, cases| simplified_inversion::write(page, Factor::Radius, cases),
            figures_of_table: Some(|table| {
                simplified_inversion::figures_of_table("fig3.10", Factor::Radius, table)
            }),
        },
    },
    Artifact {
        name: "fig3.11",
        title: "Figure 3.11: the simplified knot over the unknotting number",
        recipe: &Recipe {
            runs: Inversion::of_figure_3_6,
            write: |page, cases| simplified_inversion::write(page, Factor::UnknottingNumber, cases),
            figures_of_table: Some(|table| {
                simplified_inversion::figures_of_table("fig3.11", Factor::UnknottingNumber, table)
            }),
        },
    },
    Artifact {
        name: "fig4.5",
        title: "Figure 4.5: the force manifold of folding",
        recipe: &Recipe {
            runs: Folded::of_figure_4_5,
            write: figure_4_5::write,
            figures_of_table: None,
        },
    },
    Artifact {
        name: "fig4.9",
        title: "Figure 4.9: the gravito-bending length from a strip that hangs down",
        recipe: &Recipe {
            runs: Hanging::of_figure_4_9,
            write: figure_4_9::write,
            figures_of_table: Some(figure_4_9::figures_of_table),
        },
    },
    Artifact {
        name: "fig4.10",
        title: "Figure 4.10: ways of the gripper that folds US letter paper",
        recipe: &Recipe {
            runs: Folded::of_figure_4_10,
            write: figure_4_10::write,
            figures_of_table: None,
        },
    },
    Artifact {
        name: "fig4.11",
        title: "Figure 4.11: seven folds by several ways, simulated",
        recipe: &Recipe {
            runs: Folded::of_figure_4_11,
            write: figure_4_11::write,
            figures_of_table: Some(figure_4_11::figures_of_table),
        },
    },
    Artifact {
        name: "fig4.11-cell",
        title: "Figure 4.11 in the virtual cell: seven folds through drivers and camera",
        recipe: &Recipe {
            runs: Folded::of_cell,
            write: figure_4_11_cell::write,
            figures_of_table: Some(figure_4_11_cell::figures_of_table),
        },
    },
    Artifact {
        name: "tab4.1",
        title: "Table 4.1: how long plans of folds take",
        recipe: &Recipe {
            runs: Folded::of_table_4_1,
            write: table_4_1::write,
            figures_of_table: None,
        },
    },
    Artifact {
        name: "fig5.4",
        title: "Figure 5.4: where a gripper may be above a straight line",
        recipe: &Recipe {
            runs: SidewaysPush::of_figure_5_5,
            write: figure_5_4::write,
            figures_of_table: Some(figure_5_4::figures_of_table),
        },
    },
    Artifact {
        name: "fig5.5",
        title: "Figure 5.5: two optimal grasps pushed sideways",
        recipe: &Recipe {
            runs: SidewaysPush::of_figure_5_5,
            write: figure_5_5::write,
            figures_of_table: Some(figure_5_5::figures_of_table),
        },
    },
    Artifact {
        name: "fig5.6",
        title: "Figure 5.6: optimal grasps over curvature, length and stiffness",
        recipe: &Recipe {
            runs: GraspGrid::of_figure_5_6,
            write: figure_5_6::write,
            figures_of_table: Some(figure_5_6::figures_of_table),
        },
    },
    Artifact {
        name: "fig5.8",
        title: "Figure 5.8: the gravito-bending length from the height of a loop",
        recipe: &Recipe {
            runs: LoopOfRod::of_figure_5_8,
            write: figure_5_8::write,
            figures_of_table: Some(figure_5_8::figures_of_table),
        },
    },
    Artifact {
        name: "fig5.10",
        title: "Figure 5.10: three rods laid along patterns on fabric",
        recipe: &Recipe {
            runs: Laying::of_figure_5_10,
            write: laid_patterns::write_rods,
            figures_of_table: None,
        },
    },
    Artifact {
        name: "fig5.11",
        title: "Figure 5.11: a rod laid along patterns on three tables",
        recipe: &Recipe {
            runs: Laying::of_figure_5_11,
            write: laid_patterns::write_tables,
            figures_of_table: None,
        },
    },
    Artifact {
        name: "tab5.2",
        title: "Table 5.2: rods laid along patterns, simulated and measured",
        recipe: &Recipe {
            runs: Laying::of_table_5_2,
            write: table_5_2::write,
            figures_of_table: None,
        },
    },
    Artifact {
        name: "tab5.2-cell",
        title: "Table 5.2 in the virtual cell: through drivers and camera",
        recipe: &Recipe {
            runs: Laying::of_cell,
            write: table_5_2_cell::write,
            figures_of_table: None,
        },
    },
    Artifact {
        name: "tab5.3",
        title: "Table 5.3: trajectories by exact grasps and by the network",
        recipe: &Recipe {
            runs: Laying::of_table_5_3,
            write: table_5_3::write,
            figures_of_table: Some(table_5_3::figures_of_table),
        },
    },
    Artifact {
        name: "tab5.4",
        title: "Table 5.4: cables placed in clips, and knots tied on the table",
        recipe: &Recipe {
            runs: Application::of_table_5_4,
            write: table_5_4::write,
            figures_of_table: None,
        },
    },
    Artifact {
        name: "tab5.4-cell",
        title: "Table 5.4 in the virtual cell: cables placed and knots tied through drivers and camera",
        recipe: &Recipe {
            runs: Application::of_table_5_4_in_cell,
            write: table_5_4_cell::write,
            figures_of_table: None,
        },
    },
    Artifact {
        name: "fig6.2",
        title: "Figure 6.2: the boundary of the stable helices",
        recipe: &Recipe {
            runs: |quick| vec![Helices::of_the_thesis(quick)],
            write: figure_6_2::write,
            figures_of_table: Some(figure_6_2::figures_of_table),
        },
    },
    Artifact {
        name: "fig6.5",
        title: "Figure 6.5: disturbances of a manipulated helical rod",
        recipe: &Recipe {
            runs: ManipulatedHelix::of_figure_6_5,
            write: figure_6_5::write,
            figures_of_table: Some(figure_6_5::figures_of_table),
        },
    },
    Artifact {
        name: "fig6.6",
        title: "Figure 6.6: the boundary of the stable helices at ω = 0",
        recipe: &Recipe {
            runs: |quick| vec![Helices::of_the_thesis(quick)],
            write: figure_6_2::write_section,
            figures_of_table: Some(figure_6_2::figures_of_section),
        },
    },
    Artifact {
        name: "fig6.6-robot",
        title: "Figure 6.6: the boundary of the stable helices, explored by the arm of a virtual cell",
        recipe: &Recipe {
            runs: |quick| vec![Explored::of_the_thesis(quick)],
            write: figure_6_6_robot::write,
            figures_of_table: Some(figure_6_6_robot::figures_of_table),
        },
    },
    Artifact {
        name: "knot-convergence",
        title: "Overhand knots pulled tight: mesh, pull speed and contact tolerance",
        recipe: &Recipe {
            runs: Tightening::of_convergence,
            write: knot_convergence::write,
            figures_of_table: None,
        },
    },
    Artifact {
        name: "deployment-errors",
        title: "Laid rods: jitter of the gripper and errors of the gravito-bending length",
        recipe: &Recipe {
            runs: Laying::of_errors,
            write: deployment_errors::write,
            figures_of_table: Some(deployment_errors::figures_of_table),
        },
    },
    Artifact {
        name: "deployment-correction",
        title: "Laid rods: what online correction makes up for",
        recipe: &Recipe {
            runs: Laying::of_correction,
            write: deployment_correction::write,
            figures_of_table: Some(deployment_correction::figures_of_table),
        },
    },
    Artifact {
        name: "cell-correction",
        title: "Rods laid in the virtual cell: what correction makes up for",
        recipe: &Recipe {
            runs: Laying::of_cell_correction,
            write: cell_correction::write,
            figures_of_table: Some(cell_correction::figures_of_table),
        },
    },
    Artifact {
        name: "cost",
        title: "Cost of a step over the number of flagella, of rods in a heap, of edges",
        recipe: &Recipe {
            runs: Costly::all,
            write: cost::write,
            figures_of_table: Some(cost::figures_of_table),
        },
    },
    Artifact {
        name: "drag-steps",
        title: "Error of larger and automatic steps, two flagella",
        recipe: &Recipe {
            runs: Bundling::of_drag_steps,
            write: drag_steps::write,
            figures_of_table: None,
        },
    },
    Artifact {
        name: "auto-steps",
        title: "Automatic steps over 250 s, two and ten flagella",
        recipe: &Recipe {
            runs: Bundling::of_auto_steps,
            write: auto_steps::write,
            figures_of_table: None,
        },
    },
];

impl Artifact {
    /// The artefact of a name.
    pub fn named(name: &str) -> Option<&'static Self> {
        ARTIFACTS.iter().find(|artifact| artifact.name == name)
    }

    /// What the command line and directories call it.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// What it shows, with its number.
    pub fn title(&self) -> &'static str {
        self.title
    }

    /// Rough cost of all its runs on one core, s.
    pub fn cost(&self, quick: bool) -> f64 {
        self.recipe.cost(quick)
    }
}

impl PartialEq for Artifact {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl fmt::Debug for Artifact {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name)
    }
}

/// How an artefact is made: its runs, quick ones or all of their time, and the page that is written of them.
struct Recipe<R> {
    runs: fn(quick: bool) -> Vec<R>,
    write: fn(&mut Page, &[Case<R>]) -> Result<(), ReproduceError>,
    /// Its figures from its table alone, where they hold no more.
    figures_of_table: Option<FiguresOfTable>,
}

/// A [`Recipe`] of whatever runs.
pub(super) trait AnyRecipe: Sync {
    /// Rough cost of all runs on one core, s.
    fn cost(&self, quick: bool) -> f64;

    /// The figures from the table alone.
    fn figures_of_table(&self) -> Option<FiguresOfTable>;

    /// Makes the runs and writes the page; returns the files written.
    fn make(
        &self,
        artifact: &'static Artifact,
        options: &ReproduceOptions,
        report: &(dyn Fn(&str) + Sync),
    ) -> Result<Vec<PathBuf>, ReproduceError>;

    /// The same with a few steps of the first `count` runs.
    #[cfg(test)]
    fn make_shortened(
        &self,
        artifact: &'static Artifact,
        count: usize,
        options: &ReproduceOptions,
        report: &(dyn Fn(&str) + Sync),
    ) -> Result<Vec<PathBuf>, ReproduceError>;

    /// The ids of the runs.
    #[cfg(test)]
    fn ids(&self, quick: bool) -> Vec<String>;

    /// The type of the runs.
    #[cfg(test)]
    fn kind(&self) -> &'static str;

    /// Prepares so many of the runs, each of which has a rod.
    #[cfg(test)]
    fn check_scenarios(&self, quick: bool, count: usize);
}

impl<R: Run> Recipe<R> {
    fn make_of(
        &self,
        artifact: &'static Artifact,
        runs: &[R],
        options: &ReproduceOptions,
        report: &(dyn Fn(&str) + Sync),
    ) -> Result<Vec<PathBuf>, ReproduceError> {
        let cases = run_all(runs, options, report)?;
        let heading = Heading {
            name: artifact.name,
            title: artifact.title,
        };
        let mut page = Page::begin(heading, options, &cases)?;
        (self.write)(&mut page, &cases)?;
        Ok(page.finish()?)
    }
}

impl<R: Run> AnyRecipe for Recipe<R> {
    fn cost(&self, quick: bool) -> f64 {
        (self.runs)(quick).iter().map(Run::cost).sum()
    }

    fn figures_of_table(&self) -> Option<FiguresOfTable> {
        self.figures_of_table
    }

    fn make(
        &self,
        artifact: &'static Artifact,
        options: &ReproduceOptions,
        report: &(dyn Fn(&str) + Sync),
    ) -> Result<Vec<PathBuf>, ReproduceError> {
        self.make_of(artifact, &(self.runs)(options.quick), options, report)
    }

    #[cfg(test)]
    fn make_shortened(
        &self,
        artifact: &'static Artifact,
        count: usize,
        options: &ReproduceOptions,
        report: &(dyn Fn(&str) + Sync),
    ) -> Result<Vec<PathBuf>, ReproduceError> {
        let runs = (self.runs)(options.quick);
        let runs: Vec<R> = runs.iter().take(count).map(Run::shortened).collect();
        self.make_of(artifact, &runs, options, report)
    }

    #[cfg(test)]
    fn ids(&self, quick: bool) -> Vec<String> {
        (self.runs)(quick).iter().map(Run::id).collect()
    }

    #[cfg(test)]
    fn kind(&self) -> &'static str {
        std::any::type_name::<R>()
    }

    #[cfg(test)]
    fn check_scenarios(&self, quick: bool, count: usize) {
        for run in (self.runs)(quick).iter().take(count) {
            assert!(!run.prepare().scene.rods.is_empty(), "{}", run.id());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn artefacts_are_found_by_their_names() {
        for artifact in &ARTIFACTS {
            let found = Artifact::named(artifact.name()).unwrap();
            assert_eq!(found.title(), artifact.title());
        }
        assert_eq!(Artifact::named("tab9.9"), None);
    }

    #[test]
    fn runs_of_an_artefact_have_different_ids() {
        for artifact in &ARTIFACTS {
            for quick in [false, true] {
                let ids = artifact.recipe.ids(quick);
                let different: BTreeSet<&String> = ids.iter().collect();
                assert_eq!(different.len(), ids.len(), "{artifact:?}");
            }
        }
    }

    /// One of each kind; the test of the pages prepares more.
    #[test]
    fn runs_of_an_artefact_are_scenarios() {
        let is_full = crate::reproduce::tests_are_full();
        let mut kinds = BTreeSet::new();
        for artifact in &ARTIFACTS {
            let is_new = kinds.insert(artifact.recipe.kind());
            if is_full {
                artifact.recipe.check_scenarios(false, usize::MAX);
                artifact.recipe.check_scenarios(true, usize::MAX);
            } else if is_new {
                artifact.recipe.check_scenarios(true, 1);
            }
        }
    }
}
