//! Binary glTF 2.0.
//!
//! A rod is a tube whose vertices are each bound to one joint, and there is a joint for each node.
//! A key moves and turns a section as a whole, so that tubes keep their radius. A key takes 28 bytes
//! a node; keys of the vertices (morph targets) would take 24 bytes for each of the 16 vertices
//! around it, and a mesh for each output as much with its triangles. Between keys, sections move
//! along straight lines.

use super::super::film::{linear, normals};
use super::super::motion::{MovieCase, MovieObstacle, MoviePlane};
use super::super::palette::Color;
use super::super::tube::rod_color;
use super::frames::{Section, motion, ranges};
use super::packed::Packed;
use super::surface::around_sections;
use super::{ExchangeError, Tempo, seconds, square};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use serde_json::{Value, json};

const MAGIC: &[u8; 4] = b"glTF";
const VERSION: u32 = 2;

/// The scene in motion as the bytes of a `.glb` file. `generator` is recorded in it.
///
/// # Errors
/// [`ExchangeError`] if the file would be too large.
pub fn glb(case: &MovieCase, tempo: Tempo, generator: &str) -> Result<Vec<u8>, ExchangeError> {
    let mut file = Gltf::new(case, tempo);
    file.add_rods(case)?;
    for (number, body) in case.obstacles.iter().enumerate() {
        file.add_body(&format!("body {}", number + 1), body);
    }
    for plane in &case.planes {
        file.add_plane(case, plane);
    }
    file.written(generator)
}

/// Position, orientation and scale of a node.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Pose {
    translation: [f32; 3],
    rotation: [f32; 4],
    scale: [f32; 3],
}

struct Gltf {
    packed: Packed,
    nodes: Vec<Value>,
    /// Nodes below the one that makes z up.
    upright: Vec<usize>,
    /// Nodes at the top: meshes that joints move.
    roots: Vec<usize>,
    meshes: Vec<Value>,
    skins: Vec<Value>,
    materials: Vec<Value>,
    samplers: Vec<Value>,
    channels: Vec<Value>,
    seconds: Vec<f64>,
    /// Accessor of the times of all keys.
    keys: Option<usize>,
}

/// Rotation from z up to y up, by which (x, y, z) becomes (x, z, −y).
fn y_up() -> Matrix3<f64> {
    Matrix3::new(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0)
}

fn floats(vector: Vector3<f64>) -> [f32; 3] {
    // No negative zeros.
    vector.map(|x| x as f32 + 0.0).into()
}

fn quaternion(rotation: &UnitQuaternion<f64>) -> [f32; 4] {
    let [x, y, z, w]: [f64; 4] = rotation.coords.into();
    [x, y, z, w].map(|x| x as f32 + 0.0)
}

impl Gltf {
    fn new(case: &MovieCase, tempo: Tempo) -> Self {
        let turn = Rotation3::from_matrix_unchecked(y_up());
        let turn = quaternion(&UnitQuaternion::from_rotation_matrix(&turn));
        Self {
            packed: Packed::default(),
            nodes: vec![json!({"name": case.name, "rotation": turn})],
            upright: Vec::new(),
            roots: vec![0],
            meshes: Vec::new(),
            skins: Vec::new(),
            materials: Vec::new(),
            samplers: Vec::new(),
            channels: Vec::new(),
            seconds: seconds(case, tempo),
            keys: None,
        }
    }

    fn add_rods(&mut self, case: &MovieCase) -> Result<(), ExchangeError> {
        for (index, (rod, nodes)) in ranges(case).enumerate() {
            if rod.nodes < 2 {
                continue;
            }
            if rod.nodes >= usize::from(u16::MAX) {
                return Err(ExchangeError::TooManyNodes {
                    name: rod.name.clone(),
                    nodes: rod.nodes,
                });
            }
            let motion = motion(case, rod, nodes);
            let joints = self.add_joints(&rod.name, &motion);
            let first = &motion[0];
            let (surface, owners) = around_sections(rod);
            let placed = surface.vertices.iter().zip(&owners);
            let placed: Vec<[f32; 3]> = placed
                .map(|(vertex, owner)| floats(y_up() * first[*owner].placed(vertex)))
                .collect();
            let turned = surface.normals.iter().zip(&owners);
            let turned: Vec<[f32; 3]> = turned
                .map(|(normal, owner)| floats((y_up() * first[*owner].axes * normal).normalize()))
                .collect();
            let [numbers, weights] = self.packed.joints(&owners);
            let attributes = json!({
                "POSITION": self.packed.positions(&placed),
                "NORMAL": self.packed.normals(&turned),
                "JOINTS_0": numbers,
                "WEIGHTS_0": weights,
            });
            let indices = self.packed.triangles(&surface.triangles);
            let material = self.material(&rod.name, rod_color(index, rod.held), 1.0);
            let mesh = self.mesh(&rod.name, attributes, Some(indices), material);
            let bound: Vec<[f32; 16]> = first.iter().map(unplacing).collect();
            let bound = self.packed.matrices(&bound);
            self.skins
                .push(json!({"joints": joints, "inverseBindMatrices": bound}));
            self.roots.push(self.nodes.len());
            let skin = self.skins.len() - 1;
            self.nodes
                .push(json!({"name": rod.name, "mesh": mesh, "skin": skin}));
        }
        Ok(())
    }

    /// Joints of a rod with their keys.
    fn add_joints(&mut self, name: &str, motion: &[Vec<Section>]) -> Vec<usize> {
        let group = self.nodes.len();
        self.upright.push(group);
        let joints: Vec<usize> = (1..=motion[0].len()).map(|joint| group + joint).collect();
        self.nodes
            .push(json!({"name": format!("{name} nodes"), "children": joints}));
        for (number, &joint) in joints.iter().enumerate() {
            let poses = motion.iter().map(|sections| Pose {
                translation: floats(sections[number].centre),
                rotation: quaternion(&sections[number].orientation()),
                scale: [1.0; 3],
            });
            let poses = self.animate(joint, poses.collect());
            self.nodes.push(json!({
                "name": format!("{name} {number}"),
                "translation": poses.translation,
                "rotation": poses.rotation,
            }));
        }
        joints
    }

    /// Adds the keys of a node and returns its first pose.
    fn animate(&mut self, node: usize, mut poses: Vec<Pose>) -> Pose {
        // Of the two quaternions of an orientation the one near that before.
        for next in 1..poses.len() {
            let [before, after] = [poses[next - 1].rotation, poses[next].rotation];
            let near: f32 = before.iter().zip(&after).map(|(a, b)| a * b).sum();
            if near < 0.0 {
                poses[next].rotation = after.map(|x| 0.0 - x);
            }
        }
        let first = poses[0];
        let changes = |what: &dyn Fn(&Pose) -> bool| poses.iter().any(what);
        if changes(&|pose| pose.translation != first.translation) {
            let values: Vec<[f32; 3]> = poses.iter().map(|pose| pose.translation).collect();
            let output = self.packed.vectors(&values);
            self.channel(node, "translation", output);
        }
        if changes(&|pose| pose.rotation != first.rotation) {
            let values: Vec<[f32; 4]> = poses.iter().map(|pose| pose.rotation).collect();
            let output = self.packed.rotations(&values);
            self.channel(node, "rotation", output);
        }
        if changes(&|pose| pose.scale != first.scale) {
            let values: Vec<[f32; 3]> = poses.iter().map(|pose| pose.scale).collect();
            let output = self.packed.vectors(&values);
            self.channel(node, "scale", output);
        }
        first
    }

    fn channel(&mut self, node: usize, path: &str, output: usize) {
        let input = match self.keys {
            Some(keys) => keys,
            None => *self.keys.insert(self.packed.times(&self.seconds)),
        };
        let sampler = self.samplers.len();
        self.samplers
            .push(json!({"input": input, "output": output, "interpolation": "LINEAR"}));
        self.channels
            .push(json!({"sampler": sampler, "target": {"node": node, "path": path}}));
    }

    fn add_body(&mut self, name: &str, body: &MovieObstacle) {
        if body.triangles.is_empty() {
            return;
        }
        let vectors = |corners: &[[Vector3<f64>; 3]]| -> Vec<[f32; 3]> {
            corners.iter().flatten().map(|corner| floats(*corner)).collect()
        };
        let positions = vectors(&body.triangles);
        let normals = vectors(&normals(&body.triangles));
        let attributes = json!({
            "POSITION": self.packed.positions(&positions),
            "NORMAL": self.packed.normals(&normals),
        });
        let grey = Color::BLACK.towards(Color::WHITE, 0.55);
        let alpha = if body.hollow { 0.3 } else { 1.0 };
        let material = self.material(name, grey, alpha);
        let mesh = self.mesh(name, attributes, None, material);
        let number = self.nodes.len();
        self.upright.push(number);
        let poses: Vec<Pose> = body.poses.iter().map(pose_of).collect();
        let mut node = json!({"name": name, "mesh": mesh});
        if !poses.is_empty() {
            let first = self.animate(number, poses);
            node["translation"] = json!(first.translation);
            node["rotation"] = json!(first.rotation);
            node["scale"] = json!(first.scale);
        }
        self.nodes.push(node);
    }

    fn add_plane(&mut self, case: &MovieCase, plane: &MoviePlane) {
        let corners = square(case, plane).map(floats);
        let attributes = json!({
            "POSITION": self.packed.positions(&corners),
            "NORMAL": self.packed.normals(&[floats(plane.normal.into()); 4]),
        });
        let indices = self.packed.triangles(&[[0, 1, 2], [0, 2, 3]]);
        let pale = Color::BLACK.towards(Color::WHITE, 0.85);
        let material = self.material("plane", pale, 1.0);
        let mesh = self.mesh("plane", attributes, Some(indices), material);
        self.upright.push(self.nodes.len());
        self.nodes.push(json!({"name": "plane", "mesh": mesh}));
    }

    fn material(&mut self, name: &str, colour: Color, alpha: f32) -> usize {
        let [red, green, blue] = linear(colour);
        let mut material = json!({
            "name": name,
            "doubleSided": alpha < 1.0,
            "pbrMetallicRoughness": {
                "baseColorFactor": [red, green, blue, alpha],
                "metallicFactor": 0.0,
                "roughnessFactor": 0.5,
            },
        });
        if alpha < 1.0 {
            material["alphaMode"] = "BLEND".into();
        }
        self.materials.push(material);
        self.materials.len() - 1
    }

    fn mesh(
        &mut self,
        name: &str,
        attributes: Value,
        indices: Option<usize>,
        material: usize,
    ) -> usize {
        let mut primitive = json!({"attributes": attributes, "material": material});
        if let Some(indices) = indices {
            primitive["indices"] = indices.into();
        }
        self.meshes
            .push(json!({"name": name, "primitives": [primitive]}));
        self.meshes.len() - 1
    }

    /// The bytes: a header, the description as JSON, and the buffer.
    fn written(mut self, generator: &str) -> Result<Vec<u8>, ExchangeError> {
        if !self.upright.is_empty() {
            self.nodes[0]["children"] = json!(self.upright);
        }
        let buffer = self.packed.bytes;
        let mut root = json!({
            "asset": {"version": "2.0", "generator": generator},
            "scene": 0,
            "scenes": [{"nodes": self.roots}],
            "nodes": self.nodes,
        });
        let lists = [
            ("meshes", self.meshes),
            ("skins", self.skins),
            ("materials", self.materials),
            ("accessors", self.packed.accessors),
            ("bufferViews", self.packed.views),
        ];
        for (name, list) in lists {
            if !list.is_empty() {
                root[name] = list.into();
            }
        }
        if !self.channels.is_empty() {
            root["animations"] =
                json!([{"name": "motion", "samplers": self.samplers, "channels": self.channels}]);
        }
        if !buffer.is_empty() {
            root["buffers"] = json!([{"byteLength": buffer.len()}]);
        }
        let mut text = root.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut buffer = buffer;
        buffer.resize(buffer.len().next_multiple_of(4), 0);
        let whole = 12 + 8 + text.len() + 8 + buffer.len();
        let whole = u32::try_from(whole).map_err(|_| ExchangeError::TooLarge)?;
        let mut bytes = Vec::with_capacity(whole as usize);
        bytes.extend(MAGIC);
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend(whole.to_le_bytes());
        for (kind, chunk) in [(b"JSON", text), (b"BIN\0", buffer)] {
            bytes.extend((chunk.len() as u32).to_le_bytes());
            bytes.extend(kind);
            bytes.extend(chunk);
        }
        Ok(bytes)
    }
}

/// The inverse of the place of a section in the axes of the file, in column-major order.
fn unplacing(section: &Section) -> [f32; 16] {
    let back = section.axes.transpose();
    let turn = back * y_up().transpose();
    let offset = -(back * section.centre);
    let mut matrix = [0.0; 16];
    for column in 0..3 {
        matrix[4 * column..4 * column + 3].copy_from_slice(&floats(turn.column(column).into()));
    }
    matrix[12..15].copy_from_slice(&floats(offset));
    matrix[15] = 1.0;
    matrix
}

/// The pose of a body whose matrix has orthogonal axes.
fn pose_of(matrix: &[f64; 16]) -> Pose {
    let column = |k: usize| Vector3::new(matrix[4 * k], matrix[4 * k + 1], matrix[4 * k + 2]);
    let axes = [column(0), column(1), column(2)];
    let mut lengths = Vector3::from(axes.map(|axis| axis.norm()));
    let mut units = Matrix3::from_columns(&axes.map(|axis| axis.normalize()));
    if units.determinant() < 0.0 {
        lengths.z = -lengths.z;
        units.set_column(2, &-units.column(2));
    }
    let rotation = Rotation3::from_matrix_unchecked(units);
    Pose {
        translation: floats(column(3)),
        rotation: quaternion(&UnitQuaternion::from_rotation_matrix(&rotation)),
        scale: floats(lengths),
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::scene;
    use super::*;
    use nalgebra::Matrix4;

    /// A file that was read back.
    struct Read {
        root: Value,
        buffer: Vec<u8>,
    }

    impl Read {
        fn of(bytes: &[u8]) -> Self {
            let number = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
            assert_eq!(&bytes[..4], b"glTF");
            assert_eq!([number(4), number(8)], [2, bytes.len()]);
            let text = number(12);
            assert_eq!(&bytes[16..20], b"JSON");
            let root: Value = serde_json::from_slice(&bytes[20..20 + text]).unwrap();
            let start = 20 + text;
            assert!(start % 4 == 0 && &bytes[start + 4..start + 8] == b"BIN\0");
            assert_eq!(start + 8 + number(start), bytes.len());
            let buffer = bytes[start + 8..].to_vec();
            assert_eq!(root["buffers"][0]["byteLength"], buffer.len());
            Self { root, buffer }
        }

        /// The numbers of an accessor, one row for each entry.
        fn rows(&self, accessor: &Value) -> Vec<Vec<f64>> {
            let accessor = &self.root["accessors"][accessor.as_u64().unwrap() as usize];
            let view = accessor["bufferView"].as_u64().unwrap() as usize;
            let view = &self.root["bufferViews"][view];
            let size = |value: &Value| value.as_u64().unwrap() as usize;
            let width = match accessor["type"].as_str().unwrap() {
                "SCALAR" => 1,
                "VEC3" => 3,
                "VEC4" => 4,
                "MAT4" => 16,
                other => panic!("{other}"),
            };
            let (offset, length) = (size(&view["byteOffset"]), size(&view["byteLength"]));
            assert!(offset % 4 == 0 && offset + length <= self.buffer.len());
            let bytes = &self.buffer[offset..offset + length];
            let numbers: Vec<f64> = match size(&accessor["componentType"]) {
                5123 => bytes.as_chunks().0.iter().map(|two| u16::from_le_bytes(*two).into()).collect(),
                5125 => bytes.as_chunks().0.iter().map(|four| u32::from_le_bytes(*four).into()).collect(),
                5126 => bytes.as_chunks().0.iter().map(|four| f32::from_le_bytes(*four).into()).collect(),
                other => panic!("{other}"),
            };
            let rows: Vec<Vec<f64>> = numbers.chunks(width).map(<[f64]>::to_vec).collect();
            assert_eq!(rows.len(), size(&accessor["count"]));
            for (bound, pick) in [("min", f64::min as fn(f64, f64) -> f64), ("max", f64::max)] {
                for (column, stated) in accessor[bound].as_array().into_iter().flatten().enumerate() {
                    let found = rows.iter().map(|row| row[column]).reduce(pick).unwrap();
                    assert_eq!(stated.as_f64().unwrap() as f32, found as f32);
                }
            }
            rows
        }

        /// Matrix of a node in the scene, with the values of its channels at a key.
        fn matrix(&self, node: usize, key: usize) -> Matrix4<f64> {
            let value = |path: &str, usual: &[f64]| -> Vec<f64> {
                let channels = self.root["animations"][0]["channels"].as_array().unwrap();
                let target = |channel: &&Value| {
                    channel["target"]["node"] == node && channel["target"]["path"] == path
                };
                if let Some(channel) = channels.iter().find(target) {
                    let sampler = channel["sampler"].as_u64().unwrap() as usize;
                    let sampler = &self.root["animations"][0]["samplers"][sampler];
                    assert_eq!(self.rows(&sampler["input"]).len(), 3);
                    return self.rows(&sampler["output"])[key].clone();
                }
                let stated = self.root["nodes"][node][path].as_array();
                stated.map_or(usual.to_vec(), |list| {
                    list.iter().map(|x| x.as_f64().unwrap()).collect()
                })
            };
            let place = value("translation", &[0.0; 3]);
            let turn = value("rotation", &[0.0, 0.0, 0.0, 1.0]);
            let scale = value("scale", &[1.0; 3]);
            let turn = nalgebra::Quaternion::new(turn[3], turn[0], turn[1], turn[2]);
            assert!((turn.norm() - 1.0).abs() < 1e-6);
            Matrix4::new_translation(&Vector3::from_column_slice(&place))
                * UnitQuaternion::from_quaternion(turn).to_homogeneous()
                * Matrix4::new_nonuniform_scaling(&Vector3::from_column_slice(&scale))
        }
    }

    #[test]
    fn joints_put_the_vertices_around_the_nodes_at_every_key() {
        let case = scene();
        let bytes = glb(&case, Tempo { speed: 0.5 }, "test").unwrap();
        let file = Read::of(&bytes);
        let up = file.matrix(0, 0);
        for (index, (rod, nodes)) in ranges(&case).enumerate() {
            let skin = &file.root["skins"][index];
            let joints: Vec<usize> = (skin["joints"].as_array().unwrap().iter())
                .map(|joint| joint.as_u64().unwrap() as usize)
                .collect();
            assert_eq!(joints.len(), rod.nodes + usize::from(rod.closed));
            let inverse = file.rows(&skin["inverseBindMatrices"]);
            let primitive = &file.root["meshes"][index]["primitives"][0];
            let positions = file.rows(&primitive["attributes"]["POSITION"]);
            let owners = file.rows(&primitive["attributes"]["JOINTS_0"]);
            let weights = file.rows(&primitive["attributes"]["WEIGHTS_0"]);
            assert!(weights.iter().all(|row| row == &[1.0, 0.0, 0.0, 0.0]));
            let corners = file.rows(&primitive["indices"]);
            assert!(corners.iter().all(|corner| (corner[0] as usize) < positions.len()));
            let normals = file.rows(&primitive["attributes"]["NORMAL"]);
            assert_eq!(normals.len(), positions.len());
            for (key, frame) in case.frames.iter().enumerate() {
                for (position, owner) in positions.iter().zip(&owners) {
                    let joint = owner[0] as usize;
                    let matrix = up
                        * file.matrix(joints[joint], key)
                        * Matrix4::from_column_slice(&inverse[joint]);
                    let at = matrix.transform_point(&Vector3::from_column_slice(position).into());
                    // y is up in the file.
                    let at = Vector3::new(at.x, -at.z, at.y);
                    let node = frame.positions[nodes.clone()][joint % rod.nodes];
                    let reach = (at - node).norm();
                    let expected = match &rod.strip {
                        None => rod.radius_at(joint % rod.nodes),
                        Some(strip) => 0.5 * (strip.width.powi(2) + strip.thickness.powi(2)).sqrt(),
                    };
                    assert!((reach / expected - 1.0).abs() < 1e-4, "{} {reach}", rod.name);
                }
            }
        }
    }

    #[test]
    fn bodies_move_by_their_poses_and_times_are_scaled() {
        let case = scene();
        let file = Read::of(&glb(&case, Tempo { speed: 0.5 }, "test").unwrap());
        let nodes = file.root["nodes"].as_array().unwrap();
        let body = nodes.iter().position(|node| node["name"] == "body 1").unwrap();
        for (key, pose) in case.obstacles[0].poses.iter().enumerate() {
            let error = (file.matrix(body, key) - Matrix4::from_column_slice(pose)).norm();
            assert!(error < 1e-6, "{error}");
        }
        let input = &file.root["animations"][0]["samplers"][0]["input"];
        let times: Vec<f64> = file.rows(input).into_iter().flatten().collect();
        assert_eq!(times, [0.0, 1.0, 4.0]);
        // Every node has one parent, or is at the top.
        let mut above = vec![0; nodes.len()];
        let lists = nodes.iter().map(|node| &node["children"]);
        for list in lists.chain([&file.root["scenes"][0]["nodes"]]) {
            for child in list.as_array().into_iter().flatten() {
                above[child.as_u64().unwrap() as usize] += 1;
            }
        }
        assert!(above.iter().all(|count| *count == 1), "{above:?}");
    }

    #[test]
    fn a_scene_at_rest_has_no_animation() {
        let mut case = scene();
        case.frames.truncate(1);
        case.obstacles[0].poses.truncate(1);
        let file = Read::of(&glb(&case, Tempo { speed: 1.0 }, "test").unwrap());
        assert!(file.root.get("animations").is_none());
        assert_eq!(file.root["asset"]["version"], "2.0");
    }
}
