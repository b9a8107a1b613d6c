//! Choice of the mask and of the strands that look most like rods.

use super::attempt::{Attempt, Corners};
use super::centreline::Strand;
use super::colour::ColourRule;
use super::contrast::{Contrast, union};
use super::fitness::Fitness;
use super::kink::KinkRule;
use super::mask::Mask;
use super::options::TraceOptions;
use super::relief::{unmasked_relief, without_weak_parts};
use super::skeleton::median;
use super::{Point, VisionError};
use image::RgbImage;

/// Evenness at which a strand needs no comparison with the result of other rules.
const CLEAN: f64 = 0.93;
/// Weight of the result of [`ColourRule::Tint`] relative to that of [`ColourRule::Background`], which
/// also finds rods of the table's hue.
const TINT_WEIGHT: f64 = 0.95;
/// Weight of the result with [`ColourRule::Relief`], which also finds shadows.
const RELIEF_WEIGHT: f64 = 0.9;
/// Weight of that result if strands that were found before are only flanks of its strands.
const FLANKS_WEIGHT: f64 = 1.3;
/// Largest width of a flank, in widths of its strand.
const FLANK_WIDTH: f64 = 0.6;
/// Fraction of the points of a strand that must lie on another one of which it is a part.
const LYING_ON: f64 = 0.95;
/// Part of a picture with relief, but without strands, that may be rods, per cent; more is texture.
const RELIEF_PERCENT: std::ops::Range<f64> = 0.05..5.0;
/// Factors of the threshold that are tried if the number of strands is wrong.
const THRESHOLDS: [f64; 2] = [0.6, 1.6];
/// Corners of rods.
const TOUCHING: Corners = Corners::Split(KinkRule::SHARP);
/// Least value of strands divided at weak kinks, relative to the value before.
const LEAST_DIVIDED: f64 = 0.8;
/// Strands with less evenness and a length below [`LEAST_ROD`] are left out.
const LEAST_EVENNESS: f64 = 0.5;
/// Least length that looks like a rod, relative to that of the longest strand.
const LEAST_ROD: f64 = 0.2;
/// Least width of a bar, in widths of the rods beside it.
const BAR_WIDTH: f64 = 2.0;
/// Largest distance of a bar's points from the straight line between its ends, in its widths.
const BAR_SAGITTA: f64 = 0.25;
/// Weight of the length that does not look like a rod.
const OTHER_LENGTH: f64 = 0.5;
/// Difference from the background, out of 255, of an object that may hide a rod.
const COVER_CONTRAST: u8 = 14;
/// Widths that a strand costs.
const STRAND_WIDTHS: f64 = 4.0;
/// Largest part of a picture in which other objects may hide a rod, per cent; more is texture.
const LARGEST_COVER_PERCENT: usize = 30;

/// The contrasts of the colour rules of a search.
pub(super) fn rod_contrasts(
    picture: &RgbImage,
    options: &TraceOptions,
) -> Result<Vec<Contrast>, VisionError> {
    let rules = std::iter::once(&options.colour).chain(&options.more_colours);
    rules.map(|rule| rod_contrast(picture, rule)).collect()
}

fn rod_contrast(picture: &RgbImage, rule: &ColourRule) -> Result<Contrast, VisionError> {
    let mut contrast = Contrast::new(picture, rule)?;
    if *rule == ColourRule::Relief {
        without_weak_parts(&mut contrast);
    }
    Ok(contrast)
}

/// Finds the strands with the colour rules of a search; `limit` removes what lies outside of its
/// region.
pub(super) fn choose(
    picture: &RgbImage,
    options: &TraceOptions,
    limit: impl Fn(&mut Contrast),
) -> Result<Attempt, VisionError> {
    let mut contrasts = rod_contrasts(picture, options)?;
    contrasts.iter_mut().for_each(&limit);
    let is_automatic = contrasts.len() == 1 && options.colour == ColourRule::Background;
    if !is_automatic {
        let is_drawn = is_drawn(options);
        let cover = match is_drawn {
            true => None,
            false => cover(&Contrast::new(picture, &ColourRule::Background)?),
        };
        let corners = corners_of(options);
        let mut found = Attempt::new(picture, &contrasts, cover.as_ref(), corners, options)?;
        if options.strands.is_none() && !is_drawn {
            leave_out_edges(&mut found);
        }
        return select(found, options);
    }
    let plain = contrasts.remove(0);
    let search = Automatic {
        picture,
        options,
        cover: cover(&plain),
        plain,
        limit,
    };
    search.run()
}

/// Whether the strands are drawn lines, which may have corners.
fn is_drawn(options: &TraceOptions) -> bool {
    let rule = &options.colour;
    options.has_corners || matches!(rule, ColourRule::Pen { .. } | ColourRule::Lighter { .. })
}

fn corners_of(options: &TraceOptions) -> Corners {
    if is_drawn(options) {
        Corners::Keep
    } else {
        TOUCHING
    }
}

/// The search without a colour given by the user.
struct Automatic<'a, F> {
    picture: &'a RgbImage,
    options: &'a TraceOptions,
    /// Contrast of [`ColourRule::Background`].
    plain: Contrast,
    /// Pixels that may hide a rod.
    cover: Option<Mask>,
    /// Removes what lies outside of the region of the search.
    limit: F,
}

impl<F: Fn(&mut Contrast)> Automatic<'_, F> {
    fn run(&self) -> Result<Attempt, VisionError> {
        let first = self.attempt(self.plain.clone(), corners_of(self.options));
        let is_first_clean = first
            .as_ref()
            .is_ok_and(|first| is_clean(first, self.options));
        let may_miss_lines = match &first {
            Ok(first) => has_relief(self.picture, &first.mask),
            Err(_) => has_relief(
                self.picture,
                &Mask::new(self.plain.width, self.plain.height),
            ),
        };
        if is_first_clean && !may_miss_lines {
            return select(first?, self.options);
        }
        let mut best = Best::new(first, self.options);
        let mut is_tint_empty = false;
        if !is_first_clean {
            let tint = self.attempt(self.contrast(&ColourRule::Tint)?, corners_of(self.options));
            is_tint_empty = tint.is_err();
            best.compare(tint, TINT_WEIGHT);
        }
        if may_miss_lines || is_tint_empty && best.attempt.is_ok() {
            self.compare_relief(&mut best)?;
        }
        self.compare_thresholds(&mut best);
        let mut found = self.divided(best.attempt?);
        if self.options.strands.is_none() && !is_drawn(self.options) {
            leave_out_edges(&mut found);
        }
        select(found, self.options)
    }

    fn contrast(&self, rule: &ColourRule) -> Result<Contrast, VisionError> {
        let mut contrast = rod_contrast(self.picture, rule)?;
        (self.limit)(&mut contrast);
        Ok(contrast)
    }

    fn attempt(&self, contrast: Contrast, corners: Corners) -> Result<Attempt, VisionError> {
        let cover = self.cover.as_ref();
        Attempt::new(self.picture, &[contrast], cover, corners, self.options)
    }

    /// Compares with the lines that differ in brightness from their surroundings. Other rules find
    /// only the darker flank of a white rod on white.
    fn compare_relief(&self, best: &mut Best) -> Result<(), VisionError> {
        let relief = self.contrast(&ColourRule::Relief)?;
        let Some(both) = union(&[self.plain.clone(), relief]) else {
            return Ok(());
        };
        let found = self.attempt(both, corners_of(self.options));
        let weight = match (&best.attempt, &found) {
            (Ok(best), Ok(found)) if are_flanks(&best.strands, &found.strands) => FLANKS_WEIGHT,
            _ => RELIEF_WEIGHT,
        };
        best.compare(found, weight);
        Ok(())
    }

    /// Tries other thresholds if the number of strands is not that of the rods.
    fn compare_thresholds(&self, best: &mut Best) {
        if self.options.strands.is_none() {
            return;
        }
        for factor in THRESHOLDS {
            if best.has_wanted() {
                return;
            }
            let threshold = f64::from(self.plain.threshold) * factor;
            let contrast = Contrast {
                threshold: threshold.clamp(2.0, 255.0) as u8,
                ..self.plain.clone()
            };
            best.compare(self.attempt(contrast, corners_of(self.options)), 1.0);
        }
    }

    /// Divides strands at weak kinks if there are fewer strands than rods: two rods may touch with
    /// their ends.
    fn divided(&self, found: Attempt) -> Attempt {
        let is_missing = |wanted| found.strands.len() < wanted;
        if is_drawn(self.options) || !self.options.strands.is_some_and(is_missing) {
            return found;
        }
        let divided = self.attempt(self.plain.clone(), Corners::Split(KinkRule::WEAK));
        let least = LEAST_DIVIDED * length_of_rod(&found, self.options);
        match divided {
            Ok(divided)
                if divided.strands.len() > found.strands.len()
                    && length_of_rod(&divided, self.options) > least =>
            {
                divided
            }
            _ => found,
        }
    }
}

/// Whether all `parts` lie on strands, and one of them is only a flank: much narrower than its
/// strand.
fn are_flanks(parts: &[Strand], strands: &[Strand]) -> bool {
    let below = |part: &Strand| strands.iter().find(|strand| lies_on(part, strand));
    let below: Option<Vec<&Strand>> = parts.iter().map(below).collect();
    below.is_some_and(|below| {
        let mut pairs = parts.iter().zip(below);
        pairs.any(|(part, strand)| part.width() < FLANK_WIDTH * strand.width())
    })
}

/// Whether a strand lies within the width of another one.
fn lies_on(part: &Strand, strand: &Strand) -> bool {
    let reach = 0.5 * strand.width() + 1.0;
    let is_on = |place: &Point| {
        let mut points = strand.points.iter().step_by(2);
        points.any(|point| (point - place).norm_squared() < reach * reach)
    };
    let places = part.points.iter().step_by(8);
    let inside = places.clone().filter(|place| is_on(place)).count();
    inside as f64 >= LYING_ON * places.count() as f64
}

/// Whether lines may be left beside the strands that were found, such as white rods on white.
fn has_relief(picture: &RgbImage, mask: &Mask) -> bool {
    RELIEF_PERCENT.contains(&unmasked_relief(picture, mask))
}

/// Leaves out short strands of uneven width, such as edges of objects, and bars beside a rod.
fn leave_out_edges(found: &mut Attempt) {
    let fitness = found.fitness.clone();
    let longest = fitness.iter().map(Fitness::rod_length).fold(0.0, f64::max);
    let bars = bars(&found.strands);
    found.keep(|number| {
        let one = fitness[number];
        !bars[number] && (one.evenness >= LEAST_EVENNESS || one.rod_length() >= LEAST_ROD * longest)
    });
}

/// Whether each strand is a bar, such as the arm of a gripper: much wider than most of the length
/// of the strands, and straight.
fn bars(strands: &[Strand]) -> Vec<bool> {
    let mut sizes: Vec<(f64, f64)> = strands
        .iter()
        .map(|strand| (strand.width(), strand.length()))
        .collect();
    sizes.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = 0.5 * sizes.iter().map(|(_, length)| length).sum::<f64>();
    let mut below = 0.0;
    let usual = sizes.iter().find(|(_, length)| {
        below += length;
        below >= half
    });
    let usual = usual.map_or(f64::INFINITY, |(width, _)| *width);
    let is_bar = |strand: &Strand| {
        strand.width() > BAR_WIDTH * usual && strand.sagitta() < BAR_SAGITTA * strand.width()
    };
    strands.iter().map(is_bar).collect()
}

/// Pixels of objects that may hide a rod, such as a grey gripper above a dark table; `None` if
/// they are texture.
fn cover(plain: &Contrast) -> Option<Mask> {
    let mask = Mask::of_contrast(&Contrast {
        threshold: plain.threshold.min(COVER_CONTRAST),
        ..plain.clone()
    });
    let pixels = mask.width() * mask.height();
    (100 * mask.area() <= LARGEST_COVER_PERCENT * pixels).then_some(mask)
}

/// Whether all strands look like rods.
fn is_clean(found: &Attempt, options: &TraceOptions) -> bool {
    let is_even = found.fitness.iter().all(|one| one.evenness >= CLEAN);
    let is_expected = options
        .strands
        .is_none_or(|wanted| found.strands.len() == wanted);
    is_even && is_expected && found.signs.count() == 0
}

/// The best attempt so far.
struct Best<'a> {
    attempt: Result<Attempt, VisionError>,
    value: f64,
    options: &'a TraceOptions,
}

impl<'a> Best<'a> {
    fn new(first: Result<Attempt, VisionError>, options: &'a TraceOptions) -> Self {
        let value = first.as_ref().map_or(0.0, |first| value(first, options));
        Self {
            attempt: first,
            value,
            options,
        }
    }

    fn compare(&mut self, other: Result<Attempt, VisionError>, weight: f64) {
        let value = other
            .as_ref()
            .map_or(0.0, |other| weight * value(other, self.options));
        if value > self.value {
            *self = Self {
                attempt: other,
                value,
                options: self.options,
            };
        }
    }

    /// Whether the number of strands is the number of rods.
    fn has_wanted(&self) -> bool {
        let count = self.attempt.as_ref().ok().map(|best| best.strands.len());
        count.is_some() && count == self.options.strands
    }
}

/// The length of the strands, less a few widths for each sign of a wrong joint, pixels: a strand was
/// divided there, or two were joined.
fn value(found: &Attempt, options: &TraceOptions) -> f64 {
    let width = median_width(found);
    length_of_rod(found, options) - STRAND_WIDTHS * found.signs.joints as f64 * width
}

fn median_width(found: &Attempt) -> f64 {
    let widths: Vec<f64> = found.strands.iter().map(Strand::width).collect();
    median(&widths)
}

/// Length that looks like a rod, less the length that does not and a few widths for each strand,
/// pixels: of two results of the same length, that with fewer gaps is better. If the number of rods is
/// given, all strands beyond it count as not like a rod.
fn length_of_rod(found: &Attempt, options: &TraceOptions) -> f64 {
    let (mut fitness, mut bars_length) = (found.fitness.clone(), 0.0);
    if options.strands.is_none() {
        let mut bars = bars(&found.strands).into_iter();
        fitness.retain(|one| {
            let is_bar = bars.next() == Some(true);
            bars_length += if is_bar { one.length } else { 0.0 };
            !is_bar
        });
    }
    fitness.sort_by(|a, b| b.rod_length().total_cmp(&a.rod_length()));
    let wanted = options.strands.unwrap_or(fitness.len()).min(fitness.len());
    let (rods, others) = fitness.split_at(wanted);
    let of_rod = |one: &Fitness| {
        let rod = one.rod_length();
        rod - OTHER_LENGTH * (one.length - rod)
    };
    let rods: f64 = rods.iter().map(of_rod).sum();
    let others = bars_length + others.iter().map(|other| other.length).sum::<f64>();
    let widths: f64 = found.strands.iter().map(Strand::width).sum();
    rods - OTHER_LENGTH * others - STRAND_WIDTHS * widths
}

/// Keeps the strands that a search asks for.
///
/// # Errors
/// All strands are too short.
pub(super) fn select(mut found: Attempt, options: &TraceOptions) -> Result<Attempt, VisionError> {
    let lengths: Vec<f64> = found.fitness.iter().map(|one| one.length).collect();
    let (least, longest) = (
        options.least_length,
        lengths.iter().copied().fold(0.0, f64::max),
    );
    if longest < least {
        return Err(VisionError::Short { least, longest });
    }
    if least > 0.0 {
        found.keep(|number| lengths[number] >= least);
    }
    if let Some(wanted) = options.strands {
        let lengths: Vec<f64> = found.fitness.iter().map(Fitness::rod_length).collect();
        let mut order: Vec<usize> = (0..lengths.len()).collect();
        order.sort_by(|a, b| lengths[*b].total_cmp(&lengths[*a]));
        order.truncate(wanted);
        found.keep(|number| order.contains(&number));
    }
    Ok(found)
}
