//! Patterns as arguments: formulas and drawings.

use super::drawn_pattern::{Part, counted, drawn_points, drawn_strokes};
use super::middle_line::{Filled, FilledLine, POINT_STEP};
use super::picture_source::has_ending;
use super::prelude::*;
use super::preset_file::{GivenPattern, pattern_or_preset};
use rodlab_lab::scenario::metres;
use rodlab_planning::plan::pattern::{
    Circle, Drawing, Line, PatternSource, Point, Sine, StrokeChoice, bounds,
};
use rodlab_planning::plan::remedy::Changes;
use rodlab_vision::{
    Camera, ColourRule, Metric, PICTURE_ENDINGS, TraceOptions, pattern, read_picture, trace,
};
use std::sync::OnceLock;

/// Largest number of strokes that are laid without a choice.
const MOST_STROKES: usize = 12;
/// Default distance of the smooth curve from the drawing, m.
const DEVIATION: f64 = 2.5e-4;

/// Pattern along which a rod is laid.
#[derive(Clone, Debug, Args)]
pub struct PatternArguments {
    /// Pattern: an SVG or CSV file, a photographed drawing, or line:…, circle:… or sine:…
    ///
    /// A CSV file has columns x_m and y_m. A photographed drawing is a PNG, JPEG, TIFF, BMP or WebP file, and needs --size or
    /// --drawing-camera. Formulas are line:LENGTH, circle:RADIUS and sine:AMPLITUDE,WAVELENGTH,WAVES.
    #[arg(long, value_name = "PATTERN", value_parser = pattern_or_preset, add = presets(PresetKind::Pattern))]
    pattern: GivenPattern,
    /// Length of the longer side of a drawn pattern, or `fit` [default: as drawn]
    ///
    /// `fit` shrinks a drawing for which the rod is too short.
    #[arg(long, value_name = "LENGTH", value_parser = drawing_size)]
    size: Option<DrawingSize>,
    /// Stroke of the drawing: number from 1, id, or `longest` [default: the only one]
    ///
    /// If there are several, up to twelve, a rod is laid along each of them.
    /// Strokes of an SVG have numbers and ids, strands of a CSV file and lines of a photographed drawing only numbers. Of a
    /// photograph the longest line is the default.
    #[arg(long, hide_short_help = true, value_name = "STROKE")]
    stroke: Option<StrokeChoice>,
    /// Join strokes of an SVG whose ends are at most this far apart, in any order and direction
    #[arg(long, value_name = "GAP", hide_short_help = true, value_parser = length_from_zero)]
    join: Option<f64>,
    /// Follow the middle line of all filled areas of an SVG [default: of narrow ones, such as letters]
    #[arg(long, hide_short_help = true)]
    centreline: bool,
    /// Follow the edges of all filled areas of an SVG
    #[arg(long, hide_short_help = true, conflicts_with = "centreline")]
    outline: bool,
    /// The pattern, after it was read.
    #[arg(skip)]
    read: OnceLock<PatternSource>,
    /// Lay the pattern from the last point to the first
    #[arg(long, hide_short_help = true)]
    reverse: bool,
    /// Colour of the line in a photographed drawing, as in `rodlab trace`
    #[arg(
        long,
        value_name = "RULE",
        hide_short_help = true,
        default_value = "auto"
    )]
    drawing_colour: String,
    /// File whose [camera] took a photographed drawing that lies on its table
    ///
    /// Without it the picture is assumed to be taken from straight above.
    #[arg(long, value_name = "FILE", hide_short_help = true)]
    drawing_camera: Option<PathBuf>,
    /// Smoothing length: waves of a photographed line shorter than about six times this are removed
    #[arg(long, value_name = "LENGTH", hide_short_help = true, default_value = "2 mm", value_parser = positive_length)]
    drawing_smoothing: f64,
    /// Largest distance of the smooth curve from the drawing [default: 0.25 mm; more for sharp corners]
    ///
    /// By default corners that are too sharp for the rod are rounded as far as needed, by up to a
    /// tenth of the size of the drawing.
    #[arg(long, value_name = "LENGTH", hide_short_help = true, value_parser = positive_length)]
    deviation: Option<f64>,
}

/// Size of a drawn pattern.
#[derive(Clone, Copy, Debug, PartialEq)]
enum DrawingSize {
    /// Length of its longer side, m.
    Length(f64),
    /// As drawn, or smaller if the rod is too short.
    Fit,
}

fn drawing_size(text: &str) -> Result<DrawingSize, String> {
    match text.trim() {
        "fit" => Ok(DrawingSize::Fit),
        text => positive_length(text)
            .map(DrawingSize::Length)
            .map_err(|error| format!("{error}; or `fit`")),
    }
}

impl PatternArguments {
    /// Which properties of a drawn pattern may change so that it can be laid.
    pub fn changes(&self) -> Changes {
        Changes {
            size: self.size == Some(DrawingSize::Fit),
            deviation: self.deviation.is_none(),
        }
    }

    fn deviation(&self) -> f64 {
        self.deviation.unwrap_or(DEVIATION)
    }

    /// Length of the longer side, m.
    fn longer_side(&self) -> Option<f64> {
        match self.size? {
            DrawingSize::Length(length) => Some(length),
            DrawingSize::Fit => None,
        }
    }

    /// The part of the drawing that is followed.
    fn part(&self) -> Part<'_> {
        let line = match (self.centreline, self.outline) {
            (true, _) => FilledLine::Middle,
            (_, true) => FilledLine::Edge,
            _ => FilledLine::default(),
        };
        Part {
            stroke: self.stroke.as_ref(),
            join: self.join,
            filled: Filled {
                line,
                size: self.longer_side(),
                smoothing: self.drawing_smoothing,
            },
        }
    }

    /// The pattern as given.
    pub fn name(&self) -> &str {
        &self.pattern.name
    }

    /// This pattern, once for each stroke of its drawing, at one scale, if the drawing has several
    /// and none is selected.
    pub fn strokes(&self) -> Result<Vec<Self>, Failure> {
        let path = Path::new(&self.pattern.source);
        if self.stroke.is_some() || !has_ending(path, &["svg"]) {
            return Ok(vec![self.clone()]);
        }
        let strokes = drawn_strokes(path, self.part(), MOST_STROKES)?;
        let is_alone = strokes.len() == 1;
        let whole: Vec<Point> = strokes.concat();
        let scale = self
            .longer_side()
            .map_or(1.0, |side| side / longer_side(&whole));
        let as_drawn = Drawing {
            size: None,
            reverse: self.reverse,
        };
        let stroke = |(number, points): (usize, Vec<Point>)| {
            let points = points.into_iter().map(|point| scale * point).collect();
            let source = PatternSource::Drawn {
                points: as_drawn.of(points).at(&self.pattern.name)?,
                deviation: self.deviation(),
            };
            let mut own = self.clone();
            if !is_alone {
                own.stroke = Some(StrokeChoice::Number(number));
                own.pattern.name = format!("{}, stroke {number}", self.pattern.name);
            }
            own.read = OnceLock::from(source);
            Ok(own)
        };
        (1..).zip(strokes).map(stroke).collect()
    }

    /// Turns a drawn pattern round.
    pub fn turn_round(&mut self) -> Result<(), Failure> {
        let mut source = self.source()?;
        if let PatternSource::Drawn { points, .. } = &mut source {
            points.reverse();
        }
        self.read = OnceLock::from(source);
        Ok(())
    }

    /// A second pattern from a file, drawn at the scale of this one; without a file, from the file
    /// of this pattern.
    pub fn second(
        &self,
        file: Option<&Path>,
        stroke: Option<&StrokeChoice>,
    ) -> Result<PatternSource, Failure> {
        if self.size.is_some() || self.reverse {
            return Err(Failure::Input(
                "--size and --reverse are for a single rod: with two rods, patterns keep their \
                 drawn size and direction"
                    .into(),
            ));
        }
        let file = file.unwrap_or(Path::new(&self.pattern.source));
        let part = Part {
            stroke,
            join: None,
            ..self.part()
        };
        let points = drawn_points(file, part)?.ok_or_else(|| {
            Failure::Input(format!(
                "the pattern of a second rod must be an .svg file or a .csv file; {} is not",
                file.display()
            ))
        })?;
        let whole = Drawing {
            size: None,
            reverse: false,
        };
        Ok(PatternSource::Drawn {
            points: whole.of(points).at(&self.pattern.name)?,
            deviation: self.deviation(),
        })
    }

    /// The pattern; its file is read only once.
    pub fn source(&self) -> Result<PatternSource, Failure> {
        if let Some(read) = self.read.get() {
            return Ok(read.clone());
        }
        let read = self.read_source()?;
        Ok(self.read.get_or_init(|| read).clone())
    }

    fn read_source(&self) -> Result<PatternSource, Failure> {
        let Some(formula) = self.analytic()? else {
            return Ok(PatternSource::Drawn {
                points: self.drawn()?,
                deviation: self.deviation(),
            });
        };
        let given = [
            ("--size", self.size.is_some()),
            ("--stroke", self.stroke.is_some()),
            ("--join", self.join.is_some()),
            ("--centreline", self.centreline),
            ("--outline", self.outline),
            ("--reverse", self.reverse),
            ("--drawing-camera", self.drawing_camera.is_some()),
        ];
        match given.iter().find(|(_, given)| *given) {
            Some((flag, _)) => Err(Failure::Input(format!(
                "{flag} is for drawn patterns; {} has its size and direction",
                self.pattern.name
            ))),
            None => Ok(formula),
        }
    }

    /// The pattern of a formula: `line:…`, `circle:…` or `sine:…`.
    fn analytic(&self) -> Result<Option<PatternSource>, Failure> {
        let Some((kind, text)) = self.pattern.source.split_once(':') else {
            return Ok(None);
        };
        let values: Vec<&str> = text.split(',').collect();
        let fault =
            |needed: &str| Failure::Input(format!("--pattern {}: {needed}", self.pattern.name));
        let place = format!("--pattern {}", self.pattern.name);
        let length = |text: &str| positive_length(text).at(&place);
        Ok(Some(match (kind, values.as_slice()) {
            ("line", [end]) => PatternSource::Line(Line {
                length: length(end)?,
            }),
            ("circle", [radius]) => {
                // A negative radius turns to the right.
                let radius = metres(radius).at(&place)?;
                if radius == 0.0 || !radius.is_finite() {
                    return Err(fault("a radius other than 0 is needed"));
                }
                PatternSource::Circle(Circle { radius })
            }
            ("sine", [amplitude, wavelength, waves]) => {
                let waves: Option<f64> = waves.trim().parse().ok();
                let waves = waves.filter(|waves| *waves > 0.0 && *waves <= 1000.0);
                PatternSource::Sine(Sine {
                    amplitude: length(amplitude)?,
                    wavelength: length(wavelength)?,
                    waves: waves
                        .ok_or_else(|| fault("a number of waves from 0 to 1000 is needed"))?,
                })
            }
            ("line" | "circle" | "sine", _) => {
                return Err(fault(
                    "line:LENGTH, circle:RADIUS or sine:AMPLITUDE,WAVELENGTH,WAVES is needed",
                ));
            }
            _ => return Ok(None),
        }))
    }

    /// Points from a file, scaled and reversed as requested.
    fn drawn(&self) -> Result<Vec<Point>, Failure> {
        let path = Path::new(&self.pattern.source);
        let points = if has_ending(path, &PICTURE_ENDINGS) {
            Some(self.photographed(path)?)
        } else if self.drawing_camera.is_some() {
            return Err(Failure::Input(format!(
                "--drawing-camera is for photographed drawings (PNG or JPEG); {} is not one",
                self.pattern.name
            )));
        } else {
            drawn_points(path, self.part())?
        };
        let points = points.ok_or_else(|| {
            Failure::Input(format!(
                "--pattern {}: an .svg file, a .csv file, a photograph (.png, .jpg), line:…, circle:… or sine:… is needed",
                self.pattern.name
            ))
        })?;
        let drawing = Drawing {
            size: self.longer_side(),
            reverse: self.reverse,
        };
        drawing.of(points).at(&self.pattern.name)
    }

    /// The line of a photographed drawing, m.
    fn photographed(&self, path: &Path) -> Result<Vec<Point>, Failure> {
        let place = format!("--pattern {}", self.pattern.name);
        let picture = read_picture(path)?;
        let options = TraceOptions {
            colour: ColourRule::parse(&self.drawing_colour)?,
            has_corners: true,
            ..TraceOptions::default()
        };
        let hint = |error| format!("{error}; --drawing-colour selects the colour of its line");
        let traced = trace(&picture, &options).map_err(hint).at(&place)?;
        let strand = traced.strand(counted(self.stroke.as_ref())?);
        let strand = strand.ok_or_else(|| {
            let count = traced.strands.len();
            format!("--stroke: it has {count} lines, counted from 1")
        });
        let strand = strand.at(&place)?;
        let camera = self.drawing_camera.as_deref().map(Camera::read);
        let camera = camera.transpose()?;
        let metric = match (&camera, self.longer_side()) {
            (Some(camera), _) => {
                let size = camera.check_size(picture.width(), picture.height());
                size.at(&place)?;
                Metric::Camera(camera)
            }
            (None, Some(size)) => Metric::Scan {
                pixel: size / longer_side(&strand.points),
                height: picture.height(),
            },
            (None, None) => {
                return Err("a photograph has no scale: give --size, the length of the longer side of the drawing, or --drawing-camera").at(place);
            }
        };
        pattern(strand, metric, self.drawing_smoothing, POINT_STEP).at(&place)
    }
}

/// Longer side of the bounding box of points.
fn longer_side(points: &[Point]) -> f64 {
    let [width, height] = extent(points);
    width.max(height)
}

/// Width and height of the bounding box of points.
pub fn extent(points: &[Point]) -> [f64; 2] {
    let [low, high] = bounds(points);
    (high - low).into()
}
