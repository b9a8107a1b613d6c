//! Path data of SVG (SVG 1.1, sec. 8.3) as Bézier curves.

use kurbo::{Arc, BezPath, Point, SvgArc, Vec2};
use svgtypes::{Error, PathParser, PathSegment};

/// Largest distance of an arc from its Bézier curves, relative to its radius.
const ARC_ACCURACY: f64 = 1e-9;
/// Smallest radius of an arc.
const SMALLEST_ARC: f64 = 1e-100;

/// Reads path data up to its first error, and returns that error.
pub fn bezier_path(data: &str) -> (BezPath, Option<Error>) {
    let mut pen = Pen::default();
    for segment in PathParser::from(data) {
        match segment {
            Ok(segment) => pen.draw(&segment),
            Err(error) => return (pen.path, Some(error)),
        }
    }
    (pen.path, None)
}

#[derive(Default)]
struct Pen {
    path: BezPath,
    start: Point,
    at: Point,
    /// Last control point of the cubic or quadratic curve just drawn.
    cubic: Option<Point>,
    quadratic: Option<Point>,
}

impl Pen {
    fn draw(&mut self, segment: &PathSegment) {
        use PathSegment as S;
        let from = self.at;
        let place = |abs: bool, x: f64, y: f64| {
            if abs {
                Point::new(x, y)
            } else {
                from + Vec2::new(x, y)
            }
        };
        let (cubic, quadratic) = (self.cubic.take(), self.quadratic.take());
        // A control point mirrored about the current point.
        let mirrored =
            |control: Option<Point>| control.map_or(from, |control| from + (from - control));
        match *segment {
            S::MoveTo { abs, x, y } => {
                self.at = place(abs, x, y);
                self.start = self.at;
                self.path.move_to(self.at);
            }
            S::LineTo { abs, x, y } => self.line(place(abs, x, y)),
            S::HorizontalLineTo { abs, x } => {
                self.line(Point::new(place(abs, x, 0.0).x, from.y));
            }
            S::VerticalLineTo { abs, y } => {
                self.line(Point::new(from.x, place(abs, 0.0, y).y));
            }
            S::CurveTo {
                abs,
                x1,
                y1,
                x2,
                y2,
                x,
                y,
            } => self.cubic(place(abs, x1, y1), place(abs, x2, y2), place(abs, x, y)),
            S::SmoothCurveTo { abs, x2, y2, x, y } => {
                self.cubic(mirrored(cubic), place(abs, x2, y2), place(abs, x, y));
            }
            S::Quadratic { abs, x1, y1, x, y } => {
                self.quadratic(place(abs, x1, y1), place(abs, x, y));
            }
            S::SmoothQuadratic { abs, x, y } => {
                self.quadratic(mirrored(quadratic), place(abs, x, y));
            }
            S::EllipticalArc {
                abs,
                rx,
                ry,
                x_axis_rotation,
                large_arc,
                sweep,
                x,
                y,
            } => {
                let to = place(abs, x, y);
                let arc = SvgArc {
                    from,
                    to,
                    radii: Vec2::new(rx, ry),
                    x_rotation: x_axis_rotation.to_radians(),
                    large_arc,
                    sweep,
                };
                match Arc::from_svg_arc(&arc) {
                    // Larger angles have no fractional digits, and there would be endless cubics.
                    Some(arc) if arc.radii.x.max(arc.radii.y) > SMALLEST_ARC => {
                        let accuracy = ARC_ACCURACY * arc.radii.x.max(arc.radii.y);
                        arc.to_cubic_beziers(accuracy, |one, other, end| {
                            self.path.curve_to(one, other, end);
                        });
                        self.at = to;
                    }
                    _ => self.line(to),
                }
            }
            S::ClosePath { .. } => {
                self.path.close_path();
                self.at = self.start;
            }
        }
    }

    fn line(&mut self, to: Point) {
        self.reopen();
        self.path.line_to(to);
        self.at = to;
    }

    fn cubic(&mut self, one: Point, other: Point, to: Point) {
        self.reopen();
        self.path.curve_to(one, other, to);
        (self.at, self.cubic) = (to, Some(other));
    }

    fn quadratic(&mut self, control: Point, to: Point) {
        self.reopen();
        self.path.quad_to(control, to);
        (self.at, self.quadratic) = (to, Some(control));
    }

    /// After a closed subpath, drawing continues from its start.
    fn reopen(&mut self) {
        if let Some(kurbo::PathEl::ClosePath) = self.path.elements().last() {
            self.path.move_to(self.at);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn ends(data: &str) -> Vec<(f64, f64)> {
        let path = bezier_path(data).0;
        let ends = path
            .elements()
            .iter()
            .filter_map(|element| element.end_point());
        ends.map(|point| (point.x, point.y)).collect()
    }

    #[test]
    fn relative_and_short_commands_are_read() {
        assert_eq!(
            ends("m1 2 3 4 h5 v-6 l1,1z"),
            [(1., 2.), (4., 6.), (9., 6.), (9., 0.), (10., 1.)]
        );
        assert_eq!(
            ends("M0 0H3V4M5 5zL7 7"),
            [(0., 0.), (3., 0.), (3., 4.), (5., 5.), (5., 5.), (7., 7.)]
        );
        assert!(ends("L 1 1").is_empty());
        assert!(bezier_path("M 0 0 L 1").1.is_some());
        // Data before an error is still drawn.
        assert_eq!(ends("M 0 0 L 1 2 X 3"), [(0., 0.), (1., 2.)]);
    }

    #[test]
    fn smooth_curves_mirror_the_control_point() {
        let long = bezier_path("M0 0 C1 0 2 1 3 1 C4 1 5 2 6 0 Q7 -2 8 0 Q9 2 10 0").0;
        let short = bezier_path("M0 0 C1 0 2 1 3 1 S5 2 6 0 Q7 -2 8 0 T10 0").0;
        assert_eq!(long, short);
    }

    proptest! {
        #[test]
        fn any_text_is_read_or_refused(text in "[MmLlHhVvCcSsQqTtAaZz0-9eE., +-]{0,80}") {
            let _ = bezier_path(&text);
        }

        #[test]
        fn points_of_a_circular_arc_lie_on_its_circle(radius in 0.1..1e3f64, end in 0.3..6.0f64, sweep: bool) {
            let large = end > std::f64::consts::PI;
            let side = if sweep { 1.0 } else { -1.0 };
            let (x, y) = (radius * end.cos() - radius, side * radius * end.sin());
            let data = format!("M0 0 a{radius} {radius} 0 {} {} {x} {y}", u8::from(large), u8::from(sweep));
            let path = bezier_path(&data).0;
            let centre = Point::new(-radius, 0.0);
            kurbo::flatten(&path, 1e-7 * radius, |element| {
                if let Some(point) = element.end_point() {
                    let off = ((point - centre).hypot() / radius - 1.0).abs();
                    assert!(off < 1e-7, "{data}: {off}");
                }
            });
        }
    }
}
