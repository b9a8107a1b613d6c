//! Passes the commit to the program, so that results state it, and the files of `scenarios`, its presets.
//!
//! Reads the files of the `.git` of a clone, without calling a program or the network. Without `.git`, as in a package, the
//! commit is unknown. Only release builds contain the commit: others would be rebuilt at every commit. Builds
//! elsewhere can set the environment variable `RODLAB_COMMIT`.

use std::fs;
use std::path::{Path, PathBuf};

const COMMIT: &str = "RODLAB_COMMIT";

fn main() {
    println!("cargo:rerun-if-changed=scripts/build.rs");
    list_presets();
    println!("cargo:rerun-if-env-changed={COMMIT}");
    let is_release = std::env::var("PROFILE").is_ok_and(|profile| profile == "release");
    if !is_release || std::env::var_os(COMMIT).is_some() {
        return;
    }
    if let Some(commit) = git_directory().and_then(|git| commit(&git)) {
        println!("cargo:rustc-env={COMMIT}={commit}");
    }
}

/// Writes the expression for the slice of all files of `scenarios`: paths below it, sorted, with their contents.
fn list_presets() {
    println!("cargo:rerun-if-changed=scenarios");
    let variable = |name| PathBuf::from(std::env::var_os(name).expect("set by cargo"));
    let scenarios = variable("CARGO_MANIFEST_DIR").join("scenarios");
    let mut files = Vec::new();
    list(&scenarios, &mut files);
    files.sort();
    let lines = files.iter().map(|file| {
        let below = file.strip_prefix(&scenarios).expect("listed there");
        let parts: Vec<_> = below.iter().map(|part| part.to_string_lossy()).collect();
        format!(
            "({:?}, include_bytes!({file:?}) as &[u8]),\n",
            parts.join("/")
        )
    });
    let expression = format!("&[\n{}]", lines.collect::<String>());
    fs::write(variable("OUT_DIR").join("presets.rs"), expression).expect("OUT_DIR can be written");
}

/// Adds the files below a folder except documentation.
fn list(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder)
        .expect("a folder of the package")
        .flatten()
    {
        let path = entry.path();
        if path.is_dir() {
            list(&path, files);
        } else if path.extension().is_some_and(|ending| ending != "md") {
            files.push(path);
        }
    }
}

/// The folder `.git`, or that of a further working tree, which a file `.git` names.
fn git_directory() -> Option<PathBuf> {
    let place = PathBuf::from(std::env::var_os("CARGO_MANIFEST_DIR")?).join(".git");
    if place.is_dir() {
        return Some(place);
    }
    let text = fs::read_to_string(&place).ok()?;
    let named = text.strip_prefix("gitdir:")?.trim();
    Some(place.parent()?.join(named))
}

/// The commit that is checked out.
fn commit(git: &Path) -> Option<String> {
    // Git adds a line there at every commit and checkout.
    let _ = watched(&git.join("logs/HEAD"));
    let head = watched(&git.join("HEAD"))?;
    let Some(reference) = head.trim().strip_prefix("ref:").map(str::trim) else {
        return hash(&head);
    };
    // Branches of further working trees are stored with those of the first.
    let common = fs::read_to_string(git.join("commondir")).ok();
    let common = common.map_or_else(|| git.to_owned(), |path| git.join(path.trim()));
    let loose = watched(&common.join(reference));
    loose.as_deref().and_then(hash).or_else(|| {
        let packed = watched(&common.join("packed-refs"))?;
        let line = packed
            .lines()
            .find(|line| line.split(' ').nth(1) == Some(reference));
        hash(line?.split(' ').next()?)
    })
}

/// Returns the text of a file; a change of the file triggers a build.
fn watched(path: &Path) -> Option<String> {
    let text = fs::read_to_string(path).ok()?;
    println!("cargo:rerun-if-changed={}", path.display());
    Some(text)
}

/// A hash, if the text is one.
fn hash(text: &str) -> Option<String> {
    let text = text.trim();
    let is_hash = text.len() >= 40 && text.bytes().all(|byte| byte.is_ascii_hexdigit());
    is_hash.then(|| text.to_owned())
}
