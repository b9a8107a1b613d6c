//! `rodlab evaluate`.

use super::prelude::*;
use super::samples::SampleFiles;
use rodlab_files::figure::Paper;
use rodlab_planning::learn::{
    Errors, Model, Samples, error_figure, evaluate as errors_of, read_model,
};

/// Arguments of `rodlab evaluate`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rodlab dataset deployment_dataset --set grasp_samples.points.first=1000000 --out results/others
  rodlab evaluate results/network/model.safetensors results/others --out errors.svg

Use other samples than those of the training.")]
pub struct EvaluateArguments {
    /// Network: model.safetensors of `rodlab train`
    pub model: PathBuf,
    /// Results of `rodlab dataset`
    pub samples: PathBuf,
    /// Output file for a figure of the errors, .svg
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Print the errors as JSON
    #[arg(long)]
    pub json: bool,
}

#[derive(Serialize)]
struct Answer<'a> {
    samples: usize,
    /// Number of samples outside the range of the training, which are excluded.
    out_of_range: usize,
    errors: &'a [Errors],
    provenance: &'a std::collections::BTreeMap<String, String>,
}

/// Compares a network with exact solutions.
pub fn evaluate(arguments: &EvaluateArguments) -> Result<(), Failure> {
    let files = SampleFiles::of(&arguments.samples)?;
    let model = read_model(&arguments.model, files.kind).or_input()?;
    let about = &model.about;
    if about.inputs != files.columns.inputs || about.outputs != files.columns.outputs {
        return Err(Failure::Input(format!(
            "{} predicts {} from {}; expected {} from {}",
            arguments.model.display(),
            about.outputs.join(", "),
            about.inputs.join(", "),
            files.columns.outputs.join(", "),
            files.columns.inputs.join(", ")
        )));
    }
    let samples = Samples::read_all(&files.files, &about.inputs, &about.outputs);
    let samples = samples.or_input()?;
    let covered = in_range(&model, &samples);
    if covered.rows() == 0 {
        return Err(Failure::Input(format!(
            "{}: none of {} samples is within the training range of {}",
            arguments.samples.display(),
            samples.rows(),
            arguments.model.display()
        )));
    }
    let errors = errors_of(&model, &covered, files.columns.compared).or_input()?;
    let is_finite = |errors: &Errors| errors.mean.is_finite() && errors.largest.is_finite();
    if let Some(wrong) = errors.iter().find(|errors| !is_finite(errors)) {
        return Err(Failure::Input(format!(
            "{}: its answers for `{}` are not finite; train it again",
            arguments.model.display(),
            wrong.quantity
        )));
    }
    if let Some(out) = &arguments.out {
        let figure = error_figure(&errors).svg(&Paper::default());
        write_file(out, figure.as_bytes())?;
    }
    let out_of_range = samples.rows() - covered.rows();
    if arguments.json {
        return print_json(&Answer {
            samples: covered.rows(),
            out_of_range,
            errors: &errors,
            provenance: &about.provenance,
        });
    }
    let mut text = format!(
        "{} samples, without {out_of_range} that are out of range\n",
        covered.rows()
    );
    for errors in &errors {
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{:<20} mean {:.2e}, 95 % below {:.2e}, largest {:.2e} at {:.4?}",
            errors.quantity, errors.mean, errors.percentile_95, errors.largest, errors.largest_at
        );
    }
    print(&text)
}

fn in_range(model: &Model, samples: &Samples) -> Samples {
    let is_covered = |row: &usize| model.covers(samples.input(*row));
    samples.chosen(&(0..samples.rows()).filter(is_covered).collect::<Vec<_>>())
}
