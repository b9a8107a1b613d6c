//! `rodlab identify --rod`: the gravito-bending length of a rod that an arm holds before a camera.

use super::prelude::*;
use rodlab_lab::experiment::RodFile;
use rodlab_vision::ColourRule;
use rodlab_workcell::task::{IdentificationPlan, IdentificationTask, Planning, TaskCommand, Way};
use rodlab_workcell::virtual_cell::RodSupply;

/// Default length of the free part of a rod, in expected gravito-bending lengths; and its least
/// length, in radii.
const FREE: [f64; 2] = [4.0, 40.0];

/// Arguments of an identification in a cell.
#[derive(Debug, Args)]
pub struct HeldArguments {
    /// Identify a rod that an arm holds in three poses; FILE describes the expected rod
    ///
    /// The gravito-bending length and natural curvature of the rod are fitted to pictures.
    /// [deployment.rod] has gravito_bending_length, radius and length. The default is the rod of
    /// --cell.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["scenario", "data", "others", "fit", "overrides", "markers", "bounds", "prior", "noise"], value_parser = file_or_preset(PresetKind::Rod), add = presets(PresetKind::Rod))]
    pub rod: Option<PathBuf>,
    /// Length of the rod that hangs from the gripper
    ///
    /// The default is four expected gravito-bending lengths, and at least 40 radii.
    #[arg(long, value_name = "LENGTH", value_parser = positive_length, conflicts_with = "scenario")]
    pub free: Option<f64>,
    /// Rod of the simulated cell [default: --rod]
    #[arg(long, value_name = "FILE", conflicts_with_all = ["scenario", "cell"], value_parser = file_or_preset(PresetKind::Rod), add = presets(PresetKind::Rod))]
    pub simulated_rod: Option<PathBuf>,
    /// Name of the arm; optional if the cell has only one
    #[arg(
        long,
        hide_short_help = true,
        value_name = "NAME",
        conflicts_with = "scenario"
    )]
    pub arm: Option<String>,
    /// Greatest speed of a hand that holds the rod, m/s
    #[arg(long, hide_short_help = true, value_name = "SPEED", default_value_t = 0.1, value_parser = positive)]
    pub hand_speed: f64,
    /// Greatest speed of a hand that holds nothing, m/s
    #[arg(long, hide_short_help = true, value_name = "SPEED", default_value_t = 0.1, value_parser = positive)]
    pub approach_speed: f64,
    /// Least distance of arm and rod to anything else, m
    #[arg(long, hide_short_help = true, value_name = "DISTANCE", default_value_t = 0.01, value_parser = positive)]
    pub margin: f64,
    /// Colour of the rod, as in `rodlab trace`
    #[arg(
        long,
        hide_short_help = true,
        value_name = "RULE",
        default_value = "auto"
    )]
    pub colour: String,
    /// Choose the poses and write the pages, but move nothing
    #[arg(long, conflicts_with = "scenario")]
    pub dry_run: bool,
    /// The arm and its gripper were inspected after a task that did not finish
    #[arg(long, hide_short_help = true)]
    pub checked: bool,
    /// Directory for the results
    ///
    /// The default is results/NAME-identified with the name of the scenario, or results/identify-TIME.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

impl TaskCommand for HeldArguments {
    const NAME: &'static str = "identify";
    const CAMERA: Option<&'static str> = Some("the rod is seen in three poses");
    type Task = IdentificationTask;
    type Error = Failure;

    fn way(&self) -> Way<'_> {
        Way {
            arm: self.arm.as_deref(),
            dry_run: self.dry_run,
            checked: Some(self.checked),
            out: self.out.as_deref(),
        }
    }

    fn plan(&self, planning: &Planning<'_>, arms: &[usize]) -> Result<IdentificationTask, Failure> {
        let file = self.rod.as_ref().or(planning.cell.rod.as_ref());
        let file = file.ok_or_else(|| {
            let cell = planning.file.display();
            Failure::Input(format!("--rod is required: {cell} has no [rod]"))
        })?;
        let rod = RodFile::read(file)?;
        let [lengths, radii] = FREE;
        let usual = (lengths * rod.rod.gravito_bending_length).max(radii * rod.rod.radius);
        let free = self.free.unwrap_or_else(|| usual.min(rod.rod.length));
        let plan = IdentificationPlan {
            arm: arms[0],
            rod,
            free,
            colour: ColourRule::parse(&self.colour)?,
            speeds: [self.approach_speed, self.hand_speed],
            margin: self.margin,
        };
        let task = IdentificationTask::new(planning.cell, plan)?;
        planning.furnish(|settings| -> Result<(), Failure> {
            let simulated = self.simulated_rod.as_ref().unwrap_or(file);
            settings.supply = Some(RodSupply::hanging(simulated, free)?);
            Ok(())
        })?;
        Ok(task)
    }
}
