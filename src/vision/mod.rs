//! From images to curves in metres.

mod camera;
mod centreline;
mod colour;
mod contrast;
mod crossing;
mod dice;
mod error;
mod gap;
mod labels;
mod mask;
mod order;
mod overlay;
mod picture;
mod skeleton;
mod smoothing;
mod strand;
mod thinning;
mod trace;

pub use camera::{Camera, Lens};
pub use centreline::Strand;
pub use colour::{ColourRule, HsvBox, LabBall, colour_difference, hsv, lab};
pub use contrast::Contrast;
pub use dice::{InstanceDice, instance_dice};
pub use error::VisionError;
pub use labels::{MOST_LABELS, paint_labels};
pub use mask::Mask;
pub use order::{Passage, StrandCrossing, find_crossings};
pub use overlay::{
    centrelines_csv, centrelines_svg, encode_labels, encode_picture, mask_overlay, overlay,
    strand_colour,
};
pub use picture::{
    LARGEST_FILE, LONGEST_SIDE, MOST_PIXELS, decode_labels, decode_picture, pictures_in,
    read_picture,
};
pub use trace::{Trace, TraceOptions, clean_mask, trace, trace_contrast};

/// A point of an image, pixels: u to the right, v down; (0, 0) is the centre of the first pixel.
pub type Point = nalgebra::Vector2<f64>;
