//! The general experiment: the rods listed in the scenario, with clamps, loads and planes.

use super::Kind;
use crate::scenario::Experiment;
use crate::scenario::keys::{CommonTables, ExperimentKeys, Request, Section};
use serde::Serialize;

/// Rods as listed.
pub struct SceneKind;

/// The general experiment, which reads only the common tables.
#[derive(Serialize)]
struct NoTables {}

impl ExperimentKeys for SceneKind {
    fn name(&self) -> &'static str {
        "scene"
    }

    fn summary(&self) -> &'static str {
        "Rods as listed, with clamps, loads and planes."
    }

    fn refusal(&self) -> &'static str {
        "this table is for builders; a scene lists its rods as [[rods]]"
    }

    fn resolve(&self, request: &Request<'_>) -> Option<Experiment> {
        request.refuse(&["rod"], self.refusal());
        Some(Experiment::new(self.name(), NoTables {}))
    }

    fn judge(&self, top: &Section<'_>, common: &CommonTables<'_>) {
        // Free bodies move by themselves.
        if common.parts.smallest_radius().is_finite() {
            return;
        }
        if common.rods.is_empty() {
            top.missing(
                "rods",
                "a scene needs at least one rod or free body; [[rods]] with count = 0 make none",
            );
        } else if common.rods.iter().all(|rod| rod.held) {
            top.fault(
                "rods",
                "every rod is held; at least one must be free to move",
            );
        }
    }
}

impl Kind for SceneKind {
    fn template(&self) -> &'static str {
        include_str!("template.toml")
    }
}
