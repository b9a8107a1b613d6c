//! Text on a terminal. Names of files and messages of servers must not move the cursor, clear the
//! screen or write to the clipboard.

/// Replaces control characters, and characters that change the direction of writing, with U+FFFD.
/// Line breaks, tabs and the sequences for colours and bold print are kept.
pub fn printable(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(character) = rest.chars().next() {
        let length = style(rest).unwrap_or(character.len_utf8());
        let is_kept = length > 1 && character == ESCAPE;
        if is_kept || !is_harmful(character) {
            safe += &rest[..length];
        } else {
            safe.push(char::REPLACEMENT_CHARACTER);
        }
        rest = &rest[length..];
    }
    safe
}

const ESCAPE: char = '\u{1b}';

fn is_harmful(character: char) -> bool {
    let turns = matches!(character, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    turns || character.is_control() && !matches!(character, '\n' | '\t')
}

/// Length of the sequence for a style (`ESC [ numbers m`) at the beginning of a text.
fn style(text: &str) -> Option<usize> {
    let inside = text.strip_prefix("\u{1b}[")?;
    let end = inside.find(|character: char| !(character.is_ascii_digit() || character == ';'))?;
    inside[end..].starts_with('m').then_some(end + 3)
}

/// Passes text to a writer in its [`printable`] form.
pub struct Printable<W>(pub W);

impl<W: std::io::Write> std::io::Write for Printable<W> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let text = printable(&String::from_utf8_lossy(bytes));
        self.0.write_all(text.as_bytes())?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.0.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    #[test]
    fn only_lines_tabs_and_styles_pass() {
        for kept in [
            "a\tb\n",
            "\u{1b}[1;31merror\u{1b}[0m: µ → 柔",
            "\u{1b}[m",
            "",
        ] {
            assert_eq!(printable(kept), kept);
        }
        for (raw, safe) in [
            ("a\u{1b}[2Jb", "a\u{fffd}[2Jb"),
            ("\u{1b}]52;c;aGk=\u{7}", "\u{fffd}]52;c;aGk=\u{fffd}"),
            ("done\rfailed", "done\u{fffd}failed"),
            ("\u{9b}2J\u{8}\u{7f}", "\u{fffd}2J\u{fffd}\u{fffd}"),
            ("a\u{202e}b", "a\u{fffd}b"),
            ("\u{1b}", "\u{fffd}"),
            ("\u{1b}[1", "\u{fffd}[1"),
        ] {
            assert_eq!(printable(raw), safe);
        }
        let mut written = Vec::new();
        let bytes = "é\u{1b}c".as_bytes();
        assert_eq!(Printable(&mut written).write(bytes).unwrap(), bytes.len());
        assert_eq!(written, "é\u{fffd}c".as_bytes());
    }
}
