//! Addresses of links, which are paths in the repository.

use std::fmt;
use std::path::Path;

/// Target of a link in the repository.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Address {
    /// Path of the file from the root of the repository.
    pub path: String,
    /// The anchor on its page.
    pub anchor: Option<String>,
}

impl Address {
    /// Target of a link on a page; `None` outside the repository.
    pub fn of(page: &str, link: &str) -> Option<Self> {
        if link.contains("://") || link.starts_with("mailto:") || link.starts_with("data:") {
            return None;
        }
        let (path, anchor) = match link.split_once('#') {
            Some((path, anchor)) => (path, Some(anchor.to_owned())),
            None => (link, None),
        };
        let path = match path {
            "" => page.to_owned(),
            path => joined(page, path),
        };
        Some(Self { path, anchor })
    }

    /// The page of a folder of the repository, its `README.md`; other targets are unchanged.
    #[must_use]
    pub fn of_folder(self, repository: &Path) -> Self {
        let page = format!("{}/README.md", self.path);
        match repository.join(&page).is_file() {
            true => Self { path: page, ..self },
            false => self,
        }
    }

    /// Whether the target is a page of the site.
    pub fn is_page(&self) -> bool {
        self.path.ends_with(".md")
    }
}

impl fmt::Display for Address {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.path)?;
        match &self.anchor {
            Some(anchor) => write!(formatter, "#{anchor}"),
            None => Ok(()),
        }
    }
}

/// Converts a path relative to a page to a path from the root.
fn joined(page: &str, path: &str) -> String {
    let mut parts: Vec<&str> = page.split('/').collect();
    parts.pop();
    for part in path.split('/') {
        match part {
            "" | "." => {}
            ".." => drop(parts.pop()),
            part => parts.push(part),
        }
    }
    parts.join("/")
}

/// Path of a page in the site.
pub fn html_path(page: &str) -> String {
    match page.strip_suffix(".md") {
        Some("README") => "index.html".into(),
        Some(stem) => format!("{stem}.html"),
        None => page.to_owned(),
    }
}

/// The address of a place relative to the folder of a page. For an empty place it is the address
/// of the root: empty or with a trailing slash.
pub fn relative(page: &str, place: &str) -> String {
    "../".repeat(page.matches('/').count()) + place
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_lead_to_places_in_the_repository() {
        for (page, link, expected) in [
            ("README.md", "src/guide/time.md", Some("src/guide/time.md")),
            (
                "src/guide/a.md",
                "../../scenarios/b.toml",
                Some("scenarios/b.toml"),
            ),
            ("src/guide/a.md", "b.md#c", Some("src/guide/b.md#c")),
            ("src/guide/a.md", "#c", Some("src/guide/a.md#c")),
            ("a.md", "https://example.org/b.md", None),
        ] {
            let address = Address::of(page, link).map(|address| address.to_string());
            assert_eq!(address.as_deref(), expected, "{link}");
        }
    }

    #[test]
    fn addresses_are_relative_to_the_page() {
        assert_eq!(
            relative("src/guide/a.html", "index.html"),
            "../../index.html"
        );
        assert_eq!(relative("index.html", "a.html"), "a.html");
        assert_eq!(html_path("scenarios/README.md"), "scenarios/README.html");
    }
}
