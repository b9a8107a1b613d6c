//! Version of the program, and the commit from which it was built.

use std::sync::OnceLock;

/// Version of the program.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

static COMMIT: OnceLock<&'static str> = OnceLock::new();

/// Sets the commit from which the program was built; only the first call has an effect.
pub fn state_commit(commit: &'static str) {
    COMMIT.get_or_init(|| commit);
}

/// The commit from which the program was built, if known.
pub fn commit() -> Option<&'static str> {
    COMMIT.get().copied()
}

/// The version, with the commit if known.
pub fn version() -> String {
    commit().map_or_else(
        || VERSION.to_owned(),
        |commit| format!("{VERSION} ({commit})"),
    )
}
