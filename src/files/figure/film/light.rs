//! Lighting of visible surfaces: a sky and a ground, a key light with soft shadows, and ambient
//! occlusion.

use super::mesh::{Mesh, Place, cross, dot, norm, plus, times, unit};
use super::samples::{Corner, NOTHING, Samples, unpacked};

/// Side of the shadow map, in its samples.
const MAP: usize = 1400;
/// Sample points of the ambient occlusion: a spiral in the unit disk (Vogel 1979).
const TAPS: usize = 16;
/// Number of rotations of the spiral from sample to sample, to avoid visible patterns.
const TURNS: usize = 16;

/// Fading towards white at the back, 0 to 1.
const HAZE: f32 = 0.2;

/// Directions of the light in the axes of a picture, and range of the ambient occlusion.
pub(super) struct Light {
    /// Unit vector towards the key light.
    pub key: Place,
    /// Unit vector upwards in the scene.
    pub sky: Place,
    /// Distance within which surfaces occlude the sky, samples.
    pub reach: f32,
    /// Depth over which colours fade, from the nearest to the farthest, samples.
    pub haze: [f32; 2],
    spiral: [[[f32; 2]; TAPS]; TURNS],
    halfway: Place,
}

impl Light {
    pub fn new(key: Place, sky: Place, reach: f32, haze: [f32; 2]) -> Self {
        let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
        let tap = |turn: usize, tap: usize| {
            let angle = golden * tap as f64 + std::f64::consts::TAU * turn as f64 / TURNS as f64;
            let distance = ((tap as f64 + 0.5) / TAPS as f64).sqrt();
            let (sine, cosine) = libm::sincos(angle);
            [(distance * cosine) as f32, (distance * sine) as f32]
        };
        let key = unit(key);
        Self {
            key,
            sky: unit(sky),
            reach,
            haze,
            spiral: std::array::from_fn(|turn| std::array::from_fn(|k| tap(turn, k))),
            halfway: unit(plus(key, [0.0, 0.0, 1.0])),
        }
    }

    fn taps(&self, column: usize, row: usize) -> &[[f32; 2]; TAPS] {
        // An ordered dither of four by four.
        const ORDER: [usize; TURNS] = [0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5];
        &self.spiral[ORDER[(row & 3) * 4 + (column & 3)]]
    }

    /// Linear red, green, blue of a sample.
    pub fn shade(
        &self,
        samples: &Samples,
        shadows: &ShadowMap,
        palette: &[[f32; 3]],
        sample: usize,
    ) -> [f32; 3] {
        let (column, row) = (sample % samples.width, sample / samples.width);
        let (material, normal) = unpacked(samples.surface[sample]);
        let at = [column as f32 + 0.5, row as f32 + 0.5, samples.depth[sample]];
        let base = palette[usize::from(material) % palette.len()];
        let taps = self.taps(column, row);
        let lit = dot(normal, self.key).max(0.0);
        let lit = if lit > 0.0 {
            lit * shadows.light(at, normal, taps)
        } else {
            0.0
        };
        let open = self.openness(samples, at, normal, taps, column, row);
        let sky = 0.5 + 0.5 * dot(normal, self.sky);
        let shine = dot(normal, self.halfway).max(0.0);
        // To the 64th power.
        let shine = (0..6).fold(shine, |power, _| power * power);
        // Surfaces that turn away from the eye are darker, which separates crossing rods.
        let rim = 0.55 + 0.45 * smooth(normal[2] / 0.5);
        let diffuse = (open * (0.22 + 0.3 * sky) + 0.72 * lit) * rim;
        let far = smooth((self.haze[0] - at[2]) / (self.haze[0] - self.haze[1]).max(1e-6));
        let gleam = 0.22 * shine * lit;
        base.map(|channel| {
            let colour = channel * diffuse + gleam;
            colour + HAZE * far * (1.0 - colour)
        })
    }

    /// The share of the sky that nearby surfaces do not hide.
    fn openness(
        &self,
        samples: &Samples,
        at: Place,
        normal: Place,
        taps: &[[f32; 2]; TAPS],
        column: usize,
        row: usize,
    ) -> f32 {
        let mut hidden = 0.0;
        for [x, y] in taps {
            let dx = (x * self.reach) as isize;
            let dy = (y * self.reach) as isize;
            let (Some(column), Some(row)) =
                (column.checked_add_signed(dx), row.checked_add_signed(dy))
            else {
                continue;
            };
            if column >= samples.width || row >= samples.height {
                continue;
            }
            let depth = samples.depth[row * samples.width + column];
            if depth == NOTHING {
                continue;
            }
            let from = [dx as f32, dy as f32, depth - at[2]];
            let squared = dot(from, from);
            let rise = dot(from, normal);
            if rise > 0.12 * self.reach.min(norm(from)) {
                let near = 1.0 / (1.0 + squared / (self.reach * self.reach));
                hidden += rise / squared.max(1e-6).sqrt() * near;
            }
        }
        (1.0 - 1.5 * hidden / TAPS as f32).max(0.25)
    }
}

fn smooth(x: f32) -> f32 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

/// The view of the key light: nearness to the light, over the axes of its own picture.
pub(super) struct ShadowMap {
    samples: Samples,
    /// Right, down and towards the light.
    axes: [Place; 3],
    /// Origin of the map, and number of its samples per sample of the picture.
    origin: [f32; 2],
    scale: f32,
}

impl ShadowMap {
    pub fn new() -> Self {
        Self {
            samples: Samples::new(MAP, MAP),
            axes: [[0.0; 3]; 3],
            origin: [0.0; 2],
            scale: 1.0,
        }
    }

    /// Draws the shadow map of a surface.
    pub fn look(&mut self, mesh: &Mesh, key: Place) {
        let aside = if key[1].abs() < 0.9 {
            [0.0, 1.0, 0.0]
        } else {
            [1.0, 0.0, 0.0]
        };
        let right = unit(cross(aside, key));
        self.axes = [right, cross(key, right), key];
        let (mut low, mut high) = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2]);
        for place in mesh.places() {
            for k in 0..2 {
                let coordinate = dot(self.axes[k], place);
                low[k] = low[k].min(coordinate);
                high[k] = high[k].max(coordinate);
            }
        }
        let extent = (high[0] - low[0]).max(high[1] - low[1]);
        // Half the resolution of the picture is enough, because shadows are soft.
        self.scale = ((MAP - 8) as f32 / extent.max(1.0)).min(0.6);
        self.origin = [0, 1].map(|k| low[k] - 4.0 / self.scale);
        self.samples.clear();
        mesh.each_triangle(|places| {
            let [a, b, c] = places.map(|place| Corner {
                at: self.seen(place),
                normal: [0.0, 0.0, 1.0],
            });
            self.samples.fill([&a, &b, &c], 0, false);
        });
    }

    /// Converts a position of the picture to one of the map.
    fn seen(&self, place: Place) -> Place {
        let [x, y, z] = self.axes.map(|axis| dot(axis, place));
        [
            (x - self.origin[0]) * self.scale,
            (y - self.origin[1]) * self.scale,
            z,
        ]
    }

    fn depth(&self, x: f32, y: f32) -> f32 {
        // Negative numbers become zero.
        let (column, row) = (x as usize, y as usize);
        if x >= 0.0 && y >= 0.0 && column < MAP && row < MAP {
            self.samples.depth[row * MAP + column]
        } else {
            NOTHING
        }
    }

    /// The share of the key light that reaches a point of a surface.
    pub fn light(&self, at: Place, normal: Place, taps: &[[f32; 2]; TAPS]) -> f32 {
        // The map is coarse, so an offset keeps a surface from shadowing itself.
        let offset = 2.2 / self.scale;
        let at = self.seen(plus(at, times(normal, offset)));
        let hidden = taps
            .iter()
            .filter(|[x, y]| self.depth(at[0] + 2.0 * x, at[1] + 2.0 * y) > at[2] + 0.5 * offset);
        1.0 - hidden.count() as f32 / TAPS as f32
    }

    /// The share of the key light that reaches a point of the ground. Shadows are sharper near the
    /// surface that casts them.
    pub fn light_on_ground(&self, at: Place, light: &Light, column: usize, row: usize) -> f32 {
        /// Ratio of the width of the penumbra to the distance.
        const SOFTNESS: f32 = 0.16;
        /// Largest width of the penumbra, samples of the map.
        const WIDEST: f32 = 26.0;
        let taps = light.taps(column, row);
        let at = self.seen(at);
        let reaches = |place: f32| place > -WIDEST && place < MAP as f32 + WIDEST;
        if !reaches(at[0]) || !reaches(at[1]) {
            return 1.0;
        }
        let (mut count, mut above) = (0, 0.0);
        for [x, y] in taps {
            let depth = self.depth(at[0] + WIDEST * x, at[1] + WIDEST * y);
            if depth > at[2] {
                count += 1;
                above += depth - at[2];
            }
        }
        if count == 0 {
            return 1.0;
        }
        let width = (SOFTNESS * self.scale * above / count as f32).clamp(1.2, WIDEST);
        let hidden = taps
            .iter()
            .filter(|[x, y]| self.depth(at[0] + width * x, at[1] + width * y) > at[2]);
        1.0 - hidden.count() as f32 / TAPS as f32
    }
}
