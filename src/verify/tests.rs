//! Every group passes. There is one test per group, so that they run in parallel and a failure
//! names its group.

use super::*;

/// Asserts that the checks of a group pass, and that the page of `rodlab verify --markdown`
/// contains them.
fn assert_passes(name: &str) {
    let group = GROUPS.iter().find(|(known, _)| *known == name);
    let (_, group) = group.expect("a group of this name");
    let checks = group(false).unwrap();
    assert!(!checks.is_empty());
    println!("{}", table(&checks));
    page::assert_on_page(name, &checks);
    let failed: Vec<_> = checks
        .iter()
        .filter(|check| check.verdict() == Verdict::Fail)
        .collect();
    assert!(failed.is_empty(), "{failed:#?}");
}

/// A test per group.
macro_rules! groups_pass {
    ($($test:ident: $group:literal,)*) => {
        $(#[test]
        fn $test() {
            assert_passes($group);
        })*
    };
}

groups_pass! {
    statics_pass: "statics",
    spatial_rods_pass: "spatial rods",
    vibration_passes: "vibration",
    sections_pass: "sections",
    actuation_passes: "actuation",
    damping_passes: "damping",
    yielding_passes: "yielding",
    buckling_passes: "buckling",
    helix_manipulation_passes: "helix manipulation",
    localized_buckling_passes: "localised buckling",
    conservation_passes: "conservation",
    helix_passes: "helix",
    scale_invariance_passes: "scale invariance",
    symmetry_passes: "symmetry",
    drag_passes: "drag",
    derivatives_pass: "derivatives",
    sensitivities_pass: "sensitivities",
    determinism_pass: "determinism",
    friction_pass: "friction",
    contact_passes: "contact",
    smooth_contact_passes: "smooth contact",
    obstacles_pass: "obstacles",
    joints_pass: "joints",
    continuation_passes: "continuation",
    springs_pass: "springs",
    tendons_pass: "tendons",
    sheaths_pass: "sheaths",
    free_bodies_pass: "free bodies",
    overdamped_passes: "overdamped",
    drag_of_bodies_passes: "drag of bodies",
    background_flow_passes: "background flow",
}
