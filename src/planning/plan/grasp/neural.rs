//! Optimal grasps by a network trained on exact ones (thesis 5.3.5).
//!
//! The inputs of the network are ln(1 + l̄_s), |κ̄| and 1/k̄_s. The outputs are, first, the
//! quantities that are even in κ̄: the gripper's x, its drop below the height on an upright rod, in
//! L_gb, and the component y of the rotation vector. The other outputs are the odd quantities
//! divided by κ̄: the gripper's y, and the components x and z of the rotation vector. Grasps on
//! straight patterns are therefore exactly straight, and those on mirrored patterns exactly
//! mirrored.

use super::{GraspProblem, Vector3};
use crate::learn::{Compared, Model, ModelError, read_model};
use rodlab_engine::mechanics::{UnitQuaternion, rotation};
use std::path::Path;
use std::sync::LazyLock;

/// A trained network for grasps.
#[derive(Clone, Debug)]
pub struct NeuralGrasps {
    model: Model,
}

/// Output of a network for a grasp: position in L_gb, rotation as in [`Grasp`](super::Grasp).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LearnedGrasp {
    /// Position of the gripper.
    pub position: Vector3,
    /// Rotation of the gripper.
    pub rotation: UnitQuaternion,
}

/// ln(1 + l̄_s).
pub fn log_length(suspended_length: f64) -> f64 {
    libm::log1p(suspended_length)
}

/// Height of the upper end of a rod that hangs upright, L_gb. As in a grasp, its tension at s is
/// about s/2 − 0.7.
pub fn hanging_height(suspended_length: f64, stretch_compliance: f64) -> f64 {
    let stretch = 0.25 * suspended_length * suspended_length - 0.7 * suspended_length;
    suspended_length + stretch_compliance * stretch
}

static BUILT_IN: LazyLock<NeuralGrasps> = LazyLock::new(|| {
    let bytes = include_bytes!("../../../../results/models/grasps.safetensors");
    let path = Path::new("the network in this program");
    NeuralGrasps::from_bytes(path, bytes).expect("the network in this program is whole")
});

impl NeuralGrasps {
    /// The kind of its samples.
    pub const SAMPLES: &str = "grasp-samples";

    /// Input columns of the network.
    pub const INPUTS: [&str; 3] = ["log_length", "curvature", "stretch_compliance"];
    /// Output columns of the network.
    pub const OUTPUTS: [&str; 6] = [
        "x",
        "y_per_curvature",
        "drop",
        "rotation_x_per_curvature",
        "rotation_y",
        "rotation_z_per_curvature",
    ];
    /// Quantities whose errors are reported. Outputs divided by the curvature are multiplied by
    /// it.
    pub const COMPARED: [Compared; 2] = [
        Compared {
            quantity: "position in L_gb",
            components: |input, output| [output[0], input[1] * output[1], output[2]],
        },
        Compared {
            quantity: "rotation in rad",
            components: |input, output| [input[1] * output[3], output[4], input[1] * output[5]],
        },
    ];

    /// The network that is part of the program: `results/models/grasps.safetensors`, made by
    /// `rodlab dataset scenarios/deployment_dataset.toml` and
    /// `rodlab train results/deployment_dataset`.
    pub fn built_in() -> &'static Self {
        &BUILT_IN
    }

    /// Reads a model.
    ///
    /// # Errors
    /// See [`ModelError`].
    pub fn read(path: &Path) -> Result<Self, ModelError> {
        Self::of(path, read_model(path, Self::SAMPLES)?)
    }

    fn from_bytes(path: &Path, bytes: &[u8]) -> Result<Self, ModelError> {
        Self::of(path, Model::from_bytes(path, bytes, Self::SAMPLES)?)
    }

    /// The network of a model that was read from a file.
    ///
    /// # Errors
    /// The model was trained on other columns.
    pub fn of(path: &Path, model: Model) -> Result<Self, ModelError> {
        Ok(Self {
            model: model.with_columns(path, &Self::INPUTS, &Self::OUTPUTS)?,
        })
    }

    /// The model.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// A grasp for each problem within the range of the samples, `None` for the others.
    ///
    /// # Errors
    /// [`ModelError::Tensors`].
    pub fn predict(
        &self,
        problems: &[GraspProblem],
    ) -> Result<Vec<Option<LearnedGrasp>>, ModelError> {
        let input = |problem: &GraspProblem| {
            [
                log_length(problem.suspended_length),
                problem.curvature.abs(),
                problem.stretch_compliance,
            ]
        };
        let inputs: Vec<_> = problems.iter().map(input).collect();
        let outputs = self.model.predict_covered(&inputs)?;
        let grasps = problems.iter().zip(outputs).map(|(problem, output)| {
            let output = output?;
            Some(LearnedGrasp {
                position: Vector3::new(
                    output[0],
                    problem.curvature * output[1],
                    hanging_height(problem.suspended_length, problem.stretch_compliance)
                        - output[2],
                ),
                rotation: rotation::from_vector(Vector3::new(
                    problem.curvature * output[3],
                    output[4],
                    problem.curvature * output[5],
                )),
            })
        });
        Ok(grasps.collect())
    }
}

#[cfg(test)]
mod tests {
    use super::super::{GraspMethod, GraspSolver};
    use super::*;

    fn problem(length: f64, curvature: f64) -> GraspProblem {
        GraspProblem::new(length, curvature, 1e4).unwrap()
    }

    #[test]
    fn the_built_in_network_generalises_to_unseen_grasps() {
        let mut problems = Vec::new();
        for index in 0..500 {
            // A separate lattice, not Sobol' points.
            let part = |factor: f64| (f64::from(index) * factor).fract();
            problems.push(problem(
                0.5 + 49.0 * part(0.754_877_666).powi(2),
                2.0 * part(0.569_840_291),
            ));
        }
        let found = NeuralGrasps::built_in().predict(&problems).unwrap();
        let mut errors = [0.0; 2];
        for (found, problem) in found.iter().zip(&problems) {
            let found = found.expect("a grasp within the range");
            let exact = GraspSolver::new()
                .solve(problem, GraspMethod::Theory)
                .unwrap();
            errors[0] += (found.position - exact.position).norm() / 500.0;
            errors[1] += found.rotation.angle_to(&exact.rotation).to_degrees() / 500.0;
        }
        // Over the whole range of its samples; `reproduce tab5.3` reports the errors along
        // patterns.
        assert!(errors[0] < 0.003 && errors[1] < 0.05, "{errors:?}");
    }

    #[test]
    fn the_built_in_network_has_its_checksum() {
        let bytes = include_bytes!("../../../../results/models/grasps.safetensors");
        let written = NeuralGrasps::built_in().model().to_bytes().unwrap();
        assert!(
            written == bytes,
            "results/models/grasps.safetensors is not as it is written"
        );
    }

    #[test]
    fn a_turn_to_the_right_is_the_mirror_image_of_one_to_the_left() {
        let problems = [problem(9.0, 0.7), problem(9.0, -0.7)];
        let found = NeuralGrasps::built_in().predict(&problems).unwrap();
        let [left, right] = [0, 1].map(|index| found[index].unwrap());
        assert_eq!(left.position.x, right.position.x);
        assert_eq!(left.position.y, -right.position.y);
        assert_eq!(left.position.z, right.position.z);
        assert_eq!(left.rotation.j, right.rotation.j);
        assert_eq!(left.rotation.i, -right.rotation.i);
        assert_eq!(left.rotation.k, -right.rotation.k);
    }

    #[test]
    fn problems_outside_the_training_range_have_no_output() {
        let problems = [problem(9.0, 0.7), problem(9.0, 5.0), problem(80.0, 0.1)];
        let found = NeuralGrasps::built_in().predict(&problems).unwrap();
        let answered: Vec<bool> = found.iter().map(Option::is_some).collect();
        assert_eq!(answered, [true, false, false]);
    }
}
