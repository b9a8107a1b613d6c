//! Rods that are wider than thick: strips and sheets.

use nalgebra::Vector3;

/// The rectangle of a rod's cross-section, and its orientation as placed.
///
/// Results hold positions of nodes, not the rotation of rods about their tangents: pictures rotate
/// a strip by the smallest rotation from its placed orientation. This is exact for strips that
/// bend about their width only, such as sheets.
#[derive(Clone, Debug, PartialEq)]
pub struct Strip {
    /// Extent along the width, m.
    pub width: f64,
    /// Extent across it, m.
    pub thickness: f64,
    /// Tangent of the rod and unit vector along the width at each node as placed.
    pub placed: Vec<[Vector3<f64>; 2]>,
}

impl Strip {
    /// A strip with its width along `director` at its first node and transported along the rod
    /// without twist.
    pub fn placed(
        width: f64,
        thickness: f64,
        director: &Vector3<f64>,
        points: &[Vector3<f64>],
        closed: bool,
    ) -> Self {
        let mut placed: Vec<[Vector3<f64>; 2]> = Vec::with_capacity(points.len());
        for node in 0..points.len() {
            let tangent = tangent(node, points, closed);
            let across = match placed.last() {
                None => square_to(director, &tangent),
                Some([before, across]) => turned(across, before, &tangent),
            };
            placed.push([tangent, across]);
        }
        Self {
            width,
            thickness,
            placed,
        }
    }

    /// Unit vector along the width at a node, for the given positions of the nodes.
    pub(in crate::figure) fn across(
        &self,
        node: usize,
        points: &[Vector3<f64>],
        closed: bool,
    ) -> Vector3<f64> {
        let [from, across] = &self.placed[node];
        turned(across, from, &tangent(node, points, closed))
    }
}

/// Unit tangent of a rod at a node, from its neighbours; at an open end, along the edge.
pub(in crate::figure) fn tangent(
    node: usize,
    points: &[Vector3<f64>],
    closed: bool,
) -> Vector3<f64> {
    let last = points.len() - 1;
    let (before, after) = match (closed, node) {
        (true, _) => ((node + last) % (last + 1), (node + 1) % (last + 1)),
        (false, _) => (node.saturating_sub(1), (node + 1).min(last)),
    };
    let along = points[after] - points[before];
    along.try_normalize(0.0).unwrap_or_else(Vector3::x)
}

/// A unit vector normal to `from`, after the smallest rotation from `from` to `to`; for opposite
/// vectors, after half a turn.
pub(in crate::figure) fn turned(
    vector: &Vector3<f64>,
    from: &Vector3<f64>,
    to: &Vector3<f64>,
) -> Vector3<f64> {
    let along = from.dot(to);
    if along < -1.0 + 1e-9 {
        return square_to(vector, to);
    }
    let axis = from.cross(to);
    let turned = vector * along + axis.cross(vector) + axis * (axis.dot(vector) / (1.0 + along));
    square_to(&turned, to)
}

/// The component of a vector normal to a unit tangent, normalised; any normal if it is zero.
pub(in crate::figure) fn square_to(vector: &Vector3<f64>, tangent: &Vector3<f64>) -> Vector3<f64> {
    let square =
        |vector: &Vector3<f64>| (vector - tangent * tangent.dot(vector)).try_normalize(1e-9);
    let other = if tangent.z.abs() < 0.8 {
        Vector3::z()
    } else {
        Vector3::x()
    };
    square(vector)
        .or_else(|| square(&other))
        .unwrap_or_else(Vector3::y)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arc(turn: f64) -> Vec<Vector3<f64>> {
        let angle = |k: usize| turn * k as f64 / 20.0;
        (0..=20)
            .map(|k| Vector3::new(angle(k).sin(), 0.0, 1.0 - angle(k).cos()))
            .collect()
    }

    #[test]
    fn a_sheet_that_is_rolled_up_keeps_its_width_across() {
        let flat: Vec<Vector3<f64>> = (0..=20).map(|k| Vector3::x() * (0.05 * k as f64)).collect();
        let sheet = Strip::placed(0.2, 1e-4, &Vector3::y(), &flat, false);
        for turn in [0.1, 1.0, std::f64::consts::PI, 6.0] {
            for node in 0..=20 {
                let across = sheet.across(node, &arc(turn), false);
                assert!(
                    (across - Vector3::y()).norm() < 1e-9,
                    "{turn} {node} {across}"
                );
            }
        }
    }

    #[test]
    fn the_width_is_square_to_the_rod_wherever_it_was_placed() {
        let flat: Vec<Vector3<f64>> = (0..=20).map(|k| Vector3::x() * (0.05 * k as f64)).collect();
        for director in [Vector3::x(), Vector3::new(1.0, 1.0, 0.2)] {
            let strip = Strip::placed(0.1, 0.01, &director, &flat, false);
            let bent = arc(2.0);
            for node in 0..=20 {
                let across = strip.across(node, &bent, false);
                assert!(across.dot(&tangent(node, &bent, false)).abs() < 1e-9);
                assert!((across.norm() - 1.0).abs() < 1e-9);
            }
        }
    }
}
