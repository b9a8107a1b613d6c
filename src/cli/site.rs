//! `rodlab site`.

use super::candidates::scenario_keys;
use super::prelude::*;
use crate::guide::PAGES;
use crate::site::{Chapter, SiteError, build};
use clap::Command;
use rodlab_lab::experiment::{self, described_files};

/// Pages that are not part of the guide; they follow it in the menu.
const OTHERS: [(&str, &str); 7] = [
    ("scenarios/README.md", "Gallery"),
    ("results/reproduced/README.md", "Reproduced pages"),
    (COMMANDS, "Commands"),
    (KEYS, "Keys of scenario files"),
    (FILES, "Files and columns"),
    ("CONTRIBUTING.md", "Contributing"),
    ("CHANGELOG.md", "Changes"),
];
const COMMANDS: &str = "reference/commands.md";
const KEYS: &str = "reference/keys.md";
const FILES: &str = "reference/files.md";

/// Arguments of `rodlab site`.
#[derive(Debug, Args)]
#[command(after_help = "\
Example:
  rodlab site target/site          then open target/site/index.html in a browser

The pages are those of the repository, and the output of `--help` and `rodlab explain`. They need no
server. scripts/site adds the documentation of the library.")]
pub struct SiteArguments {
    /// Directory for the site
    #[arg(value_name = "DIR")]
    out: PathBuf,
    /// A checkout of the repository
    #[arg(long, value_name = "DIR", default_value = ".")]
    repository: PathBuf,
}

/// Writes the documentation of `program` as a web site.
pub fn site(arguments: &SiteArguments, program: Command) -> Result<(), Failure> {
    let chapters = [
        (COMMANDS, commands(program)),
        (KEYS, keys()),
        (FILES, files()),
    ];
    let chapters = chapters.map(|(path, text)| Chapter { path, text });
    let mut menu = vec![("README.md".to_owned(), "rodlab".to_owned())];
    menu.extend(PAGES.iter().map(|page| {
        let name = page.topic().replace('-', "_");
        (format!("src/guide/{name}.md"), page.title().to_owned())
    }));
    menu.extend(OTHERS.map(|(path, title)| (path.to_owned(), title.to_owned())));
    let api = "api/rodlab/index.html";
    if arguments.out.join(api).is_file() {
        menu.push((api.to_owned(), "Library".to_owned()));
    }
    let pages = build(&arguments.repository, &chapters, &menu, &arguments.out);
    let pages = pages.map_err(|error| match error {
        SiteError::NoRepository(_) => Failure::Input(error.to_string()),
        error => Failure::system(error),
    })?;
    let index = arguments.out.join("index.html");
    print(&format!("{pages} pages: {}\n", index.display()))
}

/// The help of all subcommands.
fn commands(mut program: Command) -> String {
    program.build();
    let mut text = "# Commands\n".to_owned();
    add_command(&mut text, &program, "rodlab");
    text
}

fn add_command(text: &mut String, command: &Command, name: &str) {
    let help = command.clone().render_long_help().to_string();
    let lines = help.lines().map(str::trim_end).collect::<Vec<_>>();
    *text += &format!("\n## {name}\n\n```text\n{}\n```\n", lines.join("\n"));
    for inner in command.get_subcommands() {
        if inner.get_name() != "help" && !inner.is_hide_set() {
            add_command(text, inner, &format!("{name} {}", inner.get_name()));
        }
    }
}

/// The explanations of all keys.
fn keys() -> String {
    let mut text = "# Keys of scenario files\n".to_owned();
    for (key, _) in scenario_keys() {
        if let Ok(words) = experiment::explain(&key) {
            text += &format!("\n## {key}\n\n```text\n{}\n```\n", words.trim_end());
        }
    }
    text
}

/// The files of results directories with their columns.
fn files() -> String {
    let mut text = "# Files of results directories, and their columns\n".to_owned();
    for file in described_files() {
        text += &format!("\n## {}\n\n{}\n", file.names.join(", "), file.meaning);
        let columns: Vec<String> = file
            .columns()
            .map(|column| format!("| `{}` | {} |\n", column.name, column.meaning))
            .collect();
        if !columns.is_empty() {
            text += &format!("\n| column | meaning |\n|---|---|\n{}", columns.concat());
        }
    }
    text
}
