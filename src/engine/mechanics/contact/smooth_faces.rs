//! Meshes that stand for smooth surfaces: normals and neighbours of their faces.

use crate::mechanics::rigid_body::{NO_FACE, RigidBody};

/// The smooth faces of all obstacles.
#[derive(Clone, Debug, Default)]
pub(super) struct SmoothFaces {
    /// Faces in the order of [`ContactSurface::faces`], or fewer; `None` for flat ones.
    faces: Vec<Option<SmoothFace>>,
    /// Numbers of normals, and of vertices of all obstacles.
    normals: usize,
    vertices: usize,
}

/// A curved face.
#[derive(Clone, Copy, Debug)]
pub(super) struct SmoothFace {
    /// Its corners, among the vertices of all obstacles.
    pub vertices: [u32; 3],
    /// Normals at its corners, among those of all obstacles.
    pub normals: [u32; 3],
    /// Faces across the sides opposite to its corners.
    pub across: [u32; 3],
}

impl SmoothFaces {
    /// Adds an obstacle whose faces are numbered from `first_face`.
    pub(crate) fn add(&mut self, obstacle: &RigidBody, first_face: usize) {
        self.faces.resize(first_face, None);
        let vertex = self.vertices;
        self.vertices += obstacle.vertices.len();
        let Some(smooth) = &obstacle.smooth else {
            return;
        };
        let (first, normal) = (first_face as u32, self.normals as u32);
        let numbered = |other: u32| {
            if other == NO_FACE {
                other
            } else {
                first + other
            }
        };
        let corners = smooth.corners.iter().zip(&smooth.across);
        let faces = obstacle.faces.iter().zip(corners);
        self.faces.extend(faces.map(|(face, (corners, across))| {
            Some(SmoothFace {
                vertices: face.map(|corner| (vertex + corner) as u32),
                normals: corners.map(|corner| normal + corner),
                across: across.map(numbered),
            })
        }));
        self.normals += smooth.normals.len();
    }

    /// A curved face; `None` for a flat one.
    pub(crate) fn face(&self, face: usize) -> Option<&SmoothFace> {
        self.faces.get(face)?.as_ref()
    }
}
