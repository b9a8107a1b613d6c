//! Rods that are drawn with the width of their cross-section: rods with a rectangular section, and
//! folded sheets.

use crate::experiment::FoldingTables;
use crate::scenario::{CrossSection, Rod, Scenario};
use nalgebra::Vector3;
use rodlab_engine::mechanics::rod::transport::any_normal;
use rodlab_files::figure::Strip;
use rodlab_files::results::RodRecord;

/// Name of the rod that is the sheet of a folding experiment.
const SHEET: &str = "sheet";

/// The strip that represents a rod; `None` for a tube. `placed`: its nodes at the first output.
pub(super) fn strip_of(
    record: &RodRecord,
    described: Option<&Rod>,
    scenario: Option<&Scenario>,
    placed: &[Vector3<f64>],
) -> Option<Strip> {
    if let Some(CrossSection::Rectangle { width, thickness }) =
        described.map(|rod| rod.cross_section)
    {
        let director = described.and_then(|rod| rod.director).map(Vector3::from);
        let along = placed.get(1)? - placed.first()?;
        let director = director.unwrap_or_else(|| any_normal(&along.normalize()));
        return Some(Strip::placed(
            width,
            thickness,
            &director,
            placed,
            record.closed,
        ));
    }
    // A sheet folds in the plane of x and z.
    let tables = scenario?.experiment.tables::<FoldingTables>()?;
    let paper = &tables.folding.paper;
    let is_sheet = described.is_none() && record.name == SHEET;
    is_sheet.then(|| {
        Strip::placed(
            paper.width,
            2.0 * record.radius,
            &Vector3::y(),
            placed,
            false,
        )
    })
}
