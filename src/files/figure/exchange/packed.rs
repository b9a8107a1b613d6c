//! The binary part of a glTF file: arrays of numbers with their descriptions.

use serde_json::{Value, json};

/// Component types of glTF.
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
const FLOAT: u32 = 5126;
/// Uses of buffer views.
const VERTICES: u32 = 34962;
const TRIANGLES: u32 = 34963;

/// The buffer of a glTF file with its views and accessors.
#[derive(Default)]
pub(super) struct Packed {
    pub bytes: Vec<u8>,
    pub views: Vec<Value>,
    pub accessors: Vec<Value>,
}

impl Packed {
    /// Appends an array and returns the number of its accessor.
    fn add(&mut self, bytes: &[u8], target: Option<u32>, mut accessor: Value) -> usize {
        // Every view starts at a multiple of the largest component, four bytes.
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let mut view =
            json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()});
        if let Some(target) = target {
            view["target"] = target.into();
        }
        self.bytes.extend_from_slice(bytes);
        accessor["bufferView"] = self.views.len().into();
        self.views.push(view);
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn floats<const N: usize>(
        &mut self,
        values: &[[f32; N]],
        kind: &str,
        target: Option<u32>,
        is_bounded: bool,
    ) -> usize {
        let bytes: Vec<u8> = (values.iter().flatten())
            .flat_map(|value| value.to_le_bytes())
            .collect();
        let mut accessor = json!({"componentType": FLOAT, "count": values.len(), "type": kind});
        if is_bounded {
            let bound = |pick: fn(f32, f32) -> f32| -> Vec<f32> {
                let mut bound = values[0];
                for value in values {
                    bound
                        .iter_mut()
                        .zip(value)
                        .for_each(|(a, b)| *a = pick(*a, *b));
                }
                bound.to_vec()
            };
            accessor["min"] = json!(bound(f32::min));
            accessor["max"] = json!(bound(f32::max));
        }
        self.add(&bytes, target, accessor)
    }

    /// Positions of vertices, with their bounds.
    pub fn positions(&mut self, values: &[[f32; 3]]) -> usize {
        self.floats(values, "VEC3", Some(VERTICES), true)
    }

    pub fn normals(&mut self, values: &[[f32; 3]]) -> usize {
        self.floats(values, "VEC3", Some(VERTICES), false)
    }

    /// Joints that move each vertex: one each, with the weight 1.
    pub fn joints(&mut self, owners: &[usize]) -> [usize; 2] {
        let four = |owner: &usize| [*owner as u16, 0, 0, 0];
        let numbers = owners.iter().flat_map(four);
        let bytes: Vec<u8> = numbers.flat_map(u16::to_le_bytes).collect();
        let accessor =
            json!({"componentType": UNSIGNED_SHORT, "count": owners.len(), "type": "VEC4"});
        let joints = self.add(&bytes, Some(VERTICES), accessor);
        let weights = vec![[1.0, 0.0, 0.0, 0.0]; owners.len()];
        [joints, self.floats(&weights, "VEC4", Some(VERTICES), false)]
    }

    /// Corners of triangles.
    pub fn triangles(&mut self, triangles: &[[u32; 3]]) -> usize {
        let corners = triangles.iter().flatten();
        let bytes: Vec<u8> = corners.flat_map(|corner| corner.to_le_bytes()).collect();
        let count = 3 * triangles.len();
        let accessor = json!({"componentType": UNSIGNED_INT, "count": count, "type": "SCALAR"});
        self.add(&bytes, Some(TRIANGLES), accessor)
    }

    pub fn matrices(&mut self, values: &[[f32; 16]]) -> usize {
        self.floats(values, "MAT4", None, false)
    }

    /// Times of keys, with their bounds.
    pub fn times(&mut self, values: &[f64]) -> usize {
        let values: Vec<[f32; 1]> = values.iter().map(|time| [*time as f32]).collect();
        self.floats(&values, "SCALAR", None, true)
    }

    /// Translations or scales at keys.
    pub fn vectors(&mut self, values: &[[f32; 3]]) -> usize {
        self.floats(values, "VEC3", None, false)
    }

    /// Rotations at keys: x, y, z, w.
    pub fn rotations(&mut self, values: &[[f32; 4]]) -> usize {
        self.floats(values, "VEC4", None, false)
    }
}
