//! `rodlab place` in the virtual cell.

use super::{said, serve_cell};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Command;

#[test]
fn a_cable_is_placed_between_its_pegs_by_the_optimal_grasps_and_not_by_the_intuitive_ones() {
    let scenario = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/cable_placement_u.toml");
    let scenario = scenario.to_str().unwrap();
    let served = serve_cell(&["--scene", scenario, "--rate", "50"], "");
    for (scheme, is_placed) in [("optimal", true), ("intuitive", false)] {
        let scheme_key = format!("deployment.scheme={scheme}");
        let set = ["--set", &scheme_key, "--out", scheme];
        let cell = ["--cell", "client.toml", "--approach-speed", "0.4"];
        let placed = served.run(&[&["place", scenario], &cell[..], &set[..]].concat());
        assert!(placed.status.success(), "{}", said(&placed));
        let manifest = served.read(&format!("{scheme}/manifest.json"));
        let manifest: Value = serde_json::from_str(&manifest).unwrap();
        assert_eq!(manifest["pegs"]["count"], 22, "{manifest}");
        let passed = manifest["pegs"]["passed"].as_u64().unwrap();
        assert_eq!(passed == 22, is_placed, "{manifest}");
        let report = served.read(&format!("{scheme}/report.md"));
        assert!(report.contains(&format!("{passed} of 22")), "{report}");
        assert!(
            served
                .read(&format!("{scheme}/pegs.svg"))
                .contains("</svg>")
        );
    }
}

#[test]
fn invalid_placements_are_rejected() {
    let folder = tempfile::tempdir().unwrap();
    for (scenario, word) in [
        ("deployment.toml", "deployment.clips"),
        ("trefoil.toml", "deployment"),
        ("nothing.toml", "nothing.toml"),
    ] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("scenarios")
            .join(scenario);
        for command in [&["place"][..], &["cell", "serve", "--scene"]] {
            let refused = Command::new(env!("CARGO_BIN_EXE_rodlab"))
                .args(command)
                .arg(&path)
                .arg("--cell")
                .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/cells/gantry.toml"))
                .current_dir(folder.path())
                .output()
                .unwrap();
            assert_eq!(refused.status.code(), Some(2), "{}", said(&refused));
            assert!(said(&refused).contains(word), "{}", said(&refused));
        }
    }
    assert!(fs::read_dir(folder.path()).unwrap().next().is_none());
}
