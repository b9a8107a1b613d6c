//! The directory of a training: model, rounds, figure and state.

use super::loss_figure::loss_figure;
use super::model::{ModelError, is_model, read_model};
use super::processor::Processor;
use super::samples::{Samples, SamplesError};
use super::trainer::{FEWEST_SAMPLES, Standing, Trainer};
use super::training::{Epoch, Plan};
use rodlab_files::figure::is_picture;
use rodlab_files::results::{ResultsError, check_own, is_unfinished, write_whole};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use thiserror::Error;

/// The best network so far.
pub const MODEL: &str = "model.safetensors";
/// Errors of all rounds.
pub const EPOCHS: &str = "training.csv";
/// The same as a figure.
pub const LOSS_FIGURE: &str = "training.svg";
/// State of the training.
pub const RECORD: &str = "training.json";

/// First line of `training.csv`.
const EPOCHS_HEADER: &[u8] = b"epoch,phase,training,held_back\n";

/// Files in addition to the record, each with the first bytes of a valid file.
type IsOwn = fn(&[u8]) -> bool;
const OWN_FILES: [(&str, IsOwn); 3] = [
    (MODEL, is_model),
    (EPOCHS, |head| head.starts_with(EPOCHS_HEADER)),
    (LOSS_FIGURE, is_picture),
];

/// Interval at which the best network is written during a phase.
const SAVED_EVERY: Duration = Duration::from_secs(20);

/// Task of a training.
#[derive(Clone, Debug)]
pub struct Task<'a> {
    /// CSV files of the samples.
    pub samples: &'a [PathBuf],
    /// Kind of the samples.
    pub kind: &'a str,
    /// Input columns.
    pub inputs: &'a [&'a str],
    /// Output columns.
    pub outputs: &'a [&'a str],
    /// Weights of the errors of the outputs; equal if empty.
    pub weights: &'a [f64],
    /// Settings of the training.
    pub plan: Plan,
    /// The processor.
    pub processor: Processor,
    /// Directory of the results.
    pub directory: &'a Path,
    /// Whether to discard an earlier training in the directory.
    pub force: bool,
}

/// Result of a training.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Trained {
    /// State of the training at its end.
    pub status: Status,
    /// Number of samples, held-out ones included.
    pub samples: usize,
    /// Rounds over them.
    pub epochs: usize,
    /// Smallest mean absolute error of the standardised held-out outputs.
    pub held_back_error: Option<f64>,
    /// The model.
    pub model: PathBuf,
}

/// State of a training.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// All phases are done.
    Finished,
    /// The training was stopped; the next start resumes it.
    Stopped,
}

/// `training.json`.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Record {
    status: Status,
    /// The task.
    task: RecordedTask,
    /// The next phase.
    next_phase: usize,
    samples: usize,
    epochs: usize,
    held_back_error: Option<f64>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct RecordedTask {
    kind: String,
    inputs: Vec<String>,
    outputs: Vec<String>,
    #[serde(default)]
    weights: Vec<f64>,
    /// BLAKE3 of the samples' files.
    samples_hash: String,
    plan: Plan,
}

/// A row of `training.csv`.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct EpochRow {
    epoch: usize,
    phase: usize,
    training: f64,
    held_back: f64,
}

/// Why training failed.
#[derive(Debug, Error)]
pub enum TrainingError {
    /// Samples could not be read.
    #[error(transparent)]
    Samples(#[from] SamplesError),
    /// There are too few samples.
    #[error("{path} has {rows} samples; at least {FEWEST_SAMPLES} are needed")]
    TooFew {
        /// The file.
        path: PathBuf,
        /// Number of samples.
        rows: usize,
    },
    /// The directory belongs to another training.
    #[error(
        "{directory} holds another training, which differs in {what}; choose another directory \
         with --out, or start over with --force"
    )]
    Another {
        /// The directory.
        directory: PathBuf,
        /// The difference.
        what: &'static str,
    },
    /// The directory holds other files.
    #[error(
        "{directory} is not empty and does not hold a training ({RECORD}); choose another with --out"
    )]
    NotOwn {
        /// The directory.
        directory: PathBuf,
    },
    /// The record belongs to another program, or is damaged.
    #[error(
        "{path} is not the record of a training: {fault}; it is not replaced: choose another directory with --out"
    )]
    NotRecord {
        /// The file.
        path: PathBuf,
        /// The error.
        fault: String,
    },
    /// A file of an earlier call is damaged.
    #[error("{path} is damaged: {fault}; start over with --force")]
    Damaged {
        /// The file.
        path: PathBuf,
        /// The error.
        fault: String,
    },
    /// The model failed.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A file could not be read or written.
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// An error of the operating system.
    #[error("{path}: {error}")]
    System {
        /// The file.
        path: PathBuf,
        /// Message of the system.
        error: std::io::Error,
    },
}

/// Trains a network, or resumes its training; `keep_going` is called after each round.
///
/// # Errors
/// See [`TrainingError`].
pub fn train(
    task: &Task<'_>,
    provenance: &[(&str, String)],
    keep_going: &mut dyn FnMut(&Trainer) -> bool,
) -> Result<Trained, TrainingError> {
    let system = |path: &Path| {
        let path = path.to_owned();
        |error| TrainingError::System { path, error }
    };
    let mut hash = blake3::Hasher::new();
    for path in task.samples {
        hash.update(&std::fs::read(path).map_err(system(path))?);
    }
    let owned = |names: &[&str]| {
        names
            .iter()
            .map(|name| (*name).to_owned())
            .collect::<Vec<_>>()
    };
    let recorded = RecordedTask {
        kind: task.kind.to_owned(),
        inputs: owned(task.inputs),
        outputs: owned(task.outputs),
        weights: task.weights.to_vec(),
        samples_hash: hash.finalize().to_hex().to_string(),
        plan: task.plan.clone(),
    };
    let earlier = earlier(task, &recorded)?;
    if let Some(record) = &earlier
        && record.status == Status::Finished
    {
        return Ok(trained(task, record));
    }
    let samples = Samples::read_all(task.samples, task.inputs, task.outputs)?;
    if samples.rows() < FEWEST_SAMPLES {
        return Err(TrainingError::TooFew {
            path: task.samples.first().cloned().unwrap_or_default(),
            rows: samples.rows(),
        });
    }
    let names = [owned(task.inputs), owned(task.outputs)];
    let mut trainer = Trainer::new(
        task.plan.clone(),
        task.kind,
        names,
        task.weights,
        &samples,
        task.processor,
    )?;
    std::fs::create_dir_all(task.directory).map_err(system(task.directory))?;
    match &earlier {
        None => begin(task, &recorded, &samples)?,
        // A training killed before its first round was written starts from scratch.
        Some(record) if record.epochs == 0 => {}
        Some(record) => resume(task, record, &mut trainer)?,
    }
    let write =
        |trainer: &Trainer, status| write(task, &recorded, provenance, &samples, trainer, status);
    let mut written = Instant::now();
    let mut failed = None;
    let mut keep_going = |trainer: &Trainer| {
        if written.elapsed() > SAVED_EVERY {
            failed = write(trainer, Status::Stopped).err();
            written = Instant::now();
        }
        keep_going(trainer) && failed.is_none()
    };
    let standing = trainer.train(&mut keep_going, &mut |trainer| {
        write(trainer, Status::Stopped).map(drop)
    })?;
    if let Some(error) = failed {
        return Err(error);
    }
    let status = match standing {
        Standing::Finished => Status::Finished,
        Standing::Stopped => Status::Stopped,
    };
    let record = write(&trainer, status)?;
    Ok(trained(task, &record))
}

fn trained(task: &Task<'_>, record: &Record) -> Trained {
    Trained {
        status: record.status,
        samples: record.samples,
        epochs: record.epochs,
        held_back_error: record.held_back_error,
        model: task.directory.join(MODEL),
    }
}

/// The record of an earlier call for the same task.
fn earlier(task: &Task<'_>, recorded: &RecordedTask) -> Result<Option<Record>, TrainingError> {
    let directory = task.directory;
    let path = directory.join(RECORD);
    if !path.exists() {
        let entries = std::fs::read_dir(directory).into_iter().flatten().flatten();
        let mut others = entries.filter(|entry| !is_unfinished(&entry.file_name()));
        return match others.next() {
            None => Ok(None),
            Some(_) => Err(TrainingError::NotOwn {
                directory: directory.to_owned(),
            }),
        };
    }
    let record: Record =
        serde_json::from_slice(&read(&path)?).map_err(|error| TrainingError::NotRecord {
            path,
            fault: error.to_string(),
        })?;
    for (name, is_own) in OWN_FILES {
        check_own(&directory.join(name), is_own)?;
    }
    if task.force {
        for name in [MODEL, EPOCHS, LOSS_FIGURE, RECORD] {
            // Missing files need not be removed.
            let _ = std::fs::remove_file(directory.join(name));
        }
        return Ok(None);
    }
    let differs = |what| TrainingError::Another {
        directory: directory.to_owned(),
        what,
    };
    if record.task.plan != recorded.plan {
        Err(differs("how the network is trained"))
    } else if record.task != *recorded {
        Err(differs("the samples"))
    } else {
        Ok(Some(record))
    }
}

/// Writes the owner of the directory, before anything else.
fn begin(task: &Task<'_>, recorded: &RecordedTask, samples: &Samples) -> Result<(), TrainingError> {
    place_record(
        task,
        &Record {
            status: Status::Stopped,
            task: recorded.clone(),
            next_phase: 0,
            samples: samples.rows(),
            epochs: 0,
            held_back_error: None,
        },
    )
}

fn place_record(task: &Task<'_>, record: &Record) -> Result<(), TrainingError> {
    let json = serde_json::to_vec_pretty(record).expect("names and numbers are JSON values");
    Ok(write_whole(&task.directory.join(RECORD), &json)?)
}

fn resume(task: &Task<'_>, record: &Record, trainer: &mut Trainer) -> Result<(), TrainingError> {
    let model = read_model(&task.directory.join(MODEL), task.kind)?;
    let path = task.directory.join(EPOCHS);
    let damaged = |fault: String| TrainingError::Damaged {
        path: path.clone(),
        fault,
    };
    let bytes = read(&path)?;
    let mut reader = csv::Reader::from_reader(&bytes[..]);
    let rows: Result<Vec<EpochRow>, _> = reader.deserialize().collect();
    let rows = rows.map_err(|error| damaged(error.to_string()))?;
    let mut epochs: Vec<Epoch> = rows
        .into_iter()
        .map(|row| Epoch {
            phase: row.phase,
            training: row.training,
            held_back: row.held_back,
        })
        .collect();
    if epochs.len() < record.epochs {
        return Err(damaged(format!(
            "{} rounds, expected {}",
            epochs.len(),
            record.epochs
        )));
    }
    // The record is written last.
    epochs.truncate(record.epochs);
    trainer.resume(&model, epochs, record.next_phase)?;
    Ok(())
}

fn read(path: &Path) -> Result<Vec<u8>, TrainingError> {
    std::fs::read(path).map_err(|error| TrainingError::System {
        path: path.to_owned(),
        error,
    })
}

fn write(
    task: &Task<'_>,
    recorded: &RecordedTask,
    provenance: &[(&str, String)],
    samples: &Samples,
    trainer: &Trainer,
    status: Status,
) -> Result<Record, TrainingError> {
    let record = Record {
        status,
        task: recorded.clone(),
        next_phase: trainer.next_phase(),
        samples: samples.rows(),
        epochs: trainer.epochs().len(),
        held_back_error: trainer.least_error(),
    };
    let mut said = provenance.to_vec();
    said.extend([
        ("samples", record.samples.to_string()),
        ("samples_hash", recorded.samples_hash.clone()),
        ("seed", recorded.plan.seed.to_string()),
        ("epochs", record.epochs.to_string()),
        (
            "held_back_error",
            record.held_back_error.unwrap_or(f64::NAN).to_string(),
        ),
    ]);
    let place = |name: &str, bytes: &[u8]| write_whole(&task.directory.join(name), bytes);
    place(MODEL, &trainer.model(&said)?.to_bytes()?)?;
    let mut writer = csv::Writer::from_writer(Vec::new());
    for (index, epoch) in trainer.epochs().iter().enumerate() {
        let row = EpochRow {
            epoch: index + 1,
            phase: epoch.phase,
            training: epoch.training,
            held_back: epoch.held_back,
        };
        writer
            .serialize(row)
            .expect("numbers can be written to memory");
    }
    place(
        EPOCHS,
        &writer.into_inner().expect("memory can be written to"),
    )?;
    place(LOSS_FIGURE, loss_figure(trainer.epochs()).as_bytes())?;
    place_record(task, &record)?;
    Ok(record)
}
