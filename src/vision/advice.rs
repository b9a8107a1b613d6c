//! Signs that a result is wrong, in words, with a remedy for each.

use super::attempt::Attempt;
use super::options::TraceOptions;
use image::RgbImage;
use std::fmt;

/// Number of strands above which some of them are probably not rods.
const MANY: usize = 12;
/// Evenness below which a strand is doubtful.
const UNEVEN: f64 = 0.7;
/// Percentage of the mask without a strand that is reported.
const UNEXPLAINED_PERCENT: usize = 25;
/// Brightness that the lightest hundredth of a well exposed picture exceeds, out of 255.
const DARK: usize = 40;
/// Percentage of white pixels above which a picture is overexposed.
const GLARE_PERCENT: usize = 10;

/// A sign that a result is wrong; its text contains a remedy.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Doubt {
    /// More strands than most pictures have rods.
    Many {
        /// Number of strands.
        count: usize,
    },
    /// Fewer strands than asked for.
    Few {
        /// Number of strands.
        count: usize,
        /// Number asked for.
        wanted: usize,
    },
    /// A strand whose width varies.
    Uneven {
        /// Its number, from 1.
        strand: usize,
        /// Percentage of its length with an even width.
        even_percent: usize,
    },
    /// Ends that touch other strands, and strands that change their hue.
    Joined {
        /// Number of these places.
        signs: usize,
    },
    /// Part of the mask that belongs to no strand.
    Unexplained {
        /// Percentage of the mask.
        percent: usize,
    },
    /// The picture is dark.
    Dark {
        /// Brightness that a hundredth of the pixels exceeds, out of 255.
        brightness: usize,
    },
    /// Large parts of the picture are white.
    Glare {
        /// Percentage of white pixels.
        percent: usize,
    },
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Many { count } => write!(
                f,
                "{count} strands were found, and some may be texture or edges: give the number of rods (--strands), \
                 their colour (--colour) or --least-length"
            ),
            Self::Few { count, wanted } => write!(
                f,
                "{count} of {wanted} strands were found: give the colour of the rods (--colour, once for each), and check \
                 whether rods of one colour touch"
            ),
            Self::Uneven {
                strand,
                even_percent,
            } => write!(
                f,
                "strand {strand} has an even width over only {even_percent} % of its length, and may contain a shadow or an \
                 edge: try --colour tint, or give the colour of the rod"
            ),
            Self::Joined { signs } => write!(
                f,
                "{} ends on another strand or changes its hue: check the overlay; if rods have different colours, \
                 give one --colour for each",
                match signs {
                    1 => "a strand".to_owned(),
                    _ => format!("in {signs} places a strand"),
                }
            ),
            Self::Unexplained { percent } => write!(
                f,
                "{percent} % of the pixels taken for rod belong to no strand, such as other objects: give the colour of the \
                 rod (--colour) or a part of the image (--region)"
            ),
            Self::Dark { brightness } => write!(
                f,
                "the picture is dark, 99 % of it below {brightness} of 255: expose it longer or add light"
            ),
            Self::Glare { percent } => write!(
                f,
                "{percent} % of the picture is overexposed: shorten the exposure, or move the lamp"
            ),
        }
    }
}

/// The signs that a result is wrong.
pub(super) fn advice(picture: &RgbImage, found: &Attempt, options: &TraceOptions) -> Vec<Doubt> {
    let count = found.strands.len();
    let mut doubts = Vec::new();
    if count > MANY && options.strands.is_none() {
        doubts.push(Doubt::Many { count });
    }
    if let Some(wanted) = options.strands.filter(|wanted| count < *wanted) {
        doubts.push(Doubt::Few { count, wanted });
    }
    if found.signs.joints > 0 {
        doubts.push(Doubt::Joined {
            signs: found.signs.joints,
        });
    }
    let percent = unexplained_percent(found);
    if percent >= UNEXPLAINED_PERCENT {
        doubts.push(Doubt::Unexplained { percent });
    }
    for (index, fitness) in found.fitness.iter().enumerate().take(MANY) {
        if fitness.evenness < UNEVEN {
            doubts.push(Doubt::Uneven {
                strand: index + 1,
                even_percent: (100.0 * fitness.evenness).round() as usize,
            });
        }
    }
    doubts.extend(exposure(picture));
    doubts
}

/// Percentage of the mask beyond the area of the strands.
fn unexplained_percent(found: &Attempt) -> usize {
    let strands = found.strands.iter();
    let explained: f64 = strands.map(|one| one.length() * one.width()).sum();
    let area = found.mask.area() as f64;
    (100.0 * (1.0 - explained / area.max(1.0)).max(0.0)) as usize
}

/// A doubt about the exposure of a picture.
fn exposure(picture: &RgbImage) -> Option<Doubt> {
    let mut histogram = [0usize; 256];
    for pixel in picture.pixels().step_by(7) {
        let most = pixel.0.into_iter().max().unwrap_or(0);
        let least = pixel.0.into_iter().min().unwrap_or(0);
        // A channel of a bright colour may be at its limit; white has all of them there.
        histogram[usize::from(if least >= 254 { 255 } else { most.min(253) })] += 1;
    }
    let total: usize = histogram.iter().sum();
    let mut above = 0;
    let brightness = (0..256).rev().find(|value| {
        above += histogram[*value];
        100 * above >= total
    });
    let brightness = brightness.unwrap_or(0);
    if brightness < DARK {
        return Some(Doubt::Dark { brightness });
    }
    let percent = 100 * histogram[255] / total.max(1);
    (percent >= GLARE_PERCENT).then_some(Doubt::Glare { percent })
}
