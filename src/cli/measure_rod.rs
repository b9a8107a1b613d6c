//! `rodlab measure rod`: the gravito-bending length and the natural curvature of a rod that is held at one end, from a
//! photograph.

use super::prelude::*;
use rodlab_lab::identify::{CURVATURE_KEY, HangingRod, Identified, LENGTH_KEY, measure_hanging};
use rodlab_lab::run::Interruption;
use rodlab_vision::{
    Camera, ColourRule, Metric, Point, TraceOptions, encode_picture, overlay, read_picture, trace,
};

const HELP: [&str; 2] = help!(
    "\
Examples:
  rodlab measure rod photo.png --pixel \"0.2 mm\"
  rodlab measure rod photo.jpg --camera camera.toml --down 0,-1 --colour red --out measured",
    "\
The rod is held at one end, hangs or stands free, and is seen whole and from the side. The answer is
JSON: gravito-bending length L_gb, m, radius, m, and natural curvature, 1/m, positive to the left
seen from the held end, with standard errors from the scatter of the traced points and, of the
length, from half the radius to which the ends are seen. The bending stiffness is 2 L_gb³ times the
weight per length."
);

/// Arguments of `rodlab measure rod`.
#[derive(Debug, Args)]
#[command(after_help = HELP[0], after_long_help = HELP[1])]
pub struct RodArguments {
    /// PNG or JPEG image of the rod
    image: PathBuf,
    /// File whose table [camera] gives coordinates in metres, on the plane in which the rod hangs
    #[arg(long, value_name = "FILE", value_parser = file_or_preset(PresetKind::Cell), add = presets(PresetKind::Cell), required_unless_present = "pixel")]
    camera: Option<PathBuf>,
    /// Side of a pixel, where the image plane is parallel to that of the rod
    #[arg(long, value_name = "LENGTH", value_parser = positive_length, conflicts_with = "camera")]
    pixel: Option<f64>,
    /// Colour of the rod, as in `rodlab trace`
    #[arg(long, value_name = "RULE", default_value = "auto")]
    colour: String,
    /// Number of the strand, from 1 [default: the longest one]
    #[arg(long, value_name = "N")]
    strand: Option<usize>,
    /// Direction of gravity: x,y in metric coordinates; without a camera y is up
    #[arg(long, value_name = "X,Y", default_value = "0,-1", value_parser = direction, allow_hyphen_values = true)]
    down: [f64; 2],
    /// Pixel near the held end, u,v [default: the higher end]
    #[arg(long, value_name = "U,V", value_parser = pair)]
    held: Option<[f64; 2]>,
    /// Assume that the rod is straight without stress
    #[arg(long)]
    straight: bool,
    /// Directory for the image with the traced rod on it: overlay.png
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Accepted for uniformity: the answer is always JSON
    #[arg(long)]
    json: bool,
}

/// Part of its radius to which the ends of a strand are seen: an error of the length is one of all lengths.
const ENDS: f64 = 0.5;

#[derive(Serialize)]
struct Answer {
    gravito_bending_length_m: f64,
    uncertainty_m: Option<f64>,
    radius_m: f64,
    length_m: f64,
    natural_curvature_per_m: Option<f64>,
    natural_curvature_uncertainty_per_m: Option<f64>,
    /// Root mean square distance of the traced points from the fitted rod, in each coordinate.
    misfit_m: f64,
    remarks: Vec<String>,
}

fn pair(text: &str) -> Result<[f64; 2], String> {
    match numbers(text).as_deref() {
        Some(&[one, other]) if one.is_finite() && other.is_finite() => Ok([one, other]),
        _ => Err("expected two numbers with a comma between them, as in 320,40".to_owned()),
    }
}

fn direction(text: &str) -> Result<[f64; 2], String> {
    pair(text).and_then(|pair| match pair == [0.0, 0.0] {
        true => Err("the direction must not be 0".to_owned()),
        false => Ok(pair),
    })
}

/// Traces the rod, fits it and prints the result.
pub fn measure_rod(arguments: &RodArguments) -> Result<(), Failure> {
    let path = &arguments.image;
    let file = path.display();
    let camera = arguments.camera.as_deref().map(Camera::read).transpose()?;
    let picture = read_picture(path)?;
    if let Some(camera) = &camera {
        camera
            .check_size(picture.width(), picture.height())
            .at(&file)?;
    }
    let metric = match (&camera, arguments.pixel) {
        (Some(camera), _) => Metric::Camera(camera),
        (None, pixel) => Metric::Scan {
            pixel: pixel.unwrap_or(1.0),
            height: picture.height(),
        },
    };
    let options = TraceOptions {
        colour: ColourRule::parse(&arguments.colour)?,
        ..TraceOptions::default()
    };
    let traced = trace(&picture, &options).at(&file)?;
    if let Some(out) = &arguments.out {
        write_files(
            out,
            vec![("overlay.png", encode_picture(&overlay(&picture, &traced)))],
        )?;
    }
    let strand = traced.strand(arguments.strand).ok_or_else(|| {
        Failure::Input(format!(
            "--strand: there are {} strands, counted from 1",
            traced.strands.len()
        ))
    })?;
    if strand.closed {
        return Err(Failure::Input(format!(
            "{file}: the traced rod is closed; expected one with two ends"
        )));
    }
    let located: Result<Vec<Point>, _> = strand
        .points
        .iter()
        .map(|point| metric.locate(*point))
        .collect();
    let located: Vec<[f64; 2]> = located
        .at(&file)?
        .iter()
        .map(|point| [point.x, point.y])
        .collect();
    let (Some(first), Some(last)) = (located.first(), located.last()) else {
        return Err(Failure::Input(format!("{file}: no rod was found")));
    };
    let is_reversed = match arguments.held {
        Some(held) => {
            let far = |end: &Point| libm::hypot(end.x - held[0], end.y - held[1]);
            far(&strand.points[strand.points.len() - 1]) < far(&strand.points[0])
        }
        None => height(last, arguments.down) > height(first, arguments.down),
    };
    let mut points = located.clone();
    if is_reversed {
        points.reverse();
    }
    let length: f64 = points
        .windows(2)
        .map(|pair| libm::hypot(pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]))
        .sum();
    let mut widths = strand.widths.clone();
    widths.sort_by(f64::total_cmp);
    let radius = 0.5 * widths[widths.len() / 2] * length / strand.length();
    let rod = HangingRod {
        picture: path,
        points: &points,
        radius,
        down: arguments.down,
        is_straight: arguments.straight,
    };
    let interruption = Interruption::watch();
    let found = measure_hanging(&rod, &|| interruption.requested().is_none());
    let found = found.map_err(super::identify::failure)?;
    print_json(&answer(&found, radius, length))
}

fn height(point: &[f64; 2], down: [f64; 2]) -> f64 {
    -(point[0] * down[0] + point[1] * down[1])
}

fn answer(found: &Identified, radius_m: f64, length_m: f64) -> Answer {
    let of = |key: &str| found.parameters.iter().find(|one| one.key == key);
    let (length, curvature) = (of(LENGTH_KEY), of(CURVATURE_KEY));
    let mut remarks = found.remarks.clone();
    remarks.extend(found.undetermined.iter().map(|one| one.words.clone()));
    Answer {
        gravito_bending_length_m: length.map_or(f64::NAN, |one| one.value),
        uncertainty_m: length.and_then(|one| {
            let of_ends = one.value * ENDS * radius_m / length_m;
            Some(libm::hypot(one.standard_error?, of_ends))
        }),
        radius_m,
        length_m,
        natural_curvature_per_m: curvature.map(|one| one.value),
        natural_curvature_uncertainty_per_m: curvature.and_then(|one| one.standard_error),
        misfit_m: found
            .groups
            .first()
            .map_or(f64::NAN, |group| group.root_mean_square),
        remarks,
    }
}
