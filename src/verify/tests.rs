//! Every group passes; one test each, so that they run side by side and a failure names its group.

use super::*;

/// The checks of a group pass, and the page of `rodlab verify --markdown` has them.
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

#[test]
fn statics_pass() {
    assert_passes("statics");
}

#[test]
fn spatial_rods_pass() {
    assert_passes("spatial rods");
}

#[test]
fn vibration_passes() {
    assert_passes("vibration");
}

#[test]
fn actuation_passes() {
    assert_passes("actuation");
}

#[test]
fn damping_passes() {
    assert_passes("damping");
}

#[test]
fn buckling_passes() {
    assert_passes("buckling");
}

#[test]
fn helix_manipulation_passes() {
    assert_passes("helix manipulation");
}

#[test]
fn localized_buckling_passes() {
    assert_passes("localised buckling");
}

#[test]
fn conservation_passes() {
    assert_passes("conservation");
}

#[test]
fn helix_passes() {
    assert_passes("helix");
}

#[test]
fn scale_invariance_passes() {
    assert_passes("scale invariance");
}

#[test]
fn symmetry_passes() {
    assert_passes("symmetry");
}

#[test]
fn drag_passes() {
    assert_passes("drag");
}

#[test]
fn derivatives_pass() {
    assert_passes("derivatives");
}

#[test]
fn determinism_pass() {
    assert_passes("determinism");
}

#[test]
fn friction_pass() {
    assert_passes("friction");
}

#[test]
fn contact_passes() {
    assert_passes("contact");
}

#[test]
fn obstacles_pass() {
    assert_passes("obstacles");
}

#[test]
fn joints_pass() {
    assert_passes("joints");
}

#[test]
fn continuation_passes() {
    assert_passes("continuation");
}

#[test]
fn springs_pass() {
    assert_passes("springs");
}

#[test]
fn overdamped_passes() {
    assert_passes("overdamped");
}

#[test]
fn drag_of_bodies_passes() {
    assert_passes("drag of bodies");
}
