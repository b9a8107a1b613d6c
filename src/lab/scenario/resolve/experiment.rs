//! Interface of a kind of experiment to scenario files.

use super::request::{CommonTables, Request};
use crate::scenario::own_tables::OwnTable;
use crate::scenario::resolved::{Experiment, Time};
use crate::scenario::section::Section;

/// A kind of experiment as scenario files see it.
pub trait ExperimentKeys: Sync {
    /// Name of the experiment in scenario files.
    fn name(&self) -> &'static str;

    /// Description of the simulation, one sentence.
    fn summary(&self) -> &'static str;

    /// The tables that belong to it; kinds may share a table.
    fn tables(&self) -> &'static [OwnTable] {
        &[]
    }

    /// Default if the file has no table `[time]`; `None` if the table is required.
    fn usual_time(&self) -> Option<Time> {
        None
    }

    /// Default of `fluid.spin`: whether the fluid resists rotation of rods about their own axes.
    fn resists_spin(&self) -> bool {
        true
    }

    /// Message for a table that belongs only to other kinds.
    fn refusal(&self) -> &'static str {
        "this table is for another experiment"
    }

    /// Resolves the tables of this kind and rejects common tables that it does not use; `None`
    /// after a fault that prevents further checks.
    fn resolve(&self, request: &Request<'_>) -> Option<Experiment>;

    /// Reports missing and unsupported keys of the common tables.
    fn judge(&self, _top: &Section<'_>, _common: &CommonTables<'_>) {}
}
