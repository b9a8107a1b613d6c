//! Damaged and extreme images give an error or a result, never a panic.
//!
//! `RODLAB_MUTATIONS=1000000 cargo test --release --lib vision::hostile -- --nocapture` runs that
//! many mutations.

use super::camera::tests::looking_at;
use super::picture::tests::crc32;
use super::render::{RenderOptions, RenderedRod, render};
use super::trace_tests::Dice;
use super::*;
use image::codecs::jpeg::JpegEncoder;
use image::{Rgb, RgbImage};
use nalgebra::{UnitQuaternion, Vector3};
use proptest::prelude::*;

/// Default number of mutations.
const USUAL_MUTATIONS: u64 = 3000;

fn small_picture() -> RgbImage {
    let lens = ([60.0; 2], [27.5, 20.5], [0.0; 5]);
    let straight = UnitQuaternion::identity();
    let camera = looking_at(Vector3::zeros(), 0.5, straight, [56, 42], lens);
    let points = (0..200)
        .map(|index| {
            let t = f64::from(index) * 0.05;
            Vector3::new(0.02 * t - 0.1 + 0.06 * t.sin(), 0.1 * (0.9 * t).cos(), 0.01)
        })
        .collect();
    let rod = RenderedRod {
        points,
        radius: 0.015,
        colour: [210, 120, 90],
    };
    render(&camera, &[rod], |_| [10.0; 3], &RenderOptions::default())
}

struct Mutator(Dice);

impl Mutator {
    fn below(&mut self, limit: usize) -> usize {
        self.0.number() as usize % limit.max(1)
    }

    fn mutate(&mut self, original: &[u8]) -> Vec<u8> {
        let mut bytes = original.to_vec();
        for _ in 0..=self.below(6) {
            let place = self.below(bytes.len());
            match self.below(7) {
                0 => bytes[place] ^= 1 << self.below(8),
                1 => bytes[place] = [0, 1, 0x7f, 0x80, 0xfe, 0xff][self.below(6)],
                2 => bytes[place] = self.below(256) as u8,
                3 => bytes.truncate(place.max(1)),
                4 => {
                    let end = (place + self.below(40)).min(bytes.len());
                    let piece = bytes[place..end].to_vec();
                    let target = self.below(bytes.len());
                    bytes.splice(target..target, piece);
                }
                5 => {
                    let end = (place + 1 + self.below(20)).min(bytes.len());
                    if end - place < bytes.len() {
                        bytes.drain(place..end);
                    }
                }
                _ => {
                    let end = (place + 4).min(bytes.len());
                    bytes[place..end].fill(0xff);
                }
            }
        }
        // Half of the PNGs get correct checksums again, so that the decoder reaches the damage.
        if bytes.starts_with(&original[..8]) && original[0] == 0x89 && self.below(2) == 0 {
            mend_checksums(&mut bytes);
        }
        bytes
    }
}

fn mend_checksums(bytes: &mut [u8]) {
    let mut start = 8;
    while start + 12 <= bytes.len() {
        let length = bytes[start..].first_chunk().copied().unwrap_or_default();
        let length = u32::from_be_bytes(length) as usize;
        let Some(end) = start.checked_add(8).and_then(|at| at.checked_add(length)) else {
            return;
        };
        if end + 4 > bytes.len() {
            return;
        }
        let checksum = crc32(&bytes[start + 4..end]);
        bytes[end..end + 4].copy_from_slice(&checksum.to_be_bytes());
        start = end + 4;
    }
}

#[test]
fn mutated_files_give_an_error_or_a_result() {
    let count = std::env::var("RODLAB_MUTATIONS").ok();
    let count = count
        .and_then(|count| count.parse().ok())
        .unwrap_or(USUAL_MUTATIONS);
    let picture = small_picture();
    let mut jpeg = Vec::new();
    JpegEncoder::new_with_quality(&mut jpeg, 80)
        .encode_image(&picture)
        .expect("a JPEG");
    let originals = [encode_picture(&picture), jpeg];
    let rules =
        ["auto", "pen", "red", "pick:20,20"].map(|rule| ColourRule::parse(rule).expect("a rule"));
    let mut mutator = Mutator(Dice(20231));
    let (mut refused, mut decoded, mut traced) = (0u64, 0u64, 0u64);
    for round in 0..count {
        let bytes = mutator.mutate(&originals[(round % 2) as usize]);
        let picture = match decode_picture(&bytes) {
            Ok(picture) => picture,
            Err(reason) => {
                assert!(!reason.is_empty());
                refused += 1;
                continue;
            }
        };
        decoded += 1;
        // Damaged headers may give large pictures, which are only decoded.
        if picture.width() * picture.height() > 400_000 {
            continue;
        }
        let options = TraceOptions {
            colour: rules[(round / 2 % 4) as usize].clone(),
            least_area: 8,
            ..TraceOptions::default()
        };
        if let Ok(found) = trace(&picture, &options) {
            traced += 1;
            assert_eq!(found.labels.dimensions(), picture.dimensions());
        }
    }
    println!("{count} mutations: {refused} refused, {decoded} decoded, {traced} with strands");
    assert!(refused > 0 && decoded > 0 && traced > 0);
}

fn noise(width: u32, height: u32, bits: &[u8], grain: u32) -> RgbImage {
    RgbImage::from_fn(width, height, |u, v| {
        let index = (v / grain * width.div_ceil(grain) + u / grain) as usize;
        let value = bits[index % bits.len()];
        Rgb([value, value.wrapping_mul(3), 255 - value])
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]
    #[test]
    fn noise_is_traced_or_refused(
        width in 1u32..70,
        height in 1u32..70,
        grain in 1u32..9,
        rule in 0usize..6,
        bits in proptest::collection::vec(any::<u8>(), 1..3000),
    ) {
        let rule = ["auto", "pen", "white", "blue", "pick:0,0:40", "hsv:0-360,0-100,50-100"][rule];
        let picture = noise(width, height, &bits, grain);
        let options = TraceOptions {
            colour: ColourRule::parse(rule).expect("a rule"),
            least_area: 3,
            least_slenderness: 1.0,
            ..TraceOptions::default()
        };
        if let Ok(found) = trace(&picture, &options) {
            for strand in &found.strands {
                prop_assert_eq!(strand.points.len(), strand.widths.len());
                prop_assert!(strand.points.iter().all(|point| point.iter().all(|x| x.is_finite())));
            }
            overlay(&picture, &found);
            centrelines_csv(&found.strands, None).expect("a table");
        }
    }
}

#[test]
fn masks_without_lines_are_reported() {
    let dark = RgbImage::from_pixel(120, 90, Rgb([8, 9, 10]));
    let options = TraceOptions::default();
    let error = trace(&dark, &options)
        .expect_err("nothing there")
        .to_string();
    assert!(error.contains("the mask is empty"), "{error}");

    let white = RgbImage::from_pixel(120, 90, Rgb([250; 3]));
    let all = TraceOptions {
        colour: ColourRule::parse("white").expect("a rule"),
        ..TraceOptions::default()
    };
    let error = trace(&white, &all).expect_err("all of it").to_string();
    assert!(error.contains("100 %"), "{error}");

    let mut blob = dark.clone();
    for (u, v, pixel) in blob.enumerate_pixels_mut() {
        if (f64::from(u) - 60.0).hypot(f64::from(v) - 45.0) < 25.0 {
            *pixel = Rgb([200, 60, 60]);
        }
    }
    let error = trace(&blob, &options).expect_err("a disc").to_string();
    assert!(error.contains("not a line"), "{error}");
}

#[test]
fn strands_may_leave_the_picture() {
    let mut picture = RgbImage::from_pixel(200, 100, Rgb([8, 9, 10]));
    for (u, v, pixel) in picture.enumerate_pixels_mut() {
        if (f64::from(v) - 50.0 - 0.1 * f64::from(u)).abs() < 5.0 {
            *pixel = Rgb([200, 60, 60]);
        }
    }
    let found = trace(&picture, &TraceOptions::default()).expect("a strand");
    assert_eq!(found.strands.len(), 1);
    let strand = &found.strands[0];
    let (first, last) = (strand.points[0], strand.points[strand.points.len() - 1]);
    assert!(first.x.min(last.x) < 1.0 && first.x.max(last.x) > 198.0);
    for point in &strand.points {
        assert!((point.y - 50.0 - 0.1 * point.x).abs() < 0.5, "{point}");
    }
}
