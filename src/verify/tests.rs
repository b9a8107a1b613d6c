//! Every group passes; one test each, so that they run side by side and a failure names its group.

use super::*;

fn assert_passes(group: CheckGroup) {
    let checks = group(false).unwrap();
    assert!(!checks.is_empty());
    println!("{}", table(&checks));
    let failed: Vec<_> = checks
        .iter()
        .filter(|check| check.verdict() == Verdict::Fail)
        .collect();
    assert!(failed.is_empty(), "{failed:#?}");
}

#[test]
fn statics_pass() {
    assert_passes(statics::checks);
}

#[test]
fn vibration_passes() {
    assert_passes(vibration::checks);
}

#[test]
fn buckling_passes() {
    assert_passes(buckling::checks);
}

#[test]
fn helix_manipulation_passes() {
    assert_passes(helix_manipulation::checks);
}

#[test]
fn localized_buckling_passes() {
    assert_passes(localized_buckling::checks);
}

#[test]
fn conservation_passes() {
    assert_passes(conservation::checks);
}

#[test]
fn helix_passes() {
    assert_passes(helix::checks);
}

#[test]
fn symmetry_passes() {
    assert_passes(symmetry::checks);
}

#[test]
fn drag_passes() {
    assert_passes(drag::checks);
}

#[test]
fn derivatives_pass() {
    assert_passes(derivatives::checks);
}

#[test]
fn determinism_pass() {
    assert_passes(determinism::checks);
}

#[test]
fn friction_pass() {
    assert_passes(friction::checks);
}

#[test]
fn contact_passes() {
    assert_passes(contact::checks);
}

#[test]
fn continuation_passes() {
    assert_passes(continuation::checks);
}
