//! Drawings and robots as users provide them: the detected content, and the proposed options.

use std::fs;
use std::path::Path;
use std::process::Command;

/// Exit code, standard output and standard error of a planthat runs in a folder.
fn plan(folder: &Path, arguments: &[&str]) -> (i32, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_rodlab"))
        .args(["plan", "deployment", "--rod", "green_vps", "--out", "out"])
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let code = output.status.code().unwrap();
    (code, text(&output.stdout), text(&output.stderr))
}

fn drawing(folder: &Path, content: &str) {
    let text = format!(
        "<svg xmlns='http://www.w3.org/2000/svg' width='200mm' height='200mm' viewBox='0 0 200 200'>\n{content}</svg>"
    );
    fs::write(folder.join("d.svg"), text).unwrap();
}

#[test]
fn a_rod_is_planned_along_each_stroke_or_one_is_chosen() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    drawing(
        folder,
        "<path d='M10 50H100'/><path id='b' d='M190 50H100.3'/>",
    );
    let (code, stdout, stderr) = plan(folder, &["--pattern", "d.svg"]);
    assert_eq!(code, 0, "{stderr}");
    let record: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    let length = |stroke: usize| record["strokes"][stroke]["length_m"].as_f64().unwrap();
    assert!((length(0) - 0.09).abs() < 1e-3 && (length(1) - 0.0897).abs() < 1e-3);
    let picture = fs::read_to_string(folder.join("out/strokes.svg")).unwrap();
    assert!(picture.contains("aria-label=\"2\""));
    for stroke in ["stroke-1", "stroke-2"] {
        assert!(
            folder
                .join("out")
                .join(stroke)
                .join("trajectory.csv")
                .exists()
        );
    }
    // A stroke that cannot be laid leaves no plan of the others.
    fs::remove_dir_all(folder.join("out")).unwrap();
    let (code, _, stderr) = plan(folder, &["--pattern", "d.svg", "--lead-in", "2 m"]);
    assert_eq!(code, 2, "{stderr}");
    assert!(!folder.join("out").exists());
    for (arguments, length) in [
        (vec!["--join", "0.5 mm"], 0.18),
        (vec!["--stroke", "b"], 0.0897),
        (vec!["--stroke", "longest"], 0.09),
    ] {
        let (code, stdout, stderr) =
            plan(folder, &[&["--pattern", "d.svg"], &arguments[..]].concat());
        assert_eq!(code, 0, "{stderr}");
        let record: serde_json::Value = serde_json::from_str(&stdout).unwrap();
        let found = record["length_m"].as_f64().unwrap();
        assert!((found - length).abs() < 1e-3, "{arguments:?}: {found}");
    }
}

#[test]
fn proposed_options_work() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    drawing(
        folder,
        "<path fill='none' stroke='red' d='M20 20L150 20L150 150'/>",
    );
    for more in [
        vec!["--deviation", "0.25 mm"],
        vec!["--size", "3 m"],
        vec!["--size", "4 mm"],
    ] {
        let arguments = [&["--pattern", "d.svg"], &more[..]].concat();
        let (code, _, stderr) = plan(folder, &arguments);
        assert_eq!(code, 2, "{stderr}");
        let (_, options) = stderr.split_once("it can be laid with ").expect(&stderr);
        let words: Vec<&str> = options.trim().split('"').map(str::trim).collect();
        let proposed: Vec<&str> = words.into_iter().filter(|word| !word.is_empty()).collect();
        let arguments = [&["--pattern", "d.svg"], &proposed[..]].concat();
        let (code, _, stderr) = plan(folder, &arguments);
        assert_eq!(code, 0, "{arguments:?}: {stderr}");
    }
}

#[test]
fn corners_are_rounded_and_long_drawings_shrunk_on_request() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    drawing(
        folder,
        "<path fill='none' stroke='red' d='M20 20L150 20L150 150'/>",
    );
    let (code, stdout, stderr) = plan(folder, &["--pattern", "d.svg"]);
    assert_eq!(code, 0, "{stderr}");
    assert!(
        stderr.contains("too sharp for the rod are rounded"),
        "{stderr}"
    );
    assert!(stderr.contains("the rod will slide there"), "{stderr}");
    let record: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    let deviation = record["deviation_m"].as_f64().unwrap();
    assert!(deviation > 2.5e-4 && deviation < 0.05 * 0.13, "{deviation}");
    drawing(
        folder,
        "<path fill='none' stroke='red' d='M0 0C1500 0 500 1500 2000 1500'/>",
    );
    let fit = ["--pattern", "d.svg", "--size", "fit"];
    let (code, _, stderr) = plan(folder, &fit[..2]);
    assert_eq!(code, 2, "{stderr}");
    let (code, stdout, stderr) = plan(folder, &fit);
    assert_eq!(code, 0, "{stderr}");
    assert!(
        stderr.contains("--size fit: the longer side is"),
        "{stderr}"
    );
    let record: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    assert!(record["length_m"].as_f64().unwrap() < record["rod_length_m"].as_f64().unwrap());
}

/// The edges of a ring are not two strokes.
#[test]
fn edges_of_filled_areas_are_not_laid_one_by_one() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    drawing(
        folder,
        "<path fill-rule='evenodd' d='M10 10H90V90H10ZM30 30H70V70H30Z'/>",
    );
    let arguments = ["deploy", "--pattern", "d.svg", "--dry-run", "--out", "out"];
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_rodlab"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{stderr}");
}

#[test]
fn too_many_strokes_are_listed_and_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let lines: String = (0..13)
        .map(|line| format!("<path id='p{line}' d='M{} 50h10'/>", 15 * line))
        .collect();
    drawing(folder, &lines);
    let (code, stdout, stderr) = plan(folder, &["--pattern", "d.svg"]);
    assert_eq!((code, stdout.as_str()), (2, ""), "{stderr}");
    for part in [
        "13 strokes",
        "1: 10.0 mm long",
        "line 2, <path>, id `p4`",
        "--join \"10.000 mm\" joins all",
        "d_strokes.svg",
    ] {
        assert!(stderr.contains(part), "{stderr}");
    }
    let picture = fs::read_to_string(folder.join("d_strokes.svg")).unwrap();
    assert!(picture.contains("aria-label=\"13\""));
    assert!(!folder.join("out").exists());
}

#[test]
fn outlines_are_reported_and_have_a_middle_line() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    drawing(
        folder,
        "<path d='M10 20C60 0 120 60 190 20L190 40C120 80 60 20 10 40Z'/>",
    );
    let plain = ["--pattern", "d.svg", "--lead-in", "none"];
    let (code, stdout, stderr) = plan(folder, &[&plain[..], &["--outline"]].concat());
    assert_eq!(code, 0, "{stderr}");
    assert!(
        stderr.contains("line 2: <path> is a filled area"),
        "{stderr}"
    );
    let edge: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    assert!(edge["length_m"].as_f64().unwrap() > 0.3, "{edge}");
    let (code, stdout, stderr) = plan(folder, &plain);
    assert!(
        stderr.contains("line 2: a narrow filled area is followed along the middle"),
        "{stderr}"
    );
    assert_eq!(code, 0, "{stderr}");
    let record: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    let found = record["length_m"].as_f64().unwrap();
    // The middle line has the shape of the upper edge, 10 mm lower, with rounded ends.
    assert!((0.16..0.20).contains(&found), "{found}");
}

#[test]
fn letters_and_text_are_followed_along_their_middle() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    // A T: a bar of 180 mm over a stem of 120 mm. A dot is left out.
    let letter =
        "<path d='M10 20H190V40H110V160H90V40H10Z' fill='black'/><circle cx='30' cy='150' r='12'/>";
    let text = "<text x='10' y='150' font-size='160' font-family='no such font'>T</text>";
    for (content, dots) in [(letter, true), (text, false)] {
        drawing(folder, content);
        let plain = ["--pattern", "d.svg", "--lead-in", "none"];
        let (code, stdout, stderr) = plan(folder, &plain);
        assert_eq!(code, 0, "{stderr}");
        assert_eq!(
            stderr.contains("filled dots are left out: 1"),
            dots,
            "{stderr}"
        );
        assert_eq!(
            stderr.contains("<text> is drawn in the font"),
            !dots,
            "{stderr}"
        );
        let record: serde_json::Value = serde_json::from_str(&stdout).unwrap();
        let strokes = record["strokes"].as_array().unwrap();
        let lengths = strokes
            .iter()
            .map(|stroke| stroke["length_m"].as_f64().unwrap());
        assert_eq!(strokes.len(), 2, "{record}");
        // The ends of middle lines are half a width inside.
        let whole: f64 = lengths.sum();
        let drawn = if dots { 0.26 } else { 0.18 };
        assert!((whole - drawn).abs() < 0.03, "{record}");
    }
}

#[test]
fn middle_lines_keep_their_corners() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    drawing(folder, "<path d='M10 20H35V145H160V170H10Z'/>");
    let plain = ["--pattern", "d.svg", "--lead-in", "none"];
    let (code, stdout, stderr) = plan(folder, &plain);
    assert_eq!(code, 0, "{stderr}");
    let record: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    // One line with two arms, whose ends are half a width inside and whose corner is round.
    let length = record["length_m"].as_f64().unwrap();
    assert!((0.21..0.26).contains(&length), "{length}");
}

#[test]
fn files_from_many_sources_are_read() {
    let shared = Path::new(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../shared/repro/files"
    ));
    let Ok(drawings) = fs::read_dir(shared.join("svg")) else {
        println!("skipped: {} is not here", shared.display());
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    for drawing in drawings {
        let path = drawing.unwrap().path();
        let arguments = ["--pattern", path.to_str().unwrap(), "--join", "0.1 mm"];
        let (code, _, stderr) = plan(folder.path(), &arguments);
        assert_eq!(code, 0, "{}: {stderr}", path.display());
    }
    for robot in fs::read_dir(shared.join("urdf")).unwrap() {
        let path = robot.unwrap().path();
        if path.extension().is_some_and(|ending| ending == "urdf") {
            let arm = rodlab::robot::read_urdf(&path, None, None);
            let arm = arm.unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(arm.chain.joints.len(), 2, "{}", path.display());
        }
    }
}
