//! Reading photographs, with bounds on what a file may ask for.

use super::VisionError;
use super::input::read_file;
use super::jpeg::has_end_of_image;
use image::{DynamicImage, ImageError, ImageReader, Limits, RgbImage};
use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// The most pixels along a side of an image.
pub const LONGEST_SIDE: u32 = 16_384;
/// The most pixels of an image. A decoded picture takes three bytes for each.
pub const MOST_PIXELS: u64 = 50_000_000;
/// The most bytes of an image file.
pub const LARGEST_FILE: u64 = 256 << 20;

/// Reads a PNG or JPEG file as 8-bit RGB.
///
/// # Errors
/// The file cannot be read, is neither PNG nor JPEG, is damaged or truncated, or is larger than [`MOST_PIXELS`].
pub fn read_picture(path: &Path) -> Result<RgbImage, VisionError> {
    let bytes = read_file(path, LARGEST_FILE)?;
    decode_picture(&bytes).map_err(|reason| VisionError::Malformed {
        path: path.into(),
        reason,
    })
}

/// Reads a label image: pixel = number of the strand, 0 = background.
///
/// # Errors
/// The file cannot be read, or is no image of 8-bit grey.
pub fn read_labels(path: &Path) -> Result<image::GrayImage, VisionError> {
    let bytes = read_file(path, LARGEST_FILE)?;
    decode_labels(&bytes).map_err(|reason| VisionError::Malformed {
        path: path.into(),
        reason,
    })
}

/// Decodes the bytes of a PNG or JPEG file as 8-bit RGB. Transparent pixels lose their transparency.
///
/// # Errors
/// In words: the bytes are neither PNG nor JPEG, are damaged or truncated, or promise more than [`MOST_PIXELS`].
pub fn decode_picture(bytes: &[u8]) -> Result<RgbImage, String> {
    Ok(decode(bytes)?.into_rgb8())
}

/// Decodes a label image: pixel = number of the strand, 0 = background. Colour is refused.
///
/// # Errors
/// As for [`decode_picture`], and images that are not 8-bit grey.
pub fn decode_labels(bytes: &[u8]) -> Result<image::GrayImage, String> {
    match decode(bytes)? {
        DynamicImage::ImageLuma8(labels) => Ok(labels),
        other => Err(format!(
            "a label image has one 8-bit channel, this one is {:?}",
            other.color()
        )),
    }
}

fn decode(bytes: &[u8]) -> Result<DynamicImage, String> {
    const NEITHER: &str = "neither a PNG nor a JPEG image";
    let format = image::guess_format(bytes).map_err(|_| NEITHER.to_string())?;
    match format {
        image::ImageFormat::Png => {}
        image::ImageFormat::Jpeg => {
            // The decoder fills missing rows with grey and reports no error.
            if !has_end_of_image(bytes) {
                return Err("the JPEG is truncated: its end-of-image marker is missing".to_string());
            }
        }
        _ => return Err(NEITHER.to_string()),
    }
    let mut limits = Limits::default();
    limits.max_image_width = Some(LONGEST_SIDE);
    limits.max_image_height = Some(LONGEST_SIDE);
    // 16-bit RGBA is the widest pixel of either format.
    limits.max_alloc = Some(MOST_PIXELS * 8 + (1 << 20));
    let reader = |limits: &Limits| {
        let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
        reader.limits(limits.clone());
        reader
    };
    let (width, height) = reader(&limits).into_dimensions().map_err(describe)?;
    if width == 0 || height == 0 {
        return Err(format!("the image has {width} × {height} pixels"));
    }
    if width.max(height) > LONGEST_SIDE || u64::from(width) * u64::from(height) > MOST_PIXELS {
        return Err(format!(
            "the image has {width} × {height} pixels; the most is {MOST_PIXELS}, {LONGEST_SIDE} along a side"
        ));
    }
    reader(&limits).decode().map_err(describe)
}

fn describe(error: ImageError) -> String {
    match error {
        ImageError::Limits(_) => format!(
            "the image is too large: the most is {MOST_PIXELS} pixels, {LONGEST_SIDE} along a side"
        ),
        ImageError::IoError(error) => format!("the image is truncated: {error}"),
        other => format!("the image is damaged: {other}"),
    }
}

/// The image files of a folder (`.png`, `.jpg`, `.jpeg`), in order of time: by name, numbers in names by value.
///
/// # Errors
/// The folder cannot be read, or holds no image.
pub fn pictures_in(folder: &Path) -> Result<Vec<PathBuf>, VisionError> {
    let unreadable = |reason: String| VisionError::Unreadable {
        path: folder.into(),
        reason,
    };
    let entries = fs::read_dir(folder).map_err(|error| unreadable(error.to_string()))?;
    let mut found = Vec::new();
    for entry in entries {
        let path = entry.map_err(|error| unreadable(error.to_string()))?.path();
        let extension = path.extension().and_then(|extension| extension.to_str());
        let is_picture = extension.is_some_and(|extension| {
            ["png", "jpg", "jpeg"]
                .iter()
                .any(|known| extension.eq_ignore_ascii_case(known))
        });
        if is_picture && path.is_file() {
            found.push(path);
        }
    }
    if found.is_empty() {
        return Err(unreadable("it holds no .png, .jpg or .jpeg file".into()));
    }
    found.sort_by_cached_key(|path| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        (natural_key(&name), name.into_owned())
    });
    Ok(found)
}

/// Pieces of a name such that `frame_9` sorts before `frame_10`: runs of digits compare by length, then by digit.
fn natural_key(name: &str) -> Vec<(usize, String)> {
    let mut pieces: Vec<(usize, String)> = Vec::new();
    let mut digits_before = None;
    for character in name.chars() {
        let digit = character.is_ascii_digit();
        if digits_before != Some(digit) {
            pieces.push((0, String::new()));
            digits_before = Some(digit);
        }
        let piece = pieces.last_mut().expect("a piece was just begun");
        if digit && piece.1 == "0" {
            piece.1.clear();
            piece.0 = 0;
        }
        piece.1.push(character);
        if digit {
            piece.0 += 1;
        }
    }
    pieces
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};

    fn png(width: u32, height: u32) -> Vec<u8> {
        let mut bytes = Vec::new();
        let pixels = vec![40; (width * height * 3) as usize];
        PngEncoder::new(&mut bytes)
            .write_image(&pixels, width, height, ExtendedColorType::Rgb8)
            .expect("a PNG");
        bytes
    }

    #[test]
    fn frames_come_in_order_of_their_numbers() {
        let mut names = ["f10.png", "f9.png", "f010.png", "a2.png", "f100.png"];
        names.sort_by_key(|name| natural_key(name));
        assert_eq!(names[0], "a2.png");
        assert_eq!(names[1], "f9.png");
        assert_eq!(names[4], "f100.png");
    }

    #[test]
    fn a_truncated_png_is_named() {
        let bytes = png(20, 10);
        assert_eq!(decode_picture(&bytes).expect("a picture").width(), 20);
        let error = decode_picture(&bytes[..bytes.len() / 2]).expect_err("half a PNG");
        assert!(
            error.contains("truncated") || error.contains("damaged"),
            "{error}"
        );
    }

    #[test]
    fn a_header_that_promises_gigabytes_is_refused() {
        let mut bytes = png(20, 10);
        // Width and height of the PNG's header, and its checksum.
        bytes[16..24].copy_from_slice(&[0, 0, 0x3f, 0xff, 0, 0, 0x3f, 0xff]);
        let checksum = crc32(&bytes[12..29]);
        bytes[29..33].copy_from_slice(&checksum.to_be_bytes());
        let error = decode_picture(&bytes).expect_err("16383 squared pixels");
        assert!(error.contains("16383"), "{error}");
    }

    #[test]
    fn other_files_are_neither() {
        let error = decode_picture(b"GIF89a....").expect_err("a GIF");
        assert!(error.contains("neither"), "{error}");
        assert!(decode_picture(b"").is_err());
    }

    /// The checksum of the chunks of a PNG file.
    pub fn crc32(bytes: &[u8]) -> u32 {
        let mut crc = !0u32;
        for byte in bytes {
            crc ^= u32::from(*byte);
            for _ in 0..8 {
                crc = (crc >> 1) ^ (0xedb8_8320 & (crc & 1).wrapping_neg());
            }
        }
        !crc
    }
}
