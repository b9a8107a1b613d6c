//! `rodlab train`.

use super::prelude::*;
use super::samples::SampleFiles;
use indicatif::ProgressBar;
use rodlab_lab::run::{Interruption, StopRequest};
use rodlab_planning::learn::{self, Plan, Processor, Schedule, Status, Task, Trainer};
use std::time::{Duration, Instant};

/// Schedules by which the steps decrease.
const SCHEDULES: [Named<Schedule>; 2] = [
    (
        "cosine",
        Schedule::Cosine,
        "Adam with a rate that falls to zero along half a wave of a cosine",
    ),
    (
        "plateau",
        Schedule::Plateau,
        "Adam and gradient descent alternately, each until the error no longer falls",
    ),
];
/// Devices that train a network.
const DEVICES: [Named<Processor>; 2] = [
    (
        "cpu",
        Processor::Cpu,
        "The processor: the same network on every machine of a kind",
    ),
    ("gpu", Processor::Gpu, "The first GPU, by CUDA"),
];

const HELP: [&str; 2] = help!(
    "\
Examples:
  rodlab dataset scenarios/deployment_dataset.toml
  rodlab train results/deployment_dataset --out results/network
  rodlab evaluate results/network/model.safetensors results/other_samples
  rodlab train results/folding_dataset --out results/fold_network --batch 512",
    "\
The mean absolute error of the standardised outputs is minimised by Adam, for a fixed number of
rounds (--most-epochs) over which its rate falls to zero. One sample in five is held back, and the
network with the smallest error of these samples is kept. With --schedule plateau, as in the thesis,
Adam and gradient descent alternate: a phase ends when the error has not fallen for --patience
rounds; then batches are doubled and steps are made smaller. The best network so far is in
model.safetensors, which is written every 20 s. Run the same command again to resume."
);

/// Arguments of `rodlab train`.
#[derive(Debug, Args)]
#[command(after_help = HELP[0], after_long_help = HELP[1])]
pub struct TrainArguments {
    /// Results of `rodlab dataset`; those of a sweep are combined
    pub samples: PathBuf,
    /// Directory for the network
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Widths of the hidden layers
    #[arg(long, value_name = "WIDTHS", value_delimiter = ',', default_value = "392,392,392,392", value_parser = clap::value_parser!(u16).range(1..=4096))]
    pub hidden: Vec<u16>,
    /// Seed of the initial weights, of the samples held back, and of their order
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Initial number of samples in a batch
    #[arg(long, value_name = "N", default_value_t = 128, value_parser = clap::value_parser!(u32).range(1..=65_536))]
    pub batch: u32,
    /// Largest batch size, reached by doubling [default: that of --batch; with --schedule plateau
    /// 2048]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=65_536))]
    pub last_batch: Option<u32>,
    /// With --schedule plateau, number of rounds without improvement after which Adam stops;
    /// gradient descent stops after a quarter of that
    #[arg(long, value_name = "N", default_value_t = 30, value_parser = clap::value_parser!(u32).range(1..))]
    pub patience: u32,
    /// Number of rounds over all samples, with --schedule plateau the largest [default: 250; 2000]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub most_epochs: Option<u32>,
    /// Schedule of the learning rate
    #[arg(long, default_value = "cosine", value_parser = named(&SCHEDULES))]
    pub schedule: Schedule,
    /// Initial rate of Adam [default: 0.002; with --schedule plateau 0.001]
    #[arg(long, value_name = "RATE", value_parser = number(is_rate, "a number above 0 and up to 1 is needed"))]
    pub rate: Option<f64>,
    /// Device for the training; a GPU needs a program that was built with `--features cuda`
    #[arg(long, value_name = "PROCESSOR", default_value = "cpu", value_parser = named(&DEVICES))]
    pub device: Processor,
    /// Start over and discard an earlier training
    #[arg(long)]
    pub force: bool,
    /// Print the results as JSON
    #[arg(long)]
    pub json: bool,
    /// Stop this long after the start, such as "10 min"; the same command resumes
    #[arg(long, value_name = "TIME", value_parser = duration)]
    pub timeout: Option<Duration>,
}

/// Default of the largest batch with the schedule of the thesis.
const LAST_BATCH: u32 = 2048;
/// Ratio of the rate of Adam with the last batch to that with the first.
const LAST_RATE: f64 = 0.01;

fn is_rate(rate: f64) -> bool {
    rate > 0.0 && rate <= 1.0
}

/// Trains a network.
pub fn train(arguments: &TrainArguments, common: &Common) -> Result<(), Failure> {
    let deadline = arguments
        .timeout
        .and_then(|limit| Instant::now().checked_add(limit));
    let files = SampleFiles::of(&arguments.samples)?;
    let (rounds, rate, last_batch) = match arguments.schedule {
        Schedule::Plateau => (2000, 1e-3, LAST_BATCH.max(arguments.batch)),
        // Larger batches are fewer steps: 4,000 samples have only two batches of 2,048.
        Schedule::Cosine => (250, 2e-3, arguments.batch),
    };
    let last_batch = arguments.last_batch.unwrap_or(last_batch);
    if last_batch < arguments.batch {
        return Err(Failure::Input(format!(
            "--last-batch {last_batch} is less than --batch {}",
            arguments.batch
        )));
    }
    let rate = arguments.rate.unwrap_or(rate);
    let task = Task {
        samples: &files.files,
        kind: files.kind,
        inputs: files.columns.inputs,
        outputs: files.columns.outputs,
        weights: files.columns.weights,
        plan: Plan {
            hidden: arguments
                .hidden
                .iter()
                .map(|width| usize::from(*width))
                .collect(),
            seed: arguments.seed,
            batch: [arguments.batch, last_batch].map(|batch| batch as usize),
            patience: arguments.patience as usize,
            most_epochs: arguments.most_epochs.unwrap_or(rounds) as usize,
            schedule: arguments.schedule,
            rates: [rate, LAST_RATE * rate],
        },
        processor: arguments.device,
        directory: &arguments.out,
        force: arguments.force,
    };
    let interruption = Interruption::watch();
    let mut stopped = None;
    let bar = common.progress(
        ProgressBar::new_spinner(),
        "{spinner} {msg} [{elapsed_precise}]",
    );
    let mut goes_on = |trainer: &Trainer| {
        show(&bar, trainer);
        let up = deadline.is_some_and(|deadline| Instant::now() >= deadline);
        stopped = interruption
            .requested()
            .or(up.then_some(StopRequest::TimeLimit));
        stopped.is_none()
    };
    let commit = rodlab_files::origin::commit().unwrap_or("unknown");
    let provenance = [
        ("program", format!("rodlab {}", env!("CARGO_PKG_VERSION"))),
        ("commit", commit.to_owned()),
    ];
    let trained = learn::train(&task, &provenance, &mut goes_on);
    bar.finish_and_clear();
    let trained = trained.map_err(|error| Failure::of_training(&error))?;
    if arguments.json {
        print_json(&trained)?;
    } else {
        let error = trained.held_back_error.unwrap_or(f64::NAN);
        print(&format!(
            "{}\nmodel                   {}\nsamples                 {}, one in five held back\nrounds                  {}\n\
             error of those held back {error:.2e} (mean absolute, standardised)\n",
            match trained.status {
                Status::Finished => "finished",
                Status::Stopped => "stopped; run the same command again to resume",
            },
            trained.model.display(),
            trained.samples,
            trained.epochs,
        ))?;
    }
    match (trained.status, stopped) {
        (Status::Stopped, Some(request)) => Err(Failure::Stopped(request)),
        _ => Ok(()),
    }
}

fn show(bar: &ProgressBar, trainer: &Trainer) {
    let phases = trainer.phases();
    if let Some(epoch) = trainer.epochs().last() {
        bar.set_message(format!(
            "phase {} of {}, round {}: error {:.2e}, of those held back {:.2e}, at best {:.2e}",
            epoch.phase + 1,
            phases.len(),
            trainer.epochs().len(),
            epoch.training,
            epoch.held_back,
            trainer.least_error().unwrap_or(f64::NAN),
        ));
        bar.tick();
    }
}
