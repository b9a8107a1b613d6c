//! Robot cells: their files, simulation and tasks.
//!
//! | room | contents |
//! |---|---|
//! | [`cell`] | a robot cell from its file: arms, axes, table, camera, drivers |
//! | [`virtual_cell`] | the same cell simulated, with a rod or a sheet, behind the protocol of real ones |
//! | [`recording`] | the log of a task: its measured motion, and as an MCAP file |
//! | [`task`] | tasks of the cell: a rod laid along a pattern, a knot tied, a sheet folded, seen and scored |
//! | [`live`] | the live page of a task in the browser |

// Tests compare with a tolerance, and may call any mathematical library.
#![cfg_attr(test, allow(clippy::disallowed_methods))]

pub mod cell;
pub mod live;
pub mod recording;
pub mod task;
#[cfg(test)]
mod test_cells;
pub mod virtual_cell;
