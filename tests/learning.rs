//! `rodlab dataset`, `train`, `evaluate` and plans with a network, from outside.

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn rodlab(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rodlab"))
        .current_dir(folder)
        .args(arguments)
        .output()
        .unwrap()
}

fn done(folder: &Path, arguments: &[&str]) -> Value {
    let output = rodlab(folder, arguments);
    let fault = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {fault}");
    serde_json::from_slice(&output.stdout).unwrap_or(Value::Null)
}

/// Error message of a command that rejects its arguments.
fn refused(folder: &Path, arguments: &[&str]) -> String {
    let output = rodlab(folder, arguments);
    let fault = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {fault}");
    fault
}

const SAMPLES: &str = "experiment = \"grasp-samples\"
[grasp_samples]
points = { kind = \"sobol\", count = 600 }
suspended_length = { from = 1, to = 30 }
curvature = { from = 0, to = 1 }
";

/// A separate folder with samples.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("grasps.toml"), SAMPLES).unwrap();
    done(folder.path(), &["dataset", "grasps.toml"]);
    folder
}

const SMALL: [&str; 11] = [
    "train",
    "results/grasps",
    "--out",
    "network",
    "--hidden",
    "48,48",
    "--schedule",
    "plateau",
    "--patience",
    "4",
    "--json",
];

/// A model of version 1, which has no checksum, with weights so large that its answers overflow.
fn with_huge_weights(model: &[u8]) -> Vec<u8> {
    let length = u64::from_le_bytes(model[..8].try_into().unwrap()) as usize;
    let mut header: Value = serde_json::from_slice(&model[8..8 + length]).unwrap();
    let about = header["__metadata__"]["rodlab"].as_str().unwrap();
    let mut about: Value = serde_json::from_str(about).unwrap();
    about["version"] = 1.into();
    about.as_object_mut().unwrap().remove("checksum");
    header["__metadata__"]["rodlab"] = about.to_string().into();
    let mut header = header.to_string();
    header += &" ".repeat(header.len().next_multiple_of(8) - header.len());
    let weights = model[8 + length..]
        .chunks(4)
        .flat_map(|_| 3e38_f32.to_le_bytes());
    let mut huge = (header.len() as u64).to_le_bytes().to_vec();
    huge.extend(header.bytes());
    huge.extend(weights);
    huge
}

#[test]
fn networks_are_trained_evaluated_and_used() {
    let folder = folder();
    let folder = folder.path();
    let table = fs::read_to_string(folder.join("results/grasps/samples.csv")).unwrap();
    assert_eq!(table.lines().count(), 601);

    let trained = done(folder, &SMALL);
    assert_eq!(trained["status"], "finished");
    assert_eq!(trained["samples"], 600);
    for file in [
        "model.safetensors",
        "training.csv",
        "training.svg",
        "training.json",
    ] {
        assert!(folder.join("network").join(file).exists(), "{file}");
    }
    // Running the command again does nothing, and gives the same result.
    let bytes = fs::read(folder.join("network/model.safetensors")).unwrap();
    assert_eq!(done(folder, &SMALL), trained);
    assert_eq!(
        fs::read(folder.join("network/model.safetensors")).unwrap(),
        bytes
    );

    let others = [
        "dataset",
        "grasps.toml",
        "--set",
        "grasp_samples.points.first=5000",
        "--set",
        "grasp_samples.curvature.to=1.2",
        "--out",
        "others",
    ];
    done(folder, &others);
    let model = "network/model.safetensors";
    let judged = done(
        folder,
        &["evaluate", model, "others", "--out", "errors.svg", "--json"],
    );
    assert!(folder.join("errors.svg").exists());
    assert!(judged["out_of_range"].as_u64().unwrap() > 50);
    let mean = |index: usize| judged["errors"][index]["mean"].as_f64().unwrap();
    // A small network trained with few samples has errors of a tenth of the spread of positions
    // and a quarter of that of rotations.
    assert!(mean(0) < 0.3 && mean(1) < 0.2, "{judged}");

    fs::write(
        folder.join("huge.safetensors"),
        with_huge_weights(&fs::read(folder.join(model)).unwrap()),
    )
    .unwrap();
    let message = refused(folder, &["evaluate", "huge.safetensors", "results/grasps"]);
    assert!(message.contains("are not finite"), "{message}");

    let plan = |solver: &[&str]| {
        let rod = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/rods/green_vps.toml");
        let arguments = [
            "plan",
            "deployment",
            "--pattern",
            "circle:0.1",
            "--rod",
            rod,
            "--out",
            "plan",
        ];
        done(folder, &[&arguments, solver].concat())
    };
    let exact = plan(&[]);
    assert_eq!(
        (&exact["solver"], &exact["solved_exactly"]),
        (&Value::from("exact"), &Value::Null)
    );
    let own = plan(&["--solver", "neural", "--model", model]);
    assert_eq!(own["poses"], exact["poses"]);
    assert!(own["solved_exactly"].as_u64().unwrap() < own["poses"].as_u64().unwrap() / 4);
    assert!(
        !folder.join("plan/landing.toml").exists()
            || own["files"].to_string().find("landing").is_none()
    );
    let built_in = plan(&["--solver", "neural"]);
    assert!(built_in["files"].to_string().contains("landing.toml"));
    let landing = fs::read_to_string(folder.join("plan/landing.toml")).unwrap();
    assert!(landing.contains("solver = \"neural\""));
    done(folder, &["check", "plan/landing.toml", "--json"]);
}

#[test]
fn a_stopped_training_resumes() {
    let folder = folder();
    let folder = folder.path();
    let stopped = rodlab(folder, &[&SMALL[..], &["--timeout", "0"]].concat());
    assert_eq!(stopped.status.code(), Some(5));
    let left: Value = serde_json::from_slice(&stopped.stdout).unwrap();
    assert_eq!(left["status"], "stopped");
    assert_eq!(left["epochs"], 1);
    let finished = done(folder, &SMALL);
    assert_eq!(finished["status"], "finished");
    let other = refused(folder, &[&SMALL[..], &["--seed", "3"]].concat());
    assert!(
        other.contains("how the network is trained") && other.contains("--force"),
        "{other}"
    );
    done(
        folder,
        &[
            &SMALL[..],
            &["--seed", "3", "--most-epochs", "2", "--force"],
        ]
        .concat(),
    );
}

#[test]
fn a_training_replaces_only_its_own_files() {
    let folder = folder();
    let folder = folder.path();
    let own = folder.join("network");
    let forced = [&SMALL[..], &["--force"]].concat();
    fs::create_dir_all(&own).unwrap();
    fs::write(own.join("model.safetensors"), "precious").unwrap();
    fs::write(own.join("training.json"), "{\"my\": \"state\"}").unwrap();
    for arguments in [&SMALL[..], &forced] {
        let message = refused(folder, arguments);
        assert!(message.contains("training.json"), "{message}");
        assert!(!message.contains("--force"), "{message}");
    }
    fs::remove_file(own.join("training.json")).unwrap();
    fs::remove_file(own.join("model.safetensors")).unwrap();
    let stopped = rodlab(folder, &[&SMALL[..], &["--timeout", "0"]].concat());
    assert_eq!(stopped.status.code(), Some(5));
    for name in ["model.safetensors", "training.csv", "training.svg"] {
        let written = fs::read(own.join(name)).unwrap();
        fs::write(own.join(name), "precious").unwrap();
        for arguments in [&SMALL[..], &forced] {
            assert!(refused(folder, arguments).contains(name), "{name}");
            assert_eq!(fs::read(own.join(name)).unwrap(), b"precious");
        }
        fs::write(own.join(name), written).unwrap();
    }
    done(folder, &forced);
}

/// A training that was killed while its first files were written used to leave a folder that later
/// runs rejected.
#[test]
fn a_training_that_was_killed_at_its_start_starts_again() {
    let folder = folder();
    let folder = folder.path();
    let own = folder.join("network");
    let place = own.join(".rodlab-unfinished-a1b2c3");
    fs::create_dir_all(&own).unwrap();
    fs::write(&place, "{").unwrap();
    let stopped = rodlab(folder, &[&SMALL[..], &["--timeout", "0"]].concat());
    assert_eq!(stopped.status.code(), Some(5));
    let record = own.join("training.json");
    let mut begun: Value = serde_json::from_slice(&fs::read(&record).unwrap()).unwrap();
    begun["epochs"] = 0.into();
    begun["next_phase"] = 0.into();
    fs::write(&record, begun.to_string()).unwrap();
    let model = fs::read(own.join("model.safetensors")).unwrap();
    fs::write(own.join("model.safetensors"), &model[..model.len() / 2]).unwrap();
    assert_eq!(done(folder, &SMALL)["status"], "finished");
}

/// A network learns folds with Adam and a cosine schedule. The path of the gripper over the
/// learned manifold is nearly the exact one.
#[test]
fn learned_folds_are_used_in_plans() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let scenario = "experiment = \"fold-samples\"
[fold_samples]
points = { kind = \"sobol\", count = 3000 }
suspended_length = { from = 0.9, to = 4.7 }
";
    fs::write(folder.join("folds.toml"), scenario).unwrap();
    done(folder, &["dataset", "folds.toml"]);
    let table = fs::read_to_string(folder.join("results/folds/samples.csv")).unwrap();
    assert_eq!(table.lines().count(), 3001);
    let figure = fs::read_to_string(folder.join("results/folds/samples.svg")).unwrap();
    assert!(figure.contains("<svg"));
    let again = ["plot", "results/folds"];
    done(folder, &again);

    let train = [
        "train",
        "results/folds",
        "--out",
        "network",
        "--hidden",
        "64,64",
        "--most-epochs",
        "60",
        "--batch",
        "32",
        "--last-batch",
        "128",
        "--json",
    ];
    let trained = done(folder, &train);
    assert_eq!(
        (&trained["status"], &trained["epochs"]),
        (&Value::from("finished"), &Value::from(60))
    );
    let rounds = fs::read_to_string(folder.join("network/training.csv")).unwrap();
    let held_back = |row: &str| row.rsplit(',').next().unwrap().parse::<f64>().unwrap();
    let (first, last) = (
        rounds.lines().nth(1).unwrap(),
        rounds.lines().last().unwrap(),
    );
    assert!(held_back(last) < 0.25 * held_back(first), "{first} {last}");

    let model = "network/model.safetensors";
    let others = [
        "dataset",
        "folds.toml",
        "--set",
        "fold_samples.points.first=5000",
        "--set",
        "fold_samples.points.count=500",
        "--out",
        "others",
    ];
    done(folder, &others);
    let judged = done(folder, &["evaluate", model, "others", "--json"]);
    let errors = judged["errors"].as_array().unwrap();
    let named: Vec<&str> = errors
        .iter()
        .map(|error| error["quantity"].as_str().unwrap())
        .collect();
    assert_eq!(
        named,
        ["lambda", "alpha in rad", "suspended length in L_gb"]
    );
    assert!(errors[1]["mean"].as_f64().unwrap() < 0.05, "{judged}");

    let letter = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/scenarios/papers/us_letter.toml"
    );
    let base = [
        "plan", "fold", "--paper", letter, "--crease", "half", "--out", "plan",
    ];
    let exact = done(folder, &base);
    let neural = [&base[..], &["--solver", "neural", "--model", model]].concat();
    let learned = done(folder, &neural);
    assert_eq!(
        (&exact["solver"], &learned["solver"]),
        (&Value::from("exact"), &Value::from("neural"))
    );
    let integral = |plan: &Value| plan["integral"].as_f64().unwrap();
    assert!(integral(&learned) < 1.2 * integral(&exact), "{learned}");
    assert!(integral(&learned) > 0.95 * integral(&exact), "{learned}");

    // Sheets outside the training range, networks for other purposes, and incompatible options.
    fs::remove_dir_all(folder.join("plan")).unwrap();
    let a4 = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/papers/a4.toml");
    let mut other = neural.clone();
    other[3] = a4;
    let said = refused(folder, &other);
    assert!(
        said.contains("trained for suspended lengths from 0.9") && said.contains("to 6.18"),
        "{said}"
    );
    let grasps = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/results/models/grasps.safetensors"
    );
    let mut other = neural.clone();
    other[11] = grasps;
    let said = refused(folder, &other);
    assert!(
        said.contains("is a model of `grasp-samples`; a model of `fold-samples`"),
        "{said}"
    );
    let said = refused(folder, &["evaluate", grasps, "others"]);
    assert!(
        said.contains("a model of `fold-samples` is needed"),
        "{said}"
    );
    for (more, why) in [
        (&["--model", model][..], "--model is for --solver neural"),
        (&["--solver", "neural"], "needs --model"),
        (
            &[
                "--solver",
                "neural",
                "--model",
                model,
                "--objective",
                "friction",
            ],
            "--objective friction is for --solver exact",
        ),
    ] {
        let said = refused(folder, &[&base[..], more].concat());
        assert!(said.contains(why), "{said}");
    }
    assert!(!folder.join("plan").exists());
}

#[test]
fn invalid_samples_and_models_are_rejected_by_name() {
    let folder = folder();
    let folder = folder.path();
    let scene = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/scenarios/heavy_cantilever.toml"
    );
    let said = refused(folder, &["dataset", scene]);
    assert!(
        said.contains("makes no samples; those that do: grasp-samples, fold-samples"),
        "{said}"
    );
    assert!(refused(folder, &["train", ".", "--out", "n"]).contains("not a results directory"));
    assert!(
        refused(folder, &["train", "results/grasps", "--out", "."])
            .contains("does not hold a training")
    );
    let few = [
        "dataset",
        "grasps.toml",
        "--set",
        "grasp_samples.points.count=40",
        "--out",
        "few",
    ];
    done(folder, &few);
    assert!(
        refused(folder, &["train", "few", "--out", "n"]).contains("has 40 samples; at least 50")
    );
    assert!(!folder.join("n").exists());

    fs::write(
        folder.join("text.safetensors"),
        "no tensors at all, but words",
    )
    .unwrap();
    let said = refused(folder, &["evaluate", "text.safetensors", "results/grasps"]);
    assert!(
        said.contains("text.safetensors is not a whole safetensors file"),
        "{said}"
    );
    let plan = [
        "plan",
        "deployment",
        "--pattern",
        "line:0.3",
        "--rod",
        "rod.toml",
        "--out",
        "p",
    ];
    let rod = "[deployment.rod]\ngravito_bending_length = 0.03\nradius = 0.0016\nlength = 0.8\n";
    fs::write(folder.join("rod.toml"), rod).unwrap();
    let neural = ["--solver", "neural", "--model", "text.safetensors"];
    let said = refused(folder, &[&plan[..], &neural].concat());
    assert!(said.contains("not a whole safetensors file"), "{said}");
    let said = refused(folder, &[&plan[..], &neural[2..]].concat());
    assert!(said.contains("--model is for --solver neural"), "{said}");
    assert!(!folder.join("p").exists());
}
