//! Markdown as a page for the browser.

use super::markup::{escape, fill};
use super::slug::Slugs;
use crate::origin::version;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use pulldown_cmark::{CowStr, Event, Options, Parser, Tag, TagEnd, html};

const PAGE: &str = include_str!("document.html");

/// Converts Markdown (CommonMark with tables) to HTML. `address` replaces the address of each link
/// and picture. Headings have anchors, as on repository hosts.
pub fn markdown_html(markdown: &str, address: &mut dyn FnMut(&str) -> Option<String>) -> String {
    let mut events: Vec<Event<'_>> = Parser::new_ext(markdown, Options::ENABLE_TABLES).collect();
    let mut slugs = Slugs::default();
    for index in 0..events.len() {
        let anchor = match &events[index] {
            Event::Start(Tag::Heading { .. }) => Some(slugs.of(&words_of(&events[index + 1..]))),
            _ => None,
        };
        match &mut events[index] {
            Event::Start(Tag::Heading { id, .. }) => *id = anchor.map(CowStr::from),
            Event::Start(Tag::Image { dest_url, .. } | Tag::Link { dest_url, .. }) => {
                if let Some(other) = address(dest_url) {
                    *dest_url = other.into();
                }
            }
            _ => {}
        }
    }
    let mut text = String::with_capacity(2 * markdown.len());
    html::push_html(&mut text, events.into_iter());
    text
}

/// The text of the current heading.
fn words_of(events: &[Event<'_>]) -> String {
    let inside = events
        .iter()
        .take_while(|event| !matches!(event, Event::End(TagEnd::Heading(_))));
    let words = inside.filter_map(|event| match event {
        Event::Text(words) | Event::Code(words) => Some(words.as_ref()),
        _ => None,
    });
    words.collect()
}

/// An HTML page that contains Markdown and its pictures. `picture` returns the bytes of a picture
/// by its address, or `None` to keep the address.
pub fn document_page(
    title: &str,
    markdown: &str,
    picture: &dyn Fn(&str) -> Option<Vec<u8>>,
) -> String {
    let mut embedded = |url: &str| picture(url).and_then(|bytes| data_address(&bytes));
    let body = markdown_html(markdown, &mut embedded);
    let parts = [
        ("version", escape(&version())),
        ("title", escape(title)),
        ("body", body),
    ];
    fill(
        PAGE,
        &parts.each_ref().map(|(name, text)| (*name, text.as_str())),
    )
}

/// A picture, PNG or SVG, as a data address.
fn data_address(bytes: &[u8]) -> Option<String> {
    let kinds: [(&[u8], &str); 3] = [
        (b"\x89PNG", "png"),
        (b"<svg", "svg+xml"),
        (b"<?xml", "svg+xml"),
    ];
    let (_, kind) = kinds.iter().find(|(head, _)| bytes.starts_with(head))?;
    let text = STANDARD.encode(bytes);
    Some(format!("data:image/{kind};base64,{text}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::escape_markdown;

    #[test]
    fn a_page_holds_its_tables_and_pictures() {
        let markdown = "# Rods\n\n| a | b |\n|---|---|\n| 1 | 2 |\n\n![A rod](rod.png)\n\n[more](other.html)\n";
        let png = [0x89, b'P', b'N', b'G', b'\r', b'\n', 0x1a, b'\n'];
        let page = document_page("Rods & <more>", markdown, &|name| {
            (name == "rod.png").then(|| png.to_vec())
        });
        for part in [
            "<title>Rods &amp; &lt;more&gt;</title>",
            "<td>1</td><td>2</td>",
            "src=\"data:image/png;base64,",
            "href=\"other.html\"",
        ] {
            assert!(page.contains(part), "{part}: {page}");
        }
    }

    #[test]
    fn escaped_text_brings_no_markup() {
        let hostile = "<script>alert(1)</script> [a](javascript:b) ![c](d) `e` | f";
        let html = markdown_html(
            &format!("| x |\n|---|\n| {} |\n", escape_markdown(hostile)),
            &mut |_| None,
        );
        assert!(
            !html.contains("<script") && !html.contains("<a ") && !html.contains("<img"),
            "{html}"
        );
    }
}
