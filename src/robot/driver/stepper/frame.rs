//! Frames: a sequence number, a kind, data and a checksum, stuffed so that no byte is zero,
//! followed by a zero.
//!
//! The stuffing is Consistent Overhead Byte Stuffing (Cheshire & Baker 1999), so that a zero
//! always ends a frame, wherever a receiver starts. The checksum is CRC-16/GENIBUS.

/// Longest frame, bytes before stuffing.
pub const LONGEST: usize = 32;

/// CRC-16/GENIBUS: polynomial 0x1021 from 0xFFFF, inverted. Without the inversion, a frame whose
/// checksum ends with a zero would also be valid if the line repeats that zero.
pub fn checksum(bytes: &[u8]) -> u16 {
    !bytes.iter().fold(0xFFFF, |mut crc, byte| {
        crc ^= u16::from(*byte) << 8;
        for _ in 0..8 {
            crc = if crc & 0x8000 == 0 {
                crc << 1
            } else {
                crc << 1 ^ 0x1021
            };
        }
        crc
    })
}

/// A frame ready for the line.
pub fn encode(sequence: u8, kind: u8, data: &[u8]) -> Vec<u8> {
    let mut plain = vec![sequence, kind];
    plain.extend(data);
    plain.extend(checksum(&plain).to_be_bytes());
    let mut stuffed = Vec::with_capacity(plain.len() + 2);
    for run in plain.split(|byte| *byte == 0) {
        // Frames are shorter than 254 bytes, so that a run always fits its length byte.
        stuffed.push(run.len() as u8 + 1);
        stuffed.extend(run);
    }
    stuffed.push(0);
    stuffed
}

/// A received frame.
#[derive(Debug, PartialEq, Eq)]
pub struct Frame {
    /// Sequence number of the frame.
    pub sequence: u8,
    /// Kind of the frame.
    pub kind: u8,
    /// Data of the frame.
    pub data: Vec<u8>,
}

/// Decodes the bytes before a zero; `None` if they are damaged.
pub fn decode(stuffed: &[u8]) -> Option<Frame> {
    let mut plain = Vec::with_capacity(stuffed.len());
    let mut rest = stuffed;
    while let Some((length, tail)) = rest.split_first() {
        let run = usize::from(*length).checked_sub(1)?;
        if run > tail.len() {
            return None;
        }
        plain.extend(&tail[..run]);
        rest = &tail[run..];
        if !rest.is_empty() {
            plain.push(0);
        }
    }
    let (body, sum) = plain.split_at_checked(plain.len().checked_sub(2)?)?;
    let (sequence, body_tail) = body.split_first()?;
    let (kind, data) = body_tail.split_first()?;
    (checksum(body).to_be_bytes() == *sum).then(|| Frame {
        sequence: *sequence,
        kind: *kind,
        data: data.to_vec(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_checksum_is_the_standard_one() {
        assert_eq!(checksum(b"123456789"), 0xD64E);
    }

    #[test]
    fn repeated_zeros_after_a_frame_are_detected() {
        for sequence in 0..=255 {
            for data in 0..=255 {
                let plain = [sequence, 2, data];
                let sum = checksum(&plain).to_be_bytes();
                let longer = [&plain[..], &sum, &[0]].concat();
                let (body, tail) = longer.split_at(longer.len() - 2);
                assert_ne!(checksum(body).to_be_bytes(), tail, "{plain:?}");
            }
        }
    }

    proptest! {
        #[test]
        fn frames_read_back(sequence: u8, kind: u8, data in prop::collection::vec(any::<u8>(), 0..24)) {
            let stuffed = encode(sequence, kind, &data);
            prop_assert_eq!(stuffed.iter().filter(|byte| **byte == 0).count(), 1);
            let frame = decode(&stuffed[..stuffed.len() - 1]).unwrap();
            prop_assert_eq!(frame, Frame { sequence, kind, data });
        }

        #[test]
        fn a_changed_byte_is_detected(data in prop::collection::vec(any::<u8>(), 0..24), at: prop::sample::Index, flip in 1..=255u8) {
            let mut stuffed = encode(7, 2, &data);
            stuffed.pop();
            let index = at.index(stuffed.len());
            stuffed[index] ^= flip;
            prop_assert_eq!(decode(&stuffed), None);
        }

        #[test]
        fn no_bytes_cause_a_panic(bytes in prop::collection::vec(any::<u8>(), 0..40)) {
            let _ = decode(&bytes);
        }
    }
}
