//! VTK PolyData: one frame per output time (`vtk/rods_000000.vtp`, ...) and `rods.pvd`, which
//! ParaView opens. Obstacles are its second part, as triangles with the index of the obstacle in
//! the cell data `obstacle`.
//!
//! Each rod is a polyline. Point data: `radius`, `velocity`, and the available forces; cell data:
//! `rod`, the index of the rod. Numbers are stored in binary, 64 bits each, after the XML
//! ("appended raw"). In ParaView, the filter "Tube" with "Vary Radius: By Absolute Scalar" draws
//! the rods with their radii.
//!
//! Format: VTK User's Guide, "VTK File Formats", XML PolyData, version 1.0.

use super::files::{VTK_COLLECTION, VTK_FOLDER, frame_name};
use super::frame::{Frame, node_places};
use super::{ResultsError, RodRecord, write_whole};
use nalgebra::Vector3;
use std::collections::HashMap;
use std::fs;
use std::path::Path;

/// Writes frame number `index` of the series in a results directory; returns its bytes.
pub(super) fn write_frame(
    directory: &Path,
    index: usize,
    rods: &[RodRecord],
    frame: &Frame,
) -> Result<Vec<u8>, ResultsError> {
    let bytes = poly_data(rods, frame);
    write_part(directory, &frame_name(index), &bytes)?;
    Ok(bytes)
}

/// Writes a file in the folder of frames.
fn write_part(directory: &Path, name: &str, bytes: &[u8]) -> Result<(), ResultsError> {
    let folder = directory.join(VTK_FOLDER);
    if folder.is_symlink() {
        return Err(ResultsError::Link { path: folder });
    }
    fs::create_dir_all(&folder).map_err(ResultsError::io("create", &folder))?;
    write_whole(&directory.join(name), bytes)
}

/// Writes the obstacles of a frame; returns the bytes.
pub(super) fn write_obstacles(
    directory: &Path,
    name: &str,
    surfaces: &[Surface],
) -> Result<Vec<u8>, ResultsError> {
    let points: Vec<Vector3<f64>> = surfaces.iter().flat_map(|s| s.points.clone()).collect();
    let firsts = surfaces.iter().scan(0, |first, surface| {
        let own = *first;
        *first += surface.points.len();
        Some(own)
    });
    let triangles: Vec<[usize; 3]> = (surfaces.iter().zip(firsts))
        .flat_map(|(surface, first)| {
            let triangles = surface.triangles.iter();
            triangles.map(move |corners| corners.map(|corner| first + corner))
        })
        .collect();
    let numbers = surfaces.iter().enumerate();
    let numbers =
        numbers.flat_map(|(number, surface)| vec![number; surface.triangles.len()].into_iter());
    let mut file = PolyData::new(points.len(), 0, triangles.len());
    file.section("CellData", |file| file.integers("obstacle", numbers));
    file.surface(&points, &triangles);
    let bytes = file.finish();
    write_part(directory, name, &bytes)?;
    Ok(bytes)
}

/// Writes the collection that assigns each frame its time, with the obstacles of a frame if they
/// have a file.
pub(super) fn write_collection(
    directory: &Path,
    times: impl Iterator<Item = f64>,
    obstacle_file: impl Fn(usize) -> Option<String>,
) -> Result<(), ResultsError> {
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n<Collection>\n",
    );
    for (index, time) in times.enumerate() {
        let files = [Some(frame_name(index)), obstacle_file(index)];
        for (part, file) in files.into_iter().flatten().enumerate() {
            text += &format!("<DataSet timestep=\"{time:?}\" part=\"{part}\" file=\"{file}\"/>\n");
        }
    }
    text += "</Collection>\n</VTKFile>\n";
    write_whole(&directory.join(VTK_COLLECTION), text.as_bytes())
}

fn poly_data(rods: &[RodRecord], frame: &Frame) -> Vec<u8> {
    let count = rods.iter().filter(|rod| !rod.rigid).count();
    let triangles = triangles(rods);
    let mut file = PolyData::new(frame.positions.len(), count, triangles.len());
    file.section("PointData", |file| {
        file.floats(
            "radius",
            1,
            node_places(rods).map(|place| place.rod.radius_at(place.node)),
        );
        let vectors = [
            ("velocity", &frame.velocities),
            ("fluid_force", &frame.fluid_forces),
            ("contact_force", &frame.contact_forces),
        ];
        for (name, values) in vectors.into_iter().filter(|(_, values)| !values.is_empty()) {
            file.floats(name, 3, components(values));
        }
    });
    file.section("CellData", |file| {
        let of_triangles = triangles.iter().map(|(rod, _)| *rod);
        file.integers("rod", (0..count).chain(of_triangles));
    });
    file.section("Points", |file| {
        file.floats("points", 3, components(&frame.positions));
    });
    let (connectivity, offsets) = polylines(rods);
    file.section("Lines", |file| {
        file.integers("connectivity", connectivity.into_iter());
        file.integers("offsets", offsets.into_iter());
    });
    if !triangles.is_empty() {
        file.section("Polys", |file| {
            let corners = triangles.iter().flat_map(|(_, corners)| *corners);
            file.integers("connectivity", corners);
            let offsets = (1..=triangles.len()).map(|triangle| 3 * triangle);
            file.integers("offsets", offsets);
        });
    }
    file.finish()
}

/// Triangles of free bodies, with the index of the body among all rods.
fn triangles(rods: &[RodRecord]) -> Vec<(usize, [usize; 3])> {
    let (mut first, mut triangles) = (0, Vec::new());
    for (index, rod) in rods.iter().enumerate() {
        let placed = rod.faces.iter().map(|face| face.map(|node| first + node));
        triangles.extend(placed.map(|face| (index, face)));
        first += rod.nodes;
    }
    triangles
}

/// A surface of triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// The corners.
    pub points: Vec<Vector3<f64>>,
    /// Three indices of corners for each triangle.
    pub triangles: Vec<[usize; 3]>,
}

impl Surface {
    /// The surface of triangles given by their corners, with equal corners merged.
    pub fn from_triangles(triangles: &[[Vector3<f64>; 3]]) -> Self {
        let mut surface = Self::default();
        let mut numbers = HashMap::new();
        for corners in triangles {
            let corner = |point: &Vector3<f64>| {
                let place: [u64; 3] = (*point).map(f64::to_bits).into();
                *numbers.entry(place).or_insert_with(|| {
                    surface.points.push(*point);
                    surface.points.len() - 1
                })
            };
            let numbers = corners.each_ref().map(corner);
            surface.triangles.push(numbers);
        }
        surface
    }
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
    let mut file = PolyData::new(surface.points.len(), 0, surface.triangles.len());
    file.section("PointData", |file| {
        file.floats(name, 1, values.iter().copied())
    });
    file.surface(&surface.points, &surface.triangles);
    write_whole(path, &file.finish())
}

/// Point indices of all polylines, and the end of each polyline among them; closed rods return to
/// their start.
fn polylines(rods: &[RodRecord]) -> (Vec<usize>, Vec<usize>) {
    let (mut connectivity, mut offsets) = (Vec::new(), Vec::new());
    let mut first = 0;
    for rod in rods {
        if !rod.rigid {
            connectivity.extend(first..first + rod.nodes);
            connectivity.extend(rod.closed.then_some(first));
            offsets.push(connectivity.len());
        }
        first += rod.nodes;
    }
    (connectivity, offsets)
}

fn components(vectors: &[Vector3<f64>]) -> impl Iterator<Item = f64> {
    vectors
        .iter()
        .flat_map(|vector| [vector.x, vector.y, vector.z])
}

/// A PolyData file under construction: the XML, and the numbers that follow it.
struct PolyData {
    xml: String,
    /// Arrays, each as its length in bytes as a 64-bit integer, then its numbers, all
    /// little-endian.
    appended: Vec<u8>,
}

impl PolyData {
    fn new(points: usize, lines: usize, polygons: usize) -> Self {
        let xml = format!(
            "<?xml version=\"1.0\"?>\n\
             <VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n\
             <PolyData>\n\
             <Piece NumberOfPoints=\"{points}\" NumberOfVerts=\"0\" NumberOfLines=\"{lines}\" \
             NumberOfStrips=\"0\" NumberOfPolys=\"{polygons}\">\n"
        );
        Self {
            xml,
            appended: Vec::with_capacity(100 * points),
        }
    }

    fn section(&mut self, name: &str, fill: impl FnOnce(&mut Self)) {
        self.xml += &format!("<{name}>\n");
        fill(self);
        self.xml += &format!("</{name}>\n");
    }

    /// Writes the corners of triangles, and the indices of the corners of each triangle.
    fn surface(&mut self, points: &[Vector3<f64>], triangles: &[[usize; 3]]) {
        self.section("Points", |file| {
            file.floats("points", 3, components(points));
        });
        self.section("Polys", |file| {
            file.integers("connectivity", triangles.iter().flatten().copied());
            let offsets = (1..=triangles.len()).map(|triangle| 3 * triangle);
            file.integers("offsets", offsets);
        });
    }

    fn floats(&mut self, name: &str, components: usize, values: impl Iterator<Item = f64>) {
        self.array("Float64", name, components, values.map(f64::to_le_bytes));
    }

    /// Writes integers without components, as VTK requires for point indices, offsets and indices
    /// of rods.
    fn integers(&mut self, name: &str, values: impl Iterator<Item = usize>) {
        let bytes = values.map(|value| (value as u64).to_le_bytes());
        self.array("Int64", name, 1, bytes);
    }

    fn array(
        &mut self,
        kind: &str,
        name: &str,
        components: usize,
        values: impl Iterator<Item = [u8; 8]>,
    ) {
        let offset = self.appended.len();
        self.xml += &format!(
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" \
             format=\"appended\" offset=\"{offset}\"/>\n"
        );
        self.appended.extend([0; 8]);
        self.appended.extend(values.flatten());
        let length = (self.appended.len() - offset - 8) as u64;
        self.appended[offset..offset + 8].copy_from_slice(&length.to_le_bytes());
    }

    fn finish(self) -> Vec<u8> {
        let mut bytes = self.xml.into_bytes();
        bytes.extend(b"</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_");
        bytes.extend(self.appended);
        bytes.extend(b"\n</AppendedData>\n</VTKFile>\n");
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The XML in front of the numbers, and the numbers, 8 bytes each.
    fn read(file: &[u8]) -> (Vec<String>, &[u8]) {
        let mark: &[u8] = b"<AppendedData encoding=\"raw\">\n_";
        let at = file.windows(mark.len()).position(|bytes| bytes == mark);
        let at = at.expect("appended data");
        let xml = std::str::from_utf8(&file[..at]).unwrap();
        (tags(xml), &file[at + mark.len()..])
    }

    fn tags(xml: &str) -> Vec<String> {
        let tags = xml.split('<').skip(1);
        tags.map(|tag| tag.split_once('>').expect("a closed tag").0.to_owned())
            .collect()
    }

    fn attribute<'a>(tag: &'a str, name: &str) -> &'a str {
        let (_, rest) = tag.split_once(&format!("{name}=\"")).expect(name);
        rest.split_once('"').unwrap().0
    }

    /// The numbers of an array, decoded from the file.
    fn numbers(file: &[u8], name: &str) -> Vec<f64> {
        let (tags, data) = read(file);
        let is_array = |tag: &&String| tag.contains(&format!("Name=\"{name}\""));
        let tag = tags.iter().find(is_array).unwrap();
        let offset: usize = attribute(tag, "offset").parse().unwrap();
        let word = |at: usize| <[u8; 8]>::try_from(&data[at..at + 8]).unwrap();
        let length = u64::from_le_bytes(word(offset)) as usize;
        let number = |at: usize| match attribute(tag, "type") {
            "Float64" => f64::from_le_bytes(word(at)),
            _ => u64::from_le_bytes(word(at)) as f64,
        };
        (0..length / 8)
            .map(|k| number(offset + 8 + 8 * k))
            .collect()
    }

    fn rods() -> Vec<RodRecord> {
        let rod = |name: &str, nodes, closed, radius| RodRecord {
            name: name.into(),
            nodes,
            closed,
            radius,
            ..RodRecord::default()
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
            contacts: Vec::new(),
            obstacle_poses: Vec::new(),
        }
    }

    #[test]
    fn a_frame_is_well_formed_and_holds_the_rods() {
        let file = poly_data(&rods(), &frame());
        let (tags, _) = read(&file);
        let piece = tags.iter().find(|tag| tag.starts_with("Piece")).unwrap();
        assert_eq!(attribute(piece, "NumberOfPoints"), "7");
        assert_eq!(attribute(piece, "NumberOfLines"), "2");
        assert_eq!(
            numbers(&file, "connectivity"),
            [0., 1., 2., 3., 4., 5., 6., 3.]
        );
        assert_eq!(numbers(&file, "offsets"), [3., 8.]);
        assert_eq!(
            numbers(&file, "radius"),
            [1e-3, 1e-3, 1e-3, 2e-3, 2e-3, 2e-3, 2e-3]
        );
        assert_eq!(numbers(&file, "rod"), [0., 1.]);
        let positions = components(&frame().positions).collect::<Vec<_>>();
        assert_eq!(numbers(&file, "points"), positions);
        let velocities = components(&frame().velocities).collect::<Vec<_>>();
        assert_eq!(numbers(&file, "velocity"), velocities);
        assert!(!tags.iter().any(|tag| tag.contains("fluid_force")));
    }

    #[test]
    fn lists_of_a_surface_have_one_component_as_readers_demand() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("boundary.vtp");
        let surface = Surface {
            points: vec![Vector3::zeros(), Vector3::x(), Vector3::y(), Vector3::z()],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
        };
        write_surface(&path, &surface, "distance", &[0.0, 1.0, 2.0, 3.0]).unwrap();
        let file = fs::read(path).unwrap();
        assert_eq!(numbers(&file, "connectivity"), [0., 1., 2., 0., 2., 3.]);
        assert_eq!(numbers(&file, "offsets"), [3., 6.]);
        assert_eq!(numbers(&file, "distance"), [0., 1., 2., 3.]);
        let (tags, _) = read(&file);
        let lists = tags.iter().filter(|tag| tag.contains("type=\"Int64\""));
        for list in lists {
            assert_eq!(attribute(list, "NumberOfComponents"), "1", "{list}");
        }
    }

    #[test]
    fn the_collection_gives_every_frame_its_time() {
        let directory = tempfile::tempdir().unwrap();
        for index in 0..2 {
            write_frame(directory.path(), index, &rods(), &frame()).unwrap();
        }
        write_collection(directory.path(), [0.0, 0.25].into_iter(), |_| None).unwrap();
        let text = fs::read_to_string(directory.path().join(VTK_COLLECTION)).unwrap();
        let tags = tags(&text);
        let frames: Vec<_> = tags
            .iter()
            .filter(|tag| tag.starts_with("DataSet"))
            .collect();
        assert_eq!(frames.len(), 2);
        assert_eq!(attribute(frames[1], "timestep"), "0.25");
        for tag in frames {
            let file = attribute(tag, "file");
            assert!(directory.path().join(file).exists(), "{file}");
        }
    }
}
