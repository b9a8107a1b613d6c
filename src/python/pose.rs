//! Clamps that move to a pose during a step.

use crate::arrays::{elements, table};
use crate::errors::{bad_argument, of_simulation};
use nalgebra::{Matrix3, Matrix4};
use numpy::PyArray2;
use pyo3::prelude::*;
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::{HeldPose, Simulation};

/// Largest deviation of the columns of a rotation from unit vectors at right angles.
const SKEW: f64 = 1e-6;

/// The pose that a clamp is to have at the end of the next step.
#[derive(Clone, Copy)]
pub struct Target {
    clamp: usize,
    position: Vector3,
    frame: Option<Matrix3<f64>>,
}

impl Target {
    /// A target from a pose 4 × 4, or from a position of 3 numbers.
    pub fn new(clamp: usize, flat: &[f64]) -> PyResult<Self> {
        if flat.len() == 3 {
            return Ok(Self {
                clamp,
                position: Vector3::from_column_slice(flat),
                frame: None,
            });
        }
        let pose = Matrix4::from_row_slice(flat);
        let frame: Matrix3<f64> = pose.fixed_view::<3, 3>(0, 0).into();
        let skew = (frame.transpose() * frame - Matrix3::identity()).amax();
        let last = pose.row(3);
        if skew > SKEW || frame.determinant() < 0.0 || last != Matrix4::<f64>::identity().row(3) {
            return Err(bad_argument(
                "pose: expected a rotation and a position, with (0, 0, 0, 1) as the last row",
            ));
        }
        Ok(Self {
            clamp,
            position: pose.fixed_view::<3, 1>(0, 3).into(),
            frame: Some(frame),
        })
    }

    /// Reads a target from an array-like object.
    pub fn read(py: Python<'_>, clamp: usize, pose: &Bound<'_, PyAny>) -> PyResult<Self> {
        let (_, flat) = elements(py, "pose", pose, &[&[4, 4], &[3]])?;
        Self::new(clamp, &flat)
    }

    /// The clamp.
    pub fn clamp(&self) -> usize {
        self.clamp
    }

    /// Starts the motion of the clamp from its current pose.
    pub fn carry(&self, simulation: &mut Simulation, until: f64) -> PyResult<()> {
        let frame = self.frame.map(|frame| {
            nalgebra::UnitQuaternion::from_matrix_eps(&frame, 1e-14, 100, nalgebra::one())
        });
        let carried = simulation.carry_clamp(self.clamp, self.position, frame, until);
        carried.map_err(|error| of_simulation(&error))
    }
}

/// The clamp with a number.
///
/// # Errors
/// The clamp does not exist, or was released.
pub fn held(simulation: &Simulation, clamp: usize) -> PyResult<HeldPose> {
    simulation.clamp_pose(clamp).ok_or_else(|| {
        let clamps = simulation.clamps();
        bad_argument(match clamp < clamps {
            true => format!("clamp {clamp} was released"),
            false => format!("clamp {clamp} does not exist; the scene has {clamps} clamps"),
        })
    })
}

/// Creates an array 4 × 4 from a pose.
pub fn matrix<'py>(py: Python<'py>, held: &HeldPose) -> Bound<'py, PyArray2<f64>> {
    let pose = nalgebra::Isometry3::from_parts(held.position.into(), held.frame);
    let pose = pose.to_homogeneous();
    table(py, [4, 4], pose.transpose().iter().copied().collect())
}
