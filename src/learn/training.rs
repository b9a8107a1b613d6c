//! Training: the mean absolute error of standardised outputs, made small by Adam and stochastic gradient descent in turns,
//! with batches that grow (thesis 5.3.5).

use super::network::Network;
use super::samples::shuffle;
use candle_core::{Device, Result, Tensor};
use candle_nn::{AdamW, Optimizer, ParamsAdamW, SGD};
use rand_pcg::Pcg64;
use rand_pcg::rand_core::SeedableRng;
use serde::{Deserialize, Serialize};

/// How a network is trained.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// Widths of the hidden layers.
    pub hidden: Vec<usize>,
    /// Chooses the first weights and the order of samples.
    pub seed: u64,
    /// Batches at first and at last; they are doubled in between.
    pub batch: [usize; 2],
    /// Rates of Adam with the first and with the last batch.
    pub rates: [f64; 2],
    /// Rounds over all samples without a lower error of those held back after which the method changes.
    pub patience: usize,
    /// Rounds in all, at most.
    pub most_epochs: usize,
}

impl Default for Plan {
    fn default() -> Self {
        Self {
            hidden: vec![392; 4],
            seed: 0,
            batch: [128, 2048],
            rates: [1e-3, 1e-5],
            patience: 30,
            most_epochs: 2000,
        }
    }
}

/// What makes the error small.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Adam (Kingma and Ba 2015).
    Adam,
    /// Stochastic gradient descent.
    GradientDescent,
}

/// A stretch of training with one method and one size of batches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phase {
    /// The method.
    pub method: Method,
    /// Samples in a batch.
    pub batch: usize,
    /// Size of its steps.
    pub rate: f64,
}

/// A round over all samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Epoch {
    /// The phase that it belongs to, from 0.
    pub phase: usize,
    /// Mean absolute error of the batches, before the step that each led to.
    pub training: f64,
    /// Mean absolute error of the samples held back, after the round.
    pub held_back: f64,
}

impl Plan {
    /// Rounds without a lower error after which a phase ends. Gradient descent gains little here, and gets less.
    pub fn patience_of(&self, phase: &Phase) -> usize {
        match phase.method {
            Method::Adam => self.patience,
            Method::GradientDescent => self.patience.div_ceil(4),
        }
    }

    /// Adam, then gradient descent, for each size of batches.
    pub fn phases(&self) -> Vec<Phase> {
        let [first, last] = self.batch;
        let doublings = (last / first.max(1)).max(1).ilog2();
        let rate = |doubling: u32| {
            let part = f64::from(doubling) / f64::from(doublings.max(1));
            self.rates[0] * libm::pow(self.rates[1] / self.rates[0], part)
        };
        let sizes = 0..=doublings;
        sizes
            .flat_map(|doubling| {
                let batch = first << doubling;
                let phase = |method, rate| Phase {
                    method,
                    batch,
                    rate,
                };
                [
                    phase(Method::Adam, rate(doubling)),
                    phase(Method::GradientDescent, 10.0 * rate(doubling)),
                ]
            })
            .collect()
    }
}

/// Standardised samples on a device.
#[derive(Clone, Debug)]
pub struct Rows {
    /// Inputs, rows × inputs.
    pub inputs: Tensor,
    /// Outputs, rows × outputs.
    pub outputs: Tensor,
}

impl Rows {
    fn mean_absolute_error(&self, network: &Network) -> Result<Tensor> {
        (network.forward(&self.inputs)? - &self.outputs)?
            .abs()?
            .mean_all()
    }

    fn chosen(&self, rows: &Tensor) -> Result<Self> {
        Ok(Self {
            inputs: self.inputs.index_select(rows, 0)?,
            outputs: self.outputs.index_select(rows, 0)?,
        })
    }
}

enum Descent {
    Adam(AdamW),
    Gradient(SGD),
}

impl Descent {
    fn new(phase: &Phase, network: &Network) -> Result<Self> {
        Ok(match phase.method {
            Method::Adam => {
                let parameters = ParamsAdamW {
                    lr: phase.rate,
                    weight_decay: 0.0,
                    ..ParamsAdamW::default()
                };
                Self::Adam(AdamW::new(network.variables(), parameters)?)
            }
            Method::GradientDescent => Self::Gradient(SGD::new(network.variables(), phase.rate)?),
        })
    }

    fn step(&mut self, error: &Tensor) -> Result<()> {
        match self {
            Self::Adam(method) => method.backward_step(error),
            Self::Gradient(method) => method.backward_step(error),
        }
    }
}

/// Trains a network for a phase, which ends with the weights that served the samples held back best; `told` hears of each
/// round, with both errors and the best network so far, and says whether to go on.
pub fn train_phase(
    network: &Network,
    phase: &Phase,
    patience: usize,
    training: &Rows,
    held_back: &Rows,
    random: &mut Pcg64,
    told: &mut dyn FnMut(f64, f64, &Network) -> bool,
) -> Result<f64> {
    let error_of = |network: &Network| held_back.mean_absolute_error(network)?.to_scalar::<f32>();
    let mut best = (error_of(network)?, network.snapshot()?);
    let mut descent = Descent::new(phase, network)?;
    let count = training.inputs.dim(0)?;
    let mut order: Vec<u32> = (0..count as u32).collect();
    let mut since = 0;
    while since < patience {
        shuffle(&mut order, random);
        let device: &Device = training.inputs.device();
        let mut sum = 0.0;
        for rows in order.chunks(phase.batch) {
            let chosen = training.chosen(&Tensor::new(rows, device)?)?;
            let error = chosen.mean_absolute_error(network)?;
            descent.step(&error)?;
            sum += f64::from(error.to_scalar::<f32>()?) * rows.len() as f64;
        }
        let held = error_of(network)?;
        since += 1;
        if held < best.0 {
            // Small gains do not keep a phase alive.
            if held < 0.998 * best.0 {
                since = 0;
            }
            best = (held, network.snapshot()?);
        }
        if !told(sum / count as f64, f64::from(held), &best.1) {
            break;
        }
    }
    network.restore(&best.1)?;
    Ok(f64::from(best.0))
}

/// Random numbers of a phase: it can be begun again.
pub fn random_of_phase(seed: u64, phase: usize) -> Pcg64 {
    Pcg64::seed_from_u64(seed.wrapping_mul(1_000_003).wrapping_add(phase as u64 + 1))
}
