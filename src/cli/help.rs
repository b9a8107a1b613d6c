//! Texts after the options of a command: `-h` shows examples, `--help` a description, too.

/// Both texts: the examples, and the examples with the description.
macro_rules! help {
    ($examples:literal, $description:literal) => {
        [$examples, concat!($examples, "\n\n", $description)]
    };
}
pub(super) use help;
