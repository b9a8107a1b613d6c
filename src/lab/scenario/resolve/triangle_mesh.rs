//! Triangle meshes, from files or lists.

use super::Section;
use crate::scenario::input_file;
use rodlab_files::mesh::{self, Mesh};

/// The mesh of `file`, or of the lists `vertices` and `triangles`; `None` after a fault.
pub fn triangle_mesh(
    section: &Section<'_>,
    file: &Option<String>,
    vertices: &Option<Vec<[f64; 3]>>,
    triangles: &Option<Vec<[i64; 3]>>,
) -> Option<Mesh> {
    match (file, vertices, triangles) {
        (Some(file), None, None) => read(section, file)
            .map_err(|message| section.fault("file", message))
            .ok(),
        (None, Some(vertices), Some(triangles)) => Some(Mesh {
            vertices: vertices.clone(),
            triangles: corners(section, vertices.len(), triangles)?,
        }),
        (None, None, None) => {
            section.missing("file", "an STL or OBJ file, or `vertices` and `triangles`");
            None
        }
        (Some(_), ..) => {
            section.fault(
                "file",
                "give `file`, or `vertices` and `triangles`, not both",
            );
            None
        }
        _ => {
            section.missing("triangles", "`vertices` and `triangles` go together");
            None
        }
    }
}

fn read(section: &Section<'_>, file: &str) -> Result<Mesh, String> {
    let path = section.path_of("file", file);
    let ending = path.extension().and_then(|ending| ending.to_str());
    let bytes = input_file::read(&path, input_file::LARGEST_TABLE)?;
    mesh::parse(&bytes, ending.unwrap_or_default())
        .map_err(|what| format!("{} {what}", path.display()))
}

fn corners(
    section: &Section<'_>,
    vertices: usize,
    triangles: &[[i64; 3]],
) -> Option<Vec<[usize; 3]>> {
    let below = section.below("triangles");
    let mut corners = Vec::with_capacity(triangles.len());
    for (index, triangle) in triangles.iter().enumerate() {
        let known = triangle.map(|corner| usize::try_from(corner).unwrap_or(usize::MAX));
        if let Some(k) = known.iter().position(|corner| *corner >= vertices) {
            let message = match vertices {
                0 => "there are no vertices".to_owned(),
                _ => format!(
                    "there is no vertex {}; allowed: 0 to {}",
                    triangle[k],
                    vertices - 1
                ),
            };
            below
                .below(&index.to_string())
                .fault(&k.to_string(), message);
            return None;
        }
        corners.push(known);
    }
    Some(corners)
}
