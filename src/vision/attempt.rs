//! One attempt to find strands in given masks.

use super::across::reach_across;
use super::centreline::{Strand, centreline};
use super::colour::lab;
use super::contrast::{Contrast, union};
use super::corner::cut_corners;
use super::crossing::crossings;
use super::doubt::{MOST_STRANDS, Signs, doubts};
use super::fitness::{Fitness, fitness};
use super::joining::join_arms;
use super::kink::{KinkRule, split_at_kinks};
use super::layers::layers;
use super::mask::Mask;
use super::options::TraceOptions;
use super::skeleton::Skeleton;
use super::stem::share_stems;
use super::strand::paths;
use super::strand_end::EndStops;
use super::{Point, VisionError};
use image::RgbImage;

/// Largest percentage of a picture that lines may cover.
const LARGEST_COVERAGE_PERCENT: usize = 50;
/// Largest number of branches of a skeleton; more mean that the mask is noise.
const MOST_BRANCHES: usize = 800;

/// Whether a strand may turn sharply.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Corners {
    /// A strand may have a corner, as a drawn line.
    Keep,
    /// Strands of a given colour touch at corners.
    Split(KinkRule),
}

/// What was found in masks.
pub(super) struct Attempt {
    pub mask: Mask,
    pub strands: Vec<Strand>,
    /// One for each strand.
    pub fitness: Vec<Fitness>,
    /// Parts of the mask that are not strands: centre, length and width of each.
    pub rejected: Vec<(Point, f64, f64)>,
    /// Signs that strands were joined or divided incorrectly.
    pub signs: Signs,
}

impl Attempt {
    /// Finds the strands in one contrast image for each colour rule. Gaps are closed where pixels
    /// of `cover` hide a strand.
    pub fn new(
        picture: &RgbImage,
        contrasts: &[Contrast],
        cover: Option<&Mask>,
        corners: Corners,
        options: &TraceOptions,
    ) -> Result<Self, VisionError> {
        let clean = |contrast: &Contrast| {
            let mut mask = Mask::of_contrast(contrast);
            mask.clean(options.least_area, options.largest_hole);
            mask
        };
        let whole = if contrasts.len() > 1 {
            union(contrasts)
        } else {
            None
        };
        let Some(contrast) = whole.as_ref().or(contrasts.first()) else {
            return Err(VisionError::EmptyMask {
                found: 0,
                pixels: 0,
            });
        };
        let mask = clean(contrast);
        check_coverage(&mask)?;
        let hidden = cover.map_or_else(|| mask.clone(), |cover| mask.with(cover));
        let follow = |skeleton| {
            let mut found = Found::new(picture, contrast, &hidden, skeleton, options);
            // More strands are noise.
            if let Corners::Split(rule) = corners
                && found.strands.len() <= MOST_STRANDS
            {
                let stems = share_stems(contrast, &mut found.strands);
                let kinks = split_at_kinks(contrast, &mut found.strands, rule);
                found.touching = 2 * (stems + kinks);
            }
            found
        };
        let doubts = |found: &Found| Signs {
            touching: found.touching,
            ..doubts(picture, &mask, &found.strands)
        };
        let (found, signs) = if contrasts.len() > 1 {
            let skeletons: Vec<Skeleton> = contrasts
                .iter()
                .map(|contrast| Skeleton::new(&clean(contrast)))
                .collect();
            let skeleton = Skeleton::joined(skeletons);
            check_branches(&skeleton)?;
            let found = follow(skeleton);
            let signs = doubts(&found);
            (found, signs)
        } else {
            let skeleton = Skeleton::new(&mask);
            check_branches(&skeleton)?;
            let plain = follow(skeleton);
            match doubts(&plain) {
                signs if signs.count() == 0 => (plain, signs),
                signs => layers(picture, &mask, options.least_area, options.largest_hole)
                    .map(|masks| Skeleton::joined(masks.iter().map(Skeleton::new)))
                    .map(|mut skeleton| {
                        cut_corners(&mut skeleton);
                        let layered = follow(skeleton);
                        let signs = doubts(&layered);
                        (layered, signs)
                    })
                    .filter(|(layered, fewer)| {
                        let rank =
                            |signs: Signs, found: &Found| (signs.count(), found.strands.len());
                        rank(*fewer, layered) <= rank(signs, &plain)
                    })
                    .unwrap_or((plain, signs)),
            }
        };
        let Found {
            strands, rejected, ..
        } = found;
        if strands.is_empty() {
            return Err(match rejected.first() {
                Some((point, length, width)) => VisionError::Blob {
                    u: point.x,
                    v: point.y,
                    length: *length,
                    width: *width,
                },
                None => empty(&mask),
            });
        }
        if strands.len() > MOST_STRANDS && options.strands.is_none() {
            return Err(VisionError::Noise {
                lines: strands.len(),
            });
        }
        Ok(Self {
            fitness: fitness(contrast, &strands),
            mask,
            strands,
            rejected,
            signs,
        })
    }

    /// Keeps the strands with the given numbers, in their order; the others are listed as rejected.
    pub fn keep(&mut self, is_kept: impl Fn(usize) -> bool) {
        let strands = std::mem::take(&mut self.strands);
        let fitness = std::mem::take(&mut self.fitness);
        for (number, (strand, fitness)) in strands.into_iter().zip(fitness).enumerate() {
            if is_kept(number) {
                self.strands.push(strand);
                self.fitness.push(fitness);
            } else if let Some(middle) = strand.points.get(strand.points.len() / 2) {
                self.rejected
                    .push((*middle, strand.length(), strand.width()));
            }
        }
    }
}

fn empty(mask: &Mask) -> VisionError {
    VisionError::EmptyMask {
        found: mask.area(),
        pixels: mask.width() * mask.height(),
    }
}

fn check_coverage(mask: &Mask) -> Result<(), VisionError> {
    let (found, pixels) = (mask.area(), mask.width() * mask.height());
    if found == 0 {
        return Err(empty(mask));
    }
    if 100 * found > LARGEST_COVERAGE_PERCENT * pixels {
        return Err(VisionError::FullMask {
            found,
            pixels,
            limit_percent: LARGEST_COVERAGE_PERCENT,
        });
    }
    Ok(())
}

fn check_branches(skeleton: &Skeleton) -> Result<(), VisionError> {
    let lines = skeleton.branches.len();
    if lines > MOST_BRANCHES {
        return Err(VisionError::Noise { lines });
    }
    Ok(())
}

/// Strands, and parts that are not strands.
struct Found {
    strands: Vec<Strand>,
    rejected: Vec<(Point, f64, f64)>,
    /// Number of ends that touch a strand of their colour.
    touching: usize,
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
        Self {
            strands,
            rejected,
            touching: 0,
        }
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
