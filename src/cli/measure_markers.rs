//! `rodlab measure markers`: whether a helical rod is still the expected helix.

use super::helix_file::HelixFile;
use super::picture_source::{RecordingArguments, SourcePicture, is_series, pictures};
use super::prelude::*;
use nalgebra::Vector3;
use rodlab_vision::{
    Camera, ColourRule, InstabilityRule, InstabilityWatch, MarkerErrors, Point, compare_markers,
    encode_picture, find_markers, marker_overlay,
};

const HELP: [&str; 2] = help!(
    "\
Examples:
  rodlab measure markers photo.png --cell camera.toml --helix helix.toml --colour blue
  rodlab measure markers frames/ --cell camera.toml --helix helix.toml --upper \"8 mm\" --out watched",
    "\
The file of the helix, in the axes of the camera's world:

  [helix]
  curvature = 9.0                      # 1/m
  torsion = 5.0
  markers = [\"2 cm\", \"4.5 cm\"]         # arc lengths
  position = [0.02, 0.25, 0.05]        # start of the helix
  quaternion = [1.0, 0.0, 0.0, 0.0]    # w, x, y, z of the frame there: z is the tangent,
                                       # x the direction of bending

For several images, --upper, --lower and --frames define the images in which the rod is unstable."
);

/// Arguments of `rodlab measure markers`.
#[derive(Debug, Args)]
#[command(after_help = HELP[0], after_long_help = HELP[1])]
pub struct MarkerArguments {
    /// PNG or JPEG image, folder of images, recording (.bag) or address of a camera, as in `rodlab trace`
    ///
    /// The images of a folder are read in order of their names.
    image: PathBuf,
    #[command(flatten)]
    recording: RecordingArguments,
    /// File whose table [camera] gives lens and pose of the camera
    #[arg(long, value_name = "FILE", value_parser = file_or_preset(PresetKind::Cell), add = presets(PresetKind::Cell))]
    cell: PathBuf,
    /// File whose table [helix] defines the expected helix
    #[arg(long, value_name = "FILE")]
    helix: PathBuf,
    /// Colour of the markers, as in `rodlab trace`
    #[arg(long, value_name = "RULE", default_value = "white")]
    colour: String,
    /// Smallest number of pixels of a marker
    #[arg(long, value_name = "PIXELS", default_value_t = 12)]
    least_area: usize,
    /// Largest number of pixels of a marker
    #[arg(long, value_name = "PIXELS", default_value_t = 2000)]
    largest_area: usize,
    /// Search radius of a marker, pixels; a marker that is not found counts with this error
    #[arg(long, value_name = "PIXELS", default_value_t = 40.0, value_parser = number(is_positive, "expected a number of pixels above 0"))]
    gate: f64,
    /// Error above which the rod no longer counts as the helix
    #[arg(long, value_name = "LENGTH", default_value = "10 mm", value_parser = positive_length)]
    upper: f64,
    /// Error below which the rod counts as the helix again, less than --upper
    #[arg(long, value_name = "LENGTH", default_value = "5 mm", value_parser = positive_length)]
    lower: f64,
    /// Number of consecutive images that decide on stability
    #[arg(long, value_name = "N", default_value_t = 3)]
    frames: usize,
    /// Directory for markers.csv and the images with markers and their expected places
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print the results as JSON
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Answer {
    pictures: Vec<PictureAnswer>,
    /// The first image in which the rod counts as unstable.
    #[serde(skip_serializing_if = "Option::is_none")]
    unstable_from: Option<PathBuf>,
}

#[derive(Serialize)]
struct PictureAnswer {
    image: PathBuf,
    #[serde(skip_serializing_if = "Option::is_none")]
    time_s: Option<f64>,
    spots: usize,
    markers: Vec<MarkerAnswer>,
    rms_m: f64,
    unstable: bool,
}

#[derive(Serialize)]
struct MarkerAnswer {
    marker: usize,
    arc_length_m: f64,
    /// Expected place in the picture; `None` if it is behind the camera.
    expected_px: Option<[f64; 2]>,
    found_px: Option<[f64; 2]>,
    error_px: Option<f64>,
    error_m: Option<f64>,
}

/// Compares the markers of all images with the helix.
pub fn measure_markers(arguments: &MarkerArguments) -> Result<(), Failure> {
    let camera = Camera::read(&arguments.cell)?;
    let helix = HelixFile::read(&arguments.helix)?;
    let rule = ColourRule::parse(&arguments.colour)?;
    let mut watch = InstabilityWatch::new(InstabilityRule {
        upper: arguments.upper,
        lower: arguments.lower,
        // A single image decides by itself.
        frames: if is_series(&arguments.image) {
            arguments.frames
        } else {
            1
        },
    })?;
    let expected = helix.places();
    let mut answer = Answer {
        pictures: Vec::new(),
        unstable_from: None,
    };
    for source in pictures(&arguments.image, &arguments.recording)? {
        let picture = arguments.picture(source, &camera, &rule, &helix, &expected, &mut watch)?;
        if picture.unstable && answer.unstable_from.is_none() {
            answer.unstable_from = Some(picture.image.clone());
        }
        if !arguments.json {
            print(&summary(&picture))?;
        }
        answer.pictures.push(picture);
    }
    if let Some(out) = &arguments.out {
        write_file(&out.join("markers.csv"), table(&answer).as_bytes())?;
    }
    if arguments.json {
        return print_json(&answer);
    }
    match &answer.unstable_from {
        Some(image) => print(&format!("unstable from {} on\n", image.display())),
        None => Ok(()),
    }
}

impl MarkerArguments {
    fn picture(
        &self,
        source: SourcePicture,
        camera: &Camera,
        rule: &ColourRule,
        helix: &HelixFile,
        expected: &[Vector3<f64>],
        watch: &mut InstabilityWatch,
    ) -> Result<PictureAnswer, Failure> {
        let file = source.name.display();
        let picture = source.picture?;
        camera
            .check_size(picture.width(), picture.height())
            .at(&file)?;
        let found = find_markers(&picture, rule, self.least_area, self.largest_area).at(&file)?;
        let errors = compare_markers(camera, expected, &found, self.gate).at(&file)?;
        if let Some(out) = &self.out {
            let shown = encode_picture(&marker_overlay(&picture, &found, &errors));
            write_files(&out.join(&source.folder), vec![("overlay.png", shown)])?;
        }
        Ok(PictureAnswer {
            unstable: watch.observe(errors.rms_metres),
            image: source.name,
            time_s: source.time,
            spots: found.len(),
            markers: marker_answers(helix, &errors),
            rms_m: errors.rms_metres,
        })
    }
}

fn marker_answers(helix: &HelixFile, errors: &MarkerErrors) -> Vec<MarkerAnswer> {
    let pixel = |point: &Option<Point>| point.map(|point| [point.x, point.y]);
    let markers = helix.markers.iter().enumerate();
    let answers = markers.map(|(index, arc_length)| MarkerAnswer {
        marker: index + 1,
        arc_length_m: *arc_length,
        expected_px: pixel(&errors.expected[index]),
        found_px: pixel(&errors.found[index]),
        error_px: errors.pixels[index],
        error_m: errors.metres[index],
    });
    answers.collect()
}

fn summary(picture: &PictureAnswer) -> String {
    let seen = picture
        .markers
        .iter()
        .filter(|marker| marker.error_px.is_some());
    format!(
        "{}: {} of {} markers, error {:.2} mm{}\n",
        picture.image.display(),
        seen.count(),
        picture.markers.len(),
        1e3 * picture.rms_m,
        if picture.unstable { ", unstable" } else { "" }
    )
}

/// A row for each marker of each image.
fn table(answer: &Answer) -> String {
    let mut text = String::from(
        "image,time_s,marker,arc_length_m,expected_u_px,expected_v_px,u_px,v_px,error_px,error_m,unstable\n",
    );
    let number = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.6}"));
    let pixel = |point: Option<[f64; 2]>| {
        let [u, v] = point.map_or([None; 2], |point| point.map(Some));
        format!("{},{}", number(u), number(v))
    };
    for picture in &answer.pictures {
        for marker in &picture.markers {
            // Writing to a string does not fail.
            let _ = writeln!(
                text,
                "\"{}\",{},{},{:.6},{},{},{},{},{}",
                picture.image.display().to_string().replace('"', "\"\""),
                number(picture.time_s),
                marker.marker,
                marker.arc_length_m,
                pixel(marker.expected_px),
                pixel(marker.found_px),
                number(marker.error_px),
                number(marker.error_m),
                u8::from(picture.unstable)
            );
        }
    }
    text
}
