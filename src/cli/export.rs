//! `rodlab export`.

use super::prelude::*;
use rodlab_files::figure::Tempo;
use rodlab_files::results::replace_own;
use rodlab_lab::experiment::{load, prepare};
use rodlab_lab::report::{ExportFormat, ExportRequest, SceneModel, mjcf, newton, write_export};
use rodlab_lab::run::PreparedRun;
use rodlab_workcell::recording::record;

const HELP: [&str; 2] = help!(
    "\
Examples:
  rodlab export results/whip --format gltf --out whip.glb --speed 0.1    ten times slower
  rodlab export results/sweep --case friction-0.3 --format usd --out slide.usda
  rodlab export results/knot --format obj --out knot.obj --at 0.5s
  rodlab export beam.toml --format mjcf --out beam.xml
  rodlab export beam.toml --format newton --out beam.py
  rodlab export results/deploy --format mcap --out deploy.mcap",
    "\
gltf: tubes with a joint for each node, keyed at each output; y is up.
usd: curves with widths and time samples, meshes of bodies; z is up.
obj: tubes and bodies at one output; z is up.
mjcf: rods as flexes of MuJoCo 4. The command lists what the file does not contain.
newton: rods as chains of Newton 1.8, in a Python program that simulates them. With the same list.
mcap: the log of a task in a cell, or of `rodlab stream`, as messages of ROS 2, for Foxglove.
`rodlab guide exchange` describes the files."
);

/// First bytes of an MCAP file.
const MCAP: &[u8] = b"\x89MCAP0";

/// Arguments of `rodlab export`.
#[derive(Debug, Args)]
#[command(after_help = HELP[0], after_long_help = HELP[1])]
pub struct ExportArguments {
    /// A results directory, finished or still running; for mjcf and newton a scenario file, for mcap a log
    #[arg(value_name = "DIR|SCENARIO")]
    pub source: PathBuf,
    /// Format of the file
    #[arg(long, value_name = "FORMAT")]
    pub format: FormatName,
    /// Output file: .glb, .usda, .obj, .xml, .py or .mcap
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// The case of a sweep, by its id
    #[arg(long, value_name = "ID")]
    pub case: Option<String>,
    /// Time of the output for obj, such as 0.5s [default: the last output]
    #[arg(long, value_name = "TIME", value_parser = duration)]
    pub at: Option<std::time::Duration>,
    /// Simulated seconds per second of animation: 0.1 is ten times slower than life
    #[arg(long, value_name = "FACTOR", default_value = "1", value_parser = positive)]
    pub speed: f64,
    /// Export at most this many outputs, evenly spread
    #[arg(long, value_name = "N", default_value = "1000", value_parser = clap::value_parser!(u32).range(1..))]
    pub outputs: u32,
    /// Set a key of the scenario, for mjcf and newton; repeatable
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub overrides: Vec<String>,
}

/// Formats of `rodlab export`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FormatName {
    /// Binary glTF 2.0
    Gltf,
    /// USD text
    Usd,
    /// Wavefront OBJ
    Obj,
    /// Model of MuJoCo 4
    Mjcf,
    /// Python program for Newton 1.8
    Newton,
    /// Recording of a task in a cell
    Mcap,
}

impl FormatName {
    /// Its name in arguments.
    fn name(self) -> String {
        let value = self.to_possible_value();
        value.map_or_else(String::new, |value| value.get_name().to_owned())
    }

    /// Ending of its files.
    fn ending(self) -> &'static str {
        match self {
            Self::Gltf => "glb",
            Self::Usd => "usda",
            Self::Obj => "obj",
            Self::Mjcf => "xml",
            Self::Newton => "py",
            Self::Mcap => "mcap",
        }
    }
}

/// Writes a file for another program and prints its path.
pub fn export(arguments: &ExportArguments) -> Result<(), Failure> {
    let out = &arguments.out;
    let ending = arguments.format.ending();
    if out
        .extension()
        .is_none_or(|found| !found.eq_ignore_ascii_case(ending))
    {
        return Err(Failure::Input(format!(
            "--out {}: a file of this format ends in .{ending}",
            out.display()
        )));
    }
    let format = match arguments.format {
        FormatName::Mjcf => return export_scenario(arguments, mjcf, b"<!-- rodlab "),
        FormatName::Newton => return export_scenario(arguments, newton, b"# rodlab "),
        FormatName::Mcap => return export_recording(arguments),
        FormatName::Gltf => ExportFormat::Gltf,
        FormatName::Usd => ExportFormat::Usd,
        FormatName::Obj => ExportFormat::Obj(arguments.at.map(|time| time.as_secs_f64())),
    };
    if arguments.at.is_some() && arguments.format != FormatName::Obj {
        return Err(Failure::Input("--at belongs to --format obj".into()));
    }
    if !arguments.overrides.is_empty() {
        return Err(Failure::Input(
            "--set belongs to --format mjcf and newton".into(),
        ));
    }
    let request = ExportRequest {
        format,
        case: arguments.case.clone(),
        outputs: arguments.outputs as usize,
        tempo: Tempo {
            speed: arguments.speed,
        },
    };
    let written = write_export(&arguments.source, out, &request)?;
    if written.thinned {
        tracing::warn!(
            "only {} outputs were read; --outputs reads more",
            arguments.outputs
        );
    }
    let content = match written.time {
        Some(time) => format!("the output at {time} s"),
        None if written.outputs == 1 => "1 output".into(),
        None => format!("{} outputs", written.outputs),
    };
    let megabytes = written.bytes as f64 / 1e6;
    print(&format!(
        "{}\n{content}, {megabytes:.2} MB\n",
        out.display()
    ))
}

/// Writes the recording of a log.
fn export_recording(arguments: &ExportArguments) -> Result<(), Failure> {
    let ExportArguments { source, out, .. } = arguments;
    if arguments.case.is_some() || arguments.at.is_some() || !arguments.overrides.is_empty() {
        return Err(Failure::Input(
            "--case, --at and --set do not belong to --format mcap".into(),
        ));
    }
    let recording = record(source).or_input()?;
    replace_own(out, &recording.file, |bytes| bytes.starts_with(MCAP))?;
    print(&format!(
        "{}\n{} motions, {} messages, {:.1} s, {:.2} MB\n",
        out.display(),
        recording.motions,
        recording.messages,
        recording.duration,
        recording.file.len() as f64 / 1e6
    ))
}

/// Writes the model of a scenario. `head`: first bytes of its files.
fn export_scenario(
    arguments: &ExportArguments,
    model: fn(&PreparedRun) -> Result<SceneModel, Vec<String>>,
    head: &[u8],
) -> Result<(), Failure> {
    let source = &arguments.source;
    if source.is_dir() {
        return Err(Failure::Input(format!(
            "`{}` is a directory; --format {} exports a scenario file, such as its scenario.toml",
            source.display(),
            arguments.format.name()
        )));
    }
    if arguments.case.is_some() || arguments.at.is_some() {
        return Err(Failure::Input(
            "--case and --at belong to a results directory".into(),
        ));
    }
    let loaded = load(source, &arguments.overrides)?;
    let prepared = prepare(&loaded.scenario).map_err(|issues| loaded.locate(issues))?;
    let model = model(&prepared).map_err(|faults| {
        let name = source.display();
        let lines = faults.iter().map(|fault| format!("{name}: {fault}"));
        Failure::Input(lines.collect::<Vec<_>>().join("\nerror: "))
    })?;
    replace_own(&arguments.out, model.text.as_bytes(), |bytes| {
        bytes.starts_with(head)
    })?;
    let mut text = format!("{}\nnot in the file:\n", arguments.out.display());
    for line in &model.left_out {
        _ = writeln!(text, "  {line}");
    }
    print(&text)
}
