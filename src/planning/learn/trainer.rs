//! A training that can be interrupted: phase after phase, with the state needed to resume.

use super::model::{About, Model, ModelError};
use super::network::Network;
use super::processor::Processor;
use super::samples::Samples;
use super::scaling::{Scaling, range_of};
use super::training::{Epoch, Phase, Plan, Rows, random_of_phase, train_phase};
use candle_core::{Device, Tensor};

/// Fraction of held-out samples (thesis 5.3.5).
pub const HELD_BACK: f64 = 0.2;
/// Minimum number of samples that can be split and standardised.
pub const FEWEST_SAMPLES: usize = 50;

/// Standardised samples, a network, and its progress.
#[derive(Debug)]
pub struct Trainer {
    plan: Plan,
    about: About,
    training: Rows,
    held_back: Rows,
    network: Network,
    /// The best network for the held-out samples.
    best: Network,
    next: usize,
    epochs: Vec<Epoch>,
}

/// State of a training.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standing {
    /// All phases are done.
    Finished,
    /// It was stopped.
    Stopped,
}

impl Trainer {
    /// A training before its first phase. `names` are the names of the input and output columns of
    /// samples of a kind. An error of an output with `weight` 2 counts twice; without weights all
    /// outputs count equally.
    ///
    /// # Errors
    /// [`ModelError::Tensors`]; [`ModelError::NoGpu`].
    ///
    /// # Panics
    /// If there are fewer than [`FEWEST_SAMPLES`].
    pub fn new(
        plan: Plan,
        kind: &str,
        names: [Vec<String>; 2],
        weights: &[f64],
        samples: &Samples,
        processor: Processor,
    ) -> Result<Self, ModelError> {
        let device = processor.device()?;
        assert!(samples.rows() >= FEWEST_SAMPLES, "too few samples to split");
        let [kept, held] = samples.split(HELD_BACK, plan.seed);
        let inputs = Scaling::of(&kept.inputs, kept.input_width);
        let outputs = Scaling::of(&kept.outputs, kept.output_width).weighted(weights);
        let rows = |samples: &Samples| -> candle_core::Result<Rows> {
            let tensor =
                |numbers, width| Tensor::from_vec(numbers, (samples.rows(), width), &device);
            Ok(Rows {
                inputs: tensor(inputs.standardised(&samples.inputs), samples.input_width)?,
                outputs: tensor(outputs.standardised(&samples.outputs), samples.output_width)?,
            })
        };
        let (training, held_back) = (rows(&kept)?, rows(&held)?);
        let mut widths = vec![samples.input_width];
        widths.extend(&plan.hidden);
        widths.push(samples.output_width);
        let mut random = random_of_phase(plan.seed, usize::MAX - 1);
        let network = Network::new(&widths, &mut random, &device)?;
        Ok(Self {
            best: network.snapshot()?,
            network,
            about: About::new(
                kind,
                names,
                [inputs, outputs],
                [
                    range_of(&samples.inputs, samples.input_width),
                    range_of(&samples.outputs, samples.output_width),
                ],
            ),
            plan,
            training,
            held_back,
            next: 0,
            epochs: Vec::new(),
        })
    }

    /// Resumes a training, given the best weights so far, the previous rounds, and the current
    /// phase.
    ///
    /// # Errors
    /// [`ModelError::Tensors`]: the model is of another shape.
    pub fn resume(
        &mut self,
        model: &Model,
        epochs: Vec<Epoch>,
        next: usize,
    ) -> Result<(), ModelError> {
        self.network.restore(model.network())?;
        self.best = self.network.snapshot()?;
        self.epochs = epochs;
        self.next = next;
        Ok(())
    }

    /// Phases of the trainer.
    pub fn phases(&self) -> Vec<Phase> {
        self.plan.phases()
    }

    /// The next or interrupted phase.
    pub fn next_phase(&self) -> usize {
        self.next
    }

    /// All rounds so far.
    pub fn epochs(&self) -> &[Epoch] {
        &self.epochs
    }

    /// Least mean absolute error of the standardised held-out outputs; `None` before the first
    /// round.
    pub fn least_error(&self) -> Option<f64> {
        let errors = self.epochs.iter().map(|epoch| epoch.held_back);
        errors.min_by(f64::total_cmp)
    }

    /// Trains until all phases are done, or until `keep_going` returns `false` after a round; `saved`
    /// is called after each phase.
    ///
    /// # Errors
    /// [`ModelError::Tensors`], and the errors of `saved`.
    pub fn train<Error: From<ModelError>>(
        &mut self,
        keep_going: &mut dyn FnMut(&Self) -> bool,
        saved: &mut dyn FnMut(&Self) -> Result<(), Error>,
    ) -> Result<Standing, Error> {
        for (index, phase) in self.phases().iter().enumerate().skip(self.next) {
            let mut stopped = self.epochs.len() >= self.plan.most_epochs;
            if !stopped {
                let mut random = random_of_phase(self.plan.seed, index);
                let network = self.network.clone();
                let (training, held_back) = (self.training.clone(), self.held_back.clone());
                let patience = self.plan.patience_of(phase);
                let done = self.epochs.iter().filter(|epoch| epoch.phase == index);
                let done = done.count();
                let mut report = |error: f64, held_back: f64, best: &Network| {
                    self.best = best.clone();
                    self.epochs.push(Epoch {
                        phase: index,
                        training: error,
                        held_back,
                    });
                    stopped = !keep_going(self);
                    !stopped && self.epochs.len() < self.plan.most_epochs
                };
                train_phase(
                    &network,
                    phase,
                    patience,
                    done,
                    &training,
                    &held_back,
                    &mut random,
                    &mut report,
                )
                .map_err(ModelError::from)?;
            }
            if stopped && self.epochs.len() < self.plan.most_epochs {
                saved(self)?;
                return Ok(Standing::Stopped);
            }
            self.next = index + 1;
            saved(self)?;
        }
        Ok(Standing::Finished)
    }

    /// The best network so far, as a model with its origin.
    ///
    /// # Errors
    /// [`ModelError::Tensors`].
    pub fn model(&self, provenance: &[(&str, String)]) -> Result<Model, ModelError> {
        let mut about = self.about.clone();
        let provenance = provenance
            .iter()
            .map(|(name, text)| ((*name).to_owned(), text.clone()));
        about.provenance = provenance.collect();
        Ok(Model::new(about, self.best.on(&Device::Cpu)?))
    }
}
