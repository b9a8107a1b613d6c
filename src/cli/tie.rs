//! `rodlab tie`.

use super::cell::FRICTION;
use super::plan_deployment::DeploymentPlan;
use super::prelude::*;
use rodlab_planning::plan::deployment::Spare;
use rodlab_planning::plan::pattern::StrokeChoice;
use rodlab_vision::ColourRule;
use rodlab_workcell::task::{
    KnotPlan, Planning, TaskArguments, TaskCommand, TieMotion, TieMotionRequest, TiePlan, TieTask,
    Way,
};
use rodlab_workcell::virtual_cell::RodSupply;

const HELP: [&str; 2] = help!(
    "\
Examples:
  rodlab tie --pattern trefoil --knot over,under,over                   in a virtual cell
  rodlab tie --pattern trefoil --rod thick_pink_vps --knot over,under,over --dry-run
  rodlab tie --pattern k.svg --knot over,under,over --cell cell.toml --arm right --second-arm left
  rodlab tie --pattern reef --stroke 1 --rod thick_pink_vps --knot over,over,under,over,over,under \\
    --second-stroke 2 --second-rod green_vps",
    "\
Two arms tie a knot in one rod, or in two. The pattern crosses itself and is longer than the rod:
one arm lays the rod along it and leads the end of the rod along the rest, under the strands that
the other arm lifts meanwhile, and over others. --knot states for each crossing whether the second
pass is over or under; it is over where the rod crosses itself as it is laid. With two rods each arm
lays one, the second over the first, and then leads its end, first that of the second rod. --knot
then lists the crossings of the second rod as it is laid, then those of its end, then those of the
end of the first rod.

Then both grippers open and the camera of the cell file takes a picture. The knot in the picture,
identified by its determinant and signature, is compared with that of the pattern: `score.tied` is
true or false, or null if the picture does not decide, and `score.undecided` gives the reason. With
--dry-run nothing moves: look at its page first.

All results are in one directory: manifest.json, report.md, report.html, plan/, joints.csv,
cell.html, approach/, laying/ and tying/ (commanded.csv, state.csv, events.csv), picture.png,
overlay.png, rod.csv. Exit code 1: a step failed; the message and report.md give the reason. A cell
for trying --cell:
  rodlab cell serve --cell two_gantries --rod thick_pink_vps"
);

/// Arguments of `rodlab tie`.
#[derive(Debug, Args)]
#[command(after_help = HELP[0], after_long_help = HELP[1])]
pub struct TieArguments {
    #[command(flatten)]
    plan: DeploymentPlan,
    /// Name of the arm that lays the rod and leads its end [default: the first]
    #[arg(long, value_name = "NAME")]
    arm: Option<String>,
    /// Name of the arm that lifts strands, and lays a second rod [default: the first of the others]
    #[arg(long, value_name = "NAME")]
    second_arm: Option<String>,
    /// File of the second rod of a knot of two rods
    ///
    /// It is laid over the first rod, and its end is led before that of the first.
    #[arg(long, value_name = "FILE", value_parser = file_or_preset(PresetKind::Rod), add = presets(PresetKind::Rod))]
    second_rod: Option<PathBuf>,
    /// Pattern of the second rod, an SVG or CSV file in the same frame [default: --pattern]
    #[arg(long, value_name = "FILE", requires = "second_rod", hide_short_help = true, value_parser = file_or_preset(PresetKind::Pattern), add = presets(PresetKind::Pattern))]
    second_pattern: Option<PathBuf>,
    /// Stroke of the second pattern, as --stroke [default: the only one]
    ///
    /// For an SVG file: number (from 1) or id of the stroke, or `longest`. For a CSV file: number
    /// of the strand, from 1.
    #[arg(
        long,
        value_name = "STROKE",
        requires = "second_rod",
        hide_short_help = true
    )]
    second_stroke: Option<StrokeChoice>,
    #[command(flatten)]
    task: TaskArguments,
}

impl TaskCommand for TieArguments {
    const NAME: &'static str = "tie";
    const CELL: &'static str = "two_gantries";
    const CAMERA: Option<&'static str> = Some("its picture shows whether the knot is tied");
    type Task = TieTask;
    type Error = Failure;

    fn way(&self) -> Way<'_> {
        self.task.way()
    }

    fn check(&self) -> Result<(), Failure> {
        if !self.plan.ties_knot() {
            return Err(Failure::Input(
                "--knot is required: over or under for each crossing, in the order of the second passes, \
                 as in --knot over,under,over"
                    .into(),
            ));
        }
        Ok(())
    }

    fn arms(&self, planning: &Planning<'_>) -> Result<Vec<usize>, Failure> {
        self.two_arms(planning).map(Into::into)
    }

    fn plan(&self, planning: &Planning<'_>, arms: &[usize]) -> Result<TieTask, Failure> {
        let (cell, arms) = (planning.cell, [arms[0], arms[1]]);
        self.plan.use_rod_of(cell);
        let colour = ColourRule::parse(&self.task.colour)?;
        let second = self.second()?;
        let mut outline = self.plan.outline()?;
        let second_points = second.iter().flat_map(|knot| knot.rods[1].points());
        outline.extend(second_points);
        let place = self.task.place(cell, &outline)?;
        let knot = match second {
            Some(knot) => knot,
            None => {
                // Check before a directory is created.
                self.plan.check_knot()?;
                let directory = planning.directory()?.join("plan");
                let written = self.plan.write(&directory, &Spare::HANGS)?;
                written.knot.expect("a plan with --knot")
            }
        };
        let request = TieMotionRequest {
            cell,
            arms,
            place,
            speed: self.task.hand_speed,
            free_speed: self.task.approach_speed,
            margin: self.task.margin,
        };
        let motion = TieMotion::plan(&request, &knot)?;
        planning.furnish(|settings| -> Result<(), Failure> {
            let supply = |number: usize, file: &Path| -> Result<RodSupply, Failure> {
                let start = knot.rods[number].pattern.at(0.0).position;
                Ok(RodSupply::new(file, FRICTION)?.beginning_at(&motion.frame, start))
            };
            let second = self.second_rod.as_deref();
            settings.supply = Some(supply(0, self.plan.rod_file()?)?);
            settings.second_supply = second.map(|file| supply(1, file)).transpose()?;
            Ok(())
        })?;
        let plan = TiePlan {
            arms,
            names: self.pattern_names(),
            motion,
            knot,
            free_speed: self.task.approach_speed,
            colour,
        };
        Ok(TieTask::new(cell, plan))
    }
}

impl TieArguments {
    /// Plan of a knot of two rods; `None` without a second rod.
    fn second(&self) -> Result<Option<KnotPlan>, Failure> {
        let Some(rod) = &self.second_rod else {
            return Ok(None);
        };
        let file = self.second_pattern.as_deref();
        let source = self.plan.second_source(file, self.second_stroke.as_ref())?;
        self.plan.knot_with(rod, &source).map(Some)
    }

    /// The patterns as given.
    fn pattern_names(&self) -> Vec<String> {
        let first = self.plan.pattern_name().to_owned();
        let second = self.second_rod.as_ref().map(|_| {
            let file = self.second_pattern.as_ref();
            let file = file.map_or_else(|| first.clone(), |file| file.display().to_string());
            match &self.second_stroke {
                Some(stroke) => format!("stroke {stroke} of {file}"),
                None => file,
            }
        });
        std::iter::once(first.clone()).chain(second).collect()
    }

    /// Indices of the arm that lays rods and of the arm that lifts strands.
    fn two_arms(&self, planning: &Planning<'_>) -> Result<[usize; 2], Failure> {
        let Planning { cell, file, .. } = planning;
        let names: Vec<&str> = cell.arms.iter().map(|arm| arm.name.as_str()).collect();
        if names.len() < 2 {
            let found = names
                .first()
                .map_or("none".into(), |name| format!("one: {name}"));
            return Err(Failure::Input(format!(
                "{}: a knot takes two arms, one that leads the end and one that lifts strands; it has {found}",
                file.display()
            )));
        }
        let named = |flag: &str, name: &Option<String>| {
            let arm = name.as_deref().map(|name| planning.arm(flag, Some(name)));
            arm.transpose()
        };
        let layer = named("--arm", &self.arm)?;
        let lifter = named("--second-arm", &self.second_arm)?;
        let other = |known: Option<usize>| usize::from(known == Some(0));
        let layer = layer.unwrap_or_else(|| other(lifter));
        let lifter = lifter.unwrap_or_else(|| other(Some(layer)));
        if layer == lifter {
            return Err(Failure::Input(format!(
                "--second-arm: {} lays the rod and leads its end; another arm must lift strands",
                names[layer]
            )));
        }
        Ok([layer, lifter])
    }
}
