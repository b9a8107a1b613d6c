//! Files embedded in the program: scenarios, rods, papers, cells, patterns, and the files to which
//! they refer.
//!
//! A preset is used like any other file. [`Preset::file`] writes all of them to a folder of the user's cache first, so that
//! a preset may extend another one or refer to a mesh.

mod embedded;
mod folder;

use std::fmt;
use std::path::{Path, PathBuf};

pub use folder::CannotUnpack;

/// Kind of a preset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PresetKind {
    /// A scenario to run.
    Scenario,
    /// A rod to lay.
    Rod,
    /// A paper to fold.
    Paper,
    /// A robot cell.
    Cell,
    /// A drawing to lay a rod along.
    Pattern,
}

impl PresetKind {
    /// All kinds.
    pub const ALL: [Self; 5] = [
        Self::Scenario,
        Self::Rod,
        Self::Paper,
        Self::Cell,
        Self::Pattern,
    ];

    /// Name of the kind.
    pub fn name(self) -> &'static str {
        match self {
            Self::Scenario => "scenario",
            Self::Rod => "rod",
            Self::Paper => "paper",
            Self::Cell => "cell",
            Self::Pattern => "pattern",
        }
    }

    /// The kind of a file by its path below the folder of presets; `None` for a file that is only
    /// referred to by presets.
    fn of(path: &str) -> Option<Self> {
        let (folder, name) = path.rsplit_once('/').unwrap_or(("", path));
        let kind = Self::ALL.into_iter().find(|kind| kind.folder() == folder)?;
        name.ends_with(kind.ending()).then_some(kind)
    }

    fn folder(self) -> &'static str {
        match self {
            Self::Scenario => "",
            Self::Rod => "rods",
            Self::Paper => "papers",
            Self::Cell => "cells",
            Self::Pattern => "patterns",
        }
    }

    /// Ending of the names of its files.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Pattern => ".svg",
            _ => ".toml",
        }
    }
}

impl fmt::Display for PresetKind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

/// A file embedded in the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Preset {
    /// Kind of the preset.
    pub kind: PresetKind,
    /// The name of its file without the ending.
    pub name: &'static str,
    /// Text of the preset.
    pub text: &'static str,
    path: &'static str,
}

impl Preset {
    /// All presets, grouped by kind and sorted by name.
    pub fn all() -> impl Iterator<Item = Self> {
        PresetKind::ALL.into_iter().flat_map(|kind| {
            embedded::FILES.iter().filter_map(move |&(path, bytes)| {
                let name = path.rsplit('/').next().unwrap_or(path);
                (PresetKind::of(path) == Some(kind)).then(|| Self {
                    kind,
                    name: name.strip_suffix(kind.ending()).unwrap_or(name),
                    text: std::str::from_utf8(bytes).expect("presets are text"),
                    path,
                })
            })
        })
    }

    /// The presets of a kind, sorted by name.
    pub fn of_kind(kind: PresetKind) -> impl Iterator<Item = Self> {
        Self::all().filter(move |preset| preset.kind == kind)
    }

    /// The preset of a kind with a name.
    pub fn named(kind: PresetKind, name: &str) -> Option<Self> {
        Self::of_kind(kind).find(|preset| preset.name == name)
    }

    /// The preset for a path that does not exist: its name, such as `green_vps`, or a path that
    /// ends in the name of its file, such as `scenarios/rods/green_vps.toml`.
    pub fn in_place_of(kind: PresetKind, path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_str()?;
        let is_bare = path.components().count() == 1;
        let stem = name.strip_suffix(kind.ending());
        Self::named(kind, stem.or(is_bare.then_some(name))?)
    }

    /// The title in its text, or its first comment.
    pub fn title(&self) -> &'static str {
        let between = |before, after: char| {
            let (_, rest) = self.text.split_once(before)?;
            Some(rest.split_once(after)?.0)
        };
        let title = match self.kind {
            PresetKind::Pattern => between("<title>", '<'),
            _ => between("title = \"", '"'),
        };
        title.unwrap_or_else(|| {
            let first = self.text.lines().next().unwrap_or_default();
            first.trim_start_matches(['#', ' '])
        })
    }

    /// Path of its file, in a folder with all presets in the user's cache. Missing or different
    /// files are written first.
    ///
    /// # Errors
    /// The folder cannot be written.
    pub fn file(&self) -> Result<PathBuf, CannotUnpack> {
        Ok(folder::unpacked()?.join(self.path))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn each_preset_has_a_title_and_a_name_of_its_own() {
        let all: Vec<_> = Preset::all().collect();
        for preset in &all {
            assert!(!preset.title().is_empty(), "{}", preset.path);
        }
        let names: BTreeSet<_> = all
            .iter()
            .map(|preset| (preset.kind as u8, preset.name))
            .collect();
        assert_eq!(names.len(), all.len());
        for kind in PresetKind::ALL {
            assert!(Preset::of_kind(kind).count() > 3);
        }
    }

    #[test]
    fn a_path_selects_the_preset_that_it_ends_in() {
        let found =
            |kind, path: &str| Preset::in_place_of(kind, Path::new(path)).map(|preset| preset.name);
        let rod = PresetKind::Rod;
        for path in [
            "rope",
            "rope.toml",
            "scenarios/rods/rope.toml",
            "/elsewhere/rope.toml",
        ] {
            assert_eq!(found(rod, path), Some("rope"), "{path}");
        }
        for path in ["", "..", "rods/rope", "rope.svg", "trefoil"] {
            assert_eq!(found(rod, path), None, "{path}");
        }
        assert_eq!(found(PresetKind::Pattern, "A"), Some("A"));
        assert_eq!(found(PresetKind::Pattern, "drawings/A.svg"), Some("A"));
        assert_eq!(
            found(PresetKind::Scenario, "flagella_m5"),
            Some("flagella_m5")
        );
    }
}
