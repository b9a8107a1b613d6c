//! `--watch` and `--speed-override`: the live page of a motion, and its speed.

use super::prelude::*;
use super::values::within;
use rodlab_robot::JointTrajectory;
use rodlab_workcell::cell::Cell;
use rodlab_workcell::live::LivePage;
use rodlab_workcell::task::SpeedOverride;

/// The reason why the speed of a motion cannot change.
const FIXED: &str = "the speed of a motion can change only with `streaming.horizon` in the cell file; without it a controller receives \
                     the whole motion at once";

/// Choice of the live page, and of the speed at the start.
#[derive(Clone, Debug, Args)]
pub struct LiveArguments {
    /// Open a live page with buttons to hold, resume, slow and stop
    ///
    /// The page is served on this computer only; its address is printed. Without a port a free one
    /// is chosen.
    #[arg(long, value_name = "PORT", num_args = 0..=1, require_equals = true, default_missing_value = "0")]
    pub watch: Option<u16>,
    /// Speed at the start, relative to the planned one: 0 holds the motion until it is released
    ///
    /// The live page changes it during the motion. Needs `streaming.horizon` in the cell file.
    #[arg(long, hide_short_help = true, value_name = "FRACTION", default_value_t = 1.0, value_parser = within(0.0, 1.0))]
    pub speed_override: f64,
}

impl LiveArguments {
    /// The speed at the start.
    ///
    /// # Errors
    /// The speed cannot change in this cell, or nothing could release a motion that is held.
    pub fn speed(&self, cell: &Cell) -> Result<SpeedOverride, Failure> {
        if self.speed_override != 1.0 && cell.streaming.horizon.is_none() {
            return Err(Failure::Input(format!("--speed-override: {FIXED}")));
        }
        if self.speed_override == 0.0 && self.watch.is_none() {
            return Err(Failure::Input(
                "--speed-override 0 needs --watch: nothing else could release the motion".into(),
            ));
        }
        Ok(SpeedOverride::new(self.speed_override))
    }

    /// The live page of the motions `plan` in a cell, if there is to be one; it is opened in the browser.
    ///
    /// # Errors
    /// The port is in use.
    pub fn page(
        &self,
        cell: &Cell,
        plan: &[JointTrajectory],
        speed: &SpeedOverride,
    ) -> Result<Option<LivePage>, Failure> {
        let Some(port) = self.watch else {
            return Ok(None);
        };
        let fixed = cell.streaming.horizon.is_none().then_some(FIXED);
        let page = LivePage::serve(cell, plan, port, speed, fixed);
        let page = page.map_err(|error| {
            Failure::System(format!("--watch: port {port} cannot be used: {error}"))
        })?;
        let address = page.address();
        match open::that_detached(&address) {
            Ok(()) => tracing::warn!("the live page is {address}"),
            Err(error) => {
                tracing::warn!("no browser could be started: {error}; open {address}");
            }
        }
        Ok(Some(page))
    }
}
