//! Text inside SVG, HTML and Markdown: one function for each context.

/// Text escaped for use between tags and in quoted attributes. Control characters, which XML does
/// not allow, are replaced.
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '"' => escaped += "&quot;",
            '\n' | '\t' => escaped.push(character),
            _ if character.is_control() => escaped.push(char::REPLACEMENT_CHARACTER),
            _ => escaped.push(character),
        }
    }
    escaped
}

/// Text escaped for a line of Markdown, also in headings and table cells. File names and server
/// messages then add no markup, links, HTML or lines.
pub fn escape_markdown(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '\\' | '`' | '*' | '_' | '[' | ']' | '<' | '>' | '|' | '&' | '~' => {
                escaped.push('\\');
                escaped.push(character);
            }
            _ if character.is_control() => escaped.push(' '),
            _ => escaped.push(character),
        }
    }
    escaped
}

/// A template with `{{name}}` replaced by the text of that name. Inserted text is not searched
/// again: a title may contain `{{script}}`.
///
/// # Panics
/// If the template contains a name that is not among `parts`.
pub fn fill(template: &str, parts: &[(&str, &str)]) -> String {
    let length: usize = parts.iter().map(|(_, text)| text.len()).sum();
    let mut filled = String::with_capacity(template.len() + length);
    let mut rest = template;
    while let Some((before, after)) = rest.split_once("{{") {
        let (name, after) = after.split_once("}}").expect("a name in braces");
        let part = parts.iter().find(|(part, _)| *part == name);
        filled += before;
        filled += part.unwrap_or_else(|| panic!("no part `{name}`")).1;
        rest = after;
    }
    filled + rest
}

/// Whether the beginning of a file is that of a page written by rodlab.
pub fn is_page(head: &[u8]) -> bool {
    let head = String::from_utf8_lossy(head);
    head.starts_with("<!DOCTYPE html>")
        // Earlier versions did not write their version.
        && head.contains(r#"<meta name="generator" content="rodlab"#)
}

/// Whether the beginning of a file is that of a picture written by rodlab: SVG, PNG or PDF.
pub fn is_picture(head: &[u8]) -> bool {
    let beginnings: [&[u8]; 4] = [b"<svg", b"<?xml", b"\x89PNG", b"%PDF-"];
    beginnings
        .iter()
        .any(|beginning| head.starts_with(beginning))
}

/// JSON escaped for a script element, which a name such as `</script>` must not end.
pub fn json_in_script(value: &serde_json::Value) -> String {
    value.to_string().replace('<', "\\u003c")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_bring_no_markup() {
        assert_eq!(
            escape("a\u{1b}[2J <b c=\"d\"> & e"),
            "a\u{fffd}[2J &lt;b c=&quot;d&quot;&gt; &amp; e"
        );
        assert_eq!(
            escape_markdown("a_b\n# c\r[d](javascript:e) <script> | `f`"),
            "a\\_b # c \\[d\\](javascript:e) \\<script\\> \\| \\`f\\`"
        );
    }

    #[test]
    fn text_that_reads_like_a_place_is_left_alone() {
        let filled = fill(
            "<title>{{title}}</title>{{script}}",
            &[("script", "f();"), ("title", "{{script}} {{title}} {{x}}")],
        );
        assert_eq!(filled, "<title>{{script}} {{title}} {{x}}</title>f();");
    }

    #[test]
    fn tags_in_text_are_ignored() {
        assert_eq!(escape("a < b & c > d"), "a &lt; b &amp; c &gt; d");
        let name = serde_json::json!({ "name": "</script>" });
        let text = json_in_script(&name);
        assert!(!text.contains('<'));
        assert_eq!(
            serde_json::from_str::<serde_json::Value>(&text).unwrap(),
            name
        );
    }
}
