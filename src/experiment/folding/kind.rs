//! The experiment `folding`.

use super::feedback::VisualFeedback;
use super::files::{FILES, FOLDED_FIGURE};
use super::folded_figure::folded_figure;
use super::gripper_path::GripperPath;
use super::keys::{Folding, GRAVITY, TABLES, resolve};
use super::monitor::{FoldingMonitor, Watched};
use super::tables::FoldingTables;
use crate::experiment::kind::{FigureError, Kind, OwnNumbers};
use crate::experiment::prepare::round_rod;
use crate::figure::Figure;
use crate::mechanics::Vector3;
use crate::mechanics::scene::{Clamp, Load, LoadKind, Plane, Scene};
use crate::plan::deployment::DeployedRod;
use crate::results::FileDescription;
use crate::run::PreparedRun;
use crate::scenario::keys::{CommonTables, ExperimentKeys, OwnTable, Request, Section};
use crate::scenario::{
    BuilderRod, Contact, Experiment, Issue, KeyPath, Material, Scenario, Scheme, Step, Time,
};
use serde::Serialize;
use std::f64::consts::PI;
use std::path::Path;

/// Step and duration where no table says otherwise, s.
const STEP: f64 = 5e-3;
const END: f64 = 15.0;
/// The edge is down where it is less than so many layers high, and no more than a part of L_gb.
const LAYERS: f64 = 6.0;
const DOWN: f64 = 0.05;

/// A sheet that a gripper folds on a table.
pub struct FoldingKind;

/// Numbers for `rodlab check`.
#[derive(Serialize)]
struct DerivedFold {
    gravito_bending_length_m: f64,
    target_m: f64,
    poses: usize,
    largest_gripper_speed_m_s: f64,
}

fn tables(scenario: &Scenario) -> &FoldingTables {
    let tables = scenario.experiment.tables();
    tables.expect("the tables of this experiment")
}

impl ExperimentKeys for FoldingKind {
    fn name(&self) -> &'static str {
        "folding"
    }

    fn summary(&self) -> &'static str {
        "A sheet that a gripper folds on a table."
    }

    fn tables(&self) -> &'static [OwnTable] {
        &TABLES
    }

    fn usual_time(&self) -> Option<Time> {
        Some(Time::Dynamic {
            scheme: Scheme::ImplicitEuler,
            step: Step::Fixed(STEP),
            end: END,
        })
    }

    fn resolve(&self, request: &Request<'_>) -> Option<Experiment> {
        let folding = resolve(request)?;
        let radius = 0.5 * folding.paper.thickness;
        let tables = FoldingTables::new(folding);
        Some(Experiment::new(self.name(), tables).with_radius(radius))
    }

    fn judge(&self, top: &Section<'_>, common: &CommonTables<'_>) {
        if *common.contact == Contact::None {
            top.missing("contact", "a table that a sheet is folded on: [contact]");
        }
    }
}

impl Kind for FoldingKind {
    fn template(&self) -> &'static str {
        include_str!("template.toml")
    }

    fn build(&self, scenario: &Scenario, scene: &mut Scene) -> Result<(), Issue> {
        let folding = &tables(scenario).folding;
        let path = gripper_path(scenario)?;
        add(scene, folding, path, scenario.contact.friction());
        Ok(())
    }

    fn attach(&self, scenario: &Scenario, run: &mut PreparedRun) -> Result<(), Issue> {
        let folding = &tables(scenario).folding;
        let path = gripper_path(scenario)?;
        let friction = scenario.contact.friction();
        run.observers
            .push(Box::new(FoldingMonitor::new(watched(folding, path))));
        if let Some(keys) = folding.feedback {
            let node = folding.paper.edges;
            let clamps = &run.scene.clamps;
            let holds = |clamp: &Clamp| clamp.rod == 0 && clamp.node == node;
            let clamp = clamps.iter().position(holds);
            let clamp = clamp.expect("the gripper of a fold");
            let feedback = VisualFeedback::new(folding, keys, path, clamp, friction);
            run.controllers.push(Box::new(feedback));
        }
        Ok(())
    }

    fn derived(&self, run: &PreparedRun) -> Option<OwnNumbers> {
        let monitor = run.observer::<FoldingMonitor>()?;
        let watched = &monitor.watched;
        let numbers = DerivedFold {
            gravito_bending_length_m: watched.gravito_bending_length,
            target_m: watched.target,
            poses: watched.poses,
            largest_gripper_speed_m_s: watched.largest_speed,
        };
        let line = |name: &str, text: String| (name.to_owned(), text);
        let lines = vec![
            line(
                "sheet",
                format!(
                    "{:.4} m = {:.3} L_gb; its edge goes {:.4} m",
                    watched.length,
                    watched.length / watched.gravito_bending_length,
                    watched.target
                ),
            ),
            line(
                "  gripper, at most",
                format!("{:.1} cm/s", 1e2 * watched.largest_speed),
            ),
        ];
        Some(OwnNumbers::new("folding", &numbers, lines))
    }

    fn files(&self) -> &'static [FileDescription] {
        &FILES
    }

    fn figures(&self, directory: &Path) -> Result<Vec<(&'static str, Figure)>, FigureError> {
        let figure = folded_figure(directory)?;
        Ok(figure
            .map(|figure| (FOLDED_FIGURE, figure))
            .into_iter()
            .collect())
    }
}

fn gripper_path(scenario: &Scenario) -> Result<&GripperPath, Issue> {
    let path = tables(scenario).path(scenario);
    path.map_err(|error| Issue::new(KeyPath::from("folding.crease"), error.to_string()))
}

/// Adds sheet, gripper, weight and table. A strip of the sheet is a round rod as thick as the sheet, whose modulus gives it the same L_gb:
/// then both bend alike in the plane of the fold.
fn add(scene: &mut Scene, folding: &Folding, path: &GripperPath, friction: f64) {
    let sheet = folding.sheet();
    let paper = &folding.paper;
    let radius = 0.5 * paper.thickness;
    let strip = DeployedRod {
        gravito_bending_length: sheet.gravito_bending_length,
        radius,
        length: sheet.length,
    };
    let material = Material {
        youngs_modulus: strip.youngs_modulus(paper.density, GRAVITY),
        poissons_ratio: 0.5,
        density: paper.density,
    };
    let section = BuilderRod {
        radius,
        nodes: paper.edges + 1,
    };
    let flat = (0..=paper.edges).map(|node| {
        let part = 1.0 - node as f64 / paper.edges as f64;
        Vector3::new(sheet.length * part, 0.0, radius)
    });
    let index = scene.rods.len();
    scene
        .rods
        .push(round_rod("sheet", flat.collect(), &material, &section));
    scene.clamps.push(Clamp {
        rod: index,
        node: paper.edges,
        holds_position: true,
        holds_frame: true,
        motion: path.motion(),
    });
    scene.loads.push(Load {
        kind: LoadKind::Gravity {
            acceleration: -GRAVITY * Vector3::z(),
        },
        schedule: Vec::new(),
    });
    scene.planes.push(Plane {
        point: Vector3::zeros(),
        normal: Vector3::z(),
        friction: Some(friction),
    });
}

fn watched(folding: &Folding, path: &GripperPath) -> Watched {
    let paper = &folding.paper;
    let sheet = folding.sheet();
    let down = (LAYERS * paper.thickness).max(DOWN * sheet.gravito_bending_length);
    let radius = 0.5 * paper.thickness;
    Watched {
        nodes: paper.edges + 1,
        length: sheet.length,
        target: folding.target(),
        down,
        weight: paper.width * paper.thickness / (PI * radius * radius),
        end: path.times.last().copied().unwrap_or(0.0),
        gravito_bending_length: sheet.gravito_bending_length,
        poses: path.times.len(),
        largest_speed: path.largest_speed(),
    }
}
