//! `rodlab plan fold`.

use super::deployment_files::trajectory_csv;
use super::failure::Failure;
use super::fold_figures::{fold_figure, friction_figure};
use super::folded_sheet::PaperFile;
use super::output::{print_json, write_files};
use super::values::positive_length;
use crate::figure::Paper;
use crate::plan::deployment::GripperPose;
use crate::plan::fold::{
    FoldAtlas, FoldPath, FoldedSheet, ForceManifold, NeuralFolds, Objective, fold_path, sliding,
};
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::fmt::Write;
use std::path::PathBuf;

/// Longest suspended length of the manifold, in L_gb (thesis sec. 4.3.3).
const LONGEST: f64 = 6.84;
/// Fastest turn of the gripper, rad/s.
const FASTEST_TURN: f64 = 1.0;

/// Arguments of `rodlab plan fold`.
#[derive(Debug, Args)]
pub struct FoldPlanArguments {
    /// The sheet: TOML with length, width and gravito_bending_length (or youngs_modulus, thickness and density) in [folding.paper]
    #[arg(long, value_name = "FILE")]
    paper: PathBuf,
    /// Where the edge goes: `half`, onto the opposite edge; `diagonal`, a corner of a square sheet onto the opposite one; or how far
    /// (the thesis' C); the crease is pressed half way
    #[arg(long, value_name = "half|diagonal|LENGTH", value_parser = crease)]
    crease: Crease,
    /// Where to write the results
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// What the way of the gripper makes least
    #[arg(long, default_value = "sum")]
    objective: ObjectiveName,
    /// Who knows the folds of the manifold over which the way is searched; those of the plan are exact in any case
    #[arg(long, default_value = "exact")]
    solver: SolverName,
    /// The network of --solver neural: model.safetensors of `rodlab train`
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,
    /// Static friction of the table that the demand is compared with [default: that in the sheet's file]
    #[arg(long, value_name = "FRICTION", value_parser = friction)]
    friction: Option<f64>,
    /// Speed of the gripper, m/s; slower where it would turn faster than 1 rad/s
    #[arg(long, value_name = "SPEED", default_value_t = 0.05, value_parser = speed)]
    speed: f64,
}

#[derive(Clone, Copy, Debug, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
enum ObjectiveName {
    /// The sum of λ = |F_x|/|F_z| over the way (thesis Eq. 4.11).
    Sum,
    /// The largest friction that the whole sheet asks for.
    Friction,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
enum SolverName {
    /// The equations of the suspended sheet.
    Exact,
    /// A network.
    Neural,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Crease {
    Half,
    Diagonal,
    At(f64),
}

#[derive(Serialize)]
struct Report {
    paper: String,
    gravito_bending_length_m: f64,
    length_m: f64,
    target_m: f64,
    crease_m: f64,
    objective: ObjectiveName,
    solver: SolverName,
    poses: usize,
    lifted_without_push: usize,
    grid_cost: f64,
    grid_integral: f64,
    integral: f64,
    largest_force_ratio: f64,
    friction_demand: f64,
    friction: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    holds: Option<bool>,
    /// Farthest on the way.
    #[serde(skip_serializing_if = "Option::is_none")]
    slides_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    slides_away: Option<String>,
    duration_s: f64,
    files: Vec<PathBuf>,
}

impl FoldPlanArguments {
    /// Plans, and writes trajectory, folds and figures.
    pub fn plan(&self) -> Result<(), Failure> {
        let network = self.network()?;
        let file = PaperFile::read(&self.paper)?;
        let (sheet, target) = self.target(&file)?;
        let unit = sheet.gravito_bending_length;
        let atlas = FoldAtlas::new();
        let dimensionless = sheet.dimensionless();
        let longest = dimensionless.length.min(LONGEST);
        let manifold = match &network {
            None => ForceManifold::new(&atlas, ForceManifold::SPACING, longest),
            Some(network) => {
                let lengths = [dimensionless.least_suspended, longest];
                let manifold = network.manifold(&atlas, ForceManifold::SPACING, lengths);
                manifold
                    .map_err(|error| Failure::Input(format!("{}: {error}", self.model_name())))?
            }
        };
        let objective = match self.objective {
            ObjectiveName::Sum => Objective::Sum,
            ObjectiveName::Friction => Objective::Largest,
        };
        let path = fold_path(&atlas, &manifold, &dimensionless, target / unit, objective);
        let path = path.map_err(|error| Failure::Input(format!("{}: {error}", file.title)))?;
        let poses = sheet.poses(&path.folds);
        let times = self.times(&poses);
        let friction = self.friction.or(file.friction);
        let demand = path.friction_demand(dimensionless.length);
        let slid = friction
            .map(|friction| sliding(&path.folds, dimensionless.length, friction))
            .transpose();
        let (slid, slides_away) = match slid {
            Ok(slid) => (slid, None),
            Err(error) => (None, Some(error.to_string())),
        };
        let svg = |figure: crate::figure::Figure| figure.svg(&Paper::default()).into_bytes();
        let named = vec![
            (
                "trajectory.csv",
                trajectory_csv(&poses, &times).into_bytes(),
            ),
            ("folds.csv", folds_csv(&path, &sheet).into_bytes()),
            (
                "fold.svg",
                svg(fold_figure(&path, &manifold, dimensionless.length)),
            ),
            (
                "friction.svg",
                svg(friction_figure(
                    &path,
                    dimensionless.length,
                    friction,
                    slid.as_deref(),
                )),
            ),
        ];
        let files = named.iter().map(|(name, _)| self.out.join(name)).collect();
        write_files(&self.out, named)?;
        print_json(&Report {
            paper: file.title,
            gravito_bending_length_m: unit,
            length_m: sheet.length,
            target_m: target,
            crease_m: 0.5 * target,
            objective: self.objective,
            solver: self.solver,
            poses: poses.len(),
            lifted_without_push: path.lift,
            grid_cost: path.grid_cost,
            grid_integral: path.grid_integral,
            integral: path.integral,
            largest_force_ratio: path.largest_force_ratio(),
            friction_demand: demand,
            friction,
            holds: friction.map(|friction| demand <= friction),
            slides_m: slid.map(|slid| {
                let farthest = slid
                    .iter()
                    .fold(0.0, |most: f64, slid| most.max(slid.abs()));
                farthest * unit
            }),
            slides_away,
            duration_s: times.last().copied().unwrap_or(0.0),
            files,
        })
    }

    /// The network that knows the folds, if one does.
    fn network(&self) -> Result<Option<NeuralFolds>, Failure> {
        let refused = |why: &str| Err(Failure::Input(why.into()));
        match (self.solver, self.objective, &self.model) {
            (SolverName::Exact, _, None) => Ok(None),
            (SolverName::Exact, _, Some(_)) => refused("--model is for --solver neural"),
            (SolverName::Neural, ObjectiveName::Friction, _) => refused(
                "--objective friction is for --solver exact: a network tells λ, but not how hard the sheet presses on the table",
            ),
            (SolverName::Neural, _, None) => refused(
                "--solver neural needs --model, model.safetensors of `rodlab train` from samples of scenarios/folding_dataset.toml",
            ),
            (SolverName::Neural, _, Some(path)) => {
                let network = NeuralFolds::read(path);
                network
                    .map(Some)
                    .map_err(|error| Failure::Input(error.to_string()))
            }
        }
    }

    fn model_name(&self) -> String {
        let path = self.model.as_deref();
        path.map_or_else(String::new, |path| path.display().to_string())
    }

    /// The sheet in the direction of the fold, and where its edge goes, m.
    fn target(&self, file: &PaperFile) -> Result<(FoldedSheet, f64), Failure> {
        let along_diagonal = self.crease == Crease::Diagonal;
        if along_diagonal && !file.is_square() {
            return Err(Failure::Input(format!(
                "--crease diagonal: {} is {} m by {} m; only a square sheet is folded along its diagonal",
                file.title, file.length, file.width
            )));
        }
        let sheet = file.sheet(along_diagonal);
        let target = match self.crease {
            Crease::At(target) => target,
            Crease::Half | Crease::Diagonal => sheet.length,
        };
        if target > sheet.length {
            return Err(Failure::Input(format!(
                "--crease {target} m: {} is {} m long, and its edge cannot go beyond the opposite one",
                file.title, sheet.length
            )));
        }
        Ok((sheet, target))
    }

    /// When the gripper passes its poses, s, from 0.
    fn times(&self, poses: &[GripperPose]) -> Vec<f64> {
        let mut time = 0.0;
        let steps = poses.windows(2).map(|pair| {
            let turn = pair[0].rotation.angle_to(&pair[1].rotation);
            time += ((pair[1].s - pair[0].s) / self.speed).max(turn / FASTEST_TURN);
            time
        });
        [0.0].into_iter().chain(steps).collect()
    }
}

/// Columns x, z, suspended length (m), alpha_rad, lambda, friction_demand, and the forces per weight of L_gb of the sheet.
fn folds_csv(path: &FoldPath, sheet: &FoldedSheet) -> String {
    let mut text = String::from(
        "x_m,z_m,suspended_length_m,alpha_rad,lambda,friction_demand,horizontal_force,vertical_force\n",
    );
    let length = sheet.dimensionless().length;
    for fold in &path.folds {
        let [x, z, suspended] = [fold.gripper[0], fold.gripper[1], fold.suspended_length]
            .map(|value| value * sheet.gravito_bending_length);
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "{x:.9},{z:.9},{suspended:.9},{:.9},{:.9},{:.9},{:.9},{:.9}",
            fold.angle,
            fold.force_ratio(),
            fold.friction_demand(length),
            2.0 * fold.forces.horizontal,
            2.0 * fold.forces.vertical
        );
    }
    text
}

fn crease(text: &str) -> Result<Crease, String> {
    match text.trim() {
        "half" => Ok(Crease::Half),
        "diagonal" => Ok(Crease::Diagonal),
        text => positive_length(text)
            .map(Crease::At)
            .map_err(|error| format!("{error}; or `half`, or `diagonal`")),
    }
}

fn friction(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(friction) if friction >= 0.0 && friction.is_finite() => Ok(friction),
        _ => Err("a number from 0 up is needed".into()),
    }
}

fn speed(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(speed) if speed > 0.0 && speed.is_finite() => Ok(speed),
        _ => Err("a speed above 0 is needed, m/s".into()),
    }
}
