//! Determines from the picture which strand is on top where two strands overlap.
//!
//! Next to the overlap, each strand shows its cross-section: its colour, and the shading from edge
//! to edge. The upper strand keeps this cross-section through the overlap; the lower one does not.
//! Both strands are compared with every pixel that they share, so that strands of the same colour
//! are distinguished by their shading. Pixels of a third strand are ignored.

use super::Point;
use super::centreline::Strand;
use super::colour::lab;
use super::passage::{Passage, locate, segments, width_at};
use super::pixels::between;
use image::RgbImage;

/// Number of positions across a strand at which its colour is stored.
const LANES: usize = 9;
/// Largest number of pixels sampled across a strand; wider strands are subsampled.
const PIXELS_ACROSS: f64 = 8.0;
/// Fraction of the half width of a strand that is used, since colours mix at its edges.
const LOOKED_AT: f64 = 0.84;
/// Weight of the squared mean of the differences relative to their variance. This weight is small,
/// since a bending strand turns towards the light or away from it; if the colours differ, the mean
/// is large anyway.
const MEAN_COUNTS: f64 = 0.25;
/// Length of a strand over which its cross-section is measured, in widths; longer if other strands
/// are in the way.
const STRETCHES: [f64; 3] = [1.0, 2.0, 4.0];
/// Least number of pixels of a cross-section, relative to the number of pixels across it.
const LEAST_PIXELS: f64 = 2.0;
/// Smallest fraction of an overlap that must be free of third strands, so that the rest can be
/// ignored.
const LEAST_FREE: f64 = 0.2;

/// Colour differences between the picture on the overlap of two strands and the cross-section of
/// each strand.
pub(super) fn differences(
    picture: &RgbImage,
    strands: &[Strand],
    passages: [Passage; 2],
) -> [f64; 2] {
    let (centre, tangents) = {
        let [(a, t), (b, u)] = passages.map(|passage| locate(strands, passage));
        ((a + b) * 0.5, [t, u])
    };
    let widths = passages.map(|passage| width_at(strands, passage));
    let sine = tangents[0].perp(&tangents[1]).abs().max(0.2);
    let half_overlaps = [widths[1], widths[0]].map(|width| 0.5 * width / sine);
    let reach = |side: usize| half_overlaps[side] + widths[side] * (STRETCHES[2] + 1.0);
    let paths = [0, 1].map(|side| LocalPath::new(strands, passages[side], side, reach(side)));
    let surroundings = Surroundings::new(strands, centre, reach(0).max(reach(1)), &paths);
    let sections = [0, 1].map(|side| {
        let near = half_overlaps[side] + 1.0 + 0.1 * widths[side];
        Section::new(picture, &surroundings, &paths[side], near)
    });
    let middles = [0, 1].map(|side| paths[side].nearest(0.0));
    let narrower = widths[0].min(widths[1]);
    let half_size = half_overlaps[0].max(half_overlaps[1]) + 0.5 * widths[0].max(widths[1]);
    // For each pixel of the overlap: whether a third strand covers it, and its differences from
    // the two cross-sections.
    let mut pixels: Vec<(bool, [[f64; 3]; 2])> = Vec::new();
    for point in pixels_near(picture, centre, half_size, narrower) {
        let places = [0, 1].map(|side| paths[side].place(point, middles[side]));
        let [Some(first), Some(second)] = places else {
            continue;
        };
        let colour = colour_at(picture, point);
        let residual = |section: &Section, place| {
            let expected = section.expected(place);
            [0, 1, 2].map(|channel| colour[channel] - expected[channel])
        };
        pixels.push((
            surroundings.is_on_another(point, 0b011),
            [
                residual(&sections[0], first),
                residual(&sections[1], second),
            ],
        ));
    }
    let free = pixels.iter().filter(|(is_hidden, _)| !is_hidden).count();
    if free as f64 >= LEAST_FREE * pixels.len() as f64 {
        pixels.retain(|(is_hidden, _)| !is_hidden);
    }
    [0, 1].map(|side| misfit(pixels.iter().map(|(_, residuals)| residuals[side])))
}

/// Root mean square of residuals, with the mean weighted by [`MEAN_COUNTS`].
fn misfit(residuals: impl Iterator<Item = [f64; 3]> + Clone) -> f64 {
    let count = residuals.clone().count().max(1) as f64;
    let (mut mean, mut square) = ([0.0; 3], 0.0);
    for residual in residuals {
        for (mean, value) in mean.iter_mut().zip(residual) {
            *mean += value / count;
            square += value * value / count;
        }
    }
    let of_mean: f64 = mean.iter().map(|value| value * value).sum();
    (square - of_mean * (1.0 - MEAN_COUNTS)).max(0.0).sqrt()
}

fn colour_at(picture: &RgbImage, pixel: Point) -> [f64; 3] {
    lab(picture.get_pixel(pixel.x as u32, pixel.y as u32).0)
}

/// Pixels of a picture in a square around a point that is large enough for a strand of the given
/// width.
fn pixels_near(
    picture: &RgbImage,
    centre: Point,
    reach: f64,
    width: f64,
) -> impl Iterator<Item = Point> {
    let stride = ((width / PIXELS_ACROSS) as usize).max(1);
    let range = |x: f64, size: u32| between(x - reach, x + reach, size as usize);
    let (columns, rows) = (
        range(centre.x, picture.width()),
        range(centre.y, picture.height()),
    );
    rows.step_by(stride).flat_map(move |row| {
        let columns = columns.clone().step_by(stride);
        columns.map(move |column| Point::new(column as f64, row as f64))
    })
}

/// Position of a pixel on a strand.
#[derive(Clone, Copy, Debug)]
struct Place {
    /// Distance along the strand from the crossing, pixels.
    along: f64,
    /// Position across the strand, from -1 to 1 within the sampled part.
    across: f64,
}

/// A strand near a crossing.
struct LocalPath {
    strand: usize,
    /// Index of the strand at the crossing, 0 or 1.
    side: usize,
    /// Number of points of the whole strand.
    count: usize,
    /// Points near the crossing: numbers, positions, tangents (unit vectors), and distances along
    /// the strand from the crossing.
    points: Vec<(usize, Point, Point, f64)>,
    width: f64,
}

impl LocalPath {
    fn new(strands: &[Strand], passage: Passage, side: usize, reach: f64) -> Self {
        let strand = &strands[passage.strand];
        let count = strand.points.len();
        let step = (strand.length() / segments(strand).max(1) as f64).max(1e-3);
        let steps = ((reach / step).ceil() as i64).min(count as i64 / 2);
        let middle = passage.at.round() as i64;
        let indices = middle - steps..=middle + steps;
        let inside = indices.filter_map(|index| {
            let number = if strand.closed {
                index.rem_euclid(count as i64) as usize
            } else {
                usize::try_from(index).ok().filter(|index| *index < count)?
            };
            let along = (index as f64 - passage.at) * step;
            Some((number, strand.points[number], strand.tangent(number), along))
        });
        Self {
            strand: passage.strand,
            side,
            count,
            points: inside.collect(),
            width: width_at(strands, passage),
        }
    }

    /// Position of a pixel on the strand, by descent from one of its points; `None` if the pixel
    /// is not on the strand.
    fn place(&self, pixel: Point, start: usize) -> Option<Place> {
        let square = |index: usize| (self.points[index].1 - pixel).norm_squared();
        let mut index = start;
        let mut least = square(index);
        for forward in [true, false] {
            while let Some(next) = index
                .checked_add_signed(if forward { 1 } else { -1 })
                .filter(|next| *next < self.points.len() && square(*next) < least)
            {
                (index, least) = (next, square(next));
            }
        }
        let (_, point, tangent, along) = self.points[index];
        let offset = pixel - point;
        let place = Place {
            along: along + offset.dot(&tangent),
            across: tangent.perp(&offset) / (0.5 * LOOKED_AT * self.width),
        };
        (place.across.abs() <= 1.0 && offset.dot(&tangent).abs() < self.width).then_some(place)
    }

    /// Index in `points` of the point nearest to a distance from the crossing.
    fn nearest(&self, along: f64) -> usize {
        let behind = self.points.partition_point(|point| point.3 < along);
        behind.min(self.points.len() - 1)
    }

    /// Whether the path contains a point of a strand.
    fn has(&self, strand: usize, index: usize) -> bool {
        let first = self.points[0].0;
        // A path along a closed strand may continue from its last point to its first.
        let from_first = (index + self.count - first) % self.count;
        self.strand == strand && from_first < self.points.len()
    }
}

/// Strands that cover the pixels about a crossing.
struct Surroundings {
    first: [i64; 2],
    size: usize,
    /// Bit 0: the first strand of the crossing; bit 1: the second one; bit 2: any other strand, or
    /// more distant parts of these two.
    covers: Vec<u8>,
}

impl Surroundings {
    /// Marks the covered pixels; those of the paths belong to the strands of the crossing.
    fn new(strands: &[Strand], centre: Point, reach: f64, paths: &[LocalPath; 2]) -> Self {
        let size = 2 * reach.ceil() as usize + 3;
        let first = [centre.x, centre.y].map(|x| (x - reach).floor() as i64 - 1);
        let mut surroundings = Self {
            first,
            size,
            covers: vec![0; size * size],
        };
        for (number, strand) in strands.iter().enumerate() {
            // Points every third of a width are sufficient.
            let points = strand.points.iter().zip(&strand.widths).enumerate();
            for (index, (point, width)) in points.step_by(2) {
                let half_width = 0.5 * width + 1.0;
                if (point - centre).amax() < reach + half_width {
                    let of = |side: usize| u8::from(paths[side].has(number, index)) << side;
                    let bits = of(0) | of(1);
                    surroundings.stamp(*point, half_width, if bits == 0 { 4 } else { bits });
                }
            }
        }
        surroundings
    }

    fn stamp(&mut self, centre: Point, radius: f64, bits: u8) {
        let local = centre - Point::new(self.first[0] as f64, self.first[1] as f64);
        let range = |x: f64| between(x - radius, x + radius, self.size);
        let (columns, rows) = (range(local.x), range(local.y));
        for row in rows {
            for column in columns.clone() {
                let offset = Point::new(column as f64, row as f64) - local;
                if offset.norm_squared() < radius * radius {
                    self.covers[row * self.size + column] |= bits;
                }
            }
        }
    }

    /// Whether a pixel is on a strand other than those in `bits`.
    fn is_on_another(&self, pixel: Point, bits: u8) -> bool {
        let [column, row] = [
            pixel.x as i64 - self.first[0],
            pixel.y as i64 - self.first[1],
        ];
        let size = self.size as i64;
        let is_inside = (0..size).contains(&column) && (0..size).contains(&row);
        is_inside && self.covers[(row * size + column) as usize] & !bits != 0
    }
}

/// Colours across a strand before and behind a crossing.
struct Section {
    /// For each known side: its distance along the strand, and the colour of each lane.
    sides: Vec<(f64, [[f64; 3]; LANES])>,
}

impl Section {
    /// Samples a strand farther than `near` from the crossing.
    fn new(picture: &RgbImage, surroundings: &Surroundings, path: &LocalPath, near: f64) -> Self {
        let mut sides = Vec::new();
        for is_free_only in [true, false] {
            for sign in [-1.0, 1.0] {
                sides.extend(STRETCHES.iter().find_map(|stretch| {
                    let range = near..near + stretch * path.width;
                    side(picture, surroundings, path, sign, range, is_free_only)
                }));
            }
            if !sides.is_empty() {
                break;
            }
        }
        Self { sides }
    }

    /// The colour of the strand at a position, if the strand continues as next to the crossing.
    fn expected(&self, place: Place) -> [f64; 3] {
        let lane = (place.across + 1.0) * 0.5 * (LANES - 1) as f64;
        let index = (lane as usize).min(LANES - 2);
        let part = lane - index as f64;
        let colour = |lanes: &[[f64; 3]; LANES]| mix(lanes[index], lanes[index + 1], part);
        match &self.sides[..] {
            [] => [f64::INFINITY; 3],
            [(_, only)] => colour(only),
            [(begin, before), (end, behind), ..] => {
                let t = ((place.along - begin) / (end - begin)).clamp(0.0, 1.0);
                mix(colour(before), colour(behind), t)
            }
        }
    }
}

fn mix(a: [f64; 3], b: [f64; 3], t: f64) -> [f64; 3] {
    [0, 1, 2].map(|channel| a[channel] * (1.0 - t) + b[channel] * t)
}

/// One side of a cross-section; `None` if too few pixels are free.
fn side(
    picture: &RgbImage,
    surroundings: &Surroundings,
    path: &LocalPath,
    sign: f64,
    range: std::ops::Range<f64>,
    is_free_only: bool,
) -> Option<(f64, [[f64; 3]; LANES])> {
    let inside = path
        .points
        .iter()
        .filter(|(_, _, _, along)| range.contains(&(sign * along)));
    let points: Vec<Point> = inside.map(|(_, point, _, _)| *point).collect();
    let start = path.nearest(sign * 0.5 * (range.start + range.end));
    let middle = points.iter().sum::<Point>() / points.len().max(1) as f64;
    let farthest = points.iter().map(|point| (point - middle).norm());
    let reach = farthest.fold(0.0, f64::max) + 0.5 * path.width;
    let (mut sums, mut weights) = ([[0.0; 3]; LANES], [0.0; LANES]);
    let (mut along, mut count) = (0.0, 0.0);
    if points.is_empty() {
        return None;
    }
    for pixel in pixels_near(picture, middle, reach, path.width) {
        let Some(place) = path.place(pixel, start) else {
            continue;
        };
        if !range.contains(&(sign * place.along))
            || is_free_only && surroundings.is_on_another(pixel, 1 << path.side)
        {
            continue;
        }
        let colour = colour_at(picture, pixel);
        let lane = (place.across + 1.0) * 0.5 * (LANES - 1) as f64;
        let index = (lane as usize).min(LANES - 2);
        for (index, weight) in [
            (index, 1.0 - lane + index as f64),
            (index + 1, lane - index as f64),
        ] {
            weights[index] += weight;
            for (sum, value) in sums[index].iter_mut().zip(colour) {
                *sum += weight * value;
            }
        }
        along += place.along;
        count += 1.0;
    }
    if count < LEAST_PIXELS * path.width.min(PIXELS_ACROSS) {
        return None;
    }
    // Lanes without pixels get the colour of the nearest lane with pixels.
    let known: Vec<usize> = (0..LANES).filter(|lane| weights[*lane] > 0.2).collect();
    let lanes = std::array::from_fn(|lane| {
        let nearest = known.iter().min_by_key(|other| lane.abs_diff(**other));
        nearest.map_or([0.0; 3], |other| {
            sums[*other].map(|sum| sum / weights[*other])
        })
    });
    (!known.is_empty()).then_some((along / count, lanes))
}
