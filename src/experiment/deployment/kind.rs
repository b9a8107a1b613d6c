//! The experiment `deployment`.

use super::files::{FILES, LAID_FIGURE};
use super::gripper_path::GripperPath;
use super::keys::{Deployment, TABLES, resolve};
use super::knot_proof::determinant_of_pattern;
use super::laid_figure::laid_figure;
use super::laid_rod::{POINTS, PatternMark};
use super::monitor::{DeploymentMonitor, Watched};
use super::online::OnlineCorrection;
use super::outcome::DerivedDeployment;
use super::pegs;
use super::release::Release;
use super::strand_gripper::StrandGripper;
use super::tables::DeploymentTables;
use crate::experiment::kind::{FigureError, Kind, OwnNumbers};
use crate::experiment::prepare::round_rod;
use crate::figure::Figure;
use crate::mechanics::Vector3;
use crate::mechanics::scene::{Clamp, Load, LoadKind, NaturalShape, Plane, RodDescription, Scene};
use crate::results::FileDescription;
use crate::run::PreparedRun;
use crate::scenario::keys::{CommonTables, ExperimentKeys, OwnTable, Request, Section};
use crate::scenario::{
    BuilderRod, Contact, Experiment, Issue, KeyPath, Material, Scenario, Scheme, Step, Time,
};
use std::path::Path;

/// Acceleration of free fall, m/s².
pub const GRAVITY: f64 = 9.81;
/// Step and duration where no table says otherwise, s.
const STEP: f64 = 5e-3;
const END: f64 = 60.0;

/// A rod that a gripper lays on a table along a pattern.
pub struct DeploymentKind;

fn tables(scenario: &Scenario) -> &DeploymentTables {
    let tables = scenario.experiment.tables();
    tables.expect("the tables of this experiment")
}

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
        Some(Time::Dynamic {
            scheme: Scheme::ImplicitEuler,
            step: Step::Fixed(STEP),
            end: END,
        })
    }

    fn resolve(&self, request: &Request<'_>) -> Option<Experiment> {
        let deployment = resolve(request)?;
        let radius = deployment.rod.radius;
        let tables = DeploymentTables::new(deployment);
        Some(Experiment::new(self.name(), tables).with_radius(radius))
    }

    fn judge(&self, top: &Section<'_>, common: &CommonTables<'_>) {
        if *common.contact == Contact::None {
            top.missing("contact", "a table that a rod is laid on: [contact]");
        }
    }
}

impl Kind for DeploymentKind {
    fn template(&self) -> &'static str {
        include_str!("template.toml")
    }

    fn build(&self, scenario: &Scenario, scene: &mut Scene) -> Result<(), Issue> {
        let deployment = &tables(scenario).deployment;
        let path = gripper_path(scenario)?;
        add(scene, deployment, path, scenario.contact.friction());
        Ok(())
    }

    fn attach(&self, scenario: &Scenario, run: &mut PreparedRun) -> Result<(), Issue> {
        let deployment = &tables(scenario).deployment;
        let path = gripper_path(scenario)?;
        run.observers
            .push(Box::new(monitor(scenario, deployment, path)));
        let node = deployment.rod.edges;
        let clamps = &run.scene.clamps;
        let holds = |clamp: &Clamp| clamp.rod == 0 && clamp.node == node;
        let clamp = clamps.iter().position(holds);
        let clamp = clamp.expect("the gripper of a deployment");
        if deployment.release.is_some() {
            run.controllers
                .push(Box::new(Release::new(clamp, path.end())));
        }
        if let (Some(tying), Some(knot)) = (&path.tying, &deployment.knot) {
            let gripper = StrandGripper::new(&tying.lifts, deployment.rod.edges + 1, knot.reach);
            run.controllers.push(Box::new(gripper));
        }
        if let Some(keys) = deployment.correction {
            let lying = lying_height(scenario, deployment);
            let correction = OnlineCorrection::new(deployment, keys, path, clamp, lying);
            run.controllers.push(Box::new(correction));
        }
        Ok(())
    }

    fn derived(&self, run: &PreparedRun) -> Option<OwnNumbers> {
        let monitor = run.observer::<DeploymentMonitor>()?;
        let numbers = monitor.watched.derived;
        let mut lines = vec![(
            "pattern".to_owned(),
            format!(
                "{:.4} m, of which {:.4} m lead-in",
                numbers.pattern_length, numbers.lead_in
            ),
        )];
        let mut line = |name: &str, text: String| lines.push((name.to_owned(), text));
        if let Some(radius) = numbers.least_radius {
            line("  least radius", format!("{radius:.4} m"));
        }
        line(
            "  largest friction demand",
            format!(
                "{:.3}; above that of the table for {:.1} % of its length",
                numbers.largest_friction_demand,
                1e2 * numbers.share_above_friction
            ),
        );
        line(
            "  gripper, at most",
            format!("{:.1} cm/s", 1e2 * numbers.largest_gripper_speed),
        );
        Some(OwnNumbers::new("deployment", &numbers, lines))
    }

    fn files(&self) -> &'static [FileDescription] {
        &FILES
    }

    fn figures(&self, directory: &Path) -> Result<Vec<(&'static str, Figure)>, FigureError> {
        let figure = laid_figure(directory)?;
        Ok(figure
            .map(|figure| (LAID_FIGURE, figure))
            .into_iter()
            .collect())
    }
}

fn gripper_path(scenario: &Scenario) -> Result<&GripperPath, Issue> {
    let path = tables(scenario).path(scenario);
    path.map_err(|error| Issue::new(KeyPath::from("deployment.pattern"), error.to_string()))
}

/// Adds rod, gripper, weight and table.
fn add(scene: &mut Scene, deployment: &Deployment, path: &GripperPath, friction: f64) {
    let rod = &deployment.rod;
    let material = Material {
        youngs_modulus: rod.deployed().youngs_modulus(rod.density, GRAVITY),
        poissons_ratio: 0.5,
        density: rod.density,
    };
    let section = BuilderRod {
        radius: rod.radius,
        nodes: rod.edges + 1,
    };
    let straight = (0..=rod.edges)
        .map(|node| Vector3::x() * (rod.length * node as f64 / rod.edges as f64))
        .collect();
    let index = scene.rods.len();
    scene.rods.push(RodDescription {
        end_tangents: [None, Some(path.first_direction())],
        natural_shape: NaturalShape::Centreline(straight),
        ..round_rod("rod", path.start.clone(), &material, &section)
    });
    let standing = deployment.pegs.iter().enumerate();
    let standing = standing.map(|(number, peg)| pegs::post(&format!("peg_{}", number + 1), peg));
    scene.rods.extend(standing);
    scene.clamps.push(Clamp {
        rod: index,
        node: rod.edges,
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

/// Height below which a node lies on the table, m.
fn lying_height(scenario: &Scenario, deployment: &Deployment) -> f64 {
    let tolerance = scenario.contact.distance_tolerance().unwrap_or(0.0);
    deployment.rod.radius + 2.0 * tolerance
}

fn monitor(scenario: &Scenario, deployment: &Deployment, path: &GripperPath) -> DeploymentMonitor {
    let rod = &deployment.rod;
    let from = deployment.lead_in;
    let marks = (0..POINTS).map(|index| {
        let s = from + (path.length - from) * index as f64 / (POINTS - 1) as f64;
        let position = path.curve.at(s).position;
        PatternMark {
            s,
            position: position.into(),
        }
    });
    let marks = marks.collect();
    let asked = &path.feasibility;
    let derived = DerivedDeployment {
        pattern_length: path.length,
        lead_in: from,
        least_radius: Some(asked.least_radius_m).filter(|radius| radius.is_finite()),
        largest_friction_demand: asked.largest_demand,
        share_above_friction: asked.share_above_friction.unwrap_or(0.0),
        largest_gripper_speed: path.largest_speed(),
    };
    DeploymentMonitor::new(Watched {
        marks,
        length: rod.length,
        nodes: rod.edges + 1,
        lying_height: lying_height(scenario, deployment),
        friction: scenario.contact.friction(),
        laid: path.laid.clone(),
        outline: if deployment.pegs.is_empty() {
            Vec::new()
        } else {
            pegs::outline(&path.curve)
        },
        pegs: deployment.pegs.clone(),
        knot: path.tying.as_ref().map(|tying| {
            let whole = deployment.whole_pattern().ok()?;
            determinant_of_pattern(&whole, &tying.passages)
        }),
        derived,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::deployment::{DeploymentOutcome, TiedKnot};
    use crate::experiment::{from_text, prepare};
    use crate::run::{RunOptions, run};

    fn scenario(deployment: &str, rest: &str) -> Result<Scenario, String> {
        let text = format!(
            "experiment = \"deployment\"\n\
             [deployment]\n{deployment}\n\
             [deployment.rod]\ngravito_bending_length = 0.018\nradius = 0.0016\nlength = 0.5\n\
             [contact]\nfriction = 0.4\ndistance_tolerance = 5e-5\nslip_tolerance = 1e-5\n{rest}"
        );
        from_text("laid", &text, Path::new(""), &[])
            .map(|loaded| loaded.scenario)
            .map_err(|error| error.to_string())
    }

    fn laid(deployment: &str, end: f64) -> DeploymentOutcome {
        let time = format!("[time]\nstep = 0.005\nend = {end:?}\n[output]\nnodes = false\n");
        let prepared = prepare(&scenario(deployment, &time).unwrap()).unwrap();
        let directory = tempfile::tempdir().unwrap();
        let finished = run(&prepared, &RunOptions::new(directory.path())).unwrap();
        DeploymentOutcome::of(&finished.case).unwrap()
    }

    const ARC: &str = "pattern = { kind = \"circle\", radius = -0.05 }";

    #[test]
    fn a_rod_is_laid_around_a_circle() {
        let outcome = laid(ARC, 15.0);
        assert!(outcome.mean_error_m.unwrap() < 1e-3, "{outcome:?}");
        assert_eq!(outcome.share_above_friction, 0.0);
        // It hangs from the gripper, most of it at the start: ρ g π h² L = 0.0395 N.
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
        // A peg that stands on that side of the pattern is passed on the wrong side, one on the other side is not.
        let peg = |y: f64| {
            let line = "pattern = { kind = \"line\", length = 0.1 }\nframe_shift = [0.0, 0.03]";
            let peg =
                format!("pegs = [{{ position = [0.05, {y}], radius = 0.004, height = 0.01 }}]");
            laid(&format!("{line}\n{peg}"), 4.0).pegs.unwrap().passed
        };
        assert_eq!((peg(0.015), peg(-0.015)), (0, 1));
    }

    /// The scenario of a trefoil, with other keys.
    fn tied(overrides: &[&str]) -> TiedKnot {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let file = root.join("scenarios/tied_trefoil.toml");
        let overrides: Vec<String> = overrides.iter().map(|key| (*key).to_owned()).collect();
        let loaded = crate::experiment::load(&file, &overrides).unwrap();
        let again = from_text(
            "tied_trefoil",
            &loaded.scenario.to_toml(),
            Path::new(""),
            &[],
        );
        assert_eq!(again.unwrap().scenario, loaded.scenario);
        let prepared = prepare(&loaded.scenario).unwrap();
        let directory = tempfile::tempdir().unwrap();
        let finished = run(&prepared, &RunOptions::new(directory.path())).unwrap();
        DeploymentOutcome::of(&finished.case).unwrap().knot.unwrap()
    }

    #[test]
    fn a_trefoil_is_tied_on_the_table() {
        let knot = tied(&[]);
        assert_eq!((knot.pattern, knot.rod), (Some(3), Some(3)));
        assert!(knot.is_tied());
    }

    #[test]
    fn an_end_that_is_led_over_everything_ties_nothing() {
        let knot = tied(&["deployment.knot.crossings=[\"over\", \"over\", \"over\"]"]);
        assert_eq!((knot.pattern, knot.rod), (Some(1), Some(1)));
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
            "pattern = { kind = \"line\", length = 0.1 }\npegs = [{ position = [0.05, \"1 cm\"], radius = 0.004, height = 0.01 }]",
        ] {
            let scenario = scenario(text, "").unwrap();
            let again = from_text("laid", &scenario.to_toml(), Path::new(""), &[]).unwrap();
            assert_eq!(again.scenario, scenario, "{text}");
        }
    }

    #[test]
    fn faults_of_deployments_name_what_is_allowed() {
        let fault = |text: &str| scenario(text, "").unwrap_err();
        insta::assert_snapshot!(fault("scheme = \"optimal\""), @r#"laid.toml:2:1: `deployment`: missing key `pattern` ({ file = "drawing.svg" }, or { kind = "circle", radius = "9 cm" })"#);
        insta::assert_snapshot!(fault("pattern = { kind = \"line\", length = 0.6 }"), @"laid.toml:3:11: `deployment.pattern`: the pattern is 0.6000 m long, and the rod 0.5 m: it must be at least 0.6018 m, so that the gripper can still hold it at the end");
        insta::assert_snapshot!(fault("pattern = { kind = \"line\", length = 0.1, radius = 0.6 }"), @r#"laid.toml:3:51: `deployment.pattern.radius`: this key is for patterns of kind "circle""#);
        insta::assert_snapshot!(fault("pattern = { kind = \"circle\", radius = 0 }"), @"laid.toml:3:39: `deployment.pattern.radius`: a circle has a radius other than 0");
        insta::assert_snapshot!(fault("pattern = { file = \"nowhere.svg\" }"), @"laid.toml:3:20: `deployment.pattern.file`: nowhere.svg cannot be read: No such file or directory (os error 2)");
        insta::assert_snapshot!(fault("pattern = { file = \"laid.toml\" }"), @"laid.toml:3:20: `deployment.pattern.file`: laid.toml: an .svg or a .csv file is needed");
        insta::assert_snapshot!(fault("pattern = { points = [[0, 0], [0, 0]] }"), @"laid.toml:3:11: `deployment.pattern`: it has no length");
        insta::assert_snapshot!(fault(&format!("{ARC}\nlength_error = -1")), @"laid.toml:4:16: `deployment.length_error`: -1.0 is out of range; allowed: -0.9 to 0.9");
        insta::assert_snapshot!(fault(&format!("{ARC}\nseed = -2")), @"laid.toml:4:8: `deployment.seed`: -2 is out of range; allowed: 0 and above");
        insta::assert_snapshot!(fault(&format!("{ARC}\ncorrection = {{ every = 0.03, return_length = 0.05 }}")), @"laid.toml:4:46: `deployment.correction.return_length`: 0.05 m is too short: the rod would swing about its pattern; allowed: 3 times `every` and the gravito-bending length, 0.0900 m, and more");
        insta::assert_snapshot!(fault(&format!("{ARC}\ncorrection = {{ every = 0.001 }}")), @"laid.toml:4:24: `deployment.correction.every`: 0.001 m is less than an edge of the rod, 0.0045 m (`rod.edges`)");
        insta::assert_snapshot!(fault(&format!("{ARC}\nscheme = \"intuitive\"\ncorrection = {{}}")), @r#"laid.toml:5:14: `deployment.correction`: the intuitive scheme is not corrected: use "optimal""#);
        insta::assert_snapshot!(fault(&format!("{ARC}\nseed = {}", i64::MIN)), @"laid.toml:4:8: `deployment.seed`: -9223372036854775808 is out of range; allowed: 0 and above");
        let peg = |keys: &str| {
            fault(&format!(
                "pattern = {{ kind = \"line\", length = 0.1 }}\npegs = [{{ {keys} }}]"
            ))
        };
        insta::assert_snapshot!(peg("position = [0.05, 0.003], radius = 0.004, height = 0.01"), @"laid.toml:4:22: `deployment.pegs.0.position`: the pattern runs through this peg, 0.0030 m from its axis; allowed: 0.0056 m, the radii of peg and rod, and more");
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
        insta::assert_snapshot!(clips("at = [0.02], width = 0.003, radius = 0.004, height = 0.006"), @"laid.toml:4:32: `deployment.clips.width`: 0.003 m is too narrow; allowed: at least 0.0032 m, as thick as the rod is");
        insta::assert_snapshot!(clips("width = 0.008, radius = 0.004, height = 0.006"), @r#"laid.toml:4:9: `deployment.clips`: missing key `at` (arc lengths of the pattern, ["2 cm", "8 cm"])"#);
        insta::assert_snapshot!(fault("pattern = { kind = \"line\", length = 0.1 }\nknot = { crossings = [\"over\"] }"), @r#"laid.toml:4:22: `deployment.knot.crossings`: crossings that the pattern comes to again: 0; passes given: 1; say "over" or "under" for each, in the order in which it comes there"#);
        insta::assert_snapshot!(fault(&format!("{ARC}\nknot = {{ crossings = [\"beside\"] }}")), @r#"laid.toml:4:23: `deployment.knot.crossings.0`: "beside" is not known here; allowed: over, under"#);
        insta::assert_snapshot!(fault(&format!("{ARC}\nknot = {{ lift = 0.02 }}")), @r#"laid.toml:4:8: `deployment.knot`: missing key `crossings` ("over" or "under" for each crossing, as ["over", "under", "over"])"#);
        insta::assert_snapshot!(fault(&format!("{ARC}\nrelease = 70")), @"laid.toml:4:11: `deployment.release`: 70.0 s is out of range; allowed: less than the time in which the rod is laid, 60.0 s (`time.end`)");
        insta::assert_snapshot!(scenario(ARC, "[material]\ndensity = 1").unwrap_err(), @"laid.toml:12:1: `material`: the rod of a deployment and its material are [deployment.rod]");
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
