//! Conversion of surfaces to pixels, and of pictures to a film.

use super::super::motion::MoviePlane;
use super::camera::Camera;
use super::light::{Light, ShadowMap};
use super::mesh::{Mesh, Place, dot, minus, norm, times};
use super::samples::{NOTHING, Samples};
use super::{FINENESS, Film, FilmError};
use nalgebra::Vector3;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::{LazyLock, Mutex};

/// Number of light levels in the table of pixel brightness.
const LEVELS: usize = 4096;

/// Brightness of a pixel by its light, relative to that of white.
static BRIGHTNESS: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let light = |level: usize| level as f64 / (LEVELS - 1) as f64;
    let brightness = |level| (255.0 * libm::pow(light(level), 1.0 / 2.2)).round() as u8;
    (0..LEVELS).map(brightness).collect()
});

/// Buffers that are reused for all pictures, so that a film allocates them once per thread.
pub(super) struct Workspace {
    pub positions: Vec<Vector3<f64>>,
    pub nodes: Vec<Place>,
    pub across: Vec<Place>,
    /// Surfaces of rods and bodies; `clear` holds those of translucent bodies.
    pub solid: Mesh,
    pub clear: Mesh,
    /// The picture: red, green, blue by row.
    pub pixels: Vec<u8>,
    samples: Samples,
    clear_samples: Option<Samples>,
    shadows: ShadowMap,
}

impl Workspace {
    /// Creates the buffers for pictures of a size in pixels.
    pub fn new(size: [usize; 2]) -> Self {
        let [width, height] = size.map(|side| side * FINENESS);
        Self {
            positions: Vec::new(),
            nodes: Vec::new(),
            across: Vec::new(),
            solid: Mesh::default(),
            clear: Mesh::default(),
            pixels: vec![255; 3 * size[0] * size[1]],
            samples: Samples::new(width, height),
            clear_samples: None,
            shadows: ShadowMap::new(),
        }
    }

    /// Draws the surfaces and lights the visible ones. `radius`: that of the scene, m.
    pub fn develop(
        &mut self,
        light: &Light,
        camera: &Camera,
        palette: &[[f32; 3]],
        planes: &[MoviePlane],
        radius: f64,
    ) {
        self.samples.clear();
        self.solid.draw(&mut self.samples);
        self.shadows.look(&self.solid, light.key);
        if !self.clear.is_empty() {
            let samples = (self.clear_samples)
                .get_or_insert_with(|| Samples::new(self.samples.width, self.samples.height));
            samples.clear();
            self.clear.draw(samples);
        }
        let grounds = planes
            .iter()
            .filter_map(|plane| Ground::of(plane, camera, radius));
        let scene = Lit {
            samples: &self.samples,
            clear: (self.clear_samples.as_ref()).filter(|_| !self.clear.is_empty()),
            shadows: &self.shadows,
            light,
            palette,
            grounds: grounds.collect(),
        };
        let width = self.samples.width / FINENESS;
        for (row, pixels) in self.pixels.chunks_exact_mut(3 * width).enumerate() {
            scene.light_row(row, pixels);
        }
    }
}

/// A scene with its visible surfaces and its lighting.
struct Lit<'a> {
    samples: &'a Samples,
    clear: Option<&'a Samples>,
    shadows: &'a ShadowMap,
    light: &'a Light,
    palette: &'a [[f32; 3]],
    grounds: Vec<Ground>,
}

impl Lit<'_> {
    /// Lights a row of pixels.
    fn light_row(&self, row: usize, pixels: &mut [u8]) {
        let solid = pixels_of(self.samples, row);
        let clear = self.clear.map_or(0..0, |clear| pixels_of(clear, row));
        for (column, pixel) in pixels.chunks_exact_mut(3).enumerate() {
            let has_surface = solid.contains(&column) || clear.contains(&column);
            if !has_surface && self.grounds.is_empty() {
                pixel.fill(255);
                continue;
            }
            let light = if has_surface {
                self.pixel(column, row)
            } else {
                [self.ground(column, row); 3]
            };
            for (channel, light) in pixel.iter_mut().zip(light) {
                let level = (light.clamp(0.0, 1.0) * (LEVELS - 1) as f32 + 0.5) as usize;
                *channel = BRIGHTNESS[level];
            }
        }
    }

    /// Linear red, green, blue of a pixel that may show a surface.
    fn pixel(&self, column: usize, row: usize) -> [f32; 3] {
        let width = self.samples.width;
        let first = row * FINENESS * width + column * FINENESS;
        let corners = [first, first + 1, first + width, first + width + 1];
        let is_open = |sample: &usize| self.samples.depth[*sample] == NOTHING;
        let back = if corners.iter().any(is_open) {
            self.ground(column, row)
        } else {
            1.0
        };
        let clear = self.clear;
        if is_smooth(self.samples, corners) && clear.is_none_or(|clear| is_smooth(clear, corners)) {
            return self.shade(first, back);
        }
        let shaded = corners.map(|sample| self.shade(sample, back));
        std::array::from_fn(|k| 0.25 * shaded.iter().map(|colour| colour[k]).sum::<f32>())
    }

    /// Linear red, green, blue of a sample before a background.
    fn shade(&self, sample: usize, back: f32) -> [f32; 3] {
        let depth = self.samples.depth[sample];
        let of = |samples| (self.light).shade(samples, self.shadows, self.palette, sample);
        let colour = if depth == NOTHING {
            [back; 3]
        } else {
            of(self.samples)
        };
        let Some(clear) = self.clear.filter(|clear| clear.depth[sample] > depth) else {
            return colour;
        };
        let pale = of(clear);
        std::array::from_fn(|k| colour[k] + CLOUD * (pale[k] - colour[k]))
    }

    /// Light of the ground at a pixel.
    fn ground(&self, column: usize, row: usize) -> f32 {
        ground_light(&self.grounds, self.shadows, self.light, column, row)
    }
}

/// The pixels of a row that may show a surface.
fn pixels_of(samples: &Samples, row: usize) -> Range<usize> {
    let rows = row * FINENESS..(row + 1) * FINENESS;
    let spans = rows
        .map(|row| samples.span(row))
        .filter(|span| !span.is_empty());
    let span = spans.reduce(|a, b| a.start.min(b.start)..a.end.max(b.end));
    let span = span.unwrap_or(0..0);
    span.start / FINENESS..span.end.div_ceil(FINENESS)
}

/// Whether the samples of a pixel show one nearly flat surface, or nothing: a single sample then
/// represents all.
fn is_smooth(samples: &Samples, corners: [usize; FINENESS * FINENESS]) -> bool {
    /// Largest difference of normals between samples, in levels; there are two thousand from zero
    /// to one.
    const TURN: u32 = 60;
    /// Largest difference of depth between samples, in samples.
    const STEP: f32 = 6.0;
    let [first, rest @ ..] = corners;
    let (surface, depth) = (samples.surface[first], samples.depth[first]);
    rest.iter().all(|other| {
        let (other, at) = (samples.surface[*other], samples.depth[*other]);
        if depth == NOTHING || at == NOTHING {
            return depth == at;
        }
        let turn = |shift: u32| (surface >> shift & 0xfff).abs_diff(other >> shift & 0xfff);
        surface >> 24 == other >> 24
            && turn(12) < TURN
            && turn(0) < TURN
            && (depth - at).abs() < STEP
    })
}

/// Opacity of translucent bodies.
const CLOUD: f32 = 0.4;
/// Light reflected by the ground in the sun and in the shadow; beyond the scene it fades to white.
const SUNNY: f32 = 0.86;
const SHADY: f32 = 0.42;

/// A plane in the view, with its depth over the picture.
struct Ground {
    at: Place,
    normal: Place,
    /// Centre of the scene on the plane, and the distance from it at which the plane has faded,
    /// samples.
    middle: Place,
    reach: f32,
}

impl Ground {
    /// Creates it for a plane viewed from its front; `None` for one viewed from behind or edge-on.
    fn of(plane: &MoviePlane, camera: &Camera, radius: f64) -> Option<Self> {
        let normal = camera.turn(&plane.normal.into());
        let at = camera.place(&plane.point.into());
        let target = [camera.middle[0] as f32, camera.middle[1] as f32, 0.0];
        let height = dot(minus(target, at), normal);
        (normal[2] > 0.05).then(|| Self {
            at,
            normal,
            middle: minus(target, times(normal, height)),
            reach: (1.9 * radius * camera.scale) as f32,
        })
    }

    fn depth(&self, x: f32, y: f32) -> f32 {
        let [dx, dy] = [x - self.at[0], y - self.at[1]];
        self.at[2] - (self.normal[0] * dx + self.normal[1] * dy) / self.normal[2]
    }
}

/// Light of the nearest plane at a pixel, or of white paper if there is none.
fn ground_light(
    grounds: &[Ground],
    shadows: &ShadowMap,
    light: &Light,
    column: usize,
    row: usize,
) -> f32 {
    let [x, y] = [column, row].map(|place| (place as f32 + 0.5) * FINENESS as f32);
    let by_depth = grounds.iter().map(|ground| (ground, ground.depth(x, y)));
    let Some((ground, depth)) = by_depth.reduce(|a, b| if b.1 > a.1 { b } else { a }) else {
        return 1.0;
    };
    let at = [x, y, depth];
    let far = norm(minus(at, ground.middle)) / ground.reach;
    let fade = ((1.15 - far) / 0.7).clamp(0.0, 1.0);
    let fade = fade * fade * (3.0 - 2.0 * fade);
    if fade == 0.0 {
        return 1.0;
    }
    let lit = if dot(ground.normal, light.key) > 0.05 {
        shadows.light_on_ground(at, light, column, row)
    } else {
        1.0
    };
    1.0 - fade * (1.0 - SHADY - (SUNNY - SHADY) * lit)
}

impl Film<'_> {
    /// Draws all pictures in parallel and passes each one on in order after packing.
    ///
    /// `watch` is called with the number of pictures done, and returns whether to continue. The
    /// result is the same for any number of threads.
    pub(super) fn each_picture<P: Send>(
        &self,
        watch: &(dyn Fn(usize) -> bool + Sync),
        pack: impl Fn(&[u8]) -> P + Sync,
        mut take: impl FnMut(P) -> Result<(), FilmError> + Send,
    ) -> Result<(), FilmError> {
        let free: Mutex<Vec<Workspace>> = Mutex::default();
        let draw = |pictures: Range<usize>| -> Vec<P> {
            let one = |picture| {
                let kept = free.lock().ok().and_then(|mut free| free.pop());
                let mut work = kept.unwrap_or_else(|| Workspace::new(self.size));
                self.draw(picture, &mut work);
                let packed = pack(&work.pixels);
                if let Ok(mut free) = free.lock() {
                    free.push(work);
                }
                packed
            };
            pictures.into_par_iter().map(one).collect()
        };
        let batch = 2 * rayon::current_num_threads();
        let upto = |first: usize| first..(first + batch).min(self.pictures());
        let mut next = upto(0);
        let mut ready = draw(next.clone());
        while !ready.is_empty() {
            if !watch(next.start) {
                return Err(FilmError::Interrupted);
            }
            next = upto(next.end);
            let drawing = next.clone();
            let (drawn, taken) = rayon::join(
                || draw(drawing),
                || ready.into_iter().try_for_each(&mut take),
            );
            taken?;
            ready = drawn;
        }
        watch(self.pictures());
        Ok(())
    }

    /// Some evenly spread pictures, which are needed before the first one is passed on.
    pub(super) fn some_pictures(&self, count: usize) -> Vec<Vec<u8>> {
        let count = count.min(self.pictures());
        let last = self.pictures() - 1;
        let pictures = (0..count).into_par_iter().map(|k| {
            let mut work = Workspace::new(self.size);
            self.draw(k * last / (count - 1).max(1), &mut work);
            work.pixels
        });
        pictures.collect()
    }
}
