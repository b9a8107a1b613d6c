//! Source files as the compiler sees them: without comments, literals and tests, and with full
//! paths.

use std::fs;
use std::path::{Path, PathBuf};

/// A path to an item: its room and the names below it. The crate of the room does not matter.
pub type ItemPath = Vec<String>;

/// Crates that are a single room with the name of the crate.
const ROOM_CRATES: [&str; 3] = ["python", "robot", "vision"];

/// The path of the root of a crate.
fn root_of(name: &str) -> ItemPath {
    let is_room = ROOM_CRATES.contains(&name);
    is_room.then(|| name.to_owned()).into_iter().collect()
}

/// The path of the root of the crate that contains a module.
fn own_root(module: &[String]) -> ItemPath {
    module.first().map_or(Vec::new(), |room| root_of(room))
}

/// A source file.
pub struct Source {
    /// The file.
    pub file: PathBuf,
    /// Path of the module.
    pub module: ItemPath,
    /// Full paths of all items of these crates that the file names outside its tests.
    pub imports: Vec<ItemPath>,
    /// Full paths of the items of other files that the file re-exports with `pub use`.
    pub exports: Vec<ItemPath>,
}

/// All files below the folder of the crates, except tests and roots with several rooms, which only
/// name their rooms.
pub fn sources(folder: &Path) -> Vec<Source> {
    let mut files = Vec::new();
    collect(folder, &mut files);
    let texts: Vec<(PathBuf, String)> = files
        .into_iter()
        .map(|file| {
            let text = fs::read_to_string(&file).expect("readable source");
            (file, plain(&text))
        })
        .collect();
    let tests: Vec<ItemPath> = texts
        .iter()
        .flat_map(|(file, code)| {
            let module = module_of(file, folder);
            let names = test_items(code).1;
            names.into_iter().map(move |name| joined(&module, &[name]))
        })
        .collect();
    texts
        .into_iter()
        .filter_map(|(file, code)| {
            let module = module_of(&file, folder);
            let is_root = module.is_empty();
            let is_test = tests.iter().any(|test| module.starts_with(test));
            let code = test_items(&code).0;
            (!is_root && !is_test).then(|| Source {
                file,
                imports: imports(&code, &module),
                exports: exports(&code, &module),
                module,
            })
        })
        .collect()
}

fn collect(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a source folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            collect(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found.sort();
}

fn module_of(file: &Path, folder: &Path) -> ItemPath {
    let below = file.strip_prefix(folder).expect("a file below the folder");
    let mut names: ItemPath = below
        .with_extension("")
        .components()
        .map(|component| component.as_os_str().to_string_lossy().into_owned())
        .collect();
    if matches!(
        names.last().map(String::as_str),
        Some("mod" | "lib" | "main")
    ) {
        names.pop();
    }
    let is_crate = names.first().is_some_and(|name| {
        let manifest = folder.join(name).join("Cargo.toml");
        root_of(name).is_empty() && manifest.is_file()
    });
    if is_crate {
        names.remove(0);
    }
    names
}

fn joined(module: &[String], names: &[String]) -> ItemPath {
    module.iter().chain(names).cloned().collect()
}

fn is_name(character: char) -> bool {
    character.is_alphanumeric() || character == '_'
}

/// Replaces comments, strings and characters in code by blanks.
pub fn plain(text: &str) -> String {
    let characters: Vec<char> = text.chars().collect();
    let at = |index: usize| characters.get(index).copied().unwrap_or('\0');
    let mut code = String::with_capacity(text.len());
    let mut index = 0;
    while index < characters.len() {
        let end = match (at(index), at(index + 1)) {
            ('/', '/') => end_of(&characters, index, |k| at(k) == '\n'),
            ('/', '*') => end_of(&characters, index + 2, |k| {
                at(k - 2) == '*' && at(k - 1) == '/'
            }),
            ('"', _) => end_of_text(&characters, index + 1),
            ('r', '"' | '#') if index == 0 || !is_name(at(index - 1)) => {
                let hashes = (index + 1..).take_while(|&k| at(k) == '#').count();
                if at(index + 1 + hashes) == '"' {
                    let first = index + 2 + hashes;
                    end_of(&characters, first + hashes, |k| {
                        let quote = k - hashes - 1;
                        quote >= first && at(quote) == '"' && (quote + 1..k).all(|k| at(k) == '#')
                    })
                } else {
                    index
                }
            }
            // This is a character literal, not a lifetime.
            ('\'', '\\') => end_of(&characters, index + 3, |k| at(k - 1) == '\''),
            ('\'', _) if at(index + 2) == '\'' => index + 3,
            _ => index,
        };
        if end > index {
            code.extend((index..end).map(|k| if at(k) == '\n' { '\n' } else { ' ' }));
            index = end;
        } else {
            code.push(at(index));
            index += 1;
        }
    }
    code
}

/// The first index at or after `start` for which `ends` holds.
fn end_of(characters: &[char], start: usize, ends: impl Fn(usize) -> bool) -> usize {
    (start..characters.len())
        .find(|&index| ends(index))
        .unwrap_or(characters.len())
}

/// The index after the closing quote of a string, which may contain escaped quotes.
fn end_of_text(characters: &[char], start: usize) -> usize {
    let mut index = start;
    while index < characters.len() {
        match characters[index] {
            '\\' => index += 2,
            '"' => return index + 1,
            _ => index += 1,
        }
    }
    characters.len()
}

/// Code without the items that only tests have, and the names of the removed modules.
pub fn test_items(code: &str) -> (String, Vec<String>) {
    const TEST: &str = "#[cfg(test)]";
    let mut kept = String::new();
    let mut modules = Vec::new();
    let mut rest = code;
    while let Some(start) = rest.find(TEST) {
        kept.push_str(&rest[..start]);
        let item = &rest[start + TEST.len()..];
        if let Some((_, after)) = item.split_once("mod ")
            && item.find("mod ") < item.find(['{', ';'])
        {
            let name: String = after.chars().take_while(|c| is_name(*c)).collect();
            modules.push(name);
        }
        rest = &item[item_end(item)..];
    }
    kept.push_str(rest);
    (kept, modules)
}

/// End of an item: after its semicolon, or after its closing brace.
fn item_end(item: &str) -> usize {
    let mut depth = 0;
    for (index, character) in item.char_indices() {
        match character {
            '{' | '(' | '[' => depth += 1,
            '}' | ')' | ']' => {
                depth -= 1;
                // This is the closing brace of the item itself; lists of fields or arguments close
                // earlier.
                if depth == 0 && character == '}' {
                    return index + 1;
                }
                // The item is the last one in the block of another item.
                if depth < 0 {
                    return index;
                }
            }
            ';' | ',' if depth == 0 => return index + 1,
            _ => {}
        }
    }
    item.len()
}

/// Full paths of everything in these crates that the code imports.
pub fn imports(code: &str, module: &[String]) -> Vec<ItemPath> {
    let mut found = Vec::new();
    for (start, root) in code.match_indices("rodlab_") {
        let (name, rest) = split_name(&code[start + root.len()..]);
        if !code[..start].ends_with(is_name)
            && let Some(below) = rest.strip_prefix("::")
        {
            tree(below, root_of(name), &mut found);
        }
    }
    for root in ["crate::", "super::", "self::"] {
        for (start, _) in code.match_indices(root) {
            let before = &code[..start];
            if before.ends_with(is_name) || before.ends_with("::") {
                continue;
            }
            let base = match root {
                "crate::" => own_root(module),
                "super::" => module[..module.len().saturating_sub(1)].to_vec(),
                _ => module.to_vec(),
            };
            tree(&code[start + root.len()..], base, &mut found);
        }
    }
    found
}

/// Full paths of everything that the module re-exports. An item of another crate looks like a part
/// of the module.
pub fn exports(code: &str, module: &[String]) -> Vec<ItemPath> {
    let mut found = Vec::new();
    for (start, _) in code.match_indices("use ") {
        let before = code[..start].trim_end();
        if !(before.ends_with("pub")
            || before.ends_with("pub(crate)")
            || before.ends_with("pub(super)"))
        {
            continue;
        }
        let path = &code[start + "use ".len()..];
        match path.strip_prefix("crate::") {
            Some(below) => tree(below, own_root(module), &mut found),
            None => tree(path, module.to_vec(), &mut found),
        };
    }
    found
}

/// The name at the beginning of code, and the remaining code.
fn split_name(code: &str) -> (&str, &str) {
    let length = code.find(|c: char| !is_name(c)).unwrap_or(code.len());
    code.split_at(length)
}

/// Adds the paths of a tree such as `a::{b, c::D}` below `base`; returns the remaining code.
fn tree<'a>(code: &'a str, base: ItemPath, found: &mut Vec<ItemPath>) -> &'a str {
    let code = code.trim_start();
    if let Some(mut rest) = code.strip_prefix('{') {
        loop {
            rest = tree(rest, base.clone(), found).trim_start();
            match rest.strip_prefix(',') {
                Some(after) if !after.trim_start().starts_with('}') => rest = after,
                Some(after) => return after.trim_start().trim_start_matches('}'),
                None => return rest.strip_prefix('}').unwrap_or(rest),
            }
        }
    }
    let (name, rest) = split_name(code);
    let mut path = base;
    if name == "super" {
        path.pop();
    } else if !name.is_empty() && name != "self" {
        path.push(name.to_owned());
    }
    if let Some(below) = rest.strip_prefix("::")
        && below
            .trim_start()
            .starts_with(|c: char| is_name(c) || c == '{')
    {
        return tree(below, path, found);
    }
    found.push(path);
    // The item is renamed, as in `a as b`.
    match rest.trim_start().strip_prefix("as ") {
        Some(renamed) => renamed.trim_start().trim_start_matches(is_name),
        None => rest,
    }
}
