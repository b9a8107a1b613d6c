//! Probes in scenario files.

use super::{CANTILEVER, RESTING, prepared};
use crate::experiment::from_text;
use std::path::Path;

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
    let loaded = from_text("probes", &text, Path::new(""), &[]).unwrap();
    let resolved = loaded.scenario.to_toml();
    let again = from_text("probes", &resolved, Path::new(""), &[]).unwrap();
    assert_eq!(again.scenario, loaded.scenario, "{resolved}");
    assert_eq!(again.scenario.probes.len(), 5);
}

#[test]
fn faults_of_probes_name_their_keys_and_what_is_allowed() {
    let faults = [
        (
            "kind = \"position\"\nat = 0",
            "probes.0`: missing key `name`",
        ),
        (
            "name = \"a b\"\nkind = \"arc_length\"",
            "probes.0.name`: `a b` cannot begin",
        ),
        (
            "name = \"a_\"\nkind = \"arc_length\"",
            "probes.0.name`: `a_` cannot begin",
        ),
        ("name = \"a\"\nkind = \"lenght\"", "probes.0.kind`"),
        (
            "name = \"a\"\nkind = \"arc_length\"\nat = 3",
            "probes.0.at`",
        ),
        (
            "name = \"a\"\nkind = \"position\"",
            "probes.0`: missing key `at`",
        ),
        (
            "name = \"a\"\nkind = \"position\"\nat = 41",
            "probes.0.at`: rod `beam` has no node 41; allowed: 0 to 40",
        ),
        (
            "name = \"a\"\nkind = \"tension\"\nat = 40",
            "probes.0.at`: rod `beam` has no edge 40; allowed: 0 to 39",
        ),
        (
            "name = \"a\"\nkind = \"spring_force\"",
            "probes.0`: missing key `joint`",
        ),
        (
            "name = \"a\"\nkind = \"spring_force\"\njoint = \"bungee\"",
            "probes.0.joint`: no spring between nodes is called `bungee` (the scene has no springs",
        ),
        (
            "name = \"a\"\nkind = \"energy\"\nrod = \"baem\"",
            "probes.0.rod`: no rod is called `baem` (did you mean `beam`?)",
        ),
        (
            "name = \"a\"\nkind = \"reaction\"\nat = 7",
            "probes.0.at`: no clamp holds node 7 of rod `beam`",
        ),
        (
            "name = \"a\"\nkind = \"contact_force\"",
            "probes.0.kind`: there is no contact",
        ),
        (
            "name = \"a\"\nkind = \"distance\"\nat = 0",
            "probes.0`: missing key `to`",
        ),
        (
            "name = \"a\"\nkind = \"distance\"",
            "probes.0`: missing key `to_rod`",
        ),
        (
            "name = \"a\"\nkind = \"distance\"\nto_rod = \"beam\"",
            "probes.0.to_rod`: a rod has no distance from itself",
        ),
        (
            "name = \"a\"\nkind = \"arc_length\"\nsummary = \"first\"",
            "probes.0.summary`",
        ),
        (
            "name = \"min_distance\"\nkind = \"arc_length\"",
            "probes.0.name`: series.csv has a column `min_distance_m` already",
        ),
        (
            "name = \"a\"\nkind = \"arc_length\"\n[[probes]]\nname = \"a\"\nkind = \"writhe\"",
            "probes.1.name`: another probe is called `a`",
        ),
        (
            "name = \"a\"\nkind = \"arc_length\"\n[[probes]]\nname = \"a_m\"\nkind = \"writhe\"",
            "probes.1.name`: series.csv has a column `a_m` already",
        ),
        (
            "name = \"a\"\nkind = \"arc_length\"\n[stop_when]\nprobe = \"b\"\nabove = 1",
            "stop_when.probe`: no probe has a column `b`",
        ),
        (
            "name = \"a\"\nkind = \"arc_length\"\n[stop_when]\nprobe = \"a\"",
            "stop_when`: missing key `above`",
        ),
        (
            "name = \"a\"\nkind = \"arc_length\"\n[stop_when]\nprobe = \"a\"\nabove = 1\nbelow = 0",
            "stop_when.below`: either",
        ),
        (
            "name = \"a\"\nkind = \"position\"\nat = 0\n[stop_when]\nprobe = \"a\"\nabove = 1",
            "stop_when.probe`: this probe has several columns (name one of them: a_x_m, a_y_m, a_z_m)",
        ),
    ];
    for (probe, expected) in faults {
        let text = format!("{CANTILEVER}[[probes]]\n{probe}\n");
        let error = prepared(&text).expect_err(probe);
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
