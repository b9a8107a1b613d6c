//! Check of the nesting of XML before parsing: XML parsers and trees recurse, so a deep document
//! overflows the stack.

/// Maximum nesting of elements.
pub const DEEPEST: usize = 100;

/// Checks in one pass that elements are nested at most [`DEEPEST`] levels deep.
///
/// Comments, CDATA sections, processing instructions and quoted attribute values are skipped.
/// Syntax errors are left to the parser.
///
/// # Errors
/// The reason, as a message after the name of the document.
pub fn check_nesting(text: &str) -> Result<(), String> {
    let mut depth = 0_usize;
    let mut rest = text;
    while let Some(at) = rest.find('<') {
        rest = &rest[at + 1..];
        let passed_over = [("!--", "-->"), ("![CDATA[", "]]>"), ("?", "?>")];
        let section = passed_over
            .iter()
            .find(|(begin, _)| rest.starts_with(begin));
        if let Some((begin, end)) = section {
            rest = &rest[begin.len()..];
            rest = rest.find(end).map_or("", |at| &rest[at + end.len()..]);
        } else if rest.starts_with('/') {
            depth = depth.saturating_sub(1);
        } else if !rest.starts_with('!') {
            let end = end_of_tag(rest);
            if !rest[..end].ends_with('/') {
                depth += 1;
            }
            if depth > DEEPEST {
                let line = text[..text.len() - rest.len()].matches('\n').count() + 1;
                return Err(format!(
                    "line {line}: elements are nested more than {DEEPEST} levels deep, which is not allowed"
                ));
            }
            rest = &rest[end..];
        }
    }
    Ok(())
}

/// Position of the `>` of a tag, outside quotes; the end of the text if it has none.
fn end_of_tag(text: &str) -> usize {
    let mut quote = None;
    for (at, byte) in text.bytes().enumerate() {
        match (quote, byte) {
            (None, b'>') => return at,
            (None, b'"' | b'\'') => quote = Some(byte),
            (Some(open), _) if open == byte => quote = None,
            _ => {}
        }
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nested(depth: usize) -> String {
        format!("{}{}", "<a b='>'>".repeat(depth), "</a>".repeat(depth))
    }

    #[test]
    fn nesting_is_bounded() {
        assert_eq!(check_nesting(&nested(DEEPEST)), Ok(()));
        let message = check_nesting(&format!("\n{}", nested(DEEPEST + 1))).unwrap_err();
        assert!(
            message.contains("line 2") && message.contains("100 levels"),
            "{message}"
        );
        // Unclosed elements count as well.
        assert!(check_nesting(&"<a>".repeat(1_000_000)).is_err());
    }

    #[test]
    fn only_elements_around_elements_count() {
        for flat in [
            "<a/>",
            "<a b=\"c\" />",
            "<a></a>",
            "<!-- <a> -->",
            "<![CDATA[<a>]]>",
            "<?a <b> ?>",
            "<a b='<c>'/>",
        ] {
            let text = format!("<r>{}</r>", flat.repeat(DEEPEST + 1));
            assert_eq!(check_nesting(&text), Ok(()), "{flat}");
        }
        for cut in ["<", "<a", "<a b='", "<!--", "<![CDATA[", "<?", "</", "<ü"] {
            assert_eq!(check_nesting(cut), Ok(()), "{cut}");
        }
    }
}
