//! Chords across a strand.

/// The edges of a strand along its normal, from a point of its centreline.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chord {
    edges: [f64; 2],
}

impl Chord {
    /// A chord between two places along the normal, pixels.
    pub fn new(edges: [f64; 2]) -> Self {
        Self { edges }
    }

    pub fn width(&self) -> f64 {
        self.edges[1] - self.edges[0]
    }

    /// Places of both edges along the normal, pixels.
    pub fn edges(&self) -> [f64; 2] {
        self.edges
    }

    pub fn middle(&self) -> f64 {
        0.5 * (self.edges[0] + self.edges[1])
    }
}
