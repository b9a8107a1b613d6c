//! Finds the strands in a picture.

use super::advice::{Doubt, advice};
use super::attempt::{Attempt, Corners};
use super::centreline::Strand;
use super::choice::{choose, rod_contrasts, select};
use super::contrast::{Contrast, picked};
use super::labels::paint_labels;
use super::mask::Mask;
use super::options::TraceOptions;
use super::order::{StrandCrossing, find_crossings};
use super::region::Frame;
use super::{Point, VisionError};
use image::{GrayImage, RgbImage};
use std::borrow::Cow;

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
    /// Parts of the mask that are not strands, and strands that were left out: centre, length and
    /// width of each.
    pub rejected: Vec<(Point, f64, f64)>,
    /// Signs that the result is wrong.
    pub doubts: Vec<Doubt>,
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

/// Finds the strands of a picture.
///
/// With [`ColourRule::Background`](super::ColourRule::Background) only, the strands found by that
/// rule are kept if they are even and complete. Otherwise they are compared with those of
/// [`ColourRule::Tint`](super::ColourRule::Tint), and, if the picture has thin light or dark lines
/// without a strand, with those of [`ColourRule::Relief`](super::ColourRule::Relief). The set with
/// the greater length of rod is used. Bars, which are straight and more than twice as wide as the
/// rods, are left out unless [`TraceOptions::strands`] is given.
///
/// Except with [`ColourRule::Pen`](super::ColourRule::Pen) and
/// [`ColourRule::Lighter`](super::ColourRule::Lighter), strands are divided where they turn more
/// sharply than a rod: there, two rods touch with their ends.
///
/// # Errors
/// Nothing or everything looks like a rod, no part of the mask is a line, or rods cannot be
/// distinguished from noise.
pub fn trace(picture: &RgbImage, options: &TraceOptions) -> Result<Trace, VisionError> {
    let search = Search::new(picture, options)?;
    let found = choose(&search.picture, &search.options, |contrast| {
        search.limit(contrast)
    });
    Ok(search.finish(found?))
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
    let search = Search::new(picture, options)?;
    let mut contrast = match search.frame {
        Some(frame) => frame.cut_contrast(contrast),
        None => contrast.clone(),
    };
    search.limit(&mut contrast);
    let found = Attempt::new(&search.picture, &[contrast], None, Corners::Keep, options)?;
    Ok(search.finish(select(found, options)?))
}

/// The mask of the colour rules, even if [`trace`] finds nothing in it.
///
/// # Errors
/// The region or the pixel to pick lies outside of the picture.
pub fn clean_mask(picture: &RgbImage, options: &TraceOptions) -> Result<Mask, VisionError> {
    let search = Search::new(picture, options)?;
    let mut mask = Mask::new(
        search.picture.width() as usize,
        search.picture.height() as usize,
    );
    for mut contrast in rod_contrasts(&search.picture, &search.options)? {
        search.limit(&mut contrast);
        mask = mask.with(&Mask::of_contrast(&contrast));
    }
    mask.clean(options.least_area, options.largest_hole);
    Ok(match search.frame {
        Some(frame) => frame.paste_mask(&mask, search.size),
        None => mask,
    })
}

/// The part of a picture that is searched.
struct Search<'a> {
    picture: Cow<'a, RgbImage>,
    /// Width and height of the whole picture.
    size: [u32; 2],
    frame: Option<Frame>,
    /// The options, with the colours of picked pixels.
    options: TraceOptions,
}

impl<'a> Search<'a> {
    fn new(picture: &'a RgbImage, options: &TraceOptions) -> Result<Self, VisionError> {
        let rules = options.more_colours.iter();
        let rules = rules.map(|rule| picked(picture, rule));
        let (width, height) = picture.dimensions();
        let region = options.region.as_ref();
        let frame = region
            .map(|region| region.frame(width, height))
            .transpose()?;
        Ok(Self {
            picture: match frame {
                Some(frame) => Cow::Owned(frame.cut(picture)),
                None => Cow::Borrowed(picture),
            },
            size: [width, height],
            frame,
            options: TraceOptions {
                colour: picked(picture, &options.colour)?,
                more_colours: rules.collect::<Result<_, _>>()?,
                ..options.clone()
            },
        })
    }

    fn limit(&self, contrast: &mut Contrast) {
        if let (Some(region), Some(frame)) = (&self.options.region, self.frame) {
            region.limit(contrast, frame);
        }
    }

    fn finish(&self, found: Attempt) -> Trace {
        let doubts = advice(&self.picture, &found, &self.options);
        let crossings = find_crossings(&self.picture, &found.strands);
        let mut trace = Trace {
            mask: found.mask,
            strands: found.strands,
            crossings,
            labels: GrayImage::default(),
            rejected: found.rejected,
            doubts,
        };
        if let Some(frame) = self.frame {
            paste(frame, &mut trace, self.size);
        }
        trace.labels = paint_labels(&trace.mask, &trace.strands, &trace.crossings);
        trace
    }
}

/// Moves a trace to the pixels of the whole image, of the given width and height.
fn paste(frame: Frame, trace: &mut Trace, size: [u32; 2]) {
    let offset = Point::from(frame.origin.map(f64::from));
    for strand in &mut trace.strands {
        for point in &mut strand.points {
            *point += offset;
        }
    }
    for crossing in &mut trace.crossings {
        crossing.position += offset;
    }
    for (point, _, _) in &mut trace.rejected {
        *point += offset;
    }
    trace.mask = frame.paste_mask(&trace.mask, size);
}
