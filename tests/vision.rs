//! The program on images: files, answers and exit codes.

use assert_cmd::Command;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use rodlab::vision::{Camera, Lens, Point, RenderOptions, RenderedRod, encode_picture, render};
use serde_json::Value;
use std::f64::consts::PI;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

fn camera() -> Camera {
    let down = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI);
    let rotation = UnitQuaternion::from_euler_angles(0.2, 0.0, 0.3) * down;
    Camera {
        width: 640,
        height: 480,
        lens: Lens {
            focal: [620.0, 618.0],
            centre: [318.0, 242.0],
            distortion: [0.05, -0.08, 0.0, 0.0, 0.0],
        },
        pose: Isometry3::from_parts(
            Translation3::from(rotation * Vector3::new(0.0, 0.0, -0.6)),
            rotation,
        ),
        table_height: 0.003,
    }
}

/// Two rods that cross, and the curve of the first one.
fn scene() -> (Vec<RenderedRod>, Vec<Point>) {
    let rod = |curve: &dyn Fn(f64) -> (f64, f64), height: f64, colour| RenderedRod {
        points: (0..=600)
            .map(|index| {
                let (x, y) = curve(f64::from(index) / 300.0 - 1.0);
                Vector3::new(x, y, height)
            })
            .collect(),
        radius: 0.003,
        colour,
    };
    let wave = |t: f64| (0.2 * t, 0.06 * (2.5 * t).sin());
    let line = |t: f64| (0.02 * t, 0.13 * t);
    let rods = vec![
        rod(&wave, 0.003, [210, 80, 90]),
        rod(&line, 0.0105, [90, 170, 200]),
    ];
    let curve = rods[0].points.iter().map(|point| point.xy()).collect();
    (rods, curve)
}

fn photograph(folder: &Path) {
    let (rods, curve) = scene();
    let picture = render(&camera(), &rods, |_| [14.0; 3], &RenderOptions::default());
    fs::write(folder.join("photo.png"), encode_picture(&picture)).expect("a picture");
    fs::write(folder.join("camera.toml"), camera().to_toml()).expect("a camera");
    let mut csv = String::from("x_m,y_m\n");
    for point in curve {
        csv += &format!("{},{}\n", point.x, point.y);
    }
    fs::write(folder.join("pattern.csv"), csv).expect("a pattern");
}

fn rodlab(folder: &Path, arguments: &[&str]) -> assert_cmd::assert::Assert {
    Command::cargo_bin("rodlab")
        .expect("the program")
        .current_dir(folder)
        .args(arguments)
        .assert()
}

fn json(assert: &assert_cmd::assert::Assert) -> Value {
    serde_json::from_slice(&assert.get_output().stdout).expect("JSON")
}

#[test]
fn a_photograph_is_traced_and_scored() {
    let folder = TempDir::new().expect("a folder");
    let place = folder.path();
    photograph(place);
    let traced = rodlab(
        place,
        &[
            "trace",
            "photo.png",
            "--cell",
            "camera.toml",
            "--out",
            "traced",
            "--json",
        ],
    )
    .success();
    let answer = json(&traced);
    assert_eq!(answer["strands"].as_array().map(Vec::len), Some(2));
    assert_eq!(answer["crossings"].as_array().map(Vec::len), Some(1));
    let over = answer["crossings"][0]["over"]["strand"]
        .as_u64()
        .expect("a strand");
    let under = answer["crossings"][0]["under"]["strand"]
        .as_u64()
        .expect("a strand");
    let length = |strand: u64| {
        let strands = answer["strands"].as_array().expect("strands");
        strands[strand as usize - 1]["length_m"]
            .as_f64()
            .expect("a length")
    };
    assert!((length(over) - 0.263).abs() < 0.01, "{answer}");
    assert!((length(under) - 0.431).abs() < 0.02, "{answer}");
    for file in [
        "centrelines.csv",
        "centrelines.svg",
        "labels.png",
        "overlay.png",
    ] {
        assert!(place.join("traced").join(file).is_file(), "{file}");
    }
    let table = fs::read_to_string(place.join("traced/centrelines.csv")).expect("a table");
    assert!(table.starts_with("strand,point,u_px,v_px,width_px,x_m,y_m\n1,0,"));

    let under = under.to_string();
    let scored = rodlab(
        place,
        &[
            "score",
            "traced/centrelines.csv",
            "pattern.csv",
            "--strand",
            &under,
            "--out",
            "score.svg",
            "--json",
        ],
    )
    .success();
    let score = json(&scored);
    let mean = |kind: &str| score[kind]["mean_m"].as_f64().expect("a mean");
    assert!(mean("by_nearest_point") < 0.5e-3, "{score}");
    assert!(mean("by_arc_length") < 2e-3, "{score}");
    assert!(place.join("score.svg").is_file() && place.join("score.png").is_file());
}

#[test]
fn the_rods_asked_for_are_traced() {
    let folder = TempDir::new().expect("a folder");
    photograph(folder.path());
    let one = ["trace", "photo.png", "--strands", "1", "--json"];
    let answer = json(&rodlab(folder.path(), &one).success());
    assert_eq!(answer["strands"].as_array().map(Vec::len), Some(1));
    assert_eq!(answer["rejected"].as_array().map(Vec::len), Some(1));

    let colours = ["trace", "photo.png", "--colour", "red", "--colour", "cyan"];
    let answer = json(&rodlab(folder.path(), &[&colours[..], &["--json"]].concat()).success());
    assert_eq!(answer["strands"].as_array().map(Vec::len), Some(2));

    // There are only two rods: the program reports its doubt.
    let three = ["trace", "photo.png", "--strands", "3"];
    let text = rodlab(folder.path(), &three).success();
    let text = String::from_utf8_lossy(&text.get_output().stdout).into_owned();
    assert!(text.contains("doubtful: 2 of 3 strands"), "{text}");
}

/// `trace --pattern`, `score --out` and similar options used to replace any existing file.
#[test]
fn files_of_the_user_are_not_replaced_by_answers() {
    let folder = TempDir::new().expect("a folder");
    let place = folder.path();
    photograph(place);
    let notes = "length of the cable,0.4 m\n";
    fs::write(place.join("notes.csv"), notes).expect("notes");
    fs::write(place.join("notes.svg"), notes).expect("notes");
    let scored = ["score", "pattern.csv", "pattern.csv", "--out", "notes.svg"];
    let traced = ["trace", "photo.png", "--cell", "camera.toml", "--pattern"];
    for arguments in [&scored[..], &[&traced[..], &["notes.csv"]].concat()] {
        let refused = rodlab(place, arguments).code(2);
        let said = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
        assert!(said.contains("is not replaced"), "{said}");
    }
    for name in ["notes.csv", "notes.svg"] {
        let kept = fs::read_to_string(place.join(name)).expect("notes");
        assert_eq!(kept, notes);
    }
    // The answer of an earlier call is replaced.
    for _ in 0..2 {
        rodlab(place, &[&traced[..], &["drawn.csv"]].concat()).success();
    }
}

#[test]
fn bad_images_end_with_exit_code_2() {
    let folder = TempDir::new().expect("a folder");
    let place = folder.path();
    photograph(place);
    let bytes = fs::read(place.join("photo.png")).expect("a picture");
    fs::write(place.join("half.png"), &bytes[..bytes.len() / 2]).expect("half a picture");
    fs::write(place.join("text.png"), "no picture").expect("a file");
    let black = image::RgbImage::new(100, 80);
    fs::write(place.join("black.png"), encode_picture(&black)).expect("a picture");
    let wrong = camera().to_toml().replace("width = 640", "width = 320");
    fs::write(place.join("wrong.toml"), wrong).expect("a camera");
    fs::write(place.join("none.toml"), "[arm]\nlength = 1\n").expect("a file");
    let cases: [(&[&str], &str); 16] = [
        (&["trace", "absent.png"], "absent.png"),
        (&["trace", "half.png"], "half.png: the image is"),
        (&["trace", "text.png"], "neither a PNG nor a JPEG"),
        (&["trace", "black.png", "--out", "why"], "the mask is empty"),
        (&["trace", "photo.png", "--colour", "redd"], "\"redd\""),
        (
            &["trace", "photo.png", "--region", "1,2,3"],
            "x,y,width,height",
        ),
        (
            &["trace", "photo.png", "--region", "900,0,9,9"],
            "640 × 480",
        ),
        (
            &["trace", "photo.png", "--least-length", "5000"],
            "5000 px long",
        ),
        (&["trace", "photo.png", "--mask", "black.png"], "100 × 80"),
        (&["trace", "photo.png", "--cell", "wrong.toml"], "640 × 480"),
        (
            &["trace", "photo.png", "--cell", "none.toml"],
            "no table [camera]",
        ),
        (&["trace", "photo.png", "--pattern", "p.csv"], "--pixel"),
        (
            &["trace", "rosbridge://127.0.0.1/camera"],
            "host:port/topic",
        ),
        (&["trace", "ros2://300/camera"], "ROS_DOMAIN_ID"),
        (&["trace", "ros2://0@here/camera"], "ros2://domain@address"),
        (
            &["trace", "http://127.0.0.1/a.png"],
            "ros1://, rosbridge://",
        ),
    ];
    for (arguments, expected) in cases {
        let failed = rodlab(place, arguments).code(2);
        let said = String::from_utf8_lossy(&failed.get_output().stderr).into_owned();
        assert!(said.contains(expected), "{arguments:?}: {said}");
    }
    assert!(place.join("why/overlay.png").is_file());
    assert!(!place.join("p.csv").exists());
}

#[test]
fn a_camera_is_calibrated_from_pictures() {
    let folder = TempDir::new().expect("a folder");
    let place = folder.path();
    let board = |point: Point| {
        let (x, y) = ((point.x / 0.03).floor(), (point.y / 0.03).floor());
        let inside = (-1.0..6.0).contains(&x) && (-1.0..5.0).contains(&y);
        let dark = (x + y).rem_euclid(2.0) == 1.0;
        if inside && dark {
            [30.0; 3]
        } else {
            [220.0; 3]
        }
    };
    fs::create_dir(place.join("views")).expect("a folder");
    for index in 0..5 {
        let turn = f64::from(index) * 2.4;
        let mut view = camera();
        let down = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI);
        let tilt = if index == 0 { 0.0 } else { 0.5 };
        let rotation = UnitQuaternion::new(Vector3::new(turn.cos(), turn.sin(), 0.0) * tilt) * down;
        let aim = Vector3::new(0.075, 0.06, 0.0);
        view.table_height = 0.0;
        view.pose = Isometry3::from_parts(
            Translation3::from(aim - rotation * Vector3::z() * 0.4),
            rotation,
        );
        let picture = render(&view, &[], board, &RenderOptions::default());
        let name = format!("views/view_{index}.png");
        fs::write(place.join(name), encode_picture(&picture)).expect("a picture");
    }
    let arguments = [
        "calibrate",
        "camera",
        "views",
        "--board",
        "6x5",
        "--square",
        "30 mm",
    ];
    let mut with_out = arguments.to_vec();
    with_out.extend(["--out", "camera.toml", "--json"]);
    let answer = json(&rodlab(place, &with_out).success());
    assert_eq!(answer["images"], 5);
    assert!(
        answer["reprojection_rms_px"].as_f64().expect("a number") < 0.1,
        "{answer}"
    );
    let found = Camera::read(&place.join("camera.toml")).expect("a camera");
    assert!(
        (found.lens.focal[0] - 620.0).abs() < 5.0,
        "{:?}",
        found.lens
    );
    assert!((found.pose.translation.vector.z - 0.4).abs() < 0.004);

    assert_eq!(answer["camera"]["width"], 640);

    let view = fs::read_dir(place.join("views")).expect("views").next();
    let view = view.expect("a view").expect("a view").path();
    let view = view.to_str().expect("a name");
    let size = ["--board", "6x5", "--square", "30 mm"];
    let pose = [
        &["calibrate", "pose", view],
        &size[..],
        &["--cell", "camera.toml", "--json"],
    ];
    let seen = json(&rodlab(place, &pose.concat()).success());
    assert!(
        seen["reprojection_rms_px"].as_f64().expect("a number") < 0.2,
        "{seen}"
    );
    assert_eq!(seen["camera"]["width"], 640);

    let wrong = [
        "calibrate",
        "camera",
        "views",
        "--board",
        "9x7",
        "--square",
        "30 mm",
    ];
    let failed = rodlab(place, &wrong).code(2);
    let said = String::from_utf8_lossy(&failed.get_output().stderr).into_owned();
    assert!(said.contains("no image shows the board"), "{said}");
}
