//! The experiments `knot-tightening` and `knot-inversion`, which differ in when they end.

use super::files::{FILES, TRACTION_FIGURE};
use super::keys::{KnotKind, KnotStart, KnotTables, TABLES, resolve};
use super::monitor::KnotMonitor;
use super::observer::KnotObserver;
use super::tied_knot::{determinant_of_kind, determinant_of_rods};
use super::tightening;
use super::traction_figure::traction_figure;
use crate::experiment::kind::{FigureError, Figures, Kind, OwnNumbers};
use crate::experiment::prepare::try_scene;
use crate::run::{Mode, PreparedRun, RunError};
use crate::scenario::keys::{CommonTables, ExperimentKeys, OwnTable, Request, Section};
use crate::scenario::{Contact, Experiment, Issue, KeyPath, Scenario, Time};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::scene::Scene;
use rodlab_files::results::FileDescription;
use serde::Serialize;
use std::path::Path;

/// A kind of experiment in which the ends of a knot are pulled apart.
pub struct PulledKnot {
    name: &'static str,
    summary: &'static str,
    template: &'static str,
    /// Whether it is an overhand knot that is pulled until its loop has snapped onto the braid.
    until_inverted: bool,
}

/// A knot whose ends are pulled apart.
pub static TIGHTENING: PulledKnot = PulledKnot {
    name: "knot-tightening",
    summary: "A knot whose ends are pulled apart.",
    template: include_str!("tightening_template.toml"),
    until_inverted: false,
};

/// An overhand knot whose ends are pulled apart until its loop has snapped onto the braid.
pub static INVERSION: PulledKnot = PulledKnot {
    name: "knot-inversion",
    summary: "An overhand knot that is pulled until its loop snaps onto the braid.",
    template: include_str!("inversion_template.toml"),
    until_inverted: true,
};

/// Numbers of a knot.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DerivedKnot {
    /// Determinant of the knot.
    pub determinant: u64,
    /// Speed at which each end is pulled, m/s.
    pub pull_speed: f64,
    /// l̄_k = (L − l_c)/h at the start and at the end of the pull.
    pub length_normalized: [f64; 2],
}

impl ExperimentKeys for PulledKnot {
    fn name(&self) -> &'static str {
        self.name
    }

    fn summary(&self) -> &'static str {
        self.summary
    }

    fn tables(&self) -> &'static [OwnTable] {
        &TABLES
    }

    fn resolve(&self, request: &Request<'_>) -> Option<Experiment> {
        let tables = resolve(request)?;
        let kind = tables.knot.start.kind();
        if self.until_inverted && !matches!(kind, Some(KnotKind::Overhand { .. })) {
            let message = "other knots do not invert; allowed: \"overhand\"";
            request.top.below("knot").fault("kind", message);
        }
        let radius = tables.rod.radius;
        Some(Experiment::new(self.name, tables).with_radius(radius))
    }

    fn judge(&self, top: &Section<'_>, common: &CommonTables<'_>) {
        if *common.contact == Contact::None {
            top.missing("contact", "a knot needs contact: a table [contact]");
        }
    }
}

impl Kind for PulledKnot {
    fn template(&self) -> &'static str {
        self.template
    }

    fn build(&self, scenario: &Scenario, scene: &mut Scene) -> Result<(), Issue> {
        let end = match scenario.time {
            Time::Static | Time::Continuation => 0.0,
            Time::Dynamic { end, .. } => end,
        };
        tightening::add(scene, scenario.experiment.own(), end)
    }

    fn attach(&self, scenario: &Scenario, run: &mut PreparedRun) -> Result<(), Issue> {
        let tables: &KnotTables = scenario.experiment.own();
        if let Some(observer) = observer(tables, &run.scene, self.until_inverted) {
            run.observers.push(Box::new(KnotMonitor::new(observer)));
        }
        if let KnotStart::Curve { .. } = tables.knot.start
            && let Err(RunError::Scene(error)) = try_scene(run)
        {
            // The curve is too near to itself for the thickness of the rod.
            return Err(Issue::new(KeyPath::from("knot.curve"), error.to_string()));
        }
        Ok(())
    }

    fn derived(&self, run: &PreparedRun) -> Option<OwnNumbers> {
        let monitor = run.observer::<KnotMonitor>()?;
        let knot = derived_knot(&monitor.observer, run)?;
        let [start, end] = knot.length_normalized;
        let lines = [
            ("knot", format!("determinant {}", knot.determinant)),
            (
                "  pull speed of each end",
                format!("{:.3} mm/s", 1e3 * knot.pull_speed),
            ),
            ("  pulled from, to", format!("l̄_k = {start:.1}, {end:.1}")),
        ];
        Some(OwnNumbers::new("knot", &knot, lines))
    }

    fn files(&self) -> &'static [FileDescription] {
        &FILES
    }

    fn figures(&self, directory: &Path) -> Result<Figures, FigureError> {
        let figure = traction_figure(directory)?;
        Ok(Vec::from_iter(
            figure.map(|figure| (TRACTION_FIGURE, figure)),
        ))
    }
}

/// Observer of the knot of a scene, which begins with the rods of the knot.
fn observer(tables: &KnotTables, scene: &Scene, until_inverted: bool) -> Option<KnotObserver> {
    let KnotTables { rod, knot, .. } = tables;
    let rods = scene.rods.get(..knot.start.rods())?;
    let stiffness = &rods.first()?.stiffness;
    let kind = knot.start.kind();
    let placed: Vec<&[Vector3]> = rods.iter().map(|rod| &rod.centreline[..]).collect();
    let has_long_braid =
        matches!(kind, Some(KnotKind::Overhand { unknotting_number }) if unknotting_number > 1);
    Some(KnotObserver {
        rods: rods.len(),
        nodes: rod.nodes,
        has_braid: matches!(kind, Some(KnotKind::Overhand { .. })),
        radius: rod.radius,
        bending_stiffness: stiffness.bending[0],
        stretching_stiffness: stiffness.stretching,
        length: knot.length,
        tolerance: scene.contact?.distance_tolerance,
        determinant: kind
            .map(determinant_of_kind)
            .or_else(|| determinant_of_rods(&placed))?,
        pulled_from: knot.settling_time,
        pull_speed: knot.pull_speed,
        kinetic_bound: knot.kinetic_bound,
        may_invert: has_long_braid || until_inverted,
        ends_after_inversion: until_inverted,
    })
}

fn derived_knot(knot: &KnotObserver, run: &PreparedRun) -> Option<DerivedKnot> {
    let Mode::Dynamic { end, .. } = run.mode else {
        return None;
    };
    let rods = run.scene.rods.iter().take(knot.rods);
    let rods: Vec<&[Vector3]> = rods.map(|rod| &rod.centreline[..]).collect();
    let start = knot.length_normalized(&rods);
    let pulled = 2.0 * knot.pull_speed * (end - knot.pulled_from).max(0.0);
    Some(DerivedKnot {
        determinant: knot.determinant,
        pull_speed: knot.pull_speed,
        length_normalized: [start, start - pulled / knot.radius],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::{load, prepare};

    #[test]
    fn a_knot_is_pulled_from_and_to_a_shortening() {
        let path =
            Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("scenarios/reef.toml");
        let loaded = load(&path, &[]).unwrap_or_else(|error| panic!("{error}"));
        let run = prepare(&loaded.scenario).unwrap();
        let monitor = run.observer::<KnotMonitor>().unwrap();
        let knot = derived_knot(&monitor.observer, &run).unwrap();
        assert_eq!((knot.determinant, knot.pull_speed), (9, 4e-3));
        // (0.6 − 0.36)/0.001 at the start; 2 · 4 mm/s · 22.5 s less at the end.
        assert!((knot.length_normalized[0] - 240.0).abs() < 1e-9);
        assert!((knot.length_normalized[1] - 60.0).abs() < 1e-9);
    }
}
