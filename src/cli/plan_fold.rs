//! `rodlab plan fold`.

use super::deployment_files::trajectory_csv;
use super::fold_figures::{fold_figure, friction_figure};
use super::folded_sheet::PaperFile;
use super::prelude::*;
use rodlab_files::figure::Paper;
use rodlab_lab::experiment::Crease;
use rodlab_planning::plan::deployment::{GripperPose, timed};
use rodlab_planning::plan::fold::{
    Algorithm, FoldPath, FoldPlanner, FoldedSheet, NetworkCheck, NeuralFolds, Objective, Sheet,
    sliding,
};

/// Fastest turn of the gripper, rad/s.
const FASTEST_TURN: f64 = 1.0;

/// Arguments of `rodlab plan fold`.
#[derive(Debug, Args)]
pub struct FoldPlanArguments {
    /// The sheet: TOML with length, width and gravito_bending_length (or youngs_modulus, thickness and density) in [folding.paper]
    #[arg(long, value_name = "FILE")]
    paper: PathBuf,
    /// Where the edge goes: `half`, onto the opposite edge; `diagonal-strip`, a corner of a square sheet onto the opposite one, planned as a
    /// strip of one width, as in the thesis; or how far (the thesis' C); the crease is pressed half way
    #[arg(long, value_name = "half|diagonal-strip|LENGTH", value_parser = crease)]
    crease: Crease,
    /// Where to write the results
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// What the way of the gripper makes least
    #[arg(long, default_value = "sum")]
    objective: ObjectiveName,
    /// Source of the folds of the manifold over which the way is searched; those of the plan are exact in any case
    #[arg(long, default_value = "exact")]
    solver: SolverName,
    /// The network of --solver neural: model.safetensors of `rodlab train`
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,
    /// Static friction of the table that the demand is compared with [default: that in the sheet's file]
    #[arg(long, value_name = "FRICTION", value_parser = friction)]
    friction: Option<f64>,
    /// Folds in half one after the other, with --crease half: each folds what the one before has left, twice as thick
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=4))]
    times: u8,
    /// What layers do that lie on each other when they are folded again
    #[arg(long, default_value = "loose")]
    layers: LayersName,
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
    /// The moment at the gripper by which the sheet asks for no more than 0.85 of the friction of the table.
    Moment,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
enum SolverName {
    /// The equations of the suspended sheet.
    Exact,
    /// A network.
    Neural,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum LayersName {
    /// They slide on each other: twice as stiff and twice as heavy, the same L_gb.
    Loose,
    /// They stick together: a sheet twice as thick, L_gb larger by 4^(1/3).
    Stuck,
}

/// A plan with the files that it leaves.
struct Planned {
    report: Report,
    out: PathBuf,
    files: Vec<(&'static str, Vec<u8>)>,
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
    /// How many folds of a network were compared with exact ones, and how many were wrong.
    #[serde(skip_serializing_if = "Option::is_none")]
    compared_answers: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    wrong_answers: Option<usize>,
    /// Whether the way was searched over exact folds in place of those of the network.
    #[serde(skip_serializing_if = "Option::is_none")]
    fell_back: Option<bool>,
    poses: usize,
    lifted_without_push: usize,
    grid_cost: f64,
    grid_integral: f64,
    integral: f64,
    largest_force_ratio: f64,
    friction_demand: f64,
    /// In EI/L_gb.
    largest_moment: f64,
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
        let target = file.paper.target(self.crease);
        let target = target.map_err(|error| Failure::Input(format!("--crease: {error}")))?;
        if self.times > 1 && self.crease != Crease::Half {
            return Err(Failure::Input(
                "--times: a sheet is folded again with --crease half".into(),
            ));
        }
        let stiffer = match self.layers {
            LayersName::Loose => 1.0,
            LayersName::Stuck => libm::cbrt(4.0),
        };
        let mut sheet = file.paper.sheet(self.crease);
        let mut target = target;
        let mut plans = vec![];
        for fold in 1..=self.times {
            let out = match self.times {
                1 => self.out.clone(),
                _ => self.out.join(format!("fold_{fold}")),
            };
            plans.push(self.planned(&file, sheet, target, out, network.as_ref())?);
            sheet.length *= 0.5;
            target *= 0.5;
            sheet.gravito_bending_length *= stiffer;
        }
        let mut reports = vec![];
        for Planned { report, out, files } in plans {
            write_files(&out, files)?;
            reports.push(report);
        }
        match &reports[..] {
            [report] => print_json(report),
            reports => print_json(&reports),
        }
    }

    /// The plan of one fold.
    fn planned(
        &self,
        file: &PaperFile,
        sheet: FoldedSheet,
        target: f64,
        out: PathBuf,
        network: Option<&NeuralFolds>,
    ) -> Result<Planned, Failure> {
        let unit = sheet.gravito_bending_length;
        let dimensionless = sheet.dimensionless();
        let friction = self.friction.or(file.paper.friction);
        let (planner, check) = self.planner(dimensionless, friction, network)?;
        let path = planner.path(target / unit);
        let title = &file.title;
        let path = path.map_err(|error| {
            Failure::Input(format!("{title}, {:.4} m long: {error}", sheet.length))
        })?;
        let poses = sheet.poses(&path.folds);
        let times = self.times(&poses);
        let demand = path.friction_demand(dimensionless.length);
        let slid = friction
            .map(|friction| sliding(&path.folds, dimensionless.length, friction))
            .transpose();
        let (slid, slides_away) = match slid {
            Ok(slid) => (slid, None),
            Err(error) => (None, Some(error.to_string())),
        };
        let svg = |figure: rodlab_files::figure::Figure| figure.svg(&Paper::default()).into_bytes();
        let named = vec![
            (
                "trajectory.csv",
                trajectory_csv(&timed(&poses, &times))?.into_bytes(),
            ),
            ("folds.csv", folds_csv(&path, &sheet).into_bytes()),
            (
                "fold.svg",
                svg(fold_figure(&path, planner.manifold(), dimensionless.length)),
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
        let files = named.iter().map(|(name, _)| out.join(name)).collect();
        let report = Report {
            paper: file.title.clone(),
            gravito_bending_length_m: unit,
            length_m: sheet.length,
            target_m: target,
            crease_m: 0.5 * target,
            objective: self.objective,
            solver: self.solver,
            compared_answers: check.map(|check| check.compared),
            wrong_answers: check.map(|check| check.wrong + check.not_finite),
            fell_back: check.map(|check| !check.is_passed()),
            poses: poses.len(),
            lifted_without_push: path.lift,
            grid_cost: path.grid_cost,
            grid_integral: path.grid_integral,
            integral: path.integral,
            largest_force_ratio: path.largest_force_ratio(),
            friction_demand: demand,
            largest_moment: path.largest_moment(),
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
        };
        Ok(Planned {
            report,
            out,
            files: named,
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
            (SolverName::Neural, ObjectiveName::Moment, _) => refused(
                "--objective moment is for --solver exact: a network knows folds without a moment",
            ),
            (SolverName::Neural, _, None) => refused(
                "--solver neural needs --model, model.safetensors of `rodlab train` from samples of scenarios/folding_dataset.toml",
            ),
            (SolverName::Neural, _, Some(path)) => {
                let network = NeuralFolds::read(path);
                network.map(Some).map_err(Failure::input)
            }
        }
    }

    /// What plans, and how folds of a network compare with exact ones.
    fn planner(
        &self,
        sheet: Sheet,
        friction: Option<f64>,
        network: Option<&NeuralFolds>,
    ) -> Result<(FoldPlanner, Option<NetworkCheck>), Failure> {
        let algorithm = match (self.objective, friction) {
            (ObjectiveName::Sum, _) => Algorithm::Optimal(Objective::Sum),
            (ObjectiveName::Friction, _) => Algorithm::Optimal(Objective::Largest),
            (ObjectiveName::Moment, Some(friction)) => Algorithm::Held { friction },
            (ObjectiveName::Moment, None) => {
                let message = "--objective moment: the friction of the table is needed, --friction or `folding.paper.friction`";
                return Err(Failure::Input(message.into()));
            }
        };
        let Some(network) = network else {
            return Ok((FoldPlanner::new(sheet, algorithm), None));
        };
        let model = self.model.as_deref().unwrap_or(Path::new("")).display();
        let planned = FoldPlanner::by_network(sheet, network);
        let (planner, check) =
            planned.map_err(|error| Failure::Input(format!("{model}: {error}")))?;
        if !check.is_passed() {
            tracing::warn!(
                "{model}: {} of {} folds that were compared with exact ones are wrong, and {} are not finite; the way is searched over exact folds",
                check.wrong,
                check.compared,
                check.not_finite
            );
        }
        Ok((planner, Some(check)))
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

/// Columns x, z, suspended length (m), alpha_rad, lambda, friction_demand, the forces in EI/L_gb², as of `rodlab solve fold`, and the moment
/// at the gripper in EI/L_gb.
fn folds_csv(path: &FoldPath, sheet: &FoldedSheet) -> String {
    let mut text = String::from(
        "x_m,z_m,suspended_length_m,alpha_rad,lambda,friction_demand,\
         horizontal_force_ei_per_lgb2,vertical_force_ei_per_lgb2,moment_ei_per_lgb\n",
    );
    let length = sheet.dimensionless().length;
    for fold in &path.folds {
        let [x, z, suspended] = [fold.gripper[0], fold.gripper[1], fold.suspended_length]
            .map(|value| value * sheet.gravito_bending_length);
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "{x:.9},{z:.9},{suspended:.9},{:.9},{:.9},{:.9},{:.9},{:.9},{:.9}",
            fold.angle,
            fold.force_ratio(),
            fold.friction_demand(length),
            // Added to zero, a zero has no sign.
            fold.forces.horizontal + 0.0,
            fold.forces.vertical + 0.0,
            (1e9 * fold.moment).round() / 1e9 + 0.0
        );
    }
    text
}

/// Where the edge goes, as typed.
pub(super) fn crease(text: &str) -> Result<Crease, String> {
    match text.trim() {
        "half" => Ok(Crease::Half),
        Crease::DIAGONAL_STRIP => Ok(Crease::Diagonal),
        "diagonal" => Err(Crease::NO_DIAGONAL.into()),
        text => positive_length(text)
            .map(Crease::At)
            .map_err(|error| format!("{error}; or `half`, or `{}`", Crease::DIAGONAL_STRIP)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rodlab_planning::plan::fold::FoldAtlas;

    #[test]
    fn forces_of_a_plan_are_in_the_unit_of_a_single_fold() {
        let sheet = FoldedSheet {
            gravito_bending_length: 0.05,
            length: 0.3,
            least_suspended: 0.958,
        };
        let fold = FoldAtlas::new().solve([3.4, 1.7]).unwrap();
        let path = FoldPath {
            folds: vec![fold],
            lift: 0,
            grid_cost: 0.0,
            grid_integral: 0.0,
            integral: 0.0,
        };
        let text = folds_csv(&path, &sheet);
        let (header, row) = text.trim_end().split_once('\n').unwrap();
        let cell = |name: &str| -> f64 {
            let place = header.split(',').position(|column| column == name).unwrap();
            row.split(',').nth(place).unwrap().parse().unwrap()
        };
        let forces = fold.forces;
        assert!((cell("horizontal_force_ei_per_lgb2") - forces.horizontal).abs() < 1e-9);
        assert!((cell("vertical_force_ei_per_lgb2") - forces.vertical).abs() < 1e-9);
    }

    #[test]
    fn a_fold_along_the_diagonal_is_refused_unless_it_is_asked_for_as_a_strip() {
        let words = crease("diagonal").unwrap_err();
        assert!(
            words.contains("triangle") && words.contains("diagonal-strip"),
            "{words}"
        );
        assert_eq!(crease("diagonal-strip"), Ok(Crease::Diagonal));
    }
}
