//! The batch script of a job array.

use super::jobs::LOGS;
use super::{ClusterError, Request};
use std::path::{Path, PathBuf};

/// Seconds before its time limit at which Slurm signals a task, so that it writes its checkpoints.
const WARNING_SECONDS: u32 = 60;
/// Number of times that a task requeues itself. A task requeues itself only after progress, or
/// after it was killed. The limit ends a task that is killed at once each time.
const MOST_RESTARTS: u32 = 100;

/// The program that the tasks run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Program {
    /// The executable.
    pub executable: PathBuf,
    /// The results directory, absolute.
    pub directory: PathBuf,
    /// The scenario in it.
    pub scenario: PathBuf,
    /// Number of tasks, equal to the number of shares.
    pub tasks: usize,
}

/// The script that runs the given tasks (counted from 1).
///
/// Task K runs the K-th share of the cases. A task that receives the signal before its time limit
/// writes checkpoints and puts itself into the queue again; so does a task whose program was
/// killed. A cancelled task writes checkpoints, if Slurm leaves it the time, and is not queued
/// again.
///
/// # Errors
/// [`ClusterError::NotOneLine`] if a name or an option would break a line of the script,
/// [`ClusterError::NotOneWord`] if the value of an option would end early.
pub fn script(
    program: &Program,
    request: &Request,
    tasks: &[usize],
) -> Result<String, ClusterError> {
    refuse_breaks(program, request)?;
    let logs = program.directory.join(LOGS);
    let limit = request
        .array_limit
        .map_or(String::new(), |limit| format!("%{limit}"));
    let mut options = request.options();
    options.extend([
        format!("--array={}{limit}", ranges(tasks)),
        format!("--output={}", log_pattern(&logs)),
        "--open-mode=append".to_owned(),
        "--requeue".to_owned(),
        format!("--signal=B:USR1@{WARNING_SECONDS}"),
    ]);
    let options: String = options
        .iter()
        .map(|option| format!("#SBATCH {option}\n"))
        .collect();
    let prologue: String = request
        .prologue
        .iter()
        .map(|line| format!("{line}\n"))
        .collect();
    let wrapper = request
        .wrapper
        .as_ref()
        .map_or(String::new(), |words| format!("{words} "));
    Ok(format!(
        r#"#!/bin/bash
# Written by `rodlab submit`: each task runs its share of the cases, and resumes where it stopped.
{options}
{prologue}
{wrapper}{executable} run {scenario} --out {directory} \
    --shard "$SLURM_ARRAY_TASK_ID/{tasks}" --jobs {cores} --threads {cores} &
program=$!

# Signals reach this script. A wait that a signal interrupts must be repeated.
signalled=yes
cancelled=
trap 'signalled=yes; kill -USR1 $program' USR1
trap 'signalled=yes; cancelled=yes; kill -USR1 $program' TERM INT
while [ -n "$signalled" ]; do
    signalled=
    wait $program
    code=$?
done

# 5: out of time, with checkpoints; 137: killed.
if [ -z "$cancelled" ] && {{ [ $code = 5 ] || [ $code = 137 ]; }} \
    && [ "${{SLURM_RESTART_COUNT:-0}}" -lt {MOST_RESTARTS} ]; then
    scontrol requeue "${{SLURM_ARRAY_JOB_ID}}_${{SLURM_ARRAY_TASK_ID}}"
fi
exit $code
"#,
        executable = quoted(&program.executable),
        scenario = quoted(&program.scenario),
        directory = quoted(&program.directory),
        tasks = program.tasks,
        cores = request.cores,
    ))
}

/// Rejects text that would add lines to the script: line breaks, and quotes in paths of `#SBATCH`
/// lines.
fn refuse_breaks(program: &Program, request: &Request) -> Result<(), ClusterError> {
    let directory = program.directory.display().to_string();
    let paths = [
        (
            "name of the program",
            program.executable.display().to_string(),
        ),
        ("results directory", directory.clone()),
        ("scenario", program.scenario.display().to_string()),
    ];
    let lines = request.lines();
    let lines = lines.iter().map(|(what, line)| (*what, (*line).to_owned()));
    let broken = |text: &str| text.contains(|character: char| character.is_control());
    let found = paths
        .into_iter()
        .chain(lines)
        .find(|(_, text)| broken(text));
    let found = found.or_else(|| {
        let quoted = directory.contains(['"', '\\']);
        quoted.then_some(("results directory", directory))
    });
    if let Some((what, text)) = found {
        return Err(ClusterError::NotOneLine { what, text });
    }
    let is_word = |text: &str| !text.contains([' ', '"', '\'', '\\', '#']);
    match request.words().into_iter().find(|(_, text)| !is_word(text)) {
        Some((what, text)) => Err(ClusterError::NotOneWord {
            what,
            text: text.to_owned(),
        }),
        None => Ok(()),
    }
}

/// A path with the numbers of job and task, as Slurm reads it. The path is quoted since it may
/// contain blanks; each percent sign is doubled.
fn log_pattern(folder: &Path) -> String {
    let folder = folder.display().to_string();
    format!("\"{}/%A_%a.log\"", folder.replace('%', "%%"))
}

/// A path as one word of the shell.
fn quoted(path: &Path) -> String {
    format!("'{}'", path.display().to_string().replace('\'', r"'\''"))
}

/// Ascending numbers as Slurm writes them: `1-3,7`.
fn ranges(tasks: &[usize]) -> String {
    let mut parts: Vec<[usize; 2]> = Vec::new();
    for task in tasks {
        match parts.last_mut() {
            Some([_, last]) if *last + 1 == *task => *last = *task,
            _ => parts.push([*task, *task]),
        }
    }
    let text = |[first, last]: &[usize; 2]| {
        if first == last {
            first.to_string()
        } else {
            format!("{first}-{last}")
        }
    };
    parts.iter().map(text).collect::<Vec<_>>().join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_values_add_no_options() {
        let program = Program {
            executable: "/opt/rodlab".into(),
            directory: "/data/a --exclusive".into(),
            scenario: "/data/a --exclusive/scenario.toml".into(),
            tasks: 1,
        };
        let mut request = Request {
            name: "a --exclusive --mail-user=evil@x \"b\" #c".into(),
            cores: 1,
            ..Request::default()
        };
        let text = script(&program, &request, &[1]).unwrap();
        assert!(
            text.contains("#SBATCH --job-name=a_--exclusive_--mail-user=evil@x__b___c\n"),
            "{text}"
        );
        for value in ["short --exclusive", "a\"b", "a#b"] {
            request.partition = Some(value.into());
            let error = script(&program, &request, &[1]).unwrap_err().to_string();
            assert!(error.contains("partition"), "{error}");
        }
    }

    #[test]
    fn numbers_are_joined_to_ranges() {
        assert_eq!(ranges(&[1, 2, 3, 7, 9, 10]), "1-3,7,9-10");
        assert_eq!(ranges(&[4]), "4");
    }

    #[test]
    fn the_script_asks_for_what_was_requested() {
        let program = Program {
            executable: "/opt/rod's/rodlab".into(),
            directory: "/data/swings".into(),
            scenario: "/data/swings/scenario.toml".into(),
            tasks: 8,
        };
        let request = Request {
            name: "swings".into(),
            partition: Some("short".into()),
            time: Some("1:00:00".into()),
            memory: Some("2G".into()),
            cores: 4,
            account: None,
            array_limit: Some(3),
            extra: vec!["--constraint=avx2".into()],
            prologue: vec!["module load gcc".into()],
            wrapper: Some("apptainer exec rods.sif".into()),
        };
        let script = script(&program, &request, &[1, 2, 5]).unwrap();
        let head = script.split("# Signals").next().unwrap();
        insta::assert_snapshot!(head, @r#"
        #!/bin/bash
        # Written by `rodlab submit`: each task runs its share of the cases, and resumes where it stopped.
        #SBATCH --job-name=swings
        #SBATCH --cpus-per-task=4
        #SBATCH --partition=short
        #SBATCH --time=1:00:00
        #SBATCH --mem=2G
        #SBATCH --constraint=avx2
        #SBATCH --array=1-2,5%3
        #SBATCH --output="/data/swings/slurm/%A_%a.log"
        #SBATCH --open-mode=append
        #SBATCH --requeue
        #SBATCH --signal=B:USR1@60

        module load gcc

        apptainer exec rods.sif '/opt/rod'\''s/rodlab' run '/data/swings/scenario.toml' --out '/data/swings' \
            --shard "$SLURM_ARRAY_TASK_ID/8" --jobs 4 --threads 4 &
        program=$!
        "#);
    }

    #[test]
    fn a_line_break_in_a_name_is_refused_and_does_not_become_a_line_of_the_script() {
        let program = |directory: &str| Program {
            executable: "rodlab".into(),
            directory: directory.into(),
            scenario: "/data/scenario.toml".into(),
            tasks: 1,
        };
        let refused = |directory: &str, request: &Request| {
            script(&program(directory), request, &[1])
                .unwrap_err()
                .to_string()
        };
        let plain = Request::default();
        insta::assert_snapshot!(refused("/data/a\nrm -rf b", &plain), @r#"the results directory "/data/a\nrm -rf b" is not allowed in a batch script; leave out line breaks, other control characters and, in the name of the results directory, quotes and backslashes"#);
        insta::assert_snapshot!(refused("/data/a\"b", &plain), @r#"the results directory "/data/a\"b" is not allowed in a batch script; leave out line breaks, other control characters and, in the name of the results directory, quotes and backslashes"#);
        let named = Request {
            name: "a\n#SBATCH --exclusive".into(),
            ..Request::default()
        };
        insta::assert_snapshot!(refused("/data", &named), @r#"the name of the job "a\n#SBATCH --exclusive" is not allowed in a batch script; leave out line breaks, other control characters and, in the name of the results directory, quotes and backslashes"#);
        let text = script(&program("/data/a b/50%"), &plain, &[1]).unwrap();
        assert!(text.contains("#SBATCH --output=\"/data/a b/50%%/slurm/%A_%a.log\"\n"));
    }

    #[test]
    #[cfg(unix)]
    fn the_shell_understands_the_script() {
        let program = Program {
            executable: "rodlab".into(),
            directory: "/data/a b".into(),
            scenario: "/data/a b/scenario.toml".into(),
            tasks: 1,
        };
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("script");
        let script = script(&program, &Request::default(), &[1]).unwrap();
        std::fs::write(&path, script).unwrap();
        let checked = std::process::Command::new("bash")
            .arg("-n")
            .arg(path)
            .status();
        assert!(checked.unwrap().success());
    }
}
