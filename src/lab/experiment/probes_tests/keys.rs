//! Probes in scenario files.

use super::{CANTILEVER, RESTING, prepared};
use crate::test_support::{assert_reads_back, cases, loaded};

#[test]
fn resolved_probes_read_back_to_themselves() {
    let text = format!(
        "{RESTING}{}",
        r#"
        [[probes]]
        name = "a"
        kind = "position"
        at = 3
        summary = "last"
        [[probes]]
        name = "b"
        kind = "distance"
        rod = "rod"
        at = "start"
        to = "end"
        [[probes]]
        name = "c"
        kind = "contact_force"
        from_plane = 0
        [[probes]]
        name = "d"
        kind = "twisting_moment"
        [[probes]]
        name = "e"
        kind = "arc_length"
        summary = "mean"
        [stop_when]
        probe = "b"
        above = 3
        "#
    );
    let scenario = loaded("probes", &text).unwrap().scenario;
    assert_reads_back("probes", &scenario);
    assert_eq!(scenario.probes.len(), 5);
}

#[test]
fn faults_of_probes_name_their_keys_and_what_is_allowed() {
    let faults = r#"
        kind = "position"; at = 0 => probes.0`: missing key `name`
        name = "a b"; kind = "arc_length" => probes.0.name`: `a b` cannot begin
        name = "a_"; kind = "arc_length" => probes.0.name`: `a_` cannot begin
        name = "a"; kind = "lenght" => probes.0.kind`
        name = "a"; kind = "arc_length"; at = 3 => probes.0.at`
        name = "a"; kind = "position" => probes.0`: missing key `at`
        name = "a"; kind = "position"; at = 41 => probes.0.at`: rod `beam` has no node 41; allowed: 0 to 40
        name = "a"; kind = "tension"; at = 40 => probes.0.at`: rod `beam` has no edge 40; allowed: 0 to 39
        name = "a"; kind = "spring_force" => probes.0`: missing key `joint`
        name = "a"; kind = "spring_force"; joint = "bungee" => probes.0.joint`: no spring between nodes is called `bungee` (the scene has no springs
        name = "a"; kind = "energy"; rod = "baem" => probes.0.rod`: no rod is called `baem` (did you mean `beam`?)
        name = "a"; kind = "reaction"; at = 7 => probes.0.at`: no clamp holds node 7 of rod `beam`
        name = "a"; kind = "contact_force" => probes.0.kind`: there is no contact
        name = "a"; kind = "distance"; at = 0 => probes.0`: missing key `to`
        name = "a"; kind = "distance" => probes.0`: missing key `to_rod`
        name = "a"; kind = "distance"; to_rod = "beam" => probes.0.to_rod`: a rod has no distance from itself
        name = "a"; kind = "arc_length"; summary = "first" => probes.0.summary`
        name = "min_distance"; kind = "arc_length" => probes.0.name`: series.csv has a column `min_distance_m` already
        name = "a"; kind = "arc_length"; [[probes]]; name = "a"; kind = "writhe" => probes.1.name`: another probe has the name `a`
        name = "a"; kind = "arc_length"; [[probes]]; name = "a_m"; kind = "writhe" => probes.1.name`: series.csv has a column `a_m` already
        name = "a"; kind = "arc_length"; [stop_when]; probe = "b"; above = 1 => stop_when.probe`: no probe has a column `b`
        name = "a"; kind = "arc_length"; [stop_when]; probe = "a" => stop_when`: missing key `above`
        name = "a"; kind = "arc_length"; [stop_when]; probe = "a"; above = 1; below = 0 => stop_when.below`: either
        name = "a"; kind = "position"; at = 0; [stop_when]; probe = "a"; above = 1 => stop_when.probe`: this probe has several columns (name one of them: a_x_m, a_y_m, a_z_m)
    "#;
    for (probe, expected) in cases(faults) {
        let text = format!("{CANTILEVER}[[probes]]\n{probe}\n");
        let error = prepared(&text).expect_err(&probe);
        assert!(error.contains(expected), "{probe}\n{error}");
    }
    let text = include_str!("../../../../scenarios/helix_boundary.toml");
    let text = format!("{text}\n[[probes]]\nname = \"a\"\nkind = \"arc_length\"\n");
    let error = prepared(&text).unwrap_err();
    assert!(
        error.contains("`probes`: this experiment fills a table"),
        "{error}"
    );
}
