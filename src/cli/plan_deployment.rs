//! `rodlab plan deployment`.

use super::deployed_rod::RodFile;
use super::deployment_files::{
    DRAWING, Landing, drawing_csv, landing, pattern_csv, trajectory_csv, trajectory_json,
};
use super::failure::Failure;
use super::output::{print_json, write_file};
use super::pattern_source::PatternArguments;
use super::values::{positive_length, speed};
use clap::{Args, ValueEnum};
use rodlab_files::finite::NotFinite;
use rodlab_planning::plan::deployment::{
    DeployedRod, DeploymentError, Feasibility, GripperPose, LaidPath, MOST_POSES, OptimalGrasps,
    Scheme, Spare, Trajectory, checked_points, checked_trajectory, deployment_figure,
    friction_demands, lead_length, long_enough, times, trajectory, when_laid, with_spare_laid,
};
use rodlab_planning::plan::grasp::NeuralGrasps;
use rodlab_planning::plan::pattern::{Crossing, Pattern, PatternSource, Point, crossings};
use rodlab_planning::plan::tying::{Pass, Passage, TiedRod, laid_length, passages};
use rodlab_workcell::task::{KnotPlan, PlannedRod};
use serde::Serialize;
use std::borrow::Cow;
use std::path::{Path, PathBuf};

/// Arguments of `rodlab plan deployment`.
#[derive(Debug, Args)]
pub struct DeploymentArguments {
    #[command(flatten)]
    what: DeploymentPlan,
    /// Where to write the results
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

/// What is laid along what, and how.
#[derive(Debug, Args)]
pub struct DeploymentPlan {
    #[command(flatten)]
    source: PatternArguments,
    /// The rod: TOML with gravito_bending_length, radius and length in [deployment.rod]
    #[arg(long, value_name = "FILE")]
    rod: PathBuf,
    /// How the gripper leads the rod
    #[arg(long, default_value = "optimal")]
    scheme: SchemeName,
    /// Who finds the optimal grasps
    #[arg(long, default_value = "exact")]
    solver: SolverName,
    /// The network of --solver neural, from `rodlab train` [default: the one in this program]
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,
    /// Length of a straight start whose curvature grows to that of the pattern: `auto`, as the friction demand of 0.1
    /// needs it, but shorter where it would bend below three radii of the rod or coil, `none`, or a length
    #[arg(long, value_name = "LENGTH", default_value = "auto", value_parser = lead)]
    lead_in: LeadLength,
    /// How far the rod is laid on behind the pattern: `auto`, where it is longer than that, all but 2.5 gravito-bending lengths of
    /// it (behind the pattern as far as there is room on the table and in the picture of the camera, the rest straight in front of
    /// it), `none`, or a length [default: auto where a cell is known, otherwise none]
    #[arg(long, value_name = "LENGTH", value_parser = lead)]
    lead_out: Option<LeadLength>,
    /// Distance of neighbouring poses along the pattern, at most
    #[arg(long, value_name = "LENGTH", default_value = "3 mm", value_parser = positive_length)]
    step: f64,
    /// Speed of laying along the pattern, m/s; slower where the gripper would have to move more than 1.5 times as fast
    #[arg(long, value_name = "SPEED", default_value_t = 0.02, value_parser = speed)]
    speed: f64,
    /// Friction of the table that the demand is compared with: a number, or a name in the rod's file
    #[arg(long, value_name = "FRICTION")]
    friction: Option<String>,
    /// Tie a knot: `over` or `under` for each crossing, in the order in which the pattern comes there again; what is longer than the
    /// rod is the path of its end
    #[arg(long, value_name = "PASS,...", value_delimiter = ',')]
    knot: Vec<PassName>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum PassName {
    /// Over what lies there.
    Over,
    /// Under it, when it is lifted.
    Under,
}

#[derive(Clone, Copy, Debug, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
enum SchemeName {
    /// The optimal grasp of each point.
    Optimal,
    /// Upright above the contact node.
    Intuitive,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
enum SolverName {
    /// The equations of the suspended rod.
    Exact,
    /// A network; the equations where it has not learned them.
    Neural,
}

#[derive(Clone, Copy, Debug)]
enum LeadLength {
    Auto,
    Given(f64),
}

/// Numbers of a plan, and its files.
#[derive(Serialize)]
pub struct Report {
    pattern: String,
    rod: String,
    scheme: SchemeName,
    solver: SolverName,
    length_m: f64,
    lead_in_m: f64,
    lead_out_m: f64,
    rod_length_m: f64,
    deviation_m: f64,
    least_radius_m: Option<f64>,
    least_radius_at_m: f64,
    /// Of the lying rod or at the contact node.
    largest_friction_demand: f64,
    largest_friction_demand_at_m: f64,
    /// Of the lying rod alone (thesis Eq. 5.2).
    largest_lying_friction_demand: f64,
    friction: Option<f64>,
    share_above_friction: Option<f64>,
    crossings: Vec<CrossingReport>,
    poses: usize,
    /// Poses out of the range of the network.
    #[serde(skip_serializing_if = "Option::is_none")]
    solved_exactly: Option<usize>,
    /// Answers of the network that are not those of the equations, and were replaced.
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

/// A plan that was written.
pub struct WrittenPlan {
    /// Its numbers, for people.
    pub report: Report,
    /// The rod.
    pub rod: DeployedRod,
    /// The path along which it is laid.
    pub path: LaidPath,
    /// What follows where a knot is tied.
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
        print_json(&self.what.write(&self.out, &spare)?.report)
    }
}

impl DeploymentPlan {
    /// Plans, and writes trajectory, pattern and figure into a directory. `spare` says what is done with a rod that is longer
    /// than its pattern, unless the arguments do.
    ///
    /// # Errors
    /// The rod, the pattern or an argument is faulty, or a file cannot be written.
    pub fn write(&self, out: &Path, spare: &Spare<'_>) -> Result<WrittenPlan, Failure> {
        let file = RodFile::read(&self.rod)?;
        let rod = file.rod;
        let friction = self.friction(&file)?;
        let source = self.source.source()?;
        let pattern = self.pattern(&source, &rod)?;
        let passages = self.passages(&pattern, &rod)?;
        let bent = pattern.lead_in();
        let pattern = match passages {
            Some(_) => pattern.shortened(laid_length(&rod)),
            None => self.with_lead_out(pattern, &rod, spare),
        };
        let (lead_in, end) = (pattern.lead_in(), pattern.length() - pattern.lead_out());
        // Before anything is sampled: it may be very long.
        long_enough(&rod, &pattern).map_err(|error| self.refused(&error))?;
        if pattern.length() / self.step > MOST_POSES {
            return Err(Failure::Input(format!(
                "--step {} m cuts {:.4} m into more than {MOST_POSES} poses",
                self.step,
                pattern.length()
            )));
        }
        let points = pattern.sampled(self.step);
        let checked =
            checked_points(&pattern, self.step, &rod).map_err(|error| self.refused(&error))?;
        let scheme = match self.scheme {
            SchemeName::Optimal => Scheme::Optimal,
            SchemeName::Intuitive => Scheme::Intuitive,
        };
        let network = self.network()?;
        let grasps = network.as_ref().map_or(OptimalGrasps::Exact, |network| {
            OptimalGrasps::Neural(network)
        });
        let Trajectory { poses, rejected } = checked_trajectory(&points, &rod, scheme, grasps)
            .map_err(|error| self.refused(&error))?;
        let checks = Feasibility::of(&checked, &rod, friction, &poses);
        let crossings = crossings(&points);
        let demands = friction_demands(&rod, &points, &poses);
        let title = format!("{} along {}", file.title, self.source.name());
        let figure = deployment_figure(&title, &points, &poses, &demands, friction, &crossings);
        let times = times(&poses, self.speed);
        let laid_by = times.last().copied().unwrap_or(0.0);
        let when = |s: f64| when_laid(&poses, &times, s);
        let tied = passages.map(|passages| {
            let whole = self.pattern(&source, &rod)?;
            let planned = PlannedRod {
                rod,
                pattern: whole,
                laying: poses.clone(),
            };
            Ok::<_, Failure>(KnotPlan::new(vec![planned], passages))
        });
        let knot = tied.transpose()?;
        let tying = knot.as_ref().map_or(0.0, KnotPlan::duration);
        let leads = || knot.iter().flat_map(|knot| &knot.leads);
        let duration = laid_by + tying;
        let mut followed = poses.clone();
        let mut followed_times = times.clone();
        for (time, position, rotation) in leads().flat_map(|lead| lead.end.iter().skip(1)) {
            followed.push(GripperPose {
                s: rod.length,
                position: *position,
                rotation: *rotation,
                grasp: None,
                contact_demand: None,
            });
            followed_times.push(laid_by + time);
        }
        let simulated = Landing {
            file: &file,
            name: self.source.name(),
            source: &source,
            lead_in: bent,
            scheme,
            is_neural: network.is_some(),
            friction,
            knot: self.knot.iter().map(|pass| Pass::from(*pass)).collect(),
            duration: when(end) - when(lead_in - bent) + (duration - laid_by),
        };
        let mut named = vec![
            (
                "trajectory.csv".to_owned(),
                trajectory_csv(&followed, &followed_times)?,
            ),
            (
                "trajectory.json".to_owned(),
                trajectory_json(&followed, &followed_times, self.source.name(), &file)?,
            ),
            ("pattern.csv".to_owned(), pattern_csv(&points, &demands)),
            ("deployment.svg".to_owned(), figure),
        ];
        for (index, lift) in leads().flat_map(|lead| &lead.lifts).enumerate() {
            let poses = lift.poses.iter();
            let (times, poses): (Vec<f64>, Vec<GripperPose>) = poses
                .map(|&(time, position, rotation)| {
                    let pose = GripperPose {
                        s: rod.length,
                        position,
                        rotation,
                        grasp: None,
                        contact_demand: None,
                    };
                    (laid_by + time, pose)
                })
                .unzip();
            let name = format!("lift_{}.csv", index + 1);
            named.push((name, trajectory_csv(&poses, &times)?));
        }
        // A scenario knows the network of the program only.
        if self.model.is_none() {
            named.push(("landing.toml".to_owned(), landing(&simulated)));
        }
        if let PatternSource::Drawn { points, .. } = &source {
            named.push((DRAWING.to_owned(), drawing_csv(points)));
        }
        std::fs::create_dir_all(out).map_err(|error| {
            Failure::System(format!("{} cannot be made: {error}", out.display()))
        })?;
        let mut files = Vec::new();
        for (name, text) in named {
            let path = out.join(name);
            write_file(&path, text.as_bytes())?;
            files.push(path);
        }
        let report = Report {
            pattern: self.source.name().to_owned(),
            rod: file.title,
            scheme: self.scheme,
            solver: self.solver,
            length_m: end,
            lead_in_m: lead_in,
            lead_out_m: pattern.lead_out(),
            rod_length_m: rod.length,
            deviation_m: pattern.deviation,
            least_radius_m: Some(checks.least_radius_m).filter(|radius| radius.is_finite()),
            least_radius_at_m: checks.least_radius_at_m,
            largest_friction_demand: checks.largest_demand,
            largest_friction_demand_at_m: checks.largest_demand_at_m,
            largest_lying_friction_demand: checks.largest_lying_demand,
            friction,
            share_above_friction: checks.share_above_friction,
            crossings: crossings.iter().map(CrossingReport::of).collect(),
            unstable_poses: poses.iter().filter(|pose| is_unstable(pose)).count(),
            poses: poses.len(),
            solved_exactly: network.as_ref().map(|_| {
                let exact = poses.iter().filter(|pose| pose.grasp.is_some()).count();
                exact - rejected
            }),
            rejected_answers: network.map(|_| rejected),
            duration_s: duration,
            files,
        };
        Ok(WrittenPlan {
            report,
            rod,
            path: LaidPath {
                lays_spare: lead_in > bent || pattern.lead_out() > 0.0,
                lead_in,
                poses,
                points,
            },
            knot,
        })
    }

    /// The plan of a knot of this rod and of a second one, by its file, along another pattern.
    ///
    /// # Errors
    /// A rod, a pattern or an argument is faulty, or they do not go together.
    pub fn knot_with(&self, second: &Path, source: &PatternSource) -> Result<KnotPlan, Failure> {
        let rods = [RodFile::read(&self.rod)?.rod, RodFile::read(second)?.rod];
        let first = self.source.source()?;
        let sources = [&first, source];
        let scheme = match self.scheme {
            SchemeName::Optimal => Scheme::Optimal,
            SchemeName::Intuitive => Scheme::Intuitive,
        };
        let mut planned = Vec::new();
        for (rod, source) in rods.into_iter().zip(sources) {
            let laid = self.pattern(source, &rod)?.shortened(laid_length(&rod));
            long_enough(&rod, &laid).map_err(|error| self.refused(&error))?;
            if laid.length() / self.step > MOST_POSES {
                return Err(Failure::Input(format!(
                    "--step {} m cuts {:.4} m into more than {MOST_POSES} poses",
                    self.step,
                    laid.length()
                )));
            }
            let points = laid.sampled(self.step);
            let laying = trajectory(&points, &rod, scheme, OptimalGrasps::Exact);
            planned.push(PlannedRod {
                rod,
                pattern: self.pattern(source, &rod)?,
                laying: laying.map_err(|error| self.refused(&error))?,
            });
        }
        let tied = planned.iter().map(|planned| TiedRod {
            rod: &planned.rod,
            curve: &planned.pattern,
        });
        let words: Vec<Pass> = self.knot.iter().map(|pass| Pass::from(*pass)).collect();
        let passages = passages(&tied.collect::<Vec<_>>(), &words);
        let passages = passages
            .map_err(|error| Failure::Input(format!("--knot: {}: {error}", self.source.name())))?;
        Ok(KnotPlan::new(planned, passages))
    }

    /// Refuses a knot that cannot be tied so.
    ///
    /// # Errors
    /// The rod, the pattern or an argument is faulty, or they do not go together.
    pub fn check_knot(&self) -> Result<(), Failure> {
        let rod = RodFile::read(&self.rod)?.rod;
        let pattern = self.pattern(&self.source.source()?, &rod)?;
        self.passages(&pattern, &rod).map(|_| ())
    }

    /// The pattern without lead-in and lead-out, m.
    ///
    /// # Errors
    /// The pattern or an argument is faulty.
    pub fn outline(&self) -> Result<Vec<Point>, Failure> {
        let pattern = self.source.source()?.pattern();
        let pattern = pattern.map_err(|error| self.source.no_pattern(&error))?;
        // It may be very long.
        let step = self.step.max(pattern.length() / MOST_POSES);
        let points = pattern.sampled(step).into_iter();
        Ok(points.map(|point| point.position).collect())
    }

    /// The pattern of a second rod, see [`PatternArguments::second`].
    ///
    /// # Errors
    /// As there.
    pub fn second_source(
        &self,
        file: Option<&Path>,
        stroke: Option<usize>,
    ) -> Result<PatternSource, Failure> {
        self.source.second(file, stroke)
    }

    /// Whether a knot is tied.
    pub fn ties_knot(&self) -> bool {
        !self.knot.is_empty()
    }

    /// The pattern as it was given.
    pub fn pattern_name(&self) -> &str {
        self.source.name()
    }

    /// The crossings of a knot; `None` where none is tied.
    fn passages(
        &self,
        pattern: &Pattern,
        rod: &DeployedRod,
    ) -> Result<Option<Vec<Passage>>, Failure> {
        if self.knot.is_empty() {
            return Ok(None);
        }
        let words: Vec<Pass> = self.knot.iter().map(|pass| Pass::from(*pass)).collect();
        let tied = TiedRod {
            rod,
            curve: pattern,
        };
        let passages = passages(&[tied], &words);
        passages
            .map(Some)
            .map_err(|error| Failure::Input(format!("--knot: {}: {error}", self.source.name())))
    }

    fn refused(&self, error: &DeploymentError) -> Failure {
        if let DeploymentError::NotFinite { s_m } = error {
            let what = format!(
                "{}: the pose of the gripper at {s_m:.4} m",
                self.source.name()
            );
            return NotFinite { what }.into();
        }
        Failure::Input(format!("{}: {error}", self.source.name()))
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
                    self.rod.display(),
                    if names.is_empty() {
                        "none there".into()
                    } else {
                        names.join(", ")
                    }
                ))
            })
    }

    /// The network that finds the grasps, if one does.
    fn network(&self) -> Result<Option<Cow<'static, NeuralGrasps>>, Failure> {
        match (self.solver, self.scheme, &self.model) {
            (SolverName::Exact, _, Some(_)) => {
                Err(Failure::Input("--model is for --solver neural".into()))
            }
            (SolverName::Neural, SchemeName::Intuitive, _) => Err(Failure::Input(
                "--solver neural is for --scheme optimal: the intuitive scheme asks for no grasps"
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

    /// The pattern with its lead-in.
    fn pattern(&self, source: &PatternSource, rod: &DeployedRod) -> Result<Pattern, Failure> {
        let pattern = source
            .pattern()
            .map_err(|error| self.source.no_pattern(&error))?;
        let length = match self.lead_in {
            LeadLength::Given(length) => length,
            LeadLength::Auto => lead_length(rod, &pattern.at(0.0)),
        };
        Ok(pattern.with_lead_in(length))
    }

    /// The pattern and, where it is wanted, what the rod is longer than it.
    fn with_lead_out(&self, pattern: Pattern, rod: &DeployedRod, spare: &Spare<'_>) -> Pattern {
        if let Some(LeadLength::Given(length)) = self.lead_out {
            let last = pattern.at(pattern.length());
            return pattern.with_lead_out(lead_length(rod, &last.turned_round()), length);
        }
        with_spare_laid(pattern, rod, spare)
    }
}

impl From<PassName> for Pass {
    fn from(name: PassName) -> Self {
        match name {
            PassName::Over => Self::Over,
            PassName::Under => Self::Under,
        }
    }
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
