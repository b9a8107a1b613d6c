//! Wrapping of the prose of a page.

/// Largest width of a line of prose, columns.
const WIDTH: usize = 100;

/// Wraps a paragraph to lines of at most 100 columns. Tables, pictures and headings keep their
/// lines.
pub(super) fn wrapped(paragraph: &str) -> String {
    let lines: Vec<String> = paragraph.lines().map(wrapped_line).collect();
    lines.join("\n")
}

fn wrapped_line(line: &str) -> String {
    if line.starts_with(['|', '#']) || line.starts_with("![") {
        return line.to_owned();
    }
    // Continuation lines of a list item are indented to its text.
    let indent = if line.starts_with("- ") { "  " } else { "" };
    let mut text = String::with_capacity(line.len());
    let mut columns = 0;
    for words in unbroken(line) {
        let length = words.chars().count();
        if columns > 0 && columns + 1 + length > WIDTH {
            text.push('\n');
            text += indent;
            columns = indent.len();
        } else if columns > 0 {
            text.push(' ');
            columns += 1;
        }
        text += words;
        columns += length;
    }
    text
}

/// The words of a line, each with following words that would be markup at the start of a line.
fn unbroken(line: &str) -> Vec<&str> {
    let mut parts = Vec::new();
    let mut begin = 0;
    for (place, _) in line.match_indices(' ') {
        let next = line[place + 1..].split(' ').next().unwrap_or_default();
        if begin < place && !is_mark(next) {
            parts.push(&line[begin..place]);
            begin = place + 1;
        }
    }
    parts.push(&line[begin..]);
    parts
}

/// Whether a word would begin a list, a heading, a quotation or a table at the start of a line.
fn is_mark(word: &str) -> bool {
    let number = word.trim_end_matches(['.', ')']);
    let is_ordinal = number.len() < word.len() && number.bytes().all(|byte| byte.is_ascii_digit());
    is_ordinal || matches!(word, "-" | "+" | "*") || word.starts_with(['#', '>', '|', '='])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prose_has_lines_of_a_hundred_columns_and_the_same_words() {
        let words = "Length l̄ of 3 - 2 = 1 in 2026. It is > 0 ".repeat(20);
        let text = wrapped(words.trim());
        assert!(text.lines().count() > 5);
        for line in text.lines() {
            let first = line.split(' ').next().unwrap_or_default();
            assert!(line.chars().count() <= WIDTH && !is_mark(first), "{line}");
        }
        assert_eq!(text.replace('\n', " "), words.trim());
    }

    #[test]
    fn tables_pictures_and_items_keep_their_form() {
        let long = "word ".repeat(30);
        for start in ["| ", "![", "# "] {
            let line = format!("{start}{long}");
            assert_eq!(wrapped(&line), line);
        }
        let items = wrapped(&format!("- {long}\n- {long}"));
        let starts: Vec<&str> = items.lines().map(|line| &line[..2]).collect();
        assert_eq!(starts, ["- ", "  ", "- ", "  "]);
        assert_eq!(wrapped(&items), items);
    }
}
