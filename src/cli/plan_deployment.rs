//! `rodlab plan deployment`.

use super::chosen_rod::{rod_for, rod_for_knot};
use super::drawn_pattern::stroke_picture;
use super::pattern_source::{PatternArguments, extent};
use super::prelude::*;
use rodlab_files::finite::NotFinite;
use rodlab_lab::experiment::{Landing, RodFile};
use rodlab_planning::plan::deployment::{
    DeployedRod, DeploymentError, Feasibility, GripperPose, LaidPath, MOST_POSES, OptimalGrasps,
    Scheme, Spare, timed, when_laid,
};
use rodlab_planning::plan::files::{drawing_csv, path_files, trajectory_csv, trajectory_json};
use rodlab_planning::plan::grasp::NeuralGrasps;
use rodlab_planning::plan::pattern::{Crossing, PatternError, PatternSource, StrokeChoice};
use rodlab_planning::plan::request::{DeploymentRequest, LeadLength, RequestError};
use rodlab_planning::plan::tying::Pass;
use rodlab_workcell::cell::Cell;
use rodlab_workcell::task::{KnotPlan, PlannedRod, stroke_folder};
use std::borrow::Cow;
use std::sync::OnceLock;

/// Coefficient of friction that few tables exceed.
const LARGEST_FRICTION: f64 = 1.0;
/// Schemes of leading the rod.
const SCHEMES: [Named<Scheme>; 2] = [
    (
        "optimal",
        Scheme::Optimal,
        "The optimal grasp of each point",
    ),
    (
        "intuitive",
        Scheme::Intuitive,
        "Upright above the contact node",
    ),
];
/// Ways of passing a crossing.
const PASSES: [Named<Pass>; 2] = [
    ("over", Pass::Over, "Over the strand that lies there"),
    ("under", Pass::Under, "Under that strand, which is lifted"),
];

/// Arguments of `rodlab plan deployment`.
#[derive(Debug, Args)]
pub struct DeploymentArguments {
    #[command(flatten)]
    what: DeploymentPlan,
    /// Directory for the results
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

/// Rod, pattern and scheme of a deployment.
#[derive(Clone, Debug, Args)]
pub struct DeploymentPlan {
    #[command(flatten)]
    pub(super) source: PatternArguments,
    /// The pattern as it is laid.
    #[arg(skip)]
    pub(super) fitted: OnceLock<PatternSource>,
    /// Rod file: TOML with [deployment.rod] [default: that of the cell, otherwise a preset]
    ///
    /// [deployment.rod] has gravito_bending_length, radius and length. The default preset is the
    /// softest one that is long enough. For a knot it is the longest one that is shorter than the
    /// pattern.
    #[arg(long, value_name = "FILE", value_parser = file_or_preset(PresetKind::Rod), add = presets(PresetKind::Rod))]
    rod: Option<PathBuf>,
    #[arg(skip)]
    pub(super) chosen: OnceLock<PathBuf>,
    #[arg(skip)]
    identified: OnceLock<PathBuf>,
    /// Whether the rod is cut to the length of the pattern.
    #[arg(skip)]
    pub(super) is_cut: bool,
    /// Scheme by which the gripper leads the rod
    #[arg(long, hide_short_help = true, default_value = "optimal", value_parser = named(&SCHEMES))]
    scheme: Scheme,
    /// Solver for the optimal grasps
    #[arg(long, hide_short_help = true, default_value = "exact")]
    solver: SolverName,
    /// Network of --solver neural, from `rodlab train` [default: the built-in one]
    #[arg(long, value_name = "FILE", hide_short_help = true)]
    model: Option<PathBuf>,
    /// Length of a lead-in, whose curvature grows to that of the pattern: `auto`, `none` or a
    /// length
    ///
    /// `auto` keeps the friction demand below 0.1, but is shorter if the lead-in would bend below
    /// three radii of the rod, or coil.
    #[arg(long, value_name = "LENGTH", hide_short_help = true, default_value = "auto", value_parser = lead)]
    lead_in: LeadLength,
    /// Length of rod that is laid beyond the end of the pattern: `auto`, `none` or a length
    ///
    /// If the rod is longer than the pattern, `auto` lays all of it except 2.5 gravito-bending
    /// lengths. The rod is laid behind the pattern as far as there is room on the table and in the
    /// picture of the camera, and the rest straight in front of the pattern. The default is `auto`
    /// with a cell, otherwise `none`.
    #[arg(long, value_name = "LENGTH", hide_short_help = true, value_parser = lead)]
    lead_out: Option<LeadLength>,
    /// Largest distance of neighbouring poses along the pattern
    #[arg(long, value_name = "LENGTH", hide_short_help = true, default_value = "3 mm", value_parser = positive_length)]
    pub(super) step: f64,
    /// Speed of laying along the pattern, m/s
    ///
    /// It is reduced where the gripper would otherwise move more than 1.5 times as fast.
    #[arg(long, value_name = "SPEED", default_value_t = 0.02, value_parser = speed)]
    speed: f64,
    /// Friction of the table, to compare with the demand: a number, or a name in the rod file
    #[arg(long, value_name = "FRICTION")]
    friction: Option<String>,
    /// Tie a knot: `over` or `under` for each crossing, in the order of the second passes
    ///
    /// The part of the pattern beyond the length of the rod is the path of its end.
    #[arg(long, value_name = "PASS,...", value_delimiter = ',', value_parser = named(&PASSES))]
    knot: Vec<Pass>,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
enum SolverName {
    /// The equations of the suspended rod.
    Exact,
    /// A network; the equations outside of its range.
    Neural,
}

/// Numbers and files of a plan.
#[derive(Serialize)]
pub struct Report {
    pattern: String,
    rod: String,
    scheme: Scheme,
    solver: SolverName,
    length_m: f64,
    lead_in_m: f64,
    lead_out_m: f64,
    rod_length_m: f64,
    deviation_m: f64,
    #[serde(flatten)]
    feasibility: Feasibility,
    crossings: Vec<CrossingReport>,
    poses: usize,
    /// Number of poses outside the range of the network.
    #[serde(skip_serializing_if = "Option::is_none")]
    solved_exactly: Option<usize>,
    /// Number of answers of the network that differed from the equations and were replaced.
    #[serde(skip_serializing_if = "Option::is_none")]
    rejected_answers: Option<usize>,
    unstable_poses: usize,
    duration_s: f64,
    files: Vec<PathBuf>,
}

#[derive(Serialize)]
struct CrossingReport {
    first_m: f64,
    second_m: f64,
    x_m: f64,
    y_m: f64,
}

/// Numbers and files of the strokes of a drawing.
#[derive(Serialize)]
struct Strokes {
    strokes: Vec<Report>,
    picture: PathBuf,
}

/// A plan and the names and texts of its files.
struct PlanFiles {
    plan: WrittenPlan,
    files: Vec<(String, String)>,
}

/// A plan that was written to files.
pub struct WrittenPlan {
    /// Numbers of the plan, as text.
    pub report: Report,
    /// The rod.
    pub rod: DeployedRod,
    /// The path along which the rod is laid.
    pub path: LaidPath,
    /// Plan of the knot, if one is tied.
    pub knot: Option<KnotPlan>,
}

impl DeploymentArguments {
    /// Plans, writes trajectory, pattern and figure, and prints the numbers.
    pub fn plan(&self) -> Result<(), Failure> {
        let part = match self.what.lead_out {
            Some(LeadLength::Auto) => 1.0,
            _ => 0.0,
        };
        let spare = Spare {
            part,
            ..Spare::HANGS
        };
        let plans = self.what.strokes()?;
        if let [plan] = &plans[..] {
            return print_json(&plan.write(&self.out, &spare)?.report);
        }
        let planned = plans.iter().map(|plan| plan.plan(&spare));
        let planned = planned.collect::<Result<Vec<_>, _>>()?;
        let folders = (0..).map(|stroke| self.out.join(stroke_folder(stroke)));
        let written = planned.into_iter().zip(folders);
        let written = written.map(|(plan, folder)| Ok(plan.write(&folder)?.report));
        let strokes = written.collect::<Result<Vec<_>, Failure>>()?;
        let picture = self.out.join("strokes.svg");
        let drawn = plans.iter().map(|plan| plan.source.source());
        let drawn = drawn.collect::<Result<Vec<_>, _>>()?;
        let drawn = drawn.iter().map(PatternSource::drawn_points);
        write_file(&picture, stroke_picture(drawn).as_bytes())?;
        print_json(&Strokes { strokes, picture })
    }
}

impl PlanFiles {
    fn write(mut self, out: &Path) -> Result<WrittenPlan, Failure> {
        make_directory(out)?;
        for (name, text) in self.files {
            let path = out.join(name);
            write_file(&path, text.as_bytes())?;
            self.plan.report.files.push(path);
        }
        Ok(self.plan)
    }
}

impl DeploymentPlan {
    /// Plans, and writes trajectory, pattern and figure into a directory. `spare` determines how
    /// the spare length of a rod is laid, unless the arguments do.
    pub fn write(&self, out: &Path, spare: &Spare<'_>) -> Result<WrittenPlan, Failure> {
        self.plan(spare)?.write(out)
    }

    /// Plans without writing files.
    fn plan(&self, spare: &Spare<'_>) -> Result<PlanFiles, Failure> {
        let mut file = RodFile::read(self.rod_file()?)?;
        let source = self.fitted()?;
        file.rod.length = self.cut_length()?.unwrap_or(file.rod.length);
        let rod = file.rod;
        let network = self.network()?;
        let mut request = self.request();
        request.friction = self.friction(&file)?;
        if let Some(network) = &network {
            request.grasps = OptimalGrasps::Neural(network);
        }
        let planned = request.plan(&source, &rod, spare);
        let planned = planned.map_err(|error| {
            let way_out = way_out(&error, &request, &source, &rod, spare);
            self.refused(error).followed_by(&way_out)
        })?;
        let (path, pattern) = (planned.path, planned.pattern);
        let knot = planned.knot.map(|(pattern, passages)| {
            let laying = path.poses.clone();
            let rods = vec![PlannedRod {
                rod,
                pattern,
                laying,
            }];
            KnotPlan::new(rods, passages)
        });
        let laid_by = planned.times.last().copied().unwrap_or(0.0);
        let duration = laid_by + knot.as_ref().map_or(0.0, KnotPlan::duration);
        let leads = || knot.iter().flat_map(|knot| &knot.leads);
        let later = |&(time, position, rotation)| (laid_by + time, position, rotation);
        let mut followed = timed(&path.poses, &planned.times);
        let led = leads().flat_map(|lead| lead.end.iter().skip(1));
        followed.extend(led.map(later));
        let when = |s: f64| when_laid(&path.poses, &planned.times, s);
        let end = pattern.length() - pattern.lead_out();
        let name = self.source.name();
        let title = format!("{} along {name}", file.title);
        let of_rod = (file.title.as_str(), rod.gravito_bending_length);
        let [pattern_file, figure] = path_files(
            &title,
            &path,
            &planned.demands,
            &planned.crossings,
            request.friction,
        );
        let mut named = vec![
            ("trajectory.csv".to_owned(), trajectory_csv(&followed)?),
            (
                "trajectory.json".to_owned(),
                trajectory_json(&followed, name, of_rod)?,
            ),
            pattern_file,
            figure,
        ];
        for (lift, number) in leads().flat_map(|lead| &lead.lifts).zip(1..) {
            let poses: Vec<_> = lift.poses.iter().map(later).collect();
            named.push((format!("lift_{number}.csv"), trajectory_csv(&poses)?));
        }
        // A scenario can use only the built-in network.
        if self.model.is_none() {
            let simulated = Landing {
                rod: &file,
                name,
                source: &source,
                request: &request,
                lead_in: planned.bent,
                duration: when(end) - when(path.lead_in - planned.bent) + (duration - laid_by),
            };
            named.push(("landing.toml".to_owned(), simulated.scenario()));
        }
        if let PatternSource::Drawn { points, .. } = &source {
            named.push((Landing::DRAWING.to_owned(), drawing_csv(points)));
        }
        warn_of_sliding(&planned.feasibility, name);
        let exact = path.poses.iter().filter(|pose| pose.grasp.is_some());
        let report = Report {
            pattern: name.to_owned(),
            rod: file.title,
            scheme: self.scheme,
            solver: self.solver,
            length_m: end,
            lead_in_m: path.lead_in,
            lead_out_m: pattern.lead_out(),
            rod_length_m: rod.length,
            deviation_m: pattern.deviation,
            feasibility: planned.feasibility,
            crossings: planned.crossings.iter().map(CrossingReport::of).collect(),
            unstable_poses: path.poses.iter().filter(|pose| is_unstable(pose)).count(),
            poses: path.poses.len(),
            solved_exactly: network.as_ref().map(|_| exact.count() - path.rejected),
            rejected_answers: network.as_ref().map(|_| path.rejected),
            duration_s: duration,
            files: Vec::new(),
        };
        Ok(PlanFiles {
            plan: WrittenPlan {
                report,
                rod,
                path,
                knot,
            },
            files: named,
        })
    }

    /// The request, as far as the arguments define it.
    pub(super) fn request(&self) -> DeploymentRequest<'_> {
        DeploymentRequest {
            lead_in: self.lead_in,
            lead_out: self.lead_out.unwrap_or_default(),
            step: self.step,
            speed: self.speed,
            scheme: self.scheme,
            knot: self.knot.clone(),
            ..DeploymentRequest::default()
        }
    }

    /// The plan of a knot of this rod and a second one. `second` is the file of the second rod,
    /// `source` its pattern.
    pub fn knot_with(&self, second: &Path, source: &PatternSource) -> Result<KnotPlan, Failure> {
        let rods = [
            RodFile::read(self.rod_file()?)?.rod,
            RodFile::read(second)?.rod,
        ];
        let first = self.source.source()?;
        let request = self.request();
        let mut planned = Vec::new();
        for (rod, source) in rods.into_iter().zip([&first, source]) {
            let tied = request.tied(source, &rod);
            let (pattern, path) = tied.map_err(|error| self.refused(error))?;
            planned.push(PlannedRod {
                rod,
                pattern,
                laying: path.poses,
            });
        }
        let tied = planned.iter().map(|rod| (&rod.rod, &rod.pattern));
        let passages = request.passages(&tied.collect::<Vec<_>>());
        let passages = passages.map_err(|error| self.refused(error.into()))?;
        Ok(KnotPlan::new(planned, passages))
    }

    /// Rejects a knot that cannot be tied with these arguments.
    pub fn check_knot(&self) -> Result<(), Failure> {
        let rod = RodFile::read(self.rod_file()?)?.rod;
        let (request, source) = (self.request(), self.source.source()?);
        let pattern = request.pattern(&source, &rod).map_err(RequestError::from);
        let passages = pattern.and_then(|pattern| Ok(request.passages(&[(&rod, &pattern)])?));
        passages.map_err(|error| self.refused(error))?;
        Ok(())
    }

    /// Uses the rod of a cell if the arguments name none.
    pub fn use_rod_of(&self, cell: &Cell) {
        if let (None, Some(file)) = (&self.rod, &cell.rod) {
            tracing::warn!("no --rod: using {} of the cell", file.display());
            self.chosen.get_or_init(|| file.clone());
        }
    }

    /// Uses an identified rod instead of the expected one.
    pub fn use_identified(&self, file: PathBuf) {
        self.identified.get_or_init(|| file);
    }

    /// The file of the rod as given.
    pub fn given_rod(&self) -> Option<&Path> {
        self.rod.as_deref()
    }

    /// The file of the identified rod, otherwise of the expected one.
    pub fn rod_file(&self) -> Result<&Path, Failure> {
        match self.identified.get() {
            Some(identified) => Ok(identified),
            None => self.expected_rod(),
        }
    }

    /// The given file of the rod, or that of the preset chosen for the pattern.
    pub fn expected_rod(&self) -> Result<&Path, Failure> {
        if let Some(given) = self.rod.as_ref().or(self.chosen.get()) {
            return Ok(given);
        }
        let source = self.source.source()?;
        // For a pattern with sharp corners, use the drawn length.
        let length = match source.pattern() {
            Err(PatternError::Deviation { .. }) => source.drawn_length(),
            pattern => pattern.at(self.source.name())?.length(),
        };
        let chosen = match self.ties_knot() {
            true => rod_for_knot(length)?,
            false => rod_for(length)?,
        };
        Ok(self.chosen.get_or_init(|| chosen))
    }

    /// The pattern of a second rod, see [`PatternArguments::second`].
    pub fn second_source(
        &self,
        file: Option<&Path>,
        stroke: Option<&StrokeChoice>,
    ) -> Result<PatternSource, Failure> {
        self.source.second(file, stroke)
    }

    /// Whether a knot is tied.
    pub fn ties_knot(&self) -> bool {
        !self.knot.is_empty()
    }

    /// The pattern as given.
    pub fn pattern_name(&self) -> &str {
        self.source.name()
    }

    fn refused(&self, error: RequestError) -> Failure {
        let name = self.source.name();
        match error {
            RequestError::Deployment(DeploymentError::NotFinite { s_m }) => {
                let what = format!("{name}: the pose of the gripper at {s_m:.4} m");
                NotFinite { what }.into()
            }
            RequestError::Tying(error) => Failure::Input(format!("--knot: {name}: {error}")),
            RequestError::TooManyPoses { step, length } => Failure::Input(format!(
                "--step {step} m cuts {length:.4} m into more than {MOST_POSES} poses"
            )),
            error => Failure::Input(format!("{name}: {error}")),
        }
    }

    fn friction(&self, file: &RodFile) -> Result<Option<f64>, Failure> {
        let Some(text) = &self.friction else {
            return Ok(None);
        };
        let number = text.trim().parse().ok().filter(|friction| *friction >= 0.0);
        let named = || file.friction.get(text.trim()).copied();
        number
            .filter(|friction: &f64| friction.is_finite())
            .or_else(named)
            .map(Some)
            .ok_or_else(|| {
                let names: Vec<&str> = file.friction.keys().map(String::as_str).collect();
                Failure::Input(format!(
                    "--friction {text}: a number from 0 up is needed, or a name in {}: {}",
                    self.rod_file().unwrap_or(Path::new("the rod")).display(),
                    if names.is_empty() {
                        "none there".into()
                    } else {
                        names.join(", ")
                    }
                ))
            })
    }

    /// The network that predicts the grasps, if one is used.
    fn network(&self) -> Result<Option<Cow<'static, NeuralGrasps>>, Failure> {
        match (self.solver, self.scheme, &self.model) {
            (SolverName::Exact, _, Some(_)) => {
                Err(Failure::Input("--model is for --solver neural".into()))
            }
            (SolverName::Neural, Scheme::Intuitive, _) => Err(Failure::Input(
                "--solver neural is for --scheme optimal: the intuitive scheme needs no grasps"
                    .into(),
            )),
            (SolverName::Exact, ..) => Ok(None),
            (SolverName::Neural, _, None) => Ok(Some(Cow::Borrowed(NeuralGrasps::built_in()))),
            (SolverName::Neural, _, Some(path)) => {
                let network = NeuralGrasps::read(path);
                let network = network.map_err(Failure::input)?;
                Ok(Some(Cow::Owned(network)))
            }
        }
    }
}

/// Advice about the size of a drawing and the options with which it can be planned; empty if its
/// size and corners are not the problem.
fn way_out(
    error: &RequestError,
    request: &DeploymentRequest<'_>,
    source: &PatternSource,
    rod: &DeployedRod,
    spare: &Spare<'_>,
) -> String {
    let of_size = [
        matches!(error, RequestError::Pattern(PatternError::Deviation { .. })),
        matches!(error, RequestError::TooManyPoses { .. }),
        matches!(
            error,
            RequestError::Deployment(
                DeploymentError::TooLong { .. }
                    | DeploymentError::TooSharp { .. }
                    | DeploymentError::Grasp { .. }
            )
        ),
    ];
    let PatternSource::Drawn { points, .. } = source else {
        return String::new();
    };
    if !of_size.contains(&true) {
        return String::new();
    }
    let [width, height] = extent(points).map(|side| 1e3 * side);
    let mut text = format!("\nThe drawing was read as {width:.1} mm × {height:.1} mm");
    let _ = match request.remedy(source, rod, spare) {
        Some(remedy) => write!(text, "; it can be laid with {remedy}"),
        None => write!(
            text,
            "; it cannot be laid with any size, or any deviation up to a tenth of its size, that \
             was tried"
        ),
    };
    text
}

impl CrossingReport {
    fn of(crossing: &Crossing) -> Self {
        Self {
            first_m: crossing.first,
            second_m: crossing.second,
            x_m: crossing.position.x,
            y_m: crossing.position.y,
        }
    }
}

/// Warns if a pattern needs more friction than the table has.
fn warn_of_sliding(feasibility: &Feasibility, name: &str) {
    let demand = feasibility.largest_demand;
    let table = match feasibility.friction {
        Some(friction) if demand > friction => format!("the table has {friction}"),
        None if demand > LARGEST_FRICTION => "few tables have more than 1".to_owned(),
        _ => return,
    };
    tracing::warn!(
        "{name} needs friction of up to {demand:.2}, and {table}: the rod will slide there; draw it larger, or with rounder bends"
    );
}

fn is_unstable(pose: &GripperPose) -> bool {
    pose.grasp.as_ref().is_some_and(|grasp| !grasp.is_stable())
}

fn lead(text: &str) -> Result<LeadLength, String> {
    match text.trim() {
        "auto" => Ok(LeadLength::Auto),
        "none" => Ok(LeadLength::Given(0.0)),
        text => positive_length(text)
            .map(LeadLength::Given)
            .map_err(|error| format!("{error}; or `auto`, or `none`")),
    }
}
