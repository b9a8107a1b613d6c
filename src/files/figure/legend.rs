//! Legends: the names of curves, rods or planes.

use super::drawing::{Anchor, Drawing, Words};
use super::text::Line;

/// Space from the start of a sample to its name, and after the name, em.
const SAMPLE: f64 = 2.5;
const GAP: f64 = 1.3;
/// Height of a row, em.
const ROW: f64 = 1.6;

/// Names side by side, each after a sample, in as many rows as needed.
pub(super) struct Legend {
    names: Vec<String>,
    /// Left ends and rows of the samples, pixels.
    places: Vec<(f64, usize)>,
    rows: usize,
    em: f64,
}

impl Legend {
    /// A legend between a left and a right edge, pixels.
    pub fn between(left: f64, right: f64, names: Vec<String>, em: f64) -> Self {
        let (mut x, mut row) = (left, 0);
        let mut places = Vec::new();
        for name in &names {
            let width = (SAMPLE + Line::of(name).width) * em;
            if x + width > right && x > left {
                (x, row) = (left, row + 1);
            }
            places.push((x, row));
            x += width + GAP * em;
        }
        let rows = if names.is_empty() { 0 } else { row + 1 };
        Self {
            names,
            places,
            rows,
            em,
        }
    }

    /// Height of the legend, pixels.
    pub fn height(&self) -> f64 {
        ROW * self.em * self.rows as f64
    }

    /// Draws the legend below `top`. `sample` draws the sample of an index between two positions
    /// at one height.
    pub fn draw(
        &self,
        top: f64,
        drawing: &mut Drawing,
        mut sample: impl FnMut(usize, [f64; 2], f64, &mut Drawing),
    ) {
        for (index, (name, (x, row))) in self.names.iter().zip(&self.places).enumerate() {
            let base = top + self.em * (1.1 + ROW * *row as f64);
            let middle = base - 0.36 * self.em;
            sample(index, [*x, x + (SAMPLE - 0.5) * self.em], middle, drawing);
            drawing.text(Words {
                text: name,
                at: [x + SAMPLE * self.em, base],
                size: self.em,
                anchor: Anchor::Start,
                upright: false,
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_names_stand_in_several_rows_within_the_edges() {
        let names: Vec<String> = (0..20).map(|k| format!("curve number {k}")).collect();
        let legend = Legend::between(40.0, 400.0, names.clone(), 10.0);
        assert!(legend.rows >= 5);
        for ((x, row), name) in legend.places.iter().zip(&names) {
            let end = x + 10.0 * (SAMPLE + Line::of(name).width);
            assert!(*x >= 40.0 && end <= 400.0 && *row < legend.rows, "{name}");
        }
        assert_eq!(Legend::between(0.0, 100.0, vec![], 10.0).height(), 0.0);
    }
}
