//! Common imports of modules of pages.

pub(super) use super::Result;
pub(super) use super::artifact::{Artifact, Free};
pub(super) use super::cases::Case;
pub(super) use super::page::{Page, PageFigure, columns, number};
pub(super) use super::table::{Rows, Tabled, curve, largest, mean, plot};
pub(super) use rodlab_files::figure::{
    AxisScale, Curve, Look, PlotStyle, line_plots, named_plots, plot_to_scale, styled_line_plots,
};
pub(super) use serde::{Deserialize, Serialize};
