//! Anchors of headings.

use std::collections::BTreeMap;

/// Names of the anchors of a page, without repetition.
#[derive(Default)]
pub struct Slugs {
    used: BTreeMap<String, usize>,
}

impl Slugs {
    /// The anchor of a heading, as on repository hosts: lower case, hyphens for blanks, no
    /// punctuation.
    pub fn of(&mut self, heading: &str) -> String {
        let mut slug = String::new();
        for character in heading.trim().chars() {
            match character {
                ' ' => slug.push('-'),
                _ if character.is_alphanumeric() || matches!(character, '-' | '_') => {
                    slug.extend(character.to_lowercase());
                }
                _ => {}
            }
        }
        let count = self.used.entry(slug.clone()).or_insert(0);
        *count += 1;
        match *count {
            1 => slug,
            count => format!("{slug}-{}", count - 1),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn anchors_are_those_of_repositories() {
        let mut slugs = Slugs::default();
        for (heading, slug) in [
            ("A knot tied by two arms", "a-knot-tied-by-two-arms"),
            ("`--set`, twice", "--set-twice"),
            ("Options", "options"),
            ("Options", "options-1"),
        ] {
            assert_eq!(slugs.of(heading), slug);
        }
    }
}
