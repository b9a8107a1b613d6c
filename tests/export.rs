//! Files for other programs: complete or not written, and models of MuJoCo and Newton that move like
//! the rods.

use crate::parts::{have, in_build, skipped, succeeds};
use assert_cmd::Command;
use std::fs;
use std::path::{Path, PathBuf};

/// A clamp that rises by 0.2 m within half a second and stays there.
const RISING: &str = r#"
experiment = "scene"
material = { youngs_modulus = "20 MPa", poissons_ratio = 0.5, density = 1000.0, viscosity = 4e5 }
time = { step = "auto", end = "0.7 s" }
output = { interval = "0.1 s" }
[[rods]]
name = "beam"
radius = "5 mm"
edges = 20
shape = { kind = "straight", start = [0, 0, 0], end = [0.5, 0, 0] }
[[clamps]]
rod = "beam"
at = "start"
move = [[0.0, [0, 0, 0]], [0.5, [0, 0, 0.2]]]
"#;

/// A cantilever that bends by most of its length under its weight.
const HEAVY: &str = r#"
experiment = "scene"
material = { youngs_modulus = "100 MPa", poissons_ratio = 0.5, density = 1000.0 }
time = { mode = "static" }
output = { nodes = true }
[[rods]]
name = "beam"
radius = "5 mm"
edges = 20
shape = { kind = "straight", start = [0, 0, 0], end = [1, 0, 0] }
[[clamps]]
rod = "beam"
at = "start"
[[loads]]
kind = "gravity"
acceleration = [0, 0, -9.81]
"#;

fn rodlab(directory: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rodlab"));
    command.current_dir(directory).args(arguments);
    command
}

/// A directory with a scenario `beam.toml` and its results in `beam`.
fn results(scenario: &str) -> tempfile::TempDir {
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("beam.toml"), scenario).unwrap();
    rodlab(directory.path(), &["run", "beam.toml", "--out", "beam"])
        .assert()
        .success();
    directory
}

/// Positions of the last node at each output, with the time.
fn tips(directory: &Path) -> Vec<[f64; 4]> {
    let text = fs::read_to_string(directory.join("beam/nodes.csv")).unwrap();
    let rows = text
        .lines()
        .skip(1)
        .map(|line| line.split(',').collect::<Vec<_>>());
    let rows = rows.filter(|row| row[2] == "20");
    let number = |word: &str| word.parse().unwrap();
    rows.map(|row| [row[0], row[3], row[4], row[5]].map(number))
        .collect()
}

#[test]
fn results_are_written_in_every_format() {
    let directory = results(RISING);
    let heads: [(&str, &str, &[u8]); 3] = [
        ("gltf", "a.glb", b"glTF"),
        ("usd", "a.usda", b"#usda 1.0"),
        ("obj", "a.obj", b"# rodlab"),
    ];
    for (format, name, head) in heads {
        let arguments = ["export", "beam", "--format", format, "--out", name];
        let done = rodlab(directory.path(), &arguments).assert().success();
        let printed = String::from_utf8(done.get_output().stdout.clone()).unwrap();
        assert!(printed.starts_with(name), "{printed}");
        let bytes = fs::read(directory.path().join(name)).unwrap();
        assert!(bytes.starts_with(head));
        // The file is replaced by one of its kind.
        rodlab(directory.path(), &arguments).assert().success();
        assert_eq!(fs::read(directory.path().join(name)).unwrap(), bytes);
    }
    rodlab(
        directory.path(),
        &[
            "export", "beam", "--format", "obj", "--out", "b.obj", "--at", "0.31s",
        ],
    )
    .assert()
    .success();
    let text = fs::read_to_string(directory.path().join("b.obj")).unwrap();
    assert!(
        text.lines().next().unwrap().contains("t = 0.3 s"),
        "{text:.80}"
    );
}

#[test]
fn bad_input_ends_with_code_2_and_leaves_no_file() {
    let directory = results(HEAVY);
    fs::write(directory.path().join("letter.glb"), "Dear reader").unwrap();
    let closed = HEAVY.replace(
        "kind = \"straight\", start = [0, 0, 0], end = [1, 0, 0]",
        "kind = \"ring\", centre = [0, 0, 0], normal = [0, 0, 1], radius = 0.2",
    );
    fs::write(
        directory.path().join("ring.toml"),
        closed.split("[[clamps]]").next().unwrap(),
    )
    .unwrap();
    let refused = |arguments: &[&str], words: &[&str]| {
        let failed = rodlab(directory.path(), arguments).assert().code(2);
        let said = String::from_utf8(failed.get_output().stderr.clone()).unwrap();
        for word in words {
            assert!(said.contains(word), "{word}: {said}");
        }
    };
    let to = |source: &'static str, format: &'static str, name: &'static str| {
        ["export", source, "--format", format, "--out", name]
    };
    refused(
        &to("nowhere", "gltf", "new.glb"),
        &["nowhere", "manifest.json"],
    );
    refused(&to("beam", "gltf", "new.usda"), &["new.usda", ".glb"]);
    refused(
        &to("beam", "gltf", "letter.glb"),
        &["letter.glb", "another kind"],
    );
    refused(&to("beam", "mjcf", "new.xml"), &["beam", "scenario"]);
    refused(
        &to("ring.toml", "mjcf", "new.xml"),
        &["ring.toml: rods.beam.shape"],
    );
    refused(
        &to("beam", "newton", "new.py"),
        &["beam", "--format newton exports a scenario"],
    );
    refused(&to("beam.toml", "newton", "new.xml"), &["new.xml", ".py"]);
    let inner = HEAVY.replace("at = \"start\"", "at = 10");
    fs::write(directory.path().join("inner.toml"), inner).unwrap();
    refused(
        &to("inner.toml", "newton", "new.py"),
        &["inner.toml: rods.beam.name: a clamp"],
    );
    refused(&to("beam.toml", "gltf", "new.glb"), &["beam.toml"]);
    for name in ["new.glb", "new.usda", "new.xml", "new.py"] {
        assert!(!directory.path().join(name).exists(), "{name}");
    }
    assert_eq!(
        fs::read(directory.path().join("letter.glb")).unwrap(),
        b"Dear reader"
    );
}

/// Steps a model; prints the time and the place of the last node at each tenth of a second, and at
/// the end. A moving clamp rises as in [`RISING`]; without one, the model is brought to rest.
const RUN: &str = r#"
import sys, mujoco, numpy as np
model = mujoco.MjModel.from_xml_path(sys.argv[1])
data = mujoco.MjData(model)
tip = model.body("beam_20").id
def show():
    print(round(data.time, 4), *data.xpos[tip])
if model.nmocap:
    start, shown = data.mocap_pos[0].copy(), 0
    while data.time < 0.7 - 1e-9:
        data.mocap_pos[0] = start + [0, 0, 0.4 * min(data.time + model.opt.timestep, 0.5)]
        mujoco.mj_step(model, data)
        if data.time >= 0.1 * (shown + 1) - 0.5 * model.opt.timestep:
            shown += 1
            mujoco.mj_kinematics(model, data)
            show()
else:
    while data.time < 1 or np.abs(data.qvel).max() > 1e-5:
        mujoco.mj_step(model, data)
        assert data.time < 100
    show()
"#;

/// A Python that runs a line: the one that `RODLAB_PYTHON` names, or one in a folder of the build
/// directory, in which `package` is installed if `installs`.
fn python_that_runs(
    line: &str,
    folder: &str,
    [part, package]: [&str; 2],
    installs: bool,
) -> Option<PathBuf> {
    let has = |python: &Path| succeeds(std::process::Command::new(python).args(["-c", line]));
    let named = std::env::var_os("RODLAB_PYTHON").map(PathBuf::from);
    if let Some(python) = named.filter(|python| has(python)) {
        return Some(python);
    }
    let folder = in_build(folder);
    let python = folder.join("bin/python");
    if !installs && !has(&python) {
        skipped(&format!(
            "no {part}; RODLAB_TESTS_FULL=1 installs it, and RODLAB_PYTHON names a Python with it"
        ));
        return None;
    }
    let install = || {
        let mut environment = std::process::Command::new("python3");
        let mut packages = std::process::Command::new(&python);
        succeeds(environment.args(["-m", "venv"]).arg(&folder))
            && succeeds(packages.args(["-m", "pip", "install", "--quiet", package]))
    };
    have(part, "to run exported models", || has(&python), install).then_some(python)
}

/// Exports `beam.toml` and returns what is printed.
fn exported(directory: &Path, format: &str, name: &str) -> String {
    let arguments = ["export", "beam.toml", "--format", format, "--out", name];
    let done = rodlab(directory, &arguments).assert().success();
    String::from_utf8(done.get_output().stdout.clone()).unwrap()
}

/// What MuJoCo shows of an exported scenario; `None` without MuJoCo 4.
fn shown_by_mujoco(directory: &Path) -> Option<Vec<[f64; 4]>> {
    let line = "import mujoco; assert int(mujoco.__version__.split('.')[0]) >= 4";
    let python = python_that_runs(line, "mujoco4", ["MuJoCo 4", "mujoco>=4"], true)?;
    exported(directory, "mjcf", "beam.xml");
    fs::write(directory.join("run.py"), RUN).unwrap();
    let done = Command::new(python)
        .current_dir(directory)
        .args(["run.py", "beam.xml"])
        .assert()
        .success();
    let text = String::from_utf8(done.get_output().stdout.clone()).unwrap();
    let rows = text.lines().map(|line| {
        let words: Vec<f64> = line.split(' ').map(|word| word.parse().unwrap()).collect();
        <[f64; 4]>::try_from(words).unwrap()
    });
    Some(rows.collect())
}

/// What the program for Newton prints of the last node; `None` without Newton, which takes half a
/// gigabyte and is installed for the full tests only.
fn shown_by_newton(directory: &Path) -> Option<Vec<[f64; 4]>> {
    let line =
        "import newton; v = newton.__version__.split('.'); assert [int(v[0]), int(v[1])] >= [1, 8]";
    let full = std::env::var("RODLAB_TESTS_FULL").is_ok_and(|value| value == "1");
    let python = python_that_runs(line, "newton1.8", ["Newton 1.8", "newton==1.8.*"], full)?;
    exported(directory, "newton", "beam.py");
    let done = Command::new(python)
        .current_dir(directory)
        .env("WARP_CACHE_PATH", in_build("warp"))
        .arg("beam.py")
        .assert()
        .success();
    let text = String::from_utf8(done.get_output().stdout.clone()).unwrap();
    let rows = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let rows = rows.filter(|row| row.len() == 6 && row[1] == "beam" && row[2] == "20");
    let number = |word: &str| word.parse().unwrap();
    let rows = rows.map(|row| [row[0], row[3], row[4], row[5]].map(number));
    Some(rows.collect())
}

/// Distance between two places after their times.
fn distance(one: &[f64; 4], other: &[f64; 4]) -> f64 {
    (1..4)
        .map(|k| (one[k] - other[k]).powi(2))
        .sum::<f64>()
        .sqrt()
}

#[test]
fn a_heavy_cantilever_hangs_as_low_in_mujoco() {
    let directory = results(HEAVY);
    let Some(shown) = shown_by_mujoco(directory.path()) else {
        return;
    };
    let tip = tips(directory.path())[0];
    assert!(tip[3] < -0.7);
    let error = distance(&shown[0], &tip);
    assert!(error < 0.01, "{shown:?} {tip:?}");
}

#[test]
fn a_cantilever_on_a_rising_clamp_swings_alike_in_mujoco() {
    let directory = results(RISING);
    let Some(shown) = shown_by_mujoco(directory.path()) else {
        return;
    };
    let tips = tips(directory.path());
    assert_eq!(shown.len(), 7);
    for (shown, tip) in shown.iter().zip(&tips[1..]) {
        assert!((shown[0] - tip[0]).abs() < 0.01);
        let error = distance(shown, tip);
        assert!(error < 0.01 * 0.5, "{shown:?} {tip:?}");
    }
}

#[test]
fn a_heavy_cantilever_hangs_as_low_in_newton() {
    let directory = results(HEAVY);
    let Some(shown) = shown_by_newton(directory.path()) else {
        return;
    };
    let tip = tips(directory.path())[0];
    assert!(tip[3] < -0.7);
    let error = distance(shown.last().unwrap(), &tip);
    assert!(error < 0.01, "{shown:?} {tip:?}");
}

#[test]
fn a_cantilever_on_a_rising_clamp_swings_alike_in_newton() {
    let directory = results(RISING);
    let Some(shown) = shown_by_newton(directory.path()) else {
        return;
    };
    let tips = tips(directory.path());
    assert_eq!(shown.len(), tips.len());
    for (shown, tip) in shown.iter().zip(&tips) {
        assert!((shown[0] - tip[0]).abs() < 1e-3);
        let error = distance(shown, tip);
        assert!(error < 0.01 * 0.5, "{shown:?} {tip:?}");
    }
}

#[test]
fn programs_for_newton_are_python_with_the_numbers_of_the_scenario() {
    let directory = tempfile::tempdir().unwrap();
    let directory = directory.path();
    fs::write(directory.join("beam.toml"), RISING).unwrap();
    let printed = exported(directory, "newton", "beam.py");
    assert!(
        printed.starts_with("beam.py\nnot in the file:\n"),
        "{printed}"
    );
    assert!(printed.contains("stretching of beam: EA"), "{printed}");
    let text = fs::read_to_string(directory.join("beam.py")).unwrap();
    for part in [
        "# rodlab ",
        "\"damping\": 0.02,",
        "            (0.025, 0.0, 0.0),\n",
        "\"tangent\": (1.0, 0.0, 0.0)",
        "(0.5, 0.0, 0.0, 0.2, 0.0, 0.0, 0.0, 1.0),",
        "SolverVBD",
    ] {
        assert!(text.contains(part), "{part}");
    }
    // The file is replaced by one of its kind.
    fs::write(directory.join("beam.toml"), HEAVY).unwrap();
    let printed = exported(directory, "newton", "beam.py");
    assert!(printed.contains("until they are at rest"), "{printed}");
    let text = fs::read_to_string(directory.join("beam.py")).unwrap();
    assert!(text.contains("GRAVITY = (0.0, 0.0, -9.81)"));
    if !succeeds(std::process::Command::new("python3").arg("--version")) {
        skipped("no python3 to compile a program for Newton");
        return;
    }
    Command::new("python3")
        .current_dir(directory)
        .args(["-m", "py_compile", "beam.py"])
        .assert()
        .success();
}
