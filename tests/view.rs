//! The 3-D page in a real browser: it draws, it moves, it does not complain.

use crate::browser::Browser;
use assert_cmd::Command;
use std::fs;
use std::path::{Path, PathBuf};

/// Two rods, one of which falls across the other.
const SCENARIO: &str = r#"
experiment = "scene"
title = "A rod falls on another"
material = { youngs_modulus = "1 MPa", poissons_ratio = 0.5, density = 1000.0 }
time = { step = "1 ms", end = "120 ms" }
output = { interval = "5 ms", forces = true }
contact = { distance_tolerance = "0.1 mm" }

[[rods]]
name = "post"
radius = "8 mm"
edges = 10
shape = { kind = "straight", start = [0, -0.1, 0], end = [0, 0.1, 0] }
held = true

[[rods]]
name = "rope"
radius = "5 mm"
edges = 20
shape = { kind = "straight", start = [-0.15, 0, 0.03], end = [0.1, 0, 0.03] }

[[loads]]
kind = "gravity"
acceleration = [0, 0, -9.81]
"#;

/// Runs the scenario and makes its page.
fn page(directory: &Path) -> PathBuf {
    fs::write(directory.join("fall.toml"), SCENARIO).unwrap();
    for arguments in [
        &["run", "fall.toml", "--out", "fall"][..],
        &["view", "fall", "--out", "fall.html"],
    ] {
        Command::new(env!("CARGO_BIN_EXE_rodlab"))
            .current_dir(directory)
            .args(arguments)
            .assert()
            .success();
    }
    directory.join("fall.html")
}

/// Pixels of a picture as red, green, blue.
fn pixels(png: &[u8]) -> Vec<[u8; 3]> {
    let image = image::load_from_memory(png).expect("a PNG").to_rgb8();
    image.pixels().map(|pixel| pixel.0).collect()
}

/// Number of pixels with a strong colour, as the rods have and the ground has not.
fn colourful(png: &[u8]) -> usize {
    let spread = |pixel: &[u8; 3]| pixel.iter().max().unwrap() - pixel.iter().min().unwrap();
    pixels(png)
        .iter()
        .filter(|pixel| spread(pixel) > 60)
        .count()
}

/// Number of pixels that differ between two pictures.
fn changed(before: &[u8], after: &[u8]) -> usize {
    let pairs = pixels(before).into_iter().zip(pixels(after));
    pairs.filter(|(a, b)| a != b).count()
}

#[test]
fn the_page_draws_moves_and_does_not_complain() {
    let directory = tempfile::tempdir().unwrap();
    let page = page(directory.path());
    let Some(mut browser) = Browser::start() else {
        return;
    };
    browser.open(&page);
    // Only the canvas: buttons and colour bars come and go.
    browser.press("h");
    let start = browser.screenshot();
    assert!(colourful(&start) > 5_000, "{}", colourful(&start));

    browser.set("time", "24");
    let end = browser.screenshot();
    assert!(changed(&start, &end) > 5_000, "{}", changed(&start, &end));
    browser.set("time", "0");
    assert_eq!(changed(&start, &browser.screenshot()), 0);

    browser.press("End");
    assert_eq!(
        browser.evaluate("document.getElementById('time').value"),
        "24"
    );
    assert_eq!(changed(&end, &browser.screenshot()), 0);

    for colour in ["Curvature", "Contact force", "Speed"] {
        browser.set("colour", colour);
        let coloured = browser.screenshot();
        assert!(changed(&end, &coloured) > 2_000, "{colour}");
    }
    browser.drag([600.0, 400.0], [700.0, 350.0]);
    assert!(changed(&end, &browser.screenshot()) > 5_000);

    browser.press("h");
    keep("view.png", &browser.screenshot());
    assert!(
        browser.complaints().is_empty(),
        "{:?}",
        browser.complaints()
    );
}

#[test]
fn play_goes_on_and_pause_stops() {
    let directory = tempfile::tempdir().unwrap();
    let page = page(directory.path());
    let Some(mut browser) = Browser::start() else {
        return;
    };
    browser.open(&page);
    let place =
        |browser: &mut Browser| browser.evaluate("Number(document.getElementById('time').value)");
    browser.click("play");
    let seen = browser.evaluate(
        "new Promise(done => { const look = () => document.getElementById('time').value > 2 ? done(true) : setTimeout(look, 20); look(); })",
    );
    assert_eq!(seen, true);
    browser.press(" ");
    let paused = place(&mut browser);
    browser.evaluate("new Promise(done => setTimeout(() => done(0), 200))");
    assert_eq!(place(&mut browser), paused);
    assert!(
        browser.complaints().is_empty(),
        "{:?}",
        browser.complaints()
    );
}

/// Keeps a picture for people to look at.
fn keep(name: &str, png: &[u8]) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("screenshots");
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join(name), png).unwrap();
}

#[test]
fn what_cannot_be_shown_is_refused_in_words() {
    let directory = tempfile::tempdir().unwrap();
    let refuse = |name: &str| {
        let output = Command::new(env!("CARGO_BIN_EXE_rodlab"))
            .current_dir(directory.path())
            .args(["view", name])
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2));
        assert!(!directory.path().join(name).join("view.html").exists());
        String::from_utf8(output.stderr).unwrap()
    };
    assert!(refuse("nowhere").contains("no results directory"));
    page(directory.path());
    fs::remove_file(directory.path().join("fall/nodes.csv")).unwrap();
    assert!(refuse("fall").contains("`nodes = true` under [output]"));
}
