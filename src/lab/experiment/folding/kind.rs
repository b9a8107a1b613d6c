//! The experiment `folding`.

use super::feedback::VisualFeedback;
use super::files::{FILES, FOLDED_FIGURE};
use super::folded_figure::folded_figure;
use super::gripper_path::GripperPath;
use super::keys::{Folding, TABLES, resolve};
use super::monitor::{FoldingMonitor, Watched};
use super::tables::FoldingTables;
use crate::experiment::kind::{FigureError, Figures, Kind, OwnNumbers};
use crate::experiment::on_table;
use crate::experiment::prepare::round_rod;
use crate::run::PreparedRun;
use crate::scenario::keys::{CommonTables, ExperimentKeys, OwnTable, Request, Section};
use crate::scenario::{BuilderRod, Experiment, Issue, KeyPath, Scenario, Time};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::scene::{Clamp, Scene};
use rodlab_files::results::FileDescription;
use rodlab_planning::plan::deployment::DeployedRod;
use serde::Serialize;
use std::f64::consts::PI;
use std::path::Path;

/// Default duration, s.
const END: f64 = 15.0;
/// The edge is down if its height is less than this number of layers, and less than this fraction
/// of L_gb.
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
        Some(on_table::usual_time(END))
    }

    fn resolve(&self, request: &Request<'_>) -> Option<Experiment> {
        let folding = resolve(request)?;
        let radius = 0.5 * folding.paper.thickness;
        let tables = FoldingTables::new(folding);
        Some(Experiment::new(self.name(), tables).with_radius(radius))
    }

    fn judge(&self, top: &Section<'_>, common: &CommonTables<'_>) {
        on_table::need_contact(top, common.contact, "a sheet is folded");
    }
}

impl Kind for FoldingKind {
    fn has_table(&self) -> bool {
        true
    }

    fn template(&self) -> &'static str {
        include_str!("template.toml")
    }

    fn build(&self, scenario: &Scenario, scene: &mut Scene) -> Result<(), Issue> {
        let FoldingTables { folding, .. } = scenario.experiment.own();
        let path = gripper_path(scenario)?;
        add(scene, folding, path, scenario.contact.friction());
        Ok(())
    }

    fn attach(&self, scenario: &Scenario, run: &mut PreparedRun) -> Result<(), Issue> {
        let FoldingTables { folding, .. } = scenario.experiment.own();
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
        let sheet = format!(
            "{:.4} m = {:.3} L_gb; its edge moves by {:.4} m",
            watched.length,
            watched.length / watched.gravito_bending_length,
            watched.target
        );
        let speed = format!("{:.1} cm/s", 1e2 * watched.largest_speed);
        let lines = [("sheet", sheet), ("  gripper speed, up to", speed)];
        Some(OwnNumbers::new("folding", &numbers, lines))
    }

    fn files(&self) -> &'static [FileDescription] {
        &FILES
    }

    fn figures(&self, directory: &Path) -> Result<Figures, FigureError> {
        let figure = folded_figure(directory)?;
        Ok(Vec::from_iter(figure.map(|figure| (FOLDED_FIGURE, figure))))
    }
}

fn gripper_path(scenario: &Scenario) -> Result<&GripperPath, Issue> {
    let tables: &FoldingTables = scenario.experiment.own();
    let path = tables.path(scenario);
    path.map_err(|error| Issue::new(KeyPath::from("folding.crease"), error.to_string()))
}

/// Adds sheet, gripper, weight and table. A strip of the sheet is represented by a round rod as
/// thick as the sheet. The rod's modulus gives it the same L_gb, so that both bend alike in the
/// plane of the fold.
fn add(scene: &mut Scene, folding: &Folding, path: &GripperPath, friction: f64) {
    let sheet = folding.sheet();
    let paper = &folding.paper;
    let radius = 0.5 * paper.thickness;
    let strip = DeployedRod {
        gravito_bending_length: sheet.gravito_bending_length,
        radius,
        length: sheet.length,
    };
    let material = on_table::material(&strip, paper.density);
    let section = BuilderRod {
        radius,
        nodes: paper.edges + 1,
    };
    let flat = (0..=paper.edges).map(|node| {
        let part = 1.0 - node as f64 / paper.edges as f64;
        Vector3::new(sheet.length * part, 0.0, path.height)
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
    on_table::add_table(scene, friction);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::{FoldingOutcome, prepare};
    use crate::test_support::{assert_reads_back, loaded, ran};
    use rodlab_planning::plan::fold::{FoldAtlas, ForceManifold, Objective, fold_path, sliding};

    const A4: &str =
        "length = \"297 mm\"\nwidth = \"210 mm\"\ngravito_bending_length = \"4.8 cm\"\n";

    fn scenario(folding: &str, paper: &str, rest: &str) -> Result<Scenario, String> {
        let text = format!(
            "experiment = \"folding\"\n[folding]\n{folding}\n[folding.paper]\n{paper}\n\
             [contact]\nfriction = 0.12\ndistance_tolerance = 2e-5\nslip_tolerance = 2e-5\n{rest}"
        );
        loaded("fold", &text).map(|loaded| loaded.scenario)
    }

    fn folded(folding: &str) -> FoldingOutcome {
        let paper = format!("{A4}edges = 80");
        let time = "[time]\nstep = 0.01\nend = 12.0\n[output]\ninterval = 1.0\nnodes = false\n";
        let prepared = prepare(&scenario(folding, &paper, time).unwrap()).unwrap();
        let (finished, _) = ran(&prepared).unwrap();
        FoldingOutcome::of(&finished.case).unwrap()
    }

    #[test]
    fn a_sheet_that_is_held_by_a_moment_does_not_slide() {
        let outcome = folded("algorithm = \"held\"");
        assert!(outcome.largest_sliding_m < 3e-4, "{outcome:?}");
        assert!(
            outcome.fold_length_error_m.unwrap().abs() < 3e-4,
            "{outcome:?}"
        );
        // The gripper carries a part of a sheet of 210 mm × 297 mm and 80 g/m², 0.049 N, and bends
        // the sheet down.
        assert!(
            (0.01..0.1).contains(&outcome.largest_gripper_force_n),
            "{outcome:?}"
        );
    }

    /// The equilibrium of the suspended sheet, without inertia, gives 7.3 mm.
    #[test]
    fn without_a_moment_the_sheet_slides_as_its_equilibrium_predicts() {
        let length = 0.297 / 0.048;
        let atlas = FoldAtlas::new();
        let manifold = ForceManifold::new(&atlas, ForceManifold::SPACING, length);
        let sheet = rodlab_planning::plan::fold::Sheet {
            length,
            least_suspended: 0.958,
        };
        let path = fold_path(&atlas, &manifold, &sheet, length, Objective::Sum).unwrap();
        let slid = sliding(&path.folds, length, 0.12).unwrap();
        let expected = 0.048 * slid.last().unwrap();
        let outcome = folded("");
        assert!(
            (outcome.final_sliding_m - expected).abs() < 0.05 * expected,
            "{outcome:?} {expected}"
        );
        // It is pushed away all the time.
        let most = outcome.largest_sliding_m;
        assert!(
            (most / outcome.final_sliding_m - 1.0).abs() < 0.01,
            "{outcome:?}"
        );
        assert!((outcome.fold_length_error_m.unwrap() + outcome.final_sliding_m).abs() < 1e-4);
    }

    #[test]
    fn feedback_folds_a_sheet_that_has_slid_where_it_should() {
        let outcome = folded("feedback = { parts = 5 }");
        assert!(outcome.largest_sliding_m > 5e-3, "{outcome:?}");
        assert!(
            outcome.fold_length_error_m.unwrap().abs() < 3e-4,
            "{outcome:?}"
        );
    }

    #[test]
    fn folds_read_back_to_themselves() {
        for (folding, paper) in [
            ("", A4),
            (
                "crease = \"25 cm\"\nalgorithm = \"circle\"\njitter = \"1 mm\"\nseed = 3",
                A4,
            ),
            ("feedback = { noise = \"0.5 mm\" }\nlength_error = -0.1", A4),
            (
                "crease = \"diagonal-strip\"\nalgorithm = \"least-friction\"",
                "length = 0.2\nwidth = 0.2\nyoungs_modulus = \"2 GPa\"\nthickness = \"0.1 mm\"\ndensity = 800\nedges = 90",
            ),
        ] {
            let scenario = scenario(folding, paper, "").unwrap();
            assert_reads_back("fold", &scenario);
        }
    }

    #[test]
    fn faults_of_folds_name_what_is_allowed() {
        let fault = |folding: &str, paper: &str| scenario(folding, paper, "").unwrap_err();
        insta::assert_snapshot!(fault("crease = \"30 cm\"", A4), @"fold.toml:3:10: `folding.crease`: 0.3 m: the sheet is 0.297 m long, and its edge cannot go beyond the opposite one");
        assert!(fault("crease = \"diagonal\"", A4).contains("is a triangle"));
        insta::assert_snapshot!(fault("crease = \"diagonal-strip\"", A4), @"fold.toml:3:10: `folding.crease`: the sheet is 0.297 m by 0.21 m; only a square sheet is folded along its diagonal");
        insta::assert_snapshot!(fault("algorithm = \"best\"", A4), @r#"fold.toml:3:13: `folding.algorithm`: "best" is not a valid value; allowed: optimal, least-friction, held, circle, step-by-step"#);
        insta::assert_snapshot!(fault("algorithm = \"circle\"\nfeedback = {}", A4), @r#"fold.toml:4:12: `folding.feedback`: this algorithm cannot replan; use "optimal", "least-friction" or "held""#);
        insta::assert_snapshot!(fault("feedback = { parts = 1 }", A4), @"fold.toml:3:22: `folding.feedback.parts`: 1 is out of range; allowed: 2 to 1000");
        insta::assert_snapshot!(fault("length_error = 2", A4), @"fold.toml:3:16: `folding.length_error`: 2.0 is out of range; allowed: -0.9 to 0.9");
        insta::assert_snapshot!(fault("seed = -2", A4), @"fold.toml:3:8: `folding.seed`: -2 is out of range; allowed: 0 and above");
        insta::assert_snapshot!(fault("", "length = 0.3\nwidth = 0.2"), @"fold.toml:4:1: `folding.paper`: missing key `gravito_bending_length` (a length; or `youngs_modulus`, `thickness` and `density`)");
        insta::assert_snapshot!(fault("", "length = 0.3\nwidth = 0.2\ngravito_bending_length = 0"), @"fold.toml:7:26: `folding.paper.gravito_bending_length`: 0.0 is out of range; allowed: greater than 0");
        insta::assert_snapshot!(fault("", "length = 0.3\nwidth = 0.2\nyoungs_modulus = 1e9"), @r#"
        fold.toml:4:1: `folding.paper`: missing key `thickness` (a length, greater than 0)
        fold.toml:4:1: `folding.paper`: missing key `density` (a density, greater than 0)
        "#);
        insta::assert_snapshot!(fault("", &format!("{A4}youngs_modulus = 1e9")), @"fold.toml:8:18: `folding.paper.youngs_modulus`: give `gravito_bending_length` or `youngs_modulus`, not both");
        insta::assert_snapshot!(scenario("", A4, "[material]\ndensity = 1").unwrap_err(), @"fold.toml:13:1: `material`: [folding.paper] defines the sheet of a fold and its material");
    }

    #[test]
    fn a_target_out_of_reach_is_refused_before_the_run() {
        let refused = |folding: &str| {
            let scenario = scenario(folding, A4, "").unwrap();
            prepare(&scenario).unwrap_err().0[0].message.clone()
        };
        assert!(refused("crease = \"1 cm\"").contains("targets from"));
        assert!(refused("crease = \"12 cm\"\nalgorithm = \"held\"").contains("a fold this tight"));
    }
}
