//! Differences of two resolved scenarios.

use toml::{Table, Value};

/// Maximum number of listed keys.
const MOST_NAMED: usize = 12;
/// Maximum length of a listed value, characters.
const LONGEST_VALUE: usize = 48;

/// Top-level keys that describe a run without changing it.
const REMARKS: [&str; 1] = ["title"];
/// Keys of `[output]` that only add files: results with such files also serve a scenario that
/// omits them.
const ADDITIONS: [&str; 3] = ["nodes", "forces", "vtk"];

/// The text without the keys that do not change a run; text that is not TOML stays unchanged.
pub(super) fn without_remarks(scenario: &str) -> String {
    if let Some(rest) = without_first_title(scenario) {
        return rest.to_owned();
    }
    let Ok(mut table) = scenario.parse::<Table>() else {
        return scenario.to_owned();
    };
    for key in REMARKS {
        table.remove(key);
    }
    toml::to_string(&table).unwrap_or_else(|_| scenario.to_owned())
}

/// The text after a first line that is a title, as resolved scenarios have it: they are as they
/// would be written again, and with a mesh of 100,000 triangles reading them takes 0.3 s.
fn without_first_title(scenario: &str) -> Option<&str> {
    let (title, rest) = scenario.strip_prefix("title = \"")?.split_once('\n')?;
    let is_closed = title.find('"') == Some(title.len().checked_sub(1)?);
    (is_closed && !title.contains('\\') && rest.starts_with("experiment = \"")).then_some(rest)
}

/// Whether finished results of one scenario contain everything that another requests: the other
/// may only omit files.
pub(super) fn holds(finished: &str, asked: &str) -> bool {
    let tables = finished.parse::<Table>().ok().zip(asked.parse().ok());
    let Some((mut finished, asked)): Option<(Table, Table)> = tables else {
        return false;
    };
    let addition = |table: &Table, key: &str| table.get("output")?.get(key)?.as_bool();
    for key in ADDITIONS {
        if addition(&asked, key) == Some(false)
            && let Some(Value::Table(output)) = finished.get_mut("output")
        {
            output.insert(key.to_owned(), Value::Boolean(false));
        }
    }
    [finished, asked]
        .map(|table| without_remarks(&table.to_string()))
        .windows(2)
        .all(|pair| pair[0] == pair[1])
}

/// The keys in which two scenarios differ, a line each: `key: earlier value, now value`.
pub(super) fn difference(earlier: &str, now: &str) -> Vec<String> {
    let [earlier, now] = [earlier, now].map(|text| {
        let table: Table = text.parse().unwrap_or_default();
        let mut keys = Vec::new();
        flatten("", &Value::Table(table), &mut keys);
        keys
    });
    let value = |keys: &[(String, String)], wanted: &str| {
        let found = keys.iter().find(|(key, _)| key == wanted);
        found.map(|(_, value)| value.clone())
    };
    let mut lines = Vec::new();
    for (key, before) in &earlier {
        match value(&now, key) {
            Some(after) if after == *before => {}
            Some(after) => lines.push(format!("{key}: {}, now {}", cut(before), cut(&after))),
            None => lines.push(format!("{key}: {}, now absent", cut(before))),
        }
    }
    for (key, after) in &now {
        if value(&earlier, key).is_none() {
            lines.push(format!("{key}: absent, now {}", cut(after)));
        }
    }
    lines.sort();
    let more = lines.len().saturating_sub(MOST_NAMED);
    if more > 0 {
        lines.truncate(MOST_NAMED);
        lines.push(format!("and {more} more"));
    }
    lines
}

/// All dotted keys at or below `value` with their values. Elements of lists of tables are
/// identified by their names, as on the command line, or otherwise by their indices.
fn flatten(path: &str, value: &Value, keys: &mut Vec<(String, String)>) {
    let below = |key: &str| match path {
        "" => key.to_owned(),
        path => format!("{path}.{key}"),
    };
    match value {
        Value::Table(table) => {
            for (key, value) in table {
                flatten(&below(key), value, keys);
            }
        }
        Value::Array(elements) if elements.iter().any(Value::is_table) => {
            for (index, element) in elements.iter().enumerate() {
                let name = element.get("name").and_then(Value::as_str);
                flatten(&below(name.unwrap_or(&index.to_string())), element, keys);
            }
        }
        value => keys.push((path.to_owned(), value.to_string())),
    }
}

fn cut(value: &str) -> String {
    if value.chars().count() <= LONGEST_VALUE {
        return value.to_owned();
    }
    let head: String = value.chars().take(LONGEST_VALUE).collect();
    format!("{head} …")
}

#[cfg(test)]
mod tests {
    use super::*;

    const BEAM: &str = "title = \"Beam\"\nexperiment = \"scene\"\n[[rods]]\nname = \"beam\"\nradius = 0.005\n\
                        [output]\nnodes = true\nvtk = true\n";

    #[test]
    fn keys_that_differ_are_named_with_both_values() {
        let other = BEAM
            .replace("0.005", "0.006")
            .replace("vtk = true", "interval = 0.1");
        assert_eq!(
            difference(BEAM, &other),
            [
                "output.interval: absent, now 0.1",
                "output.vtk: true, now absent",
                "rods.beam.radius: 0.005, now 0.006",
            ]
        );
        assert!(difference(BEAM, BEAM).is_empty());
    }

    #[test]
    fn long_lists_are_cut() {
        let many: String = (0..40).map(|k| format!("key_{k} = {k}\n")).collect();
        let lines = difference(&many, "");
        assert_eq!(lines.len(), MOST_NAMED + 1);
        assert_eq!(lines[MOST_NAMED], "and 28 more");
        let long = format!("points = [{}]\n", "1.0, ".repeat(1000));
        assert!(difference(&long, "")[0].len() < 90);
    }

    #[test]
    fn a_title_in_the_first_line_is_removed_as_from_the_parsed_text() {
        let text = "title = \"Mesh\"\nexperiment = \"scene\"\n\n[[rods]]\nedges = 3\n\n[output]\ninterval = 0.1\n";
        let mut table: Table = text.parse().unwrap();
        table.remove("title");
        assert_eq!(without_remarks(text), toml::to_string(&table).unwrap());
        for other in [r#"title = "a\"b""#, r#"title = "" # "a""#, "title = 'a'"] {
            let other = text.replacen(r#"title = "Mesh""#, other, 1);
            assert_eq!(without_first_title(&other), None);
            assert_eq!(without_remarks(&other), without_remarks(text));
        }
    }

    #[test]
    fn titles_change_nothing_and_fewer_files_are_in_more() {
        let titled = BEAM.replace("Beam", "A beam");
        assert_eq!(without_remarks(BEAM), without_remarks(&titled));
        let fewer = titled.replace("vtk = true", "vtk = false");
        assert!(holds(BEAM, &fewer) && holds(BEAM, BEAM));
        assert!(!holds(&fewer, BEAM));
        assert!(!holds(BEAM, &fewer.replace("0.005", "0.006")));
    }
}
