//! The scene that represents all samples: a sheet that hangs from the gripper.

use super::keys::FoldSamples;
use crate::experiment::data_set::hanging;
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::scene::{NaturalShape, RodDescription, Scene, Stiffness};
use rodlab_planning::plan::fold::FoldAtlas;

/// Edges of the sheet.
const EDGES: usize = 50;
/// Radius of the rod that represents it, L_gb: for display only.
const RADIUS: f64 = 0.02;
/// Stretching stiffness of a sheet that hardly stretches.
const STIFFEST: f64 = 1e6;

/// The longest sheet that is lifted without a push, between touchdown point and gripper, with EI =
/// 1 and weight 1/2 per length, so that L_gb = 1. `None` if it cannot be lifted.
pub fn lifted_sheet(plan: &FoldSamples) -> Option<Scene> {
    let length = plan.suspended_length.to;
    let fold = *FoldAtlas::lift(length, EDGES).last()?;
    let place = |[x, z]: [f64; 2]| Vector3::new(x, 0.0, z);
    let centreline = fold.shape(EDGES).into_iter().map(place).collect();
    let flat = (0..=EDGES).map(|node| Vector3::x() * (length * (1.0 - node as f64 / EDGES as f64)));
    let stiffness = Stiffness {
        stretching: STIFFEST,
        bending: [1.0; 2],
        twisting: 1.0,
    };
    let sheet = RodDescription {
        natural_shape: NaturalShape::Centreline(flat.collect()),
        ..RodDescription::uniform("sheet", centreline, stiffness, RADIUS, 0.5)
    };
    Some(hanging(sheet, false))
}
