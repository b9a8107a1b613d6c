//! Records of bags of ROS 1: headers of named fields, data, and chunks of records.

use lz4_flex::frame::FrameDecoder;
use std::io::{ErrorKind, Read};

/// Largest header of a record.
const LARGEST_HEADER: usize = 1 << 20;
/// Largest chunk and largest message, bytes: enough for ten pictures of eight million pixels.
const LARGEST_DATA: usize = 256 << 20;

/// A header of fields `name=value`, each after its length, and data.
pub struct Record {
    /// The fields.
    pub header: Vec<u8>,
    /// The rest.
    pub data: Vec<u8>,
}

/// Decompresses the records of a chunk, `size` bytes.
///
/// # Errors
/// A message if the compression is unknown, or the chunk is damaged or too large.
pub fn decompressed(
    compression: Option<&[u8]>,
    data: Vec<u8>,
    size: usize,
) -> Result<Vec<u8>, String> {
    if size > LARGEST_DATA {
        return Err(format!(
            "a chunk has {size} bytes; allowed: at most {LARGEST_DATA}"
        ));
    }
    match compression {
        None | Some(b"none") if data.len() == size => Ok(data),
        None | Some(b"none") => Err("a chunk is damaged".into()),
        Some(b"lz4") => decode_lz4(&data, size),
        Some(other) => Err(format!(
            "its chunks are compressed by {}; allowed: none and lz4 (`rosbag decompress` writes such a bag)",
            String::from_utf8_lossy(other)
        )),
    }
}

/// Decodes an LZ4 frame of exactly `size` bytes, and at most one additional block.
fn decode_lz4(frame: &[u8], size: usize) -> Result<Vec<u8>, String> {
    let mut decoded = Vec::new();
    let mut bounded = FrameDecoder::new(frame).take(size as u64 + 1);
    match bounded.read_to_end(&mut decoded) {
        Ok(read) if read == size => Ok(decoded),
        _ => Err("its LZ4 data is damaged".into()),
    }
}

/// The next record of a file; `None` at its end.
///
/// # Errors
/// A message if the file is truncated or cannot be read.
pub fn read_record(file: &mut impl Read) -> Result<Option<Record>, String> {
    let mut first = [0; 4];
    let count = read_up_to(file, &mut first)?;
    if count == 0 {
        return Ok(None);
    }
    if count < first.len() {
        return Err("it is truncated".into());
    }
    let header = read_sized(file, u32::from_le_bytes(first) as usize, LARGEST_HEADER)?;
    let mut size = [0; 4];
    if read_up_to(file, &mut size)? < size.len() {
        return Err("it is truncated".into());
    }
    let data = read_sized(file, u32::from_le_bytes(size) as usize, LARGEST_DATA)?;
    Ok(Some(Record { header, data }))
}

/// Reads until the buffer is full or the file ends.
fn read_up_to(file: &mut impl Read, buffer: &mut [u8]) -> Result<usize, String> {
    let mut count = 0;
    while count < buffer.len() {
        match file.read(&mut buffer[count..]) {
            Ok(0) => break,
            Ok(read) => count += read,
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(format!("cannot be read: {error}")),
        }
    }
    Ok(count)
}

/// Reads `size` bytes; the memory grows with the data, so that a damaged size cannot exhaust it.
fn read_sized(file: &mut impl Read, size: usize, most: usize) -> Result<Vec<u8>, String> {
    if size > most {
        return Err(format!(
            "a record of {size} bytes is too large or damaged; allowed: at most {most}"
        ));
    }
    let mut bytes = Vec::new();
    let read = file.take(size as u64).read_to_end(&mut bytes);
    read.map_err(|error| format!("cannot be read: {error}"))?;
    if bytes.len() < size {
        return Err("it is truncated".into());
    }
    Ok(bytes)
}

/// Splits off the header and data of the first record.
pub fn split_record<'a>(rest: &mut &'a [u8]) -> Option<(&'a [u8], &'a [u8])> {
    let mut part = || {
        let size = u32_of(rest.get(..4)?)? as usize;
        let (part, behind) = rest.get(4..)?.split_at_checked(size)?;
        *rest = behind;
        Some(part)
    };
    Some((part()?, part()?))
}

/// The value of a field `name=value` of a header.
pub fn field<'a>(mut header: &'a [u8], name: &str) -> Option<&'a [u8]> {
    while !header.is_empty() {
        let size = u32_of(header.get(..4)?)? as usize;
        let (entry, rest) = header.get(4..)?.split_at_checked(size)?;
        let (key, value) = entry.split_at(entry.iter().position(|byte| *byte == b'=')?);
        if key == name.as_bytes() {
            return value.get(1..);
        }
        header = rest;
    }
    None
}

/// Kind of the record.
pub fn op(header: &[u8]) -> Option<u8> {
    match field(header, "op")? {
        [op] => Some(*op),
        _ => None,
    }
}

/// A number of four bytes.
pub fn u32_of(bytes: &[u8]) -> Option<u32> {
    Some(u32::from_le_bytes(bytes.try_into().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// An LZ4 frame with independent blocks: twenty letters a, then "bcd".
    fn frame() -> Vec<u8> {
        let descriptor = [0x04, 0x22, 0x4d, 0x18, 0x60, 0x40, 0x82];
        // Token 0x1f: one literal, then a match of 15 + 0 + 4 bytes at offset 1; then three
        // literals.
        let block = [0x1f, b'a', 1, 0, 0, 0x30, b'b', b'c', b'd'];
        let size = (block.len() as u32).to_le_bytes();
        [&descriptor[..], &size, &block, &[0; 4]].concat()
    }

    #[test]
    fn fields_are_found_by_their_names() {
        let mut header = Vec::new();
        for entry in [&b"op=\x02"[..], b"topic=/a=b", b"conn=\x07\0\0\0"] {
            header.extend((entry.len() as u32).to_le_bytes());
            header.extend(entry);
        }
        assert_eq!(op(&header), Some(2));
        assert_eq!(field(&header, "topic"), Some(&b"/a=b"[..]));
        assert_eq!(field(&header, "conn").and_then(u32_of), Some(7));
        assert_eq!(field(&header, "time"), None);
        assert_eq!(field(&header[..header.len() - 1], "conn"), None);
    }

    #[test]
    fn memory_is_not_allocated_by_stated_sizes() {
        let mut record = 4u32.to_le_bytes().to_vec();
        record.extend([0; 4]);
        record.extend((LARGEST_DATA as u32).to_le_bytes());
        record.extend(b"short");
        let error = read_record(&mut &record[..]).err().unwrap();
        assert_eq!(error, "it is truncated");
        record[8..12].fill(0xff);
        let error = read_record(&mut &record[..]).err().unwrap();
        assert!(error.contains("too large"), "{error}");
        assert!(read_record(&mut &record[..0]).unwrap().is_none());
    }

    #[test]
    fn unknown_compressions_are_named() {
        let error = decompressed(Some(b"bz2"), vec![1, 2], 4).unwrap_err();
        assert!(error.contains("bz2") && error.contains("lz4"), "{error}");
        assert_eq!(decompressed(Some(b"none"), vec![1, 2], 2).unwrap(), [1, 2]);
        assert!(decompressed(None, vec![1, 2], 3).is_err());
    }

    #[test]
    fn compressed_chunks_have_the_size_of_their_record() {
        let expected = [&[b'a'; 20][..], b"bcd"].concat();
        assert_eq!(decompressed(Some(b"lz4"), frame(), 23).unwrap(), expected);
        for wrong in [0, 22, 24] {
            assert!(decompressed(Some(b"lz4"), frame(), wrong).is_err());
        }
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
            if let Ok(decoded) = decode_lz4(&bytes, size) {
                prop_assert_eq!(decoded.len(), size);
            }
        }
    }
}
