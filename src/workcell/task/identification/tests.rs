//! Tests of the identification of unknown rods in rendered pictures.

use super::candidate::hand;
use super::pose::HoldRequest;
use super::strand::{directions, strand};
use crate::test_cells::gantry;
use crate::virtual_cell::{Scenery, picture};
use rodlab_lab::identify::{HeldRod, HeldView, IdentifiedKey, identify_held};
use rodlab_vision::ColourRule;

/// Unknown rods: gravito-bending length and radius, mm, ratio of the expected to the true length,
/// and natural curvatures, 1/m.
const RODS: [([f64; 3], [f64; 2]); 12] = [
    ([18.0, 1.6, 1.5], [0.0, 0.0]),
    ([32.0, 1.6, 1.5], [0.0, 0.0]),
    ([80.1, 1.6, 0.66], [0.0, 0.0]),
    ([25.0, 2.0, 0.8], [1.0, -2.0]),
    ([30.0, 1.0, 1.2], [0.0, 3.0]),
    ([40.0, 2.0, 1.4], [-2.0, 0.0]),
    ([45.0, 1.5, 0.7], [1.5, 1.5]),
    ([50.0, 2.5, 1.1], [0.0, 0.0]),
    ([55.0, 1.2, 0.9], [0.0, -1.0]),
    ([60.0, 2.0, 1.3], [1.0, 0.0]),
    ([65.0, 1.8, 0.75], [-1.0, 1.0]),
    ([22.0, 1.2, 1.0], [0.0, 0.0]),
];

/// Returns the length of a rod from three pictures, and its error in standard errors.
fn found(truth: [f64; 3], curvatures: [f64; 2]) -> (IdentifiedKey, f64) {
    let [unit, radius, factor] = [1e-3 * truth[0], 1e-3 * truth[1], truth[2]];
    let expected = factor * unit;
    let cell = gantry();
    let rod = HeldRod {
        title: "rod".into(),
        length: (4.0 * expected).max(40.0 * radius),
        radius,
        density: 1000.0,
        gravito_bending_length: expected,
    };
    let request = HoldRequest {
        cell: &cell,
        arm: 0,
        rod: &rod,
        margin: 0.01,
        speed: 0.1,
    };
    let (_, poses) = request.plan().unwrap();
    let camera = cell.camera.as_ref().unwrap();
    let camera = camera.seeing(cell.table_height());
    let views: Vec<HeldView> = (1..)
        .zip(&poses)
        .map(|(number, pose)| {
            let [heading, angle] = [pose.heading_deg, pose.angle_deg].map(f64::to_radians);
            let hand = hand(pose.position_m.into(), heading, angle);
            let nodes = rod.nodes(&hand, [unit, curvatures[0], curvatures[1]]);
            let scenery = Scenery {
                rods: vec![(nodes.unwrap(), radius, 0)],
                ..Scenery::default()
            };
            let shown = picture(&camera, scenery, number);
            let (_, points) = strand(&shown, &ColourRule::Background, &camera, &hand).unwrap();
            HeldView {
                picture: format!("look_{number}.png").into(),
                hand,
                camera: camera.pose,
                points: directions(&camera, &points),
            }
        })
        .collect();
    let (found, _) = identify_held(&rod, &views, &|| true).unwrap();
    assert!(found.converged);
    let length = found.parameters[0].clone();
    let off = (length.value - unit) / length.standard_error.unwrap();
    println!(
        "{:.1} mm: found {:.3} ± {:.3} mm, {:.2} %, {off:.1} errors; noise {:.1} µm",
        truth[0],
        1e3 * length.value,
        1e3 * length.standard_error.unwrap(),
        100.0 * (length.value / unit - 1.0),
        1e6 * found.groups[0].standard_deviation
    );
    (length, off)
}

#[test]
fn error_bars_of_rods_that_are_held_before_the_camera_cover_the_truth() {
    let count = match std::env::var_os("RODLAB_TESTS_FULL") {
        Some(_) => RODS.len(),
        None => 2,
    };
    let mut covered = 0;
    for ([unit, radius, factor], curvatures) in RODS.into_iter().take(count) {
        let (length, off) = found([unit, radius, factor], curvatures);
        assert!((1e3 * length.value / unit - 1.0).abs() < 0.01, "{length:?}");
        assert!(off.abs() < 3.5, "{length:?}");
        let [low, high] = length.interval_95.unwrap();
        covered += usize::from((low..=high).contains(&(1e-3 * unit)));
    }
    println!("{covered} of {count} covered");
    assert!(10 * covered >= 9 * count - 9, "{covered} of {count}");
}
