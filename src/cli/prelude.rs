//! Common parts of the subcommands: options, values, output and failures.

pub(super) use super::candidates::presets;
pub(super) use super::common::Common;
pub(super) use super::failure::{Failure, OrInput};
pub(super) use super::help::help;
pub(super) use super::output::{
    make_directory, print, print_json, print_paths, write_file, write_files,
};
pub(super) use super::preset_file::file_or_preset;
pub(super) use super::values::{
    Named, duration, edges, friction, is_positive, length_from_zero, named, number, numbers,
    positive, positive_length, shard, speed, within,
};
pub(super) use crate::presets::PresetKind;
pub(super) use clap::{Args, Subcommand, ValueEnum};
pub(super) use serde::Serialize;
pub(super) use std::fmt::{Display, Write};
pub(super) use std::path::{Path, PathBuf};
