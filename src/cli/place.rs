//! `rodlab place`: a cable laid between pegs.

use super::deployment_files::{path_files, trajectory_csv};
use super::laying::{Laying, LayingArguments};
use super::prelude::*;
use rodlab_files::results::{SCENARIO, write_whole};
use rodlab_lab::experiment::{self, Deployment, DeploymentTables, Fixtures};
use rodlab_planning::plan::deployment::{LaidPath, Spare, friction_demands, timed, times};
use rodlab_planning::plan::pattern::crossings;
use rodlab_planning::plan::request::DeploymentRequest;

/// Arguments of `rodlab place`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rodlab place scenarios/cable_placement_u.toml --dry-run
  rodlab place scenarios/cable_placement_u.toml
  rodlab place scenarios/cable_placement_s.toml --set deployment.scheme=intuitive --place 0.1,0,0,90

The scenario is one of the experiment \"deployment\" with [deployment.clips] or [[deployment.pegs]]: its rod is the cable, its
pattern the way between the pegs, and `rodlab run` simulates the same. Pegs are fixed to the table where --place puts the frame of
the pattern. The arm lays the cable and lets it go; the camera looks, and pegs count as passed where the cable leaves them on the
side on which the pattern does and does not lie on them. Everything is in one directory, as of `rodlab deploy`; pegs.svg shows
the cable between its pegs. `rodlab cell serve --scene SCENARIO` is a cell to try it with.")]
pub struct PlaceArguments {
    /// The scenario
    scenario: PathBuf,
    /// Set a key of the scenario, such as deployment.scheme=intuitive; may be given several times
    #[arg(long = "set", value_name = "KEY=VALUE")]
    overrides: Vec<String>,
    #[command(flatten)]
    laying: LayingArguments,
}

/// Lays a cable between pegs.
pub fn place(arguments: &PlaceArguments) -> Result<(), Failure> {
    let scene = Scene::read(&arguments.scenario, &arguments.overrides)?;
    let outline = scene.fixtures.outline();
    let file = arguments.scenario.display().to_string();
    let what = Laying {
        task: "place",
        pattern: &file,
        outline: &outline,
        fixtures: Some(&scene.fixtures),
        is_corrected: false,
    };
    arguments.laying.lay(&what, |spare, directory| {
        let path = scene.path(spare)?;
        scene.write(&path, directory)?;
        Ok((scene.deployment.rod.deployed(), path))
    })
}

/// A cable and its pegs, by a scenario.
pub struct Scene {
    title: String,
    /// The scenario as it was resolved.
    text: String,
    /// The cable and its pattern.
    pub deployment: Deployment,
    /// Friction of the table.
    pub friction: f64,
    /// The pegs.
    pub fixtures: Fixtures,
}

impl Scene {
    /// Reads a scenario.
    pub fn read(path: &Path, overrides: &[String]) -> Result<Self, Failure> {
        let loaded = experiment::load(path, overrides)?;
        let scenario = &loaded.scenario;
        let refused = |what: &str| Failure::Input(format!("{}: {what}", path.display()));
        let tables: Option<&DeploymentTables> = scenario.experiment.tables();
        let tables = tables.ok_or_else(|| {
            refused("a scenario of the experiment \"deployment\" is needed, with pegs or clips")
        })?;
        let deployment = tables.deployment.clone();
        if deployment.pegs.is_empty() {
            return Err(refused(
                "it has neither [deployment.clips] nor [[deployment.pegs]]; `rodlab deploy` lays a rod without",
            ));
        }
        if deployment.knot.is_some() || deployment.second.is_some() {
            return Err(refused(
                "one rod is placed, without a knot: leave out [deployment.knot] and [deployment.second]",
            ));
        }
        let fixtures = Fixtures::of(&deployment).map_err(|error| refused(&error.to_string()))?;
        Ok(Self {
            title: scenario.title.clone(),
            text: scenario.to_toml(),
            friction: scenario.contact.friction(),
            deployment,
            fixtures,
        })
    }

    /// The path of the gripper where there is room for what is longer than the pattern.
    fn path(&self, spare: &Spare<'_>) -> Result<LaidPath, Failure> {
        let Deployment {
            rod,
            scheme,
            solver,
            ..
        } = &self.deployment;
        let refused =
            |error: &dyn std::fmt::Display| Failure::Input(format!("{}: {error}", self.title));
        let pattern = self.deployment.whole_pattern();
        let pattern = pattern.map_err(|error| refused(&error))?;
        let step = DeploymentRequest::default().step;
        let way = ((*scheme).into(), (*solver).into());
        let path = LaidPath::new(pattern, &rod.deployed(), spare, step, way);
        path.map_err(|error| refused(&error))
    }

    /// Writes the plan for people and programs.
    fn write(&self, path: &LaidPath, directory: &Path) -> Result<(), Failure> {
        make_directory(directory)?;
        let demands = friction_demands(&self.deployment.rod.deployed(), &path.points, &path.poses);
        let crossings = crossings(&path.points);
        let friction = Some(self.friction);
        let [pattern, figure] = path_files(&self.title, path, &demands, &crossings, friction);
        let times = times(&path.poses, DeploymentRequest::default().speed);
        let trajectory = trajectory_csv(&timed(&path.poses, &times))?;
        let files = [
            (SCENARIO.to_owned(), self.text.clone()),
            ("trajectory.csv".to_owned(), trajectory),
            pattern,
            figure,
        ];
        for (name, text) in files {
            write_whole(&directory.join(name), text.as_bytes())?;
        }
        Ok(())
    }
}
