//! The guide: a page per topic, for people who run scenarios and for those who call the library.
//!
//! Each page is a Markdown file in this folder. The same text is a module here, is printed by
//! `rodlab guide TOPIC`, and reads on its own in a browser of the repository. A new page is a file and its
//! name in the list below. `tests/guide.rs` runs the commands and loads the scenarios of all pages.
//!
//! Between pages, links are written `[contact]` or `[exit codes][exit_codes]`, with `[contact]: contact.md`
//! at the end of the file; here they lead to the modules.

/// Where links between pages lead in this documentation: the first definition of a label counts.
macro_rules! links {
    ([$($name:ident)*]) => {
        concat!($("[", stringify!($name), "]: crate::guide::", stringify!($name), "\n"),*)
    };
}

macro_rules! pages {
    ($($name:ident)*) => { pages!(@ [$($name)*] $($name)*); };
    (@ $list:tt $($name:ident)*) => {
        $(
            #[allow(missing_docs)]
            pub mod $name {
                #![doc = links!($list)]
                #![doc = ""]
                #![doc = include_str!(concat!(stringify!($name), ".md"))]
            }
        )*

        /// All pages, in the order in which they are best read.
        pub const PAGES: &[Page] = &[$(
            Page {
                name: stringify!($name),
                text: include_str!(concat!(stringify!($name), ".md")),
            },
        )*];
    };
}

pages! {
    getting_started
    scenarios
    parameters
    sections
    actuation
    plasticity
    tendons
    sheaths
    contact
    smooth_contact
    joints
    springs
    networks
    obstacles
    free_bodies
    time
    exit_codes
    sweeps
    sensitivity
    cluster
    equilibria
    knots
    helices
    deployment
    tying
    folding
    training
    fluid
    currents
    results
    probes
    identification
    photographs
    design
    figures
    exchange
    robots
    streaming
    cell
    bench
    virtual_cell
    exploration
    vision
    theory
    accuracy
    performance
    python
    environments
    library
}

/// A page of the guide.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Page {
    /// Name of its file and module.
    name: &'static str,
    /// The page in Markdown.
    pub text: &'static str,
}

impl Page {
    /// Name of the page on the command line, such as `exit-codes`.
    pub fn topic(&self) -> String {
        self.name.replace('_', "-")
    }

    /// Heading of the page.
    pub fn title(&self) -> &'static str {
        let heading = self.text.lines().next().unwrap_or_default();
        heading.trim_start_matches('#').trim()
    }
}

/// The page of a topic; hyphens, underscores and capitals make no difference.
pub fn page(topic: &str) -> Option<&'static Page> {
    let name = topic.to_lowercase().replace(['-', ' '], "_");
    PAGES.iter().find(|page| page.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;
    use std::fs;
    use std::path::Path;

    #[test]
    fn every_file_is_in_the_list() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/guide");
        let files: BTreeSet<String> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .filter_map(|name| name.strip_suffix(".md").map(str::to_owned))
            .collect();
        let listed: BTreeSet<String> = PAGES.iter().map(|page| page.name.to_owned()).collect();
        assert_eq!(files, listed);
        assert_eq!(listed.len(), PAGES.len());
    }

    #[test]
    fn every_page_begins_with_its_one_title() {
        for page in PAGES {
            assert!(page.text.starts_with("# "), "{}", page.name);
            let mut in_code = false;
            let titles = page.text.lines().filter(|line| {
                in_code ^= line.starts_with("```");
                !in_code && line.starts_with("# ")
            });
            assert_eq!(titles.count(), 1, "{}", page.name);
        }
    }

    #[test]
    fn links_lead_to_pages_and_definitions_are_used() {
        for page in PAGES {
            let is_definition = |line: &str| line.starts_with('[') && line.contains("]: ");
            let mut text = String::new();
            for line in page.text.lines().filter(|line| !is_definition(line)) {
                text += line;
                text.push('\n');
            }
            for line in page.text.lines().filter(|line| is_definition(line)) {
                let (label, file) = line[1..].split_once("]: ").unwrap();
                assert_eq!(format!("{label}.md"), file, "{}: {line}", page.name);
                assert!(super::page(label).is_some(), "{}: {line}", page.name);
                assert!(
                    text.contains(&format!("[{label}]")),
                    "{}: {line}",
                    page.name
                );
            }
        }
    }

    #[test]
    fn the_table_of_speed_mixes_no_machines() {
        let speed = page("performance").unwrap().text;
        let table: Vec<&str> = speed.lines().filter(|line| line.starts_with('|')).collect();
        assert!(table.len() > 8);
        for line in table {
            assert_eq!(line.matches('|').count(), 5, "{line}");
            for other in ["thesis", "PyElastica", "MuJoCo", "other codes"] {
                assert!(!line.contains(other), "{line}");
            }
        }
    }

    #[test]
    fn topics_are_found_however_they_are_typed() {
        for topic in ["exit-codes", "exit_codes", "Exit codes"] {
            assert_eq!(page(topic).unwrap().name, "exit_codes");
        }
        assert_eq!(page("exit-codes").unwrap().topic(), "exit-codes");
        assert_eq!(page("exits"), None);
        assert!(PAGES.iter().all(|page| !page.title().is_empty()));
    }
}
