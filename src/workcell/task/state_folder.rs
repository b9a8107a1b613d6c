//! The directory of the user's state.

use std::env;
use std::path::{Path, PathBuf};

/// A directory in `$XDG_STATE_HOME/rodlab`, which may not exist yet.
pub fn state_folder(name: &str) -> PathBuf {
    let given = env::var_os("XDG_STATE_HOME").map(PathBuf::from);
    let at_home = || env::var_os("HOME").map(|home| Path::new(&home).join(".local/state"));
    let state = given.filter(|path| path.is_absolute()).or_else(at_home);
    let state = state.unwrap_or_else(env::temp_dir);
    state.join("rodlab").join(name)
}
