//! Pictures of plain curves and rows.
