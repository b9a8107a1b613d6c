//! The results of a run do not depend on how the C library computes sines, exponentials and
//! logarithms. Runs are done twice; in the second one the last bit of every function of the C
//! library is wrong.

use crate::parts;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Functions that replace those of the C library, and a program that checks one of them.
const SOURCE: &str = r#"
use std::ffi::{c_char, c_void};

unsafe extern "C" {
    fn dlsym(handle: *mut c_void, name: *const c_char) -> *mut c_void;
}

/// RTLD_NEXT: the function of the next loaded library.
fn next(name: &std::ffi::CStr) -> *mut c_void {
    unsafe { dlsym(usize::MAX as *mut c_void, name.as_ptr()) }
}

macro_rules! of_one {
    ($($name:ident)*) => { $(
        #[cfg(library)]
        #[unsafe(no_mangle)]
        pub extern "C" fn $name(x: f64) -> f64 {
            let name = std::ffi::CString::new(stringify!($name)).unwrap();
            let exact: extern "C" fn(f64) -> f64 = unsafe { std::mem::transmute(next(&name)) };
            exact(x).next_up()
        }
    )* };
}

macro_rules! of_two {
    ($($name:ident)*) => { $(
        #[cfg(library)]
        #[unsafe(no_mangle)]
        pub extern "C" fn $name(x: f64, y: f64) -> f64 {
            let name = std::ffi::CString::new(stringify!($name)).unwrap();
            let exact: extern "C" fn(f64, f64) -> f64 = unsafe { std::mem::transmute(next(&name)) };
            exact(x, y).next_up()
        }
    )* };
}

of_one! { sin cos tan asin acos atan sinh cosh tanh asinh acosh atanh exp exp2 expm1 log log2 log10 log1p cbrt }
of_two! { atan2 pow hypot }

/// # Safety
/// Writes to `sine` and `cosine`.
#[cfg(library)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sincos(x: f64, sine: *mut f64, cosine: *mut f64) {
    unsafe {
        *sine = sin(x);
        *cosine = cos(x);
    }
}

#[cfg(not(library))]
fn main() {
    let _ = next;
    println!("{:?}", std::hint::black_box(1.0f64).sin());
}
"#;

/// The inexact library, after a check that it has an effect.
fn inexact_library() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("inexact");
    fs::create_dir_all(&folder).unwrap();
    let source = folder.join("inexact.rs");
    fs::write(&source, SOURCE).unwrap();
    let compiled = |name: &str, options: &[&str]| {
        let mut command = Command::new("rustc");
        command.args(["--edition", "2024", "-O", "--check-cfg", "cfg(library)"]);
        command.args(options).arg(&source);
        let path = folder.join(name);
        parts::succeeds(command.arg("-o").arg(&path)).then_some(path)
    };
    let library = compiled(
        "inexact.so",
        &["--crate-type", "cdylib", "--cfg", "library"],
    )?;
    let program = compiled("sine", &[])?;
    let shown = |preloaded: bool| {
        let mut command = Command::new(&program);
        if preloaded {
            command.env("LD_PRELOAD", &library);
        }
        command.output().unwrap().stdout
    };
    (shown(false) != shown(true)).then_some(library)
}

/// The tables of results without columns that depend on the machine.
fn tables(directory: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut found = Vec::new();
    for entry in fs::read_dir(directory).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(tables(&path));
        } else if path.extension().is_some_and(|ending| ending == "csv")
            && !path.ends_with("timings.csv")
        {
            found.push((path.clone(), fs::read(&path).unwrap()));
        }
    }
    found.sort();
    found
}

/// Short runs of everything that writes a summary: knots, fluid, contact, closed rods, swept
/// parameters, rotated clamps, and boundaries.
const RUNS: &[(&str, &[&str])] = &[
    ("twisted_ring.toml", &[]),
    (
        "flagella_quick.toml",
        &["--set", "time.end=0.2", "--set", "output.interval=0.1"],
    ),
    ("trefoil.toml", &["--set", "time.end=3"]),
    ("figure_eight.toml", &["--set", "time.end=1"]),
    ("reef.toml", &["--set", "time.end=1"]),
    ("inversion_n3.toml", &["--set", "time.end=1"]),
    ("three_twist.toml", &["--set", "time.end=1"]),
    ("driven_plectoneme.toml", &["--set", "time.end=1"]),
    ("elastic_pendulum.toml", &["--set", "time.end=0.5"]),
    ("rod_on_incline.toml", &["--set", "time.end=0.1"]),
    ("euler_column.toml", &[]),
    ("cantilever_sweep.toml", &[]),
    ("turned.toml", &[]),
    ("boundary.toml", &[]),
];

/// A helix whose end follows the poses of a gripperand which is pressed on a post, with
/// incremental potentials.
const TURNED: &str = r#"
experiment = "scene"
material = { youngs_modulus = "1 MPa", poissons_ratio = 0.3, density = 1200.0 }
time = { step = 0.001, end = 0.5 }
contact = { model = "ipc", friction = 0.3 }
output = { interval = 0.1 }
[[rods]]
name = "rod"
radius = "2 mm"
edges = 30
shape = { kind = "helix", start = [0, 0, 0], axis = [1, 0, 0], radius = 0.01, pitch = 0.1, turns = 2 }
[[rods]]
name = "post"
radius = "2 mm"
edges = 10
shape = { kind = "straight", start = [0.1, -0.05, -0.016], end = [0.1, 0.05, -0.016] }
[[clamps]]
rod = "post"
at = "start"
[[clamps]]
rod = "post"
at = "end"
[[clamps]]
rod = "rod"
at = "start"
poses = [[0, [0, 0, 0], [1, 0, 0, 0]], [0.3, [0.01, 0, 0], [0.96, 0, 0.28, 0]], [0.5, [0.01, 0.01, 0], [0.8, 0.48, 0, 0.36]]]
[[loads]]
kind = "gravity"
acceleration = [0, 0, -9.81]
"#;

const BOUNDARY: &str = r#"
experiment = "helix-stability"
[helix_stability]
edges = 40
extrapolate = true
largest_distance = 8
directions = { kind = "fibonacci", count = 40 }
section_directions = 7
"#;

#[test]
fn another_c_library_gives_the_same_bytes() {
    if !cfg!(all(target_os = "linux", target_env = "gnu")) {
        return parts::skipped("another C library: functions are exchanged for glibc only");
    }
    let Some(library) = inexact_library() else {
        return parts::skipped("another C library: rustc did not make one");
    };
    let folder = tempfile::tempdir().unwrap();
    for entry in fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios")).unwrap() {
        let path = entry.unwrap().path();
        if path.is_file() {
            fs::copy(&path, folder.path().join(path.file_name().unwrap())).unwrap();
        }
    }
    fs::write(folder.path().join("turned.toml"), TURNED).unwrap();
    fs::write(folder.path().join("boundary.toml"), BOUNDARY).unwrap();
    for (scenario, options) in RUNS {
        let results = |out: &str, preloaded: bool| {
            let mut command = Command::new(env!("CARGO_BIN_EXE_rodlab"));
            command.current_dir(folder.path());
            command
                .args(["-q", "run", scenario, "--out", out])
                .args(*options);
            if preloaded {
                command.env("LD_PRELOAD", &library);
            }
            let output = command.output().unwrap();
            let stderr = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(0), "{scenario}: {stderr}");
            let out = folder.path().join(out);
            let found = tables(&out);
            fs::remove_dir_all(&out).unwrap();
            found
        };
        let exact = results("results", false);
        let inexact = results("results", true);
        assert!(!exact.is_empty());
        assert_eq!(exact.len(), inexact.len());
        for ((path, one), (_, other)) in exact.iter().zip(&inexact) {
            assert!(one == other, "{scenario}: {} differs", path.display());
        }
    }
}
