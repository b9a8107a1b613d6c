//! Reading of photographs, with limits on the memory that a file may need.

use super::VisionError;
use super::input::read_file;
use super::jpeg::has_end_of_image;
use image::{
    DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits, Rgb, RgbImage,
};
use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// Maximum number of pixels along a side of an image.
pub const LONGEST_SIDE: u32 = 16_384;
/// Maximum number of pixels of an image. A decoded picture takes three bytes per pixel.
pub const MOST_PIXELS: u64 = 50_000_000;
/// Maximum number of bytes of an image file.
pub const LARGEST_FILE: u64 = 256 << 20;

/// Endings of the files that are read as pictures, in lower case.
pub const PICTURE_ENDINGS: [&str; 7] = ["png", "jpg", "jpeg", "tif", "tiff", "bmp", "webp"];

/// Reads a PNG, JPEG, TIFF, BMP or WebP file as 8-bit RGB, rotated to the orientation of its
/// camera.
///
/// # Errors
/// The file cannot be read, has none of these formats, is damaged or truncated, or is larger than
/// [`MOST_PIXELS`].
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
/// The file cannot be read, or is not an image of 8-bit grey.
pub fn read_labels(path: &Path) -> Result<image::GrayImage, VisionError> {
    let bytes = read_file(path, LARGEST_FILE)?;
    decode_labels(&bytes).map_err(|reason| VisionError::Malformed {
        path: path.into(),
        reason,
    })
}

/// Decodes the bytes of a picture as 8-bit RGB, rotated to the orientation of its camera.
/// Transparent pixels are drawn on white.
///
/// # Errors
/// A message if the bytes have none of the formats of [`read_picture`], are damaged or truncated,
/// or have more than [`MOST_PIXELS`].
pub fn decode_picture(bytes: &[u8]) -> Result<RgbImage, String> {
    let picture = decode(bytes)?;
    if !picture.color().has_alpha() {
        return Ok(picture.into_rgb8());
    }
    let (width, height) = (picture.width(), picture.height());
    let layered = picture.into_rgba8();
    Ok(RgbImage::from_fn(width, height, |u, v| {
        let [red, green, blue, alpha] = layered.get_pixel(u, v).0.map(u16::from);
        let on_white = |value: u16| ((value * alpha + 255 * (255 - alpha) + 127) / 255) as u8;
        Rgb([red, green, blue].map(on_white))
    }))
}

/// Decodes a label image: pixel = number of the strand, 0 = background. Colour images are rejected.
///
/// # Errors
/// See [`decode_picture`]; also if the image is not 8-bit grey.
pub fn decode_labels(bytes: &[u8]) -> Result<image::GrayImage, String> {
    match decode(bytes)? {
        DynamicImage::ImageLuma8(labels) => Ok(labels),
        other => Err(format!(
            "a label image has one 8-bit channel, this one is {:?}",
            other.color()
        )),
    }
}

/// Whether a file is of the ISO format of HEIC and AVIF (ISO/IEC 23008-12): its box `ftyp` names a
/// brand of images.
fn is_heif(bytes: &[u8]) -> bool {
    const BRANDS: [&[u8]; 8] = [
        b"heic", b"heix", b"heim", b"heis", b"hevc", b"mif1", b"msf1", b"avif",
    ];
    bytes.get(4..8) == Some(b"ftyp")
        && bytes
            .get(8..12)
            .is_some_and(|brand| BRANDS.contains(&brand))
}

fn decode(bytes: &[u8]) -> Result<DynamicImage, String> {
    const NEITHER: &str = "neither a PNG nor a JPEG, TIFF, BMP or WebP image";
    if is_heif(bytes) {
        return Err(
            "HEIC and AVIF images of phones are not read; convert them first, as by `heif-convert photo.heic photo.jpg`"
                .to_string(),
        );
    }
    let format = image::guess_format(bytes).map_err(|_| NEITHER.to_string())?;
    match format {
        ImageFormat::Png | ImageFormat::Tiff | ImageFormat::Bmp | ImageFormat::WebP => {}
        // The decoder fills missing rows with grey and reports no error.
        ImageFormat::Jpeg if has_end_of_image(bytes) => {}
        ImageFormat::Jpeg => {
            return Err("the JPEG is truncated: its end-of-image marker is missing".to_string());
        }
        _ => return Err(NEITHER.to_string()),
    }
    let mut limits = Limits::default();
    limits.max_image_width = Some(LONGEST_SIDE);
    limits.max_image_height = Some(LONGEST_SIDE);
    // 16-bit RGBA is the widest pixel format that is read.
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
            "the image has {width} × {height} pixels; allowed: at most {MOST_PIXELS}, {LONGEST_SIDE} along a side"
        ));
    }
    let mut decoder = reader(&limits).into_decoder().map_err(describe)?;
    // Larger images are rejected before memory is allocated.
    if decoder.total_bytes() > MOST_PIXELS * 8 {
        return Err(describe(ImageError::Limits(
            image::error::LimitError::from_kind(image::error::LimitErrorKind::InsufficientMemory),
        )));
    }
    // A damaged orientation entry does not make the picture invalid.
    let orientation = decoder
        .orientation()
        .unwrap_or(image::metadata::Orientation::NoTransforms);
    let mut picture = DynamicImage::from_decoder(decoder).map_err(describe)?;
    picture.apply_orientation(orientation);
    Ok(picture)
}

fn describe(error: ImageError) -> String {
    match error {
        ImageError::Limits(_) => format!(
            "the image is too large; allowed: at most {MOST_PIXELS} pixels, {LONGEST_SIDE} along a side"
        ),
        ImageError::IoError(error) => format!("the image is truncated: {error}"),
        other => format!("the image is damaged: {other}"),
    }
}

/// The image files of a folderwith one of the [`PICTURE_ENDINGS`], in chronological order: sorted
/// by name, with numbers in names by value.
///
/// # Errors
/// The folder cannot be read, or has no image.
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
            PICTURE_ENDINGS
                .iter()
                .any(|known| extension.eq_ignore_ascii_case(known))
        });
        if is_picture && path.is_file() {
            found.push(path);
        }
    }
    if found.is_empty() {
        return Err(unreadable(format!(
            "it has no file whose name ends in {}",
            PICTURE_ENDINGS.join(", ")
        )));
    }
    found.sort_by_cached_key(|path| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        (natural_key(&name), name.into_owned())
    });
    Ok(found)
}

/// Splits a name into pieces so that `frame_9` sorts before `frame_10`. Runs of digits compare by
/// length, then by digits.
fn natural_key(name: &str) -> Vec<(usize, String)> {
    let mut pieces: Vec<(usize, String)> = Vec::new();
    let mut digits_before = None;
    for character in name.chars() {
        let digit = character.is_ascii_digit();
        if digits_before != Some(digit) {
            pieces.push((0, String::new()));
            digits_before = Some(digit);
        }
        let piece = pieces.last_mut().expect("a piece was just started");
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
    fn a_picture_of_a_phone_in_heic_gets_a_conversion() {
        for brand in [b"heic", b"mif1", b"avif"] {
            let bytes = [&[0, 0, 0, 24][..], b"ftyp", &brand[..], &[0; 12]].concat();
            let error = decode_picture(&bytes).expect_err("HEIC");
            assert!(error.contains("heif-convert"), "{error}");
        }
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
        // Width and height in the header of a PNG, and its checksum.
        bytes[16..24].copy_from_slice(&[0, 0, 0x3f, 0xff, 0, 0, 0x3f, 0xff]);
        let checksum = crc32(&bytes[12..29]);
        bytes[29..33].copy_from_slice(&checksum.to_be_bytes());
        let error = decode_picture(&bytes).expect_err("16383 squared pixels");
        assert!(error.contains("16383"), "{error}");
    }

    #[test]
    fn pictures_of_all_formats_and_depths_are_read() {
        use image::{DynamicImage, ImageFormat, Rgb, RgbImage};
        let colours = RgbImage::from_fn(6, 4, |u, v| Rgb([40 * u as u8, 60 * v as u8, 200]));
        let picture = DynamicImage::ImageRgb8(colours.clone());
        let bytes = |picture: &DynamicImage, format: ImageFormat| {
            let mut bytes = std::io::Cursor::new(Vec::new());
            picture.write_to(&mut bytes, format).expect("a picture");
            bytes.into_inner()
        };
        for format in [
            ImageFormat::Png,
            ImageFormat::Tiff,
            ImageFormat::Bmp,
            ImageFormat::WebP,
        ] {
            let whole = bytes(&picture, format);
            assert_eq!(
                decode_picture(&whole).expect("a picture"),
                colours,
                "{format:?}"
            );
            assert!(
                decode_picture(&whole[..whole.len() / 2]).is_err(),
                "{format:?}"
            );
        }
        for format in [ImageFormat::Png, ImageFormat::Tiff] {
            let deep = DynamicImage::ImageRgb16(picture.to_rgb16());
            assert_eq!(
                decode_picture(&bytes(&deep, format)).expect("16 bits"),
                colours
            );
        }
    }

    #[test]
    fn transparent_pixels_are_drawn_on_white() {
        let mut bytes = Vec::new();
        PngEncoder::new(&mut bytes)
            .write_image(
                &[0, 0, 0, 0, 10, 20, 30, 255, 0, 0, 0, 128],
                3,
                1,
                ExtendedColorType::Rgba8,
            )
            .expect("a PNG");
        let picture = decode_picture(&bytes).expect("a picture");
        assert_eq!(
            picture.as_raw()[..],
            [255, 255, 255, 10, 20, 30, 127, 127, 127]
        );
    }

    #[test]
    fn a_picture_is_turned_as_its_camera_was_held() {
        let picture = image::RgbImage::from_fn(16, 8, |u, _| image::Rgb([15 * u as u8; 3]));
        let mut bytes = Vec::new();
        image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, 95)
            .encode_image(&picture)
            .expect("a JPEG");
        for (orientation, size, first_is_dark) in [
            (1, (16, 8), true),
            (3, (16, 8), false),
            (6, (8, 16), true),
            (8, (8, 16), false),
            (99, (16, 8), true),
        ] {
            // An EXIF block with the single entry 0x0112 (EXIF 2.3, sec. 4.6).
            let exif = [
                &b"Exif\0\0MM\0\x2a\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0"[..],
                &[orientation],
                &b"\0\0\0\0\0\0"[..],
            ]
            .concat();
            let length = u16::try_from(exif.len() + 2).expect("short").to_be_bytes();
            let turned = [&bytes[..2], &[0xff, 0xe1], &length, &exif, &bytes[2..]].concat();
            let read = decode_picture(&turned).expect("a picture");
            assert_eq!(read.dimensions(), size, "{orientation}");
            assert_eq!(
                read.get_pixel(0, 0).0[0] < 60,
                first_is_dark,
                "{orientation}"
            );
        }
    }

    #[test]
    fn other_files_are_rejected() {
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
