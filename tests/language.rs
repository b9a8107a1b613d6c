//! Texts are in plain technical English: none contains words that read like a literal translation.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Words that texts about software do not need. `CONTRIBUTING.md` refers to this list.
const BANNED: [&str; 9] = [
    "anew", "somebody", "nobody", "goes on", "it is no", "is told", "are told", "whoever", "lest",
];

/// Largest width of a line of help, columns.
const WIDEST_HELP: usize = 100;

/// Largest number of lines of the short help of a command, which fits on a screen.
const LONGEST_SHORT_HELP: usize = 40;

/// Largest number of lines of the overview, which has a line for each of 39 commands.
const LONGEST_OVERVIEW: usize = 50;

/// Largest width of a line of prose in a document, columns.
const WIDEST_PROSE: usize = 100;

/// Largest number of lines of a page of the guide.
const LONGEST_PAGE: usize = 250;

/// A text with its place.
struct Text {
    place: String,
    words: String,
}

/// Faults of texts, one per line.
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

/// Whether a text contains words that are not parts of longer words or of identifiers.
fn has_words(text: &str, words: &str) -> bool {
    let is_of_word = |character: char| character.is_alphanumeric() || character == '_';
    let adjoins = |character: Option<char>| character.is_some_and(is_of_word);
    text.match_indices(words).any(|(begin, _)| {
        let after = text[begin + words.len()..].chars().next();
        !adjoins(text[..begin].chars().next_back()) && !adjoins(after)
    })
}

/// All files below a directory with the given extension.
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

/// The lines of a source file before its tests.
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

/// Whether a line may be broken: it is not one of a table, a picture or a heading.
fn is_prose(line: &str) -> bool {
    !line.starts_with(['|', '#']) && !line.starts_with("![")
}

#[test]
fn prose_of_documents_has_lines_of_a_hundred_columns() {
    let mut documents = files_below(&root().join("src/guide"), "md");
    documents.extend(files_below(&root().join("results/reproduced"), "md"));
    let of_root = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md"];
    documents.extend(of_root.map(|name| root().join(name)));
    let mut found = Vec::new();
    for document in documents {
        let mut is_code = false;
        for line in lines(&document, |_| true) {
            is_code ^= line.words.starts_with("```");
            let columns = line.words.chars().count();
            if !is_code && is_prose(&line.words) && columns > WIDEST_PROSE {
                found.push(format!("{}: {columns} columns", line.place));
            }
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn pages_of_the_guide_have_at_most_250_lines() {
    for page in files_below(&root().join("src/guide"), "md") {
        let count = lines(&page, |_| true).len();
        assert!(count <= LONGEST_PAGE, "{}: {count} lines", page.display());
    }
}

/// Prints the help of a command with an option, `-h` or `--help`.
fn help(command: &[String], option: &str) -> String {
    let mut program = Command::new(env!("CARGO_BIN_EXE_rodlab"));
    let output = program.args(command).arg(option).output().unwrap();
    assert!(output.status.success(), "{command:?}");
    String::from_utf8(output.stdout).unwrap()
}

/// All commands with their subcommands; the program itself is first.
fn commands() -> Vec<Vec<String>> {
    let mut commands = vec![vec![]];
    let mut index = 0;
    while let Some(command) = commands.get(index).cloned() {
        let column = if command.is_empty() { 14 } else { 2 };
        let names = subcommands(&help(&command, "--help"), column).into_iter();
        commands.extend(names.map(|name| [&command[..], &[name]].concat()));
        index += 1;
    }
    commands
}

#[test]
fn help_is_narrow_and_has_no_escaped_quotes() {
    let mut faults = Vec::new();
    for command in commands() {
        for line in help(&command, "--help").lines() {
            // The line of usage is not wrapped.
            let is_wide = line.chars().count() > WIDEST_HELP && !line.starts_with("Usage:");
            if is_wide || line.contains("\\\"") {
                faults.push(format!("{command:?}: {line}"));
            }
        }
    }
    assert!(
        faults.is_empty(),
        "{} lines:\n{}",
        faults.len(),
        faults.join("\n")
    );
}

#[test]
fn short_help_fits_on_a_screen() {
    let commands = commands();
    assert!(commands.len() > 40, "{commands:?}");
    for command in commands {
        let most = if command.is_empty() {
            LONGEST_OVERVIEW
        } else {
            LONGEST_SHORT_HELP
        };
        let lines = help(&command, "-h").lines().count();
        assert!(lines <= most, "{command:?}: {lines} lines");
    }
}

/// The subcommands that a help page lists, with their descriptions. Each is on one line that
/// starts at a column: in the overview after the titles of groups, elsewhere after `Commands:`.
fn subcommands(help: &str, column: usize) -> Vec<String> {
    let list = help.split_once("\nUsage:").map_or("", |(_, list)| list);
    let list = list.split("\nOptions:").next().unwrap_or("");
    let list = list.split("\nArguments:").next().unwrap_or("");
    let names = list.lines().filter_map(|line| {
        let (before, rest) = line.split_at_checked(column)?;
        let name = rest.split("  ").next()?;
        let is_name = before.ends_with(' ')
            && name.starts_with(|first: char| first.is_ascii_lowercase())
            && name
                .chars()
                .all(|letter| letter.is_ascii_lowercase() || letter == '-');
        (is_name && name != "help").then(|| name.to_owned())
    });
    names.collect()
}

#[test]
fn words_are_found_only_as_whole_words() {
    assert!(has_words("made anew.", "anew") && has_words("anew", "anew"));
    assert!(!has_words("sanewt", "anew") && !has_words("biggest, or lesters", "lest"));
    let help = "About\n\nUsage: rodlab <COMMAND>\n\nSimulate  run     Run it\n          cell-x  Serve\n\nOptions:\n  verbose  no";
    assert_eq!(subcommands(help, 10), ["run", "cell-x"]);
    let help = "About\n\nUsage: rodlab solve <COMMAND>\n\nCommands:\n  ik    Solve a\n        problem\n  help  Print\n\nOptions:\n";
    assert_eq!(subcommands(help, 2), ["ik"]);
}
