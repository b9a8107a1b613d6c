//! The guide and the front page are correct: scenarios load, commands run, and links and pictures
//! exist.
//!
//! Words after the language of a code block determine its test:
//!
//! | block | what happens |
//! |---|---|
//! | `toml` | a whole scenario: loaded and prepared |
//! | `toml file:NAME` | the same, and written as `NAME` for the commands of the page |
//! | `toml extends:FILE` | keys laid over those of `FILE` |
//! | `toml after:FILE` | a continuation of the text of `FILE` |
//! | `toml cell` | keys of a cell file, no scenario |
//! | `sh` | commands, run in their order in one folder for each page |
//! | `sh set:KEY:VALUE` | run with `--set KEY=VALUE`, so that they end soon |
//! | `sh dry-run` | `rodlab run` with `--dry-run`, other commands not at all: they take too long |
//! | `sh not-run` | not run: they install something, need a cluster, or measure |
//!
//! A test in `cli` checks that every command line parses, whether it is run or not.

use rodlab::experiment::{case_set, prepare};
use rodlab::guide::PAGES;
use rodlab::scenario::Loaded;
use rodlab::sweep::check_every_value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const README: &str = include_str!("../README.md");
/// Longest front page, characters; users do not read longer ones.
const LONGEST_README: usize = 10_000;

/// A fenced block of code.
struct Block {
    language: String,
    words: Vec<String>,
    text: String,
}

impl Block {
    fn is(&self, language: &str) -> bool {
        self.language == language
    }

    fn says(&self, word: &str) -> bool {
        self.words.iter().any(|known| known == word)
    }

    /// The values of words with a key, such as `file:beam.toml`.
    fn values<'a>(&'a self, key: &'a str) -> impl Iterator<Item = &'a str> {
        self.words
            .iter()
            .filter_map(move |word| word.strip_prefix(key)?.strip_prefix(':'))
    }
}

fn blocks(markdown: &str) -> Vec<Block> {
    let mut blocks: Vec<Block> = Vec::new();
    let mut is_open = false;
    for line in markdown.lines() {
        if let Some(fence) = line.strip_prefix("```") {
            is_open = !is_open;
            if is_open {
                let mut words = fence.split_whitespace().map(str::to_owned);
                blocks.push(Block {
                    language: words.next().unwrap_or_default(),
                    words: words.collect(),
                    text: String::new(),
                });
            }
        } else if let Some(block) = blocks.last_mut().filter(|_| is_open) {
            block.text += line;
            block.text.push('\n');
        }
    }
    assert!(!is_open, "a block of code that does not end");
    blocks
}

/// A folder as the user has it: the scenarios of the repository, and the files that the page
/// defines.
fn folder(blocks: &[Block]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let scenarios = folder.path().join("scenarios");
    copy_folder(&repository().join("scenarios"), &scenarios);
    for block in blocks.iter().filter(|block| block.is("toml")) {
        for name in block.values("file") {
            fs::write(folder.path().join(name), &block.text).unwrap();
        }
    }
    folder
}

fn copy_folder(from: &Path, to: &Path) {
    fs::create_dir(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let (from, to) = entry
            .map(|entry| (entry.path(), to.join(entry.file_name())))
            .unwrap();
        if from.is_dir() {
            copy_folder(&from, &to);
        } else {
            fs::copy(from, to).unwrap();
        }
    }
}

fn repository() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The pages of the guide, and the front page.
fn pages() -> Vec<(String, &'static str)> {
    let guide = PAGES.iter().map(|page| (page.topic(), page.text));
    guide.chain([("README".to_owned(), README)]).collect()
}

/// Loads a scenario filewith all its cases, and builds their scenes.
fn load(path: &Path) -> Result<(), String> {
    let case_set = case_set(path, &[], &[]).map_err(|error| error.to_string())?;
    if case_set.is_sweep() {
        return check_every_value(&case_set)
            .map(drop)
            .map_err(|error| error.to_string());
    }
    let loaded: Loaded = case_set.scenario_of(0).map_err(|error| error.to_string())?;
    prepare(&loaded.scenario)
        .map(drop)
        .map_err(|issues| loaded.locate(issues).to_string())
}

#[test]
fn scenarios_load() {
    let mut count = 0;
    for (page, text) in pages() {
        let blocks = blocks(text);
        let folder = folder(&blocks);
        let scenarios = blocks
            .iter()
            .filter(|block| block.is("toml") && !block.says("cell"));
        for block in scenarios {
            let mut text = block.text.clone();
            for base in block.values("extends") {
                text = format!("extends = {base:?}\n{text}");
            }
            for base in block.values("after") {
                text = fs::read_to_string(folder.path().join(base)).unwrap() + &text;
            }
            let path = folder.path().join("block.toml");
            fs::write(&path, &text).unwrap();
            load(&path).unwrap_or_else(|error| panic!("{page}: {error}\n{text}"));
            count += 1;
        }
    }
    assert!(count > 12, "{count}");
}

/// Command lines of `rodlab` in a block, with options that shorten them.
fn command_lines(block: &Block) -> Vec<String> {
    let through_cargo = "cargo run --release -- ";
    let mut lines: Vec<String> = block
        .text
        .lines()
        .map(|line| line.replacen(through_cargo, "rodlab ", 1))
        .collect();
    // Exclude commands that run these tests themselves.
    lines.retain(|line| !line.is_empty() && !line.starts_with("cargo test"));
    let sets: String = block
        .values("set")
        .map(|set| {
            let (key, value) = set.rsplit_once(':').expect("set:KEY:VALUE");
            format!(" --set {key}={value}")
        })
        .collect();
    for line in &mut lines {
        if line.starts_with("rodlab run ") {
            *line = line
                .split(" #")
                .next()
                .unwrap_or_default()
                .trim()
                .to_owned()
                + &sets;
        }
    }
    if block.says("dry-run") {
        lines.retain(|line| line.starts_with("rodlab run "));
        lines.iter_mut().for_each(|line| *line += " --dry-run");
    }
    lines
}

/// Runs a shell command in which `rodlab` is the program under test.
fn shell(line: &str, folder: &Path) {
    let program = PathBuf::from(env!("CARGO_BIN_EXE_rodlab"));
    let mut path = program.parent().unwrap().as_os_str().to_owned();
    path.push(":");
    path.push(std::env::var_os("PATH").unwrap_or_default());
    let output = Command::new("sh")
        .args(["-c", line])
        .current_dir(folder)
        .env("PATH", path)
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{line}: {}\n{}{}",
        output.status,
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
}

fn run_commands(pages: &[(String, &str)]) -> usize {
    let mut count = 0;
    for (page, text) in pages {
        let blocks = blocks(text);
        let folder = folder(&blocks);
        for block in blocks.iter().filter(|block| block.is("sh")) {
            if block.says("not-run") {
                continue;
            }
            for line in command_lines(block) {
                assert!(line.starts_with("rodlab "), "{page}: {line}");
                println!("{page}: {line}");
                shell(&line, folder.path());
                count += 1;
            }
        }
    }
    count
}

#[cfg(unix)]
#[test]
fn commands_run() {
    let count = run_commands(&pages());
    assert!(count > 60, "{count}");
}

#[test]
fn the_front_page_is_short_and_its_links_are_valid() {
    assert!(README.len() <= LONGEST_README, "{} bytes", README.len());
    let mut count = 0;
    for place in README.split("](").skip(1) {
        let target = place.split(')').next().unwrap();
        if target.starts_with("http") {
            continue;
        }
        let file = target.split('#').next().unwrap();
        assert!(repository().join(file).exists(), "{target}");
        count += 1;
    }
    assert!(count > 20, "{count}");
}

#[test]
fn the_front_page_leads_to_every_topic() {
    for page in PAGES {
        let file = format!("src/guide/{}.md", page.topic().replace('-', "_"));
        assert!(README.contains(&file), "{file}");
    }
}

#[test]
fn scenarios_named_by_the_table_of_experiments_exist() {
    let page = rodlab::guide::page("scenarios").unwrap().text;
    let table = page.split("| examples in `scenarios/` |").nth(1).unwrap();
    let rows = table
        .lines()
        .skip(2)
        .take_while(|line| line.starts_with('|'));
    let mut count = 0;
    for examples in rows.map(|row| row.rsplit(" | ").next().unwrap()) {
        for name in examples.split('`').skip(1).step_by(2) {
            let file = repository().join(format!("scenarios/{name}.toml"));
            assert!(file.exists(), "{name}");
            count += 1;
        }
    }
    assert!(count > 20, "{count}");
}

#[test]
fn reproduced_pages_are_listed() {
    let folder = repository().join("results/reproduced");
    let index = fs::read_to_string(folder.join("README.md")).unwrap();
    for entry in fs::read_dir(&folder).unwrap() {
        let entry = entry.unwrap();
        let name = entry.file_name().into_string().unwrap();
        if entry.path().join("README.md").exists() {
            assert!(index.contains(&format!("]({name}/README.md)")), "{name}");
        }
    }
}
