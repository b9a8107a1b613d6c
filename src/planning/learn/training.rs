//! Training: minimises the mean absolute error of standardised outputs with growing batches,
//! either by Adam and stochastic gradient descent alternately (thesis 4.3.4 and 5.3.5) or by Adam
//! alone with a cosine schedule.

use super::adam::Adam;
use super::network::Network;
use super::samples::shuffle;
use candle_core::{Device, Result, Tensor};
use candle_nn::{AdamW, Optimizer, ParamsAdamW, SGD};
use rand_pcg::Pcg64;
use rand_pcg::rand_core::SeedableRng;
use serde::{Deserialize, Serialize};

/// Options of a training.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// Widths of the hidden layers.
    pub hidden: Vec<usize>,
    /// Seed of the initial weights and the order of samples.
    pub seed: u64,
    /// Initial and final batch size, doubled in between.
    pub batch: [usize; 2],
    /// Schedule of the learning rate.
    #[serde(default)]
    pub schedule: Schedule,
    /// Learning rates of Adam with the first and the last batch size. With a cosine schedule only
    /// the first is used, which decreases to zero.
    pub rates: [f64; 2],
    /// Number of rounds without a lower held-out error after which the method changes.
    pub patience: usize,
    /// Maximum number of rounds.
    pub most_epochs: usize,
}

impl Default for Plan {
    fn default() -> Self {
        Self {
            hidden: vec![392; 4],
            seed: 0,
            batch: [128, 2048],
            schedule: Schedule::default(),
            rates: [1e-3, 1e-5],
            patience: 30,
            most_epochs: 2000,
        }
    }
}

/// Schedule of the learning rate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Schedule {
    /// Adam, then gradient descent with each batch size, both until the error no longer decreases.
    #[default]
    Plateau,
    /// Adam for the maximum number of rounds, with a rate that decreases to zero along a half
    /// cosine (Loshchilov and Hutter 2017), and equal numbers of rounds with each batch size.
    Cosine,
}

/// Optimisation method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Adam (Kingma and Ba 2015).
    Adam,
    /// Stochastic gradient descent.
    GradientDescent,
}

/// A phase of training with one method and one batch size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phase {
    /// The method.
    pub method: Method,
    /// Samples in a batch.
    pub batch: usize,
    /// The learning rate, or the first rate of the schedule.
    pub rate: f64,
    /// Schedule of the rate; `None` for a constant rate, with which the phase ends when the error
    /// no longer decreases.
    pub decay: Option<Decay>,
}

/// A part of a half cosine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decay {
    /// Rounds of the phase.
    pub rounds: usize,
    /// Start and end of the phase in the half cosine, from 0 to 1.
    pub parts: [f64; 2],
}

impl Phase {
    /// Learning rate after a number of rounds of the phase.
    pub fn rate_after(&self, rounds: f64) -> f64 {
        let Some(decay) = &self.decay else {
            return self.rate;
        };
        let [from, to] = decay.parts;
        let part = from + (to - from) * rounds / decay.rounds.max(1) as f64;
        0.5 * self.rate * (1.0 + libm::cos(std::f64::consts::PI * part))
    }
}

/// A round over all samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Epoch {
    /// Phase of the epoch, from 0.
    pub phase: usize,
    /// Mean absolute error of the batches, before their steps.
    pub training: f64,
    /// Mean absolute error of the held-out samples, after the round.
    pub held_back: f64,
}

impl Plan {
    /// Rounds without a lower error after which a phase ends. Gradient descent gains little after
    /// the first rounds, and has fewer.
    pub fn patience_of(&self, phase: &Phase) -> usize {
        match phase.method {
            Method::Adam => self.patience,
            Method::GradientDescent => self.patience.div_ceil(4),
        }
    }

    /// For each batch size Adam, then gradient descent; or Adam along the cosine.
    pub fn phases(&self) -> Vec<Phase> {
        let [first, last] = self.batch;
        let doublings = (last / first.max(1)).max(1).ilog2();
        if self.schedule == Schedule::Cosine {
            let begin = |size: usize| size * self.most_epochs / (doublings as usize + 1);
            let phases = (0..=doublings as usize).map(|size| Phase {
                method: Method::Adam,
                batch: first << size,
                rate: self.rates[0],
                decay: Some(Decay {
                    rounds: begin(size + 1) - begin(size),
                    parts: [size, size + 1]
                        .map(|size| begin(size) as f64 / self.most_epochs.max(1) as f64),
                }),
            });
            return phases.collect();
        }
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
                    decay: None,
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
    Adam(Adam),
    AdamOnGpu(AdamW),
    Gradient(SGD),
}

impl Descent {
    fn new(phase: &Phase, network: &Network) -> Result<Self> {
        Ok(match phase.method {
            Method::Adam if network.is_on_cpu() => {
                Self::Adam(Adam::new(network.variables(), phase.rate))
            }
            Method::Adam => {
                let parameters = ParamsAdamW {
                    lr: phase.rate,
                    weight_decay: 0.0,
                    ..ParamsAdamW::default()
                };
                Self::AdamOnGpu(AdamW::new(network.variables(), parameters)?)
            }
            Method::GradientDescent => Self::Gradient(SGD::new(network.variables(), phase.rate)?),
        })
    }

    fn step(&mut self, error: &Tensor) -> Result<()> {
        match self {
            Self::Adam(method) => method.step(&error.backward()?),
            Self::AdamOnGpu(method) => method.backward_step(error),
            Self::Gradient(method) => method.backward_step(error),
        }
    }

    fn set_rate(&mut self, rate: f64) {
        match self {
            Self::Adam(method) => method.set_rate(rate),
            Self::AdamOnGpu(method) => method.set_learning_rate(rate),
            Self::Gradient(method) => method.set_learning_rate(rate),
        }
    }
}

/// Trains a network for the rest of a phase, which ends with the weights that are best for the
/// held-out samples. `report` is called after each round with both errors and the best network so
/// far, and returns whether to continue.
#[allow(clippy::too_many_arguments)]
pub fn train_phase(
    network: &Network,
    phase: &Phase,
    patience: usize,
    done: usize,
    training: &Rows,
    held_back: &Rows,
    random: &mut Pcg64,
    report: &mut dyn FnMut(f64, f64, &Network) -> bool,
) -> Result<f64> {
    let error_of = |network: &Network| held_back.mean_absolute_error(network)?.to_scalar::<f32>();
    let mut best = (error_of(network)?, network.snapshot()?);
    let mut descent = Descent::new(phase, network)?;
    let count = training.inputs.dim(0)?;
    let mut order: Vec<u32> = (0..count as u32).collect();
    let mut since = 0;
    let mut done = done;
    while phase
        .decay
        .map_or(since < patience, |decay| done < decay.rounds)
    {
        shuffle(&mut order, random);
        let device: &Device = training.inputs.device();
        let mut sum = 0.0;
        for (step, rows) in order.chunks(phase.batch).enumerate() {
            let round = (step * phase.batch) as f64 / count as f64;
            descent.set_rate(phase.rate_after(done as f64 + round));
            let chosen = training.chosen(&Tensor::new(rows, device)?)?;
            let error = chosen.mean_absolute_error(network)?;
            descent.step(&error)?;
            sum += f64::from(error.to_scalar::<f32>()?) * rows.len() as f64;
        }
        let held = error_of(network)?;
        since += 1;
        done += 1;
        if held < best.0 {
            // Small improvements do not extend a phase.
            if held < 0.998 * best.0 {
                since = 0;
            }
            best = (held, network.snapshot()?);
        }
        if !report(sum / count as f64, f64::from(held), &best.1) {
            break;
        }
    }
    network.restore(&best.1)?;
    Ok(f64::from(best.0))
}

/// Random numbers of a phase. They depend only on the seed and the phase, so that a phase can be
/// restarted.
pub fn random_of_phase(seed: u64, phase: usize) -> Pcg64 {
    Pcg64::seed_from_u64(seed.wrapping_mul(1_000_003).wrapping_add(phase as u64 + 1))
}
