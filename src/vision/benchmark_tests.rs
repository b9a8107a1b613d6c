//! The images of the public benchmark, if the shared data is present.

use super::*;
use std::fs;
use std::path::{Path, PathBuf};

/// Images of rods and their true labels, next to the checkout.
fn benchmark() -> Option<PathBuf> {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
        .join("../shared/vision/mbest_sample");
    if !folder.is_dir() {
        eprintln!("skipped: {} is not there", folder.display());
    }
    folder.is_dir().then_some(folder)
}

#[test]
fn strands_of_the_public_benchmark_are_found() {
    let Some(folder) = benchmark() else {
        return;
    };
    // Mean instance Dice of the authors' released code on its 300 images.
    for (set, least) in [(1, 0.966), (2, 0.958), (3, 0.961)] {
        let (mut sum, mut count) = (0.0, 0.0);
        for number in [0, 21, 42, 63, 84] {
            let name = format!("S{set}_img{number}");
            let picture = read_picture(&folder.join(format!("{name}.jpg"))).expect("a picture");
            let truth = fs::read(folder.join(format!("{name}_gt.png"))).expect("a label image");
            let truth = decode_labels(&truth).expect("labels");
            let found = trace(&picture, &TraceOptions::default()).expect("strands");
            assert_eq!(found.strands.len(), set, "{name}");
            for point in found.strands.iter().flat_map(|strand| &strand.points) {
                let inside = point.x > -1.0 && point.y > -1.0 && point.x < 672.0 && point.y < 896.0;
                assert!(inside, "{name}: {point} lies outside of the picture");
            }
            let dice = instance_dice(&found.labels, &truth).expect("the same size");
            println!("{name}: mean instance Dice {:.4}", dice.mean);
            assert!(dice.mean > 0.95, "{name}: {dice:?}");
            sum += dice.mean;
            count += 1.0;
        }
        let mean = sum / count;
        println!("S{set}: {mean:.4}");
        assert!(mean >= least, "S{set}: {mean}");
    }
}
