//! The experiment `deployment`.

use super::files::{FILES, LAID_FIGURE};
use super::hand::Hand;
use super::keys::{TABLES, resolve};
use super::laid_figure::laid_figure;
use super::monitor::DeploymentMonitor;
use super::online::OnlineCorrection;
use super::outcome::DerivedDeployment;
use super::paths::DeploymentPaths;
use super::release::Release;
use super::scene;
use super::tables::DeploymentTables;
use crate::experiment::kind::{FigureError, Figures, Kind, OwnNumbers};
use crate::experiment::on_table;
use crate::run::PreparedRun;
use crate::scenario::keys::{CommonTables, ExperimentKeys, OwnTable, Request, Section};
use crate::scenario::{Experiment, Issue, KeyPath, Scenario, Time};
use rodlab_engine::mechanics::scene::Scene;
use rodlab_files::results::FileDescription;
use std::path::Path;

/// Default duration, s.
const END: f64 = 60.0;

/// A rod that a gripper lays on a table along a pattern.
pub struct DeploymentKind;

impl ExperimentKeys for DeploymentKind {
    fn name(&self) -> &'static str {
        "deployment"
    }

    fn summary(&self) -> &'static str {
        "A rod that a gripper lays on a table along a pattern."
    }

    fn tables(&self) -> &'static [OwnTable] {
        &TABLES
    }

    fn usual_time(&self) -> Option<Time> {
        Some(on_table::usual_time(END))
    }

    fn resolve(&self, request: &Request<'_>) -> Option<Experiment> {
        let deployment = resolve(request)?;
        let radii = deployment.rods().map(|rod| rod.radius);
        let radius = radii.fold(f64::INFINITY, f64::min);
        let tables = DeploymentTables::new(deployment);
        Some(Experiment::new(self.name(), tables).with_radius(radius))
    }

    fn judge(&self, top: &Section<'_>, common: &CommonTables<'_>) {
        on_table::need_contact(top, common.contact, "a rod is laid");
    }
}

impl Kind for DeploymentKind {
    fn has_table(&self) -> bool {
        true
    }

    fn template(&self) -> &'static str {
        include_str!("template.toml")
    }

    fn build(&self, scenario: &Scenario, scene: &mut Scene) -> Result<(), Issue> {
        let paths = gripper_paths(scenario)?;
        let DeploymentTables { deployment, .. } = scenario.experiment.own();
        scene::add(scene, deployment, paths, scenario.contact.friction());
        Ok(())
    }

    fn attach(&self, scenario: &Scenario, run: &mut PreparedRun) -> Result<(), Issue> {
        let DeploymentTables { deployment, .. } = scenario.experiment.own();
        let paths = gripper_paths(scenario)?;
        let watched = scene::watched(scenario, deployment, paths);
        run.observers
            .push(Box::new(DeploymentMonitor::new(watched)));
        let clamps = scene::gripper_clamps(deployment, &run.scene);
        let all_done = deployment.release.map(|_| paths.end());
        let released = |rod: usize| {
            let tying = paths.tying.as_ref();
            tying.and_then(|tying| tying.released[rod]).or(all_done)
        };
        for (rod, &clamp) in clamps.iter().enumerate() {
            if let Some(time) = released(rod) {
                run.controllers.push(Box::new(Release::new(clamp, time)));
            }
        }
        if let (Some(tying), Some(knot)) = (&paths.tying, &deployment.knot) {
            let nodes = scene::nodes(deployment);
            for (number, holds) in tying.holds.iter().enumerate() {
                if !holds.is_empty() {
                    let hand = Hand::new(number, holds, &nodes, knot.reach);
                    run.controllers.push(Box::new(hand));
                }
            }
        }
        if let Some(keys) = deployment.correction {
            let lying = scene::lying_height(scenario, &deployment.rod);
            let path = &paths.rods[0];
            let correction = OnlineCorrection::new(deployment, keys, path, clamps[0], lying);
            run.controllers.push(Box::new(correction));
        }
        Ok(())
    }

    fn derived(&self, run: &PreparedRun) -> Option<OwnNumbers> {
        let monitor = run.observer::<DeploymentMonitor>()?;
        let rods = &monitor.watched.rods;
        let all = DerivedDeployment::of_all(rods.iter().map(|rod| rod.derived));
        let mut lines = Vec::new();
        for (number, rod) in rods.iter().enumerate() {
            let name = ["pattern", "second pattern"][number.min(1)];
            lines.extend(described(name, &rod.derived));
        }
        Some(OwnNumbers::new("deployment", &all, lines))
    }

    fn files(&self) -> &'static [FileDescription] {
        &FILES
    }

    fn figures(&self, directory: &Path) -> Result<Figures, FigureError> {
        let figure = laid_figure(directory)?;
        Ok(Vec::from_iter(figure.map(|figure| (LAID_FIGURE, figure))))
    }
}

fn gripper_paths(scenario: &Scenario) -> Result<&DeploymentPaths, Issue> {
    let tables: &DeploymentTables = scenario.experiment.own();
    let paths = tables.paths(scenario);
    paths.map_err(|error| Issue::new(KeyPath::from("deployment.pattern"), error.to_string()))
}

/// The numbers of a rod as text.
fn described<'a>(pattern: &'a str, numbers: &DerivedDeployment) -> Vec<(&'a str, String)> {
    let (length, lead_in) = (numbers.pattern_length, numbers.lead_in);
    let mut lines = vec![(
        pattern,
        format!("{length:.4} m, of which {lead_in:.4} m lead-in"),
    )];
    let radius = numbers.least_radius;
    lines.extend(radius.map(|radius| ("  least radius", format!("{radius:.4} m"))));
    let demand = format!(
        "{:.3}; above that of the table for {:.1} % of its length",
        numbers.largest_friction_demand,
        1e2 * numbers.share_above_friction
    );
    let speed = format!("{:.1} cm/s", 1e2 * numbers.largest_gripper_speed);
    lines.extend([
        ("  largest friction demand", demand),
        ("  gripper speed, up to", speed),
    ]);
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::deployment::DeploymentOutcome;
    use crate::experiment::prepare;
    use crate::test_support::{assert_reads_back, loaded, ran};

    fn scenario(deployment: &str, rest: &str) -> Result<Scenario, String> {
        let text = format!(
            "experiment = \"deployment\"\n\
             [deployment]\n{deployment}\n\
             [deployment.rod]\ngravito_bending_length = 0.018\nradius = 0.0016\nlength = 0.5\n\
             [contact]\nfriction = 0.4\ndistance_tolerance = 5e-5\nslip_tolerance = 1e-5\n{rest}"
        );
        loaded("laid", &text).map(|loaded| loaded.scenario)
    }

    fn laid(deployment: &str, end: f64) -> DeploymentOutcome {
        let time = format!("[time]\nstep = 0.005\nend = {end:?}\n[output]\nnodes = false\n");
        let prepared = prepare(&scenario(deployment, &time).unwrap()).unwrap();
        let (finished, _) = ran(&prepared).unwrap();
        DeploymentOutcome::of(&finished.case).unwrap()
    }

    const ARC: &str = "pattern = { kind = \"circle\", radius = -0.05 }";

    #[test]
    fn a_rod_is_laid_around_a_circle() {
        let outcome = laid(ARC, 15.0);
        assert!(outcome.mean_error_m.unwrap() < 1e-3, "{outcome:?}");
        assert_eq!(outcome.share_above_friction, 0.0);
        // The rod hangs from the gripper, most of it at the start: ρ g π h² L = 0.0395 N.
        let force = outcome.largest_gripper_force_n;
        assert!((0.037..0.045).contains(&force), "{force}");
    }

    #[test]
    fn a_line_is_laid_straight() {
        let optimal = laid("pattern = { kind = \"line\", length = 0.2 }", 8.0);
        assert!(optimal.mean_error_m.unwrap() < 3e-4, "{optimal:?}");
    }

    #[test]
    fn the_intuitive_scheme_misses_a_circle() {
        let intuitive = laid(&format!("{ARC}\nscheme = \"intuitive\""), 15.0);
        assert!(intuitive.mean_error_m.unwrap() > 5e-3, "{intuitive:?}");
    }

    #[test]
    fn an_error_of_the_frame_is_an_error_of_the_laid_rod() {
        let line = "pattern = { kind = \"line\", length = 0.1 }\nframe_shift = [0.0, 0.01]";
        let outcome = laid(line, 4.0);
        assert!(
            (outcome.mean_error_m.unwrap() - 0.01).abs() < 1e-4,
            "{outcome:?}"
        );
        assert!(outcome.error_deviation_m.unwrap() < 1e-4);
    }

    const CLIPS: &str = "pattern = { kind = \"line\", length = 0.1 }\nrelease = 1\n\
        clips = { at = [0.02, 0.05, 0.08], width = 0.008, radius = 0.004, height = 0.006 }";

    #[test]
    fn a_rod_is_laid_into_clips_and_stays_there_when_the_gripper_lets_go() {
        let outcome = laid(CLIPS, 5.0);
        let pegs = outcome.pegs.unwrap();
        assert_eq!((pegs.count, pegs.passed), (6, 6), "{outcome:?}");
        assert!(pegs.are_all());
    }

    #[test]
    fn a_rod_that_is_laid_beside_its_clips_passes_half_of_their_pegs_on_the_wrong_side() {
        let outcome = laid(&format!("{CLIPS}\nframe_shift = [0.0, 0.03]"), 5.0);
        let pegs = outcome.pegs.unwrap();
        assert_eq!((pegs.count, pegs.passed), (6, 3), "{outcome:?}");
        // A peg on that side of the pattern is passed on the wrong side, one on the other side is
        // not.
        let peg = |y: f64| {
            let line = "pattern = { kind = \"line\", length = 0.1 }\nframe_shift = [0.0, 0.03]";
            let peg =
                format!("pegs = [{{ position = [0.05, {y}], radius = 0.004, height = 0.01 }}]");
            laid(&format!("{line}\n{peg}"), 4.0).pegs.unwrap().passed
        };
        assert_eq!((peg(0.015), peg(-0.015)), (0, 1));
    }

    const SECOND: &str = "pattern = { kind = \"line\", length = 0.1 }\n\
        second = { pattern = { points = [[0.05, -0.1], [0.05, 0], [0.05, 0.1]] }, \
        rod = { gravito_bending_length = 0.018, radius = 0.001, length = 0.4 } }";

    #[test]
    fn a_second_rod_is_laid_over_the_first() {
        let outcome = laid(SECOND, 16.0);
        // The free end of the second rod slips by about a gravito-bending length when it is
        // lowered; the first rod lies as if it were alone.
        assert!(
            outcome.largest_error_m.unwrap() < 1.5 * 0.018,
            "{outcome:?}"
        );
        assert_eq!((outcome.pegs, outcome.knot), (None, None));
        // The first rod is heavier: ρ g π h² L = 0.0395 N.
        let force = outcome.largest_gripper_force_n;
        assert!((0.037..0.045).contains(&force), "{force}");
    }

    #[test]
    fn correction_makes_up_for_a_wrong_gravito_bending_length() {
        let wrong = format!("{ARC}\nlength_error = 0.1");
        let [open, corrected] = ["", "\ncorrection = {}"]
            .map(|keys| laid(&format!("{wrong}{keys}"), 40.0).mean_error_m.unwrap());
        assert!(corrected < 0.7 * open, "{corrected} {open}");
    }

    #[test]
    fn deployments_read_back_to_themselves() {
        for text in [
            ARC,
            "pattern = { kind = \"sine\", amplitude = 0.01, wavelength = \"20 cm\", waves = 1 }\nlead_in = 0.02",
            "pattern = { points = [[0, 0], [0.1, 0.01], [0.2, 0.01]], size = 0.15, reverse = true }\njitter = \"1 mm\"\nseed = 3",
            "pattern = { kind = \"line\", length = 0.1 }\nscheme = \"intuitive\"\nframe_turn = \"3 deg\"",
            "pattern = { kind = \"line\", length = 0.1 }\ncorrection = { every = \"3 cm\", noise = \"0.5 mm\" }",
            CLIPS,
            SECOND,
            "pattern = { kind = \"line\", length = 0.1 }\npegs = [{ position = [0.05, \"1 cm\"], radius = 0.004, height = 0.01 }]",
        ] {
            let scenario = scenario(text, "").unwrap();
            assert_reads_back("laid", &scenario);
        }
    }

    #[test]
    fn faults_of_deployments_name_what_is_allowed() {
        let fault = |text: &str| scenario(text, "").unwrap_err();
        insta::assert_snapshot!(fault("scheme = \"optimal\""), @r#"laid.toml:2:1: `deployment`: missing key `pattern` ({ file = "drawing.svg" }, or { kind = "circle", radius = "9 cm" })"#);
        insta::assert_snapshot!(fault("pattern = { kind = \"line\", length = 0.6 }"), @"laid.toml:3:11: `deployment.pattern`: the pattern is 0.6000 m long, and the rod 0.5 m: the rod must be at least 0.6018 m long, so that the gripper can still hold it at the end");
        insta::assert_snapshot!(fault("pattern = { kind = \"line\", length = 0.1, radius = 0.6 }"), @r#"laid.toml:3:51: `deployment.pattern.radius`: this key is for patterns of kind "circle""#);
        insta::assert_snapshot!(fault("pattern = { kind = \"circle\", radius = 0 }"), @"laid.toml:3:39: `deployment.pattern.radius`: a circle has a radius other than 0");
        insta::assert_snapshot!(fault("pattern = { file = \"nowhere.svg\" }"), @"laid.toml:3:20: `deployment.pattern.file`: nowhere.svg cannot be read: No such file or directory (os error 2)");
        insta::assert_snapshot!(fault("pattern = { file = \"laid.toml\" }"), @"laid.toml:3:20: `deployment.pattern.file`: laid.toml: an .svg or a .csv file is needed");
        insta::assert_snapshot!(fault("pattern = { points = [[0, 0], [0, 0]] }"), @"laid.toml:3:11: `deployment.pattern`: it has no length");
        insta::assert_snapshot!(fault(&format!("{ARC}\nlength_error = -1")), @"laid.toml:4:16: `deployment.length_error`: -1.0 is out of range; allowed: -0.9 to 0.9");
        insta::assert_snapshot!(fault(&format!("{ARC}\nseed = -2")), @"laid.toml:4:8: `deployment.seed`: -2 is out of range; allowed: 0 and above");
        insta::assert_snapshot!(fault(&format!("{ARC}\ncorrection = {{ every = 0.03, return_length = 0.05 }}")), @"laid.toml:4:46: `deployment.correction.return_length`: 0.05 m is too short, so that the rod would swing about its pattern; allowed: at least 0.0900 m, which is 3 times the larger of `every` and the gravito-bending length");
        insta::assert_snapshot!(fault(&format!("{ARC}\ncorrection = {{ every = 0.001 }}")), @"laid.toml:4:24: `deployment.correction.every`: 0.001 m is less than an edge of the rod, 0.0045 m (`rod.edges`)");
        insta::assert_snapshot!(fault(&format!("{ARC}\nscheme = \"intuitive\"\ncorrection = {{}}")), @r#"laid.toml:5:14: `deployment.correction`: the intuitive scheme cannot be corrected; use "optimal""#);
        insta::assert_snapshot!(fault(&format!("{ARC}\nseed = {}", i64::MIN)), @"laid.toml:4:8: `deployment.seed`: -9223372036854775808 is out of range; allowed: 0 and above");
        let peg = |keys: &str| {
            fault(&format!(
                "pattern = {{ kind = \"line\", length = 0.1 }}\npegs = [{{ {keys} }}]"
            ))
        };
        insta::assert_snapshot!(peg("position = [0.05, 0.003], radius = 0.004, height = 0.01"), @"laid.toml:4:22: `deployment.pegs.0.position`: the pattern runs through this peg, 0.0030 m from its axis; allowed: at least 0.0056 m, the radii of peg and rod");
        insta::assert_snapshot!(peg("position = [0.05, 0.03], radius = 0.004, height = 0.004"), @"laid.toml:4:61: `deployment.pegs.0.height`: 0.004 m is out of range; allowed: more than the radius of its round top, 0.004 m");
        insta::assert_snapshot!(peg("radius = 0.004, height = 0.005"), @"laid.toml:4:9: `deployment.pegs.0`: missing key `position` (two lengths [x, y])");
        insta::assert_snapshot!(peg("position = [0, 1], radius = -0.004, heigth = 0.005"), @"laid.toml:4:47: `deployment.pegs.0.heigth`: unknown key (did you mean `height`?)");
        let clips = |keys: &str| {
            fault(&format!(
                "pattern = {{ kind = \"line\", length = 0.1 }}\nclips = {{ {keys} }}"
            ))
        };
        insta::assert_snapshot!(clips("at = [0.02, 0.12], width = 0.008, radius = 0.004, height = 0.006"), @"laid.toml:4:23: `deployment.clips.at.1`: 0.12 m is out of range; allowed: 0 to 0.1000 m, the length of the pattern");
        insta::assert_snapshot!(clips("at = [0.02, -0.01], width = 0.008, radius = 0.004, height = 0.006"), @"laid.toml:4:23: `deployment.clips.at.1`: -0.01 is out of range; allowed: at least 0");
        insta::assert_snapshot!(clips("at = [0.02], width = 0.003, radius = 0.004, height = 0.006"), @"laid.toml:4:32: `deployment.clips.width`: 0.003 m is too narrow; allowed: at least 0.0032 m, the thickness of the rod");
        insta::assert_snapshot!(clips("width = 0.008, radius = 0.004, height = 0.006"), @r#"laid.toml:4:9: `deployment.clips`: missing key `at` (arc lengths of the pattern, ["2 cm", "8 cm"])"#);
        insta::assert_snapshot!(fault("pattern = { kind = \"line\", length = 0.1 }\nknot = { crossings = [\"over\"] }"), @r#"laid.toml:4:22: `deployment.knot.crossings`: crossings of the pattern: 0; passes given: 1; give "over" or "under" for each crossing, in the order of the second passes"#);
        insta::assert_snapshot!(fault(&format!("{ARC}\nknot = {{ crossings = [\"beside\"] }}")), @r#"laid.toml:4:23: `deployment.knot.crossings.0`: "beside" is not a valid value; allowed: over, under"#);
        insta::assert_snapshot!(fault(&format!("{ARC}\nknot = {{ lift = 0.02 }}")), @r#"laid.toml:4:8: `deployment.knot`: missing key `crossings` ("over" or "under" for each crossing, as ["over", "under", "over"])"#);
        let second = |keys: &str| {
            fault(&format!(
                "pattern = {{ kind = \"line\", length = 0.1 }}\nsecond = {{ {keys} }}"
            ))
        };
        let rod = "rod = { gravito_bending_length = 0.018, radius = 0.001, length = 0.4 }";
        insta::assert_snapshot!(second(rod), @r#"laid.toml:4:10: `deployment.second`: missing key `pattern` ({ file = "drawing.svg", stroke = 2 }, in the frame of the first)"#);
        insta::assert_snapshot!(second("pattern = { kind = \"line\", length = 0.1 }"), @r#"laid.toml:4:10: `deployment.second`: missing key `rod` (a table [deployment.second.rod] with the keys of [deployment.rod])"#);
        insta::assert_snapshot!(second(&format!("pattern = {{ kind = \"line\", length = 0.5 }}, {rod}")), @r#"laid.toml:4:22: `deployment.second.pattern`: the pattern is 0.5000 m long, and the rod 0.4 m: the rod must be at least 0.5018 m long, so that the gripper can still hold it at the end"#);
        insta::assert_snapshot!(second(&format!("pattern = {{ kind = \"line\", length = 0.1 }}, seed = 3, {rod}")), @r#"laid.toml:4:55: `deployment.second.seed`: unknown key (its keys are: pattern, rod, scheme, lead_in)"#);
        insta::assert_snapshot!(fault(&format!("{SECOND}\nknot = {{ crossings = [\"over\", \"over\"] }}")), @r#"laid.toml:5:22: `deployment.knot.crossings`: crossings of the rods: 1; passes given: 2; give "over" or "under" for each crossing, in the order of the second passes: first the second rod as it is laid, then its end, then the end of the first rod"#);
        insta::assert_snapshot!(fault(&format!("{SECOND}\nknot = {{ crossings = [\"over\"] }}")), @r#"laid.toml:5:22: `deployment.knot.crossings`: neither pattern is longer than its rod, so no end is led under the other rod and no knot is tied; extend a pattern beyond the length of its rod"#);
        insta::assert_snapshot!(fault(&format!("{SECOND}\ncorrection = {{}}")), @r#"laid.toml:5:14: `deployment.correction`: this key is for one rod: leave it, or `second`, out"#);
        insta::assert_snapshot!(fault(&format!("{ARC}\nrelease = 70")), @"laid.toml:4:11: `deployment.release`: 70.0 s is out of range; allowed: less than the time in which the rod is laid, 60.0 s (`time.end`)");
        insta::assert_snapshot!(scenario(ARC, "[material]\ndensity = 1").unwrap_err(), @"laid.toml:12:1: `material`: [deployment.rod] defines the rod of a deployment and its material");
    }

    #[test]
    fn a_pattern_too_sharp_for_the_rod_is_refused_before_the_run() {
        let scenario = scenario(
            "pattern = { kind = \"circle\", radius = 0.001 }\nlead_in = 0",
            "",
        )
        .unwrap();
        let issues = prepare(&scenario).unwrap_err();
        assert!(
            issues.0[0].message.contains("less than the rod's"),
            "{issues:?}"
        );
    }
}
