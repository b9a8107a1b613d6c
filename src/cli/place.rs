//! `rodlab place`: a cable laid between pegs.

use super::candidates::keys;
use super::laying::{Laying, LayingArguments};
use super::prelude::*;
use rodlab_files::results::write_whole;
use rodlab_lab::experiment::{Placement, PlacementError};
use rodlab_workcell::task::{DeployTask, Planning, TaskCommand, Way};
use rodlab_workcell::virtual_cell::RodSupply;

const HELP: [&str; 2] = help!(
    "\
Examples:
  rodlab place cable_placement_u                     in a virtual cell
  rodlab place cable_placement_u --cell gantry --dry-run
  rodlab place cable_placement_s --cell cell.toml --set deployment.scheme=intuitive
  rodlab place cable_placement_s --cell cell.toml --place 0.1,0,0,90",
    "\
The scenario is of the experiment \"deployment\", with [deployment.clips] or [[deployment.pegs]]:
its rod is the cable, its pattern the path between the pegs, and `rodlab run` simulates the same
task. Pegs are fixed to the table where --place puts the frame of the pattern. The arm lays the
cable and releases it; the camera takes a picture. A peg counts as passed if the cable leaves it on
the same side as the pattern and does not lie on it. All results are in one directory, as with
`rodlab deploy`; pegs.svg shows the cable between its pegs. `rodlab cell serve --scene SCENARIO`
starts a cell for trying --cell."
);

/// Arguments of `rodlab place`.
#[derive(Debug, Args)]
#[command(after_help = HELP[0], after_long_help = HELP[1])]
pub struct PlaceArguments {
    /// The scenario
    #[arg(value_parser = file_or_preset(PresetKind::Scenario), add = presets(PresetKind::Scenario))]
    scenario: PathBuf,
    /// Set a key of the scenario, such as deployment.scheme=intuitive; repeatable
    #[arg(long = "set", value_name = "KEY=VALUE", add = keys("="))]
    overrides: Vec<String>,
    #[command(flatten)]
    laying: LayingArguments,
}

impl TaskCommand for PlaceArguments {
    const NAME: &'static str = "place";
    type Task = DeployTask;
    type Error = Failure;

    fn way(&self) -> Way<'_> {
        self.laying.way()
    }

    fn check(&self) -> Result<(), Failure> {
        read_placement(&self.scenario, &self.overrides).map(drop)
    }

    fn plan(&self, planning: &Planning<'_>, arms: &[usize]) -> Result<DeployTask, Failure> {
        let placement = read_placement(&self.scenario, &self.overrides)?;
        let laying = Laying {
            name: &self.scenario.display().to_string(),
            outline: placement.fixtures.outline(),
            place: None,
            folder: "",
            fixtures: Some(placement.fixtures.clone()),
            is_corrected: false,
            supply: &|frame| {
                let Placement {
                    deployment,
                    friction,
                    ..
                } = &placement;
                Ok(RodSupply::of(deployment, *friction, frame)?)
            },
        };
        self.laying
            .plan(planning, arms[0], laying, |spare, directory| {
                let path = placement.path(spare).at(&placement.title)?;
                make_directory(directory)?;
                for (name, text) in placement.files(&path)? {
                    write_whole(&directory.join(name), text.as_bytes())?;
                }
                Ok((placement.deployment.rod.deployed(), path))
            })
    }
}

/// The cable and the pegs of a scenario.
pub fn read_placement(path: &Path, overrides: &[String]) -> Result<Placement, Failure> {
    match Placement::read(path, overrides) {
        // Scenarios print the faulty lines.
        Err(PlacementError::Scenario(error)) => Err(error.into()),
        read => read.at(path.display()),
    }
}
