//! The documentation as a web site that needs no server: pages of the repository, and pages that
//! the program generates about itself.
//!
//! Pages keep their paths: `src/guide/contact.md` becomes `src/guide/contact.html`. Files to which
//! pages link are copied to the same paths, so that links have the same targets as in the
//! repository. Pages are found by following links from `README.md`.

mod address;
mod openings;
mod page;

use address::{Address, html_path, relative};
use openings::opened;
use page::{Rendered, render};
use rodlab_files::figure::{escape, fill};
use rodlab_files::results::{ResultsError, write_whole};
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::fs;
use std::path::{Path, PathBuf};
use thiserror::Error;

const FRAME: &str = include_str!("frame.html");
const SEARCH: &str = include_str!("search.js");

/// A generated page without a file in the repository.
#[derive(Clone, Debug)]
pub struct Chapter {
    /// Path, such as `reference/keys.md`.
    pub path: &'static str,
    /// Text, Markdown.
    pub text: String,
}

/// Reason why a site was not built.
#[derive(Debug, Error)]
pub enum SiteError {
    /// The folder is not a checkout of the repository.
    #[error("{}: there is no README.md; the site is built from a checkout of the repository", .0.display())]
    NoRepository(PathBuf),
    /// Links are broken.
    #[error("broken links:\n{}", .0.join("\n"))]
    Broken(Vec<String>),
    /// A file could not be read.
    #[error("{}: {error}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        error: std::io::Error,
    },
    /// A file could not be written.
    #[error(transparent)]
    Results(#[from] ResultsError),
}

/// Builds the site of a repository in a folder; returns the number of its pages. `menu` contains
/// the paths and titles of the pages to which all pages link.
///
/// # Errors
/// A file cannot be read or written, or a link is broken. If a link is broken, nothing is written.
pub fn build(
    repository: &Path,
    chapters: &[Chapter],
    menu: &[(String, String)],
    out: &Path,
) -> Result<usize, SiteError> {
    if !repository.join("README.md").is_file() {
        return Err(SiteError::NoRepository(repository.to_owned()));
    }
    let site = collect(repository, chapters)?;
    let broken = broken_links(&site, repository, out);
    if !broken.is_empty() {
        return Err(SiteError::Broken(broken));
    }
    for (path, page) in &site {
        let place = html_path(path);
        let entries = menu.iter().map(|(target, title)| {
            let address = relative(&place, &html_path(target));
            format!("<li><a href=\"{address}\">{title}</a></li>\n")
        });
        let root = relative(&place, "");
        let text = fill(
            FRAME,
            &[
                ("title", &escape(&page.title)),
                ("root", &root),
                ("menu", &entries.collect::<String>()),
                ("body", &page.html),
            ],
        );
        write(&out.join(&place), text.as_bytes())?;
    }
    for file in copied(&site) {
        let from = repository.join(file);
        let bytes = fs::read(&from).map_err(|error| SiteError::Unreadable { path: from, error })?;
        write(&out.join(file), &bytes)?;
    }
    let index = site.iter().map(|(path, page)| {
        serde_json::json!({ "path": html_path(path), "title": page.title, "text": page.words })
    });
    let index = serde_json::Value::Array(index.collect());
    write(
        &out.join("index.js"),
        format!("const PAGES = {index};\n").as_bytes(),
    )?;
    write(&out.join("search.js"), SEARCH.as_bytes())?;
    Ok(site.len())
}

/// Renders all pages that can be reached by links from `README.md` and from the chapters; returns
/// them by path.
fn collect(
    repository: &Path,
    chapters: &[Chapter],
) -> Result<BTreeMap<String, Rendered>, SiteError> {
    let mut site = BTreeMap::new();
    let mut waiting = VecDeque::from(["README.md".to_owned()]);
    waiting.extend(chapters.iter().map(|chapter| chapter.path.to_owned()));
    while let Some(path) = waiting.pop_front() {
        if site.contains_key(&path) {
            continue;
        }
        let chapter = chapters.iter().find(|chapter| chapter.path == path);
        let file = repository.join(&path);
        let text = match chapter {
            Some(chapter) => chapter.text.clone(),
            None if file.is_file() => fs::read_to_string(&file)
                .map_err(|error| SiteError::Unreadable { path: file, error })?,
            // The missing page is reported with the page that links to it.
            None => continue,
        };
        let page = render(&path, &opened(&path, &text), repository);
        let pages = page.links.iter().filter(|link| link.is_page());
        waiting.extend(pages.map(|link| link.path.clone()));
        site.insert(path, page);
    }
    Ok(site)
}

/// Messages about links to missing pages, anchors and files.
fn broken_links(site: &BTreeMap<String, Rendered>, repository: &Path, out: &Path) -> Vec<String> {
    let leads = |link: &Address| match site.get(&link.path) {
        Some(page) => link
            .anchor
            .as_ref()
            .is_none_or(|anchor| page.anchors.contains(anchor)),
        None => {
            let is_file = repository.join(&link.path).is_file() && !link.is_page();
            is_file || link.path.starts_with("api/") && out.join(&link.path).is_file()
        }
    };
    let all = site
        .iter()
        .flat_map(|(path, page)| page.links.iter().map(move |link| (path, link)));
    let broken = all.filter(|(_, link)| !leads(link));
    broken
        .map(|(path, link)| format!("  {path}: {link}"))
        .collect()
}

/// Files of the repository to which pages link.
fn copied(site: &BTreeMap<String, Rendered>) -> impl Iterator<Item = &String> {
    let links = site.values().flat_map(|page| &page.links);
    let files = links.filter(|link| !link.is_page() && !link.path.starts_with("api/"));
    let files: BTreeSet<&String> = files.map(|link| &link.path).collect();
    files.into_iter()
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), SiteError> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).map_err(|error| SiteError::Unreadable {
            path: folder.to_owned(),
            error,
        })?;
    }
    Ok(write_whole(path, bytes)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pages_are_found_by_their_links_and_files_are_copied() {
        let folder = tempfile::tempdir().unwrap();
        let (from, to) = (folder.path().join("from"), folder.path().join("to"));
        fs::create_dir_all(from.join("guide")).unwrap();
        let page = "# Rods\n\n[more](guide/knots.md#tight-knots) ![a rod](rod.svg) [web](https://example.org) [cases](cases)\n";
        fs::write(from.join("README.md"), page).unwrap();
        fs::write(from.join("rod.svg"), "<svg/>").unwrap();
        fs::create_dir_all(from.join("cases")).unwrap();
        fs::write(from.join("cases/README.md"), "# Cases\n").unwrap();
        let knots =
            "# Knots\n\n## Tight knots\n\n[back](../README.md) [keys][k]\n\n[k]: ../keys.md\n";
        fs::write(from.join("guide/knots.md"), knots).unwrap();
        let keys = Chapter {
            path: "keys.md",
            text: "# Keys\n".into(),
        };
        let menu = [("keys.md".to_owned(), "Keys".to_owned())];
        assert_eq!(
            build(&from, std::slice::from_ref(&keys), &menu, &to).unwrap(),
            4
        );
        let read = |name: &str| fs::read_to_string(to.join(name)).unwrap();
        assert!(read("index.html").contains("href=\"guide/knots.html#tight-knots\""));
        assert!(read("index.html").contains("href=\"cases/README.html\""));
        assert!(read("guide/knots.html").contains("href=\"../index.html\""));
        assert!(read("guide/knots.html").contains("href=\"../keys.html\">Keys"));
        assert_eq!(read("rod.svg"), "<svg/>");
        assert!(read("index.js").contains("\"title\":\"Knots\""));
        fs::write(
            from.join("guide/knots.md"),
            "# Knots\n[gone](no.md) [lost](../rod.png)\n",
        )
        .unwrap();
        let error = build(&from, std::slice::from_ref(&keys), &menu, &to)
            .unwrap_err()
            .to_string();
        for broken in [
            "README.md: guide/knots.md#tight-knots",
            "guide/no.md",
            "rod.png",
        ] {
            assert!(error.contains(broken), "{error}");
        }
    }
}
