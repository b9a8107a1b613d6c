//! `rodlab score`: how far a deployed curve is from its pattern.

use super::failure::Failure;
use super::output::{print, print_json};
use crate::figure::{Format, Paper};
use crate::results::write_whole;
use crate::vision::{
    CurveError, SCORE_POINTS, Score, read_curve, score as score_curves, score_figure,
};
use clap::Args;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Arguments of `rodlab score`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct ScoreArguments {
    /// The deployed curve: centrelines.csv of a trace with a camera, nodes.csv or a results directory of a run, or any
    /// CSV with columns x_m and y_m
    pub result: PathBuf,
    /// The pattern: CSV with columns x_m and y_m
    pub pattern: PathBuf,
    /// Strand of the result, from 1 [default: the first one]
    #[arg(long, value_name = "N")]
    pub strand: Option<usize>,
    /// Number of points that are compared
    #[arg(long, value_name = "N", default_value_t = SCORE_POINTS, value_parser = point_count)]
    pub points: usize,
    /// Turn and move the result first such that it fits best
    #[arg(long)]
    pub align: bool,
    /// Where to write a figure of both curves, as .svg and .png
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Print the score as JSON
    #[arg(long)]
    pub json: bool,
}

const EXAMPLES: &str = "\
Examples:
  rodlab score traced/centrelines.csv letter.csv
  rodlab score results/deployment letter.csv --align --out score.svg

Mean and standard deviation are those of Eq. 5.11 of the thesis: points at equal distances along the pattern are
compared with those at the same part of the result's length, and with the nearest point of the result.";

fn point_count(text: &str) -> Result<usize, String> {
    let count = text
        .parse()
        .ok()
        .filter(|count| (2..=100_000).contains(count));
    count.ok_or_else(|| "expected a whole number, 2 to 100000".into())
}

#[derive(Serialize)]
struct Answer {
    points: usize,
    by_arc_length: CurveError,
    by_nearest_point: CurveError,
    pattern_length_m: f64,
    result_length_m: f64,
    reversed: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    alignment: Option<Alignment>,
}

#[derive(Serialize)]
struct Alignment {
    turn_degrees: f64,
    shift_m: [f64; 2],
}

/// Scores a curve and prints the result.
pub fn score(arguments: &ScoreArguments) -> Result<(), Failure> {
    let source = if arguments.result.is_dir() {
        arguments.result.join("nodes.csv")
    } else {
        arguments.result.clone()
    };
    let result = read_curve(&source, arguments.strand)?;
    let pattern = read_curve(&arguments.pattern, None)?;
    let found = score_curves(&result, &pattern, arguments.points, arguments.align)?;
    if let Some(out) = &arguments.out {
        write_figure(out, &found, &arguments.result, &arguments.pattern)?;
    }
    let answer = Answer {
        points: arguments.points,
        by_arc_length: found.by_arc_length,
        by_nearest_point: found.by_nearest_point,
        pattern_length_m: found.pattern_length,
        result_length_m: found.result_length,
        reversed: found.reversed,
        alignment: arguments.align.then(|| Alignment {
            turn_degrees: found.alignment.rotation.angle().to_degrees(),
            shift_m: found.alignment.translation.vector.into(),
        }),
    };
    if arguments.json {
        return print_json(&answer);
    }
    let line = |name: &str, error: &CurveError| {
        format!(
            "{name:<18} {:.3} ± {:.3} mm, largest {:.3} mm\n",
            1e3 * error.mean_m,
            1e3 * error.deviation_m,
            1e3 * error.largest_m
        )
    };
    let mut text = line("by arc length", &answer.by_arc_length);
    text += &line("by nearest point", &answer.by_nearest_point);
    text += &format!(
        "length             {:.4} m, pattern {:.4} m\n",
        answer.result_length_m, answer.pattern_length_m
    );
    if let Some(alignment) = &answer.alignment {
        text += &format!(
            "aligned by         {:.3}° and ({:.5}, {:.5}) m\n",
            alignment.turn_degrees, alignment.shift_m[0], alignment.shift_m[1]
        );
    }
    print(&text)
}

fn write_figure(out: &Path, found: &Score, result: &Path, pattern: &Path) -> Result<(), Failure> {
    let [result, pattern] = [result, pattern].map(|path| path.display().to_string());
    let svg = score_figure(found, &result, &pattern).svg(&Paper::default());
    for format in [Format::Svg, Format::Png] {
        let path = out.with_extension(format.ending());
        write_whole(&path, &format.encode(&svg))?;
    }
    Ok(())
}
