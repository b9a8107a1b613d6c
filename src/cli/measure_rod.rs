//! `rodlab measure rod`: the gravito-bending length and the natural curvature of a rod that is
//! held at one end, from a photograph. Photographs of the rod turned about its axis also give its
//! twisting stiffness.

use super::prelude::*;
use rodlab_lab::identify::{
    CURVATURE_KEY, HangingRod, Identified, LENGTH_KEY, Photograph, TWISTING_KEY, measure_hanging,
    measure_photographs,
};
use rodlab_lab::run::Interruption;
use rodlab_lab::scenario;
use rodlab_vision::{
    Camera, ColourRule, Metric, Point, TraceOptions, encode_picture, overlay, read_picture, trace,
};

const HELP: [&str; 2] = help!(
    "\
Examples:
  rodlab measure rod photo.png --pixel \"0.2 mm\"
  rodlab measure rod photo.jpg --camera camera.toml --down 0,-1 --colour red --out measured
  rodlab measure rod front.png side.png --roll 0,90 --camera camera.toml",
    "\
The rod is held at one end, hangs or stands freely, and is photographed whole and from the side.
Several photographs show the same rod. If it is naturally curved and turned about its axis at the
clamp (--roll), its shape also gives the ratio of twisting to bending stiffness. A turn of 0 means
that the natural curvature is in the plane of the photograph. Turns are right-handed about the
direction in which the rod leaves the clamp, and assumed to be accurate to a degree. The answer is
JSON: the gravito-bending length L_gb (m), the radius (m) and the natural curvature (1/m), positive
to the left as seen from the held end. Standard errors follow from the scatter of the traced points
and, for the length, from the ends, whose uncertainty is half the radius. The bending stiffness is 2
L_gb³ times the weight per length."
);

/// Arguments of `rodlab measure rod`.
#[derive(Debug, Args)]
#[command(after_help = HELP[0], after_long_help = HELP[1])]
pub struct RodArguments {
    /// PNG or JPEG images of the rod
    #[arg(required = true)]
    images: Vec<PathBuf>,
    /// Files whose table [camera] gives coordinates in metres, on the plane in which the rod is held: one for all images, or one each
    #[arg(long, value_name = "FILE,...", value_delimiter = ',', value_parser = file_or_preset(PresetKind::Cell), add = presets(PresetKind::Cell), required_unless_present = "pixel")]
    camera: Vec<PathBuf>,
    /// Side of a pixel, if the image plane is parallel to the plane of the rod
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
    /// Pixel near the held end, u,v; once for each image [default: the higher end]
    #[arg(long, value_name = "U,V", value_parser = pair)]
    held: Vec<[f64; 2]>,
    /// Turn of the rod about its axis at the clamp in each image, such as 0,90: degrees, or with a unit [default: 0]
    #[arg(long, value_name = "ANGLE,...", value_delimiter = ',', value_parser = turn, allow_hyphen_values = true)]
    roll: Vec<f64>,
    /// Assume that the rod is naturally straight
    #[arg(long)]
    straight: bool,
    /// Directory for the images with the traced rod on them: overlay.png, overlay_2.png, ...
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Has no effect: the answer is always JSON
    #[arg(long)]
    json: bool,
}

/// Uncertainty of the ends of a strand, as a fraction of its radius. An error of the length
/// affects all lengths.
const ENDS: f64 = 0.5;

#[derive(Serialize)]
struct Answer {
    gravito_bending_length_m: f64,
    uncertainty_m: Option<f64>,
    radius_m: f64,
    length_m: f64,
    natural_curvature_per_m: Option<f64>,
    natural_curvature_uncertainty_per_m: Option<f64>,
    #[serde(flatten)]
    twisting: Option<Twisting>,
    /// Root mean square distance of the traced points from the fitted rod, in each coordinate.
    misfit_m: f64,
    remarks: Vec<String>,
}

/// Results from several photographs.
#[derive(Serialize)]
struct Twisting {
    /// GJ/EI; `None` if the shapes do not determine it.
    twisting_over_bending: Option<f64>,
    twisting_over_bending_uncertainty: Option<f64>,
}

/// A rod as traced in an image.
struct Traced {
    points: Vec<[f64; 2]>,
    radius: f64,
    length: f64,
    eye: Option<[f64; 3]>,
}

/// How to determine the twisting stiffness.
const TURN_IT: &str = "the shapes do not determine the twisting stiffness: photograph a naturally curved rod that is turned out of its plane about its axis at the clamp, too (--roll 0,90)";

fn turn(text: &str) -> Result<f64, String> {
    match scenario::angle(text)? {
        angle if angle.is_finite() => Ok(angle),
        _ => Err("the angle is too large".to_owned()),
    }
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
    let count = arguments.images.len();
    for (option, given) in [
        ("--camera", arguments.camera.len()),
        ("--held", arguments.held.len()),
        ("--roll", arguments.roll.len()),
    ] {
        let one_for_all = given <= usize::from(option == "--camera");
        if given != 0 && given != count && !one_for_all {
            return Err(Failure::Input(format!(
                "{option}: {given} given for {count} images; expected one for each"
            )));
        }
    }
    let traced: Result<Vec<Traced>, Failure> =
        (0..count).map(|number| traced(arguments, number)).collect();
    let traced = traced?;
    let interruption = Interruption::watch();
    let goes_on = || interruption.requested().is_none();
    let roll = |number: usize| arguments.roll.get(number).copied().unwrap_or(0.0);
    if let ([image], [one]) = (arguments.images.as_slice(), traced.as_slice())
        && roll(0) == 0.0
    {
        let rod = HangingRod {
            picture: image,
            points: &one.points,
            radius: one.radius,
            down: arguments.down,
            is_straight: arguments.straight,
        };
        let found = measure_hanging(&rod, &goes_on).map_err(super::identify::failure)?;
        return print_json(&answer(&found, one.radius, one.length));
    }
    let photographs =
        (arguments.images.iter().zip(&traced).enumerate()).map(|(number, (image, one))| {
            Photograph {
                picture: image,
                points: &one.points,
                down: arguments.down,
                roll: roll(number),
                eye: one.eye,
            }
        });
    let photographs: Vec<Photograph<'_>> = photographs.collect();
    let radius = traced.iter().map(|one| one.radius).sum::<f64>() / count as f64;
    let found = measure_photographs(&photographs, radius, arguments.straight, &goes_on);
    let found = found.map_err(super::identify::failure)?;
    let mut answer = answer(&found.identified, radius, found.length);
    let twisting = found.identified.parameters.iter();
    let twisting = twisting.clone().find(|one| one.key == TWISTING_KEY);
    let determined = twisting.filter(|one| one.standard_error.is_some());
    if determined.is_none() {
        answer.remarks.push(TURN_IT.to_owned());
    }
    answer.twisting = Some(Twisting {
        twisting_over_bending: determined.map(|one| one.value),
        twisting_over_bending_uncertainty: determined.and_then(|one| {
            let of_ends = found.twisting_over_ends? * ENDS * radius / found.length;
            Some(libm::hypot(one.standard_error?, of_ends))
        }),
    });
    print_json(&answer)
}

/// Traces the rod in one of the images.
fn traced(arguments: &RodArguments, number: usize) -> Result<Traced, Failure> {
    let path = &arguments.images[number];
    let file = path.display();
    let camera = match arguments.camera.as_slice() {
        [one] => Some(one),
        several => several.get(number),
    };
    let camera = camera.map(|camera| Camera::read(camera)).transpose()?;
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
        let name = match number {
            0 => "overlay.png".to_owned(),
            _ => format!("overlay_{}.png", number + 1),
        };
        let bytes = encode_picture(&overlay(&picture, &traced));
        write_files(out, vec![(name.as_str(), bytes)])?;
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
    let is_reversed = match arguments.held.get(number) {
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
    Ok(Traced {
        points,
        radius,
        length,
        eye: camera.map(|camera| {
            let eye = camera.pose.translation.vector;
            [eye.x, eye.y, eye.z - camera.table_height]
        }),
    })
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
        twisting: None,
        misfit_m: found
            .groups
            .first()
            .map_or(f64::NAN, |group| group.root_mean_square),
        remarks,
    }
}
