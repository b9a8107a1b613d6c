//! Texts after the options of a command: `-h` shows examples; `--help` also shows a description.

/// Defines both texts: the examples, and the examples with the description.
macro_rules! help {
    ($examples:literal, $description:literal) => {
        [$examples, concat!($examples, "\n\n", $description)]
    };
}
pub(super) use help;
