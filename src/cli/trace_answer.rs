//! The answer of `rodlab trace`.

use super::prelude::*;
use image::RgbImage;
use rodlab_vision::{Camera, Passage, Point, Trace, VisionError};

/// Strands found in an image.
#[derive(Serialize)]
pub struct Answer {
    image: PathBuf,
    /// Time from the first picture of a recording, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_s: Option<f64>,
    width: u32,
    height: u32,
    strands: Vec<StrandAnswer>,
    crossings: Vec<CrossingAnswer>,
    /// Parts of the mask that are not lines, and strands that were left out.
    rejected: Vec<RejectedAnswer>,
    /// Signs that the result is wrong, each with a remedy.
    doubts: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    mean_instance_dice: Option<f64>,
}

#[derive(Serialize)]
struct StrandAnswer {
    strand: usize,
    points: usize,
    closed: bool,
    length_px: f64,
    width_px: f64,
    start_px: [f64; 2],
    end_px: [f64; 2],
    #[serde(skip_serializing_if = "Option::is_none")]
    length_m: Option<f64>,
}

#[derive(Serialize)]
struct CrossingAnswer {
    u_px: f64,
    v_px: f64,
    over: PassageAnswer,
    under: PassageAnswer,
    angle_degrees: f64,
    confidence: f64,
}

#[derive(Serialize)]
struct PassageAnswer {
    strand: usize,
    point: f64,
}

#[derive(Serialize)]
struct RejectedAnswer {
    u_px: f64,
    v_px: f64,
    length_px: f64,
    width_px: f64,
}

/// Results of a trace; lengths in metres if there is a camera.
pub fn answer(
    path: &Path,
    picture: &RgbImage,
    traced: &Trace,
    camera: Option<&Camera>,
    mean_instance_dice: Option<f64>,
) -> Result<Answer, VisionError> {
    let rounded = |value: f64| (value * 1000.0).round() / 1000.0;
    let pixel = |point: &Point| [rounded(point.x), rounded(point.y)];
    let mut strands = Vec::new();
    for (number, strand) in traced.strands.iter().enumerate() {
        let on_table = camera.map(|camera| {
            let points = strand.points.iter().map(|point| camera.on_table(*point));
            points.collect::<Result<Vec<Point>, VisionError>>()
        });
        let length =
            |points: Vec<Point>| points.windows(2).map(|two| (two[1] - two[0]).norm()).sum();
        let length_m = on_table.transpose()?.map(length);
        let last = strand.points.len() - 1;
        strands.push(StrandAnswer {
            strand: number + 1,
            points: strand.points.len(),
            closed: strand.closed,
            length_px: rounded(strand.length()),
            width_px: rounded(strand.width()),
            start_px: pixel(&strand.points[0]),
            end_px: pixel(&strand.points[last]),
            length_m,
        });
    }
    let passage = |passage: Passage| PassageAnswer {
        strand: passage.strand + 1,
        point: rounded(passage.at),
    };
    let crossings = traced.crossings.iter().map(|crossing| CrossingAnswer {
        u_px: rounded(crossing.position.x),
        v_px: rounded(crossing.position.y),
        over: passage(crossing.over),
        under: passage(crossing.under),
        angle_degrees: rounded(crossing.angle_degrees),
        confidence: rounded(crossing.confidence),
    });
    let rejected = traced.rejected.iter();
    let rejected = rejected.map(|(point, length, width)| RejectedAnswer {
        u_px: rounded(point.x),
        v_px: rounded(point.y),
        length_px: rounded(*length),
        width_px: rounded(*width),
    });
    Ok(Answer {
        image: path.into(),
        time_s: None,
        width: picture.width(),
        height: picture.height(),
        strands,
        crossings: crossings.collect(),
        rejected: rejected.collect(),
        doubts: traced.doubts.iter().map(ToString::to_string).collect(),
        mean_instance_dice,
    })
}

/// Largest number of parts left out that are listed in the text.
const MOST_PARTS: usize = 8;

/// The answer as text.
pub fn summary(answer: &Answer) -> String {
    let mut text = format!(
        "{}: {}, {}\n",
        answer.image.display(),
        counted(answer.strands.len(), "strand"),
        counted(answer.crossings.len(), "crossing")
    );
    for strand in &answer.strands {
        let _ = write!(
            text,
            "  strand {}: {:.1} px long, {:.1} px wide",
            strand.strand, strand.length_px, strand.width_px
        );
        if let Some(length) = strand.length_m {
            let _ = write!(text, ", {length:.4} m long");
        }
        let _ = if strand.closed {
            writeln!(text, ", closed")
        } else {
            let ([u0, v0], [u1, v1]) = (strand.start_px, strand.end_px);
            writeln!(text, ", from ({u0:.1}, {v0:.1}) to ({u1:.1}, {v1:.1})")
        };
    }
    for part in answer.rejected.iter().take(MOST_PARTS) {
        let _ = writeln!(
            text,
            "  left out: a part {:.0} px long and {:.0} px wide at ({:.0}, {:.0})",
            part.length_px, part.width_px, part.u_px, part.v_px
        );
    }
    if let Some(more @ 1..) = answer.rejected.len().checked_sub(MOST_PARTS) {
        let _ = writeln!(text, "  left out: {}", counted(more, "more part"));
    }
    for doubt in &answer.doubts {
        let _ = writeln!(text, "  doubtful: {doubt}");
    }
    if let Some(dice) = answer.mean_instance_dice {
        let _ = writeln!(text, "  mean instance Dice {dice:.4}");
    }
    text
}

/// A number with its noun, in singular or plural.
pub fn counted(count: usize, thing: &str) -> String {
    format!("{count} {thing}{}", if count == 1 { "" } else { "s" })
}
