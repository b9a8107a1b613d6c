//! Deployments as resolved.

use rodlab_planning::plan::deployment::DeployedRod;
use rodlab_planning::plan::pattern::{
    Circle, Line, Pattern as Curve, PatternError, PatternSource, Point, Sine,
};
use rodlab_planning::plan::tying::{Handling, Pass, laid_length};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A rod that a gripper lays on a table along a pattern.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Deployment {
    /// Scheme for the gripper's path.
    pub scheme: Scheme,
    /// Solver for the optimal grasps.
    pub solver: Solver,
    /// Length of the lead-in, m.
    pub lead_in: f64,
    /// Relative error of the gravito-bending length assumed by the planner.
    pub length_error: f64,
    /// Displacement of the frame assumed by the planner, m.
    pub frame_shift: [f64; 2],
    /// Rotation of that frame about the first point of the pattern, rad.
    pub frame_turn: f64,
    /// Root mean square of the gripper's displacement in each direction, m.
    pub jitter: f64,
    /// Root mean square of the gripper's rotation about each axis, rad.
    pub jitter_angle: f64,
    /// Period of the fastest jitter, s.
    pub jitter_period: f64,
    /// Seed of the jitter, and of the noise of observations.
    pub seed: u64,
    /// Correction of the path while the rod is laid, if enabled.
    pub correction: Option<Correction>,
    /// Time before the end of the run at which the gripper releases the rod, s; `None` means
    /// never.
    pub release: Option<f64>,
    /// Posts on the table, including those of clips.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub pegs: Vec<Peg>,
    /// The knot to tie, if any.
    pub knot: Option<Knot>,
    /// Target curve of the rod.
    pub pattern: Pattern,
    /// The rod.
    pub rod: Rod,
    /// A second rod that is laid after the first, if any.
    pub second: Option<Second>,
}

/// The second rod of a deployment.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Second {
    /// Scheme for its gripper's path.
    pub scheme: Scheme,
    /// Length of its lead-in, m.
    pub lead_in: f64,
    /// Target curve of the rod.
    pub pattern: Pattern,
    /// The rod.
    pub rod: Rod,
}

/// Correction of the gripper's path from the observed position of the rod.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Correction {
    /// Length laid between two corrections, m.
    pub every: f64,
    /// Length over which the rod returns to the pattern, m.
    pub return_length: f64,
    /// Root mean square error, in each direction, of observed positions of the lying rod, m.
    pub noise: f64,
}

/// A knot that is tied along the pattern.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Knot {
    /// Whether the second pass of the rod is over or under, for each crossing.
    pub crossings: Vec<Pass>,
    /// Height to which strands are lifted, m.
    pub lift: f64,
    /// Speed at which the end is led, m/s.
    pub speed: f64,
    /// Largest distance of a strand from its planned place at which the gripper finds it, m.
    pub reach: f64,
}

/// A post on the table: a cylinder with a round top.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Peg {
    /// Place of its axis, m.
    pub position: [f64; 2],
    /// Radius of the peg, m.
    pub radius: f64,
    /// Height of its top, m.
    pub height: f64,
}

/// Scheme for the gripper's path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum Scheme {
    /// The optimal grasp of each point.
    Optimal,
    /// The gripper upright above the contact node.
    Intuitive,
}

/// Solver for the optimal grasps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum Solver {
    /// The equations of the suspended rod.
    Exact,
    /// The network of the program. Outside the range of its samples the equations are solved.
    Neural,
}

/// Target curve of a laid rod, m.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Pattern {
    /// Points of a drawing.
    Drawn {
        /// The points.
        points: Vec<[f64; 2]>,
        /// Largest distance of the smooth curve from the points.
        deviation: f64,
    },
    /// A straight line along x.
    Line {
        /// Length of the line.
        length: f64,
    },
    /// A circle.
    Circle {
        /// Radius of the circle; a negative radius turns it to the right.
        radius: f64,
    },
    /// A sine.
    Sine {
        /// Amplitude of the sine.
        amplitude: f64,
        /// Wavelength of the sine.
        wavelength: f64,
        /// The number of waves.
        waves: f64,
    },
}

/// The rod that is laid.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Rod {
    /// L_gb, m.
    pub gravito_bending_length: f64,
    /// Radius, m.
    pub radius: f64,
    /// Length, m.
    pub length: f64,
    /// Mass per volume, kg/m³.
    pub density: f64,
    /// Number of edges of the simulated rod.
    pub edges: usize,
}

impl From<Solver> for rodlab_planning::plan::deployment::OptimalGrasps<'static> {
    fn from(solver: Solver) -> Self {
        match solver {
            Solver::Exact => Self::Exact,
            Solver::Neural => Self::Neural(rodlab_planning::plan::grasp::NeuralGrasps::built_in()),
        }
    }
}

impl From<Scheme> for rodlab_planning::plan::deployment::Scheme {
    fn from(scheme: Scheme) -> Self {
        match scheme {
            Scheme::Optimal => Self::Optimal,
            Scheme::Intuitive => Self::Intuitive,
        }
    }
}

impl Pattern {
    /// The same for the planner.
    pub fn source(&self) -> PatternSource {
        match *self {
            Self::Drawn {
                ref points,
                deviation,
            } => PatternSource::Drawn {
                points: points.iter().map(|[x, y]| Point::new(*x, *y)).collect(),
                deviation,
            },
            Self::Line { length } => PatternSource::Line(Line { length }),
            Self::Circle { radius } => PatternSource::Circle(Circle { radius }),
            Self::Sine {
                amplitude,
                wavelength,
                waves,
            } => PatternSource::Sine(Sine {
                amplitude,
                wavelength,
                waves,
            }),
        }
    }
}

impl Rod {
    /// Data of the rod for planning.
    pub fn deployed(&self) -> DeployedRod {
        DeployedRod {
            gravito_bending_length: self.gravito_bending_length,
            radius: self.radius,
            length: self.length,
        }
    }
}

impl Knot {
    /// The same for the planner.
    pub fn handling(&self) -> Handling {
        Handling {
            lift: self.lift,
            speed: self.speed,
        }
    }
}

/// Difference of the seeds of two grippers.
const OTHER_GRIPPER: u64 = 1 << 32;

impl Deployment {
    /// One deployment per rod, in the order of laying, each with the jitter of its gripper.
    pub fn layings(&self) -> Vec<Self> {
        let first = Self {
            second: None,
            ..self.clone()
        };
        let second = self.second.clone().map(|second| Self {
            scheme: second.scheme,
            lead_in: second.lead_in,
            pattern: second.pattern,
            rod: second.rod,
            ..first.by_another_gripper()
        });
        std::iter::once(first).chain(second).collect()
    }

    /// The deployment with the jitter of another gripper.
    pub fn by_another_gripper(&self) -> Self {
        Self {
            seed: self.seed.wrapping_add(OTHER_GRIPPER),
            ..self.clone()
        }
    }

    /// The rods in the order in which they are laid.
    pub fn rods(&self) -> impl Iterator<Item = &Rod> {
        std::iter::once(&self.rod).chain(self.second.iter().map(|second| &second.rod))
    }

    /// The whole pattern with its lead-in.
    ///
    /// # Errors
    /// The pattern is invalid.
    pub fn whole_pattern(&self) -> Result<Curve, PatternError> {
        Ok(self.pattern.source().pattern()?.with_lead_in(self.lead_in))
    }

    /// The part of the pattern along which the rod is laid. This is the whole pattern, unless a
    /// knot is tied; the rest is then the path of the rod's end.
    ///
    /// # Errors
    /// The pattern is invalid.
    pub fn laid_pattern(&self) -> Result<Curve, PatternError> {
        let whole = self.whole_pattern()?;
        Ok(match self.knot {
            Some(_) => whole.shortened(laid_length(&self.rod.deployed())),
            None => whole,
        })
    }
}
