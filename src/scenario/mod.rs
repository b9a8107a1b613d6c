//! Scenario files: the TOML schema as Rust types, units, validation with source positions.
