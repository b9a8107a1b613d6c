//! The checks as a Markdown page, which the repository contains as `results/reproduced/verify.md`.

use super::GroupResult;
use super::check::{Check, Verdict, number};

const HEADER: [&str; 8] = [
    "check", "formula", "expected", "got", "unit", "error", "at most", "source",
];
/// Columns with values that depend on the machine.
#[cfg(test)]
const FOUND: [usize; 2] = [3, 5];

/// A table per group.
pub fn markdown(groups: &[GroupResult]) -> String {
    let mut text = format!(
        "# The engine against theory\n\n\
         Made by `rodlab verify --markdown`, version {}. Errors are fractions of the expected value,\n\
         or of the scale of the check: the length of the rod, its radius, a force. A test compares names,\n\
         expected values and bounds with those of the program.\n",
        env!("CARGO_PKG_VERSION")
    );
    for group in groups {
        let mut name = group.name.to_owned();
        name[..1].make_ascii_uppercase();
        text += &format!("\n## {name}\n\n");
        text += &line(&HEADER.map(str::to_owned));
        text += &line(&HEADER.map(|_| "---".to_owned()));
        for check in &group.checks {
            text += &line(&cells(check));
        }
    }
    text
}

fn cells(check: &Check) -> [String; 8] {
    let failed = match check.verdict() {
        Verdict::Pass => "",
        Verdict::Fail => " **FAIL**",
    };
    [
        check.name.clone(),
        check.formula.clone(),
        number(check.expected),
        number(check.got),
        check.unit.clone(),
        format!("{:.1e}{failed}", check.error),
        format!("{:.1e}", check.bound),
        check.source.clone(),
    ]
}

fn line(cells: &[String; 8]) -> String {
    let escaped = cells.each_ref().map(|cell| cell.replace('|', "\\|"));
    format!("| {} |\n", escaped.join(" | "))
}

/// Fails unless the page contains the rows of a group, regardless of the simulated values.
#[cfg(test)]
pub(super) fn assert_on_page(group: &str, checks: &[Check]) {
    let page = include_str!("../../results/reproduced/verify.md");
    let name = format!("\n## {}{}\n", group[..1].to_uppercase(), &group[1..]);
    let section = page.split_once(&name).map(|(_, section)| section);
    let section = section.unwrap_or_else(|| panic!("the page has no group {group}"));
    let section = section.split("\n## ").next().unwrap_or_default();
    let rows = section.lines().filter(|line| line.starts_with("| "));
    let kept = |line: &str| -> Vec<String> {
        let cells = line.trim().split(" | ").map(str::to_owned).enumerate();
        let kept = cells.filter(|(column, _)| !FOUND.contains(column));
        kept.map(|(_, cell)| cell).collect()
    };
    let on_page: Vec<Vec<String>> = rows.skip(2).map(kept).collect();
    let expected: Vec<Vec<String>> = checks
        .iter()
        .map(|check| kept(&line(&cells(check))))
        .collect();
    let advice = "`rodlab verify --markdown > results/reproduced/verify.md` rewrites it";
    assert_eq!(on_page, expected, "{advice}");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::GROUPS;

    #[test]
    fn the_page_has_the_groups_of_the_program() {
        let page = include_str!("../../results/reproduced/verify.md");
        let headings: Vec<String> = page
            .lines()
            .filter_map(|line| line.strip_prefix("## "))
            .map(str::to_lowercase)
            .collect();
        assert_eq!(headings, GROUPS.map(|(name, _)| name));
    }

    #[test]
    fn bars_in_formulas_do_not_end_cells() {
        let mut check = Check::not_run("group", "no reason");
        check.formula = "|x|".into();
        let groups = [GroupResult {
            name: "group",
            checks: vec![check],
        }];
        let text = markdown(&groups);
        assert!(
            text.contains("\n## Group\n") && text.contains("| \\|x\\| |"),
            "{text}"
        );
        assert!(text.contains("FAIL"));
    }
}
