//! Files of [`glb`] are valid, and put vertices where the rods are.

use super::frames::ranges;
use super::tests::scene;
use super::{Tempo, glb};
use nalgebra::{Matrix4, UnitQuaternion, Vector3};
use serde_json::Value;

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
            5123 => bytes
                .as_chunks()
                .0
                .iter()
                .map(|two| u16::from_le_bytes(*two).into())
                .collect(),
            5125 => bytes
                .as_chunks()
                .0
                .iter()
                .map(|four| u32::from_le_bytes(*four).into())
                .collect(),
            5126 => bytes
                .as_chunks()
                .0
                .iter()
                .map(|four| f32::from_le_bytes(*four).into())
                .collect(),
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
        assert!(
            corners
                .iter()
                .all(|corner| (corner[0] as usize) < positions.len())
        );
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
                assert!(
                    (reach / expected - 1.0).abs() < 1e-4,
                    "{} {reach}",
                    rod.name
                );
            }
        }
    }
}

#[test]
fn bodies_move_by_their_poses_and_times_are_scaled() {
    let case = scene();
    let file = Read::of(&glb(&case, Tempo { speed: 0.5 }, "test").unwrap());
    let nodes = file.root["nodes"].as_array().unwrap();
    let body = nodes
        .iter()
        .position(|node| node["name"] == "body 1")
        .unwrap();
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
