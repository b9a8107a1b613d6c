//! Values over positions of a plot as colours, with their colour bar.

use super::axis::{Axis, AxisScale};

use super::drawing::{Anchor, Drawing, Stroke, Words, number};
use super::mark::Mark;
use super::palette::Color;
use super::plot_axes::{Axes, Frame, widest_label};

/// Space between the plot and the bar, and width of the bar, em.
const GAP: f64 = 1.2;
const WIDTH: f64 = 0.9;
/// Space between the bar and its tick labels and between these and the name, and height of the
/// name, em.
const BESIDE: f64 = 0.35;
const NAME: f64 = 1.3;
/// Steps of colour in the bar.
const STEPS: usize = 64;
/// Radius of a position without a size, em.
const DOT: f64 = 0.3;

/// Values at positions of a plot, each shown by its colour.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ColourField {
    /// Name and unit of the values.
    pub label: String,
    /// Positions and values: x, y, value.
    pub values: Vec<[f64; 3]>,
    /// Width and height of the rectangle around each position; `None` for a disc.
    pub cell: Option<[f64; 2]>,
    /// Scale of the colours.
    pub scale: AxisScale,
    /// Largest value with a colour of its own; larger values have the last colour.
    pub most: Option<f64>,
}

/// A field with its colour axis.
pub(super) struct DrawnField<'a> {
    field: &'a ColourField,
    axis: Axis,
    em: f64,
}

impl<'a> DrawnField<'a> {
    pub fn new(field: &'a ColourField, em: f64) -> Self {
        let most = field.most.unwrap_or(f64::INFINITY);
        let values = field.values.iter().map(|[_, _, value]| value.min(most));
        let axis = Axis::around(field.scale, values);
        Self { field, axis, em }
    }

    /// Width of the bar with its ticks and its name, pixels.
    pub fn room(&self) -> f64 {
        let ticks = self.axis.ticks(6);
        self.em * (GAP + WIDTH + 2.0 * BESIDE + widest_label(&ticks) + NAME)
    }

    fn color(&self, value: f64) -> Color {
        let most = self.field.most.unwrap_or(f64::INFINITY);
        Color::of_part(self.axis.part(value.min(most)))
    }

    /// Draws the values.
    pub fn draw(&self, axes: &Axes, drawing: &mut Drawing) {
        for &[x, y, value] in &self.field.values {
            let color = self.color(value);
            let path = match self.field.cell {
                Some([width, height]) => {
                    let [left, right] = [-0.5, 0.5].map(|side| axes.x(x + side * width));
                    let [below, above] = [-0.5, 0.5].map(|side| axes.y(y + side * height));
                    // The rectangles are slightly enlarged, so that no background shows between
                    // neighbours.
                    let (left, above) = (left - 0.15, above - 0.15);
                    let (across, down) = (right - left + 0.15, below - above + 0.15);
                    format!(
                        "M{} {}h{}v{}h-{}z",
                        number(left),
                        number(above),
                        number(across),
                        number(down),
                        number(across)
                    )
                }
                None => Mark::Disc.path([axes.x(x), axes.y(y)], DOT * self.em),
            };
            drawing.area(&path, color);
        }
    }

    /// Draws the bar to the right of a frame.
    pub fn draw_bar(&self, beside: Frame, drawing: &mut Drawing) {
        let em = self.em;
        let left = beside.right + GAP * em;
        let frame = Frame {
            left,
            right: left + WIDTH * em,
            ..beside
        };
        let axes = Axes {
            frame,
            horizontal: &self.axis,
            vertical: &self.axis,
        };
        let height = (frame.bottom - frame.top) / STEPS as f64;
        let width = number(WIDTH * em);
        for step in 0..STEPS {
            let part = (step as f64 + 0.5) / STEPS as f64;
            let top = frame.bottom - (step + 1) as f64 * height;
            let path = format!(
                "M{} {}h{width}v{}h-{width}z",
                number(left),
                number(top),
                number(height + if step > 0 { 0.3 } else { 0.0 }),
            );
            drawing.area(&path, Color::of_part(part));
        }
        let ticks = self
            .axis
            .ticks(((frame.bottom - frame.top) / (2.2 * em)) as usize);
        let is_cut = self.field.most.is_some();
        for (value, label) in &ticks.labelled {
            let y = axes.y(*value);
            let tick = format!(
                "M{} {}h{}",
                number(frame.right),
                number(y),
                number(0.2 * em)
            );
            drawing.path(&tick, &Stroke::solid(Color::BLACK, 0.07 * em), None);
            drawing.text(Words {
                text: label,
                at: [frame.right + BESIDE * em, y + 0.36 * em],
                size: em,
                anchor: Anchor::Start,
                upright: false,
            });
        }
        let factor = ticks.factor.unwrap_or_default();
        let above = if is_cut { "and above" } else { &factor };
        drawing.text(Words {
            text: above,
            at: [left, frame.top - 0.35 * em],
            size: em,
            anchor: Anchor::Start,
            upright: false,
        });
        drawing.text(Words {
            text: &self.field.label,
            at: [
                left + self.room() - GAP * em - 0.2 * em,
                0.5 * (frame.top + frame.bottom),
            ],
            size: em,
            anchor: Anchor::Middle,
            upright: true,
        });
    }
}
