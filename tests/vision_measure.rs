//! The program on photographs of paper and of markers, on recordings, and on the photographs of the repository.

use assert_cmd::Command;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use rodlab::vision::{
    Camera, Lens, Point, RenderOptions, decode_picture, encode_picture, helix_points, render,
};
use serde_json::Value;
use std::f64::consts::PI;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

fn camera() -> Camera {
    let down = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI);
    let rotation = UnitQuaternion::from_euler_angles(0.15, 0.0, 0.2) * down;
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
        table_height: 0.0,
    }
}

fn rodlab(folder: &Path, line: &str) -> assert_cmd::assert::Assert {
    Command::cargo_bin("rodlab")
        .expect("the program")
        .current_dir(folder)
        .args(line.split(' '))
        .assert()
}

fn json(assert: &assert_cmd::assert::Assert) -> Value {
    serde_json::from_slice(&assert.get_output().stdout).expect("JSON")
}

fn said(assert: &assert_cmd::assert::Assert) -> String {
    String::from_utf8_lossy(&assert.get_output().stderr).into_owned()
}

fn repository() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// A sheet of 0.2 m × 0.15 m with a given centre and rotation.
fn sheet(folder: &Path, name: &str, centre: Point, angle: f64) {
    let ground = |point: Point| {
        let (sine, cosine) = angle.sin_cos();
        let way = point - centre;
        let (x, y) = (way.x * cosine + way.y * sine, way.y * cosine - way.x * sine);
        if x.abs() < 0.1 && y.abs() < 0.075 {
            [225.0, 222.0, 210.0]
        } else {
            [60.0, 70.0, 85.0]
        }
    };
    let picture = render(&camera(), &[], ground, &RenderOptions::default());
    fs::write(folder.join(name), encode_picture(&picture)).expect("a picture");
    fs::write(folder.join("camera.toml"), camera().to_toml()).expect("a camera");
}

#[test]
fn a_sheet_and_its_sliding_are_measured() {
    let folder = TempDir::new().expect("a folder");
    let place = folder.path();
    sheet(place, "before.png", Point::new(0.0, 0.01), 0.1);
    sheet(place, "after.png", Point::new(0.012, 0.005), 0.13);
    let line = "measure sheet before.png after.png --cell camera.toml --edge 2 --out sheets";
    let answer = json(&rodlab(place, line).success());
    assert_eq!(answer["unit"], "m");
    let number = |value: &Value| value.as_f64().expect("a number");
    let edges = answer["sheets"][0]["edges"].as_array().expect("edges");
    for edge in edges {
        let length = number(&edge["length"]);
        assert!(
            (length - 0.2).abs().min((length - 0.15).abs()) < 0.3e-3,
            "{edge}"
        );
        let angle = (number(&edge["angle_degrees"]) - 0.1f64.to_degrees()).rem_euclid(90.0);
        assert!(angle.min(90.0 - angle) < 0.1, "{edge}");
    }
    let slid = &answer["sliding"];
    assert!(
        (number(&slid["turned_degrees"]) - 0.03f64.to_degrees()).abs() < 0.1,
        "{slid}"
    );
    // The edge on the right of the image: its middle is half a side from the centre, along the
    // axis of the sheet.
    let middle =
        |centre: Point, angle: f64, side: f64| centre + Point::new(angle.cos(), angle.sin()) * side;
    let expected = [-0.1, 0.1].map(|side| {
        middle(Point::new(0.012, 0.005), 0.13, side) - middle(Point::new(0.0, 0.01), 0.1, side)
    });
    let distance = number(&slid["distance"]);
    let off = expected.map(|moved| (moved.x - distance).abs());
    assert!(off[0].min(off[1]) < 0.3e-3, "{slid}");
    for name in ["sheet_1.png", "sheet_2.png"] {
        assert!(place.join("sheets").join(name).is_file(), "{name}");
    }

    let black = image::RgbImage::new(640, 480);
    fs::write(place.join("black.png"), encode_picture(&black)).expect("a picture");
    for (line, expected) in [
        (
            "measure sheet black.png --out why",
            "the sheet was not found",
        ),
        ("measure sheet before.png --cell absent.toml", "absent.toml"),
        ("measure sheet before.png --direction 0,0", "not both 0"),
        ("measure sheet before.png --edge 5", "--edge"),
        ("measure sheet before.png --colour redd", "\"redd\""),
    ] {
        let failed = rodlab(place, line).code(2);
        assert!(
            said(&failed).contains(expected),
            "{line}: {}",
            said(&failed)
        );
    }
    assert!(place.join("why/sheet_1.png").is_file());
}

const HELIX: &str = "[helix]\ncurvature = 9.0\ntorsion = \"5 1/m\"\n\
    markers = [0.02, \"4.5 cm\", 0.07, 0.095, 0.12]\nposition = [-0.05, 0.02, 0.03]\n\
    quaternion = [0.7071067811865476, 0.0, 0.7071067811865476, 0.0]\n";

/// Markers of the helix, all shifted in the image.
fn markers(folder: &Path, name: &str, shift: Point) {
    let camera = camera();
    let pose = Isometry3::from_parts(
        Translation3::new(-0.05, 0.02, 0.03),
        UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(
            0.5f64.sqrt(),
            0.0,
            0.5f64.sqrt(),
            0.0,
        )),
    );
    let places = helix_points(9.0, 5.0, &[0.02, 0.045, 0.07, 0.095, 0.12], &pose);
    let spots: Vec<Point> = places
        .iter()
        .map(|point| camera.project(*point).expect("in front") + shift)
        .collect();
    let picture = image::RgbImage::from_fn(640, 480, |u, v| {
        let pixel = Point::new(f64::from(u), f64::from(v));
        let cover = spots
            .iter()
            .map(|spot| (5.0 - (spot - pixel).norm()).clamp(0.0, 1.0))
            .fold(0.0, f64::max);
        let mix = |from: f64, to: f64| (from + cover * (to - from)) as u8;
        image::Rgb([mix(60.0, 40.0), mix(60.0, 90.0), mix(60.0, 230.0)])
    });
    fs::write(folder.join(name), encode_picture(&picture)).expect("a picture");
}

#[test]
fn markers_show_when_a_rod_becomes_unstable() {
    let folder = TempDir::new().expect("a folder");
    let place = folder.path();
    fs::create_dir(place.join("frames")).expect("a folder");
    fs::write(place.join("camera.toml"), camera().to_toml()).expect("a camera");
    fs::write(place.join("helix.toml"), HELIX).expect("a helix");
    // One image above the bound is noise; from the fifth one on, all are above it.
    for (index, away) in [1.0, 14.0, 1.0, 1.0, 14.0, 14.0, 14.0]
        .into_iter()
        .enumerate()
    {
        let shift = Point::new(0.6, -0.8) * away;
        markers(place, &format!("frames/{}.png", index + 8), shift);
    }
    let line =
        "measure markers frames --cell camera.toml --helix helix.toml --colour blue --out watched";
    let json_line = format!("{line} --json");
    let answer = json(&rodlab(place, &json_line).success());
    let pictures = answer["pictures"].as_array().expect("pictures");
    assert_eq!(pictures.len(), 7);
    assert_eq!(pictures[0]["spots"], 5);
    for marker in pictures[0]["markers"].as_array().expect("markers") {
        let error = marker["error_px"].as_f64().expect("an error");
        assert!((error - 1.0).abs() < 0.2, "{marker}");
    }
    assert_eq!(answer["unstable_from"], "frames/14.png");
    let table = fs::read_to_string(place.join("watched/markers.csv")).expect("a table");
    assert_eq!(table.lines().count(), 1 + 7 * 5);
    assert!(place.join("watched/8.png/overlay.png").is_file());
    let words = rodlab(place, line).success();
    let words = String::from_utf8_lossy(&words.get_output().stdout).into_owned();
    assert!(
        words.ends_with("unstable from frames/14.png on\n"),
        "{words}"
    );

    fs::write(
        place.join("wrong.toml"),
        HELIX.replace("torsion", "torsoin"),
    )
    .expect("a file");
    fs::write(
        place.join("none.toml"),
        HELIX.replace("0.02, \"4.5", "\"2 kg\", \"4.5"),
    )
    .expect("a file");
    for (helix, more, expected) in [
        ("wrong.toml", "", "torsion"),
        ("none.toml", "", "none.toml:4"),
        ("helix.toml", " --lower 20mm", "lower"),
        ("helix.toml", " --gate 0", "--gate"),
        ("absent.toml", "", "absent.toml"),
    ] {
        let line = format!("measure markers frames --cell camera.toml --helix {helix}{more}");
        let failed = rodlab(place, &line).code(2);
        assert!(
            said(&failed).contains(expected),
            "{line}: {}",
            said(&failed)
        );
    }
}

/// A record of a ROS 1 bag.
fn record(fields: &[(&str, &[u8])], data: &[u8]) -> Vec<u8> {
    let mut header = Vec::new();
    for (name, value) in fields {
        header.extend(((name.len() + 1 + value.len()) as u32).to_le_bytes());
        header.extend(name.as_bytes());
        header.push(b'=');
        header.extend(*value);
    }
    let mut record = (header.len() as u32).to_le_bytes().to_vec();
    record.extend(header);
    record.extend((data.len() as u32).to_le_bytes());
    record.extend(data);
    record
}

/// A bag with some pictures on a topicone second apart.
fn bag(pictures: &[image::RgbImage]) -> Vec<u8> {
    const MAGIC: &[u8] = b"#ROSBAG V2.0\n";
    let text = |text: &str| [&(text.len() as u32).to_le_bytes()[..], text.as_bytes()].concat();
    let connection = record(
        &[("op", &[7]), ("conn", &[0; 4]), ("topic", b"/camera/color")],
        &text("type=sensor_msgs/Image"),
    );
    let mut body = connection.clone();
    for (second, picture) in (10u32..).zip(pictures) {
        let mut data = vec![0; 12];
        data.extend(text("camera"));
        data.extend(
            [picture.height(), picture.width()]
                .map(u32::to_le_bytes)
                .concat(),
        );
        data.extend(text("rgb8"));
        data.push(0);
        data.extend((3 * picture.width()).to_le_bytes());
        data.extend((picture.as_raw().len() as u32).to_le_bytes());
        data.extend(picture.as_raw());
        let time = [second.to_le_bytes(), [0; 4]].concat();
        body.extend(record(
            &[("op", &[2]), ("conn", &[0; 4]), ("time", &time)],
            &data,
        ));
    }
    let head = |index: u64| {
        let fields = [("op", &[3][..]), ("index_pos", &index.to_le_bytes())];
        [MAGIC, &record(&fields, b"")].concat()
    };
    let index = (head(0).len() + body.len()) as u64;
    [head(index), body, connection].concat()
}

#[test]
fn recordings_are_traced_picture_by_picture() {
    let folder = TempDir::new().expect("a folder");
    let place = folder.path();
    let picture = |row: u32| {
        image::RgbImage::from_fn(120, 90, |u, v| {
            let inside = v.abs_diff(row) < 4 && (10..110).contains(&u);
            image::Rgb(if inside { [200, 60, 70] } else { [10, 10, 10] })
        })
    };
    let whole = bag(&[picture(20), picture(40), picture(60)]);
    fs::write(place.join("scene.bag"), &whole).expect("a bag");
    fs::write(place.join("cut.bag"), &whole[..whole.len() / 2]).expect("a bag");
    fs::write(place.join("new.db3"), "SQLite format 3").expect("a file");
    let answer = json(&rodlab(place, "trace scene.bag --every 2 --out traced --json").success());
    let pictures = answer.as_array().expect("pictures");
    assert_eq!(pictures.len(), 2);
    assert_eq!(pictures[1]["time_s"], 2.0);
    let start = &pictures[1]["strands"][0]["start_px"][1];
    assert!(
        (start.as_f64().expect("a number") - 60.0).abs() < 0.5,
        "{start}"
    );
    assert!(place.join("traced/picture_000002/overlay.png").is_file());
    for (line, expected) in [
        ("trace scene.bag --topic /depth", "/camera/color"),
        ("trace cut.bag", "cut.bag"),
        ("trace new.db3", "rosbags-convert"),
        ("trace new.db3 --topic /depth", "--topic"),
    ] {
        let failed = rodlab(place, line).code(2);
        assert!(
            said(&failed).contains(expected),
            "{line}: {}",
            said(&failed)
        );
    }
}

#[test]
fn the_front_page_shows_what_trace_draws() {
    let folder = TempDir::new().expect("a folder");
    let photograph = repository().join("scenarios/photographs/rods.jpg");
    let line = format!("trace {} --out traced", photograph.display());
    rodlab(folder.path(), &line).success();
    let read = |path: PathBuf| decode_picture(&fs::read(path).expect("a file")).expect("a picture");
    let drawn = read(folder.path().join("traced/overlay.png"));
    let shown = read(repository().join("results/reproduced/trace_rods.png"));
    assert_eq!(
        drawn, shown,
        "copy traced/overlay.png to results/reproduced/trace_rods.png"
    );
}

#[test]
fn patterns_may_be_drawings() {
    let folder = TempDir::new().expect("a folder");
    let place = folder.path();
    let svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"100mm\" height=\"50mm\" viewBox=\"0 0 100 50\">\
        <path d=\"M 0 25 H 100\"/><path d=\"M 0 0 V 50\"/></svg>";
    fs::write(place.join("lines.svg"), svg).expect("a drawing");
    let rows: String = (0..=60)
        .map(|k| format!("{},0.027\n", 0.002 * f64::from(k) - 0.01))
        .collect();
    fs::write(place.join("laid.csv"), format!("x_m,y_m\n{rows}")).expect("a curve");
    // The rod begins 10 mm before the pattern, ends 10 mm beyond it, and is 2 mm beside it.
    let line = "score laid.csv lines.svg --stroke 1 --begin 10mm --json";
    let answer = json(&rodlab(place, line).success());
    let mean = answer["by_arc_length"]["mean_m"].as_f64().expect("a mean");
    assert!((mean - 0.002).abs() < 1e-9, "{answer}");
    // 120 mm count as the whole of a rod of 122 mm, but not of one of 125 mm.
    let whole = json(&rodlab(place, &format!("{line} --rod-length 122mm")).success());
    assert!((whole["seen_length"]["seen_m"].as_f64().unwrap() - 0.12).abs() < 1e-9);
    let part = rodlab(place, &format!("{line} --rod-length 125mm")).code(4);
    assert!(said(&part).contains("not seen whole") && said(&part).contains("125.0 mm"));
    for (line, expected) in [
        ("score laid.csv lines.svg", "2 strokes"),
        ("score laid.csv lines.svg --stroke 3", "no stroke 3"),
        ("score laid.csv laid.txt", ".svg or .csv file"),
        (
            "score laid.csv lines.svg --stroke 1 --begin 30mm",
            "too short for a pattern",
        ),
    ] {
        let failed = rodlab(place, line).code(2);
        assert!(
            said(&failed).contains(expected),
            "{line}: {}",
            said(&failed)
        );
    }
}
