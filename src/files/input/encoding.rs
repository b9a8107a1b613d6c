//! Decoding of XML files.

/// Decodes an XML file: UTF-8, UTF-16 with a byte order mark, or otherwise Latin-1, in which every
/// byte is a letter. Names and comments in other encodings are decoded wrongly; markup and numbers
/// are the same in all of them.
pub fn xml_text(bytes: &[u8]) -> String {
    let units = |of: fn([u8; 2]) -> u16| {
        let pairs = bytes[2..].chunks_exact(2);
        let units: Vec<u16> = pairs.map(|pair| of([pair[0], pair[1]])).collect();
        String::from_utf16_lossy(&units)
    };
    match bytes {
        [0xff, 0xfe, ..] => units(u16::from_le_bytes),
        [0xfe, 0xff, ..] => units(u16::from_be_bytes),
        _ => {
            let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
            match std::str::from_utf8(bytes) {
                Ok(text) => text.to_owned(),
                Err(_) => bytes.iter().copied().map(char::from).collect(),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_read_in_their_encoding() {
        let text = "<a b='größe'/>";
        let latin: Vec<u8> = text.chars().map(|letter| u32::from(letter) as u8).collect();
        let utf_16 = |of: fn(u16) -> [u8; 2]| text.encode_utf16().flat_map(of).collect::<Vec<u8>>();
        for bytes in [
            text.as_bytes().to_vec(),
            [b"\xef\xbb\xbf", text.as_bytes()].concat(),
            latin,
            [&[0xff, 0xfe], &utf_16(u16::to_le_bytes)[..]].concat(),
            [&[0xfe, 0xff], &utf_16(u16::to_be_bytes)[..]].concat(),
        ] {
            assert_eq!(xml_text(&bytes), text, "{bytes:?}");
        }
        for odd in [&b""[..], b"\xff\xfe", b"\xfe\xff\x00", b"\xff"] {
            let _ = xml_text(odd);
        }
    }
}
