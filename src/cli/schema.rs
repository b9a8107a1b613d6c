//! `rodlab schema`.

use super::prelude::*;
use rodlab_lab::experiment::json_schema;

/// Prints the JSON Schema of scenario files.
pub fn schema() -> Result<(), Failure> {
    print(&format!("{:#}\n", json_schema()))
}
