//! The catenary: the shape of a heavy chain that hangs between two points.
//!
//! With the horizontal distance h and the vertical distance v from start to end, a chain of length
//! L > √(h² + v²) hangs on z = a cosh(x/a). The parameter a follows from
//!
//! ```text
//! √(L² − v²)/h = sinh ξ/ξ,     ξ = h/2a
//! ```
//!
//! and the start is at x₁/a = artanh(v/L) − ξ. At the arc length s from the start, x/a =
//! arsinh(s/a + sinh(x₁/a)).

use rodlab_engine::mechanics::Vector3;

/// A hanging chain.
#[derive(Clone, Copy, Debug)]
pub struct Catenary {
    start: Vector3,
    across: Vector3,
    up: Vector3,
    length: f64,
    /// a, m.
    parameter: f64,
    /// x₁/a.
    first: f64,
}

impl Catenary {
    /// A chain of `length` between two points. The length is greater than their distance, and the
    /// points do not lie above each other along the unit vector `up`.
    pub fn new(start: Vector3, end: Vector3, length: f64, up: Vector3) -> Self {
        let along = end - start;
        let rise = along.dot(&up);
        let level = along - up * rise;
        let span = level.norm();
        let half = half_angle(libm::sqrt((length - rise) * (length + rise)) / span);
        Self {
            start,
            across: level / span,
            up,
            length,
            parameter: 0.5 * span / half,
            first: libm::atanh(rise / length) - half,
        }
    }

    /// The point at a fraction of the length, from 0 to 1.
    pub fn point(&self, share: f64) -> Vector3 {
        let (a, first, here) = (self.parameter, self.first, self.place(share));
        // cosh u − cosh u₁ without cancellation, for nearly taut chains.
        let rise = 2.0 * libm::sinh(0.5 * (here + first)) * libm::sinh(0.5 * (here - first));
        self.start + self.across * (a * (here - first)) + self.up * (a * rise)
    }

    /// Unit tangent there.
    pub fn tangent(&self, share: f64) -> Vector3 {
        let here = self.place(share);
        (self.across + self.up * libm::sinh(here)) / libm::cosh(here)
    }

    /// x/a.
    fn place(&self, share: f64) -> f64 {
        libm::asinh(share * self.length / self.parameter + libm::sinh(self.first))
    }
}

/// Solves sinh ξ = r ξ for ξ > 0 with r > 1, by Newton's method from above, where the function is
/// convex and increasing.
fn half_angle(ratio: f64) -> f64 {
    let mut half = if ratio < 3.0 {
        // sinh ξ > ξ + ξ³/6.
        libm::sqrt(6.0 * (ratio - 1.0))
    } else {
        let logarithm = libm::log(2.0 * ratio);
        logarithm + 2.0 * libm::log(logarithm)
    };
    for _ in 0..100 {
        let step = (libm::sinh(half) - ratio * half) / (libm::cosh(half) - ratio);
        half -= step;
        if step.abs() <= f64::EPSILON * half {
            break;
        }
    }
    half
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_ends_where_it_should_and_hangs_as_a_chain_does() {
        let up = Vector3::new(0.0, 0.6, 0.8);
        let start = Vector3::new(0.1, -0.2, 0.3);
        for end in [Vector3::new(1.0, 0.4, 0.2), Vector3::new(0.3, 2.0, 2.5)] {
            let distance = (end - start).norm();
            for slack in [1.0 + 1e-9, 1.0001, 1.1, 2.0, 30.0] {
                let chain = Catenary::new(start, end, slack * distance, up);
                assert!((chain.point(0.0) - start).norm() < 1e-15);
                let missed = (chain.point(1.0) - end).norm() / distance;
                assert!(missed < 1e-11 * slack, "{slack}: {missed}");
                // The vertical force increases by the weight and the horizontal force is constant,
                // so slopes are linear in the arc length.
                let slope = |share: f64| {
                    let tangent = chain.tangent(share);
                    tangent.dot(&up) / tangent.dot(&chain.across)
                };
                let (first, last) = (slope(0.0), slope(1.0));
                for share in [0.25, 0.5, 0.9] {
                    let expected = first + share * (last - first);
                    assert!((slope(share) - expected).abs() < 1e-9 * last.abs().max(1.0));
                    // The tangent is the derivative with respect to arc length.
                    let [ahead, behind] = [1e-5, -1e-5].map(|by| chain.point(share + by));
                    let derivative = (ahead - behind) / (2e-5 * slack * distance);
                    assert!((derivative - chain.tangent(share)).norm() < 1e-6);
                }
            }
        }
    }
}
