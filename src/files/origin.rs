//! Version of the program, and the commit that it was built from.

use std::sync::OnceLock;

/// Version of the program.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

static COMMIT: OnceLock<&'static str> = OnceLock::new();

/// Sets the commit that the program was built from; only the first call has an effect.
pub fn state_commit(commit: &'static str) {
    COMMIT.get_or_init(|| commit);
}

/// The commit that the program was built from, if known.
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
