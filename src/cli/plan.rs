//! `rodlab plan`: trajectories.

use super::plan_deployment::DeploymentArguments;
use super::plan_fold::FoldPlanArguments;
use super::plan_grippers::GripperPlanArguments;
use super::prelude::*;
use super::solve_arm::ArmChoice;
use rodlab_workcell::cell::{Place, PlanError, PlanRequest, read_poses};

const DEPLOYMENT: [&str; 2] = help!(
    "\
Examples:
  rodlab plan deployment --pattern A --rod green_vps --out results/letter_a
  rodlab plan deployment --pattern traced.csv --size \"25 cm\" --rod rope --friction steel --out plan
  rodlab plan deployment --pattern circle:0.1 --rod pink_vps --scheme intuitive --out results/circle
  rodlab plan deployment --pattern trefoil --rod thick_pink_vps --knot over,under,over \\
    --lead-in none --out results/trefoil",
    "\
Writes trajectory.csv (time_s, x_m, y_m, z_m, qw, qx, qy, qz: the poses that a clamp follows and
that `rodlab plan joints` reads), trajectory.json, pattern.csv (s_m, x_m, y_m, curvature_per_m,
friction_demand), deployment.svg and a scenario that simulates the laying, landing.toml with
rod.csv. With --knot it also writes lift_1.csv and so on, the poses of the gripper that lifts a
strand, at the same times. A drawing of several strokes gets a folder for each, stroke-1 and so on,
and strokes.svg, which shows them. Prints the demands of the pattern on the rod and the table. The
table is z = 0; the gripper's x axis is the tangent of the rod, towards the gripper. See
`rodlab guide deployment`."
);

const FOLD: [&str; 2] = help!(
    "\
Examples:
  rodlab plan fold --paper a4 --crease half --out results/fold_a4
  rodlab plan fold --paper us_letter --crease \"20 cm\" --objective friction --out results/fold_letter
  rodlab plan fold --paper origami --crease diagonal-strip --out results/fold_origami",
    "\
The edge is lifted without a push along the table. The end of the lift, and the path over the force
manifold that follows it, are searched on a grid of 0.0548 L_gb (thesis Algorithm 4). The points of
the path are then moved until the sum of λ no longer decreases.

Writes trajectory.csv (time_s, x_m, y_m, z_m, qw, qx, qy, qz), folds.csv, fold.svg (the sheet along
its path) and friction.svg. Prints the largest λ = |F_x|/|F_z| at the touchdown point, and the
friction demand of the whole sheet, including its lying part. Where the demand is above the friction
of the table, the sheet slides, by at most `slides_m`, computed without inertia and with the planned
angles. --objective friction minimises the demand. Initially the edge is at the origin, and the
sheet lies along x on the table z = 0. The gripper's x axis is the tangent of the sheet, towards the
gripper."
);

const GRIPPERS: [&str; 2] = help!(
    "\
Examples:
  rodlab plan grippers tied_reef --out results/reef_plan
  rodlab plan grippers tied_trefoil --set deployment.scheme=intuitive --out results/trefoil_plan",
    "\
Writes a file for each time that a gripper holds a rod, in the order in which these begin. The
gripper lays the rod (and leads its end on), lifts a strand, or grasps the end of the rod again and
leads it. The columns are time_s, x_m, y_m, z_m, qw, qx, qy, qz, in the time of the scenario,
without its jitter. Prints the schedule of the grippers."
);

const JOINTS: [&str; 2] = help!(
    "\
Examples:
  rodlab plan joints trajectory.csv --cell six_joints --place auto > joints.csv
  rodlab plan joints trajectory.csv --cell cell.toml --arm right --place 0.6,0,0.1 --out joints.csv",
    "\
The table of poses has the columns x_m, y_m, z_m, qw, qx, qy, qz; its times are ignored: the motion
is as fast as the limits of the joints and --hand-speed allow, from rest to rest. The answer has
time_s and a column arm.joint_rad (or _m) per joint. With --out it is written to that file, and a
summary is printed as JSON."
);

/// Arguments of `rodlab plan`.
#[derive(Debug, Args)]
pub struct PlanArguments {
    /// Object to plan
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    /// A gripper's trajectory that lays a rod along a pattern
    #[command(after_help = DEPLOYMENT[0], after_long_help = DEPLOYMENT[1])]
    Deployment(Box<DeploymentArguments>),
    /// A gripper's trajectory that folds a sheet with little sliding
    #[command(after_help = FOLD[0], after_long_help = FOLD[1])]
    Fold(FoldPlanArguments),
    /// Trajectories of all grippers of a deployment of one rod or two, with the moves that tie a knot
    #[command(after_help = GRIPPERS[0], after_long_help = GRIPPERS[1])]
    Grippers(GripperPlanArguments),
    /// A joint trajectory along poses of the hand
    #[command(after_help = JOINTS[0], after_long_help = JOINTS[1])]
    Joints(JointsArguments),
}

#[derive(Debug, Args)]
struct JointsArguments {
    /// Table of poses of the hand
    trajectory: PathBuf,
    #[command(flatten)]
    arm: ArmChoice,
    /// Place of the path in the cell: x,y,z in metres, a turn about z in degrees; or `auto`
    ///
    /// `auto` selects the best place on the table.
    #[arg(
        long,
        value_name = "X,Y,Z[,TURN]|auto",
        default_value = "0,0,0",
        allow_hyphen_values = true
    )]
    place: Place,
    /// Greatest speed of the hand, m/s
    #[arg(long, value_name = "SPEED", default_value_t = 0.25, value_parser = positive)]
    hand_speed: f64,
    /// Least distance to anything else, m
    #[arg(long, value_name = "DISTANCE", default_value_t = 0.01, value_parser = positive)]
    margin: f64,
    /// Points per second: 100, 125, 200, 250, 500 or 1000
    #[arg(long, value_name = "N", default_value_t = 100)]
    rate: u32,
    /// Output file for the trajectory [default: standard output]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Plans and prints a trajectory.
pub fn plan(arguments: &PlanArguments) -> Result<(), Failure> {
    match &arguments.what {
        What::Deployment(arguments) => arguments.plan(),
        What::Fold(arguments) => arguments.plan(),
        What::Grippers(arguments) => arguments.plan(),
        What::Joints(arguments) => joints(arguments),
    }
}

fn joints(arguments: &JointsArguments) -> Result<(), Failure> {
    let (cell, arm) = arguments.arm.read()?;
    let path = read_poses(&arguments.trajectory).map_err(Failure::input)?;
    let plan = cell.plan(&PlanRequest {
        arm,
        path,
        place: arguments.place,
        margin: arguments.margin,
        speed: arguments.hand_speed,
        rate: arguments.rate,
    })?;
    let csv = plan.trajectory.to_csv()?;
    match &arguments.out {
        None => print(&csv),
        Some(file) => {
            write_file(file, csv.as_bytes())?;
            print_json(&plan.report)
        }
    }
}

impl From<PlanError> for Failure {
    fn from(error: PlanError) -> Self {
        match error {
            PlanError::Input(message) => Self::Input(message),
            PlanError::Path(message) => Self::Unreachable(message),
            PlanError::Timing(error) => Self::input(error),
        }
    }
}
