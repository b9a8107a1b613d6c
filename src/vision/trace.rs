//! Finds the strands in a picture.

use super::across::reach_across;
use super::centreline::{Strand, centreline};
use super::colour::{ColourRule, lab};
use super::contrast::Contrast;
use super::corner::cut_corners;
use super::crossing::crossings;
use super::doubt::doubts;
use super::joining::join_arms;
use super::labels::paint_labels;
use super::layers::layers;
use super::mask::Mask;
use super::order::{StrandCrossing, find_crossings};
use super::skeleton::Skeleton;
use super::strand::paths;
use super::strand_end::EndStops;
use super::{Point, VisionError};
use image::{GrayImage, RgbImage};

/// Options of the search for strands.
#[derive(Clone, Debug, PartialEq)]
pub struct TraceOptions {
    /// Colours of the rod.
    pub colour: ColourRule,
    /// Least number of pixels of a part of the mask; smaller parts are noise.
    pub least_area: usize,
    /// Number of pixels below which a hole of the mask is a highlight of a rod, not a loop.
    pub largest_hole: usize,
    /// Least length of a strand, in widths; shorter ones are not lines.
    pub least_slenderness: f64,
}

impl Default for TraceOptions {
    fn default() -> Self {
        Self {
            colour: ColourRule::Background,
            least_area: 60,
            largest_hole: 20,
            least_slenderness: 3.0,
        }
    }
}

/// Result of tracing a picture.
#[derive(Clone, Debug)]
pub struct Trace {
    /// Pixels of the rod.
    pub mask: Mask,
    /// The strands.
    pub strands: Vec<Strand>,
    /// Crossings of the strands.
    pub crossings: Vec<StrandCrossing>,
    /// Label image: number of the strand at each pixel, from 1; 0 is background.
    pub labels: GrayImage,
    /// Parts of the mask that are not lines: centre, length and width of each.
    pub rejected: Vec<(Point, f64, f64)>,
}

impl Trace {
    /// A strand by its number from 1; without a number, the longest one.
    pub fn strand(&self, number: Option<usize>) -> Option<&Strand> {
        let strands = self.strands.iter();
        match number {
            Some(number) => self.strands.get(number.checked_sub(1)?),
            None => strands.max_by(|a, b| a.length().total_cmp(&b.length())),
        }
    }
}

/// Largest percentage of a picture that lines may cover.
const LARGEST_COVERAGE_PERCENT: usize = 50;

/// Finds the strands of a picture.
///
/// # Errors
/// Nothing or everything looks like a rod, or no part of the mask is a line.
pub fn trace(picture: &RgbImage, options: &TraceOptions) -> Result<Trace, VisionError> {
    let contrast = Contrast::new(picture, &options.colour)?;
    trace_contrast(picture, &contrast, options)
}

/// The mask that [`trace`] uses, even if it finds nothing in it.
pub fn clean_mask(contrast: &Contrast, options: &TraceOptions) -> Mask {
    let mut mask = Mask::of_contrast(contrast);
    mask.clean(options.least_area, options.largest_hole);
    mask
}

/// Strands, and parts that are not strands.
struct Found {
    strands: Vec<Strand>,
    rejected: Vec<(Point, f64, f64)>,
}

impl Found {
    fn new(
        picture: &RgbImage,
        contrast: &Contrast,
        mask: &Mask,
        skeleton: Skeleton,
        options: &TraceOptions,
    ) -> Self {
        let colour = |point: Point| lab(picture.get_pixel(point.x as u32, point.y as u32).0);
        let (mut crossings, links) = crossings(&skeleton, colour);
        join_arms(&skeleton, &links, &mut crossings, mask, colour);
        let ends = EndStops::new(&skeleton, &crossings, colour);
        let mut strands = Vec::new();
        let mut rejected = blobs(&skeleton);
        for path in paths(&skeleton, &crossings, &links) {
            let strand = centreline(contrast, &skeleton, &path, &ends);
            let (length, width) = (strand.length(), strand.width());
            if length >= options.least_slenderness * width && strand.points.len() > 2 {
                strands.push(strand);
            } else if let Some(point) = strand.points.get(strand.points.len() / 2) {
                rejected.push((*point, length, width));
            }
        }
        reach_across(contrast, &mut strands);
        Self { strands, rejected }
    }
}

/// Parts of the mask that thinning reduces to a point: centre, length and width of each.
fn blobs(skeleton: &Skeleton) -> Vec<(Point, f64, f64)> {
    let mut is_point = vec![true; skeleton.nodes.len()];
    for node in skeleton
        .branches
        .iter()
        .filter_map(|branch| branch.nodes)
        .flatten()
    {
        is_point[node] = false;
    }
    let points = skeleton
        .nodes
        .iter()
        .zip(is_point)
        .filter(|(_, is_point)| *is_point);
    points
        .map(|(node, _)| {
            let width = 2.0 * node.half_width;
            (node.position, width, width)
        })
        .collect()
}

/// Finds the strands of a picture from a contrast image of the same size.
///
/// # Errors
/// See [`trace`].
pub fn trace_contrast(
    picture: &RgbImage,
    contrast: &Contrast,
    options: &TraceOptions,
) -> Result<Trace, VisionError> {
    let mask = clean_mask(contrast, options);
    let (found, pixels) = (mask.area(), mask.width() * mask.height());
    if found == 0 {
        return Err(VisionError::EmptyMask { found, pixels });
    }
    if 100 * found > LARGEST_COVERAGE_PERCENT * pixels {
        return Err(VisionError::FullMask {
            found,
            pixels,
            limit_percent: LARGEST_COVERAGE_PERCENT,
        });
    }
    let plain = Found::new(picture, contrast, &mask, Skeleton::new(&mask), options);
    let doubts = |found: &Found| doubts(picture, &mask, &found.strands);
    let Found { strands, rejected } = match doubts(&plain) {
        0 => plain,
        doubtful => layers(picture, &mask, options.least_area, options.largest_hole)
            .map(|masks| Skeleton::joined(masks.iter().map(Skeleton::new)))
            .map(|mut skeleton| {
                cut_corners(&mut skeleton);
                Found::new(picture, contrast, &mask, skeleton, options)
            })
            .filter(|layered| {
                let rank = |doubtful, found: &Found| (doubtful, found.strands.len());
                rank(doubts(layered), layered) <= rank(doubtful, &plain)
            })
            .unwrap_or(plain),
    };
    if strands.is_empty() {
        return Err(match rejected.first() {
            Some((point, length, width)) => VisionError::Blob {
                u: point.x,
                v: point.y,
                length: *length,
                width: *width,
            },
            None => VisionError::EmptyMask { found, pixels },
        });
    }
    let crossings = find_crossings(picture, &strands);
    let labels = paint_labels(&mask, &strands, &crossings);
    Ok(Trace {
        mask,
        strands,
        crossings,
        labels,
        rejected,
    })
}
