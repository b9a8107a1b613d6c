//! Patterns given by a formula, with exact curvature.

use super::{PlaneCurve, Point};
use std::f64::consts::TAU;

/// A straight line from the origin along x.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Length, m.
    pub length: f64,
}

/// A full circle through the origin, where its tangent is x.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    /// Radius, m; a negative radius turns it to the right.
    pub radius: f64,
}

/// y = A sin(2π x/λ), starting at a crest, which is A above the axis and level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sine {
    /// A, m.
    pub amplitude: f64,
    /// λ, m.
    pub wavelength: f64,
    /// Number of waves.
    pub waves: f64,
}

impl PlaneCurve for Line {
    fn end(&self) -> f64 {
        self.length
    }

    fn pieces(&self) -> usize {
        1
    }

    fn at(&self, u: f64) -> [Point; 3] {
        [Point::new(u, 0.0), Point::x(), Point::zeros()]
    }
}

impl PlaneCurve for Circle {
    fn end(&self) -> f64 {
        TAU
    }

    fn pieces(&self) -> usize {
        16
    }

    fn at(&self, u: f64) -> [Point; 3] {
        let (sine, cosine) = libm::sincos(u);
        let [size, radius] = [self.radius.abs(), self.radius];
        [
            Point::new(size * sine, radius * (1.0 - cosine)),
            Point::new(size * cosine, radius * sine),
            Point::new(-size * sine, radius * cosine),
        ]
    }
}

impl PlaneCurve for Sine {
    fn end(&self) -> f64 {
        self.waves * self.wavelength
    }

    fn pieces(&self) -> usize {
        // Pieces are short enough even for steep waves.
        let steepness = 1.0 + TAU * (self.amplitude / self.wavelength).abs();
        (32.0 * self.waves * steepness).ceil().max(8.0) as usize
    }

    fn at(&self, u: f64) -> [Point; 3] {
        let number = TAU / self.wavelength;
        let (sine, cosine) = libm::sincos(number * u);
        let height = self.amplitude;
        [
            Point::new(u, height * (cosine - 1.0)),
            Point::new(1.0, -height * number * sine),
            Point::new(0.0, -height * number * number * cosine),
        ]
    }
}
