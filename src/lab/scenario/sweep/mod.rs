//! Sweeps: one scenario file, many cases.
//!
//! | file | what |
//! |---|---|
//! | `case_set` | a scenario and all its cases |
//! | `case` | one case: its values and its id |
//! | `portable` | the scenario with copies of the files that it reads |
//! | `axis`, `range` | lists, ranges and zipped lists of values |
//! | `derivatives` | derivatives in the table |
//! | `ends` | ends of ranges that are expressions |
//! | `sample` | samples of ranges |
//! | `points`, `vary` | points from a CSV file and from the command line |
//! | `search` | the search for one value |

mod axis;
mod case;
mod case_set;
mod derivatives;
mod ends;
mod points;
mod portable;
mod range;
mod sample;
mod search;
#[cfg(test)]
mod tests;
mod vary;

pub use case::{Case, Parameter, earlier_id};
pub use case_set::CaseSet;
pub use derivatives::SweptDerivatives;
pub use portable::{InputFile, Portable};
pub use search::Search;
