//! Converts images to curves in metres: strands, crossings, cameras, scores. The crate depends on
//! images and arrays, not on rods or robots.
//!
//! [`trace()`] follows these steps:
//!
//! 1. [`Contrast`]: how much each pixel looks like a rod, by a [`ColourRule`]; its threshold is the
//!    [`Mask`]. If the strands of the automatic rule are uneven, they are compared with those that
//!    differ from the background in more than shade, and with those that have flanks lighter or
//!    darker than the table.
//! 2. Thinning reduces the mask to lines one pixel wide, which form a graph of ends and junctions
//!    joined by branches.
//! 3. Forks that face each other are the halves of one crossing. Arms are paired so that the paths
//!    between them bend least and keep their colour: at a crossing, along a stretch that two
//!    strands share, or across a gap under another strand. If ends remain that touch other
//!    strands, if strands change their hue, or if parts of the mask remain without a strand, the
//!    mask is divided by hue and traced again.
//! 4. Each path becomes a [`Strand`]: the middle between its two edges, measured with sub-pixel
//!    accuracy, smoothed along the strand, and interpolated where it meets other strands. An end
//!    that emerges beyond another strand is followed to its tip. Strands are divided at kinks, and
//!    those that end beside another one share its stem: two rods of one colour touch there.
//! 5. [`find_crossings`] intersects the centrelines. The picture shows which strand is on top
//!    where both overlap: the upper one keeps its cross-section from outside the crossing.
//!    [`whole_rod`] inserts closed strands into the open one that they belong to, if the picture
//!    shows a single rod.
//! 6. [`paint_labels`] gives each pixel of the mask to a strand; [`instance_dice`] compares the
//!    labels with the truth.
//!
//! A [`Camera`] maps pixels to the table; [`calibrate`], [`board_pose`] and [`hand_eye()`]
//! determine it. [`pattern()`] converts a drawn line to a pattern, [`score()`] compares a deployed
//! curve with a pattern, [`find_sheet`] finds a sheet of paper, and [`find_edge`] one of its
//! edges. [`find_markers`], [`compare_markers`] and [`InstabilityWatch`] detect when a rod with
//! markers stops being a helix. [`render()`] generates test pictures.
//!
//! ```
//! use rodlab_vision::{TraceOptions, trace};
//!
//! let mut picture = image::RgbImage::new(120, 80);
//! for (u, v, pixel) in picture.enumerate_pixels_mut() {
//!     if (i64::from(v) - 40).abs() <= 3 && (10..110).contains(&u) {
//!         *pixel = image::Rgb([200, 60, 70]);
//!     }
//! }
//! let found = trace(&picture, &TraceOptions::default())?;
//! assert_eq!(found.strands.len(), 1);
//! assert!((found.strands[0].width() - 7.0).abs() < 0.5);
//! # Ok::<(), rodlab_vision::VisionError>(())
//! ```
//!
//! Everything runs on one thread. An image of 672 × 896 pixels takes about 10 ms and 20 bytes of
//! memory per pixel; [`read_picture`] rejects images of more than [`MOST_PIXELS`].

// Tests compare with a tolerance, and may call any mathematical library.
#![cfg_attr(test, allow(clippy::disallowed_methods))]

mod across;
mod advice;
mod attempt;
mod averages;
#[cfg(test)]
mod benchmark_tests;
mod beside;
mod calibration;
mod camera;
mod camera_file;
mod centreline;
mod checkerboard;
mod choice;
mod chord;
mod colour;
mod connection;
mod contrast;
mod corner;
mod crossing;
#[cfg(test)]
mod crossing_tests;
mod curve_file;
mod dice;
mod doubt;
mod error;
mod fitness;
mod hand_eye;
mod hand_eye_consensus;
mod hand_eye_mount;
mod homography;
#[cfg(test)]
mod hostile_tests;
mod input;
mod joining;
mod jpeg;
mod junction;
mod kink;
mod labels;
mod layers;
mod lens_fit;
mod marker;
mod mask;
mod options;
mod order;
mod overlap;
mod overlay;
mod passage;
mod path_energy;
mod pattern;
#[cfg(test)]
mod photograph_tests;
mod picture;
mod pixels;
mod pose_file;
mod region;
mod relief;
mod render;
mod reprojection;
#[cfg(test)]
mod room_tests;
mod saddle;
#[cfg(test)]
mod scene_tests;
mod score;
mod score_figure;
mod seen_length;
mod shading;
mod sheet;
mod skeleton;
mod smoothing;
mod stem;
mod straight_edge;
mod strand;
mod strand_end;
mod surroundings;
mod thinning;
#[cfg(test)]
mod touch_tests;
mod trace;
#[cfg(test)]
mod trace_tests;
mod whole_rod;

pub use advice::Doubt;
pub use calibration::{Calibration, board_pose, calibrate};
pub use camera::{Camera, Lens};
pub use centreline::Strand;
pub use checkerboard::Checkerboard;
pub use colour::{ColourRule, HsvBox, LabBall, colour_difference, hsv, lab};
pub use contrast::Contrast;
pub use curve_file::read_curve;
pub use dice::{InstanceDice, instance_dice};
pub use error::VisionError;
pub use hand_eye::{HandEye, RejectedPair, hand_eye};
pub use labels::{MOST_LABELS, paint_labels};
pub use lens_fit::LensMisfit;
pub use marker::{
    InstabilityRule, InstabilityWatch, MarkerErrors, compare_markers, find_markers, helix_points,
};
pub use mask::Mask;
pub use options::TraceOptions;
pub use order::{StrandCrossing, find_crossings};
pub use overlay::{
    centrelines_csv, centrelines_svg, edges_overlay, encode_labels, encode_picture, marker_overlay,
    mask_overlay, overlay, sheet_overlay, strand_colour,
};
pub use passage::Passage;
pub use pattern::{Metric, pattern, pattern_csv};
pub use picture::{
    LARGEST_FILE, LONGEST_SIDE, MOST_PIXELS, PICTURE_ENDINGS, decode_labels, decode_picture,
    pictures_in, read_labels, read_picture,
};
pub use pose_file::read_poses;
pub use region::Region;
pub use render::{RenderOptions, RenderedRod, render};
pub use score::{
    CurveError, SCORE_POINTS, Score, distance_to, part_of_curve, rigid_alignment, score,
};
pub use score_figure::score_figure;
pub use seen_length::SeenLength;
pub use sheet::{EdgePose, Sheet, find_sheet, sliding};
pub use straight_edge::{FoundEdge, find_edge};
pub use trace::{Trace, clean_mask, trace, trace_contrast};
pub use whole_rod::whole_rod;

/// A point of an image, pixels: u to the right, v down; (0, 0) is the centre of the first pixel.
pub type Point = nalgebra::Vector2<f64>;
