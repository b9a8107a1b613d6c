//! The experiment `helix-stability`.

use super::boundary::Boundary;
use super::discrete_rod::first_scene;
use super::keys::{HelixTables, TABLES, resolve};
use super::sections::section_figures;
use super::surface::boundary_page;
use crate::experiment::kind::{FigureError, FileNote, Kind, Page};
use crate::mechanics::scene::Scene;
use crate::results::{BOUNDARY, COMPARISON, PAGE, ResultsError, SECTION_FIGURES, SURFACE};
use crate::run::PreparedRun;
use crate::scenario::keys::{CommonTables, ExperimentKeys, OwnTable, Request, Section};
use crate::scenario::{Contact, Experiment, Fluid, Issue, Scenario, Time};
use std::path::Path;
use std::sync::Arc;

/// Where clamped helical rods lose stability.
pub struct HelixStabilityKind;

/// The files of the boundary.
static FILES: [FileNote; 7] = [
    FileNote {
        name: BOUNDARY,
        summary: "The loss of stability along each direction of the (κ, τ, ω) space, of a rod of length 1 and bending \
                  stiffness 1.",
        columns: &[
            (
                "part",
                "Part of the boundary: its surface, or one of the sections kappa_tau (ω = 0), kappa_omega (τ = 0) and \
                 tau_omega (κ = 0).",
            ),
            ("kappa", "Unit direction: curvature κ."),
            ("tau", "Unit direction: torsion τ."),
            ("omega", "Unit direction: twisting moment ω."),
            (
                "outcome",
                "What becomes of the rod: buckles, touches_itself before, stable up to the largest distance, or \
                 no_convergence.",
            ),
            (
                "critical",
                "Distance ‖(κ, τ, ω)‖ at which the discrete rod loses stability; empty where it does not.",
            ),
            (
                "extrapolated",
                "The same in the limit of a fine mesh; empty where it is not asked for.",
            ),
            (
                "theory",
                "The same by the conjugate points of the smooth rod; empty where there are none up to 100.",
            ),
            ("relative_difference", "critical/theory − 1."),
            (
                "relative_difference_extrapolated",
                "extrapolated/theory − 1.",
            ),
            (
                "contact",
                "Distance at which the rod first touches itself; empty where it loses stability before.",
            ),
        ],
    },
    FileNote {
        name: COMPARISON,
        summary: "The discrete rod against theory, in bands of distance.",
        columns: &[
            ("quantity", "What is compared: critical or extrapolated."),
            ("from", "Least distance of the band, by theory."),
            (
                "to",
                "Largest distance of the band, by theory; empty where there is no end.",
            ),
            ("directions", "Directions for which both have a value."),
            (
                "mean_difference",
                "Mean of the relative difference, without sign.",
            ),
            (
                "largest_difference",
                "Largest relative difference, without sign.",
            ),
            (
                "within_2e_4",
                "Part of the directions that differ by at most 0.02 %.",
            ),
            (
                "within_1e_3",
                "Part of the directions that differ by at most 0.1 %.",
            ),
            (
                "within_5e_3",
                "Part of the directions that differ by at most 0.5 %.",
            ),
        ],
    },
    FileNote {
        name: SECTION_FIGURES[0],
        summary: "Section ω = 0 of the boundary, the discrete rod over theory.",
        columns: &[],
    },
    FileNote {
        name: SECTION_FIGURES[1],
        summary: "Section τ = 0 of the boundary, the discrete rod over theory.",
        columns: &[],
    },
    FileNote {
        name: SECTION_FIGURES[2],
        summary: "Section κ = 0 of the boundary, the discrete rod over theory.",
        columns: &[],
    },
    FileNote {
        name: SURFACE,
        summary: "The boundary as a surface, for ParaView.",
        columns: &[],
    },
    FileNote {
        name: PAGE,
        summary: "The boundary as an interactive surface.",
        columns: &[],
    },
];

fn tables(scenario: &Scenario) -> &HelixTables {
    let tables = scenario.experiment.tables();
    tables.expect("the tables of this experiment")
}

impl ExperimentKeys for HelixStabilityKind {
    fn name(&self) -> &'static str {
        "helix-stability"
    }

    fn summary(&self) -> &'static str {
        "Where clamped helical rods lose stability."
    }

    fn tables(&self) -> &'static [OwnTable] {
        &TABLES
    }

    /// Equilibria all of them; there is no time to speak of.
    fn usual_time(&self) -> Option<Time> {
        Some(Time::Static)
    }

    fn resolve(&self, request: &Request<'_>) -> Option<Experiment> {
        request.refuse(
            &["material", "rod", "rods", "clamps", "loads", "planes"],
            "the rod has length 1 and bending stiffness 1; [helix_stability] says all of it",
        );
        Some(Experiment::new(self.name(), resolve(request)?))
    }

    fn judge(&self, top: &Section<'_>, common: &CommonTables<'_>) {
        for (key, present) in [
            ("time", *common.time != Time::Static),
            ("contact", *common.contact != Contact::None),
            ("fluid", *common.fluid != Fluid::None),
        ] {
            if present {
                top.fault(
                    key,
                    "helices are judged in equilibrium and in a vacuum; leave the table out",
                );
            }
        }
    }
}

impl Kind for HelixStabilityKind {
    fn template(&self) -> &'static str {
        include_str!("template.toml")
    }

    fn build(&self, scenario: &Scenario, scene: &mut Scene) -> Result<(), Issue> {
        *scene = first_scene(&tables(scenario).helix_stability);
        Ok(())
    }

    fn attach(&self, scenario: &Scenario, run: &mut PreparedRun) -> Result<(), Issue> {
        let boundary = Boundary::new(tables(scenario).helix_stability.clone());
        run.table = Some(Arc::new(boundary));
        Ok(())
    }

    fn files(&self) -> &'static [FileNote] {
        &FILES
    }

    fn figures(&self, directory: &Path) -> Result<Vec<(&'static str, String)>, FigureError> {
        if !directory.join(BOUNDARY).exists() {
            return Ok(Vec::new());
        }
        Ok(section_figures(directory)?)
    }

    fn page(&self, directory: &Path) -> Result<Page, ResultsError> {
        if !directory.join(BOUNDARY).exists() {
            return Ok(Page::RodsInMotion);
        }
        let page = boundary_page(directory)?;
        Ok(page.map_or(
            Page::Nothing("a boundary, but too few directions for a surface"),
            Page::Own,
        ))
    }
}
