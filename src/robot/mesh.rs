//! Collision meshes from STL files.

use rodlab_files::input;
use rodlab_files::mesh::stl_corners;
use std::path::{Path, PathBuf};

/// Largest mesh, bytes.
const LARGEST: u64 = 256 << 20;

/// Resolves the name of a file in a URDF: a path relative to the folder of the URDF,
/// `file://PATH`, or `package://PACKAGE/PATH`. The package is searched in the folder of the URDF
/// and in all folders above. `None` if the package is not found or the file does not exist.
pub(super) fn locate(name: &str, directory: &Path) -> Option<PathBuf> {
    let Some(rest) = name.strip_prefix("package://") else {
        let path = directory.join(name.strip_prefix("file://").unwrap_or(name));
        return path.is_file().then_some(path);
    };
    let (package, inside) = rest.split_once('/').unwrap_or((rest, ""));
    let start = directory
        .canonicalize()
        .unwrap_or_else(|_| directory.to_owned());
    start.ancestors().find_map(|folder| {
        let is_package = folder.file_name().is_some_and(|name| name == package);
        let within = is_package.then(|| folder.join(inside));
        let candidates = within.into_iter().chain([folder.join(rest)]);
        candidates.into_iter().find(|path| path.is_file())
    })
}

/// The corners of the triangles of an STL file, binary or text, in the order of the file.
///
/// # Errors
/// A message if the file cannot be read or is not an STL file.
pub(super) fn read_stl(path: &Path) -> Result<Vec<[f64; 3]>, String> {
    let fault = |what: String| format!("its mesh {} {what}", path.display());
    let bytes = input::read(path, LARGEST);
    let bytes = bytes.map_err(|reason| fault(format!("cannot be read: {reason}")))?;
    stl_corners(&bytes).map_err(fault)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1e-1 0 0\nvertex 0 0.25 0\n\
                        endloop\nendfacet\nendsolid s\n";

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
            let found = locate(name, &urdf).unwrap();
            assert_eq!(read_stl(&found).unwrap().len(), 3, "{name}");
        }
        assert_eq!(locate("package://other/meshes/link.stl", &urdf), None);
        assert_eq!(locate("meshes/link.stl", &urdf), None);
    }
}
