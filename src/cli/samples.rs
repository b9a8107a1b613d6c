//! Samples in results directories, for `rodlab train` and `rodlab evaluate`.

use super::prelude::*;
use rodlab_files::results::{CASES, Manifest};
use rodlab_lab::experiment::{KINDS, SampleColumns, kind_named};

/// Files of samples of one kind.
pub struct SampleFiles {
    /// The kind.
    pub kind: &'static str,
    /// Columns of the files.
    pub columns: SampleColumns,
    /// One file, or the files of the cases of a sweep.
    pub files: Vec<PathBuf>,
}

/// Names of the kinds of experiments that generate samples.
pub fn kinds_with_samples() -> String {
    let kinds = KINDS.iter().filter(|kind| kind.samples().is_some());
    kinds.map(|kind| kind.name()).collect::<Vec<_>>().join(", ")
}

impl SampleFiles {
    /// Samples of a results directory.
    pub fn of(directory: &Path) -> Result<Self, Failure> {
        let refused = |why: String| Failure::Input(format!("{}: {why}", directory.display()));
        let manifest = Manifest::read_checked(directory)?;
        let manifest = manifest.ok_or_else(|| {
            refused("not a results directory (manifest.json is missing): make samples with `rodlab dataset`".into())
        })?;
        let kind = kind_named(&manifest.experiment);
        let Some((kind, columns)) = kind.and_then(|kind| Some((kind.name(), kind.samples()?)))
        else {
            return Err(refused(format!(
                "results of the experiment {:?}, which makes no samples; those that do: {}",
                manifest.experiment,
                kinds_with_samples()
            )));
        };
        let mut files = vec![directory.join(columns.file)];
        if !files[0].exists() {
            let cases = std::fs::read_dir(directory.join(CASES));
            let cases = cases.into_iter().flatten().flatten();
            files = cases.map(|case| case.path().join(columns.file)).collect();
            files.retain(|file| file.exists());
            // The order of directory listings is undefined.
            files.sort();
        }
        if files.is_empty() {
            return Err(refused(format!("there is no {} yet", columns.file)));
        }
        Ok(Self {
            kind,
            columns,
            files,
        })
    }
}
