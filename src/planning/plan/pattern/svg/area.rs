//! Filled areas without lines of their own.

use super::{DrawnStroke, SvgDrawing};
use crate::plan::pattern::{Point, bounds};

/// Largest thickness of a narrow area, as a fraction of its longer side.
const NARROW: f64 = 1.0 / 3.0;
/// Number of places along the longer side at which the thickness is measured.
const PLACES: usize = 80;
/// Maximum number of edge points with which the thickness is measured.
const MOST_POINTS: usize = 2000;
/// Maximum number of edges of an element whose holes are found.
const MOST_EDGES: usize = 1000;

/// A connected filled area of a drawing, such as a letter made into a path.
#[derive(Clone, Debug, PartialEq)]
pub struct FilledArea {
    /// Indices of the strokes around it: its outer edge, then its holes.
    pub edges: Vec<usize>,
    /// Diameter of the largest circle inside it, m.
    pub thickness: f64,
    /// Longer side of its bounding box, m.
    pub longer_side: f64,
}

impl FilledArea {
    /// Whether it looks like a thick line: it is at most a third as thick as it is long.
    pub fn is_narrow(&self) -> bool {
        self.thickness <= NARROW * self.longer_side
    }

    /// Whether a point of the drawing, m, is inside the area.
    pub fn contains(&self, drawing: &SvgDrawing, at: Point) -> bool {
        let edges = self
            .edges
            .iter()
            .filter_map(|edge| drawing.strokes.get(*edge));
        edges.filter(|edge| is_inside(&edge.points, at)).count() % 2 == 1
    }
}

impl SvgDrawing {
    /// The filled areas without lines of their own, except the background, in drawing order.
    pub fn areas(&self) -> Vec<FilledArea> {
        let is_area = |stroke: &DrawnStroke| stroke.is_outline && !stroke.is_background;
        let numbered: Vec<(usize, &DrawnStroke)> = self.strokes.iter().enumerate().collect();
        let elements = numbered.chunk_by(|(_, one), (_, next)| {
            is_area(one) == is_area(next) && (one.line, &one.id) == (next.line, &next.id)
        });
        let areas = elements.filter(|element| element.iter().any(|(_, stroke)| is_area(stroke)));
        areas.flat_map(areas_of).collect()
    }
}

/// The areas of an element: an edge inside an even number of others is an outer one.
fn areas_of(element: &[(usize, &DrawnStroke)]) -> Vec<FilledArea> {
    let around: Vec<Vec<usize>> = (0..element.len())
        .map(|inner| match element.len() > MOST_EDGES {
            true => Vec::new(),
            false => surrounding(element, inner),
        })
        .collect();
    let is_outer = |edge: &usize| around[*edge].len().is_multiple_of(2);
    let is_hole = |hole: &usize, outer: usize| {
        around[*hole].len() == around[outer].len() + 1 && around[*hole].contains(&outer)
    };
    let outer = (0..element.len()).filter(is_outer);
    let area = |outer: usize| {
        let holes = (0..element.len()).filter(|edge| is_hole(edge, outer));
        let edges: Vec<usize> = std::iter::once(outer).chain(holes).collect();
        let points: Vec<&[Point]> = edges
            .iter()
            .map(|edge| &element[*edge].1.points[..])
            .collect();
        let [low, high] = bounds(points[0]);
        FilledArea {
            edges: edges.iter().map(|edge| element[*edge].0).collect(),
            thickness: thickness(&points),
            longer_side: (high - low).max(),
        }
    };
    outer.map(area).collect()
}

/// The edges of an element that go around one of them.
fn surrounding(element: &[(usize, &DrawnStroke)], inner: usize) -> Vec<usize> {
    let first = element[inner].1.points[0];
    let others = element.iter().enumerate();
    let around =
        others.filter(|(index, (_, edge))| *index != inner && is_inside(&edge.points, first));
    around.map(|(index, _)| index).collect()
}

/// Diameter of the largest circle inside an area, found on a grid; too small by up to 2 % of the
/// longer side.
fn thickness(edges: &[&[Point]]) -> f64 {
    let [low, high] = bounds(edges[0]);
    let step = (high - low).max() / PLACES as f64;
    let count = |side: f64| (side / step).ceil() as usize;
    if !(step > 0.0) {
        return 0.0;
    }
    let most = edges.iter().map(|edge| edge.len()).sum::<usize>();
    let every = most.div_ceil(MOST_POINTS);
    let edges: Vec<Vec<Point>> = edges.iter().map(|edge| thinned(edge, every)).collect();
    let mut radius: f64 = 0.0;
    for row in 0..count((high - low).y) {
        for column in 0..count((high - low).x) {
            let at = low + Point::new(column as f64 + 0.5, row as f64 + 0.5) * step;
            if edges.iter().filter(|edge| is_inside(edge, at)).count() % 2 == 1 {
                let distances = edges.iter().map(|edge| distance_to_edge(edge, at));
                radius = radius.max(distances.fold(f64::INFINITY, f64::min));
            }
        }
    }
    2.0 * radius
}

/// One of `every` points, and the last one.
fn thinned(edge: &[Point], every: usize) -> Vec<Point> {
    let mut points: Vec<Point> = edge.iter().step_by(every).copied().collect();
    points.extend(edge.last());
    points
}

/// Whether a point is inside a closed edge, by the parity of the crossings of a ray.
fn is_inside(edge: &[Point], at: Point) -> bool {
    let crosses = |side: &&[Point]| {
        let (a, b) = (side[0], side[1]);
        (a.y > at.y) != (b.y > at.y) && at.x < a.x + (b.x - a.x) * (at.y - a.y) / (b.y - a.y)
    };
    edge.windows(2).filter(crosses).count() % 2 == 1
}

fn distance_to_edge(edge: &[Point], at: Point) -> f64 {
    let distance = |side: &[Point]| {
        let along = side[1] - side[0];
        let share = (at - side[0]).dot(&along) / along.norm_squared();
        let nearest = side[0]
            + along
                * if share.is_finite() {
                    share.clamp(0.0, 1.0)
                } else {
                    0.0
                };
        (at - nearest).norm()
    };
    edge.windows(2).map(distance).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn areas(content: &str) -> Vec<FilledArea> {
        let text = format!(
            "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' viewBox='0 0 100 100'>{content}</svg>"
        );
        SvgDrawing::read(&text).unwrap().areas()
    }

    #[test]
    fn thickness_is_that_of_the_largest_circle_inside() {
        let found = areas("<path d='M10 10H90V30H10Z'/>");
        assert_eq!(found[0].edges, [0]);
        assert!((found[0].thickness - 0.02).abs() < 1e-3, "{found:?}");
        assert!((found[0].longer_side - 0.08).abs() < 1e-9);
        assert!(found[0].is_narrow());
        let disk = &areas("<circle cx='50' cy='50' r='40'/>")[0];
        assert!(
            (0.0784..=0.08).contains(&disk.thickness) && !disk.is_narrow(),
            "{disk:?}"
        );
    }

    #[test]
    fn holes_belong_to_the_area_around_them() {
        // A ring with a disk inside, and a bar; one element.
        let found = areas(
            "<path fill-rule='evenodd' d='M0 0H60V60H0Z M10 10H50V50H10Z M25 25H35V35H25Z M70 0H80V60H70Z'/>",
        );
        let edges: Vec<&[usize]> = found.iter().map(|area| &area.edges[..]).collect();
        assert_eq!(edges, [&[0, 1][..], &[2], &[3]]);
        // The largest circle touches two outer sides and an inner corner: r = √2 (10 mm − r).
        let root = std::f64::consts::SQRT_2;
        let corner = 0.02 * root / (1.0 + root);
        assert!((found[0].thickness - corner).abs() < 2e-3, "{found:?}");
        let narrow: Vec<bool> = found.iter().map(FilledArea::is_narrow).collect();
        assert_eq!(narrow, [true, false, true]);
    }

    #[test]
    fn stars_and_hearts_are_not_narrow() {
        let star = "<polygon points='50,10 59.4,37.1 88,37.6 65.2,54.9 73.5,82.4 50,66 26.5,82.4 34.8,54.9 12,37.6 40.6,37.1'/>";
        let heart = "<path d='M50 85C10 55 10 20 35 20C45 20 50 30 50 35C50 30 55 20 65 20C90 20 90 55 50 85z'/>";
        for content in [star, heart] {
            let found = areas(content);
            assert!(found.len() == 1 && !found[0].is_narrow(), "{found:?}");
        }
        assert!(areas("<path fill='none' stroke='red' d='M0 0H60V60H0Z'/>").is_empty());
    }
}
