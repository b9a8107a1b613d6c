//! VTK PolyData: a frame per output time (`vtk/rods_000000.vtp`, ...) and `rods.pvd`, which ParaView opens.
//!
//! Each rod is a polyline. Point data: `radius`, `velocity`, and the forces that there are; cell data: `rod`,
//! the number of the rod. Numbers are text in the shortest form that reads back to the same bits. In ParaView,
//! the filter "Tube" with "Vary Radius: By Absolute Scalar" draws the rods as they are.
//!
//! Format: VTK User's Guide, "VTK File Formats", XML PolyData, version 1.0.

use super::directory::{VTK_COLLECTION, VTK_FOLDER};
use super::frame::{Frame, node_places};
use super::{ResultsError, RodRecord, write_whole};
use nalgebra::Vector3;
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// Writes frame number `index` of the series in a results directory.
pub(super) fn write_frame(
    directory: &Path,
    index: usize,
    rods: &[RodRecord],
    frame: &Frame,
) -> Result<(), ResultsError> {
    let folder = directory.join(VTK_FOLDER);
    fs::create_dir_all(&folder).map_err(ResultsError::io("create", &folder))?;
    write_whole(
        &directory.join(frame_name(index)),
        poly_data(rods, frame).as_bytes(),
    )
}

/// Writes the collection that gives each frame its time.
pub(super) fn write_collection(
    directory: &Path,
    times: impl Iterator<Item = f64>,
) -> Result<(), ResultsError> {
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n<Collection>\n",
    );
    for (index, time) in times.enumerate() {
        let file = frame_name(index);
        text += &format!("<DataSet timestep=\"{time:?}\" part=\"0\" file=\"{file}\"/>\n");
    }
    text += "</Collection>\n</VTKFile>\n";
    write_whole(&directory.join(VTK_COLLECTION), text.as_bytes())
}

fn frame_name(index: usize) -> String {
    format!("{VTK_FOLDER}/rods_{index:06}.vtp")
}

fn poly_data(rods: &[RodRecord], frame: &Frame) -> String {
    let points = frame.positions.len();
    let mut text = String::with_capacity(200 * points);
    text += "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\">\n<PolyData>\n";
    text += &format!(
        "<Piece NumberOfPoints=\"{points}\" NumberOfVerts=\"0\" NumberOfLines=\"{}\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n",
        rods.len()
    );
    text += "<PointData>\n";
    push_array(
        &mut text,
        "Float64",
        "radius",
        1,
        node_places(rods).map(|place| place.rod.radius),
    );
    let vectors = [
        ("velocity", &frame.velocities),
        ("fluid_force", &frame.fluid_forces),
        ("contact_force", &frame.contact_forces),
    ];
    for (name, values) in vectors.into_iter().filter(|(_, values)| !values.is_empty()) {
        push_array(&mut text, "Float64", name, 3, components(values));
    }
    text += "</PointData>\n<CellData>\n";
    push_array(&mut text, "Int64", "rod", 1, 0..rods.len());
    text += "</CellData>\n<Points>\n";
    push_array(
        &mut text,
        "Float64",
        "points",
        3,
        components(&frame.positions),
    );
    text += "</Points>\n<Lines>\n";
    let (connectivity, offsets) = polylines(rods);
    push_array(
        &mut text,
        "Int64",
        "connectivity",
        1,
        connectivity.into_iter(),
    );
    push_array(&mut text, "Int64", "offsets", 1, offsets.into_iter());
    text += "</Lines>\n</Piece>\n</PolyData>\n</VTKFile>\n";
    text
}

/// A surface of triangles.
#[derive(Clone, Debug, Default)]
pub struct Surface {
    /// The corners.
    pub points: Vec<Vector3<f64>>,
    /// Three indices of corners for each triangle.
    pub triangles: Vec<[usize; 3]>,
}

/// Writes a surface with a number for each corner, called `name`.
///
/// # Errors
/// [`ResultsError::Io`] naming `path`.
pub fn write_surface(
    path: &Path,
    surface: &Surface,
    name: &str,
    values: &[f64],
) -> Result<(), ResultsError> {
    let mut text = String::with_capacity(100 * surface.points.len());
    text += "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\">\n<PolyData>\n";
    text += &format!(
        "<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"{}\">\n",
        surface.points.len(),
        surface.triangles.len()
    );
    text += "<PointData>\n";
    push_array(&mut text, "Float64", name, 1, values.iter().copied());
    text += "</PointData>\n<Points>\n";
    push_array(
        &mut text,
        "Float64",
        "points",
        3,
        components(&surface.points),
    );
    text += "</Points>\n<Polys>\n";
    let corners = surface.triangles.iter().flatten().copied();
    push_array(&mut text, "Int64", "connectivity", 3, corners);
    let offsets = (1..=surface.triangles.len()).map(|triangle| 3 * triangle);
    push_array(&mut text, "Int64", "offsets", 1, offsets);
    text += "</Polys>\n</Piece>\n</PolyData>\n</VTKFile>\n";
    write_whole(path, text.as_bytes())
}

/// Point numbers of every polyline, and where each polyline ends among them; closed rods return to their start.
fn polylines(rods: &[RodRecord]) -> (Vec<usize>, Vec<usize>) {
    let (mut connectivity, mut offsets) = (Vec::new(), Vec::new());
    let mut first = 0;
    for rod in rods {
        connectivity.extend(first..first + rod.nodes);
        connectivity.extend(rod.closed.then_some(first));
        offsets.push(connectivity.len());
        first += rod.nodes;
    }
    (connectivity, offsets)
}

fn components(vectors: &[Vector3<f64>]) -> impl Iterator<Item = f64> {
    vectors
        .iter()
        .flat_map(|vector| [vector.x, vector.y, vector.z])
}

fn push_array<T: std::fmt::Debug>(
    text: &mut String,
    kind: &str,
    name: &str,
    components: usize,
    values: impl Iterator<Item = T>,
) {
    *text += &format!(
        "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"ascii\">\n"
    );
    for (index, value) in values.enumerate() {
        let separator = if (index + 1).is_multiple_of(components) {
            '\n'
        } else {
            ' '
        };
        write!(text, "{value:?}{separator}").expect("a string takes all text");
    }
    *text += "</DataArray>\n";
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Elements of an XML text that holds no comments: tag with attributes, and the text that follows it.
    /// Panics where tags do not nest.
    fn elements(xml: &str) -> Vec<(String, String)> {
        let (mut open, mut found) = (Vec::new(), Vec::new());
        let body = xml.strip_prefix("<?xml version=\"1.0\"?>\n").unwrap();
        for piece in body.split('<').skip(1) {
            let (tag, text) = piece.split_once('>').expect("a tag is closed");
            if let Some(name) = tag.strip_prefix('/') {
                assert_eq!(open.pop().as_deref(), Some(name));
            } else {
                assert_eq!(tag.matches('"').count() % 2, 0, "{tag}");
                if !tag.ends_with('/') {
                    open.push(tag.split(' ').next().unwrap().to_owned());
                }
                found.push((tag.to_owned(), text.to_owned()));
            }
        }
        assert!(open.is_empty(), "{open:?} not closed");
        found
    }

    fn numbers(elements: &[(String, String)], name: &str) -> Vec<f64> {
        let name = format!("Name=\"{name}\"");
        let (_, text) = elements
            .iter()
            .find(|(tag, _)| tag.contains(&name))
            .unwrap();
        text.split_whitespace()
            .map(|word| word.parse().unwrap())
            .collect()
    }

    fn rods() -> Vec<RodRecord> {
        let rod = |name: &str, nodes, closed, radius| RodRecord {
            name: name.into(),
            nodes,
            closed,
            radius,
        };
        vec![
            rod("a <b> & \"c\"", 3, false, 1e-3),
            rod("ring", 4, true, 2e-3),
        ]
    }

    fn frame() -> Frame {
        let spiral =
            |k: usize| Vector3::new((k as f64).cos() / 3.0, 1e-9 * k as f64, -0.1 * k as f64);
        Frame {
            time: 0.3,
            positions: (0..7).map(spiral).collect(),
            twist_rates: Vec::new(),
            edge_angles: vec![0.0; 7],
            velocities: (7..14).map(spiral).collect(),
            fluid_forces: Vec::new(),
            contact_forces: (14..21).map(spiral).collect(),
        }
    }

    #[test]
    fn a_frame_is_well_formed_and_holds_the_rods() {
        let elements = elements(&poly_data(&rods(), &frame()));
        let piece = &elements
            .iter()
            .find(|(tag, _)| tag.starts_with("Piece"))
            .unwrap()
            .0;
        assert!(
            piece.contains("NumberOfPoints=\"7\"") && piece.contains("NumberOfLines=\"2\""),
            "{piece}"
        );
        assert_eq!(
            numbers(&elements, "connectivity"),
            [0., 1., 2., 3., 4., 5., 6., 3.]
        );
        assert_eq!(numbers(&elements, "offsets"), [3., 8.]);
        assert_eq!(
            numbers(&elements, "radius"),
            [1e-3, 1e-3, 1e-3, 2e-3, 2e-3, 2e-3, 2e-3]
        );
        assert_eq!(numbers(&elements, "rod"), [0., 1.]);
        assert_eq!(
            numbers(&elements, "points"),
            components(&frame().positions).collect::<Vec<_>>()
        );
        let velocities = components(&frame().velocities).collect::<Vec<_>>();
        assert_eq!(numbers(&elements, "velocity"), velocities);
        assert!(!elements.iter().any(|(tag, _)| tag.contains("fluid_force")));
    }

    #[test]
    fn the_collection_gives_every_frame_its_time() {
        let directory = tempfile::tempdir().unwrap();
        for index in 0..2 {
            write_frame(directory.path(), index, &rods(), &frame()).unwrap();
        }
        write_collection(directory.path(), [0.0, 0.25].into_iter()).unwrap();
        let text = fs::read_to_string(directory.path().join(VTK_COLLECTION)).unwrap();
        let elements = elements(&text);
        let frames: Vec<_> = elements
            .iter()
            .filter(|(tag, _)| tag.starts_with("DataSet"))
            .collect();
        assert_eq!(frames.len(), 2);
        assert!(frames[1].0.contains("timestep=\"0.25\""));
        for (tag, _) in frames {
            let file = tag
                .split("file=\"")
                .nth(1)
                .unwrap()
                .split('"')
                .next()
                .unwrap();
            assert!(directory.path().join(file).exists(), "{file}");
        }
    }
}
