//! Formats the Markdown of the guide for a terminal.

const BOLD: &str = "\x1b[1m";
const CODE: &str = "\x1b[36m";
const PLAIN: &str = "\x1b[0m";
/// Width of text, columns. Longer lines are hard to read, and every terminal has this width.
const WIDTH: usize = 80;

/// Formats Markdown: headings in bold, code in colour, links as their text, and paragraphs and
/// tables within 80 columns.
pub fn for_terminal(markdown: &str) -> String {
    let mut text = String::new();
    let mut in_code = false;
    let mut table: Vec<Vec<String>> = Vec::new();
    for line in markdown.lines() {
        if !in_code && let Some(row) = line.strip_prefix('|') {
            table.push(cells(row));
            continue;
        }
        text += &table_in_columns(&std::mem::take(&mut table));
        if line.starts_with("```") {
            in_code = !in_code;
        } else if in_code {
            text += &format!("    {CODE}{line}{PLAIN}\n");
        } else if let Some(heading) = heading(line) {
            text += &format!("{BOLD}{heading}{PLAIN}\n");
        } else if !is_definition(line) {
            let hanging = if line.starts_with("- ") { 2 } else { 0 };
            text += &wrapped(&inline(line), hanging);
        }
    }
    text += &table_in_columns(&table);
    text.truncate(text.trim_end().len());
    text.push('\n');
    text
}

fn heading(line: &str) -> Option<&str> {
    let words = line.trim_start_matches('#');
    words.strip_prefix(' ').filter(|_| line.len() > words.len())
}

/// Whether a line defines the target of a link.
fn is_definition(line: &str) -> bool {
    line.starts_with('[') && line.contains("]: ")
}

/// Cells of a row whose first bar was removed.
fn cells(row: &str) -> Vec<String> {
    let row = row.trim().trim_end_matches('|');
    row.split(" |").map(|cell| inline(cell.trim())).collect()
}

/// Formats a table in aligned columns if they fit. Otherwise each row becomes a paragraph with its
/// cells under the names of their columns.
fn table_in_columns(rows: &[Vec<String>]) -> String {
    let [header, _rule, rows @ ..] = rows else {
        return String::new();
    };
    let cell_width =
        |row: &Vec<String>, column: usize| row.get(column).map_or(0, |cell| visible_length(cell));
    let widths: Vec<usize> = (0..header.len())
        .map(|column| {
            let body = rows.iter().map(|row| cell_width(row, column));
            body.fold(cell_width(header, column), usize::max)
        })
        .collect();
    let mut text = String::new();
    if widths.iter().map(|width| width + 2).sum::<usize>() <= WIDTH {
        for row in std::iter::once(header).chain(rows) {
            let mut line = String::new();
            for (cell, width) in row.iter().zip(&widths) {
                line += cell;
                line += &" ".repeat(width - visible_length(cell) + 2);
            }
            text += line.trim_end();
            text.push('\n');
        }
        return text;
    }
    for row in rows {
        let mut named = row.iter().zip(header).filter(|(cell, _)| !cell.is_empty());
        if let Some((first, _)) = named.next() {
            text += &wrapped(first, 2);
        }
        for (cell, name) in named {
            let label = match name.is_empty() {
                true => String::new(),
                false => format!("{name}: "),
            };
            text += &wrapped(&format!("  {label}{cell}"), 4);
        }
    }
    text
}

/// Wraps text to lines of at most [`WIDTH`] columns; lines after the first are indented.
fn wrapped(line: &str, hanging: usize) -> String {
    let indent = line.len() - line.trim_start().len();
    let mut text = " ".repeat(indent);
    let mut column = indent;
    for (index, word) in line.split_whitespace().enumerate() {
        let length = visible_length(word);
        if index > 0 && column + 1 + length > WIDTH {
            text.push('\n');
            text += &" ".repeat(hanging);
            column = hanging;
        } else if index > 0 {
            text.push(' ');
            column += 1;
        }
        text += word;
        column += length;
    }
    text.push('\n');
    text
}

/// Number of characters without those of style codes.
fn visible_length(text: &str) -> usize {
    let styles = [BOLD, CODE, PLAIN];
    let codes: usize = styles
        .iter()
        .map(|style| style.len() * text.matches(style).count())
        .sum();
    text.chars().count() - codes
}

/// Formats code spans and strong words in their styles, and links as their text.
fn inline(line: &str) -> String {
    let mut text = String::new();
    for (index, part) in line.split('`').enumerate() {
        if index % 2 == 1 {
            text += &format!("{CODE}{part}{PLAIN}");
            continue;
        }
        for (index, part) in part.split("**").enumerate() {
            let words = links_as_words(part);
            match index % 2 {
                0 => text += &words,
                _ => text += &format!("{BOLD}{words}{PLAIN}"),
            }
        }
    }
    text
}

/// `[words][label]`, `[words](address)` and `[words]` are replaced by the words. Intervals such as
/// [0, 1] are kept.
fn links_as_words(text: &str) -> String {
    let mut words = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('[') {
        words += before;
        let is_link = after.starts_with(char::is_alphabetic);
        let Some((label, after)) = after.split_once(']').filter(|_| is_link) else {
            words.push('[');
            rest = after;
            continue;
        };
        words += label;
        let target = [('[', ']'), ('(', ')')]
            .into_iter()
            .find_map(|(open, close)| {
                let (_, rest) = after.strip_prefix(open)?.split_once(close)?;
                Some(rest)
            });
        rest = target.unwrap_or(after);
    }
    words + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain(markdown: &str) -> String {
        let text = for_terminal(markdown);
        text.replace(BOLD, "").replace(CODE, "").replace(PLAIN, "")
    }

    #[test]
    fn headings_code_and_links_are_rendered() {
        let page = "# Title\n\nSee [sweeps], [Rust](https://rustup.rs) and [what to do][exit_codes]; `a[0]` in [0, 1].\n\n```sh\n# not a heading\n```\n\n[sweeps]: sweeps.md\n";
        assert_eq!(
            plain(page),
            "Title\n\nSee sweeps, Rust and what to do; a[0] in [0, 1].\n\n    # not a heading\n"
        );
        let text = for_terminal(page);
        assert!(text.starts_with(&format!("{BOLD}Title{PLAIN}")));
        assert!(text.contains(&format!("{CODE}a[0]{PLAIN}")));
    }

    #[test]
    fn narrow_tables_are_aligned_and_wide_ones_become_paragraphs() {
        assert_eq!(
            plain("| a | long |\n|---|---|\n| `xyz` | 1 |\n"),
            "a    long\nxyz  1\n"
        );
        let words = "word ".repeat(20);
        let wide = plain(&format!("| name | meaning |\n|---|---|\n| x | {words}|\n"));
        let lines: Vec<&str> = wide.lines().collect();
        assert_eq!(lines[0], "x");
        assert!(lines[1].starts_with("  meaning: word word"));
        assert!(lines[2].starts_with("    word"));
        assert!(wide.lines().all(|line| line.len() <= WIDTH));
    }

    #[test]
    fn paragraphs_are_wrapped_by_their_visible_width() {
        let paragraph = "`code` ".repeat(40);
        let text = for_terminal(&paragraph);
        let longest = text.lines().map(visible_length).max();
        assert_eq!(longest, Some(79));
        assert!(plain(&format!("- {paragraph}")).contains("\n  code"));
    }
}
