//! `rodlab measure rod` on rendered photographs of rods with known properties.

use assert_cmd::Command;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use rodlab::mechanics::dynamics::{IntegrationParameters, Simulation};
use rodlab::mechanics::scene::{
    Clamp, Load, LoadKind, Motion, NaturalShape, RodDescription, Scene, Stiffness,
};
use rodlab::vision::{Camera, Lens, RenderOptions, RenderedRod, encode_picture, render};
use serde_json::Value;
use std::f64::consts::PI;
use std::fs;
use std::path::Path;

/// A rod in a photograph: gravito-bending length, length, radius (m), natural curvature (1/m),
/// direction at the clamp and rotation of the camera about its axes (rad).
struct Photograph {
    gravito_bending_length: f64,
    length: f64,
    radius: f64,
    curvature: f64,
    angle: f64,
    camera: [f64; 3],
}

const fn photograph(
    [gravito_bending_length, length, radius]: [f64; 3],
    [curvature, angle]: [f64; 2],
    camera: [f64; 3],
) -> Photograph {
    Photograph {
        gravito_bending_length,
        length,
        radius,
        curvature,
        angle,
        camera,
    }
}

const PHOTOGRAPHS: [Photograph; 10] = [
    photograph([0.10, 0.30, 1.5e-3], [0.0, 0.2], [0.0, 0.0, 0.0]),
    photograph([0.08, 0.30, 1.5e-3], [2.0, 0.5], [0.1, 0.0, 0.0]),
    photograph([0.12, 0.32, 2.0e-3], [-2.0, 0.6], [0.0, 0.1, 0.05]),
    photograph([0.15, 0.30, 2.0e-3], [0.0, 0.0], [-0.1, 0.05, 0.0]),
    photograph([0.06, 0.25, 1.2e-3], [3.0, 0.0], [0.05, 0.1, -0.05]),
    photograph([0.09, 0.28, 1.5e-3], [-4.0, 0.9], [0.1, -0.1, 0.1]),
    photograph([0.20, 0.35, 2.5e-3], [1.0, 0.1], [0.0, 0.15, 0.0]),
    photograph([0.07, 0.22, 1.2e-3], [0.0, 0.8], [0.15, 0.0, 0.02]),
    photograph([0.11, 0.26, 1.8e-3], [4.0, -0.2], [-0.05, -0.1, 0.0]),
    photograph([0.13, 0.34, 2.2e-3], [-1.0, 0.4], [0.1, 0.1, -0.1]),
];

/// Nodes of the rod in the plane z = 0, under gravity along −y.
fn hanging(photograph: &Photograph) -> Vec<Vector3<f64>> {
    turned(photograph, 1.0 / 1.5, 0.0)
}

/// Nodes of a rod with a ratio of twisting to bending stiffness, which is rotated about its axis
/// at the clamp, rad.
fn turned(photograph: &Photograph, twisting: f64, roll: f64) -> Vec<Vector3<f64>> {
    const EDGES: usize = 200;
    let (sine, cosine) = photograph.angle.sin_cos();
    let along = Vector3::new(cosine, sine, 0.0);
    let nodes = (0..=EDGES).map(|k| along * (photograph.length * k as f64 / EDGES as f64));
    let mass = 1100.0 * PI * photograph.radius.powi(2);
    let bending = 2.0 * mass * 9.81 * photograph.gravito_bending_length.powi(3);
    let stiffness = Stiffness {
        stretching: 4.0 * bending / photograph.radius.powi(2),
        bending: [bending; 2],
        twisting: twisting * bending,
    };
    let mut rod =
        RodDescription::uniform("rod", nodes.collect(), stiffness, photograph.radius, mass);
    rod.first_director =
        Some(Vector3::new(-sine, cosine, 0.0) * roll.cos() + Vector3::z() * roll.sin());
    rod.natural_shape = NaturalShape::Curved {
        curvature: [0.0, photograph.curvature],
        twist: 0.0,
    };
    let scene = Scene {
        rods: vec![rod],
        clamps: vec![Clamp {
            rod: 0,
            node: 0,
            holds_position: true,
            holds_frame: true,
            motion: Motion::default(),
        }],
        loads: vec![Load {
            kind: LoadKind::Gravity {
                acceleration: Vector3::new(0.0, -9.81, 0.0),
            },
            schedule: Vec::new(),
        }],
        ..Scene::default()
    };
    let mut simulation = Simulation::new(&scene, &IntegrationParameters::default()).unwrap();
    simulation.find_equilibrium().unwrap();
    simulation.positions().to_vec()
}

/// A camera that looks at a point of the plane z = 0 from 0.6 m.
fn camera(at: Vector3<f64>, [x, y, z]: [f64; 3]) -> Camera {
    let down = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI);
    let rotation = UnitQuaternion::from_euler_angles(x, y, z) * down;
    Camera {
        width: 960,
        height: 720,
        lens: Lens {
            focal: [1000.0, 998.0],
            centre: [478.0, 362.0],
            distortion: [0.03, -0.05, 0.0, 0.0, 0.0],
        },
        pose: Isometry3::from_parts(
            Translation3::from(at + rotation * Vector3::new(0.0, 0.0, -0.6)),
            rotation,
        ),
        table_height: 0.0,
    }
}

/// Writes a photograph of a rod, `name`.png, with its camera, `name`.toml. Returns the pixel of
/// the held end.
fn shoot(
    place: &Path,
    name: &str,
    nodes: &[Vector3<f64>],
    photograph: &Photograph,
    seed: u64,
) -> String {
    let (mut low, mut high) = (nodes[0], nodes[0]);
    for node in nodes {
        (low, high) = (low.inf(node), high.sup(node));
    }
    let middle = 0.5 * (low + high);
    let camera = camera(Vector3::new(middle.x, middle.y, 0.0), photograph.camera);
    fs::write(place.join(name).with_extension("toml"), camera.to_toml()).unwrap();
    // The wall is behind the rod.
    let wall = Camera {
        table_height: -3.0 * photograph.radius,
        ..camera
    };
    // The points are closer together than the radius.
    let points = nodes.windows(2).flat_map(|pair| {
        (0..4).map(|part| pair[0] + (pair[1] - pair[0]) * (f64::from(part) / 4.0))
    });
    let rod = RenderedRod {
        points: points.chain(nodes.last().copied()).collect(),
        radius: photograph.radius,
        colour: [190, 40, 35],
    };
    let options = RenderOptions {
        seed,
        ..RenderOptions::default()
    };
    let picture = render(&wall, &[rod], |_| [225.0, 222.0, 215.0], &options);
    fs::write(
        place.join(name).with_extension("png"),
        encode_picture(&picture),
    )
    .unwrap();
    let held = wall.project(nodes[0]).unwrap();
    format!("{:.0},{:.0}", held.x, held.y)
}

/// The answer of `rodlab measure rod`.
fn answer(place: &Path, arguments: &[&str]) -> Value {
    let output = Command::cargo_bin("rodlab")
        .unwrap()
        .current_dir(place)
        .args(["measure", "rod"])
        .args(arguments)
        .args(["--colour", "red"])
        .output()
        .unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {error}");
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Measures one photograph; returns the relative error of the length, and the error divided by the
/// standard error.
fn measure(number: usize, photograph: &Photograph) -> [f64; 2] {
    let folder = tempfile::tempdir().unwrap();
    let nodes = hanging(photograph);
    shoot(
        folder.path(),
        "photo",
        &nodes,
        photograph,
        number as u64 + 1,
    );
    let answer = answer(folder.path(), &["photo.png", "--camera", "photo.toml"]);
    let of = |key: &str| answer[key].as_f64().unwrap_or(f64::NAN);
    let truth = photograph.gravito_bending_length;
    let found = of("gravito_bending_length_m");
    let sigma = of("uncertainty_m");
    let relative = found / truth - 1.0;
    let over_error = (found - truth) / sigma;
    println!(
        "{number}: L_gb {truth} m: {:+.2} %, error bar {:.2} %, {over_error:+.1} σ; length {:+.2} mm, radius {:+.1} %, curvature {:.2} ± {:.2} of {}, misfit {:.3} mm",
        100.0 * relative,
        100.0 * sigma / truth,
        1e3 * (of("length_m") - photograph.length),
        100.0 * (of("radius_m") / photograph.radius - 1.0),
        of("natural_curvature_per_m"),
        of("natural_curvature_uncertainty_per_m"),
        photograph.curvature,
        1e3 * of("misfit_m")
    );
    [relative, over_error]
}

#[test]
fn the_gravito_bending_length_of_a_rod_is_found_from_its_photograph() {
    let full = std::env::var("RODLAB_TESTS_FULL").is_ok_and(|value| value == "1");
    let count = if full { PHOTOGRAPHS.len() } else { 1 };
    let photographs = PHOTOGRAPHS.iter().enumerate().take(count);
    let found: Vec<[f64; 2]> = photographs
        .map(|(number, one)| measure(number, one))
        .collect();
    for (number, [relative, over_error]) in found.into_iter().enumerate() {
        assert!(relative.abs() < 0.01, "{number}: {relative}");
        assert!(over_error.abs() < 3.0, "{number}: {over_error}");
    }
}

#[test]
fn the_twisting_stiffness_of_a_rod_is_found_from_two_photographs() {
    let one = photograph([0.12, 0.3, 1.5e-3], [5.0, 0.3], [0.0, 0.0, 0.0]);
    let truth = 0.9;
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    let front = shoot(place, "front", &turned(&one, truth, 0.0), &one, 1);
    let side = shoot(place, "side", &turned(&one, truth, 0.5 * PI), &one, 2);
    // In the photograph of the planar rod, the free end is the higher one, so that the held end
    // must be given.
    let pictures = ["front.png", "side.png", "--camera", "front.toml,side.toml"];
    let held = ["--held", front.as_str(), "--held", side.as_str()];
    let found = answer(place, &[&pictures[..], &held, &["--roll", "0,90"]].concat());
    println!("{found:#}");
    let of = |key: &str| found[key].as_f64().unwrap();
    let (twisting, error) = (
        of("twisting_over_bending"),
        of("twisting_over_bending_uncertainty"),
    );
    // The ends of the rod are located to half its radius; an error of the length of a thousandth
    // gives several per cent here.
    assert!((twisting / truth - 1.0).abs() < 0.1, "{twisting}");
    assert!(
        (twisting - truth).abs() < 3.0 * error && error < 0.25,
        "{twisting} ± {error}"
    );
    assert!((of("gravito_bending_length_m") / 0.12 - 1.0).abs() < 0.01);
    // Two copies of one photograph determine only a planar shape.
    let pictures = ["front.png", "front.png", "--camera", "front.toml"];
    let held = ["--held", front.as_str(), "--held", front.as_str()];
    let found = answer(place, &[&pictures[..], &held].concat());
    assert!(found["twisting_over_bending"].is_null(), "{found}");
    assert!(
        found["remarks"].to_string().contains("--roll 0,90"),
        "{found}"
    );
}
