//! Arguments of tasks with rods: motion of the arms, directory of the results.

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
    /// Place of the pattern in the cell: x,y,z in metres, a turn about z in degrees; or `auto`
    ///
    /// `auto` selects the best place on the table for the arm that lays the rod. By default the
    /// middle of the pattern is in the middle of the table.
    #[arg(
        long,
        hide_short_help = true,
        value_name = "X,Y,Z[,TURN]|auto",
        allow_hyphen_values = true
    )]
    place: Option<Place>,
    /// Largest speed of a hand that holds the rod, m/s
    #[arg(long, hide_short_help = true, value_name = "SPEED", default_value_t = 0.03, value_parser = positive)]
    pub hand_speed: f64,
    /// Largest speed of a hand that holds nothing, m/s
    #[arg(long, hide_short_help = true, value_name = "SPEED", default_value_t = 0.1, value_parser = positive)]
    pub approach_speed: f64,
    /// Least distance of the arms from each other and from anything else, m
    #[arg(long, hide_short_help = true, value_name = "DISTANCE", default_value_t = 0.01, value_parser = positive)]
    pub margin: f64,
    /// Colour of the rod, as in `rodlab trace`
    #[arg(long, value_name = "RULE", default_value = "auto")]
    pub colour: String,
    /// Plan everything and write the pages, but move nothing
    #[arg(long)]
    pub dry_run: bool,
    /// The arms and their grippers were inspected after a task that did not finish
    #[arg(long, hide_short_help = true)]
    pub checked: bool,
    /// Directory for the results [default: results/TASK-TIME]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

impl TaskArguments {
    /// Place in a cell of patterns with these points, m.
    ///
    /// # Errors
    /// No place is given, and the cell has no table.
    pub fn place(&self, cell: &Cell, outline: &[Point]) -> Result<Place, PlanError> {
        let place = self.place.or_else(|| middle_of_table(cell, outline));
        place.ok_or_else(|| PlanError::Input("--place is required: the cell has no [table]".into()))
    }

    /// Returns the options of the run.
    pub fn way(&self) -> Way<'_> {
        Way {
            arm: None,
            dry_run: self.dry_run,
            checked: Some(self.checked),
            out: self.out.as_deref(),
        }
    }
}
