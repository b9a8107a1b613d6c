//! Files for other programs: the model of a scene for MuJoCo, and a motion of 100 outputs for
//! viewers.

use criterion::{Criterion, criterion_group, criterion_main};
use rodlab::experiment;
use rodlab::figure::Tempo;
use rodlab::report::{ExportFormat, ExportRequest, mjcf, write_export};
use rodlab::run::{PreparedRun, RunOptions, run};
use std::path::Path;

/// A whip with a disk, which moves for 1 s.
fn whip() -> PreparedRun {
    let scenarios = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let path = scenarios.join("whip_with_disk.toml");
    let text = std::fs::read_to_string(path).expect("a shipped scenario");
    let keys = ["time.end=1.0", "output.interval=0.01", "output.nodes=true"];
    let keys = keys.map(str::to_owned);
    let loaded = experiment::from_text("whip", &text, &scenarios, &keys).expect("valid");
    experiment::prepare(&loaded.scenario).expect("a valid scene")
}

fn exports(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("export of a whip");
    group.sample_size(10);
    let whip = whip();
    group.bench_function("scene for MuJoCo", |bencher| {
        bencher.iter(|| mjcf(&whip).expect("a scene that MuJoCo can show"));
    });
    let directory = tempfile::tempdir().expect("a temporary directory");
    let mut options = RunOptions::new(directory.path().join("results"));
    options.progress = false;
    run(&whip, &options).expect("a run to its end");
    let formats = [
        ("glTF", ExportFormat::Gltf, "whip.glb"),
        ("USD", ExportFormat::Usd, "whip.usda"),
    ];
    for (name, format, file) in formats {
        let request = ExportRequest {
            format,
            case: None,
            outputs: 1000,
            tempo: Tempo { speed: 1.0 },
        };
        let file = directory.path().join(file);
        group.bench_function(format!("motion as {name}"), |bencher| {
            bencher.iter(|| write_export(&options.directory, &file, &request).expect("written"));
        });
    }
    group.finish();
}

criterion_group!(benches, exports);
criterion_main!(benches);
