//! A page: its HTML, and its data for other pages and the search.

use super::address::{Address, html_path, relative};
use rodlab_files::figure::markdown_html;
use std::collections::BTreeSet;
use std::path::Path;

/// A page.
pub struct Rendered {
    /// The first heading.
    pub title: String,
    /// Content between header and footer.
    pub html: String,
    /// Text for the search.
    pub words: String,
    /// Anchors of the page.
    pub anchors: BTreeSet<String>,
    /// Targets of links in the repository.
    pub links: Vec<Address>,
}

/// Renders the Markdown of a page at a place in a repository.
pub fn render(path: &str, markdown: &str, repository: &Path) -> Rendered {
    let mut links = Vec::new();
    let html = markdown_html(markdown, &mut |link| {
        let address = Address::of(path, link)?.of_folder(repository);
        let anchor = address.anchor.as_ref();
        let anchor = anchor.map_or(String::new(), |anchor| format!("#{anchor}"));
        let place = relative(&html_path(path), &html_path(&address.path));
        links.push(address);
        Some(place + &anchor)
    });
    let anchors = html.split(" id=\"").skip(1);
    let anchors = anchors.filter_map(|rest| Some(rest.split_once('"')?.0.to_owned()));
    let title = markdown.lines().find_map(|line| line.strip_prefix("# "));
    Rendered {
        title: title.unwrap_or(path).replace('`', ""),
        words: words(&html),
        anchors: anchors.collect(),
        html,
        links,
    }
}

/// The text between tags, with spaces instead of line breaks.
fn words(html: &str) -> String {
    let pieces = html.split('<').enumerate();
    let text = pieces.map(|(index, piece)| match piece.split_once('>') {
        Some((_, text)) if index > 0 => text,
        _ => piece,
    });
    let text: String = text.collect();
    let text = text.replace("&lt;", "<").replace("&gt;", ">");
    let text = text.replace("&quot;", "\"").replace("&amp;", "&");
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_search_text_of_a_page_is_its_visible_text() {
        let page = render(
            "a.md",
            "# `run` a <b>\n\nForces & *moments*\n\n| x |\n|---|\n| 1 |\n",
            Path::new(""),
        );
        assert_eq!(page.title, "run a <b>");
        assert!(
            page.words.contains("Forces & moments") && page.words.ends_with('1'),
            "{}",
            page.words
        );
        assert!(page.anchors.contains("run-a"), "{:?}", page.anchors);
    }
}
