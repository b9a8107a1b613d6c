//! The axes of a plot: lines, ticks, labels, grid.

use super::axis::{Axis, Ticks};
use super::drawing::{Anchor, Drawing, Stroke, Words, number};
use super::palette::Color;
use super::text::Line;

/// Lengths relative to the font size.
pub(super) const TICK: f64 = 0.35;
const AXIS_WIDTH: f64 = 0.07;
const GRID_WIDTH: f64 = 0.05;
/// Fading of the grid towards white.
const GRID: f64 = 0.88;
const SMALL_TICK: f64 = 0.2;
/// Space between a tick and its label, and between the label and the name of the axis.
pub(super) const GAP: f64 = 0.3;

/// The rectangle between the axes, pixels.
#[derive(Clone, Copy)]
pub(super) struct Frame {
    pub left: f64,
    pub right: f64,
    pub top: f64,
    pub bottom: f64,
}

/// Both axes of a plot in their frame.
pub(super) struct Axes<'a> {
    pub frame: Frame,
    pub horizontal: &'a Axis,
    pub vertical: &'a Axis,
}

impl Axes<'_> {
    /// Horizontal position of a value, pixels.
    pub fn x(&self, value: f64) -> f64 {
        let Frame { left, right, .. } = self.frame;
        left + (right - left) * self.horizontal.part(value)
    }

    /// Vertical position of a value, pixels.
    pub fn y(&self, value: f64) -> f64 {
        let Frame { top, bottom, .. } = self.frame;
        bottom - (bottom - top) * self.vertical.part(value)
    }
}

/// Width of the widest label, em.
pub(super) fn widest_label(ticks: &Ticks) -> f64 {
    let labels = ticks.labelled.iter();
    labels
        .map(|(_, label)| Line::of(label).width)
        .fold(0.0, f64::max)
}

/// As many ticks as fit with their labels beside each other.
pub(super) fn ticks_that_fit(axis: &Axis, width: f64, em: f64) -> Ticks {
    let fits = |ticks: &Ticks| {
        let room = em * (widest_label(ticks) + 1.2) * ticks.labelled.len() as f64;
        room <= width
    };
    let all = (2..=10).rev().map(|most| axis.ticks(most));
    all.into_iter().find(fits).unwrap_or_else(|| axis.ticks(2))
}

/// Strokes of an axis and of its grid.
fn strokes(em: f64) -> [Stroke; 2] {
    [
        Stroke::solid(Color::BLACK, AXIS_WIDTH * em),
        Stroke::solid(Color::BLACK.towards(Color::WHITE, GRID), GRID_WIDTH * em),
    ]
}

/// Draws the vertical axis with its grid and its label.
pub(super) fn draw_vertical(
    axes: &Axes,
    ticks: &Ticks,
    label: &str,
    em: f64,
    drawing: &mut Drawing,
) {
    let Frame {
        left,
        right,
        top,
        bottom,
    } = axes.frame;
    let [axis, grid] = strokes(em);
    for (value, label) in &ticks.labelled {
        let y = number(axes.y(*value));
        drawing.path(
            &format!("M{} {y}H{}", number(left), number(right)),
            &grid,
            None,
        );
        let reach = number(left - TICK * em);
        drawing.path(&format!("M{reach} {y}H{}", number(left)), &axis, None);
        drawing.text(Words {
            text: label,
            at: [left - (TICK + GAP) * em, axes.y(*value) + 0.36 * em],
            size: em,
            anchor: Anchor::End,
            upright: false,
        });
    }
    for value in &ticks.small {
        let (y, reach) = (number(axes.y(*value)), number(left - SMALL_TICK * em));
        drawing.path(&format!("M{reach} {y}H{}", number(left)), &axis, None);
    }
    let line = format!("M{} {}V{}", number(left), number(top), number(bottom));
    drawing.path(&line, &axis, None);
    drawing.text(Words {
        text: ticks.factor.as_deref().unwrap_or_default(),
        at: [left, top - 0.35 * em],
        size: em,
        anchor: Anchor::Start,
        upright: false,
    });
    // The label is next to the tick labels, and smaller on a short axis.
    let beside = left - (TICK + 2.0 * GAP + widest_label(ticks)) * em - 0.3 * em;
    let room = (bottom - top + 1.5 * em) / (Line::of(label).width * em);
    drawing.text(Words {
        text: label,
        at: [beside, 0.5 * (top + bottom)],
        size: em * room.clamp(0.6, 1.0),
        anchor: Anchor::Middle,
        upright: true,
    });
}

/// Draws the horizontal axis with its grid; tick labels are drawn below the last plot only.
pub(super) fn draw_horizontal(
    axes: &Axes,
    ticks: &Ticks,
    is_last: bool,
    em: f64,
    drawing: &mut Drawing,
) {
    let Frame {
        left,
        right,
        top,
        bottom,
    } = axes.frame;
    let [axis, grid] = strokes(em);
    for (value, label) in &ticks.labelled {
        let x = number(axes.x(*value));
        drawing.path(
            &format!("M{x} {}V{}", number(top), number(bottom)),
            &grid,
            None,
        );
        let reach = number(bottom + TICK * em);
        drawing.path(&format!("M{x} {}V{reach}", number(bottom)), &axis, None);
        if is_last {
            drawing.text(Words {
                text: label,
                at: [axes.x(*value), bottom + (TICK + GAP + 0.85) * em],
                size: em,
                anchor: Anchor::Middle,
                upright: false,
            });
        }
    }
    for value in &ticks.small {
        let (x, reach) = (number(axes.x(*value)), number(bottom + SMALL_TICK * em));
        drawing.path(&format!("M{x} {}V{reach}", number(bottom)), &axis, None);
    }
    let line = format!("M{} {}H{}", number(left), number(bottom), number(right));
    drawing.path(&line, &axis, None);
}
