//! `rodlab solve fk` and `rodlab solve ik`: the kinematics of an arm of a cell.

use super::prelude::*;
use rodlab_robot::{Pose, Posture, parts, pose};
use rodlab_workcell::cell::{Arm, Cell};

/// Choice of an arm of a cell.
#[derive(Debug, Args)]
pub(super) struct ArmChoice {
    /// The cell file
    #[arg(long, value_name = "FILE", value_parser = file_or_preset(PresetKind::Cell), add = presets(PresetKind::Cell))]
    pub cell: PathBuf,
    /// Name of the arm; optional if the cell has only one
    #[arg(long, value_name = "NAME")]
    pub arm: Option<String>,
}

impl ArmChoice {
    /// Reads the cell; returns it with the index of the arm.
    pub fn read(&self) -> Result<(Cell, usize), Failure> {
        read_arm(&self.cell, self.arm.as_deref())
    }
}

/// Reads a cell; returns it with the index of the named arm.
pub(super) fn read_arm(file: &Path, arm: Option<&str>) -> Result<(Cell, usize), Failure> {
    let cell = Cell::read(file)?;
    let index = cell.arm_named("--arm", arm, file)?;
    Ok((cell, index))
}

/// Arguments of `rodlab solve fk`.
#[derive(Debug, Args)]
pub struct ForwardArguments {
    #[command(flatten)]
    arm: ArmChoice,
    /// Joint positions, rad or m, from base to hand
    #[arg(long, value_name = "Q1,Q2,...", value_delimiter = ',', value_parser = number(f64::is_finite, "a number is needed, in rad or m"), allow_hyphen_values = true, required = true)]
    joints: Vec<f64>,
}

impl ForwardArguments {
    /// The posture.
    pub fn solve(&self) -> Result<Posture, Failure> {
        let (cell, index) = self.arm.read()?;
        let arm = &cell.arms[index];
        let count = arm.chain.joints.len();
        if self.joints.len() != count {
            let names: Vec<&str> = arm
                .chain
                .joints
                .iter()
                .map(|joint| joint.name.as_str())
                .collect();
            return Err(Failure::Input(format!(
                "--joints: {count} positions are needed ({}), found {}",
                names.join(", "),
                self.joints.len()
            )));
        }
        Ok(Posture::new(&arm.chain, &self.joints, None))
    }
}

/// Arguments of `rodlab solve ik`.
#[derive(Debug, Args)]
pub struct InverseArguments {
    #[command(flatten)]
    arm: ArmChoice,
    /// Pose of the hand in the frame of the arm's base, m, with a quaternion
    #[arg(long, value_name = "X,Y,Z,QW,QX,QY,QZ", value_parser = parse_pose, allow_hyphen_values = true)]
    pose: Pose,
    /// Joint positions at which to start [default: those of `home`]
    #[arg(long, value_name = "Q1,Q2,...", value_delimiter = ',', value_parser = number(f64::is_finite, "a number is needed, in rad or m"), allow_hyphen_values = true)]
    from: Vec<f64>,
    /// Return every posture; for more than six joints, samples of the curves of postures
    #[arg(long)]
    all: bool,
    /// Largest number of samples of a curve, with --all
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u16).range(2..), requires = "all")]
    samples: u16,
}

/// The answer: one posture, all of them, or curves.
#[derive(Serialize)]
#[serde(untagged)]
pub enum InverseAnswer {
    /// One.
    One(Box<Posture>),
    /// All isolated postures.
    Branches {
        /// The postures, sorted.
        branches: Vec<Posture>,
    },
    /// Curves of postures of a redundant arm.
    Curves {
        /// Samples from end to end of each curve.
        curves: Vec<Vec<Posture>>,
    },
}

impl InverseArguments {
    /// Finds the posture or the postures.
    pub fn solve(&self) -> Result<InverseAnswer, Failure> {
        let (cell, index) = self.arm.read()?;
        let arm = &cell.arms[index];
        let chain = &arm.chain;
        let from = if self.from.is_empty() {
            &arm.home
        } else {
            &self.from
        };
        if from.len() != chain.joints.len() {
            return Err(Failure::Input(format!(
                "--from: {} positions are needed, found {}",
                chain.joints.len(),
                from.len()
            )));
        }
        let one = chain
            .reach(&self.pose, from)
            .map_err(|nearest| out_of_reach(arm, &nearest.hand, nearest.distance, nearest.angle))?;
        let posture = |joints: &Vec<f64>| Posture::new(chain, joints, Some(&self.pose));
        if !self.all {
            return Ok(InverseAnswer::One(Box::new(posture(&one))));
        }
        if chain.joints.len() <= 6 {
            let branches = chain.branches(&self.pose).iter().map(posture).collect();
            return Ok(InverseAnswer::Branches { branches });
        }
        let curves = chain.self_motions(&self.pose);
        let thinned = curves.iter().map(|curve| {
            let most = usize::from(self.samples).min(curve.len());
            let last = (curve.len() - 1) as f64;
            (0..most)
                .map(|k| {
                    posture(&curve[(k as f64 * last / (most.max(2) - 1) as f64).round() as usize])
                })
                .collect()
        });
        Ok(InverseAnswer::Curves {
            curves: thinned.collect(),
        })
    }
}

fn out_of_reach(arm: &Arm, hand: &Pose, distance: f64, angle: f64) -> Failure {
    let ([x, y, z], [qw, qx, qy, qz]) = parts(hand);
    Failure::Unreachable(format!(
        "no posture of arm {} within its limits reaches the pose; the nearest found is \
         {x:.6},{y:.6},{z:.6},{qw:.6},{qx:.6},{qy:.6},{qz:.6}, {distance:.3e} m and {angle:.3e} rad away",
        arm.name
    ))
}

/// A pose as `x,y,z,qw,qx,qy,qz`.
pub(super) fn parse_pose(text: &str) -> Result<Pose, String> {
    let numbers = numbers(text);
    let Some([x, y, z, qw, qx, qy, qz]) = numbers.as_deref() else {
        return Err("expected seven numbers with commas between them: x,y,z,qw,qx,qy,qz".into());
    };
    pose([*x, *y, *z], [*qw, *qx, *qy, *qz])
        .ok_or_else(|| "expected finite numbers and a quaternion other than zero".into())
}
