//! Rendered pictures of rods on a table, for tests and for cells without a real camera.
//!
//! Rods are shaded tubes with a depth buffer; they cast shadows on the table and on the rods
//! below. The colour of the table is a function of the place, so that sheets, drawings and
//! checkerboards can be rendered. Details narrower than half a pixel may be missed. Not rendered:
//! light reflected between rods, gloss, and depth of field.

use super::Point;
use super::camera::Camera;
use super::pixels::between;
use image::{Rgb, RgbImage};
use nalgebra::Vector3;

/// A rod to be rendered.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderedRod {
    /// Points of the centreline, metres; closer together than its radius.
    pub points: Vec<Vector3<f64>>,
    /// Radius, metres.
    pub radius: f64,
    /// Colour, sRGB.
    pub colour: [u8; 3],
}

/// Light, and noise and blur of the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderOptions {
    /// Direction towards the light.
    pub light: Vector3<f64>,
    /// Ambient light, 0 to 1; the rest is directional.
    pub ambient: f64,
    /// Fraction of the light that shadows remove, 0 to 1.
    pub shadow: f64,
    /// Standard deviation of the noise of each channel, out of 255.
    pub noise: f64,
    /// Number of rounds of a binomial blur of 3 × 3 pixels.
    pub blur: usize,
    /// Seed of the noise.
    pub seed: u64,
}

impl Default for RenderOptions {
    fn default() -> Self {
        Self {
            light: Vector3::new(0.3, 0.4, 1.0),
            ambient: 0.45,
            shadow: 0.5,
            noise: 2.0,
            blur: 1,
            seed: 1,
        }
    }
}

/// Samples along each side of a pixel.
const SAMPLES: usize = 3;
/// Number of table lookups along each side of a sample.
const FINE: usize = 3;
/// Largest colour difference between the corners and the middle of a plain pixel, out of 255. One
/// lookup is enough for a plain pixel.
const PLAIN: f64 = 1.5;

/// Number of rows of pixels that are rendered together, so that their samples stay in the cache.
const BAND: usize = 16;

/// Renders rods above the table of a camera. `ground` is the colour, sRGB from 0 to 255, of the table at x, y.
pub fn render(
    camera: &Camera,
    rods: &[RenderedRod],
    ground: impl Fn(Point) -> [f64; 3],
    options: &RenderOptions,
) -> RgbImage {
    let light = options.light.normalize();
    let shadows = shadows(camera, rods, &light, options.shadow);
    let tubes: Vec<Tube> = rods
        .iter()
        .flat_map(|rod| tubes(camera, rod, rods, &light, options))
        .collect();
    let mut picture = Picture::new(camera);
    // A regular grid of lookups would shift edges along it by a fraction of a pixel.
    let mut jitter = Noise(!options.seed);
    let mut canvas = Canvas::new(camera);
    for first in (0..picture.height).step_by(BAND) {
        canvas.begin(first, BAND.min(picture.height - first));
        canvas.paint_ground(camera, &ground, &mut jitter);
        canvas.shade_ground(&shadows, options.shadow);
        for tube in &tubes {
            canvas.paint_tube(tube, &light, options.ambient);
        }
        canvas.average_into(&mut picture);
    }
    picture.develop(options)
}

/// The shadow of a point of a rod on the table; lengths in samples.
struct Shadow {
    centre: Point,
    radius: f64,
    /// Half of the width of its edge.
    soft: f64,
}

/// The shadows of rods on the table.
fn shadows(
    camera: &Camera,
    rods: &[RenderedRod],
    light: &Vector3<f64>,
    shadow: f64,
) -> Vec<Shadow> {
    if light.z <= 0.0 || shadow <= 0.0 {
        return Vec::new();
    }
    let of_point = |rod: &RenderedRod, point: &Vector3<f64>| {
        let height = point.z - camera.table_height;
        let foot = point - light * (height / light.z);
        let centre = camera.project(foot)?;
        let side = camera.project(foot + Vector3::x() * rod.radius)?;
        let radius = (side - centre).norm() * SAMPLES as f64;
        Some(Shadow {
            centre: on_samples(centre),
            radius,
            // Penumbrae are wider for higher rods.
            soft: radius * (0.2 + height / rod.radius * 0.05),
        })
    };
    let points = rods.iter().flat_map(|rod| {
        let points = rod.points.iter();
        points.filter_map(move |point| of_point(rod, point))
    });
    points.collect()
}

/// A piece of a rod in the picture; lengths in samples where not said otherwise.
struct Tube {
    centre: Point,
    radius: f64,
    /// Direction across the piece.
    across: Point,
    /// From its start to its end.
    along: Point,
    /// Distance of its middle from the camera, m.
    depth: f64,
    /// Radius, m.
    thickness: f64,
    /// Directions across the piece in the cell: in the picture, and towards the camera.
    side: Vector3<f64>,
    view: Vector3<f64>,
    /// Fraction of the light that reaches it.
    lit: f64,
    colour: [u8; 3],
}

/// The visible pieces of a rod, one for each pair of its points.
fn tubes(
    camera: &Camera,
    rod: &RenderedRod,
    rods: &[RenderedRod],
    light: &Vector3<f64>,
    options: &RenderOptions,
) -> Vec<Tube> {
    let of_pair = |pair: &[Vector3<f64>]| {
        let (from, to) = (pair[0], pair[1]);
        let middle = (from + to) * 0.5;
        let (a, b) = (camera.project(from)?, camera.project(to)?);
        let axis = (to - from).try_normalize(1e-15).unwrap_or(Vector3::x());
        let towards = (camera.pose.translation.vector - middle).normalize();
        let view = (towards - axis * towards.dot(&axis)).normalize();
        let side = axis.cross(&view);
        let edge = camera.project(middle + side * rod.radius)?;
        let centre = (a + b) * 0.5;
        Some(Tube {
            centre: on_samples(centre),
            radius: (edge - centre).norm() * SAMPLES as f64,
            across: (edge - centre).normalize(),
            along: (b - a) * SAMPLES as f64,
            depth: camera.pose.inverse_transform_point(&middle.into()).z,
            thickness: rod.radius,
            side,
            view,
            lit: 1.0 - options.shadow * covered(middle, rod, rods, light),
            colour: rod.colour,
        })
    };
    rod.points.windows(2).filter_map(of_pair).collect()
}

/// A place in pixels as one in samples.
fn on_samples(pixel: Point) -> Point {
    let sample = |pixel: f64| (pixel + 0.5) * SAMPLES as f64 - 0.5;
    Point::new(sample(pixel.x), sample(pixel.y))
}

/// Samples of a band of the picture, [`SAMPLES`]² per pixel. Averages are linear in sRGB values.
struct Canvas {
    /// Samples in a row.
    width: usize,
    /// The first row of pixels.
    first: usize,
    /// Number of rows of pixels.
    rows: usize,
    colours: Vec<[f32; 3]>,
    depths: Vec<f32>,
    shades: Vec<f32>,
}

impl Canvas {
    fn new(camera: &Camera) -> Self {
        let width = camera.width as usize * SAMPLES;
        let samples = width * SAMPLES * BAND;
        Self {
            width,
            first: 0,
            rows: 0,
            colours: vec![[0.0; 3]; samples],
            depths: vec![f32::INFINITY; samples],
            shades: vec![0.0; samples],
        }
    }

    /// Empties the canvas for a number of rows of pixels.
    fn begin(&mut self, first: usize, rows: usize) {
        (self.first, self.rows) = (first, rows);
        self.colours.fill([0.0; 3]);
        self.depths.fill(f32::INFINITY);
    }

    fn paint_ground(
        &mut self,
        camera: &Camera,
        ground: &impl Fn(Point) -> [f64; 3],
        jitter: &mut Noise,
    ) {
        // Coordinates on the table are bilinear between the corners of a pixel.
        let corners_along = camera.width as usize + 1;
        let corner = |index: usize| {
            let (column, row) = (index % corners_along, self.first + index / corners_along);
            let pixel = Point::new(column as f64 - 0.5, row as f64 - 0.5);
            let place = camera.on_table(pixel).ok()?;
            Some((place, ground(place)))
        };
        let corners: Vec<Option<(Point, [f64; 3])>> =
            (0..corners_along * (self.rows + 1)).map(corner).collect();
        for row in 0..self.rows {
            for column in 0..camera.width as usize {
                let first = row * corners_along + column;
                let below = first + corners_along;
                let (Some(a), Some(b), Some(c), Some(d)) = (
                    corners[first],
                    corners[first + 1],
                    corners[below],
                    corners[below + 1],
                ) else {
                    continue;
                };
                let place = |s: f64, t: f64| {
                    (a.0 * (1.0 - s) + b.0 * s) * (1.0 - t) + (c.0 * (1.0 - s) + d.0 * s) * t
                };
                let middle = ground(place(0.5, 0.5));
                let plain = [a.1, b.1, c.1, d.1].iter().all(|corner| {
                    corner
                        .iter()
                        .zip(middle)
                        .all(|(x, y)| (x - y).abs() < PLAIN)
                });
                for sample in 0..SAMPLES * SAMPLES {
                    let (i, j) = (sample % SAMPLES, sample / SAMPLES);
                    let colour = if plain {
                        middle
                    } else {
                        mean_colour(jitter, |s, t| {
                            let part = |index: usize, within: f64| {
                                (index as f64 + within) / SAMPLES as f64
                            };
                            ground(place(part(i, s), part(j, t)))
                        })
                    };
                    let index = (row * SAMPLES + j) * self.width + column * SAMPLES + i;
                    self.colours[index] = colour.map(|channel| channel as f32);
                }
            }
        }
    }

    /// Darkens the table where rods hide the light.
    fn shade_ground(&mut self, shadows: &[Shadow], shadow: f64) {
        if shadows.is_empty() {
            return;
        }
        let mut shades = std::mem::take(&mut self.shades);
        shades.fill(0.0);
        for Shadow {
            centre,
            radius,
            soft,
        } in shadows
        {
            self.each_near(*centre, radius + soft, |index, distance, _| {
                let dark = ((radius + soft - distance) / (2.0 * soft)).clamp(0.0, 1.0);
                shades[index] = shades[index].max(dark as f32);
            });
        }
        for (colour, shade) in self.colours.iter_mut().zip(&shades) {
            *colour = colour.map(|channel| channel * (1.0 - shadow as f32 * shade));
        }
        self.shades = shades;
    }

    fn paint_tube(&mut self, tube: &Tube, light: &Vector3<f64>, ambient: f64) {
        let reach = tube.radius + tube.along.norm();
        let mut found = Vec::new();
        self.each_near(tube.centre, reach, |index, _, offset| {
            let t = offset.dot(&tube.across) / tube.radius;
            let s = offset.dot(&tube.along) / tube.along.norm_squared().max(1e-12);
            if t.abs() < 1.0 && s.abs() <= 0.75 {
                found.push((index, t));
            }
        });
        for (index, t) in found {
            let rise = (1.0 - t * t).sqrt();
            let nearest = (tube.depth - tube.thickness * rise) as f32;
            if nearest >= self.depths[index] {
                continue;
            }
            let normal = tube.side * t + tube.view * rise;
            let direct = normal.dot(light).max(0.0) * tube.lit;
            let brightness = ambient + (1.0 - ambient) * direct;
            self.depths[index] = nearest;
            self.colours[index] = tube.colour.map(|c| (f64::from(c) * brightness) as f32);
        }
    }

    /// Calls `visit` with the index of all samples near a place, their distance and their offset from it; all
    /// in samples.
    fn each_near(&self, centre: Point, reach: f64, mut visit: impl FnMut(usize, f64, Point)) {
        let first = self.first * SAMPLES;
        let rows = between(
            centre.y - reach,
            centre.y + reach,
            first + self.rows * SAMPLES,
        );
        for row in rows.start.max(first)..rows.end {
            for column in between(centre.x - reach, centre.x + reach, self.width) {
                let offset = Point::new(column as f64, row as f64) - centre;
                let distance = offset.norm();
                if distance <= reach {
                    visit((row - first) * self.width + column, distance, offset);
                }
            }
        }
    }

    /// Averages the samples of each pixel.
    fn average_into(&self, picture: &mut Picture) {
        for row in 0..self.rows {
            for column in 0..picture.width {
                let mut mean = [0.0; 3];
                for sample in 0..SAMPLES * SAMPLES {
                    let (i, j) = (sample % SAMPLES, sample / SAMPLES);
                    let index = (row * SAMPLES + j) * self.width + column * SAMPLES + i;
                    for (mean, channel) in mean.iter_mut().zip(self.colours[index]) {
                        *mean += f64::from(channel) / (SAMPLES * SAMPLES) as f64;
                    }
                }
                let pixel = (self.first + row) * picture.width + column;
                for (plane, mean) in picture.planes.iter_mut().zip(mean) {
                    plane[pixel] = mean;
                }
            }
        }
    }
}

/// Mean colours of the pixels, one plane per channel.
struct Picture {
    width: usize,
    height: usize,
    planes: [Vec<f64>; 3],
}

impl Picture {
    fn new(camera: &Camera) -> Self {
        let (width, height) = (camera.width as usize, camera.height as usize);
        Self {
            width,
            height,
            planes: [(); 3].map(|()| vec![0.0; width * height]),
        }
    }

    /// Adds blur and noise.
    fn develop(mut self, options: &RenderOptions) -> RgbImage {
        let (width, height) = (self.width, self.height);
        for plane in &mut self.planes {
            for _ in 0..options.blur {
                binomial(plane, width, height);
            }
        }
        let mut noise = Noise(options.seed);
        RgbImage::from_fn(width as u32, height as u32, |u, v| {
            let pixel = v as usize * width + u as usize;
            Rgb([0, 1, 2].map(|channel| {
                let value = self.planes[channel][pixel] + options.noise * noise.normal();
                value.round().clamp(0.0, 255.0) as u8
            }))
        })
    }
}

/// Mean of [`FINE`]² lookups, one at a random place in each part of the unit square.
fn mean_colour(jitter: &mut Noise, look: impl Fn(f64, f64) -> [f64; 3]) -> [f64; 3] {
    let mut mean = [0.0; 3];
    for fine in 0..FINE * FINE {
        let mut part = |index: usize| (index as f64 + jitter.uniform()) / FINE as f64;
        let (s, t) = (part(fine % FINE), part(fine / FINE));
        for (mean, channel) in mean.iter_mut().zip(look(s, t)) {
            *mean += channel / (FINE * FINE) as f64;
        }
    }
    mean
}

/// Fraction of the light that rods hide from a point of a rod.
fn covered(
    point: Vector3<f64>,
    rod: &RenderedRod,
    rods: &[RenderedRod],
    light: &Vector3<f64>,
) -> f64 {
    let mut most = 0.0f64;
    for other in rods {
        // A coarse step is sufficient, since shadows are soft.
        let step = (other.points.len() / 400).max(1);
        for above in other.points.iter().step_by(step) {
            let way = above - point;
            let height = way.dot(light);
            if height < 1.2 * rod.radius {
                continue;
            }
            let beside = (way - light * height).norm();
            let dark = (1.5 * other.radius - beside) / other.radius;
            most = most.max(dark.clamp(0.0, 1.0));
        }
    }
    most
}

fn binomial(plane: &mut [f64], width: usize, height: usize) {
    let old = plane.to_vec();
    let at = |row: usize, column: usize| old[row * width + column];
    for row in 0..height {
        for column in 0..width {
            let rows = [row.saturating_sub(1), row, (row + 1).min(height - 1)];
            let columns = [
                column.saturating_sub(1),
                column,
                (column + 1).min(width - 1),
            ];
            let mut sum = 0.0;
            for (r, wr) in rows.into_iter().zip([1.0, 2.0, 1.0]) {
                for (c, wc) in columns.into_iter().zip([1.0, 2.0, 1.0]) {
                    sum += wr * wc * at(r, c);
                }
            }
            plane[row * width + column] = sum / 16.0;
        }
    }
}

/// Random numbers by SplitMix64 (Steele, Lea and Flood, OOPSLA 2014).
struct Noise(u64);

impl Noise {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A normally distributed number, by the Box–Muller method.
    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * libm::log(1.0 - self.uniform())).sqrt();
        radius * libm::cos(std::f64::consts::TAU * self.uniform())
    }
}
