//! The files of `scenarios`, which `scripts/build.rs` lists.

/// Paths below `scenarios`, sorted, with their contents.
pub(super) const FILES: &[(&str, &[u8])] = include!(concat!(env!("OUT_DIR"), "/presets.rs"));
