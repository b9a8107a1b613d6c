//! A trained network with all data needed to use it, and its file.
//!
//! The file is in the safetensors format: weights and biases as `layer.0.weight`, `layer.0.bias`,
//! ... (single precision), and under `rodlab` in its metadata a JSON text with the names of
//! columns, the standardisation, the range of the samples and their origin.
//!
//! The text holds a BLAKE3 checksum of itself and of all weights and biases. Without it a flipped
//! bit would usually give another finite weight, which the network would use. Files of version 1
//! have no checksum; they are read with a warning.

use super::network::Network;
use super::scaling::Scaling;
use candle_core::{Device, Tensor};
use safetensors::tensor::{Dtype, SafeTensors, TensorView};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, HashMap};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Format name in the metadata of a model.
const KIND: &str = "rodlab multilayer perceptron";
/// Version of the file.
const VERSION: u32 = 2;
/// The last version whose files have no checksum.
const UNCHECKED_VERSION: u32 = 1;
/// Maximum number of layers and numbers of a file: far above those of any trained model.
const MOST_LAYERS: usize = 64;
/// Largest file, bytes.
const LARGEST_FILE: u64 = 1 << 30;

/// A network with the meaning of its numbers and its range.
#[derive(Clone, Debug)]
pub struct Model {
    /// The metadata of the file.
    pub about: About,
    network: Network,
}

/// Description of a model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct About {
    kind: String,
    version: u32,
    /// Kind of the samples, such as `grasp-samples`.
    pub samples: String,
    /// Names of the inputs.
    pub inputs: Vec<String>,
    /// Names of the outputs.
    pub outputs: Vec<String>,
    /// Standardisation of the inputs.
    pub input_scaling: Scaling,
    /// Standardisation of the outputs.
    pub output_scaling: Scaling,
    /// Smallest and largest value of each input in the training.
    pub range: Vec<[f64; 2]>,
    /// Least and largest value of each output; missing in models of earlier versions.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub output_range: Vec<[f64; 2]>,
    /// Origin of the model: program, commit, number of samples, seed, errors.
    pub provenance: BTreeMap<String, String>,
    /// Checksum of a file, see [`checksum`]; `None` for a model in memory.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    checksum: Option<String>,
}

/// Reason why a model cannot be used.
#[derive(Debug, Error)]
pub enum ModelError {
    /// There is no GPU for training.
    #[error("no GPU can be used: {0}")]
    NoGpu(String),
    /// A file cannot be used.
    #[error("{path} {fault}")]
    File {
        /// The file.
        path: PathBuf,
        /// The fault.
        fault: ModelFault,
    },
    /// The library of tensors failed.
    #[error("the network failed: {0}")]
    Tensors(#[from] candle_core::Error),
}

/// Reason why a file is not a model, or not the required one.
#[derive(Debug, Error)]
pub enum ModelFault {
    /// The file is not a safetensors file, or is truncated.
    #[error("is not a whole safetensors file: {0}")]
    NotSafetensors(safetensors::SafeTensorError),
    /// The file belongs to another program.
    #[error(
        "holds weights, but is not a model of rodlab (no text `rodlab` in its metadata): train one with `rodlab train`"
    )]
    Foreign,
    /// The model has another version.
    #[error("is a model of version {0}; this program reads version {VERSION}: train it again")]
    Version(u32),
    /// The bytes of the model were changed.
    #[error(
        "is damaged: its checksum is {found}, but {noted} was recorded when it was written; copy the file again, or train the model again \
         with `rodlab train`"
    )]
    Damaged {
        /// Checksum of the content.
        found: String,
        /// Checksum in the file.
        noted: String,
    },
    /// The metadata of the model are inconsistent.
    #[error("is inconsistent: {0}")]
    Contradiction(String),
    /// The file is a model of another kind.
    #[error("is a model of `{found}`; a model of `{wanted}` is needed here")]
    OtherKind {
        /// Kind of its samples.
        found: String,
        /// The required kind.
        wanted: String,
    },
    /// The model was trained on other columns.
    #[error("predicts {found}; needed here: {wanted}")]
    Columns {
        /// Outputs and inputs of the model.
        found: String,
        /// Those that are needed.
        wanted: String,
    },
    /// The file could not be read.
    #[error("cannot be read: {0}")]
    Unreadable(std::io::Error),
    /// The file is too large for a model.
    #[error("is larger than {LARGEST_FILE} bytes, the limit for a model of rodlab")]
    TooLarge,
}

impl About {
    /// A model for samples of a kind. The standardisation and ranges are those of the training
    /// samples, with inputs first.
    pub fn new(
        samples: &str,
        names: [Vec<String>; 2],
        scalings: [Scaling; 2],
        ranges: [Vec<[f64; 2]>; 2],
    ) -> Self {
        let [inputs, outputs] = names;
        let [range, output_range] = ranges;
        let [input_scaling, output_scaling] = scalings;
        Self {
            kind: KIND.to_owned(),
            version: VERSION,
            samples: samples.to_owned(),
            inputs,
            outputs,
            input_scaling,
            output_scaling,
            range,
            output_range,
            provenance: BTreeMap::new(),
            checksum: None,
        }
    }

    /// The inconsistency.
    fn fault(&self) -> Option<String> {
        let (inputs, outputs) = (self.inputs.len(), self.outputs.len());
        let scaling = |scaling: &Scaling, width: usize| {
            let all = scaling.mean.iter().chain(&scaling.deviation);
            scaling.mean.len() == width
                && scaling.deviation.len() == width
                && all.clone().all(|number| number.is_finite())
                && scaling.deviation.iter().all(|deviation| *deviation > 0.0)
        };
        if inputs == 0 || outputs == 0 {
            Some("it has no inputs or no outputs".into())
        } else if !scaling(&self.input_scaling, inputs) || !scaling(&self.output_scaling, outputs) {
            Some("the standardisation does not match the columns".into())
        } else if self.range.len() != inputs || self.range.iter().any(|[from, to]| !(from <= to)) {
            Some("the range does not match the inputs".into())
        } else if ![0, outputs].contains(&self.output_range.len())
            || self.output_range.iter().any(|[from, to]| !(from <= to))
        {
            Some("the range of the outputs does not match the outputs".into())
        } else {
            None
        }
    }
}

impl Model {
    /// A network and its description.
    pub fn new(about: About, network: Network) -> Self {
        Self { about, network }
    }

    /// The network.
    pub fn network(&self) -> &Network {
        &self.network
    }

    /// Whether inputs lie within the range of the samples.
    pub fn covers(&self, input: &[f64]) -> bool {
        let ranges = self.about.range.iter().zip(input);
        ranges.fold(true, |inside, ([from, to], value)| {
            // The border is included, despite rounding.
            let margin = 1e-9 * (to - from);
            inside && (from - margin..=to + margin).contains(value)
        })
    }

    /// Outputs, one row after the other, for rows of inputs.
    ///
    /// # Errors
    /// [`ModelError::Tensors`].
    pub fn predict(&self, inputs: &[f64]) -> Result<Vec<f64>, ModelError> {
        let width = self.about.inputs.len();
        let rows = inputs.len() / width;
        if rows == 0 {
            return Ok(Vec::new());
        }
        let standard = self
            .about
            .input_scaling
            .standardised(&inputs[..rows * width]);
        let standard = Tensor::from_vec(standard, (rows, width), &Device::Cpu)?;
        let outputs = self.network.forward(&standard)?.flatten_all()?;
        Ok(self.about.output_scaling.restored(&outputs.to_vec1()?))
    }

    /// Outputs for each row of inputs within the range of the samples, `None` for the others.
    ///
    /// # Errors
    /// [`ModelError::Tensors`].
    pub fn predict_covered<const WIDTH: usize>(
        &self,
        rows: &[[f64; WIDTH]],
    ) -> Result<Vec<Option<Vec<f64>>>, ModelError> {
        let covered = |row: &&[f64; WIDTH]| self.covers(&row[..]);
        let inputs: Vec<f64> = rows.iter().filter(covered).flatten().copied().collect();
        let outputs = self.predict(&inputs)?;
        let mut outputs = outputs.chunks_exact(self.about.outputs.len());
        let of = |row| covered(&row).then(|| outputs.next()).flatten();
        Ok(rows
            .iter()
            .map(of)
            .map(|row| row.map(<[f64]>::to_vec))
            .collect())
    }

    /// The model from the file `path`, if it predicts these outputs from these inputs.
    ///
    /// # Errors
    /// [`ModelFault::Columns`].
    pub fn with_columns(
        self,
        path: &Path,
        inputs: &[&str],
        outputs: &[&str],
    ) -> Result<Self, ModelError> {
        if self.about.inputs == inputs && self.about.outputs == outputs {
            return Ok(self);
        }
        let words = |outputs: String, inputs: String| format!("{outputs} from {inputs}");
        Err(ModelError::File {
            path: path.to_owned(),
            fault: ModelFault::Columns {
                found: words(self.about.outputs.join(", "), self.about.inputs.join(", ")),
                wanted: words(outputs.join(", "), inputs.join(", ")),
            },
        })
    }

    /// The bytes of its file.
    ///
    /// # Errors
    /// [`ModelError::Tensors`].
    pub fn to_bytes(&self) -> Result<Vec<u8>, ModelError> {
        let mut tensors = Vec::new();
        for (index, layer) in self.network.tensors().into_iter().enumerate() {
            for (tensor, part) in layer.into_iter().zip(["weight", "bias"]) {
                let numbers: Vec<f32> = tensor.flatten_all()?.to_vec1()?;
                let bytes: Vec<u8> = numbers
                    .iter()
                    .flat_map(|number| number.to_le_bytes())
                    .collect();
                tensors.push((name(index, part), tensor.dims().to_vec(), bytes));
            }
        }
        let views = tensors.iter().map(|(name, shape, bytes)| {
            let view = TensorView::new(Dtype::F32, shape.clone(), bytes);
            (name, view.expect("as many bytes as the shape says"))
        });
        let parts = tensors
            .iter()
            .map(|(name, shape, bytes)| (&name[..], &shape[..], &bytes[..]));
        let about = About {
            version: VERSION,
            checksum: None,
            ..self.about.clone()
        };
        let about = About {
            checksum: Some(checksum(&about, parts)),
            ..about
        };
        let about = serde_json::to_string(&about).expect("names and numbers are JSON values");
        let metadata = HashMap::from([("rodlab".to_owned(), about)]);
        let bytes = safetensors::serialize(views, Some(metadata));
        Ok(bytes.expect("tensors of single precision can be written"))
    }

    /// A model from the bytes of the file `path`, which must be a model of samples of the kind
    /// `wanted`.
    ///
    /// # Errors
    /// See [`ModelError`].
    pub fn from_bytes(path: &Path, bytes: &[u8], wanted: &str) -> Result<Self, ModelError> {
        let refused = |fault| ModelError::File {
            path: path.to_owned(),
            fault,
        };
        let broken = |error| refused(ModelFault::NotSafetensors(error));
        let contradiction = |fault: String| refused(ModelFault::Contradiction(fault));
        let (_, metadata) = SafeTensors::read_metadata(bytes).map_err(broken)?;
        let text = metadata
            .metadata()
            .as_ref()
            .and_then(|texts| texts.get("rodlab"));
        let text = text.ok_or_else(|| refused(ModelFault::Foreign))?;
        // The version is checked first, since other versions have other metadata.
        let value: serde_json::Value =
            serde_json::from_str(text).map_err(|error| contradiction(error.to_string()))?;
        if value["kind"] != KIND {
            return Err(refused(ModelFault::Foreign));
        }
        match value["version"].as_u64() {
            Some(version)
                if (u64::from(UNCHECKED_VERSION)..=u64::from(VERSION)).contains(&version) => {}
            version => {
                let version = version.and_then(|version| u32::try_from(version).ok());
                return Err(refused(ModelFault::Version(version.unwrap_or(u32::MAX))));
            }
        }
        let mut about: About =
            serde_json::from_value(value).map_err(|error| contradiction(error.to_string()))?;
        if about.samples != wanted {
            return Err(refused(ModelFault::OtherKind {
                found: about.samples,
                wanted: wanted.to_owned(),
            }));
        }
        if let Some(fault) = about.fault() {
            return Err(contradiction(fault));
        }
        let file = SafeTensors::deserialize(bytes).map_err(broken)?;
        let count = file.len() / 2;
        if file.len() % 2 != 0 || count == 0 || count > MOST_LAYERS {
            return Err(contradiction(format!("it has {} tensors", file.len())));
        }
        let mut width = about.inputs.len();
        let mut layers = Vec::new();
        for index in 0..count {
            let read = |part| {
                let view = file.tensor(&name(index, part));
                let view = view.map_err(|error| contradiction(error.to_string()))?;
                numbers(&view).ok_or_else(|| {
                    contradiction(format!(
                        "{} must hold finite numbers of single precision",
                        name(index, part)
                    ))
                })
            };
            let (weight, weights) = read("weight")?;
            let (bias, biases) = read("bias")?;
            let [outputs] = bias[..] else {
                return Err(contradiction(format!(
                    "{} is not a list",
                    name(index, "bias")
                )));
            };
            if weight != [outputs, width] {
                return Err(contradiction(format!(
                    "{} is of shape {weight:?}, expected [{outputs}, {width}]",
                    name(index, "weight")
                )));
            }
            layers.push([
                Tensor::from_vec(weights, (outputs, width), &Device::Cpu)?,
                Tensor::from_vec(biases, outputs, &Device::Cpu)?,
            ]);
            width = outputs;
        }
        if width != about.outputs.len() {
            return Err(contradiction(format!(
                "the last layer has {width} outputs, but there are {} names of outputs",
                about.outputs.len()
            )));
        }
        match about.checksum.take() {
            Some(noted) => {
                let found = checksum_of_file(&about, &file, count);
                let found = found.map_err(|error| contradiction(error.to_string()))?;
                if found != noted {
                    return Err(refused(ModelFault::Damaged { found, noted }));
                }
            }
            None if about.version > UNCHECKED_VERSION => {
                return Err(contradiction("it has no checksum".into()));
            }
            None => tracing::warn!(
                "{} has no checksum, so damage cannot be detected: it was written by an earlier \
                 version; train it again to add one",
                path.display()
            ),
        }
        about.version = VERSION;
        Ok(Self {
            about,
            network: Network::from_tensors(layers)?,
        })
    }
}

/// Whether a file begins like a model of rodlab. The metadata are the first key of its header.
pub fn is_model(head: &[u8]) -> bool {
    let text = head.get(8..).unwrap_or_default();
    text.starts_with(b"{\"__metadata__\":{\"rodlab\":")
        && String::from_utf8_lossy(text).contains(KIND)
}

/// Reads a model of samples of the kind `wanted`.
///
/// # Errors
/// See [`ModelError`].
pub fn read_model(path: &Path, wanted: &str) -> Result<Model, ModelError> {
    let refused = |fault| ModelError::File {
        path: path.to_owned(),
        fault,
    };
    let failed = |error| refused(ModelFault::Unreadable(error));
    let file = File::open(path).map_err(failed)?;
    let mut bytes = Vec::new();
    file.take(LARGEST_FILE + 1)
        .read_to_end(&mut bytes)
        .map_err(failed)?;
    if bytes.len() as u64 > LARGEST_FILE {
        return Err(refused(ModelFault::TooLarge));
    }
    Model::from_bytes(path, &bytes, wanted)
}

/// Checksum of a model's text, without the checksum itself, and of its tensors with name, shape
/// and bytes, in the order of the layers.
fn checksum<'a>(
    about: &About,
    tensors: impl Iterator<Item = (&'a str, &'a [usize], &'a [u8])>,
) -> String {
    let mut hasher = blake3::Hasher::new();
    let mut add = |bytes: &[u8]| {
        // The length is hashed, too, so that bytes cannot move between parts.
        hasher.update(&(bytes.len() as u64).to_le_bytes());
        hasher.update(bytes);
    };
    add(&serde_json::to_vec(about).expect("names and numbers are JSON values"));
    for (name, shape, bytes) in tensors {
        add(name.as_bytes());
        let shape = shape.iter().flat_map(|size| (*size as u64).to_le_bytes());
        add(&shape.collect::<Vec<u8>>());
        add(bytes);
    }
    hasher.finalize().to_hex().to_string()
}

/// Checksum of a file with `count` layers.
fn checksum_of_file(
    about: &About,
    file: &SafeTensors<'_>,
    count: usize,
) -> Result<String, safetensors::SafeTensorError> {
    let mut views = Vec::with_capacity(2 * count);
    for layer in 0..count {
        for part in ["weight", "bias"] {
            let name = name(layer, part);
            let view = file.tensor(&name)?;
            views.push((name, view));
        }
    }
    let parts = views
        .iter()
        .map(|(name, view)| (&name[..], view.shape(), view.data()));
    Ok(checksum(about, parts))
}

fn name(layer: usize, part: &str) -> String {
    format!("layer.{layer}.{part}")
}

/// Shape and numbers of a single-precision tensor.
fn numbers(view: &TensorView<'_>) -> Option<(Vec<usize>, Vec<f32>)> {
    if view.dtype() != Dtype::F32 {
        return None;
    }
    let numbers = view.data().chunks_exact(4);
    let numbers: Vec<f32> = numbers
        .map(|bytes| f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]))
        .collect();
    let finite = numbers.iter().all(|number| number.is_finite());
    finite.then(|| (view.shape().to_vec(), numbers))
}
