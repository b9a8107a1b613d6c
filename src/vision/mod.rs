//! From images to curves in metres.

#[cfg(test)]
mod benchmark_tests;
mod calibration;
mod camera;
mod centreline;
mod checkerboard;
mod colour;
mod contrast;
mod crossing;
mod curve_file;
mod dice;
mod error;
mod gap;
mod hand_eye;
#[cfg(test)]
mod hostile_tests;
mod labels;
mod marker;
mod mask;
mod order;
mod overlay;
mod pattern;
mod picture;
mod pose_file;
mod render;
mod score;
mod score_figure;
mod sheet;
mod skeleton;
mod smoothing;
mod strand;
mod thinning;
mod trace;
#[cfg(test)]
mod trace_tests;

pub use calibration::{Calibration, board_pose, calibrate};
pub use camera::{Camera, Lens};
pub use centreline::Strand;
pub use checkerboard::Checkerboard;
pub use colour::{ColourRule, HsvBox, LabBall, colour_difference, hsv, lab};
pub use contrast::Contrast;
pub use curve_file::read_curve;
pub use dice::{InstanceDice, instance_dice};
pub use error::VisionError;
pub use hand_eye::{HandEye, hand_eye};
pub use labels::{MOST_LABELS, paint_labels};
pub use marker::{
    InstabilityRule, InstabilityWatch, MarkerErrors, compare_markers, find_markers, helix_points,
};
pub use mask::Mask;
pub use order::{Passage, StrandCrossing, find_crossings};
pub use overlay::{
    centrelines_csv, centrelines_svg, encode_labels, encode_picture, mask_overlay, overlay,
    strand_colour,
};
pub use pattern::{Metric, pattern, pattern_csv};
pub use picture::{
    LARGEST_FILE, LONGEST_SIDE, MOST_PIXELS, decode_labels, decode_picture, pictures_in,
    read_picture,
};
pub use pose_file::read_poses;
pub use render::{RenderOptions, RenderedRod, render};
pub use score::{CurveError, SCORE_POINTS, Score, rigid_alignment, score};
pub use score_figure::score_figure;
pub use sheet::{EdgePose, Sheet, find_sheet, sliding};
pub use trace::{Trace, TraceOptions, clean_mask, trace, trace_contrast};

/// A point of an image, pixels: u to the right, v down; (0, 0) is the centre of the first pixel.
pub type Point = nalgebra::Vector2<f64>;
