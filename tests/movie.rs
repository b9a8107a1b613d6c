//! Films of results: they contain the requested pictures, and are written completely or not at
//! all.

use assert_cmd::Command;
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;

/// A rod that falls for a tenth of a second, with eleven outputs.
const SCENARIO: &str = r#"
experiment = "scene"
title = "A rod falls"
material = { youngs_modulus = "1 MPa", poissons_ratio = 0.5, density = 1000.0 }
time = { step = "1 ms", end = "100 ms" }
output = { interval = "10 ms" }
[[rods]]
name = "rope"
radius = "5 mm"
edges = 10
shape = { kind = "straight", start = [-0.1, 0, 0.1], end = [0.1, 0, 0.1] }
[[bodies]]
name = "bob"
rod = "rope"
at = "end"
mass = "5 g"
[[loads]]
kind = "gravity"
acceleration = [0, 0, -9.81]
[[planes]]
point = [0, 0, 0]
normal = [0, 0, 1]
"#;

fn rodlab(directory: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rodlab"));
    command.current_dir(directory).args(arguments);
    command
}

/// A directory with results in `fall`.
fn results() -> tempfile::TempDir {
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("fall.toml"), SCENARIO).unwrap();
    rodlab(directory.path(), &["run", "fall.toml", "--out", "fall"])
        .assert()
        .success();
    directory
}

const SMALL: [&str; 6] = ["--size", "160x96", "--fps", "10", "--duration", "0.5s"];

fn movie(directory: &Path, out: &str, arguments: &[&str]) -> Command {
    let arguments = [&["movie", "fall", "--out", out], arguments].concat();
    rodlab(directory, &arguments)
}

/// Names of the entries of a directory.
fn names(directory: &Path) -> Vec<String> {
    let entries = fs::read_dir(directory).unwrap();
    let mut names: Vec<String> = entries
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

#[test]
fn a_film_has_the_pictures_that_were_asked_for() {
    let directory = results();
    let printed = movie(directory.path(), "fall.gif", &SMALL)
        .assert()
        .success();
    let printed = String::from_utf8(printed.get_output().stdout.clone()).unwrap();
    assert!(
        printed.starts_with("fall.gif\n5 pictures, 0.5 s,"),
        "{printed}"
    );
    let gif = fs::read(directory.path().join("fall.gif")).unwrap();
    assert!(gif.starts_with(b"GIF89a"));
    assert_eq!([gif[6], gif[8]], [160, 96]);

    movie(directory.path(), "frames/", &SMALL)
        .assert()
        .success();
    let frames = directory.path().join("frames");
    let expected: Vec<String> = (1..=5)
        .map(|number| format!("frame_{number:04}.png"))
        .collect();
    assert_eq!(names(&frames), expected);
    let pictures: Vec<_> = expected
        .iter()
        .map(|name| image::open(frames.join(name)).unwrap().to_rgb8())
        .collect();
    assert!(
        pictures
            .iter()
            .all(|picture| picture.dimensions() == (160, 96))
    );
    assert!(pictures.windows(2).all(|pair| pair[0] != pair[1]));

    // A shorter film replaces a longer one.
    let shorter = [
        "--size", "160x96", "--fps", "10", "--speed", "0.5", "--turn", "90deg",
    ];
    movie(directory.path(), "frames", &shorter)
        .assert()
        .success();
    assert_eq!(names(&frames), ["frame_0001.png", "frame_0002.png"]);
}

#[test]
fn a_film_is_the_same_bytes_with_one_and_four_threads() {
    let directory = results();
    let bytes = |threads: &str| {
        let arguments = [&SMALL[..], &["--threads", threads]].concat();
        movie(directory.path(), "fall.gif", &arguments)
            .assert()
            .success();
        fs::read(directory.path().join("fall.gif")).unwrap()
    };
    assert_eq!(bytes("1"), bytes("4"));
}

#[test]
fn impossible_films_report_the_reason_and_leave_no_files() {
    let directory = results();
    let before = names(directory.path());
    let refuse = |arguments: &[&str], words: &[&str]| {
        let output = rodlab(directory.path(), arguments).output().unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{message}");
        for word in words {
            assert!(message.contains(word), "{message}");
        }
        assert_eq!(names(directory.path()), before);
    };
    let film = |rest: &[&'static str]| [&["movie", "fall"], rest].concat();
    refuse(
        &["movie", "nowhere", "--out", "a.gif"],
        &["not a results directory"],
    );
    refuse(&film(&["--out", "a.avi"]), &[".gif", ".mp4", "frames/"]);
    refuse(&film(&["--out", "a.gif", "--size", "7x7"]), &["1280x720"]);
    refuse(
        &film(&["--out", "a.gif", "--fps", "60"]),
        &["50 pictures per second"],
    );
    refuse(
        &film(&["--out", "a.gif", "--follow", "ropes"]),
        &["did you mean `rope`"],
    );
    refuse(
        &film(&["--out", "a.gif", "--case", "x"]),
        &["no case `x`", "fall"],
    );
    refuse(&film(&["--out", "fall/"]), &["not a picture of a film"]);
    refuse(&film(&["--out", "fall.toml"]), &[".gif"]);
    refuse(&film(&["--out", "a.gif", "--speed", "1e-9"]), &["too long"]);
    if cfg!(not(feature = "video")) {
        refuse(
            &film(&["--out", "a.mp4"]),
            &["a.gif", "ffmpeg", "--features video"],
        );
    }
    // A file of another kind is not replaced.
    fs::write(directory.path().join("fall/letter.gif"), "to a friend").unwrap();
    refuse(&film(&["--out", "fall/letter.gif"]), &["not replaced"]);
    fs::remove_file(directory.path().join("fall/nodes.csv")).unwrap();
    refuse(
        &film(&["--out", "a.gif"]),
        &["`nodes = true` under [output]"],
    );
}

#[cfg(unix)]
#[test]
fn an_interrupted_film_leaves_nothing() {
    let directory = results();
    let before = names(directory.path());
    for out in ["long.gif", "frames/"] {
        let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_rodlab"))
            .current_dir(directory.path())
            .args(["movie", "fall", "--out", out, "--duration", "10min"])
            .stderr(std::process::Stdio::null())
            .spawn()
            .unwrap();
        std::thread::sleep(std::time::Duration::from_millis(1500));
        let id = child.id().to_string();
        let sent = std::process::Command::new("kill")
            .args(["-INT", &id])
            .status();
        assert!(sent.unwrap().success());
        assert_eq!(child.wait().unwrap().code(), Some(130));
        assert_eq!(names(directory.path()), before);
    }
}

#[test]
fn a_watched_run_ends_with_the_same_results_and_a_page_at_rest() {
    let directory = results();
    // A program that opens pages is found, but no browser: the message names the page.
    let bin = directory.path().join("bin");
    fs::create_dir(&bin).unwrap();
    let opens = bin.join("xdg-open");
    fs::write(&opens, "#!/bin/sh\nexit 0\n").unwrap();
    fs::set_permissions(&opens, fs::Permissions::from_mode(0o755)).unwrap();
    let watch = rodlab(
        directory.path(),
        &["run", "fall.toml", "--out", "watched", "--watch"],
    )
    .env("PATH", &bin)
    .assert()
    .success();
    let stderr = String::from_utf8_lossy(&watch.get_output().stderr).into_owned();
    assert!(stderr.contains("watched/view.html"), "{stderr}");
    let watched = directory.path().join("watched");
    let page = fs::read_to_string(watched.join("view.html")).unwrap();
    assert!(page.contains("\"reload\":null"));
    for table in ["nodes.csv", "series.csv", "summary.csv"] {
        let [one, other] = ["fall", "watched"]
            .map(|name| fs::read(directory.path().join(name).join(table)).unwrap());
        assert!(one == other, "{table}");
    }
}
