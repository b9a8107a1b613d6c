//! `rodlab solve grasp`.

use super::answers::Answers;
use super::prelude::*;
use rodlab_engine::mechanics::rotation;
use rodlab_planning::plan::grasp::{Grasp, GraspError, GraspMethod, GraspProblem, GraspSolver};

/// Largest number of edges of a discrete rod. Beyond it, round-off exceeds the error of the mesh.
const MOST_EDGES: usize = 2000;

/// Arguments of `rodlab solve grasp`.
#[derive(Debug, Args)]
pub struct GraspArguments {
    /// l̄_s: the suspended length over the gravito-bending length
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    suspended_length: f64,
    /// κ̄: curvature of the pattern at the contact node times L_gb; positive to the left
    #[arg(long, value_name = "CURVATURE", allow_hyphen_values = true)]
    curvature: f64,
    /// k̄_s: stretching stiffness times L_gb²/EI, 4 L_gb²/h² for a round rod [default: inextensible]
    #[arg(long, value_name = "STIFFNESS", allow_hyphen_values = true)]
    stretch: Option<f64>,
    /// Method of solution
    #[arg(long, default_value = "theory")]
    method: Method,
    /// Edges of the discrete rod
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = edges(GraspMethod::FEWEST_EDGES..=MOST_EDGES))]
    edges: usize,
    /// Return all solutions found, starting with the one returned without --all
    #[arg(long)]
    all: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
enum Method {
    /// Collocation of the continuous rod.
    Theory,
    /// The discrete elastic rod.
    Der,
}

/// A grasp, dimensionless.
#[derive(Serialize)]
pub struct Answer {
    suspended_length: f64,
    curvature: f64,
    stretch: Option<f64>,
    method: Method,
    /// Number of the branch; 1 is the gentle one.
    branch: usize,
    position: [f64; 3],
    rotation_vector: [f64; 3],
    quaternion: [f64; 4],
    contact_force: [f64; 3],
    residual: f64,
    stable: bool,
    unstable_modes: usize,
    feasible: bool,
    lowest_height: f64,
}

impl GraspArguments {
    /// Finds the grasp, or all grasps.
    pub fn solve(&self) -> Result<Answers<Answer>, Failure> {
        let stiffness = self.stretch.unwrap_or(f64::INFINITY);
        let problem = GraspProblem::new(self.suspended_length, self.curvature, stiffness)?;
        let method = match self.method {
            Method::Theory => GraspMethod::Theory,
            Method::Der => GraspMethod::Discrete { edges: self.edges },
        };
        let mut solver = GraspSolver::new();
        if self.all {
            let found = solver.solve_all(&problem, method)?;
            let numbered = found.iter().zip(1..);
            let solutions = numbered.map(|(grasp, branch)| self.answer(grasp, branch));
            Ok(Answers::All {
                solutions: solutions.collect(),
            })
        } else {
            let grasp = solver.solve(&problem, method)?;
            Ok(Answers::One(self.answer(&grasp, 1)))
        }
    }

    fn answer(&self, grasp: &Grasp, branch: usize) -> Answer {
        let rotation = grasp.rotation;
        // Use the quaternion of the rotation with w ≥ 0, without negative zeros.
        let sign = if rotation.w < 0.0 { -1.0 } else { 1.0 };
        let quaternion = [rotation.w, rotation.i, rotation.j, rotation.k];
        Answer {
            suspended_length: self.suspended_length,
            curvature: self.curvature,
            stretch: self.stretch,
            method: self.method,
            branch,
            position: plain(grasp.position.into()),
            rotation_vector: plain(rotation::to_vector(&rotation).into()),
            quaternion: quaternion.map(|part| sign * part + 0.0),
            contact_force: plain(grasp.contact_force.into()),
            residual: grasp.residual,
            stable: grasp.is_stable(),
            unstable_modes: grasp.unstable_modes,
            feasible: grasp.is_feasible(),
            lowest_height: grasp.lowest,
        }
    }
}

/// Replaces negative zeros by zeros.
fn plain(vector: [f64; 3]) -> [f64; 3] {
    vector.map(|part| part + 0.0)
}

impl From<GraspError> for Failure {
    fn from(error: GraspError) -> Self {
        match error {
            GraspError::NoConvergence { .. } => Self::Unreachable(error.to_string()),
            error => Self::input(error),
        }
    }
}
