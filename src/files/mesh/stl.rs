//! STL files, binary or text.

use super::MOST_TRIANGLES;
use crate::finite;

/// Bytes of a binary file before its triangles, and bytes per triangle.
const HEADER: usize = 84;
const TRIANGLE: usize = 50;

/// The corners of the triangles of an STL file, in the order of the file.
///
/// A binary file is recognised by its length: its header may contain anything.
///
/// # Errors
/// A message if it is not an STL file.
pub fn corners(bytes: &[u8]) -> Result<Vec<[f64; 3]>, String> {
    let count = bytes
        .get(HEADER - 4..HEADER)
        .and_then(|bytes| bytes.try_into().ok())
        .map(|bytes| u32::from_le_bytes(bytes) as usize);
    if let Some(count) = count
        && bytes.len() == HEADER + count * TRIANGLE
    {
        if count > MOST_TRIANGLES {
            return Err(format!("has {count} triangles; allowed: {MOST_TRIANGLES}"));
        }
        let number = |at: &[u8]| {
            let bytes = at.try_into().unwrap_or_default();
            f64::from(f32::from_le_bytes(bytes))
        };
        let triangles = bytes[HEADER..].chunks_exact(TRIANGLE);
        // A normal, three corners, two bytes.
        let corners = triangles.flat_map(|triangle| triangle[12..48].chunks_exact(12));
        let corners: Vec<[f64; 3]> = corners
            .map(|corner| [0, 4, 8].map(|k| number(&corner[k..k + 4])))
            .collect();
        let checked = finite::check(corners.iter().flatten(), |index| {
            format!(
                "has a corner that is not finite: number {} of triangle {}",
                index % 9 + 1,
                index / 9 + 1
            )
        });
        return checked.map(|()| corners).map_err(|error| error.what);
    }
    let text = std::str::from_utf8(bytes)
        .ok()
        .filter(|text| text.trim_start().starts_with("solid"))
        .ok_or("is not a complete STL file")?;
    let mut words = text.split_whitespace();
    let mut corners = Vec::new();
    while let Some(word) = words.next() {
        if word == "vertex" {
            let mut number = || finite::number(words.next()?);
            let corner = (number(), number(), number());
            let (Some(x), Some(y), Some(z)) = corner else {
                return Err("has a `vertex` without three finite numbers".into());
            };
            corners.push([x, y, z]);
        }
        if corners.len() > 3 * MOST_TRIANGLES {
            return Err(format!("has too many triangles; allowed: {MOST_TRIANGLES}"));
        }
    }
    if !text.contains("endsolid") {
        return Err("is not a complete STL file".into());
    }
    Ok(corners)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const TEXT: &str = "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1e-1 0 0\nvertex 0 0.25 0\n\
                        endloop\nendfacet\nendsolid s\n";

    fn binary() -> Vec<u8> {
        let mut bytes = vec![0; 80];
        bytes.extend(1_u32.to_le_bytes());
        let numbers = [
            0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 0.25, 0.0_f32,
        ];
        bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        bytes.extend([0, 0]);
        bytes
    }

    #[test]
    fn text_and_binary_files_have_the_same_corners() {
        let from_text = corners(TEXT.as_bytes()).unwrap();
        assert_eq!(from_text, [[0.0; 3], [0.1, 0.0, 0.0], [0.0, 0.25, 0.0]]);
        let from_binary = corners(&binary()).unwrap();
        for (a, b) in from_text.iter().flatten().zip(from_binary.iter().flatten()) {
            assert!((a - b).abs() < 1e-8);
        }
        // Binary files of some programs begin with the word `solid`.
        let mut named = binary();
        named[..5].copy_from_slice(b"solid");
        assert_eq!(corners(&named).unwrap(), from_binary);
    }

    #[test]
    fn parts_of_files_are_refused() {
        let whole = binary();
        assert!((0..whole.len()).all(|end| corners(&whole[..end]).is_err()));
        for bad in ["x", "nan", "inf", "1e999"] {
            assert!(corners(TEXT.replace("0.25", bad).as_bytes()).is_err());
        }
        let mut not_finite = whole.clone();
        not_finite[HEADER + 12..HEADER + 16].copy_from_slice(&f32::NAN.to_le_bytes());
        let words = corners(&not_finite).unwrap_err();
        assert!(words.contains("number 1 of triangle 1"), "{words}");
        assert!(corners(&TEXT.as_bytes()[..60]).is_err());
    }

    proptest! {
        #[test]
        fn no_bytes_cause_a_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
            let _ = corners(&bytes);
        }
    }
}
