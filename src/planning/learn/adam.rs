//! Adam (Kingma and Ba 2015, algorithm 1) in one pass over the weights.
//!
//! m ← β₁ m + (1 − β₁) g, v ← β₂ v + (1 − β₂) g²,
//! w ← w − η m̂ / (√v̂ + ε) with m̂ = m / (1 − β₁ᵗ) and v̂ = v / (1 − β₂ᵗ).
//!
//! The optimiser of candle, which makes a tensor of each term, serves on a GPU.

use super::layer::{contiguous, contiguous_mut};
use candle_core::backprop::GradStore;
use candle_core::{CpuStorage, InplaceOp2, Layout, Result, Var};
use rayon::prelude::*;
use std::sync::{Mutex, PoisonError};

/// Decay of both moments, β₁ and β₂.
const DECAY: [f32; 2] = [0.9, 0.999];
/// ε.
const LEAST_ROOT: f32 = 1e-8;
/// Weights of a task of a thread.
const CHUNK: usize = 1 << 14;

/// Weights with both moments of their gradients.
#[derive(Debug)]
pub struct Adam {
    weights: Vec<(Var, Mutex<[Vec<f32>; 2]>)>,
    rate: f64,
    steps: i32,
}

impl Adam {
    /// The method before its first step, for tensors of 32 bits on the processor.
    pub fn new(variables: Vec<Var>, rate: f64) -> Self {
        let weights = variables.into_iter().map(|variable| {
            let zeros = vec![0.0; variable.elem_count()];
            (variable, Mutex::new([zeros.clone(), zeros]))
        });
        Self {
            weights: weights.collect(),
            rate,
            steps: 0,
        }
    }

    /// Sets η.
    pub fn set_rate(&mut self, rate: f64) {
        self.rate = rate;
    }

    /// One step of all weights that have a gradient.
    pub fn step(&mut self, gradients: &GradStore) -> Result<()> {
        self.steps += 1;
        let [first, second] = DECAY.map(|decay| 1.0 - f64::from(decay).powi(self.steps));
        for (variable, moments) in &self.weights {
            if let Some(gradient) = gradients.get(variable) {
                let step = Step {
                    moments,
                    rate: (self.rate / first) as f32,
                    second_correction: (1.0 / second) as f32,
                };
                variable.inplace_op2(&gradient.contiguous()?, &step)?;
            }
        }
        Ok(())
    }
}

/// A step of the weights of one tensor.
struct Step<'adam> {
    moments: &'adam Mutex<[Vec<f32>; 2]>,
    /// η / (1 − β₁ᵗ).
    rate: f32,
    /// 1 / (1 − β₂ᵗ).
    second_correction: f32,
}

impl InplaceOp2 for Step<'_> {
    fn name(&self) -> &'static str {
        "adam"
    }

    fn cpu_fwd(
        &self,
        weights: &mut CpuStorage,
        weights_layout: &Layout,
        gradient: &CpuStorage,
        gradient_layout: &Layout,
    ) -> Result<()> {
        let mut moments = self.moments.lock().unwrap_or_else(PoisonError::into_inner);
        let [first, second] = &mut *moments;
        let weights = contiguous_mut(weights, weights_layout)?;
        let gradient = contiguous(gradient, gradient_layout)?;
        let [keep, keep_square] = DECAY;
        weights
            .par_chunks_mut(CHUNK)
            .zip(gradient.par_chunks(CHUNK))
            .zip(first.par_chunks_mut(CHUNK))
            .zip(second.par_chunks_mut(CHUNK))
            .for_each(|(((weights, gradient), first), second)| {
                let moments = first.iter_mut().zip(second);
                for ((weight, slope), (m, v)) in weights.iter_mut().zip(gradient).zip(moments) {
                    *m = keep * *m + (1.0 - keep) * slope;
                    *v = keep_square * *v + (1.0 - keep_square) * slope * slope;
                    let root = (*v * self.second_correction).sqrt();
                    *weight -= self.rate * *m / (root + LEAST_ROOT);
                }
            });
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use candle_core::{Device, Tensor};
    use candle_nn::{AdamW, Optimizer, ParamsAdamW};

    #[test]
    fn thirty_steps_are_those_of_the_optimiser_of_candle() -> Result<()> {
        let start = [0.3_f32, -2.0, 5.0, 0.0];
        let variables = || Var::from_tensor(&Tensor::new(&start, &Device::Cpu)?);
        let [here, there] = [variables()?, variables()?];
        let settings = ParamsAdamW {
            lr: 0.05,
            weight_decay: 0.0,
            ..ParamsAdamW::default()
        };
        let mut adam = Adam::new(vec![here.clone()], 0.05);
        let mut candle = AdamW::new(vec![there.clone()], settings)?;
        let error = |weights: &Var| (weights.as_tensor() - 1.0)?.sqr()?.sqr()?.sum_all();
        for step in 0..30 {
            let rate = 0.05 / f64::from(1 + step);
            adam.set_rate(rate);
            candle.set_learning_rate(rate);
            adam.step(&error(&here)?.backward()?)?;
            candle.backward_step(&error(&there)?)?;
        }
        let [here, there] = [here, there].map(|weights| weights.to_vec1::<f32>());
        let (here, there) = (here?, there?);
        assert!(
            here.iter()
                .zip(start)
                .all(|(end, start)| (end - start).abs() > 0.1)
        );
        for (a, b) in here.iter().zip(there) {
            assert!((a - b).abs() < 2e-6, "{a} {b}");
        }
        Ok(())
    }
}
