//! The table that lies beside a page, and the figures that come of it.

use super::ReproduceError;
use super::page::PageFigure;
use rodlab_files::results::read_whole_rows;
use serde::de::DeserializeOwned;
use std::path::Path;

/// The figures of a page from its table.
pub(super) type FiguresOfTable = fn(&Path) -> Result<Vec<PageFigure>, ReproduceError>;

/// The rows of a table.
pub(super) fn rows_of<Row: DeserializeOwned>(table: &Path) -> Result<Vec<Row>, ReproduceError> {
    Ok(read_whole_rows(table)?.rows)
}
