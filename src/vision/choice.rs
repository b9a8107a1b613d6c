//! Choice of the mask and of the strands that look most like rods.

use super::VisionError;
use super::attempt::{Attempt, Corners};
use super::centreline::Strand;
use super::colour::ColourRule;
use super::contrast::Contrast;
use super::fitness::Fitness;
use super::kink::KinkRule;
use super::mask::Mask;
use super::options::TraceOptions;
use super::skeleton::median;
use image::RgbImage;

/// Evenness at which a strand needs no comparison with the result of other rules.
const CLEAN: f64 = 0.93;
/// Weight of the result of [`ColourRule::Tint`] relative to that of [`ColourRule::Background`], which
/// also finds rods of the table's hue.
const TINT_WEIGHT: f64 = 0.95;
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
    rules.map(|rule| Contrast::new(picture, rule)).collect()
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
        let cover = match options.colour {
            ColourRule::Pen { .. } | ColourRule::Lighter { .. } => None,
            _ => cover(&Contrast::new(picture, &ColourRule::Background)?),
        };
        let corners = match options.colour {
            ColourRule::Pen { .. } => Corners::Keep,
            _ => TOUCHING,
        };
        let found = Attempt::new(picture, &contrasts, cover.as_ref(), corners, options)?;
        return select(found, options);
    }
    let plain = contrasts.remove(0);
    let cover = cover(&plain);
    let attempt = |contrast: Contrast, cover: Option<&Mask>, corners| {
        Attempt::new(picture, &[contrast], cover, corners, options)
    };
    let first = attempt(plain.clone(), cover.as_ref(), TOUCHING);
    if first.as_ref().is_ok_and(|first| is_clean(first, options)) {
        return select(first?, options);
    }
    let mut best = Best::new(first, options);
    let mut tint = Contrast::new(picture, &ColourRule::Tint)?;
    limit(&mut tint);
    best.compare(attempt(tint, cover.as_ref(), TOUCHING), TINT_WEIGHT);
    if options.strands.is_some() {
        for factor in THRESHOLDS {
            if best.has_wanted() {
                break;
            }
            let threshold = f64::from(plain.threshold) * factor;
            let contrast = Contrast {
                threshold: threshold.clamp(2.0, 255.0) as u8,
                ..plain.clone()
            };
            best.compare(attempt(contrast, cover.as_ref(), TOUCHING), 1.0);
        }
    }
    let mut found = best.attempt?;
    if options
        .strands
        .is_some_and(|wanted| found.strands.len() < wanted)
    {
        // Two rods may touch with their ends.
        if let Ok(divided) = attempt(plain, cover.as_ref(), Corners::Split(KinkRule::WEAK))
            && divided.strands.len() > found.strands.len()
            && length_of_rod(&divided, options) > LEAST_DIVIDED * length_of_rod(&found, options)
        {
            found = divided;
        }
    }
    if options.strands.is_none() {
        leave_out_edges(&mut found);
    }
    select(found, options)
}

/// Leaves out short strands of uneven width, such as edges of objects, beside a rod.
fn leave_out_edges(found: &mut Attempt) {
    let fitness = found.fitness.clone();
    let longest = fitness.iter().map(Fitness::rod_length).fold(0.0, f64::max);
    found.keep(|number| {
        let one = fitness[number];
        one.evenness >= LEAST_EVENNESS || one.rod_length() >= LEAST_ROD * longest
    });
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
    let mut fitness = found.fitness.clone();
    fitness.sort_by(|a, b| b.rod_length().total_cmp(&a.rod_length()));
    let wanted = options.strands.unwrap_or(fitness.len()).min(fitness.len());
    let (rods, others) = fitness.split_at(wanted);
    let of_rod = |one: &Fitness| {
        let rod = one.rod_length();
        rod - OTHER_LENGTH * (one.length - rod)
    };
    let rods: f64 = rods.iter().map(of_rod).sum();
    let others: f64 = others.iter().map(|other| other.length).sum();
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
