//! Errors about images, masks and cameras.

use std::path::PathBuf;

/// Reason why an image gives no result. All of these are errors of the input.
#[derive(Debug, thiserror::Error)]
pub enum VisionError {
    /// A file could not be read.
    #[error("{}: cannot be read: {reason}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Message of the system or the decoder.
        reason: String,
    },
    /// The content of a file does not match its kind.
    #[error("{}: {reason}", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// The error, and the allowed values.
        reason: String,
    },
    /// A file could not be written.
    #[error("{}: cannot be written: {reason}", path.display())]
    Unwritable {
        /// The file.
        path: PathBuf,
        /// Message of the system.
        reason: String,
    },
    /// A text is not a colour rule.
    #[error("colour \"{text}\": {reason}")]
    Colour {
        /// The text.
        text: String,
        /// The error, and the allowed values.
        reason: String,
    },
    /// Almost no pixel looks like a rod.
    #[error(
        "the mask is empty: {found} of {pixels} pixels look like a rod and none of them form a line; \
         choose another colour rule, or give a mask"
    )]
    EmptyMask {
        /// Pixels that look like a rod.
        found: usize,
        /// Pixels of the image.
        pixels: usize,
    },
    /// Nearly every pixel looks like a rod.
    #[error(
        "the mask covers {} % of the image; a line drawing covers less than {limit_percent} %: choose another \
         colour rule, or give a mask",
        (100 * found).checked_div(*pixels).unwrap_or(0)
    )]
    FullMask {
        /// Pixels that look like a rod.
        found: usize,
        /// Pixels of the image.
        pixels: usize,
        /// Largest percentage that lines may cover.
        limit_percent: usize,
    },
    /// Rods cannot be distinguished from noise.
    #[error(
        "rods cannot be distinguished from the background: the mask has {lines} lines; name the colour of the rod \
         (--colour), the part of the image that shows it (--region x,y,width,height), or the number of rods (--strands)"
    )]
    Noise {
        /// Lines in the mask.
        lines: usize,
    },
    /// No strand has the length that was asked for.
    #[error("no strand is {least:.0} px long; the longest one has {longest:.0} px")]
    Short {
        /// Least length of a strand, pixels.
        least: f64,
        /// Length of the longest strand, pixels.
        longest: f64,
    },
    /// A text is not a region.
    #[error("region \"{text}\": {reason}")]
    Region {
        /// The text.
        text: String,
        /// The allowed forms.
        reason: &'static str,
    },
    /// A region has no pixel of the image.
    #[error("the region lies outside of the image, which has {width} × {height} pixels")]
    OutsideRegion {
        /// Width of the image.
        width: u32,
        /// Height of the image.
        height: u32,
    },
    /// The mask has a part that is not a line.
    #[error(
        "the mask has a blob at ({u:.0}, {v:.0}) px, {length:.0} px long and {width:.0} px wide, that is not a line: \
         choose another colour rule, or give a mask without it"
    )]
    Blob {
        /// Centre of the part, pixels from the left.
        u: f64,
        /// Centre of the part, pixels from the top.
        v: f64,
        /// Length of the skeleton of the part, pixels.
        length: f64,
        /// Width of the part, pixels.
        width: f64,
    },
    /// An image has a different size than the image to which it belongs.
    #[error("{what} has {found_width} × {found_height} pixels, expected {width} × {height}")]
    Size {
        /// Name of the image.
        what: String,
        /// Width of the image.
        found_width: usize,
        /// Height of the image.
        found_height: usize,
        /// Width of the image to which it belongs.
        width: usize,
        /// Height of the image to which it belongs.
        height: usize,
    },
    /// A camera file lacks a key, or has an impossible value.
    #[error("{}: {key}: {reason}", path.display())]
    Camera {
        /// The file.
        path: PathBuf,
        /// The key.
        key: String,
        /// The error, and the allowed values.
        reason: String,
    },
    /// The object is not in the image.
    #[error("{what} was not found: {reason}")]
    NotFound {
        /// The object.
        what: &'static str,
        /// Reason, and advice.
        reason: String,
    },
    /// The data are too few or degenerate, so that there is no unique answer.
    #[error("{problem} is not determined: {reason}")]
    Undetermined {
        /// The problem.
        problem: &'static str,
        /// The missing data.
        reason: String,
    },
}
