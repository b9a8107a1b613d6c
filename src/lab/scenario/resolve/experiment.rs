//! What a scenario file must know of a kind of experiment.

use super::request::{CommonTables, Request};
use crate::scenario::own_tables::OwnTable;
use crate::scenario::resolved::{Experiment, Time};
use crate::scenario::section::Section;

/// A kind of experiment as scenario files see it.
pub trait ExperimentKeys: Sync {
    /// The name by which scenario files call it.
    fn name(&self) -> &'static str;

    /// What it simulates, in one sentence.
    fn summary(&self) -> &'static str;

    /// The tables that belong to it; kinds may share a table.
    fn tables(&self) -> &'static [OwnTable] {
        &[]
    }

    /// What holds where the file has no table `[time]`; `None` where it must have one.
    fn usual_time(&self) -> Option<Time> {
        None
    }

    /// Default of `fluid.spin`: whether a fluid resists that its rods spin about their own axes.
    fn resists_spin(&self) -> bool {
        true
    }

    /// What to say of a table that belongs to other kinds only.
    fn refusal(&self) -> &'static str {
        "this table is for another experiment"
    }

    /// Resolves its own tables and refuses common ones that mean nothing to it; `None` if a fault was reported that
    /// leaves nothing to go on with.
    fn resolve(&self, request: &Request<'_>) -> Option<Experiment>;

    /// Reports what it needs of the common tables, or cannot have there.
    fn judge(&self, _top: &Section<'_>, _common: &CommonTables<'_>) {}
}
