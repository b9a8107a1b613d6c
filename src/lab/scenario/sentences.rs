//! Sentences of explanations: about types of keys, in lines that fit on a terminal.

/// Largest width of a line, columns.
const WIDTH: usize = 100;

/// Beginning of the sentence about a quantity with a unit.
const QUANTITY: &str = "A number in ";

/// A sentence about a type, with spaces between the factors of its unit: "A number in Pa s, ...".
pub fn legible(words: &str) -> String {
    let parts = words.strip_prefix(QUANTITY);
    match parts.and_then(|rest| rest.split_once(',')) {
        Some((symbol, rest)) => format!("{QUANTITY}{},{rest}", spaced(symbol)),
        None => words.to_owned(),
    }
}

/// The symbol of an SI unit with spaces between its factors.
fn spaced(symbol: &str) -> &str {
    match symbol {
        "Pas" => "Pa s",
        "Ns" => "N s",
        "Ns/m^2" => "N s/m^2",
        "Nm" => "N m",
        "Nm/rad" => "N m/rad",
        "Nm^2" => "N m^2",
        "kgm^2" => "kg m^2",
        other => other,
    }
}

/// Sentence about a list of quantities. `element` is the sentence about one of them; `sizes` are
/// the numbers of elements of the list, of the lists in it, and so on, `None` if any number is
/// allowed. `None` if `element` is not about a quantity.
pub fn list(element: &str, sizes: &[Option<u64>]) -> Option<String> {
    let unit = if element == "A pure number." {
        ".".to_owned()
    } else {
        let (symbol, rest) = element.strip_prefix(QUANTITY)?.split_once(',')?;
        let rest = rest.replacen("or text with", "or texts with", 1);
        format!(" in {},{rest}", spaced(symbol))
    };
    let mut text = "A list of ".to_owned();
    for (depth, size) in sizes.iter().enumerate() {
        if let Some(size) = size {
            text += &format!("{size} ");
        }
        let is_last = depth + 1 == sizes.len();
        text += if is_last { "numbers" } else { "lists of " };
    }
    Some(text + &unit)
}

/// Whether a sentence is about a quantity.
pub fn is_quantity(words: &str) -> bool {
    words.starts_with(QUANTITY) || words.starts_with("A list of ") || words == "A pure number."
}

/// Whether most long words of the sentence about a type are in the text about its key.
pub fn repeats(of_key: &str, of_type: &str) -> bool {
    let of_key = of_key.to_lowercase();
    let of_type = of_type.to_lowercase();
    let words = of_type.split(|character: char| !character.is_alphanumeric());
    let long: Vec<&str> = words.filter(|word| word.chars().count() > 3).collect();
    let known = long.iter().filter(|word| of_key.contains(**word)).count();
    2 * known > long.len()
}

/// The lines of a text, indented by two columns, after the first by `indent`. A paragraph with
/// lines that are too wide is broken again.
pub fn indented(words: &str, indent: usize) -> String {
    let fits = |line: &str| line.chars().count() + 2 <= WIDTH;
    let margin = " ".repeat(indent);
    if words.lines().all(fits) || words.contains("\n\n") {
        let lines: Vec<&str> = words.lines().collect();
        return format!("  {}", lines.join(&format!("\n{margin}")));
    }
    let (mut text, mut column) = (" ".to_owned(), 1);
    for word in words.split_whitespace() {
        let width = 1 + word.chars().count();
        if column + width > WIDTH {
            text += &format!("\n{margin}{word}");
            column = margin.len() + width - 1;
        } else {
            text += &format!(" {word}");
            column += width;
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_state_their_sizes_and_units() {
        assert_eq!(
            list("A pure number.", &[Some(3)]).unwrap(),
            "A list of 3 numbers."
        );
        let nested = list(
            "A number in Pas, or text with a unit; all.",
            &[None, Some(2)],
        );
        assert_eq!(
            nested.unwrap(),
            "A list of lists of 2 numbers in Pa s, or texts with a unit; all."
        );
        assert_eq!(list("A held or driven node.", &[None]), None);
    }

    #[test]
    fn wide_paragraphs_are_broken_and_others_stay() {
        assert_eq!(indented("one\ntwo", 2), "  one\n  two");
        let wide = indented(&"word ".repeat(30), 4);
        let widths: Vec<usize> = wide.lines().map(str::len).collect();
        assert_eq!(widths, [96, 58]);
        assert!(wide.lines().nth(1).unwrap().starts_with("    word"));
    }

    #[test]
    fn a_type_is_left_out_only_if_the_key_says_the_same() {
        let joined = "Nets, gridshells, trees: many rods joined at their crossings.";
        assert!(repeats(
            joined,
            "Many rods joined at their crossings, from one table."
        ));
        let knot = "The knot of the experiments and how it is pulled tight.";
        let settles = "A knot of one or two rods: it settles, then its ends are pulled apart.";
        assert!(!repeats(knot, settles));
    }
}
