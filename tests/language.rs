//! Texts are plain technical English: words that read like a literal translation are in none of them.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Words that software and its documentation do without. `CONTRIBUTING.md` refers to this list.
const BANNED: [&str; 9] = [
    "anew", "somebody", "nobody", "goes on", "it is no", "is told", "are told", "whoever", "lest",
];

/// Columns of a line of help.
const WIDEST_HELP: usize = 100;

/// A text and where it stands.
struct Text {
    place: String,
    words: String,
}

/// What is wrong with texts, a line each.
fn faults(texts: impl IntoIterator<Item = Text>) -> Vec<String> {
    let mut faults = Vec::new();
    for text in texts {
        let lower = text.words.to_lowercase();
        for banned in BANNED {
            if has_words(&lower, banned) {
                faults.push(format!(
                    "{}: `{banned}` in: {}",
                    text.place,
                    text.words.trim()
                ));
            }
        }
    }
    faults
}

/// Whether a text has words that are no part of longer ones or of identifiers.
fn has_words(text: &str, words: &str) -> bool {
    let is_of_word = |character: char| character.is_alphanumeric() || character == '_';
    let adjoins = |character: Option<char>| character.is_some_and(is_of_word);
    text.match_indices(words).any(|(begin, _)| {
        let after = text[begin + words.len()..].chars().next();
        !adjoins(text[..begin].chars().next_back()) && !adjoins(after)
    })
}

/// All files below a directory with this ending.
fn files_below(directory: &Path, ending: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(directory).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files_below(&path, ending));
        } else if path
            .extension()
            .is_some_and(|extension| extension == ending)
        {
            found.push(path);
        }
    }
    found.sort();
    found
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The lines of a file as texts.
fn lines(path: &Path, is_wanted: impl Fn(&str) -> bool) -> Vec<Text> {
    let text = fs::read_to_string(path).unwrap();
    let place = path.strip_prefix(root()).unwrap().display().to_string();
    let numbered = text.lines().enumerate().filter(|(_, line)| is_wanted(line));
    let numbered = numbered.map(|(index, line)| Text {
        place: format!("{place}:{}", index + 1),
        words: line.to_owned(),
    });
    numbered.collect()
}

/// The source of a file up to its tests.
fn without_tests(path: &Path) -> Vec<Text> {
    let mut is_test = false;
    let text = lines(path, |_| true);
    let kept = text.into_iter().filter(|line| {
        is_test |= line.words.starts_with("mod tests {");
        !is_test
    });
    kept.collect()
}

#[test]
fn sources_have_no_banned_words() {
    let sources = files_below(&root().join("src"), "rs");
    let found = faults(sources.iter().flat_map(|path| without_tests(path)));
    assert!(
        found.is_empty(),
        "{} lines:\n{}",
        found.len(),
        found.join("\n")
    );
}

#[test]
fn documents_and_scenarios_have_no_banned_words() {
    let mut texts = Vec::new();
    for page in files_below(&root().join("src/guide"), "md") {
        texts.extend(lines(&page, |_| true));
    }
    for document in [
        "README.md",
        "CONTRIBUTING.md",
        "CHANGELOG.md",
        "scenarios/README.md",
    ] {
        texts.extend(lines(&root().join(document), |_| true));
    }
    for scenario in files_below(&root().join("scenarios"), "toml") {
        texts.extend(lines(&scenario, |line| line.contains('#')));
    }
    let found = faults(texts);
    assert!(
        found.is_empty(),
        "{} lines:\n{}",
        found.len(),
        found.join("\n")
    );
}

#[test]
fn help_is_narrow_and_has_no_escaped_quotes() {
    let mut pages: Vec<Vec<String>> = vec![vec![]];
    let mut faults = Vec::new();
    while let Some(command) = pages.pop() {
        let mut program = Command::new(env!("CARGO_BIN_EXE_rodlab"));
        let output = program.args(&command).arg("--help").output().unwrap();
        assert!(output.status.success(), "{command:?}");
        let help = String::from_utf8(output.stdout).unwrap();
        for line in help.lines() {
            // The line of usage is not wrapped.
            let is_wide = line.chars().count() > WIDEST_HELP && !line.starts_with("Usage:");
            if is_wide || line.contains("\\\"") {
                faults.push(format!("{command:?}: {line}"));
            }
        }
        pages.extend(subcommands(&help).map(|name| [&command[..], &[name]].concat()));
    }
    assert!(
        faults.is_empty(),
        "{} lines:\n{}",
        faults.len(),
        faults.join("\n")
    );
}

/// The subcommands that a page of help lists: lines of a name and what it does, between `Commands:` or the title of a group
/// and the options.
fn subcommands(help: &str) -> impl Iterator<Item = String> {
    let list = help.split_once("\nUsage:").map_or("", |(_, list)| list);
    let list = list.split("\nOptions:").next().unwrap_or("");
    let list = list.split("\nArguments:").next().unwrap_or("");
    let names = list.lines().filter_map(|line| {
        let name = line.strip_prefix("  ")?.split("  ").next()?;
        let is_name = name.starts_with(|first: char| first.is_ascii_lowercase())
            && name
                .chars()
                .all(|letter| letter.is_ascii_lowercase() || letter == '-');
        (is_name && name != "help").then(|| name.to_owned())
    });
    names.collect::<Vec<_>>().into_iter()
}

#[test]
fn words_are_found_only_as_whole_words() {
    assert!(has_words("made anew.", "anew") && has_words("anew", "anew"));
    assert!(!has_words("sanewt", "anew") && !has_words("biggest, or lesters", "lest"));
    let help = "About\n\nUsage: rodlab <COMMAND>\n\nSimulate:\n  run          Run\n  cell-x  Serve\n\nOptions:\n  verbose  no";
    assert_eq!(subcommands(help).collect::<Vec<_>>(), ["run", "cell-x"]);
}
