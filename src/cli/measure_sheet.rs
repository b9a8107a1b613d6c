//! `rodlab measure sheet`: the position of a sheet of paper, and its slide.

use super::prelude::*;
use super::trace::mask_of_rule;
use rodlab_vision::{
    Camera, ColourRule, EdgePose, Point, Sheet, encode_picture, find_sheet, mask_overlay,
    read_picture, sheet_overlay, sliding,
};

const HELP: [&str; 2] = help!(
    "\
Examples:
  rodlab measure sheet before.png --colour white --cell camera.toml
  rodlab measure sheet before.png after.png --cell camera.toml --edge 3 --direction 1,0 --out sheets",
    "\
The answer is JSON, in metres on the table with --cell, otherwise in pixels. Corners count clockwise
in the image from the one nearest to its upper left; edge 1 goes from corner 1 to corner 2.
straightness is the root mean square distance of the points of an edge from its line."
);

/// Arguments of `rodlab measure sheet`.
#[derive(Debug, Args)]
#[command(after_help = HELP[0], after_long_help = HELP[1])]
pub struct SheetArguments {
    /// PNG or JPEG image of the sheet
    image: PathBuf,
    /// Later image, for measuring the slide of the sheet
    after: Option<PathBuf>,
    /// Colour of the paper, as in `rodlab trace`
    #[arg(long, value_name = "RULE", default_value = "auto")]
    colour: String,
    /// File whose table [camera] gives coordinates in metres
    #[arg(long, value_name = "FILE", value_parser = file_or_preset(PresetKind::Cell), add = presets(PresetKind::Cell))]
    cell: Option<PathBuf>,
    /// Number of the edge whose slide is measured
    #[arg(long, value_name = "1..4", default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=4))]
    edge: u8,
    /// Direction of the slide: x,y on the table, or right,down in the image without a camera
    #[arg(long, value_name = "X,Y", default_value = "1,0", value_parser = direction, allow_hyphen_values = true)]
    direction: Point,
    /// Directory for the images with the edges on them: sheet_1.png, sheet_2.png
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Has no effect: the answer is always JSON
    #[arg(long)]
    json: bool,
}

fn direction(text: &str) -> Result<Point, String> {
    let parts = text.split_once(',');
    let parts = parts.and_then(|(x, y)| Some((x.trim().parse().ok()?, y.trim().parse().ok()?)));
    parts
        .map(|(x, y)| Point::new(x, y))
        .filter(|way| way.norm() > 1e-9 && way.norm().is_finite())
        .ok_or_else(|| "expected two numbers that are not both 0, as in 1,0".into())
}

#[derive(Serialize)]
struct Answer {
    /// Unit of lengths and coordinates.
    unit: &'static str,
    sheets: Vec<SheetAnswer>,
    #[serde(skip_serializing_if = "Option::is_none")]
    sliding: Option<SlidingAnswer>,
}

#[derive(Serialize)]
struct SheetAnswer {
    image: PathBuf,
    corners: [[f64; 2]; 4],
    corners_px: [[f64; 2]; 4],
    edges: Vec<EdgeAnswer>,
}

#[derive(Serialize)]
struct EdgeAnswer {
    edge: usize,
    middle: [f64; 2],
    angle_degrees: f64,
    length: f64,
    straightness: f64,
}

#[derive(Serialize)]
struct SlidingAnswer {
    edge: usize,
    direction: [f64; 2],
    /// Distance by which the middle of the edge moved along the given direction.
    distance: f64,
    /// Total displacement of the middle of the edge.
    moved: [f64; 2],
    turned_degrees: f64,
}

/// Finds one or two sheets and prints their positions.
pub fn measure_sheet(arguments: &SheetArguments) -> Result<(), Failure> {
    let camera = arguments.cell.as_deref().map(Camera::read).transpose()?;
    let rule = ColourRule::parse(&arguments.colour)?;
    let mut sheets: Vec<(PathBuf, Sheet)> = Vec::new();
    for (path, number) in std::iter::once(&arguments.image)
        .chain(&arguments.after)
        .zip(1..)
    {
        let sheet = arguments.sheet(path, number, &rule, camera.as_ref())?;
        let sheet = match sheets.first() {
            Some((_, first)) => sheet.numbered_like(first),
            None => sheet,
        };
        sheets.push((path.clone(), sheet));
    }
    let slid = match &sheets[..] {
        [(_, before), (_, after)] => {
            let edge = usize::from(arguments.edge) - 1;
            Some(arguments.slid(&before.edge(edge), &after.edge(edge)))
        }
        _ => None,
    };
    print_json(&Answer {
        unit: if camera.is_some() { "m" } else { "px" },
        sheets: sheets.into_iter().map(SheetAnswer::of).collect(),
        sliding: slid,
    })
}

impl SheetArguments {
    fn sheet(
        &self,
        path: &Path,
        number: usize,
        rule: &ColourRule,
        camera: Option<&Camera>,
    ) -> Result<Sheet, Failure> {
        let picture = read_picture(path)?;
        if let Some(camera) = camera {
            let size = camera.check_size(picture.width(), picture.height());
            size.at(path.display())?;
        }
        let found = match camera {
            Some(camera) => find_sheet(&picture, rule, |pixel| camera.on_table(pixel)),
            None => find_sheet(&picture, rule, Ok),
        };
        if let Some(out) = &self.out {
            let shown = match &found {
                Ok(sheet) => sheet_overlay(&picture, sheet),
                Err(_) => mask_overlay(&picture, &mask_of_rule(&picture, rule)?),
            };
            let name = format!("sheet_{number}.png");
            write_files(out, vec![(&name, encode_picture(&shown))])?;
        }
        found.at(path.display())
    }

    fn slid(&self, before: &EdgePose, after: &EdgePose) -> SlidingAnswer {
        let unit = self.direction.normalize();
        let turned = (after.angle - before.angle).to_degrees();
        SlidingAnswer {
            edge: self.edge.into(),
            direction: unit.into(),
            distance: sliding(before, after, unit),
            moved: (after.middle - before.middle).into(),
            turned_degrees: (turned + 180.0).rem_euclid(360.0) - 180.0,
        }
    }
}

impl SheetAnswer {
    fn of((image, sheet): (PathBuf, Sheet)) -> Self {
        let edges = (0..4).map(|edge| {
            let pose = sheet.edge(edge);
            EdgeAnswer {
                edge: edge + 1,
                middle: pose.middle.into(),
                angle_degrees: pose.angle.to_degrees(),
                length: pose.length,
                straightness: sheet.straightness[edge],
            }
        });
        Self {
            image,
            corners: sheet.corners.map(Into::into),
            corners_px: sheet.corner_pixels.map(Into::into),
            edges: edges.collect(),
        }
    }
}
