//! Triangle meshes in files: STL (binary or text) and OBJ.

mod obj;
mod stl;

pub use stl::corners as stl_corners;

use std::collections::HashMap;

/// Maximum number of triangles of a file.
pub const MOST_TRIANGLES: usize = 2_000_000;

/// A triangle mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertices, in the unit of the file.
    pub vertices: Vec<[f64; 3]>,
    /// Corners of each triangle, indices into the vertices.
    pub triangles: Vec<[usize; 3]>,
}

/// Reads the bytes of a file with the extension `stl` or `obj`. Corners of an STL file at the same
/// position become one vertex.
///
/// # Errors
/// A message about the file, to be placed after its name.
pub fn parse(bytes: &[u8], ending: &str) -> Result<Mesh, String> {
    match ending.to_ascii_lowercase().as_str() {
        "stl" => Ok(weld(stl::corners(bytes)?)),
        "obj" => obj::parse(bytes),
        _ => Err("is not a mesh; allowed: names that end in .stl or .obj".into()),
    }
}

fn weld(corners: Vec<[f64; 3]>) -> Mesh {
    let mut mesh = Mesh::default();
    let mut known: HashMap<[u64; 3], usize> = HashMap::new();
    let mut numbers = Vec::with_capacity(corners.len());
    for corner in corners {
        // 0 and −0 are the same position.
        let place = corner.map(|coordinate| (coordinate + 0.0).to_bits());
        numbers.push(*known.entry(place).or_insert_with(|| {
            mesh.vertices.push(corner);
            mesh.vertices.len() - 1
        }));
    }
    mesh.triangles = numbers.as_chunks::<3>().0.to_vec();
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_in_one_place_are_one_vertex() {
        let text = "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n\
                    facet normal 0 0 1\nouter loop\nvertex 1 0 0\nvertex 1 1 0\nvertex -0 1 \
                    0\nendloop\nendfacet\nendsolid s\n";
        let mesh = parse(text.as_bytes(), "STL").unwrap();
        assert_eq!(mesh.vertices.len(), 4);
        assert_eq!(mesh.triangles, [[0, 1, 2], [1, 3, 2]]);
    }

    #[test]
    fn other_files_are_refused() {
        assert!(parse(b"ply", "ply").unwrap_err().contains(".stl or .obj"));
    }
}
