//! Size of a knot.

use super::polyline::length;
use rodlab_engine::mechanics::Vector3;

/// Number of bisections of the size of a knot, equal to the bits of a number.
const BISECTIONS: usize = 53;

/// Dimensions of a knot that is to be tied.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KnotSize {
    /// Length of each rod, m.
    pub length: f64,
    /// Radius of the rods, m.
    pub radius: f64,
    /// Distance of the left ends from the right ends, m.
    pub end_to_end: f64,
}

impl KnotSize {
    /// The curve with the length of the rod, from a family of curves whose length increases with
    /// the extent of their loops (m), which lies between two bounds.
    ///
    /// # Errors
    /// A message if there is no such curve.
    pub(super) fn fitted(
        &self,
        [mut smaller, mut larger]: [f64; 2],
        curve: impl Fn(f64) -> Vec<Vector3>,
    ) -> Result<Vec<Vector3>, String> {
        if !(smaller < larger) {
            return Err(format!(
                "the ends are {:.4} m apart, too near for the smallest loops",
                self.end_to_end
            ));
        }
        let [least, most] = [smaller, larger].map(|extent| length(&curve(extent)));
        if !(least..=most).contains(&self.length) {
            return Err(format!(
                "with its ends {:.4} m apart the knot takes {least:.4} to {most:.4} m of rod, not {:.4} m",
                self.end_to_end, self.length
            ));
        }
        for _ in 0..BISECTIONS {
            let extent = 0.5 * (smaller + larger);
            if length(&curve(extent)) < self.length {
                smaller = extent;
            } else {
                larger = extent;
            }
        }
        Ok(curve(0.5 * (smaller + larger)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(extent: f64) -> Vec<Vector3> {
        [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
            .map(|[x, y]| Vector3::new(x, y, 0.0) * extent)
            .to_vec()
    }

    #[test]
    fn a_curve_is_as_long_as_the_rod_or_there_is_none() {
        let size = KnotSize {
            length: 10.0,
            radius: 0.1,
            end_to_end: 1.0,
        };
        let curve = size.fitted([0.1, 5.0], square).unwrap();
        assert!((length(&curve) - 10.0).abs() < 1e-14);
        let refused = |bounds| size.fitted(bounds, square).unwrap_err();
        assert!(refused([0.1, 2.0]).contains("takes 0.3000 to 6.0000 m of rod, not 10.0000 m"));
        assert!(refused([5.0, 0.1]).contains("too near"));
    }
}
