//! A scenario as a list of keys and values for display.

use toml::Value;

/// Length at which values are cut; their beginning identifies them.
const LONGEST: usize = 60;

/// Every key of a scenario with its value. Keys are dotted; the list is empty if the text is not
/// TOML.
pub(super) fn flattened(scenario: &str) -> Vec<(String, String)> {
    let mut pairs = Vec::new();
    if let Ok(table) = scenario.parse::<toml::Table>() {
        for (key, value) in table {
            flatten(&key, &value, &mut pairs);
        }
    }
    pairs
}

fn flatten(key: &str, value: &Value, pairs: &mut Vec<(String, String)>) {
    match value {
        Value::Table(table) => {
            for (name, value) in table {
                flatten(&format!("{key}.{name}"), value, pairs);
            }
        }
        Value::Array(tables) if tables.iter().any(Value::is_table) => {
            for (index, table) in tables.iter().enumerate() {
                let name = table.get("name").and_then(Value::as_str);
                let name = name.map_or_else(|| index.to_string(), str::to_owned);
                flatten(&format!("{key}.{name}"), table, pairs);
            }
        }
        Value::String(text) => pairs.push((key.to_owned(), shortened(text.clone()))),
        other => pairs.push((key.to_owned(), shortened(other.to_string()))),
    }
}

fn shortened(text: String) -> String {
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{} …", &text[..end]),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_become_dotted_keys_and_named_rods_their_names() {
        let text = "title = \"Beam\"\n[contact]\nfriction = 0.3\n[[rods]]\nname = \"a\"\nstart = [0, 0, 1]\n";
        let pairs = flattened(text);
        let value = |key: &str| {
            let pair = pairs.iter().find(|(name, _)| name == key);
            pair.map(|(_, value)| value.as_str())
        };
        assert_eq!(value("title"), Some("Beam"));
        assert_eq!(value("contact.friction"), Some("0.3"));
        assert_eq!(value("rods.a.start"), Some("[0, 0, 1]"));
        assert!(flattened("not = toml = at all").is_empty());
    }

    #[test]
    fn long_values_are_cut() {
        let text = format!("points = \"{}\"", "é".repeat(100));
        assert_eq!(flattened(&text)[0].1, format!("{} …", "é".repeat(LONGEST)));
    }
}
