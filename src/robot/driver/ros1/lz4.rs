//! The LZ4 frame format (github.com/lz4/lz4, doc/lz4_Frame_format.md, version 1.6.4), as chunks of bags use it.
//!
//! Checksums are passed over: what matters is that damage neither panics nor takes memory.

const MAGIC: [u8; 4] = 0x184d_2204u32.to_le_bytes();
/// Shortest match.
const LEAST_MATCH: usize = 4;

/// Decodes a frame of exactly `size` bytes.
///
/// # Errors
/// In words: it is no such frame, it is damaged, or it holds more or less.
pub fn decode_frame(bytes: &[u8], size: usize) -> Result<Vec<u8>, String> {
    const DAMAGED: &str = "its LZ4 data is damaged";
    decode(bytes, size)
        .filter(|decoded| decoded.len() == size)
        .ok_or_else(|| DAMAGED.to_owned())
}

fn decode(bytes: &[u8], size: usize) -> Option<Vec<u8>> {
    let mut input = bytes.strip_prefix(&MAGIC)?;
    let [flags, _] = *take(&mut input, 2)? else {
        return None;
    };
    let has = |bit: u8| flags & (1 << bit) != 0;
    if flags >> 6 != 1 || has(0) {
        // Another version, or a dictionary that is not here.
        return None;
    }
    let content_size = if has(3) { 8 } else { 0 };
    // The descriptor's checksum has one byte.
    take(&mut input, content_size + 1)?;
    let mut decoded = Vec::new();
    loop {
        let header = u32::from_le_bytes(take(&mut input, 4)?.try_into().ok()?);
        if header == 0 {
            return Some(decoded);
        }
        let block = take(&mut input, (header & 0x7fff_ffff) as usize)?;
        if header >> 31 == 1 {
            if decoded.len() + block.len() > size {
                return None;
            }
            decoded.extend_from_slice(block);
        } else {
            decode_block(block, &mut decoded, size)?;
        }
        if has(4) {
            take(&mut input, 4)?;
        }
    }
}

/// Appends a block: literals and matches in turn, of which the last has literals only.
fn decode_block(mut input: &[u8], decoded: &mut Vec<u8>, most: usize) -> Option<()> {
    loop {
        let token = take(&mut input, 1)?[0];
        let literals = length(&mut input, usize::from(token >> 4))?;
        let literals = take(&mut input, literals)?;
        if decoded.len() + literals.len() > most {
            return None;
        }
        decoded.extend_from_slice(literals);
        if input.is_empty() {
            return Some(());
        }
        let offset = usize::from(u16::from_le_bytes(take(&mut input, 2)?.try_into().ok()?));
        let count = length(&mut input, usize::from(token & 15))? + LEAST_MATCH;
        let start = decoded.len().checked_sub(offset)?;
        if offset == 0 || count > most - decoded.len() {
            return None;
        }
        // A match may reach into what it makes.
        for index in start..start + count {
            decoded.push(decoded[index]);
        }
    }
}

/// A length of 15 goes on in the bytes that follow, up to the first that is not 255.
fn length(input: &mut &[u8], short: usize) -> Option<usize> {
    let mut length = short;
    if short == 15 {
        loop {
            let more = take(input, 1)?[0];
            length = length.checked_add(usize::from(more))?;
            if more != u8::MAX {
                break;
            }
        }
    }
    Some(length)
}

fn take<'a>(input: &mut &'a [u8], count: usize) -> Option<&'a [u8]> {
    let (head, tail) = input.split_at_checked(count)?;
    *input = tail;
    Some(head)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Magic number, version 1 with independent blocks, blocks of 64 KiB, and the checksum of these two.
    const DESCRIPTOR: [u8; 7] = [0x04, 0x22, 0x4d, 0x18, 0x60, 0x40, 0x82];

    /// Twenty letters a, then "bcd".
    fn frame() -> Vec<u8> {
        // Token 0x1f: one literal, match of 15 + 0 + 4 at offset 1; then three literals.
        let block = [0x1f, b'a', 1, 0, 0, 0x30, b'b', b'c', b'd'];
        let mut frame = DESCRIPTOR.to_vec();
        frame.extend((block.len() as u32).to_le_bytes());
        frame.extend(block);
        frame.extend([0; 4]);
        frame
    }

    #[test]
    fn matches_may_reach_into_themselves() {
        let expected = [&[b'a'; 20][..], b"bcd"].concat();
        assert_eq!(decode_frame(&frame(), 23).unwrap(), expected);
        for wrong in [0, 22, 24] {
            assert!(decode_frame(&frame(), wrong).is_err());
        }
    }

    #[test]
    fn stored_blocks_are_taken_as_they_are() {
        let mut stored = DESCRIPTOR.to_vec();
        stored.extend((3u32 | 1 << 31).to_le_bytes());
        stored.extend(b"xyz\0\0\0\0");
        assert_eq!(decode_frame(&stored, 3).unwrap(), b"xyz");
    }

    proptest! {
        #[test]
        fn damage_is_refused_or_decoded_within_its_bounds(
            places in proptest::collection::vec((0usize..24, any::<u8>()), 1..6),
            size in 0usize..4096,
        ) {
            let mut bytes = frame();
            for (place, value) in places {
                bytes[place] = value;
            }
            if let Ok(decoded) = decode_frame(&bytes, size) {
                prop_assert_eq!(decoded.len(), size);
            }
        }
    }
}
