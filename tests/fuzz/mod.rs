//! Every reader gets damaged input. It must accept or reject the input, without a panic, a hang,
//! or excessive memory.
//!
//! Inputs are mutants of files in the repository: lines and numbers of scenarios, options, tables,
//! drawings, pictures, checkpoints and manifests are removed, duplicated, exchanged, or replaced
//! by values that typing errors and disks may produce. The same number of cases gives the same
//! mutants on every machine. `RODLAB_FUZZ_CASES=1000000 cargo test --release fuzz::` runs more
//! than the ten thousand cases of continuous integration. `RODLAB_FUZZ_PART=3/16` runs every
//! sixteenth case, starting with number 3 (counted from 0).

mod robots;

use rodlab::experiment::{
    case_set, case_set_from_text, derived_numbers, from_text, prepare, try_scene,
};
use rodlab::mechanics::dynamics::SimulationError;
use rodlab::plan::pattern::{Pattern, read_svg};
use rodlab::results::{
    CheckpointFiles, Manifest, read_branches, read_end_state, read_nodes, read_series,
    scenario_hash,
};
use rodlab::run::{PreparedRun, RunError, RunOptions, run};
use rodlab::scenario::read_polyline;
use rodlab::sweep::check_every_value;
use rodlab::vision::{
    Camera, TraceOptions, decode_labels, decode_picture, read_curve, read_poses, trace,
};
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Number of cases for all readers together, unless the environment variable sets another number.
const CASES: usize = 10_000;
const VARIABLE: &str = "RODLAB_FUZZ_CASES";
const PART_VARIABLE: &str = "RODLAB_FUZZ_PART";
/// Longest time for a reader to process one input while other tests keep the cores busy. Five
/// cases with knots of 600 nodes take a second of processor time each.
const LONGEST: Duration = Duration::from_secs(20);
/// Largest memory of the process, bytes.
const MOST_MEMORY: u64 = 4 << 30;
/// One in this number of accepted scenarios is set up.
const SET_UP_EVERY: usize = 20;

/// SplitMix64 (Steele, Lea, Flood 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, count: usize) -> usize {
        (self.next() % count.max(1) as u64) as usize
    }

    fn one_of<'a, T: ?Sized>(&mut self, all: &[&'a T]) -> &'a T {
        all[self.below(all.len())]
    }
}

/// Values that replace others.
const VALUES: [&str; 36] = [
    "0",
    "-1",
    "1",
    "2",
    "3",
    "0.0",
    "-0.0",
    "1e-300",
    "1e-9",
    "1e300",
    "1e308",
    "-1e308",
    "nan",
    "inf",
    "-inf",
    "9223372036854775807",
    "-9223372036854775808",
    "4096",
    "100000",
    "1e400",
    "true",
    "false",
    "\"\"",
    "\"1.6 mm\"",
    "\"5 furlongs\"",
    "\"-3 MPa\"",
    "\"auto\"",
    "\"imc\"",
    "\"none\"",
    "[]",
    "{}",
    "[0, 0, 0]",
    "[[0, 0, 0]]",
    "{ from = 0, to = 1, count = 3 }",
    "\"/dev/zero\"",
    "\"\u{1b}[2J\u{0}\"",
];

/// Replaces bytes by other bytes, a few times.
fn damaged(bytes: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..=random.below(3) {
        let at = random.below(bytes.len());
        match random.below(5) {
            _ if bytes.is_empty() => bytes.push(random.next() as u8),
            0 => bytes[at] ^= 1 << random.below(8),
            1 => bytes[at] = random.next() as u8,
            2 => drop(bytes.remove(at)),
            3 => bytes.insert(at, random.next() as u8),
            _ => bytes.truncate(at),
        }
    }
    bytes
}

/// Replaces lines and values by others, a few times; occasionally damages bytes.
fn mutant(text: &str, other: &str, random: &mut Random) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    for _ in 0..=random.below(3) {
        let (at, to) = (random.below(lines.len()), random.below(lines.len() + 1));
        match random.below(8) {
            _ if lines.is_empty() => lines.push("[x]".to_owned()),
            0 => drop(lines.remove(at)),
            1 => lines.insert(to, lines[at].clone()),
            2 => {
                let last = lines.len() - 1;
                lines.swap(at, to.min(last));
            }
            3 => {
                let strange: Vec<&str> = other.lines().collect();
                lines.insert(to, random.one_of(&strange).to_owned());
            }
            _ => lines[at] = with_another_value(&lines[at], random),
        }
    }
    let text = lines.join("\n");
    if random.below(8) == 0 {
        return String::from_utf8_lossy(&damaged(text.as_bytes(), random)).into_owned();
    }
    text
}

/// Replaces a number in a line by another value, or its whole value.
fn with_another_value(line: &str, random: &mut Random) -> String {
    let value = random.one_of(&VALUES);
    let is_number = |c: char| c.is_ascii_digit() || ".-+e".contains(c);
    let mut numbers = Vec::new();
    let mut start = None;
    for (index, c) in line.char_indices().chain([(line.len(), ' ')]) {
        match (is_number(c), start) {
            (true, None) => start = Some(index),
            (false, Some(from)) => {
                if line[from..index].parse::<f64>().is_ok() {
                    numbers.push((from, index));
                }
                start = None;
            }
            _ => {}
        }
    }
    if !numbers.is_empty() && random.below(4) > 0 {
        let (from, to) = numbers[random.below(numbers.len())];
        return format!("{}{value}{}", &line[..from], &line[to..]);
    }
    match line.split_once('=') {
        Some((key, _)) => format!("{key}= {value}"),
        None => format!("{line}{value}"),
    }
}

fn repository() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The texts of all files of a folder with an extension.
fn texts(folder: &str, ending: &str) -> Vec<String> {
    let mut paths: Vec<PathBuf> = fs::read_dir(repository().join(folder))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|found| found == ending))
        .collect();
    paths.sort();
    paths
        .iter()
        .map(|path| fs::read_to_string(path).unwrap())
        .collect()
}

/// The first case of this process, and the step to its next case; other processes run the
/// remaining cases.
fn part() -> (usize, usize) {
    let Ok(text) = std::env::var(PART_VARIABLE) else {
        return (0, 1);
    };
    let numbers = text.split_once('/');
    let numbers = numbers.and_then(|(first, all)| Some((first.parse().ok()?, all.parse().ok()?)));
    numbers.expect("a part such as 3/16")
}

/// Feeds a share of all cases to a reader. `read` creates the input of a case and reads it; it
/// returns a description of the input and the outcome.
fn feed(reader: &str, share: f64, mut read: impl FnMut(&mut Random) -> (String, Outcome)) -> usize {
    let all = std::env::var(VARIABLE).ok();
    let all = all.map_or(CASES, |text| text.parse().expect("a number of cases"));
    let count = (share * all as f64) as usize;
    let (first, stride) = part();
    let name = reader
        .bytes()
        .fold(0, |sum: u64, byte| 31 * sum + u64::from(byte));
    let mut accepted = 0;
    for case in (first..count).step_by(stride) {
        let mut random = Random(name.wrapping_add((case as u64) << 20));
        let start = Instant::now();
        let read = catch_unwind(AssertUnwindSafe(|| read(&mut random)));
        let Ok((input, outcome)) = read else {
            panic!("{reader}: case {case} panics");
        };
        let took = start.elapsed();
        assert!(
            took < LONGEST,
            "{reader}: case {case} takes {took:?}\n{input}"
        );
        assert!(
            outcome != Outcome::Contradicted,
            "{reader}: case {case}\n{input}"
        );
        accepted += usize::from(outcome == Outcome::Accepted);
    }
    let memory = peak_memory();
    assert!(memory < MOST_MEMORY, "{reader}: {memory} bytes");
    assert!(
        count < 1000 || accepted < count,
        "{reader}: everything is accepted"
    );
    accepted
}

#[derive(Clone, Copy, PartialEq)]
enum Outcome {
    Accepted,
    Refused,
    /// Accepted by one reader and rejected by another one.
    Contradicted,
}

impl<T, E> From<Result<T, E>> for Outcome {
    fn from(result: Result<T, E>) -> Self {
        result.map_or(Self::Refused, |_| Self::Accepted)
    }
}

/// Largest resident memory of the process so far, bytes; 0 if the operating system does not report
/// it.
fn peak_memory() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kilobytes = line.and_then(|line| line.trim().trim_end_matches(" kB").parse::<u64>().ok());
    1024 * kilobytes.unwrap_or_default()
}

/// The result of `check` for the text of a scenario.
fn checked(text: &str, directory: &Path) -> Result<Option<PreparedRun>, String> {
    let cases = case_set_from_text("mutant", text, directory).map_err(|error| error.to_string())?;
    if cases.count() > 1000 {
        return Ok(None);
    }
    let prepared = if cases.is_sweep() {
        check_every_value(&cases).map_err(|error| error.to_string())?
    } else {
        let loaded = cases.scenario_of(0).map_err(|error| error.to_string())?;
        prepare(&loaded.scenario).map_err(|issues| loaded.locate(issues).to_string())?
    };
    let nodes: usize = prepared
        .scene
        .rods
        .iter()
        .map(|rod| rod.centreline.len())
        .sum();
    // Large scenarios are not different, but take longer.
    if nodes > 2000 {
        return Ok(None);
    }
    try_scene(&prepared).map_err(|error| error.to_string())?;
    derived_numbers(&prepared);
    Ok((!cases.is_sweep()).then_some(prepared))
}

/// The reason if a run rejects, before its first step, a scenario that `check` has accepted.
fn is_refused(prepared: &PreparedRun) -> Option<String> {
    let directory = tempfile::tempdir().unwrap();
    let options = RunOptions {
        deadline: Some(Instant::now()),
        progress: false,
        ..RunOptions::new(directory.path().join("run"))
    };
    match run(prepared, &options) {
        Err(error @ (RunError::Scene(_) | RunError::Results(_))) => Some(error.to_string()),
        Err(RunError::Simulation {
            source: SimulationError::BadScene(error),
            ..
        }) => Some(error.to_string()),
        _ => None,
    }
}

#[test]
fn scenarios_accepted_by_check_run_without_panics() {
    let corpus = texts("scenarios", "toml");
    let scenarios = repository().join("scenarios");
    let mut accepted = 0;
    let found = feed("scenario", 0.3, |random| {
        let [one, other] = [random.below(corpus.len()), random.below(corpus.len())];
        let text = mutant(&corpus[one], &corpus[other], random);
        let outcome = match checked(&text, &scenarios) {
            Err(_) => Outcome::Refused,
            Ok(None) => Outcome::Accepted,
            Ok(Some(prepared)) => {
                accepted += 1;
                let tried = accepted % SET_UP_EVERY == 0;
                match tried.then(|| is_refused(&prepared)).flatten() {
                    Some(error) => return (format!("{error}\n{text}"), Outcome::Contradicted),
                    None => Outcome::Accepted,
                }
            }
        };
        (text, outcome)
    });
    assert!(found > 0);
}

#[test]
fn overrides_do_not_panic() {
    let base = fs::read_to_string(repository().join("scenarios/heavy_cantilever.toml")).unwrap();
    let keys = [
        "rods.beam.radius=7 mm",
        "rods.0.shape={ kind = \"straight\", start = [0, 0, 0], end = [1, 0, 0] }",
        "clamps.0.at=end",
        "loads.0.acceleration=[0, 0, -9.81]",
        "time.mode=dynamic",
        "contact.model=ipc",
        "output.interval=0.1",
        "title=x",
    ];
    feed("set", 0.15, |random| {
        let typed = random.one_of(&keys);
        let text = match random.below(3) {
            0 => with_another_value(typed, random),
            _ => String::from_utf8_lossy(&damaged(typed.as_bytes(), random)).into_owned(),
        };
        let read = from_text("beam", &base, Path::new("."), std::slice::from_ref(&text));
        (text, read.into())
    });
    let scenario = repository().join("scenarios/heavy_cantilever.toml");
    let ranges = [
        "rods.beam.radius=2 mm:8 mm:1 mm",
        "rods.beam.edges=10,20,30",
        "rods.beam.radius=0.001:0.01:0.001",
    ];
    feed("vary", 0.15, |random| {
        let typed = random.one_of(&ranges);
        let text = match random.below(3) {
            0 => with_another_value(typed, random),
            _ => String::from_utf8_lossy(&damaged(typed.as_bytes(), random)).into_owned(),
        };
        let read = case_set(&scenario, &[], std::slice::from_ref(&text));
        let read = read.map(|cases| (cases.count() < 100).then(|| check_every_value(&cases)));
        (text, read.into())
    });
}

/// Writes an input to a file and reads it.
fn feed_file<T, E>(
    reader: &str,
    share: f64,
    name: &str,
    seeds: &[&[u8]],
    read: impl Fn(&Path) -> Result<T, E>,
) {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join(name);
    feed(reader, share, |random| {
        let seed = random.one_of(seeds);
        let bytes = match std::str::from_utf8(seed) {
            Ok(text) if random.below(2) == 0 => mutant(text, text, random).into_bytes(),
            _ => damaged(seed, random),
        };
        // Some file systems write an overwritten file to the disk at once, which takes
        // milliseconds.
        let _ = fs::remove_file(&path);
        fs::write(&path, &bytes).unwrap();
        let outcome = read(&path).into();
        (String::from_utf8_lossy(&bytes).into_owned(), outcome)
    });
}

const POINTS: &[u8] = b"# corners\nx_m,y_m,z_m\n0,0,0\n0.1,0,0\n0.2,0.05,0\n0.3,0.05,1e-3\n";
const POSES: &[u8] =
    b"time_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n1,0,0,0.1,0.7071,0.7071,0,0\n";
const CASES_TABLE: &[u8] = b"rods.beam.radius,rods.beam.edges\n1 mm,10\n0.002,20\n\"3 mm\",30\n";

#[test]
fn tables_of_scenarios_do_not_panic() {
    feed_file("points", 0.1, "points.csv", &[POINTS], read_polyline);
    let base = fs::read_to_string(repository().join("scenarios/heavy_cantilever.toml")).unwrap();
    let followed = base.replace("static", "dynamic\"\nend = 1.0\nstep = \"auto");
    feed_file("follow", 0.05, "poses.csv", &[POSES], |path| {
        let follow = ["clamps.0.follow=poses.csv".to_owned()];
        let loaded = from_text("beam", &followed, path.parent().unwrap(), &follow);
        loaded.map(|loaded| prepare(&loaded.scenario).is_ok())
    });
    let swept = format!("{base}\n[sweep]\npoints = \"cases.csv\"\n");
    feed_file("sweep points", 0.05, "cases.csv", &[CASES_TABLE], |path| {
        let cases = case_set_from_text("beam", &swept, path.parent().unwrap());
        cases.map(|cases| check_every_value(&cases).is_ok())
    });
}

#[test]
fn damaged_results_do_not_panic() {
    let directory = tempfile::tempdir().unwrap();
    let base = fs::read_to_string(repository().join("scenarios/heavy_cantilever.toml")).unwrap();
    let loaded = from_text("beam", &base, Path::new("."), &[]).unwrap();
    let options = RunOptions {
        progress: false,
        ..RunOptions::new(directory.path())
    };
    run(&prepare(&loaded.scenario).unwrap(), &options).unwrap();
    let file = |name: &str| fs::read(directory.path().join(name)).unwrap();
    let folder = |path: &Path| path.parent().unwrap().to_owned();
    let manifest = file("manifest.json");
    // Damaged files of a run with an intact manifest, and a damaged manifest.
    let marked = |name: &str| {
        let beside = tempfile::tempdir().unwrap();
        for entry in fs::read_dir(directory.path()).unwrap() {
            let entry = entry.unwrap();
            if entry.path().is_file() {
                fs::copy(entry.path(), beside.path().join(entry.file_name())).unwrap();
            }
        }
        let (written, place) = (file(name), beside.path().join(name));
        feed(&format!("marked {name}"), 0.005, |random| {
            let bytes = damaged(&written, random);
            fs::write(&place, &bytes).unwrap();
            let read = Manifest::read_checked(beside.path());
            let outcome = match (bytes == written, &read) {
                (false, Ok(Some(_))) if name != "manifest.json" => Outcome::Contradicted,
                _ => read.into(),
            };
            (String::from_utf8_lossy(&bytes).into_owned(), outcome)
        });
    };
    for name in [
        "manifest.json",
        "summary.csv",
        "end_state.csv",
        "scenario.toml",
    ] {
        marked(name);
    }
    feed_file("manifest", 0.04, "manifest.json", &[&manifest], |path| {
        Manifest::read(&folder(path))
    });
    feed_file(
        "series",
        0.03,
        "series.csv",
        &[&file("series.csv")],
        |path| read_series(&folder(path)),
    );
    feed_file("nodes", 0.03, "nodes.csv", &[&file("nodes.csv")], |path| {
        read_nodes(&folder(path), 51)
    });
    let branch = b"branch,parameter\n0,1.0\n";
    feed_file("branch", 0.01, "branch.csv", &[branch], |path| {
        read_branches(&folder(path))
    });
    feed_file(
        "end state",
        0.02,
        "end_state.csv",
        &[&file("end_state.csv")],
        |path| read_end_state(&fs::read(path).unwrap()),
    );
    let hash = scenario_hash("a = 1");
    type Payload = (u64, Vec<f64>, Option<String>);
    let payload: Payload = (7, vec![0.5; 40], Some("state".to_owned()));
    let at_work = tempfile::tempdir().unwrap();
    CheckpointFiles::new(at_work.path(), &hash)
        .write(&payload)
        .unwrap();
    let checkpoint = fs::read(at_work.path().join("checkpoint.0")).unwrap();
    feed_file("checkpoint", 0.03, "checkpoint.0", &[&checkpoint], |path| {
        let read = CheckpointFiles::new(&folder(path), &hash).read(|payload: Payload| Ok(payload));
        read.unwrap().ok_or(())
    });
}

#[test]
fn drawings_do_not_panic() {
    let drawings = texts("scenarios/patterns", "svg");
    let more = r#"<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="80mm" viewBox="0 0 120 80">
<g transform="translate(10 20) rotate(30, 5, 5) scale(1.5)">
<path d="M 10,10 C 20,0 30,20 40,10 S 60,0 70,10 Q 80,20 90,10 T 110,10"/>
<path d="m 0 0 h 10 v 10 a 5 7 30 1 0 10 10 l 5 -5 z"/>
</g>
<circle cx="30" cy="30" r="10"/>
<ellipse cx="50" cy="30" rx="10" ry="4" transform="matrix(1 0.2 -0.3 1 0 0) skewX(10)"/>
<rect x="1" y="2" width="30" height="10" rx="2"/>
<polyline points="0,0 10,5 20,-5"/>
<polygon points="0,0 10,5 20,-5"/>
<line x1="0" y1="0" x2="1cm" y2="1cm"/>
</svg>"#;
    let seeds: Vec<&str> = drawings.iter().map(String::as_str).chain([more]).collect();
    feed("svg", 0.05, |random| {
        let [one, other] = [random.one_of(&seeds), random.one_of(&seeds)];
        let text = match random.below(2) {
            0 => mutant(one, other, random),
            _ => String::from_utf8_lossy(&damaged(one.as_bytes(), random)).into_owned(),
        };
        let read = read_svg(&text);
        if let Ok(strokes) = &read
            && let Some(stroke) = strokes.first()
            && stroke.len() < 300
            && random.below(10) == 0
            && let Ok(pattern) = Pattern::along(stroke, 1e-3)
        {
            assert!(pattern.length().is_finite());
        }
        (text, read.into())
    });
}

#[test]
fn pictures_do_not_panic() {
    use image::{DynamicImage, GrayImage, ImageFormat, Luma, Rgb, RgbImage};
    let rod = RgbImage::from_fn(48, 32, |u, v| match (v as i64 - 16).abs() <= 3 {
        true if u > 4 => Rgb([200, 60, 70]),
        _ => Rgb([u as u8, 250, 240]),
    });
    let labels = GrayImage::from_fn(48, 32, |u, v| Luma([u8::from(u + v > 40)]));
    let encoded = |picture: DynamicImage, format: ImageFormat| {
        let mut bytes = std::io::Cursor::new(Vec::new());
        picture.write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    };
    let colour = DynamicImage::ImageRgb8(rod);
    let seeds = [
        encoded(colour.clone(), ImageFormat::Png),
        encoded(colour.clone(), ImageFormat::Jpeg),
        encoded(
            DynamicImage::ImageRgba16(colour.to_rgba16()),
            ImageFormat::Png,
        ),
        encoded(DynamicImage::ImageLuma8(labels), ImageFormat::Png),
    ];
    let seeds = seeds.each_ref().map(|seed| &seed[..]);
    feed("picture", 0.05, |random| {
        let bytes = damaged(random.one_of(&seeds), random);
        let read = decode_picture(&bytes);
        let _ = decode_labels(&bytes);
        if let Ok(picture) = &read
            && u64::from(picture.width()) * u64::from(picture.height()) < 10_000
        {
            let _ = trace(picture, &TraceOptions::default());
        }
        (format!("{bytes:?}"), read.into())
    });
    let camera = b"[camera]\nwidth = 640\nheight = 480\nfx = 500.0\nfy = 500.0\ncx = 320.0\ncy = 240.0\n\
        distortion = [0.0, 0.0, 0.0, 0.0, 0.0]\nposition = [0.0, 0.0, 1.0]\nquaternion = [0.0, 1.0, 0.0, 0.0]\n\
        table_height = 0.0\n";
    feed_file("camera", 0.01, "camera.toml", &[camera], Camera::read);
    let curve = b"strand,x_m,y_m\n1,0,0\n1,0.1,0\n2,0.2,0.1\n";
    feed_file("curve", 0.01, "curve.csv", &[curve], |path| {
        read_curve(path, None)
    });
    feed_file("poses", 0.01, "poses.csv", &[POSES], read_poses);
}
