//! Text inside SVG and HTML.

/// Text as it stands between tags.
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

/// JSON as it stands in a script element, which a name such as `</script>` must not end.
pub fn json_in_script(value: &serde_json::Value) -> String {
    value.to_string().replace('<', "\\u003c")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tags_in_text_are_no_tags() {
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
