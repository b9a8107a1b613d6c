//! The 3-D page in a real browser: it draws, moves, and reports no errors.

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

/// Runs the scenario and writes its page.
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

/// Number of pixels with a strong colour, which rods have and the ground does not.
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
fn the_page_draws_and_moves_without_errors() {
    let directory = tempfile::tempdir().unwrap();
    let page = page(directory.path());
    let Some(mut browser) = Browser::start() else {
        return;
    };
    browser.open(&page);
    // Hide everything except the canvas, since buttons and colour bars appear and disappear.
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
fn play_continues_and_pause_stops() {
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

/// A column that is compressed until it has buckled: equilibria along a path with three branches.
const COLUMN: &str = "scenarios/euler_column.toml";

/// Writes the page of a scenario of the repository.
fn page_of(scenario: &str, directory: &Path, overrides: &[&str]) -> PathBuf {
    let scenario = Path::new(env!("CARGO_MANIFEST_DIR")).join(scenario);
    let scenario = scenario.to_string_lossy().into_owned();
    let run = [&["run", &scenario, "--out", "results"][..], overrides].concat();
    for arguments in [&run[..], &["view", "results", "--out", "page.html"]] {
        Command::new(env!("CARGO_BIN_EXE_rodlab"))
            .current_dir(directory)
            .args(arguments)
            .assert()
            .success();
    }
    directory.join("page.html")
}

fn is_seen(browser: &mut Browser, id: &str) -> bool {
    let height = format!("document.getElementById('{id}').getBoundingClientRect().height > 0");
    browser.evaluate(&height) == true
}

#[test]
fn equilibria_are_not_played_as_a_motion_with_a_speed() {
    let directory = tempfile::tempdir().unwrap();
    let page = page_of(COLUMN, directory.path(), &[]);
    let Some(mut browser) = Browser::start() else {
        return;
    };
    browser.open(&page);
    for id in ["play", "speed", "video"] {
        assert!(!is_seen(&mut browser, id), "{id}");
    }
    assert!(is_seen(&mut browser, "time"));
    let clock = |browser: &mut Browser| {
        let text = browser.evaluate("document.getElementById('clock').textContent");
        text.as_str().unwrap().to_owned()
    };
    assert!(clock(&mut browser).starts_with("parameter 0, branch 0"));
    browser.press("End");
    assert!(clock(&mut browser).starts_with("parameter 6, branch 2"));
    browser.press(" ");
    assert!(clock(&mut browser).starts_with("parameter 6, branch 2"));
    let colours = browser.evaluate("document.getElementById('colour').textContent");
    assert!(!colours.as_str().unwrap().contains("speed"), "{colours}");
    // All three branches end at the same parameter, and the chart must not connect them.
    browser.set("plot", "Bending energy");
    let pieces = browser
        .evaluate("document.querySelector('#chart path').getAttribute('d').split('M').length - 1");
    assert_eq!(pieces, 3);
    keep("path.png", &browser.screenshot());
    assert!(
        browser.complaints().is_empty(),
        "{:?}",
        browser.complaints()
    );
}

#[test]
fn rods_at_rest_have_no_time_bar() {
    let directory = tempfile::tempdir().unwrap();
    let cantilever = r#"
experiment = "scene"
material = { youngs_modulus = "100 MPa", poissons_ratio = 0.5, density = 1000.0 }
time = { mode = "static" }
clamps = [{ rod = "beam", at = "start" }]
loads = [{ kind = "gravity", acceleration = [0, 0, -9.81] }]
[[rods]]
name = "beam"
radius = "5 mm"
edges = 20
shape = { kind = "straight", start = [0, 0, 0], end = [1, 0, 0] }
"#;
    let file = directory.path().join("beam.toml");
    fs::write(&file, cantilever).unwrap();
    let page = page_of(&file.to_string_lossy(), directory.path(), &[]);
    let Some(mut browser) = Browser::start() else {
        return;
    };
    browser.open(&page);
    for id in ["transport", "plot-choice", "video"] {
        assert!(!is_seen(&mut browser, id), "{id}");
    }
    assert!(is_seen(&mut browser, "picture"));
    keep("rest.png", &browser.screenshot());
}

/// Smallest and largest column and row of pixels with a strong colour.
fn bounds_of_rods(png: &[u8]) -> [[u32; 2]; 2] {
    let image = image::load_from_memory(png).expect("a PNG").to_rgb8();
    let spread = |pixel: &[u8; 3]| pixel.iter().max().unwrap() - pixel.iter().min().unwrap();
    let coloured = image
        .enumerate_pixels()
        .filter(|(.., pixel)| spread(&pixel.0) > 60);
    coloured.fold([[u32::MAX, 0]; 2], |[across, down], (x, y, _)| {
        let with = |[least, most]: [u32; 2], one: u32| [least.min(one), most.max(one)];
        [with(across, x), with(down, y)]
    })
}

/// Smallest and largest row of pixels with a strong colour.
fn rows_of_rods(png: &[u8]) -> [u32; 2] {
    bounds_of_rods(png)[1]
}

#[test]
fn the_tools_do_not_cover_a_rod_near_the_camera() {
    let directory = tempfile::tempdir().unwrap();
    let long = SCENARIO.replace(
        "[-0.15, 0, 0.03], end = [0.1, 0, 0.03]",
        "[-0.3, 0.3, 0.03], end = [0.3, -0.3, 0.03]",
    );
    fs::write(directory.path().join("long.toml"), long).unwrap();
    let file = directory.path().join("long.toml");
    let page = page_of(
        &file.to_string_lossy(),
        directory.path(),
        &["--set", "time.end=10ms"],
    );
    let Some(mut browser) = Browser::start() else {
        return;
    };
    browser.resize(1280, 800);
    browser.open(&page);
    let tools = "document.getElementById('tools').getBoundingClientRect().left";
    let tools = browser.evaluate(tools).as_f64().unwrap();
    browser.press("h");
    let [[left, right], _] = bounds_of_rods(&browser.screenshot());
    assert!(f64::from(right) < tools, "{right} beyond {tools}");
    assert!(
        f64::from(right - left) > 0.3 * tools,
        "{left} {right}: small"
    );
    // The rod stays completely visible when the window becomes narrow.
    browser.resize(400, 800);
    let [[left, right], _] = bounds_of_rods(&browser.screenshot());
    assert!(left > 0 && right < 399, "{left} {right}: cut off");
}

#[test]
fn the_fit_leaves_room_for_the_bar_on_large_and_small_screens() {
    let directory = tempfile::tempdir().unwrap();
    // A rod with the height of the screen.
    let upright = SCENARIO.replace(
        "[-0.15, 0, 0.03], end = [0.1, 0, 0.03]",
        "[0, 0, 0.05], end = [0, 0, 0.45]",
    );
    fs::write(directory.path().join("upright.toml"), upright).unwrap();
    let file = directory.path().join("upright.toml");
    let page = page_of(
        &file.to_string_lossy(),
        directory.path(),
        &["--set", "time.end=10ms"],
    );
    let Some(mut browser) = Browser::start() else {
        return;
    };
    for (width, height) in [(1280, 800), (390, 800), (800, 390), (844, 390)] {
        browser.resize(width, height);
        browser.open(&page);
        let edge = |browser: &mut Browser, id: &str, side: &str| {
            let place = format!("document.getElementById('{id}').getBoundingClientRect().{side}");
            browser.evaluate(&place).as_f64().unwrap()
        };
        let bar = edge(&mut browser, "transport", "top");
        assert!(edge(&mut browser, "transport", "right") <= f64::from(width));
        let cards = if width < 640 {
            edge(&mut browser, "legend", "bottom").max(edge(&mut browser, "about", "bottom"))
        } else if height < 760 {
            // The tools used to cover the tips of the rod.
            edge(&mut browser, "tools", "bottom")
        } else {
            0.0
        };
        keep(&format!("fit_{width}x{height}.png"), &browser.screenshot());
        browser.press("h");
        let [top, bottom] = rows_of_rods(&browser.screenshot());
        assert!(
            f64::from(bottom) < bar,
            "{width}x{height}: {bottom} below {bar}"
        );
        assert!(
            f64::from(top) > cards,
            "{width}x{height}: {top} above {cards}"
        );
        // The rod fills most of the free space.
        let free = bar - cards;
        assert!(
            f64::from(bottom - top) > 0.5 * free,
            "{width}x{height}: {top} {bottom}"
        );
        browser.press("h");
    }
    assert!(
        browser.complaints().is_empty(),
        "{:?}",
        browser.complaints()
    );
}

#[test]
fn series_are_plotted_and_pictures_and_videos_saved() {
    let directory = tempfile::tempdir().unwrap();
    let page = page(directory.path());
    let Some(mut browser) = Browser::start() else {
        return;
    };
    browser.open(&page);
    assert!(!is_seen(&mut browser, "chart-card"));
    let plots = browser.evaluate(
        "[...document.getElementById('plot').options].map(one => one.textContent).join()",
    );
    assert!(
        plots.as_str().unwrap().contains("Kinetic energy"),
        "{plots}"
    );
    browser.set("plot", "Kinetic energy");
    assert!(is_seen(&mut browser, "chart-card"));
    browser.set("time", "20");
    let value = browser.evaluate("document.getElementById('chart-value').textContent");
    assert!(value.as_str().unwrap().ends_with(" J"), "{value}");
    keep("chart.png", &browser.screenshot());
    // A file offered for download is recorded instead.
    browser.evaluate(
        "window.saved = []; HTMLAnchorElement.prototype.click = function () {
           const name = this.download;
           fetch(this.href).then(one => one.blob()).then(blob => saved.push(`${name} ${blob.type} ${blob.size}`)); };",
    );
    let saved = |browser: &mut Browser, count: usize| -> String {
        let wait = format!(
            "new Promise(done => {{ const look = () => saved.length >= {count} ? done(saved.at(-1)) : setTimeout(look, 50); look(); }})"
        );
        browser.evaluate(&wait).as_str().unwrap().to_owned()
    };
    let size = |file: &str| file.rsplit(' ').next().unwrap().parse::<usize>().unwrap();
    browser.press("s");
    let picture = saved(&mut browser, 1);
    assert!(
        picture.starts_with("a-rod-falls-on-another.png image/png ") && size(&picture) > 5_000,
        "{picture}"
    );
    browser.set("speed", "0.1");
    browser.press("v");
    let video = saved(&mut browser, 2);
    assert!(
        video.starts_with("a-rod-falls-on-another.webm video/webm") && size(&video) > 5_000,
        "{video}"
    );
    assert_eq!(
        browser.evaluate("document.getElementById('time').value"),
        "24"
    );
    assert!(
        browser.complaints().is_empty(),
        "{:?}",
        browser.complaints()
    );
}

#[test]
fn a_page_of_a_run_at_work_reloads_and_keeps_what_the_user_chose() {
    let directory = tempfile::tempdir().unwrap();
    let page = page(directory.path());
    let text = fs::read_to_string(&page).unwrap();
    let reloading = text.replace("\"reload\":null", "\"reload\":3600");
    assert!(reloading != text);
    fs::write(&page, reloading).unwrap();
    let Some(mut browser) = Browser::start() else {
        return;
    };
    // The page reloads after an hour; the test ends this wait at once.
    browser.prepare(
        "{ const wait = window.setTimeout.bind(window);
           window.setTimeout = (action, time) => time === 3600e3 ? (window.afterAnHour = action, 0) : wait(action, time); }",
    );
    browser.open(&page);
    // The page of a running run shows its last output.
    let time = "document.getElementById('time').value";
    assert_eq!(browser.evaluate(time), "24");
    let before = browser.screenshot();
    browser.set("colour", "Curvature");
    browser.drag([600.0, 400.0], [700.0, 350.0]);
    let turned = browser.screenshot();
    let loaded = "document.readyState === 'complete' ? String(performance.timeOrigin) : ''";
    let first = browser.evaluate(loaded);
    browser.evaluate("setTimeout(window.afterAnHour, 0)");
    let begin = std::time::Instant::now();
    while browser.evaluate(loaded) == first || browser.evaluate(loaded) == "" {
        assert!(begin.elapsed().as_secs() < 300, "the page was not reloaded");
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    browser.settle();
    let colour = "document.getElementById('colour').value";
    assert_eq!(browser.evaluate(colour), "Curvature");
    assert_eq!(browser.evaluate(time), "24");
    let after = browser.screenshot();
    assert!(changed(&before, &after) > 5_000);
    let rest = changed(&turned, &after);
    assert!(rest < 500, "{rest}");
}

/// Saves a picture for inspection by a person.
fn keep(name: &str, png: &[u8]) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("screenshots");
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join(name), png).unwrap();
}

#[test]
fn impossible_views_are_rejected_with_a_message() {
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
    assert!(refuse("nowhere").contains("not a results directory"));
    page(directory.path());
    fs::remove_file(directory.path().join("fall/nodes.csv")).unwrap();
    assert!(refuse("fall").contains("`nodes = true` under [output]"));
}
