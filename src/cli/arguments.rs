//! The arguments of the program: its subcommands and their common options.

use super::in_cell::InCell;
use super::prelude::*;
use super::{
    calibrate, cell, check, completions, dataset, deploy, design, evaluate, expand, explain,
    explore, export, fold_arguments, gather, guide, identify, init, man, measure, movie, place,
    plan, plot, presets, replay, reproduce, run, score, sensitivity, site, solve, status, stream,
    submit, tie, trace, train, verify, view,
};
use clap::Parser;
use std::sync::OnceLock;

/// A laboratory for slender elastic rods: bending, twist, contact, friction, viscous fluid.
#[derive(Debug, Parser)]
#[command(version = version(), propagate_version = true, after_long_help = EXAMPLES, max_term_width = 100)]
pub struct Arguments {
    /// Subcommand to run.
    #[command(subcommand)]
    pub command: Command,
    /// Options that every subcommand has.
    #[command(flatten)]
    pub common: Common,
}

const EXAMPLES: &str = "\
Examples:
  rodlab run scenarios/flagella_quick.toml       run a scenario; see results/flagella_quick/
  rodlab run beam.toml --set rods.beam.radius=\"7 mm\" --out results/thick
  rodlab check beam.toml                         validate; print derived numbers
  rodlab init scene > my_scene.toml              write a template of a scenario
  rodlab explain rods.natural_curvature          explain a key of scenario files
  rodlab guide getting-started                   the guide, a page per topic

Exit codes: 0 done, 1 failed, 2 bad input, 3 no convergence, 4 a physics check failed,
5 time limit reached (run again to continue), 130 interrupted (run again to continue).";

/// Version, with the commit if it is known.
fn version() -> &'static str {
    static TEXT: OnceLock<String> = OnceLock::new();
    TEXT.get_or_init(rodlab_files::origin::version)
}

/// The subcommands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run a scenario, or resume its interrupted run
    Run(run::RunArguments),
    /// Validate scenarios and print derived numbers
    Check(check::CheckArguments),
    /// Print a scenario with parameters, expressions and copies resolved
    Expand(expand::ExpandArguments),
    /// Write a commented scenario template to standard output
    Init(init::InitArguments),
    /// List the presets (scenarios, rods, papers, cells, patterns), or print one
    Presets(presets::PresetsArguments),
    /// Print the JSON Schema of scenario files, for completion in editors
    Schema,
    /// Explain a key of scenario files, or a file or column of results
    Explain(explain::ExplainArguments),
    /// Read the guide, a page per topic; begin with getting-started
    Guide(guide::GuideArguments),
    /// Solve a problem exactly; the answer is JSON on standard output
    Solve(solve::SolveArguments),
    /// Measure rods, sheets, markers and knots in photographs or curves
    Measure(measure::MeasureArguments),
    /// Differentiate probes of a scenario exactly, with respect to its keys
    Sensitivity(sensitivity::SensitivityArguments),
    /// Fit keys of scenarios to measurements, or a rod that an arm holds
    Identify(identify::IdentifyArguments),
    /// Find the natural shape that gives a rod a target equilibrium
    Design(design::DesignArguments),
    /// Compare the engine with theory, check by check
    Verify(verify::VerifyArguments),
    /// Reproduce a table or figure of the thesis
    Reproduce(reproduce::ReproduceArguments),
    /// Make samples for the training of a network
    Dataset(dataset::DatasetArguments),
    /// Train a network on samples
    Train(train::TrainArguments),
    /// Compare a network with samples
    Evaluate(evaluate::EvaluateArguments),
    /// Plan the path of a gripper, or the joint positions of an arm
    Plan(plan::PlanArguments),
    /// Lay a rod along a pattern with an arm: plan, show, stream, see and score
    Deploy(Box<InCell<deploy::DeployArguments>>),
    /// Lay a cable between pegs with an arm: plan, show, stream, see and score
    Place(Box<InCell<place::PlaceArguments>>),
    /// Tie a knot in a rod with two arms: plan, show, stream, see and score
    Tie(Box<InCell<tie::TieArguments>>),
    /// Explore where helical rods lose stability, with an arm and a chuck
    Explore(InCell<explore::ExploreArguments>),
    /// Fold a sheet: plan, simulate, show and score it
    Fold(InCell<fold_arguments::FoldArguments>),
    /// Draw the figures of a results directory
    Plot(plot::PlotArguments),
    /// Write an interactive 3-D page of a results directory
    View(view::ViewArguments),
    /// Write a film of a results directory: GIF, MP4 or pictures
    Movie(movie::MovieArguments),
    /// Write results as glTF, USD or OBJ, or a scenario as a MuJoCo model
    Export(export::ExportArguments),
    /// Show the measured motion of a task in a cell, and score its picture again
    Replay(replay::ReplayArguments),
    /// Stream a joint trajectory to the arms and axes of a cell
    Stream(stream::StreamArguments),
    /// Serve a virtual robot cell: arms, grippers, a table and a camera
    Cell(cell::CellArguments),
    /// Run a sweep as a Slurm job array
    Submit(submit::SubmitArguments),
    /// Show the status of a sweep's cases and of their Slurm tasks
    Status(status::StatusArguments),
    /// Collect the cases of a sweep into its tables and figures
    Gather(gather::GatherArguments),
    /// Find the centrelines of rods in an image
    Trace(trace::TraceArguments),
    /// Compare a deployed curve with its pattern
    Score(score::ScoreArguments),
    /// Calibrate a camera, its pose or its mount
    Calibrate(calibrate::CalibrateArguments),
    /// Print a completion script for a shell
    Completions(completions::CompletionsArguments),
    /// Write the documentation as a web site
    #[command(hide = true)]
    Site(site::SiteArguments),
    /// Write the manual pages
    Man(man::ManArguments),
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_arguments_do_not_contradict_each_other() {
        Arguments::command().debug_assert();
    }
}
