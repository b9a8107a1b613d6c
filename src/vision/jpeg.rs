//! The segments of a JPEG file, up to its end marker (ITU-T T.81, annex B).
//!
//! A camera stores a thumbnail, which is a complete JPEG file, inside an APPn segment. Since the
//! end marker of the thumbnail does not end the main picture, the file is read segment by segment.

/// Start of the image, end of the image and start of a scan.
const START_OF_IMAGE: u8 = 0xd8;
const END_OF_IMAGE: u8 = 0xd9;
const START_OF_SCAN: u8 = 0xda;
/// Markers without a segment: TEM and the restart markers.
const TEMPORARY: u8 = 0x01;
const RESTARTS: std::ops::RangeInclusive<u8> = 0xd0..=0xd7;

/// Whether a JPEG file is complete up to the end marker of its main image. Segments are skipped by
/// their lengths. The coded data of a scan end at the first marker that is not a restart marker; a
/// data byte 0xff is followed by a zero, so that it is not a marker.
pub fn has_end_of_image(bytes: &[u8]) -> bool {
    if !bytes.starts_with(&[0xff, START_OF_IMAGE]) {
        return false;
    }
    let mut at = 2;
    let mut has_scan = false;
    while let Some((marker, after)) = next_marker(bytes, at) {
        at = match marker {
            END_OF_IMAGE => return has_scan,
            TEMPORARY => after,
            marker if RESTARTS.contains(&marker) => after,
            marker => {
                has_scan |= marker == START_OF_SCAN;
                let Some(length) = bytes.get(after..after + 2) else {
                    return false;
                };
                after + usize::from(u16::from_be_bytes([length[0], length[1]])).max(2)
            }
        };
    }
    false
}

/// The next marker from a position, and the position after it. The bytes before it are coded data
/// or padding.
fn next_marker(bytes: &[u8], from: usize) -> Option<(u8, usize)> {
    let rest = bytes.get(from..)?;
    let pairs = rest.windows(2).enumerate();
    let mut markers = pairs.filter(|(_, pair)| pair[0] == 0xff && !matches!(pair[1], 0x00 | 0xff));
    markers
        .next()
        .map(|(index, pair)| (pair[1], from + index + 2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::codecs::jpeg::JpegEncoder;

    /// A JPEG file with a thumbnail in an APP1 segment and an end marker in a comment.
    fn photograph() -> (Vec<u8>, usize) {
        let picture = image::RgbImage::from_fn(64, 48, |u, v| {
            image::Rgb([(7 * u) as u8, (5 * v) as u8, (3 * u * v) as u8])
        });
        let encoded = |side: u32| {
            let mut bytes = Vec::new();
            let part = image::imageops::crop_imm(&picture, 0, 0, side, side).to_image();
            let mut encoder = JpegEncoder::new_with_quality(&mut bytes, 90);
            encoder.encode_image(&part).expect("a JPEG file");
            bytes
        };
        let (main, thumbnail) = (encoded(48), encoded(16));
        let segment = |marker: u8, payload: &[u8]| {
            let length = u16::try_from(payload.len() + 2).expect("a short segment");
            [&[0xff, marker], &length.to_be_bytes()[..], payload].concat()
        };
        let inserted = [
            segment(0xe1, &[b"Exif\0\0", &thumbnail[..]].concat()),
            segment(0xfe, b"\xff\xd9 in a comment"),
        ]
        .concat();
        let whole = [&main[..2], &inserted[..], &main[2..]].concat();
        (whole, 2 + inserted.len())
    }

    #[test]
    fn no_part_of_a_photograph_with_a_thumbnail_passes_as_whole() {
        let (whole, _) = photograph();
        assert!(has_end_of_image(&whole));
        for end in 0..whole.len() {
            assert!(!has_end_of_image(&whole[..end]), "{end} bytes");
        }
        // Data after the end marker, such as the video of a moving photograph, is not part of the
        // picture.
        assert!(has_end_of_image(
            &[&whole[..], b"more \xff\xd8 bytes"].concat()
        ));
    }

    #[test]
    fn a_cut_photograph_is_refused_by_the_reader_of_pictures() {
        let (whole, thumbnail_end) = photograph();
        let read = super::super::decode_picture;
        assert_eq!(read(&whole).expect("a picture").width(), 48);
        for end in [
            thumbnail_end + 1,
            (thumbnail_end + whole.len()) / 2,
            whole.len() - 1,
        ] {
            let error = read(&whole[..end]).expect_err("a part of a photograph");
            assert!(error.contains("truncated"), "{error}");
        }
    }
}
