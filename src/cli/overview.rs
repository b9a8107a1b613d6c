//! `rodlab --help`: the subcommands in groups, by purpose.

use clap::Command;
use std::fmt::Write;

/// Groups of subcommands. Titles and names fit into their columns.
const GROUPS: [(&str, &[&str]); 8] = [
    ("Simulate", &["run", "check", "init", "presets", "expand"]),
    ("Look", &["plot", "view", "movie", "export"]),
    ("Sweep", &["submit", "status", "gather"]),
    (
        "Solve, plan",
        &[
            "solve",
            "measure",
            "sensitivity",
            "identify",
            "design",
            "plan",
        ],
    ),
    (
        "Robot cell",
        &[
            "deploy", "place", "tie", "fold", "explore", "stream", "replay", "cell",
        ],
    ),
    ("Vision", &["trace", "score", "calibrate"]),
    ("Learn", &["dataset", "train", "evaluate"]),
    (
        "Read, verify",
        &[
            "guide",
            "explain",
            "schema",
            "verify",
            "reproduce",
            "completions",
            "man",
            "help",
        ],
    ),
];

/// The program with a help page that lists its subcommands in groups, one per line.
pub fn with_groups(program: Command) -> Command {
    let mut groups = String::new();
    for (title, names) in GROUPS {
        for (index, name) in names.iter().enumerate() {
            let title = if index == 0 { title } else { "" };
            let about = program.find_subcommand(name).and_then(Command::get_about);
            let about = match about {
                Some(about) => about.to_string(),
                None => "Print this page, or the help of a subcommand".to_owned(),
            };
            // Writing to a string cannot fail.
            let _ = writeln!(groups, "{title:<14}{name:<13}{about}");
        }
    }
    program.help_template(format!(
        "{{about-with-newline}}\n{{usage-heading}} {{usage}}\n\n{groups}\nOptions:\n{{options}}{{after-help}}"
    ))
}

#[cfg(test)]
mod tests {
    use super::super::arguments::Arguments;
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn every_subcommand_is_in_one_group() {
        let program = Arguments::command();
        let shown = program
            .get_subcommands()
            .filter(|command| !command.is_hide_set());
        let mut names: Vec<&str> = shown.map(Command::get_name).chain(["help"]).collect();
        let mut grouped: Vec<&str> = GROUPS
            .iter()
            .flat_map(|(_, names)| *names)
            .copied()
            .collect();
        names.sort_unstable();
        grouped.sort_unstable();
        assert_eq!(grouped, names);
        let help = with_groups(program).render_help().to_string();
        assert!(help.contains("\nLook          plot         Draw"), "{help}");
        let longest = help.lines().map(str::len).max();
        assert!(longest <= Some(100), "{longest:?}");
    }
}
