//! `rodlab score`: the distance of a deployed curve from its pattern.

use super::drawn_pattern::{Part, drawn_points};
use super::exit_code::NOT_SEEN_WHOLE;
use super::middle_line::Filled;
use super::prelude::*;
use rodlab_files::figure::{Format, Paper};
use rodlab_lab::scenario::read_text_file;
use rodlab_planning::plan::pattern::{Drawing, StrokeChoice};
use rodlab_vision::{
    CurveError, Point, SCORE_POINTS, Score, SeenLength, part_of_curve, read_curve,
    score as score_curves, score_figure,
};

/// Arguments of `rodlab score`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct ScoreArguments {
    /// Deployed curve: CSV with columns x_m and y_m, or a results directory of a run
    ///
    /// For example centrelines.csv of a trace with a camera, or nodes.csv of a run.
    pub result: PathBuf,
    /// Pattern: an SVG drawing, or CSV with columns x_m and y_m
    #[arg(value_parser = file_or_preset(PresetKind::Pattern), add = presets(PresetKind::Pattern))]
    pub pattern: PathBuf,
    /// Strand of the result, from 1 [default: the first one]
    #[arg(long, value_name = "N")]
    pub strand: Option<usize>,
    /// Stroke of an SVG pattern: number from 1, id, or `longest`; or number of a strand of a CSV pattern
    #[arg(long, value_name = "N|ID|longest")]
    pub stroke: Option<StrokeChoice>,
    /// Join strokes of an SVG pattern whose ends are at most this far apart
    #[arg(long, value_name = "GAP", value_parser = length_from_zero)]
    pub join: Option<f64>,
    /// Length of the longer side of the pattern [default: as drawn]
    #[arg(long, value_name = "LENGTH", value_parser = positive_length)]
    pub size: Option<f64>,
    /// Arc length of the result at which the pattern begins
    ///
    /// The part beyond the length of the pattern is left out, too. The default is the lead-in of the scenario for results of a
    /// deployment; otherwise the whole result is compared.
    #[arg(long, value_name = "LENGTH", value_parser = length_from_zero)]
    pub begin: Option<f64>,
    /// Length of the rod; a result whose length differs by more than 3 % is not scored (exit code 4)
    #[arg(long, value_name = "LENGTH", value_parser = positive_length)]
    pub rod_length: Option<f64>,
    /// Number of points to compare
    #[arg(long, value_name = "N", default_value_t = SCORE_POINTS, value_parser = point_count)]
    pub points: usize,
    /// Turn and move the result to the best fit first
    #[arg(long)]
    pub align: bool,
    /// Output file for a figure of both curves, .svg and .png
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Print the score as JSON
    #[arg(long)]
    pub json: bool,
}

const EXAMPLES: &str = "\
Examples:
  rodlab score traced/centrelines.csv letter.csv
  rodlab score traced/centrelines.csv scenarios/patterns/U.svg --align --out score.svg
  rodlab score results/letter/landing letter.csv

Mean and standard deviation are those of Eq. 5.11 of the thesis. Points at equal distances along the
pattern are compared with the points of the result at the same fraction of its length, and with its
nearest points.";

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
    /// Arc length of the result at which the compared part begins.
    #[serde(skip_serializing_if = "Option::is_none")]
    begin_m: Option<f64>,
    /// Length of the result, and length of the rod.
    #[serde(skip_serializing_if = "Option::is_none")]
    seen_length: Option<SeenLength>,
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
    let whole = read_curve(&source, arguments.strand)?;
    let pattern = arguments.pattern_points()?;
    let seen_length = (arguments.rod_length).map(|length| SeenLength::of(&whole, length));
    if let Some(length) = seen_length.filter(|length| !length.is_whole()) {
        return Err(Failure::Other {
            exit_code: NOT_SEEN_WHOLE,
            message: format!("{}: not seen whole: {length}", arguments.result.display()),
        });
    }
    let begin = match arguments.begin {
        Some(begin) => Some(begin),
        None => lead_in_of(&arguments.result)?,
    };
    let result = match begin {
        Some(begin) => part_of_curve(&whole, begin, &pattern)?,
        None => whole,
    };
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
        begin_m: begin,
        seen_length,
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
    if let Some(begin) = answer.begin_m {
        text += &format!("begins at          {begin:.4} m of the result\n");
    }
    if let Some(alignment) = &answer.alignment {
        text += &format!(
            "aligned by         {:.3}° and ({:.5}, {:.5}) m\n",
            alignment.turn_degrees, alignment.shift_m[0], alignment.shift_m[1]
        );
    }
    print(&text)
}

impl ScoreArguments {
    fn pattern_points(&self) -> Result<Vec<Point>, Failure> {
        let file = self.pattern.display();
        let part = Part {
            stroke: self.stroke.as_ref(),
            join: self.join,
            filled: Filled {
                size: self.size,
                ..Filled::default()
            },
        };
        let points = drawn_points(&self.pattern, part)?;
        let points = points.ok_or("expected an .svg or a .csv file").at(&file)?;
        let drawing = Drawing {
            size: self.size,
            reverse: false,
        };
        drawing.of(points).at(&file)
    }
}

/// The lead-in of the results of a deployment, m, which precedes the pattern. The gripper still
/// holds the other end of the rod, beyond the pattern. `None` for other results.
fn lead_in_of(results: &Path) -> Result<Option<f64>, Failure> {
    let path = results.join("scenario.toml");
    if !path.is_file() {
        return Ok(None);
    }
    let file = path.display();
    let text = String::from_utf8(read_text_file(&path).or_input()?);
    let text = text.map_err(|_| "not text in UTF-8").at(&file)?;
    let scenario = text.parse::<toml::Table>();
    let scenario = scenario.map_err(|_| "not a TOML file").at(&file)?;
    let kind = scenario.get("experiment").and_then(toml::Value::as_str);
    if kind != Some("deployment") {
        return Ok(None);
    }
    let deployment = scenario.get("deployment");
    let lead_in = deployment.and_then(|deployment| deployment.get("lead_in")?.as_float());
    let lead_in = lead_in.filter(|length| *length >= 0.0 && length.is_finite());
    let advice =
        "deployment.lead_in is not a length; give --begin, where on the rod the pattern begins";
    lead_in.map(Some).ok_or(advice).at(&file)
}

fn write_figure(out: &Path, found: &Score, result: &Path, pattern: &Path) -> Result<(), Failure> {
    let [result, pattern] = [result, pattern].map(|path| path.display().to_string());
    let svg = score_figure(found, &result, &pattern).svg(&Paper::default());
    for format in [Format::Svg, Format::Png] {
        let path = out.with_extension(format.ending());
        write_file(&path, &format.encode(&svg))?;
    }
    Ok(())
}
