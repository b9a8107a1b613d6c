//! Pictures from cameras: pixels in one of the encodings of `sensor_msgs/Image`, or files.

use super::DriverError;
use image::RgbImage;
use std::time::Duration;

/// Largest message with a picture, bytes.
pub(super) const LARGEST_PICTURE: usize = 64 << 20;

/// A received picture.
#[derive(Clone, Debug, PartialEq)]
pub enum CameraPicture {
    /// Pixels of the picture.
    Pixels(RgbImage),
    /// A PNG or JPEG file.
    File(Vec<u8>),
}

/// A topic of pictures of a camera: `sensor_msgs/Image`, or `sensor_msgs/CompressedImage` if its
/// name ends in `/compressed`.
pub trait PictureTopic {
    /// The newest picture; older ones are skipped. If none has arrived since the last call, waits
    /// for the next one.
    ///
    /// # Errors
    /// No picture arrives in time, or it is damaged or has an unknown encoding.
    fn picture(&mut self, patience: Duration) -> Result<CameraPicture, DriverError>;
}

/// Whether a topic sends files.
pub(super) fn sends_files(topic: &str) -> bool {
    topic.rsplit('/').next() == Some("compressed")
}

/// Fields of a `sensor_msgs/Image`.
#[derive(Debug, PartialEq, Eq)]
pub struct RawImage<'a> {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Such as `rgb8`.
    pub encoding: String,
    /// Whether numbers of two bytes are big-endian.
    pub is_big_endian: bool,
    /// Number of bytes per row.
    pub step: usize,
    /// Rows from top to bottom.
    pub data: &'a [u8],
}

/// Conversion of the bytes of a pixel to red, green and blue.
struct Encoding {
    name: &'static str,
    bytes: usize,
    colours: [usize; 3],
}

/// Supported encodings. Of two-byte numbers, the more significant byte is used.
const ENCODINGS: [Encoding; 10] = [
    encoding("rgb8", 3, [0, 1, 2]),
    encoding("bgr8", 3, [2, 1, 0]),
    encoding("rgba8", 4, [0, 1, 2]),
    encoding("bgra8", 4, [2, 1, 0]),
    encoding("mono8", 1, [0; 3]),
    encoding("mono16", 2, [1; 3]),
    encoding("8UC1", 1, [0; 3]),
    encoding("8UC3", 3, [2, 1, 0]),
    encoding("8UC4", 4, [2, 1, 0]),
    encoding("16UC1", 2, [1; 3]),
];

const fn encoding(name: &'static str, bytes: usize, colours: [usize; 3]) -> Encoding {
    Encoding {
        name,
        bytes,
        colours,
    }
}

/// Red, green and blue of a picture's pixels.
pub(super) fn pixels(raw: &RawImage<'_>) -> Result<RgbImage, String> {
    let [width, height] = raw.size;
    let encoding = ENCODINGS
        .iter()
        .find(|encoding| encoding.name == raw.encoding)
        .ok_or_else(|| {
            let known = ENCODINGS.map(|encoding| encoding.name).join(", ");
            format!("its encoding is {:?}; allowed: {known}", raw.encoding)
        })?;
    let row = width as usize * encoding.bytes;
    let is_whole = width > 0
        && height > 0
        && row <= raw.step
        && raw.step.checked_mul(height as usize) == Some(raw.data.len());
    if !is_whole {
        return Err(format!(
            "{width} × {height} pixels do not fit its {} bytes",
            raw.data.len()
        ));
    }
    let mut colours = encoding.colours;
    if encoding.bytes == 2 && raw.is_big_endian {
        colours = [0; 3];
    }
    let rows = raw.data.chunks_exact(raw.step);
    let bytes = rows
        .flat_map(|bytes| bytes[..row].chunks_exact(encoding.bytes))
        .flat_map(|pixel| colours.map(|colour| pixel[colour]))
        .collect();
    RgbImage::from_raw(width, height, bytes).ok_or_else(|| "the picture is damaged".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn raw<'a>(encoding: &str, step: usize, data: &'a [u8]) -> RawImage<'a> {
        RawImage {
            size: [2, 1],
            encoding: encoding.into(),
            is_big_endian: false,
            step,
            data,
        }
    }

    #[test]
    fn every_encoding_gives_red_green_and_blue() {
        for (encoding, step, data, expected) in [
            ("rgb8", 6, &[1, 2, 3, 4, 5, 6][..], [1, 2, 3, 4, 5, 6]),
            // Rows may be padded.
            ("bgr8", 8, &[1, 2, 3, 4, 5, 6, 7, 8], [3, 2, 1, 6, 5, 4]),
            ("bgra8", 8, &[1, 2, 3, 0, 4, 5, 6, 0], [3, 2, 1, 6, 5, 4]),
            ("mono8", 2, &[7, 8], [7, 7, 7, 8, 8, 8]),
            ("mono16", 4, &[0, 7, 0, 8], [7, 7, 7, 8, 8, 8]),
        ] {
            let found = pixels(&raw(encoding, step, data)).unwrap();
            assert_eq!(found.as_raw()[..], expected, "{encoding}");
        }
        let big = RawImage {
            is_big_endian: true,
            ..raw("mono16", 4, &[7, 0, 8, 0])
        };
        assert_eq!(pixels(&big).unwrap().as_raw()[..], [7, 7, 7, 8, 8, 8]);
    }

    #[test]
    fn pictures_that_do_not_fit_their_bytes_are_refused() {
        for (encoding, step, data) in [
            ("rgb8", 5, &[0; 5][..]),
            ("rgb8", 6, &[0; 5]),
            ("rgb8", 6, &[0; 12]),
            ("mono8", usize::MAX, &[0; 2]),
        ] {
            assert!(pixels(&raw(encoding, step, data)).is_err());
        }
        let error = pixels(&raw("bayer_rggb8", 2, &[0; 2])).unwrap_err();
        assert!(error.contains("allowed: rgb8"), "{error}");
    }
}
