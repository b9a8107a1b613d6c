//! Resources requested from Slurm.

/// Resources requested from Slurm for each task of a job array; the cluster's defaults apply to the rest.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Request {
    /// Name of the job.
    pub name: String,
    /// `--partition`.
    pub partition: Option<String>,
    /// `--time`, in the words of Slurm, such as `8:00:00`.
    pub time: Option<String>,
    /// `--mem`, such as `2G`.
    pub memory: Option<String>,
    /// `--cpus-per-task`.
    pub cores: u16,
    /// `--account`.
    pub account: Option<String>,
    /// Tasks that run at a time.
    pub array_limit: Option<u32>,
    /// Further options of `sbatch`, one per line, such as `--constraint=avx2`.
    pub extra: Vec<String>,
    /// Lines of shell before the program starts, such as `module load gcc`.
    pub prologue: Vec<String>,
    /// Words in front of the program, such as `apptainer exec rodlab.sif`.
    pub wrapper: Option<String>,
}

impl Request {
    /// The options in the order in which the script has them.
    pub(super) fn options(&self) -> Vec<String> {
        let mut options = vec![
            format!("--job-name={}", one_word(&self.name)),
            format!("--cpus-per-task={}", self.cores),
        ];
        for (option, value) in [
            ("partition", &self.partition),
            ("time", &self.time),
            ("mem", &self.memory),
            ("account", &self.account),
        ] {
            options.extend(value.as_ref().map(|value| format!("--{option}={value}")));
        }
        options.extend(self.extra.iter().cloned());
        options
    }

    /// Values of options that must be one word each, with their names.
    pub(super) fn words(&self) -> Vec<(&'static str, &str)> {
        let values = [
            ("partition", self.partition.as_ref()),
            ("time", self.time.as_ref()),
            ("memory", self.memory.as_ref()),
            ("account", self.account.as_ref()),
        ];
        let given = values.into_iter();
        given
            .filter_map(|(what, value)| Some((what, &value?[..])))
            .collect()
    }

    /// Parts of the script that come from the user, with their names: each must be a single line.
    pub(super) fn lines(&self) -> Vec<(&'static str, &str)> {
        let options = [
            ("name of the job", Some(&self.name)),
            ("partition", self.partition.as_ref()),
            ("time", self.time.as_ref()),
            ("memory", self.memory.as_ref()),
            ("account", self.account.as_ref()),
            ("wrapper", self.wrapper.as_ref()),
        ];
        let given = options
            .into_iter()
            .filter_map(|(what, value)| Some((what, &value?[..])));
        let extra = self
            .extra
            .iter()
            .map(|option| ("extra option", &option[..]));
        let prologue = self.prologue.iter().map(|line| ("prologue", &line[..]));
        given.chain(extra).chain(prologue).collect()
    }
}

/// A name as one word of an option. Characters that Slurm could read as the end of the word become
/// `_`.
fn one_word(name: &str) -> String {
    let is_plain = |character: char| character.is_alphanumeric() || "._-+=@:".contains(character);
    let word: String = name
        .chars()
        .map(|character| if is_plain(character) { character } else { '_' })
        .collect();
    word
}
