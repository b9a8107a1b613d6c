//! `rodlab plan deployment`.

use super::deployed_rod::RodFile;
use super::deployment_files::{
    DRAWING, Landing, drawing_csv, landing, pattern_csv, trajectory_csv, trajectory_json,
};
use super::drawn_pattern::drawn_points;
use super::failure::Failure;
use super::output::{print_json, write_file};
use super::values::positive_length;
use crate::plan::deployment::{
    DeployedRod, DeploymentError, Feasibility, GripperPose, MOST_POSES, OptimalGrasps, Scheme,
    deployment_figure, friction_demand, lead_in_length, long_enough, times, trajectory,
};
use crate::plan::grasp::NeuralGrasps;
use crate::plan::pattern::{
    Circle, Crossing, Drawing, Line, Pattern, PatternError, PatternPoint, PatternSource, Point,
    Sine, crossings,
};
use crate::plan::tying::{
    GripperPoses, Handling, LiftPath, Pass, Passage, Schedule, TiedRod, TyingTask, laid_length,
    passages,
};
use crate::scenario::metres;
use clap::{Args, ValueEnum};
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
    /// The pattern: an SVG file; a CSV file with columns x_m and y_m; or line:LENGTH, circle:RADIUS,
    /// sine:AMPLITUDE,WAVELENGTH,WAVES
    #[arg(long, value_name = "PATTERN")]
    pattern: String,
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
    /// Length of the longer side of a drawn pattern [default: as drawn]
    #[arg(long, value_name = "LENGTH", value_parser = positive_length)]
    size: Option<f64>,
    /// Which stroke of an SVG, or strand of a CSV file, from 1
    #[arg(long, value_name = "N")]
    stroke: Option<usize>,
    /// Lay it from the last point to the first
    #[arg(long)]
    reverse: bool,
    /// How far the smooth curve may be from what was drawn
    #[arg(long, value_name = "LENGTH", default_value = "0.25 mm", value_parser = positive_length)]
    deviation: f64,
    /// Length of a straight start whose curvature grows to that of the pattern: `auto`, as the friction demand of 0.1
    /// needs it, `none`, or a length
    #[arg(long, value_name = "LENGTH", default_value = "auto", value_parser = lead_in)]
    lead_in: LeadInLength,
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
enum LeadInLength {
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
    rod_length_m: f64,
    deviation_m: f64,
    least_radius_m: Option<f64>,
    least_radius_at_m: f64,
    largest_friction_demand: f64,
    largest_friction_demand_at_m: f64,
    friction: Option<f64>,
    share_above_friction: Option<f64>,
    crossings: Vec<CrossingReport>,
    poses: usize,
    /// Poses that the network does not know.
    #[serde(skip_serializing_if = "Option::is_none")]
    solved_exactly: Option<usize>,
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
    /// Poses of the gripper that lays it.
    pub poses: Vec<GripperPose>,
    /// The pattern with its lead-in.
    pub points: Vec<PatternPoint>,
    /// Length of that, m.
    pub lead_in: f64,
}

impl DeploymentArguments {
    /// Plans, writes trajectory, pattern and figure, and prints the numbers.
    pub fn plan(&self) -> Result<(), Failure> {
        print_json(&self.what.write(&self.out)?.report)
    }
}

impl DeploymentPlan {
    /// Plans, and writes trajectory, pattern and figure into a directory.
    ///
    /// # Errors
    /// The rod, the pattern or an argument is faulty, or a file cannot be written.
    pub fn write(&self, out: &Path) -> Result<WrittenPlan, Failure> {
        let file = RodFile::read(&self.rod)?;
        let rod = file.rod;
        let friction = self.friction(&file)?;
        let source = self.source()?;
        let pattern = self.pattern(&source, &rod)?;
        let knot = self.passages(&pattern, &rod)?;
        let pattern = match knot {
            Some(_) => pattern.shortened(laid_length(&rod)),
            None => pattern,
        };
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
        let checks = Feasibility::of(&pattern, self.step, &rod, friction)
            .map_err(|error| self.refused(&error))?;
        let scheme = match self.scheme {
            SchemeName::Optimal => Scheme::Optimal,
            SchemeName::Intuitive => Scheme::Intuitive,
        };
        let network = self.network()?;
        let grasps = network.as_ref().map_or(OptimalGrasps::Exact, |network| {
            OptimalGrasps::Neural(network)
        });
        let poses =
            trajectory(&points, &rod, scheme, grasps).map_err(|error| self.refused(&error))?;
        let crossings = crossings(&points);
        let demands: Vec<f64> = points
            .iter()
            .map(|point| friction_demand(&rod, point))
            .collect();
        let title = format!("{} along {}", file.title, self.pattern);
        let figure = deployment_figure(&title, &points, &poses, &demands, friction, &crossings);
        let times = times(&poses, self.speed);
        let laid_by = times.last().copied().unwrap_or(0.0);
        let tied = knot.as_ref().zip(poses.last());
        let tied = tied.map(|(passages, last)| self.tied(passages, &source, &rod, last));
        let tied = tied.transpose()?;
        let duration = laid_by + tied.as_ref().map_or(0.0, |tied| tied.duration);
        let mut followed = poses.clone();
        let mut followed_times = times.clone();
        for (time, position, rotation) in tied.iter().flat_map(|tied| tied.end.iter().skip(1)) {
            followed.push(GripperPose {
                s: rod.length,
                position: *position,
                rotation: *rotation,
                grasp: None,
            });
            followed_times.push(laid_by + time);
        }
        let simulated = Landing {
            file: &file,
            name: &self.pattern,
            source: &source,
            lead_in: pattern.lead_in(),
            scheme,
            is_neural: network.is_some(),
            friction,
            knot: self.knot.iter().map(|pass| Pass::from(*pass)).collect(),
            duration,
        };
        let mut named = vec![
            (
                "trajectory.csv".to_owned(),
                trajectory_csv(&followed, &followed_times),
            ),
            (
                "trajectory.json".to_owned(),
                trajectory_json(&followed, &followed_times, &self.pattern, &file)?,
            ),
            ("pattern.csv".to_owned(), pattern_csv(&points, &demands)),
            ("deployment.svg".to_owned(), figure),
        ];
        for (index, lift) in tied.iter().flat_map(|tied| &tied.lifts).enumerate() {
            let poses = lift.poses.iter();
            let (times, poses): (Vec<f64>, Vec<GripperPose>) = poses
                .map(|&(time, position, rotation)| {
                    let pose = GripperPose {
                        s: rod.length,
                        position,
                        rotation,
                        grasp: None,
                    };
                    (laid_by + time, pose)
                })
                .unzip();
            let name = format!("lift_{}.csv", index + 1);
            named.push((name, trajectory_csv(&poses, &times)));
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
            pattern: self.pattern.clone(),
            rod: file.title,
            scheme: self.scheme,
            solver: self.solver,
            length_m: pattern.length(),
            lead_in_m: pattern.lead_in(),
            rod_length_m: rod.length,
            deviation_m: pattern.deviation,
            least_radius_m: Some(checks.least_radius_m).filter(|radius| radius.is_finite()),
            least_radius_at_m: checks.least_radius_at_m,
            largest_friction_demand: checks.largest_demand,
            largest_friction_demand_at_m: checks.largest_demand_at_m,
            friction,
            share_above_friction: checks.share_above_friction,
            crossings: crossings.iter().map(CrossingReport::of).collect(),
            unstable_poses: poses.iter().filter(|pose| is_unstable(pose)).count(),
            poses: poses.len(),
            solved_exactly: network
                .map(|_| poses.iter().filter(|pose| pose.grasp.is_some()).count()),
            duration_s: duration,
            files,
        };
        Ok(WrittenPlan {
            report,
            rod,
            lead_in: pattern.lead_in(),
            poses,
            points,
        })
    }

    /// Whether a knot is tied.
    pub fn ties_knot(&self) -> bool {
        !self.knot.is_empty()
    }

    /// The pattern as it was given.
    pub fn pattern_name(&self) -> &str {
        &self.pattern
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
            .map_err(|error| Failure::Input(format!("--knot: {}: {error}", self.pattern)))
    }

    /// What the grippers do after the `last` pose of the laying.
    fn tied(
        &self,
        passages: &[Passage],
        source: &PatternSource,
        rod: &DeployedRod,
        last: &GripperPose,
    ) -> Result<Tied, Failure> {
        let whole = self.pattern(source, rod)?;
        let handling = Handling::usual([rod]);
        let tied = TiedRod { rod, curve: &whole };
        let schedule = Schedule::new(0, &tied, passages, &handling);
        let task = TyingTask {
            rods: &[*rod],
            passages,
            pattern: &|place| whole.at(place.s),
        };
        Ok(Tied {
            duration: schedule.duration(),
            end: task.end_path(&schedule, (last.position, last.rotation)),
            lifts: task.lift_paths(&schedule, &handling),
        })
    }

    fn refused(&self, error: &DeploymentError) -> Failure {
        Failure::Input(format!("{}: {error}", self.pattern))
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
                let network = network.map_err(|error| Failure::Input(error.to_string()))?;
                Ok(Some(Cow::Owned(network)))
            }
        }
    }

    /// What the pattern is made from.
    fn source(&self) -> Result<PatternSource, Failure> {
        let Some(formula) = self.analytic()? else {
            return Ok(PatternSource::Drawn {
                points: self.drawn()?,
                deviation: self.deviation,
            });
        };
        let given = [
            ("--size", self.size.is_some()),
            ("--stroke", self.stroke.is_some()),
            ("--reverse", self.reverse),
        ];
        match given.iter().find(|(_, given)| *given) {
            Some((flag, _)) => Err(Failure::Input(format!(
                "{flag} is for drawn patterns; {} has its size and direction",
                self.pattern
            ))),
            None => Ok(formula),
        }
    }

    /// The pattern with its lead-in.
    fn pattern(&self, source: &PatternSource, rod: &DeployedRod) -> Result<Pattern, Failure> {
        let pattern = source.pattern().map_err(|error| self.no_pattern(&error))?;
        let length = match self.lead_in {
            LeadInLength::Given(length) => length,
            LeadInLength::Auto => lead_in_length(rod, pattern.at(0.0).curvature),
        };
        Ok(pattern.with_lead_in(length))
    }

    fn no_pattern(&self, error: &PatternError) -> Failure {
        Failure::Input(format!("{}: {error}", self.pattern))
    }

    /// `line:…`, `circle:…` or `sine:…`.
    fn analytic(&self) -> Result<Option<PatternSource>, Failure> {
        let Some((kind, text)) = self.pattern.split_once(':') else {
            return Ok(None);
        };
        let values: Vec<&str> = text.split(',').collect();
        let fault = |needed: &str| Failure::Input(format!("--pattern {}: {needed}", self.pattern));
        let length = |text: &str| positive_length(text).map_err(|error| fault(&error));
        Ok(Some(match (kind, values.as_slice()) {
            ("line", [end]) => PatternSource::Line(Line {
                length: length(end)?,
            }),
            ("circle", [radius]) => {
                // A negative radius turns to the right.
                let radius = metres(radius).map_err(|error| fault(&error))?;
                if radius == 0.0 || !radius.is_finite() {
                    return Err(fault("a radius other than 0 is needed"));
                }
                PatternSource::Circle(Circle { radius })
            }
            ("sine", [amplitude, wavelength, waves]) => {
                let waves: Option<f64> = waves.trim().parse().ok();
                let waves = waves.filter(|waves| *waves > 0.0 && *waves <= 1000.0);
                PatternSource::Sine(Sine {
                    amplitude: length(amplitude)?,
                    wavelength: length(wavelength)?,
                    waves: waves
                        .ok_or_else(|| fault("a number of waves from 0 to 1000 is needed"))?,
                })
            }
            ("line" | "circle" | "sine", _) => {
                return Err(fault(
                    "line:LENGTH, circle:RADIUS or sine:AMPLITUDE,WAVELENGTH,WAVES is needed",
                ));
            }
            _ => return Ok(None),
        }))
    }

    /// Points of an SVG or CSV file, in its size and direction.
    fn drawn(&self) -> Result<Vec<Point>, Failure> {
        let points = drawn_points(Path::new(&self.pattern), self.stroke)?;
        let points = points.ok_or_else(|| {
            Failure::Input(format!(
                "--pattern {}: an .svg file, a .csv file, line:…, circle:… or sine:… is needed",
                self.pattern
            ))
        })?;
        let drawing = Drawing {
            size: self.size,
            reverse: self.reverse,
        };
        drawing.of(points).map_err(|error| self.no_pattern(&error))
    }
}

/// What follows the laying where a knot is tied; times from its end, s.
struct Tied {
    duration: f64,
    end: GripperPoses,
    lifts: Vec<LiftPath>,
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

fn lead_in(text: &str) -> Result<LeadInLength, String> {
    match text.trim() {
        "auto" => Ok(LeadInLength::Auto),
        "none" => Ok(LeadInLength::Given(0.0)),
        text => positive_length(text)
            .map(LeadInLength::Given)
            .map_err(|error| format!("{error}; or `auto`, or `none`")),
    }
}

fn speed(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(speed) if speed > 0.0 && speed.is_finite() => Ok(speed),
        _ => Err("a speed above 0 is needed, m/s".into()),
    }
}
