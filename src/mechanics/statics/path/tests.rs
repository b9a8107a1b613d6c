//! Paths with known critical points.
