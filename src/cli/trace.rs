//! `rodlab trace`: from images to centrelines.

use super::failure::Failure;
use super::output::{print, print_json};
use super::values::positive_length;
use crate::results::write_whole;
use crate::robot::{CameraPicture, DriverError, Ros1Camera};
use crate::vision::{
    Camera, ColourRule, Contrast, Metric, Point, Trace, TraceOptions, VisionError, centrelines_csv,
    centrelines_svg, clean_mask, decode_picture, encode_labels, encode_picture, instance_dice,
    mask_overlay, overlay, pattern, pattern_csv, pictures_in, read_labels, read_picture,
    trace_contrast,
};
use clap::Args;
use image::{GrayImage, RgbImage};
use serde::Serialize;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Arguments of `rodlab trace`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct TraceArguments {
    /// A PNG or JPEG image, a folder of them, taken in order of their names, or a camera of ROS 1: the next picture of
    /// ros1://host:port/topic
    pub image: PathBuf,
    /// Which colours are rod: auto, pen, black, white, a hue (red, orange, yellow, green, cyan, blue, purple, pink),
    /// #rrggbb[:radius], pick:u,v[:radius] or hsv:h-h,s-s,v-v
    // No alias "color": that is an option of all subcommands.
    #[arg(
        long,
        value_name = "RULE",
        default_value = "auto",
        conflicts_with = "mask"
    )]
    pub colour: String,
    /// An image of the same size whose pixels are rod where they are not black
    #[arg(long, value_name = "FILE")]
    pub mask: Option<PathBuf>,
    /// File whose table [camera] gives coordinates in metres
    #[arg(long, value_name = "FILE")]
    pub cell: Option<PathBuf>,
    /// Parts with fewer pixels are noise
    #[arg(long, value_name = "PIXELS", default_value_t = 60)]
    pub least_area: usize,
    /// Where to write a strand as a pattern file, CSV with columns x_m and y_m; needs --cell or --pixel
    #[arg(long, value_name = "FILE")]
    pub pattern: Option<PathBuf>,
    /// The strand that becomes the pattern, from 1 [default: the longest one]
    #[arg(long, value_name = "N", requires = "pattern")]
    pub strand: Option<usize>,
    /// Waves of the pattern shorter than about six times this are smoothed away
    #[arg(long, value_name = "LENGTH", default_value = "2 mm", value_parser = positive_length)]
    pub smoothing: f64,
    /// Side of a pixel of a scan, for --pattern without a camera
    #[arg(long, value_name = "LENGTH", value_parser = positive_length, conflicts_with = "cell")]
    pub pixel: Option<f64>,
    /// True label image (8 bit, pixel = strand) to compare with
    #[arg(long, value_name = "FILE")]
    pub truth: Option<PathBuf>,
    /// Directory for centrelines.csv, centrelines.svg, labels.png and overlay.png; one in it for each image of a folder
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print what was found as JSON
    #[arg(long)]
    pub json: bool,
}

const EXAMPLES: &str = "\
Examples:
  rodlab trace photo.jpg --out traced                 rods on a plain background
  rodlab trace letter.png --colour pen --out traced   pen on paper
  rodlab trace letter.png --colour pen --pixel \"0.2 mm\" --pattern letter.csv
  rodlab trace photo.jpg --colour red --json
  rodlab trace photo.jpg --colour pick:320,240 --cell cell.toml --out traced
  rodlab trace ros1://192.168.1.5:11311/camera/image_raw --cell cell.toml --out traced

Pixels count from the centre of the first one, u to the right and v down. Strands count from 1, points from 0.";

/// Longest wait for a picture of a camera.
const CAMERA_PATIENCE: Duration = Duration::from_secs(5);

/// What was found in an image.
#[derive(Serialize)]
struct Answer {
    image: PathBuf,
    width: u32,
    height: u32,
    strands: Vec<StrandAnswer>,
    crossings: Vec<CrossingAnswer>,
    /// Parts of the mask that are no lines.
    rejected: Vec<RejectedAnswer>,
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

/// Traces one image, or all of a folder.
pub fn trace(arguments: &TraceArguments) -> Result<(), Failure> {
    let options = TraceOptions {
        colour: ColourRule::parse(&arguments.colour)?,
        least_area: arguments.least_area,
        ..TraceOptions::default()
    };
    let camera = arguments.cell.as_deref().map(Camera::read).transpose()?;
    if !arguments.image.is_dir() {
        let answer = trace_image(
            arguments,
            &arguments.image,
            &options,
            camera.as_ref(),
            arguments.out.as_deref(),
        )?;
        return if arguments.json {
            print_json(&answer)
        } else {
            print(&summary(&answer))
        };
    }
    if arguments.truth.is_some() || arguments.mask.is_some() || arguments.pattern.is_some() {
        return Err(Failure::Input(
            "--truth, --mask and --pattern belong to one image, not to a folder".into(),
        ));
    }
    let mut answers = Vec::new();
    let mut faults = Vec::new();
    for image in pictures_in(&arguments.image)? {
        let name = image.file_name().unwrap_or_default();
        let out = arguments.out.as_ref().map(|out| out.join(name));
        match trace_image(arguments, &image, &options, camera.as_ref(), out.as_deref()) {
            Ok(answer) if arguments.json => answers.push(answer),
            Ok(answer) => print(&summary(&answer))?,
            Err(Failure::Input(message)) => faults.push(message),
            Err(other) => return Err(other),
        }
    }
    if arguments.json {
        print_json(&answers)?;
    }
    if faults.is_empty() {
        return Ok(());
    }
    Err(Failure::Input(faults.join("\nerror: ")))
}

/// The picture in a file, or the next one of a camera.
fn picture(path: &Path) -> Result<RgbImage, Failure> {
    let Some(place) = path.to_str().and_then(|text| text.strip_prefix("ros1://")) else {
        return Ok(read_picture(path)?);
    };
    let (master, topic) = place
        .split_once('/')
        .filter(|(master, topic)| master.contains(':') && !topic.is_empty())
        .ok_or_else(|| {
            let shape =
                "ros1://host:port/topic is needed, as in ros1://192.168.1.5:11311/camera/image_raw";
            Failure::Input(format!("{}: {shape}", path.display()))
        })?;
    let of_camera = |error: DriverError| Failure::System(error.to_string());
    let mut camera =
        Ros1Camera::open(&format!("http://{master}"), &format!("/{topic}")).map_err(of_camera)?;
    match camera.picture(CAMERA_PATIENCE).map_err(of_camera)? {
        CameraPicture::Pixels(picture) => Ok(picture),
        CameraPicture::File(bytes) => decode_picture(&bytes)
            .map_err(|reason| Failure::System(format!("{}: {reason}", path.display()))),
    }
}

fn trace_image(
    arguments: &TraceArguments,
    path: &Path,
    options: &TraceOptions,
    camera: Option<&Camera>,
    out: Option<&Path>,
) -> Result<Answer, Failure> {
    let in_file = |error: VisionError| Failure::Input(format!("{}: {error}", path.display()));
    let picture = picture(path)?;
    if let Some(camera) = camera {
        camera
            .check_size(picture.width(), picture.height())
            .map_err(in_file)?;
    }
    let contrast = match &arguments.mask {
        Some(mask) => Contrast::of_mask(&mask_of(mask, &picture)?),
        None => Contrast::new(&picture, &options.colour).map_err(in_file)?,
    };
    let traced = match trace_contrast(&picture, &contrast, options) {
        Ok(traced) => traced,
        Err(error) => {
            if let Some(out) = out {
                let mask = clean_mask(&contrast, options);
                let shown = encode_picture(&mask_overlay(&picture, &mask));
                write_files(out, vec![("overlay.png", shown)])?;
            }
            return Err(in_file(error));
        }
    };
    let mean_instance_dice = match &arguments.truth {
        Some(truth) => {
            let truth = read_labels(truth)?;
            Some(instance_dice(&traced.labels, &truth).map_err(in_file)?.mean)
        }
        None => None,
    };
    let answer = answer(path, &picture, &traced, camera, mean_instance_dice).map_err(in_file)?;
    let csv = centrelines_csv(&traced.strands, camera).map_err(in_file)?;
    if let Some(pattern) = &arguments.pattern {
        write_pattern(arguments, pattern, &traced, camera, picture.height())?;
    }
    if let Some(out) = out {
        let svg = centrelines_svg(picture.width(), picture.height(), &traced.strands);
        write_files(
            out,
            vec![
                ("centrelines.csv", csv.into_bytes()),
                ("centrelines.svg", svg.into_bytes()),
                ("labels.png", encode_labels(&traced.labels)),
                ("overlay.png", encode_picture(&overlay(&picture, &traced))),
            ],
        )?;
    }
    Ok(answer)
}

/// Distance of a pattern's points, metres.
const PATTERN_STEP: f64 = 1e-3;

fn write_pattern(
    arguments: &TraceArguments,
    path: &Path,
    traced: &Trace,
    camera: Option<&Camera>,
    height: u32,
) -> Result<(), Failure> {
    let metric = match (camera, arguments.pixel) {
        (Some(camera), _) => Metric::Camera(camera),
        (None, Some(pixel)) => Metric::Scan { pixel, height },
        (None, None) => {
            return Err(Failure::Input(
                "--pattern is in metres: give a camera by --cell, or the side of a pixel by --pixel".into(),
            ));
        }
    };
    let count = traced.strands.len();
    let strand = match arguments.strand {
        Some(number) => number
            .checked_sub(1)
            .and_then(|index| traced.strands.get(index)),
        None => traced
            .strands
            .iter()
            .max_by(|a, b| a.length().total_cmp(&b.length())),
    };
    let strand = strand.ok_or_else(|| {
        Failure::Input(format!(
            "--strand: there are {}, counted from 1",
            counted(count, "strand")
        ))
    })?;
    let points = pattern(strand, metric, arguments.smoothing, PATTERN_STEP)?;
    write_whole(path, pattern_csv(&points).as_bytes())?;
    Ok(())
}

fn mask_of(path: &Path, picture: &RgbImage) -> Result<GrayImage, VisionError> {
    let mask = read_picture(path)?;
    if mask.dimensions() != picture.dimensions() {
        return Err(VisionError::Size {
            what: format!("the mask {}", path.display()),
            found_width: mask.width() as usize,
            found_height: mask.height() as usize,
            width: picture.width() as usize,
            height: picture.height() as usize,
        });
    }
    let brightest = |pixel: &image::Rgb<u8>| pixel.0.into_iter().max().unwrap_or(0);
    Ok(GrayImage::from_fn(mask.width(), mask.height(), |u, v| {
        image::Luma([brightest(mask.get_pixel(u, v))])
    }))
}

fn write_files(directory: &Path, files: Vec<(&str, Vec<u8>)>) -> Result<(), Failure> {
    fs::create_dir_all(directory).map_err(|error| {
        Failure::System(format!("{}: cannot be made: {error}", directory.display()))
    })?;
    for (name, bytes) in files {
        write_whole(&directory.join(name), &bytes)?;
    }
    Ok(())
}

fn answer(
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
        let length_m = match camera {
            Some(camera) => {
                let located: Result<Vec<Point>, VisionError> = strand
                    .points
                    .iter()
                    .map(|point| camera.on_table(*point))
                    .collect();
                let steps = located?;
                Some(
                    steps
                        .windows(2)
                        .map(|pair| (pair[1] - pair[0]).norm())
                        .sum(),
                )
            }
            None => None,
        };
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
    let passage = |passage: crate::vision::Passage| PassageAnswer {
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
    let rejected = traced
        .rejected
        .iter()
        .map(|(point, length, width)| RejectedAnswer {
            u_px: rounded(point.x),
            v_px: rounded(point.y),
            length_px: rounded(*length),
            width_px: rounded(*width),
        });
    Ok(Answer {
        image: path.into(),
        width: picture.width(),
        height: picture.height(),
        strands,
        crossings: crossings.collect(),
        rejected: rejected.collect(),
        mean_instance_dice,
    })
}

fn summary(answer: &Answer) -> String {
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
    for part in &answer.rejected {
        let _ = writeln!(
            text,
            "  left out, no line: a part {:.0} px long and {:.0} px wide at ({:.0}, {:.0})",
            part.length_px, part.width_px, part.u_px, part.v_px
        );
    }
    if let Some(dice) = answer.mean_instance_dice {
        let _ = writeln!(text, "  mean instance Dice {dice:.4}");
    }
    text
}

fn counted(count: usize, thing: &str) -> String {
    format!("{count} {thing}{}", if count == 1 { "" } else { "s" })
}
