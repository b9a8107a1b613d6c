//! A rod drawn as a shaded tube: pieces of stroked curve, painted from far to near.

use super::palette::Color;
use super::view::{Projected, View};
use nalgebra::{Vector2, Vector3};

/// A rod to be drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct RodCurve {
    /// The nodes, m.
    pub points: Vec<Vector3<f64>>,
    /// Whether the last node is joined to the first.
    pub closed: bool,
    /// Radius, m; the largest one if it varies.
    pub radius: f64,
    /// Radius at each node, m, if it varies.
    pub radii: Vec<f64>,
    /// Whether it is an obstacle, which does not move.
    pub held: bool,
}

impl RodCurve {
    /// Radius at a node, m.
    pub fn radius_at(&self, node: usize) -> f64 {
        self.radii.get(node).copied().unwrap_or(self.radius)
    }
}

/// The colour of the rod with the given index; obstacles are grey.
pub(super) fn rod_color(index: usize, held: bool) -> Color {
    if held {
        Color::BLACK.towards(Color::WHITE, 0.55)
    } else {
        Color::of(index)
    }
}

/// Placement of the picture on the page: pixels = origin + scale · metres, downwards.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placement {
    pub origin: Vector2<f64>,
    /// Pixels per metre.
    pub scale: f64,
}

impl Placement {
    pub fn pixels(&self, point: &Projected) -> Vector2<f64> {
        self.origin + self.scale * Vector2::new(point.x, -point.y)
    }
}

/// A piece of a tube between two nodes, a cubic curve with its shading; or a face of a body,
/// sorted with them.
pub(super) struct Piece {
    /// Nearness of the piece to the eye, m.
    pub nearness: f64,
    /// Elements of the piece.
    pub svg: String,
}

/// Minimum width of drawn rods, pixels: thinner ones would be invisible.
const MINIMUM_WIDTH: f64 = 1.4;

const ROUND: &str = " stroke-linecap=\"round\"";

/// Width of the body between the outlines, as a share of the whole.
const BODY: f64 = 0.78;

/// Fading towards white at the back, 0 to 1.
const HAZE: f64 = 0.45;

/// The rods of a scene and pieces of other objects, as SVG elements, far pieces first.
///
/// Each piece is one segment of the Catmull–Rom spline through the nodes, which is a cubic Bézier
/// curve. The tube is painted as an outline, the body, and a highlight on the side of the light. To
/// avoid visible seams between the pieces of one rod, the outline ends flat, the body round, and
/// the highlight extends beyond that round end.
pub(super) fn tubes(
    rods: &[RodCurve],
    among: Vec<Piece>,
    view: &View,
    placement: &Placement,
) -> String {
    let depths = rods
        .iter()
        .flat_map(|rod| &rod.points)
        .map(|point| view.project(point).nearness);
    let (far, near) = depths.fold((f64::INFINITY, f64::NEG_INFINITY), |(far, near), depth| {
        (far.min(depth), near.max(depth))
    });
    let thickest = rods.iter().map(|rod| rod.radius).fold(0.0, f64::max);
    // The depth of flat scenes is not significant.
    let depth = (near - far).max(20.0 * thickest);
    let mut pieces = among;
    for (index, rod) in rods.iter().enumerate() {
        let farness = |nearness: f64| (near - nearness) / depth;
        pieces.extend(rod_pieces(
            rod,
            rod_color(index, rod.held),
            view,
            placement,
            farness,
        ));
    }
    pieces.sort_by(|a: &Piece, b: &Piece| a.nearness.total_cmp(&b.nearness));
    pieces.into_iter().map(|piece| piece.svg).collect()
}

fn rod_pieces(
    rod: &RodCurve,
    color: Color,
    view: &View,
    placement: &Placement,
    farness: impl Fn(f64) -> f64,
) -> Vec<Piece> {
    let width_at = |node: usize| (2.0 * rod.radius_at(node) * placement.scale).max(MINIMUM_WIDTH);
    let projected: Vec<Projected> = rod.points.iter().map(|point| view.project(point)).collect();
    let pixels: Vec<Vector2<f64>> = projected
        .iter()
        .map(|point| placement.pixels(point))
        .collect();
    let spline = Spline {
        nodes: &pixels,
        closed: rod.closed,
    };
    let highlight: Vec<Vector2<f64>> = (0..pixels.len())
        .map(|node| pixels[node] + 0.22 * width_at(node) * spline.lit_side(node))
        .collect();
    let highlight = Spline {
        nodes: &highlight,
        closed: rod.closed,
    };
    (0..spline.segments())
        .map(|segment| {
            let next = (segment + 1) % pixels.len();
            let nearness = 0.5 * (projected[segment].nearness + projected[next].nearness);
            let color = color.towards(Color::WHITE, HAZE * farness(nearness));
            let outline = color.towards(Color::BLACK, 0.55);
            let mut svg = String::new();
            let width = 0.5 * (width_at(segment) + width_at(next));
            let is_thick = width > 2.0 * MINIMUM_WIDTH;
            // Draw the round free end, including its outline.
            for (is_end, node) in [(segment == 0, 0), (next + 1 == pixels.len(), next)] {
                if is_end && is_thick && !rod.closed {
                    let dot = format!("M{}l0.01 0", pair(pixels[node]));
                    svg += &stroke(&dot, outline, width, ROUND);
                }
            }
            svg += &stroke(&spline.path(segment, 0.3), outline, width, "");
            svg += &stroke(&spline.path(segment, 0.0), color, BODY * width, ROUND);
            if is_thick {
                let light = color.towards(Color::WHITE, 0.5);
                let path = highlight.path(segment, 0.42 * BODY * width);
                svg += &stroke(&path, light, 0.22 * width, "");
            }
            Piece { nearness, svg }
        })
        .collect()
}

/// A stroked path with further `attributes`.
fn stroke(path: &str, color: Color, width: f64, attributes: &str) -> String {
    let color = color.hex();
    format!("<path d=\"{path}\" stroke=\"{color}\" stroke-width=\"{width:.2}\"{attributes}/>\n")
}

/// The Catmull–Rom spline through the nodes of a rod on the page.
struct Spline<'a> {
    nodes: &'a [Vector2<f64>],
    closed: bool,
}

impl Spline<'_> {
    fn segments(&self) -> usize {
        if self.closed {
            self.nodes.len()
        } else {
            self.nodes.len().saturating_sub(1)
        }
    }

    /// Half the difference of the neighbours; at an open end, the difference to the only
    /// neighbour.
    fn tangent(&self, node: usize) -> Vector2<f64> {
        let last = self.nodes.len() - 1;
        let (before, after) = match node {
            0 if self.closed => (self.nodes[last], self.nodes[1 % self.nodes.len()]),
            0 => return self.nodes[1] - self.nodes[0],
            _ if node == last && self.closed => (self.nodes[last - 1], self.nodes[0]),
            _ if node == last => return self.nodes[last] - self.nodes[last - 1],
            _ => (self.nodes[node - 1], self.nodes[node + 1]),
        };
        0.5 * (after - before)
    }

    /// Unit vector across the curve towards the light, which comes from the top left.
    fn lit_side(&self, node: usize) -> Vector2<f64> {
        let tangent = self.tangent(node);
        let across = Vector2::new(-tangent.y, tangent.x);
        let side = across
            .try_normalize(f64::MIN_POSITIVE)
            .unwrap_or_else(Vector2::zeros);
        // Fade out where the curve runs along the light, so that the highlight is continuous.
        side * side.dot(&Vector2::new(-0.6, -0.8)).clamp(-0.5, 0.5) * 2.0
    }

    /// The curve from a node to the next, with a short straight piece of the given length beyond
    /// both ends.
    fn path(&self, segment: usize, beyond: f64) -> String {
        let next = (segment + 1) % self.nodes.len();
        let (start, end) = (self.nodes[segment], self.nodes[next]);
        let (leaving, arriving) = (self.tangent(segment), self.tangent(next));
        let (a, b) = (start + leaving / 3.0, end - arriving / 3.0);
        // Relative numbers are short, which makes the file a third smaller.
        let curve = format!(
            "c{} {} {}",
            pair(a - start),
            pair(b - start),
            pair(end - start)
        );
        if beyond == 0.0 {
            return format!("M{}{curve}", pair(start));
        }
        let before = leaving.cap_magnitude(beyond);
        let after = arriving.cap_magnitude(beyond);
        format!(
            "M{}l{}{curve}l{}",
            pair(start - before),
            pair(before),
            pair(after)
        )
    }
}

/// Two numbers in SVG notation, to a hundredth of a pixel.
fn pair(vector: Vector2<f64>) -> String {
    let [x, y] = [vector.x, vector.y].map(|number| (100.0 * number).round() / 100.0);
    format!("{x} {y}")
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLACEMENT: Placement = Placement {
        origin: Vector2::new(100.0, 100.0),
        scale: 1000.0,
    };

    fn bar(depth: f64) -> RodCurve {
        // Viewed from −y, nearer bars have smaller y.
        RodCurve {
            points: (0..4)
                .map(|k| Vector3::new(0.01 * k as f64, depth, 0.0))
                .collect(),
            closed: false,
            radius: 2e-3,
            radii: Vec::new(),
            held: false,
        }
    }

    fn view() -> View {
        View::from(-Vector3::y())
    }

    #[test]
    fn far_rods_are_painted_before_near_ones() {
        for (first, second) in [(0.0, 0.1), (0.1, 0.0)] {
            let svg = tubes(&[bar(first), bar(second)], Vec::new(), &view(), &PLACEMENT);
            let near = if first < second { 0 } else { 1 };
            let near_color = Color::of(near).hex();
            let first_near = svg.find(&near_color).expect("the near rod is not pale");
            let far_color = Color::of(1 - near).towards(Color::WHITE, HAZE).hex();
            let last_far = svg.rfind(&far_color).expect("the far rod is pale");
            assert!(last_far < first_near);
        }
    }

    #[test]
    fn a_rod_has_its_true_width_and_a_closed_one_a_piece_more() {
        let width = |svg: &str| svg.split("stroke-width=\"").nth(1).unwrap()[..4].to_owned();
        let svg = tubes(&[bar(0.0)], Vec::new(), &view(), &PLACEMENT);
        assert_eq!(width(&svg), "4.00");
        // Three segments of three layers each, and the outlines of two round ends.
        assert_eq!(svg.matches("<path").count(), 3 * 3 + 2);
        let ring = RodCurve {
            closed: true,
            ..bar(0.0)
        };
        assert_eq!(
            tubes(&[ring], Vec::new(), &view(), &PLACEMENT)
                .matches("<path")
                .count(),
            4 * 3
        );
    }

    #[test]
    fn straight_rods_are_straight_on_the_page() {
        let svg = tubes(&[bar(0.0)], Vec::new(), &view(), &PLACEMENT);
        assert!(svg.contains("M110 100c3.33 0 6.67 0 10 0"), "{svg}");
    }
}
