//! `rodlab plan fold`.

use super::prelude::*;
use rodlab_lab::experiment::{Crease, PaperFile};
use rodlab_planning::plan::fold::{Algorithm, NeuralFolds, Objective};
use rodlab_planning::plan::fold_request::{FoldNumbers, FoldPlanRequest, halvings};

/// Arguments of `rodlab plan fold`.
#[derive(Debug, Args)]
pub struct FoldPlanArguments {
    /// Sheet file: TOML with [folding.paper]
    ///
    /// It has length, width and gravito_bending_length (or youngs_modulus, thickness and density).
    #[arg(long, value_name = "FILE", value_parser = file_or_preset(PresetKind::Paper), add = presets(PresetKind::Paper))]
    paper: PathBuf,
    /// Target of the edge: `half`, `diagonal-strip`, or the distance by which it moves
    ///
    /// `half`: onto the opposite edge. `diagonal-strip`: fold a corner of a square sheet onto the
    /// opposite corner; the plan assumes a strip of uniform width, as in the thesis. A distance is
    /// the C of the thesis; the crease is pressed half way.
    #[arg(long, value_name = "TARGET", value_parser = crease)]
    crease: Crease,
    /// Directory for the results
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Quantity that the path of the gripper minimises
    #[arg(long, default_value = "sum")]
    objective: ObjectiveName,
    /// Source of the fold manifold over which the path is searched
    ///
    /// The folds of the plan are always exact.
    #[arg(long, default_value = "exact")]
    solver: SolverName,
    /// Network of --solver neural: model.safetensors from `rodlab train`
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,
    /// Static friction of the table, to compare with the demand [default: that of the sheet file]
    #[arg(long, value_name = "FRICTION", value_parser = friction)]
    friction: Option<f64>,
    /// Number of folds in half, with --crease half
    ///
    /// Each fold after the first folds the folded sheet, which is twice as thick.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=4))]
    times: u8,
    /// Behaviour of layers when they are folded again
    #[arg(long, default_value = "loose")]
    layers: LayersName,
    /// Speed of the gripper, m/s; slower where it would turn faster than 1 rad/s
    #[arg(long, value_name = "SPEED", default_value_t = 0.05, value_parser = speed)]
    speed: f64,
}

#[derive(Clone, Copy, Debug, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
enum ObjectiveName {
    /// The sum of λ = |F_x|/|F_z| over the path (thesis Eq. 4.11).
    Sum,
    /// The largest friction that the whole sheet demands.
    Friction,
    /// The moment at the gripper with which the sheet demands at most 0.85 of the friction of the table.
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

#[derive(Serialize)]
struct Report {
    paper: String,
    gravito_bending_length_m: f64,
    length_m: f64,
    target_m: f64,
    crease_m: f64,
    objective: ObjectiveName,
    solver: SolverName,
    /// Number of folds of a network that were compared with exact ones.
    #[serde(skip_serializing_if = "Option::is_none")]
    compared_answers: Option<usize>,
    /// Number of these folds that were wrong.
    #[serde(skip_serializing_if = "Option::is_none")]
    wrong_answers: Option<usize>,
    /// Whether the path was searched over exact folds instead of those of the network.
    #[serde(skip_serializing_if = "Option::is_none")]
    fell_back: Option<bool>,
    #[serde(flatten)]
    numbers: FoldNumbers,
    files: Vec<PathBuf>,
}

impl FoldPlanArguments {
    /// Plans, and writes trajectory, folds and figures.
    pub fn plan(&self) -> Result<(), Failure> {
        let network = self.network()?;
        let PaperFile { title, paper } = PaperFile::read(&self.paper)?;
        let target = paper.target(self.crease).at("--crease")?;
        if self.times > 1 && self.crease != Crease::Half {
            return Err(Failure::Input(
                "--times needs --crease half: only a fold in half is repeated".into(),
            ));
        }
        let friction = self.friction.or(paper.friction);
        let request = FoldPlanRequest {
            algorithm: self.algorithm(friction)?,
            network: network.as_ref(),
            friction,
            speed: self.speed,
        };
        let larger = match self.layers {
            LayersName::Loose => 1.0,
            LayersName::Stuck => libm::cbrt(4.0),
        };
        let (mut reports, mut written) = (vec![], vec![]);
        let folds = halvings(paper.sheet(self.crease), target, larger);
        for ((sheet, target), number) in folds.zip(1..=self.times) {
            let (planner, check) = request.planner(&sheet).at(self.model_name())?;
            if let Some(check) = check.filter(|check| !check.is_passed()) {
                tracing::warn!(
                    "{}: {} of {} folds differ from the exact ones and {} are not finite; the path is planned with \
                     exact folds instead",
                    self.model_name(),
                    check.wrong,
                    check.compared,
                    check.not_finite
                );
            }
            let plan = request.plan(&planner, sheet, target);
            let plan = plan.at(format_args!("{title}, {:.4} m long", sheet.length))?;
            let out = match self.times {
                1 => self.out.clone(),
                _ => self.out.join(format!("fold_{number}")),
            };
            let files = plan.files(&planner)?;
            reports.push(Report {
                paper: title.clone(),
                gravito_bending_length_m: sheet.gravito_bending_length,
                length_m: sheet.length,
                target_m: target,
                crease_m: 0.5 * target,
                objective: self.objective,
                solver: self.solver,
                compared_answers: check.map(|check| check.compared),
                wrong_answers: check.map(|check| check.wrong + check.not_finite),
                fell_back: check.map(|check| !check.is_passed()),
                numbers: plan.numbers,
                files: files.iter().map(|(name, _)| out.join(name)).collect(),
            });
            written.push((out, files));
        }
        for (out, files) in written {
            write_files(&out, files)?;
        }
        match &reports[..] {
            [report] => print_json(report),
            reports => print_json(&reports),
        }
    }

    fn model_name(&self) -> impl Display {
        self.model.as_deref().unwrap_or(Path::new("")).display()
    }

    fn algorithm(&self, friction: Option<f64>) -> Result<Algorithm, Failure> {
        match (self.objective, friction) {
            (ObjectiveName::Sum, _) => Ok(Algorithm::Optimal(Objective::Sum)),
            (ObjectiveName::Friction, _) => Ok(Algorithm::Optimal(Objective::Largest)),
            (ObjectiveName::Moment, Some(friction)) => Ok(Algorithm::Held { friction }),
            (ObjectiveName::Moment, None) => Err(Failure::Input(
                "--objective moment: the friction of the table is missing: give --friction or `folding.paper.friction`".into(),
            )),
        }
    }

    /// Network that predicts the folds, if one is used.
    fn network(&self) -> Result<Option<NeuralFolds>, Failure> {
        let refused = |why: &str| Err(Failure::Input(why.into()));
        match (self.solver, self.objective, &self.model) {
            (SolverName::Exact, _, None) => Ok(None),
            (SolverName::Exact, _, Some(_)) => refused("--model is for --solver neural"),
            (SolverName::Neural, ObjectiveName::Friction, _) => refused(
                "--objective friction is for --solver exact: a network predicts λ, but not the force of the sheet on the table",
            ),
            (SolverName::Neural, ObjectiveName::Moment, _) => refused(
                "--objective moment is for --solver exact: a network predicts only folds without a moment",
            ),
            (SolverName::Neural, _, None) => refused(
                "--solver neural needs --model, model.safetensors of `rodlab train` from samples of scenarios/folding_dataset.toml",
            ),
            (SolverName::Neural, _, Some(path)) => Ok(Some(NeuralFolds::read(path).or_input()?)),
        }
    }
}

/// Parses the target of the edge.
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

    #[test]
    fn a_diagonal_fold_must_be_requested_as_a_strip() {
        let words = crease("diagonal").unwrap_err();
        assert!(
            words.contains("triangle") && words.contains("diagonal-strip"),
            "{words}"
        );
        assert_eq!(crease("diagonal-strip"), Ok(Crease::Diagonal));
    }
}
