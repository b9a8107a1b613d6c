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
            corners
                .iter()
                .flatten()
                .map(|corner| floats(*corner))
                .collect()
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

/// The pose of a body whose matrix has orthogonal axes. A third axis without length, as that of a
/// thread between two nodes at one place, is square to the others.
fn pose_of(matrix: &[f64; 16]) -> Pose {
    let column = |k: usize| Vector3::new(matrix[4 * k], matrix[4 * k + 1], matrix[4 * k + 2]);
    let axes = [column(0), column(1), column(2)];
    let mut lengths = Vector3::from(axes.map(|axis| axis.norm()));
    let [first, second] = [axes[0].normalize(), axes[1].normalize()];
    let square = first.cross(&second);
    if axes[2].dot(&square) < 0.0 {
        lengths.z = -lengths.z;
    }
    let rotation =
        Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[first, second, square]));
    Pose {
        translation: floats(column(3)),
        rotation: quaternion(&UnitQuaternion::from_rotation_matrix(&rotation)),
        scale: floats(lengths),
    }
}
