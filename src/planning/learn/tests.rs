//! Tests of training and of model files.

use super::*;
use rand_pcg::Pcg64;
use rand_pcg::rand_core::SeedableRng;
use rodlab_engine::random::sobol;
use std::path::Path;

/// A smooth function of two numbers at Sobol' points.
fn samples(count: u64, first: u64) -> Samples {
    let mut samples = Samples {
        input_width: 2,
        output_width: 2,
        ..Samples::default()
    };
    for number in first..first + count {
        let [a, b] = sobol(number);
        samples.inputs.extend([3.0 * a, b - 4.0]);
        samples
            .outputs
            .extend([(2.0 * a).sin() * b, 100.0 + 5.0 * a - b * b]);
    }
    samples
}

fn plan() -> Plan {
    Plan {
        hidden: vec![32, 32],
        batch: [16, 128],
        rates: [3e-3, 1e-4],
        patience: 8,
        ..Plan::default()
    }
}

fn trainer(plan: &Plan) -> Trainer {
    let names = ["from", "to"].map(|word| vec![format!("{word}_1"), format!("{word}_2")]);
    Trainer::new(
        plan.clone(),
        "smooth",
        names,
        &[],
        &samples(1200, 0),
        Processor::Cpu,
    )
    .unwrap()
}

fn trained(plan: &Plan) -> Trainer {
    let mut trainer = trainer(plan);
    let standing = trainer.train::<ModelError>(&mut |_| true, &mut |_| Ok(()));
    assert_eq!(standing.unwrap(), Standing::Finished);
    trainer
}

/// A model of one round, with these hidden layers.
fn small_model(hidden: &[usize]) -> Model {
    let plan = Plan {
        hidden: hidden.to_vec(),
        most_epochs: 1,
        ..plan()
    };
    trained(&plan).model(&[]).unwrap()
}

/// A training that resumes an interrupted one.
fn resumed(plan: &Plan, stopped: &Trainer) -> Trainer {
    let mut trainer = trainer(plan);
    let model = stopped.model(&[]).unwrap();
    trainer
        .resume(&model, stopped.epochs().to_vec(), stopped.next_phase())
        .unwrap();
    trainer
        .train::<ModelError>(&mut |_| true, &mut |_| Ok(()))
        .unwrap();
    trainer
}

#[test]
fn a_smooth_function_is_learned_from_its_values() {
    let model = trained(&plan()).model(&[]).unwrap();
    let others = samples(500, 5000);
    let errors = evaluate(
        &model,
        &others,
        &[
            Compared {
                quantity: "both",
                components: |_, to| [to[0], to[1], 0.0],
            },
            Compared {
                quantity: "one",
                components: |_, to| [to[0], 0.0, 0.0],
            },
        ],
    )
    .unwrap();
    assert!(errors[0].mean < 0.03, "{errors:?}");
    assert!(errors[1].mean <= errors[0].mean && errors[0].largest < 0.5);
    assert_eq!(errors[0].sizes.len(), 500);
    let below = |size: &&f64| **size < errors[0].percentile_95;
    assert_eq!(errors[0].sizes.iter().filter(below).count(), 475);
    // At the inputs of the largest error it is as large as that.
    let at = &errors[0].largest_at;
    let row = (0..500).find(|row| others.input(*row) == at).unwrap();
    let predicted = model.predict(at).unwrap();
    let exact = others.output(row);
    let size = libm::hypot(predicted[0] - exact[0], predicted[1] - exact[1]);
    assert!((size / errors[0].largest - 1.0).abs() < 1e-3, "{size}");
}

/// The error of the best network is that of the rows that it was not trained with, in their standard deviations.
#[test]
fn the_least_error_is_that_of_the_rows_held_back_and_the_range_that_of_all() {
    let plan = Plan {
        most_epochs: 2,
        ..plan()
    };
    let trainer = trained(&plan);
    let model = trainer.model(&[]).unwrap();
    let all = samples(1200, 0);
    let [kept, held] = all.split(trainer::HELD_BACK, plan.seed);
    let error = |rows: &Samples| {
        let predicted = model.predict(&rows.inputs).unwrap();
        let deviations = model.about.output_scaling.deviation.iter().cycle();
        let pairs = predicted.iter().zip(&rows.outputs).zip(deviations);
        let sizes = pairs.map(|((one, other), deviation)| (one - other).abs() / deviation);
        sizes.sum::<f64>() / rows.outputs.len() as f64
    };
    let least = trainer.least_error().unwrap();
    let [of_held, of_kept] = [&held, &kept].map(error);
    assert!((of_held / least - 1.0).abs() < 1e-4, "{of_held} {least}");
    assert!((of_kept / least - 1.0).abs() > 1e-3, "{of_kept} {least}");
    for (numbers, range) in [
        (&all.inputs, &model.about.range),
        (&all.outputs, &model.about.output_range),
    ] {
        for (column, ends) in range.iter().enumerate() {
            let column = || numbers.iter().copied().skip(column).step_by(2);
            assert!(column().all(|number| (ends[0]..=ends[1]).contains(&number)));
            assert!(ends.iter().all(|end| column().any(|number| number == *end)));
        }
    }
}

#[test]
fn the_same_seed_gives_the_same_network() {
    let bytes = |seed| {
        let plan = Plan {
            seed,
            most_epochs: 3,
            ..plan()
        };
        trained(&plan).model(&[]).unwrap().to_bytes().unwrap()
    };
    assert_eq!(bytes(1), bytes(1));
    assert_ne!(bytes(1), bytes(2));
}

#[test]
fn training_resumes_where_it_was_stopped() {
    let mut trainer_a = trainer(&plan());
    let mut left = 3;
    let standing = trainer_a.train::<ModelError>(
        &mut |_| {
            left -= 1;
            left > 0
        },
        &mut |_| Ok(()),
    );
    assert_eq!(standing.unwrap(), Standing::Stopped);
    assert_eq!((trainer_a.next_phase(), trainer_a.epochs().len()), (0, 3));
    let reached = trainer_a.least_error().unwrap();

    let trainer_b = resumed(&plan(), &trainer_a);
    assert!(trainer_b.epochs().len() > 3);
    assert!(trainer_b.least_error().unwrap() < 0.5 * reached);
}

#[test]
fn batches_grow_and_steps_shrink_from_phase_to_phase() {
    let phases = Plan::default().phases();
    assert_eq!(phases.len(), 10);
    let adam: Vec<&Phase> = phases
        .iter()
        .filter(|phase| phase.method == Method::Adam)
        .collect();
    let batches: Vec<usize> = adam.iter().map(|phase| phase.batch).collect();
    assert_eq!(batches, [128, 256, 512, 1024, 2048]);
    assert!(adam.windows(2).all(|pair| pair[1].rate < pair[0].rate));
}

#[test]
fn a_rate_falls_along_a_cosine_over_all_phases() {
    let plan = Plan {
        schedule: Schedule::Cosine,
        batch: [128, 512],
        rates: [4e-3, 1.0],
        most_epochs: 100,
        ..Plan::default()
    };
    let phases = plan.phases();
    let decay = |phase: &Phase| phase.decay.unwrap();
    let rounds: usize = phases.iter().map(|phase| decay(phase).rounds).sum();
    assert_eq!((phases.len(), rounds), (3, 100));
    assert!(phases.iter().all(|phase| phase.method == Method::Adam));
    assert_eq!(phases[0].rate_after(0.0), 4e-3);
    for pair in phases.windows(2) {
        let end = pair[0].rate_after(decay(&pair[0]).rounds as f64);
        assert!((end - pair[1].rate_after(0.0)).abs() < 1e-15);
    }
    // Half of the rate half way through, zero at the end.
    assert!((phases[1].rate_after(17.0) - 2e-3).abs() < 1e-15);
    assert!(phases[2].rate_after(decay(&phases[2]).rounds as f64) < 1e-15);
}

#[test]
fn along_a_cosine_as_many_rounds_are_trained_as_were_asked_for() {
    let plan = Plan {
        schedule: Schedule::Cosine,
        most_epochs: 40,
        ..plan()
    };
    let whole = trained(&plan);
    assert_eq!(whole.epochs().len(), 40);
    let first = whole.epochs()[0].held_back;
    assert!(whole.least_error().unwrap() < 0.3 * first);

    let mut stopped = trainer(&plan);
    let standing =
        stopped.train::<ModelError>(&mut |trainer| trainer.epochs().len() < 15, &mut |_| Ok(()));
    assert_eq!(standing.unwrap(), Standing::Stopped);
    let again = resumed(&plan, &stopped);
    assert_eq!(again.epochs().len(), 40);
}

/// Outputs with a larger weight are learned better.
#[test]
fn weights_say_which_errors_matter() {
    let plan = Plan {
        schedule: Schedule::Cosine,
        most_epochs: 15,
        ..plan()
    };
    let names = ["from", "to"].map(|word| vec![format!("{word}_1"), format!("{word}_2")]);
    let errors = |weights: &[f64]| {
        let data = samples(1200, 0);
        let mut trainer = Trainer::new(
            plan.clone(),
            "s",
            names.clone(),
            weights,
            &data,
            Processor::Cpu,
        )
        .unwrap();
        trainer
            .train::<ModelError>(&mut |_| true, &mut |_| Ok(()))
            .unwrap();
        let model = trainer.model(&[]).unwrap();
        let one = |quantity, components| Compared {
            quantity,
            components,
        };
        let compared = [
            one("first", |_, to| [to[0], 0.0, 0.0]),
            one("second", |_, to| [to[1], 0.0, 0.0]),
        ];
        let errors = evaluate(&model, &samples(500, 5000), &compared).unwrap();
        errors[0].mean / errors[1].mean
    };
    assert!(errors(&[10.0, 1.0]) < errors(&[1.0, 10.0]));
}

/// Gradients of the library compared with differences, through all layers.
#[test]
fn gradients_are_those_of_the_error() {
    use candle_core::{Device, Tensor};
    let network = Network::new(&[2, 8, 8, 1], &mut Pcg64::seed_from_u64(3), &Device::Cpu).unwrap();
    let rows = Tensor::new(&[[0.3_f32, -1.2], [0.8, 0.4], [-0.5, 0.9]], &Device::Cpu).unwrap();
    let error = |network: &Network| {
        let outputs = network.forward(&rows).unwrap();
        outputs
            .affine(1.0, -0.7)
            .unwrap()
            .abs()
            .unwrap()
            .mean_all()
            .unwrap()
    };
    let gradients = error(&network).backward().unwrap();
    for variable in network.variables() {
        let gradient = gradients.get(&variable).unwrap().flatten_all().unwrap();
        let gradient: Vec<f32> = gradient.to_vec1().unwrap();
        let numbers: Vec<f32> = variable.flatten_all().unwrap().to_vec1().unwrap();
        for entry in [0, numbers.len() - 1] {
            let at = |step: f32| {
                let mut moved = numbers.clone();
                moved[entry] += step;
                let moved = Tensor::from_vec(moved, variable.dims(), &Device::Cpu).unwrap();
                variable.set(&moved).unwrap();
                error(&network).to_scalar::<f32>().unwrap()
            };
            let difference = (at(1e-2) - at(-1e-2)) / 2e-2;
            at(0.0);
            assert!(
                (difference - gradient[entry]).abs() < 2e-3,
                "{difference} {}",
                gradient[entry]
            );
        }
    }
}

#[test]
fn a_model_comes_back_from_its_file() {
    let plan = Plan {
        most_epochs: 2,
        ..plan()
    };
    let model = trained(&plan).model(&[("seed", "0".to_owned())]).unwrap();
    let bytes = model.to_bytes().unwrap();
    let again = Model::from_bytes(Path::new("a"), &bytes, "smooth").unwrap();
    assert_eq!(again.about, model.about);
    let inputs = samples(20, 40).inputs;
    assert_eq!(
        again.predict(&inputs).unwrap(),
        model.predict(&inputs).unwrap()
    );
    assert!(
        model.covers(&[1.5, -3.5])
            && !model.covers(&[3.5, -3.5])
            && !model.covers(&[f64::NAN, -3.5])
    );
}

fn fault(bytes: &[u8]) -> String {
    let read = Model::from_bytes(Path::new("model.safetensors"), bytes, "smooth");
    read.map(|_| ()).unwrap_err().to_string()
}

#[test]
fn files_that_are_not_models_are_reported_with_their_kind() {
    let bytes = small_model(&[32, 32]).to_bytes().unwrap();
    for length in [0, 5, 200, bytes.len() - 1] {
        let said = fault(&bytes[..length]);
        assert!(
            said.contains("not a whole safetensors file"),
            "{length}: {said}"
        );
    }
    let read = Model::from_bytes(Path::new("m"), &bytes, "other").unwrap_err();
    assert!(
        read.to_string()
            .contains("model of `smooth`; a model of `other`"),
        "{read}"
    );
    let text = |from: &str, to: &str| {
        assert_eq!(from.len(), to.len());
        let at = bytes
            .windows(from.len())
            .position(|part| part == from.as_bytes());
        let at = at.expect("the words are in the file");
        let mut changed = bytes.clone();
        changed[at..at + to.len()].copy_from_slice(to.as_bytes());
        fault(&changed)
    };
    assert!(text("\\\"version\\\":2", "\\\"version\\\":7").contains("version 7"));
    assert!(text("multilayer", "multipayer").contains("is not a model of rodlab"));
    assert!(text("\"__metadata__\"", "\"__metadota__\"").contains("model.safetensors"));
    assert!(text("layer.1.bias", "layer.1.bios").contains("is inconsistent"));
    assert!(text("[32,32]", "[64,16]").contains("is inconsistent"));
    assert!(text("from_2", "from\\2").contains("model.safetensors"));
}

/// A file with changed JSON text in its metadata.
fn with_text(bytes: &[u8], change: impl Fn(&mut serde_json::Value)) -> Vec<u8> {
    let length = u64::from_le_bytes(bytes[..8].try_into().unwrap()) as usize;
    let mut header: serde_json::Value = serde_json::from_slice(&bytes[8..8 + length]).unwrap();
    let text = header["__metadata__"]["rodlab"].as_str().unwrap();
    let mut about: serde_json::Value = serde_json::from_str(text).unwrap();
    change(&mut about);
    header["__metadata__"]["rodlab"] = about.to_string().into();
    let header = serde_json::to_vec(&header).unwrap();
    [
        &(header.len() as u64).to_le_bytes(),
        &header[..],
        &bytes[8 + length..],
    ]
    .concat()
}

#[test]
fn a_file_with_any_number_changed_is_refused_as_damaged() {
    let bytes = small_model(&[3]).to_bytes().unwrap();
    let data = 8 + u64::from_le_bytes(bytes[..8].try_into().unwrap()) as usize;
    for at in data..bytes.len() {
        // Flips the lowest bit of any byte: the numbers stay finite, and most of them are nearly
        // the same.
        let mut changed = bytes.clone();
        changed[at] ^= 1;
        assert!(fault(&changed).contains("is damaged: its checksum"), "{at}");
    }
    let changed = with_text(&bytes, |about| {
        about["output_scaling"]["mean"][0] = 1e3.into();
    });
    assert!(fault(&changed).contains("is damaged"));
    let changed = with_text(&bytes, |about| {
        about["range"][0] = vec![-1e9, 1e9].into();
    });
    assert!(fault(&changed).contains("is damaged"));
}

#[test]
fn only_files_of_the_earlier_version_may_lack_a_checksum() {
    let model = small_model(&[32, 32]);
    let bytes = model.to_bytes().unwrap();
    let without = with_text(&bytes, |about| {
        about.as_object_mut().unwrap().remove("checksum");
    });
    assert!(fault(&without).contains("no checksum"));
    let old = with_text(&without, |about| about["version"] = 1.into());
    let read = Model::from_bytes(Path::new("a"), &old, "smooth").unwrap();
    let inputs = samples(20, 40).inputs;
    assert_eq!(
        read.predict(&inputs).unwrap(),
        model.predict(&inputs).unwrap()
    );
    // When written again, the file has the current version and a checksum.
    assert_eq!(read.to_bytes().unwrap(), bytes);
}

/// Any changed bytes give a result or an error, never a panic.
#[test]
fn damaged_files_do_not_panic() {
    let bytes = small_model(&[3]).to_bytes().unwrap();
    let mut random = Pcg64::seed_from_u64(1);
    use rand_pcg::rand_core::Rng;
    for _ in 0..5000 {
        let mut changed = bytes.clone();
        for _ in 0..1 + random.next_u32() % 4 {
            let at = random.next_u64() as usize % changed.len();
            changed[at] = random.next_u32() as u8;
        }
        if random.next_u32() % 4 == 0 {
            changed.truncate(random.next_u64() as usize % changed.len());
        }
        let _ = Model::from_bytes(Path::new("m"), &changed, "smooth");
    }
}

#[test]
fn samples_are_read_by_the_names_of_their_columns() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("samples.csv");
    std::fs::write(&path, "b,a,y\n1,2,3\n4,5,\n7,8,9\n").unwrap();
    let read = Samples::read(&path, &["a", "b"], &["y"]).unwrap();
    assert_eq!(read.inputs, [2.0, 1.0, 8.0, 7.0]);
    assert_eq!(read.outputs, [3.0, 9.0]);
    let fault = Samples::read(&path, &["c"], &["y"])
        .unwrap_err()
        .to_string();
    assert!(
        fault.ends_with("there is no column `c`; there are b, a, y"),
        "{fault}"
    );
    std::fs::write(&path, "a,y\n1,2\nx,3\n").unwrap();
    let fault = Samples::read(&path, &["a"], &["y"])
        .unwrap_err()
        .to_string();
    assert!(
        fault.ends_with("line 3: `a` is \"x\", not a finite number"),
        "{fault}"
    );
}

#[test]
fn a_share_is_held_back_and_nothing_is_lost() {
    let all = samples(100, 0);
    let [kept, held] = all.split(0.2, 7);
    assert_eq!((kept.rows(), held.rows()), (80, 20));
    let mut sums: Vec<f64> = [kept, held]
        .iter()
        .flat_map(|part| part.inputs.clone())
        .collect();
    let mut expected = all.inputs.clone();
    sums.sort_by(f64::total_cmp);
    expected.sort_by(f64::total_cmp);
    assert_eq!(sums, expected);
}
