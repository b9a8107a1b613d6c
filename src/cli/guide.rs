//! `rodlab guide`.

use super::candidates::guide_topics;
use super::markdown::for_terminal;
use super::prelude::*;
use crate::guide::{PAGES, page};
use rodlab_lab::scenario::did_you_mean;

/// Arguments of `rodlab guide`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rodlab guide                      the topics
  rodlab guide contact              one page; Markdown where standard output is not a terminal
  rodlab guide exit-codes | less")]
pub struct GuideArguments {
    /// Topic; without it, all topics are listed
    #[arg(add = guide_topics())]
    pub topic: Option<String>,
}

/// Prints a page of the guide, or the list of topics.
pub fn guide(arguments: &GuideArguments, common: &Common) -> Result<(), Failure> {
    let Some(topic) = &arguments.topic else {
        return print(&topics());
    };
    let Some(page) = page(topic) else {
        let topics: Vec<String> = PAGES.iter().map(|page| page.topic()).collect();
        let advice = did_you_mean(topic, topics.iter().map(String::as_str))
            .unwrap_or_else(|| format!("the topics are: {}", topics.join(", ")));
        return Err(Failure::Input(format!(
            "there is no topic `{topic}`; {advice}"
        )));
    };
    match common.styles_stdout() {
        true => print(&for_terminal(page.text)),
        false => print(page.text),
    }
}

/// Lists topic and title, one line per page.
fn topics() -> String {
    PAGES
        .iter()
        .map(|page| format!("{:<18}{}\n", page.topic(), page.title()))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::arguments::Arguments;
    use super::*;
    use clap::Parser;
    use clap::error::ErrorKind;

    /// The words of a command line up to a comment, a pipe or a redirection.
    fn words(line: &str) -> Vec<String> {
        let mut words = vec![String::new()];
        let mut quote = None;
        for character in line.chars() {
            match character {
                '"' | '\'' if quote.is_none() => quote = Some(character),
                _ if quote == Some(character) => quote = None,
                '#' | '>' | '|' | '&' if quote.is_none() => break,
                ' ' if quote.is_none() => words.push(String::new()),
                _ => words.last_mut().expect("one word").push(character),
            }
        }
        words.retain(|word| !word.is_empty());
        words
    }

    fn texts() -> impl Iterator<Item = &'static str> {
        let guide = PAGES.iter().map(|page| page.text);
        guide.chain([
            include_str!("../../README.md"),
            include_str!("../../CONTRIBUTING.md"),
            include_str!("../../results/reproduced/README.md"),
        ])
    }

    /// Whether the only fault of a command line is a file that only its reader has.
    fn lacks_a_file(error: &clap::Error) -> bool {
        error.kind() == ErrorKind::ValueValidation && error.to_string().contains("there is no such")
    }

    #[test]
    fn command_lines_of_the_guide_parse() {
        let mut count = 0;
        for line in texts().flat_map(str::lines) {
            if line.starts_with("rodlab ") {
                let error = Arguments::try_parse_from(words(line)).err();
                let error = error.filter(|error| error.kind() != ErrorKind::DisplayHelp);
                let error = error.filter(|error| !lacks_a_file(error));
                assert!(error.is_none(), "{line}: {}", error.unwrap());
                count += 1;
            }
        }
        assert!(count > 50, "{count}");
    }

    #[test]
    fn commands_named_in_the_text_are_commands() {
        for line in texts().flat_map(str::lines) {
            let spans = line.split('`').skip(1).step_by(2);
            for span in spans.filter(|span| span.starts_with("rodlab ")) {
                if let Err(error) = Arguments::try_parse_from(words(span)) {
                    // Text may name a command without its required arguments, or its help.
                    let named = [
                        ErrorKind::DisplayHelp,
                        ErrorKind::MissingRequiredArgument,
                        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand,
                        ErrorKind::MissingSubcommand,
                    ];
                    let is_fine = named.contains(&error.kind()) || lacks_a_file(&error);
                    assert!(is_fine, "{span}: {error}");
                }
            }
        }
    }

    #[test]
    fn misspelt_topics_get_advice() {
        let common = Arguments::parse_from(["rodlab", "guide"]).common;
        let arguments = GuideArguments {
            topic: Some("contakt".into()),
        };
        let Err(Failure::Input(message)) = guide(&arguments, &common) else {
            panic!("there is no such topic");
        };
        assert_eq!(
            message,
            "there is no topic `contakt`; did you mean `contact`?"
        );
        assert!(topics().contains("exit-codes        Exit codes"));
    }
}
