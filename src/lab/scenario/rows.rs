//! The form of a tabulated function, [[position, value], ...].

use super::form::{Form, Requirable};
use super::quantity::Quantity;
use super::section::{FINITE, Section};
use super::units::Dimension;
use std::marker::PhantomData;

/// Rows of a function that is linear between them, with growing positions.
pub struct Rows<X, Y>(PhantomData<(X, Y)>);

impl<X: Dimension, Y: Dimension> Rows<X, Y> {
    /// Any values.
    pub fn any() -> Self {
        Self(PhantomData)
    }
}

impl<X: Dimension, Y: Dimension> Form for Rows<X, Y> {
    type Typed = Vec<(Quantity<X>, Quantity<Y>)>;
    type Value = Vec<(f64, f64)>;

    fn judge(&self, section: &Section<'_>, key: &str, typed: &Self::Typed) -> Self::Value {
        let mut rows: Self::Value = Vec::new();
        if typed.is_empty() {
            section.fault(key, "the table is empty; give at least one row");
        }
        for (row, (position, value)) in section.elements(key, typed) {
            let position = row.number("0", position, FINITE);
            if let Some((before, _)) = rows.last()
                && position <= *before
            {
                row.fault(
                    "0",
                    format!("{position:?} does not come after {before:?}; positions must grow"),
                );
            }
            rows.push((position, row.number("1", value, FINITE)));
        }
        rows
    }

    fn range(&self) -> Option<String> {
        Some("positions that grow".to_owned())
    }
}

impl<X: Dimension, Y: Dimension> Requirable for Rows<X, Y> {
    fn help(&self) -> String {
        format!("rows [[{}, {}], ...]", X::NAME, Y::NAME)
    }

    fn nothing(&self) -> Self::Value {
        Vec::new()
    }
}
