//! Processor for training.

use super::ModelError;
use candle_core::Device;

/// Processor for training.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Processor {
    /// The CPU, which gives the same network on every machine of a kind.
    #[default]
    Cpu,
    /// The first GPU, by CUDA. The order of sums is not fixed there, so that the last digits of
    /// the network differ from run to run.
    Gpu,
}

impl Processor {
    /// Whether this program was built for GPUs.
    pub const KNOWS_GPUS: bool = cfg!(feature = "cuda");

    /// Device of the processor.
    ///
    /// # Errors
    /// [`ModelError::NoGpu`].
    pub(super) fn device(self) -> Result<Device, ModelError> {
        match self {
            Self::Cpu => Ok(Device::Cpu),
            Self::Gpu if Self::KNOWS_GPUS => {
                Device::new_cuda(0).map_err(|error| ModelError::NoGpu(error.to_string()))
            }
            Self::Gpu => Err(ModelError::NoGpu(
                "this program was built without the cargo feature `cuda`, which needs the CUDA toolkit".into(),
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_without_gpus_reports_it() {
        assert!(Processor::Cpu.device().is_ok());
        if !Processor::KNOWS_GPUS {
            let refused = Processor::Gpu.device();
            let Err(ModelError::NoGpu(reason)) = refused else {
                panic!("{refused:?}");
            };
            assert!(reason.contains("`cuda`"), "{reason}");
        }
    }
}
