//! Faults of a scenario, each with its key.

use std::fmt;

/// The path from the top of a scenario to a key: table keys, and indices of arrays as decimal numbers.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct KeyPath(Vec<String>);

impl KeyPath {
    /// The top of the scenario.
    pub fn root() -> Self {
        Self::default()
    }

    /// The path to `key` below this one.
    #[must_use]
    pub fn key(&self, key: &str) -> Self {
        let mut steps = self.0.clone();
        steps.push(key.to_owned());
        Self(steps)
    }

    /// The path to the element `index` of the array at this path.
    #[must_use]
    pub fn index(&self, index: usize) -> Self {
        self.key(&index.to_string())
    }

    /// The steps from the top.
    pub fn steps(&self) -> &[String] {
        &self.0
    }
}

impl From<&str> for KeyPath {
    /// Splits a dotted path such as `rods.0.radius`.
    fn from(dotted: &str) -> Self {
        Self(dotted.split('.').map(str::to_owned).collect())
    }
}

impl fmt::Display for KeyPath {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.0.join("."))
    }
}

/// One fault of a scenario.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Issue {
    /// Path of the faulty key; for a missing key, of its table.
    pub path: KeyPath,
    /// Description of the fault, with the allowed range.
    pub message: String,
    /// Advice on what to type instead.
    pub help: Option<String>,
    /// Whether the key itself is faulty, rather than its value.
    pub labels_key: bool,
    /// Index of the copy, if the table is a copy.
    pub copy: Option<usize>,
}

impl Issue {
    /// A fault at `path`.
    pub fn new(path: KeyPath, message: impl Into<String>) -> Self {
        Self {
            path,
            message: message.into(),
            help: None,
            labels_key: false,
            copy: None,
        }
    }

    /// Adds advice on what to type instead, if there is any.
    #[must_use]
    pub fn with_help(mut self, help: impl Into<Option<String>>) -> Self {
        self.help = help.into();
        self
    }
}

impl fmt::Display for Issue {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.path.steps(), self.copy) {
            ([], _) => write!(formatter, "{}", self.message),
            (_, None) => write!(formatter, "`{}`: {}", self.path, self.message),
            (_, Some(copy)) => {
                write!(formatter, "`{}` (copy {copy}): {}", self.path, self.message)
            }
        }
    }
}

/// All faults found in a scenario.
#[derive(Clone, Debug, Default, PartialEq, Eq, thiserror::Error)]
pub struct Issues(pub Vec<Issue>);

impl Issues {
    /// Adds a fault, unless it is already listed.
    pub fn push(&mut self, issue: Issue) {
        if !self.0.contains(&issue) {
            self.0.push(issue);
        }
    }

    /// Returns the value of a result, or adds its faults to these.
    pub fn keep<T>(&mut self, result: Result<T, Self>) -> Option<T> {
        match result {
            Ok(value) => Some(value),
            Err(faults) => {
                faults.0.into_iter().for_each(|issue| self.push(issue));
                None
            }
        }
    }

    /// Prefixes the paths of all faults with `path`.
    #[must_use]
    pub fn below(self, path: &KeyPath) -> Self {
        let below = |issue: Issue| {
            let steps = issue.path.steps();
            Issue {
                path: steps.iter().fold(path.clone(), |path, step| path.key(step)),
                ..issue
            }
        };
        Self(self.0.into_iter().map(below).collect())
    }

    /// `value` if there are no faults, else the faults.
    pub fn or_ok<T>(self, value: T) -> Result<T, Self> {
        if self.0.is_empty() {
            Ok(value)
        } else {
            Err(self)
        }
    }
}

impl From<Issue> for Issues {
    fn from(issue: Issue) -> Self {
        Self(vec![issue])
    }
}

impl fmt::Display for Issues {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (number, issue) in self.0.iter().enumerate() {
            if number > 0 {
                writeln!(formatter)?;
            }
            write!(formatter, "{issue}")?;
        }
        Ok(())
    }
}

/// The candidate that is most similar to `typed`, if one is similar enough to be a typing error.
pub fn nearest<'a>(typed: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    candidates
        .into_iter()
        .map(|candidate| (strsim::jaro_winkler(typed, candidate), candidate))
        .filter(|(likeness, _)| *likeness > 0.75)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}

/// "did you mean `...`?", if a candidate is similar.
pub fn did_you_mean<'a>(
    typed: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Option<String> {
    nearest(typed, candidates).map(|candidate| format!("did you mean `{candidate}`?"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn suggests_the_nearest_name_only() {
        let keys = ["radius", "edges", "closed"];
        assert_eq!(nearest("raduis", keys), Some("radius"));
        assert_eq!(nearest("edge", keys), Some("edges"));
        assert_eq!(nearest("viscosity", keys), None);
    }

    #[test]
    fn paths_read_as_they_are_typed() {
        let path = KeyPath::root().key("rods").index(2).key("radius");
        assert_eq!(path.to_string(), "rods.2.radius");
        assert_eq!(path, KeyPath::from("rods.2.radius"));
    }
}
