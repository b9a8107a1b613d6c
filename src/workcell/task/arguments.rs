//! How arms of a cell move in a task with rods, and where its results go.

use super::command::Way;
use super::motion::middle_of_table;
use crate::cell::{Cell, Place, PlanError};
use clap::Args;
use rodlab_files::input::positive;
use rodlab_vision::Point;
use std::path::PathBuf;

/// Place, speeds, colour and results.
#[derive(Debug, Args)]
pub struct TaskArguments {
    /// Where the pattern lies in the cell: x,y,z in metres and a turn about z in degrees, or `auto`: the best place on the
    /// table for the arm that lays [default: its middle in that of the table]
    #[arg(long, value_name = "X,Y,Z[,TURN]|auto", allow_hyphen_values = true)]
    place: Option<Place>,
    /// Greatest speed of a hand that holds the rod, m/s
    #[arg(long, value_name = "SPEED", default_value_t = 0.03, value_parser = positive)]
    pub hand_speed: f64,
    /// Greatest speed of a hand that holds nothing, m/s
    #[arg(long, value_name = "SPEED", default_value_t = 0.1, value_parser = positive)]
    pub approach_speed: f64,
    /// Least distance of the arms to each other and to anything else, m
    #[arg(long, value_name = "DISTANCE", default_value_t = 0.01, value_parser = positive)]
    pub margin: f64,
    /// Which colours are rod, as of `rodlab trace`
    #[arg(long, value_name = "RULE", default_value = "auto")]
    pub colour: String,
    /// Plan everything, write the pages, and move nothing
    #[arg(long)]
    pub dry_run: bool,
    /// The arms, and what they hold, were looked at after a task that did not come to its end
    #[arg(long)]
    pub checked: bool,
    /// Where everything goes [default: results/TASK-TIME]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

impl TaskArguments {
    /// Where patterns with these points, m, lie in a cell.
    ///
    /// # Errors
    /// It is not given, and the cell has no table.
    pub fn place(&self, cell: &Cell, outline: &[Point]) -> Result<Place, PlanError> {
        let place = self.place.or_else(|| middle_of_table(cell, outline));
        place.ok_or_else(|| PlanError::Input("--place is needed: the cell has no [table]".into()))
    }

    /// How the task is run.
    pub fn way(&self) -> Way<'_> {
        Way {
            arm: None,
            dry_run: self.dry_run,
            checked: Some(self.checked),
            out: self.out.as_deref(),
        }
    }
}
