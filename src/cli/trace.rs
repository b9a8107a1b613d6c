//! `rodlab trace`: finds centrelines in images.

use super::picture_source::{RecordingArguments, SourcePicture, is_series, pictures};
use super::prelude::*;
use super::trace_answer::{Answer, answer, counted, summary};
use image::{GrayImage, RgbImage};
use rodlab_vision::{
    Camera, ColourRule, Contrast, Mask, Metric, Region, Trace, TraceOptions, VisionError,
    centrelines_csv, centrelines_svg, clean_mask, encode_labels, encode_picture, instance_dice,
    mask_overlay, overlay, pattern, pattern_csv, read_labels, read_picture, trace_contrast,
};

const HELP: [&str; 2] = help!(
    "\
Examples:
  rodlab trace photo.jpg --out traced                 rods on a plain background
  rodlab trace photo.jpg --strands 2 --region 100,80,640,480 --out traced
  rodlab trace letter.png --colour pen --out traced   pen on paper
  rodlab trace letter.png --colour pen --pixel \"0.2 mm\" --pattern letter.csv",
    "\
More examples:
  rodlab trace ros1://192.168.1.5:11311/camera/image_raw --cell cell.toml --out traced
  rodlab trace photo.jpg --colour pick:320,240 --cell cell.toml --out traced
  rodlab trace photo.jpg --colour red --json
  rodlab trace recording.bag --every 30 --out traced
  rodlab trace rosbridge://192.168.1.5:9090/camera/image_raw/compressed --out traced
  rodlab trace ros2://0/camera/image_raw --out traced

Pixels count from the centre of the first one, u to the right and v down. Strands count from 1,
points from 0."
);

/// Arguments of `rodlab trace`.
#[derive(Debug, Args)]
#[command(after_help = HELP[0], after_long_help = HELP[1])]
pub struct TraceArguments {
    /// Image, folder of images, recording (.bag) or address of a camera
    ///
    /// Images are PNG, JPEG, TIFF, BMP or WebP files; those of a folder are read in order of their
    /// names. Recordings are of ROS 1 or of a RealSense camera. From a camera the next picture is
    /// read: ros1://host:port/topic, rosbridge://host:port/topic, ros2://domain/topic.
    pub image: PathBuf,
    #[command(flatten)]
    recording: RecordingArguments,
    /// Colour of a rod, once for each: auto, tint, a hue, pick:u,v and others (see --help)
    ///
    /// Hues are red, orange, yellow, green, cyan, blue, purple and pink; there are also black and
    /// white. A colour is #rrggbb[:radius] or that of a pixel, pick:u,v[:radius], or
    /// hsv:h-h,s-s,v-v. "tint" is any colour except those of the background and its shadows;
    /// "lighter" and "darker" (or "pen") compare with the surroundings; "relief" does so in both
    /// directions, for white on white. Strands of different colours are separate.
    // No alias "color", since that is an option of all subcommands.
    #[arg(
        long,
        value_name = "RULE",
        default_value = "auto",
        conflicts_with = "mask"
    )]
    pub colour: Vec<String>,
    /// Number of rods: keep the strands that look most like rods
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=60))]
    pub strands: Option<u16>,
    /// Part of the image, pixels: x,y,width,height or corners
    ///
    /// The corners of a polygon are separated by spaces: "100,80 740,80 420,560". Strands end at
    /// its edge.
    #[arg(long, value_name = "REGION")]
    pub region: Option<String>,
    /// Length below which a strand is left out
    #[arg(long, value_name = "PIXELS", default_value_t = 0.0, value_parser = least_length)]
    pub least_length: f64,
    /// Mask of the same size: pixels that are not black belong to the rod
    #[arg(long, value_name = "FILE")]
    pub mask: Option<PathBuf>,
    /// File whose table [camera] gives coordinates in metres
    #[arg(long, value_name = "FILE", value_parser = file_or_preset(PresetKind::Cell), add = presets(PresetKind::Cell))]
    pub cell: Option<PathBuf>,
    /// Number of pixels below which a part is noise
    #[arg(long, value_name = "PIXELS", default_value_t = 60)]
    pub least_area: usize,
    /// Write a strand as a pattern file, CSV with columns x_m and y_m; needs --cell or --pixel
    #[arg(long, value_name = "FILE")]
    pub pattern: Option<PathBuf>,
    /// Number of the strand that becomes the pattern, from 1 [default: the longest one]
    #[arg(long, value_name = "N", requires = "pattern")]
    pub strand: Option<usize>,
    /// Smoothing length: waves of the pattern shorter than about six times this are removed
    #[arg(long, value_name = "LENGTH", default_value = "2 mm", value_parser = positive_length)]
    pub smoothing: f64,
    /// Side of a pixel of a scan, for --pattern without a camera
    #[arg(long, value_name = "LENGTH", value_parser = positive_length, conflicts_with = "cell")]
    pub pixel: Option<f64>,
    /// True label image (8 bit, pixel = strand) to compare with
    #[arg(long, value_name = "FILE")]
    pub truth: Option<PathBuf>,
    /// Directory for centrelines.csv, centrelines.svg, labels.png and overlay.png
    ///
    /// It has one subdirectory for each image of a folder or recording.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print what was found as JSON
    #[arg(long)]
    pub json: bool,
}

fn least_length(text: &str) -> Result<f64, String> {
    let length = text.parse().ok();
    let length = length.filter(|length: &f64| length.is_finite() && *length >= 0.0);
    length.ok_or_else(|| "expected a number of pixels, at least 0".into())
}

fn options(arguments: &TraceArguments) -> Result<TraceOptions, VisionError> {
    Ok(TraceOptions {
        region: arguments.region.as_deref().map(Region::parse).transpose()?,
        strands: arguments.strands.map(usize::from),
        least_length: arguments.least_length,
        least_area: arguments.least_area,
        has_corners: arguments.pattern.is_some(),
        ..TraceOptions::of_colours(&arguments.colour)?
    })
}

/// Traces one image, or all of a folder.
pub fn trace(arguments: &TraceArguments) -> Result<(), Failure> {
    let options = options(arguments)?;
    let camera = arguments.cell.as_deref().map(Camera::read).transpose()?;
    let sources = pictures(&arguments.image, &arguments.recording)?;
    if !is_series(&arguments.image) {
        for source in sources {
            let answer = trace_picture(arguments, source, &options, camera.as_ref())?;
            if arguments.json {
                print_json(&answer)?;
            } else {
                print(&summary(&answer))?;
            }
        }
        return Ok(());
    }
    if arguments.truth.is_some() || arguments.mask.is_some() || arguments.pattern.is_some() {
        return Err(Failure::Input(
            "--truth, --mask and --pattern belong to one image, not to a folder or a recording"
                .into(),
        ));
    }
    let mut answers = Vec::new();
    let mut faults = Vec::new();
    for source in sources {
        match trace_picture(arguments, source, &options, camera.as_ref()) {
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

fn trace_picture(
    arguments: &TraceArguments,
    source: SourcePicture,
    options: &TraceOptions,
    camera: Option<&Camera>,
) -> Result<Answer, Failure> {
    let path = source.name;
    let file = path.display();
    let picture = source.picture?;
    let out = arguments.out.as_ref().map(|out| out.join(source.folder));
    if let Some(camera) = camera {
        camera
            .check_size(picture.width(), picture.height())
            .at(&file)?;
    }
    let traced = match &arguments.mask {
        Some(mask) => {
            let mask = Contrast::of_mask(&mask_of(mask, &picture)?);
            trace_contrast(&picture, &mask, options)
        }
        None => rodlab_vision::trace(&picture, options),
    };
    let traced = match traced {
        Ok(traced) => traced,
        Err(error) => {
            if let (Some(out), None) = (&out, &arguments.mask) {
                let mask = clean_mask(&picture, options).at(&file)?;
                let shown = encode_picture(&mask_overlay(&picture, &mask));
                write_files(out, vec![("overlay.png", shown)])?;
            }
            return Err(error).at(&file);
        }
    };
    let mean_instance_dice = match &arguments.truth {
        Some(truth) => {
            let truth = read_labels(truth)?;
            Some(instance_dice(&traced.labels, &truth).at(&file)?.mean)
        }
        None => None,
    };
    let mut answer = answer(&path, &picture, &traced, camera, mean_instance_dice).at(&file)?;
    answer.time_s = source.time;
    let csv = centrelines_csv(&traced.strands, camera).at(&file)?;
    if let Some(pattern) = &arguments.pattern {
        write_pattern(arguments, pattern, &traced, camera, picture.height())?;
    }
    if let Some(out) = &out {
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

/// Pixels of a picture that match a colour rule, for a picture that shows why nothing was found.
pub fn mask_of_rule(picture: &RgbImage, rule: &ColourRule) -> Result<Mask, VisionError> {
    Ok(Mask::of_contrast(&Contrast::new(picture, rule)?))
}

/// Distance between the points of a pattern, metres.
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
    let strand = traced.strand(arguments.strand).ok_or_else(|| {
        let count = counted(traced.strands.len(), "strand");
        Failure::Input(format!("--strand: there are {count}, counted from 1"))
    })?;
    let points = pattern(strand, metric, arguments.smoothing, PATTERN_STEP)?;
    write_file(path, pattern_csv(&points).as_bytes())
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
