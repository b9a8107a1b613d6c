//! Collision meshes from STL files.

use std::path::{Path, PathBuf};

/// Bytes of a binary file before its triangles, and of each of them.
const HEADER: usize = 84;
const TRIANGLE: usize = 50;
/// Most corners of triangles: a link has thousands.
const MOST: usize = 6_000_000;

/// The file that a URDF means by a name: a path from the folder of the URDF, `file://` and a path, or `package://`, a
/// package and a path in it. A package is looked for in the folder of the URDF and in all above it; `None` where it is
/// in none of them, as of a URDF that came alone.
///
/// # Errors
/// If a path leads nowhere, in words.
pub(super) fn locate(name: &str, directory: &Path) -> Result<Option<PathBuf>, String> {
    let Some(rest) = name.strip_prefix("package://") else {
        let path = directory.join(name.strip_prefix("file://").unwrap_or(name));
        return if path.is_file() {
            Ok(Some(path))
        } else {
            Err(format!("its mesh {} is not there", path.display()))
        };
    };
    let (package, inside) = rest.split_once('/').unwrap_or((rest, ""));
    let start = directory
        .canonicalize()
        .unwrap_or_else(|_| directory.to_owned());
    Ok(start.ancestors().find_map(|folder| {
        let is_package = folder.file_name().is_some_and(|name| name == package);
        let within = is_package.then(|| folder.join(inside));
        let candidates = within.into_iter().chain([folder.join(rest)]);
        candidates.into_iter().find(|path| path.is_file())
    }))
}

/// The corners of the triangles of an STL file, binary or text, each where the file has it.
///
/// # Errors
/// In words, if it cannot be read or is no STL file.
pub(super) fn read_stl(path: &Path) -> Result<Vec<[f64; 3]>, String> {
    let fault = |what: String| format!("its mesh {} {what}", path.display());
    let bytes = std::fs::read(path).map_err(|error| fault(format!("cannot be read: {error}")))?;
    let corners = corners(&bytes).map_err(fault)?;
    if corners.iter().flatten().any(|number| !number.is_finite()) {
        return Err(fault("has a corner that is not finite".into()));
    }
    Ok(corners)
}

/// A binary file is known by its length: the text of a file may begin with anything.
fn corners(bytes: &[u8]) -> Result<Vec<[f64; 3]>, String> {
    let count = bytes
        .get(HEADER - 4..HEADER)
        .and_then(|bytes| bytes.try_into().ok())
        .map(|bytes| u32::from_le_bytes(bytes) as usize);
    if let Some(count) = count
        && bytes.len() == HEADER + count * TRIANGLE
    {
        if count * 3 > MOST {
            return Err(format!("has {count} triangles; allowed: {}", MOST / 3));
        }
        let number = |at: &[u8]| {
            let bytes = at.try_into().unwrap_or_default();
            f64::from(f32::from_le_bytes(bytes))
        };
        let triangles = bytes[HEADER..].chunks_exact(TRIANGLE);
        // A normal, three corners, two bytes.
        let corners = triangles.flat_map(|triangle| triangle[12..48].chunks_exact(12));
        return Ok(corners
            .map(|corner| [0, 4, 8].map(|k| number(&corner[k..k + 4])))
            .collect());
    }
    let text = std::str::from_utf8(bytes)
        .ok()
        .filter(|text| text.trim_start().starts_with("solid"))
        .ok_or("is no STL file, or not a whole one")?;
    let mut words = text.split_whitespace();
    let mut corners = Vec::new();
    while let Some(word) = words.next() {
        if word == "vertex" {
            let mut number = || words.next()?.parse::<f64>().ok();
            let corner = (number(), number(), number());
            let (Some(x), Some(y), Some(z)) = corner else {
                return Err("has a `vertex` without three numbers".into());
            };
            corners.push([x, y, z]);
        }
        if corners.len() > MOST {
            return Err(format!("has too many triangles; allowed: {}", MOST / 3));
        }
    }
    if !text.contains("endsolid") {
        return Err("is no STL file, or not a whole one".into());
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
        // Files of some programs are binary and begin with the word.
        let mut named = binary();
        named[..5].copy_from_slice(b"solid");
        assert_eq!(corners(&named).unwrap(), from_binary);
    }

    #[test]
    fn parts_of_files_are_refused() {
        let whole = binary();
        assert!((0..whole.len()).all(|end| corners(&whole[..end]).is_err()));
        assert!(corners(TEXT.replace("0.25", "x").as_bytes()).is_err());
        assert!(corners(&TEXT.as_bytes()[..60]).is_err());
    }

    #[test]
    fn packages_are_found_beside_and_above_the_urdf() {
        let folder = tempfile::tempdir().unwrap();
        let urdf = folder.path().join("arm_description/urdf");
        let meshes = folder.path().join("arm_description/meshes");
        std::fs::create_dir_all(&urdf).unwrap();
        std::fs::create_dir_all(&meshes).unwrap();
        std::fs::write(meshes.join("link.stl"), TEXT).unwrap();
        for name in [
            "package://arm_description/meshes/link.stl",
            "../meshes/link.stl",
        ] {
            let found = locate(name, &urdf).unwrap().unwrap();
            assert_eq!(read_stl(&found).unwrap().len(), 3, "{name}");
        }
        assert_eq!(locate("package://other/meshes/link.stl", &urdf), Ok(None));
        let error = locate("meshes/link.stl", &urdf).unwrap_err();
        assert!(error.contains("meshes/link.stl is not there"), "{error}");
    }

    proptest! {
        #[test]
        fn no_bytes_make_it_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
            let _ = corners(&bytes);
        }
    }
}
