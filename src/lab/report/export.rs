//! Results as files for other programs: glTF, USD, OBJ.

use super::film::{MovieError, case_of};
use super::motion::CaseMotion;
use super::view::{ViewError, rods_in_motion};
use rodlab_files::figure::{ExchangeError, MovieCase, Tempo, glb, obj, usda};
use rodlab_files::origin::VERSION;
use rodlab_files::results::{ResultsError, replace_own};
use std::path::Path;

/// Format of results for other programs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ExportFormat {
    /// Binary glTF, animated.
    Gltf,
    /// USD text, animated.
    Usd,
    /// OBJ at the output nearest to a time, s; `None` is the last output.
    Obj(Option<f64>),
}

impl ExportFormat {
    /// Whether a file is one of this format, by its first bytes.
    fn is_own(self, head: &[u8]) -> bool {
        match self {
            Self::Gltf => head.starts_with(b"glTF"),
            Self::Usd => head.starts_with(b"#usda"),
            Self::Obj(_) => head.starts_with(b"# rodlab"),
        }
    }
}

/// What to export.
#[derive(Clone, Debug)]
pub struct ExportRequest {
    /// The format.
    pub format: ExportFormat,
    /// The case of a sweep.
    pub case: Option<String>,
    /// Maximum number of outputs, evenly spread.
    pub outputs: usize,
    /// Speed of the animation.
    pub tempo: Tempo,
}

/// Summary of an exported file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WrittenExport {
    /// Number of outputs in the file.
    pub outputs: usize,
    /// Whether outputs were left out.
    pub thinned: bool,
    /// Size of the file, bytes.
    pub bytes: usize,
    /// Time of the only output in the file, s, if its format has no motion.
    pub time: Option<f64>,
}

/// Failure to export results.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The directory or the case shows no rods in motion.
    #[error(transparent)]
    Case(#[from] MovieError),
    /// The scene does not fit into the format.
    #[error(transparent)]
    Exchange(#[from] ExchangeError),
    /// A file could not be read or written.
    #[error(transparent)]
    Results(#[from] ResultsError),
}

/// Writes a results directory to the file `to`.
///
/// # Errors
/// [`ExportError`]. The file is written completely or not at all.
pub fn write_export(
    directory: &Path,
    to: &Path,
    request: &ExportRequest,
) -> Result<WrittenExport, ExportError> {
    let manifest = rods_in_motion(directory).map_err(MovieError::from)?;
    let folder = case_of(directory, request.case.as_deref(), "the file holds")?;
    let motion = CaseMotion::read(&folder, &manifest, request.outputs)?;
    let motion =
        motion.ok_or_else(|| MovieError::View(ViewError::NoNodes(directory.to_owned())))?;
    let scene = motion.scene();
    let generator = format!("rodlab {VERSION}");
    let (bytes, time) = match request.format {
        ExportFormat::Gltf => (glb(&scene, request.tempo, &generator)?, None),
        ExportFormat::Usd => (usda(&scene, request.tempo, &generator).into_bytes(), None),
        ExportFormat::Obj(time) => {
            let frame = nearest(&scene, time);
            let text = obj(&scene, frame, &generator);
            (text.into_bytes(), Some(scene.frames[frame].time))
        }
    };
    replace_own(to, &bytes, |head| request.format.is_own(head))?;
    Ok(WrittenExport {
        outputs: time.map_or(scene.frames.len(), |_| 1),
        thinned: motion.thinned,
        bytes: bytes.len(),
        time,
    })
}

/// Number of the output nearest to a time, s; without a time, the last one.
fn nearest(scene: &MovieCase, time: Option<f64>) -> usize {
    let last = scene.frames.len() - 1;
    let Some(time) = time else {
        return last;
    };
    let distance = |frame: &usize| (scene.frames[*frame].time - time).abs();
    (0..=last)
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
        .unwrap_or(last)
}
