//! Films of rods: pictures of a scene in motion, one after the other, drawn without a graphics card.
//!
//! A picture is drawn in steps: triangles around rods and bodies (`mesh`) go into a depth buffer
//! with four samples a pixel (`samples`), the visible surfaces are lit (`light`), and scale bar and
//! time are printed on top (`labels`). The camera is orthographic (`camera`). Pictures are drawn
//! side by side and do not depend on the number of threads.

mod bodies;
mod camera;
mod develop;
mod gif;
mod labels;
mod light;
mod mesh;
#[cfg(feature = "video")]
mod mp4;
mod png;
mod samples;
mod timeline;

pub use timeline::MOST_PICTURES;

pub(in crate::figure) use bodies::normals;
pub(in crate::figure) use mesh::{DrawnRod, Mesh};

use super::motion::{MovieCase, room};
use super::palette::Color;
use super::tube::rod_color;
use bodies::Body;
use camera::{Camera, CameraPath, FreePart};
use develop::Workspace;
use labels::{Stamp, scale_bar, text};
use light::Light;

use nalgebra::Vector3;
use timeline::{Moment, Timeline};

/// Options of a film.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmOptions {
    /// Width and height, pixels; even numbers.
    pub size: [usize; 2],
    /// Pictures per second.
    pub pictures_per_second: f64,
    /// Speed of the film.
    pub pace: Pace,
    /// Azimuth and elevation of the camera, rad; chosen to show the scene well by default. The
    /// azimuth is zero at the front (−y) and grows towards the right (+x).
    pub from: Option<[f64; 2]>,
    /// Angle by which the camera turns around the scene, rad.
    pub turn: f64,
    /// Magnification.
    pub zoom: f64,
    /// Index of the rod that the camera follows.
    pub follow: Option<usize>,
}

/// Speed of a film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pace {
    /// Ten seconds of film, or fewer if there are few outputs.
    Usual,
    /// Length of the film, s.
    Duration(f64),
    /// Simulated seconds per second of film.
    Speed(f64),
}

/// Reason why a film cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum FilmError {
    /// A static scene has no speed.
    #[error("these rods do not move in time; set the length of the film with --duration")]
    NoSpeed,
    /// Too many pictures.
    #[error("a film of {pictures} pictures is too long; allowed: at most {MOST_PICTURES}")]
    TooLong {
        /// Number of pictures.
        pictures: f64,
    },
    /// More pictures per second than the format supports.
    #[error("GIF files show at most 50 pictures per second")]
    TooFast,
    /// The caller asked to stop.
    #[error("interrupted; no file was written")]
    Interrupted,
    /// A picture could not be encoded or written.
    #[error("{0}")]
    Encoding(String),
}

/// A film, not drawn yet.
pub struct Film<'a> {
    case: &'a MovieCase,
    bodies: Vec<Body<'a>>,
    size: [usize; 2],
    pictures_per_second: f64,
    timeline: Timeline,
    path: CameraPath,
    palette: Vec<[f32; 3]>,
    scale_bar: Stamp,
    /// Size of letters, pixels.
    em: f64,
    /// Radius of the scene, m.
    radius: f64,
}

/// Samples per pixel along each side.
const FINENESS: usize = 2;
/// Materials of held rods and of bodies, after the colours of rods.
const HELD: u8 = 7;
const BODY: u8 = 8;

impl<'a> Film<'a> {
    /// A film of a case.
    ///
    /// # Errors
    /// [`FilmError::NoSpeed`], [`FilmError::TooLong`].
    ///
    /// # Panics
    /// If the case has no frames.
    pub fn new(case: &'a MovieCase, options: &FilmOptions) -> Result<Self, FilmError> {
        let timeline = Timeline::of(case, options)?;
        let [width, height] = options.size.map(|side| side as f64);
        let em = (height / 32.0).min(width / 40.0).max(9.0);
        let fineness = FINENESS as f64;
        let free = FreePart {
            left: 1.5 * em * fineness,
            right: (width - 1.5 * em) * fineness,
            top: 2.4 * em * fineness,
            bottom: (height - 3.6 * em) * fineness,
        };
        let path = CameraPath::around(case, options, free);
        let colours = (0..usize::from(HELD)).map(|index| rod_color(index, false));
        let body = Color::BLACK.towards(Color::WHITE, 0.74);
        let colours = colours.chain([rod_color(0, true), body]);
        Ok(Self {
            bodies: case.obstacles.iter().map(Body::of).collect(),
            size: options.size,
            pictures_per_second: options.pictures_per_second,
            palette: colours.map(linear).collect(),
            scale_bar: scale_bar(path.scale() / fineness, 0.2 * width, em),
            em,
            radius: 0.5 * room(case)[1].norm(),
            case,
            timeline,
            path,
        })
    }

    /// Number of its pictures.
    pub fn pictures(&self) -> usize {
        self.timeline.pictures
    }

    /// Duration of the film, s.
    pub fn seconds(&self) -> f64 {
        self.pictures() as f64 / self.pictures_per_second
    }

    /// Draws a picture into the workspace; its pixels are stored as red, green, blue by row.
    fn draw(&self, picture: usize, work: &mut Workspace) {
        let moment = self.timeline.moment(picture);
        let [from, to] = [moment.from, moment.to].map(|frame| &self.case.frames[frame].positions);
        work.positions.clear();
        let between = |(a, b): (&Vector3<f64>, &Vector3<f64>)| a + (b - a) * moment.blend;
        work.positions.extend(from.iter().zip(to).map(between));
        let camera = self.path.at(moment.part, &work.positions);
        work.solid.clear();
        self.add_rods(&camera, work);
        for body in self.bodies.iter().filter(|body| !body.hollow) {
            let corners = body.corners([moment.from, moment.to], moment.blend, &camera);
            work.solid.add_body(corners, BODY);
        }
        work.clear.clear();
        for body in self.bodies.iter().filter(|body| body.hollow) {
            let corners = body.corners([moment.from, moment.to], moment.blend, &camera);
            work.clear.add_body(corners, BODY);
        }
        work.develop(
            &self.light(&camera),
            &camera,
            &self.palette,
            &self.case.planes,
            self.radius,
        );
        self.print_labels(&moment, &mut work.pixels);
    }

    fn add_rods(&self, camera: &Camera, work: &mut Workspace) {
        let mut first = 0;
        for (index, rod) in self.case.rods.iter().enumerate() {
            let positions = &work.positions[first..first + rod.nodes];
            first += rod.nodes;
            work.nodes.clear();
            work.nodes
                .extend(positions.iter().map(|node| camera.place(node)));
            work.across.clear();
            if let Some(strip) = &rod.strip {
                let across = (0..rod.nodes).map(|node| strip.across(node, positions, rod.closed));
                work.across
                    .extend(across.map(|across| camera.turn(&across)));
            }
            let half = rod.strip.as_ref().map_or([rod.radius; 2], |strip| {
                [0.5 * strip.width, 0.5 * strip.thickness]
            });
            let radii: Vec<f32> = (rod.radii.iter())
                .map(|radius| (radius * camera.scale) as f32)
                .collect();
            work.solid.add_rod(&DrawnRod {
                nodes: &work.nodes,
                across: &work.across,
                closed: rod.closed,
                half: half.map(|half| (half * camera.scale) as f32),
                radii: if rod.strip.is_some() { &[] } else { &radii },
                material: if rod.held {
                    HELD
                } else {
                    (index % usize::from(HELD)) as u8
                },
            });
        }
    }

    /// Light from above the left shoulder of the camera.
    fn light(&self, camera: &Camera) -> Light {
        let thickness = self.case.rods.iter().map(|rod| {
            let strip = rod.strip.as_ref().map(|strip| 0.1 * strip.width);
            strip.unwrap_or(rod.radius)
        });
        let thickness = thickness.fold(0.0, f64::max) * camera.scale;
        let depth = (self.radius * camera.scale) as f32;
        Light::new(
            [-0.55, -0.8, 1.0],
            camera.turn(&Vector3::z()),
            (4.0 * thickness).clamp(5.0, 50.0) as f32,
            [0.5 * depth, -1.2 * depth],
        )
    }

    /// Prints scale bar and time.
    fn print_labels(&self, moment: &Moment, pixels: &mut [u8]) {
        let [width, height] = self.size;
        let margin = self.em.round() as usize;
        let bar = (2.2 * self.em).ceil() as usize;
        self.scale_bar.print(
            pixels,
            width,
            [margin, height.saturating_sub(bar + margin / 2)],
        );
        if let Some(label) = self.label(moment) {
            text(&label, self.em).print(pixels, width, [margin, margin / 2]);
        }
    }

    /// The text at the top: the time, or the parameter of a path of equilibria; empty for a single
    /// output.
    fn label(&self, moment: &Moment) -> Option<String> {
        if self.case.frames.len() < 2 {
            return None;
        }
        let duration = self.timeline.duration().abs();
        let digits = if duration > 0.0 {
            (2.0 - libm::log10(duration).floor()).clamp(0.0, 9.0) as usize
        } else {
            0
        };
        let number = format!("{:.digits$}", moment.time).replace('-', "−");
        Some(match self.case.branches {
            None => format!("t = {number} s"),
            Some(_) => format!("parameter {number}"),
        })
    }
}

/// A colour in linear light, 1 for white.
pub(in crate::figure) fn linear(colour: Color) -> [f32; 3] {
    colour.0.map(|channel| libm::pow(channel, 2.2) as f32)
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::View;
    use super::super::motion::{MovieFrame, MovieObstacle, MoviePlane, MovieRod};
    use super::*;

    /// A rod above a floor that makes a quarter turn in a second, with the given number of
    /// outputs.
    pub fn swinging(outputs: usize) -> MovieCase {
        let rod = MovieRod {
            name: "rod".into(),
            nodes: 9,
            closed: false,
            radius: 0.04,
            radii: Vec::new(),
            held: false,
            straight: false,
            strip: None,
        };
        let frame = |k: usize| {
            let time = 0.1 * k as f64;
            let (sine, cosine) = libm::sincos(1.5 * time);
            let point =
                |node: usize| Vector3::new(cosine, 0.2 * sine, sine) * (0.125 * node as f64);
            MovieFrame {
                time,
                positions: (0..9).map(point).collect(),
                contacts: Vec::new(),
            }
        };
        MovieCase {
            name: "main".into(),
            distinction: Vec::new(),
            parameters: Vec::new(),
            rods: vec![rod],
            planes: vec![MoviePlane {
                point: [0.0, 0.0, -0.1],
                normal: [0.0, 0.0, 1.0],
            }],
            obstacles: Vec::new(),
            view: View::oblique(),
            frames: (0..outputs).map(frame).collect(),
            fields: Vec::new(),
            series: Vec::new(),
            branches: None,
        }
    }

    pub fn options() -> FilmOptions {
        FilmOptions {
            size: [320, 180],
            pictures_per_second: 30.0,
            pace: Pace::Usual,
            from: None,
            turn: 0.0,
            zoom: 1.0,
            follow: None,
        }
    }

    /// The pixels of a picture.
    fn pixels(case: &MovieCase, options: &FilmOptions, picture: usize) -> Vec<u8> {
        let film = Film::new(case, options).unwrap();
        let mut work = Workspace::new(options.size);
        film.draw(picture, &mut work);
        work.pixels
    }

    fn is_colourful(pixel: &[u8]) -> bool {
        pixel.iter().max().unwrap() - pixel.iter().min().unwrap() > 50
    }

    /// Least and largest column and row with a colour, and the number of pixels with one.
    fn coloured(pixels: &[u8], width: usize) -> ([usize; 4], usize) {
        let seen = pixels
            .chunks_exact(3)
            .enumerate()
            .filter(|(_, pixel)| is_colourful(pixel));
        let edges = seen.clone().map(|(at, _)| [at % width, at / width]);
        let bounds = edges.fold([usize::MAX, 0, usize::MAX, 0], |bounds, [x, y]| {
            [
                bounds[0].min(x),
                bounds[1].max(x),
                bounds[2].min(y),
                bounds[3].max(y),
            ]
        });
        (bounds, seen.count())
    }

    #[test]
    fn the_whole_motion_stays_in_the_picture_from_everywhere() {
        let case = swinging(11);
        for (from, turn) in [
            (None, 0.0),
            (Some([0.7, 0.5]), 0.0),
            (Some([0.0, 0.3]), 4.0),
        ] {
            let options = FilmOptions {
                from,
                turn,
                ..options()
            };
            let film = Film::new(&case, &options).unwrap();
            let mut largest = 0;
            for picture in 0..film.pictures() {
                let (bounds, count) = coloured(&pixels(&case, &options, picture), 320);
                assert!(count > 40 && bounds[0] > 4 && bounds[1] < 315, "{bounds:?}");
                assert!(bounds[2] > 8 && bounds[3] < 165, "{bounds:?}");
                largest = largest.max(bounds[3] - bounds[2]);
            }
            assert!(largest > 70, "{largest}");
        }
    }

    #[test]
    fn zoom_magnifies_and_a_followed_rod_stays_in_the_middle() {
        let case = swinging(11);
        let close = FilmOptions {
            zoom: 0.5,
            ..options()
        };
        let [far, near] =
            [close, options()].map(|options| coloured(&pixels(&case, &options, 0), 320).1);
        let ratio = near as f64 / far as f64;
        assert!((ratio - 4.0).abs() < 0.6, "{ratio}");
        let follow = FilmOptions {
            follow: Some(0),
            ..options()
        };
        for picture in [0, 20, 49] {
            let ([left, right, top, bottom], _) = coloured(&pixels(&case, &follow, picture), 320);
            assert!((left + right).abs_diff(320) < 8, "{left} {right}");
            assert!((top + bottom).abs_diff(170) < 14, "{top} {bottom}");
        }
    }

    #[test]
    fn a_body_before_a_rod_hides_it_and_a_hollow_one_lets_it_show() {
        let mut case = swinging(1);
        let free = coloured(&pixels(&case, &options(), 0), 320).1;
        // A large sheet, seen from the front at y = −1, far in front of the rod.
        let corner = |x: f64, z: f64| Vector3::new(9.0 * x, -1.0, 9.0 * z);
        let sheet = vec![
            [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0)],
            [corner(-1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)],
        ];
        case.obstacles.push(MovieObstacle {
            triangles: sheet,
            poses: Vec::new(),
            hollow: false,
            is_carried: false,
        });
        assert_eq!(coloured(&pixels(&case, &options(), 0), 320).1, 0);
        case.obstacles[0].hollow = true;
        assert!(coloured(&pixels(&case, &options(), 0), 320).1 > free / 4);
    }

    #[test]
    fn a_rod_near_the_floor_casts_a_shadow() {
        let mut case = swinging(1);
        let options = FilmOptions {
            from: Some([0.0, 0.9]),
            ..options()
        };
        let dark = |case: &MovieCase| {
            let pixels = pixels(case, &options, 0);
            let grey = |pixel: &&[u8]| !is_colourful(pixel) && (150..225).contains(&pixel[1]);
            pixels.chunks_exact(3).filter(grey).count()
        };
        let with_shadow = dark(&case);
        case.planes.clear();
        let without = dark(&case);
        assert!(with_shadow > without + 300, "{with_shadow} {without}");
    }
}
